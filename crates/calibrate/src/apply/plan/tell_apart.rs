//! Poses that distinguish causes between which a run cannot decide; if there is one set of causes only, poses that reduce the variance
//! of the prediction.
//!
//! Let X be the columns of hypothesis b (geometry and frames G F, curves C, its causes A_b) in the measured rows, P their prior, and
//! M = XᵀX + P. If hypothesis a is true, a pose with the rows x raises the noncentrality d² of b's lack of fit by
//! rᵀ (I + x M⁻¹ xᵀ)⁻¹ r, where r is the difference of the predictions of a and b there, both fitted to the rows measured before
//! (T-optimality: Atkinson, Fedorov 1975). The chosen poses lower most the bound Σ √(p_a p_b) exp(-d²/8) on the probability of a
//! wrong choice (Kailath 1967), a soft minimum over the pairs of hypotheses. The reported odds are the exact expectation for normal
//! predictions (Box and Hill 1967). If no cause is uncertain, or all will be distinguished, further poses lower the mean variance of
//! the prediction over the joint range (V-optimality: Fedorov 1972).

mod design;
mod written;

use self::design::{Design, Offered, Separation};
use super::{PlanError, PlanOptions, allowed, as_predicted, candidates};
use denavit_identify::effects::driver::{RUN_ORDER, VELOCITY};
use denavit_identify::effects::history::History;
use denavit_measurements::{Covariate, Covariates, Measurements};
use denavit_model::Chain;
use denavit_trace::infer::hypotheses::{Approached, Cause, Hypotheses, Hypothesis, Open};
use serde::Serialize;

/// Largest number of joints with both sides of approach among the candidates: each doubles their number.
const MOST_SIDES: usize = 2;
/// Number of poses at which the prediction is evaluated.
const JUDGED: usize = 200;
/// Smallest expected rise of a pair's odds that counts as separated, logarithm.
const SEPARATED: f64 = 1.0;

/// A set of causes that remains possible.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Possible {
    /// The causes.
    pub causes: Vec<Cause>,
    /// Joints whose error curve, of no known cause, is part of it and not of all others.
    pub curves: Vec<String>,
    /// How probable it is now, of those in the list.
    pub probability: f64,
    /// Its logarithm.
    #[serde(skip)]
    pub log_probability: f64,
    /// Columns other than joints that its causes follow, such as temperature.
    pub follows: Vec<String>,
}

/// Two of them, and how well the poses are expected to distinguish them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pair {
    /// Their places in the list, counted from 0.
    pub of: [usize; 2],
    /// Natural logarithm of the odds of the first against the second now.
    pub log_odds: f64,
    /// Its expected value after the poses are measured, if the first is true.
    pub expected_if_first: f64,
    /// The same if the second is.
    pub expected_if_second: f64,
    /// Whether the poses distinguish them.
    pub separated: bool,
    /// What only one of the two follows and poses do not vary.
    pub vary: Vec<String>,
}

/// Uncertainty of the prediction, m: root mean square over the joint range, or over the candidates if they were given.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Unsure {
    /// Now.
    pub now: f64,
    /// As expected with the poses measured.
    pub expected: f64,
}

/// The possible causes, and what the poses are expected to show.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Prospect {
    /// Poses chosen.
    pub poses: usize,
    /// How many of them distinguish causes; the others are for the prediction.
    pub for_separation: usize,
    /// The possible sets of causes, the most probable first; one: no cause is uncertain.
    pub possible: Vec<Possible>,
    /// Every pair of them.
    pub pairs: Vec<Pair>,
    /// Uncertainty of the prediction.
    pub unsure: Unsure,
}

/// Which side a joint of a pose is to be approached from.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Approach {
    /// The joint's name.
    pub joint: String,
    /// Whether the order of the poses makes it so; else the measured rows need the column.
    pub by_order: bool,
    /// For each pose +1 from below, -1 from above.
    pub sides: Vec<f64>,
}

/// Poses to measure next.
#[derive(Debug, Clone, PartialEq)]
pub struct TellApart {
    /// Names of the coordinates.
    pub joints: Vec<String>,
    /// The poses, one value per coordinate, rad or m, in the order in which they are to be measured.
    pub poses: Vec<Vec<f64>>,
    /// Which candidate each of them is, counted from 0.
    pub candidates: Vec<usize>,
    /// Candidates that could be used.
    pub usable: usize,
    /// Whether the prediction is evaluated at given candidates instead of over the joint range.
    pub at_given: bool,
    /// Sides of approach that matter.
    pub approach: Vec<Approach>,
    /// What is open, and what is expected of the poses.
    pub prospect: Prospect,
}

