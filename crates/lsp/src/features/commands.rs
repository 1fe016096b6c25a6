//! Commands for an editor: a table, a comparison with the last commit.

use crate::session::Session;
use denavit_compare::report::{self, Report};
use denavit_compare::{Comparison, Options, compare};
use denavit_export::{Sheet, Units, formats};
use denavit_load::{Loaded, Made, NEARLY_PARALLEL, Selection, TableOptions};
use denavit_model::Robot;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// The Denavit-Hartenberg table, as text.
pub(crate) const TABLE: &str = "denavit.server.table";
/// The differences from the last commit, as text.
pub(crate) const COMPARE: &str = "denavit.server.compareWithHead";
/// Every command.
pub(crate) const NAMES: [&str; 2] = [TABLE, COMPARE];

pub(crate) fn run(session: &Session, command: &str, path: Option<&Path>) -> Result<String, String> {
    let path = path.ok_or("name the file: its URI is the command's first argument")?;
    let shown = path.display().to_string();
    match command {
        TABLE => {
            let robot = robot_of(session, path)?;
            let made = table(session, &robot, None)?;
            let sheet = sheet(&made, &shown);
            let text = formats::named("text").ok_or("no text format")?;
            (text.render)(&sheet).map_err(|error| error.to_string())
        }
        COMPARE => {
            let (comparison, _) = with_head(session, path)?;
            let report = Report::Comparison(&comparison);
            let text = report::format("markdown").ok_or("no markdown format")?;
            Ok((text.render)(&report))
        }
        _ => Err(format!("{command} is not a command")),
    }
}

/// The robot of a file.
pub(crate) fn robot_of(session: &Session, path: &Path) -> Result<Robot, String> {
    let robots = session.robots_of(path);
    let found = robots.iter().find_map(|analysis| analysis.robot.clone());
    found.ok_or_else(|| format!("{}: no robot could be read; see its problems", path.display()))
}

/// The table of a chain: to a link, or the longest one.
pub(crate) fn table(session: &Session, robot: &Robot, tip: Option<&str>) -> Result<Made, String> {
    let file = robot.source.file.clone();
    let selection = Selection { file: &file, tip, ..Selection::default() };
    let options = TableOptions { convention: session.settings.convention(), gauge: None, tolerance: NEARLY_PARALLEL };
    let robot = Loaded::Robot(Box::new(robot.clone()));
    robot.table(&selection, &options).map_err(|error| error.to_string())
}

pub(crate) fn sheet<'a>(made: &'a Made, source: &'a str) -> Sheet<'a> {
    Sheet {
        table: &made.table.value,
        convention: made.convention,
        units: Units::default(),
        notes: &made.table.notes,
        source,
        gauge: made.gauge,
    }
}

/// The differences of a file's robot from that of the last commit.
pub(crate) fn with_head(session: &Session, path: &Path) -> Result<(Comparison, PathBuf), String> {
    let robots = session.robots_of(path);
    let analysis = robots.first().map(Rc::clone).ok_or("there is no robot to compare")?;
    let robot = analysis.robot.clone().ok_or("there is no robot to compare")?;
    let file = analysis.file.clone();
    let name = format!("git:HEAD:{}", file.display());
    let before = denavit_load::load(&name, &session.settings.options(&file)).map_err(|error| error.to_string())?;
    let now = Loaded::Robot(Box::new(robot));
    let shown = file.display().to_string();
    let options = Options::default();
    let compared = compare(&before.robot.subject(&name), &Loaded::subject(&now, &shown), &options);
    Ok((compared.map_err(|error| error.to_string())?, file))
}
