//! A robot from any source.

use crate::chain::Chain;
use crate::errors::{argument, load, said};
use denavit_dh::{Convention, Gauge, Parallelism};
use denavit_edit::{Actual, Files, Operation, Text, Words};
use denavit_export::sources::Stated;
use denavit_export::urdf::{Frames, LinkFrames, Options as ExportOptions};
use denavit_load::{Loaded, Options, Selection};
use denavit_model::nalgebra::{Matrix3, Rotation3, UnitQuaternion};
use denavit_model::{Note, Reading, se3};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::path::PathBuf;
use std::sync::Arc;

/// A matrix whose columns deviate by more is not a rotation.
pub const ORTHONORMAL: f64 = 1e-6;

/// A robot as its source describes it.
#[pyclass(frozen, module = "denavit._denavit")]
pub struct Robot {
    pub loaded: Arc<Loaded>,
    pub file: Arc<str>,
    notes: Vec<String>,
}

/// The text of a file, of standard input (`-`) or of `git:REVISION:PATH`, and its name in messages.
#[pyfunction]
pub fn read_text(py: Python<'_>, name: &str) -> PyResult<(String, String)> {
    py.detach(|| denavit_load::read_text(name)).map_err(|error| load(&error))
}

/// Roll, pitch and yaw of a rotation matrix, as URDF writes them, rad.
#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "what Python calls with is handed over by value")]
pub fn rpy(rotation: PyReadonlyArray2<'_, f64>) -> PyResult<[f64; 3]> {
    let entries = rotation.as_array();
    if entries.shape() != [3, 3] {
        return Err(argument("a rotation is a matrix of shape (3, 3)"));
    }
    let matrix = Matrix3::from_fn(|row, column| entries[[row, column]]);
    Ok(se3::rpy_from_rotation(&Rotation3::from_matrix_unchecked(matrix)))
}

/// A rotation matrix as a quaternion x, y, z, w of unit length.
#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "what Python calls with is handed over by value")]
pub fn quaternion(rotation: PyReadonlyArray2<'_, f64>) -> PyResult<[f64; 4]> {
    let entries = rotation.as_array();
    let matrix = (entries.shape() == [3, 3]).then(|| Matrix3::from_fn(|row, column| entries[[row, column]]));
    let off = |matrix: &Matrix3<f64>| (matrix.transpose() * matrix - Matrix3::identity()).amax();
    let rotation = matrix.filter(|matrix| off(matrix) < ORTHONORMAL && matrix.determinant() > 0.0);
    let rotation = rotation.ok_or_else(|| argument("a pose's upper left 3 by 3 must be a rotation"))?;
    let found = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix(&rotation));
    Ok([found.i, found.j, found.k, found.w])
}

/// Angles as written, or as they were meant.
pub fn reading(exact: bool) -> Reading {
    if exact { Reading::AsWritten } else { Reading::Intended }
}

/// Convention and units of a table whose file does not state them.
pub fn stated(convention: Option<&str>, units: &str) -> PyResult<Stated> {
    let convention = convention.map(|word| self::convention("table_convention", word)).transpose()?;
    let stated = Stated { convention, ..Stated::default() }.with_units(units);
    stated.map_err(|unknown| {
        argument(format!(
            "table_units: \"{}\" is not a unit of a table; write one length unit and one angle unit, such as mm,deg",
            unknown.word
        ))
    })
}

/// A convention by one of its names.
pub fn convention(keyword: &str, word: &str) -> PyResult<Convention> {
    Convention::from_word(word).ok_or_else(|| {
        argument(format!(
            "{keyword} is \"{word}\"; write distal (standard, sdh, dh), proximal (modified, mdh, craig), paper or hayati"
        ))
    })
}

#[pymethods]
impl Robot {
    /// Reads a robot from text; `file` is what messages call it, and its ending distinguishes some formats.
    #[staticmethod]
    #[pyo3(signature = (file, text, arguments, package_path, allow_any_file, vendor_angles, convention, units))]
    #[expect(clippy::too_many_arguments, reason = "each is a keyword of the Python function")]
    fn from_text(
        py: Python<'_>,
        file: &str,
        text: &str,
        arguments: Vec<(String, String)>,
        package_path: Vec<PathBuf>,
        allow_any_file: bool,
        vendor_angles: bool,
        convention: Option<&str>,
        units: &str,
    ) -> PyResult<Self> {
        let stated = stated(convention, units)?;
        let options = Options { arguments, package_path, allow_any_file, vendor_angles, stated, ..Options::default() };
        let opened = py.detach(|| denavit_load::from_text(file, text, &options)).map_err(|error| load(&error))?;
        let notes = opened.notes.iter().map(said).collect();
        let file: Arc<str> = match &opened.robot {
            Loaded::Robot(robot) => robot.source.file.as_str().into(),
            _ => file.into(),
        };
        Ok(Self { loaded: Arc::new(opened.robot), file, notes })
    }

