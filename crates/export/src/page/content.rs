//! The content of a document, as text for the templates.

use super::outline::outline_svg;
use super::workspace::{SEED, Workspace};
use super::{Branches, ChainPart, Document};
use crate::drawing::{Detail, View, far_from_scale, skeleton};
use crate::numbers::{AngleUnit, LengthUnit, Units, decimal};
use crate::sheet::Sheet;
use denavit_dh::{Convention, Motion};
use denavit_model::chain::{Chain, Coordinate, Quantity};
use denavit_model::forms::BaseForm;
use denavit_model::robot::Robot;
use denavit_model::se3::rpy_from_rotation;
use denavit_model::settings::plain;
use serde::Serialize;
use std::collections::BTreeSet;

/// Everything on a page except the 3-D view.
#[derive(Serialize)]
pub(super) struct Content {
    pub name: String,
    pub kinds: String,
    pub length_unit: &'static str,
    pub facts: Vec<(String, String)>,
    pub source: String,
    pub fingerprint: Option<String>,
    /// Titles of the chains that the 3-D view holds.
    pub chains: Vec<String>,
    pub main: Chapter,
    pub others: Vec<Chapter>,
    pub limits: Vec<Vec<String>>,
    pub workspace: Option<Envelope>,
    pub masses: Option<Masses>,
    pub notes: Vec<String>,
}

/// A chain's figures, tables, screw axes and home pose.
#[derive(Serialize)]
pub(super) struct Chapter {
    pub title: String,
    pub slug: String,
    pub freedom: usize,
    pub far: bool,
    /// Too many joints to label in a figure.
    pub many: bool,
    pub figures: Vec<Named>,
    pub tables: Vec<Grid>,
    pub gauge: String,
    pub screws: Vec<Vec<String>>,
    pub home: Vec<Vec<String>>,
    pub home_words: String,
    pub notes: Vec<String>,
}

/// A figure and its caption.
#[derive(Serialize)]
pub(super) struct Named {
    pub view: &'static str,
    pub name: String,
    pub svg: String,
}

/// A table with headings.
#[derive(Serialize)]
pub(super) struct Grid {
    pub title: String,
    pub formula: &'static str,
    pub columns: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

/// The workspace as outlines.
#[derive(Serialize)]
pub(super) struct Envelope {
    pub beside: String,
    pub above: String,
    pub words: String,
    pub across: &'static str,
}

/// Links that have a mass.
#[derive(Serialize)]
pub(super) struct Masses {
    pub rows: Vec<Vec<String>>,
    pub total: String,
    pub massless: usize,
}

impl Content {
    pub fn of(document: &Document) -> Self {
        let Document { main, units, .. } = document;
        let chain = &main.chain;
        let moves = !chain.joints().is_empty();
        let workspace = moves.then(|| Workspace::of(chain));
        let masses = document.robot.as_ref().and_then(|robot| masses(robot, *units));
        let chapter = |part: &ChainPart, index: usize| Chapter::of(part, document, index);
        let sheet = sheet(main, document, Convention::Distal);
        Self {
            name: chain.name().to_owned(),
            kinds: document.branches().as_ref().and_then(Branches::words).unwrap_or_else(|| sheet.kinds()),
            length_unit: units.length_word(),
            facts: facts(document, workspace.as_ref(), masses.as_ref()),
            source: document.source.clone(),
            fingerprint: document.fingerprint.clone(),
            chains: document.parts_from_one_base().iter().map(|part| part.title()).collect(),
            limits: limits(document),
            workspace: workspace.as_ref().map(|workspace| envelope(workspace, *units)),
            masses,
            notes: main.notes.iter().map(plain).collect(),
            main: chapter(main, 0),
            others: document.others.iter().enumerate().map(|(k, part)| chapter(part, k + 1)).collect(),
        }
    }

