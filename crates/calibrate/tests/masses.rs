//! Masses that a description does not have.

use crate::drawn::drawn;
use denavit_calibrate::calibration::{CalibrateError, CalibrateOptions, HoldOut, calibrate};
use denavit_calibrate::report::text;
use denavit_calibrate::{IdentifyOptions, Measurements};
use denavit_identify::effects::{Carrier, Coupling, Driver, Effect, EffectModel, Kind, SavedEffects, Statics, Term};
use denavit_identify::identify;
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::{SimulationOptions, simulate};
use denavit_measurements::kinds::ObservationKind;
use denavit_model::Chain;
use denavit_trace::TraceOptions;
use denavit_trace::masses::{LinkMasses, link_masses};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::LN_2;

/// Masses of the simulated arm over those of rods: heavy drives in the wrist, a light upper arm.
const RATIOS: [f64; 6] = [1.0, 0.5, 0.5, 3.0, 4.0, 5.0];

/// A UR5e without masses, and one whose masses are not those of rods, each joint as soft as those of its size.
fn arm() -> (Chain, Statics, EffectModel) {
    let (chain, _) = drawn("universal_robots/ur5e.urdf");
    let rods = Statics::of_chain(&chain);
    let mut heavy = rods.clone();
    for point in &mut heavy.masses.points {
        point.mass *= RATIOS[point.joint];
    }
    let soft = |joint: usize, c: f64| Effect {
        term: Term {
            kind: Kind::JointCompliance,
            carrier: Carrier::Joint(joint),
            driver: Driver::Torque(joint),
            coupling: Coupling::Each,
        },
        coefficients: vec![c],
    };
    let effects = EffectModel::new(heavy, vec![soft(1, 2e-5), soft(2, 4e-5), soft(3, 8e-5), soft(4, 1e-4)]);
    (chain, rods, effects)
}

fn rows(chain: &Chain, effects: Option<&EffectModel>, seed: u64) -> Measurements {
    let options =
        SimulationOptions { kind: ObservationKind::Position, rows: 150, seed, ..SimulationOptions::default() };
    effects
        .map_or_else(|| simulate(chain, &options, &NoEffects).data, |effects| simulate(chain, &options, effects).data)
}

fn found(chain: &Chain, rods: &Statics, data: &Measurements) -> Option<LinkMasses> {
    let geometric = identify(chain, data, &IdentifyOptions::axes(chain)).geometric;
    link_masses(rods, data, &geometric, false)
}

#[test]
fn masses_that_all_compliances_share_predict_better_than_rods() {
    let (chain, rods, effects) = arm();
    let total: f64 = rods.masses.points.iter().map(|point| point.mass).sum();
    let ratio = |masses: &[f64]| (masses[3] + masses[4] + masses[5]) / (masses[1] + masses[2]);
    let truth: Vec<f64> = effects.statics.masses.points.iter().map(|point| point.mass).collect();
    let assumed: Vec<f64> = rods.masses.points.iter().map(|point| point.mass).collect();
    for seed in 0..6 {
        let found = found(&chain, &rods, &rows(&chain, Some(&effects), seed)).unwrap_or_else(|| panic!("{seed}: none"));
        let masses: Vec<f64> = found.links.iter().map(|link| link.kg).collect();
        println!("{seed}: {:.2} explained, {masses:.2?}; truth {truth:.2?}, rods {assumed:.2?}", found.explains);
        assert!((found.total_kg / total - 1.0).abs() < 0.05 && !found.total_given, "{found:?}");
        let off = |masses: &[f64]| (ratio(masses) / ratio(&truth)).ln().abs();
        // Each joint has a compliance of its own, so that the rows tell the share of each link and little of its mass.
        assert!(found.explains > 0.1 && off(&masses) < off(&assumed), "{masses:?}");
    }
}

