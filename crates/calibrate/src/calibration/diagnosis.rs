//! Diagnosis of data that do not belong to the robot, or not as written: which common mistake explains them.
//!
//! ```text
//! the residual of the robot as drawn, or of its fitted geometry, is too large
//!    ─► every common mistake undone, nominal fit ─► the best, and pairs with them ─► geometric fit ─► certain
//!            certain and harmless: continue with it, and say so first;  certain: named, refused
//!    ─► rows that fit together without the others ─► named, refused;  nothing explains it: refused
//! ```
//! A mistake is certain if undoing it makes the error of the robot *as drawn* at least [`NOMINAL_ORDER`] times smaller, and small
//! compared with the robot, or the error of the fitted geometry at least [`ORDER`] times smaller. The first criterion does not depend on
//! the number of rows: with few rows, the fitted geometry has so much freedom that it hides the mistake, but the robot as drawn has none.
//! Correct data are not diagnosed as mistaken: no other interpretation of the columns brings a robot so much closer to its drawing.

mod conventions;
pub mod explained;
pub(super) mod mistakes;
mod mixed;
mod zeros;

pub use mistakes::{Mistake, QuaternionSlip};

use self::explained::{Explained, explained};

use denavit_identify::initial_guess::nominal_fit;
use denavit_identify::parameters::NoEffects;
use denavit_identify::solve::{Fit, FitOptions};
use denavit_identify::{Identification, IdentifyOptions, identify};
use denavit_measurements::{Measurements, Scene};
use denavit_model::Chain;
use denavit_model::nalgebra::Vector3;
use thiserror::Error;

/// The geometric fit must become this many times better for a mistake to be named.
pub const ORDER: f64 = 10.0;
/// Or the nominal fit this many times, and leave no more than this share of the robot's size (or rad).
pub const NOMINAL_ORDER: f64 = 8.0;
const LIKE_THE_DRAWING: f64 = 0.02;
/// And the nominal one this many times, to be tested further.
const PROMISING: f64 = 2.0;
/// Error of the robot as drawn, as a share of its size (or rad), above which mistakes are tried, whatever the fitted geometry's error.
const NOMINAL_SUSPICIOUS: f64 = 0.01;
/// Numbers, beyond those that place the robot, needed for a certain mistake.
const CERTAIN_FROM: usize = 12;
/// The simplest of equally good mistakes is taken; it is uncertain if another one is worse by no more than this.
const ALIKE: f64 = 1.02;
const RIVAL: f64 = 2.0;
/// Smallest spread of the positions, as a share of the robot's size, for a search for two zeros.
const VARIED: f64 = 0.1;
/// Number of mistakes that are tried together with a second one.
const BEAM: usize = 6;
/// Below this share of the robot's size (or rad) a misfit is an effect or a rough robot, and no mistake is tried.
const SUSPICIOUS: f64 = 2e-3;
/// Below this share, rows of two robots of the same model are not searched for: they differ by less than tolerances.
const UNLIKE_ONE_ROBOT: f64 = 2e-4;
/// Above this share of the robot's size (or rad) geometry within tolerances cannot be the cause.
const BEYOND_GEOMETRY: f64 = 0.02;
/// Rows on which mistakes are tried, and on which the best are confirmed.
const ROWS_TO_TRY: usize = 20;
const ROWS_TO_CONFIRM: usize = 200;
/// Iterations from a start: enough to compare mistakes, not for a complete fit.
const ITERATIONS_TO_TRY: usize = 10;
/// Largest number of mistakes that are confirmed, the best ones.
const CONFIRMED: usize = 3;