    /// The robot's name.
    #[getter]
    fn name(&self) -> &str {
        match &*self.loaded {
            Loaded::Robot(robot) => &robot.name,
            Loaded::Table { chain, .. } | Loaded::Poe(chain) => chain.name(),
        }
    }

    /// The name of its source in messages.
    #[getter]
    fn file(&self) -> &str {
        &self.file
    }

    /// `urdf`, `table` or `poe`.
    #[getter]
    fn kind(&self) -> &'static str {
        match &*self.loaded {
            Loaded::Robot(_) => "urdf",
            Loaded::Table { .. } => "table",
            Loaded::Poe(_) => "poe",
        }
    }

    /// Links, and joints that move; of a tree only.
    #[getter]
    fn counts(&self) -> Option<(usize, usize)> {
        let Loaded::Robot(robot) = &*self.loaded else { return None };
        Some((robot.links.len(), robot.joints.iter().filter(|joint| joint.kind.moves()).count()))
    }

    /// The URDF, with xacro expanded; of a tree only.
    #[getter]
    fn urdf(&self) -> Option<String> {
        let Loaded::Robot(robot) = &*self.loaded else { return None };
        Some(robot.source.text.clone())
    }

    /// The mesh files that its shapes name, as it names them, and what they hold: of a tree, of at most `most` bytes together.
    fn meshes<'py>(
        &self,
        py: Python<'py>,
        package_path: Vec<PathBuf>,
        most: u64,
    ) -> Vec<(String, Bound<'py, PyBytes>)> {
        let Loaded::Robot(robot) = &*self.loaded else { return Vec::new() };
        let options = Options { package_path, ..Options::default() };
        let found = py.detach(|| denavit_load::meshes(robot, &self.file, &options, most)).found;
        found.into_iter().map(|mesh| (mesh.uri, PyBytes::new(py, &mesh.bytes))).collect()
    }

    /// Joints that move by themselves, and joints that follow another (`<mimic>`); of a tree only.
    fn couplings(&self) -> (Vec<String>, Vec<String>) {
        let Loaded::Robot(robot) = &*self.loaded else { return (Vec::new(), Vec::new()) };
        let moving = robot.joints.iter().filter(|joint| joint.kind.moves());
        let (followers, drivers): (Vec<_>, Vec<_>) = moving.partition(|joint| joint.mimic.is_some());
        let names = |joints: Vec<&denavit_model::robot::Joint>| joints.iter().map(|joint| joint.name.clone()).collect();
        (names(drivers), names(followers))
    }

    /// What was read differently from what is written.
    #[getter]
    fn notes(&self) -> Vec<String> {
        let own: &[Note] = if let Loaded::Robot(robot) = &*self.loaded { &robot.notes } else { &[] };
        self.notes.iter().cloned().chain(own.iter().map(said)).collect()
    }

    /// Base, tip, coordinates of every chain to a leaf, and whether it is the default chain.
    fn chains(&self) -> Vec<(String, String, Vec<String>, bool)> {
        let listing = self.loaded.chains();
        let default = listing.default;
        let entry = |chain: denavit_model::tree::ChainListing| {
            let is_default = chain == default;
            (chain.base, chain.tip, chain.coordinates, is_default)
        };
        listing.chains.into_iter().map(entry).collect()
    }

    /// The chain between two links.
    #[pyo3(signature = (base, tip, exact))]
    fn chain(&self, base: Option<&str>, tip: Option<&str>, exact: bool) -> PyResult<Chain> {
        let selection = Selection { file: &self.file, base, tip, reading: reading(exact) };
        let noted = self.loaded.chain(&selection).map_err(|error| load(&error))?;
        Ok(Chain::new(Arc::clone(&self.loaded), Arc::clone(&self.file), noted, exact))
    }

    /// The canonical URDF and its notes.
    #[pyo3(signature = (link_frames, frames, tip, exact, tolerance))]
    fn canonical(
        &self,
        py: Python<'_>,
        link_frames: &str,
        frames: &str,
        tip: Option<String>,
        exact: bool,
        tolerance: f64,
    ) -> PyResult<(String, Vec<String>)> {
        let options = ExportOptions {
            link_frames: match link_frames {
                "replace" => LinkFrames::Replace,
                "keep" => LinkFrames::Keep,
                "mark" => LinkFrames::MarkOnly,
                other => return Err(argument(format!("link_frames is \"{other}\"; write replace, keep or mark"))),
            },
            frames: match frames {
                "distal" => Frames::Distal,
                "proximal" => Frames::Proximal,
                other => return Err(argument(format!("frames is \"{other}\"; write distal or proximal"))),
            },
            reading: reading(exact),
            gauge: Gauge::default(),
            parallelism: if exact { Parallelism::Exact } else { Parallelism::Within { angle: tolerance } },
            base: None,
            tip,
        };
        let made = py.detach(|| denavit_load::canonical(&self.loaded, &self.file, &options));
        let made = made.map_err(|error| load(&error))?;
        Ok((made.value, made.notes.iter().map(said).collect()))
    }

    /// The edited URDF, and a report with notes for each operation; each operation in words, as on the
    /// command line.
    fn edit(&self, py: Python<'_>, operations: Vec<Vec<String>>) -> PyResult<(String, Vec<String>)> {
        let Loaded::Robot(robot) = &*self.loaded else {
            return Err(argument(
                "edits change the text of a URDF; first make one from the table with robot.canonical()",
            ));
        };
        let files = Files::urdf(&*self.file, robot.source.text.clone());
        py.detach(|| {
            let steps = operations.into_iter().map(|line| operation(line, robot, &self.file));
            let steps = steps.collect::<PyResult<Vec<_>>>()?;
            let done = denavit_edit::apply(&files, &steps).map_err(|error| argument(error.to_string()))?;
            let said = done
                .reports
                .iter()
                .flat_map(|report| std::iter::once(report.to_string()).chain(report.notes.iter().cloned()));
            Ok((done.files.urdf.text, said.collect()))
        })
    }
}

