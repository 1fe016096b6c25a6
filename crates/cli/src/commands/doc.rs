//! `denavit doc`: a page for each robot, and an index of several.

use crate::args::{DocArguments, OneTip, RobotArguments, SourceArguments, UnitsArguments};
use crate::failure::Failure;
use crate::output::{self, OutputFolder, Status};
use crate::source::{self, Loaded};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use denavit_compare::fingerprint;
use denavit_export::Units;
use denavit_export::page::{self, Card, ChainPart, Document, Solid};
use denavit_load::TableOptions;
use denavit_model::Reading;
use std::fmt::Write as _;
use std::path::Path;

/// A picture of more joints is unreadable, and a page of them too long.
const MOST_JOINTS: usize = 500;
/// Hands and legs have some dozens.
const MOST_CHAINS: usize = 300;

/// Runs the command.
pub fn run(arguments: &DocArguments) -> Result<Status, Failure> {
    let units = super::units(&arguments.units)?;
    let printed = arguments.output == Path::new("-");
    let folder = if printed { None } else { Some(OutputFolder::of(&arguments.output)?) };
    let mut source = SourceArguments {
        package_path: arguments.package_path.clone(),
        allow_any_file: arguments.allow_any_file,
        ..SourceArguments::default()
    };
    let robots = source::sources(&arguments.robots, &mut source)?;
    // Everything is made before anything is written.
    let mut files: Vec<(String, String)> = Vec::new();
    let mut cards = Vec::new();
    let names: Vec<&str> = robots.iter().map(String::as_str).collect();
    let mut refused = 0;
    for (name, loaded) in robots.iter().zip(source::load_each(&names, &source)?) {
        let made = loaded.and_then(|loaded| document(arguments, &source, name, loaded, units));
        let document = match made {
            Ok(document) => document,
            Err(failure) if robots.len() == 1 => return Err(failure),
            // The others get their pages.
            Err(failure) => {
                refused += 1;
                output::complain(&failure);
                continue;
            }
        };
        let stem = unused_stem(name, &files);
        if arguments.markdown {
            files.extend(page::markdown(&document, &stem).into_iter().map(|file| (file.name, file.text)));
        } else {
            cards.push(Card::of(&document, format!("{stem}.html")));
            let solid = solid(arguments, &source, name, &document)?;
            let text = match &solid {
                Some(solid) => page::html_with_shapes(&document, solid),
                None => page::html(&document),
            };
            files.push((format!("{stem}.html"), text));
        }
    }
    if refused == robots.len() {
        return Err(Failure::Argument(format!("none of {refused} robots can be read; no page was written")));
    }
    if cards.len() > 1 {
        files.push(("index.html".into(), page::index("Robots", &cards)));
    }
    let Some(folder) = folder else {
        let [(_, text)] = &files[..] else {
            let message = format!("--output -: standard output can hold one file, not {}; name a folder", files.len());
            return Err(Failure::Argument(message));
        };
        output::print(text)?;
        return Ok(if refused > 0 { Status::Error } else { Status::Same });
    };
    let inputs = robots.iter().map(String::as_str).chain(source.files());
    let mut listing = String::new();
    for path in folder.write(&files, inputs)? {
        let _ = writeln!(listing, "{}", path.display());
    }
    output::print(&listing)?;
    if refused > 0 {
        let others = robots.len() - refused;
        let pages = if others == 1 { "page" } else { "pages" };
        output::mention(format!(
            "{refused} of {} robots could not be read; the {pages} of the {others} others are written",
            robots.len()
        ));
        return Ok(Status::Error);
    }
    Ok(Status::Same)
}

/// The page of one robot: its whole chain, in metres and degrees.
pub fn page_of(name: &str, source: &SourceArguments) -> Result<String, Failure> {
    let arguments = DocArguments {
        robots: vec![name.to_owned()],
        output: "-".into(),
        markdown: false,
        base: None,
        tip: None,
        exact: false,
        package_path: source.package_path.clone(),
        allow_any_file: source.allow_any_file,
        units: UnitsArguments { units: "m,deg".into() },
    };
    let loaded = source::load(name, source)?;
    Ok(page::html(&document(&arguments, source, name, loaded, super::units(&arguments.units)?)?))
}

/// The explorer's 3-D view as web/build makes it, for pages.
#[cfg(feature = "explorer")]
const VIEW: Option<&str> = Some(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../web/dist/view.js")));
#[cfg(not(feature = "explorer"))]
const VIEW: Option<&str> = None;
/// Meshes of more bytes than this are left out of a page: it is to be sent and kept.
const MOST_MESH_BYTES: u64 = 16 << 20;

/// The 3-D view with the robot's shapes, where this binary has it.
fn solid(
    arguments: &DocArguments,
    source: &SourceArguments,
    name: &str,
    document: &Document,
) -> Result<Option<Solid<'static>>, Failure> {
    let (Some(script), Some(robot)) = (VIEW, &document.robot) else { return Ok(None) };
    let meshes = denavit_load::meshes(robot, name, &source::options(source)?, MOST_MESH_BYTES).found;
    let meshes = meshes.into_iter().map(|mesh| (mesh.uri, BASE64.encode(mesh.bytes))).collect();
    let reading = if arguments.exact { Reading::AsWritten } else { Reading::Intended };
    Ok(Some(Solid { script, reading, meshes }))
}

