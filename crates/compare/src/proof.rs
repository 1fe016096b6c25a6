//! Compares two trees, one derived from the other, name by name: what is the same, and by how much it differs.

use denavit_model::placed::PlacedRobot;
use denavit_model::robot::{Geometry, JointKind};
use denavit_model::se3::{self, Pose};
use denavit_model::tree::Reading;
use denavit_model::{Robot, nalgebra::Vector3};
use std::collections::HashMap;

/// Number of random sets of joint values in addition to the limits.
const SAMPLES: usize = 20;

/// Differences up to this, relative to the robot's size, 1 rad, or the largest number of their kind in the robot, are rounding.
pub const ROUNDING: f64 = 1e-9;

/// What was compared, and the differences.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Proof {
    /// A line for each kind of thing: how many, and the largest difference.
    pub lines: Vec<String>,
    /// What differs by more than rounding, or is in only one of the two.
    pub differences: Vec<String>,
}

/// Compares every link of `a` with the link of the same name in `b`: frames at random joint values and at the limits,
/// masses, limits, mimics, shapes.
///
/// # Examples
/// ```
/// use denavit_model::urdf;
/// let text = r#"<robot name="r"><link name="a"/><link name="b"/>
///   <joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint></robot>"#;
/// let robot = urdf::read("r.urdf", text)?;
/// let proof = denavit_compare::proof::of(&robot, &robot);
/// assert!(proof.differences.is_empty() && proof.lines[0].starts_with("2 frames"));
/// # Ok::<(), denavit_model::UrdfError>(())
/// ```
pub fn of(a: &Robot, b: &Robot) -> Proof {
    let mut proof = Proof::default();
    let in_b: HashMap<&str, usize> =
        b.links.iter().enumerate().map(|(index, link)| (link.name.as_str(), index)).collect();
    let pairs: Vec<(usize, usize)> =
        a.links.iter().enumerate().filter_map(|(index, link)| Some((index, *in_b.get(link.name.as_str())?))).collect();
    for link in a.links.iter().filter(|link| !in_b.contains_key(link.name.as_str())) {
        proof.differences.push(format!("link \"{}\" is gone", link.name));
    }
    frames(a, b, &pairs, &mut proof);
    masses(a, b, &pairs, &mut proof);
    joints(a, b, &mut proof);
    shapes(a, b, &pairs, &mut proof);
    proof
}

/// root_from_link of every link, where the joints of these names have these values; others follow or stand at 0.
fn poses(placed: &PlacedRobot, values: &HashMap<String, f64>) -> Vec<Pose> {
    let robot = placed.robot();
    let mut poses = vec![Pose::identity(); robot.links.len()];
    for link in placed.order() {
        let Some(carrier) = placed.carrier(*link) else { continue };
        let joint = &robot.joints[carrier];
        let value = placed.drive(carrier).map_or(0.0, |drive| {
            let own = |driver: usize| values.get(&robot.joints[driver].name).copied().unwrap_or(0.0);
            drive.driver.map_or(0.0, own) * drive.scale + drive.offset
        });
        let axis = joint.axis.into_inner();
        let turn = |angle: f64| se3::pose(se3::rotation_about(&axis, angle), Vector3::zeros());
        let motion = match &joint.kind {
            JointKind::Revolute | JointKind::Continuous => turn(value),
            JointKind::Prismatic => se3::translation(axis * value),
            JointKind::Screw(pitch) => turn(value) * se3::translation(axis * (pitch.metres_per_radian() * value)),
            _ => Pose::identity(),
        };
        poses[*link] = poses[joint.parent] * joint.origin.pose() * motion;
    }
    poses
}

