//! Nested models: links called `MODEL::LINK` go into their own `<model>` where SDF's naming rules allow it.

use denavit_model::{JointKind, Robot};
use std::collections::BTreeSet;

/// Between the name of a model and that of what is in it.
pub(crate) const SEPARATOR: &str = "::";

/// Nested models by their full names, outer ones before inner ones.
pub(crate) struct Scopes(BTreeSet<String>);

impl Scopes {
    /// A group is a model if nothing inside refers to anything outside: a joint named like its joints connects two of its links, and
    /// follows none but its own; one joint at most, of the model around it, carries one of its links.
    pub fn of(robot: &Robot) -> Self {
        let names = robot.links.iter().flat_map(|link| {
            link.name.match_indices(SEPARATOR).map(|(at, _)| link.name[..at].to_owned()).collect::<Vec<_>>()
        });
        let mut scopes = Self(BTreeSet::new());
        for name in names.filter(|name| !name.is_empty()).collect::<BTreeSet<String>>() {
            let outer = name.rsplit_once(SEPARATOR).map(|(outer, _)| outer);
            let last = name.rsplit(SEPARATOR).next().unwrap_or_default();
            let is_allowed = last != "world" && !(last.starts_with("__") && last.ends_with("__")) && !last.is_empty();
            if is_allowed && outer.is_none_or(|outer| scopes.0.contains(outer)) && is_closed(robot, &name) {
                scopes.0.insert(name);
            }
        }
        scopes
    }

    /// The innermost model that something of this name is in; empty for the robot itself.
    pub fn around(&self, name: &str) -> &str {
        let inner = self.0.iter().rfind(|scope| is_in(name, scope));
        inner.map_or("", String::as_str)
    }

    /// The models right inside another.
    pub fn inside(&self, scope: &str) -> Vec<String> {
        let outer = |name: &String| name.rsplit_once(SEPARATOR).map_or("", |(outer, _)| outer) == scope;
        self.0.iter().filter(|name| outer(name)).cloned().collect()
    }

    /// Every model.
    pub fn all(&self) -> impl Iterator<Item = &String> {
        self.0.iter()
    }
}

/// Whether a name is that of something in a model; everything is in the robot itself.
pub(crate) fn is_in(name: &str, scope: &str) -> bool {
    scope.is_empty() || name.strip_prefix(scope).is_some_and(|rest| rest.starts_with(SEPARATOR))
}

fn is_closed(robot: &Robot, scope: &str) -> bool {
    let inside = |link: usize| is_in(&robot.links[link].name, scope);
    let mut entering = 0;
    for joint in &robot.joints {
        let (parent, child, own) = (inside(joint.parent), inside(joint.child), is_in(&joint.name, scope));
        entering += usize::from(!parent && child);
        // What floats has no joint in SDF.
        if joint.kind == JointKind::Floating {
            continue;
        }
        let follows = joint.mimic.as_ref().is_none_or(|mimic| !own || is_in(&mimic.joint, scope));
        if own != (parent && child) || !follows {
            return false;
        }
    }
    let is_root = inside(robot.root);
    entering + usize::from(is_root) == 1
}
