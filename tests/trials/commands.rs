//! Commands and plans in the requested units; an arm that keeps its configuration.

use super::Trial;
use crate::golden::snapshot;

const POSES: &str = "x,y,z,roll,pitch,yaw\n";

/// Joint values of a CSV of commands or of a plan, without comments and header.
fn rows(text: &str) -> Vec<Vec<f64>> {
    let lines = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    lines.map(|line| line.split(',').take(6).map(|cell| cell.parse().unwrap()).collect()).collect()
}

#[test]
fn units_are_those_of_what_comes_out_too() {
    let trial = Trial::new().with("poses.csv", &format!("{POSES}400,200,500,180,0,0\n"));
    let degrees = trial.run("compensate arm.urdf --poses poses.csv --units mm,deg").succeeded();
    assert!(
        degrees.contains("# units: mm,deg\n") && degrees.contains("position_error_mm,orientation_error_deg"),
        "{degrees}"
    );
    let metres = trial.with("poses.csv", &format!("{POSES}0.4,0.2,0.5,{},0,0\n", std::f64::consts::PI));
    let radians = metres.run("compensate arm.urdf --poses poses.csv").succeeded();
    assert!(
        radians.contains("# units: m,rad\n") && radians.contains("position_error_m,orientation_error_rad"),
        "{radians}"
    );
    for (degree, radian) in rows(&degrees)[0].iter().zip(&rows(&radians)[0]) {
        assert!((degree.to_radians() - radian).abs() < 1e-6, "{degree}° {radian}");
    }
    let plan = |units: &str| metres.run(&format!("plan arm.urdf --count 6 --spread 60 --units {units}")).succeeded();
    assert!(plan("deg").contains("# units: m,deg\n"));
    for (degrees, radians) in rows(&plan("deg")).iter().zip(rows(&plan("rad"))) {
        assert!(degrees.iter().zip(radians).all(|(degree, radian)| (degree.to_radians() - radian).abs() < 1e-8));
    }
    std::fs::write(metres.path("plan.csv"), plan("deg")).unwrap();
    let measured = metres.run("simulate arm.urdf --poses plan.csv --units deg").succeeded();
    let first: f64 = rows(&measured)[0][0];
    assert!((first - rows(&plan("rad"))[0][0]).abs() < 1e-6, "{first}");
}

