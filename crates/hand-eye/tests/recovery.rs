//! Placements come back exactly from exact rows, and as well as theory allows from noisy ones; what cannot be known is said.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a panic is a failure, and what is printed is read")]

use denavit_hand_eye::closed_form::METHODS;
use denavit_hand_eye::{Arrangement, HandEye, HandEyeError, Pair, Unknown, solve};
use denavit_model::nalgebra::{Rotation3, Vector3};
use denavit_model::{Pose, se3};
use proptest::prelude::*;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};

const BOTH: [Arrangement; 2] = [Arrangement::InstrumentStands, Arrangement::InstrumentOnHand];

fn normal(rng: &mut ChaCha8Rng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| StandardNormal.sample(rng))
}

fn anywhere(rng: &mut ChaCha8Rng, far: f64) -> Pose {
    let axis = normal(rng).normalize();
    let angle = rng.random_range(0.0..3.1);
    se3::pose(Rotation3::new(axis * angle), normal(rng) * far)
}

struct Run {
    pairs: Vec<Pair>,
    base: Pose,
    tip: Pose,
}

/// Rows of a robot that turns by up to `turn` about anything, with noise of one component in m and rad.
fn run(arrangement: Arrangement, rows: usize, turn: f64, noise: [f64; 2], seed: u64) -> Run {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (base, tip) = (anywhere(&mut rng, 0.8), anywhere(&mut rng, 0.1));
    let middle = anywhere(&mut rng, 0.5);
    let pairs = (0..rows).map(|_| {
        let axis = normal(&mut rng).normalize();
        let here = se3::pose(Rotation3::new(axis * rng.random_range(0.0..turn)), normal(&mut rng) * 0.2);
        let robot = middle * here;
        let exact = match arrangement {
            Arrangement::InstrumentStands => base.inverse() * robot * tip,
            Arrangement::InstrumentOnHand => tip.inverse() * robot.inverse() * base,
        };
        let wrong = Rotation3::new(normal(&mut rng) * noise[1]);
        let place = exact.translation.vector + normal(&mut rng) * noise[0];
        Pair { robot, seen: se3::pose(exact.rotation * wrong, place) }
    });
    Run { pairs: pairs.collect(), base, tip }
}

fn apart(found: &HandEye, run: &Run) -> [(f64, f64); 2] {
    [se3::difference(&found.base.pose, &run.base), se3::difference(&found.tip.pose, &run.tip)]
}

#[test]
fn exact_rows_give_exact_placements_by_every_method() {
    for arrangement in BOTH {
        for seed in 0..50 {
            let run = run(arrangement, 8, 1.5, [0.0; 2], seed);
            let found = solve(&run.pairs, arrangement).unwrap();
            for (turned, moved) in apart(&found, &run) {
                assert!(turned < 1e-12 && moved < 1e-12, "{arrangement:?} {seed}: {turned:e} {moved:e}");
            }
            assert!(found.converged && found.unknown.is_none());
            for form in &found.closed_forms {
                let name = form.name;
                for (moved, turned) in form.apart.unwrap() {
                    assert!(moved < 1e-8 && turned < 1e-8, "{name} {seed}: {moved:e} {turned:e}");
                }
            }
        }
    }
}

#[test]
fn noisy_rows_are_as_good_as_is_said_and_better_than_every_closed_form() {
    for arrangement in BOTH {
        let (mut inside, mut all, mut squares) = (0.0, 0.0, 0.0);
        let mut ratios = [const { Vec::new() }; METHODS.len()];
        let (mut ours, mut held, mut fitted) = (0.0, 0.0, 0.0);
        for seed in 0..200 {
            let run = run(arrangement, 30, 1.2, [0.5e-3, 2e-3], seed);
            let found = solve(&run.pairs, arrangement).unwrap();
            for (placed, truth) in [(&found.base, &run.base), (&found.tip, &run.tip)] {
                let place = placed.pose.translation.vector - truth.translation.vector;
                let turn = se3::rotation_vector(&(placed.pose.rotation * truth.rotation.inverse()));
                let errors = [place.x, place.y, place.z, turn.x, turn.y, turn.z];
                for (error, std) in errors.iter().zip(placed.std()) {
                    inside += f64::from(u8::from(error.abs() < 1.96 * std));
                    all += 1.0;
                    squares += (error / std).powi(2);
                }
            }
            let [(_, base), (_, tip)] = apart(&found, &run);
            ours += base * base + tip * tip;
            let held_out = found.held_out.unwrap();
            held += held_out.position_rms.powi(2);
            fitted += found.fitted.position_rms.powi(2);
            let used = run.pairs.iter().map(|pair| denavit_hand_eye::Row {
                moved: if arrangement == Arrangement::InstrumentStands { pair.robot } else { pair.robot.inverse() },
                seen: pair.seen,
            });
            let used: Vec<_> = used.collect();
            for (method, sums) in METHODS.iter().zip(&mut ratios) {
                let [left, right] = (method.solve)(&used).unwrap();
                let placed = if arrangement == Arrangement::InstrumentStands { [left, right] } else { [right, left] };
                sums.push(
                    se3::difference(&placed[0], &run.base).1.powi(2) + se3::difference(&placed[1], &run.tip).1.powi(2),
                );
            }
        }
        let coverage = inside / all;
        println!(
            "{arrangement:?}: {:.1} % inside 95 %, error over its standard deviation {:.3}",
            100.0 * coverage,
            f64::sqrt(squares / all)
        );
        assert!((0.93..0.97).contains(&coverage), "{coverage}");
        assert!((0.95..1.05).contains(&f64::sqrt(squares / all)), "{}", f64::sqrt(squares / all));
        // Rows that were not fitted are off by more than rows that were.
        assert!(held > fitted, "{held} {fitted}");
        for (method, sums) in METHODS.iter().zip(&ratios) {
            let theirs: f64 = sums.iter().sum();
            println!("  {}: {:.2} of its error", method.name, f64::sqrt(ours / theirs));
            assert!(ours < theirs, "{}", method.name);
        }
    }
}

