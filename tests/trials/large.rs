//! Files far larger than any robot: done in a time that grows with their size, or refused at once with what to do instead.

use super::Trial;
use crate::support::program;
use std::fmt::Write as _;
use std::process::{Command, Stdio};

/// Links of the large files.
const LINKS: usize = 10_000;
/// Seconds of processor time: a run that needs more grows faster than its input. A busy machine does not count in them.
const LONGEST: u64 = 120;

/// A robot whose joint `k` hangs on the link that `parent` says.
fn robot(joints: usize, moving: usize, parent: impl Fn(usize) -> usize) -> String {
    let mut text = String::from("<robot name=\"large\"><link name=\"l0\"/>\n");
    for k in 0..joints {
        let kind = if k < moving { "revolute" } else { "fixed" };
        let axis = if k % 2 == 0 { "0 1 0" } else { "0 0 1" };
        let _ = writeln!(
            text,
            "<link name=\"l{0}\"/><joint name=\"j{k}\" type=\"{kind}\"><parent link=\"l{1}\"/><child link=\"l{0}\"/>\
             <origin xyz=\"0.01 0 0.{2}\" rpy=\"0 0.1 0\"/><axis xyz=\"{axis}\"/>\
             <limit lower=\"-2\" upper=\"2\" velocity=\"1\" effort=\"1\"/></joint>",
            k + 1,
            parent(k),
            k % 7
        );
    }
    text + "</robot>\n"
}

impl Trial {
    /// Exit code and messages of a run that must end within this many seconds of processor time; else the kernel ends it.
    fn in_time(&self, line: &str, longest: u64) -> (i32, String) {
        let messages = self.path("messages");
        let plain = program(self.folder());
        let mut run = Command::new("sh");
        run.current_dir(self.folder())
            .args(["-c", &format!("ulimit -t {longest}; exec \"$0\" \"$@\"")])
            .arg(plain.get_program())
            .args(line.split_whitespace());
        for (name, value) in plain.get_envs() {
            match value {
                Some(value) => run.env(name, value),
                None => run.env_remove(name),
            };
        }
        let status = run
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(std::fs::File::create(&messages).unwrap())
            .status()
            .unwrap();
        match status.code() {
            Some(code) => (code, self.text("messages")),
            None => panic!("{line}: ended by a signal, {status}; it may use {longest} s of processor time"),
        }
    }
}

#[test]
fn large_files_are_done_in_time() {
    let longer = robot(LINKS, LINKS, |k| k).replacen("0.01 0 0.3", "0.02 0 0.3", 1);
    let trial = Trial::new()
        .with("chain.urdf", &robot(LINKS, LINKS, |k| k))
        .with("longer.urdf", &longer)
        .with("rigid.urdf", &robot(LINKS, 4, |k| k))
        .with("star.urdf", &robot(LINKS, LINKS, |_| 0));
    for (line, expected) in [
        ("table chain.urdf", 0),
        ("export chain.urdf", 0),
        ("export --keep-link-frames chain.urdf", 0),
        ("simulate chain.urdf --rows 5", 0),
        ("diff chain.urdf longer.urdf", 1),
        ("doc rigid.urdf -o -", 0),
        ("plan rigid.urdf --count 5", 0),
        ("export star.urdf", 0),
        ("diff star.urdf star.urdf", 0),
        ("plan star.urdf --count 5", 0),
    ] {
        let (code, said) = trial.in_time(line, LONGEST);
        assert_eq!(code, expected, "{line}: {said}");
    }
    assert!(trial.in_time("check chain.urdf", LONGEST).0 < 2);
}

#[test]
fn what_would_take_days_or_show_nothing_is_refused_at_once() {
    let trial = Trial::new()
        .with("chain.urdf", &robot(2000, 2000, |k| k))
        .with("star.urdf", &robot(2000, 2000, |_| 0))
        .with("data.csv", "")
        .with("poses.csv", "");
    for (line, said) in [
        (
            "plan chain.urdf --count 5",
            "2000 joints move between \"l0\" and \"l2000\", but at most 100 can be identified",
        ),
        ("identify chain.urdf", "choose a part of the chain: --base and --tip"),
        ("calibrate chain.urdf --data data.csv", "at most 100 can be identified at once"),
        ("doc chain.urdf -o pages", "a page shows at most 500; choose a part of the chain with --base and --tip"),
        ("doc star.urdf -o pages", "the robot has 2000 chains, and a page shows at most 300"),
    ] {
        let (code, message) = trial.in_time(line, 20);
        assert!(code == 2 && message.contains(said), "{line}: {code} {message}");
        assert!(!trial.path("pages").exists());
    }
    let (code, said) = trial.in_time("plan chain.urdf --count 5 --base l0 --tip l6", LONGEST);
    assert_eq!(code, 0, "{said}");
}