#[test]
fn commands_keep_the_configuration_or_say_that_it_changes() {
    // Along a line, and then to a pose where the arm's other configuration is nearer.
    let line: Vec<String> = (0..12u32).map(|k| format!("400,{},500,180,0,0\n", -200 + 40 * i64::from(k))).collect();
    let line = line.concat();
    let trial = Trial::new().with("line.csv", &format!("{POSES}{line}"));
    let run = trial.run("compensate arm.urdf --poses line.csv --units mm,deg");
    assert!(!run.stdout.contains("changes its configuration"), "{}", run.stdout);
    let commands = rows(&run.succeeded());
    for pair in commands.windows(2) {
        let most = pair[0].iter().zip(&pair[1]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(most < 30.0, "40 mm take {most}° of a joint: {pair:?}");
    }
    // A shoulder with a small range can reach the other side only by folding over.
    let narrow = trial.text("arm.urdf").replacen(
        "lower=\"-6.283185307179586\" upper=\"6.283185307179586\"",
        "lower=\"-1.2\" upper=\"1.2\"",
        1,
    );
    assert_ne!(narrow, trial.text("arm.urdf"), "a limit to narrow");
    let trial = trial
        .with("narrow.urdf", &narrow)
        .with("sides.csv", &format!("{POSES}500,0,400,180,0,0\n-500,0,400,180,0,0\n"));
    let run = trial.run("compensate narrow.urdf --poses sides.csv --units mm,deg");
    let json: serde_json::Value =
        serde_json::from_str(&trial.run("compensate narrow.urdf --poses sides.csv --units mm,deg --json").stdout)
            .unwrap();
    assert_eq!(json["commands"][0]["keeps_configuration"], true);
    let second = &json["commands"][1];
    if second["state"] == "reached" {
        assert_eq!(second["keeps_configuration"], false);
        assert!(run.stdout.contains("line 3: the arm changes its configuration"), "{}", run.stdout);
    } else {
        assert!(run.stdout.contains("line 3: out"), "{}", run.stdout);
    }
}

#[test]
fn residuals_of_every_row_are_a_table_of_their_own() {
    let trial = Trial::new().with_robot("arm.urdf", "universal_robots/ur5e.urdf");
    trial.run("simulate arm.urdf --rows 60 -o data.csv").succeeded();
    let run = trial.run("calibrate arm.urdf --data data.csv --effects none --hold-out 0.3 --residuals rows.csv --json");
    let json: serde_json::Value = serde_json::from_str(&run.succeeded()).unwrap();
    let text = trial.text("rows.csv");
    assert!(text.starts_with("line,setup,target,held_out,rejected,dx_mm,dy_mm,dz_mm\n"), "{text}");
    assert_eq!(text.lines().count() - 1, json["rows"].as_array().unwrap().len());
    let held_out = json["rows"].as_array().unwrap().iter().filter(|row| row["held_out"] == true).count();
    assert_eq!(held_out, 18);
    let refused = trial.run("calibrate arm.urdf --data data.csv --effects none --residuals data.csv");
    assert_eq!(refused.code, 2, "{}", refused.stderr);
}

#[test]
fn a_few_new_poses_continue_an_earlier_calibration() {
    let trial = Trial::new().with_robot("arm.urdf", "universal_robots/ur5e.urdf");
    trial.run("simulate arm.urdf --rows 40 --seed 5 -o first.csv --test later.csv").succeeded();
    trial.run("calibrate arm.urdf --data first.csv --effects none --json before.json --urdf now.urdf").succeeded();
    let again = "calibrate arm.urdf --data later.csv --effects none --hold-out 0.5 --prior before.json";
    let said = trial.run(again).succeeded();
    let counted =
        "prior: the axis estimate of before.json counts in full; stage \"earlier\" is that robot on these rows\n";
    assert!(said.contains(counted) && said.contains("\nearlier "), "{said}");
    let json: serde_json::Value = serde_json::from_str(&trial.run(&format!("{again} --json")).succeeded()).unwrap();
    assert_eq!(json["origin"]["files"][1]["used"], "prior");
    assert_eq!(json["earlier"]["weight"], 1.0);
    let chosen = trial.run("plan arm.urdf --count 5 --spread 60 --prior before.json").succeeded();
    assert_ne!(chosen, trial.run("plan arm.urdf --count 5 --spread 60").succeeded());
    trial.refuses("calibrate now.urdf --data later.csv --prior before.json", "give the robot as it was drawn then");
    trial.refuses("calibrate arm.urdf --data later.csv --prior first.csv", "first.csv: not a calibration");
    trial.refuses("plan now.urdf --count 5 --prior before.json", "give the robot as it was drawn then");
    trial.refuses(&format!("{again} --json before.json"), "before.json");
}

#[test]
fn poses_are_planned_for_what_a_run_cannot_distinguish() {
    let trial = Trial::new();
    let effect = "--effect backlash@elbow_joint=0.04mm";
    trial.run(&format!("simulate arm.urdf --rows 60 --seed 5 -o run.csv {effect}")).succeeded();
    let said = trial.run("plan arm.urdf --tell-apart run.csv --count 8 --spread 200 -o poses.csv").succeeded();
    snapshot("plan_tell_apart", &said);
    let poses = trial.text("poses.csv");
    assert_eq!(poses.lines().filter(|line| !line.starts_with('#')).count(), 9, "{poses}");
    assert!(said.lines().all(|line| poses.contains(&format!("# {line}\n"))), "{poses}");
    // What is written can be measured, in the unit that it is in.
    trial.run("simulate arm.urdf --poses poses.csv -o more.csv").succeeded();
    let in_degrees = "plan arm.urdf --tell-apart run.csv --count 8 --spread 200";
    trial.refuses(&format!("{in_degrees} --units mm,deg"), "run.csv");
    let report = trial.run("calibrate arm.urdf --data run.csv").succeeded();
    assert!(report.contains("`denavit plan` with --tell-apart writes them."), "{report}");
    trial.refuses("plan arm.urdf --tell-apart none.csv", "none.csv");
    trial.refuses("plan arm.urdf", "--count");
    trial.refuses("plan arm.urdf --tell-apart run.csv --measure poses", "--measure");
    trial.refuses("plan arm.urdf --tell-apart run.csv --count 8 --spread 4", "choose fewer poses");
    trial.refuses("plan arm.urdf --tell-apart run.csv -o run.csv", "run.csv");
}
