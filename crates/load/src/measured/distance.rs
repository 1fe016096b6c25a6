//! Reads a known distance.

use super::MeasuredError;
use denavit_model::Quantity;
use denavit_model::units::Unit;

/// Default standard deviation of a known distance, m.
const USUAL_DEVIATION: f64 = 5e-5;

/// Two labels, their distance and its standard deviation, m.
pub struct Known {
    /// Of sockets or anchors.
    pub labels: [String; 2],
    /// m.
    pub length: f64,
    /// Standard deviation, m.
    pub deviation: f64,
}

/// `LABEL,LABEL=50mm` or `LABEL,LABEL=50mm±0.1mm`.
pub fn known_distance(word: &str) -> Result<Known, MeasuredError> {
    let wrong = || {
        MeasuredError::Option(format!(
            "‹distance› \"{word}\": write two labels and their distance, such as front/0,front/1=50mm, or \
             */0,*/1=50mm+-0.1mm for every placement"
        ))
    };
    let (labels, value) = word.rsplit_once('=').ok_or_else(wrong)?;
    let (first, second) = labels.split_once(',').ok_or_else(wrong)?;
    let (length, deviation) = match value.split_once('±').or_else(|| value.split_once("+-")) {
        Some((length, deviation)) => (metres(length), metres(deviation)),
        None => (metres(value), Some(USUAL_DEVIATION)),
    };
    let (Some(length), Some(deviation)) = (length, deviation) else { return Err(wrong()) };
    if first.trim().is_empty() || second.trim().is_empty() || first.contains('*') != second.contains('*') {
        return Err(wrong());
    }
    Ok(Known { labels: [first.trim().into(), second.trim().into()], length, deviation })
}

/// A positive length with its unit, in m.
fn metres(text: &str) -> Option<f64> {
    Unit::value(text, Quantity::Length).filter(|length| *length > 0.0)
}
