//! Statistics of fleets: plain numbers in, plain numbers out, no store.

pub mod false_discovery;
pub mod hierarchy;
mod lasting;
pub mod population;
pub mod scatter;
pub mod trend;
pub mod vigil;

/// Median; 0 of nothing.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    values.sort_unstable_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 1 { values[middle] } else { f64::midpoint(values[middle - 1], values[middle]) }
}
