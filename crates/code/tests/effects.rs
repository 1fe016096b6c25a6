//! What cannot be is refused, and what is written is as small as the effects.

#![allow(clippy::unwrap_used, reason = "a panic is a failure")]

mod examples_with_effects;

use denavit_code::{Language, Options, Precision, code_with_effects};
use denavit_dh::convert::{self, table};
use denavit_model::nalgebra::Translation3;

const OPTIONS: Options = Options { language: Language::Rust, precision: Precision::Double };

#[test]
fn code_that_would_compute_something_else_is_not_written() {
    for mut effects in examples_with_effects::all() {
        let table = table(&effects.chain, &convert::Options::default()).unwrap().value;
        assert!(code_with_effects(&table, &effects, OPTIONS).is_ok());
        let case = &mut effects.cases[2];
        case.pose = Translation3::new(0.0, 1e-8, 0.0) * case.pose;
        let refused = code_with_effects(&table, &effects, OPTIONS).unwrap_err().to_string();
        assert!(refused.starts_with("the code would miss the effects' own prediction by 1.0e-8"), "{refused}");
    }
}

#[test]
fn what_does_not_act_is_not_written() {
    let [of_values, of_gravity] = [0, 1].map(|index| {
        let effects = &examples_with_effects::all()[index];
        let table = table(&effects.chain, &convert::Options::default()).unwrap().value;
        code_with_effects(&table, effects, OPTIONS).unwrap()
    });
    assert!(of_values.contains("fn waves") && !of_values.contains("fn bend") && !of_values.contains("fn squares"));
    assert!(of_gravity.contains("fn bend") && !of_gravity.contains("fn waves") && !of_gravity.contains("given: &"));
    assert!(of_values.contains("// - given[1] time (1)"));
}
