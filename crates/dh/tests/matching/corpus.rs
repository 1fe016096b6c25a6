//! Reading robots and tables from files.

use denavit_dh::Motion;
use denavit_dh::matching::{Match, Sense, VendorJoint, VendorNumber, VendorRow};
use denavit_model::tree::Reading;
use denavit_model::{Chain, Robot, urdf};
use std::path::{Path, PathBuf};

/// The vendor corpus beside the workspace, or `None` with the reason printed.
pub fn vendor_corpus() -> Option<PathBuf> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/vendor");
    if !folder.is_dir() {
        println!("skipped, because {} is not there", folder.display());
        return None;
    }
    Some(folder)
}

pub fn read_robot(path: &Path) -> Robot {
    let file = path.display().to_string();
    let text = std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{file}: {error}"));
    urdf::read(&file, &text).unwrap_or_else(|error| panic!("{file}: {error}"))
}

/// The chain between links as the corpus names them: `root`, a link, or `child link of JOINT`.
pub fn chain_of(robot: &Robot, base: &str, tip: &str, reading: Reading) -> Chain {
    let base = if base == "root" { robot.links[robot.root].name.clone() } else { base.to_owned() };
    let tip = match tip.strip_prefix("child link of ") {
        Some(joint) => robot.links[robot.joints[robot.joint_index(joint).expect(joint)].child].name.clone(),
        None => tip.to_owned(),
    };
    robot.chain(Some(&base), Some(&tip), reading).unwrap_or_else(|error| panic!("{error}")).value
}

/// A CSV file whose records are asked for by column name.
pub struct Rows {
    headers: csv::StringRecord,
    pub records: Vec<csv::StringRecord>,
}

impl Rows {
    pub fn read(path: &Path) -> Self {
        let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path).unwrap();
        let headers = reader.headers().unwrap().clone();
        Self { headers, records: reader.records().map(Result::unwrap).collect() }
    }

    pub fn has(&self, name: &str) -> bool {
        self.headers.iter().any(|header| header == name)
    }

    pub fn text<'a>(&self, record: &'a csv::StringRecord, name: &str) -> &'a str {
        &record[self.headers.iter().position(|header| header == name).expect(name)]
    }

    /// A joint row; `columns` are theta, d, alpha, a and the kind, units those of angles and lengths.
    pub fn joint(&self, record: &csv::StringRecord, columns: [&str; 5], units: [f64; 2]) -> VendorJoint {
        let number =
            |at: usize| Some(VendorNumber::from_written(self.text(record, columns[at]), units[at % 2]).unwrap());
        let row = VendorRow { theta: number(0), d: number(1), alpha: number(2), a: number(3), beta: None };
        let motion = if self.text(record, columns[4]) == "prismatic" { Motion::Prismatic } else { Motion::Revolute };
        VendorJoint { name: None, motion, row }
    }
}

/// Reversed senses and zeros that a match needed.
pub fn needed(found: &Match) -> usize {
    let mentioned = |zero: f64| usize::from(zero.abs() > 1e-3);
    found.placement.joints.iter().map(|joint| usize::from(joint.sense == Sense::Reversed) + mentioned(joint.zero)).sum()
}

/// What the robot's lengths read when rounded to the places that the vendor wrote, six at the most, beside the vendor's.
pub fn lengths_misprinted(found: &Match) -> Vec<String> {
    let numbers = found.rows.iter().flat_map(|row| &row.numbers);
    let lengths = numbers.filter(|number| number.number.is_length() && number.vendor.places().is_some_and(|p| p <= 6));
    let misprinted = lengths.filter_map(|number| {
        let written = number.vendor.written.as_ref()?;
        let places = usize::try_from(number.vendor.places()?.max(1)).ok()?;
        let own = format!("{:.places$}", number.robot / written.unit);
        let same = own.parse::<f64>().ok()? == written.text.parse::<f64>().ok()?;
        (!same).then(|| format!("{own} for {}", written.text))
    });
    misprinted.collect()
}
