//! What is hashed: a tree of joints, each hashed with what is attached to it; what has no order is sorted by its hash.

use crate::fingerprint::cells::Cells;
use crate::mechanism::{Frame, Mass, Mechanism, MovingJoint, PartPlace, PlacedElement, PlacedShape, Role};
use denavit_model::nalgebra::{Matrix3, Vector3};
use denavit_model::robot::Geometry;
use sha2::{Digest, Sha256};
use std::collections::{HashMap, HashSet};

type Hash = [u8; 32];

/// The hash, then its values for each choice of sides for the numbers near a border.
pub(super) fn hashes(tolerance: f64, digest: impl Fn(&mut Cells) -> Hash) -> Vec<String> {
    let short = |hash: Hash| {
        let [.., a, b, c, d, e, f] = hash;
        format!("{a:02x}{b:02x}{c:02x}{d:02x}{e:02x}{f:02x}")
    };
    let mut cells = Cells::new(tolerance, 0);
    let mut result = vec![short(digest(&mut cells))];
    for choice in 1..1u32 << cells.unsure() {
        result.push(short(digest(&mut Cells::new(tolerance, choice))));
    }
    result
}

/// Words and cells on their way into a hash.
#[derive(Default)]
struct Words(Sha256);

impl Words {
    fn of(tag: &str) -> Self {
        let mut words = Self::default();
        words.text(tag);
        words
    }

    fn text(&mut self, text: &str) {
        self.0.update((text.len() as u64).to_le_bytes());
        self.0.update(text.as_bytes());
    }

    fn cells(&mut self, cells: impl IntoIterator<Item = i64>) {
        for cell in cells {
            self.0.update(cell.to_le_bytes());
        }
    }

    fn vector(&mut self, cells: &mut Cells, vector: &Vector3<f64>) {
        self.cells(vector.iter().map(|x| cells.of(*x)));
    }

    /// Nine components: of a matrix that changes by the tolerance, one changes by a third of it or more.
    fn matrix(&mut self, cells: &mut Cells, matrix: &Matrix3<f64>) {
        self.cells(matrix.iter().map(|x| cells.of(*x * 3f64.sqrt())));
    }

    /// Hashes whose order does not matter.
    fn unordered(&mut self, mut hashes: Vec<Hash>) {
        hashes.sort_unstable();
        self.0.update((hashes.len() as u64).to_le_bytes());
        for hash in hashes {
            self.0.update(hash);
        }
    }

    fn hash(self) -> Hash {
        self.0.finalize().into()
    }
}

/// Axes, kinds, pitches, limits, couplings, empty leaf frames.
pub(super) fn motion(mechanism: &Mechanism, cells: &mut Cells) -> Hash {
    let named = mechanism.joint_indices();
    tree(mechanism, cells, &|words, cells, body| {
        if let Some(joint) = body.checked_sub(1) {
            joint_motion(words, mechanism, cells, &named, joint);
        }
        let empty = mechanism.bodies[body].frames.iter().filter(|frame| frame.leaf && !frame.matter);
        let tips = empty.map(|frame| tip(cells, frame)).collect();
        words.unordered(tips);
    })
}

