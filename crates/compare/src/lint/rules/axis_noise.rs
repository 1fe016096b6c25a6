//! Axes and pitch angles with the rounding error of a CAD program.

use crate::lint::finding::Found;
use crate::lint::sheet::words;
use crate::lint::{Edit, Rule, Sheet};
use crate::report::Level;
use denavit_model::intended;
use denavit_model::robot::Joint;

pub(super) const RULE: Rule = Rule {
    code: "D018",
    name: "drawing-noise",
    level: Level::Warning,
    summary: "An axis or a pitch angle differs from a round value by the rounding error of a CAD program",
    why: "`2.2e-08 -4.4e-08 -1.0` is 0 0 -1, and a pitch of -1.5707927 is a quarter turn: at gimbal lock half of the digits \
          are lost. Axes that should be parallel or perpendicular are not, and tables show 89.999997° or lengths of \
          kilometres. Only differences too small for a calibration are corrected.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"continuous\">\n  <axis xyz=\"2.2e-08 -4.4e-08 -1.0\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"continuous\">\n  <axis xyz=\"0 0 -1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: true,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    sheet.joints().iter().flat_map(|joint| [axis(sheet, joint), pitch(sheet, joint)]).flatten().collect()
}

fn axis(sheet: &Sheet, joint: &Joint) -> Option<Found> {
    let meant = joint.axis_meant.as_ref().filter(|_| joint.kind.moves())?;
    let at = sheet.below(joint.at, &["axis"]);
    let numbers: Vec<String> = meant.axis.iter().map(|x| format!("{}", x + 0.0)).collect();
    let what = format!(
        "axis \"{}\" is {} to {:.1e} rad; write {}",
        meant.written,
        meant.read_as,
        meant.turned,
        numbers.join(" ")
    );
    let edit = sheet.set_attribute(at, "xyz", numbers.join(" "));
    Some(Found::at(at, format!("joint \"{}\"", joint.name), what).fixed_by(edit.into_iter().collect()))
}

fn pitch(sheet: &Sheet, joint: &Joint) -> Option<Found> {
    let at = sheet.below(joint.at, &["origin"]);
    let (written, start) = sheet.written(at, "rpy")?;
    let (offset, word) = words(written).nth(1)?;
    let meant = intended::pitch_read_as(word)?;
    let what =
        format!("rpy: the pitch {word} is {} to {:.1e} rad; write {}", meant.read_as, meant.change.abs(), meant.angle);
    let edit = Edit { start: start + offset, end: start + offset + word.len(), text: format!("{}", meant.angle) };
    Some(Found::at(at, format!("joint \"{}\"", joint.name), what).fixed_by(vec![edit]))
}
