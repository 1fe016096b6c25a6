//! Files of effects, written and read.

use denavit_identify::effects::carrier::Carrier;
use denavit_identify::effects::catalogue::Kind;
use denavit_identify::effects::driver::{Conditions, Driver, Statics};
use denavit_identify::effects::model::{Coupling, Effect, EffectModel, Term};
use denavit_identify::effects::saved::{SCHEMA, SavedEffects};
use denavit_measurements::{Column, Covariate, Covariates, MissingColumn};
use denavit_model::examples;

fn recorded() -> Covariates {
    vec![Covariate { name: "time".into(), values: vec![5.0] }].into()
}

fn time(name: &str) -> Result<Column, MissingColumn> {
    recorded().column("one row", 1, name)
}

fn model() -> EffectModel {
    let statics = Statics::of_chain(&examples::planar_arm());
    let term = |kind, carrier, driver| Term { kind, carrier, driver, coupling: Coupling::Each };
    let effects = vec![
        Effect {
            term: term(Kind::TransmissionError, Carrier::Joint(1), Driver::Harmonic { joint: 1, order: 2.5 }),
            coefficients: vec![1e-3, -2e-3],
        },
        Effect {
            term: term(Kind::Drift, Carrier::Base, Driver::Steps { covariate: time("time").unwrap(), at: vec![3.0] }),
            coefficients: vec![0.0, 0.0, 1e-3, 0.0, 2e-3, 0.0],
        },
    ];
    EffectModel::new(statics, effects)
}

#[test]
fn what_is_saved_moves_the_arm_alike() {
    let model = model();
    let again = SavedEffects::from_json("effects.json", &model.to_json(), &model.statics).unwrap();
    assert_eq!(again.needed(), ["time"]);
    let none = |name: &str| Covariates::none().column("one row", 1, name);
    assert_eq!(again.clone().bound(&none).unwrap_err().column(), "time");
    let again = again.bound(&time).unwrap();
    assert_eq!(again, model.clone().into());
    let recorded = recorded();
    let conditions = Conditions { reading: &[0.3, 0.8], recorded: recorded.row(0), tip: 0 };
    let chain = &model.statics.chain;
    assert_eq!(again.fk(chain, &conditions), model.fk(chain, &conditions));
    assert!((model.fk(chain, &conditions).translation.vector - chain.fk(&[0.3, 0.8]).translation.vector).norm() > 1e-4);
}

#[test]
fn what_does_not_fit_is_refused_with_its_place() {
    let model = model();
    let refused = |text: &str| SavedEffects::from_json("e.json", text, &model.statics).unwrap_err().to_string();
    let text = model.to_json();
    assert!(refused("{}").starts_with("e.json: not a file of effects (missing field `schema`"));
    assert!(refused(&text.replace(SCHEMA, "denavit.effects/9")).contains("schema is \"denavit.effects/9\""));
    let other = text.replacen(&model.statics.chain.joints()[0].name, "elsewhere", 1);
    assert!(refused(&other).starts_with("e.json: the effects are for joints elsewhere"), "{}", refused(&other));
    let short = text.replacen("0.001,", "", 1);
    assert_eq!(refused(&short), "e.json: effect 1 (transmission_error): 1 coefficients are given; give 2");
    let (drawn, effects) = text.split_once("\"effects\": [").unwrap();
    let beyond = format!("{drawn}\"effects\": [{}", effects.replace("\"joint\": 1", "\"joint\": 7"));
    assert_eq!(refused(&beyond), "e.json: effect 1 (transmission_error): it names joint 7; joints are 0 to 1");
    let bare = refused(&text.replacen("\"points\": [", "\"points\": [[0, 0, 0],", 1));
    assert!(bare.starts_with("e.json: drawn: 4 points instead of 3"), "{bare}");
}
