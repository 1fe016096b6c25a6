//! A short hash that says "the same robot" in CI: the same for every way to write the robot down.
//!
//! Hashed are screw axes, their kinds, pitches, limits and couplings, empty leaf frames, and apart from these what the
//! links weigh and show - all in the root link's frame at zero, so that link frames, the order of elements and the
//! spelling of numbers are not in it. Names are not in it either; where the robot stands on its root link is.
//!
//! **Rounding.** A number x becomes its cell floor(x / grid + offset). The grid is tolerance / √3, for
//! matrices tolerance / 3: a vector or matrix that changes by the tolerance or more has a component that changes its
//! cell, so the hash changes. The offset puts the
//! borders of the cells where no number lies that people write. Still, a number may come to lie within 1e-4 of a cell
//! from a border, and then another computer may see it on the other side: for each such number both cells are hashed,
//! and [`Fingerprint::matches`] accepts either. Equal robots thus match on every platform, robots a tolerance apart
//! never do (but for the 2⁻⁴⁸ of the hash); in between they may or may not.

mod cells;
mod digest;

pub use cells::DEFAULT_TOLERANCE;

use crate::mechanism::Mechanism;
use crate::subject::Subject;
use denavit_model::tree::Reading;
use serde::Serialize;
use std::fmt;

/// Two hashes: of what moves how, and of what it weighs and shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fingerprint {
    /// m, rad, and relative for masses.
    pub tolerance: f64,
    /// Of axes, kinds, pitches, limits, couplings and empty leaf frames; twelve hexadecimal digits.
    pub motion: String,
    /// Of masses, shapes, speeds and efforts; twelve hexadecimal digits.
    pub matter: String,
    /// What `motion` is if numbers beside a cell's border fall on its other side.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub other_motions: Vec<String>,
    /// What `matter` is if numbers beside a cell's border fall on its other side.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub other_matters: Vec<String>,
}

/// The first field of a fingerprint: what is hashed, and how. Another number, another meaning.
const FORMAT: &str = "d1";

/// The fingerprint of a robot at a tolerance in m and rad, angles read as written.
///
/// # Examples
/// ```
/// use denavit_compare::{Subject, fingerprint};
/// use denavit_model::examples;
/// let (one, other) = (examples::puma_like(), examples::scara_helical());
/// let of = |chain| fingerprint(&Subject::Chain { file: "-", chain }, 1e-6);
/// assert!(of(&one).matches(&of(&one).to_string()));
/// assert!(!of(&one).matches(&of(&other).to_string()));
/// ```
pub fn fingerprint(subject: &Subject, tolerance: f64) -> Fingerprint {
    let mut mechanism: Mechanism = subject.mechanism(Reading::AsWritten);
    mechanism.join_screws();
    let motion = digest::hashes(tolerance, |cells| digest::motion(&mechanism, cells));
    let matter = digest::hashes(tolerance, |cells| digest::matter(&mechanism, cells));
    let split = |mut hashes: Vec<String>| {
        let first = hashes.remove(0);
        (first, hashes)
    };
    let ((motion, other_motions), (matter, other_matters)) = (split(motion), split(matter));
    Fingerprint { tolerance, motion, matter, other_motions, other_matters }
}

impl Fingerprint {
    /// Whether a fingerprint that was written down is that of this robot.
    pub fn matches(&self, written: &str) -> bool {
        let Some((head, matter)) = written.trim().rsplit_once('-') else { return false };
        self.is_of(head, |motion| self.has_motion(motion))
            && (matter == self.matter || self.other_matters.iter().any(|other| other == matter))
    }

    /// Whether a fingerprint that was written down is that of a robot that moves as this one, whatever it weighs.
    pub fn moves_as(&self, written: &str) -> bool {
        written.trim().rsplit_once('-').is_some_and(|(head, _)| self.is_of(head, |motion| self.has_motion(motion)))
    }

    /// Why a text cannot be compared with this fingerprint: it is none, or one of another version or tolerance. `None` where
    /// it can.
    pub fn not_comparable(&self, written: &str) -> Option<String> {
        let mut parts = written.trim().rsplitn(3, '-');
        let hashes = [parts.next(), parts.next()];
        let is_hash = |hash: &&str| hash.len() == self.motion.len() && hash.chars().all(|c| c.is_ascii_hexdigit());
        let head = parts.next().and_then(|head| head.split_once('-'));
        let head = head.filter(|_| hashes.iter().flatten().filter(|hash| is_hash(hash)).count() == hashes.len());
        let Some((version, tolerance)) = head else {
            return Some(format!("\"{written}\" is no fingerprint; that of this robot is {self}"));
        };
        if version != FORMAT {
            return Some(format!("\"{written}\" was made by another version; that of this robot is now {self}"));
        }
        if tolerance != format!("{:e}", self.tolerance) {
            return Some(format!("\"{written}\" was made with --tolerance {tolerance}; give that, too"));
        }
        None
    }

    fn is_of(&self, head: &str, has: impl Fn(&str) -> bool) -> bool {
        head.rsplit_once('-').is_some_and(|(format, motion)| format == self.format() && has(motion))
    }

    fn has_motion(&self, motion: &str) -> bool {
        motion == self.motion || self.other_motions.iter().any(|other| other == motion)
    }

    fn format(&self) -> String {
        format!("{FORMAT}-{:e}", self.tolerance)
    }
}

impl fmt::Display for Fingerprint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}-{}-{}", self.format(), self.motion, self.matter)
    }
}
