//! Evaluates the functions before they are written.

use crate::correction::{Correction, Part, STILL};
use crate::effects::Case;
use crate::program::{Factor, Statement, Term, Value};
use crate::spread::Table;
use std::collections::HashMap;

/// Names with their values.
#[derive(Debug, Clone, Default)]
pub struct Evaluation {
    values: HashMap<String, f64>,
    arrays: HashMap<String, Vec<f64>>,
}

impl Evaluation {
    /// Error of the functions at a case's pose, m or rad.
    pub fn off(correction: &Correction, case: &Case) -> f64 {
        let wanted = case.pose.to_homogeneous();
        let found = Self::pose(correction, &case.q, &case.given);
        let cell = |index: usize| (found[index] - wanted[(index / 4, index % 4)]).abs();
        // NaN counts as far off.
        (0..12).map(cell).map(|off| if off.is_finite() { off } else { f64::INFINITY }).fold(0.0, f64::max)
    }

    /// The pose with effects, row by row.
    fn pose(correction: &Correction, q: &[f64], given: &[f64]) -> Vec<f64> {
        let mut start = Self::default();
        start.set("q", q);
        start.set("given", given);
        if let (Some(steady), Some(bend)) = (&correction.steady, &correction.bend) {
            let steady = start.clone().run(steady, correction);
            start.set("steady", &steady);
            let (mut t, mut at, mut last) = (steady.clone(), steady, 0.0);
            for pass in 0..=correction.passes {
                let mut own = start.clone();
                own.set("t", &t);
                let next = own.run(bend, correction);
                let moved =
                    next.iter().zip(&t).map(|(a, b)| (a - if pass == 0 { 0.0 } else { *b }).abs()).fold(0.0, f64::max);
                (at, t) = (t, next);
                if moved < STILL || moved * moved < STILL * last {
                    break;
                }
                last = moved;
            }
            start.set("t", &t);
            start.set("at", &at);
        }
        start.run(&correction.reach, correction)
    }

    fn set(&mut self, array: &str, values: &[f64]) {
        for (index, value) in values.iter().enumerate() {
            self.values.insert(format!("{array}[{index}]"), *value);
        }
    }

    fn value(&self, value: &Value) -> f64 {
        match value {
            Value::Number(number) => *number,
            Value::Name { negative, name } => {
                let value = self.values.get(name).copied().unwrap_or(f64::NAN);
                if *negative { -value } else { value }
            }
        }
    }

    fn sum(&self, terms: &[Term]) -> f64 {
        let product = |term: &Term| {
            let factor = |factor: &Factor| match factor {
                Factor::Number(number) => *number,
                Factor::Name(name) => self.values.get(name).copied().unwrap_or(f64::NAN),
                Factor::Coordinate(index) => self.values.get(&format!("q[{index}]")).copied().unwrap_or(f64::NAN),
            };
            let product: f64 = term.factors.iter().map(factor).product();
            if term.negative { -product } else { product }
        };
        terms.iter().map(product).sum()
    }

    /// The outputs of a part.
    fn run(&mut self, part: &Part, Correction { tables, numbers, .. }: &Correction) -> Vec<f64> {
        let mut z = vec![[0.0; 3]; *numbers];
        for statement in &part.statements {
            match statement {
                Statement::Sum { name, terms } => {
                    let value = self.sum(terms);
                    self.values.insert(name.clone(), value);
                }
                Statement::SinCos { sine, cosine, angle } => {
                    let (s, c) = self.sum(angle).sin_cos();
                    self.values.extend([(sine.clone(), s), (cosine.clone(), c)]);
                }
                Statement::Call { name, function, arguments } => {
                    let arguments: Vec<f64> = arguments.iter().map(|value| self.value(value)).collect();
                    self.values.insert(name.clone(), function.of(&arguments));
                }
                Statement::Waves { array, count, angle, inside, turns } => {
                    let (angle, inside) = (self.value(angle), self.value(inside));
                    let wave = |k: usize| match turns {
                        false => (angle * (k + 1) as f64).sin(),
                        true if k.is_multiple_of(2) => (angle * (k / 2 + 1) as f64).sin(),
                        true => (angle * (k / 2 + 1) as f64).cos(),
                    };
                    self.arrays.insert(array.clone(), (0..*count).map(|k| inside * wave(k)).collect());
                }
                Statement::Weighted { name, array, table, .. } => {
                    let sum = self.arrays[array].iter().zip(&tables[*table].values).map(|(a, b)| a * b).sum();
                    self.values.insert(name.clone(), sum);
                }
                Statement::Scatter { axis, first, array, by, .. } => {
                    let by = self.value(by);
                    for (k, wave) in self.arrays[array].iter().enumerate() {
                        z[first + k][*axis] = wave * by;
                    }
                }
                Statement::Store { axis, index, value } => z[*index][*axis] = self.value(value),
                Statement::Squares { name, first, table } => {
                    let sum = squares(&z[*first..], &tables[*table]);
                    self.values.insert(name.clone(), sum);
                }
            }
        }
        part.outputs.iter().map(|value| self.value(value)).collect()
    }
}

fn squares(z: &[[f64; 3]], table: &Table) -> f64 {
    let of_row = |(start, row): (usize, &[f64])| -> f64 {
        (0..3).map(|axis| row.iter().zip(&z[start..]).map(|(cell, z)| cell * z[axis]).sum::<f64>().powi(2)).sum()
    };
    table.each_row().enumerate().map(of_row).sum::<f64>() / 3.0
}
