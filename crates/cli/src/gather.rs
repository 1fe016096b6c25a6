//! What `calibrate` fits and what it judges by: files of measurements, files of readings in sockets, known distances.

use crate::args::CalibrateArguments;
use crate::failure::Failure;
use crate::measured;
use denavit_calibrate::observation::measurements::{ColumnUse, Measurements, label_of, read_socket};
use denavit_model::Chain;
use std::path::Path;

/// How sure a known distance is when nothing is said, m.
const USUAL_DEVIATION: f64 = 5e-5;

/// The rows of a calibration.
pub struct Rows {
    /// To fit.
    pub data: Measurements,
    /// To judge by, where they are said by name.
    pub test: Option<Measurements>,
    /// What the columns of the first file were taken for.
    pub columns: Vec<ColumnUse>,
}

/// Reads the rows to fit and those to judge by.
pub fn rows(arguments: &CalibrateArguments, chain: &Chain) -> Result<Rows, Failure> {
    let several = arguments.data.len() > 1;
    let mut columns = Vec::new();
    let mut parts = Vec::new();
    for file in &arguments.data {
        let (data, used) = measured::measurements(file, chain, &arguments.units)?;
        if columns.is_empty() {
            columns = used;
        }
        let stem = Path::new(file).file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        parts.push(if several { data.of_setup(&stem) } else { data });
    }
    for word in &arguments.socket {
        parts.push(socket(word, chain, &arguments.units)?);
    }
    let Some(mut data) = Measurements::joined(parts) else {
        return Err(Failure::Argument("there is nothing to fit; name a file by --data or --socket".into()));
    };
    let read = |file| Ok::<_, Failure>(measured::measurements(file, chain, &arguments.units)?.0);
    let mut test = arguments.test.as_deref().map(read).transpose()?;
    for word in &arguments.distance {
        let known = known_distance(word)?;
        let stated = |data: &mut Measurements| {
            data.scene.know_length([&known.labels[0], &known.labels[1]], known.length, known.deviation)
        };
        let count = stated(&mut data) + test.as_mut().map_or(0, stated);
        if count == 0 {
            let labels: Vec<&str> = data.scene.points.iter().map(|name| label_of(name)).collect();
            return Err(Failure::Argument(format!(
                "--distance \"{word}\": no two sockets or anchors are called so; there are {}",
                if labels.is_empty() { "none".into() } else { labels.join(", ") }
            )));
        }
    }
    if arguments.hold_out_setups.is_empty() {
        return Ok(Rows { data, test: test.map(Measurements::placed_anew), columns });
    }
    let (train, held) = data.apart(&arguments.hold_out_setups).map_err(|name| {
        Failure::Argument(format!(
            "--hold-out-setups: no row is of a setup \"{name}\"; name setups, or what stands before the / of a socket"
        ))
    })?;
    if train.is_empty() {
        return Err(Failure::Argument("--hold-out-setups: nothing is left to fit; name fewer setups".into()));
    }
    Ok(Rows { data: train, test: Some(held), columns })
}

/// `LABEL=FILE`.
fn socket(word: &str, chain: &Chain, written: &str) -> Result<Measurements, Failure> {
    let (label, file) =
        word.split_once('=').filter(|(label, file)| !label.is_empty() && !file.is_empty()).ok_or_else(|| {
            Failure::Argument(format!("--socket \"{word}\": write LABEL=FILE, such as front/0=front_0.csv"))
        })?;
    measured::read(file, written, |name, text, units| read_socket(name, text.as_bytes(), label, chain, units))
}

struct Known {
    labels: [String; 2],
    length: f64,
    deviation: f64,
}

/// `LABEL,LABEL=50mm` or `LABEL,LABEL=50mm±0.1mm`.
fn known_distance(word: &str) -> Result<Known, Failure> {
    let wrong = || {
        Failure::Argument(format!(
            "--distance \"{word}\": write two labels and their distance, such as front/0,front/1=50mm, or \
             */0,*/1=50mm+-0.1mm for every placement"
        ))
    };
    let (labels, value) = word.rsplit_once('=').ok_or_else(wrong)?;
    let (first, second) = labels.split_once(',').ok_or_else(wrong)?;
    let (length, deviation) = match value.split_once('±').or_else(|| value.split_once("+-")) {
        Some((length, deviation)) => (metres(length), metres(deviation)),
        None => (metres(value), Some(USUAL_DEVIATION)),
    };
    let (Some(length), Some(deviation)) = (length, deviation) else { return Err(wrong()) };
    if first.trim().is_empty() || second.trim().is_empty() || first.contains('*') != second.contains('*') {
        return Err(wrong());
    }
    Ok(Known { labels: [first.trim().into(), second.trim().into()], length, deviation })
}

/// A positive length with its unit, in m.
fn metres(text: &str) -> Option<f64> {
    let text = text.trim();
    let units = [("mm", 1e-3), ("um", 1e-6), ("µm", 1e-6), ("in", 0.0254), ("m", 1.0)];
    let (number, unit) = units.iter().find_map(|(word, unit)| Some((text.strip_suffix(word)?, unit)))?;
    number.trim().parse::<f64>().ok().filter(|number| number.is_finite() && *number > 0.0).map(|number| number * unit)
}
