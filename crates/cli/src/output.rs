//! Printing, colours and exit codes, and outputs that are never half-written.

#![expect(clippy::print_stderr, reason = "this module is where the program speaks")]

mod destination;
mod notes;
mod staged;
mod wrapped;

use crate::failure::Failure;
use denavit_compare::report::Colour;
use denavit_load::LoadError;
use denavit_model::notes::Note;
use denavit_model::settings::{Shown, shown};
use denavit_model::words::readable;
use destination::Destination;
use staged::Staged;
use std::borrow::Cow;
use std::io::{self, IsTerminal as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use terminal_size::{Height, Width};

/// Exit codes, as those of `diff`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Status {
    /// Done; the same; nothing found.
    Same = 0,
    /// Different; something found.
    Different = 1,
    /// The work could not be done.
    Error = 2,
}

/// A message with its settings as the flags that they are here.
fn with_flags(text: &str) -> Cow<'_, str> {
    shown(text, Shown::CommandLine)
}

/// Writes text to standard output.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    out.write_all(with_flags(text).as_bytes()).and_then(|()| out.flush()).map_err(|error| match error.kind() {
        io::ErrorKind::BrokenPipe => Failure::ClosedPipe,
        _ => Failure::Write { file: "standard output".into(), reason: error.to_string() },
    })
}

/// Writes sentences to standard output, as wide as the terminal where that is one.
pub fn print_sentences(text: &str) -> Result<(), Failure> {
    print(&fitted(text))
}

/// Sentences for standard output: as wide as the terminal where that is one.
pub fn fitted(text: &str) -> Cow<'_, str> {
    as_wide_as(if io::stdout().is_terminal() { terminal_size::terminal_size() } else { None }, text)
}

fn as_wide_as(terminal: Option<(Width, Height)>, text: &str) -> Cow<'_, str> {
    match terminal {
        Some((Width(width), _)) => wrapped::wrapped(text, usize::from(width)).into(),
        None => text.into(),
    }
}

/// Says what went wrong.
pub fn complain(failure: &Failure) {
    tell_notes(false);
    let text = failure.to_string();
    let text = with_flags(&text);
    let each_line = matches!(failure, Failure::Load(LoadError::Urdf(_) | LoadError::Format(_)));
    for (index, line) in readable(&text).lines().enumerate() {
        // A URDF's problems stand a line each; other messages continue in their own lines.
        let mark = if each_line || index == 0 { "error: " } else { "" };
        eprintln!("{mark}{line}");
    }
}

/// Prints on standard error the notes that do not belong to the output on standard output.
pub fn remark(notes: &[Note]) {
    notes.iter().for_each(mention);
}

/// Prints a note on standard error: not an error, but perhaps not intended.
pub fn mention(text: impl std::fmt::Display) {
    let note = text.to_string();
    match GATHERED.lock().unwrap_or_else(PoisonError::into_inner).as_mut() {
        Some(notes) => notes.push(note),
        None => print_note(&note),
    }
}

/// Notes of a command that prints them at its end; `None` if each is printed at once.
static GATHERED: Mutex<Option<Vec<String>>> = Mutex::new(None);

/// From here on notes wait for [`tell_notes`].
pub fn gather_notes() {
    *GATHERED.lock().unwrap_or_else(PoisonError::into_inner) = Some(Vec::new());
}

/// Tells the notes that wait: all, or one of each kind and ten lines at most.
pub fn tell_notes(all: bool) {
    let Some(notes) = GATHERED.lock().unwrap_or_else(PoisonError::into_inner).take() else { return };
    let lines = if all { notes::once(notes) } else { notes::grouped(notes, "--verbose") };
    for line in &lines {
        print_note(line);
    }
}

fn print_note(note: &str) {
    let line = format!("note: {}", readable(&with_flags(note)));
    let terminal = if io::stderr().is_terminal() { terminal_size::terminal_size_of(io::stderr()) } else { None };
    eprintln!("{}", as_wide_as(terminal, &line));
}

/// Whether text on standard output is coloured: on a terminal, unless `NO_COLOR` is set.
pub fn colour(to_standard_output: bool) -> Colour {
    let plain = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    if to_standard_output && !plain && io::stdout().is_terminal() { Colour::Ansi } else { Colour::None }
}

/// Files that this process reads although its command line does not name them, and files that it will write. Whichever becomes
/// known second is compared with the other.
struct Run {
    read: Vec<PathBuf>,
    places: Vec<Place>,
}

static RUN: Mutex<Run> = Mutex::new(Run { read: Vec::new(), places: Vec::new() });

/// Records files that a source includes, as xacro files do; an error if an output would replace one.
pub fn reads(files: &[PathBuf]) -> Result<(), Failure> {
    let mut run = RUN.lock().unwrap_or_else(PoisonError::into_inner);
    for place in &run.places {
        place.spares(files)?;
    }
    run.read.extend_from_slice(files);
    Ok(())
}

/// What a run writes: every place is checked before the work, and all are written together after it.
#[derive(Debug, Default)]
pub struct Outputs {
    inputs: Vec<String>,
    places: Vec<Place>,
    /// Files that are fixed in place are inputs, too.
    in_place: bool,
}

#[derive(Debug, Clone)]
struct Place {
    option: &'static str,
    given: PathBuf,
    destination: Destination,
}

impl Place {
    /// Refuses to replace one of these files.
    fn spares(&self, read: &[PathBuf]) -> Result<(), Failure> {
        match read.iter().find(|file| self.destination.is_input(&file.to_string_lossy())) {
            None => Ok(()),
            Some(file) => Err(Failure::Argument(format!(
                "{} {}: the run reads this file (the robot includes {}); give the output a file of its own",
                self.option,
                self.given.display(),
                file.display()
            ))),
        }
    }
}