    /// Every figure with its file name's last part.
    pub fn figures(&self) -> impl Iterator<Item = (&str, &str)> {
        let chapters = std::iter::once(&self.main).chain(&self.others);
        let skeletons = chapters.flat_map(|chapter| &chapter.figures).map(|figure| (&*figure.name, &*figure.svg));
        let outlines = self
            .workspace
            .iter()
            .flat_map(|envelope| [("workspace-side", &*envelope.beside), ("workspace-above", &*envelope.above)]);
        skeletons.chain(outlines)
    }
}

/// Branches that are named one by one.
const MOST_BRANCHES: usize = 12;

/// A figure with more joints than this has no room for their names.
const NAMED: usize = 60;

impl Chapter {
    fn of(part: &ChainPart, document: &Document, index: usize) -> Self {
        let units = document.units;
        let views: &[View] = if index == 0 { &View::ALL } else { &[View::Isometric] };
        let slug = if index == 0 { String::new() } else { format!("chain-{index}-") };
        let many = part.table.joints.len() > NAMED;
        let detail = if many { Detail::Plain } else { Detail::Dimensioned };
        let figures = views.iter().map(|view| Named {
            view: view.word(),
            name: format!("{slug}{}", view.word()),
            svg: skeleton(&part.table, *view, detail, units),
        });
        let hayati = part.table.rows.iter().any(|row| row.beta().is_some());
        let conventions: &[Convention] =
            if hayati { &[Convention::Hayati] } else { &[Convention::Distal, Convention::Proximal] };
        let form = BaseForm::of(&part.chain);
        let angle = |angle: f64| with_unit(&minus(&units.angle(angle)), units.angle_word());
        let length = |length: f64| with_unit(&minus(&units.length(length)), units.length_word());
        let [roll, pitch, yaw] = rpy_from_rotation(&form.home.rotation).map(angle);
        let [x, y, z] = <[f64; 3]>::from(form.home.translation.vector).map(length);
        Self {
            title: part.title(),
            freedom: part.chain.coordinates().len(),
            far: far_from_scale(&part.table),
            many,
            figures: figures.collect(),
            tables: conventions.iter().map(|convention| grid(&sheet(part, document, *convention))).collect(),
            gauge: part.gauge.clone(),
            screws: screws(&part.chain, &form, units),
            home: home(&form, units),
            home_words: format!("x {x}, y {y}, z {z}; roll {roll}, pitch {pitch}, yaw {yaw}"),
            notes: part.notes.iter().map(plain).collect(),
            slug,
        }
    }
}

fn variable(number: usize) -> String {
    format!("q{}", crate::drawing::subscript(number))
}

fn sheet<'a>(part: &'a ChainPart, document: &'a Document, convention: Convention) -> Sheet<'a> {
    Sheet {
        table: &part.table,
        convention,
        units: document.units,
        notes: &part.notes,
        source: &document.source,
        gauge: &part.gauge,
    }
}

fn minus(text: &str) -> String {
    text.replace('-', "−")
}

fn grid(sheet: &Sheet) -> Grid {
    let symbol = |column: &&str| match *column {
        "theta" => format!("θ ({})", sheet.units.angle_word()),
        "alpha" => format!("α ({})", sheet.units.angle_word()),
        "beta" => format!("β ({})", sheet.units.angle_word()),
        column => format!("{column} ({})", sheet.units.length_word()),
    };
    let columns = ["", "joint", "kind"].map(str::to_owned).into_iter();
    let rows = sheet.text_rows(variable).into_iter().map(|row| {
        let numbers = row.numbers.iter().map(|number| minus(number));
        [row.label, row.joint, row.kind].into_iter().chain(numbers).collect()
    });
    Grid {
        title: capital(sheet.convention_words()),
        formula: sheet.row_formula(),
        columns: columns.chain(sheet.number_columns().iter().map(symbol)).collect(),
        rows: rows.collect(),
    }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

fn facts(document: &Document, workspace: Option<&Workspace>, masses: Option<&Masses>) -> Vec<(String, String)> {
    let (chain, units) = (&document.main.chain, document.units);
    let own = chain.coordinates().len();
    let mut facts = Vec::new();
    let branches = document.branches();
    if let Some((branches, words)) = branches.as_ref().and_then(|branches| Some((branches, branches.words()?))) {
        let base = match branches.floating {
            0 => String::new(),
            1 => ", and 6 of a floating base".to_owned(),
            count => format!(", and 6 of each of {count} floating joints"),
        };
        facts.push(("Degrees of freedom".to_owned(), format!("{}{base}", branches.freedom)));
        let one = |(base, tip, freedom): &(String, String, usize)| format!("{base} → {tip} ({freedom})");
        let mut listed: Vec<String> = branches.chains.iter().take(MOST_BRANCHES).map(one).collect();
        if branches.chains.len() > MOST_BRANCHES {
            listed.push(format!("{} others", branches.chains.len() - MOST_BRANCHES));
        }
        facts.push((capital(&words), listed.join(", ")));
        facts.push(("Chain shown first".to_owned(), format!("{} → {}, {own} of them", chain.base(), chain.tip())));
    } else {
        let all =
            branches.map_or_else(|| own.to_string(), |all| format!("{}, {own} of them in this chain", all.freedom));
        facts.push(("Chain".to_owned(), format!("{} → {}", chain.base(), chain.tip())));
        facts.push(("Degrees of freedom".to_owned(), all));
    }
    if let Some(workspace) = workspace {
        facts.push(("Reach".to_owned(), reach_words(workspace.reach, units)));
    }
    if let Some(masses) = masses {
        facts.push(("Mass".to_owned(), format!("{} kg", masses.total)));
    }
    facts.push(("Source".to_owned(), document.source.clone()));
    if let Some(fingerprint) = &document.fingerprint {
        facts.push(("Fingerprint".to_owned(), fingerprint.clone()));
    }
    facts
}

pub(super) fn reach_words(reach: f64, units: Units) -> String {
    let shown = match units.length_word() {
        "mm" => decimal(reach * 1e3, 0),
        _ => decimal(reach, 3),
    };
    format!("{shown} {}", units.length_word())
}

/// Every coordinate once; those of the main chain with their symbol.
fn limits(document: &Document) -> Vec<Vec<String>> {
    let units = document.units;
    let row = |symbol: String, coordinate: &Coordinate| {
        let unit = match coordinate.quantity {
            Quantity::Angle => units.angle_word(),
            Quantity::Length => units.length_word(),
        };
        let value = |value: f64| with_unit(&rounded(value, coordinate.quantity, units), unit);
        let none = || "–".to_owned();
        let limits = coordinate.limits;
        let bound = |bound: Option<f64>| match bound {
            Some(bound) => value(bound),
            None if coordinate.continuous => "endless".to_owned(),
            None => none(),
        };
        let effort_unit = if coordinate.quantity == Quantity::Angle { "N·m" } else { "N" };
        vec![
            symbol,
            coordinate.name.clone(),
            bound(limits.range.map(|range| range.0)),
            bound(limits.range.map(|range| range.1)),
            limits.velocity.map_or_else(none, |v| format!("{}/s", value(v))),
            limits.effort.map_or_else(none, |e| format!("{} {effort_unit}", decimal(e, 4))),
        ]
    };
    let mut listed: Vec<&Coordinate> = document.main.chain.coordinates().iter().collect();
    let own = listed.len();
    let mut known: BTreeSet<&str> = listed.iter().map(|coordinate| coordinate.name.as_str()).collect();
    let others = document.others.iter().flat_map(|part| part.chain.coordinates());
    listed.extend(others.filter(|coordinate| known.insert(&coordinate.name)));
    let symbol = |k: usize| if k < own { variable(k + 1) } else { String::new() };
    listed.iter().enumerate().map(|(k, coordinate)| row(symbol(k), coordinate)).collect()
}

/// Hundredths of a degree, tenths of a millimetre: limits are not more precise.
fn rounded(value: f64, quantity: Quantity, units: Units) -> String {
    let places = match (quantity, units.angle, units.length) {
        (Quantity::Angle, AngleUnit::Degree, _) => 2,
        (Quantity::Length, _, LengthUnit::Millimetre) => 1,
        _ => 4,
    };
    let shown: f64 = units.value(value, quantity).parse().unwrap_or(value);
    minus(&decimal(shown, places))
}

fn with_unit(number: &str, unit: &str) -> String {
    if unit == "°" { format!("{number}°") } else { format!("{number} {unit}") }
}

/// Unit twists at zero of every coordinate, with a point on the axis that can be checked on a drawing.
fn screws(chain: &Chain, form: &BaseForm, units: Units) -> Vec<Vec<String>> {
    let per_metre = if units.length == LengthUnit::Millimetre { 1e3 } else { 1.0 };
    let row = |(joint, twist): (&denavit_model::ChainJoint, &denavit_model::nalgebra::Vector6<f64>)| {
        let unit = twist / joint.scale;
        let slides = joint.screw.line().is_none();
        let vector = |from: usize, length: bool| -> String {
            let number = |k: usize| decimal(if length { unit[k] * per_metre } else { unit[k] }, 9);
            minus(&(from..from + 3).map(number).collect::<Vec<_>>().join(", "))
        };
        let motion = Motion::of(&joint.screw);
        let pitch = match motion {
            Motion::Revolute => "0".to_owned(),
            Motion::Prismatic => "∞".to_owned(),
            Motion::Helical(pitch) => minus(&decimal(pitch.metres_per_radian() * per_metre, 9)),
        };
        let coordinate = &chain.coordinates()[joint.coordinate];
        let mut moved_by = variable(joint.coordinate + 1);
        let scale = minus(&decimal(joint.scale, 9));
        if scale != "1" {
            moved_by = format!("{scale} {moved_by}");
        }
        if coordinate.name != joint.name {
            moved_by = format!("{moved_by} ({})", coordinate.name);
        }
        vec![joint.name.clone(), motion.word().to_owned(), vector(0, false), vector(3, !slides), pitch, moved_by]
    };
    chain.joints().iter().zip(&form.twists).map(row).collect()
}

fn home(form: &BaseForm, units: Units) -> Vec<Vec<String>> {
    let matrix = form.home.to_homogeneous();
    let cell = |row: usize, column: usize| {
        let value = matrix[(row, column)];
        minus(&if column == 3 && row < 3 { units.length(value) } else { decimal(value, 8) })
    };
    (0..4).map(|row| (0..4).map(|column| cell(row, column)).collect()).collect()
}

fn masses(robot: &Robot, units: Units) -> Option<Masses> {
    let carrying: Vec<_> = robot.links.iter().filter_map(|link| Some((link, link.inertial.as_ref()?))).collect();
    if carrying.is_empty() {
        return None;
    }
    let rows = carrying.iter().map(|(link, inertial)| {
        let centre: Vec<String> = inertial.origin.xyz.iter().map(|x| units.length(*x)).collect();
        let moments: Vec<String> = (0..3).map(|k| significant(inertial.tensor[(k, k)])).collect();
        vec![link.name.clone(), decimal(inertial.mass, 4), minus(&centre.join(", ")), minus(&moments.join(", "))]
    });
    let total: f64 = carrying.iter().map(|(_, inertial)| inertial.mass).sum();
    Some(Masses { rows: rows.collect(), total: decimal(total, 3), massless: robot.links.len() - carrying.len() })
}

/// Four significant digits.
fn significant(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return "0".to_owned();
    }
    let places = (3.0 - value.abs().log10().floor()).clamp(0.0, 12.0) as usize;
    decimal(value, places)
}

fn envelope(workspace: &Workspace, units: Units) -> Envelope {
    let bounds: Vec<String> = ["x", "y", "z"]
        .iter()
        .zip(workspace.bounds)
        .map(|(axis, (lower, upper))| {
            let shown = |value: f64| reach_words(value, units).split(' ').next().map_or_else(String::new, minus);
            format!("{axis} {} … {} {}", shown(lower), shown(upper), units.length_word())
        })
        .collect();
    let across = if workspace.turns_about_z { "distance from z" } else { "x" };
    Envelope {
        beside: outline_svg(&workspace.beside(), across, "z", units),
        above: outline_svg(&workspace.above(), "x", "y", units),
        words: format!(
            "Outline of the tip positions at {} postures (low-discrepancy sequence, seed {SEED}), some of them moved \
             to the border: {}. Farthest from the base origin: {}.",
            workspace.postures,
            bounds.join(", "),
            reach_words(workspace.reach, units)
        ),
        across,
    }
}
