//! `denavit chains`: every chain from a base link to a leaf.

use crate::args::ChainsArguments;
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::Status;
use crate::source;
use denavit_load::Listing as Chains;
use denavit_model::tree::ChainListing;
use std::fmt::Write as _;

/// Runs the command.
pub fn run(arguments: &ChainsArguments) -> Result<Status, Failure> {
    let inputs = std::iter::once(arguments.robot.as_str()).chain(arguments.source.files());
    let delivery = Delivery::of(None, &arguments.json, inputs)?;
    let loaded = source::load(&arguments.robot, &arguments.source)?;
    let listing = loaded.chains();
    let own = || {
        let Chains { robot: name, mut chains, default } = listing.clone();
        let leaves = chains.len();
        if !chains.contains(&default) {
            chains.insert(0, default.clone());
        }
        Ok(text(&name, leaves, &chains, &default))
    };
    delivery.deliver(own, || Ok(denavit_load::json::chains(&listing)))?;
    Ok(Status::Same)
}

fn text(name: &str, leaves: usize, chains: &[ChainListing], default: &ChainListing) -> String {
    let mut out = format!("{name}: {leaves} chains to a leaf; * is the default\n\n");
    let width =
        |name: fn(&ChainListing) -> &str| chains.iter().map(|listing| name(listing).chars().count()).max().unwrap_or(0);
    let (base, tip) = (width(|listing| &listing.base), width(|listing| &listing.tip));
    for listing in chains {
        let mark = if listing == default { '*' } else { ' ' };
        let joints = match listing.coordinates.len() {
            0 => "no moving joint".to_owned(),
            count => format!("{count:>2}  {}", listing.coordinates.join(" ")),
        };
        let (from, to) = (padded(&listing.base, base), padded(&listing.tip, tip));
        let _ = writeln!(out, "{mark} {from} → {to}  {joints}");
    }
    out
}

/// A name with blanks behind it up to a width, which may be wider than what formatting takes.
fn padded(name: &str, width: usize) -> String {
    let blanks = width.saturating_sub(name.chars().count());
    format!("{name}{}", " ".repeat(blanks))
}
