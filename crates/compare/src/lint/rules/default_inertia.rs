//! SDF: a mass that is not stated.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;

pub(super) const RULE: Rule = Rule {
    code: "D110",
    name: NAME,
    level: Level::Warning,
    summary: "SDF: a link states no mass or inertia, so it has 1 kg and 1 kg·m² about each axis",
    why: "That is the SDF default, even for a link that is only a frame. State `<inertial>`, or make the link a \
          `<frame>`.",
    bad: "<sdf version=\"1.9\"><model name=\"m\">\n  <link name=\"base\"/>\n</model></sdf>",
    good: "<sdf version=\"1.9\"><model name=\"m\">\n  <link name=\"base\">\n    <inertial><mass>2</mass><inertia><ixx>.1</ixx><iyy>.1</iyy><izz>.1</izz></inertia></inertial>\n  </link>\n</model></sdf>",
    fixable: false,
    check,
};

const NAME: &str = "default-inertia";

fn check(sheet: &Sheet) -> Vec<Found> {
    super::of_reader(sheet, NAME)
}
