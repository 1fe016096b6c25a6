//! `denavit explore`: the page of `web/` with robots in it, written to a file or served on this machine.

mod server;

use crate::args::{ExploreArguments, SourceArguments};
use crate::failure::Failure;
use crate::output::{self, Outputs, Status};
use crate::source;
use serde::Serialize;
use std::path::Path;

/// The page as `web/build` makes it.
#[cfg(feature = "explorer")]
const PAGE: Option<&str> = Some(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../web/dist/explorer.html")));
#[cfg(not(feature = "explorer"))]
const PAGE: Option<&str> = None;

/// Where the page has its robots.
const ROBOTS: &str = r#"<script type="application/json" id="robots">[]</script>"#;

#[derive(Serialize)]
struct Embedded {
    file: String,
    text: String,
}

/// Runs the command.
pub fn run(arguments: &ExploreArguments) -> Result<Status, Failure> {
    let Some(page) = PAGE else {
        let message = "this binary was built without the explorer's page; run web/build, then cargo build --release \
                       --features explorer -p denavit, or open web/dist/explorer.html itself";
        return Err(Failure::Argument(message.into()));
    };
    let mut source = SourceArguments {
        package_path: arguments.package_path.clone(),
        allow_any_file: arguments.allow_any_file,
        ..SourceArguments::default()
    };
    let names = if arguments.robots.is_empty() { Vec::new() } else { source::sources(&arguments.robots, &mut source)? };
    let inputs = names.iter().map(String::as_str).chain(source.files());
    let mut outputs = Outputs::beside(inputs);
    let slot = outputs.add_if("--output", arguments.output.as_deref())?;
    let robots = names.iter().map(|name| embedded(name, &source)).collect::<Result<Vec<_>, Failure>>()?;
    let page = filled(page, &robots);
    match slot {
        Some(slot) => outputs.write(&[(slot, page)])?,
        None => server::serve(&page, arguments.port, !arguments.no_browser)?,
    }
    Ok(Status::Same)
}

/// A robot as the page takes it: URDF, xacro expanded, or a table as it stands.
fn embedded(name: &str, arguments: &SourceArguments) -> Result<Embedded, Failure> {
    let (file, text) = source::read_text(name)?;
    // Standard input and git are read once; what is no robot is said here and not on the page.
    let opened = denavit_load::from_text(&file, &text, &source::options(arguments)?)?;
    opened.notes.iter().for_each(output::mention);
    let shown = Path::new(&file).file_name().map_or_else(|| file.clone(), |name| name.to_string_lossy().into_owned());
    let text = match &opened.robot {
        source::Loaded::Robot(_) => source::urdf_text(&file, text, arguments)?.text,
        _ => text,
    };
    Ok(Embedded { file: shown, text })
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
    fn no_text_of_a_robot_ends_the_element_that_holds_it() {
        let page = format!("<body>{ROBOTS}</body>");
        let hostile =
            Embedded { file: "/</script>.urdf".into(), text: "</script><script>alert(1)</script><!--".into() };
        let filled = filled(&page, &[hostile]);
        assert_eq!(filled.matches("</script>").count(), 1, "{filled}");
        let json = filled.split("id=\"robots\">").nth(1).unwrap().split("</script>").next().unwrap();
        let read: serde_json::Value = serde_json::from_str(json).unwrap();
        assert_eq!(read[0]["text"], "</script><script>alert(1)</script><!--");
    }
}
