//! What the columns are called that drivers follow, and their units.

use denavit_measurements::covariates::PAYLOAD;

/// Name of the covariate that gives the time of a row, s.
pub const TIME: &str = "time";
/// Name of the covariate that counts rows in run order.
pub const RUN_ORDER: &str = "run order";
/// Ending of the covariates that give the side from which a joint came, +1 from below.
pub const APPROACH: &str = ".approach";
/// Ending of the same when it was read from the order of the rows.
pub const APPROACH_FROM_ROWS: &str = ".approach from run order";
/// Within the names of the covariates that say how far a joint has wound itself up since it last turned back, -1 to +1, for one of
/// [`MEMORIES`]: read from the order of the rows.
pub const WOUND_UP: &str = ".wound up over";
/// Travels after which a joint that turned back is wound up to all but 1/e, rad or m.
pub const MEMORIES: [f64; 3] = [0.02, 0.1, 0.5];
/// Within the names of the covariates that say how warm a joint's own work has made it, rad or m by row or by second: read from the order
/// of the rows, and of the clock.
pub const WARMTH: &str = ".warmth over";
/// Ending of the covariates that give a joint's velocity.
pub const VELOCITY: &str = ".velocity";

/// Endings of the covariates that give what a joint's motor works against: torque, the same as ROS calls it (N·m; N for a slide), and current, A.
pub const MOTOR_TORQUE: &str = ".torque";
/// See [`MOTOR_TORQUE`].
pub const EFFORT: &str = ".effort";
/// See [`MOTOR_TORQUE`].
pub const CURRENT: &str = ".current";

/// The unit that the contract gives to a recorded quantity.
pub fn unit_of(covariate: &str) -> &'static str {
    match covariate {
        TIME => "s",
        PAYLOAD => "kg",
        RUN_ORDER => "row",
        name if name.ends_with("temperature") => "°C",
        name if name.ends_with(MOTOR_TORQUE) || name.ends_with(EFFORT) => "N m",
        name if name.ends_with(CURRENT) => "A",
        _ => "1",
    }
}
