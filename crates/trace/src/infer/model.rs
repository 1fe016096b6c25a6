//! The priors of all parameters of the inference.
//!
//! | block | numbers | prior |
//! |---|---|---|
//! | geometry η | axes, in the layout's order | normal, covariance of machining and mastering ([`denavit_identify::prior`]) |
//! | frames φ | instrument, targets | flat |
//! | effects β | coefficients of named effects | normal about 0, an engineer's size or unit information |
//! | curve of joint j, w_j | one number per wave | normal about 0, variance = spectral density of the kernel at the wave |
//! | noise ε | | normal, one level per channel; replicates of a posture share one misfit (`replicates`) |

use denavit_identify::effects::curve::{Curve, Waves};

/// Largest periodic errors, bumps, play and error curves of joints that machines have, rad or m; more is geometry or visible
/// damage.
pub const LARGEST: f64 = 3e-3;

/// Hyperparameters of one curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kernel {
    /// Natural logarithm of the curve's variance, rad² or m².
    pub log_variance: f64,
    /// Natural logarithm of its length scale, rad or m.
    pub log_length: f64,
}

impl Kernel {
    /// That of a fitted curve.
    pub fn of(curve: &Curve) -> Self {
        Self { log_variance: 2.0 * curve.size.ln(), log_length: curve.length.ln() }
    }

    /// Logarithm of the spectral density of the Matérn kernel of smoothness 5/2 at a frequency, and its derivative by the
    /// logarithm of the length (Rasmussen, Williams 2006, eq. 4.15). Curves of gears are smooth, but not infinitely so:
    /// they have short waves as well as long ones.
    pub fn log_density(&self, frequency: f64) -> (f64, f64) {
        let inverse = (-2.0 * self.log_length).exp() * 5.0;
        let sum = inverse + frequency * frequency;
        let constant = (16.0f64 / 3.0).ln() + 2.5 * 5.0f64.ln();
        let value = self.log_variance + constant - 5.0 * self.log_length - 3.0 * sum.ln();
        (value, -5.0 + 6.0 * inverse / sum)
    }

    /// Prior variance of each wave's number, rad² or m², and the derivative of its logarithm by the length's.
    pub fn variances(&self, waves: &Waves) -> Vec<(f64, f64)> {
        let unit = waves.variance_per_density();
        (0..waves.len())
            .map(|index| {
                let (density, slope) = self.log_density(waves.frequency(index));
                (density.exp() * unit, slope)
            })
            .collect()
    }
}

/// All hyperparameters: the marginal likelihood is maximised over them.
#[derive(Debug, Clone, PartialEq)]
pub struct Hyperparameters {
    /// Logarithm of the noise's variance relative to that of the linearisation.
    pub log_noise: f64,
    /// One kernel per curve.
    pub kernels: Vec<Kernel>,
}

impl Hyperparameters {
    /// As a list: noise, then variance and length of each curve.
    pub fn to_vec(&self) -> Vec<f64> {
        let kernels = self.kernels.iter().flat_map(|kernel| [kernel.log_variance, kernel.log_length]);
        std::iter::once(self.log_noise).chain(kernels).collect()
    }

    /// From such a list.
    pub fn from_slice(list: &[f64]) -> Self {
        let kernels = list[1..].chunks_exact(2).map(|pair| Kernel { log_variance: pair[0], log_length: pair[1] });
        Self { log_noise: list[0], kernels: kernels.collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variances_of_the_waves_add_up_to_the_curves_variance() {
        // The kernel at distance 0, halfway between the ends: Σ v_k b_k(x)².
        for (waves, reading) in
            [(Waves::over(0.0, 3.0, false, 200.0, 500), 1.4), (Waves::over(-4.0, 4.0, true, 200.0, 500), 0.3)]
        {
            let kernel = Kernel { log_variance: (2.5e-7f64).ln(), log_length: (0.2f64).ln() };
            let sum: f64 =
                kernel.variances(&waves).iter().zip(waves.values(reading)).map(|((v, _), b)| v * b * b).sum();
            // Turns have no constant wave: that is the joint's zero.
            let constant = match waves {
                Waves::Turns { .. } => 0.5 * kernel.log_density(0.0).0.exp() * waves.variance_per_density(),
                Waves::Sines { .. } => 0.0,
            };
            assert!(((sum + constant) / 2.5e-7 - 1.0).abs() < 0.02, "{sum}");
        }
    }

    #[test]
    fn the_slope_is_the_densitys() {
        for frequency in [0.1, 3.0, 40.0] {
            let at = |log_length: f64| Kernel { log_variance: -12.0, log_length }.log_density(frequency);
            let slope = (at(-1.0 + 1e-6).0 - at(-1.0 - 1e-6).0) / 2e-6;
            assert!((slope - at(-1.0).1).abs() < 1e-7);
        }
    }
}
