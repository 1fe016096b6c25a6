//! The index of a fleet: a card a robot.

use super::content::reach_words;
use super::workspace::Workspace;
use super::{Branches, Document, small_figure};
use crate::sheet::Sheet;
use denavit_dh::Convention;
use serde::Serialize;

/// A robot on the index page.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Card {
    /// The robot's name.
    pub name: String,
    /// `6R`, `RRPH`, …
    pub kinds: String,
    /// Degrees of freedom, all branches counted.
    pub freedom: usize,
    /// Largest distance of the main chain's tip from its base origin, with its unit; empty if nothing moves.
    pub reach: String,
    /// Where it came from.
    pub source: String,
    /// The page's file.
    pub file: String,
    /// A small figure, SVG.
    pub figure: String,
}

impl Card {
    /// The card of a document whose page is `file`.
    pub fn of(document: &Document, file: impl Into<String>) -> Self {
        let part = &document.main;
        let sheet = Sheet {
            table: &part.table,
            convention: Convention::Distal,
            units: document.units,
            notes: &part.notes,
            source: &document.source,
            gauge: &document.main.gauge,
        };
        let moves = !part.chain.joints().is_empty();
        let branches = document.branches();
        Self {
            name: part.chain.name().to_owned(),
            kinds: branches.as_ref().and_then(Branches::words).unwrap_or_else(|| sheet.kinds()),
            freedom: branches.map_or(part.chain.coordinates().len(), |branches| branches.freedom),
            reach: if moves { reach_words(Workspace::of(&part.chain).reach, document.units) } else { String::new() },
            source: document.source.clone(),
            file: file.into(),
            figure: small_figure(&part.table, document.units),
        }
    }
}

/// The index page: one HTML file with links to the pages in the same folder.
pub fn index(title: &str, cards: &[Card]) -> String {
    #[derive(Serialize)]
    struct Index<'a> {
        title: &'a str,
        cards: &'a [Card],
        style: &'a str,
    }
    let page = Index { title, cards, style: include_str!("../../templates/page.css") };
    super::render("index.html", include_str!("../../templates/index.html"), &page)
}
