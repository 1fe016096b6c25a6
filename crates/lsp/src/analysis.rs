//! Analysis of a text: its robot, the origin of each part, and all problems.

use crate::names::Language;
use crate::session::Files;
use crate::settings::Settings;
use denavit_compare::lint::{self, srdf};
use denavit_compare::report::Level;
use denavit_load::{LoadError, Rules, UrdfText};
use denavit_model::{Place, Robot};
use denavit_xacro::{ErrorKind, Frame, Trace, XacroError, is_xacro};
use std::collections::HashMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Bytes of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Spot {
    pub file: PathBuf,
    pub range: Range<usize>,
}

/// Something that is wrong with a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Problem {
    pub at: Spot,
    pub level: Level,
    /// The rule's code.
    pub code: Option<&'static str>,
    pub message: String,
    /// The path to it: places and their descriptions.
    pub related: Vec<(Spot, String)>,
    /// Edits of the file at `at` that certainly fix it.
    pub fix: Vec<(Range<usize>, String)>,
}

/// The analysis of a file with everything that it includes.
#[derive(Debug)]
pub(crate) struct Analysis {
    pub file: PathBuf,
    /// The URDF that the file is or expands to.
    pub urdf: String,
    /// The origin of its parts, for a xacro file.
    pub trace: Option<Traced>,
    pub robot: Option<Robot>,
    /// The file and what it includes.
    pub files: Vec<PathBuf>,
    pub problems: Vec<Problem>,
    /// Whether it is part of other robots and not a robot itself.
    pub is_part: bool,
    /// Whether the root element has a name, as that of a robot has.
    pub is_named: bool,
}

/// A trace whose files have their real names.
#[derive(Debug)]
pub(crate) struct Traced {
    pub trace: Trace,
    pub files: Vec<PathBuf>,
    /// Elements by their first line in the result, from 1.
    by_line: HashMap<usize, usize>,
}

impl Traced {
    fn new(trace: Trace, urdf: &str) -> Self {
        let files = trace.files.iter().map(|file| real(file)).collect();
        let mut by_line = HashMap::new();
        let (mut line, mut at) = (1, 0);
        for (index, element) in trace.elements.iter().enumerate() {
            line += urdf[at..element.at].matches('\n').count();
            at = element.at;
            by_line.entry(line).or_insert(index);
        }
        Self { trace, files, by_line }
    }

    fn index(&self, file: &Path) -> Option<usize> {
        self.files.iter().position(|known| known == file)
    }

    /// The evaluated values of an attribute, each once.
    pub fn values_of<'u>(&self, urdf: &'u str, at: &Spot) -> Vec<&'u str> {
        let Some(file) = self.index(&at.file) else { return Vec::new() };
        let mut values: Vec<&str> = Vec::new();
        for element in self.trace.elements.iter().filter(|element| element.name.file == file) {
            for attribute in element.attributes.iter().filter(|attribute| attribute.source == at.range) {
                let value = &urdf[attribute.at.clone()];
                if !values.contains(&value) {
                    values.push(value);
                }
            }
        }
        values
    }

    /// The evaluated values of the expression or substitution around a byte, with its bytes; each value once.
    pub fn evaluated(&self, file: &Path, at: usize) -> Option<(Range<usize>, Vec<&str>)> {
        let file = self.index(file)?;
        let around = |range: &Range<usize>| range.start <= at && at <= range.end;
        let found = self.trace.values.iter().filter(|value| value.span.file == file && around(&value.span.range));
        let range = found.clone().min_by_key(|value| value.span.range.len())?.span.range.clone();
        let mut values: Vec<&str> = Vec::new();
        for value in found.filter(|value| value.span.range == range) {
            if !values.contains(&value.value.as_str()) {
                values.push(&value.value);
            }
        }
        Some((range, values))
    }

    /// Where the source writes the value of an attribute of the result.
    pub fn source_of(&self, at: &Range<usize>) -> Option<Spot> {
        let next = self.trace.elements.partition_point(|element| element.at <= at.start);
        let element = self.trace.elements.get(next.checked_sub(1)?)?;
        let attribute = element.attributes.iter().find(|attribute| attribute.at == *at)?;
        Some(Spot { file: self.files[element.name.file].clone(), range: attribute.source.clone() })
    }
}

