//! What a release is packed into, made of the program that is tested: it runs from where it is unpacked.

use super::Trial;
use crate::support::{robot, top};
use std::path::Path;
use std::process::{Command, Output};

fn script(folder: &Path, words: &str) -> Output {
    let mut command = Command::new("bash");
    command
        .args(["-c", words])
        .current_dir(folder)
        .env("TOP", top())
        .env("DENAVIT_BUILT", env!("CARGO_BIN_EXE_denavit"));
    command.env("SOURCE_DATE_EPOCH", "1772323200").env("GIT_CONFIG_GLOBAL", "/dev/null").output().unwrap()
}

fn succeeded(folder: &Path, words: &str) -> String {
    let output = script(folder, words);
    assert!(output.status.success(), "{words}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn is_there(program: &str) -> bool {
    let found = Command::new(program).arg("--version").output().is_ok();
    if !found {
        println!("skipped, because there is no {program}");
    }
    found
}

/// The program without its debug information, as a release has it.
fn built(trial: &Trial) -> String {
    let stripped = script(trial.folder(), "strip -o built $DENAVIT_BUILT");
    let program = if stripped.status.success() { trial.path("built") } else { env!("CARGO_BIN_EXE_denavit").into() };
    program.to_str().unwrap().to_owned()
}

/// The README's table, printed by a program that was unpacked.
fn prints_the_table(folder: &Path, program: &str) {
    let table = succeeded(folder, &format!("{program} table {}", robot("universal_robots/ur5e.urdf")));
    assert!(table.starts_with("ur5e   base → tool0   6R\n") && table.contains("-0.3922"), "{table}");
}

#[test]
fn the_archive_has_the_program_its_pages_and_its_completions() {
    if !is_there("tar") || !is_there("git") {
        return;
    }
    let trial = Trial::new();
    let name = concat!("denavit-", env!("CARGO_PKG_VERSION"), "-x86_64-unknown-linux-gnu");
    let pack = format!("$TOP/release/pack {} x86_64-unknown-linux-gnu out", built(&trial));
    assert_eq!(succeeded(trial.folder(), &pack).trim(), format!("out/{name}.tar.gz"));
    let listed = succeeded(trial.folder(), &format!("tar -tzf out/{name}.tar.gz && tar -xzf out/{name}.tar.gz"));
    for file in [
        "bin/denavit",
        "share/man/man1/denavit-table.1",
        "share/bash-completion/completions/denavit",
        "share/zsh/site-functions/_denavit",
        "share/fish/vendor_completions.d/denavit.fish",
        "share/doc/denavit/LICENSE-MIT",
    ] {
        assert!(listed.lines().any(|line| line == format!("{name}/{file}")), "{file}: {listed}");
    }
    prints_the_table(trial.folder(), &format!("{name}/bin/denavit"));
    // Where cargo binstall and hooks/denavit look for it.
    let manifest = std::fs::read_to_string(top().join("crates/cli/Cargo.toml")).unwrap();
    assert!(manifest.contains("/v{ version }/denavit-{ version }-{ target }.tar.gz\""));
    assert!(manifest.contains("bin-dir = \"denavit-{ version }-{ target }/bin/{ bin }{ binary-ext }\""));
}

#[test]
fn the_debian_package_runs_from_an_empty_root() {
    if !is_there("dpkg-deb") || !is_there("git") {
        return;
    }
    let trial = Trial::new();
    let made = succeeded(trial.folder(), &format!("DEB_COMPRESSION=1 $TOP/release/deb {} amd64 out", built(&trial)));
    let control = succeeded(trial.folder(), &format!("dpkg-deb --field {0} && dpkg-deb -x {0} root", made.trim()));
    assert!(control.contains("Package: denavit\n") && control.contains("Depends: libc6 (>= 2."), "{control}");
    // With nothing of this machine but the kernel and its C library.
    prints_the_table(trial.folder(), "env -i root/usr/bin/denavit");
    let listed = succeeded(trial.folder(), "cd root && find . -type f");
    assert!(
        listed.contains("./usr/share/man/man1/denavit-diff.1.gz")
            && listed.contains("./usr/share/doc/denavit/copyright")
    );
}

#[test]
fn a_release_is_prepared_by_one_command() {
    if !is_there("git") {
        return;
    }
    let trial = Trial::new();
    let top = top();
    let clone = "git init -q r && cd r && git config user.name t && git config user.email t@example.org && mkdir -p crates && \
                 cp -r $TOP/release $TOP/Cargo.toml $TOP/Cargo.lock $TOP/CHANGELOG.md . && mkdir docs examples ci && \
                 cp $TOP/docs/ci.md docs/ && cp $TOP/examples/github-action.yml examples/ && cp $TOP/ci/gitlab.yml ci/ && \
                 git add . && git commit -qm all && mkdir bin && printf '#!/bin/sh\\necho $* >> cargo.log\\n' > bin/cargo && chmod +x \
                 bin/cargo && printf 'bin\\ncargo.log\\n' > .git/info/exclude";
    succeeded(trial.folder(), clone);
    let folder = trial.path("r");
    let prepare = |version: &str| script(&folder, &format!("PATH=$PWD/bin:$PATH release/prepare {version}"));
    for (version, said) in [("next", "write a version"), ("0.0.9", "0.0.9 is before 0.1.0")] {
        let output = prepare(version);
        assert_eq!(output.status.code(), Some(2));
        assert!(String::from_utf8_lossy(&output.stderr).contains(said));
    }
    let output = prepare("0.2.0");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    let manifest = read("Cargo.toml");
    let own: Vec<&str> = manifest.lines().filter(|line| line.starts_with("denavit")).collect();
    assert!(own.len() > 10 && own.iter().all(|line| line.contains("version = \"0.2.0\"")), "{own:?}");
    assert!(manifest.contains("\nversion = \"0.2.0\"\n") && !manifest.contains("\"0.1.0\""));
    assert!(read("CHANGELOG.md").contains("## Unreleased\n\n## 0.2.0 - 2026-03-01\n"));
    for file in ["docs/ci.md", "examples/github-action.yml", "ci/gitlab.yml"] {
        assert!(read(file).contains("v0.2.0") && !read(file).contains("v0.1.0"), "{file}");
    }
    assert_eq!(read("cargo.log"), "update --quiet --offline --workspace\n");
    assert_eq!(prepare("0.3.0").status.code(), Some(2), "the working tree has changes");
    assert!(top.join("release/prepare").is_file());
}
