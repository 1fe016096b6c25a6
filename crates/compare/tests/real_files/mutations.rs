//! Harmless edits must read as the same robot, real ones must be found, named and measured.

use crate::real_files::support::chance::Chance;
use crate::real_files::support::write::{PLAIN, again};
use crate::real_files::support::{as_written, harmless, real, vendor};
use denavit_compare::{Options, Subject, Verdict, compare, fingerprint_as};
use denavit_model::{Reading, Robot};

/// Edits of each sort per robot, at least one of each kind where it can be made; and robots of our own that there must be at least.
const EDITS: usize = 10;
const OWN: usize = 12;

/// Robots with a joint that moves, each read back from what is written of it: our own, and the corpus where it is there.
fn robots() -> Vec<Robot> {
    let robots: Vec<Robot> =
        vendor::robots().into_iter().filter(|robot| robot.joints.iter().any(|j| j.kind.moves())).collect();
    assert!(robots.len() >= OWN, "only {} robots are in robots/", robots.len());
    println!("{} robots with a joint that moves, those of ../shared/vendor counted where it is there", robots.len());
    robots.iter().map(|robot| again(robot, &PLAIN)).collect()
}

fn quick() -> Options {
    Options { samples: 256, ..as_written() }
}

#[test]
fn harmless_edits_leave_the_same_robot() {
    let robots = robots();
    let (mut edits, mut faults) = (0, Vec::new());
    for (index, robot) in robots.iter().enumerate() {
        let mut chance = Chance::new(index as u64);
        let pinned = fingerprint_as(&Subject::Robot(robot), 1e-6, Reading::AsWritten).to_string();
        let mut done = 0;
        for attempt in 0..4 * EDITS {
            let Some((what, edited)) = harmless::edit(robot, attempt, &mut chance) else { continue };
            let found = compare(&Subject::Robot(robot), &Subject::Robot(&edited), &quick()).unwrap();
            if found.verdict != Verdict::Same {
                faults.push(format!("{}: {what}: {:?} {:?}", robot.source.file, found.joints, found.parts));
            }
            if !fingerprint_as(&Subject::Robot(&edited), 1e-6, Reading::AsWritten).matches(&pinned) {
                faults.push(format!("{}: {what}: another fingerprint", robot.source.file));
            }
            done += 1;
            if done == EDITS {
                break;
            }
        }
        assert!(done == EDITS, "{}: {done} edits", robot.source.file);
        edits += done;
    }
    println!("{} robots, {edits} harmless edits, {} read as different", robots.len(), faults.len());
    assert!(faults.is_empty(), "{}", faults.iter().take(15).cloned().collect::<Vec<_>>().join("\n"));
}

/// Whether an edit is above 1e-6 m, rad and, for masses, of the body that it is part of (at most the whole robot).
fn above_a_micrometre(robot: &Robot, edited: &Robot, edit: &real::Edit) -> bool {
    if edit.what == real::What::Mass {
        let mass = |link: &denavit_model::robot::Link| link.inertial.as_ref().map_or(0.0, |inertial| inertial.mass);
        let whole: f64 = robot.links.iter().map(mass).sum();
        let own = robot.link_index(&edit.name).map_or(0.0, |link| mass(&robot.links[link]));
        return edit.by * own > 2e-6 * whole;
    }
    let options = Options { tolerance_m: 1e-6, samples: 0, ..as_written() };
    let found = compare(&Subject::Robot(robot), &Subject::Robot(edited), &options).unwrap();
    found.verdict == Verdict::Different
}

#[test]
fn real_edits_are_found_named_measured_and_bounded() {
    let robots = robots();
    let (mut edits, mut faults, mut ratios) = (0, Vec::new(), Vec::new());
    for (index, robot) in robots.iter().enumerate() {
        let mut chance = Chance::new(1000 + index as u64);
        let pinned = fingerprint_as(&Subject::Robot(robot), 1e-6, Reading::AsWritten).to_string();
        let mut done = 0;
        for attempt in 0..4 * EDITS {
            let mut edited = robot.clone();
            let what = real::KINDS[attempt % real::KINDS.len()];
            let Some(edit) = real::edit(&mut edited, what, &mut chance) else { continue };
            let edited = again(&edited, &PLAIN);
            let found = compare(&Subject::Robot(robot), &Subject::Robot(&edited), &quick()).unwrap();
            let name = format!("{}: {:?} of {} by {}", robot.source.file, edit.what, edit.name, edit.by);
            if found.verdict != Verdict::Different {
                faults.push(format!("{name}: not found"));
            } else if let Some(fault) = real::fault(&edit, &found) {
                faults.push(format!("{name}: {fault}"));
            }
            if fingerprint_as(&Subject::Robot(&edited), 1e-6, Reading::AsWritten).matches(&pinned)
                && above_a_micrometre(robot, &edited, &edit)
            {
                faults.push(format!("{name}: the same fingerprint"));
            }
            for tip in &found.tips {
                if tip.bound_m < tip.sampled_m {
                    faults.push(format!(
                        "{name}: {} displaced by {} above its bound {}",
                        tip.tip, tip.sampled_m, tip.bound_m
                    ));
                }
                if tip.sampled_m > 1e-9 && what != real::What::Kind {
                    ratios.push((
                        tip.bound_m / tip.sampled_m,
                        format!("{name}: tip {}: {} {}", tip.tip, tip.sampled_m, tip.bound_m),
                    ));
                }
            }
            done += 1;
            if done == EDITS {
                break;
            }
        }
        assert!(done == EDITS, "{}: {done} edits", robot.source.file);
        edits += done;
    }
    ratios.sort_by(|one, other| other.0.total_cmp(&one.0));
    println!("{} robots, {edits} real edits, {} faults", robots.len(), faults.len());
    println!("{} bounds; largest {:?}; median {:?}", ratios.len(), ratios.first(), ratios.get(ratios.len() / 2));
    assert!(faults.is_empty(), "{}", faults.iter().take(25).cloned().collect::<Vec<_>>().join("\n"));
    assert!(ratios[0].0 <= 2.0, "{:#?}", &ratios[..ratios.len().min(12)]);
}
