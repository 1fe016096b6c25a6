//! The measured scene: setups, targets, fixed points, and series of observations.

use crate::board::{Camera, Corner, Sight};
use crate::kinds::{Frame, ObservationKind, Part};
use denavit_model::{Chain, Tips};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Observations of one kind, of one target, in one setup.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// What is observed.
    pub kind: ObservationKind,
    /// Index of the setup.
    pub setup: usize,
    /// Index of the target.
    pub target: usize,
    /// Index of the point, for kinds that need one.
    pub point: Option<usize>,
    /// The corner of a board, for kinds that see one.
    pub corner: Option<Corner>,
    /// Index of the noise channel of the lengths, and of the angles.
    pub channels: [Option<usize>; 2],
}

impl Series {
    /// Typical distance of a camera's board, m.
    pub fn range(&self) -> f64 {
        self.corner.as_ref().map_or(1.0, |corner| corner.camera.range)
    }
}

/// Everything except the arm that observations involve.
///
/// A setup is an instrument at one place. A target is on the tip. A point is fixed in the base frame, such as the anchor
/// of a distance. The names of targets and points are those in the fit's parameters.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scene {
    /// Names of the setups; one empty name if there is only one.
    pub setups: Vec<String>,
    /// The tips that carry targets, if the robot has several; none: all targets are on the chain's own.
    tips: Option<Arc<Tips>>,
    /// Names of the targets: `""` for `x,y,z`, `"1"` for `x1,y1,z1`; where there are several tips, after the tip's name.
    pub targets: Vec<String>,
    /// Index of the tip of each target.
    sits_on: Vec<usize>,
    /// Names of the points, such as `anchor`.
    pub points: Vec<String>,
    /// What is observed.
    pub series: Vec<Series>,
    /// Groups of values that share a noise level.
    pub channels: Vec<Part>,
    /// Known distances between points.
    pub lengths: Vec<KnownLength>,
}

/// A known distance between two points.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownLength {
    /// Indices of the points.
    pub points: [usize; 2],
    /// m.
    pub length: f64,
    /// Standard deviation, m.
    pub std: f64,
}

/// A target's name, and the index of its tip.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Target<'a> {
    /// Its name.
    pub name: &'a str,
    /// 0 where there is one tip.
    pub tip: usize,
}

impl<'a> Target<'a> {
    /// A target of a robot with one tip.
    pub fn alone(name: &'a str) -> Self {
        Self { name, tip: 0 }
    }
}

fn index_of(names: &mut Vec<String>, name: &str) -> usize {
    names.iter().position(|known| known == name).unwrap_or_else(|| {
        names.push(name.into());
        names.len() - 1
    })
}

impl Scene {
    /// One setup, this many targets, each observed in this kind.
    pub fn of(kind: ObservationKind, targets: usize) -> Self {
        let mut scene = Self::default();
        for target in 1..=targets.max(1) {
            let name = if targets > 1 { target.to_string() } else { String::new() };
            scene.add(kind, "", Target::alone(&name), None);
        }
        scene
    }

    /// An empty scene of a robot with these tips.
    pub fn of_tips(tips: Option<Arc<Tips>>) -> Self {
        Self { tips: tips.filter(|tips| tips.several()), ..Self::default() }
    }

    /// An empty scene of the same robot.
    #[must_use]
    pub fn of_same_robot(&self) -> Self {
        Self::of_tips(self.tips.clone())
    }

    /// This number of targets on each tip, each observed in this kind.
    pub fn on_tips(kind: ObservationKind, tips: &Arc<Tips>, targets: usize) -> Self {
        let mut scene = Self::of_tips(Some(tips.clone()));
        for (tip, of) in tips.all().iter().enumerate() {
            for target in 1..=targets.max(1) {
                let number = if targets > 1 { target.to_string() } else { String::new() };
                let name = if tips.several() { target_on(&of.name, &number) } else { number };
                scene.add(kind, "", Target { name: &name, tip }, None);
            }
        }
        scene
    }

    /// The tips that carry targets, if there are several.
    pub fn tips(&self) -> Option<&Arc<Tips>> {
        self.tips.as_ref()
    }

    /// The tips that carry targets; `chain` has the joints of all.
    pub fn tips_of(&self, chain: &Chain) -> Tips {
        self.tips.as_ref().map_or_else(|| Tips::only(chain), |tips| (**tips).clone())
    }

    /// Index of a target's tip.
    #[inline]
    pub fn tip_of(&self, target: usize) -> usize {
        self.sits_on[target]
    }

