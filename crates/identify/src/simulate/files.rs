//! Simulated measurement files: rows to fit, rows of the same robot measured later, and the truth.

use super::columns::{NoColumn, columns};
use super::effect_specification::{EffectSpecification, EffectSpecificationError, specified_effects};
use super::two_tips::TwoTips;
use super::{
    Simulation, SimulationOptions, as_displayed, commanded_readings, scene, simulate, simulate_arm, truth, two_tips,
};
use crate::effects::driver::Statics;
use crate::effects::survey::with_run_order;
use crate::effects::{EffectModel, SavedEffects, recorded};
use crate::parameters::NoEffects;
use denavit_measurements::kinds::ObservationKind;
use denavit_measurements::{Measurements, MissingColumn, word_of_two_tips, write};
use denavit_model::Chain;
use thiserror::Error;

/// The test has its own seed.
const TEST_SEED: u64 = 0x7465_7374;

/// The requested files.
#[derive(Debug, Clone, PartialEq)]
pub struct FilesAsked {
    /// Robot, instrument and noise; recorded columns are in `columns`.
    pub options: SimulationOptions,
    /// Effects by name, place and strength, in addition to those of `effects`.
    pub specifications: Vec<EffectSpecification>,
    /// Names of recorded columns: time, temperature, payload, …
    pub columns: Vec<String>,
    /// Rows of the test, if there is one.
    pub test_rows: Option<usize>,
    /// Whether to write the truth; for a chain of many joints that takes long.
    pub truth: bool,
}

/// Files of a simulated run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Files {
    /// Rows to fit, CSV.
    pub data: String,
    /// Rows of the same robot, measured after the others, CSV.
    pub test: Option<String>,
    /// The truth, JSON, if requested.
    pub truth: Option<String>,
}

