//! Whether twenty poses chosen to distinguish causes find the right cause more often than twenty D-optimal or random ones:
//! `cargo run --release -p denavit-calibrate --example study_tell_apart -- [CASES] [ROBOT.urdf ...]`, then
//! `... -- real ROBOT.urdf DATA.csv [DRAWS]` with `TIP` and `UNITS` in the environment.
//!
//! Simulated: a robot with errors of the size of its tolerances and one effect, measured at a poor set of postures (every joint in a third
//! of its range, or in all of it with a weak effect) so that the cause is not named; then poses from the whole range are added. Real: a
//! hundred rows drawn at random; the others are candidates and test rows. `time`: time of the report's paragraph compared with that of the
//! calibration.
#![allow(clippy::unwrap_used, clippy::print_stdout)] // A study prints, and stops at the first error.

mod real;

use self::real::Real;
use denavit_calibrate::Measurements;
use denavit_calibrate::apply::plan::tell_apart::TellApart;
use denavit_calibrate::apply::plan::{PlanOptions, plan};
use denavit_calibrate::calibration::{CalibrateOptions, Calibration, calibrate};
use denavit_identify::effects::driver::Statics;
use denavit_identify::effects::survey::with_run_order;
use denavit_identify::simulate::effect_specification::specified_effects;
use denavit_identify::simulate::{Simulation, SimulationOptions, readings, simulate, simulate_arm};
use denavit_measurements::kinds::ObservationKind;
use denavit_model::Chain;
use denavit_trace::TraceOptions;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::time::Instant;

/// Why a run has more than one possible cause.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct World {
    /// Its name.
    pub name: &'static str,
    /// Fraction of each joint's range that the postures cover.
    pub share: f64,
    /// Smallest and largest displacement of the measured values by the effect over the whole range, mm.
    pub strength: (f64, f64),
}

/// Postures in a part of the range; and an effect that is weak relative to a noise of 0.05 mm.
pub const WORLDS: [World; 2] = [
    World { name: "narrow postures", share: 0.35, strength: (0.06, 0.16) },
    World { name: "weak effects", share: 1.0, strength: (0.015, 0.05) },
];

/// Rows of the run, poses added.
const ROWS: usize = 60;
const ADDED: usize = 20;
/// Test rows.
const JUDGES: usize = 300;

/// Kinds of effects that poses can distinguish, each at a random joint.
const KINDS: [&str; 5] = ["joint_compliance", "transmission_error", "backlash", "joint_scale", "axis_wobble"];

/// Result with one set of poses.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Ended {
    /// Whether the right cause is named.
    pub right: bool,
    /// Whether another cause is named.
    pub wrong: bool,
    /// Error on the test rows, m.
    pub error: f64,
    /// Log odds of the right cause against all sets without it.
    pub log_odds: f64,
}

/// A case with more than one possible cause, and the results of three ways to add poses.
#[derive(Debug, Clone)]
pub struct Case {
    /// The effect.
    pub specification: String,
    /// With the poor set alone.
    pub before: Ended,
    /// The poses chosen.
    pub planned: TellApart,
    /// With poses chosen to distinguish causes, D-optimal, random.
    pub after: [Ended; 3],
    /// Expected log odds of the right cause against its closest rival, if it is in the list.
    pub expected: Option<f64>,
}

fn options(chain: &Chain) -> CalibrateOptions {
    let options = CalibrateOptions::geometry(chain);
    CalibrateOptions { trace: Some(TraceOptions::new(options.identify.clone())), ..options }
}

fn ended(found: &Calibration, kind: &str, place: &str, judges: &Measurements) -> Ended {
    let is = |effect: &denavit_calibrate::calibration::contract::EffectEntry| {
        effect.kind == kind && effect.joint.as_deref().or(effect.place.as_deref()) == Some(place)
    };
    let named = &found.report.effects;
    let findings = found.trace.iter().flat_map(|trace| &trace.findings);
    let own = findings.clone().find(|finding| finding.term.kind.name() == kind && finding.place == place);
    let rival =
        findings.flat_map(|finding| &finding.rivals).find(|rival| rival.kind.name() == kind && rival.place == place);
    let log_odds = match (own, rival) {
        (Some(own), _) => (1.0 - own.p_value).max(1e-300).ln() - own.p_value.max(1e-300).ln(),
        (None, Some(rival)) => (rival.probability / (1.0 - rival.probability)).ln(),
        (None, None) => f64::NAN,
    };
    let later = found.predict(judges.clone()).unwrap();
    Ended {
        right: named.iter().any(is),
        wrong: named.iter().any(|effect| !is(effect)),
        error: later.errors.of("position").unwrap().rms,
        log_odds,
    }
}

