//! `denavit diff --robots`: every robot of a repository, as it was and as it is.

use crate::args::DiffArguments;
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::{self, OutputFolder, Status};
use crate::source;
use denavit_compare::report::Report;
use denavit_compare::robots::{Member, Robots, State};
use denavit_compare::{Comparison, Options, Verdict, compare};
use denavit_export::Units;
use denavit_export::drawing::{self, Detail, View};
use denavit_load::{Described, Loaded, NEARLY_PARALLEL, Opened, Pair, Selection, TableOptions};
use std::path::Path;

/// Runs the command.
pub fn run(arguments: &DiffArguments, options: &Options) -> Result<Status, Failure> {
    if let Some(value) = arguments.source.values.first().or(arguments.b.as_ref().filter(|b| b.contains(":="))) {
        return Err(Failure::Argument(format!(
            "--robots: the argument {value} belongs to one robot; write it into denavit.toml: [robots.NAME] arguments = {{ … }}"
        )));
    }
    let (before, after) = (revision(&arguments.a)?, arguments.b.as_deref().map(revision).transpose()?);
    let delivery = Delivery::of(arguments.output.as_deref(), &arguments.json, arguments.source.files())?;
    let folder = arguments.pictures.as_deref().map(OutputFolder::of).transpose()?;
    let pairs = denavit_load::pairs(before, after, &source::options(&arguments.source)?)?;
    if pairs.robots.is_empty() {
        return Err(Failure::Argument(format!(
            "--robots {}: this repository has no robot, neither then nor now; name its robots in denavit.toml",
            arguments.a
        )));
    }
    let mut work = Work { options, pictures: arguments.pictures.as_deref(), files: Vec::new(), left_out: Vec::new() };
    let members = pairs.robots.iter().map(|pair| work.member(pair, pairs.are_named));
    let members = members.collect::<Result<Vec<_>, Failure>>()?.into_iter().flatten().collect();
    let robots = Robots {
        before: arguments.a.clone(),
        after: arguments.b.clone().unwrap_or_else(|| "working tree".into()),
        members,
        left_out: work.left_out,
    };
    if let Some(folder) = folder.filter(|_| !work.files.is_empty()) {
        folder.write(&work.files, [])?;
    }
    delivery.report(&arguments.format, &Report::Robots(&robots))?;
    let counts = robots.count();
    Ok(match (counts.unreadable, counts.different) {
        (0, 0) => Status::Same,
        (0, _) => Status::Different,
        _ => Status::Error,
    })
}

fn revision(word: &str) -> Result<&str, Failure> {
    let revision = word.strip_prefix("git:").filter(|revision| !revision.is_empty() && !revision.contains(':'));
    revision.ok_or_else(|| {
        Failure::Argument(format!("--robots: \"{word}\" is not a revision; write git:REVISION, such as git:main"))
    })
}

/// The work over all robots.
struct Work<'a> {
    options: &'a Options,
    pictures: Option<&'a Path>,
    /// Pictures, by name and text.
    files: Vec<(String, String)>,
    left_out: Vec<String>,
}

