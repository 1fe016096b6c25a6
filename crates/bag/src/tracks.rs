//! The data of a bag's topics: joint readings and target positions, each by its own clock and the recorder's.

use crate::BagOptions;
use crate::clock::median;
use crate::error::BagError;
use crate::messages::{JointState, Places, joint_state, placed, places, plain};
use crate::storage::messages;
use std::collections::BTreeMap;

/// Values over time.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Track {
    /// The topic, and for transforms among others their frames.
    pub name: String,
    /// By the sender's clock, s; by the recorder's where the messages have no stamps.
    pub stamps: Vec<f64>,
    /// By the recorder's clock, s.
    pub logged: Vec<f64>,
    /// Joint readings (rad, m), or x, y, z (m) and, where they were sent, the quaternion x, y, z, w.
    pub values: Vec<Vec<f64>>,
}

impl Track {
    fn push(&mut self, stamp: f64, logged: f64, values: Vec<f64>) {
        self.stamps.push(if stamp == 0.0 { logged } else { stamp });
        self.logged.push(logged);
        self.values.push(values);
    }

    /// The first message after which the sender's clock differs from the recorder's by a different offset, and the change, s.
    ///
    /// Late messages differ, too, but not those around them.
    fn jump(&self) -> Option<(usize, f64)> {
        let ahead: Vec<f64> = self.stamps.iter().zip(&self.logged).map(|(stamp, logged)| stamp - logged).collect();
        (1..ahead.len()).filter(|&at| (ahead[at] - ahead[at - 1]).abs() > JUMP).find_map(|at| {
            let before = median(ahead[at.saturating_sub(AROUND_A_JUMP)..at].to_vec());
            let after = median(ahead[at..ahead.len().min(at + AROUND_A_JUMP)].to_vec());
            ((after - before).abs() > JUMP).then_some((at, after - before))
        })
    }

    /// In the order of the sender's clock: networks overtake.
    ///
    /// # Errors
    /// The clock was set meanwhile, so that its times have no order.
    fn ordered(self, file: &str) -> Result<Self, BagError> {
        match self.jump() {
            None => Ok(self.sorted()),
            Some((at, seconds)) => Err(BagError::ClockJumps {
                file: file.into(),
                topic: self.name,
                seconds: format!("{seconds:+.1}"),
                number: at + 1,
            }),
        }
    }

    /// In the order of the stamps.
    fn sorted(self) -> Self {
        let mut order: Vec<usize> = (0..self.stamps.len()).collect();
        order.sort_by(|&a, &b| self.stamps[a].total_cmp(&self.stamps[b]));
        Self {
            stamps: order.iter().map(|&at| self.stamps[at]).collect(),
            logged: order.iter().map(|&at| self.logged[at]).collect(),
            values: order.iter().map(|&at| self.values[at].clone()).collect(),
            name: self.name,
        }
    }
}

/// A clock that steps by more than this was set, s: networks and drift do less.
const JUMP: f64 = 2.0;
/// Messages on either side of a jump that must agree on it.
const AROUND_A_JUMP: usize = 20;

const JOINT_TOPIC: &str = "‹joint-topic›";
const TARGET_TOPIC: &str = "‹target-topic›";

#[derive(Default)]
struct Found {
    topics: BTreeMap<String, String>,
    /// How many messages a topic has had.
    numbers: BTreeMap<String, usize>,
    joints: BTreeMap<String, Track>,
    /// Joints that readings name, where these are not the robot's.
    others: BTreeMap<String, Vec<String>>,
    targets: BTreeMap<String, Track>,
}

/// The joints' readings and the target's places.
///
/// # Errors
/// A bag that cannot be read, or that does not say which topics are meant.
pub(crate) fn tracks(bag: &str, asked: &BagOptions) -> Result<(Track, Track), BagError> {
    let mut found = Found::default();
    messages(bag, &mut |message| {
        let known = found.topics.entry(message.topic.into()).or_insert_with(|| message.kind.into());
        let kind = plain(known);
        let number = found.numbers.entry(message.topic.into()).or_default();
        *number += 1;
        let wrong =
            || BagError::Message { file: bag.into(), topic: message.topic.into(), number: *number, kind: kind.clone() };
        if kind == "sensor_msgs/JointState" {
            let state = joint_state(message.bytes).ok_or_else(wrong)?;
            found.take_joints(message.topic, message.logged, &state, asked);
        } else if let Some(places) = places(&kind) {
            let all = placed(places, message.bytes).ok_or_else(wrong)?;
            for one in all {
                let name = match places {
                    Places::Transforms => format!("{}:{}", message.topic, one.frames),
                    _ => message.topic.into(),
                };
                let values = one.place.iter().chain(one.turn.iter().flatten()).copied().collect();
                let wanted = asked.target_topic.as_ref().is_none_or(|topic| *topic == name);
                let track = found.targets.entry(name.clone()).or_insert_with(|| Track { name, ..Track::default() });
                // Of others only the names are needed.
                if wanted {
                    track.push(one.stamp, message.logged, values);
                }
            }
        }
        Ok(())
    })?;
    let joints = found.joints_of(bag, asked)?;
    let target = found.target_of(bag, asked)?;
    Ok((joints.ordered(bag)?, target.ordered(bag)?))
}

