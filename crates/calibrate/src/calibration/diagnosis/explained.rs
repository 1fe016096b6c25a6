//! How much of the measured variation the fitted robot explains: a small error may still be the whole variation.

use denavit_identify::parameters::NoEffects;
use denavit_identify::residual_statistics::each_residual;
use denavit_identify::solve::Fit;
use denavit_measurements::Measurements;
use denavit_measurements::kinds::Frame;
use denavit_model::nalgebra::{Quaternion, Rotation3, UnitQuaternion, Vector3};
use serde::Serialize;

/// Residual as a share of the spread above which it is reported.
const WORTH_A_WORD: f64 = 0.2;
/// Residual as a share of the spread above which nothing is explained: half of the variance.
const EXPLAINS_NOTHING: f64 = 0.7;
/// Motion that the drawing must predict, relative to the residual; else there was nothing to explain.
const EXPECTED_TO_MOVE: f64 = 0.5;
/// Or the residual is more than this share of the robot's size: no instrument has such noise.
const NO_NOISE: f64 = 5e-3;
/// Residual, as a share of the robot's size (or rad), from which on it is examined.
const LOOKED_INTO: f64 = 2e-4;

/// Variation of a measured quantity, and its residual; root mean square of all components together.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Explained {
    /// `position`, `distance`, `orientation` …
    pub of: &'static str,
    /// `m` or `rad`.
    pub unit: &'static str,
    /// Spread of what was measured about its mean.
    pub spread: f64,
    /// Residuals of the fitted geometry, corrected for degrees of freedom.
    pub left: f64,
    /// Spread of what the fitted geometry predicts.
    #[serde(skip)]
    pub predicted: f64,
}

impl Explained {
    /// Whether it is reported.
    pub fn poorly(&self) -> bool {
        self.left > WORTH_A_WORD * self.spread
    }

    /// Whether nothing is explained although there was something to explain; `size`: of the robot, m, or 1 rad.
    pub fn nothing(&self, size: f64) -> bool {
        let moves = self.predicted > EXPECTED_TO_MOVE * self.left || self.unit == "m" && self.left > NO_NOISE * size;
        self.left > EXPLAINS_NOTHING * self.spread && moves && self.left > LOOKED_INTO * size
    }

    /// How large a share of the variance is explained: 1 - left²/spread².
    pub fn share(&self) -> f64 {
        1.0 - (self.left / self.spread.max(f64::MIN_POSITIVE)).powi(2)
    }
}

/// Sums of one series in one channel.
#[derive(Default)]
struct Series {
    measured: Places,
    predicted: Places,
    turned: [Vec<UnitQuaternion<f64>>; 2],
}

/// Positions relative to the first one; rows are not stored, as there may be a million.
#[derive(Default)]
struct Places {
    first: Option<Vector3<f64>>,
    sum: Vector3<f64>,
    squares: f64,
    count: f64,
}

impl Places {
    fn push(&mut self, place: Vector3<f64>) {
        let from_first = place - *self.first.get_or_insert(place);
        self.sum += from_first;
        self.squares += from_first.norm_squared();
        self.count += 1.0;
    }

    /// Sum of squares about the mean, and degrees of freedom.
    fn about_the_mean(&self) -> (f64, f64) {
        let of_mean = self.sum.norm_squared() / self.count.max(1.0);
        ((self.squares - of_mean).max(0.0), (self.count - 1.0).max(0.0))
    }
}

/// This many orientations of a series say how much they vary.
const ORIENTATIONS: usize = 10_000;

/// Spread and rest of every sort of value that is measured as a number.
pub fn explained(fit: &Fit<NoEffects>, data: &Measurements) -> Vec<Explained> {
    let scene = &data.scene;
    let mut series: Vec<Series> = Vec::new();
    series.resize_with(scene.series.len(), Series::default);
    for residual in each_residual(0..data.len(), &fit.arm, &NoEffects, data) {
        if fit.weights[residual.observation] <= 0.0 {
            continue;
        }
        let of = &scene.series[residual.series];
        let values = data.observed.values(residual.observation);
        let own = &mut series[residual.series];
        let measured = match (of.kind.position(values), values.len()) {
            // In the base frame, as residuals are.
            (Some(place), _) => fit.arm.instruments[of.setup].rotation.inverse() * place,
            (None, 1) => Vector3::new(values[0], 0.0, 0.0),
            (None, 2) => {
                let scale = of.channels[0].and_then(|channel| scene.per_pixel(channel)).unwrap_or(1.0);
                Vector3::new(values[0], values[1], 0.0) * scale
            }
            _ => continue,
        };
        // A gauge reads how far the robot is from its drawing, and no motion that the drawing explains.
        if of.kind.unknowns().frame == Frame::Plane {
            continue;
        }
        own.measured.push(measured);
        own.predicted.push(measured - residual.place);
        if let Some(orientation) = of.kind.orientation(values).filter(|_| own.turned[0].len() < ORIENTATIONS) {
            let here =
                UnitQuaternion::from_rotation_matrix(&(fit.arm.instruments[of.setup].rotation.inverse() * orientation));
            let drawn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_scaled_axis(-residual.turn)) * here;
            own.turned[0].push(here);
            own.turned[1].push(drawn);
        }
    }
    let of_channel = |(channel, part): (usize, &denavit_measurements::kinds::Part)| {
        let places: Vec<&Series> = scene
            .series
            .iter()
            .zip(&series)
            .filter(|(of, _)| of.channels[0] == Some(channel))
            .map(|(_, own)| own)
            .collect();
        let turns: Vec<&Series> = scene
            .series
            .iter()
            .zip(&series)
            .filter(|(of, _)| of.channels[1] == Some(channel))
            .map(|(_, own)| own)
            .collect();
        let spread = |pick: &dyn Fn(&Series) -> (f64, f64), of: &[&Series]| {
            let (sum, count) = of.iter().map(|own| pick(own)).fold((0.0, 0.0), |(a, b), (c, d)| (a + c, b + d));
            (count > 0.0).then(|| (sum / count).sqrt())
        };
        let measured = spread(&|own| own.measured.about_the_mean(), &places)
            .or_else(|| spread(&|own| of_turns(&own.turned[0]), &turns))?;
        let predicted = spread(&|own| own.predicted.about_the_mean(), &places)
            .or_else(|| spread(&|own| of_turns(&own.turned[1]), &turns))?;
        let left = fit.noise.levels[channel] * (part.height as f64).sqrt();
        Some(Explained { of: part.word, unit: part.unit, spread: measured, left, predicted })
    };
    scene.channels.iter().enumerate().filter_map(of_channel).collect()
}

/// Sum of squares about the mean, and degrees of freedom.
fn of_turns(turns: &[UnitQuaternion<f64>]) -> (f64, f64) {
    let Some(first) = turns.first() else { return (0.0, 0.0) };
    // The mean on the side of the first.
    let sum = turns.iter().map(|turn| turn.coords * turn.coords.dot(&first.coords).signum());
    let sum = sum.fold(Quaternion::new(0.0, 0.0, 0.0, 0.0).coords, |a, b| a + b);
    if sum.norm() < 1e-9 {
        return (turns.len() as f64, turns.len() as f64);
    }
    let mean = UnitQuaternion::new_normalize(Quaternion::from(sum));
    (turns.iter().map(|turn| (mean.inverse() * turn).angle().powi(2)).sum(), turns.len().saturating_sub(1) as f64)
}
