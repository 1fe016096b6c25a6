//! Runs the recipes of docs/ci.md unchanged, in a repository of their own.

use crate::support;
use denavit_model::settings::{Shown, shown};
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// Result of a shell script.
struct Ran {
    code: i32,
    output: String,
}

/// A repository with `arm.urdf` in it, committed.
struct Repository {
    folder: TempDir,
}

impl Repository {
    /// `None`, with the reason printed, if there is no git.
    fn new() -> Option<Self> {
        let has_git = Command::new("git").arg("--version").output().is_ok_and(|output| output.status.success());
        if !has_git {
            println!("skipped, because there is no git");
            return None;
        }
        let repository = Self { folder: TempDir::new().unwrap() };
        std::fs::copy(support::robot("universal_robots/ur5e.urdf"), repository.path("arm.urdf")).unwrap();
        let commit = "git init -q . && git config user.name t && git config user.email t@example.org && git add arm.urdf \
                      && git commit -qm arm";
        assert_eq!(repository.run("sh", commit).code, 0);
        Some(repository)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Runs a script in the repository, with `denavit` on the PATH.
    fn run(&self, shell: &str, script: &str) -> Ran {
        let binary = Path::new(env!("CARGO_BIN_EXE_denavit")).parent().unwrap();
        let path = format!("{}:{}", binary.display(), std::env::var("PATH").unwrap());
        let output = Command::new(shell)
            .args(["-c", script])
            .current_dir(self.folder.path())
            .env("PATH", path)
            .env("GIT_CONFIG_GLOBAL", "/dev/null")
            .env("GIT_PAGER", "cat")
            .output()
            .unwrap();
        let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
        Ran { code: output.status.code().unwrap_or(-1), output: text.concat() }
    }

    /// Moves the elbow by 2 mm.
    fn edit(&self) {
        let text = std::fs::read_to_string(self.path("arm.urdf")).unwrap();
        let at = text.find("<joint name=\"elbow_joint\"").unwrap();
        let origin = at + text[at..].find("xyz=\"").unwrap() + "xyz=\"".len();
        let end = origin + text[origin..].find('"').unwrap();
        let mut numbers: Vec<f64> = text[origin..end].split_whitespace().map(|word| word.parse().unwrap()).collect();
        numbers[0] += 0.002;
        let written: Vec<String> = numbers.iter().map(ToString::to_string).collect();
        std::fs::write(self.path("arm.urdf"), format!("{}{}{}", &text[..origin], written.join(" "), &text[end..]))
            .unwrap();
    }
}

fn page(name: &str) -> String {
    std::fs::read_to_string(support::top().join(name)).unwrap()
}

/// The code blocks of one language in a page.
fn blocks(page: &str, language: &str) -> Vec<String> {
    let start = format!("```{language}\n");
    page.split(&start).skip(1).map(|rest| rest.split("```").next().unwrap_or_default().to_owned()).collect()
}

fn block_with(page: &str, language: &str, words: &str) -> String {
    let found = blocks(page, language).into_iter().find(|block| block.contains(words));
    found.unwrap_or_else(|| panic!("docs/ci.md has no {language} block with {words}"))
}

#[test]
fn a_diff_against_head_names_the_joint_that_was_edited() {
    let Some(repository) = Repository::new() else {
        return;
    };
    let command = "denavit diff git:HEAD:arm.urdf arm.urdf";
    assert!(page("docs/ci.md").contains(command));
    let same = repository.run("sh", command);
    assert_eq!(same.code, 0, "{}", same.output);
    repository.edit();
    let edited = repository.run("sh", command);
    assert_eq!(edited.code, 1, "{}", edited.output);
    assert!(edited.output.contains("joint \"elbow_joint\": axis moved by 2 mm"), "{}", edited.output);
}

/// A repository in which `git diff` is set up as docs/ci.md says; `robot` replaces `arm.urdf`, if given.
fn with_textconv(robot: Option<&Path>) -> Option<Repository> {
    let repository = Repository::new()?;
    let docs = page("docs/ci.md");
    std::fs::write(repository.path(".gitattributes"), block_with(&docs, "gitattributes", "diff=urdf")).unwrap();
    assert_eq!(repository.run("sh", &block_with(&docs, "sh", "textconv")).code, 0);
    if let Some(robot) = robot {
        std::fs::copy(robot, repository.path("arm.urdf")).unwrap();
        assert_eq!(repository.run("sh", "git commit -qam other").code, 0);
    }
    Some(repository)
}

impl Repository {
    /// Replaces a text, which must be in the file.
    fn replace(&self, from: &str, to: &str) {
        let text = std::fs::read_to_string(self.path("arm.urdf")).unwrap();
        assert!(text.contains(from), "{from}");
        std::fs::write(self.path("arm.urdf"), text.replacen(from, to, 1)).unwrap();
    }

