//! Which parameters of a robot measurements can identify, as text and as JSON.

use crate::report::tables::table;
use denavit_identify::dh_form::DhForm;
use denavit_identify::identifiability::Identifiability;
use denavit_model::{Chain, Screw};
use serde_json::{Value, json};
use std::fmt::Write;

/// Version of the JSON.
pub const SCHEMA: &str = "denavit.identifiability/1";

/// The paper's count and the rank, for each kind of measurement; then what is unidentifiable and why.
pub fn identifiability(found: &[Identifiability]) -> String {
    let mut rows = vec![["measured", "count", "", "rank", "weakest"].map(String::from).to_vec()];
    for one in found {
        rows.push(vec![
            one.scene.words(),
            one.formula.clone(),
            format!("= {}", one.expected),
            one.rank.to_string(),
            format!("{:.1e}", one.smallest),
        ]);
    }
    let mut text = table(&rows);
    for one in found {
        // One line for all that is not identifiable for one reason.
        for together in one.unidentifiable.chunk_by(|a, b| a.why == b.why) {
            let names: Vec<&str> = together.iter().map(|unidentifiable| unidentifiable.parameter.as_str()).collect();
            let kind = one.scene.words();
            let _ = writeln!(text, "{kind}: {} not identifiable: {}", names.join(", "), together[0].why);
        }
    }
    text
}

/// Why joint offsets are not parameters.
const OFFSETS: &str = "with free axes and tool, no measurement identifies them";

/// What no measurement identifies in this form: joint offsets, and the position of slides' axes.
pub fn never_identifiable(chain: &Chain) -> String {
    let joints = chain.joints();
    let mut text = format!("joint offsets ({}) are not parameters of this form: {OFFSETS}\n", joints.len());
    let slides: Vec<String> = joints
        .iter()
        .filter(|joint| matches!(joint.screw, Screw::Prismatic(_)))
        .map(|joint| format!("\"{}\"", joint.name))
        .collect();
    if !slides.is_empty() {
        let _ = writeln!(
            text,
            "{} slides: measurements identify the direction of its axis, not its position",
            slides.join(", ")
        );
    }
    text
}

/// The D-H form of a chain: its numbers, how many are redundant and where, and what it cannot express.
pub fn dh_form(form: &DhForm, chain: &Chain) -> String {
    let name = |index: usize| chain.joints()[index].name.as_str();
    let mut text = format!(
        "D-H form with full poses: {} numbers, rank {}; {} too many in the base, {} in the tool\n",
        form.numbers, form.rank, form.redundant_in_base, form.redundant_in_tool
    );
    for &first in &form.parallel {
        let _ = writeln!(
            text,
            "  \"{}\" and \"{}\" are parallel neighbours: their d cannot be separated, and no small change of the row \
             tilts one against the other in the second direction; use the POE form or Hayati's row",
            name(first),
            name(first + 1)
        );
    }
    for &slide in &form.prismatic {
        let _ = writeln!(
            text,
            "  \"{}\" slides: its axis has no position, so two numbers next to it are free",
            name(slide)
        );
    }
    text
}

/// All of it as JSON; `rows`: readings that it was computed at.
pub fn to_json(chain: &Chain, rows: usize, found: &[Identifiability], form: &DhForm) -> String {
    let name = |index: &usize| chain.joints()[*index].name.clone();
    let unidentifiable = |one: &Identifiability| -> Vec<Value> {
        let entry = |unidentifiable: &denavit_identify::identifiability::UnidentifiableParameter| json!({"parameter": unidentifiable.parameter, "joint": unidentifiable.joint, "why": unidentifiable.why});
        one.unidentifiable.iter().map(entry).collect()
    };
    let poe: Vec<Value> = found
        .iter()
        .map(|one| {
            json!({
                "measurement": one.scene.measured(),
                "formula": one.formula,
                "expected": one.expected,
                "rank": one.rank,
                "smallest_singular_value": one.smallest,
                "unidentifiable": unidentifiable(one),
            })
        })
        .collect();
    let parallel: Vec<[String; 2]> = form.parallel.iter().map(|first| [name(first), name(&(first + 1))]).collect();
    let value = json!({
        "schema": SCHEMA,
        "robot": chain.name(),
        "base": chain.base(),
        "tip": chain.tip(),
        "rows": rows,
        "poe": poe,
        "joint_offsets": {"number": chain.joints().len(), "told": 0, "why": OFFSETS},
        "dh": {
            "numbers": form.numbers,
            "rank": form.rank,
            "redundant_in_base": form.redundant_in_base,
            "redundant_in_tool": form.redundant_in_tool,
            "parallel_neighbours": parallel,
            "slides": form.prismatic.iter().map(name).collect::<Vec<_>>(),
        },
    });
    serde_json::to_string_pretty(&value).expect("names are texts and numbers are numbers") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use denavit_identify::dh_form::dh_form as analyse;
    use denavit_model::examples;

    #[test]
    fn parallel_neighbours_are_named() {
        let chain = examples::planar_arm();
        let readings: Vec<Vec<f64>> = (0..20).map(|k| vec![0.3 * f64::from(k), 0.7 * f64::from(k)]).collect();
        let text = dh_form(&analyse(&chain, &readings), &chain);
        assert!(
            text.starts_with("D-H form with full poses: 20 numbers, rank 13; 4 too many in the base, 2 in the tool\n")
        );
        assert!(text.contains("\"joint_1\" and \"joint_2\" are parallel neighbours"), "{text}");
    }
}
