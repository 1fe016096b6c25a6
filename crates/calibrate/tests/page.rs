//! The page of a calibration: one file, every plot in it.

#![allow(clippy::unwrap_used)] // Tests: a panic is a failure.

use crate::curves::giving;
use denavit_calibrate::IdentifyOptions;
use denavit_calibrate::calibration::{CalibrateOptions, HoldOut, calibrate};
use denavit_calibrate::report::html::page;
use denavit_identify::effects::carrier::Carrier;
use denavit_identify::effects::catalogue::Kind;
use denavit_identify::effects::driver::{Driver, Statics};
use denavit_identify::effects::model::{Coupling, Effect, EffectModel, Term};
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::{SimulationOptions, simulate};
use denavit_measurements::kinds::ObservationKind;
use denavit_model::examples::puma_like;
use denavit_trace::infer::CurveOptions;
use denavit_trace::infer::named::Alternative;
use denavit_trace::{PartialResidual, Structure, TraceOptions};

#[test]
fn holds_every_plot_and_no_link() {
    let chain = puma_like();
    for (kind, plots) in [(ObservationKind::Position, 11), (ObservationKind::Distance, 9)] {
        let run = simulate(&chain, &SimulationOptions { kind, rows: 80, ..Default::default() }, &NoEffects);
        let options = CalibrateOptions::geometry(&chain);
        let result = calibrate(&chain, &Statics::of_chain(&chain), run.data, None, &options).unwrap();
        let text = page(&result).unwrap();
        assert_eq!(text.matches("<svg").count(), plots);
        assert!(!text.contains("href=") && !text.contains("src="));
        assert!(text.contains("Calibration of puma_like"));
        if let Ok(folder) = std::env::var("DENAVIT_SHOW") {
            std::fs::write(format!("{folder}/page_{plots}.html"), text).unwrap();
        }
    }
}

#[test]
fn shows_an_effect_beside_what_drives_it_and_all_that_was_tried() {
    let chain = puma_like();
    let statics = Statics::of_chain(&chain);
    let wave = Term {
        kind: Kind::TransmissionError,
        carrier: Carrier::Joint(2),
        driver: Driver::Harmonic { joint: 2, order: 2.0 },
        coupling: Coupling::Each,
    };
    let hidden = EffectModel::new(statics.clone(), vec![Effect { term: wave, coefficients: vec![4e-4, 3e-4] }]);
    let kind = ObservationKind::Position;
    let run = simulate(&chain, &SimulationOptions { kind, rows: 120, ..Default::default() }, &hidden);
    let identify = IdentifyOptions::axes(&chain);
    let trace = Some(TraceOptions::new(identify.clone()));
    let hold_out = Some(HoldOut { share: 0.25, seed: 1 });
    let options = CalibrateOptions { identify, hold_out, trace, ..CalibrateOptions::geometry(&chain) };
    let mut result = calibrate(&chain, &statics, run.data, None, &options).unwrap();
    let found = &result.trace.as_ref().unwrap().findings;
    assert_eq!(found.len(), 1, "{found:?}");
    // The wave is in what all else leaves, and no longer in what is left.
    let points = &found[0].partial_residuals.points;
    let square = |value: fn(&PartialResidual) -> f64| points.iter().map(|point| value(point).powi(2)).sum::<f64>();
    assert!(
        points.len() > 40 && found[0].partial_residuals.abscissa == "joint_3, rad",
        "{:?}",
        found[0].partial_residuals.abscissa
    );
    assert!(square(|point| point.after) < 0.2 * square(|point| point.partial));
    assert!(square(|point| point.partial - point.model) < 0.2 * square(|point| point.model));
    let text = page(&result).unwrap();
    assert_eq!(text.matches("<svg").count(), 13);
    // One result, many views: the parameters are those of the stage with the effect, as on the terminal.
    let last = denavit_calibrate::report::text::parameters(&result.trace.as_ref().unwrap().fit);
    let geometric = denavit_calibrate::report::text::parameters(&result.identification.geometric);
    assert!(last != geometric && text.contains(&last), "{last}");
    assert!(text.contains("transmission_error at joint_3") && text.contains("All candidates"));
    assert!(text.contains("<td>helical_pitch</td>"));
    assert!(text.contains("<h3>transmission_error at joint_3</h3>") && text.contains("half-sample refits"), "{text}");
    assert!(!text.contains("class=\"open\"") && !text.contains("Unexplained structure"));
    if let Ok(folder) = std::env::var("DENAVIT_SHOW") {
        std::fs::write(format!("{folder}/page_effect.html"), text).unwrap();
    }

    // The same finding, less sure, does not look like a named one.
    let trace = result.trace.as_mut().unwrap();
    trace.findings[0].named = false;
    trace.findings[0].rivals = vec![Alternative { kind: Kind::JointScale, place: "joint_3".into(), probability: 0.25 }];
    trace.unexplained.structured = true;
    trace.unexplained.places = vec![Structure { joint: Some("joint_2".into()), covariate: None, share: 0.4 }];
    let text = page(&result).unwrap();
    assert!(text.contains("<h3 class=\"open\">one of: transmission_error at joint_3 ("), "{text}");
    assert!(text.contains("joint_scale at joint_3 (25 %)"));
    assert!(
        text.contains("included in the model, cause uncertain: selected")
            && text.contains("there is more unexplained structure")
    );
    assert!(text.contains("Unexplained structure") && text.contains("The residuals follow joint_2 40 %"));

    // An alternative that is likelier than what the model has stands first, and its advice is given.
    let trace = result.trace.as_mut().unwrap();
    trace.findings[0].probability = 0.1;
    trace.findings[0].rivals[0].probability = 0.83;
    let report = denavit_calibrate::report::findings::findings(trace);
    assert!(report.contains("one of: joint_scale at joint_3 (83 %), transmission_error at joint_3 (10 %)"), "{report}");
    assert!(report.contains("included in the model as transmission_error at joint_3, cause uncertain"), "{report}");
    assert!(report.contains("check encoder and gear ratio") && !report.contains("errs periodically"), "{report}");
}

#[test]
fn curves_and_what_gives_under_gravity_are_drawn() {
    let (_, statics) = crate::prior_effects::study::study_coverage::ur5e();
    let chain = &statics.chain;
    let wave = |joint: usize, order: f64| Effect {
        term: Term {
            kind: Kind::TransmissionError,
            carrier: Carrier::Joint(joint),
            driver: Driver::Harmonic { joint, order },
            coupling: Coupling::Each,
        },
        coefficients: vec![3e-4, -2e-4],
    };
    let mut effects = vec![wave(1, 3.3), wave(2, 4.7)];
    effects.extend(giving(1.5e-5));
    let hidden = EffectModel::new(statics.clone(), effects);
    let run = simulate(chain, &SimulationOptions { rows: 400, ..Default::default() }, &hidden);
    let options = CalibrateOptions { curves: Some(CurveOptions::default()), ..CalibrateOptions::geometry(chain) };
    let result = calibrate(chain, &statics, run.data, None, &options).unwrap();
    let (curves, fields) = (result.report.curves.len(), result.report.fields.len());
    assert!(curves >= 2 && fields >= 1, "{curves} {fields}");
    let text = page(&result).unwrap();
    assert_eq!(text.matches("error curve and its 95 % band").count(), curves);
    assert_eq!(text.matches("deflection under gravity in the fitted rows").count(), fields);
    if let Ok(folder) = std::env::var("DENAVIT_SHOW") {
        std::fs::write(format!("{folder}/page_curves.html"), text).unwrap();
    }
}