    /// The lines that `git diff` shows as changed.
    fn changed(&self) -> Vec<String> {
        let shown = self.run("sh", "git diff -U0");
        assert_eq!(shown.code, 0, "{}", shown.output);
        let lines = shown.output.lines().filter(|line| line.starts_with(['+', '-']) && !line.starts_with("+++"));
        lines.filter(|line| !line.starts_with("---")).map(str::to_owned).collect()
    }
}

#[test]
fn git_diff_shows_every_edit_of_a_robot_with_two_arms() {
    let baxter = support::robot("rethink/baxter.urdf");
    let text = std::fs::read_to_string(&baxter).unwrap();
    let vendor = support::top().join("../shared/vendor/robots");
    let pr2 = if vendor.is_dir() { support::files(&vendor, "urdf") } else { Vec::new() };
    let pr2 = pr2.into_iter().find(|path| path.file_name().is_some_and(|name| name == "pr2.urdf"));
    if pr2.is_none() {
        println!("the PR2 is skipped, because ../shared/vendor is not beside this clone");
    }
    for robot in [Some(PathBuf::from(&baxter)), pr2].into_iter().flatten() {
        let Some(repository) = with_textconv(Some(&robot)) else {
            return;
        };
        // The last moving joint of the file belongs to an arm outside the default chain, or to a hand.
        let text = std::fs::read_to_string(&robot).unwrap();
        let name = if text.contains("r_elbow_flex_joint") { "r_elbow_flex_joint" } else { "right_e1" };
        let at = text.find(&format!("<joint name=\"{name}\"")).unwrap();
        let origin = at + text[at..].find("xyz=\"").unwrap() + "xyz=\"".len();
        let number = &text[origin..origin + text[origin..].find([' ', '"']).unwrap()];
        let moved = number.parse::<f64>().unwrap() + 0.05;
        std::fs::write(
            repository.path("arm.urdf"),
            format!("{}{moved}{}", &text[..origin], &text[origin + number.len()..]),
        )
        .unwrap();
        let changed = repository.changed();
        assert!(changed.iter().any(|line| line.contains("axis turns about")), "{}: {changed:?}", robot.display());
    }
    assert!(text.contains("right_e1"));
}

#[test]
fn git_diff_shows_masses_limits_and_transmissions_and_not_another_spelling() {
    let Some(repository) = with_textconv(None) else {
        return;
    };
    repository.replace("<mass value=\"3.761\"/>", "<mass value=\"37.61\"/>");
    let changed = repository.changed();
    assert!(changed.iter().any(|line| line.starts_with('+') && line.contains("mass 37.61")), "{changed:?}");
    repository.replace("<mass value=\"37.61\"/>", "<mass value=\"3.7610\"/>");
    assert_eq!(repository.changed(), Vec::<String>::new());
    repository.replace(
        "</robot>",
        "<transmission name=\"t\"><joint name=\"elbow_joint\"/><mechanicalReduction>-100</mechanicalReduction></transmission>\n</robot>",
    );
    let changed = repository.changed();
    assert!(changed.iter().any(|line| line == "+  mechanicalReduction: -100"), "{changed:?}");
}

#[test]
fn the_difftool_says_it_in_words() {
    let Some(repository) = Repository::new() else {
        return;
    };
    let docs = page("docs/ci.md");
    assert_eq!(repository.run("sh", &block_with(&docs, "sh", "difftool.denavit.cmd")).code, 0);
    repository.edit();
    let shown = repository.run("sh", &block_with(&docs, "sh", "git difftool --tool"));
    assert!(shown.output.contains("joint \"elbow_joint\": axis moved by 2 mm"), "{}", shown.output);
}

#[test]
fn help_lists_what_is_compared() {
    for command in ["diff", "fingerprint", "describe"] {
        let help = support::denavit(&[command, "--help"]).succeeded();
        for entry in denavit_compare::compared::COMPARED {
            let what = shown(entry.what, Shown::CommandLine);
            assert!(help.replace('\n', " ").contains(&*what) || help.contains(&what[..30]), "{command}: {help}");
        }
    }
}

#[test]
fn unusable_tolerances_and_fingerprints_are_refused() {
    let arm = support::robot("universal_robots/ur5e.urdf");
    for arguments in [
        &["diff", &arm, &arm, "--tolerance-m", "nan"][..],
        &["diff", &arm, &arm, "--tolerance-rad", "-1"],
        &["fingerprint", &arm, "--expect", "abc"],
    ] {
        let run = support::denavit(arguments);
        assert_eq!(run.code, 2, "{arguments:?} {}", run.stderr);
    }
}

#[test]
fn our_own_arm_passes_the_rules_and_one_in_millimetres_does_not_pass_unseen() {
    let arm = support::robot("universal_robots/ur5e.urdf");
    let own = support::denavit(&["check", &arm]);
    assert_eq!(own.code, 0, "{}", own.stdout);
    let text = std::fs::read_to_string(&arm).unwrap();
    let mut robot = denavit_model::urdf::read("ur5e.urdf", &text).unwrap();
    for joint in &mut robot.joints {
        joint.origin.xyz = joint.origin.xyz.map(|x| x * 1000.0);
    }
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("ur5e.urdf");
    std::fs::write(&path, denavit_model::write::urdf(&robot)).unwrap();
    let found = support::denavit(&["check", path.to_str().unwrap()]);
    assert!(found.stdout.contains("warning D016") && found.stdout.contains("is it in mm?"), "{}", found.stdout);
}

#[test]
fn meshes_of_one_unknown_package_are_one_finding() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("r.urdf");
    let mesh = "<visual><geometry><mesh filename=\"package://nowhere/a.stl\"/></geometry></visual>";
    std::fs::write(&path, format!("<robot name=\"r\"><link name=\"a\">{}</link></robot>", mesh.repeat(50))).unwrap();
    let found = support::denavit(&["check", path.to_str().unwrap()]);
    let lines: Vec<&str> = found.stdout.lines().filter(|line| line.contains("D050")).collect();
    assert_eq!(lines.len(), 1, "{}", found.stdout);
    assert!(lines[0].contains("error D050") && lines[0].contains("50 meshes are in package nowhere"), "{}", lines[0]);
}

