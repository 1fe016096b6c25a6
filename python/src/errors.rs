//! Errors of the library as the package's exceptions, with file, line, column and hint.

use denavit_load::LoadError;
use denavit_load::measured::MeasuredError;
use denavit_measurements::DataError;
use denavit_model::settings::{Shown, shown};
use denavit_model::words::readable;
use denavit_model::{Place, TreeError, UrdfError};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyModule};

/// A class of `denavit.errors`.
#[derive(Debug, Clone, Copy)]
pub enum Class {
    /// An invalid argument.
    Argument,
    /// A file that cannot be read.
    Read,
    /// A text that is not a valid robot.
    Robot,
    /// A chain that does not exist.
    Chain,
    /// A robot that a format cannot hold.
    Export,
    /// Measurements that cannot be read.
    Data,
    /// Measurements that cannot be fitted.
    Calibration,
    /// Not a manifest.
    Manifest,
    /// A fleet's store that cannot be read or written.
    Store,
}

impl Class {
    fn name(self) -> &'static str {
        match self {
            Self::Argument => "ArgumentError",
            Self::Read => "ReadError",
            Self::Robot => "RobotError",
            Self::Chain => "ChainError",
            Self::Export => "ExportError",
            Self::Data => "DataError",
            Self::Calibration => "CalibrationError",
            Self::Manifest => "ManifestError",
            Self::Store => "StoreError",
        }
    }
}

/// The place of an error.
#[derive(Debug, Default)]
pub struct Spot {
    /// As given.
    pub file: Option<String>,
    /// From 1.
    pub line: Option<usize>,
    /// From 1, in characters.
    pub column: Option<usize>,
    /// Such as `joint "elbow"`.
    pub element: Option<String>,
}

impl Spot {
    /// Somewhere in a file.
    pub fn file(file: &str) -> Self {
        Self { file: Some(file.to_owned()), ..Self::default() }
    }
}

impl From<&Place> for Spot {
    fn from(place: &Place) -> Self {
        Self {
            file: Some(place.file.clone()),
            line: Some(place.line),
            column: None,
            element: Some(place.element.clone()),
        }
    }
}

/// The exception of a class with this message; the hint is what the message says to do.
pub fn error(class: Class, message: &str, spot: Spot) -> PyErr {
    let message = said(message);
    Python::attach(|py| raised(py, class, &readable(&message), spot).unwrap_or_else(|error| error))
}

/// A message with its settings as the keywords that they are in Python.
pub fn said(message: impl std::fmt::Display) -> String {
    shown(&message.to_string(), Shown::Python).into_owned()
}

/// An invalid argument.
pub fn argument(message: impl AsRef<str>) -> PyErr {
    error(Class::Argument, message.as_ref(), Spot::default())
}

fn raised(py: Python<'_>, class: Class, message: &str, spot: Spot) -> PyResult<PyErr> {
    let module = PyModule::import(py, "denavit.errors")?;
    let options = PyDict::new(py);
    options.set_item("file", spot.file)?;
    options.set_item("line", spot.line)?;
    options.set_item("column", spot.column)?;
    options.set_item("element", spot.element)?;
    let made = module.getattr(class.name())?.call((message,), Some(&options))?;
    Ok(PyErr::from_value(made))
}

/// The exception of an error of reading a robot.
pub fn load(failure: &LoadError) -> PyErr {
    let message = failure.to_string();
    match failure {
        LoadError::Read { file, .. } => error(Class::Read, &message, Spot::file(file)),
        LoadError::NotText { file, line } => {
            error(Class::Read, &message, Spot { line: Some(*line), ..Spot::file(file) })
        }
        LoadError::Urdf(UrdfError { problems }) => {
            error(Class::Robot, &message, problems.first().map_or_else(Spot::default, |first| (&first.place).into()))
        }
        LoadError::Tree(failure) => tree(failure),
        LoadError::Source(source) => error(Class::Robot, &message, (&source.place).into()),
        LoadError::Xacro(xacro) => {
            let spot = xacro.place.as_ref().map_or_else(Spot::default, |place| Spot {
                file: Some(place.file.display().to_string()),
                line: Some(place.line),
                column: Some(place.column),
                element: None,
            });
            error(Class::Robot, &message, spot)
        }
        LoadError::Chain { file, .. } => error(Class::Robot, &message, Spot::file(file)),
        LoadError::OneChain { file, .. } => error(Class::Chain, &message, Spot::file(file)),
        LoadError::Export(_) => error(Class::Export, &message, Spot::default()),
        _ => error(Class::Robot, &message, Spot::default()),
    }
}

/// The exception for arguments and files that do not form a calibration.
pub fn measured(failure: &MeasuredError) -> PyErr {
    match failure {
        MeasuredError::Data(failure) => data(failure),
        MeasuredError::OutOfProportion(_) => error(Class::Robot, &failure.to_string(), Spot::default()),
        MeasuredError::Unreadable { file, .. } => error(Class::Read, &failure.to_string(), Spot::file(file)),
        other => argument(other.to_string()),
    }
}

/// The exception of measurements or poses that cannot be read, with the first line that is wrong.
pub fn data(failure: &DataError) -> PyErr {
    let first = failure.problems.first();
    let line = first.and_then(|first| usize::try_from(first.line).ok()).filter(|line| *line > 0);
    let spot = Spot { file: first.map(|first| first.file.clone()), line, ..Spot::default() };
    error(Class::Data, &failure.to_string(), spot)
}

/// The exception for measurements that cannot be calibrated from.
pub fn calibration(message: &str, file: &str) -> PyErr {
    error(Class::Calibration, message, Spot::file(file))
}

/// The exception for a chain that does not exist.
pub fn tree(failure: &TreeError) -> PyErr {
    let spot = match failure {
        TreeError::NoSuchLink { file, .. } => Spot::file(file),
        TreeError::Unsupported { place, .. } => place.into(),
        _ => Spot::default(),
    };
    error(Class::Chain, &failure.to_string(), spot)
}

/// An internal error: a caller cannot fix it.
pub fn broken(what: &str) -> PyErr {
    PyRuntimeError::new_err(what.to_owned())
}
