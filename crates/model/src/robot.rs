//! A robot as its URDF describes it: links, joints, and their source text.

use crate::chain::Limits;
use crate::element::Element;
use crate::formats::{Format, Kept, Translation};
use crate::intended::{self, IntendedAngle, IntendedAxis};
use crate::inventory::Inventory;
use crate::loops::Loop;
use crate::notes::{Note, Place};
use crate::se3::{self, Pose};
use crate::tree::Reading;
use nalgebra::{Matrix3, Unit, Vector3};
use std::collections::HashSet;
use std::sync::OnceLock;

/// A robot description: a tree of links and joints, everything that is not kinematics kept as text.
#[derive(Debug, Clone)]
pub struct Robot {
    /// The robot's name; empty where the source gives none.
    pub name: String,
    /// Links in the order of the file.
    pub links: Vec<Link>,
    /// Joints in the order of the file.
    pub joints: Vec<Joint>,
    /// Index of the one link that no joint carries.
    pub root: usize,
    /// Other elements of the file: transmissions, simulators' and controllers' settings, materials.
    pub elements: Vec<Element>,
    /// What was repaired or read as meant, what is not understood, and what is kept but not used.
    pub notes: Vec<Note>,
    /// What was understood and what was not; [`Robot::inventory`] adds what is kept.
    pub read: Inventory,
    /// Where it came from.
    pub source: SourceText,
}

/// The text of a robot description, complete enough to write it again without loss. It is immutable.
#[derive(Debug, Clone, Default)]
pub struct SourceText {
    /// Name of the file, for messages.
    pub file: String,
    /// Well-formed text, as it was read.
    pub text: String,
    /// What stood before `text` and was left out: a byte order mark, white space before the XML declaration.
    pub dropped_before: String,
    /// The piece of `text` that was put in to declare unbound namespace prefixes; not part of the original.
    pub declared: std::ops::Range<usize>,
    /// The description in another format that `text` was made of; its places then are those of that one.
    pub translation: Option<Box<Translation>>,
    /// Where lines end in `text`, found when a line is first asked for.
    ends: OnceLock<Vec<usize>>,
}

impl SourceText {
    /// A text without anything removed or added.
    pub fn new(file: impl Into<String>, text: impl Into<String>) -> Self {
        let text = text.into();
        let translation = Translation::of_text(&text).map(Box::new);
        Self { file: file.into(), text, translation, ..Self::default() }
    }

    /// A text that was made of a description in another format.
    pub(crate) fn translated(file: impl Into<String>, text: String, translation: Translation) -> Self {
        Self { file: file.into(), text, translation: Some(Box::new(translation)), ..Self::default() }
    }

    /// The format of the description that the robot was read from.
    pub fn format(&self) -> Format {
        self.translation.as_ref().map_or(Format::Urdf, |translation| translation.format)
    }

    /// What the description states and URDF cannot.
    pub fn kept(&self) -> &[Kept] {
        self.translation.as_ref().map_or(&[], |translation| &translation.kept)
    }

    /// Puts a piece into the text.
    pub(crate) fn insert(&mut self, at: usize, piece: &str) {
        self.text.insert_str(at, piece);
        self.ends = OnceLock::new();
    }

    /// The line (counted from 1) of a byte offset into `text`, as it is in the original.
    pub fn line(&self, offset: usize) -> usize {
        let line = self.own_line(offset);
        self.translation.as_ref().map_or(line, |translation| translation.origin(line).1)
    }

    /// The line of `text` itself.
    fn own_line(&self, offset: usize) -> usize {
        let newlines = |text: &str| text.match_indices('\n').map(|(at, _)| at).collect::<Vec<usize>>();
        let ends = self.ends.get_or_init(|| newlines(&self.text));
        1 + newlines(&self.dropped_before).len() + ends.partition_point(|end| *end < offset)
    }

