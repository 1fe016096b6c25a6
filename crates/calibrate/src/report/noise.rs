//! The components of the noise, in a paragraph.

use denavit_identify::noise::{Component, NoiseModel};
use std::fmt::Write;

/// Factor and unit in which a size is written: angles of an instrument in µrad, angles of joints in mrad.
fn written(component: &Component) -> (f64, &'static str) {
    match (component.unit, &*component.name) {
        ("rad", "angle") => (1e6, "µrad"),
        ("rad", _) => (1e3, "mrad"),
        _ => (1e3, "mm"),
    }
}

/// A number with three significant digits, or all its digits before the point.
fn rounded(value: f64) -> String {
    let digits = (0..6).find(|digits| value * 10f64.powi(*digits) >= 100.0).unwrap_or(6);
    let digits = usize::try_from(if value > 0.0 { digits } else { 0 }).unwrap_or(0);
    format!("{value:.digits$}")
}

fn size(component: &Component) -> String {
    let (factor, unit) = written(component);
    let high = component.high.map_or_else(|| "no upper end".into(), |high| rounded(high * factor));
    format!("{} {unit} ({} to {high})", rounded(component.value * factor), rounded(component.low * factor))
}

fn claimed(component: &Component) -> String {
    let size = size(component);
    match (&*component.name, &component.joint) {
        ("range", _) => format!("{size} along the line of sight"),
        ("angle", _) => format!("{size} across it"),
        ("repeatability", Some(joint)) => format!("repeatability of {joint} {size}"),
        ("repeatability", None) => format!("repeatability of the joints, assumed equal, {size}"),
        (name, _) => format!("{size} in each component of {name}"),
    }
}

fn bound(component: &Component) -> Option<String> {
    let (factor, unit) = written(component);
    let high = rounded(component.high? * factor);
    Some(match (&*component.name, &component.joint) {
        ("repeatability", Some(joint)) => format!("{joint} {high} {unit}"),
        ("repeatability", None) => format!("all joints alike {high} {unit}"),
        (name, _) => format!("{name} {high} {unit}"),
    })
}

/// The components of the noise, upper bounds of those not detected, and the correlation in run order.
pub(super) fn noise(noise: Option<&NoiseModel>) -> String {
    let mut text = String::new();
    let Some(noise) = noise else { return text };
    let (there, open): (Vec<&Component>, Vec<&Component>) = noise.components.iter().partition(|of| of.claimed);
    let (joints, instrument): (Vec<&Component>, Vec<&Component>) =
        there.into_iter().partition(|of| of.name == "repeatability");
    let listed = |of: &[&Component]| of.iter().map(|of| claimed(of)).collect::<Vec<_>>().join(", ");
    let level = if instrument.is_empty() { "no single source".into() } else { listed(&instrument) };
    let _ = writeln!(text, "noise, standard deviation and 95 % interval: {level}");
    if !joints.is_empty() {
        let _ = writeln!(text, "  {}", listed(&joints));
    }
    let bounds: Vec<String> = open.iter().filter_map(|of| bound(of)).collect();
    if !bounds.is_empty() {
        let _ = writeln!(text, "  not detected; 95 % upper bounds: {}", bounds.join(", "));
    }
    if let Some(lever) = &noise.lever {
        let [x, y, z] = lever.value.map(|length| length * 1e3);
        let [a, b, c] = lever.std.map(|length| length * 1e3);
        let _ = writeln!(
            text,
            "  orientation and position errors are correlated, as if the target turned about a point offset from it by \
             {:.1} ± {a:.1}, {:.1} ± {b:.1}, {:.1} ± {c:.1} mm in the target's axes",
            -x, -y, -z
        );
    }
    if let Some(order) = noise.run_order.filter(|order| order.claimed) {
        let _ = writeln!(
            text,
            "  neighbouring rows have correlated errors: correlation {:.2} ({:.2} to {:.2})",
            order.lag_1, order.low, order.high
        );
    }
    if noise.rows < noise.of_rows {
        let _ = writeln!(text, "  estimated from {} of the {} rows, evenly spread", noise.rows, noise.of_rows);
    }
    text
}