/// Chooses `count` poses of the options' candidates to distinguish the possible causes of the run `data`.
///
/// # Shape and units
/// `data`: the rows that were fitted, with the columns that the fit was given.
///
/// # Errors
/// Too few candidates are left, or one has the wrong length; or what was observed last holds the target.
pub fn tell_apart(open: &Open, data: &Measurements, options: &PlanOptions) -> Result<TellApart, PlanError> {
    let arm = open.arm();
    let chain = &arm.nominal;
    let series = last_seen(data)?;
    let all = candidates(chain, options)?;
    let total = all.len();
    let usable: Vec<usize> = (0..total).filter(|&index| allowed(chain, arm, &all[index], options)).collect();
    let sides = Sides::offered(&open.approached(), chain);
    let wanted = judged(chain, options, &usable.iter().map(|&index| &all[index]).collect::<Vec<_>>())?;
    let each = usable.iter().flat_map(|&index| (0..sides.ways()).map(move |way| (index, way)));
    let each: Vec<(usize, usize)> = each.collect();
    let poses = each.iter().map(|(index, _)| &all[*index]).chain(&wanted);
    let nothing_yet = Measurements::empty("candidates", data.joints.clone(), data.scene.clone());
    let mut rows = as_predicted(arm, nothing_yet, &series, poses);
    let number: Vec<usize> = rows.lines.iter().map(|line| line - 1).collect();
    let seen = number.iter().take_while(|number| **number < each.len()).count();
    let way = |row: usize| each.get(number[row]).map(|(_, way)| *way);
    rows.covariates = recorded(data, rows.len(), |column, row| way(row).and_then(|way| sides.value(column, way)));
    let visible = seen / sides.ways();
    if visible < options.count || options.count == 0 {
        return Err(PlanError::TooFewCandidates { wanted: options.count, left: visible, candidates: total });
    }
    let hypotheses = open.hypotheses(&rows).ok_or(PlanError::Degenerate)?;
    let mut design = Design::new(Offered::of(&hypotheses, seen, series.len()));
    design.choose(options.count);
    let separations = design.separations();
    let [now, expected] = design.unsure(&separations);
    let mut chosen: Vec<(usize, usize)> = design.chosen.iter().map(|&row| each[number[row]]).collect();
    sides.in_order(&mut chosen, &all);
    let name = |coordinate: usize| chain.coordinates()[coordinate].name.clone();
    let approach = sides.list.iter().enumerate().map(|(index, offer)| Approach {
        joint: name(offer.coordinate),
        by_order: offer.approached.by_order,
        sides: chosen.iter().map(|(_, way)| Sides::side(index, *way)).collect(),
    });
    let possible = possible(&hypotheses, chain);
    let pairs = pairs(&possible, &separations);
    Ok(TellApart {
        joints: chain.coordinates().iter().map(|coordinate| coordinate.name.clone()).collect(),
        approach: approach.collect(),
        poses: chosen.iter().map(|(index, _)| all[*index].clone()).collect(),
        candidates: chosen.iter().map(|(index, _)| *index).collect(),
        usable: visible,
        at_given: options.candidates.is_some(),
        prospect: Prospect {
            poses: chosen.len(),
            for_separation: design.for_separation,
            possible,
            pairs,
            unsure: Unsure { now, expected },
        },
    })
}

/// Poses at which the prediction is evaluated: some of the candidates if they were given, else spread over the joint limits.
fn judged(chain: &Chain, options: &PlanOptions, given: &[&Vec<f64>]) -> Result<Vec<Vec<f64>>, PlanError> {
    if options.candidates.is_some() {
        return Ok(given.iter().step_by(given.len().div_ceil(JUDGED).max(1)).map(|pose| (*pose).clone()).collect());
    }
    let anywhere =
        PlanOptions { allowed: None, spread: JUDGED.min(options.spread), seed: !options.seed % 997, ..options.clone() };
    candidates(chain, &anywhere)
}

/// The observations in the last row that determine more than the place of a target.
fn last_seen(data: &Measurements) -> Result<Vec<usize>, PlanError> {
    let last = (0..data.len()).rev().find(|&row| !data.locate[row]);
    let series: Vec<usize> = last
        .map_or_else(Vec::new, |row| data.of_row(row).map(|observation| data.observed.series(observation)).collect());
    let held = series.iter().map(|&series| data.scene.series[series].kind).find(|kind| kind.holds_the_target());
    held.map_or(Ok(series), |kind| Err(PlanError::InContact(kind)))
}

/// The columns of future rows: values of `value`, else those of the last row; run order continues.
fn recorded(data: &Measurements, rows: usize, value: impl Fn(&str, usize) -> Option<f64>) -> Covariates {
    let columns = data.covariates.iter().map(|column| {
        let last = column.values.last().copied().unwrap_or(0.0);
        let usual = if column.name == RUN_ORDER { last + 1.0 } else { last };
        let values = (0..rows).map(|row| value(&column.name, row).unwrap_or(usual)).collect();
        Covariate { name: column.name.clone(), values }
    });
    columns.collect::<Vec<_>>().into()
}

