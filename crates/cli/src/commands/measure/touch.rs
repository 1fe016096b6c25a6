//! A plate touched hole by hole: each Enter appends a row with the robot's last joint values.

use crate::failure::Failure;
use crate::measured;
use crate::output::{self, Outputs};
use denavit_measurements::Units;
use denavit_measurements::plate::Plate;
use denavit_model::{Chain, Quantity};
use std::fmt::Write as _;
use std::io::{self, BufRead as _};
use std::path::Path;

/// What the user says at a hole.
enum Answer {
    Take,
    Skip,
    Move,
    End,
}

/// A run along the holes of a plate.
pub struct Touch<'a> {
    chain: &'a Chain,
    units: Units,
    written_units: &'a str,
    readings: &'a str,
    data: &'a Path,
    holes: Vec<String>,
    text: String,
    /// Placements begun, and the next hole of this one.
    placement: usize,
    hole: usize,
}

impl<'a> Touch<'a> {
    /// Continues the run in `data`, where that has one.
    pub fn begin(
        chain: &'a Chain,
        units: Units,
        written_units: &'a str,
        readings: &'a str,
        data: &'a Path,
        plate: &Plate,
    ) -> Result<Self, Failure> {
        let holes = plate.holes().map(|(name, _)| name).collect();
        let names = chain.coordinates().iter().map(|coordinate| coordinate.name.as_str());
        let header = names.chain(["hole", "setup"]).collect::<Vec<_>>().join(",") + "\n";
        let text = match std::fs::read_to_string(data) {
            Ok(text) if text.starts_with(&header) => text,
            Ok(text) if text.trim().is_empty() => header,
            Ok(_) => {
                return Err(Failure::Argument(format!(
                    "{}: this file is not a run along a plate: its first line must be {}; name another file with --data",
                    data.display(),
                    header.trim_end()
                )));
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => header,
            Err(error) => {
                return Err(Failure::Argument(format!("{}: cannot be read: {error}", data.display())));
            }
        };
        let setups = text.lines().skip(1).filter_map(|line| line.rsplit(',').next()?.trim().parse::<usize>().ok());
        let placement = setups.max().map_or(1, |last| last + 1);
        Ok(Self { chain, units, written_units, readings, data, holes, text, placement, hole: 0 })
    }

    /// Asks for the next row and appends it; whether there was one.
    pub fn next(&mut self) -> Result<bool, Failure> {
        loop {
            if self.hole == self.holes.len() {
                self.moved();
            }
            let hole = self.holes[self.hole].clone();
            output::mention(format!(
                "placement {}, hole {hole}: put the tip into it, then Enter (s: leave this hole out, m: the plate was moved, q: end)",
                self.placement
            ));
            match answer()? {
                Answer::End => return Ok(false),
                Answer::Move => self.moved(),
                Answer::Skip => self.hole += 1,
                Answer::Take => match self.last_reading() {
                    Ok(reading) => {
                        self.append(&reading, &hole)?;
                        self.hole += 1;
                        return Ok(true);
                    }
                    // Whoever stands at the robot can correct this and try again.
                    Err(failure) => output::mention(failure),
                },
            }
        }
    }

    fn moved(&mut self) {
        self.placement += 1;
        self.hole = 0;
        output::mention(format!("placement {}: move the plate and fix it again", self.placement));
    }

    /// The last joint values of the readings, rad or m.
    fn last_reading(&self) -> Result<Vec<f64>, Failure> {
        let mut rows = measured::joint_values(self.readings, self.chain, self.written_units)?;
        rows.pop().ok_or_else(|| Failure::Argument(format!("{}: there are no joint values yet", self.readings)))
    }

    /// Appends a row to the run and writes it.
    fn append(&mut self, reading: &[f64], hole: &str) -> Result<(), Failure> {
        for (coordinate, value) in self.chain.coordinates().iter().zip(reading) {
            let unit = if coordinate.quantity == Quantity::Angle { self.units.angle } else { self.units.length };
            let _ = write!(self.text, "{},", value / unit);
        }
        let _ = writeln!(self.text, "{hole},{}", self.placement);
        let mut outputs = Outputs::beside([self.readings]);
        let slot = outputs.add("--data", self.data)?;
        outputs.write(&[(slot, self.text.clone())])
    }
}

fn answer() -> Result<Answer, Failure> {
    loop {
        let mut line = String::new();
        let read = io::stdin().lock().read_line(&mut line);
        if read.map_err(|error| Failure::Argument(format!("standard input: {error}")))? == 0 {
            return Ok(Answer::End);
        }
        match line.trim() {
            "" => return Ok(Answer::Take),
            "s" => return Ok(Answer::Skip),
            "m" => return Ok(Answer::Move),
            "q" => return Ok(Answer::End),
            _ => output::mention("press Enter alone, or s, m or q and Enter"),
        }
    }
}