#[test]
fn git_diff_shows_robots_and_files_that_are_none_as_they_are() {
    let Some(repository) = Repository::new() else {
        return;
    };
    let docs = page("docs/ci.md");
    std::fs::write(repository.path(".gitattributes"), block_with(&docs, "gitattributes", "diff=urdf")).unwrap();
    assert_eq!(repository.run("sh", &block_with(&docs, "sh", "textconv")).code, 0);
    repository.edit();
    let shown = repository.run("sh", "git diff");
    assert_eq!(shown.code, 0, "{}", shown.output);
    assert!(shown.output.lines().any(|line| line.starts_with('+') && !line.starts_with("+++")), "{}", shown.output);
    assert!(!shown.output.contains("<joint"), "{}", shown.output);
    std::fs::write(repository.path("arm.urdf"), "<robot>\n<<<<<<< HEAD\n").unwrap();
    let shown = repository.run("sh", "git diff");
    assert_eq!(shown.code, 0, "{}", shown.output);
    assert!(shown.output.contains("+<<<<<<< HEAD"), "{}", shown.output);
}

#[test]
fn the_pre_commit_hook_refuses_another_motion_and_lets_new_files_pass() {
    let Some(repository) = Repository::new() else {
        return;
    };
    let hooks = page(".pre-commit-hooks.yaml");
    assert!(hooks.contains("entry: hooks/same-motion\n"));
    let hook = || repository.run("bash", support::top().join("hooks/same-motion").to_str().unwrap());
    assert_eq!(hook().code, 0);
    std::fs::copy(repository.path("arm.urdf"), repository.path("new.urdf")).unwrap();
    assert_eq!(repository.run("sh", "git add new.urdf").code, 0);
    assert_eq!(hook().code, 0);
    repository.edit();
    let refused = hook();
    assert_eq!(refused.code, 1, "{}", refused.output);
    assert!(refused.output.contains("elbow_joint"), "{}", refused.output);
}

