//! Missing mesh files.

use crate::lint::finding::Found;
use crate::lint::{Lookup, Rule, Sheet};
use crate::report::Level;
use roxmltree::Node;
use std::collections::HashMap;

pub(super) const RULE: Rule = Rule {
    code: "D050",
    name: "mesh-not-found",
    level: Level::Error,
    summary: "A mesh file is missing",
    why: "`package://NAME/…` is searched in the folders of `‹package-path›`, of `package-path` in `denavit.toml` and \
          of ROS_PACKAGE_PATH, and in the parent folders of the file; other names are relative to the file's folder. \
          Upper and lower case must match where the file system distinguishes them.",
    bad: "<link name=\"base\">\n  <visual>\n    <geometry>\n      <mesh filename=\"meshes/bsae.stl\"/>\n    </geometry>\n  </visual>\n</link>",
    good: "<link name=\"base\">\n  <visual>\n    <geometry>\n      <mesh filename=\"meshes/base.stl\"/>\n    </geometry>\n  </visual>\n</link>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let mut found: Vec<Found> = Vec::new();
    // Of a package that is not there, one finding for all its meshes.
    let mut packages: HashMap<String, (Node, String, usize)> = HashMap::new();
    let mut order = Vec::new();
    for mesh in sheet.elements().filter(|node| node.tag_name().name() == "mesh") {
        let Some(name) = mesh.attribute("filename") else { continue };
        match sheet.look_up(name) {
            Lookup::NotFound(why) => {
                let what = format!("mesh {name} not found: {why}");
                found.push(Found::at(mesh.range().start, super::owner(mesh), what));
            }
            Lookup::NoPackage { package, why } => {
                if let Some((_, _, count)) = packages.get_mut(&package) {
                    *count += 1;
                } else {
                    order.push(package.clone());
                    packages.insert(package, (mesh, why, 1));
                }
            }
            Lookup::Found | Lookup::Unknown => {}
        }
    }
    for package in order {
        let Some((mesh, why, count)) = packages.remove(&package) else { continue };
        let meshes = if count == 1 { "a mesh is".to_owned() } else { format!("{count} meshes are") };
        let what = format!("{meshes} in package {package}, which was not found: {why}");
        found.push(Found::at(mesh.range().start, super::owner(mesh), what));
    }
    found
}
