//! Files that are read row by row, beside the same rows read as a whole.

use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::{SimulationOptions, simulate};
use denavit_measurements::kinds::ObservationKind;
use denavit_measurements::{Loaded, Measurements, Units, read, write};
use denavit_model::{Chain, examples};
use std::io::Read;

/// More rows than the part of a file that shows its form.
const ROWS: usize = 4000;

fn text(chain: &Chain) -> String {
    let options = SimulationOptions { kind: ObservationKind::Position, rows: ROWS, ..SimulationOptions::default() };
    let text = write(&simulate(chain, &options, &NoEffects).data, &[]);
    assert!(text.len() > 300_000, "{}", text.len());
    text
}

fn loaded(text: &[u8], chain: &Chain) -> Loaded {
    read("large.csv", text, chain, Units::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// The rows, read in pieces that are too small for a look at the whole.
fn in_pieces(text: &str, chain: &Chain) -> Measurements {
    let (header, rows) = text.split_once('\n').unwrap();
    let rows: Vec<&str> = rows.lines().collect();
    let parts = rows.chunks(500).map(|rows| {
        let part = format!("{header}\n{}\n", rows.join("\n"));
        loaded(part.as_bytes(), chain).data
    });
    Measurements::joined(parts.collect()).unwrap()
}

#[test]
fn a_large_file_is_what_its_parts_are() {
    let chain = examples::puma_like();
    let text = text(&chain);
    let (large, small) = (loaded(text.as_bytes(), &chain), in_pieces(&text, &chain));
    assert_eq!((large.data.len(), &large.notes), (ROWS, &Vec::new()));
    assert_eq!((&large.data.readings, &large.data.observed), (&small.readings, &small.observed));
    assert!(large.data.lines.iter().copied().eq(2..ROWS + 2));
    // As another program writes it, with something for people in between.
    let mut lines: Vec<&str> = text.lines().collect();
    lines.insert(3000, "# the instrument was warm from here on");
    let other = loaded(lines.join("\r\n").as_bytes(), &chain);
    assert_eq!((&other.data.readings, &other.data.observed), (&large.data.readings, &large.data.observed));
    assert_eq!((other.data.lines[2998], other.data.lines[2999]), (3000, 3002));
}

#[test]
fn other_encodings_and_faults_behind_the_first_part_are_seen() {
    let chain = examples::puma_like();
    let text = text(&chain);
    // A column of texts, one of them written by a program of another age.
    let mut bytes = Vec::new();
    for (index, line) in text.lines().enumerate() {
        bytes.extend_from_slice(line.as_bytes());
        bytes.extend_from_slice(if index == 0 { b",operator" } else { b",M" });
        bytes.extend_from_slice(if index == 3500 { b"\xfcller\n" } else { b"\n" });
    }
    let found = loaded(&bytes, &chain);
    assert_eq!(found.data.labels[0].values[3499], "Müller");
    let notes: Vec<String> = found.notes.iter().map(ToString::to_string).collect();
    assert_eq!(notes, ["text in windows-1252"]);
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    lines[3700] = lines[3700].replacen(',', ",x", 1);
    let error = read("large.csv", lines.join("\n").as_bytes(), &chain, Units::default()).unwrap_err().to_string();
    assert!(error.contains("large.csv:3701") || error.contains("line 3701"), "{error}");
    let torn = text.as_bytes().chain(Broken);
    let error = read("large.csv", torn, &chain, Units::default()).unwrap_err().to_string();
    assert!(error.contains("the disk is gone"), "{error}");
}

/// A disk that fails.
struct Broken;

impl Read for Broken {
    fn read(&mut self, _: &mut [u8]) -> std::io::Result<usize> {
        Err(std::io::Error::other("the disk is gone"))
    }
}
