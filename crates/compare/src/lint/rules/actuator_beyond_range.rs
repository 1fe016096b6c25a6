//! MJCF: a servo that is told to go where its joint cannot.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;

pub(super) const RULE: Rule = Rule {
    code: "D102",
    name: NAME,
    level: Level::Note,
    summary: "MJCF: the control range of a position actuator goes beyond the range of its joint",
    why: "A position servo that is told to go beyond the joint's limit presses against it for as long as it is told so. Often one of the two is in \
          another unit: control ranges are never degrees.",
    bad: "<mujoco><worldbody>\n  <body name=\"arm\">\n    <joint name=\"j\" range=\"-90 90\"/>\n    <geom size=\".1\"/>\n  </body>\n</worldbody>\n<actuator>\n  <position joint=\"j\" ctrlrange=\"-90 90\"/>\n</actuator></mujoco>",
    good: "<mujoco><worldbody>\n  <body name=\"arm\">\n    <joint name=\"j\" range=\"-90 90\"/>\n    <geom size=\".1\"/>\n  </body>\n</worldbody>\n<actuator>\n  <position joint=\"j\" ctrlrange=\"-1.57 1.57\"/>\n</actuator></mujoco>",
    fixable: false,
    check,
};

const NAME: &str = "control-beyond-range";

fn check(sheet: &Sheet) -> Vec<Found> {
    super::of_reader(sheet, NAME)
}