fn frames(a: &Robot, b: &Robot, pairs: &[(usize, usize)], proof: &mut Proof) {
    let (in_a, in_b) = (PlacedRobot::new(a, Reading::AsWritten), PlacedRobot::new(b, Reading::AsWritten));
    let moving: Vec<usize> = (0..a.joints.len())
        .filter(|joint| in_a.driver(*joint) == Some(*joint) && a.joints[*joint].mimic.is_none())
        .collect();
    let range = |joint: usize| match a.joints[joint].limits_in_force().interval() {
        Some(range) => range,
        None if a.joints[joint].kind == JointKind::Prismatic => (-1.0, 1.0),
        None => (-std::f64::consts::PI, std::f64::consts::PI),
    };
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = || {
        // A permuted congruential step: any spread of values will do here.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut trials: Vec<HashMap<String, f64>> = vec![HashMap::new()];
    let at = |part: &mut dyn FnMut() -> f64| -> HashMap<String, f64> {
        let value = |joint: &usize, part: f64| {
            let (lower, upper) = range(*joint);
            (a.joints[*joint].name.clone(), lower + part * (upper - lower))
        };
        moving.iter().map(|joint| value(joint, part())).collect()
    };
    trials.extend([at(&mut || 0.0), at(&mut || 1.0)]);
    trials.extend((0..SAMPLES).map(|_| at(&mut random)));
    let root = pairs.iter().find(|(link, _)| *link == a.root).map(|(_, link)| *link);
    let (mut farthest, mut turned, mut size, mut worst) = (0.0_f64, 0.0_f64, 1e-3_f64, String::new());
    for values in &trials {
        let (from_a, from_b) = (poses(&in_a, values), poses(&in_b, values));
        let base = root.map_or_else(Pose::identity, |root| from_b[root].inverse());
        for (one, other) in pairs {
            let (angle, distance) = se3::difference(&from_a[*one], &(base * from_b[*other]));
            size = size.max(from_a[*one].translation.vector.norm());
            if distance > farthest || angle > turned {
                worst.clone_from(&a.links[*one].name);
            }
            (farthest, turned) = (farthest.max(distance), turned.max(angle));
        }
    }
    proof.lines.push(format!(
        "{} frames at {} sets of joint values, including the limits: apart by at most {farthest:.1e} m and \
         {turned:.1e} rad",
        pairs.len(),
        trials.len()
    ));
    if farthest > ROUNDING * size || turned > ROUNDING {
        proof.differences.push(format!("frame \"{worst}\" is apart by {farthest:.1e} m, {turned:.1e} rad"));
    }
}

fn masses(a: &Robot, b: &Robot, pairs: &[(usize, usize)], proof: &mut Proof) {
    let (in_a, in_b) = (PlacedRobot::new(a, Reading::AsWritten), PlacedRobot::new(b, Reading::AsWritten));
    let root = pairs.iter().find(|(link, _)| *link == a.root).map(|(_, link)| *link);
    let base = root.map_or_else(Pose::identity, |root| in_b.pose(root).inverse());
    let r = base.rotation.matrix();
    let (mut heavier, mut off, mut turned, mut count) = (0.0_f64, 0.0_f64, 0.0_f64, 0);
    for (one, other) in pairs {
        let name = &a.links[*one].name;
        let weighs = |mass: Option<denavit_model::placed::PlacedMass>| mass.filter(|mass| mass.mass != 0.0);
        let (own, found) = match (weighs(in_a.mass(*one)), weighs(in_b.mass(*other))) {
            (None, None) => continue,
            (Some(own), Some(found)) => (own, found),
            (own, found) => {
                let mass = own.or(found).map_or(0.0, |mass| mass.mass);
                proof.differences.push(format!("link \"{name}\": a mass of {mass:e} kg is in only one of the two"));
                continue;
            }
        };
        count += 1;
        let mass = (own.mass - found.mass).abs() / own.mass.abs();
        let centre = (own.centre - base * found.centre).norm();
        // A zero tensor has no size.
        let scale = if own.tensor.norm() > 0.0 { own.tensor.norm() } else { 1.0 };
        let tensor = (own.tensor - r * found.tensor * r.transpose()).norm() / scale;
        (heavier, off, turned) = (heavier.max(mass), off.max(centre), turned.max(tensor));
        if mass > ROUNDING || centre > ROUNDING || tensor > ROUNDING {
            proof.differences.push(format!(
                "link \"{name}\": mass differs by {mass:.1e} (relative), its centre by {centre:.1e} m, its tensor by \
                 {tensor:.1e} (relative)"
            ));
        }
    }
    proof.lines.push(format!(
        "{count} masses: differ by at most {heavier:.1e} (relative), centres by {off:.1e} m, tensors by {turned:.1e} \
         (relative)"
    ));
}

fn joints(a: &Robot, b: &Robot, proof: &mut Proof) {
    let (mut limits, mut couplings, mut largest) = (0, 0, 0.0_f64);
    for joint in a.joints.iter().filter(|joint| joint.kind.moves()) {
        let name = &joint.name;
        let Some(other) = b.joint_index(name).map(|index| &b.joints[index]) else {
            proof.differences.push(format!("joint \"{name}\" is gone"));
            continue;
        };
        let bounds = |joint: &denavit_model::Joint| {
            let limits = joint.limits_in_force();
            let range = limits.range.filter(|(lower, upper)| lower < upper);
            [range.map(|range| range.0), range.map(|range| range.1), limits.effort.filter(|effort| *effort > 0.0)]
        };
        for (own, found) in bounds(joint).into_iter().zip(bounds(other)) {
            match (own, found) {
                (Some(own), Some(found)) => {
                    limits += 1;
                    let apart = (own - found).abs() / own.abs().max(1.0);
                    largest = largest.max(apart);
                    if apart > ROUNDING {
                        proof.differences.push(format!("joint \"{name}\": a limit of {own} is {found}"));
                    }
                }
                (None, None) => {}
                (own, found) => {
                    let value = own.or(found).unwrap_or(0.0);
                    proof.differences.push(format!("joint \"{name}\": a limit of {value} is in only one of the two"));
                }
            }
        }
        match (&joint.mimic, &other.mimic) {
            (None, None) => {}
            (Some(own), Some(found))
                if own.joint == found.joint
                    && (own.multiplier - found.multiplier).abs() <= ROUNDING * own.multiplier.abs().max(1.0)
                    && (own.offset - found.offset).abs() <= ROUNDING * own.offset.abs().max(1.0) =>
            {
                couplings += 1;
            }
            _ => proof.differences.push(format!("joint \"{name}\": its mimic is not the same")),
        }
    }
    proof.lines.push(format!("{limits} limits differ by at most {largest:.1e}, {couplings} mimics the same"));
}

/// Sizes of a shape, m; a mesh has its scale.
fn sizes(geometry: &Geometry) -> Vec<f64> {
    match geometry {
        Geometry::Box(edges) => edges.to_vec(),
        Geometry::Cylinder { radius, length } | Geometry::Capsule { radius, length } => vec![*radius, *length],
        Geometry::Sphere(radius) => vec![*radius],
        Geometry::Mesh { scale, .. } => scale.to_vec(),
        _ => Vec::new(),
    }
}

fn shapes(a: &Robot, b: &Robot, pairs: &[(usize, usize)], proof: &mut Proof) {
    let (mut count, mut largest) = (0, 0.0_f64);
    for (one, other) in pairs {
        let (one, other) = (&a.links[*one], &b.links[*other]);
        for (role, own, found) in
            [("visual", &one.visuals, &other.visuals), ("collision", &one.collisions, &other.collisions)]
        {
            if own.len() != found.len() {
                let (had, has) = (own.len(), found.len());
                proof.differences.push(format!("link \"{}\": {had} {role} shape(s) became {has}", one.name));
                continue;
            }
            for (own, found) in own.iter().zip(found) {
                count += 1;
                let (angle, distance) = se3::difference(&own.origin.pose(), &found.origin.pose());
                let (s, t) = (sizes(&own.geometry), sizes(&found.geometry));
                let kind = std::mem::discriminant(&own.geometry) == std::mem::discriminant(&found.geometry);
                let size = s.iter().zip(&t).map(|(s, t)| (s - t).abs()).fold(0.0, f64::max);
                let apart = angle.max(distance).max(size);
                largest = largest.max(apart);
                if !kind || s.len() != t.len() || apart > ROUNDING {
                    proof.differences.push(format!("link \"{}\": a {role} shape is not the same", one.name));
                }
            }
        }
    }
    proof.lines.push(format!("{count} shapes differ by at most {largest:.1e} m or rad"));
}
