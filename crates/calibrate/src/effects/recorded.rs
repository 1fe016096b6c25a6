//! Which recorded quantities an effect hangs on: what must be known to say what it does.

use crate::effects::carrier::Carrier;
use crate::effects::driver::{APPROACH, APPROACH_FROM_ROWS, Driver, RUN_ORDER, VELOCITY};
use crate::effects::model::Term;
use crate::observation::measurements::Covariate;
use denavit_model::Chain;

/// Names of the quantities without which nothing can be said, such as `temperature` or `elbow.approach`.
///
/// A payload is never among them: nothing given is nothing carried.
pub fn needed(term: &Term, chain: &Chain) -> Vec<String> {
    let joint = |index: usize, ending: &str| format!("{}{ending}", chain.joints()[index].name);
    match &term.driver {
        Driver::Approach { joint: index, from_rows: true } => vec![joint(*index, APPROACH_FROM_ROWS)],
        Driver::Approach { joint: index, from_rows: false } => vec![joint(*index, APPROACH)],
        Driver::Velocities => (0..chain.joints().len()).map(|index| joint(index, VELOCITY)).collect(),
        driver => driver.covariate().map(String::from).into_iter().collect(),
    }
}

/// The name under which a person gives a quantity: a side of approach is one, whether a file gives it or the order of rows.
pub fn plain(name: &str) -> String {
    name.strip_suffix(APPROACH_FROM_ROWS).map_or_else(|| name.to_owned(), |joint| format!("{joint}{APPROACH}"))
}

/// A quantity's value among those given under plain names.
pub fn given(values: &[(String, f64)], name: &str) -> Option<f64> {
    let name = plain(name);
    values.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
}

/// Whether a run with these columns tells a quantity: as a column, or by the order of its rows.
pub fn told_by_run(name: &str, columns: &[Covariate]) -> bool {
    name == RUN_ORDER || name.ends_with(APPROACH_FROM_ROWS) || columns.iter().any(|column| column.name == name)
}

/// Whether an effect has a part in where the tip is; the others change what is measured.
pub fn moves_the_tip(term: &Term) -> bool {
    !matches!(term.carrier, Carrier::Target | Carrier::Anchor | Carrier::Scale | Carrier::Reading)
}

impl Driver {
    /// What is wrong with the numbers of a driver that was written by hand.
    pub(super) fn fault(&self) -> Option<String> {
        let good = match self {
            Self::Harmonic { order, .. } => order.is_finite(),
            Self::Bump { at, width, .. } => at.is_finite() && *width > 0.0,
            Self::Decay { from, constant, .. } => from.is_finite() && *constant > 0.0,
            Self::Steps { at, .. } => !at.is_empty() && at.is_sorted(),
            Self::Smooth { knots, .. } => knots.len() > 1 && knots.windows(2).all(|pair| pair[0] < pair[1]),
            _ => true,
        };
        (!good).then(|| {
            "a number of its driver cannot be; width and constant are above 0, steps ascend, and knots are two or more \
             that rise"
                .into()
        })
    }
}
