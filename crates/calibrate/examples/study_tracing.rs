//! Tests the tracer on a folder of blind cases made by `tests/oracle/calibration/suite.py`:
//! `cargo run --release -p denavit-calibrate --example study_tracing -- FOLDER [PART OF A NAME]`.
//!
//! Prints the true and the found effects of each case that is not right. At the end: the table of `docs/effects.md`.
#![allow(clippy::unwrap_used, clippy::print_stdout)] // A study prints, and stops at the first error.
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "places in sorted lists")]
#![allow(clippy::too_many_lines, reason = "a study runs from top to bottom")]

use denavit_calibrate::IdentifyOptions;
use denavit_identify::effects::catalogue::Kind;
use denavit_identify::effects::survey::{with_run_order, with_run_order_after};
use denavit_identify::effects::{Driver, Statics};
use denavit_identify::identify;
use denavit_identify::parameters::Effects;
use denavit_identify::residual::ResidualModel;
use denavit_measurements::{Measurements, Units, read};
use denavit_model::{Chain, tree::Reading};
use denavit_trace::{Finding, TraceOptions, trace};
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

/// Orders this close count as equal: a period over the joint's range is about one order.
const SAME_ORDER: f64 = 0.6;

fn load(path: &Path, chain: &Chain) -> Measurements {
    let file = std::fs::File::open(path).unwrap();
    read(&path.to_string_lossy(), file, chain, Units::default()).unwrap_or_else(|error| panic!("{error}")).data
}

fn rms<E: Effects>(
    data: &Measurements,
    layout: &denavit_identify::parameters::Layout,
    arm: &denavit_calibrate::Arm,
    effects: &E,
) -> f64 {
    let squares = ResidualModel { data, layout, effects }.squares(arm);
    (squares.iter().map(|s| s[0]).sum::<f64>() / squares.len() as f64).sqrt() * 1e3
}

#[derive(Default)]
struct Tally {
    cases: usize,
    right: usize,
    among_rivals: usize,
    false_claims: usize,
    /// Those of them that are named, not kept as a correction.
    falsely_named: usize,
    ratios: Vec<f64>,
    errors: [f64; 4],
}

impl Tally {
    fn line(&self, name: &str) -> String {
        let mut r = self.ratios.clone();
        r.sort_by(f64::total_cmp);
        let n = self.cases.max(1) as f64;
        let q = |p: f64| r.get(((r.len().max(1) - 1) as f64 * p) as usize).copied().unwrap_or(f64::NAN);
        format!(
            "{name:<34} {:>4} right {:>4} + rivals {:>3} = {:>5.1} %, false {:>3}, of them named {:>2}, test/attainable median {:.3} 95 % {:.3}; mm {:.4} {:.4} {:.4} {:.4}",
            self.cases,
            self.right,
            self.among_rivals,
            100.0 * (self.right + self.among_rivals) as f64 / n,
            self.false_claims,
            self.falsely_named,
            q(0.5),
            q(0.95),
            self.errors[0] / n,
            self.errors[1] / n,
            self.errors[2] / n,
            self.errors[3] / n
        )
    }
}

