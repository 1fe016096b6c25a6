//! Every pair of carrier and driver that the catalogue makes: how a row's residual follows the effect's coefficients, in closed
//! form against central differences of the real model.
//!
//! The terms are those of [`KINDS`] on runs that record everything, so that a new kind, carrier or driver is in the test as soon
//! as it is in the catalogue.

use denavit_calibrate::{Arm, Freedom, Measurements, Tolerances};
use denavit_identify::arm::Perturbation;
use denavit_identify::arm::Row;
use denavit_identify::effects::candidates::candidates;
use denavit_identify::effects::survey::{Survey, with_run_order};
use denavit_identify::effects::{EffectModel, KINDS, Kind, Statics, Term};
use denavit_identify::parameters::Effects as _;
use denavit_identify::parameters::Layout;
use denavit_identify::parameters::NoEffects;
use denavit_identify::residual::ResidualModel;
use denavit_identify::simulate::columns::columns;
use denavit_identify::simulate::{SimulationOptions, simulate};
use denavit_measurements::kinds::ObservationKind;
use denavit_model::Chain;
use denavit_model::nalgebra::Matrix;
use denavit_model::tree::Reading;
use std::collections::BTreeSet;
use std::path::Path;

/// Rows of a run, which the catalogue looks at.
const ROWS: usize = 60;
/// Of these, the rows that are differentiated: early and late, so that drivers of the run's order differ.
const LOOKED_AT: [usize; 4] = [3, 21, 38, 57];
/// How far a step of a coefficient moves the arm, its target or its instrument, m and rad. Relative to that a central difference
/// leaves out some 1e-10, and rounding of residuals of metres makes some 1e-10.
const MOVED: f64 = 2e-5;
/// Greatest difference, relative to the column's largest value.
const WITHIN: f64 = 1e-6;
/// A column whose values are all smaller than this, relative to how far the effect moves the arm, is held against this: what hardly
/// moves what is measured, such as a joint that turns the target about itself.
const HARDLY: f64 = 1e-3;

/// A coefficient with which an effect acts as it does to first order.
const SMALL: f64 = 1e-9;

/// What moves the arm by less per unit of its coefficient is rounding alone: gravity on an axis that it has no lever about.
const NOTHING: f64 = 1e-9;

/// What was compared.
#[derive(Default)]
struct Compared {
    /// Carrier and driver by their words.
    pairs: BTreeSet<String>,
    kinds: BTreeSet<&'static str>,
    terms: usize,
    coefficients: usize,
    moving: usize,
    worst: f64,
}

fn robot(path: &str) -> (Chain, Vec<Statics>) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../robots").join(path);
    let robot = denavit_model::urdf::read(path, &std::fs::read_to_string(file).unwrap()).unwrap();
    let chain = robot.chain(None, None, Reading::Intended).unwrap().value;
    let statics = vec![Statics::of(&robot, &chain), Statics::of_chain(&chain)];
    (chain, statics)
}

/// A run that records everything; sides of approach by a column, or else by the order of the rows alone.
fn run(chain: &Chain, kind: ObservationKind, sides: bool) -> (Arm, Measurements) {
    let mut names: Vec<String> = ["time", "temperature", "payload", "tilt_x", "velocity"].map(String::from).into();
    names.extend(sides.then(|| "approach".to_owned()));
    names.extend(chain.coordinates().iter().map(|coordinate| format!("{}.temperature", coordinate.name)));
    let covariates = columns(&names, chain, ROWS, 0, 3).unwrap();
    let options =
        SimulationOptions { kind, rows: ROWS, seed: 11, turn: 5e-3, shift: 5e-3, covariates, ..Default::default() };
    let made = simulate(chain, &options, &NoEffects);
    (made.arm, with_run_order(made.data))
}

/// The word before what belongs to it.
fn word(of: &dyn std::fmt::Debug) -> String {
    format!("{of:?}").chars().take_while(char::is_ascii_alphanumeric).collect()
}

/// Residuals of a row.
fn residual(model: &EffectModel, layout: &Layout, arm: &Arm, data: &Measurements, row: usize) -> Vec<f64> {
    let mut residual = vec![0.0; data.tallest_row()];
    let problem = ResidualModel { data, layout, effects: model };
    problem.row_into(arm, row, &mut problem.scratch(arm), &mut residual, None);
    residual
}

