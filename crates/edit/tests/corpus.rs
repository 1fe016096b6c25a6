//! Every operation over every URDF at hand: done, refused with the reason, never wrong.

use crate::support::{files, top};
use denavit_compare::comparison::PartKind;
use denavit_compare::{Options, PartDifference, Subject, compare};
use denavit_edit::{Actual, EditError, Files, Frames, Operation, Text, Triangle, Words, apply};
use denavit_model::chain::ChainJoint;
use denavit_model::nalgebra::Vector3;
use denavit_model::robot::{Geometry, Robot};
use denavit_model::{Chain, Reading, se3, urdf};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

/// One in so many files of the corpus is edited, where `DENAVIT_EVERY` says nothing.
const EVERY: usize = 40;

/// Folders beside the project and those that the environment names, separated by colons.
fn corpus() -> Vec<PathBuf> {
    let mut folders = vec![top().join("robots")];
    let vendor = top().join("../shared/vendor");
    if vendor.is_dir() {
        folders.extend([vendor.join("robots"), vendor.join("xacro"), vendor.join("quirky")]);
    } else {
        println!(
            "skipped, because the vendors' files (../shared/vendor) are not beside this clone: their part of the corpus"
        );
    }
    if let Ok(more) = std::env::var("DENAVIT_ROBOTS") {
        folders.extend(more.split(':').map(PathBuf::from));
    }
    folders.iter().filter(|folder| folder.is_dir()).flat_map(|folder| files(folder, "urdf")).collect()
}

/// An operation that is asked of a robot, and the one that undoes it, if one can.
struct Asked {
    name: &'static str,
    there: Operation,
    back: Option<Operation>,
}

const GRIPPER: &str = r#"<robot name="gripper">
  <link name="palm"><visual><geometry><box size="1 1 1"/></geometry></visual></link> <link name="finger"/>
  <joint name="slide" type="prismatic">
    <parent link="palm"/> <child link="finger"/> <axis xyz="0 1 0"/> <limit lower="0" upper="0.1" effort="1" velocity="1"/>
  </joint>
</robot>"#;

#[allow(clippy::needless_pass_by_value, reason = "made where it is passed")]
fn operation(words: Words) -> Operation {
    Operation::of(&words).unwrap()
}

/// Words of an operation, where names have no blanks.
fn plain(line: &[&str]) -> Words {
    Words { words: line.iter().map(|word| (*word).to_owned()).collect(), ..Words::default() }
}

fn asked(robot: &Robot) -> Vec<Asked> {
    let mut asked: Vec<Asked> = Vec::new();
    let mut ask = |name: &'static str, there: Words, back: Option<Words>| {
        asked.push(Asked { name, there: operation(there), back: back.map(operation) });
    };
    for joint in robot.joints.iter().filter(|joint| joint.kind.has_one_value()).take(2) {
        let name = joint.name.as_str();
        ask("flip", plain(&["flip", name]), Some(plain(&["flip", name])));
        let zero = |value: &str| plain(&["zero", &format!("{name}={value}")]);
        ask("zero", zero("0.25"), Some(zero("-0.25")));
    }
    let root = robot.links[robot.root].name.as_str();
    for leaf in robot.leaves().into_iter().take(1) {
        let leaf = robot.links[leaf].name.as_str();
        ask("reroot", plain(&["reroot", leaf]), Some(plain(&["reroot", root])));
        let other = Text { file: "gripper.urdf".into(), text: GRIPPER.into() };
        let attached = Words {
            other: Some(other),
            at: Some(leaf.to_owned()),
            pose: Some("0,0,0.125,0,0,90deg".into()),
            prefix: Some("gripper_".into()),
            ..plain(&["attach", "gripper.urdf"])
        };
        ask("attach", attached, Some(plain(&["cut", "gripper_palm"])));
        let origin = |to: &str| Words { to: Some(to.into()), ..plain(&["origin", leaf]) };
        ask("origin", origin("0,0,0.125"), Some(origin("0,0,-0.125")));
    }
    ask(
        "rename",
        plain(&["rename", &format!("link:{root}=another_root")]),
        Some(plain(&["rename", &format!("link:another_root={root}")])),
    );
    ask("prefix", plain(&["prefix", "left_"]), None);
    ask("merge", plain(&["merge"]), None);
    ask("mirror", plain(&["mirror", "xz"]), Some(plain(&["mirror", "xz"])));
    ask("mirror", plain(&["mirror", "yz"]), Some(plain(&["mirror", "yz"])));
    let middle = robot.links[robot.links.len() / 2].name.as_str();
    ask("extract", plain(&["extract", middle]), None);
    ask("cut", plain(&["cut", middle]), None);
    ask("scale", plain(&["scale", "2"]), Some(plain(&["scale", "0.5"])));
    ask("snap", plain(&["snap"]), None);
    ask("canonical", plain(&["canonical"]), None);
    ask("recentre", plain(&["recentre"]), None);
    let uris = uris(robot);
    let tetrahedron = [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.3]].map(Vector3::from);
    let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let triangles: Vec<Triangle> = faces.map(|face| face.map(|corner: usize| tetrahedron[corner])).to_vec();
    for shape in ["smallest", "hull"] {
        let simple = Words {
            meshes: uris.iter().map(|uri| (uri.clone(), Ok(triangles.clone()))).collect(),
            folder: Some("hulls/".into()),
            to: Some("hulls".into()),
            ..plain(&["simplify-collision", shape])
        };
        ask("simplify-collision", simple, None);
    }
    let new = |index: usize| format!("copies/{index}.stl");
    let there = uris.iter().enumerate().map(|(index, uri)| (uri.trim().to_owned(), new(index))).collect();
    let back = uris.iter().enumerate().map(|(index, uri)| (new(index), uri.clone())).collect();
    let copied = |copies| Words { copies, to: Some("copies".into()), ..plain(&["meshes"]) };
    ask("meshes", copied(there), Some(copied(back)));
    if let Ok(drawn) = robot.chain(None, None, Reading::AsWritten) {
        let set = |chain: Chain| Words {
            actual: Some(Actual::Chain { chain: Box::new(chain), frames: Frames::Own }),
            ..plain(&["set-calibration", "arm.json"])
        };
        ask("set-calibration", set(disturbed(&drawn.value)), Some(set(drawn.value)));
    }
    asked
}

