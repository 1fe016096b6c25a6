//! A slice of `examples/study_watch.rs`: healthy robots raise no alarm, sick ones do.

use denavit_fleet::statistics::vigil::{Night, Nights, Watch, scatters, watch_of};
use rand::{RngExt as _, SeedableRng as _};
use rand_distr::{StandardNormal, StudentT};

/// Nights of one robot: numbers that scatter by 1 about values of their own, the first of which grows by `growth` a night from
/// night 12 on.
fn robot(seed: u64, nights: i32, numbers: usize, growth: f64, heavy: bool) -> Nights {
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    let own: Vec<f64> = (0..numbers).map(|_| 30.0 * random.sample::<f64, _>(StandardNormal)).collect();
    let tails = StudentT::new(4.0).unwrap();
    let night = |day: i32| {
        let mut value = |number: usize| {
            let noise: f64 = if heavy { random.sample(tails) } else { random.sample(StandardNormal) };
            let grown = if number == 0 { growth * f64::from((day - 12).max(0)) } else { 0.0 };
            Some(own[number] + noise + grown)
        };
        Night { day, event: false, values: (0..numbers).map(&mut value).collect() }
    };
    Nights { nights: (0..nights).map(night).collect() }
}

#[test]
fn healthy_robots_are_not_called_ill_and_sick_ones_are() {
    let how = Watch::default();
    for heavy in [false, true] {
        let mut robots: Vec<Nights> = (0..1000).map(|seed| robot(seed, 40, 6, 0.0, heavy)).collect();
        robots.extend((0..10).map(|seed| robot(5000 + seed, 40, 6, 0.6, heavy)));
        let scatters = scatters(&robots, 6, &how);
        let (mut false_alarms, mut found, mut expected) = (0, std::collections::BTreeSet::new(), 0.0);
        for tonight in 9..40 {
            let said = watch_of(&robots, &scatters, tonight, &how);
            assert_eq!(said.watched, 1010);
            expected += said.expected_false;
            for alarm in said.alarms {
                if alarm.robot < 1000 {
                    false_alarms += 1;
                } else {
                    assert!(alarm.number == 0 && alarm.change > 0.0, "{alarm:?}");
                    found.insert(alarm.robot);
                }
            }
        }
        assert!(expected < 0.01, "{expected}");
        assert_eq!(false_alarms, 0, "heavy tails: {heavy}");
        // Where one night in a hundred is six scales off, medians of some nights find what no night by itself does.
        assert_eq!(found.len(), 10, "heavy tails: {heavy}: {found:?}");
    }
}

#[test]
fn an_event_on_record_begins_again() {
    let mut robots: Vec<Nights> = (0..50).map(|seed| robot(seed, 30, 3, 0.0, false)).collect();
    // An exchanged gear: everything moves at night 15, and that is on record for robot 0, not for robot 1.
    for robot in &mut robots[..2] {
        for night in &mut robot.nights[15..] {
            night.values.iter_mut().flatten().for_each(|value| *value += 50.0);
        }
    }
    robots[0].nights[15].event = true;
    let said = denavit_fleet::statistics::vigil::watch(&robots, 3, &Watch::default());
    assert_eq!(said.alarms.iter().map(|alarm| alarm.robot).collect::<Vec<_>>(), [1]);
    assert!((said.alarms[0].change - 50.0).abs() < 5.0, "{:?}", said.alarms);
    assert!(denavit_fleet::statistics::vigil::watch(&[], 3, &Watch::default()).alarms.is_empty());
}
