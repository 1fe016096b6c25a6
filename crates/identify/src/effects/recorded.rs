//! Quantities that effects depend on, by the names that users give.

use crate::effects::driver::{APPROACH, APPROACH_FROM_ROWS, RUN_ORDER, TIME};
use crate::effects::history::History;
use denavit_measurements::Covariate;

/// A quantity's user-facing name: a side of approach has one name, whether from a file or from the order of rows.
pub fn plain(name: &str) -> String {
    name.strip_suffix(APPROACH_FROM_ROWS).map_or_else(|| name.to_owned(), |joint| format!("{joint}{APPROACH}"))
}

/// A quantity's value among those given under plain names.
pub fn given(values: &[(String, f64)], name: &str) -> Option<f64> {
    let name = plain(name);
    values.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
}

/// Whether a quantity is computed from the order of rows or of commands: a joint's side of approach, its wind-up, its warmth.
pub fn given_by_order(name: &str) -> bool {
    History::of_column(name).is_some()
}

/// Whether a run with these columns gives a quantity: as a column, or by the order of its rows.
pub fn given_by_run(name: &str, columns: &[Covariate]) -> bool {
    let given = |name: &str| columns.iter().any(|column| column.name == name);
    let history = History::of_column(name).filter(|_| !name.ends_with(APPROACH));
    name == RUN_ORDER || history.is_some_and(|(_, history)| !history.needs_a_clock() || given(TIME)) || given(name)
}
