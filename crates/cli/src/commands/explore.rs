//! `denavit explore`: the page of `web/` with robots in it, written to a file or served on this machine.

mod server;

use crate::args::{ExploreArguments, SourceArguments};
use crate::failure::Failure;
use crate::output::{self, Outputs, Status};
use crate::source;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use denavit_load::Meshes;
use serde::Serialize;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Where `web/build` puts the page in the clone that this binary was built from.
const BUILT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../web/dist/explorer.html");
/// The page inside of this binary.
#[cfg(feature = "explorer")]
const INSIDE: Option<&str> = Some(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../web/dist/explorer.html")));
#[cfg(not(feature = "explorer"))]
const INSIDE: Option<&str> = None;

/// Where the page has its robots.
const ROBOTS: &str = r#"<script type="application/json" id="robots">[]</script>"#;

/// Meshes of all robots together; a browser holds no page of more.
const MOST_MESH_BYTES: u64 = 192 << 20;

/// A robot in the page.
#[derive(Default, Serialize)]
struct Embedded {
    file: String,
    text: String,
    /// The files of its meshes in base64, by what the robot calls them.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    meshes: BTreeMap<String, String>,
}

/// Runs the command.
pub fn run(arguments: &ExploreArguments) -> Result<Status, Failure> {
    let page = page()?;
    let mut source = SourceArguments {
        package_path: arguments.package_path.clone(),
        allow_any_file: arguments.allow_any_file,
        ..SourceArguments::default()
    };
    let names = if arguments.robots.is_empty() { Vec::new() } else { source::sources(&arguments.robots, &mut source)? };
    let inputs = names.iter().map(String::as_str).chain(source.files());
    let mut outputs = Outputs::beside(inputs);
    let slot = outputs.add_if("--output", arguments.output.as_deref())?;
    let page = match page {
        Some(page) => with_robots(&page, &names, &source)?,
        None => plain(&names, &source)?,
    };
    match slot {
        Some(slot) => outputs.write(&[(slot, page)])?,
        None => server::serve(&page, arguments.port, !arguments.no_browser)?,
    }
    Ok(Status::Same)
}

/// Files that may hold the page, the first that exists counts: beside the program, as a package installs it, in the clone.
fn places(program: &Path) -> Vec<PathBuf> {
    let folder = program.parent();
    let beside = folder.map(|folder| folder.join("explorer.html"));
    let installed = folder.and_then(Path::parent).map(|prefix| prefix.join("share/denavit/explorer.html"));
    beside.into_iter().chain(installed).chain([PathBuf::from(BUILT)]).collect()
}

/// How to get the page of `web/`.
const NOT_INSTALLED: &str = "the explorer is not installed; run web/build in a clone of denavit, then copy \
                             web/dist/explorer.html beside this program";

/// The page without robots, if it is installed.
fn page() -> Result<Option<Cow<'static, str>>, Failure> {
    if let Some(page) = INSIDE {
        return Ok(Some(page.into()));
    }
    let program = std::env::current_exe().unwrap_or_default();
    let found = places(&program).into_iter().find(|path| path.is_file());
    let Some(path) = found else { return Ok(None) };
    let page = std::fs::read_to_string(&path)
        .map_err(|error| Failure::Argument(format!("{}: cannot be read: {error}", path.display())))?;
    if !page.contains(ROBOTS) {
        return Err(Failure::Argument(format!("{}: this is not a page of web/build; build it again", path.display())));
    }
    Ok(Some(page.into()))
}

/// The page with these robots in it.
fn with_robots(page: &str, names: &[String], source: &SourceArguments) -> Result<String, Failure> {
    let mut left = MOST_MESH_BYTES;
    let robots = names.iter().map(|name| embedded(name, source, &mut left)).collect::<Result<Vec<_>, Failure>>()?;
    Ok(filled(page, &robots))
}

