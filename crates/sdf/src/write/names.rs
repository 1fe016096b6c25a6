//! Names: they must be unique among links, joints and frames of an SDF model.

use super::Part;
use super::scopes::{SEPARATOR, Scopes};
use crate::names::fresh;
use denavit_model::formats::Loss;
use denavit_model::{Joint, Robot};
use std::collections::HashSet;

/// The names of links and joints in the SDF.
pub(crate) struct Names {
    pub links: Vec<String>,
    pub joints: Vec<String>,
}

impl Names {
    pub fn of(robot: &Robot, parts: &[Part], scopes: &Scopes) -> Self {
        // A nested model must have another name than its siblings.
        let mut known: HashSet<String> = scopes.all().cloned().chain(["world".to_owned()]).collect();
        let allowed = |name: &str, tag: &str| {
            let scope = scopes.around(name);
            match name.strip_prefix(scope).and_then(|own| own.strip_prefix(SEPARATOR)) {
                Some(own) if !scope.is_empty() => format!("{scope}{SEPARATOR}{}", allowed(own, tag)),
                _ => allowed(name, tag),
            }
        };
        let links = robot.links.iter().zip(parts).map(|(link, part)| {
            if *part == Part::World { "world".to_owned() } else { fresh(&mut known, &allowed(&link.name, "link")) }
        });
        let links = links.collect();
        let joints = robot.joints.iter().map(|joint| {
            let name = allowed(&joint.name, "joint");
            let name = if known.contains(&name) { format!("{name}_joint") } else { name };
            fresh(&mut known, &name)
        });
        Self { links, joints: joints.collect() }
    }

    /// Written elements whose name differs from that in the robot.
    pub fn losses(&self, robot: &Robot, parts: &[Part]) -> Vec<Loss> {
        let why = |name: &String| {
            let why = if name.contains("__") {
                "\"::\" separates models"
            } else {
                "names of links, joints and frames must be unique"
            };
            format!("{why} in SDF: it is called \"{name}\" there")
        };
        let links = robot.links.iter().zip(&self.links).filter(|(link, name)| link.name != **name);
        let links = links.map(|(link, name)| {
            let place = robot.source.place(link.at, format!("link \"{}\"", link.name));
            Loss { place, what: format!("name of link \"{}\"", link.name), why: why(name) }
        });
        let joints = robot.joints.iter().zip(&self.joints).enumerate();
        let is_written = |joint: &Joint| parts[joint.parent] != Part::Joint;
        let joints = joints.filter(|(_, (joint, name))| joint.name != **name && is_written(joint)).map(
            |(index, (joint, name))| {
                let what = format!("name of joint \"{}\"", joint.name);
                Loss { place: robot.joint_place(index), what, why: why(name) }
            },
        );
        links.chain(joints).collect()
    }
}

/// A name that SDF allows: not a reserved one, and without its scope separator.
fn allowed(name: &str, tag: &str) -> String {
    let name = name.replace("::", "__");
    if name.is_empty() || name == "world" || name.starts_with("__") && name.ends_with("__") {
        return format!("{}_{tag}", name.trim_matches('_'));
    }
    name
}
