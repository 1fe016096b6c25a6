//! `denavit chains`: every chain from a base link to a leaf.

use crate::args::{ChainsArguments, RobotArguments};
use crate::failure::Failure;
use crate::output::{self, Status};
use crate::source::{self, Loaded};
use denavit_model::tree::ChainListing;
use serde::Serialize;
use std::fmt::Write as _;

#[derive(Serialize)]
struct Listing<'a> {
    robot: &'a str,
    chains: Vec<Entry<'a>>,
}

#[derive(Serialize)]
struct Entry<'a> {
    base: &'a str,
    tip: &'a str,
    coordinates: &'a [String],
    default: bool,
}

/// Runs the command.
pub fn run(arguments: &ChainsArguments) -> Result<Status, Failure> {
    let robot = RobotArguments {
        robot: arguments.robot.clone(),
        base: None,
        tip: None,
        exact: false,
        tolerance: 0.0,
        source: arguments.source.clone(),
    };
    let loaded = source::load(&arguments.robot, &arguments.source)?;
    let (name, chains, default) = if let Loaded::Robot(robot) = &loaded {
        (robot.name.clone(), robot.leaf_chains(), robot.default_chain())
    } else {
        let chain = loaded.chain(&robot)?.value;
        let coordinates = chain.coordinates().iter().map(|coordinate| coordinate.name.clone()).collect();
        let listing = ChainListing {
            base: chain.base().to_owned(),
            tip: chain.tip().to_owned(),
            coordinates,
            links: chain.joints().len() + 1,
        };
        (chain.name().to_owned(), vec![listing.clone()], listing)
    };
    let text = if arguments.json { json(&name, &chains, &default) } else { text(&name, &chains, &default) };
    output::print(&text)?;
    Ok(Status::Same)
}

fn json(name: &str, chains: &[ChainListing], default: &ChainListing) -> String {
    let entry = |listing: &'_ ChainListing| listing == default;
    let entries = chains.iter().map(|listing| Entry {
        base: &listing.base,
        tip: &listing.tip,
        coordinates: &listing.coordinates,
        default: entry(listing),
    });
    let listing = Listing { robot: name, chains: entries.collect() };
    serde_json::to_string_pretty(&listing).expect("names are text") + "\n"
}

fn text(name: &str, chains: &[ChainListing], default: &ChainListing) -> String {
    let mut out = format!("{name}: {} chains to a leaf; * is taken where none is named\n\n", chains.len());
    let width =
        |name: fn(&ChainListing) -> &str| chains.iter().map(|listing| name(listing).chars().count()).max().unwrap_or(0);
    let (base, tip) = (width(|listing| &listing.base), width(|listing| &listing.tip));
    for listing in chains {
        let mark = if listing == default { '*' } else { ' ' };
        let joints = match listing.coordinates.len() {
            0 => "no moving joint".to_owned(),
            count => format!("{count:>2}  {}", listing.coordinates.join(" ")),
        };
        let _ = writeln!(out, "{mark} {:<base$} → {:<tip$}  {joints}", listing.base, listing.tip);
    }
    out
}
