//! Residuals and their sums by vectors of rows, and row by row.

use denavit_identify::arm::{Arm, Perturbation, Perturbed, Row};
use denavit_identify::parameters::{Effects, Freedom, Layout, NoEffects, Parameter, Sensitivity, Tolerances};
use denavit_identify::residual::ResidualModel;
use denavit_identify::simulate::{SimulationOptions, simulate};
use denavit_measurements::Measurements;
use denavit_measurements::kinds::ObservationKind;
use denavit_model::{Pose, examples};

/// No effects, but computed row by row.
#[derive(Clone)]
struct RowByRow;

impl Effects for RowByRow {
    type Standing = ();
    fn standing(&self, _arm: &Arm) {}
    fn parameters(&self) -> Vec<Parameter> {
        Vec::new()
    }
    fn perturb(&self, _row: Row<'_>, _arm: &Arm, _standing: &mut (), _out: &mut Perturbation) -> bool {
        false
    }
    fn sensitivities(&self, _: Row<'_>, _: &Arm, (): &mut (), _: Perturbed<'_>, _: &mut [Sensitivity]) {}
    fn stepped(&self, _step: &[f64]) -> Self {
        Self
    }
}

#[test]
fn simd_rows_sum_up_to_what_the_rows_do_one_by_one() {
    for chain in examples::all() {
        for (kind, targets) in [(ObservationKind::Pose, 1), (ObservationKind::Position, 3)] {
            let options = SimulationOptions { kind, rows: 77, targets, turn: 0.02, ..Default::default() };
            let mut simulation = simulate(&chain, &options, &NoEffects);
            if targets > 1 {
                // One target is not seen in one row.
                let data = &simulation.data;
                let hidden = data.observed.of_row(3).start + 1;
                let mut fewer = Measurements::empty("", data.joints.clone(), data.scene.clone());
                for row in 0..data.len() {
                    for at in data.of_row(row).filter(|at| *at != hidden) {
                        fewer.observed.push(data.observed.series(at), data.observed.values(at));
                    }
                    fewer.end_row(data.reading(row), row, false);
                }
                simulation.data = fewer;
            }
            let data = &simulation.data;
            let joints = chain.joints().len();
            let freedom = Freedom { scales: vec![true; joints], pitches: vec![true; joints], ..Freedom::axes(joints) };
            let tolerances = Tolerances::default();
            let layout = Layout::new(&chain, &data.scene, &freedom, &tolerances, Vec::new());
            let mut weights: Vec<f64> = (0..data.observations()).map(|k| 1.0 - 0.01 * k as f64 / 77.0).collect();
            weights[5] = 0.0;
            // With the true arm residuals are noise; with the instrument as drawn they are as large as possible.
            for arm in [simulation.arm.clone(), Arm { instruments: vec![Pose::identity()], ..simulation.arm.clone() }] {
                let simd_rows = ResidualModel { data, layout: &layout, effects: &NoEffects }.sums(&arm, &weights);
                let rows = ResidualModel { data, layout: &layout, effects: &RowByRow }.sums(&arm, &weights);
                for (one, other) in simd_rows.squares.iter().flatten().zip(rows.squares.iter().flatten()) {
                    assert!((one.sqrt() - other.sqrt()).abs() < 1e-13, "{one} {other}");
                }
                for (one, other) in simd_rows.channels.iter().zip(&rows.channels) {
                    let largest = |values: &[f64]| values.iter().fold(0.0f64, |most, value| most.max(value.abs()));
                    let size = |k: usize| other.matrix[k * layout.len() + k].sqrt() + 1e-300;
                    for (at, (a, b)) in one.matrix.iter().zip(&other.matrix).enumerate() {
                        let scale = size(at / layout.len()) * size(at % layout.len());
                        assert!((a - b).abs() < 1e-12 * scale + 1e-13, "{} {kind:?} {at}: {a} {b}", chain.name());
                    }
                    let scale = largest(&other.gradient);
                    for (a, b) in one.gradient.iter().zip(&other.gradient) {
                        assert!((a - b).abs() < 1e-11 * (scale + 1.0), "{a} {b}");
                    }
                    assert!((one.cost - other.cost).abs() < 1e-11 * (1.0 + other.cost));
                    assert!((one.count - other.count).abs() < 1e-12 * other.count);
                }
            }
        }
    }
}