    /// The place of an element that starts at a byte offset.
    pub fn place(&self, offset: usize, element: impl Into<String>) -> Place {
        let line = self.own_line(offset);
        let (file, line) = match &self.translation {
            Some(translation) => translation.origin(line),
            None => (self.file.as_str(), line),
        };
        Place { file: file.to_owned(), line, element: element.into() }
    }
}

/// A rigid body.
#[derive(Debug, Clone, PartialEq)]
pub struct Link {
    /// Its name.
    pub name: String,
    /// Mass, centre and tensor, where given.
    pub inertial: Option<Inertial>,
    /// What is seen.
    pub visuals: Vec<Shape>,
    /// What collides.
    pub collisions: Vec<Shape>,
    /// What else the file says of it: contact parameters, sensors.
    pub elements: Vec<Element>,
    /// Byte offset of its element in the source text.
    pub at: usize,
}

/// Where something sits in its parent: URDF's `origin`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Origin {
    /// Translation, m.
    pub xyz: [f64; 3],
    /// Fixed-axis angles roll, pitch, yaw, rad.
    pub rpy: [f64; 3],
    /// The three angles as the file writes them; `None` where it writes none.
    pub rpy_written: Option<[String; 3]>,
    /// The quaternion x, y, z, w as the file writes it (URDF 1.1's `quat_xyzw`), whose rotation is `rpy`; `None` where it
    /// writes none.
    pub quat_written: Option<[String; 4]>,
}

/// An origin as it was read: its angles as written, or as intended.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadOrigin {
    /// Translation, m.
    pub xyz: [f64; 3],
    /// Fixed-axis angles roll, pitch, yaw, rad.
    pub rpy: [f64; 3],
    /// Literals that were read as a number other than the written one, with that number.
    pub reread: Vec<(String, IntendedAngle)>,
}

impl ReadOrigin {
    /// parent_from_child.
    pub fn pose(&self) -> Pose {
        se3::pose(se3::rotation_from_rpy(self.rpy), Vector3::from(self.xyz))
    }
}

impl Origin {
    /// The origin with its angles as written or as intended.
    pub fn read(&self, reading: Reading) -> ReadOrigin {
        let mut read = ReadOrigin { xyz: self.xyz, rpy: self.rpy, reread: Vec::new() };
        if let (Reading::Intended, Some(written)) = (reading, &self.rpy_written) {
            for (index, (angle, literal)) in read.rpy.iter_mut().zip(written).enumerate() {
                let pitch = || (index == 1).then(|| intended::pitch_read_as(literal)).flatten();
                if let Some(intended) = intended::read_as(literal).or_else(pitch) {
                    *angle = intended.angle;
                    read.reread.push((literal.clone(), intended));
                }
            }
        }
        read
    }

    /// parent_from_child, its angles as written.
    pub fn pose(&self) -> Pose {
        se3::pose(se3::rotation_from_rpy(self.rpy), Vector3::from(self.xyz))
    }
}

/// Mass properties of a link.
#[derive(Debug, Clone, PartialEq)]
pub struct Inertial {
    /// Centre of mass and the axes that the tensor is given in.
    pub origin: Origin,
    /// kg.
    pub mass: f64,
    /// Inertia tensor about the centre of mass, kg·m².
    pub tensor: Matrix3<f64>,
}

/// A visual or collision shape.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// Its name, where given.
    pub name: Option<String>,
    /// Where it sits in the link.
    pub origin: Origin,
    /// What it is.
    pub geometry: Geometry,
    /// What else the file says of it: its material.
    pub elements: Vec<Element>,
}

/// Kinds of shape; lengths in m.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Geometry {
    /// Edge lengths.
    Box([f64; 3]),
    /// Radius and length along z.
    Cylinder {
        /// m.
        radius: f64,
        /// m.
        length: f64,
    },
    /// Radius and length along z, without the caps.
    Capsule {
        /// m.
        radius: f64,
        /// m.
        length: f64,
    },
    /// Radius.
    Sphere(f64),
    /// A mesh file and its scale.
    Mesh {
        /// As written: `package://…`, `file://…` or a path.
        filename: String,
        /// Factors along x, y, z.
        scale: [f64; 3],
    },
    /// Another element, by name; empty where there is none.
    Other(String),
}

