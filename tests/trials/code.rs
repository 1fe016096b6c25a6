//! Source code of one robot from the command line.

use super::Trial;
use std::process::Command;

#[test]
fn code_of_a_robot_passes_its_own_test() {
    let trial = Trial::new();
    trial.run("code arm.urdf --lang python -o arm.py").succeeded();
    let text = trial.text("arm.py");
    assert!(text.contains("q[2]  elbow_joint (rad)"), "{text}");
    match Command::new("python3").arg(trial.path("arm.py")).status() {
        Ok(status) => assert!(status.success()),
        Err(_) => println!("skipped, because python3 is not installed"),
    }
    let header = trial.run("code arm.urdf --lang c --single").succeeded();
    assert!(header.contains("static inline void ur5e_fk(const float q[6], float pose[3][4])"), "{header}");
    trial.refuses("code arm.urdf --lang c --base base --tip base", "base");
    trial.refuses("code arm.urdf --lang fortran", "fortran");
}
