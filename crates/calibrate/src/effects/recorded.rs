//! What effects follow, by the names under which people give it.

use crate::effects::driver::{APPROACH, APPROACH_FROM_ROWS, RUN_ORDER};
use crate::observation::measurements::Covariate;

/// The name under which a person gives a quantity: a side of approach is one, whether a file gives it or the order of rows.
pub fn plain(name: &str) -> String {
    name.strip_suffix(APPROACH_FROM_ROWS).map_or_else(|| name.to_owned(), |joint| format!("{joint}{APPROACH}"))
}

/// A quantity's value among those given under plain names.
pub fn given(values: &[(String, f64)], name: &str) -> Option<f64> {
    let name = plain(name);
    values.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
}

/// Whether a run with these columns gives a quantity: as a column, or by the order of its rows.
pub fn given_by_run(name: &str, columns: &[Covariate]) -> bool {
    name == RUN_ORDER || name.ends_with(APPROACH_FROM_ROWS) || columns.iter().any(|column| column.name == name)
}