/// The canonical path of a file; its given path if that fails.
pub(crate) fn real(file: &Path) -> PathBuf {
    file.canonicalize().or_else(|_| std::path::absolute(file)).unwrap_or_else(|_| file.to_path_buf())
}

/// Candidate robots for an SRDF.
pub(crate) type Robots<'a> = dyn FnMut(&str) -> Vec<Rc<Analysis>> + 'a;

/// Analyses a file. `robots` returns those with a name, for an SRDF.
pub(crate) fn analyse(files: &Files, path: &Path, settings: &Settings, robots: &mut Robots) -> Analysis {
    let mut made = Analysis {
        file: path.to_path_buf(),
        urdf: String::new(),
        trace: None,
        robot: None,
        files: vec![path.to_path_buf()],
        problems: Vec::new(),
        is_part: false,
        is_named: true,
    };
    let Some(text) = files.text(path) else { return made };
    if let Some(root) = files.markup(path).as_ref().and_then(|markup| markup.tags.first()) {
        made.is_named = root.attribute(&text.text, "name").is_some();
    }
    let name = path.to_string_lossy().into_owned();
    let options = settings.options(path);
    let work = Work { files, name: &name };
    // Text before the first element would make it a table of numbers, which an editor does not open.
    let before = text.text.len() - text.text.trim_start_matches(|c: char| c.is_whitespace() || c == '\u{feff}').len();
    if !text.text[before..].starts_with('<') {
        let end = text.text.find('<').unwrap_or(text.text.len());
        let message = "the file does not begin with an element; remove what precedes it";
        made.problems.push(work.problem(before..end, Level::Error, message));
        return made;
    }
    let outcome = files.over_the_disk(|| {
        if is_xacro(&text.text) && (name.to_ascii_lowercase().ends_with(".xacro") || has_xacro_elements(&text.text)) {
            let expanded = denavit_load::expanded_with_trace(&name, &text.text, &options)?;
            made.files.extend(expanded.files_read.iter().map(|file| real(file)).filter(|file| file != path));
            made.problems.extend(expanded.notes.iter().map(|note| work.note(note)));
            made.urdf = expanded.urdf;
            made.trace = expanded.trace.map(|trace| Traced::new(trace, &made.urdf));
            return Ok(());
        }
        let written = denavit_export::urdf::Options::default();
        let UrdfText { text, includes, .. } = denavit_load::urdf_text(&name, text.text.clone(), &options, &written)?;
        made.urdf = text;
        made.files.extend(includes.iter().map(|file| real(file)).filter(|file| file != path));
        Ok(())
    });
    if let Err(error) = outcome {
        work.refused(&mut made, &error);
        return made;
    }
    let rules = match files.over_the_disk(|| Rules::of(&name, &settings.check())) {
        Ok(rules) => rules,
        Err(error) => {
            made.problems.push(work.problem(0..0, Level::Warning, error.to_string()));
            return made;
        }
    };
    let findings = if Language::of(path, &text.text) == Language::Srdf || srdf::is_srdf(&name, &made.urdf) {
        let own = srdf::robot_of(&made.urdf).unwrap_or_default();
        let known = robots(&own);
        let checked =
            known.iter().filter_map(|known| Some(rules.check_srdf(&name, &made.urdf, known.robot.as_ref()?).0));
        let Some(findings) = checked.min_by_key(Vec::len) else {
            if let Some(problem) = roxmltree_error(&work, &made.urdf) {
                return Analysis { problems: vec![problem], ..made };
            }
            let message =
                format!("no robot \"{own}\" was found near this file, so its names are not checked; open its URDF");
            made.problems.push(work.problem(work.root_name(), Level::Note, message));
            return made;
        };
        findings
    } else {
        let (findings, robot) = files.over_the_disk(|| rules.check_and_read(&name, &made.urdf));
        made.robot = robot;
        findings
    };
    made.is_part =
        made.robot.is_none() && made.trace.is_some() && findings.iter().all(|finding| finding.rule == "D001");
    if made.is_part {
        return made;
    }
    let problems: Vec<Problem> = findings.into_iter().map(|finding| work.finding(&made, finding)).collect();
    made.problems.extend(problems);
    made
}