/// A joint between two links.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Its name.
    pub name: String,
    /// How it moves.
    pub kind: JointKind,
    /// parent_from_child at joint value 0.
    pub origin: Origin,
    /// Index of the parent link.
    pub parent: usize,
    /// Index of the child link.
    pub child: usize,
    /// Unit axis in the child link's frame, as written but for its length; as it is read: [`Joint::axis_as`].
    pub axis: Unit<Vector3<f64>>,
    /// The axis as the file gives it, before it is made of unit length; `None` where it gives none (URDF: 1 0 0).
    pub axis_written: Option<[f64; 3]>,
    /// The direction that the axis was clearly meant to have, where it differs from the written one.
    pub axis_meant: Option<IntendedAxis>,
    /// Limits, as far as they are given; [`Joint::limits_in_force`] leaves out what the joint's kind does not have.
    pub limits: Limits,
    /// Which joint it follows, where it is a mimic joint.
    pub mimic: Option<Mimic>,
    /// What else the file says of it: damping and friction, soft limits, calibration.
    pub elements: Vec<Element>,
    /// Byte offset of its element in the source text.
    pub at: usize,
}

/// Elements of a joint whose every attribute is understood or reported by itself.
const UNDERSTOOD_OF_JOINT: [&str; 4] = ["dynamics", "safety_controller", "calibration", "limit"];

/// Joint positions (rad, m) at which a reference sensor switches: URDF's `calibration`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Calibration {
    /// Where it switches on when the joint moves in its positive sense.
    pub rising: Option<f64>,
    /// Where it switches off then.
    pub falling: Option<f64>,
    /// Older files: the position of the reference.
    pub reference_position: Option<f64>,
}

/// Viscous damping and Coulomb friction; URDF's defaults are 0.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Dynamics {
    /// N·m·s/rad, or N·s/m.
    pub damping: f64,
    /// N·m, or N.
    pub friction: f64,
}

/// The soft limits of a controller: URDF's `safety_controller`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SoftLimits {
    /// Where the controller begins to slow down, lower and upper, rad or m.
    pub range: Option<(f64, f64)>,
    /// Of position and velocity bounds.
    pub k_position: f64,
    /// Of effort and velocity bounds.
    pub k_velocity: f64,
}

impl Joint {
    fn element(&self, tag: &str) -> Option<&Element> {
        self.elements.iter().find(|element| element.tag() == tag)
    }

    /// Unit axis in the child link's frame, as written or as meant.
    pub fn axis_as(&self, reading: Reading) -> Unit<Vector3<f64>> {
        match (&self.axis_meant, reading) {
            (Some(meant), Reading::Intended) => meant.axis,
            _ => self.axis,
        }
    }

    /// Damping and friction; 0 where the file states none.
    pub fn dynamics(&self) -> Dynamics {
        let number = |name| self.element("dynamics").and_then(|element| element.number(name)).unwrap_or(0.0);
        Dynamics { damping: number("damping"), friction: number("friction") }
    }

    /// Where a reference sensor switches, where stated.
    pub fn calibration(&self) -> Option<Calibration> {
        let element = self.element("calibration")?;
        let [rising, falling, reference_position] =
            ["rising", "falling", "reference_position"].map(|name| element.number(name));
        Some(Calibration { rising, falling, reference_position })
    }

    /// Soft limits, where stated; of a range of which one end is stated the other is 0.
    pub fn soft_limits(&self) -> Option<SoftLimits> {
        let element = self.element("safety_controller")?;
        let (lower, upper) = (element.number("soft_lower_limit"), element.number("soft_upper_limit"));
        let stated = lower.is_some() || upper.is_some();
        Some(SoftLimits {
            range: stated.then_some((lower.unwrap_or(0.0), upper.unwrap_or(0.0))),
            k_position: element.number("k_position").unwrap_or(0.0),
            k_velocity: element.number("k_velocity").unwrap_or(0.0),
        })
    }

