//! The skeleton of a robot as a figure: joints, common normals, every Denavit-Hartenberg frame and its four numbers.
//!
//! ```text
//! Table ──► scene (3-D, m) ──► View ──► strokes sorted from far to near ──► label placement ──► SVG
//! ```
//! Every coordinate is at zero. Frames follow the distal convention: frame i is the result of row i.

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "cells of a sheet of some thousand px")]
mod labels;
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "corners of an arc")]
mod scene;
mod solids;
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "cells and pieces of a sheet of some thousand px"
)]
mod strokes;
mod view;

use crate::numbers::Units;
use denavit_dh::Table;
use labels::Label;
use minijinja::value::Serde;
use minijinja::{AutoEscape, Environment};
use serde::Serialize;
use std::fmt::Write as _;
use strokes::Stroke;

pub use scene::{far_from_scale, subscript};
pub use view::View;

/// Width of a figure in its own units (px on a desktop).
const WIDTH: f64 = 960.0;
const NARROW: f64 = 560.0;

/// How much detail a figure has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Detail {
    /// Every frame and every number that is not zero; lengths and angles that the view foreshortens are left out in
    /// front and side views.
    #[default]
    Dimensioned,
    /// Joints, links and no words: for index pages.
    Plain,
}

#[derive(Serialize)]
struct Figure<'a> {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
    title: &'a str,
    description: &'a str,
    strokes: Vec<Stroke>,
    labels: Vec<Label>,
}

/// The figure as an SVG document, standalone or inside HTML.
///
/// Units are those of the labels; the drawing is to scale. Where a number far exceeds the robot's size, the figure
/// shows the arm, and the rest runs off its edge.
pub fn skeleton(table: &Table, view: View, detail: Detail, units: Units) -> String {
    let width = match (view, detail) {
        (View::Isometric, Detail::Dimensioned) => WIDTH,
        _ => NARROW,
    };
    let frame = view::Frame::around(&scene::extent(table), view, width, detail);
    let scene = scene::Scene::of(table, &frame, detail, units);
    let strokes = strokes::painted(&scene, &frame);
    let labels = labels::placed(&scene.labels, &strokes, &frame);
    let title = format!("{}, {} view", table.name, view.word());
    let description = format!(
        "Skeleton of {} joints with their Denavit-Hartenberg frames (x red, z blue) at zero of every joint",
        table.joints.len()
    );
    let [left, top, width, height] = trimmed(&frame, &strokes, &labels);
    let figure = Figure { left, top, width, height, title: &title, description: &description, strokes, labels };
    let mut environment = Environment::new();
    environment.set_auto_escape_callback(|_| AutoEscape::Html);
    environment
        .render_named_str("skeleton.svg", include_str!("../../templates/skeleton.svg"), Serde(&figure))
        .expect("the template names only fields of the figure")
}

/// Figures side by side as one SVG document, each with its title above it.
///
/// `figures` are documents that [`skeleton`] made.
pub fn side_by_side(figures: &[(&str, &str)]) -> String {
    const WORD: f64 = 30.0;
    let size = |figure: &str| {
        let view = figure.split_once("viewBox=\"").and_then(|(_, rest)| rest.split_once('"'));
        let numbers = view.expect("a skeleton has a viewBox").0.split(' ').map(str::parse::<f64>);
        let numbers: Vec<f64> = numbers.collect::<Result<_, _>>().expect("a viewBox is four numbers");
        (numbers[2], numbers[3])
    };
    let (mut left, mut high, mut inside) = (0.0, 0.0f64, String::new());
    for (word, figure) in figures {
        let (width, height) = size(figure);
        let _ = write!(inside, "<text x=\"{}\" y=\"20\">{word}</text>", left + 10.0);
        let placed = format!("<svg x=\"{left}\" y=\"{WORD}\" width=\"{width}\" height=\"{height}\" ");
        inside.push_str(&figure.replacen("<svg ", &placed, 1));
        left += width;
        high = high.max(height);
    }
    let high = high + WORD;
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {left} {high}\" width=\"{left}\" height=\"{high}\" \
         font-family=\"sans-serif\" font-size=\"16\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>{inside}</svg>\n"
    )
}

/// The part of the sheet that has something on it, and a little more: left, top, width, height.
fn trimmed(frame: &view::Frame, strokes: &[Stroke], labels: &[Label]) -> [f64; 4] {
    const EDGE: f64 = 10.0;
    let drawn = strokes.iter().flat_map(|stroke| &stroke.places).map(|place| (place.x, place.y, 0.0));
    let written = labels.iter().map(|label| (label.x, label.y, label.half_width));
    let mut bounds = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
    // What runs off the sheet is cut at its edge; words are not.
    let on_sheet =
        drawn.map(|(x, y, half)| (x.clamp(EDGE, frame.width - EDGE), y.clamp(EDGE, frame.height - EDGE), half));
    for (x, y, half) in on_sheet.chain(written) {
        let high = if half > 0.0 { labels::HEIGHT / 2.0 } else { 0.0 };
        bounds = [bounds[0].min(x - half), bounds[1].min(y - high), bounds[2].max(x + half), bounds[3].max(y + high)];
    }
    let (left, top) = ((bounds[0] - EDGE).floor(), (bounds[1] - EDGE).floor());
    [left, top, (bounds[2] + EDGE).ceil() - left, (bounds[3] + EDGE).ceil() - top]
}
