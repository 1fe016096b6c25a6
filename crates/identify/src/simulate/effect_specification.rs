//! Effects by name, place and strength: `KIND@PLACE[:KEY=VALUE,…]=STRENGTH`, such as
//! `joint_compliance@elbow_joint=0.3mm` or `transmission_error@wrist_1_joint:order=3=2e-4`.

use crate::arm::Arm;
use crate::effects::candidates::{Candidate, candidates};
use crate::effects::catalogue::{KINDS, Kind};
use crate::effects::driver::{BumpShape, Driver, Statics};
use crate::effects::history::History;
use crate::effects::model::{Coupling, Effect, EffectModel, Term};
use crate::effects::survey::{Survey, with_run_order};
use crate::parameters::NoEffects;
use crate::residual_statistics::residuals;
use crate::simulate::Simulation;
use denavit_measurements::{Column, Measurements};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use std::str::FromStr;
use thiserror::Error;

/// Required strength of an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Strength {
    /// Root mean square motion of the measured values over the rows, m (see [`specified_effects`]).
    Moves(f64),
    /// Its coefficient, SI; for several of one unit the norm of their vector.
    Coefficient(f64),
}

/// A requested effect.
#[derive(Debug, Clone, PartialEq)]
pub struct EffectSpecification {
    /// As written.
    text: String,
    /// Its kind.
    pub kind: Kind,
    /// Where: a joint, `base`, `links`, `target`, `anchor`, `instrument`, `wire zero` or `all joints`.
    pub place: String,
    /// Parameters of the kind: order, at, width, knee, friction, with, step, over.
    settings: Vec<(String, String)>,
    /// How strong.
    pub strength: Strength,
}

/// Why a specified effect cannot be simulated.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("\"{specification}\": {why}")]
pub struct EffectSpecificationError {
    /// As written.
    specification: String,
    /// What is wrong, and the fix.
    why: String,
}

impl FromStr for EffectSpecification {
    type Err = EffectSpecificationError;

    fn from_str(text: &str) -> Result<Self, EffectSpecificationError> {
        let wrong = |why: String| EffectSpecificationError { specification: text.into(), why };
        let form = || wrong("write KIND@PLACE=STRENGTH, such as joint_compliance@elbow_joint=0.3mm".into());
        let (what, strength) = text.rsplit_once('=').ok_or_else(form)?;
        let (kind, place) = what.split_once('@').ok_or_else(form)?;
        let kind = Kind::named(kind.trim()).ok_or_else(|| {
            let names: Vec<&str> = KINDS.iter().map(|entry| entry.name).collect();
            wrong(format!("\"{kind}\" is not a kind of effect; there are {}", names.join(", ")))
        })?;
        let (place, settings) = place.split_once(':').unwrap_or((place, ""));
        let settings = settings.split(',').filter(|word| !word.trim().is_empty()).map(|word| {
            let (key, value) = word.split_once('=').ok_or_else(form)?;
            Ok((key.trim().to_owned(), value.trim().to_owned()))
        });
        let settings = settings.collect::<Result<_, EffectSpecificationError>>()?;
        let units = [("mm", 1e-3), ("um", 1e-6), ("µm", 1e-6), ("m", 1.0)];
        let strength = strength.trim();
        let length = units.iter().find_map(|(unit, factor)| Some((strength.strip_suffix(unit)?, factor)));
        let number = |text: &str| text.trim().parse::<f64>().ok().filter(|number| number.is_finite() && *number != 0.0);
        let parsed = match length {
            Some((number_text, factor)) => {
                number(number_text).filter(|number| *number > 0.0).map(|n| Strength::Moves(n * factor))
            }
            None => number(strength).map(Strength::Coefficient),
        };
        let strength = parsed.ok_or_else(|| {
            wrong(format!(
                "\"{strength}\" is not a strength; write how far the effect moves the measured values, such as 0.3mm, or \
                 its coefficient in SI units"
            ))
        })?;
        Ok(Self { text: text.into(), kind, place: place.trim().into(), settings, strength })
    }
}

impl EffectSpecification {
    fn wrong(&self, why: String) -> EffectSpecificationError {
        EffectSpecificationError { specification: self.text.clone(), why }
    }

