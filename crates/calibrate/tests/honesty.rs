//! Noise like that of real files: no cause is named. A small part of the study.

#[path = "../examples/study_honesty.rs"]
#[allow(dead_code, reason = "the study has a main of its own")]
mod study;

use denavit_identify::effects::Kind;
use denavit_model::examples::puma_like;
use denavit_trace::Trace;
use study::{World, file, traced};

fn named(found: &Trace) -> Vec<(Kind, String)> {
    let findings = found.findings.iter().filter(|finding| finding.named);
    findings.map(|finding| (finding.term.kind, finding.place.clone())).collect()
}

#[test]
fn real_noise_names_nothing() {
    let chain = puma_like();
    for (world, rows, seed) in [
        (World::Clean, 30, 1),
        (World::Clean, 60, 2),
        (World::Clean, 120, 3),
        (World::Field, 60, 4),
        (World::Field, 120, 5),
    ] {
        let found = traced(&chain, &file(&chain, world, rows, seed));
        assert!(named(&found).is_empty(), "{world:?}, {rows} rows: {:?}", named(&found));
    }
}
