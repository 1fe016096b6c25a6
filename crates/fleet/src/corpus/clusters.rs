//! Files of one mechanism, and similar mechanisms.

use super::{CorpusFile, CorpusOptions, Near, in_parallel};
use crate::error::FleetError;
use denavit_compare::{Options, Scope, Verdict, compare};
use std::collections::{BTreeMap, HashMap};

/// Number of samples for the tips of two mechanisms; low, because many pairs are compared.
const SAMPLES: usize = 64;

/// Disjoint sets (union-find).
struct Joined(Vec<usize>);

impl Joined {
    fn of(count: usize) -> Self {
        Self((0..count).collect())
    }

    fn root(&mut self, mut at: usize) -> usize {
        while self.0[at] != at {
            self.0[at] = self.0[self.0[at]];
            at = self.0[at];
        }
        at
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        // The first one represents all, so the order of the files is that of the sets.
        self.0[a.max(b)] = a.min(b);
    }

    fn sets(mut self, members: impl Iterator<Item = usize>) -> Vec<Vec<usize>> {
        let mut sets: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for member in members {
            let root = self.root(member);
            sets.entry(root).or_default().push(member);
        }
        sets.into_values().collect()
    }
}

/// Files with matching motion fingerprints, the largest set first; without files that are not robots or do not move.
pub(super) fn mechanisms(files: &[CorpusFile]) -> Vec<Vec<usize>> {
    let mut joined = Joined::of(files.len());
    let mut first: HashMap<&str, usize> = HashMap::new();
    for (index, file) in files.iter().enumerate().filter(|(_, file)| file.joints > 0) {
        for motion in std::iter::once(&file.motion).chain(&file.other_motions) {
            let other = *first.entry(motion).or_insert(index);
            joined.join(index, other);
        }
    }
    let moving = (0..files.len()).filter(|index| files[*index].joints > 0);
    let mut sets = joined.sets(moving);
    sets.sort_by_key(|set| (usize::MAX - set.len(), set[0]));
    sets
}

/// Mechanisms whose axes and tips differ by no more than the tolerance.
///
/// Only mechanisms with the same number of joints, the same kinds in their longest chain, and similar size are compared.
pub(super) fn near(
    files: &[CorpusFile],
    mechanisms: &[Vec<usize>],
    options: &CorpusOptions,
) -> Result<Vec<Near>, FleetError> {
    if options.near <= 0.0 {
        return Ok(Vec::new());
    }
    let of = |mechanism: usize| &files[mechanisms[mechanism][0]];
    let mut groups: BTreeMap<(usize, &str), Vec<usize>> = BTreeMap::new();
    for mechanism in (0..mechanisms.len()).filter(|mechanism| !of(*mechanism).chain.is_empty()) {
        groups.entry((of(mechanism).joints, of(mechanism).chain.as_str())).or_default().push(mechanism);
    }
    let mut pairs = Vec::new();
    for group in groups.values_mut() {
        group.sort_by(|a, b| of(*a).size_m.total_cmp(&of(*b).size_m));
        for (index, &a) in group.iter().enumerate() {
            // Each joint may be off at both of its ends, and a turn moves the far end by the arm's length.
            let slack = options.near * (2.0 * (of(a).joints as f64 + 1.0) + of(a).size_m);
            let close = group[index + 1..].iter().take_while(|b| of(**b).size_m - of(a).size_m <= slack);
            pairs.extend(close.map(|b| (a, *b)));
        }
    }
    let apart = in_parallel(&pairs, options.threads, |(a, b)| apart(&of(*a).file, &of(*b).file, options.near));
    let mut joined = Joined::of(mechanisms.len());
    let apart = apart.into_iter().collect::<Result<Vec<_>, FleetError>>()?;
    let near: Vec<(usize, usize, f64)> =
        pairs.iter().zip(apart).filter_map(|(&(a, b), apart)| Some((a, b, apart?))).collect();
    for (a, b, _) in &near {
        joined.join(*a, *b);
    }
    let sets = joined.sets(0..mechanisms.len()).into_iter().filter(|set| set.len() > 1);
    let widest =
        |set: &[usize]| near.iter().filter(|(a, _, _)| set.contains(a)).map(|(_, _, apart)| *apart).fold(0.0, f64::max);
    Ok(sets.map(|set| Near { tips_apart_m: widest(&set), mechanisms: set }).collect())
}

/// Upper bound of the tip distance of two robots, if they are the same within a tolerance.
///
/// # Errors
/// A file that was a robot before cannot be read any more.
fn apart(a: &str, b: &str, tolerance: f64) -> Result<Option<f64>, FleetError> {
    let load = |name: &str| denavit_load::load(name, &denavit_load::Options::default());
    let (one, other) = (load(a)?.robot, load(b)?.robot);
    let options = Options {
        tolerance_m: tolerance,
        tolerance_rad: tolerance,
        scope: Scope::Kinematics,
        up_to_base: true,
        samples: SAMPLES,
        ..Options::default()
    };
    let Ok(found) = compare(&one.subject(a), &other.subject(b), &options) else { return Ok(None) };
    let tips = found.tips.iter().map(|tip| tip.sampled_m).fold(0.0, f64::max);
    Ok((found.verdict == Verdict::Same).then_some(tips))
}
