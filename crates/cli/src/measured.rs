//! What the commands about measurements share: files of measurements, poses and effects, and pairs of numbers.

use crate::args::{GivenArguments, MeasureName, RobotArguments};
use crate::failure::Failure;
use crate::output;
use crate::source::{self, Loaded};
use denavit_calibrate::effects::driver::Statics;
use denavit_calibrate::effects::{EffectModel, recorded};
use denavit_calibrate::identify::proportion::within_proportion;
use denavit_calibrate::observation::kinds::{DISTANCE, POSE, POSITION};
use denavit_calibrate::observation::measurements::{self, ColumnUse, Measurements, Units, poses, poses::Poses};
use denavit_calibrate::{Freedom, ObservationKind};
use denavit_model::Chain;

/// A robot, its chain and what gravity acts on; notes are said.
pub struct Robot {
    pub loaded: Loaded,
    pub chain: Chain,
    pub statics: Statics,
}

/// Reads the robot that the arguments choose.
pub fn robot(arguments: &RobotArguments) -> Result<Robot, Failure> {
    let loaded = source::load(&arguments.robot, &arguments.source)?;
    let noted = loaded.chain(&arguments.selection())?;
    output::remark(&noted.notes);
    let chain = noted.value;
    if chain.joints().is_empty() {
        let (base, tip) = (chain.base(), chain.tip());
        return Err(Failure::Argument(format!(
            "{}: nothing moves between \"{base}\" and \"{tip}\"; choose --base and --tip",
            arguments.robot
        )));
    }
    within_proportion(&chain)?;
    let statics = loaded.statics(&chain, arguments.selection().reading);
    Ok(Robot { loaded, chain, statics })
}

/// Standard input can be read once.
pub fn one_standard_input(files: &[Option<&str>]) -> Result<(), Failure> {
    if files.iter().flatten().filter(|file| **file == "-").count() > 1 {
        return Err(Failure::Argument("standard input (-) can be one file only; give the others by name".into()));
    }
    Ok(())
}

/// Units of a file of data.
pub fn units(written: &str) -> Result<Units, Failure> {
    written.parse().map_err(|error| Failure::Argument(format!("--units: {error}")))
}

/// Reads a file by a reader that takes its name, its text and the units.
pub fn read<T>(
    file: &str,
    written: &str,
    reader: impl FnOnce(&str, &str, Units) -> Result<T, measurements::DataError>,
) -> Result<T, Failure> {
    let units = units(written)?;
    let (name, text) = source::read_text(file)?;
    Ok(reader(&name, &text, units)?)
}

/// Reads measurements and what their columns were taken for; what must be known of them is said.
pub fn measurements(file: &str, chain: &Chain, written: &str) -> Result<(Measurements, Vec<ColumnUse>), Failure> {
    let units = units(written)?;
    let (name, text) = source::read_text(file)?;
    let loaded = measurements::read(&name, text.as_bytes(), chain, units)?;
    for note in &loaded.notes {
        output::mention(format!("{name}: {note}"));
    }
    Ok((loaded.data, loaded.columns))
}

/// The other chains of a tree whose joints all have a column in these data: what was measured may be one of them.
pub fn other_chains(loaded: &Loaded, chain: &Chain, data: &Measurements) -> Vec<Chain> {
    let Loaded::Robot(tree) = loaded else { return Vec::new() };
    let names = |chain: &Chain| chain.coordinates().iter().map(|c| c.name.clone()).collect::<Vec<_>>();
    let recorded = |name: &String| data.joints.contains(name) || data.covariate(name).is_some();
    let listed = tree.leaf_chains().into_iter().filter(|listing| listing.coordinates.iter().all(recorded));
    let chains = listed.filter_map(|listing| {
        Some(tree.chain(Some(&listing.base), Some(&listing.tip), denavit_model::Reading::Intended).ok()?.value)
    });
    let mut others: Vec<Chain> = Vec::new();
    for other in chains {
        let known = names(&other) == names(chain) || others.iter().any(|known| names(known) == names(&other));
        if !other.joints().is_empty() && !known {
            others.push(other);
        }
    }
    others
}

/// Reads a list of poses.
pub fn pose_list(file: &str, chain: &Chain, written: &str) -> Result<Poses, Failure> {
    let units = units(written)?;
    let (name, text) = source::read_text(file)?;
    Ok(poses::read(&name, text.as_bytes(), chain, units)?)
}