#[test]
fn rows_that_do_not_belong_are_rejected_and_the_others_stay() {
    for arrangement in BOTH {
        for seed in 0..20 {
            let mut run = run(arrangement, 30, 1.2, [0.2e-3, 1e-3], seed);
            let mut rng = ChaCha8Rng::seed_from_u64(seed + 1000);
            for row in [3, 11, 12, 20, 21, 22, 23, 29] {
                run.pairs[row].seen = anywhere(&mut rng, 0.5);
            }
            let found = solve(&run.pairs, arrangement).unwrap();
            let rejected: Vec<usize> = (0..30).filter(|row| found.residuals[*row].rejected).collect();
            assert_eq!(rejected, [3, 11, 12, 20, 21, 22, 23, 29], "{arrangement:?} {seed}");
            let [(_, base), (_, tip)] = apart(&found, &run);
            assert!(base < 3e-3 && tip < 3e-3, "{arrangement:?} {seed}: {base} {tip}");
        }
    }
}

#[test]
fn what_the_motion_does_not_tell_is_said() {
    for arrangement in BOTH {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let (base, tip) = (anywhere(&mut rng, 0.8), anywhere(&mut rng, 0.1));
        let pairs = |turns: &mut dyn FnMut(&mut ChaCha8Rng) -> Vector3<f64>, rng: &mut ChaCha8Rng| -> Vec<Pair> {
            (0..20)
                .map(|_| {
                    let robot = se3::pose(Rotation3::new(turns(rng)), normal(rng) * 0.3);
                    let exact = match arrangement {
                        Arrangement::InstrumentStands => base.inverse() * robot * tip,
                        Arrangement::InstrumentOnHand => tip.inverse() * robot.inverse() * base,
                    };
                    Pair { robot, seen: se3::translation(normal(rng) * 1e-4) * exact }
                })
                .collect()
        };
        let scara = pairs(&mut |rng| Vector3::z() * rng.random_range(-2.0..2.0), &mut rng);
        let Some(Unknown::OneAxis { axis, within }) = solve(&scara, arrangement).unwrap().unknown else {
            panic!("{arrangement:?}: an arm that turns about one axis")
        };
        assert!(axis[2] > 0.999_999 && within < 1e-6, "{axis:?} {within}");
        let still = pairs(&mut |_| Vector3::zeros(), &mut rng);
        assert_eq!(solve(&still, arrangement).unwrap().unknown, Some(Unknown::NoTurn));
        let all = pairs(&mut |rng| normal(rng), &mut rng);
        assert_eq!(solve(&all, arrangement).unwrap().unknown, None);
    }
}

#[test]
fn rows_of_nothing_in_common_are_refused() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let pairs: Vec<Pair> =
        (0..40).map(|_| Pair { robot: anywhere(&mut rng, 0.5), seen: anywhere(&mut rng, 0.5) }).collect();
    assert!(matches!(solve(&pairs, BOTH[0]), Err(HandEyeError::Apart(..))));
    assert_eq!(solve(&pairs[..2], BOTH[0]), Err(HandEyeError::TooFew(2)));
    let mut nan = pairs;
    nan[4].seen.translation.x = f64::NAN;
    assert_eq!(solve(&nan, BOTH[0]), Err(HandEyeError::NotFinite(5)));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn the_order_of_rows_does_not_matter(seed in 0u64..10_000) {
        let run = run(BOTH[0], 12, 1.2, [0.5e-3, 2e-3], seed);
        let turned: Vec<Pair> = run.pairs.iter().rev().copied().collect();
        let (a, b) = (solve(&run.pairs, BOTH[0]).unwrap(), solve(&turned, BOTH[0]).unwrap());
        let (turned, moved) = se3::difference(&a.base.pose, &b.base.pose);
        prop_assert!(turned < 1e-7 && moved < 1e-7, "{turned:e} {moved:e}");
    }
}
