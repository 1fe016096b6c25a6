//! The side from which a joint approached its position, as a driver uses it.

use crate::effects::driver::{APPROACH, APPROACH_FROM_ROWS};
use denavit_measurements::{Column, RecordedRow};
use denavit_model::Chain;
use serde::{Deserialize, Serialize};

/// The side from which a joint came, +1 from below, and where it is recorded.
///
/// `C`: as that of [`Driver`](super::Driver).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Side<C = Column> {
    /// The joint, counted from 0.
    pub joint: usize,
    /// Computed from the order of the rows, since the file does not give it.
    pub from_rows: bool,
    /// Where it is recorded.
    #[serde(skip)]
    pub column: C,
}

impl<C> Side<C> {
    /// The same, recorded elsewhere.
    ///
    /// # Errors
    /// Those of `named`.
    pub(super) fn named_by<D, E>(&self, named: impl FnOnce(&C) -> Result<D, E>) -> Result<Side<D>, E> {
        Ok(Side { joint: self.joint, from_rows: self.from_rows, column: named(&self.column)? })
    }
}

impl Side<String> {
    /// Names the column of the chain's joint.
    pub(in crate::effects) fn name_column(&mut self, chain: &Chain) {
        let ending = if self.from_rows { APPROACH_FROM_ROWS } else { APPROACH };
        self.column = format!("{}{ending}", chain.joints()[self.joint].name);
    }
}

impl Side {
    /// Its value in a row.
    pub(super) fn value(&self, recorded: &RecordedRow<'_>) -> f64 {
        recorded.value(&self.column)
    }

    /// The side on which a joint with play comes to rest, +1 or -1, with friction under this torque (N·m; N for a slide): approach from
    /// below lags, as does a joint that gravity pushes down.
    pub(super) fn at_rest(&self, recorded: &RecordedRow<'_>, torque: f64, friction: f64) -> f64 {
        side_of(torque - friction * self.value(recorded))
    }
}

/// The side to which a torque pushes, +1 or -1.
pub(super) fn side_of(torque: f64) -> f64 {
    if torque < 0.0 { -1.0 } else { 1.0 }
}