/// Why data cannot be fitted.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Diagnosis {
    /// A mistake that explains the misfit.
    #[error(
        "{file}: {} They would fit to {} instead of {} if {}; {}",
        "these data do not fit this robot as they are written.",
        in_words(*after),
        in_words(*before),
        supposed(mistakes),
        fixes(mistakes)
    )]
    Mistaken {
        /// The file.
        file: String,
        /// Which: one, or several together.
        mistakes: Vec<Mistake>,
        /// Misfit as written: m and rad per component.
        before: [f64; 2],
        /// Misfit with the mistake undone.
        after: [f64; 2],
    },
    /// Some rows belong to the robot, others do not.
    #[error(
        "{file}: {} of {rows} rows fit this robot together ({}), the others do not, lines {}; are they of another robot, or \
         was the instrument moved in between? Put each part in its own file",
        rows - strangers.len(),
        in_words(*after),
        listed(strangers)
    )]
    Mixed {
        /// The file.
        file: String,
        /// Its rows.
        rows: usize,
        /// Lines of the rows that do not fit.
        strangers: Vec<usize>,
        /// Misfit of the others.
        after: [f64; 2],
    },
    /// The fitted robot explains nothing of the measured values.
    #[error(
        "{file}: the fitted robot explains nothing: the measured {of} varies by {} rms, and {} remain as residual; do the values belong \
         to these readings, row by row, is this the robot that was measured, and are all units right (‹units›)?",
        length(*spread, unit),
        length(*left, unit)
    )]
    ExplainsNothing {
        /// The file.
        file: String,
        /// `position`, `orientation` …
        of: &'static str,
        /// `m` or `rad`.
        unit: &'static str,
        /// Spread of what was measured.
        spread: f64,
        /// What is left.
        left: f64,
    },
    /// No geometry, and no likely mistake.
    #[error(
        "{file}: the robot as drawn (size {size:.3} m) differs from the measured values by {nominal:.3} m{}, wherever the instrument \
         stands; neither its geometry within tolerances nor another sense, zero, order or unit of a column explains that; is this \
         the robot that was measured, are the joints in the right columns, the readings in rad (else ‹units› deg), the lengths in m \
         (else ‹units› mm), and ‹base› and ‹tip› right?",
        turned(*orientation)
    )]
    Refused {
        /// The file.
        file: String,
        /// Per component, m.
        nominal: f64,
        /// Per component, rad; 0 unless poses are measured.
        orientation: f64,
        /// m.
        size: f64,
    },
}

/// The mistakes of a sentence that begins with "if".
fn supposed(mistakes: &[Mistake]) -> String {
    mistakes.iter().map(Mistake::to_string).collect::<Vec<_>>().join(" and ")
}

/// What to do about all of them.
fn fixes(mistakes: &[Mistake]) -> String {
    mistakes.iter().map(Mistake::fix).collect::<Vec<_>>().join("; ")
}

fn length(value: f64, unit: &str) -> String {
    format!("{:.3} {}", value * 1e3, if unit == "m" { "mm" } else { "mrad" })
}

fn in_words([position, orientation]: [f64; 2]) -> String {
    let turned = if orientation > 0.0 { format!(" and {:.3} mrad", orientation * 1e3) } else { String::new() };
    format!("within {:.3} mm{turned} per component", position * 1e3)
}

fn turned(orientation: f64) -> String {
    if orientation > 0.0 { format!(" and {orientation:.3} rad") } else { String::new() }
}

/// Lines as people write them: `3, 7, 20-59`.
fn listed(lines: &[usize]) -> String {
    let runs = lines.chunk_by(|a, b| a + 1 == *b);
    let mut shown: Vec<String> = runs
        .map(|run| {
            if run.len() > 2 {
                format!("{}-{}", run[0], run[run.len() - 1])
            } else {
                run.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")
            }
        })
        .collect();
    if shown.len() > 12 {
        let more = shown.len() - 12;
        shown.truncate(12);
        shown.push(format!("and {more} more"));
    }
    shown.join(", ")
}

/// Misfit per component, m and rad, of all rows, gross errors included.
fn misfit(fit: &Fit<NoEffects>, data: &Measurements) -> [f64; 2] {
    let most = |unit: &str| {
        let channels = data.scene.channels.iter().zip(&fit.noise.levels).filter(|(part, _)| part.unit == unit);
        channels.map(|(_, level)| *level).fold(0.0, f64::max)
    };
    [most("m"), most("rad")]
}

