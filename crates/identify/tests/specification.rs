//! Effects of simulated runs, as they are specified.

use denavit_identify::effects::candidates::candidates;
use denavit_identify::effects::catalogue::KINDS;
use denavit_identify::effects::driver::{BumpShape, Driver, Statics};
use denavit_identify::effects::survey::{Survey, with_run_order};
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::columns::columns;
use denavit_identify::simulate::effect_specification::{EffectSpecification, moves, specified_effects};
use denavit_identify::simulate::{Simulation, SimulationOptions, simulate};
use denavit_model::{Chain, examples};

fn run(chain: &Chain) -> Simulation {
    let names = ["time", "temperature", "velocity"].map(String::from);
    let covariates = columns(&names, chain, 60, 0, 3).unwrap();
    simulate(chain, &SimulationOptions { rows: 60, seed: 3, covariates, ..Default::default() }, &NoEffects)
}

#[test]
fn every_kind_moves_the_measured_values_by_the_specified_size() {
    for chain in examples::all() {
        let (statics, run) = (Statics::of_chain(&chain), run(&chain));
        let data = with_run_order(run.data.clone());
        let survey = Survey::of(&statics, &data, Vec::new());
        for entry in KINDS {
            let Some(first) = candidates(entry.kind, &survey).into_iter().next() else { continue };
            let place = first.term.carrier.place(&chain);
            let specification: EffectSpecification = format!("{}@{place}=0.3mm", entry.name).parse().unwrap();
            match specified_effects(std::slice::from_ref(&specification), &statics, &run, 7) {
                Ok(model) => {
                    let moved = moves(&run.arm, &statics, &model.effects[0], &data);
                    assert!((moved - 3e-4).abs() < 3e-6, "{} on {}: {moved}", entry.name, chain.name());
                    assert_eq!(model, specified_effects(&[specification], &statics, &run, 7).unwrap());
                }
                Err(error) => assert!(error.to_string().contains("moves no measured value"), "{error}"),
            }
        }
    }
}

#[test]
fn what_a_kind_leaves_open_can_be_set() {
    let chain = examples::puma_like();
    let (statics, run) = (Statics::of_chain(&chain), run(&chain));
    let of = |text: &str| specified_effects(&[text.parse().unwrap()], &statics, &run, 0).unwrap().effects.remove(0);
    let [first, second] = [0, 1].map(|joint: usize| chain.joints()[joint].name.clone());
    let effect = of(&format!("transmission_error@{first}:order=3=2e-4"));
    assert_eq!(effect.term.driver, Driver::Harmonic { joint: 0, order: 3.0 });
    let length = effect.coefficients.iter().map(|value| value * value).sum::<f64>().sqrt();
    assert!((length - 2e-4).abs() < 1e-15);
    let effect = of(&format!("joint_coupling@{first}:with={second}=-1e-3"));
    assert_eq!((effect.term.driver, effect.coefficients), (Driver::Reading(1), vec![-1e-3]));
    let effect = of("drift@target:step=100=0.1mm");
    assert_eq!(effect.term.driver, Driver::Steps { covariate: run.data.column("time").unwrap(), at: vec![100.0] });
    let effect = of(&format!("joint_compliance@{second}:knee=8=0.2mm"));
    assert_eq!(effect.term.driver, Driver::HardeningTorque { joint: 1, knee: 8.0 });
    assert!(effect.coefficients[0] == 0.0 && effect.coefficients[1] > 0.0);
    let effect = of(&format!("backlash@{second}:friction=4=1e-4"));
    let Driver::FrictionSide { side, friction } = effect.term.driver else { panic!("{effect:?}") };
    assert_eq!((side.joint, side.from_rows, friction), (1, true, 4.0));
    let refused = |text: &str| specified_effects(&[text.parse().unwrap()], &statics, &run, 0).unwrap_err().to_string();
    assert!(refused(&format!("backlash@{second}:friction=0=1e-4")).ends_with("friction must be above 0"));
    assert!(refused(&format!("backlash@{second}:knee=1=1e-4")).contains("accepts friction"));
    let effect = of(&format!("local_joint_error@{second}:at=0.4,width=0.1=1e-4"));
    assert_eq!(effect.term.driver, Driver::Bump { joint: 1, at: 0.4, width: 0.1, shape: BumpShape::Bell });
}