/// One case; `None` if the effect cannot be simulated, or if there is only one possible cause.
pub fn case(chain: &Chain, statics: &Statics, world: World, seed: u64) -> Option<Case> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let kind = KINDS[usize::try_from(seed).unwrap() % KINDS.len()];
    let joint = random.random_range(0..chain.joints().len());
    let place = chain.joints()[joint].name.clone();
    let (least, most) = world.strength;
    let strength = least + (most - least) * random.random::<f64>();
    let specification = format!("{kind}@{place}={strength:.3}mm");
    let poor: Vec<(f64, f64)> = chain
        .coordinates()
        .iter()
        .map(|coordinate| {
            let (low, high) = coordinate.range();
            let width = world.share * (high - low);
            let from = low + (high - low - width) * random.random::<f64>();
            (from, width)
        })
        .collect();
    let posture =
        |random: &mut ChaCha8Rng| poor.iter().map(|(from, width)| from + width * random.random::<f64>()).collect();
    let poses: Vec<Vec<f64>> = (0..ROWS).map(|_| posture(&mut random)).collect();
    let simulated = SimulationOptions {
        kind: ObservationKind::Position,
        rows: ROWS,
        seed,
        readings: Some(poses),
        ..Default::default()
    };
    let bare = simulate(chain, &simulated, &denavit_identify::parameters::NoEffects);
    let judges = readings(chain, JUDGES, seed ^ 0xbeef);
    // The strength is that over the whole range.
    let wide = SimulationOptions { readings: Some(judges.clone()), rows: JUDGES, ..simulated.clone() };
    let wide = Simulation {
        data: simulate_arm(&bare.arm, &wide, &denavit_identify::parameters::NoEffects).data,
        ..bare.clone()
    };
    let effects = specified_effects(&[specification.parse().unwrap()], statics, &wide, seed).ok()?;
    let run = simulate(chain, &simulated, &effects);
    let measured = |poses: Vec<Vec<f64>>, seed: u64| {
        let before = Some(with_run_order(run.data.clone()));
        let rows = poses.len();
        let more = SimulationOptions { readings: Some(poses), rows, before, seed, ..simulated.clone() };
        simulate_arm(&run.arm, &more, &effects).data
    };
    let judges = measured(judges, seed + 1);
    let asked = options(chain);
    let found = calibrate(chain, statics, run.data.clone(), None, &asked).ok()?;
    let before = ended(&found, kind, &place, &judges);
    if before.right || found.trace.as_ref().is_none_or(|trace| trace.open.is_none()) {
        return None;
    }
    let plan_options = PlanOptions::new(chain, ADDED, ObservationKind::Position);
    let planned = found.tell_apart(statics, &plan_options).unwrap();
    let is_right = |possible: &denavit_calibrate::apply::plan::tell_apart::Possible| {
        possible.causes.iter().any(|cause| cause.kind.name() == kind && cause.place == place)
    };
    let expected = planned
        .prospect
        .pairs
        .iter()
        .filter_map(|pair| {
            let [a, b] = pair.of.map(|index| is_right(&planned.prospect.possible[index]));
            match (a, b) {
                (true, false) => Some(pair.expected_if_first),
                (false, true) => Some(-pair.expected_if_second),
                _ => None,
            }
        })
        .min_by(f64::total_cmp);
    let optimal = plan(chain, &plan_options).unwrap().poses;
    let by_chance = readings(chain, ADDED, seed ^ 0xcafe);
    let after = [planned.poses.clone(), optimal, by_chance].map(|poses| {
        let joined = Measurements::joined(vec![run.data.clone(), measured(poses, seed + 2)]).unwrap();
        let found = calibrate(chain, statics, joined, None, &asked).unwrap();
        ended(&found, kind, &place, &judges)
    });
    Some(Case { specification, before, planned, after, expected })
}

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.retain(|number| number.is_finite());
    numbers.sort_by(f64::total_cmp);
    if numbers.is_empty() { f64::NAN } else { numbers[numbers.len() / 2] }
}