impl Work<'_> {
    /// What became of a robot; `None` of a part of others.
    fn member(&mut self, pair: &Pair, is_named: bool) -> Result<Option<Member>, Failure> {
        let Some(described) = pair.after.as_ref().or(pair.before.as_ref()) else { return Ok(None) };
        let file_before = pair.before.as_ref().map(|before| before.path.clone());
        let member = |state| Member {
            name: pair.name.clone(),
            file: described.path.clone(),
            file_before: file_before.filter(|before| *before != described.path),
            state,
        };
        if !pair.is_touched {
            return Ok(Some(member(State::Untouched)));
        }
        let (before, after) = (pair.before.as_ref().map(load), pair.after.as_ref().map(load));
        let state = match (before, after) {
            (Some(Ok(a)), Some(Ok(b))) => self.compared(pair, &a, &b)?,
            (None | Some(Err(_)), Some(Ok(_))) => State::New,
            (Some(Ok(_)), None) => State::Removed,
            (before, Some(Err(_))) if !is_named && before.as_ref().is_none_or(Result::is_err) && is_part(described) => {
                self.left_out.push(described.path.clone());
                return Ok(None);
            }
            (before, Some(Err(failure))) => {
                State::Unreadable { why: failure.to_string(), counts: !matches!(before, Some(Err(_))) }
            }
            // It was no robot, and is gone.
            (_, None) => return Ok(None),
        };
        Ok(Some(member(state)))
    }

    fn compared(&mut self, pair: &Pair, a: &Loaded, b: &Loaded) -> Result<State, Failure> {
        let (Some(before), Some(after)) = (&pair.before, &pair.after) else { return Ok(State::New) };
        let comparison = compare(&a.subject(&before.source), &b.subject(&after.source), self.options)?;
        let picture = match self.pictures {
            Some(folder) if comparison.verdict == Verdict::Different => {
                match self.picture((before, a), (after, b), &comparison) {
                    Ok(None) => None,
                    Ok(Some(text)) => {
                        let name = self.unused_name(&pair.name);
                        let path = folder.join(&name).to_string_lossy().replace('\\', "/");
                        self.files.push((name, text));
                        Some(path)
                    }
                    Err(failure) => {
                        output::mention(format!("{}: no picture: {failure}", pair.name));
                        None
                    }
                }
            }
            _ => None,
        };
        Ok(State::Compared { comparison: Box::new(comparison), picture })
    }

    /// Both skeletons, at zero of every joint, to the tip that moved farthest; `None` where they are the same.
    fn picture(
        &self,
        a: (&Described, &Loaded),
        b: (&Described, &Loaded),
        comparison: &Comparison,
    ) -> Result<Option<String>, Failure> {
        let farthest = comparison.largest().filter(|tip| tip.sampled_m > comparison.tolerance_m);
        let farthest = farthest.map(|tip| tip.tip.as_str());
        let drawn = |(described, loaded): (&Described, &Loaded)| {
            let selection = Selection {
                file: &described.source,
                base: described.base.as_deref(),
                tip: described.tip.as_deref().or(farthest),
                reading: self.options.reading,
            };
            // A link that moved may have another name on this side: then the longest chain.
            let options = TableOptions { convention: None, gauge: None, tolerance: NEARLY_PARALLEL };
            let longest = || loaded.table(&Selection { base: None, tip: None, ..selection }, &options);
            let made = loaded.table(&selection, &options).or_else(|_| longest())?;
            let table = made.table.value;
            Ok::<String, Failure>(drawing::skeleton(&table, View::Isometric, Detail::Dimensioned, Units::default()))
        };
        let (before, after) = (drawn(a)?, drawn(b)?);
        Ok((before != after).then(|| drawing::side_by_side(&[("before", &before), ("after", &after)])))
    }

    /// A file's name for a robot's picture.
    fn unused_name(&self, robot: &str) -> String {
        let plain = |c: char| if c.is_ascii_alphanumeric() || "._-".contains(c) { c } else { '-' };
        let stem: String = robot.chars().map(plain).collect();
        let taken = |name: &String| self.files.iter().any(|(known, _)| known.eq_ignore_ascii_case(name));
        let numbered = (2..).map(|number| format!("{stem}-{number}.svg"));
        std::iter::once(format!("{stem}.svg")).chain(numbered).find(|name| !taken(name)).unwrap_or(stem)
    }
}

fn load(described: &Described) -> Result<Loaded, Failure> {
    let Opened { robot, notes, includes, .. } = denavit_load::load(&described.source, &described.options)?;
    output::reads(&includes)?;
    for note in notes {
        output::mention(format!("{}: {note}", described.source));
    }
    Ok(robot)
}

/// Whether a file is a xacro file that is no robot by itself, as far as that can be seen.
fn is_part(described: &Described) -> bool {
    described.path.to_ascii_lowercase().ends_with(".xacro")
        && source::read_text(&described.source)
            .is_ok_and(|(file, text)| denavit_load::why_a_part(&file, &text, &described.options).is_some())
}
