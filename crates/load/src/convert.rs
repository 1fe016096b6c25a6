//! Converts a robot from one format to another: the text, what it cannot express, a proof, and a sidecar that restores the source.

use crate::merged::{Merged, merged};
use crate::read::environment;
use crate::revision::Home;
use crate::{LoadError, Loaded, Options, canonical, from_text};
use base16ct::lower::encode_string;
use denavit_compare::proof;
use denavit_export::urdf;
use denavit_model::Robot;
use denavit_model::formats::{Format, FormatError, Loss, Written, as_urdf, root_element};
use denavit_model::notes::Place;
use denavit_model::robot::{Geometry, Shape};
use denavit_xacro::{PackagePath, files};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::path::{Component, Path, PathBuf};

/// The contract of a sidecar.
const SCHEMA: &str = "denavit.sidecar/1";

/// More kinds of differences than this are counted, not named.
const NAMED: usize = 20;

/// Options of a conversion.
#[derive(Debug, Clone, Copy)]
pub struct ConvertOptions<'a> {
    /// The format to write.
    pub to: Format,
    /// Where the text will stand, so that meshes are named from there; `None`: the folder of the source.
    pub output: Option<&'a Path>,
    /// Whether an inertia that no body can have is changed to the nearest that one can.
    pub fix_inertia: bool,
    /// The name and text of the SRDF beside the robot; only MJCF says what it says.
    pub srdf: Option<(&'a str, &'a str)>,
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
    /// The text that this stands beside, as it was written: what differs from it later was edited.
    #[serde(default)]
    written: String,
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

impl Lost {
    /// What a description had that this one was made of.
    fn stays_lost(self) -> Loss {
        let Self { file, line, element, what, why } = self;
        let why = format!("remains lost, as the description in between was edited: {why}");
        Loss { place: Place { file, line, element }, what, why }
    }
}

/// The name of the sidecar of a file.
pub fn sidecar_of(file: &Path) -> PathBuf {
    let mut name = file.as_os_str().to_owned();
    name.push(".denavit.json");
    name.into()
}

/// A robot in another format; `text` is the source's own text, `file` its name.
///
/// A description that already has the wanted format is the result, byte for byte. If a sidecar beside the source shows that the source
/// was made from a description in the wanted format, that description is the result: byte for byte if nothing was changed since, else
/// with the edits in it.
///
/// # Errors
/// The source is no robot, or the format cannot say it; a sidecar cannot be read.
pub fn convert(file: &str, text: &str, options: &ConvertOptions) -> Result<Written, LoadError> {
    let sidecar = beside(file)?.filter(|sidecar| sidecar.source.format == options.to.word());
    if let Some(sidecar) = &sidecar
        && sidecar.sha256 == hash(text)
    {
        let proof = vec!["the original description, byte for byte, from its sidecar".to_owned()];
        return Ok(Written { text: sidecar.source.text.clone(), losses: Vec::new(), sidecar: None, proof });
    }
    let opened = from_text(file, text, options.source)?;
    let (is_xacro, includes) = (opened.is_xacro, opened.includes);
    let is_tree = matches!(opened.robot, Loaded::Robot(_));
    let robot = match opened.robot {
        Loaded::Robot(robot) => *robot,
        other => denavit_model::urdf::read(file, &canonical(&other, file, &urdf::Options::default())?.value)?,
    };
    if is_tree && !is_xacro && robot.source.format() == options.to && !options.fix_inertia && options.srdf.is_none() {
        return Ok(as_it_is(&robot, file, text, !includes.is_empty(), options));
    }
    if let Some(written) =
        sidecar.as_ref().map(|sidecar| with_edits(&robot, file, sidecar, options)).transpose()?.flatten()
    {
        return Ok(written);
    }
    let mut written = written(&robot, file, options)?;
    prove(&robot, &mut written, options)?;
    if !written.losses.is_empty() {
        // Of what is no text in a format for robots the robot is kept: xacro and tables are read, not written.
        let text = if is_tree && !is_xacro { text } else { &robot.source.text };
        written.sidecar = Some(self::sidecar(&robot, file, text, &written));
    }
    if let Some(sidecar) = sidecar {
        written.losses.extend(sidecar.losses.into_iter().map(Lost::stays_lost));
    }
    Ok(written)
}

/// The SRDF of a model in MJCF: excluded contacts and keys.
///
/// # Errors
/// The source is not MJCF.
pub fn srdf_of(file: &str, text: &str, options: &Options) -> Result<Written, LoadError> {
    if let Loaded::Robot(robot) = from_text(file, text, options)?.robot {
        return Ok(denavit_mjcf::srdf(&robot)?);
    }
    let place = Place { file: file.to_owned(), line: 1, element: "file".into() };
    Err(FormatError::one(place, "an SRDF is made only from MJCF; give an MJCF model").into())
}

/// A description that is in the wanted format already.
fn as_it_is(robot: &Robot, file: &str, text: &str, has_parts: bool, options: &ConvertOptions) -> Written {
    let proof = vec![format!("in {} already: written byte for byte", options.to.name())];
    let mut losses = Vec::new();
    let folder = |path: &Path| {
        let folder = path.parent()?;
        files::canonical(if folder.as_os_str().is_empty() { Path::new(".") } else { folder }).ok()
    };
    let home = Home::of(file).ok().filter(|home| !home.is_revision());
    let moved = options.output.is_some_and(|output| home.and_then(|home| folder(&home.path)) != folder(output));
    let is_near =
        |shape: &Shape| matches!(&shape.geometry, Geometry::Mesh { filename, .. } if !filename.contains("://"));
    let mut shapes = robot.links.iter().flat_map(|link| link.visuals.iter().chain(&link.collisions));
    if moved && (has_parts || shapes.any(is_near)) {
        let why = "they are relative to its folder, and the output is in another; write it beside the source";
        let place = robot.source.place(0, format!("<{}>", root_element(text).unwrap_or("robot")));
        losses.push(Loss { place, what: "files that it names".into(), why: why.into() });
    }
    Written { text: text.to_owned(), losses, sidecar: None, proof }
}

