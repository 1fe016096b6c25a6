//! Numbers as a URDF writes them: the shortest text that reads back as the number, and `rpy` without loss near a pitch
//! of a quarter turn.

use denavit_model::nalgebra::Vector3;
pub(crate) use denavit_model::se3::clean_angle;
use denavit_model::se3::{self, Pose, written_rpy as rpy};

/// Rounding of one or two products, relative to their factors.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The shortest decimal that reads back as `value`; never `-0`.
pub fn word(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if value.abs() < 1e-5 { format!("{value:e}") } else { format!("{value}") }
}

/// Three words, with blanks between them.
pub fn three(values: [f64; 3]) -> String {
    values.map(word).join(" ")
}

/// `value` without rounding error: the decimal of twelve places that is within rounding, relative to
/// `scale`, if there is one.
pub fn clean(value: f64, scale: f64) -> f64 {
    let tolerance = ROUNDING * scale.max(value.abs());
    let rounded = (value * 1e12).round() / 1e12;
    if (rounded - value).abs() <= tolerance { rounded + 0.0 } else { value }
}

/// A pose in the numbers that will be written.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Numbers {
    /// m.
    pub xyz: [f64; 3],
    /// Fixed-axis angles, rad.
    pub rpy: [f64; 3],
}

impl Numbers {
    /// Of a pose; `scale` is the length, m, whose rounding the translation carries.
    pub fn of(pose: &Pose, scale: f64) -> Self {
        let t = pose.translation.vector;
        Self { xyz: [t.x, t.y, t.z].map(|x| clean(x, scale)), rpy: rpy(&pose.rotation) }
    }

    /// parent_from_child.
    pub fn pose(&self) -> Pose {
        se3::pose(se3::rotation_from_rpy(self.rpy), Vector3::from(self.xyz))
    }

    /// `<origin …/>`.
    pub fn element(&self) -> String {
        format!("<origin xyz=\"{}\" rpy=\"{}\"/>", three(self.xyz), three(self.rpy))
    }
}

/// Three numbers where a text already has three: words whose numbers stay, to the rounding of `scale`, stay.
pub(crate) fn three_over(written: &str, values: [f64; 3], scale: f64) -> String {
    let words: Vec<&str> =
        written.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty()).collect();
    let [x, y, z] = words[..] else { return three(values) };
    let kept = [x, y, z].map(|word| word.parse::<f64>().ok());
    let stays = |index: usize| kept[index].is_some_and(|old: f64| (old - values[index]).abs() <= ROUNDING * scale);
    if (0..3).all(stays) {
        return written.to_owned();
    }
    [0, 1, 2].map(|index| if stays(index) { words[index].to_owned() } else { word(values[index]) }).join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

    #[test]
    fn numbers_are_short_and_never_minus_zero() {
        for (value, expected) in [
            (-0.0, "0"),
            (0.1625, "0.1625"),
            (FRAC_PI_2, "1.5707963267948966"),
            (-3e-7, "-3e-7"),
            (1e-17, "1e-17"),
            (1234.5, "1234.5"),
        ] {
            assert_eq!(word(value), expected);
        }
        assert_eq!(word(clean(0.16250000000000003, 1.0)), "0.1625");
        assert_eq!(word(clean(0.1625000000004, 1.0)), "0.1625000000004");
        assert_eq!(clean_angle(FRAC_PI_4 + 1e-16), FRAC_PI_4);
        assert_eq!(clean_angle(-FRAC_PI_2 - 2e-16), -FRAC_PI_2);
    }

    #[test]
    fn words_that_stay_keep_their_form() {
        assert_eq!(three_over("0.0, 0.10  1e-1", [0.0, 0.1, 0.1], 1.0), "0.0, 0.10  1e-1");
        assert_eq!(three_over("0.0, 0.10  1e-1", [0.5, 0.1, 0.1], 1.0), "0.5 0.10 1e-1");
        assert_eq!(three_over("oops", [0.5, 0.1, 0.1], 1.0), "0.5 0.1 0.1");
    }

    proptest! {
        #[test]
        fn rpy_gives_the_rotation_back(roll in -PI..PI, yaw in -PI..PI, sign in prop_oneof![Just(1.0), Just(-1.0)],
            pitch in prop_oneof![-FRAC_PI_2..FRAC_PI_2, Just(FRAC_PI_2), (-17.0..-1.0f64).prop_map(|e| FRAC_PI_2 - 10f64.powf(e))]) {
            let rotation = se3::orthonormalised(&se3::rotation_from_rpy([roll, sign * pitch, yaw]));
            let again = se3::rotation_from_rpy(rpy(&rotation));
            let turned = se3::rotation_angle(&(rotation.inverse() * again));
            prop_assert!(turned < 8e-15, "{turned}");
        }
    }
}
