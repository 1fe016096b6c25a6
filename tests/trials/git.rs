//! Names of files in git.

use super::Trial;
use std::process::Command;

fn repository() -> Option<Trial> {
    let trial = Trial::new().with("precious.txt", "precious");
    let script = "git init -q . && git config user.name t && git config user.email t@example.org && git add . && \
                  git commit -qm all";
    let mut made = Command::new("sh");
    made.args(["-c", script]).current_dir(trial.folder()).env("GIT_CONFIG_GLOBAL", "/dev/null");
    if made.status().is_ok_and(|status| status.success()) {
        return Some(trial);
    }
    println!("skipped, because there is no git");
    None
}

#[test]
fn nothing_in_a_name_reaches_git_as_an_option() {
    let Some(trial) = repository() else { return };
    let table = trial.run("table arm.urdf").succeeded();
    assert_eq!(trial.run("table git:HEAD:arm.urdf").succeeded(), table);
    assert_eq!(trial.run("table git:HEAD:./arm.urdf").succeeded(), table);
    for name in
        ["git:--output=precious.txt", "git:--output=precious.txt:arm.urdf", "git:-p", "git:HEAD:--output=precious.txt"]
    {
        trial.refuses(&format!("table {name}"), "cannot be read");
        trial.refuses(&format!("diff {name} arm.urdf"), "cannot be read");
    }
    trial.refuses("table git:-p:arm.urdf", "neither a revision nor a path may begin with \"-\"");
    trial.refuses("table git:HEAD", "write git:REVISION:PATH");
    trial.refuses("table git:HEAD:missing.urdf", "missing.urdf");
    assert_eq!(trial.text("precious.txt"), "precious");
}
