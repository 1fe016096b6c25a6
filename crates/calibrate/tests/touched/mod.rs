//! A simulated arm that touches the holes of a plate, as the rows that a user would write.

use denavit_calibrate::{Arm, Measurements};
use denavit_identify::initial_guess::rigid_fit;
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::postures::brought_to;
use denavit_identify::simulate::{SimulationOptions, readings, simulate, true_target};
use denavit_measurements::import::ImportOptions;
use denavit_measurements::plate::Plate;
use denavit_measurements::{Units, read_export};
use denavit_model::nalgebra::{Point3, Rotation3, Vector3};
use denavit_model::{Chain, se3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use std::fmt::Write as _;

/// An arm and how it is touched with.
pub struct Touching<'a> {
    pub chain: &'a Chain,
    pub plate: Plate,
    /// Errors of zeros, rad, and of axes, rad and m.
    pub zeros: f64,
    pub axes: [f64; 2],
    /// Error of a touch, m.
    pub noise: f64,
}

/// Joint readings in the holes of one placement after another, and the places of the holes.
pub struct Run {
    pub truth: Arm,
    pub rows: Vec<(Vec<f64>, String, usize)>,
}

impl Touching<'_> {
    /// Rows of this number of placements.
    pub fn run(&self, placements: usize, seed: u64) -> Run {
        let options =
            SimulationOptions { rows: 1, seed, turn: self.axes[0], shift: self.axes[1], ..Default::default() };
        let mut truth = simulate(self.chain, &options, &NoEffects).arm;
        let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0x707a);
        for joint in 0..self.chain.joints().len() {
            truth.shift_zero(joint, random.random_range(-1.0..1.0) * 3_f64.sqrt() * self.zeros);
        }
        let mut rows = Vec::new();
        let mut placement = 0;
        for _ in 0..200 * placements {
            if placement == placements {
                break;
            }
            let Some(placed) = self.placement(&truth, &mut random) else { continue };
            placement += 1;
            rows.extend(placed.into_iter().map(|(q, name)| (q, name, placement)));
        }
        assert_eq!(placement, placements, "the arm does not reach all holes of a plate");
        Run { truth, rows }
    }

    /// A plate somewhere in reach, tilted by up to 30°, and a posture in each of its holes.
    fn placement(&self, truth: &Arm, random: &mut ChaCha8Rng) -> Option<Vec<(Vec<f64>, String)>> {
        let through = readings(self.chain, 1, random.random()).remove(0);
        let middle = true_target(truth, &through, 0).translation.vector;
        let mut any = || random.random_range(-1.0..1.0);
        let turned = Rotation3::from_axis_angle(&Vector3::x_axis(), 0.5 * any())
            * Rotation3::from_axis_angle(&Vector3::y_axis(), 0.5 * any())
            * Rotation3::from_axis_angle(&Vector3::z_axis(), 3.0 * any());
        let half =
            Vector3::new(self.plate.columns as f64 - 1.0, self.plate.rows as f64 - 1.0, 0.0) * self.plate.pitch / 2.0;
        let plate = se3::pose(turned, middle - turned * half);
        let mut found = Vec::new();
        for (name, at) in self.plate.holes() {
            let mut error = || self.noise * random.sample::<f64, _>(StandardNormal);
            let hole = plate * Point3::new(at.x + error(), at.y + error(), error());
            let starts = readings(self.chain, 20, random.random());
            let off = |q: &[f64]| hole.coords - true_target(truth, q, 0).translation.vector;
            found.push((starts.into_iter().find_map(|start| brought_to(self.chain, off, start))?, name));
        }
        Some(found)
    }

    /// The file of some of the rows, and the data that are read from it.
    pub fn data(&self, rows: &[(Vec<f64>, String, usize)]) -> Measurements {
        let names: Vec<&str> = self.chain.coordinates().iter().map(|coordinate| coordinate.name.as_str()).collect();
        let mut text = format!("{},hole,setup\n", names.join(","));
        for (q, hole, placement) in rows {
            for value in q {
                let _ = write!(text, "{value},");
            }
            let _ = writeln!(text, "{hole},{placement}");
        }
        let options = ImportOptions { plate: Some(self.plate), ..ImportOptions::default() };
        read_export("run.csv", text.as_bytes(), self.chain, Units::default(), &options).unwrap().data
    }

    /// How far the holes of one placement are from a plate's, as an arm says it: rms after the best fit of the plate, m.
    pub fn error(&self, arm: &Arm, rows: &[(Vec<f64>, String, usize)]) -> f64 {
        let pair = |(q, hole, _): &(Vec<f64>, String, usize)| {
            (self.plate.hole(hole).unwrap().push(0.0), true_target(arm, q, 0).translation.vector)
        };
        let pairs: Vec<(Vector3<f64>, Vector3<f64>)> = rows.iter().map(pair).collect();
        let plate = rigid_fit(&pairs).unwrap();
        let squares = pairs.iter().map(|(hole, found)| (plate * Point3::from(*hole) - found).coords.norm_squared());
        (squares.sum::<f64>() / pairs.len() as f64).sqrt()
    }
}
