//! What the figure shows, in space: links along d and a, joints, frames, angles, and the words that belong to them.

use super::Detail;
use super::labels::{Ask, Kind};
use super::solids::Solid;
use super::view::Frame;
use crate::numbers::{Units, decimal};
use denavit_dh::{Motion, Row, Table};
use denavit_model::nalgebra::{Point3, Unit, Vector3};
use denavit_model::se3::{self, Pose, rotation_about};
use std::collections::BTreeMap;

/// Sizes on the sheet, px.
const ARROW: f64 = 50.0;
const ARC: f64 = 27.0;
const TWIST_ARC: f64 = 35.0;
const AROUND: f64 = 12.0;
const BEYOND: f64 = 22.0;
/// Bodies of joints nearer than this are moved apart.
const APART: f64 = 28.0;
/// Directions seen nearly end-on are not legible.
const END_ON: f64 = 0.94;
/// Lengths tilted more than this (part towards the reader) are not dimensioned in front and side views.
const FORESHORTENED: f64 = 0.3;
/// Numbers beyond this many times the robot's size are not to scale with it.
const FAR: f64 = 3.0;

/// A line in space and its class in the style sheet.
pub(crate) struct Line {
    pub points: Vec<Point3<f64>>,
    pub class: &'static str,
    pub arrow: bool,
}

/// An axis that points at the reader or away.
pub(crate) struct EndOn {
    pub at: Point3<f64>,
    pub class: &'static str,
    pub towards: bool,
}

/// The figure in space, m.
#[derive(Default)]
pub(crate) struct Scene {
    pub lines: Vec<Line>,
    pub solids: Vec<Solid>,
    pub end_on: Vec<EndOn>,
    pub labels: Vec<Ask>,
    /// Middles of the joints' bodies.
    joints: Vec<Point3<f64>>,
    /// The same by the cells of space that they lie in.
    bodies: BTreeMap<[i64; 3], Vec<Point3<f64>>>,
}

/// Whether the table has lengths that a figure cannot show to scale.
pub fn far_from_scale(table: &Table) -> bool {
    table.greatest_length() > FAR * size(table)
}

fn size(table: &Table) -> f64 {
    table.chain().map_or(1.0, |chain| chain.size())
}

/// What the sheet must hold.
pub(crate) fn extent(table: &Table) -> Vec<Point3<f64>> {
    let mut points = vec![Point3::origin()];
    let reach = FAR * size(table);
    for step in Step::all(table) {
        points.extend([step.corner, step.end()].into_iter().filter(|point| point.coords.norm() < reach));
    }
    if points.iter().all(|point| (point - points[0]).norm() < 1e-9) {
        points.push(Point3::new(0.0, 0.0, 0.1));
    }
    points
}

/// A row in space: from the frame before along z by d to the corner, then along x by a.
struct Step {
    before: Pose,
    corner: Point3<f64>,
    after: Pose,
    row: Option<Row>,
    theta: f64,
    d: f64,
}

impl Step {
    /// Rows base, 1 … n, and the tool's pair.
    fn all(table: &Table) -> Vec<Self> {
        let mut before = Pose::identity();
        let rows = table.rows.iter().map(|row| (row.pose(), Some(*row), row.theta(), row.d().unwrap_or(0.0)));
        let tool = (table.tool.pose(), None, table.tool.theta, table.tool.d);
        let step = |(motion, row, theta, d): (Pose, Option<Row>, f64, f64)| {
            let corner = before * Point3::new(0.0, 0.0, d);
            let after = before * motion;
            let step = Self { before, corner, after, row, theta, d };
            before = after;
            step
        };
        rows.chain([tool]).map(step).collect()
    }

    fn start(&self) -> Point3<f64> {
        Point3::from(self.before.translation.vector)
    }

    fn end(&self) -> Point3<f64> {
        Point3::from(self.after.translation.vector)
    }
}

fn column(pose: &Pose, k: usize) -> Vector3<f64> {
    pose.rotation.matrix().column(k).into_owned()
}