/// One number for both: a share of the robot's size, and rad.
fn size_of([position, orientation]: [f64; 2], chain: &Chain) -> f64 {
    position / chain.size() + orientation
}

fn spread(data: &Measurements, most: usize) -> Measurements {
    let useful: Vec<usize> = (0..data.len()).filter(|row| !data.locate[*row]).collect();
    if useful.len() <= most {
        return data.subset(&useful);
    }
    let rows: Vec<usize> = (0..most).map(|k| useful[k * (useful.len() - 1) / (most - 1)]).collect();
    data.subset(&rows)
}

/// The chain and some rows as they would be without the mistake: of `some`, or of all where the order of rows matters.
fn undone(
    mistake: &Mistake,
    chain: &Chain,
    data: &Measurements,
    some: &Measurements,
    most: usize,
) -> Option<(Chain, Measurements)> {
    if !matches!(mistake, Mistake::OutOfStep(_)) {
        return mistake.undone(chain, some);
    }
    let (chain, altered) = mistake.undone(chain, data)?;
    Some((chain, spread(&altered, most)))
}

/// How far the robot as drawn is from these rows.
fn nominal_misfit(chain: &Chain, data: &Measurements) -> [f64; 2] {
    let options = FitOptions { robust: true, most_iterations: ITERATIONS_TO_TRY, ..FitOptions::default() };
    misfit(&nominal_fit(chain, data, &vec![1.0; data.observations()], &options), data)
}

/// Rows that were interpreted in another way than written, because nothing else fits: the assumed mistakes, and their evidence.
#[derive(Debug, Clone, PartialEq)]
pub struct Corrected {
    /// What was undone.
    pub mistakes: Vec<Mistake>,
    /// Alternatives that explain these rows as well, in words.
    pub alternatives: Vec<String>,
    /// Misfit as written: m and rad per component.
    pub before: [f64; 2],
    /// Misfit with the mistakes undone.
    pub after: [f64; 2],
}

impl Corrected {
    /// These rows with the mistakes undone; a mistake that cannot be in them is skipped.
    pub fn applied(&self, chain: &Chain, data: Measurements) -> Measurements {
        self.mistakes
            .iter()
            .fold(data, |data, mistake| mistake.undone(chain, &data).map_or(data, |(_, altered)| altered))
    }

    /// In words: the assumption, and what to write.
    pub fn said(&self) -> String {
        let or = if self.alternatives.is_empty() {
            String::new()
        } else {
            format!(" (these rows are explained as well if {})", self.alternatives.join(", or if "))
        };
        format!(
            "read as if {}: they fit to {} instead of {}; {}{or}",
            supposed(&self.mistakes),
            in_words(self.after),
            in_words(self.before),
            fixes(&self.mistakes)
        )
    }
}

/// Mistakes undone together, and the error of the robot as drawn on a few rows.
#[derive(Debug, Clone)]
struct Tried {
    /// In the unit of length of the rows as written: shorter lengths have smaller errors, which explains nothing.
    score: f64,
    /// In true units.
    missed: f64,
    mistakes: Vec<Mistake>,
}

/// What all lengths are multiplied by.
fn scale_of(mistakes: &[Mistake]) -> f64 {
    let factor = |mistake: &Mistake| if let Mistake::Units { lengths, .. } = mistake { *lengths } else { 1.0 };
    mistakes.iter().map(factor).product()
}