    /// The limits that hold: a joint that turns without end has no range, whatever its element states.
    pub fn limits_in_force(&self) -> Limits {
        match self.kind {
            JointKind::Continuous => Limits { range: None, ..self.limits },
            _ => self.limits,
        }
    }
}

/// A joint's kind.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum JointKind {
    /// Does not move.
    Fixed,
    /// Turns between limits.
    Revolute,
    /// Turns without end.
    Continuous,
    /// Slides.
    Prismatic,
    /// Turns and slides with this pitch in m/rad (`<drake:joint type="screw">`).
    Screw(crate::screw::Pitch),
    /// Slides in the plane across its axis and turns about the axis.
    Planar,
    /// All six.
    Floating,
    /// A word that URDF does not know (`spherical`, `ball`, …): kept, but no chain goes through it.
    Unknown(String),
}

impl JointKind {
    /// The word that the file uses.
    pub fn word(&self) -> &str {
        match self {
            Self::Fixed => "fixed",
            Self::Revolute => "revolute",
            Self::Continuous => "continuous",
            Self::Prismatic => "prismatic",
            Self::Screw(_) => "screw",
            Self::Planar => "planar",
            Self::Floating => "floating",
            Self::Unknown(word) => word,
        }
    }

    /// Whether it moves at all.
    pub fn moves(&self) -> bool {
        !matches!(self, Self::Fixed)
    }
}

/// value = multiplier · value of the other joint + offset.
#[derive(Debug, Clone, PartialEq)]
pub struct Mimic {
    /// The joint that it follows; it may be a name that no joint has.
    pub joint: String,
    /// URDF's default is 1.
    pub multiplier: f64,
    /// rad or m; URDF's default is 0.
    pub offset: f64,
}

impl Link {
    /// A link of which only the name and the place in the text are known.
    pub fn named(name: impl Into<String>, at: usize) -> Self {
        let (visuals, collisions, elements) = (Vec::new(), Vec::new(), Vec::new());
        Self { name: name.into(), inertial: None, visuals, collisions, elements, at }
    }
}

impl Robot {
    /// What was done with everything in the file, in its order: what is understood is counted, what is kept
    /// unchanged and what is not understood has its place.
    ///
    /// # Examples
    /// ```
    /// use denavit_model::{Outcome, urdf};
    /// let text = r#"<robot name="r"><link name="a"/><gazebo reference="a"/><link name="b" colour="red"/>
    ///   <joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint></robot>"#;
    /// let inventory = urdf::read("r.urdf", text)?.inventory();
    /// assert_eq!(inventory.count(Outcome::Carried), 1);
    /// assert_eq!(inventory.reported().next().unwrap().what, r#"attribute colour="red" of <link>"#);
    /// # Ok::<(), denavit_model::UrdfError>(())
    /// ```
    pub fn inventory(&self) -> Inventory {
        let mut inventory = self.read.clone();
        let on_links = self.links.iter().flat_map(|link| {
            let on_shapes = link.visuals.iter().chain(&link.collisions).flat_map(|shape| &shape.elements);
            link.elements.iter().chain(on_shapes).map(move |element| ("link", &link.name, element))
        });
        let on_joints = self.joints.iter().flat_map(|joint| {
            let further = joint.elements.iter().filter(|element| !UNDERSTOOD_OF_JOINT.contains(&element.tag()));
            further.map(move |element| ("joint", &joint.name, element))
        });
        let owned = on_links.chain(on_joints).map(|(tag, name, element)| (format!("{tag} \"{name}\""), element));
        let own = self.elements.iter().map(|element| (element.label(), element));
        // What is reported is kept, too, but listed once.
        let reported: HashSet<(usize, String)> = inventory
            .items
            .iter()
            .filter_map(|item| Some((item.place.line, item.what.split_once(" in <")?.0.to_owned())))
            .collect();
        for (owner, element) in owned.chain(own) {
            let place = self.source.place(element.at, owner);
            let tag = element.tag();
            let local = tag.rsplit(':').next().unwrap_or(tag);
            if !reported.contains(&(place.line, format!("<{local}>"))) {
                inventory.carry(place, format!("<{tag}>"));
            }
        }
        for Kept { loss, understood, .. } in self.source.kept() {
            if *understood {
                inventory.carry(loss.place.clone(), loss.what.clone());
            } else {
                inventory.report(loss.place.clone(), loss.what.clone());
            }
        }
        inventory.items.sort_by_key(|item| item.place.line);
        inventory
    }