/// Why there are no files.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum FilesError {
    /// An unknown column.
    #[error(transparent)]
    Column(#[from] NoColumn),
    /// An invalid effect.
    #[error(transparent)]
    Effect(#[from] EffectSpecificationError),
    /// Several targets for a kind with one.
    #[error("only positions can have several targets")]
    Targets(usize),
    /// A camera that does not see its board often enough.
    #[error(
        "the camera sees its board in only {found} of {wanted} rows; choose a smaller board, a wider lens or fewer rows"
    )]
    OutOfSight {
        /// Rows that see it.
        found: usize,
        /// Rows requested.
        wanted: usize,
    },
    /// Effects with a kind that has no readings.
    #[error("effects are not simulated with {0}; simulate a dial gauge, whose readings show them")]
    EffectsInContact(&'static str),
    /// A kind for two tips, of a robot with another number of tips.
    #[error("{0} need two tips of one robot; name both (‹tip› LINK ‹tip› LINK)")]
    NotTwoTips(&'static str),
    /// Columns with a kind for two tips.
    #[error("no other columns are simulated with {0}")]
    ColumnsOfTwoTips(&'static str),
    /// Tips that do not reach each other.
    #[error("the tips meet in only {found} of {wanted} rows; simulate fewer, or try another seed")]
    TipsOutOfReach {
        /// Rows in which they do.
        found: usize,
        /// Rows requested.
        wanted: usize,
    },
    /// A kind for one tip.
    #[error("{0} are simulated at one tip only; simulate one tip at a time, or measure poses, positions or distances")]
    KindOfSeveralTips(&'static str),
    /// Postures that do not reach their planes.
    #[error("the arm reaches its planes in only {found} of {wanted} rows; simulate fewer, or try another seed")]
    OutOfReach {
        /// Rows that touch one.
        found: usize,
        /// Rows requested.
        wanted: usize,
    },
    /// An effect depends on a quantity that some rows lack.
    #[error(transparent)]
    Missing(#[from] MissingColumn),
    /// An effect depends on a quantity that is not recorded.
    #[error("{kind} depends on \"{column}\"; record it with ‹columns› \"{column}\"")]
    NotRecorded {
        /// Of the effect.
        kind: &'static str,
        /// The quantity.
        column: String,
    },
}

/// Simulate a run and write its files.
///
/// # Errors
/// An invalid column or effect, or several targets for a kind with one.
pub fn files(chain: &Chain, statics: &Statics, effects: SavedEffects, asked: &FilesAsked) -> Result<Files, FilesError> {
    let mut options = asked.options.clone();
    if options.targets > 1 && !options.kind.of_several() {
        return Err(FilesError::Targets(options.targets));
    }
    if let Some(word) = word_of_two_tips(options.kind) {
        if any_effect(asked, &effects) {
            return Err(FilesError::EffectsInContact(options.kind.plural()));
        }
        return of_two_tips(chain, statics, asked, word);
    }
    let contact = options.kind.holds_the_target();
    if contact && options.kind.numbers() == 0 && any_effect(asked, &effects) {
        return Err(FilesError::EffectsInContact(options.kind.plural()));
    }
    if options.tips.is_some() && (contact || options.kind.of_a_board()) {
        return Err(FilesError::KindOfSeveralTips(options.kind.plural()));
    }
    options.covariates = columns(&asked.columns, chain, options.rows, 0, options.seed)?;
    for effect in &effects.effects {
        for column in effect.term.driver.columns() {
            if !recorded::given_by_run(column, &options.covariates) {
                return Err(FilesError::NotRecorded { kind: effect.term.kind.name(), column: column.clone() });
            }
        }
    }
    // Random draws do not depend on the effects: the strengths are those on the written rows.
    let bare = simulate(chain, &options, &NoEffects);
    let recorded = with_run_order(bare.data.clone());
    let mut model = effects.bound(&|name| recorded.column(name))?;
    model.effects.effects.extend(specified_effects(&asked.specifications, statics, &bare, options.seed)?.effects);
    let run = simulate(chain, &options, &model);
    let enough = |found: usize, wanted: usize| match contact {
        _ if found >= wanted => Ok(()),
        true => Err(FilesError::OutOfReach { found, wanted }),
        false => Err(FilesError::OutOfSight { found, wanted }),
    };
    enough(run.data.len(), options.rows)?;
    let comments = |rows: usize, kind: ObservationKind| {
        vec![format!("{}: {rows} simulated {}, m and rad; made by denavit simulate", chain.name(), kind.plural())]
    };
    let data = write(&as_displayed(&run.data, &options), &comments(options.rows, options.kind));
    let later = |rows: usize| {
        let seed = options.seed ^ TEST_SEED;
        let later = SimulationOptions {
            rows,
            seed,
            readings: Some(commanded_readings(chain, rows * options.tries(), seed)),
            before: Some(with_run_order(run.data.clone())),
            covariates: columns(&asked.columns, chain, rows, options.rows, seed)?,
            ..options.clone()
        };
        let test = simulate_arm(&run.arm, &later, &model);
        enough(test.data.len(), rows)?;
        Ok::<_, FilesError>(write(&as_displayed(&test.data, &later), &comments(rows, options.kind)))
    };
    let test = asked.test_rows.map(later).transpose()?;
    Ok(Files { data, test, truth: asked.truth.then(|| truth::to_json(&run, &options, &model)) })
}

fn any_effect(asked: &FilesAsked, effects: &SavedEffects) -> bool {
    !asked.specifications.is_empty() || !effects.effects.is_empty()
}

/// Files of a run in which two tips touch each other or hold a tool; `word` names their column.
fn of_two_tips(chain: &Chain, statics: &Statics, asked: &FilesAsked, word: &'static str) -> Result<Files, FilesError> {
    let options = &asked.options;
    let (words, label) = if options.kind == ObservationKind::Grip { ("grips", "tool") } else { ("contacts", "pins") };
    if options.tips.as_ref().is_none_or(|tips| tips.all().len() != 2) {
        return Err(FilesError::NotTwoTips(words));
    }
    if !asked.columns.is_empty() {
        return Err(FilesError::ColumnsOfTwoTips(words));
    }
    let file = |run: &TwoTips, wanted: usize| {
        let found = run.readings.len();
        if found < wanted {
            return Err(FilesError::TipsOutOfReach { found, wanted });
        }
        let comment = format!("{}: {wanted} simulated {words}, m and rad; made by denavit simulate", chain.name());
        Ok(two_tips::write(run, word, label, &[comment]))
    };
    let run = two_tips::simulate(chain, options);
    let data = file(&run, options.rows)?;
    let later = |rows: usize| {
        let seed = options.seed ^ TEST_SEED;
        file(&run.again(&SimulationOptions { rows, seed, readings: None, ..options.clone() }), rows)
    };
    let test = asked.test_rows.map(later).transpose()?;
    let truth = asked.truth.then(|| {
        let joints = chain.coordinates().iter().map(|coordinate| coordinate.name.clone()).collect();
        let data = Measurements::empty("simulation", joints, scene(options, 1));
        let run = Simulation { arm: run.arm.clone(), data, outliers: run.outliers.clone() };
        truth::to_json(&run, options, &EffectModel::new(statics.clone(), Vec::new()).into())
    });
    Ok(Files { data, test, truth })
}
