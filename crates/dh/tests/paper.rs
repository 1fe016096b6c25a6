//! The paper's PUMA 560: Table I in, Table II and Figure 4 out.
//!
//! Source: L. Wu, R. Crawford, J. Roberts, ICRA 2019, Tables I and II; outputs at full precision are those of the
//! authors' published MATLAB code. Lengths in mm, as printed.

#![allow(clippy::unwrap_used, reason = "a test that cannot build its input has failed")]

use denavit_dh::convert::table;
use denavit_dh::{Gauge, Options, Parallelism, Table};
use denavit_model::nalgebra::Vector6;
use denavit_model::{forms::BaseForm, se3};

/// Table I: columns are joints 1 to 6 and the tool; rows are omega and v.
const NOMINAL: [[f64; 7]; 6] = [
    [0., 0., 0., 0., 0., 0., 0.],
    [0., -1., -1., 0., -1., 0., 0.],
    [1., 0., 0., -1., 0., -1., 0.],
    [0., 0., 0., -50., -20., -50., 250.],
    [0., 0., 0., 250., 0., 250., 50.],
    [0., 0., -100., 0., -250., 0., -20.],
];
const ACTUAL: [[f64; 7]; 6] = [
    [0.04, 0., 0.178, 0.062, 0.001, 0.095, 0.02],
    [-0.02, -1.00002, -0.984, 0.013, -1.00004, 0.031, -0.01],
    [0.999, 0., -0.001, -0.998, 0., -0.995, 0.01],
    [0.02, -0.02, -0.07, -51., -20.6, -51., 249.],
    [0.04, 0., 0.009, 249., -0.0206, 249., 51.],
    [0., 0.05, -101., 0.0752, -249., 0., -20.6],
];

/// Table II, "actual", at full precision: theta, d, alpha, a.
const ACTUAL_ROWS: [[f64; 4]; 7] = [
    [1.1071487177940904, 1., 0.04473625771919154, 0.],
    [2.0340436559212636, -1.021387604552661, -1.5507950032234985, 0.009150842794935148],
    [-1.536395582082191, -567.6553729601925, 0.1789618098357912, 0.5113605270453513],
    [-1.501902354353836, 552.7517563126863, 1.5715543427863694, 153.30350136004415],
    [-2.964042829706064, 30.19219741541407, 1.5837345738050204, 1.8364921605958138],
    [-3.1084304424800404, -0.7926834952652702, 1.6017060668552583, 3.1761461276194574],
    [1.4451640686750478, -37.05726996573557, 3.055632217494603, -0.720188434419017],
];
const ACTUAL_TOOL: [f64; 2] = [1.4518910563633352, -35.43276076172782];
const ACTUAL_PITCH: [f64; 6] =
    [0., 0., 0.07968870163339646, -4.9599156816043655e-05, 8.239332610106287e-07, 2.8739683863477516];
const ACTUAL_SCALE: [f64; 6] =
    [1.000000499999875, 1.00002, 0.9999704995648622, 1.0000084999638754, 1.000040499979876, 1.000005499984875];

/// Table II, "nominal", theta, d, alpha, a in degrees and mm; base z and joint 1 coincide, so their thetas are free and
/// the published code's 180 and -180 are printed as 0 and 0.
const NOMINAL_ROWS: [[f64; 4]; 7] = [
    [0., 0., 0., 0.],
    [0., 0., 90., 0.],
    [0., 0., 0., 100.],
    [0., -50., 90., 150.],
    [180., 20., 90., 0.],
    [180., 0., 90., 0.],
    [0., 0., 180., 0.],
];

fn base_form(columns: &[[f64; 7]; 6]) -> BaseForm {
    let twist = |k: usize| Vector6::from_fn(|row, _| columns[row][k]);
    BaseForm { twists: (0..6).map(twist).collect(), home: se3::exp(&twist(6)) }
}

fn paper_table(columns: &[[f64; 7]; 6]) -> Table {
    let names: Vec<String> = (1..=6).map(|k| format!("joint_{k}")).collect();
    let chain = base_form(columns).chain("puma560", &names).unwrap();
    let options = Options { gauge: Gauge::Paper, parallelism: Parallelism::Exact, ..Options::default() };
    table(&chain, &options).unwrap().value
}

#[test]
fn table_ii_actual_to_full_precision() {
    let table = paper_table(&ACTUAL);
    for (row, expected) in table.rows.iter().zip(ACTUAL_ROWS) {
        let found = [row.theta(), row.d().unwrap(), row.alpha(), row.a()];
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 2e-12 * (1.0 + expected.abs()), "{found} {expected}");
        }
    }
    assert!((table.tool.theta - ACTUAL_TOOL[0]).abs() < 1e-12 && (table.tool.d - ACTUAL_TOOL[1]).abs() < 1e-10);
    for (joint, (pitch, scale)) in table.joints.iter().zip(ACTUAL_PITCH.iter().zip(ACTUAL_SCALE)) {
        assert!((joint.motion.pitch() - pitch).abs() < 1e-14 && (joint.scale - scale).abs() < 1e-15, "{joint:?}");
    }
}

#[test]
fn table_ii_nominal_is_what_the_paper_prints() {
    let table = paper_table(&NOMINAL);
    for (row, expected) in table.rows.iter().zip(NOMINAL_ROWS) {
        let found = [row.theta().to_degrees(), row.d().unwrap(), row.alpha().to_degrees(), row.a()];
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{:?} {expected:?}", table.rows);
        }
    }
    assert_eq!((table.tool.theta, table.tool.d), (0.0, 0.0));
}

/// Figure 4: conversion error over 100 random configurations; lengths are mm on a robot of some 600 mm.
#[test]
fn figure_4_conversion_error_is_rounding() {
    for columns in [&NOMINAL, &ACTUAL] {
        let form = base_form(columns);
        let table = paper_table(columns);
        let size = table.chain().unwrap().size();
        let mut worst = (0.0f64, 0.0f64);
        for sample in 0..100 {
            let q: Vec<f64> = (0..6)
                .map(|k| {
                    ((0.5 + f64::from(sample) * 0.618_033_988 * f64::from(k + 2).sqrt()).fract() * 2.0 - 1.0)
                        * std::f64::consts::PI
                })
                .collect();
            let (turned, moved) = se3::difference(&form.fk(&q), &table.fk(&q));
            worst = (worst.0.max(turned), worst.1.max(moved / size));
        }
        println!("largest rotation error {:.2e} rad, translation error {:.2e} of the robot's size", worst.0, worst.1);
        assert!(worst.0 <= 1e-14 && worst.1 <= 1e-14, "{worst:?}");
    }
}