    /// The term of the specification on these data: the catalogue's first of this kind at this place, with its open
    /// numbers set.
    fn term(&self, survey: &Survey) -> Result<Term, EffectSpecificationError> {
        let chain = &survey.statics.chain;
        let all: Vec<Candidate> = candidates(self.kind, survey);
        let mut places: Vec<String> = Vec::new();
        for candidate in &all {
            let place = candidate.term.carrier.place(chain);
            if !places.contains(&place) {
                places.push(place);
            }
        }
        let name = self.kind.name();
        if places.is_empty() {
            let column = match self.kind {
                Kind::Thermal => "temperature",
                Kind::Tilt => "tilt",
                Kind::Latency => "velocity",
                _ => "time",
            };
            return Err(self.wrong(format!("{name} depends on a recorded quantity; add ‹columns› {column}")));
        }
        let here = all.into_iter().filter(|candidate| candidate.term.carrier.place(chain) == self.place);
        let mut terms = here.map(|candidate| candidate.term);
        let Some(first) = terms.next() else {
            let unheard = self.kind == Kind::Thermal && survey.temperatures.is_empty();
            let more = if unheard { "; for other places add ‹columns› temperature" } else { "" };
            let places = places.join(", ");
            return Err(self.wrong(format!("{name} cannot act at \"{}\"; it can at {places}{more}", self.place)));
        };
        let mut term = match &first.driver {
            Driver::Harmonic { joint, .. } => {
                Term { driver: Driver::Harmonic { joint: *joint, order: 1.0 }, ..first.clone() }
            }
            Driver::Bump { joint, .. } => {
                let (low, high) = survey.ranges[*joint];
                let (at, width) = (low + 0.6 * (high - low), 0.06 * (high - low));
                Term { driver: Driver::Bump { joint: *joint, at, width, shape: BumpShape::Bell }, ..first.clone() }
            }
            _ => first.clone(),
        };
        for (key, value) in &self.settings {
            let number = || {
                let number = value.parse::<f64>().ok().filter(|number| number.is_finite());
                number.ok_or_else(|| self.wrong(format!("{key} is \"{value}\"; write a number")))
            };
            match (key.as_str(), &mut term.driver) {
                ("order", Driver::Harmonic { order, .. }) => *order = number()?,
                ("at", Driver::Bump { at, .. }) => *at = number()?,
                ("width", Driver::Bump { width, .. }) => *width = number()?,
                ("knee", Driver::Torque(joint)) => {
                    term.driver = Driver::HardeningTorque { joint: *joint, knee: number()? };
                }
                ("friction", Driver::Approach(side)) => {
                    term.driver = Driver::FrictionSide { side: side.clone(), friction: number()? };
                }
                ("over", Driver::Covariate(column)) if self.kind == Kind::Thermal => {
                    *column = self.warmth(survey, &first, number()?)?;
                }
                ("step", driver @ Driver::Covariate(_)) if self.kind == Kind::Drift => {
                    let Driver::Covariate(column) = driver else { continue };
                    *driver = Driver::Steps { covariate: column.clone(), at: vec![number()?] };
                }
                ("with", Driver::Reading(_)) if self.kind == Kind::JointCoupling => {
                    let joint = chain.joints().iter().position(|joint| joint.name == *value);
                    let joint =
                        joint.ok_or_else(|| self.wrong(format!("with is \"{value}\", which is not a joint")))?;
                    term.driver = Driver::Reading(joint);
                }
                _ => {
                    let known = match &term.driver {
                        Driver::Harmonic { .. } => "order",
                        Driver::Bump { .. } => "at and width",
                        Driver::Torque(_) => "knee",
                        Driver::Approach { .. } => "friction",
                        Driver::Covariate(_) if self.kind == Kind::Drift => "step",
                        Driver::Covariate(_) if self.kind == Kind::Thermal => "over",
                        Driver::Reading(_) if self.kind == Kind::JointCoupling => "with",
                        _ => "nothing",
                    };
                    return Err(self.wrong(format!("\"{key}\" cannot be set here; {name} accepts {known}")));
                }
            }
        }
        let not_above = match term.driver {
            Driver::Bump { width, .. } if width <= 0.0 => Some("width"),
            Driver::HardeningTorque { knee, .. } if knee <= 0.0 => Some("knee"),
            Driver::FrictionSide { friction, .. } if friction <= 0.0 => Some("friction"),
            _ => None,
        };
        if let Some(name) = not_above {
            return Err(self.wrong(format!("{name} must be above 0")));
        }
        Ok(term)
    }

    /// The column of a joint's warmth with this lag.
    fn warmth(&self, survey: &Survey, term: &Term, wanted: f64) -> Result<Column, EffectSpecificationError> {
        let lag = |column: &Column| match History::of_column(column.name()) {
            Some((_, History::Warmth { lag, .. })) => Some((lag, column.clone())),
            _ => None,
        };
        let joint = term.carrier.joint();
        let known = joint.into_iter().flat_map(|joint| survey.warmth(joint).filter_map(|column| lag(&column)));
        let known: Vec<(f64, Column)> = known.collect();
        let own = known.iter().find(|(lag, _)| *lag == wanted).map(|(_, column)| column.clone());
        own.ok_or_else(|| {
            let lags: Vec<String> = known.iter().map(|(lag, _)| lag.to_string()).collect();
            self.wrong(format!("over is {wanted}; a joint's own warmth can lag by one of {} here", lags.join(", ")))
        })
    }
}