/// A file's name without its folders; what names a revision stays whole.
fn shown_source(name: &str) -> String {
    let file = Path::new(name).file_name().filter(|_| !name.starts_with("git:"));
    file.map_or_else(|| name.to_owned(), |file| file.to_string_lossy().into_owned())
}

/// The file's name without extensions, numbered where another robot has it.
fn unused_stem(robot: &str, files: &[(String, String)]) -> String {
    // Of git:REVISION:PATH the path; a colon in a file's name would read as a scheme in a link.
    let path = robot.strip_prefix("git:").and_then(|object| object.rsplit_once(':')).map_or(robot, |(_, path)| path);
    let name = Path::new(path).file_name().map_or_else(|| "robot".into(), |name| name.to_string_lossy().into_owned());
    let name = name.replace(':', "-");
    let stem = name.split('.').next().filter(|stem| !stem.is_empty() && *stem != "-").unwrap_or("robot").to_owned();
    let taken =
        |stem: &str| files.iter().any(|(name, _)| name == &format!("{stem}.html") || name == &format!("{stem}.md"));
    if !taken(&stem) && stem != "index" {
        return stem;
    }
    // One more than there are files is enough to find a free one.
    let numbered = (2..files.len() + 4).map(|number| format!("{stem}-{number}"));
    numbered.into_iter().find(|stem| !taken(stem)).unwrap_or(stem)
}

fn document(
    arguments: &DocArguments,
    source: &SourceArguments,
    name: &str,
    loaded: Loaded,
    units: Units,
) -> Result<Document, Failure> {
    let robot = RobotArguments {
        robot: name.to_owned(),
        base: arguments.base.clone(),
        tip: OneTip { tip: arguments.tip.clone() },
        exact: arguments.exact,
        tolerance: 1e-6,
        source: source.clone(),
    };
    let main = part(&robot, &loaded)?;
    let (chain, joints) = (&main.chain, main.chain.joints().len());
    if joints > MOST_JOINTS {
        return Err(Failure::Argument(format!(
            "{name}: {joints} joints move between \"{}\" and \"{}\", and a page shows at most {MOST_JOINTS}; choose a part \
             of the chain with --base and --tip, or print the table alone: denavit table",
            chain.base(),
            chain.tip()
        )));
    }
    let mut others = Vec::new();
    if let Loaded::Robot(tree) = &loaded {
        let others_of = |listing: &denavit_model::tree::ChainListing| {
            listing.tip != main.chain.tip() && !listing.coordinates.is_empty()
        };
        let listed = tree.leaf_chains();
        if listed.len() > MOST_CHAINS {
            return Err(Failure::Argument(format!(
                "{name}: the robot has {} chains, and a page shows at most {MOST_CHAINS}; remove links from its tree, or print \
                 the table of one chain: denavit table --base LINK --tip LINK",
                listed.len()
            )));
        }
        for listing in listed.iter().filter(|listing| others_of(listing)) {
            let (base, tip) = (Some(listing.base.clone()), OneTip { tip: Some(listing.tip.clone()) });
            match part(&RobotArguments { base, tip, ..robot.clone() }, &loaded) {
                Ok(other) => others.push(other),
                Err(error) => crate::output::mention(format!(
                    "{name}: the chain {} → {} is not on the page: {error}",
                    listing.base, listing.tip
                )),
            }
        }
    }
    let fingerprint = fingerprint(&loaded.subject(name), denavit_compare::fingerprint::DEFAULT_TOLERANCE).to_string();
    Ok(Document {
        main,
        others,
        robot: match loaded {
            Loaded::Robot(tree) => Some(*tree),
            _ => None,
        },
        source: shown_source(name),
        fingerprint: Some(fingerprint),
        units,
    })
}

fn part(robot: &RobotArguments, loaded: &Loaded) -> Result<ChainPart, Failure> {
    let selection = robot.selection();
    let chain = loaded.chain(&selection)?.value;
    let options = TableOptions { convention: None, gauge: None, tolerance: robot.tolerance };
    let made = loaded.table(&selection, &options)?;
    let gauge = if made.gauge == "file" {
        "As the file has them: its joint origins, or its rows, are Denavit-Hartenberg numbers."
    } else {
        "The fewest nonzero numbers; quarter turns rather than other angles."
    };
    Ok(ChainPart { chain, table: made.table.value, notes: made.table.notes, gauge: gauge.into() })
}