/// Arms like [`arm`] whose masses and compliances are anywhere that the prior expects, the total mass within 1 % of the rods': how far the
/// masses that were found are from the truth, relatively, in the deviations that are reported with them.
fn of_their_deviation(arms: u64) -> Vec<f64> {
    let (chain, rods, like) = arm();
    let total = |statics: &Statics| statics.masses.points.iter().map(|point| point.mass).sum::<f64>();
    let mut off = Vec::new();
    for seed in 0..arms {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let statics = loop {
            let mut statics = rods.clone();
            for point in &mut statics.masses.points {
                let drawn: f64 = StandardNormal.sample(&mut random);
                point.mass *= (LN_2 * drawn).exp();
            }
            if (total(&statics) / total(&rods)).ln().abs() < 0.01 {
                break statics;
            }
        };
        let mut effects = EffectModel { statics, ..like.clone() };
        for effect in &mut effects.effects {
            let drawn: f64 = StandardNormal.sample(&mut random);
            effect.coefficients[0] = 7e-5 * drawn;
        }
        let Some(found) = found(&chain, &rods, &rows(&chain, Some(&effects), seed)) else { continue };
        let truth = effects.statics.masses.points.iter();
        off.extend(
            found.links.iter().zip(truth).map(|(link, point)| (link.kg / point.mass).ln() / (link.std / link.kg)),
        );
    }
    off
}

#[test]
fn intervals_of_masses_hold_the_truth() {
    let off = of_their_deviation(80);
    let scale = (off.iter().map(|off| off * off).sum::<f64>() / off.len() as f64).sqrt();
    let inside = off.iter().filter(|off| off.abs() < 1.96).count() as f64 / off.len() as f64;
    println!("{} masses: error {scale:.2} of their deviation, {inside:.3} of the 95 % intervals", off.len());
    assert!((0.9..1.1).contains(&scale) && (0.92..0.98).contains(&inside));
}

#[test]
fn rods_stay_where_no_row_speaks_against_them() {
    let (chain, rods, _) = arm();
    let as_rods = EffectModel { statics: rods.clone(), ..arm().2 };
    for seed in 0..6 {
        assert_eq!(found(&chain, &rods, &rows(&chain, None, seed)), None, "a rigid arm, {seed}");
        assert_eq!(found(&chain, &rods, &rows(&chain, Some(&as_rods), seed)), None, "an arm of rods, {seed}");
    }
}

#[test]
fn a_calibration_says_and_keeps_the_masses_that_it_used() {
    let (chain, rods, effects) = arm();
    let geometry = CalibrateOptions::geometry(&chain);
    let trace = TraceOptions { total_mass: Some(20.0), ..TraceOptions::new(geometry.identify.clone()) };
    let hold_out = Some(HoldOut { share: 0.3, seed: 1 });
    let options = CalibrateOptions { trace: Some(trace), hold_out, ..geometry };
    let result = calibrate(&chain, &rods, rows(&chain, Some(&effects), 1), None, &options).unwrap();
    let masses = result.report.masses.clone().expect("masses are found");
    assert!(masses.total_given && (masses.total_kg - 20.0).abs() < 1.0, "{masses:?}");
    assert!(text::report(&result).contains("the description has no masses"), "{}", text::report(&result));
    let (_, weighed) = drawn("universal_robots/ur5e.urdf");
    let refused = calibrate(&chain, &weighed, rows(&chain, None, 1), None, &options);
    assert!(matches!(refused, Err(CalibrateError::MassesKnown)), "{:?}", refused.err());
    // The file of effects has them, so that `fk --effects` loads the joints as the fit did.
    let fitted = result.effects(&rods).effects;
    let saved = SavedEffects::from_json("effects.json", &fitted.to_json(), &rods).unwrap();
    assert_eq!(saved.statics.masses, fitted.statics.masses);
    let written: Vec<f64> = saved.statics.masses.points.iter().map(|point| point.mass).collect();
    assert_eq!(written, masses.links.iter().map(|link| link.kg).collect::<Vec<_>>());
}
