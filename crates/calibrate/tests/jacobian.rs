//! The closed-form residual Jacobian against central differences.

use denavit_calibrate::{Arm, Freedom, Tolerances};
use denavit_identify::arm::Perturbation;
use denavit_identify::arm::Perturbed;
use denavit_identify::arm::Row;
use denavit_identify::parameters::Effects;
use denavit_identify::parameters::Layout;
use denavit_identify::parameters::NoEffects;
use denavit_identify::parameters::Parameter;
use denavit_identify::parameters::ParameterKind;
use denavit_identify::parameters::Sensitivity;
use denavit_identify::residual::ResidualModel;
use denavit_identify::residual::Scratch;
use denavit_identify::simulate::{SimulationOptions, simulate};
use denavit_measurements::kinds::ObservationKind;
use denavit_model::nalgebra::{Vector3, Vector6};
use denavit_model::{examples, se3};

/// Every way in which an effect may act, with numbers that are free.
#[derive(Clone)]
struct Everything {
    values: [f64; 5],
    joint: usize,
    carrier: Vector6<f64>,
}

impl Effects for Everything {
    type Standing = ();

    fn standing(&self, _arm: &Arm) {}

    fn parameters(&self) -> Vec<Parameter> {
        (0..5)
            .map(|index| Parameter {
                name: format!("effect{index}"),
                kind: ParameterKind::Effect { index },
                unit: "1",
                tolerance: None,
            })
            .collect()
    }

    fn perturb(&self, row: Row<'_>, _arm: &Arm, _standing: &mut (), out: &mut Perturbation) -> bool {
        out.twists[self.joint] += self.carrier * (self.values[0] * row.reading()[0].sin());
        out.target += Vector3::new(0.0, self.values[1], 0.0);
        out.anchor += Vector3::new(self.values[2], 0.0, 0.0);
        out.scale += self.values[3];
        out.reading += self.values[4];
        true
    }

    fn sensitivities(&self, row: Row<'_>, _arm: &Arm, _standing: &mut (), at: Perturbed<'_>, out: &mut [Sensitivity]) {
        out[0].twist = se3::adjoint_times(&at.state.before[self.joint], &self.carrier) * row.reading()[0].sin();
        out[1].target = Vector3::new(0.0, 1.0, 0.0);
        out[2].anchor = Vector3::new(1.0, 0.0, 0.0);
        out[3].scale = 1.0;
        out[4].reading = 1.0;
    }

    fn stepped(&self, step: &[f64]) -> Self {
        let mut next = self.clone();
        for (value, step) in next.values.iter_mut().zip(step) {
            *value += step;
        }
        next
    }
}

#[test]
fn columns_are_the_derivatives_of_the_residual() {
    let mut worst: f64 = 0.0;
    for chain in examples::all() {
        for kind in [
            ObservationKind::Pose,
            ObservationKind::Position,
            ObservationKind::Distance,
            ObservationKind::Plane,
            ObservationKind::Dial,
            ObservationKind::Gravity,
            ObservationKind::Inclination,
        ] {
            let options =
                SimulationOptions { kind, rows: 4, targets: 2, turn: 0.02, shift: 0.02, ..Default::default() };
            let run = simulate(&chain, &options, &NoEffects);
            let n = chain.joints().len();
            let freedom =
                Freedom { axes: vec![true; n], scales: vec![true; n], pitches: vec![true; n], zeros: vec![true; n] };
            let effects = Everything {
                values: [0.01, 0.02, -0.03, 0.01, 0.02],
                joint: n / 2,
                carrier: Vector6::new(0.3, -0.2, 0.9, 0.1, 0.4, -0.2),
            };
            let tolerances = Tolerances::default();
            let layout = Layout::new(&chain, &run.data.scene, &freedom, &tolerances, effects.parameters());
            // Away from the truth and from nominal, so that nothing vanishes.
            let mut arm = run.arm.clone();
            let away: Vec<f64> = (0..layout.len()).map(|k| 0.01 * ((k * 7 % 11) as f64 - 5.0)).collect();
            arm = layout.stepped(&arm, &away);
            let (rows, columns) = (run.data.tallest_row(), layout.len());
            let evaluate = |arm: &Arm, effects: &Everything, row: usize| {
                let mut residual = vec![0.0; rows];
                let problem = ResidualModel { data: &run.data, layout: &layout, effects };
                problem.row_into(arm, row, &mut Scratch::new(&layout, arm), &mut residual, None);
                residual
            };
            for row in 0..run.data.len() {
                let mut residual = vec![0.0; rows];
                let mut jacobian = vec![0.0; rows * columns];
                let problem = ResidualModel { data: &run.data, layout: &layout, effects: &effects };
                problem.row_into(&arm, row, &mut Scratch::new(&layout, &arm), &mut residual, Some(&mut jacobian));
                for column in 0..columns {
                    let h = 1e-5;
                    let mut step = vec![0.0; columns];
                    step[column] = h;
                    let plus =
                        evaluate(&layout.stepped(&arm, &step), &effects.stepped(&step[layout.effects.clone()]), row);
                    step[column] = -h;
                    let minus =
                        evaluate(&layout.stepped(&arm, &step), &effects.stepped(&step[layout.effects.clone()]), row);
                    for k in 0..rows {
                        let difference = (plus[k] - minus[k]) / (2.0 * h) - jacobian[k * columns + column];
                        // The effect's own twist is taken to first order in its strength: that is part of the contract.
                        let allowed = if column == layout.effects.start { 0.02 } else { 2e-9 };
                        assert!(
                            difference.abs() < allowed,
                            "{} {kind:?} {}: {difference:e}",
                            chain.name(),
                            layout.parameters[column].name
                        );
                        if column != layout.effects.start {
                            worst = worst.max(difference.abs());
                        }
                    }
                }
            }
        }
    }
    println!("largest difference {worst:e}");
}
