//! MJCF: a servo that is commanded beyond the range of its joint.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;

pub(super) const RULE: Rule = Rule {
    code: "D102",
    name: NAME,
    level: Level::Note,
    summary: "MJCF: the control range of a position actuator exceeds the range of its joint",
    why: "A position servo that is commanded beyond the joint limit keeps pressing against it. Often one of the two \
          ranges is in another unit: control ranges are never in degrees.",
    bad: "<mujoco><worldbody>\n  <body name=\"arm\">\n    <joint name=\"j\" range=\"-90 90\"/>\n    <geom size=\".1\"/>\n  </body>\n</worldbody>\n<actuator>\n  <position joint=\"j\" ctrlrange=\"-90 90\"/>\n</actuator></mujoco>",
    good: "<mujoco><worldbody>\n  <body name=\"arm\">\n    <joint name=\"j\" range=\"-90 90\"/>\n    <geom size=\".1\"/>\n  </body>\n</worldbody>\n<actuator>\n  <position joint=\"j\" ctrlrange=\"-1.57 1.57\"/>\n</actuator></mujoco>",
    fixable: false,
    check,
};

const NAME: &str = "control-beyond-range";

fn check(sheet: &Sheet) -> Vec<Found> {
    super::of_reader(sheet, NAME)
}