    /// A target by its index.
    pub fn target(&self, index: usize) -> Target<'_> {
        Target { name: &self.targets[index], tip: self.sits_on[index] }
    }

    /// A target's name without its tip: its number, and its setup if there are several.
    pub fn number_of(&self, target: usize) -> &str {
        let name = &self.targets[target];
        let tip = self.tips.as_ref().map(|tips| &tips[self.sits_on[target]].name);
        tip.and_then(|tip| name.strip_prefix(tip.as_str())).unwrap_or(name).trim_start()
    }

    /// The same setups, targets and points, without observations.
    #[must_use]
    pub fn unobserved(&self) -> Self {
        let (setups, targets, points) = (self.setups.clone(), self.targets.clone(), self.points.clone());
        Self { setups, targets, points, sits_on: self.sits_on.clone(), ..self.of_same_robot() }
    }

    /// As many targets as the kind can observe at once.
    pub fn of_several(kind: ObservationKind, targets: usize) -> Self {
        Self::of(kind, if kind.of_several() { targets } else { 1 })
    }

    /// The series of this kind, setup, target and point, made where there is none; its index.
    ///
    /// `point` distinguishes several points of one kind.
    pub fn add(&mut self, kind: ObservationKind, setup: &str, target: Target<'_>, point: Option<&str>) -> usize {
        self.add_seen(kind, setup, target, point, None)
    }

    /// The series of a board's corner, with the board or its camera as the target; made where there is none.
    pub fn add_corner(&mut self, kind: ObservationKind, setup: &str, target: Target<'_>, corner: Corner) -> usize {
        self.add_seen(kind, setup, target, None, Some(corner))
    }

    fn add_seen(
        &mut self,
        kind: ObservationKind,
        setup: &str,
        target: Target<'_>,
        point: Option<&str>,
        corner: Option<Corner>,
    ) -> usize {
        let setup = index_of(&mut self.setups, setup);
        let tip = target.tip;
        let target = index_of(&mut self.targets, target.name);
        if target == self.sits_on.len() {
            self.sits_on.push(tip);
        }
        let point = kind.unknowns().point.map(|word| {
            let name =
                point.filter(|name| !name.is_empty()).map_or_else(|| word.into(), |name| format!("{word} {name}"));
            index_of(&mut self.points, &name)
        });
        let label = corner.as_ref().map(|corner| &corner.label);
        let same = |series: &Series| {
            (series.kind, series.setup, series.target, series.point) == (kind, setup, target, point)
                && series.corner.as_ref().map(|corner| &corner.label) == label
        };
        if let Some(known) = self.series.iter().position(same) {
            return known;
        }
        let mut channel = |part: Part| {
            self.channels.iter().position(|known| *known == part).unwrap_or_else(|| {
                self.channels.push(part);
                self.channels.len() - 1
            })
        };
        let channels = [Some(channel(kind.place())), kind.turn().map(channel)];
        self.series.push(Series { kind, setup, target, point, corner, channels });
        self.series.len() - 1
    }

    /// Adds a series of another scene; its index here.
    pub fn adopt(&mut self, other: &Self, series: &Series) -> usize {
        let point = series.point.map(|point| label_of(&other.points[point]).to_owned());
        let (setup, target) = (&other.setups[series.setup], other.target(series.target));
        self.add_seen(series.kind, setup, target, point.as_deref(), series.corner.clone())
    }

    /// The corners of a board, seen by a camera at this many metres.
    ///
    /// `None` where the board is not known.
    pub fn of_board(kind: ObservationKind, sight: &Sight, range: f64) -> Option<Self> {
        let mut scene = Self::default();
        let (lens, on_hand) = (sight.lens.clone(), sight.on_hand);
        let camera = Arc::new(Camera { lens, on_hand, range });
        let board = sight.board?;
        for (number, at) in (0..board.corners()).filter_map(|number| Some((number, board.corner(number)?))) {
            let corner = Corner { label: number.to_string(), at, camera: camera.clone() };
            scene.add_corner(kind, kind.own_setup(), Target::alone(sight.on_tip()), corner);
        }
        Some(scene)
    }

    /// Typical distance of the boards, m; `None` where no camera sees one.
    pub fn range(&self) -> Option<f64> {
        self.series.iter().find_map(|series| Some(series.corner.as_ref()?.camera.range))
    }

    /// Metres per pixel of a noise channel of pixels.
    pub fn per_pixel(&self, channel: usize) -> Option<f64> {
        let own = |series: &&Series| series.channels[0] == Some(channel);
        self.series.iter().filter(own).find_map(|series| Some(series.corner.as_ref()?.camera.metres_per_pixel()))
    }

    /// Sets the distance at which errors in pixels are converted to lengths, m.
    pub fn set_range(&mut self, range: f64) {
        let mut known: Vec<(Arc<Camera>, Arc<Camera>)> = Vec::new();
        for corner in self.series.iter_mut().filter_map(|series| series.corner.as_mut()) {
            let same = known.iter().find(|(old, _)| Arc::ptr_eq(old, &corner.camera));
            let new =
                same.map_or_else(|| Arc::new(Camera { range, ..(*corner.camera).clone() }), |(_, new)| new.clone());
            known.push((std::mem::replace(&mut corner.camera, new.clone()), new));
        }
    }

    /// The point of a label, such as `front/0`, of any kind.
    pub fn point_of(&self, label: &str) -> Option<usize> {
        self.points.iter().position(|name| label_of(name) == label)
    }

    /// Sets the distance between two points; with a `*` in both labels, between all matching pairs. Returns the number of
    /// pairs.
    pub fn know_length(&mut self, labels: [&str; 2], length: f64, std: f64) -> usize {
        let mut found = Vec::new();
        for (first, name) in self.points.iter().enumerate() {
            let Some(meaning) = meaning(labels[0], label_of(name)) else { continue };
            if let Some(second) = self.point_of(&labels[1].replacen('*', meaning, 1)) {
                found.push(KnownLength { points: [first, second], length, std });
            }
        }
        self.lengths.extend_from_slice(&found);
        found.len()
    }

    /// The kinds that are observed, each once.
    pub fn kinds(&self) -> Vec<ObservationKind> {
        let mut kinds: Vec<ObservationKind> = Vec::new();
        for series in &self.series {
            if !kinds.contains(&series.kind) {
                kinds.push(series.kind);
            }
        }
        kinds
    }

    /// What is measured, as one word: `position`, or `position+distance`.
    pub fn measured(&self) -> String {
        self.kinds().iter().map(|kind| kind.name()).collect::<Vec<_>>().join("+")
    }

    /// What is measured, in words: `positions and distances`.
    pub fn words(&self) -> String {
        self.kinds().iter().map(|kind| kind.plural()).collect::<Vec<_>>().join(" and ")
    }

    /// Whether the frame of a setup's instrument, or of a tool held by two tips, is observable.
    pub fn has_instrument(&self, setup: usize) -> bool {
        self.is_held(setup) || self.sees(setup, Frame::Instrument)
    }

    /// Whether this part of a setup's frame is observable.
    fn sees(&self, setup: usize, frame: Frame) -> bool {
        self.series.iter().any(|series| series.setup == setup && series.kind.unknowns().frame == frame)
    }

    /// Whether a setup is a tool that two tips hold, in one row.
    pub fn is_held(&self, setup: usize) -> bool {
        self.sees(setup, Frame::Grip)
    }

    /// The target of the first tip that holds a tool: its frame is the tool's.
    pub fn tool_frames(&self) -> BTreeSet<usize> {
        let mut first: BTreeMap<usize, usize> = BTreeMap::new();
        for series in self.series.iter().filter(|series| series.kind.unknowns().frame == Frame::Grip) {
            let target = first.entry(series.setup).or_insert(series.target);
            *target = series.target.min(*target);
        }
        first.into_values().collect()
    }

    /// Whether only the plane z = 0 of a setup's frame is observable.
    pub fn has_plane(&self, setup: usize) -> bool {
        self.sees(setup, Frame::Plane)
    }

    /// Whether only the z axis of a setup's frame, opposite to gravity, is observable.
    pub fn has_level(&self, setup: usize) -> bool {
        self.sees(setup, Frame::Level)
    }

    /// Whether the position of a target on its tip is observable.
    pub fn places(&self, target: usize) -> bool {
        let mut own = self.series.iter().filter(|series| series.target == target).peekable();
        own.peek().is_none() || own.any(|series| !series.kind.is_turned_alone())
    }

    /// Whether any value is measured in an instrument's frame.
    pub fn has_instruments(&self) -> bool {
        self.series.iter().any(|series| series.kind.unknowns().frame == Frame::Instrument)
    }

    /// Whether a target's orientation on the tip is observable.
    pub fn turns(&self, target: usize) -> bool {
        self.series.iter().any(|series| series.target == target && series.kind.unknowns().turn)
    }

    /// The targets that are seen in a setup.
    pub fn targets_of(&self, setup: usize) -> Vec<usize> {
        let seen: BTreeSet<usize> =
            self.series.iter().filter(|series| series.setup == setup).map(|series| series.target).collect();
        seen.into_iter().collect()
    }
}

/// The name of a target (number, or empty) on one of several tips.
pub fn target_on(tip: &str, target: &str) -> String {
    if target.is_empty() { tip.into() } else { format!("{tip} {target}") }
}

/// The label of a point among others of its kind.
pub fn label_of(name: &str) -> &str {
    name.split_once(' ').map_or("", |(_, label)| label)
}

/// The text that the `*` of a pattern matches in a label; `""` for a label that equals the pattern.
fn meaning<'a>(pattern: &str, label: &'a str) -> Option<&'a str> {
    match pattern.split_once('*') {
        Some((before, after)) => label.strip_prefix(before)?.strip_suffix(after).filter(|meaning| !meaning.is_empty()),
        None => (pattern == label).then_some(""),
    }
}
