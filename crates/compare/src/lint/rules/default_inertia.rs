//! SDF: a mass that nobody stated.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;

pub(super) const RULE: Rule = Rule {
    code: "D110",
    name: NAME,
    level: Level::Warning,
    summary: "SDF: a link states no mass or no tensor, and weighs 1 kg with 1 kg·m² about each axis",
    why: "That is SDF's default, also for a link that is a mere frame. State `<inertial>`, or make the link a `<frame>`.",
    bad: "<sdf version=\"1.9\"><model name=\"m\">\n  <link name=\"base\"/>\n</model></sdf>",
    good: "<sdf version=\"1.9\"><model name=\"m\">\n  <link name=\"base\">\n    <inertial><mass>2</mass><inertia><ixx>.1</ixx><iyy>.1</iyy><izz>.1</izz></inertia></inertial>\n  </link>\n</model></sdf>",
    fixable: false,
    check,
};

const NAME: &str = "default-inertia";

fn check(sheet: &Sheet) -> Vec<Found> {
    super::of_reader(sheet, NAME)
}