/// What shows one robot where the page of `web/` is not installed: picture, table and joint values of `denavit doc`.
fn plain(names: &[String], source: &SourceArguments) -> Result<String, Failure> {
    let [name] = names else {
        return Err(Failure::Argument(format!(
            "{NOT_INSTALLED}; without it, only one robot can be shown: name one robot"
        )));
    };
    let page = super::doc::page_of(name, source)?;
    output::mention(format!("showing the page of denavit doc instead: {NOT_INSTALLED}"));
    Ok(page)
}

/// A robot as the page takes it: URDF, xacro expanded, or a table as it stands; meshes as long as bytes are left for them.
fn embedded(name: &str, arguments: &SourceArguments, left: &mut u64) -> Result<Embedded, Failure> {
    let (file, text) = source::read_text(name)?;
    // Standard input and git are read once; what is no robot is said here and not on the page.
    let options = source::options(arguments)?;
    let opened = denavit_load::from_text(&file, &text, &options)?;
    opened.notes.iter().for_each(output::mention);
    let shown = Path::new(&file).file_name().map_or_else(|| file.clone(), |name| name.to_string_lossy().into_owned());
    let source::Loaded::Robot(robot) = &opened.robot else {
        return Ok(Embedded { file: shown, text, ..Embedded::default() });
    };
    let Meshes { found, missing } = denavit_load::meshes(robot, &file, &options, *left);
    if let Some((mesh, why)) = missing.first() {
        let count = missing.len();
        let others = if count == 1 { String::new() } else { format!(", and {} more", count - 1) };
        output::mention(format!("{file}: mesh {mesh} is not shown{others}: {why}"));
    }
    *left -= found.iter().map(|mesh| mesh.bytes.len() as u64).sum::<u64>();
    let meshes = found.into_iter().map(|mesh| (mesh.uri, BASE64.encode(mesh.bytes))).collect();
    Ok(Embedded { file: shown, text: source::urdf_text(&file, text, arguments)?.text, meshes })
}

/// The page with robots in it; no text of theirs can end the element that holds them.
fn filled(page: &str, robots: &[Embedded]) -> String {
    let json = serde_json::to_string(robots).expect("texts are texts").replace('<', "\\u003c");
    page.replacen(ROBOTS, &ROBOTS.replace("[]", &json), 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_is_found_beside_the_program_and_where_a_package_installs_it() {
        let prefix = tempfile::tempdir().unwrap();
        let program = prefix.path().join("bin/denavit");
        let expected = ["bin/explorer.html", "share/denavit/explorer.html"].map(|path| prefix.path().join(path));
        assert_eq!(places(&program)[..2], expected);
        assert!(places(&program)[2].ends_with("web/dist/explorer.html"));
    }

    #[test]
    fn one_robot_is_shown_without_the_page_too() {
        let robot = concat!(env!("CARGO_MANIFEST_DIR"), "/../../robots/universal_robots/ur5e.urdf").to_owned();
        let page = plain(std::slice::from_ref(&robot), &SourceArguments::default()).unwrap();
        assert!(page.starts_with("<!doctype html>") && page.contains("0.425"));
        for names in [vec![], vec![robot.clone(), robot]] {
            let refused = plain(&names, &SourceArguments::default()).unwrap_err().to_string();
            assert!(refused.contains("web/build") && refused.contains("name one robot"), "{refused}");
        }
    }

    #[test]
    fn no_text_of_a_robot_ends_the_element_that_holds_it() {
        let page = format!("<body>{ROBOTS}</body>");
        let hostile = Embedded {
            file: "/</script>.urdf".into(),
            text: "</script><script>alert(1)</script><!--".into(),
            ..Embedded::default()
        };
        let filled = filled(&page, &[hostile]);
        assert_eq!(filled.matches("</script>").count(), 1, "{filled}");
        let json = filled.split("id=\"robots\">").nth(1).unwrap().split("</script>").next().unwrap();
        let read: serde_json::Value = serde_json::from_str(json).unwrap();
        assert_eq!(read[0]["text"], "</script><script>alert(1)</script><!--");
    }
}
