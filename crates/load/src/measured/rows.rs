//! Training and test data: files of measurements, files of readings in sockets, known distances.

use super::MeasuredError;
use super::content::Content;
use super::distance::known_distance;
use super::origin::{HashedFile, Hashing, origin};
use denavit_calibrate::calibration::contract::Origin;
use denavit_measurements::import::ImportOptions;
use denavit_measurements::{self, ColumnUse, Measurements, Units, label_of, read_socket};
use denavit_model::Chain;
use std::path::Path;

/// A file of measurements.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DataFile {
    /// What messages call it.
    pub name: String,
    /// CSV, or any export.
    pub content: Content,
    /// Units of its numbers.
    pub units: Units,
    /// What its columns are, where their names do not say so.
    pub import: ImportOptions,
    /// The files of the bag that the content was made of; empty where it was read as it is.
    pub bag: Vec<HashedFile>,
    /// The camera's file of intrinsics, where its pixels are read.
    pub camera: Option<HashedFile>,
}

/// The rows that a calibration is asked to take.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RowsAsked {
    /// To fit. Several files are several setups: each has its own instrument frame and targets.
    pub data: Vec<DataFile>,
    /// To fit: the socket's label, and joint readings with the ball in it.
    pub sockets: Vec<(String, DataFile)>,
    /// Known distances between sockets or anchors: `LABEL,LABEL=50mm` or `LABEL,LABEL=50mm±0.1mm`.
    pub distances: Vec<String>,
    /// Test data.
    pub test: Option<DataFile>,
    /// Setups, or placements of sockets, to hold out.
    pub hold_out_setups: Vec<String>,
}

/// The rows of a calibration.
#[derive(Debug)]
pub struct Rows {
    /// To fit.
    pub data: Measurements,
    /// Test data, where they are named.
    pub test: Option<Measurements>,
    /// What the columns of the first file were taken for.
    pub columns: Vec<ColumnUse>,
    /// What must be known of the files.
    pub notes: Vec<String>,
    /// The files, by their hashes.
    pub origin: Origin,
}

/// Reads training and test rows.
///
/// # Errors
/// A file that cannot be read, a label that no row has, nothing to fit.
pub fn rows(asked: &RowsAsked, chain: &Chain) -> Result<Rows, MeasuredError> {
    let (mut columns, mut notes, mut parts) = (Vec::new(), Vec::new(), Vec::new());
    let mut hashed = Vec::new();
    let mut read = |file: &DataFile| {
        let mut input = Hashing::of(file);
        let loaded = denavit_measurements::read_export(&file.name, &mut input, chain, file.units, &file.import)?;
        hashed.push(input.finish()?);
        notes.extend(loaded.notes.iter().map(|note| format!("{}: {note}", file.name)));
        Ok::<_, MeasuredError>((loaded.data, loaded.columns))
    };
    for (file, setup) in asked.data.iter().zip(setups(&asked.data)) {
        let (data, used) = read(file)?;
        if columns.is_empty() {
            columns = used;
        }
        parts.push(if asked.data.len() > 1 { data.of_setup(&setup) } else { data });
    }
    let of_files = parts.len();
    let recorded = |part: &Measurements| -> Vec<String> {
        let numbers = part.covariates.iter().map(|column| column.name.clone());
        numbers.chain(part.labels.iter().map(|label| label.name.clone())).collect()
    };
    let columns_of: Vec<(String, Vec<String>)> =
        parts.iter().map(|part| (part.source.clone(), recorded(part))).collect();
    let mut of_sockets = Vec::new();
    for (label, file) in &asked.sockets {
        let mut input = Hashing::of(file);
        parts.push(read_socket(&file.name, &mut input, label, chain, file.units)?);
        of_sockets.push(input.finish()?);
    }
    let Some(mut data) = Measurements::joined(parts) else {
        return Err(MeasuredError::Option("there is nothing to fit; name a file with ‹data› or ‹socket›".into()));
    };
    let mut left_out_of_files = Vec::new();
    if of_files > 1 {
        let kept = recorded(&data);
        for (file, columns) in &columns_of {
            let left_out: Vec<&str> = columns.iter().filter(|name| !kept.contains(name)).map(String::as_str).collect();
            if !left_out.is_empty() {
                let columns = left_out.join(", ");
                left_out_of_files.push(format!("{file}: left out, as not every file has them: {columns}"));
            }
        }
    }
    let mut test = asked.test.as_ref().map(|file| Ok::<_, MeasuredError>(read(file)?.0)).transpose()?;
    notes.extend(left_out_of_files);
    // In the order in which the files are listed: training, sockets, test.
    hashed.splice(asked.data.len()..asked.data.len(), of_sockets);
    let origin = origin(asked, hashed);
    // Errors in pixels are lengths at one distance, in all rows.
    if let (Some(range), Some(test)) = (data.scene.range(), test.as_mut()) {
        test.scene.set_range(range);
    }
    for word in &asked.distances {
        know(word, &mut data, test.as_mut())?;
    }
    if asked.hold_out_setups.is_empty() {
        return Ok(Rows { data, test: test.map(Measurements::placed_again), columns, notes, origin });
    }
    let (train, held) = data.apart(&asked.hold_out_setups).map_err(|name| {
        MeasuredError::Option(format!(
            "‹hold-out-setups›: no row is of a setup \"{name}\"; name setups, or the part before the / of a socket's label"
        ))
    })?;
    if train.is_empty() {
        let message = "‹hold-out-setups›: nothing is left to fit; name fewer setups";
        return Err(MeasuredError::Option(message.into()));
    }
    Ok(Rows { data: train, test: Some(held), columns, notes, origin })
}

/// A name for the setup of each file: the file's own without folder and extension; with them where two are called alike, and
/// counted where even these are one.
fn setups(files: &[DataFile]) -> Vec<String> {
    let stem = |file: &DataFile| {
        Path::new(&file.name).file_stem().map_or_else(|| file.name.clone(), |stem| stem.to_string_lossy().into_owned())
    };
    let mut names: Vec<String> = Vec::with_capacity(files.len());
    for (index, file) in files.iter().enumerate() {
        let alone = files.iter().filter(|other| stem(other) == stem(file)).count() == 1;
        let name = if alone { stem(file) } else { file.name.clone() };
        let before = files[..index].iter().filter(|other| other.name == file.name).count();
        names.push(if before == 0 { name } else { format!("{name} {}", before + 1) });
    }
    names
}

/// States a known distance in training and test rows.
fn know(word: &str, data: &mut Measurements, test: Option<&mut Measurements>) -> Result<(), MeasuredError> {
    let known = known_distance(word)?;
    let stated = |data: &mut Measurements| {
        data.scene.know_length([&known.labels[0], &known.labels[1]], known.length, known.deviation)
    };
    if stated(data) + test.map_or(0, stated) > 0 {
        return Ok(());
    }
    let labels: Vec<&str> = data.scene.points.iter().map(|name| label_of(name)).collect();
    Err(MeasuredError::Option(format!(
        "‹distance› \"{word}\": no two sockets or anchors have these labels; there are {}",
        if labels.is_empty() { "none".into() } else { labels.join(", ") }
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_is_a_setup_of_its_own() {
        let file = |name: &str| DataFile { name: name.into(), ..DataFile::default() };
        let files = ["monday/run.csv", "tuesday/run.csv", "late.csv", "<data frame>", "<data frame>"].map(file);
        let expected = ["monday/run.csv", "tuesday/run.csv", "late", "<data frame>", "<data frame> 2"];
        assert_eq!(setups(&files), expected);
    }
}