/// `12` as `₁₂`.
pub fn subscript(number: usize) -> String {
    number.to_string().chars().filter_map(|digit| digit.to_digit(10).and_then(|d| char::from_u32(0x2080 + d))).collect()
}

impl Scene {
    /// The figure of a table on a sheet of known scale.
    pub fn of(table: &Table, frame: &Frame, detail: Detail, units: Units) -> Self {
        let steps = Step::all(table);
        let mut scene = Self::default();
        scene.solids.push(Solid::disc(Point3::origin(), Vector3::z(), 24.0 * frame.pixel));
        for (index, step) in steps.iter().enumerate() {
            scene.link(step);
            if let Some(joint) = table.joints.get(index) {
                scene.joint(joint.motion, &step.after, frame.pixel);
            }
        }
        if detail == Detail::Plain {
            return scene;
        }
        scene.frames(&steps, frame);
        for (index, step) in steps.iter().enumerate() {
            let words = RowWords { table, index, units };
            scene.lengths(step, &words, frame);
            scene.angles(step, &words, frame);
        }
        scene
    }

    /// A joint's body at its frame, or farther along its axis where another joint's body is in the way.
    fn joint(&mut self, motion: Motion, frame: &Pose, pixel: f64) {
        let cell = |at: &Point3<f64>, k: usize| (at[k] / (APART * pixel)).floor();
        let around = |at: &Point3<f64>| {
            let [x, y, z] = [0, 1, 2].map(|k| cell(at, k) as i64);
            let near = [-1, 0, 1];
            near.into_iter()
                .flat_map(move |dx| near.into_iter().flat_map(move |dy| near.map(|dz| [x + dx, y + dy, z + dz])))
        };
        let taken = |at: &Point3<f64>| {
            let mut near = around(at).filter_map(|cell| self.bodies.get(&cell)).flatten();
            near.any(|other| (other - at).norm() < APART * pixel)
        };
        let along = |offset: f64| frame * Point3::new(0.0, 0.0, offset * APART * pixel);
        let origin = along(0.0);
        let middle = [0.0, -1.1, 1.1, -2.2, 2.2].map(along).into_iter().find(|at| !taken(at)).unwrap_or(origin);
        self.lines.push(Line { points: vec![origin, middle], class: "reference", arrow: false });
        self.bodies.entry([0, 1, 2].map(|k| cell(&middle, k) as i64)).or_default().push(middle);
        self.joints.push(middle);
        let body = se3::pose(frame.rotation, middle.coords);
        self.solids.push(Solid::joint(motion, &body, pixel));
    }

    fn link(&mut self, step: &Step) {
        for pair in [[step.start(), step.corner], [step.corner, step.end()]] {
            if (pair[1] - pair[0]).norm() > 0.0 {
                self.lines.push(Line { points: pair.to_vec(), class: "link", arrow: false });
            }
        }
    }

    /// Arrows for x and z of the base frame, frames 0 … n and the tool; those that coincide share one.
    fn frames(&mut self, steps: &[Step], frame: &Frame) {
        let last = steps.len() - 1;
        let named = steps.iter().enumerate().map(|(index, step)| {
            let suffix = if index == last { "ₜ".to_owned() } else { subscript(index) };
            (step.after, suffix)
        });
        let poses: Vec<(Pose, String)> = std::iter::once((Pose::identity(), " base".to_owned())).chain(named).collect();
        for (k, letter, class) in [(2, 'z', "z"), (0, 'x', "x")] {
            let mut drawn: Vec<(Point3<f64>, Vector3<f64>, Vec<String>)> = Vec::new();
            for (pose, suffix) in &poses {
                let (at, direction) = (Point3::from(pose.translation.vector), column(pose, k));
                let word = format!("{letter}{suffix}");
                let same = |known: &&mut (Point3<f64>, Vector3<f64>, Vec<String>)| {
                    (known.0 - at).norm() < frame.pixel && known.1.dot(&direction) > 0.999
                };
                match drawn.iter_mut().find(same) {
                    Some(known) => known.2.push(word),
                    None => drawn.push((at, direction, vec![word])),
                }
            }
            for (at, direction, mut words) in drawn {
                if words.len() > 1 {
                    words.retain(|word| !word.ends_with("base"));
                }
                self.axis(at, &direction, words.join(" "), class, frame);
            }
        }
    }

