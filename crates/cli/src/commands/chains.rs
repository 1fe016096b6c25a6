//! `denavit chains`: every chain from a base link to a leaf.

use crate::args::ChainsArguments;
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::Status;
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
    let inputs = std::iter::once(arguments.robot.as_str()).chain(arguments.source.files());
    let delivery = Delivery::of(None, &arguments.json, inputs)?;
    let loaded = source::load(&arguments.robot, &arguments.source)?;
    let Chains { robot: name, mut chains, default } = loaded.chains();
    let leaves = chains.len();
    if !chains.contains(&default) {
        chains.insert(0, default.clone());
    }
    delivery.deliver(|| Ok(text(&name, leaves, &chains, &default)), || Ok(json(&name, &chains, &default)))?;
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
    super::stamped("denavit.chains/1", &listing)
}

fn text(name: &str, leaves: usize, chains: &[ChainListing], default: &ChainListing) -> String {
    let mut out = format!("{name}: {leaves} chains to a leaf; * is taken where none is named\n\n");
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
