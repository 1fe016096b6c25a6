//! `denavit chains`: every chain from a base link to a leaf.

use crate::args::ChainsArguments;
use crate::failure::Failure;
use crate::output::{self, Status};
use crate::source;
use denavit_load::Listing as Chains;
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
    let loaded = source::load(&arguments.robot, &arguments.source)?;
    let Chains { robot: name, chains, default } = loaded.chains();
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