/// A joint that is offered from both sides.
struct Offer {
    /// What it is the side of.
    approached: Approached,
    coordinate: usize,
}

/// From which sides candidates are offered.
struct Sides {
    list: Vec<Offer>,
}

impl Sides {
    /// Where the order of the rows makes the sides, only one joint's can be chosen.
    fn offered(approached: &[Approached], chain: &Chain) -> Self {
        let mut list: Vec<Offer> = Vec::new();
        for joint in approached {
            let ordered = list.iter().any(|other| other.approached.by_order);
            if list.len() < MOST_SIDES && !(ordered && joint.by_order) {
                let coordinate = chain.joints()[joint.joint].coordinate;
                list.push(Offer { approached: joint.clone(), coordinate });
            }
        }
        Self { list }
    }

    /// In how many ways each candidate is offered.
    fn ways(&self) -> usize {
        1 << self.list.len()
    }

    /// Value of a column that records a side: +1 from below, -1 from above, fully wound up.
    fn value(&self, column: &str, way: usize) -> Option<f64> {
        let tells = |offer: &Offer| offer.approached.columns.iter().any(|own| own == column);
        Some(Self::side(self.list.iter().position(tells)?, way))
    }

    /// The side of the joint offered at this place of the list.
    fn side(index: usize, way: usize) -> f64 {
        if way >> index & 1 == 0 { 1.0 } else { -1.0 }
    }

    /// Puts poses in an order in which the joint whose side the order tells comes from the sides chosen: first those from
    /// below, rising, then those from above, falling.
    fn in_order(&self, chosen: &mut [(usize, usize)], poses: &[Vec<f64>]) {
        let Some(index) = self.list.iter().position(|offer| offer.approached.by_order) else {
            chosen.sort_unstable();
            return;
        };
        let coordinate = self.list[index].coordinate;
        let key = |(pose, way): &(usize, usize)| {
            let reading = poses[*pose][coordinate];
            if way >> index & 1 == 0 { (0, reading) } else { (1, -reading) }
        };
        chosen.sort_by(|a, b| {
            let (a, b) = (key(a), key(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
    }
}

fn possible(hypotheses: &Hypotheses, chain: &Chain) -> Vec<Possible> {
    let of = |hypothesis: &Hypothesis| {
        let shared = |joint: &&usize| hypotheses.list.iter().all(|other| other.curves.contains(joint));
        let own = hypothesis.curves.iter().filter(|joint| !shared(joint));
        let columns = hypothesis.terms.iter().flat_map(|term| term.driver.columns());
        let mut follows: Vec<String> = columns.map(|column| column.name().to_owned()).collect();
        follows.sort();
        follows.dedup();
        Possible {
            causes: hypothesis.causes.clone(),
            curves: own.map(|joint| chain.joints()[*joint].name.clone()).collect(),
            probability: hypothesis.probability,
            log_probability: hypothesis.log_probability,
            follows,
        }
    };
    hypotheses.list.iter().map(of).collect()
}

fn pairs(possible: &[Possible], separations: &[Separation]) -> Vec<Pair> {
    let mut pairs = Vec::new();
    for a in 0..possible.len() {
        for b in a + 1..possible.len() {
            let rise = |a: usize, b: usize| {
                separations.iter().find(|one| (one.true_one, one.other) == (a, b)).map_or(0.0, |one| one.rise)
            };
            let log_odds = possible[a].log_probability - possible[b].log_probability;
            let of_the_way = |name: &str| History::of_column(name).is_some_and(|(_, history)| history.is_of_the_way());
            let only = |one: usize, other: usize| {
                let own = possible[one].follows.iter().filter(move |name| !possible[other].follows.contains(name));
                own.filter(|name| !of_the_way(name)).map(|name| words(name))
            };
            let mut vary: Vec<String> = only(a, b).chain(only(b, a)).collect();
            vary.dedup();
            pairs.push(Pair {
                of: [a, b],
                log_odds,
                expected_if_first: log_odds + rise(a, b),
                expected_if_second: log_odds - rise(b, a),
                separated: rise(a, b).min(rise(b, a)) > SEPARATED,
                vary,
            });
        }
    }
    pairs
}

/// A recorded quantity in words.
fn words(column: &str) -> String {
    if column == RUN_ORDER {
        return "the time between rows".into();
    }
    if let Some((joint, History::Warmth { .. })) = History::of_column(column) {
        return format!("how much {joint} moves before it is measured");
    }
    match column.strip_suffix(VELOCITY) {
        Some(joint) => format!("the velocity of {joint}"),
        None => column.replace('_', " "),
    }
}