/// Largest change of the arm, its target or its instrument in the rows, m and rad.
fn size(model: &EffectModel, arm: &Arm, data: &Measurements) -> f64 {
    let of_row = |row: usize| {
        let mut out = Perturbation::none(arm.joints.len());
        model.perturb(Row::new(data, row), arm, &mut model.standing(arm), &mut out);
        let twists = out.twists.iter().map(Matrix::amax);
        let rest = [out.target.amax(), out.anchor.amax(), out.scale.abs(), out.reading.abs()];
        twists.chain(rest).fold(0.0, f64::max)
    };
    LOOKED_AT.into_iter().map(of_row).fold(0.0, f64::max)
}

/// The columns of a term's coefficients over the rows: in closed form, and by differences.
fn compare(term: &Term, statics: &Statics, arm: &Arm, data: &Measurements, compared: &mut Compared) {
    let model = EffectModel::of_terms(statics, None, std::slice::from_ref(term));
    let freedom = Freedom::placement(arm.joints.len());
    let layout = Layout::new(&arm.nominal, &data.scene, &freedom, &Tolerances::default(), model.parameters());
    let (height, width) = (data.tallest_row(), layout.len());
    let problem = ResidualModel { data, layout: &layout, effects: &model };
    let mut closed = vec![Vec::new(); layout.effects.len()];
    for row in LOOKED_AT {
        let (mut r, mut jacobian) = (vec![0.0; height], vec![0.0; height * width]);
        problem.row_into(arm, row, &mut problem.scratch(arm), &mut r, Some(&mut jacobian));
        for (column, cells) in closed.iter_mut().enumerate() {
            cells.extend((0..height).map(|line| jacobian[line * width + layout.effects.start + column]));
        }
    }
    compared.terms += 1;
    compared.pairs.insert(format!("{} × {}", word(&term.carrier), word(&term.driver)));
    compared.kinds.insert(term.kind.name());
    for (column, closed) in closed.iter().enumerate() {
        let largest = closed.iter().fold(0.0, |largest: f64, cell| largest.max(cell.abs()));
        let by = |step: f64| {
            let mut numbers = vec![0.0; layout.effects.len()];
            numbers[column] = step;
            model.stepped(&numbers)
        };
        let size = size(&by(SMALL), arm, data) / SMALL;
        let felt = size > NOTHING;
        let step = if felt { MOVED / size } else { MOVED };
        let moved = |step: f64| {
            let model = by(step);
            LOOKED_AT.iter().flat_map(|&row| residual(&model, &layout, arm, data, row)).collect::<Vec<f64>>()
        };
        let (up, down) = (moved(step), moved(-step));
        let off = up.iter().zip(&down).zip(closed).map(|((up, down), cell)| ((up - down) / (2.0 * step) - cell).abs());
        let off = off.fold(0.0, f64::max) / if felt { largest.max(HARDLY * size) } else { 1.0 };
        assert!(off < WITHIN, "{term:?}, coefficient {column}: {off:e} of {largest:e}");
        compared.coefficients += 1;
        compared.moving += usize::from(felt && largest > HARDLY * size);
        compared.worst = compared.worst.max(off);
    }
}

#[test]
fn every_pair_of_the_catalogue_moves_the_residual_as_its_closed_form_says() {
    let mut all = Compared::default();
    // Turning joints alone; a rail before six of them; a screw and a spline on one shaft.
    let robots = ["universal_robots/ur5e.urdf", "kuka/kr16_2_on_rail.urdf", "denso/hsr065_screw_spline.urdf"];
    for (index, path) in robots.into_iter().enumerate() {
        let (chain, statics) = robot(path);
        for kind in [ObservationKind::Pose, ObservationKind::Distance] {
            let (arm, data) = run(&chain, kind, index > 0);
            for statics in &statics {
                let gears = vec![Some(50.0); chain.joints().len()];
                let survey = Survey::of(statics, &data, gears);
                let terms = KINDS.iter().flat_map(|entry| candidates(entry.kind, &survey));
                for candidate in terms {
                    compare(&candidate.term, statics, &arm, &data, &mut all);
                }
            }
        }
    }
    let kinds: BTreeSet<&str> = KINDS.iter().map(|entry| entry.kind).map(Kind::name).collect();
    assert_eq!(all.kinds, kinds);
    assert!(10 * all.moving > 9 * all.coefficients, "{} of {} move anything", all.moving, all.coefficients);
    println!(
        "{} pairs of carrier and driver in {} terms with {} coefficients, of which {} move the residual; largest difference \
         {:.1e} of a column's largest value: {}",
        all.pairs.len(),
        all.terms,
        all.coefficients,
        all.moving,
        all.worst,
        all.pairs.iter().cloned().collect::<Vec<_>>().join(", ")
    );
}
