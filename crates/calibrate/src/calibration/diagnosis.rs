//! Data that do not belong to the robot, or not as they are written: which likely mistake would explain them.
//!
//! ```text
//! geometric fit leaves too much ─► every likely mistake undone, nominal fit ─► the best, geometric fit ─► named
//!                                  └─► rows that fit together without the others ─► named          or refused
//! ```
//! A mistake is named when undoing it makes the misfit of the fitted geometry at least [`ORDER`] times smaller. Real data
//! that are right never are: what a robot's geometry leaves is not a tenth of itself under another reading of the columns.

mod mistakes;
mod mixed;

pub use mistakes::{Mistake, QuaternionSlip};

use crate::identify::initial_guess::nominal_fit;
use crate::identify::solve::{Fit, FitOptions};
use crate::identify::{Identification, IdentifyOptions, identify};
use crate::observation::measurements::Measurements;
use crate::observation::parameters::NoEffects;
use denavit_model::Chain;
use thiserror::Error;

/// The geometric fit must become so many times better for a mistake to be named.
pub const ORDER: f64 = 10.0;
/// And the nominal one so many times, to be looked at.
const PROMISING: f64 = 2.0;
/// Below this share of the robot's size (or rad) a misfit is an effect or a rough robot, and no mistake is tried.
const SUSPICIOUS: f64 = 2e-3;
/// Below this share not even rows of two individuals of one robot are looked for: they differ by less than links are made to.
const UNLIKE_ONE_ROBOT: f64 = 2e-4;
/// Above this share of the robot's size (or rad) no geometry within its tolerances is to blame.
const BEYOND_GEOMETRY: f64 = 0.02;
/// Rows on which mistakes are tried, and on which the best are confirmed.
const ROWS_TO_TRY: usize = 20;
const ROWS_TO_CONFIRM: usize = 200;
/// Iterations after a start: enough to see which mistake's rows fit, not to fit them.
const ITERATIONS_TO_TRY: usize = 10;
/// The best mistakes are confirmed, no more than these.
const CONFIRMED: usize = 3;

/// Why data cannot be fitted.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Diagnosis {
    /// A mistake that explains the misfit.
    #[error(
        "{file}: {} What was measured would be met {} instead of {} if {mistake}; {}",
        "these data do not fit this robot as they are written.",
        in_words(*after),
        in_words(*before),
        mistake.mend()
    )]
    Mistaken {
        /// The file.
        file: String,
        /// Which.
        mistake: Mistake,
        /// Misfit as written: m and rad per component.
        before: [f64; 2],
        /// Misfit with the mistake undone.
        after: [f64; 2],
    },
    /// Some rows belong to the robot, others do not.
    #[error(
        "{file}: {} of {rows} rows fit this robot together ({}), the others do not, lines {}; are they of another robot, or \
         was the instrument moved in between? Give each its own file",
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
    /// No geometry, and no likely mistake.
    #[error(
        "{file}: the robot as drawn misses what was measured by {nominal:.3} m{}, wherever the instrument stands (its size is \
         {size:.3} m), and no change of its geometry within tolerances mends that, nor another sense, order or unit of a \
         column; is this the robot that was measured, are the joints in the right columns, the readings in rad (else ‹units› \
         deg), the lengths in m (else ‹units› mm), and ‹base› and ‹tip› right?",
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

/// Misfit per component, m and rad, of the rows as they are: gross ones are not left out here.
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

/// Whether the data can belong to the robot: what the geometric fit leaves is small, or no mistake explains it.
///
/// # Errors
/// The mistake that explains the misfit, or that nothing does.
pub fn judge(
    chain: &Chain,
    data: &Measurements,
    found: &Identification,
    options: &IdentifyOptions,
    other_chains: &[Chain],
) -> Result<(), Diagnosis> {
    let as_written = misfit(&found.geometric, data);
    let left = size_of(as_written, chain);
    // Written so that what is not a number is looked into.
    if left < UNLIKE_ONE_ROBOT {
        return Ok(());
    }
    let options = &options.plain(chain);
    if left >= SUSPICIOUS {
        mistaken(chain, data, (as_written, left), options, other_chains)?;
    }
    let mixed = |strangers: Vec<usize>, after| {
        let strangers = strangers.into_iter().map(|row| data.lines[row]).collect();
        Err(Diagnosis::Mixed { file: data.source.clone(), rows: data.len(), strangers, after })
    };
    if let Some((strangers, after)) = mixed::individuals(chain, data, options, left) {
        return mixed(strangers, after);
    }
    if left < BEYOND_GEOMETRY {
        return Ok(());
    }
    if let Some((strangers, after)) = mixed::strangers(chain, data, options, left) {
        return mixed(strangers, after);
    }
    let [nominal, orientation] = misfit(&found.nominal, data);
    Err(Diagnosis::Refused { file: data.source.clone(), nominal, orientation, size: chain.size() })
}

/// Looks for a mistake in how the data are written that explains what is left.
fn mistaken(
    chain: &Chain,
    data: &Measurements,
    (as_written, left): ([f64; 2], f64),
    options: &IdentifyOptions,
    other_chains: &[Chain],
) -> Result<(), Diagnosis> {
    let few = spread(data, ROWS_TO_TRY);
    let many = spread(data, ROWS_TO_CONFIRM);
    let before = size_of(nominal_misfit(chain, &few), chain);
    let mut promising: Vec<(f64, Mistake)> = Vec::new();
    for mistake in mistakes::likely(chain, data, other_chains) {
        let Some((other, altered)) = undone(&mistake, chain, data, &few, ROWS_TO_TRY) else { continue };
        let score = size_of(nominal_misfit(&other, &altered), &other);
        if score * PROMISING < before {
            promising.push((score, mistake));
        }
    }
    promising.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (_, mistake) in promising.into_iter().take(CONFIRMED) {
        let Some((other, altered)) = undone(&mistake, chain, data, &many, ROWS_TO_CONFIRM) else { continue };
        let after = misfit(&identify(&other, &altered, &options.plain(&other)).geometric, &altered);
        if size_of(after, &other) * ORDER < left {
            return Err(Diagnosis::Mistaken { file: data.source.clone(), mistake, before: as_written, after });
        }
    }
    Ok(())
}
