//! A file of measurements or poses as Python holds it: its content, and the description of its columns.

use crate::chain::Chain;
use crate::errors::{Class, Spot, error, load, measured, said};
use denavit_load::measured::{DataFile, HashedFile, sight};
use denavit_measurements::import::{self, EulerError, ImportOptions, Map};
use denavit_measurements::plate::PlateError;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;
use std::fmt::Display;

/// What messages call a map that was written as words, which the package's own Python shows instead of a file.
pub const COLUMNS_IN_WORDS: &str = "‹columns›";

/// A file.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Given {
    pub name: String,
    content: Content,
    units: String,
    columns: Option<(String, String)>,
    euler: Option<String>,
    quaternion: Option<String>,
    rotation_vector: bool,
    joints: Option<(String, String)>,
    camera: Option<(String, String)>,
    board: Option<String>,
    on_hand: bool,
    plate: Option<String>,
}

/// What is in it.
#[derive(FromPyObject)]
pub enum Content {
    /// Text.
    Text(String),
    /// A workbook, or text of another encoding than UTF-8.
    Bytes(PyBackedBytes),
}

impl Content {
    fn into_bytes(self) -> Vec<u8> {
        match self {
            Self::Text(text) => text.into_bytes(),
            Self::Bytes(bytes) => bytes.to_vec(),
        }
    }
}

impl Given {
    /// The file with its description interpreted.
    pub fn file(self) -> PyResult<DataFile> {
        let wrong = |message: String| error(Class::Argument, &message, Spot::file(&self.name));
        let option = |option: &str, failure: &dyn Display| wrong(format!("{}: {option}: {failure}", self.name));
        let map = self.columns.map(|(file, text)| {
            let read = if file == COLUMNS_IN_WORDS { Map::of_words(&text) } else { Map::read(&file, &text) };
            read.map_err(|failure| wrong(failure.to_string()))
        });
        let order = self.euler.map(|word| word.parse().map_err(|failure: EulerError| option("euler", &failure)));
        let plate = self.plate.map(|word| word.parse().map_err(|failure: PlateError| option("plate", &failure)));
        let program = self.joints.map(|(file, text)| {
            import::joints(&file, &text)
                .map_err(|failure| error(Class::Argument, &failure.to_string(), Spot::file(&file)))
        });
        let camera_file = self.camera.as_ref().map(|(file, text)| HashedFile::of(file, text.as_bytes()));
        let camera = self.camera.map(|(file, text)| sight(&file, &text, self.board.as_deref(), self.on_hand));
        let import = ImportOptions {
            map: map.transpose()?,
            euler: order.transpose()?,
            rotation_vector: self.rotation_vector,
            quaternion: self.quaternion,
            joints: program.transpose()?,
            plate: plate.transpose()?,
            sight: camera.transpose().map_err(|failure| measured(&failure))?,
            tips: None,
        };
        let units = self.units.parse().map_err(|failure| option("units", &failure))?;
        let (name, content) = (self.name, self.content.into_bytes().into());
        Ok(DataFile { name, content, units, import, camera: camera_file, ..DataFile::default() })
    }
}

/// The content of a file, of standard input (`-`), or of a file in git, and what to call it.
#[pyfunction]
pub fn read_bytes<'py>(py: Python<'py>, name: &str) -> PyResult<(String, Bound<'py, PyBytes>)> {
    let (file, bytes) = denavit_load::read_bytes(name).map_err(|failure| load(&failure))?;
    Ok((file, PyBytes::new(py, &bytes)))
}

/// A ROS 2 bag as rows: CSV in SI, and what was found.
#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "what Python calls with is handed over by value")]
pub fn bag_rows(
    py: Python<'_>,
    bag: &str,
    chain: PyRef<'_, Chain>,
    joint_topic: Option<String>,
    target_topic: Option<String>,
) -> PyResult<(String, Vec<String>)> {
    let joints = chain.chain.coordinates().iter().map(|coordinate| coordinate.name.clone()).collect();
    let asked = denavit_bag::BagOptions { joints, joint_topic, target_topic };
    let rows = py.detach(|| denavit_bag::rows(bag, &asked));
    let rows = rows.map_err(|failure| error(Class::Data, &failure.to_string(), Spot::file(bag)))?;
    Ok((rows.csv, rows.notes.iter().map(said).collect()))
}

/// Columns of a file as CSV, names in the first row; `None` of a file that is just that.
#[pyfunction]
pub fn cells(name: &str, content: Content) -> PyResult<Option<String>> {
    let failed = |failure: import::ImportProblem| error(Class::Data, &format!("{name}: {failure}"), Spot::file(name));
    import::cells(&content.into_bytes()).map_err(failed)
}

/// A map of a file's columns to start from, TOML.
#[pyfunction]
pub fn columns_draft(chain: &Chain, name: &str, content: Content) -> PyResult<String> {
    let failed = |failure: import::ImportProblem| error(Class::Data, &format!("{name}: {failure}"), Spot::file(name));
    import::draft(name, &content.into_bytes(), &chain.chain).map_err(failed)
}