fn simulated(world: World, robots: &[String], wanted: usize) {
    println!("{}", world.name);
    let names = ["before", "chosen", "D-optimal", "at random"];
    let mut all: Vec<Case> = Vec::new();
    for path in robots {
        let robot = Real::robot(path);
        let (mut cases, mut tried) = (Vec::new(), 0u64);
        while cases.len() < wanted && tried < 12 * wanted as u64 {
            tried += 1;
            if let Some(case) = case(&robot.chain, &robot.statics, world, 1000 + tried) {
                println!(
                    "{path} {} {}: before {:+.1}, expected {:+.1}, then {}",
                    1000 + tried,
                    case.specification,
                    case.before.log_odds,
                    case.expected.unwrap_or(f64::NAN),
                    case.after
                        .map(|e| format!(
                            "{}{} {:+.1} {:.4} mm",
                            if e.right { "right" } else { "-" },
                            if e.wrong { " wrong" } else { "" },
                            e.log_odds,
                            e.error * 1e3
                        ))
                        .join(" | ")
                );
                cases.push(case);
            }
        }
        println!("{path}: {} of {tried} drawn cases have more than one possible cause", cases.len());
        table(&names, &cases);
        all.extend(cases);
    }
    println!("all robots");
    table(&names, &all);
}

fn table(names: &[&str; 4], cases: &[Case]) {
    println!(
        "| poses | right cause named | a wrong one named | median error, mm | root mean square, mm | expected uncertainty, mm |"
    );
    println!("|---|---|---|---|---|---|");
    for (index, name) in names.iter().enumerate() {
        let of = |case: &Case| if index == 0 { case.before } else { case.after[index - 1] };
        let right = cases.iter().filter(|case| of(case).right).count();
        let wrong = cases.iter().filter(|case| of(case).wrong).count();
        let errors: Vec<f64> = cases.iter().map(|case| of(case).error * 1e3).collect();
        let rms = (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
        let unsure = match index {
            0 => format!("{:.3}", median(cases.iter().map(|case| case.planned.prospect.unsure.now * 1e3).collect())),
            1 => {
                format!("{:.3}", median(cases.iter().map(|case| case.planned.prospect.unsure.expected * 1e3).collect()))
            }
            _ => String::new(),
        };
        println!("| {name} | {right} of {} | {wrong} | {:.4} | {rms:.4} | {unsure} |", cases.len(), median(errors));
    }
    let with: Vec<&Case> = cases.iter().filter(|case| case.expected.is_some()).collect();
    let expected = median(with.iter().filter_map(|case| case.expected).collect());
    let achieved = median(with.iter().map(|case| case.after[0].log_odds).collect());
    println!(
        "log odds of the right cause, median of {} cases that list it: expected {expected:.1}, achieved {achieved:.1}",
        with.len()
    );
}

/// A hundred random rows, then forty of the others added.
fn real_rows(path: &str, file: &str, draws: u64) {
    let robot = Real::robot(path);
    let (chain, statics) = (&robot.chain, &robot.statics);
    let data = robot.rows(file);
    let asked = options(chain);
    for seed in 0..draws {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut order: Vec<(f64, usize)> = (0..data.len()).map(|row| (random.random::<f64>(), row)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let order: Vec<usize> = order.into_iter().map(|(_, row)| row).collect();
        let (first, rest) = order.split_at(100);
        let (offered, judges) = rest.split_at(rest.len().min(1200) / 2);
        let judges = &judges[..judges.len().min(600)];
        let rows = |chosen: &[usize]| {
            let mut rows: Vec<usize> = first.iter().chain(chosen).copied().collect();
            rows.sort_unstable();
            data.subset(&rows)
        };
        let mut judged = judges.to_vec();
        judged.sort_unstable();
        let judges = data.subset(&judged);
        let found = calibrate(chain, statics, rows(&[]), None, &asked).unwrap();
        let candidates = offered.iter().map(|&row| data.reading(row).to_vec()).collect();
        let wanted =
            PlanOptions { candidates: Some(candidates), ..PlanOptions::new(chain, 40, ObservationKind::Position) };
        let planned = found.tell_apart(statics, &wanted).unwrap();
        let chosen: Vec<usize> = planned.candidates.iter().map(|&index| offered[index]).collect();
        let optimal = plan(chain, &wanted).unwrap().poses;
        let optimal: Vec<usize> = optimal
            .iter()
            .map(|pose| *offered.iter().find(|row| data.reading(**row) == pose.as_slice()).unwrap())
            .collect();
        let result = |found: &Calibration| {
            let later = found.predict(judges.clone()).unwrap();
            let name = |effect: &denavit_calibrate::calibration::contract::EffectEntry| {
                format!("{} at {}", effect.kind, effect.joint.clone().or(effect.place.clone()).unwrap_or_default())
            };
            let named: Vec<String> = found.report.effects.iter().map(name).collect();
            let open: Vec<String> = found.report.one_of.iter().map(name).collect();
            format!(
                "{:.4} mm, named {named:?}, one of several {open:?}",
                later.errors.of("position").unwrap().rms * 1e3
            )
        };
        println!("draw {seed}: 100 rows {}", result(&found));
        println!(
            "  uncertainty {:.3} -> {:.3} mm, {} of {} poses to distinguish causes",
            planned.prospect.unsure.now * 1e3,
            planned.prospect.unsure.expected * 1e3,
            planned.prospect.for_separation,
            planned.poses.len()
        );
        for (name, chosen) in [("chosen", chosen), ("D-optimal", optimal), ("at random", offered[..40].to_vec())] {
            println!("  {name}: {}", result(&calibrate(chain, statics, rows(&chosen), None, &asked).unwrap()));
        }
    }
}

/// Prints the time of the report's paragraph, and that of a traced calibration of 400 positions.
fn time() {
    let robot = Real::robot(concat!(env!("CARGO_MANIFEST_DIR"), "/../../robots/universal_robots/ur5e.urdf"));
    let (chain, statics) = (&robot.chain, &robot.statics);
    for seed in 0..6 {
        let simulated = SimulationOptions { rows: 400, seed, ..Default::default() };
        let bare = simulate(chain, &simulated, &denavit_identify::parameters::NoEffects);
        let effect = "joint_compliance@elbow_joint=0.014mm".parse().unwrap();
        let effects = specified_effects(&[effect], statics, &bare, seed).unwrap();
        let data = simulate(chain, &simulated, &effects).data;
        let begun = Instant::now();
        let found = calibrate(chain, statics, data, None, &options(chain)).unwrap();
        let whole = begun.elapsed().as_secs_f64();
        let begun = Instant::now();
        let few = PlanOptions { spread: 60, ..PlanOptions::new(chain, ADDED, ObservationKind::Position) };
        let planned = found.tell_apart(statics, &few).unwrap();
        let own = begun.elapsed().as_secs_f64();
        let possible = planned.prospect.possible.len();
        let written = found.report.prospect.is_some();
        println!(
            "{possible} possible: {own:.3} s; calibration {whole:.3} s, its report {} the paragraph",
            if written { "has" } else { "lacks" }
        );
    }
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    if words.first().is_some_and(|word| word == "time") {
        return time();
    }
    if words.first().is_some_and(|word| word == "real") {
        return real_rows(&words[1], &words[2], words.get(3).map_or(3, |word| word.parse().unwrap()));
    }
    let cases = words.first().map_or(30, |word| word.parse().unwrap());
    let robots: Vec<String> = if words.len() > 1 {
        words[1..].to_vec()
    } else {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../robots");
        ["universal_robots/ur5e", "ufactory/xarm7", "adept/cobra600"]
            .map(|name| format!("{folder}/{name}.urdf"))
            .to_vec()
    };
    for world in WORLDS {
        simulated(world, &robots, cases);
    }
}
