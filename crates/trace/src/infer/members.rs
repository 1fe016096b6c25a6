//! Candidates of a round as members of sets, each with the size that it has in machines as its prior.

use crate::infer::contest::Member;
use crate::infer::curves::Round;
use crate::infer::model::LARGEST;
use denavit_identify::effects::candidates::Candidate;
use denavit_identify::effects::catalogue::Kind;
use std::ops::Range;

/// Largest step of a part that slips or is set up again, rad or m: an unnoticed turn of a joint by a radian is implausible.
const FARTHEST: f64 = 0.05;

/// The candidates of a round as members of sets, with their prior odds.
pub(super) fn members(round: &Round, candidates: &[Candidate], log_odds: impl Fn(&Candidate) -> f64) -> Vec<Member> {
    let of = |(candidate, columns): (&Candidate, &Range<usize>)| Member {
        columns: columns.clone(),
        log_odds: log_odds(candidate),
        least_precision: least_precision(candidate),
    };
    candidates.iter().zip(&round.candidates).map(of).collect()
}

/// Smallest prior precision, from the size of such causes in machines; 0 if nothing is known.
fn least_precision(candidate: &Candidate) -> f64 {
    match candidate.term.kind {
        Kind::TransmissionError | Kind::AxisWobble | Kind::LocalJointError | Kind::Backlash | Kind::TargetIncidence => {
            LARGEST.powi(-2)
        }
        Kind::Drift => FARTHEST.powi(-2),
        _ => 0.0,
    }
}
