//! A short hash that identifies a robot in CI, independent of how its file is written.
//!
//! The first hash covers screw axes, their kinds, pitches, limits and couplings, and empty leaf frames; the second covers
//! masses, shapes, and controller and simulator settings. All are in the root link's frame at zero, so link frames, the
//! order of elements and the spelling of numbers have no effect. Names have no effect either; the pose of the robot on
//! its root link has.
//!
//! **Rounding.** A number x becomes its cell floor(x / grid + offset). The grid is tolerance / √3, for
//! matrices tolerance / 3: a vector or matrix that changes by the tolerance or more has a component that changes its
//! cell, so the hash changes. The offset keeps the
//! borders of the cells away from numbers that people write. Still, a number may be within 1e-4 of a cell
//! from a border, and then another computer may put it on the other side: for each such number both cells are hashed,
//! and [`Fingerprint::matches`] accepts either. Equal robots thus match on every platform, robots a tolerance apart
//! never do (except with probability 2⁻⁴⁸ of the hash).
//!
//! **Fingerprints and diff.** The hash covers exactly what [`crate::compare`] compares, at the same tolerance. Robots
//! whose numbers differ by no more than 1e-4 of a cell - rounding, another notation, another choice of link frames - have
//! matching fingerprints. Between that and the tolerance a number may have crossed a border of its cell: then the
//! fingerprints differ although diff says "the same", and diff is right. No hash can do better: otherwise a series of robots, each
//! within the tolerance of the next, would have the same hash from end to end.

mod cells;
mod digest;

pub use cells::DEFAULT_TOLERANCE;

use crate::mechanism::Mechanism;
use crate::subject::Subject;
use denavit_model::tree::Reading;
use serde::Serialize;
use std::fmt;
use thiserror::Error;

/// Two hashes: of the motion, and of masses, shapes and settings.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fingerprint {
    /// m, rad, and relative for masses.
    pub tolerance: f64,
    /// Of axes, kinds, pitches, limits, couplings and empty leaf frames; twelve hexadecimal digits.
    pub motion: String,
    /// Of masses, shapes, speeds, efforts, damping, friction, soft limits, transmissions and settings; twelve hexadecimal digits.
    pub matter: String,
    /// Values of `motion` if numbers near a cell border fall on its other side.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub other_motions: Vec<String>,
    /// Values of `matter` if numbers near a cell border fall on its other side.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub other_matters: Vec<String>,
}

/// The first field of a fingerprint: what is hashed, and how. Another number, another meaning.
const FORMAT: &str = "d3";

/// The fingerprint of a robot at a tolerance in m and rad, angles and axes read as intended.
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
    fingerprint_as(subject, tolerance, Reading::Intended)
}

/// The same, angles and axes as written or as intended.
pub fn fingerprint_as(subject: &Subject, tolerance: f64, reading: Reading) -> Fingerprint {
    let mut mechanism: Mechanism = subject.mechanism(reading);
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

/// Why a text is not a comparable fingerprint.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum FingerprintError {
    /// Not five fields between hyphens, the last two of hexadecimal digits.
    #[error(
        "\"{0}\" is not a fingerprint; it looks like d3-1e-6-98f2c1a0b3d4-55e01f7a9c22, as `denavit fingerprint` \
         prints it"
    )]
    NotAFingerprint(String),
    /// Another version, which hashed other things.
    #[error("\"{written}\" is of format {format}, but this version uses {FORMAT}; make a new fingerprint")]
    OtherFormat {
        /// The text.
        written: String,
        /// Its first field.
        format: String,
    },
    /// Hashes of another cell size cannot be compared.
    #[error("\"{written}\" has the tolerance {tolerance}; compare with ‹tolerance› {tolerance}")]
    OtherTolerance {
        /// The text.
        written: String,
        /// Its second field.
        tolerance: String,
    },
}

impl Fingerprint {
    /// Whether a text can be compared with this fingerprint at all.
    ///
    /// # Errors
    /// It is not a fingerprint, or has another format or tolerance.
    pub fn comparable(&self, written: &str) -> Result<(), FingerprintError> {
        let text = written.trim();
        let not = || FingerprintError::NotAFingerprint(text.to_owned());
        let (head, matter) = text.rsplit_once('-').ok_or_else(not)?;
        let (head, motion) = head.rsplit_once('-').ok_or_else(not)?;
        let (format, tolerance) = head.split_once('-').ok_or_else(not)?;
        let hash = |text: &str| text.len() == 12 && text.bytes().all(|byte| byte.is_ascii_hexdigit());
        let known = format.strip_prefix('d').is_some_and(|version| version.parse::<u32>().is_ok());
        if !(hash(matter) && hash(motion) && known && tolerance.parse::<f64>().is_ok()) {
            return Err(not());
        }
        if format != FORMAT {
            return Err(FingerprintError::OtherFormat { written: text.to_owned(), format: format.to_owned() });
        }
        if tolerance != format!("{:e}", self.tolerance) {
            return Err(FingerprintError::OtherTolerance { written: text.to_owned(), tolerance: tolerance.to_owned() });
        }
        Ok(())
    }

    /// Whether a stored fingerprint is that of this robot.
    pub fn matches(&self, written: &str) -> bool {
        let Some((head, matter)) = written.trim().rsplit_once('-') else { return false };
        self.is_of(head, |motion| self.has_motion(motion))
            && (matter == self.matter || self.other_matters.iter().any(|other| other == matter))
    }

    /// Whether a stored fingerprint is that of a robot with the same motion, whatever its masses.
    pub fn moves_as(&self, written: &str) -> bool {
        written.trim().rsplit_once('-').is_some_and(|(head, _)| self.is_of(head, |motion| self.has_motion(motion)))
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
