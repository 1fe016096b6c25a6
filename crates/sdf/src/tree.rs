//! From a graph of joints to a tree: which joints carry links, and which close loops.

use crate::frames::{FrameId, WORLD};
use std::collections::HashMap;

/// A joint between two bodies of the tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Edge {
    pub parent: FrameId,
    pub child: FrameId,
}

/// What a joint is in the tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    /// The parent carries the child.
    Carries,
    /// The child carries the parent: the path from the root runs against the joint.
    Reversed,
    /// Both ends are carried by other joints.
    Loop,
}

/// The tree of bodies.
#[derive(Debug)]
pub(crate) struct Tree {
    /// For each joint.
    pub roles: Vec<Role>,
    /// The root body.
    pub root: FrameId,
    /// Other bodies that no joint carries.
    pub free: Vec<FrameId>,
}

/// The tree of `bodies`, in their order; `main`: the body whose tree is the robot's, the world where it carries a joint.
pub(crate) fn tree(bodies: &[FrameId], edges: &[Edge], main: FrameId) -> Tree {
    let mut roles = vec![Role::Loop; edges.len()];
    // The joint that carries a body, and from which.
    let mut carried: HashMap<FrameId, (usize, FrameId)> = HashMap::new();
    let root_of = |carried: &HashMap<FrameId, (usize, FrameId)>, mut body: FrameId| {
        while let Some((_, below)) = carried.get(&body) {
            body = *below;
        }
        body
    };
    for (index, edge) in edges.iter().enumerate() {
        if edge.child != WORLD && !carried.contains_key(&edge.child) && root_of(&carried, edge.parent) != edge.child {
            roles[index] = Role::Carries;
            carried.insert(edge.child, (index, edge.parent));
        }
    }
    let uses_world = edges.iter().any(|edge| edge.parent == WORLD);
    let root = root_of(&carried, if uses_world { WORLD } else { main });
    // What joins two trees turns one of them over, so that its root is where they join; the robot's root stays.
    for (index, edge) in edges.iter().enumerate() {
        if roles[index] != Role::Loop {
            continue;
        }
        let (of_parent, of_child) = (root_of(&carried, edge.parent), root_of(&carried, edge.child));
        if of_parent == of_child {
            continue;
        }
        let child_hangs = of_child != root;
        let (near, far) = if child_hangs { (edge.parent, edge.child) } else { (edge.child, edge.parent) };
        turn_over(far, &mut carried, &mut roles);
        roles[index] = if child_hangs { Role::Carries } else { Role::Reversed };
        carried.insert(far, (index, near));
    }
    let free = bodies.iter().copied().filter(|body| *body != root && !carried.contains_key(body)).collect();
    Tree { roles, root, free }
}

/// Makes `body` the root of its tree.
fn turn_over(body: FrameId, carried: &mut HashMap<FrameId, (usize, FrameId)>, roles: &mut [Role]) {
    let mut way = Vec::new();
    let mut at = body;
    while let Some((joint, below)) = carried.remove(&at) {
        way.push((at, joint, below));
        at = below;
    }
    for (above, joint, below) in way {
        roles[joint] = if roles[joint] == Role::Carries { Role::Reversed } else { Role::Carries };
        carried.insert(below, (joint, above));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn roles(edges: &[(usize, usize)], main: usize) -> (Vec<Role>, usize, Vec<usize>) {
        let edges: Vec<Edge> = edges.iter().map(|(parent, child)| Edge { parent: *parent, child: *child }).collect();
        let Tree { roles, root, free } = tree(&[1, 2, 3, 4], &edges, main);
        (roles, root, free)
    }

    #[test]
    fn the_first_joint_to_a_link_carries_it_and_the_second_closes_a_loop() {
        use Role::{Carries, Loop};
        assert_eq!(roles(&[(1, 2), (2, 3), (1, 4), (4, 3)], 1), (vec![Carries, Carries, Carries, Loop], 1, vec![]));
        assert_eq!(roles(&[(1, 2), (2, 1)], 1), (vec![Carries, Loop], 1, vec![3, 4]));
        assert_eq!(roles(&[(WORLD, 2), (2, 1)], 1), (vec![Carries, Carries], WORLD, vec![3, 4]));
    }

    #[test]
    fn a_joint_from_another_tree_is_turned_round() {
        use Role::{Carries, Reversed};
        // 3 is carried by 2 of the tree of 1; 4 also carries 3, so that 4 is attached to 3.
        assert_eq!(roles(&[(1, 2), (2, 3), (4, 3)], 1), (vec![Carries, Carries, Reversed], 1, vec![]));
        // The tree 3 → 4 joins 1 at its end.
        assert_eq!(roles(&[(1, 2), (3, 4), (4, 2)], 1), (vec![Carries, Reversed, Reversed], 1, vec![]));
    }
}
