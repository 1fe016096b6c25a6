//! Two tips of a simulated arm that touch each other or hold one tool: only the joint readings are measured.

use super::postures::brought_to;
use super::{SimulationOptions, commanded_readings, draw_arm, gross_error, normal, normal_vector, true_target};
use crate::arm::Arm;
use denavit_measurements::kinds::ObservationKind;
use denavit_measurements::word_of_two_tips;
use denavit_model::nalgebra::{SVector, Vector3};
use denavit_model::{Chain, Pose, se3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Candidate postures per required one: from most the hands do not reach each other within the joint limits.
pub const TRIES: usize = 60;
/// Postures that hold a tool are searched within this fraction of the way from a known one to any other: farther away few converge.
const NEAR: f64 = 0.4;
/// Number of postures, of which the one with the nearest tips defines the grip.
const LOOKED_AT: usize = 200;

/// A simulated run of two tips.
#[derive(Debug, Clone)]
pub struct TwoTips {
    /// The true arm; a tool's frame is that of the first tip.
    pub arm: Arm,
    /// Joint readings row by row, in the chain's coordinate order, rad or m.
    pub readings: Vec<Vec<f64>>,
    /// Rows with a gross error.
    pub outliers: Vec<usize>,
    /// For a tool: joint readings that hold it.
    pub holding: Option<Vec<f64>>,
}

/// Whether two tips touch each other, or hold a tool.
pub(super) fn is_of(options: &SimulationOptions) -> bool {
    options.tips.as_ref().is_some_and(|tips| tips.several()) && word_of_two_tips(options.kind).is_some()
}

/// Draws a true arm near the nominal one, and brings its two tips together: in as many rows as requested, or fewer where the tips
/// meet from too few of the readings.
pub fn simulate(chain: &Chain, options: &SimulationOptions) -> TwoTips {
    let mut random = ChaCha8Rng::seed_from_u64(options.seed);
    let mut arm = draw_arm(chain, options, &mut random);
    let holding = (options.kind == ObservationKind::Grip).then(|| with_a_tool(&mut arm, options.seed));
    bring(arm, holding, options, &mut random)
}

impl TwoTips {
    /// The same robot again, with its own seed.
    #[must_use]
    pub fn again(&self, options: &SimulationOptions) -> Self {
        bring(self.arm.clone(), self.holding.clone(), options, &mut ChaCha8Rng::seed_from_u64(options.seed))
    }
}

/// Defines the grip of a tool by the posture with the nearest tips, of many; returns that posture.
fn with_a_tool(arm: &mut Arm, seed: u64) -> Vec<f64> {
    arm.targets.fill(Pose::identity());
    let away = |q: &Vec<f64>| between(arm, q).translation.vector.norm();
    let postures = commanded_readings(&arm.nominal, LOOKED_AT, seed);
    let nearest = postures.into_iter().min_by(|a, b| away(a).total_cmp(&away(b))).expect("some are looked at");
    arm.targets[1] = between(arm, &nearest).inverse();
    nearest
}

/// Pose of the second tip's target in the first tip's target frame.
fn between(arm: &Arm, q: &[f64]) -> Pose {
    true_target(arm, q, 0).inverse() * true_target(arm, q, 1)
}

/// Vector from the second tip's target to the first one's, m, base frame.
pub fn touch(arm: &Arm, q: &[f64]) -> Vector3<f64> {
    true_target(arm, q, 0).translation.vector - true_target(arm, q, 1).translation.vector
}

/// Difference of the tool's pose by the two tips: position (m) and rotation (rad), in the tool's frame by the first tip.
pub fn apart(arm: &Arm, q: &[f64]) -> SVector<f64, 6> {
    let off = between(arm, q);
    let (place, turn) = (off.translation.vector, se3::rotation_vector(&off.rotation));
    SVector::from_column_slice(&[place.x, place.y, place.z, turn.x, turn.y, turn.z])
}

fn bring(arm: Arm, holding: Option<Vec<f64>>, options: &SimulationOptions, random: &mut ChaCha8Rng) -> TwoTips {
    let chain = &arm.nominal;
    let starts = options.readings.clone();
    let starts = starts.unwrap_or_else(|| commanded_readings(chain, options.rows * TRIES, options.seed));
    let (mut readings, mut outliers) = (Vec::new(), Vec::new());
    for start in starts {
        if readings.len() == options.rows {
            break;
        }
        let (gross, error) = gross_error(options, random);
        let place = normal_vector(random, options.noise_position) + error;
        let turn = normal_vector(random, options.noise_orientation);
        let found = if let Some(near) = &holding {
            let scatter = SVector::from_column_slice(&[place.x, place.y, place.z, turn.x, turn.y, turn.z]);
            let start = start.iter().zip(near).map(|(q, near)| *near + NEAR * (q - *near)).collect();
            brought_to(chain, |q| scatter - apart(&arm, q), start)
        } else {
            brought_to(chain, |q| place - touch(&arm, q), start)
        };
        let Some(mut reading) = found else { continue };
        for (value, deviation) in reading.iter_mut().zip(&options.repeatability) {
            *value -= normal(random, *deviation);
        }
        outliers.extend(gross.then_some(readings.len()));
        readings.push(reading);
    }
    TwoTips { arm, readings, outliers, holding }
}

/// The rows as a file, with `comments` on top: the column `word` (`contact`, `grip`) holds the same label in each row.
pub fn write(run: &TwoTips, word: &str, label: &str, comments: &[String]) -> String {
    let comments = comments.iter().flat_map(|comment| ["# ", comment.as_str(), "\n"]).collect::<String>();
    let names = run.arm.nominal.coordinates().iter().map(|coordinate| coordinate.name.as_str());
    let mut writer = csv::Writer::from_writer(comments.into_bytes());
    let to_memory = "writing to memory does not fail";
    let head = std::iter::once("tip").chain(names).chain(std::iter::once(word));
    writer.write_record(head).expect(to_memory);
    let tips = run.arm.tips.all().iter().map(|tip| tip.name.as_str()).collect::<Vec<_>>().join("+");
    for reading in &run.readings {
        let cells = reading.iter().map(f64::to_string);
        let cells = std::iter::once(tips.clone()).chain(cells).chain(std::iter::once(label.to_owned()));
        writer.write_record(cells).expect(to_memory);
    }
    let bytes = writer.into_inner().expect(to_memory);
    String::from_utf8(bytes).expect("only UTF-8 was written")
}
