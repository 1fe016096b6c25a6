//! A robot from one format to another: the text, what it cannot say, a proof, and a sidecar that brings the source back.

use crate::read::environment;
use crate::revision::Home;
use crate::{LoadError, Loaded, Options, canonical, from_text};
use base16ct::lower::encode_string;
use denavit_compare::proof;
use denavit_export::urdf;
use denavit_model::Robot;
use denavit_model::formats::{Format, FormatError, Written, as_urdf};
use denavit_xacro::{PackagePath, files};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::path::{Component, Path, PathBuf};

/// The contract of a sidecar.
const SCHEMA: &str = "denavit.sidecar/1";

/// More kinds of differences than this are counted, not named.
const NAMED: usize = 20;

/// What a conversion is told.
#[derive(Debug, Clone, Copy)]
pub struct ConvertOptions<'a> {
    /// The format to write.
    pub to: Format,
    /// Where the text will stand, so that meshes are named from there; `None`: the folder of the source.
    pub output: Option<&'a Path>,
    /// Whether an inertia that no body can have is changed to the nearest that one can.
    pub fix_inertia: bool,
    /// What the source needs.
    pub source: &'a Options,
}

/// A text with what it lost, in a file beside it: `arm.xml.denavit.json` for `arm.xml`.
#[derive(Debug, Serialize, Deserialize)]
struct Sidecar {
    schema: String,
    /// SHA-256 of the text that this stands beside.
    sha256: String,
    source: SourceOf,
    losses: Vec<Lost>,
}

/// What the text was made of.
#[derive(Debug, Serialize, Deserialize)]
struct SourceOf {
    format: String,
    file: String,
    text: String,
}

#[derive(Debug, Serialize, Deserialize)]
struct Lost {
    file: String,
    line: usize,
    element: String,
    what: String,
    why: String,
}

/// The name of the sidecar of a file.
pub fn sidecar_of(file: &Path) -> PathBuf {
    let mut name = file.as_os_str().to_owned();
    name.push(".denavit.json");
    name.into()
}

/// A robot in another format; `text` is the source's own text, `file` its name.
///
/// Where a sidecar stands beside the source, says that the source was made of a description in the wanted format, and nothing was
/// changed since, that description is the result, byte for byte.
///
/// # Errors
/// The source is no robot, or the format cannot say it.
pub fn convert(file: &str, text: &str, options: &ConvertOptions) -> Result<Written, LoadError> {
    if let Some(text) = brought_back(file, text, options.to) {
        let proof = vec!["the description that this one was made of, byte for byte, from its sidecar".to_owned()];
        return Ok(Written { text, losses: Vec::new(), sidecar: None, proof });
    }
    let opened = from_text(file, text, options.source)?;
    let robot = match opened.robot {
        Loaded::Robot(robot) => *robot,
        other => denavit_model::urdf::read(file, &canonical(&other, file, &urdf::Options::default())?.value)?,
    };
    let mut written = written(&robot, file, options)?;
    prove(&robot, &mut written, options)?;
    if !written.losses.is_empty() {
        written.sidecar = Some(sidecar(&robot, file, text, &written));
    }
    Ok(written)
}

fn written(robot: &Robot, file: &str, options: &ConvertOptions) -> Result<Written, LoadError> {
    match options.to {
        Format::Mjcf => {
            let mesh = |uri: &str| mesh_from(uri, file, options);
            let how = denavit_mjcf::WriteOptions { fix_inertia: options.fix_inertia, mesh: &mesh };
            Ok(denavit_mjcf::write(robot, &how)?)
        }
        Format::Sdf => Ok(denavit_sdf::write(robot)?),
        _ => {
            let losses = robot.source.kept().iter().map(|kept| kept.loss.clone()).collect();
            Ok(Written { text: as_urdf(&robot.source.text), losses, sidecar: None, proof: Vec::new() })
        }
    }
}

/// A mesh's file from where the text will stand; `None` where there is no such file.
fn mesh_from(uri: &str, file: &str, options: &ConvertOptions) -> Option<String> {
    let home = Home::of(file).ok().filter(|home| !home.is_revision())?;
    let packages = PackagePath::new(&options.source.package_path, &environment()).near(&home.path);
    let path = packages.resolve(uri, Some(&home.path)).ok().filter(|path| files::is_file(path))?;
    let path = files::canonical(&path).ok()?;
    let beside = options.output.unwrap_or(&home.path).parent()?;
    let beside = files::canonical(if beside.as_os_str().is_empty() { Path::new(".") } else { beside }).ok()?;
    Some(relative(&path, &beside))
}

/// A path from a folder, with `/` between its parts.
fn relative(path: &Path, folder: &Path) -> String {
    let (path, folder): (Vec<Component>, Vec<Component>) = (path.components().collect(), folder.components().collect());
    let shared = path.iter().zip(&folder).take_while(|(one, other)| one == other).count();
    let up = folder[shared..].iter().map(|_| "..".to_owned());
    let down = path[shared..].iter().map(|part| part.as_os_str().to_string_lossy().into_owned());
    up.chain(down).collect::<Vec<_>>().join("/")
}

/// Reads the text back and compares it with the robot.
fn prove(robot: &Robot, written: &mut Written, options: &ConvertOptions) -> Result<(), LoadError> {
    let name = format!("the written {}", options.to.name());
    let again = from_text(&name, &written.text, options.source)?.robot;
    let Loaded::Robot(again) = again else {
        let place = robot.source.place(0, "robot");
        return Err(FormatError::one(place, "what was written reads back as no tree; please report this file").into());
    };
    let found = proof::of(robot, &again);
    written.proof = found.lines;
    let (named, count) = (found.differences.iter().take(NAMED), found.differences.len());
    written.proof.extend(named.map(|difference| format!("not the same: {difference}")));
    if count > NAMED {
        written.proof.push(format!("not the same: {} more", count - NAMED));
    }
    written.proof.push(format!("{} loss(es)", written.losses.len()));
    Ok(())
}

fn hash(text: &str) -> String {
    encode_string(&Sha256::digest(text.as_bytes()))
}

fn sidecar(robot: &Robot, file: &str, text: &str, written: &Written) -> String {
    let losses = written.losses.iter().map(|loss| Lost {
        file: loss.place.file.clone(),
        line: loss.place.line,
        element: loss.place.element.clone(),
        what: loss.what.clone(),
        why: loss.why.clone(),
    });
    let source = SourceOf { format: robot.source.format().word().into(), file: file.to_owned(), text: text.to_owned() };
    let made = Sidecar { schema: SCHEMA.into(), sha256: hash(&written.text), source, losses: losses.collect() };
    serde_json::to_string_pretty(&made).expect("plain values with text keys") + "\n"
}

/// The description that a text was made of, where its sidecar says so and the text is unchanged.
fn brought_back(file: &str, text: &str, to: Format) -> Option<String> {
    let home = Home::of(file).ok()?;
    let bytes = home.within(|| files::read(&sidecar_of(&home.path))).ok()?;
    let sidecar: Sidecar = serde_json::from_slice(&bytes).ok()?;
    let holds = sidecar.schema == SCHEMA && sidecar.source.format == to.word() && sidecar.sha256 == hash(text);
    holds.then_some(sidecar.source.text)
}