fn main() {
    let root = std::env::args().nth(1).unwrap();
    let only = std::env::args().nth(2);
    let mut cases: Vec<_> = std::fs::read_dir(&root)
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.join("truth.json").exists())
        .collect();
    cases.sort();
    let mut tallies: BTreeMap<String, Tally> = BTreeMap::new();
    for case in cases {
        let name = case.file_name().unwrap().to_string_lossy().to_string();
        if only.as_ref().is_some_and(|o| !name.contains(o.as_str())) {
            continue;
        }
        let truth: serde_json::Value =
            serde_json::from_str(&std::fs::read_to_string(case.join("truth.json")).unwrap()).unwrap();
        let robot =
            denavit_model::urdf::read("nominal.urdf", &std::fs::read_to_string(case.join("nominal.urdf")).unwrap())
                .unwrap();
        let chain = robot.chain(None, None, Reading::Intended).unwrap().value;
        let statics = Statics::of(&robot, &chain);
        let train = with_run_order(load(&case.join("train.csv"), &chain));
        let rows = train.len();
        let test = with_run_order_after(load(&case.join("test.csv"), &chain), &train);
        let mut options = TraceOptions::new(IdentifyOptions::axes(&chain));
        if let Some(ratio) = truth["gear_ratio"].as_f64() {
            options.gear_ratios = vec![Some(ratio); chain.joints().len()];
        }
        let started = Instant::now();
        let identification = identify(&chain, &train, &options.identify);
        let geometric = &identification.geometric;
        let fitted = started.elapsed().as_secs_f64();
        let result = trace(&statics, &train, geometric, &options);
        let took = started.elapsed().as_secs_f64();
        let nominal =
            rms(&test, &identification.nominal.layout, &identification.nominal.arm, &identification.nominal.effects);
        let before = rms(&test, &geometric.layout, &geometric.arm, &geometric.effects);
        let after = rms(&test, &result.fit.layout, &result.fit.arm, &result.fit.effects);
        let dimension = train.scene.channels[0].height as f64;
        let floor = truth["noise_m"].as_f64().unwrap() * 1e3 * dimension.sqrt();
        let used: f64 = result.fit.parameters_used[0];
        let attainable = floor * (1.0 + used / result.fit.values[0]).sqrt();
        let claims: Vec<(String, String)> =
            result.findings.iter().map(|f| (f.term.kind.name().to_string(), f.place.clone())).collect();
        let text = |v: &serde_json::Value| v.as_str().unwrap().to_string();
        let effects = truth["effects"].as_array().unwrap();
        let truths: Vec<(String, Vec<String>)> = effects
            .iter()
            .map(|e| {
                (
                    text(&e["kind"]),
                    e["places"].as_array().unwrap().iter().map(|p| text(p).replace("all", "all joints")).collect(),
                )
            })
            .collect();
        let strength = truth["strength"].as_f64().unwrap();
        let mut good = true;
        let mut note = |key: String, right: bool, rival: bool, [wrong, falsely_named]: [usize; 2]| {
            let t = tallies.entry(key).or_default();
            t.cases += 1;
            t.right += usize::from(right);
            t.among_rivals += usize::from(!right && rival);
            t.false_claims += wrong;
            t.falsely_named += falsely_named;
            t.ratios.push(after / attainable);
            for (sum, value) in t.errors.iter_mut().zip([nominal, before, after, attainable]) {
                *sum += value;
            }
        };
        let matches = |kind: &str, place: &str| truths.iter().any(|(k, p)| k == kind && p[0] == place);
        // A harmonic of the background is present, but not among the effects to find.
        let of_ground = |finding: &Finding| {
            let Driver::Harmonic { order, .. } = finding.term.driver else { return false };
            let here = |wave: &serde_json::Value| {
                wave["place"] == finding.place.as_str() && (wave["order"].as_f64().unwrap() - order).abs() < SAME_ORDER
            };
            finding.term.kind == Kind::TransmissionError
                && truth["ground"].as_array().is_some_and(|waves| waves.iter().any(here))
        };
        let false_one = |f: &&Finding| {
            !matches(f.term.kind.name(), &f.place)
                && !f.rivals.iter().any(|r| matches(r.kind.name(), &r.place))
                && !of_ground(f)
        };
        let wrong = result.findings.iter().filter(false_one).count();
        let falsely_named = result.findings.iter().filter(false_one).filter(|f| f.named).count();
        let counts = [wrong, falsely_named];
        if truths.is_empty() {
            note("null".into(), claims.is_empty(), false, counts);
            good = claims.is_empty();
        } else if truths[0].0 == "alien" {
            let places = &truths[0].1;
            let outside = claims.iter().filter(|(_, p)| !places.contains(p)).count();
            let elsewhere = |f: &&Finding| f.named && !places.contains(&f.place);
            let named_outside = result.findings.iter().filter(elsewhere).count();
            let first = result.unexplained.places.first().and_then(|p| p.joint.clone().or(p.covariate.clone()));
            let named = first.is_some_and(|f| places.contains(&f))
                || claims.iter().any(|(k, p)| k == "drift" && places.contains(p));
            let what = text(&effects[0]["shape"]["what"]);
            note(format!("alien {what}"), named && outside == 0, false, [outside, named_outside]);
            good = named && outside == 0;
        } else {
            for (kind, places) in &truths {
                let right = claims.iter().any(|(k, p)| k == kind && *p == places[0]);
                let rival = result
                    .findings
                    .iter()
                    .any(|f| f.rivals.iter().any(|r| r.kind.name() == kind && r.place == places[0]));
                good &= right || rival;
                let key =
                    if truths.len() == 1 { format!("{kind} {strength}") } else { format!("{} at once", truths.len()) };
                note(key.clone(), right, rival, counts);
                if truths.len() == 1 {
                    note(format!("~all of strength {strength}"), right, rival, counts);
                }
            }
        }
        good &= wrong == 0 && (after / attainable < 1.1 || truths.iter().any(|(kind, _)| kind == "alien"));
        println!(
            "{} {name}: {} {} {}x{} {rows} rows, fit {fitted:.2} s, all {took:.2} s",
            if good { "ok " } else { "BAD" },
            truth["arm"],
            truth["measure"],
            truth["targets"],
            strength
        );
        if good {
            continue;
        }
        for effect in effects {
            println!(
                "   truth {} {} {} size {}",
                effect["kind"], effect["places"], effect["shape"], effect["visible_rms_in_noise"]
            );
        }
        for f in &result.findings {
            let rivals: Vec<String> = f.rivals.iter().map(|r| format!("{}({})", r.kind.name(), r.place)).collect();
            println!(
                "   {} {}({}) {:?} {:?} dBIC {:.1} p {:.1e} rivals {:?}",
                if f.named { "named" } else { "kept" },
                f.term.kind.name(),
                f.place,
                f.term.carrier,
                f.term.driver,
                f.delta_bic,
                f.p_value,
                rivals
            );
        }
        println!(
            "   test rms geometry {before:.4} -> {after:.4} mm (attainable {attainable:.4}); noise {:.4} mm; left p {:.1e} {:?}; rejected {}",
            result.fit.noise.first() * 1e3,
            result.unexplained.p_value,
            result
                .unexplained
                .places
                .iter()
                .map(|p| (p.joint.clone().or(p.covariate.clone()).unwrap(), (p.share * 100.0).round()))
                .collect::<Vec<_>>(),
            result.fit.weights.iter().filter(|w| **w == 0.0).count(),
        );
    }
    for (name, tally) in &tallies {
        println!("{}", tally.line(name));
    }
}
