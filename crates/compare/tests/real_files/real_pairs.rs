//! Pairs of real files of one robot, explained in words that name the joint.

use crate::support::vendor;
use denavit_compare::report::{Colour, Report, text};
use denavit_compare::{Comparison, Options, Scope, Subject, Verdict, compare};

/// What sets two files apart as to motion; `None`, with the reason printed, where the corpus is not there.
fn explained(one: &str, other: &str, options: &Options) -> Option<(Comparison, Vec<String>)> {
    let (Some(a), Some(b)) = (vendor::robot(one), vendor::robot(other)) else {
        println!("skipped, because ../shared/vendor has no {one} or {other}");
        return None;
    };
    let found = compare(&Subject::Robot(&a), &Subject::Robot(&b), options).unwrap();
    println!("{}", text(&Report::Comparison(&found), Colour::None));
    let changes = found.joints.iter().flat_map(|joint| {
        joint.changes.iter().map(|change| format!("{}: {}", joint.joint, change.what))
    });
    let changes = changes.collect();
    Some((found, changes))
}

fn kinematics() -> Options {
    Options { scope: Scope::Kinematics, ..Options::default() }
}
