//! `denavit edit`: operations on a URDF's text, each checked.

mod meshes;

use crate::args::{EditArguments, EditOutputs, OperationArguments, SourceArguments, Step};
use crate::failure::Failure;
use crate::output::{self, Outputs, Status};
use crate::source::{self, Loaded};
use denavit_dh::{Convention, Table};
use denavit_edit::{Actual, Files, Frames, Operation, Text, Words, apply, unified_diff};
use denavit_export::makers::{self, techman, ur_conf};
use denavit_load::Selection;
use denavit_model::Reading;
use meshes::MeshFiles;
use std::path::{Path, PathBuf};

/// Runs the command.
pub fn run(arguments: &EditArguments) -> Result<Status, Failure> {
    let (mut steps, outputs) = arguments
        .steps()
        .map_err(|error| Failure::Argument(error.to_string().trim_start_matches("error: ").to_owned()))?;
    let mut source = SourceArguments {
        package_path: outputs.package_path.clone(),
        allow_any_file: outputs.allow_any_file,
        ..SourceArguments::default()
    };
    for step in &mut steps {
        let (values, words) = std::mem::take(&mut step.words).into_iter().partition(|word| word.contains(":="));
        step.words = words;
        source.values.extend::<Vec<String>>(values);
    }
    let inputs = [arguments.robot.as_str()].into_iter().chain(outputs.srdf.as_deref()).chain(source.files());
    let mut places = Outputs::beside(inputs);
    let urdf_place = places.add("--output", outputs.output.as_deref().unwrap_or(Path::new("-")))?;
    let srdf_place = places.add_if("--srdf-out", outputs.srdf_out.as_deref())?;
    let json_place = places.add_if("--json", outputs.json.place())?;
    let files = files(&arguments.robot, &outputs, &source)?;
    let mut meshes = MeshFiles::of(files.urdf.clone());
    let operations = steps
        .iter()
        .map(|step| operation(step, &outputs, &source, &mut meshes))
        .collect::<Result<Vec<Operation>, Failure>>()?;
    let done = apply(&files, &operations)?;
    let in_the_way = outputs.dry_run || places.take_standard_output();
    let said: Vec<String> = done.reports.iter().map(ToString::to_string).collect();
    done.reports.iter().flat_map(|report| &report.notes).for_each(output::mention);
    if in_the_way {
        said.iter().for_each(output::mention);
    }
    if outputs.dry_run {
        let mut diff = unified_diff(&files.urdf, &done.files.urdf);
        if let (Some(before), Some(after)) = (&files.srdf, &done.files.srdf) {
            diff.push_str(&unified_diff(before, after));
        }
        output::print(&diff)?;
        return Ok(Status::Same);
    }
    let mut texts = vec![(urdf_place, done.files.urdf.text.clone())];
    match (srdf_place, done.files.srdf.clone()) {
        (Some(place), Some(srdf)) => texts.push((place, srdf.text)),
        (None, Some(after)) if files.srdf.as_ref() != Some(&after) => {
            output::mention(format!("{}: the SRDF changes, too; --srdf-out FILE writes it", after.file));
        }
        _ => {}
    }
    if let Some(place) = json_place {
        texts.push((place, json(&done)?));
    }
    let hulls = done.meshes.iter().map(|mesh| {
        let place =
            meshes.place(&mesh.file).ok_or_else(|| Failure::Argument(format!("{}: it has no folder", mesh.file)))?;
        Ok((place, mesh.text.clone().into_bytes()))
    });
    let hulls = hulls.collect::<Result<Vec<(PathBuf, Vec<u8>)>, Failure>>()?;
    let mut beside = std::mem::take(&mut meshes.copies);
    beside.extend(hulls);
    places.write_with(&texts, &beside)?;
    if !in_the_way {
        output::print(&(said.join("\n") + "\n"))?;
    }
    Ok(Status::Same)
}

fn json(done: &denavit_edit::Done) -> Result<String, Failure> {
    let text = denavit_edit::to_json(done).map_err(|error| Failure::Argument(format!("--json: {error}")))?;
    Ok(text + "\n")
}