    fn axis(&mut self, at: Point3<f64>, direction: &Vector3<f64>, text: String, class: &'static str, frame: &Frame) {
        let tip = at + direction * (ARROW * frame.pixel);
        let near = frame.towards_reader(direction);
        if near.abs() > END_ON {
            self.end_on.push(EndOn { at, class, towards: near > 0.0 });
            self.labels.push(Ask { text, at, class, kind: Kind::Axis });
            return;
        }
        self.lines.push(Line { points: vec![at, tip], class, arrow: true });
        self.labels.push(Ask { text, at: at + direction * (1.16 * ARROW * frame.pixel), class, kind: Kind::Axis });
    }

    fn lengths(&mut self, step: &Step, words: &RowWords, frame: &Frame) {
        let a = step.row.map_or(0.0, |row| row.a());
        let along = [
            (words.d(step.d), step.start(), step.corner, column(&step.before, 2)),
            (words.a(a), step.corner, step.end(), column(&step.after, 0)),
        ];
        for (text, from, to, direction) in along {
            let Some(text) = text else { continue };
            let tilt = frame.towards_reader(&direction).abs();
            let limit = if frame.view == super::View::Isometric { END_ON } else { FORESHORTENED };
            if tilt < limit {
                let at = from + (to - from) * 0.5;
                self.labels.push(Ask { text, at, class: "length", kind: Kind::Length });
            }
        }
    }

    /// theta about z of the frame before, from its x to the next x; alpha about x, from the z before to the next z.
    fn angles(&mut self, step: &Step, words: &RowWords, frame: &Frame) {
        let about_z = Arc {
            at: step.corner,
            about: column(&step.before, 2),
            from: column(&step.before, 0),
            angle: step.theta,
            radius: ARC,
        };
        if let Some((text, turns)) = words.theta(step.theta) {
            let body = words.joint().and_then(|joint| self.joints.get(joint)).copied();
            let arc = match body {
                Some(body) if step.theta.abs() < 1e-9 && turns => about_z.turning(body, frame.pixel),
                _ => about_z,
            };
            self.arc(&arc, text, "theta", frame);
        }
        let alpha = step.row.map_or(0.0, |row| row.alpha());
        if let Some(text) = words.alpha(alpha) {
            let arc = Arc {
                at: step.end(),
                about: column(&step.after, 0),
                from: column(&step.before, 2),
                angle: alpha,
                radius: TWIST_ARC,
            };
            self.arc(&arc, text, "alpha", frame);
        }
        if let Some(beta) = step.row.and_then(|row| row.beta()) {
            let text = format!("β{} = {}", subscript(words.index), angle(beta));
            self.labels.push(Ask { text, at: step.end(), class: "alpha", kind: Kind::Angle });
        }
    }

    fn arc(&mut self, arc: &Arc, text: String, class: &'static str, frame: &Frame) {
        let seen = frame.towards_reader(&arc.about).abs();
        let limit = if frame.view == super::View::Isometric { 0.2 } else { 0.8 };
        if seen < limit {
            return;
        }
        let points = arc.points(frame.pixel);
        let middle = points[points.len() / 2];
        self.lines.push(Line { points, class, arrow: true });
        if arc.radius > AROUND {
            let reference = arc.from.normalize() * (1.35 * arc.radius * frame.pixel);
            self.lines.push(Line { points: vec![arc.at, arc.at + reference], class: "reference", arrow: false });
        }
        self.labels.push(Ask { text, at: middle, class, kind: Kind::Angle });
    }
}

struct Arc {
    at: Point3<f64>,
    about: Vector3<f64>,
    from: Vector3<f64>,
    angle: f64,
    radius: f64,
}

