//! Where the robot stands still, by its joints' readings.

use crate::tracks::Track;

/// A joint stands while its readings stay within this, rad or m: encoder readings fluctuate.
const STILL: f64 = 5e-4;
/// Shortest standstill, s.
pub(crate) const LEAST: f64 = 0.5;
/// Left out at both ends, s: the arm's oscillation and the uncertainty of the clocks.
pub(crate) const SETTLING: f64 = 0.15;

/// The standstills as pairs of times by the joints' clock, s, without what is left out at their ends.
pub(crate) fn standstills(joints: &Track) -> Vec<[f64; 2]> {
    let (stamps, values) = (&joints.stamps, &joints.values);
    let mut found = Vec::new();
    let mut first = 0;
    while first < stamps.len() {
        let (mut least, mut most) = (values[first].clone(), values[first].clone());
        let mut end = first + 1;
        while end < stamps.len() {
            for (k, value) in values[end].iter().enumerate() {
                least[k] = least[k].min(*value);
                most[k] = most[k].max(*value);
            }
            if least.iter().zip(&most).any(|(least, most)| most - least > STILL) {
                break;
            }
            end += 1;
        }
        let (from, to) = (stamps[first], stamps[end - 1]);
        if to - from >= LEAST {
            found.push([from + SETTLING, to - SETTLING]);
            first = end;
        } else {
            first += 1;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_robot_that_trembles_stands_and_one_that_creeps_does_not() {
        let mut joints = Track::default();
        // Two seconds still, two of motion, two still; then creeping by 2 mrad/s.
        for k in 0..1000 {
            let time = 0.01 * f64::from(k);
            let q = match time {
                ..2.0 => 0.0,
                2.0..4.0 => time - 2.0,
                4.0..6.0 => 2.0,
                _ => 2.0 + 2e-3 * (time - 6.0),
            };
            joints.stamps.push(time);
            joints.values.push(vec![q + 2e-4 * f64::from(k % 2), 0.1]);
        }
        let found = standstills(&joints);
        assert_eq!(found.len(), 2, "{found:?}");
        let near = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs() < 0.2 && (a[1] - b[1]).abs() < 0.2;
        assert!(
            near(found[0], [SETTLING, 2.0 - SETTLING]) && near(found[1], [4.0 + SETTLING, 6.0 - SETTLING]),
            "{found:?}"
        );
    }
}