impl Found {
    fn take_joints(&mut self, topic: &str, logged: f64, state: &JointState, asked: &BagOptions) {
        let value = |joint: &String| {
            let at = state.names.iter().position(|name| name == joint)?;
            state.positions.get(at).copied()
        };
        match asked.joints.iter().map(value).collect::<Option<Vec<f64>>>() {
            Some(values) => {
                let name = topic.to_owned();
                let track = self.joints.entry(topic.into()).or_insert_with(|| Track { name, ..Track::default() });
                if asked.joint_topic.as_ref().is_none_or(|wanted| wanted == topic) {
                    track.push(state.stamp, logged, values);
                }
            }
            None => _ = self.others.entry(topic.into()).or_insert_with(|| state.names.clone()),
        }
    }

    fn joints_of(&mut self, file: &str, asked: &BagOptions) -> Result<Track, BagError> {
        if self.joints.is_empty() {
            let said = self.others.iter().map(|(topic, names)| format!("{topic} has {}", names.join(", ")));
            let found = said.collect::<Vec<_>>().join("; ");
            let found = if found.is_empty() { format!("the topics are {}", listed(self.topics.keys())) } else { found };
            return Err(BagError::NoJoints { file: file.into(), wanted: asked.joints.join(", "), found });
        }
        chosen(file, &mut self.joints, asked.joint_topic.as_deref(), "the joints' readings", JOINT_TOPIC)
    }

    fn target_of(&mut self, file: &str, asked: &BagOptions) -> Result<Track, BagError> {
        if self.targets.is_empty() {
            return Err(BagError::NoTarget { file: file.into(), found: listed(self.topics.keys()) });
        }
        chosen(file, &mut self.targets, asked.target_topic.as_deref(), "the target", TARGET_TOPIC)
    }
}

fn listed<'a>(names: impl Iterator<Item = &'a String>) -> String {
    let names: Vec<&str> = names.map(String::as_str).collect();
    if names.is_empty() { "none".into() } else { names.join(", ") }
}

fn chosen(
    file: &str,
    tracks: &mut BTreeMap<String, Track>,
    wanted: Option<&str>,
    what: &'static str,
    option: &'static str,
) -> Result<Track, BagError> {
    let found = listed(tracks.keys());
    let file = file.to_owned();
    match wanted {
        Some(topic) => {
            tracks.remove(topic).ok_or_else(|| BagError::NoTopic { file, option, topic: topic.into(), what, found })
        }
        None => match tracks.pop_first() {
            Some((_, track)) if tracks.is_empty() => Ok(track),
            _ => Err(BagError::Several { file, what, found, option }),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hundred messages a second apart, by a clock that is `ahead(k)` ahead of the recorder's.
    fn track(ahead: impl Fn(u32) -> f64) -> Track {
        let mut track = Track { name: "/tracker".into(), ..Track::default() };
        (0..100).for_each(|k| track.push(1e9 + f64::from(k) + ahead(k), 1e9 + f64::from(k), vec![0.0]));
        track
    }

    #[test]
    fn a_clock_that_was_set_is_an_error_and_late_messages_are_none() {
        for jump in [-5.0, 3.0, 86_400.0] {
            let error = track(|k| if k < 40 { 0.3 } else { 0.3 + jump }).ordered("run.mcap").unwrap_err().to_string();
            assert!(
                error.contains(&format!("the clock of /tracker jumps by {jump:+.1} s at its message 41")),
                "{error}"
            );
        }
        let late = track(|k| if k % 17 == 3 { -4.0 } else { 7.25 }).ordered("run.mcap").unwrap();
        assert!(late.stamps.is_sorted() && late.stamps.len() == 100);
    }
}