fn has_xacro_elements(text: &str) -> bool {
    text.contains("<xacro:") && denavit_model::urdf::read("", text).is_err()
}

fn roxmltree_error(work: &Work, text: &str) -> Option<Problem> {
    let robot = denavit_model::urdf::read(work.name, "<robot name=\"\"><link name=\"a\"/></robot>").ok()?;
    let (findings, _) = srdf::check(work.name, text, &robot, &lint::Config::default());
    let finding = findings.into_iter().find(|finding| finding.rule == "D001")?;
    let spot = work.line(Path::new(work.name), finding.place.line);
    Some(Problem { at: spot, ..work.problem(0..0, finding.level, finding.message) })
}

struct Work<'a> {
    files: &'a Files,
    name: &'a str,
}

impl Work<'_> {
    fn problem(&self, range: Range<usize>, level: Level, message: impl Into<String>) -> Problem {
        let at = Spot { file: PathBuf::from(self.name), range };
        Problem { at, level, code: None, message: message.into(), related: Vec::new(), fix: Vec::new() }
    }

    /// The name of the root element.
    fn root_name(&self) -> Range<usize> {
        let markup = self.files.markup(Path::new(self.name));
        markup.and_then(|markup| Some(markup.tags.first()?.name.clone())).unwrap_or(0..0)
    }

    /// A line (from 1) of a file.
    fn line(&self, file: &Path, line: usize) -> Spot {
        let range = self.files.text(file).map_or(0..0, |text| text.words_of_line(line.saturating_sub(1)));
        Spot { file: file.to_path_buf(), range }
    }

    /// A place of the expansion: that many characters from there.
    fn place(&self, place: &denavit_xacro::Place, characters: usize) -> Spot {
        let file = real(&place.file);
        let Some(text) = self.files.text(&file) else { return Spot { file, range: 0..0 } };
        let start = text.at_column(place.line, place.column);
        let inside = text.text[start..].char_indices().nth(characters);
        let end = inside.map_or(text.text.len(), |(at, _)| start + at);
        Spot { file, range: start..end }
    }

    /// The name at a place.
    fn name_at(&self, place: &denavit_xacro::Place) -> Spot {
        let spot = self.place(place, 1);
        let found = self.files.markup(&spot.file).and_then(|markup| {
            let tag = markup.named_at(spot.range.start)?;
            Some(markup.tags[tag].name.clone())
        });
        Spot { range: found.unwrap_or(spot.range.clone()), ..spot }
    }

    fn note(&self, note: &denavit_xacro::Note) -> Problem {
        let at = note.place.as_ref().map(|place| self.name_at(place));
        let problem = self.problem(self.root_name(), Level::Note, note.message.clone());
        Problem { at: at.unwrap_or_else(|| problem.at.clone()), ..problem }
    }

    fn refused(&self, made: &mut Analysis, error: &LoadError) {
        match error {
            LoadError::Xacro(error) => {
                use ErrorKind::{UndefinedArgument, UndefinedMacro, UndefinedName};
                made.is_part = matches!(error.kind, UndefinedName | UndefinedMacro | UndefinedArgument);
                let problem = self.xacro(error);
                // Where the error is, an editor must know whose it is.
                made.files.push(problem.at.file.clone());
                made.files.dedup();
                made.problems.push(problem);
            }
            LoadError::Format(error) => {
                for (place, what) in &error.problems {
                    let file =
                        if place.file == self.name { PathBuf::from(self.name) } else { real(Path::new(&place.file)) };
                    let at = self.line(&file, place.line);
                    made.problems
                        .push(Problem { at, ..self.problem(0..0, Level::Error, format!("{}: {what}", place.element)) });
                }
            }
            other => made.problems.push(self.problem(self.root_name(), Level::Error, other.to_string())),
        }
    }

    fn xacro(&self, error: &XacroError) -> Problem {
        let mut message = error.message.clone();
        if let Some(help) = &error.help {
            message.push_str("; ");
            message.push_str(help);
        }
        if let Some(expression) = &error.expression {
            message.push_str(" (in the expression ");
            message.push_str(expression);
            message.push(')');
        }
        let covered = error.line.as_ref().map_or(1, |(_, covered)| *covered);
        let at = error.place.as_ref().map(|place| self.place(place, covered));
        let related = error.stack.iter().flat_map(|frame| self.frame(frame)).collect();
        let problem = self.problem(self.root_name(), Level::Error, message);
        Problem { at: at.unwrap_or_else(|| problem.at.clone()), related, ..problem }
    }

    fn frame(&self, frame: &Frame) -> Vec<(Spot, String)> {
        match frame {
            Frame::Macro { name, called, .. } => {
                vec![(self.name_at(called), format!("macro \"{name}\" is called here"))]
            }
            Frame::Include { file, at } => {
                let file = file.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
                vec![(self.name_at(at), format!("{file} is included here"))]
            }
            Frame::Property { name, used } => {
                vec![(self.place(used, name.chars().count()), format!("property \"{name}\" is used here"))]
            }
            _ => Vec::new(),
        }
    }

    fn finding(&self, made: &Analysis, finding: lint::Finding) -> Problem {
        let Place { file, line, element } = &finding.place;
        let message = format!("{element}: {}", finding.message);
        let problem = Problem { code: Some(finding.rule), ..self.problem(0..0, finding.level, message) };
        let Some(traced) = &made.trace else {
            let file = if file == self.name { PathBuf::from(self.name) } else { real(Path::new(file)) };
            // What is fixed in text of another format would be fixed in the translation.
            let is_own = self.files.text(&file).is_some_and(|text| text.text == made.urdf);
            let edits = finding.fix.into_iter().filter(|_| is_own);
            let fix: Vec<(Range<usize>, String)> = edits.map(|edit| (edit.start..edit.end, edit.text)).collect();
            let first = fix.iter().map(|(range, _)| range).find(|range| !range.is_empty()).cloned();
            let on_line = self.line(&file, *line);
            let at = match first {
                Some(range) => Spot { file, range },
                None => on_line,
            };
            return Problem { at, fix, ..problem };
        };
        let Some(&element) = traced.by_line.get(line) else {
            return Problem { at: Spot { file: PathBuf::from(self.name), range: self.root_name() }, ..problem };
        };
        let element = &traced.trace.elements[element];
        let file = traced.files[element.name.file].clone();
        let at = Spot { range: self.start_tag(&file, element.name.range.start), file };
        let calls = traced.trace.calls_of(element);
        let related = calls.into_iter().flat_map(|frame| self.frame(frame)).collect();
        // Only where the source has the very text can the fix be made there.
        let fix = finding.fix.iter().map(|edit| {
            let last = traced.trace.elements.partition_point(|element| element.at <= edit.start).checked_sub(1)?;
            let element = &traced.trace.elements[last];
            let inside = |at: &Range<usize>| at.start <= edit.start && edit.end <= at.end;
            let attribute = element.attributes.iter().find(|attribute| inside(&attribute.at))?;
            let file = &traced.files[element.name.file];
            let source = self.files.text(file)?;
            let same = source.text.get(attribute.source.clone())? == &made.urdf[attribute.at.clone()];
            let start = attribute.source.start + edit.start - attribute.at.start;
            (same && *file == at.file).then(|| (start..start + edit.end - edit.start, edit.text.clone()))
        });
        let fix: Option<Vec<_>> = fix.collect();
        Problem { at, related, fix: fix.unwrap_or_default(), ..problem }
    }

    /// The start tag whose name begins at a byte, to the end of its first line.
    fn start_tag(&self, file: &Path, at: usize) -> Range<usize> {
        let found = || {
            let (text, markup) = (self.files.text(file)?, self.files.markup(file)?);
            let tag = &markup.tags[markup.named_at(at)?];
            let end = text.line(text.line_of(tag.start.start)).end;
            Some(tag.start.start..tag.start.end.min(end))
        };
        found().unwrap_or(at..at)
    }
}
