//! Straight lines between knots.

/// Piecewise linear basis over the knots; the first one is left out and the ends are held.
pub(super) fn hats(value: f64, knots: &[f64], out: &mut Vec<f64>) {
    let (Some(first), Some(last)) = (knots.first(), knots.last()) else { return };
    // Not `clamp`, which panics where the knots are not in order.
    let value = value.max(*first).min(*last);
    out.extend((1..knots.len()).map(|k| {
        if value <= knots[k] {
            ((value - knots[k - 1]) / (knots[k] - knots[k - 1])).max(0.0)
        } else {
            knots.get(k + 1).map_or(1.0, |next| ((next - value) / (next - knots[k])).max(0.0))
        }
    }));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hats_are_straight_between_knots_and_held_beyond() {
        let at = |value: f64| {
            let mut out = Vec::new();
            hats(value, &[0.0, 1.0, 3.0], &mut out);
            out
        };
        assert_eq!(at(0.5), [0.5, 0.0]);
        assert_eq!(at(2.0), [0.5, 0.5]);
        assert_eq!(at(-1.0), [0.0, 0.0]);
        assert_eq!(at(7.0), [0.0, 1.0]);
    }
}