fn uris(robot: &Robot) -> Vec<String> {
    let shapes = robot.links.iter().flat_map(|link| link.visuals.iter().chain(&link.collisions));
    let names: BTreeSet<String> = shapes
        .filter_map(|shape| match &shape.geometry {
            Geometry::Mesh { filename, .. } => Some(filename.clone()),
            _ => None,
        })
        .collect();
    names.into_iter().collect()
}

/// The chain with every axis turned by about 0.1 mrad and moved by about 0.1 mm.
fn disturbed(chain: &Chain) -> Chain {
    let joints = chain.joints().iter().enumerate().map(|(index, joint)| {
        let sign = if index % 2 == 0 { 1e-4 } else { -1e-4 };
        let step = se3::pose(
            se3::rotation_from_rpy([sign, sign / 2.0, 0.0]),
            Vector3::new(0.0, sign, sign) * chain.size().min(1.0),
        );
        ChainJoint { screw: joint.screw.moved(&step), ..joint.clone() }
    });
    let names = (chain.name(), chain.base(), chain.tip());
    Chain::new(names, chain.coordinates().to_vec(), joints.collect(), *chain.home()).unwrap()
}

fn same(before: &Robot, text: &str) -> Result<(), String> {
    let after = urdf::read("after.urdf", text).map_err(|error| error.to_string())?;
    let options = Options { samples: 0, reading: Reading::AsWritten, ..Options::default() };
    let found =
        compare(&Subject::Robot(before), &Subject::Robot(&after), &options).map_err(|error| error.to_string())?;
    // A default that is stated is the same transmission.
    let stated = |part: &&PartDifference| {
        part.kind == PartKind::Element
            && (part.what.ends_with("mechanicalReduction: 1 is new")
                || part.what.contains("offset: 0")
                || part.what.starts_with("actuator") && part.what.ends_with("is gone"))
    };
    let joints = found.joints.iter().find(|joint| joint.changes.iter().any(|change| change.counts));
    let part = found.parts.iter().find(|part| part.counts && !stated(part));
    if joints.is_none() && part.is_none() { Ok(()) } else { Err(format!("{joints:?} {part:?}")) }
}

#[test]
fn every_operation_over_every_file_is_done_or_refused() {
    let mut counts: BTreeMap<&str, [usize; 4]> = BTreeMap::new();
    let mut reasons: BTreeMap<String, usize> = BTreeMap::new();
    let mut wrong = Vec::new();
    let paths = corpus();
    let mut read = 0;
    // All files take minutes; every one in so many, from the first on.
    let every = std::env::var("DENAVIT_EVERY").ok().and_then(|every| every.parse().ok()).unwrap_or(EVERY);
    for path in paths.iter().step_by(every) {
        let Ok(text) = std::fs::read_to_string(path) else { continue };
        let Ok(robot) = urdf::read("before.urdf", &text) else { continue };
        read += 1;
        for Asked { name, there, back } in asked(&robot) {
            let count = counts.entry(name).or_default();
            match apply(&Files::urdf("robot.urdf", &*text), std::slice::from_ref(&there)) {
                Ok(done) => {
                    count[0] += 1;
                    let Some(back) = back else { continue };
                    match apply(&done.files, &[back]) {
                        Ok(again) if again.files.urdf.text == text => count[3] += 1,
                        // Axes that were turned there and back are where they were to rounding, in other digits.
                        Ok(_) if name == "set-calibration" => {}
                        Ok(again) => {
                            if let Err(what) = same(&robot, &again.files.urdf.text) {
                                wrong.push(format!("{}: {there}, and back: {what}", path.display()));
                            }
                        }
                        Err(error) => wrong.push(format!("{}: {there}, back: {error}", path.display())),
                    }
                }
                Err(error @ EditError::Unproved { .. }) => {
                    count[2] += 1;
                    wrong.push(format!("{}: {error}", path.display()));
                }
                Err(error) => {
                    count[1] += 1;
                    let said = error.to_string();
                    let reason = said.rsplit(": ").next().unwrap_or_default().to_owned();
                    *reasons.entry(format!("{name}: {reason}")).or_default() += 1;
                }
            }
        }
    }
    println!("{read} of {} files are robots", paths.len());
    println!("| operation | done | refused with the reason | undone byte for byte | wrong |\n|---|---|---|---|---|");
    for (name, [done, refused, unproved, bytes]) in &counts {
        println!("| {name} | {done} | {refused} | {bytes} | {unproved} |");
    }
    for (reason, count) in &reasons {
        println!("  {count} × {reason}");
    }
    assert!(read > 0);
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong.join("\n"));
}