/// Masses, shapes, speeds, efforts, damping, friction, soft limits, and elements other than links and joints.
pub(super) fn matter(mechanism: &Mechanism, cells: &mut Cells) -> Hash {
    let mut elements: Vec<Vec<&PlacedElement>> = vec![Vec::new(); mechanism.bodies.len()];
    for element in &mechanism.elements {
        elements[element.body].push(element);
    }
    let names = names(mechanism);
    tree(mechanism, cells, &|words, cells, body| {
        if let Some(joint) = body.checked_sub(1) {
            let MovingJoint { limits, dynamics, soft_limits, idle_range, calibration, .. } = &mechanism.joints[joint];
            if let Some((lower, upper)) = idle_range {
                words.text("idle range");
                words.cells([cells.of(*lower), cells.of(*upper)]);
            }
            if let Some(sensor) = calibration {
                words.text("calibration");
                for at in [sensor.rising, sensor.falling, sensor.reference_position] {
                    words.cells(at.map_or([0, 1], |at| [cells.of(at), 0]));
                }
            }
            for bound in [limits.velocity, limits.effort] {
                words.cells(bound.map_or([0, 1], |bound| cells.relative(bound)));
            }
            for loss in [dynamics.damping, dynamics.friction] {
                words.cells(cells.relative(loss));
            }
            if let Some(soft) = soft_limits {
                words.text("soft");
                if let Some((lower, upper)) = soft.range {
                    words.cells([cells.of(lower), cells.of(upper)]);
                }
                for factor in [soft.k_position, soft.k_velocity] {
                    words.cells(cells.relative(factor));
                }
            }
        }
        if let Some(mass) = &mechanism.bodies[body].mass {
            weight(words, cells, mass);
        }
        let shapes = mechanism.bodies[body].shapes.iter().map(|placed| shape(cells, placed)).collect();
        words.unordered(shapes);
        let further = elements[body].iter().map(|found| element(cells, &names, found)).collect();
        words.unordered(further);
    })
}

/// Names of links and joints, which are not hashed.
fn names(mechanism: &Mechanism) -> HashSet<&str> {
    let links = mechanism.bodies.iter().flat_map(|body| &body.frames).map(|frame| frame.link.as_str());
    let joints = mechanism.joints.iter().map(|joint| joint.name.as_str());
    let fixed = mechanism.fixed.iter().map(|(name, _)| name.as_str());
    links.chain(joints).chain(fixed).collect()
}

/// An element's kind and values: numbers as numbers, names of links and joints only as placeholders.
fn element(cells: &mut Cells, names: &HashSet<&str>, element: &PlacedElement) -> Hash {
    // Every second piece of a path is in quotes: a name.
    let nameless = |path: &str| path.split('"').step_by(2).collect::<String>();
    let mut of_entry = |(path, value): &(String, String)| {
        let mut words = Words::of(&nameless(path));
        if names.contains(value.as_str()) {
            words.text("name");
            return words.hash();
        }
        for word in value.split_whitespace() {
            match word.parse::<f64>() {
                Ok(number) if number.is_finite() => words.cells(cells.relative(number)),
                _ => words.text(word),
            }
        }
        words.hash()
    };
    // The order of an element's values has no meaning.
    let entries = element.entries.iter().map(&mut of_entry).collect();
    let parts = element.parts.iter().map(|part| {
        let mut words = Words::of(&nameless(&part.path));
        match &part.place {
            PartPlace::Pose(pose) | PartPlace::Inside(pose) => {
                words.matrix(cells, pose.rotation.matrix());
                words.vector(cells, &pose.translation.vector);
            }
            PartPlace::Point(point) => words.vector(cells, &point.coords),
            PartPlace::Direction(direction) => words.matrix(cells, &(direction * direction.transpose())),
        }
        words.hash()
    });
    let parts: Vec<Hash> = parts.collect();
    let mut words = Words::of(&element.kind);
    words.unordered(entries);
    if !parts.is_empty() {
        words.unordered(parts);
    }
    words.hash()
}

type Contents<'a> = dyn Fn(&mut Words, &mut Cells, usize) + 'a;

/// A body, then its descendants: each body is hashed from the root on, then each hash goes into that of its parent.
fn tree(mechanism: &Mechanism, cells: &mut Cells, contents: &Contents) -> Hash {
    let mut open: Vec<Words> = Vec::with_capacity(mechanism.bodies.len());
    for body in 0..mechanism.bodies.len() {
        let mut words = Words::of("body");
        contents(&mut words, cells, body);
        open.push(words);
    }
    let mut behind: Vec<Vec<Hash>> = vec![Vec::new(); mechanism.bodies.len()];
    while let Some(mut words) = open.pop() {
        let body = open.len();
        words.unordered(std::mem::take(&mut behind[body]));
        let hash = words.hash();
        match body.checked_sub(1) {
            Some(joint) => behind[mechanism.joints[joint].parent.map_or(0, |parent| parent + 1)].push(hash),
            None => return hash,
        }
    }
    [0; 32]
}