/// One of the places of [`Outputs`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Slot(usize);

impl Outputs {
    /// Outputs of a run that reads these files, by their names as given.
    pub fn beside<'a>(inputs: impl IntoIterator<Item = &'a str>) -> Self {
        Self { inputs: inputs.into_iter().map(str::to_owned).collect(), ..Self::default() }
    }

    /// Outputs that replace what the run reads, as they are asked to.
    pub fn in_place() -> Self {
        Self { in_place: true, ..Self::default() }
    }

    /// A place to write to, as `option` names it; refused where it cannot be written or would destroy another file of the
    /// run.
    pub fn add(&mut self, option: &'static str, given: &Path) -> Result<Slot, Failure> {
        let destination = Destination::of(given)?;
        let shown = given.display();
        if let Some(input) = self.inputs.iter().find(|input| destination.is_input(input)) {
            return Err(Failure::Argument(format!(
                "{option} {shown}: the run reads this file (as {input}); give the output a file of its own"
            )));
        }
        if let Some(other) = self.places.iter().find(|place| place.destination.clashes_with(&destination)) {
            return Err(Failure::Argument(format!(
                "{} {} and {option} {shown}: two outputs have the same file; give each a file of its own",
                other.option,
                other.given.display()
            )));
        }
        let place = Place { option, given: given.to_owned(), destination };
        if !self.in_place {
            let mut run = RUN.lock().unwrap_or_else(PoisonError::into_inner);
            place.spares(&run.read)?;
            run.places.push(place.clone());
        }
        self.places.push(place);
        Ok(Slot(self.places.len() - 1))
    }

    /// The same for an option that may be absent.
    pub fn add_if(&mut self, option: &'static str, given: Option<&Path>) -> Result<Option<Slot>, Failure> {
        given.map(|given| self.add(option, given)).transpose()
    }

    /// Whether an output goes to standard output, where nothing else then belongs.
    pub fn take_standard_output(&self) -> bool {
        self.places.iter().any(|place| place.destination == Destination::StandardOutput)
    }

    /// Writes everything or changes no file: files are filled beside their targets, then streams are written, then files
    /// renamed.
    pub fn write(&self, texts: &[(Slot, String)]) -> Result<(), Failure> {
        self.write_with(texts, &[])
    }

    /// The same with files below a folder, which is made where it is not there: all of them, or none.
    pub fn write_with(&self, texts: &[(Slot, String)], below: &[(PathBuf, Vec<u8>)]) -> Result<(), Failure> {
        let mut files = Vec::new();
        for (path, bytes) in below {
            let failed =
                |error: io::Error| Failure::Write { file: path.display().to_string(), reason: error.to_string() };
            if let Some(folder) = path.parent() {
                std::fs::create_dir_all(folder).map_err(failed)?;
            }
            match Destination::of(path)? {
                Destination::File(target) => files.push(Staged::full(&target, path, bytes)?),
                _ => return Err(failed(io::Error::other("it is not a file"))),
            }
        }
        for (Slot(slot), text) in texts {
            let place = &self.places[*slot];
            if let Destination::File(target) = &place.destination {
                files.push(Staged::full(target, &place.given, with_flags(text).as_bytes())?);
            }
        }
        let mut reader = Ok(());
        for (Slot(slot), text) in texts {
            let place = &self.places[*slot];
            match &place.destination {
                Destination::File(_) => {}
                Destination::StandardOutput => match print(text) {
                    Err(Failure::ClosedPipe) => reader = Err(Failure::ClosedPipe),
                    printed => printed?,
                },
                Destination::Stream(path) => {
                    let written = std::fs::OpenOptions::new().write(true).open(path);
                    let written = written.and_then(|mut stream| {
                        stream.write_all(with_flags(text).as_bytes())?;
                        stream.flush()
                    });
                    written.map_err(|error| Failure::Write {
                        file: place.given.display().to_string(),
                        reason: error.to_string(),
                    })?;
                }
            }
        }
        staged::commit(files)?;
        reader
    }
}

/// A folder that a run fills: made when there is something to put into it.
#[derive(Debug)]
pub struct OutputFolder(PathBuf);

impl OutputFolder {
    /// Refuses what can be no folder, before the work.
    pub fn of(given: &Path) -> Result<Self, Failure> {
        let refused = |reason: String| Failure::Write { file: given.display().to_string(), reason };
        let there = given.ancestors().find(|folder| folder.as_os_str().is_empty() || folder.exists());
        let there = there.filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if !there.is_dir() {
            return Err(refused(format!("{} is not a folder", there.display())));
        }
        staged::temporary(&there.join("any"), given)?;
        Ok(Self(given.to_owned()))
    }

    /// Writes every file, by name and text, as a whole or none; gives their paths.
    pub fn write<'a>(
        &self,
        files: &[(String, String)],
        inputs: impl IntoIterator<Item = &'a str>,
    ) -> Result<Vec<PathBuf>, Failure> {
        let is_new = !self.0.exists();
        std::fs::create_dir_all(&self.0)
            .map_err(|error| Failure::Write { file: self.0.display().to_string(), reason: error.to_string() })?;
        let mut outputs = Outputs::beside(inputs);
        let slots = files.iter().map(|(name, text)| Ok((outputs.add("--output", &self.0.join(name))?, text.clone())));
        let written = slots.collect::<Result<Vec<_>, Failure>>().and_then(|texts| outputs.write(&texts));
        if written.is_err() && is_new {
            // Only a folder that is still empty goes.
            let _ = std::fs::remove_dir(&self.0);
        }
        written?;
        Ok(files.iter().map(|(name, _)| self.0.join(name)).collect())
    }
}