/// The text of a URDF, or of an expanded xacro file with `--expand`.
fn urdf(name: &str, outputs: &EditOutputs, source: &SourceArguments) -> Result<Text, Failure> {
    let (file, written) = source::read_text(name)?;
    if !denavit_load::is_markup(&file, &written) {
        return Err(Failure::Argument(format!(
            "{file}: this is not a URDF, and edits change the text of a URDF; `denavit export {file}` makes a URDF of it first"
        )));
    }
    let urdf = source::urdf_text(&file, written, source)?;
    if urdf.is_xacro && !outputs.expand {
        return Err(Failure::Argument(format!(
            "{file}: this is xacro: one line may make several joints, so an edit has no single place; --expand edits the URDF \
             that it makes"
        )));
    }
    Ok(Text { file, text: urdf.text })
}

fn files(robot: &str, outputs: &EditOutputs, source: &SourceArguments) -> Result<Files, Failure> {
    let urdf = urdf(robot, outputs, source)?;
    let srdf = outputs.srdf.as_deref().map(source::read_text).transpose()?;
    let srdf = srdf.map(|(file, text)| Text { file, text });
    Ok(Files { urdf, srdf })
}

fn operation(
    step: &Step,
    outputs: &EditOutputs,
    source: &SourceArguments,
    meshes: &mut MeshFiles,
) -> Result<Operation, Failure> {
    let Step { words, with } = step;
    let mut words = Words {
        words: words.clone(),
        other: None,
        at: with.at.clone(),
        pose: with.pose.clone(),
        prefix: with.prefix.clone(),
        keep: with.keep.clone(),
        names: with.names.clone(),
        to: with.to.clone(),
        ..Words::default()
    };
    if let Some(name) = words.words.get(1).cloned() {
        if words.takes_a_robot() {
            let other = urdf(&name, outputs, source)?;
            meshes.robots.push(other.clone());
            words.other = Some(other);
        }
        if words.takes_a_calibration() {
            words.actual = Some(actual(&name, with, source, &meshes.robots[0])?);
        }
    }
    meshes.prepare(&mut words, outputs.output.as_deref().unwrap_or(Path::new("-")), source)?;
    Ok(Operation::of(&words)?)
}

/// A maker's calibrated numbers, and how they relate to the robot.
fn actual(name: &str, with: &OperationArguments, source: &SourceArguments, robot: &Text) -> Result<Actual, Failure> {
    let mut source = SourceArguments {
        vendor_angles: with.vendor_angles,
        table_convention: with.table_convention,
        table_units: with.table_units.clone(),
        ..source.clone()
    };
    let (file, text) = source::read_text(name)?;
    if is_calibration(&text) {
        return calibrated(&file, &text, robot);
    }
    let drawn = denavit_edit::robot_of(robot)?;
    if let Some(added) = makers::new_origins(&file, &text, &drawn) {
        let added = added.map_err(|error| Failure::Argument(error.to_string()))?;
        output::mention(format!("{file}: read as {}", added.form));
        added.notes.iter().for_each(output::mention);
        return Ok(Actual::Origins(added.origins));
    }
    let says_model = source.values.iter().any(|value| value.starts_with(ur_conf::MODEL_ARGUMENT));
    if ur_conf::is_one(&text) && !says_model {
        let own = drawn.chain(None, None, Reading::Intended).ok();
        if let Some(model) = own.and_then(|chain| makers::ur_model(&chain.value)) {
            output::mention(format!(
                "{file}: the robot has the axes of a {model}; {}:={model} is assumed",
                ur_conf::MODEL_ARGUMENT
            ));
            source.values.push(format!("{}:={model}", ur_conf::MODEL_ARGUMENT));
        }
    }
    let loaded = source::load(name, &source)?;
    let selection = Selection { file: name, reading: Reading::AsWritten, ..Selection::default() };
    let chain = loaded.chain(&selection)?.value;
    let nominal = with.nominal.as_deref().map(|nominal| source::load_quietly(nominal, &source)).transpose()?;
    let frames = match (loaded, nominal) {
        (_, Some(Loaded::Table { table, convention, .. })) => Frames::AsNominal(Box::new(table), convention),
        (_, Some(_)) => {
            return Err(Failure::Argument(
                "--nominal: this is not a D-H table; name the table of the arm as drawn, in the form of the maker's actual one".into(),
            ));
        }
        (Loaded::Table { .. }, None) => match drawn_inside(name, &source)? {
            Some((table, convention)) => Frames::AsNominal(Box::new(table), convention),
            None => {
                return Err(Failure::Argument(format!(
                    "{name}: a D-H table has its own zeros and frames; --nominal FILE names the maker's table of the arm as \
                     drawn, which relates them to the robot"
                )));
            }
        },
        (_, None) => Frames::Own,
    };
    Ok(Actual::Chain { chain: Box::new(chain), frames })
}

