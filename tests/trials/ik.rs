//! Inverse kinematics from the command line.

use super::Trial;

fn columns(row: &str) -> Vec<f64> {
    row.split(',').skip(2).take(6).map(|cell| cell.parse().unwrap()).collect()
}

#[test]
fn every_branch_of_a_pose_leads_back_to_it() {
    let trial = Trial::new();
    let run = trial.run("ik arm.urdf --pose 400,200,500,180,0,0 --units mm,deg --all");
    let text = run.succeeded();
    assert!(text.contains("closed form: axes 2, 3 and 4 are parallel"), "{text}");
    let rows: Vec<&str> = text.lines().filter(|line| line.starts_with("1,")).collect();
    assert_eq!(rows.len(), 8, "{text}");
    for row in &rows {
        let q = columns(row).iter().map(f64::to_string).collect::<Vec<_>>().join(",");
        let fk = trial.run(&format!("fk arm.urdf --q {q} --degrees --units mm,deg")).succeeded();
        let place = fk.lines().find(|line| line.starts_with("x y z")).unwrap();
        let numbers: Vec<f64> = place.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        assert!((numbers[0] - 400.0).abs() < 1e-3 && (numbers[1] - 200.0).abs() < 1e-3, "{place}");
    }
    let branches: std::collections::BTreeSet<_> = rows.iter().map(|row| row.split('"').nth(1).unwrap()).collect();
    assert_eq!(branches.len(), 8, "each branch has its name: {branches:?}");
}

#[test]
fn a_path_is_followed_and_what_is_out_of_reach_is_said() {
    let path = (0..10).map(|k| format!("400,{},500,180,0,0\n", -200 + 40 * k)).collect::<Vec<_>>().concat();
    let trial = Trial::new().with("path.csv", &format!("x,y,z,roll,pitch,yaw\n{path}"));
    let text = trial.run("ik arm.urdf --poses path.csv --near 0,-90,90,0,90,0 --units mm,deg").succeeded();
    let rows: Vec<Vec<f64>> = text.lines().filter(|line| line.contains("reached")).map(columns).collect();
    assert_eq!(rows.len(), 10, "{text}");
    for pair in rows.windows(2) {
        let most = pair[0].iter().zip(&pair[1]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(most < 30.0, "40 mm take {most} degrees of a joint");
    }
    let far = trial.run("ik arm.urdf --pose 9,0,0,0,0,0");
    assert!(far.code == 1 && far.stdout.contains("out of reach; the nearest found is"), "{}", far.stdout);
    let short = trial.run("ik arm.urdf --pose 1,2,3");
    assert!(
        short.code == 2 && short.stderr.contains("--pose: 3 numbers; write x,y,z,roll,pitch,yaw"),
        "{}",
        short.stderr
    );
}