    /// Notes on what is kept but has no effect here: closed loops, calibration positions.
    pub fn unused(&self) -> Vec<Note> {
        let mut notes: Vec<Note> = self
            .loops()
            .into_iter()
            .map(|Loop { label, at, between }| {
                let ends = match &between[..] {
                    [one, other, ..] => format!(" between \"{one}\" and \"{other}\""),
                    _ => String::new(),
                };
                let what = format!(
                    "closes a loop{ends}; it is kept but not solved: every joint moves freely here, so give \
                     joint values that close the loop"
                );
                Note::NotUnderstood { place: self.source.place(at, label), what }
            })
            .collect();
        let calibrated: Vec<&Joint> = self.joints.iter().filter(|joint| joint.calibration().is_some()).collect();
        if let Some(first) = calibrated.first() {
            let many = if calibrated.len() > 1 { format!(" (of {} joints)", calibrated.len()) } else { String::new() };
            let what = format!(
                "<calibration> states where a reference sensor switches{many}; it is kept but does not shift the joint's \
                 zero here"
            );
            notes.push(Note::NotUnderstood {
                place: self.source.place(first.at, format!("joint \"{}\"", first.name)),
                what,
            });
        }
        notes
    }

    /// Index of the link of this name.
    pub fn link_index(&self, name: &str) -> Option<usize> {
        self.links.iter().position(|link| link.name == name)
    }

    /// Index of the joint of this name.
    pub fn joint_index(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name == name)
    }

    /// For each link the joint that carries it; `None` for the root.
    pub fn carriers(&self) -> Vec<Option<usize>> {
        let mut carriers = vec![None; self.links.len()];
        for (index, joint) in self.joints.iter().enumerate() {
            carriers[joint.child] = Some(index);
        }
        carriers
    }

    /// For each link the joints that it carries, in the order of the file.
    pub fn carried(&self) -> Vec<Vec<usize>> {
        let mut carried = vec![Vec::new(); self.links.len()];
        for (index, joint) in self.joints.iter().enumerate() {
            carried[joint.parent].push(index);
        }
        carried
    }

    /// Links that carry no joint, in the order of the file.
    pub fn leaves(&self) -> Vec<usize> {
        let mut carries = vec![false; self.links.len()];
        for joint in &self.joints {
            carries[joint.parent] = true;
        }
        (0..self.links.len()).filter(|link| !carries[*link]).collect()
    }

    /// Index of the joint that carries a link; `None` for the root. For many links: [`Robot::carriers`].
    pub fn joint_to(&self, link: usize) -> Option<usize> {
        self.joints.iter().position(|joint| joint.child == link)
    }

    /// Indices of the joints that a link carries, in the order of the file.
    pub fn joints_from(&self, link: usize) -> impl Iterator<Item = usize> + '_ {
        self.joints.iter().enumerate().filter(move |(_, joint)| joint.parent == link).map(|(index, _)| index)
    }

    /// The place of a joint's element.
    pub fn joint_place(&self, joint: usize) -> Place {
        let joint = &self.joints[joint];
        self.source.place(joint.at, format!("joint \"{}\"", joint.name))
    }
}