/// Meshes of more bytes than this are not read.
const MOST: u64 = 1 << 30;

/// An operation on a robot from its words; the files that it takes are read.
fn operation(line: Vec<String>, robot: &denavit_model::Robot, file: &str) -> PyResult<Operation> {
    let wrong = |error: denavit_edit::EditError| argument(error.to_string());
    let mut words = Words::of(line).map_err(wrong)?;
    if words.copies_meshes() || words.takes_meshes() && words.to.is_some() {
        return Err(argument("this operation writes mesh files, but robot.edit returns only text; use `denavit edit`"));
    }
    if words.takes_meshes() {
        let meshes = denavit_load::meshes(robot, file, &Options::default(), MOST);
        let read = |mesh: denavit_load::MeshFile| (mesh.uri.clone(), denavit_load::triangles(&mesh.uri, &mesh.bytes));
        words.meshes = meshes.found.into_iter().map(read).collect();
        words.meshes.extend(meshes.missing.into_iter().map(|(uri, why)| (uri, Err(why))));
    }
    if let Some(name) = words.words.get(1).cloned() {
        let options = Options { arguments_for_another: true, ..Options::default() };
        if words.takes_a_robot() {
            let (file, written) = denavit_load::read_text(&name).map_err(|error| load(&error))?;
            let urdf = denavit_load::urdf_text(&file, written, &options, &ExportOptions::default());
            words.other = Some(Text { file, text: urdf.map_err(|error| load(&error))?.text });
        }
        if words.takes_a_calibration() {
            let opened = denavit_load::load(&name, &options).map_err(|error| load(&error))?.robot;
            if matches!(opened, Loaded::Table { .. }) {
                return Err(argument(
                    "a D-H table has its own zeros and frames; `denavit edit … set-calibration --nominal` applies it to a robot",
                ));
            }
            let selection = Selection { file: &name, reading: Reading::AsWritten, ..Selection::default() };
            let chain = opened.chain(&selection).map_err(|error| load(&error))?.value;
            words.actual = Some(Actual::Chain { chain: Box::new(chain), frames: denavit_edit::Frames::Own });
        }
    }
    Operation::of(&words).map_err(wrong)
}