/// Whether the data can belong to the robot: the residual is small, or no mistake explains it. Returns a mistake that is certain and
/// harmless: the rows are then read without it.
///
/// # Errors
/// The mistake that explains the misfit, or that nothing does.
pub fn judge(
    chain: &Chain,
    data: &Measurements,
    found: &Identification,
    options: &IdentifyOptions,
    other_chains: &[Chain],
) -> Result<Option<Corrected>, Diagnosis> {
    let as_written = misfit(&found.geometric, data);
    let left = size_of(as_written, chain);
    let of_spread = explained(&found.geometric, data);
    let poorly = of_spread.iter().any(Explained::poorly);
    // Zeros that explain the rows are the wanted result, however far they are from the drawing.
    let met = options.freedom.zeros_alone() && left < SUSPICIOUS;
    let drawn = if met { left } else { size_of(misfit(&found.nominal, data), chain) };
    // Written so that NaN is examined, too.
    if left < UNLIKE_ONE_ROBOT && drawn < NOMINAL_SUSPICIOUS {
        return Ok(None);
    }
    let options = &options.plain(chain);
    if left.is_nan()
        || left >= SUSPICIOUS
        || drawn.is_nan()
        || drawn >= NOMINAL_SUSPICIOUS
        || poorly && left >= UNLIKE_ONE_ROBOT
    {
        let bad = left.is_nan() || left >= 0.5 * BEYOND_GEOMETRY || drawn >= 5.0 * NOMINAL_SUSPICIOUS || poorly;
        let supposed = mistaken(chain, data, (as_written, left), options, other_chains, bad);
        if let Some((corrected, certain)) = supposed {
            if certain && corrected.mistakes.iter().all(Mistake::harmless) {
                return Ok(Some(corrected));
            }
            let Corrected { mistakes, before, after, .. } = corrected;
            return Err(Diagnosis::Mistaken { file: data.source.clone(), mistakes, before, after });
        }
    }
    if left < UNLIKE_ONE_ROBOT {
        return Ok(None);
    }
    let mixed = |strangers: Vec<usize>, after| {
        let strangers = strangers.into_iter().map(|row| data.lines[row]).collect();
        Err(Diagnosis::Mixed { file: data.source.clone(), rows: data.len(), strangers, after })
    };
    if let Some((strangers, after)) = mixed::individuals(chain, data, options, left) {
        return mixed(strangers, after);
    }
    if left < BEYOND_GEOMETRY {
        return explains_something(chain, data, &of_spread).map(|()| None);
    }
    if let Some((strangers, after)) = mixed::strangers(chain, data, options, left) {
        return mixed(strangers, after);
    }
    explains_something(chain, data, &of_spread)?;
    let [nominal, orientation] = misfit(&found.nominal, data);
    Err(Diagnosis::Refused { file: data.source.clone(), nominal, orientation, size: chain.size() })
}

/// Refuses data of which the fit explains nothing, however small the residual.
///
/// # Errors
/// A quantity varies, and is expected to, but most of its variation is not explained.
pub fn explains_something(chain: &Chain, data: &Measurements, of_spread: &[Explained]) -> Result<(), Diagnosis> {
    let size = |part: &Explained| if part.unit == "m" { chain.size() } else { 1.0 };
    match of_spread.iter().find(|part| part.nothing(size(part))) {
        None => Ok(()),
        Some(Explained { of, unit, spread, left, .. }) => {
            let file = data.source.clone();
            Err(Diagnosis::ExplainsNothing { file, of, unit, spread: *spread, left: *left })
        }
    }
}