/// Reads joint values.
pub fn joint_values(file: &str, chain: &Chain, written: &str) -> Result<Vec<Vec<f64>>, Failure> {
    let units = units(written)?;
    let (name, text) = source::read_text(file)?;
    Ok(poses::read_joints(&name, text.as_bytes(), chain, units)?)
}

/// Reads effects; without a file there are none.
pub fn effects(file: Option<&str>, statics: &Statics) -> Result<EffectModel, Failure> {
    let Some(file) = file else { return Ok(EffectModel::new(statics.clone(), Vec::new())) };
    let (name, text) = source::read_text(file)?;
    Ok(EffectModel::from_json(&name, &text, statics)?)
}

/// What was given by `--given`.
pub fn given(arguments: &GivenArguments) -> Result<Vec<(String, f64)>, Failure> {
    let pair = |word: &String| {
        let parsed = word.rsplit_once('=').and_then(|(name, value)| {
            let value = value.trim().parse::<f64>().ok().filter(|value| value.is_finite())?;
            Some((name.trim().to_owned(), value))
        });
        parsed.ok_or_else(|| Failure::Argument(format!("--given: \"{word}\" is no NAME=VALUE, such as payload=2.5")))
    };
    arguments.given.iter().map(pair).collect()
}

/// Whether everything is known that the effects with a part in where the tip is follow; `known` says so of a name.
pub fn all_known(file: &str, model: &EffectModel, known: &dyn Fn(&str) -> bool) -> Result<(), Failure> {
    let chain = &model.statics.chain;
    for effect in model.effects.iter().filter(|effect| recorded::moves_the_tip(&effect.term)) {
        for name in recorded::needed(&effect.term, chain) {
            if !known(&name) {
                let name = recorded::plain(&name);
                let (kind, place) = (effect.term.kind.name(), effect.term.carrier.place(chain));
                return Err(Failure::Argument(format!(
                    "{file}: {kind} at {place} follows \"{name}\"; give its value: --given \"{name}=VALUE\""
                )));
            }
        }
    }
    Ok(())
}

/// Says which effects have no part in where the tip is.
pub fn without_part_in_the_tip(file: &str, model: &EffectModel) {
    let chain = &model.statics.chain;
    for effect in model.effects.iter().filter(|effect| !recorded::moves_the_tip(&effect.term)) {
        let (kind, place) = (effect.term.kind.name(), effect.term.carrier.place(chain));
        output::mention(format!("{file}: {kind} at {place} changes what is measured, not where the tip is; left out"));
    }
}

/// What is fitted: every axis, and scales and pitches of the joints that were named.
pub fn freedom(chain: &Chain, scales: &[String], pitches: &[String]) -> Result<Freedom, Failure> {
    let joints = chain.joints();
    let mut freedom = Freedom::axes(joints.len());
    for (option, words, flags) in
        [("--scales", scales, &mut freedom.scales), ("--pitches", pitches, &mut freedom.pitches)]
    {
        for word in words {
            if word == "all" {
                flags.fill(true);
                continue;
            }
            let joint = joints.iter().position(|joint| joint.name == *word).ok_or_else(|| {
                let names: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
                Failure::Argument(format!(
                    "{option}: the chain has no joint \"{word}\"; write all, or of {}",
                    names.join(", ")
                ))
            })?;
            flags[joint] = true;
        }
    }
    Ok(freedom)
}

/// Millimetres and milliradians as m and rad; one number alone leaves the other at its default.
pub fn millimetres_and_milliradians(option: &str, written: &[f64], otherwise: f64) -> Result<[f64; 2], Failure> {
    let good = |value: &f64| value.is_finite() && *value >= 0.0;
    if written.is_empty() || written.len() > 2 || !written.iter().all(good) {
        let words: Vec<String> = written.iter().map(f64::to_string).collect();
        return Err(Failure::Argument(format!(
            "{option}: \"{}\" is not MM,MRAD; write one or two numbers of 0 or more",
            words.join(",")
        )));
    }
    Ok([written[0] * 1e-3, written.get(1).copied().unwrap_or(otherwise) * 1e-3])
}

/// The kind that a word on the command line means.
pub fn kind(measure: MeasureName) -> ObservationKind {
    match measure {
        MeasureName::Poses => POSE,
        MeasureName::Positions => POSITION,
        MeasureName::Distances => DISTANCE,
    }
}