#[test]
fn the_plain_hook_stops_a_broken_file() {
    let Some(repository) = Repository::new() else {
        return;
    };
    let hook = block_with(&page("docs/ci.md"), "sh", "git diff --cached");
    assert_eq!(repository.run("sh", &hook).code, 0, "nothing is staged");
    std::fs::write(repository.path("arm.urdf"), "<robot name=\"r\"><link name=\"a\"/><link name=\"a\"/></robot>\n")
        .unwrap();
    let stopped = repository.run("sh", &format!("git add arm.urdf\n{hook}"));
    assert_ne!(stopped.code, 0, "{}", stopped.output);
    assert!(stopped.output.contains("arm.urdf:1: error D004"), "{}", stopped.output);
}

/// The action's report, its comment through a simulated `gh`, and the branch that keeps its pictures.
#[test]
fn the_action_reports_comments_once_and_keeps_pictures() {
    let Some(repository) = Repository::new() else {
        return;
    };
    let action = support::top().join("action");
    let report = |out: &str| {
        let ran = repository.run("bash", &format!("{}/report HEAD ../{out}", action.display()));
        assert_eq!(ran.code, 0, "{}", ran.output);
        ran.output
    };
    let out = format!("{}-out", repository.folder.path().file_name().unwrap().to_str().unwrap());
    let made = repository.folder.path().parent().unwrap().join(&out);
    let read = |name: &str| std::fs::read_to_string(made.join(name)).unwrap();
    report(&out);
    assert_eq!(read("result"), "different=0\nfindings=0\n");
    assert!(read("badge.json").contains("findings, no error\""), "{}", read("badge.json"));
    repository.edit();
    let said = report(&out);
    assert!(said.contains("::error file=arm.urdf,line="), "{said}");
    assert_eq!(read("result"), "different=1\nfindings=0\n");
    let comment = read("comment.md");
    assert!(comment.contains("### Robots: 1 of 1 different") && comment.contains("axis moved by 2 mm"), "{comment}");
    assert!(read("pictures/arm.urdf.svg").starts_with("<svg"), "no picture");
    assert!(read("findings.sarif").contains("\"2.1.0\"") && read("diff.json").contains("denavit.diff.robots/1"));
    // A `gh` that has no comment at first, and then the posted one.
    std::fs::create_dir(repository.path("bin")).unwrap();
    let gh = "#!/bin/sh\ncase $* in *--paginate*) cat posted 2>/dev/null || true ;; *POST*) echo 7 > posted; echo POST >> log ;; \
              *comments/7*) echo PATCH >> log ;; esac\n";
    std::fs::write(repository.path("bin/gh"), gh).unwrap();
    let comment = format!(
        "chmod +x bin/gh; PATH=$PWD/bin:$PATH GITHUB_REPOSITORY=o/r; export PATH GITHUB_REPOSITORY; for i in 1 2; do {}/comment \
         ../{out}/comment.md 3 || exit 1; done; cat log",
        action.display()
    );
    let ran = repository.run("bash", &comment);
    assert_eq!((ran.code, ran.output.as_str()), (0, "POST\nPATCH\n"));
    let keep = format!(
        "git init -q --bare origin.git && git remote add origin $PWD/origin.git && {0}/keep ../{out} denavit pull-3 && {0}/keep \
         ../{out} denavit main && git -C origin.git ls-tree -r --name-only denavit && git -C origin.git rev-list --count denavit",
        action.display()
    );
    let ran = repository.run("bash", &keep);
    assert_eq!(
        (ran.code, ran.output.as_str()),
        (0, "main/arm.urdf.svg\nmain/badge.json\npull-3/arm.urdf.svg\npull-3/badge.json\n1\n")
    );
    std::fs::remove_dir_all(made).unwrap();
}