/// Searches for a mistake in the data's notation that explains the residual, and for two together if the data are `bad`; also whether
/// nothing else explains it nearly as well.
fn mistaken(
    chain: &Chain,
    data: &Measurements,
    (as_written, left): ([f64; 2], f64),
    options: &IdentifyOptions,
    other_chains: &[Chain],
    bad: bool,
) -> Option<(Corrected, bool)> {
    let (few, many) = (spread(data, ROWS_TO_TRY), spread(data, ROWS_TO_CONFIRM));
    let search = Search { chain, data, few: &few, many: &many, as_written, left, options };
    let before = size_of(nominal_misfit(chain, &few), chain);
    let try_all = |first: &[Mistake], mistakes: Vec<Mistake>| -> Vec<Tried> {
        let with = |mistake| first.iter().cloned().chain(std::iter::once(mistake)).collect::<Vec<_>>();
        let tried = mistakes.into_iter().filter_map(|mistake| search.tried(with(mistake)));
        tried.filter(|tried| tried.score * PROMISING < before).collect()
    };
    let mut simple = mistakes::likely(chain, data, other_chains);
    simple.extend(zeros_of(chain, data, &few, false));
    simple.extend(angles_of(chain, &few));
    let singles: Vec<Tried> = simple.iter().filter_map(|mistake| search.tried(vec![mistake.clone()])).collect();
    let promising = singles.iter().filter(|tried| tried.score * PROMISING < before).cloned().collect();
    if let Some(found) = search.confirmed(promising, before) {
        return Some(found);
    }
    if !bad {
        return None;
    }
    // If little moves, two zeros can imitate many other robots.
    let varied = spread_of_positions(data) > VARIED * chain.size();
    let mut pairs = if varied { try_all(&[], zeros_of(chain, data, &few, true)) } else { Vec::new() };
    let mut beam = singles;
    beam.sort_by(|a, b| a.score.total_cmp(&b.score));
    for first in beam.into_iter().take(BEAM) {
        let [mistake] = &first.mistakes[..] else { continue };
        let Some((_, altered)) = mistake.undone(chain, &few) else { continue };
        if matches!(mistake, Mistake::OtherChain(_) | Mistake::OutOfStep(_)) {
            continue;
        }
        let mut more = zeros_of(chain, &altered, &altered, false);
        more.extend(angles_of(chain, &altered));
        let second = |other: &&Mistake| match other {
            Mistake::Sense(joints) => joints.len() == 1,
            Mistake::Coupled { .. } | Mistake::Swapped(..) | Mistake::Quaternion(_) => true,
            _ => false,
        };
        more.extend(simple.iter().filter(second).cloned());
        let apart = |other: &Mistake| {
            std::mem::discriminant(other) != std::mem::discriminant(mistake)
                && !other.joints().iter().any(|joint| mistake.joints().contains(joint))
                || matches!(other, Mistake::Zero(_))
        };
        pairs.extend(try_all(&first.mistakes, more.into_iter().filter(apart).collect()));
    }
    search.confirmed(pairs, before)
}

/// Spread of the measured positions about their mean, m; infinite where other things are measured.
fn spread_of_positions(data: &Measurements) -> f64 {
    let all = (0..data.observations()).filter_map(|at| data.series_of(at).kind.position(data.observed.values(at)));
    let places: Vec<Vector3<f64>> = all.collect();
    let mean = places.iter().sum::<Vector3<f64>>() / places.len().max(1) as f64;
    let squares: f64 = places.iter().map(|place| (place - mean).norm_squared()).sum();
    if places.is_empty() { f64::INFINITY } else { (squares / places.len() as f64).sqrt() }
}

/// Zeros as mistakes.
fn zeros_of(chain: &Chain, data: &Measurements, few: &Measurements, pairs: bool) -> Vec<Mistake> {
    let found = zeros::likely(chain, few, pairs).into_iter();
    let named =
        |zeros: zeros::Zeros| zeros.into_iter().map(|(joint, zero)| (data.joints[joint].clone(), zero)).collect();
    found.map(|zeros| Mistake::Zero(named(zeros))).collect()
}

/// Conventions of angles as mistakes.
fn angles_of(chain: &Chain, few: &Measurements) -> Vec<Mistake> {
    let found = conventions::likely(chain, few).into_iter();
    found.map(|(convention, inverse, factor)| Mistake::Angles { convention, inverse, factor }).collect()
}

/// What mistakes are tried on.
struct Search<'a> {
    chain: &'a Chain,
    data: &'a Measurements,
    few: &'a Measurements,
    many: &'a Measurements,
    as_written: [f64; 2],
    left: f64,
    options: &'a IdentifyOptions,
}

