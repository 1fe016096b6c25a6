//! The graph of frames: everything with a pose in SDF has a frame, defined in another one.
//!
//! ```text
//! world ─► model ─► link, frame, joint, nested model ─► …      each step a pose; `relative_to` chooses the base
//! ```
//!
//! # Source
//! <http://sdformat.org/tutorials?tut=pose_frame_semantics>: a link's pose is given in the model frame, a joint's in its
//! child's frame, a frame's in what it is attached to, unless `relative_to` (1.7 and later; before: `frame`) says otherwise.

use crate::pose::Step;
use denavit_model::Pose;
use denavit_model::nalgebra::Rotation3;
use std::collections::HashMap;

/// Index of a frame.
pub(crate) type FrameId = usize;

/// The world's frame.
pub(crate) const WORLD: FrameId = 0;

/// A frame: its definition, and its body.
#[derive(Debug, Clone)]
pub(crate) struct Frame {
    /// Name within the whole model, such as `gripper::finger`.
    pub name: String,
    /// The frame that its step starts from.
    pub base: FrameId,
    /// base_from_frame.
    pub step: Step,
    /// The frame inside this model that the step places instead of the model's own (`placement_frame`).
    pub places: Option<FrameId>,
    /// What it is fixed to: itself if it is a link.
    pub body: FrameId,
}

/// All frames.
pub(crate) struct Frames {
    pub all: Vec<Frame>,
    names: HashMap<String, FrameId>,
    /// root_from_frame, once known.
    poses: Vec<Option<Pose>>,
}

/// Frames that depend on each other, by name.
#[derive(Debug)]
pub(crate) struct Cycle(pub FrameId, pub String);

impl Frames {
    pub fn new() -> Self {
        let mut frames = Self { all: Vec::new(), names: HashMap::new(), poses: Vec::new() };
        frames.add("world".to_owned());
        frames
    }

    /// A frame at the origin of the world, to be placed later; the first of a name has the name.
    pub fn add(&mut self, name: String) -> FrameId {
        let id = self.all.len();
        self.names.entry(name.clone()).or_insert(id);
        self.all.push(Frame { name, base: WORLD, step: Step::identity(), places: None, body: id });
        id
    }

    /// Another name of a frame.
    pub fn alias(&mut self, name: String, id: FrameId) {
        self.names.entry(name).or_insert(id);
    }

    pub fn find(&self, name: &str) -> Option<FrameId> {
        self.names.get(name).copied()
    }

    /// Names that start with a prefix, without it.
    pub fn names_in<'a>(&'a self, prefix: &'a str) -> impl Iterator<Item = &'a str> {
        let names = self.all.iter().filter_map(move |frame| frame.name.strip_prefix(prefix));
        names.filter(|name| !name.starts_with("__"))
    }

    /// Places every frame in the world and finds the link of each.
    pub fn resolve(&mut self) -> Result<(), Cycle> {
        self.poses = vec![None; self.all.len()];
        self.poses[WORLD] = Some(Pose::identity());
        for id in 0..self.all.len() {
            let mut way = Vec::new();
            let mut at = id;
            while self.poses[at].is_none() {
                way.push(at);
                if way.len() > self.all.len() {
                    return Err(self.cycle(&way));
                }
                at = self.all[at].base;
            }
            for frame in way.into_iter().rev() {
                let base = self.poses[self.all[frame].base].unwrap_or_else(Pose::identity);
                self.poses[frame] = Some(base * self.own_step(frame)?);
            }
        }
        for id in 0..self.all.len() {
            let mut at = id;
            let mut way = Vec::new();
            while self.all[at].body != at {
                way.push(at);
                if way.len() > self.all.len() {
                    return Err(self.cycle(&way));
                }
                at = self.all[at].body;
            }
            self.all[id].body = at;
        }
        Ok(())
    }

    fn cycle(&self, way: &[FrameId]) -> Cycle {
        let last = way[way.len() - 1];
        let before = way[..way.len() - 1].iter().rposition(|frame| *frame == last).map_or(0, |at| at + 1);
        let names: Vec<String> = way[before..].iter().map(|frame| format!("\"{}\"", self.all[*frame].name)).collect();
        Cycle(last, names.join(", "))
    }

    /// base_from_frame: of a model that is placed by a frame in it, that frame sits at the step.
    fn own_step(&self, id: FrameId) -> Result<Pose, Cycle> {
        let frame = &self.all[id];
        let Some(placed) = frame.places else { return Ok(frame.step.pose) };
        let (mut inside, mut at, mut way) = (Pose::identity(), placed, Vec::new());
        while at != id {
            way.push(at);
            if at == WORLD || way.len() > self.all.len() {
                return Err(self.cycle(&way));
            }
            inside = self.all[at].step.pose * inside;
            at = self.all[at].base;
        }
        Ok(frame.step.pose * inside.inverse())
    }

    /// world_from_frame.
    pub fn pose(&self, id: FrameId) -> Pose {
        self.poses[id].unwrap_or_else(Pose::identity)
    }

    /// from_to, in the digits of the file where one step of it leads there.
    pub fn between(&self, from: FrameId, to: FrameId) -> Step {
        if from == to {
            return Step::identity();
        }
        // Frames that are the same as `from`, above it.
        let moves = |id: FrameId| !self.all[id].step.is_identity() || self.all[id].places.is_some();
        let mut same = vec![from];
        while let Some(last) = same.last().copied().filter(|last| *last != WORLD && !moves(*last)) {
            same.push(self.all[last].base);
        }
        if same.contains(&to) {
            return Step::identity();
        }
        // Up from `to`: at most one step that moves anything.
        let (mut found, mut at) = (None, to);
        while at != WORLD && self.all[at].places.is_none() {
            if moves(at) && found.replace(at).is_some() {
                break;
            }
            at = self.all[at].base;
            if same.contains(&at) {
                return found.map_or_else(Step::identity, |step| self.all[step].step.clone());
            }
        }
        let (from, to) = (self.pose(from), self.pose(to));
        if from.rotation == to.rotation {
            // No rounding of a rotation with its own inverse.
            let moved = from.rotation.inverse() * (to.translation.vector - from.translation.vector);
            return Step::computed(Pose::from_parts(moved.into(), Rotation3::identity()));
        }
        Step::computed(from.inverse() * to)
    }
}
