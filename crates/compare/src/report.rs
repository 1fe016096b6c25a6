//! Reports for people and programs.
//!
//! Every format takes the same [`Report`]; [`FORMATS`] lists them for arguments, docs and tests.

mod badge;
mod entries;
mod github;
mod json;
pub mod junit;
mod markdown;
mod sarif;
mod text;

pub use entries::{Entry, Level};

use crate::comparison::Comparison;
use crate::lint::Finding;
use crate::robots::Robots;
use denavit_model::Inventory;

/// What a report is made of.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub enum Report<'a> {
    /// Two robots compared.
    Comparison(&'a Comparison),
    /// The robots of a repository in two revisions.
    Robots(&'a Robots),
    /// Files checked with the rules; with the names of all checked files.
    Findings {
        /// Every file, clean or not.
        files: &'a [String],
        /// In the order of the files.
        findings: &'a [Finding],
        /// The inventories of the files that could be read.
        inventories: &'a [FileInventory],
        /// How many more findings a baseline knows; `None` where there is no baseline.
        known: Option<usize>,
    },
}

/// The inventory of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileInventory {
    /// The file.
    pub file: String,
    /// What is understood, carried along and reported.
    pub inventory: Inventory,
}

/// Whether text is coloured by ANSI escapes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Colour {
    /// For a terminal.
    Ansi,
    /// For a file or a pipe.
    None,
}

/// A format of reports.
#[derive(Clone, Copy)]
pub struct ReportFormat {
    /// What the user calls it.
    pub name: &'static str,
    /// What it is for, a few words.
    pub summary: &'static str,
    /// Makes the text, ending in a line break.
    pub render: fn(&Report) -> String,
}

/// Every format.
pub const FORMATS: &[ReportFormat] = &[
    ReportFormat { name: "text", summary: "for people", render: plain },
    ReportFormat { name: "json", summary: "everything, for programs", render: json::render },
    ReportFormat { name: "junit", summary: "JUnit XML, for CI servers", render: junit::render },
    ReportFormat { name: "sarif", summary: "SARIF 2.1.0, for code scanning", render: sarif::render },
    ReportFormat { name: "github", summary: "annotations of a GitHub workflow", render: github::render },
    ReportFormat { name: "markdown", summary: "for a pull-request comment", render: markdown::render },
    ReportFormat { name: "badge", summary: "JSON for a shields.io badge", render: badge::render },
];

fn plain(report: &Report) -> String {
    text::render(report, Colour::None)
}

/// The text for people.
pub fn text(report: &Report, colour: Colour) -> String {
    text::render(report, colour)
}

/// The format of this name.
pub fn format(name: &str) -> Option<&'static ReportFormat> {
    FORMATS.iter().find(|format| format.name == name)
}
