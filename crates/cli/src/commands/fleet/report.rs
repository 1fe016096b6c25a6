//! `denavit fleet report`: static pages.

use crate::args::FleetReportArguments;
use crate::failure::Failure;
use crate::output::{self, OutputFolder, Status};
use crate::progress::Bar;
use denavit_fleet::nights::Fleet;
use denavit_fleet::report::Report;
use denavit_fleet::statistics::vigil::Watch;
use denavit_fleet::store::Store;

/// Pages that are in memory, and written, together.
const TOGETHER: usize = 64;

pub fn run(arguments: &FleetReportArguments) -> Result<Status, Failure> {
    let folder = OutputFolder::of(&arguments.output)?;
    let store = Store::open(&arguments.store)?;
    let fleet = Fleet::read(&store)?;
    let report = Report::new(&store, &fleet, &Watch::default())?;
    let front = report.fleet_page()?;
    let count = fleet.serials.len();
    let robots = OutputFolder::of(&arguments.output.join("robots"))?;
    let bar = Bar::start(count);
    let every: Vec<usize> = (0..count).collect();
    for some in every.chunks(TOGETHER) {
        let pages = some.iter().map(|robot| {
            bar.step(&fleet.serials[*robot], false);
            report.robot_page(*robot)
        });
        robots.write(&pages.collect::<Result<Vec<_>, _>>()?, [])?;
    }
    // The fleet's page last: it links to the others.
    folder.write(&[("index.html".to_owned(), front)], [])?;
    drop(bar);
    output::print(&format!("{}, {count} robots\n", arguments.output.join("index.html").display()))?;
    Ok(Status::Same)
}
