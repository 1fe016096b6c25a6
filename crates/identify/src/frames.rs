//! Unobservable frames: which tips, instruments and points are connected by measurements.
//!
//! Moving base frame, axes, instruments, points and targets together changes no measured value. Where two arms of one robot share
//! neither a joint nor an instrument nor a point, each of them can move by itself: each has its own frame.

use denavit_measurements::Scene;
use denavit_model::{Chain, Tips};

/// The frame with which each movable part moves, counted from 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Frames {
    /// Number of frames.
    pub count: usize,
    /// Frame of each joint.
    pub joints: Vec<usize>,
    /// Frame of each setup.
    pub setups: Vec<usize>,
    /// Frame of each point.
    pub points: Vec<usize>,
    /// Frame of each target.
    pub targets: Vec<usize>,
    /// The ways to the tips.
    tips: Tips,
}

impl Frames {
    /// The frames of a chain, or of a tree given by its chain and the scene's tips, with its observations.
    pub fn of(chain: &Chain, scene: &Scene) -> Self {
        let tips = scene.tips_of(chain);
        // Tips of one frame have one number; an unobserved tip belongs to the first.
        let count = tips.all().len();
        let mut frame: Vec<usize> = (0..count).collect();
        let mut join = |a: usize, b: usize| {
            let (low, high) = (frame[a].min(frame[b]), frame[a].max(frame[b]));
            frame.iter_mut().filter(|of| **of == high).for_each(|of| *of = low);
        };
        let seen = |tip: usize| scene.series.iter().any(|series| scene.tip_of(series.target) == tip);
        for tip in 1..count {
            if !seen(tip) {
                join(0, tip);
            }
            let own = &tips[tip].joints;
            let shared = |other: &usize| tips[*other].joints.iter().zip(own).any(|(a, b)| *a && *b);
            (0..tip).filter(shared).for_each(|other| join(other, tip));
        }
        // A tip that each setup and each point is seen from.
        let (mut of_setup, mut of_point) = (vec![None; scene.setups.len()], vec![None; scene.points.len()]);
        for series in &scene.series {
            let tip = scene.tip_of(series.target);
            join(*of_setup[series.setup].get_or_insert(tip), tip);
            if let Some(point) = series.point {
                join(*of_point[point].get_or_insert(tip), tip);
            }
        }
        for known in &scene.lengths {
            let [a, b] = known.points.map(|point| of_point[point].unwrap_or(0));
            join(a, b);
        }
        let mut numbers: Vec<usize> = frame.clone();
        numbers.sort_unstable();
        numbers.dedup();
        let number = |tip: usize| numbers.iter().position(|known| *known == frame[tip]).unwrap_or(0);
        let of_joint = |joint: usize| number((0..count).find(|&tip| tips[tip].joints[joint]).unwrap_or(0));
        Self {
            count: numbers.len(),
            joints: (0..chain.joints().len()).map(of_joint).collect(),
            setups: of_setup.into_iter().map(|tip| number(tip.unwrap_or(0))).collect(),
            points: of_point.into_iter().map(|tip| number(tip.unwrap_or(0))).collect(),
            targets: (0..scene.targets.len()).map(|target| number(scene.tip_of(target))).collect(),
            tips,
        }
    }

    /// Whether joint `first` carries joint `other`, which may be itself.
    pub fn carries(&self, first: usize, other: usize) -> bool {
        self.tips.carries(first, other)
    }
}
