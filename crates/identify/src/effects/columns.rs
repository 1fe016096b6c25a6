//! Names and units of the columns that drivers use.

use denavit_measurements::covariates::PAYLOAD;

/// Name of the covariate that gives the time of a row, s.
pub const TIME: &str = "time";
/// Name of the covariate that counts rows in run order.
pub const RUN_ORDER: &str = "run order";
/// Ending of the covariates that give the side from which a joint came, +1 from below.
pub const APPROACH: &str = ".approach";
/// The same, computed from the order of the rows.
pub const APPROACH_FROM_ROWS: &str = ".approach from run order";
/// Within the names of the covariates that give the wind-up of a joint since its last reversal, -1 to +1, for one of
/// [`MEMORIES`]: computed from the order of the rows.
pub const WOUND_UP: &str = ".wound up over";
/// Travel after a reversal to wind up a joint to all but 1/e, rad or m.
pub const MEMORIES: [f64; 3] = [0.02, 0.1, 0.5];
/// Within the names of the covariates that give a joint's warmth by its own work, rad or m by row or by second: computed from the order
/// of the rows, and the clock.
pub const WARMTH: &str = ".warmth over";
/// Ending of the covariates that give a joint's velocity.
pub const VELOCITY: &str = ".velocity";

/// Endings of the covariates that give a motor's load: torque, effort as in ROS (N·m; N for a slide), and current, A.
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
