//! MJCF: angles written in another unit than the model uses.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;

pub(super) const RULE: Rule = Rule {
    code: "D100",
    name: NAME,
    level: Level::Warning,
    summary: "MJCF: hinge ranges are in radians in a model that uses degrees, or the reverse",
    why: "MJCF angles are in degrees unless `<compiler angle=\"radian\"/>` says otherwise, so that a range of ±1.57 \
          lets a joint turn by 1.6°. State the unit of the numbers.",
    bad: "<mujoco><worldbody>\n  <body name=\"arm\">\n    <joint name=\"j\" range=\"-1.5708 1.5708\"/>\n    <geom size=\".1\"/>\n  </body>\n</worldbody></mujoco>",
    good: "<mujoco>\n<compiler angle=\"radian\"/>\n<worldbody>\n  <body name=\"arm\">\n    <joint name=\"j\" range=\"-1.5708 1.5708\"/>\n    <geom size=\".1\"/>\n  </body>\n</worldbody></mujoco>",
    fixable: false,
    check,
};

const NAME: &str = "angle-unit";

fn check(sheet: &Sheet) -> Vec<Found> {
    super::of_reader(sheet, NAME)
}
