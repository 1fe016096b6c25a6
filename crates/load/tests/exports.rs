//! The export of every file at hand is the same robot as its source, with the same tips and the same table.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a panic is a failure, and what is printed is read")]

use denavit_compare::{Options as Comparing, Verdict, compare};
use denavit_export::urdf;
use denavit_load::{Loaded, NEARLY_PARALLEL, Options, Selection, TableOptions, canonical, from_text, load, same_table};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// What the exports of some files came to.
#[derive(Default)]
struct Count {
    same: usize,
    refused: Vec<String>,
    other_numbers: Vec<String>,
    wrong: Vec<String>,
}

impl Count {
    fn add(&mut self, file: &str, options: &Options) {
        match load(file, options) {
            Ok(opened) => self.add_loaded(file, &opened.robot),
            Err(reason) => self.refused.push(format!("{file}: {reason}")),
        }
    }

    fn add_loaded(&mut self, file: &str, robot: &Loaded) {
        let text = match canonical(robot, file, &urdf::Options::default()) {
            Ok(exported) => exported.value,
            Err(reason) => return self.refused.push(format!("{file}: {reason}")),
        };
        let exported = from_text("exported.urdf", &text, &Options::default()).unwrap().robot;
        let verdict = compare(&robot.subject(file), &exported.subject("exported.urdf"), &Comparing::default());
        match verdict {
            Ok(comparison) if comparison.verdict == Verdict::Same => self.same += 1,
            Ok(comparison) => self.wrong.push(format!("{file}: {:?}", comparison.verdict)),
            Err(reason) => self.wrong.push(format!("{file}: {reason}")),
        }
        let tips = |robot: &Loaded| robot.chains().chains.iter().map(|chain| chain.tip.clone()).collect::<Vec<_>>();
        if tips(robot) != tips(&exported) {
            self.wrong.push(format!("{file}: other tips"));
        }
        let how = TableOptions { convention: None, gauge: None, tolerance: NEARLY_PARALLEL };
        match same_table(robot, &text, &Selection { file, ..Selection::default() }, &how) {
            Ok(true) => {}
            Ok(false) => self.other_numbers.push(file.to_owned()),
            Err(reason) => self.wrong.push(format!("{file}: {reason}")),
        }
    }

    fn summary(&self) -> String {
        let mut text = format!(
            "{} the same, {} refused, {} of other numbers of the same table, {} wrong\n",
            self.same,
            self.refused.len(),
            self.other_numbers.len(),
            self.wrong.len()
        );
        for (what, lines) in
            [("refused", &self.refused), ("other numbers", &self.other_numbers), ("wrong", &self.wrong)]
        {
            for line in lines {
                writeln!(text, "  {what}: {line}").unwrap();
            }
        }
        text
    }
}

fn top() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Every URDF below a folder, sorted; none where the folder is not there, which is said.
fn urdfs(folder: &Path) -> Vec<String> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        println!("skipped, because {} is not there", folder.display());
        return Vec::new();
    };
    let mut found = Vec::new();
    for path in entries.map(|entry| entry.unwrap().path()) {
        if path.is_dir() {
            found.extend(urdfs(&path));
        } else if path.extension().is_some_and(|extension| extension == "urdf") {
            found.push(path.to_str().unwrap().to_owned());
        }
    }
    found.sort();
    found
}

#[test]
fn exports_of_own_robots_are_the_same() {
    let mut count = Count::default();
    for file in urdfs(&top().join("robots")) {
        count.add(&file, &Options::default());
    }
    println!("{}", count.summary());
    assert!(count.wrong.is_empty() && count.other_numbers.is_empty(), "{}", count.summary());
    assert!(count.same >= 15 && count.refused.is_empty(), "{}", count.summary());
}

#[test]
fn exports_of_vendors_robots_are_the_same() {
    let mut count = Count::default();
    let files = urdfs(&top().join("../shared/vendor/robots"));
    for file in &files {
        count.add(file, &Options::default());
    }
    println!("{}", count.summary());
    assert!(count.wrong.is_empty() && count.other_numbers.is_empty(), "{}", count.summary());
    assert!(count.same + count.refused.len() >= files.len(), "{}", count.summary());
}

#[test]
fn exports_of_odd_files_are_the_same_or_refused() {
    let mut count = Count::default();
    for file in urdfs(&top().join("../shared/vendor/quirky")).iter().chain(&urdfs(&top().join("../shared/wild"))) {
        count.add(file, &Options::default());
    }
    println!("{}", count.summary());
    assert!(count.wrong.is_empty() && count.other_numbers.is_empty(), "{}", count.summary());
}

#[test]
fn exports_of_expanded_xacro_are_the_same() {
    let vendor = top().join("../shared/vendor/xacro");
    let mut count = Count::default();
    let more = std::fs::read_dir(vendor.join("more")).into_iter().flatten().map(|entry| entry.unwrap().path());
    let mut folders: Vec<PathBuf> = std::iter::once(vendor.clone()).chain(more).collect();
    folders.sort();
    for folder in folders.iter().filter(|folder| folder.join("cases.csv").is_file()) {
        let cases = std::fs::read_to_string(folder.join("cases.csv")).unwrap();
        for case in cases.lines().skip(1) {
            let mut cells = case.splitn(3, ',').skip(1);
            let file = folder.join("packages").join(cells.next().unwrap());
            let arguments = cells.next().unwrap_or_default().split_whitespace();
            let arguments = arguments.filter_map(|argument| argument.split_once(":="));
            let options = Options {
                arguments: arguments.map(|(name, value)| (name.to_owned(), value.to_owned())).collect(),
                package_path: vec![folder.join("packages"), vendor.join("packages")],
                ..Options::default()
            };
            count.add(file.to_str().unwrap(), &options);
        }
    }
    if count.same == 0 {
        println!("skipped, because {} is not there", vendor.display());
    }
    println!("{}", count.summary());
    assert!(count.wrong.is_empty() && count.other_numbers.is_empty(), "{}", count.summary());
}