/// The model of several specified effects for a run that was simulated without effects: strengths are those on its rows.
///
/// The run must have the columns that the effects depend on. An effect of a temperature, say, counts relative to the mean
/// temperature: instrument and target absorb the rest. Where a kind has several numbers (a phase, a direction) they are
/// drawn by the seed.
///
/// # Errors
/// An effect cannot be simulated on this robot or with these columns.
pub fn specified_effects(
    specifications: &[EffectSpecification],
    statics: &Statics,
    run: &Simulation,
    seed: u64,
) -> Result<EffectModel, EffectSpecificationError> {
    let data = with_run_order(run.data.clone());
    let survey = Survey::of(statics, &data, Vec::new());
    let mut effects = Vec::new();
    for (index, specification) in specifications.iter().enumerate() {
        let term = specification.term(&survey)?;
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(1 << 32 | index as u64);
        let direction = direction(specification, &term, statics, &mut random)?;
        let mut effect = Effect { term, coefficients: direction };
        match specification.strength {
            Strength::Coefficient(value) => scale(&mut effect, value),
            Strength::Moves(wanted) => {
                // Small first, so that the second pass finds the effect linear.
                scale(&mut effect, 1e-6);
                for _ in 0..2 {
                    let moved = moves(&run.arm, statics, &effect, &data);
                    if moved == 0.0 || !moved.is_finite() {
                        return Err(
                            specification.wrong("the effect moves no measured value; choose another place".into())
                        );
                    }
                    scale(&mut effect, wanted / moved);
                }
            }
        }
        effects.push(effect);
    }
    Ok(EffectModel::new(statics.clone(), effects))
}

fn scale(effect: &mut Effect, factor: f64) {
    for coefficient in &mut effect.coefficients {
        *coefficient *= factor;
    }
}

/// Coefficients with norm 1 in a random direction; a single one is positive.
fn direction(
    specification: &EffectSpecification,
    term: &Term,
    statics: &Statics,
    random: &mut ChaCha8Rng,
) -> Result<Vec<f64>, EffectSpecificationError> {
    let count = term.coefficients(statics);
    if count == 1 || term.coupling == Coupling::Paired {
        return Ok(vec![1.0; count]);
    }
    if let Driver::HardeningTorque { .. } = term.driver {
        // The whole compliance saturates.
        return Ok(vec![0.0, 1.0]);
    }
    let units: Vec<&str> = (0..count).map(|index| term.coefficient_name(statics, index).1).collect();
    if matches!(specification.strength, Strength::Coefficient(_)) && units.iter().any(|unit| *unit != units[0]) {
        let why = "it has coefficients in rad and in m; write how far it moves the measured values, such as 0.3mm";
        return Err(specification.wrong(why.into()));
    }
    // Rotations act over the arm's size: about as much as shifts.
    let size = if units.contains(&"rad") && units.contains(&"m") { statics.chain.size() } else { 1.0 };
    let drawn =
        units.iter().map(|unit| random.sample::<f64, _>(StandardNormal) * if *unit == "m" { size } else { 1.0 });
    let drawn: Vec<f64> = drawn.collect();
    let length = drawn.iter().map(|value| value * value).sum::<f64>().sqrt();
    Ok(drawn.iter().map(|value| value / length).collect())
}

/// Root mean square motion of the measured values by an effect, m; for an effect of a temperature or the like relative to the
/// quantity's mean.
pub fn moves(arm: &Arm, statics: &Statics, effect: &Effect, data: &Measurements) -> f64 {
    let model = EffectModel::new(statics.clone(), vec![effect.clone()]);
    let with = residuals(arm, &model, data);
    let without = match &effect.term.driver {
        Driver::Covariate(column) => residuals(arm, &model, &at_its_mean(data, column)),
        _ => residuals(arm, &NoEffects, data),
    };
    let squares: f64 = with.iter().zip(&without).map(|(a, b)| (a.place - b.place).norm_squared()).sum();
    (squares / with.len().max(1) as f64).sqrt()
}

fn at_its_mean(data: &Measurements, column: &Column) -> Measurements {
    let mut data = data.clone();
    let mean =
        (0..data.len()).map(|row| data.covariates.row(row).value(column)).sum::<f64>() / data.len().max(1) as f64;
    data.covariates.set(column, || mean);
    data
}