/// `hooks/denavit` downloads a release once, and refuses a changed one.
#[test]
fn the_hook_installs_the_release_of_its_version() {
    let Some(repository) = Repository::new() else {
        return;
    };
    let version = env!("CARGO_PKG_VERSION");
    let target = format!("{}-unknown-linux-musl", std::env::consts::ARCH);
    if std::env::consts::OS != "linux" {
        println!("skipped, because the archive of this test is for Linux");
        return;
    }
    let release = format!(
        "mkdir -p releases/v{version}/denavit-{version}-{target}/bin && cd releases/v{version} && printf '#!/bin/sh\necho \
         released $*\n' > denavit-{version}-{target}/bin/denavit && chmod +x */bin/denavit && tar -czf \
         denavit-{version}-{target}.tar.gz denavit-{version}-{target} && sha256sum *.tar.gz > SHA256SUMS"
    );
    assert_eq!(repository.run("bash", &release).code, 0);
    let hook = support::top().join("hooks/denavit");
    // Without the tests' own denavit on the PATH.
    let run = |cache: &str| {
        repository.run(
            "bash",
            &format!(
                "PATH=/usr/local/bin:/usr/bin:/bin; unset DENAVIT; DENAVIT_CACHE=$PWD/{cache} \
                 DENAVIT_RELEASES=file://$PWD/releases {} check x",
                hook.display()
            ),
        )
    };
    let ran = run("cache");
    assert_eq!((ran.code, ran.output.as_str()), (0, "released check x\n"));
    assert_eq!(repository.run("bash", "mv releases gone").code, 0);
    assert_eq!(run("cache").output, "released check x\n");
    assert_eq!(repository.run("bash", "mv gone releases; echo >> releases/*/*.tar.gz").code, 0);
    let refused = run("cache2");
    assert_eq!(refused.code, 2, "{}", refused.output);
    assert!(refused.output.contains("checksum") && !repository.path(&format!("cache2/{version}")).exists());
    assert_eq!(std::fs::read_dir(repository.path("cache2")).unwrap().count(), 0);
}

#[test]
fn a_pinned_fingerprint_holds_until_an_edit() {
    let Some(repository) = Repository::new() else {
        return;
    };
    let docs = page("docs/ci.md");
    let pin = repository
        .run("sh", &format!("{} > arm.fingerprint", block_with(&docs, "sh", "denavit fingerprint arm").trim()));
    assert_eq!(pin.code, 0, "{}", pin.output);
    let compare = block_with(&docs, "sh", "--expect");
    assert_eq!(repository.run("sh", &compare).code, 0);
    repository.edit();
    assert_eq!(repository.run("sh", &compare).code, 1);
}
