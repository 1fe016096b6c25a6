//! A robot's document: one self-contained HTML page, or Markdown with figures, and the index of a fleet.
//!
//! ```text
//! Document ──► content (numbers as people write them) ──┬─► templates/page.html + style + scene.js ──► HTML
//!      │                                                └─► templates/page.md ──► Markdown, SVG files
//!      └─────► motion (screw axes at full precision) ──► the page's 3-D view
//! ```
//! The script of the 3-D view is `templates/scene.js`: it draws line segments on a 2-D canvas. The plotly script
//! that the crate plotly can embed makes each page 4.65 MB, needs WebGL, and logs errors without it.
//! If the caller has a [`Solid`] view (the explorer's, with shapes), it covers the segments; without WebGL they stay visible.

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "digits of a number")]
mod content;
mod coordinate_ascent;
mod index;
mod motion;
#[expect(clippy::cast_possible_truncation, reason = "ticks of an axis")]
mod outline;
mod solid;
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "cells of an outline, some hundred across")]
mod workspace;

use crate::drawing::{self, Detail, View};
use crate::numbers::Units;
use denavit_dh::Table;
use denavit_model::notes::Note;
use denavit_model::robot::JointKind;
use denavit_model::{Chain, PlacedRobot, Reading, Robot};
use minijinja::value::Serde;
use minijinja::{AutoEscape, Environment};
use serde::Serialize;
use std::collections::BTreeSet;

pub use index::{Card, index};
pub use solid::Solid;

/// A chain of the robot and its numbers.
#[derive(Debug, Clone)]
pub struct ChainPart {
    /// Screw axes and home pose.
    pub chain: Chain,
    /// Its Denavit-Hartenberg numbers.
    pub table: Table,
    /// Numbers not read as written, and other findings, of this chain.
    pub notes: Vec<Note>,
    /// How the gauge was chosen, a sentence.
    pub gauge: String,
}

/// What a robot's document is made from.
#[derive(Debug, Clone)]
pub struct Document {
    /// The chain that the document is about.
    pub main: ChainPart,
    /// Other chains of the same robot, each shown with its figure and tables.
    pub others: Vec<ChainPart>,
    /// Links with their masses, where the source gives them.
    pub robot: Option<Robot>,
    /// Where the robot came from: a file's name.
    pub source: String,
    /// Hash of the gauge-free invariants, where it was computed.
    pub fingerprint: Option<String>,
    /// Of the tables and figures.
    pub units: Units,
}

impl Document {
    /// The main chain and those that start at the same link: one picture can show them.
    fn parts_from_one_base(&self) -> Vec<&ChainPart> {
        let base = self.main.chain.base();
        std::iter::once(&self.main).chain(self.others.iter().filter(|part| part.chain.base() == base)).collect()
    }
}

/// A robot whose joints are in several branches: a quadruped, a humanoid, a hand.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Branches {
    /// Joint values of the whole robot; a floating base is not counted.
    freedom: usize,
    /// Floating joints.
    floating: usize,
    /// Base, tip and number of joint values of each chain that is not part of another.
    chains: Vec<(String, String, usize)>,
}