impl Arc {
    /// An arrow around the axis just beyond the joint's body, for a coordinate with no rotation at zero.
    fn turning(self, joint: Point3<f64>, pixel: f64) -> Self {
        let from = rotation_about(&self.about, -2.3) * self.from;
        Self { at: joint + self.about * (BEYOND * pixel), from, angle: 4.6, radius: AROUND, ..self }
    }

    fn points(&self, pixel: f64) -> Vec<Point3<f64>> {
        let about = Unit::new_normalize(self.about);
        let start = self.from * (self.radius * pixel);
        let count = (self.angle.abs() / 0.16).ceil().max(2.0);
        let corner = |k: u32| self.at + rotation_about(&about, self.angle * f64::from(k) / count) * start;
        (0..=count as u32).map(corner).collect()
    }
}

/// The words of a row's numbers; `None` where there is nothing to say.
struct RowWords<'a> {
    table: &'a Table,
    index: usize,
    units: Units,
}

impl RowWords<'_> {
    fn suffix(&self) -> String {
        if self.index > self.table.joints.len() { "ₜ".to_owned() } else { subscript(self.index) }
    }

    /// Index of the joint that the row follows.
    fn joint(&self) -> Option<usize> {
        self.index.checked_sub(1).filter(|joint| *joint < self.table.joints.len())
    }

    fn joint_motion(&self) -> Option<Motion> {
        self.joint().map(|joint| self.table.joints[joint].motion)
    }

    fn variable(&self) -> Option<String> {
        let joint = &self.table.joints[self.joint()?];
        let scale = match decimal(joint.scale, 4).as_str() {
            "1" => String::new(),
            "-1" => "−".to_owned(),
            scale => format!("{scale} "),
        };
        Some(format!("{scale}q{}", subscript(joint.coordinate + 1)))
    }

    fn length(&self, metres: f64) -> String {
        let places = if self.units.length_word() == "mm" { 1 } else { 4 };
        let shown = if self.units.length_word() == "mm" { metres * 1e3 } else { metres };
        format!("{} {}", decimal(shown, places).replace('-', "−"), self.units.length_word())
    }

    /// Text for theta, and whether the joint turns by it.
    fn theta(&self, theta: f64) -> Option<(String, bool)> {
        let turns = matches!(self.joint_motion(), Some(Motion::Revolute | Motion::Helical(_)));
        let name = format!("θ{}", self.suffix());
        let zero = theta.abs() < 1e-9;
        match self.variable().filter(|_| turns) {
            Some(variable) if zero => Some((format!("{name} = {variable}"), true)),
            Some(variable) => Some((format!("{name} = {variable} {}", signed(&angle(theta))), true)),
            None if zero => None,
            None => Some((format!("{name} = {}", angle(theta)), false)),
        }
    }

    fn d(&self, d: f64) -> Option<String> {
        let name = format!("d{}", self.suffix());
        let zero = self.is_zero(d);
        let variable = match self.joint_motion() {
            Some(Motion::Prismatic) => self.variable(),
            Some(Motion::Helical(_)) => self.variable().map(|variable| format!("h {variable}")),
            _ => None,
        };
        match variable {
            Some(variable) if zero => Some(format!("{name} = {variable}")),
            Some(variable) => Some(format!("{name} = {variable} {}", signed(&self.length(d)))),
            None if zero => None,
            None => Some(format!("{name} = {}", self.length(d))),
        }
    }

    fn a(&self, a: f64) -> Option<String> {
        (!self.is_zero(a)).then(|| format!("a{} = {}", self.suffix(), self.length(a)))
    }

    fn alpha(&self, alpha: f64) -> Option<String> {
        (alpha.abs() > 1e-9).then(|| format!("α{} = {}", self.suffix(), angle(alpha)))
    }

    fn is_zero(&self, length: f64) -> bool {
        length.abs() < 5e-6 * size(self.table)
    }
}

fn angle(radians: f64) -> String {
    format!("{}°", decimal(radians.to_degrees(), 2).replace('-', "−"))
}

/// `−90°` as `− 90°`, `90°` as `+ 90°`.
fn signed(number: &str) -> String {
    number.strip_prefix('−').map_or_else(|| format!("+ {number}"), |positive| format!("− {positive}"))
}
