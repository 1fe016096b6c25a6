//! Control of the false discovery rate in many tests.

/// Benjamini and Hochberg's step-up rule: among the discoveries, the expected fraction of false ones is at most `rate`.
///
/// It is valid for independent tests, such as those of different robots, and for positive dependence.
///
/// # Reference
/// Y. Benjamini, Y. Hochberg, "Controlling the false discovery rate", J. R. Statist. Soc. B 57 (1995), 289-300.
///
/// # Examples
/// ```
/// use denavit_fleet::statistics::false_discovery::discoveries;
/// let found = discoveries(&[0.001, 0.2, 0.012, 0.03], 0.05);
/// assert_eq!(found, [true, false, true, true]);
/// ```
pub fn discoveries(p_values: &[f64], rate: f64) -> Vec<bool> {
    let mut sorted: Vec<f64> = p_values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let count = sorted.len() as f64;
    let passes = |(rank, p): (usize, &f64)| *p <= rate * (rank + 1) as f64 / count;
    let last = sorted.iter().enumerate().filter(|(rank, p)| passes((*rank, p))).map(|(_, p)| *p).next_back();
    p_values.iter().map(|p| last.is_some_and(|last| *p <= last)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example of the paper, section 3.2: fifteen p-values, of which the rule rejects four at 0.05.
    #[test]
    fn the_example_of_benjamini_and_hochberg() {
        let p = [
            0.0001, 0.0004, 0.0019, 0.0095, 0.0201, 0.0278, 0.0298, 0.0344, 0.0459, 0.3240, 0.4262, 0.5719, 0.6528,
            0.7590, 1.0000,
        ];
        assert_eq!(discoveries(&p, 0.05).iter().filter(|found| **found).count(), 4);
        assert!(discoveries(&[], 0.05).is_empty());
    }
}
