//! Hand-eye calibration from pairs of poses.

use crate::arrays::Configurations;
use crate::chain::worked;
use crate::errors::argument;
use crate::poses::pose;
use denavit_hand_eye::report::{self, Lines};
use denavit_hand_eye::{Arrangement, Pair, solve};
use pyo3::prelude::*;

/// Text and JSON of both placements, from homogeneous matrices, row by row.
#[pyfunction]
pub fn hand_eye(
    py: Python<'_>,
    robot: &Bound<'_, PyAny>,
    seen: &Bound<'_, PyAny>,
    on_hand: bool,
) -> PyResult<(String, String)> {
    let (robot, seen) = (Configurations::of(robot, 16)?, Configurations::of(seen, 16)?);
    let (robot, seen) = (robot.values()?.as_chunks::<16>().0, seen.values()?.as_chunks::<16>().0);
    let pairs: Vec<Pair> =
        std::iter::zip(robot, seen).map(|(robot, seen)| Pair { robot: pose(robot), seen: pose(seen) }).collect();
    let arrangement = if on_hand { Arrangement::InstrumentOnHand } else { Arrangement::InstrumentStands };
    let mut found = None;
    worked(py, pairs.len(), || found = Some(solve(&pairs, arrangement)));
    let found = found.expect("the work is done").map_err(|error| argument(error.to_string()))?;
    let rows: Vec<usize> = (0..pairs.len()).collect();
    let lines = Lines { rows: &rows, unseen: &[] };
    Ok((report::text(&found, lines), report::json(&found, lines)))
}