fn joint_motion(
    words: &mut Words,
    mechanism: &Mechanism,
    cells: &mut Cells,
    named: &HashMap<&str, usize>,
    index: usize,
) {
    let joint = &mechanism.joints[index];
    words.text(&joint.kind);
    axis(words, cells, joint);
    words.text(if joint.limits.range.is_some() { "limits" } else { "unlimited" });
    if let Some((lower, upper)) = joint.limits.range {
        words.cells([cells.of(lower), cells.of(upper)]);
    }
    if let Some((driver, factor, offset)) = &joint.mimic {
        words.text("mimic");
        // By the joint that moves it in the end, and by that joint's axis, since names are not hashed.
        let stated = (named.get(driver.as_str()).copied(), *factor, *offset);
        let (driver, factor, offset) =
            mechanism.driver(index, named).map_or(stated, |(driver, factor, offset)| (Some(driver), factor, offset));
        words.cells(cells.relative(factor));
        words.cells([cells.of(offset)]);
        match driver {
            Some(driver) => axis(words, cells, &mechanism.joints[driver]),
            None => words.text("nothing"),
        }
    }
}

/// Direction, and the moment of the line about the root's origin: its unit twist without the pitch, and the pitch.
fn axis(words: &mut Words, cells: &mut Cells, joint: &MovingJoint) {
    let Some(screw) = &joint.screw else { return };
    words.vector(cells, &screw.direction());
    if let Some(line) = screw.line() {
        words.vector(cells, &line.point.coords.cross(&line.direction));
    }
    if let Some(pitch) = screw.pitch() {
        words.cells([cells.of(pitch)]);
    }
}

fn tip(cells: &mut Cells, frame: &Frame) -> Hash {
    let mut words = Words::of("tip");
    words.matrix(cells, frame.pose.rotation.matrix());
    words.vector(cells, &frame.pose.translation.vector);
    words.hash()
}

fn weight(words: &mut Words, cells: &mut Cells, mass: &Mass) {
    let scale = mass.tensor.norm();
    if mass.mass == 0.0 && scale == 0.0 {
        return;
    }
    words.text("mass");
    words.cells(cells.relative(mass.mass));
    words.vector(cells, &mass.centre.coords);
    words.cells(cells.relative(scale));
    if scale > 0.0 {
        words.matrix(cells, &(mass.tensor / scale));
    }
}

fn shape(cells: &mut Cells, placed: &PlacedShape) -> Hash {
    let mut words = Words::of(match placed.role {
        Role::Visual => "visual",
        Role::Collision => "collision",
    });
    words.vector(cells, &placed.pose.translation.vector);
    let turn = placed.pose.rotation.matrix();
    let mut sized = |words: &mut Words, kind: &str, sizes: &[f64]| {
        words.text(kind);
        words.cells(sizes.iter().map(|size| cells.of(*size)));
    };
    match &placed.geometry {
        Geometry::Sphere(radius) => sized(&mut words, "sphere", &[*radius]),
        Geometry::Cylinder { radius, length } | Geometry::Capsule { radius, length } => {
            let kind = if matches!(placed.geometry, Geometry::Cylinder { .. }) { "cylinder" } else { "capsule" };
            sized(&mut words, kind, &[*radius, *length]);
            // The same upside down.
            let z = turn.column(2);
            words.matrix(cells, &(z * z.transpose()));
        }
        Geometry::Box(edges) => {
            sized(&mut words, "box", edges);
            words.matrix(cells, turn);
        }
        Geometry::Mesh { filename, scale } => {
            words.text(filename);
            sized(&mut words, "mesh", scale);
            words.matrix(cells, turn);
        }
        Geometry::Other(element) => {
            words.text(element);
            words.matrix(cells, turn);
        }
        _ => words.matrix(cells, turn),
    }
    words.hash()
}
