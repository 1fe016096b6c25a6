//! Candidates of a round as members of sets, each expected to be as large as it is in machines.

use crate::infer::contest::Member;
use crate::infer::curves::Round;
use crate::infer::model::LARGEST;
use denavit_identify::effects::catalogue::{Candidate, Kind};
use std::ops::Range;

/// What slips or is set up anew moves by so much at most, rad or m: a joint that turned by a radian where nobody sees it is none.
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

/// Causes are expected to have the size that they have in machines; 0 where nothing is known.
fn least_precision(candidate: &Candidate) -> f64 {
    match candidate.term.kind {
        Kind::TransmissionError | Kind::AxisWobble | Kind::LocalJointError | Kind::Backlash | Kind::TargetIncidence => {
            LARGEST.powi(-2)
        }
        Kind::Drift => FARTHEST.powi(-2),
        _ => 0.0,
    }
}