/// The description that another was made from, with the edits of the latter; `None` if that is unknown.
fn with_edits(
    after: &Robot,
    file: &str,
    sidecar: &Sidecar,
    options: &ConvertOptions,
) -> Result<Option<Written>, LoadError> {
    if hash(&sidecar.written) != sidecar.sha256 {
        return Ok(None);
    }
    let Loaded::Robot(before) = from_text(file, &sidecar.written, options.source)?.robot else { return Ok(None) };
    let (name, first) = (sidecar.source.file.as_str(), sidecar.source.text.as_str());
    let Some(Merged { text, changes, lost: losses }) = merged(options.to, name, first, &before, after) else {
        return Ok(None);
    };
    let mut proof = vec![format!(
        "{changes} edit(s) since it was made from {name} are put into that; everything else is unchanged"
    )];
    // On the way out again it is to be what was edited.
    let again = ConvertOptions {
        to: after.source.format(),
        output: None,
        fix_inertia: true,
        srdf: None,
        source: options.source,
    };
    let Loaded::Robot(robot) = from_text(name, &text, options.source)?.robot else { return Ok(None) };
    let mut there = written(&robot, name, &again)?;
    prove_of(after, &mut there, &again)?;
    let (same, differs): (Vec<String>, Vec<String>) =
        there.proof.into_iter().partition(|line| !line.starts_with(NOT_THE_SAME));
    proof.extend(same);
    // Of a format of which few values are put in, the whole is translated instead.
    if options.to != Format::Urdf && (!differs.is_empty() || changes == 0) {
        return Ok(None);
    }
    let mut result = Written { text, losses, sidecar: None, proof };
    for what in differs {
        let place = after.source.place(0, root_element(&after.source.text).unwrap_or("robot"));
        let why = "it is still so in the result; correct it there".to_owned();
        result.losses.push(Loss { place, what, why });
    }
    let known: Vec<(&str, &str)> =
        before.source.kept().iter().map(|kept| (kept.loss.what.as_str(), kept.text.as_str())).collect();
    let new = after.source.kept().iter().filter(|kept| !known.contains(&(&kept.loss.what, &kept.text)));
    result.losses.extend(new.map(|kept| kept.loss.clone()));
    Ok(Some(result))
}

fn written(robot: &Robot, file: &str, options: &ConvertOptions) -> Result<Written, LoadError> {
    match options.to {
        Format::Mjcf => {
            let mesh = |uri: &str| mesh_from(uri, file, options);
            let srdf = options.srdf.map(|(file, text)| denavit_mjcf::Srdf::read(file, text)).transpose()?;
            let how = denavit_mjcf::WriteOptions { fix_inertia: options.fix_inertia, mesh: &mesh, srdf: srdf.as_ref() };
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

/// What a line of a proof starts with that names a difference.
const NOT_THE_SAME: &str = "not the same: ";

/// Reads the text back and compares it with the robot; counts the losses.
fn prove(robot: &Robot, written: &mut Written, options: &ConvertOptions) -> Result<(), LoadError> {
    prove_of(robot, written, options)?;
    written.proof.push(format!("{} loss(es)", written.losses.len()));
    Ok(())
}

/// Reads the text back and compares it with the robot.
fn prove_of(robot: &Robot, written: &mut Written, options: &ConvertOptions) -> Result<(), LoadError> {
    let name = format!("the written {}", options.to.name());
    let again = from_text(&name, &written.text, options.source)?.robot;
    let Loaded::Robot(again) = again else {
        let place = robot.source.place(0, "robot");
        return Err(
            FormatError::one(place, "the written text does not read back as a tree; please report this file").into()
        );
    };
    let found = proof::of(robot, &again);
    written.proof = found.lines;
    let (named, count) = (found.differences.iter().take(NAMED), found.differences.len());
    written.proof.extend(named.map(|difference| format!("{NOT_THE_SAME}{difference}")));
    if count > NAMED {
        written.proof.push(format!("{NOT_THE_SAME}{} more", count - NAMED));
    }
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
    let made = Sidecar {
        schema: SCHEMA.into(),
        sha256: hash(&written.text),
        source,
        losses: losses.collect(),
        written: written.text.clone(),
    };
    serde_json::to_string_pretty(&made).expect("plain values with text keys") + "\n"
}

/// The sidecar of a description; `None` where there is none.
fn beside(file: &str) -> Result<Option<Sidecar>, LoadError> {
    let Ok(home) = Home::of(file) else { return Ok(None) };
    let path = sidecar_of(&home.path);
    let Ok(bytes) = home.within(|| files::read(&path)) else { return Ok(None) };
    let wrong = |reason: String| {
        let file = path.display().to_string();
        LoadError::Read { file, reason: format!("{reason}; restore the file that the conversion wrote, or remove it") }
    };
    let sidecar: Sidecar =
        serde_json::from_slice(&bytes).map_err(|error| wrong(format!("it is not a sidecar: {error}")))?;
    if sidecar.schema != SCHEMA {
        return Err(wrong(format!("its schema is \"{}\", and this program reads {SCHEMA}", sidecar.schema)));
    }
    Ok(Some(sidecar))
}