impl Document {
    /// The branches, if the robot has movable joints outside the main chain.
    fn branches(&self) -> Option<Branches> {
        let robot = self.robot.as_ref()?;
        let placed = PlacedRobot::new(robot, Reading::AsWritten);
        let values = |joint: usize| match robot.joints[joint].kind {
            JointKind::Planar => 3,
            _ => usize::from(robot.joints[joint].kind.has_one_value()),
        };
        let own = |joint: &usize| placed.driver(*joint) == Some(*joint) && values(*joint) > 0;
        let freedom = (0..robot.joints.len()).filter(own).map(values).sum();
        let parts: Vec<&ChainPart> = std::iter::once(&self.main).chain(&self.others).collect();
        let names = |part: &ChainPart| -> BTreeSet<String> {
            part.chain.coordinates().iter().map(|coordinate| coordinate.name.clone()).collect()
        };
        let sets: Vec<BTreeSet<String>> = parts.iter().map(|part| names(part)).collect();
        let whole = |place: usize| {
            let covers = |(other, set): (usize, &BTreeSet<String>)| {
                other != place && set.is_superset(&sets[place]) && (set.len() > sets[place].len() || other < place)
            };
            !sets[place].is_empty() && !sets.iter().enumerate().any(covers)
        };
        let chain = |place: usize| {
            let chain = &parts[place].chain;
            (chain.base().to_owned(), chain.tip().to_owned(), chain.coordinates().len())
        };
        let chains: Vec<_> = (0..parts.len()).filter(|place| whole(*place)).map(chain).collect();
        let floating = robot.joints.iter().filter(|joint| joint.kind == JointKind::Floating).count();
        (freedom > self.main.chain.coordinates().len()).then_some(Branches { freedom, floating, chains })
    }
}

impl Branches {
    /// `tree of 4 branches`; `None` if one chain has every joint value, such as an arm with one gripper finger.
    fn words(&self) -> Option<String> {
        let count = self.chains.len();
        (count > 1).then(|| format!("tree of {count} branches"))
    }
}

impl ChainPart {
    fn title(&self) -> String {
        format!("{} → {}", self.chain.base(), self.chain.tip())
    }
}

/// A file to be written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct File {
    /// Name without a folder.
    pub name: String,
    /// UTF-8.
    pub text: String,
}

/// The page as one file of HTML: no network, no other file.
pub fn html(document: &Document) -> String {
    html_page(document, None)
}

/// The same, with the robot's shapes in its 3-D view.
pub fn html_with_shapes(document: &Document, solid: &Solid) -> String {
    html_page(document, Some(solid))
}

fn html_page(document: &Document, solid: Option<&Solid>) -> String {
    #[derive(Serialize)]
    struct Page<'a> {
        #[serde(flatten)]
        content: &'a content::Content,
        style: &'a str,
        script: &'a str,
        motion: String,
        solid: Option<String>,
        solid_script: &'a str,
    }
    let content = content::Content::of(document);
    let page = Page {
        content: &content,
        style: include_str!("../../templates/page.css"),
        script: include_str!("../../templates/scene.js"),
        motion: motion::json(document),
        solid: solid.and_then(|solid| solid.json(document)),
        solid_script: solid.map_or("", |solid| solid.script),
    };
    render("page.html", include_str!("../../templates/page.html"), &page)
}

/// Markdown for a repository's folder of documents, and its figures; names start with `stem`.
pub fn markdown(document: &Document, stem: &str) -> Vec<File> {
    #[derive(Serialize)]
    struct Page<'a> {
        #[serde(flatten)]
        content: &'a content::Content,
        stem: &'a str,
    }
    let content = content::Content::of(document);
    let mut files: Vec<File> = content
        .figures()
        .map(|(name, svg)| File { name: format!("{stem}-{name}.svg"), text: svg.to_owned() })
        .collect();
    let page = Page { content: &content, stem };
    let text = render("page.md", include_str!("../../templates/page.md"), &page);
    files.insert(0, File { name: format!("{stem}.md"), text });
    files
}

/// A template filled in; what is not Markdown is escaped as HTML.
fn render(name: &str, template: &str, value: &impl Serialize) -> String {
    let mut environment = Environment::new();
    environment.set_auto_escape_callback(|name| if name == "page.md" { AutoEscape::None } else { AutoEscape::Html });
    environment.add_filter("md", |text: String| crate::formats::markdown::escaped(&text));
    environment
        .render_named_str(name, template, Serde(value))
        .expect("the template names only fields of the value; tests render every template")
}

/// A figure without words, for cards.
fn small_figure(table: &Table, units: Units) -> String {
    drawing::skeleton(table, View::Isometric, Detail::Plain, units)
}