/// Whether a text is what `calibrate --json` wrote.
fn is_calibration(text: &str) -> bool {
    let value: Option<serde_json::Value> = serde_json::from_str(text).ok();
    value.is_some_and(|value| {
        value["schema"]
            .as_str()
            .is_some_and(|schema| schema.starts_with("denavit.calibration/") || schema == "denavit.prior/1")
    })
}

/// The robot's axes where a calibration of ours found them.
#[cfg(feature = "calibrate")]
fn calibrated(file: &str, text: &str, robot: &Text) -> Result<Actual, Failure> {
    use denavit_identify::posterior::Earlier;
    let tree = denavit_edit::robot_of(robot)?;
    let wrong = |why: String| Failure::Argument(format!("{file}: {why}"));
    let value: serde_json::Value = serde_json::from_str(text).map_err(|error| wrong(error.to_string()))?;
    let [base, tip] = ["base", "tip"].map(|key| value[key].as_str());
    let mut refused = None;
    // As it was calibrated, or as it is written.
    for reading in [Reading::Intended, Reading::AsWritten] {
        let drawn = tree.chain(base, tip, reading).map_err(|error| wrong(error.to_string()))?.value;
        match Earlier::read(file, text, &drawn) {
            Ok(earlier) => {
                let chain = earlier.chain(&drawn).map_err(|error| wrong(error.to_string()))?;
                return Ok(Actual::Chain { chain: Box::new(chain), frames: Frames::Own });
            }
            Err(error) => refused = refused.or(Some(error)),
        }
    }
    Err(Failure::Argument(
        refused.map_or_else(|| format!("{file}: this is not a calibration"), |error| error.to_string()),
    ))
}

/// This program was built without calibration.
#[cfg(not(feature = "calibrate"))]
fn calibrated(file: &str, _: &str, _: &Text) -> Result<Actual, Failure> {
    Err(Failure::Argument(format!(
        "{file}: this program was built without calibration and cannot read this result; use the URDF that calibrate --urdf wrote"
    )))
}

/// The table of the model that a controller's file adds to: the same file with nothing added.
fn drawn_inside(name: &str, source: &SourceArguments) -> Result<Option<(Table, Convention)>, Failure> {
    let (file, text) = source::read_text(name)?;
    let nothing_added = |line: &str| match line.split_once('=') {
        Some((key, _)) if key.trim_start().starts_with("delta_") => format!("{key}= [0, 0, 0, 0, 0, 0]\n"),
        _ => format!("{line}\n"),
    };
    let ideal: String = if ur_conf::is_one(&text) {
        text.lines().map(nothing_added).collect()
    } else if techman::is_one(&text) {
        techman::drawn(&text)
    } else {
        return Ok(None);
    };
    let options = denavit_load::Options { arguments_for_another: true, ..source::options(source)? };
    Ok(match denavit_load::from_text(&file, &ideal, &options)?.robot {
        Loaded::Table { table, convention, .. } => Some((table, convention)),
        _ => None,
    })
}
