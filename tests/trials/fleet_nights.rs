//! Nights of a fleet that fail, and robots that wait for a reference.

use super::Trial;

/// Robots with some nights each, one of whose files is cut.
fn plant(nights: u32) -> Trial {
    let trial = Trial::new();
    trial.run("simulate arm.urdf --rows 60 -o data.csv").succeeded();
    let mut manifest = "serial,robot,data,date,effects\n".to_owned();
    for night in 1..=nights {
        for robot in ["SN-1", "SN-2"] {
            let data = if (robot, night) == ("SN-2", nights) { "cut.csv" } else { "data.csv" };
            let date = format!("2026-11-{night:02}");
            manifest.push_str(&[robot, "arm.urdf", data, &date, "none\n"].join(","));
        }
    }
    let cut: String = trial.text("data.csv").split_inclusive('\n').take(4).collect();
    trial.with("cut.csv", &cut).with("plant.csv", &manifest)
}

#[test]
fn a_failed_night_stays_failed_until_it_succeeds() {
    let trial = plant(2);
    for again in 0..2 {
        let run = trial.run("fleet run plant.csv -o store");
        assert_eq!(run.code, 1, "{}", run.stderr);
        assert!(run.stdout.contains("1 failed") && run.stdout.contains("SN-2 2026-11-02 calibrate"), "{}", run.stdout);
        let known = if again == 0 { "4 done now, 0 done before" } else { "1 done now, 3 done before" };
        assert!(run.stdout.contains(known), "{}", run.stdout);
    }
    let watch = trial.run("fleet watch store --junit tests.xml --markdown night.md");
    assert_eq!(watch.code, 1, "{}{}", watch.stdout, watch.stderr);
    assert!(watch.stdout.contains("FAILED SN-2 2026-11-02 calibrate: "), "{}", watch.stdout);
    let tests = trial.text("tests.xml");
    assert!(tests.contains("<testcase classname=\"denavit.fleet.failed\" name=\"SN-2\">"), "{tests}");
    assert!(trial.text("night.md").contains("| SN-2 | 2026-11-02 calibrate: "), "{}", trial.text("night.md"));
    let history = trial.run("fleet history store SN-2");
    assert!(history.stdout.contains("failed: 2026-11-02 calibrate: "), "{}{}", history.stdout, history.stderr);
    trial.run("fleet report store -o pages").succeeded();
    for page in ["pages/index.html", "pages/robots/SN-2.html"] {
        let page = trial.text(page);
        assert!(page.contains("id=\"failed\"") && page.contains("2026-11-02"), "{page}");
    }
    assert!(!trial.text("pages/robots/SN-1.html").contains("id=\"failed\""));

    std::fs::copy(trial.path("data.csv"), trial.path("cut.csv")).unwrap();
    assert!(trial.run("fleet run plant.csv -o store").succeeded().contains("0 failed"));
    assert!(!trial.run("fleet watch store").succeeded().contains("FAILED"));
    trial.run("fleet report store -o pages").succeeded();
    assert!(!trial.text("pages/index.html").contains("id=\"failed\""));
}

#[test]
fn a_robot_that_waits_for_a_reference_has_not_passed() {
    let trial = plant(1);
    std::fs::copy(trial.path("data.csv"), trial.path("cut.csv")).unwrap();
    trial.run("fleet run plant.csv -o store").succeeded();
    trial.run("fleet watch store --junit tests.xml --markdown night.md").succeeded();
    let tests = trial.text("tests.xml");
    assert!(tests.contains("tests=\"2\" failures=\"0\" skipped=\"2\""), "{tests}");
    assert_eq!(tests.matches("<skipped message=\"not tested: ").count(), 2, "{tests}");
    assert!(trial.text("night.md").contains("Not tested: 2 robots"), "{}", trial.text("night.md"));
}

/// The arm's description has masses: that a total is refused shows that it came as far as the fit.
#[test]
fn a_mass_of_the_manifest_reaches_the_fit() {
    let trial = plant(1);
    let trial = trial.with("heavy.csv", "serial,robot,data,effects\nSN-1,arm.urdf,data.csv,backlash\n");
    trial.run("fleet run heavy.csv -o store").succeeded();
    let zero = trial.run("fleet run heavy.csv -o store --set mass=0");
    assert!(zero.code == 2 && zero.stderr.contains("write a number above 0"), "{}", zero.stderr);
    let heavy = trial.run("fleet run heavy.csv -o store --set mass=30");
    assert!(heavy.stdout.contains("1 done now, 0 done before, 1 failed"), "{}{}", heavy.stdout, heavy.stderr);
    assert!(heavy.stdout.contains("the description has masses"), "{}", heavy.stdout);
}
