//! Small drawings of histories, in SVG.

use crate::statistics::trend::Point;
use std::fmt::Write as _;

/// Lines with more points are thinned, which is invisible.
const POINTS: usize = 60;

/// A line as wide as a word.
pub(super) fn spark(points: &[Point]) -> String {
    if points.len() < 2 {
        return String::new();
    }
    let step = points.len().div_ceil(POINTS);
    let shown: Vec<(f64, f64)> = points.iter().step_by(step).map(|point| (point.day, point.value)).collect();
    let line = line(&shown, bounds(&shown), [96.0, 18.0]);
    format!("<svg class=\"spark\" viewBox=\"0 0 96 18\"><polyline points=\"{line}\"/></svg>")
}

/// Median and ninth decile over the days, with their scale.
pub(super) fn trend(days: &[(f64, f64, f64)]) -> String {
    if days.len() < 2 {
        return String::new();
    }
    let middle: Vec<(f64, f64)> = days.iter().map(|(day, middle, _)| (*day, *middle)).collect();
    let high: Vec<(f64, f64)> = days.iter().map(|(day, _, high)| (*day, *high)).collect();
    let [days, [_, top]] = bounds(&high);
    let bounds = [days, [0.0, top]];
    let (low, upper) = (line(&middle, bounds, [640.0, 160.0]), line(&high, bounds, [640.0, 160.0]));
    format!(
        "<svg class=\"trend\" viewBox=\"-4 -4 720 170\"><polyline points=\"{low}\"/><polyline class=\"high\" points=\"{upper}\"/>\
         <text x=\"646\" y=\"8\">{top:.3} mm</text><text x=\"646\" y=\"160\">0</text></svg>"
    )
}

fn bounds(points: &[(f64, f64)]) -> [[f64; 2]; 2] {
    let of = |value: fn(&(f64, f64)) -> f64| {
        let values = points.iter().map(value);
        [values.clone().fold(f64::INFINITY, f64::min), values.fold(f64::NEG_INFINITY, f64::max)]
    };
    [of(|point| point.0), of(|point| point.1)]
}

fn line(points: &[(f64, f64)], [days, values]: [[f64; 2]; 2], [width, height]: [f64; 2]) -> String {
    let share = |value: f64, [low, high]: [f64; 2]| if high > low { (value - low) / (high - low) } else { 0.5 };
    let mut text = String::new();
    for (day, value) in points {
        let (x, y) = (share(*day, days) * width, (1.0 - share(*value, values)) * (height - 2.0) + 1.0);
        let _ = write!(text, "{x:.0},{y:.1} ");
    }
    text.trim_end().to_owned()
}
