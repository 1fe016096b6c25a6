//! What the program says of itself: completions and manual pages.

use super::Trial;
use crate::support::top;
use std::process::Command;

/// The commands, as `--help` lists them.
fn commands(trial: &Trial) -> Vec<String> {
    let help = trial.run("--help").succeeded();
    let list = help.split("Commands:\n").nth(1).unwrap().split("\n\n").next().unwrap();
    let first = |line: &str| (!line.starts_with("   ")).then(|| line.split_whitespace().next().unwrap().to_owned());
    list.lines().filter_map(first).filter(|name| name != "help").collect()
}

#[test]
fn every_shell_gets_completions_of_every_command() {
    let trial = Trial::new();
    let commands = commands(&trial);
    assert!(commands.len() > 15, "{commands:?}");
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = trial.run(&format!("completions {shell}")).succeeded();
        for word in commands.iter().map(String::as_str).chain(["up-to-base", "effects-out"]) {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
    trial.run("completions bash -o denavit.bash").succeeded();
    let complete = "source ./denavit.bash; COMP_WORDS=(denavit fing); COMP_CWORD=1; _denavit denavit fing denavit; echo $COMPREPLY";
    match Command::new("bash").args(["-c", complete]).current_dir(trial.folder()).output() {
        Ok(output) => assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), "fingerprint"),
        Err(_) => println!("skipped, because there is no bash"),
    }
}

#[test]
fn every_command_has_a_manual_page() {
    let trial = Trial::new();
    let mut expected: Vec<String> = commands(&trial).iter().map(|name| format!("denavit-{name}.1")).collect();
    expected.push("denavit.1".into());
    expected.sort();
    let written = trial.run("man -o pages/man1").succeeded();
    let mut written: Vec<&str> = written.lines().map(|line| line.strip_prefix("pages/man1/").unwrap()).collect();
    written.sort_unstable();
    assert_eq!(written, expected);
    let page = trial.text("pages/man1/denavit-calibrate.1");
    assert!(page.contains(".TH denavit-calibrate 1") && page.contains("effects\\-out"), "{page}");
    assert_eq!(trial.run("man").succeeded(), trial.text("pages/man1/denavit.1"));
    trial.refuses("man -o arm.urdf", "arm.urdf is not a folder");
}

#[test]
fn help_names_flags_and_no_settings() {
    let trial = Trial::new();
    for command in commands(&trial) {
        let help = trial.run(&format!("{command} --help")).succeeded();
        assert!(!help.contains('‹') && help.contains("--"), "{help}");
    }
    assert!(trial.run("diff --help").succeeded().contains("diff --only kinematics"));
    let rules = trial.run("check --explain mesh-not-found").succeeded();
    assert!(!rules.contains('‹') && rules.contains("`--package-path`"), "{rules}");
}

#[test]
fn the_readme_lists_every_command() {
    let readme = std::fs::read_to_string(top().join("README.md")).unwrap();
    for command in commands(&Trial::new()) {
        assert!(readme.contains(&format!("`{command}")), "README.md does not list {command}");
    }
}
