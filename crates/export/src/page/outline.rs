//! The workspace's outline on a plane with round grid lines.

use super::workspace::Outline;
use crate::numbers::{Units, decimal};
use serde::Serialize;

/// Room around the plane for numbers, px.
const LEFT: f64 = 54.0;
const RIGHT: f64 = 18.0;
const TOP: f64 = 14.0;
const BOTTOM: f64 = 46.0;
const WIDTH: f64 = 480.0;
/// Longest height of the plane, px.
const TALLEST: f64 = 420.0;

#[derive(Serialize)]
struct Tick {
    at: f64,
    text: String,
}

#[derive(Serialize)]
struct Plane<'a> {
    width: f64,
    height: f64,
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
    path: &'a str,
    /// Whether what leaves the plane is hidden.
    clipped: bool,
    /// From m, second coordinate up, to px.
    transform: String,
    origin: [f64; 2],
    columns: Vec<Tick>,
    rows: Vec<Tick>,
    across: String,
    up: String,
    title: String,
}

/// The figure as SVG; the base's origin is marked and always inside.
pub(super) fn outline_svg(outline: &Outline, across: &str, up: &str, units: Units) -> String {
    let left = outline.left.min(0.0);
    let bottom = outline.bottom.min(0.0);
    let wide = (outline.left + outline.wide).max(0.0) - left;
    let high = (outline.bottom + outline.high).max(0.0) - bottom;
    let pixel = (wide / (WIDTH - LEFT - RIGHT)).max(high / TALLEST);
    let height = (high / pixel).max(60.0) + TOP + BOTTOM;
    let (x0, y0) = (LEFT - left / pixel, height - BOTTOM + bottom / pixel);
    let step = round_step(wide.max(high) / 6.0);
    let tenth = |v: f64| (v * 10.0).round() / 10.0;
    let ticks = |from: f64, span: f64, place: &dyn Fn(f64) -> f64| -> Vec<Tick> {
        let (first, last) = ((from / step).ceil() as i64, ((from + span) / step).floor() as i64);
        let tick = |k: i64| {
            let value = k as f64 * step;
            let shown = if units.length_word() == "mm" { value * 1e3 } else { value };
            Tick { at: tenth(place(value)), text: decimal(shown, 4).replace('-', "−") }
        };
        (first..=last).map(tick).collect()
    };
    let unit = units.length_word();
    let plane = Plane {
        width: tenth(LEFT + wide / pixel + RIGHT),
        height: tenth(height),
        left: LEFT,
        right: tenth(LEFT + wide / pixel),
        top: tenth(height - BOTTOM - high / pixel),
        bottom: tenth(height - BOTTOM),
        path: &outline.path,
        clipped: outline.half,
        transform: format!("translate({x0:.2} {y0:.2}) scale({s:.5} -{s:.5})", s = 1.0 / pixel),
        origin: [tenth(x0), tenth(y0)],
        columns: ticks(left, wide, &|x| x0 + x / pixel),
        rows: ticks(bottom, high, &|y| y0 - y / pixel),
        across: format!("{across} ({unit})"),
        up: format!("{up} ({unit})"),
        title: format!("Workspace of the tip: {up} over {across}"),
    };
    super::render("outline.svg", include_str!("../../templates/outline.svg"), &plane)
}

/// 1, 2 or 5 times a power of ten, not below `least`.
fn round_step(least: f64) -> f64 {
    let power = 10f64.powf(least.log10().floor());
    let factor = [1.0, 2.0, 5.0, 10.0].into_iter().find(|factor| factor * power >= least * (1.0 - 1e-9));
    factor.unwrap_or(10.0) * power
}
