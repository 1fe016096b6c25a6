//! MJCF: a range that limits nothing.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;

pub(super) const RULE: Rule = Rule {
    code: "D101",
    name: NAME,
    level: Level::Warning,
    summary: "MJCF: a joint states a range that has no effect",
    why: "With `<compiler autolimits=\"false\"/>` a range applies only with `limited=\"true\"`; with \
          `limited=\"false\"` it never applies. The joint turns or slides without end.",
    bad: "<mujoco>\n<compiler autolimits=\"false\"/>\n<worldbody>\n  <body name=\"arm\">\n    <joint name=\"j\" range=\"-90 90\"/>\n    <geom size=\".1\"/>\n  </body>\n</worldbody></mujoco>",
    good: "<mujoco>\n<compiler autolimits=\"false\"/>\n<worldbody>\n  <body name=\"arm\">\n    <joint name=\"j\" range=\"-90 90\" limited=\"true\"/>\n    <geom size=\".1\"/>\n  </body>\n</worldbody></mujoco>",
    fixable: false,
    check,
};

const NAME: &str = "range-without-effect";

fn check(sheet: &Sheet) -> Vec<Found> {
    super::of_reader(sheet, NAME)
}