impl Search<'_> {
    /// Some rows with all these mistakes undone, one after the other.
    fn undone(&self, mistakes: &[Mistake], some: &Measurements, most: usize) -> Option<(Chain, Measurements)> {
        if let [mistake] = mistakes {
            return undone(mistake, self.chain, self.data, some, most);
        }
        let start = Some((self.chain.clone(), some.clone()));
        mistakes.iter().fold(start, |state, mistake| {
            let (chain, data) = state?;
            mistake.undone(&chain, &data)
        })
    }

    fn tried(&self, mistakes: Vec<Mistake>) -> Option<Tried> {
        let (chain, altered) = self.undone(&mistakes, self.few, ROWS_TO_TRY)?;
        let missed = size_of(nominal_misfit(&chain, &altered), &chain);
        let score = missed / scale_of(&mistakes);
        score.is_finite().then_some(Tried { score, missed, mistakes })
    }

    /// The first of the best that is certain compared with the rows as written, and whether it is compared with the others, too. `before`: the
    /// error of the robot as drawn on the few rows as written.
    fn confirmed(&self, mut promising: Vec<Tried>, before: f64) -> Option<(Corrected, bool)> {
        promising.sort_by(|a, b| a.score.total_cmp(&b.score));
        let best = promising.first().map_or(0.0, |tried| tried.score);
        // Among equals, a mistake with which the run can continue comes first; the sort is stable.
        let alike_with_best = |tried: &Tried| tried.score <= ALIKE * best;
        let harmless = |tried: &Tried| tried.mistakes.iter().all(Mistake::harmless);
        promising.sort_by_key(|tried| if alike_with_best(tried) { u8::from(!harmless(tried)) } else { 2 });
        for tried in promising.iter().take(CONFIRMED) {
            let Some((chain, altered)) = self.undone(&tried.mistakes, self.many, ROWS_TO_CONFIRM) else { continue };
            let found = identify(&chain, &altered, &self.options.plain(&chain)).geometric;
            let after = misfit(&found, &altered);
            let size = size_of(after, &chain);
            let by_geometry = size / scale_of(&tried.mistakes) * ORDER < self.left && size < BEYOND_GEOMETRY;
            let spare = altered.values() > needed_to_place(&altered.scene) + CERTAIN_FROM;
            let by_drawing = tried.score * NOMINAL_ORDER < before
                && tried.missed < LIKE_THE_DRAWING
                && spare
                && size < f64::max(2.0 * self.left, SUSPICIOUS);
            if by_geometry || by_drawing {
                let rival = promising.iter().any(|other| {
                    other.mistakes != tried.mistakes
                        && other.score < RIVAL * tried.score
                        && other.score > ALIKE * best
                        && !alike(&other.mistakes, &tried.mistakes)
                });
                let (mistakes, before) = (tried.mistakes.clone(), self.as_written);
                let same = promising.iter().filter(|other| {
                    other.mistakes != tried.mistakes
                        && alike_with_best(other)
                        && !alike(&other.mistakes, &tried.mistakes)
                });
                let alternatives = same.map(|other| supposed(&other.mistakes)).collect();
                return Some((Corrected { mistakes, alternatives, before, after }, !rival));
            }
        }
        None
    }
}

/// Whether two assumptions concern the same joints.
fn alike(one: &[Mistake], other: &[Mistake]) -> bool {
    let joints = |mistakes: &[Mistake]| -> Vec<String> {
        mistakes.iter().flat_map(Mistake::joints).map(str::to_owned).collect()
    };
    joints(one) == joints(other)
}

/// Numbers to find before any geometry: where instruments, points and targets are.
pub(super) fn needed_to_place(scene: &Scene) -> usize {
    let turns = (0..scene.targets.len()).filter(|&target| scene.turns(target)).count();
    let instruments = (0..scene.setups.len()).filter(|&setup| scene.has_instrument(setup)).count();
    let planes = (0..scene.setups.len()).filter(|&setup| scene.has_plane(setup)).count();
    let levels = (0..scene.setups.len()).filter(|&setup| scene.has_level(setup)).count();
    let places = (0..scene.targets.len()).filter(|&target| scene.places(target)).count();
    6 * instruments + 3 * (planes + scene.points.len() + places + turns) + 2 * levels
}
