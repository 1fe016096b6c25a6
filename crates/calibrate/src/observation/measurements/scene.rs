//! What is measured, of what and with what: setups, targets, points that stand still, and series of observations.

use crate::observation::board::{Camera, Corner, Sight};
use crate::observation::kinds::{ObservationKind, Part};
use std::collections::BTreeSet;
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
    /// How far away a camera's board is as a rule, m.
    pub fn range(&self) -> f64 {
        self.corner.as_ref().map_or(1.0, |corner| corner.camera.range)
    }
}

/// Everything beside the arm that observations speak of.
///
/// A setup is an instrument standing at one place. A target sits on the tip. A point stands still in the base frame: an
/// anchor that distances are measured from. What a target or a point is called is its name in the fit's parameters.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scene {
    /// Names of the setups; one empty name where there is one alone.
    pub setups: Vec<String>,
    /// Names of the targets: `""` for `x,y,z`, `"1"` for `x1,y1,z1`.
    pub targets: Vec<String>,
    /// Names of the points, such as `anchor`.
    pub points: Vec<String>,
    /// What is observed.
    pub series: Vec<Series>,
    /// What shares a noise level.
    pub channels: Vec<Part>,
    /// Distances between points that are known beforehand.
    pub lengths: Vec<KnownLength>,
}

/// A known distance between two points.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownLength {
    /// Indices of the points.
    pub points: [usize; 2],
    /// m.
    pub length: f64,
    /// How sure it is: standard deviation, m.
    pub std: f64,
}

fn index_of(names: &mut Vec<String>, name: &str) -> usize {
    names.iter().position(|known| known == name).unwrap_or_else(|| {
        names.push(name.into());
        names.len() - 1
    })
}

impl Scene {
    /// One setup, so many targets, each observed in this kind.
    pub fn of(kind: ObservationKind, targets: usize) -> Self {
        let mut scene = Self::default();
        for target in 1..=targets.max(1) {
            let name = if targets > 1 { target.to_string() } else { String::new() };
            scene.add(kind, "", &name, None);
        }
        scene
    }

    /// As many targets as the kind can observe at once.
    pub fn of_several(kind: ObservationKind, targets: usize) -> Self {
        Self::of(kind, if kind.of_several() { targets } else { 1 })
    }

    /// The series of this kind, setup, target and point, made where there is none; its index.
    ///
    /// `point` tells several points of one sort apart.
    pub fn add(&mut self, kind: ObservationKind, setup: &str, target: &str, point: Option<&str>) -> usize {
        self.add_seen(kind, [setup, target], point, None)
    }

    /// The series of a board's corner, the board or its camera being the target; made where there is none.
    pub fn add_corner(&mut self, kind: ObservationKind, setup: &str, target: &str, corner: Corner) -> usize {
        self.add_seen(kind, [setup, target], None, Some(corner))
    }

    fn add_seen(
        &mut self,
        kind: ObservationKind,
        [setup, target]: [&str; 2],
        point: Option<&str>,
        corner: Option<Corner>,
    ) -> usize {
        let setup = index_of(&mut self.setups, setup);
        let target = index_of(&mut self.targets, target);
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
        let (setup, target) = (&other.setups[series.setup], &other.targets[series.target]);
        self.add_seen(series.kind, [setup, target], point.as_deref(), series.corner.clone())
    }

    /// The corners of a board, seen by a camera at so many metres.
    ///
    /// `None` where the board is not known.
    pub fn of_board(kind: ObservationKind, sight: &Sight, range: f64) -> Option<Self> {
        let mut scene = Self::default();
        let (lens, on_hand) = (sight.lens.clone(), sight.on_hand);
        let camera = Arc::new(Camera { lens, on_hand, range });
        let board = sight.board?;
        for (number, at) in (0..board.corners()).filter_map(|number| Some((number, board.corner(number)?))) {
            let corner = Corner { label: number.to_string(), at, camera: camera.clone() };
            scene.add_corner(kind, kind.own_setup(), sight.on_tip(), corner);
        }
        Some(scene)
    }

    /// How far away the boards are as a rule, m; `None` where no camera sees one.
    pub fn range(&self) -> Option<f64> {
        self.series.iter().find_map(|series| Some(series.corner.as_ref()?.camera.range))
    }

    /// Metres per pixel of a noise channel, where it is of pixels.
    pub fn per_pixel(&self, channel: usize) -> Option<f64> {
        let own = |series: &&Series| series.channels[0] == Some(channel);
        self.series.iter().filter(own).find_map(|series| Some(series.corner.as_ref()?.camera.metres_per_pixel()))
    }

    /// Gives errors in pixels as lengths at this distance, m.
    pub fn set_range(&mut self, range: f64) {
        let mut known: Vec<(Arc<Camera>, Arc<Camera>)> = Vec::new();
        for corner in self.series.iter_mut().filter_map(|series| series.corner.as_mut()) {
            let same = known.iter().find(|(old, _)| Arc::ptr_eq(old, &corner.camera));
            let new =
                same.map_or_else(|| Arc::new(Camera { range, ..(*corner.camera).clone() }), |(_, new)| new.clone());
            known.push((std::mem::replace(&mut corner.camera, new.clone()), new));
        }
    }

    /// The point of a label, such as `front/0`, whatever sort of point it is.
    pub fn point_of(&self, label: &str) -> Option<usize> {
        self.points.iter().position(|name| label_of(name) == label)
    }

    /// States the distance between two points, for a `*` in both labels between all pairs that it may stand for; how many
    /// there are.
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

    /// What is measured, for people: `positions and distances`.
    pub fn words(&self) -> String {
        self.kinds().iter().map(|kind| kind.plural()).collect::<Vec<_>>().join(" and ")
    }

    /// Whether the frame of a setup's instrument is seen at all.
    pub fn has_instrument(&self, setup: usize) -> bool {
        self.series.iter().any(|series| series.setup == setup && series.kind.unknowns().instrument)
    }

    /// Whether a setup's frame is seen by its plane z = 0 alone.
    pub fn has_plane(&self, setup: usize) -> bool {
        self.series.iter().any(|series| series.setup == setup && series.kind.unknowns().plane)
    }

    /// Whether anything is read in an instrument's frame.
    pub fn has_instruments(&self) -> bool {
        self.series.iter().any(|series| series.kind.unknowns().instrument)
    }

    /// Whether a target's orientation on the tip is seen.
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

/// What tells a point from others of its sort.
pub fn label_of(name: &str) -> &str {
    name.split_once(' ').map_or("", |(_, label)| label)
}

/// What the `*` of a pattern stands for in a label; `""` for a label that is the pattern.
fn meaning<'a>(pattern: &str, label: &'a str) -> Option<&'a str> {
    match pattern.split_once('*') {
        Some((before, after)) => label.strip_prefix(before)?.strip_suffix(after).filter(|meaning| !meaning.is_empty()),
        None => (pattern == label).then_some(""),
    }
}
