//! Arrays of numpy in and out: joint values without a copy where that is possible, results into `out`.

use crate::errors::argument;
use numpy::{PyArrayDyn, PyArrayMethods as _, PyReadonlyArrayDyn, PyReadwriteArrayDyn, PyUntypedArrayMethods as _};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyModule, PyTuple};
use std::num::NonZeroUsize;

/// Below this many configurations the interpreter stays locked: releasing it costs more than the work.
pub const FEW: usize = 64;

/// Joint values of one or many configurations: the last axis is the coordinates.
pub struct Configurations<'py> {
    array: PyReadonlyArrayDyn<'py, f64>,
    coordinates: usize,
}

impl<'py> Configurations<'py> {
    /// A contiguous array of f64 is used without a copy; everything else that numpy can convert is copied.
    pub fn of(q: &Bound<'py, PyAny>, coordinates: usize) -> PyResult<Self> {
        let array = match in_order(q) {
            Some(array) => array,
            None => unnamed(q)?,
        };
        let last = array.shape().last().copied();
        if last != Some(coordinates) {
            let found = match last {
                None => "a single number".to_owned(),
                Some(_) => format!("an array of shape {}", shape_words(array.shape())),
            };
            return Err(argument(format!(
                "q is {found}, but the chain has {coordinates} coordinates; the last axis of q has one value for each"
            )));
        }
        let array = array.try_readonly().map_err(|error| argument(format!("q: {error}")))?;
        Ok(Self { array, coordinates })
    }

    /// One configuration after the other.
    pub fn values(&self) -> PyResult<&[f64]> {
        self.array.as_slice().map_err(|error| argument(format!("q: {error}")))
    }

    /// How many.
    pub fn count(&self) -> usize {
        self.array.len().checked_div(self.coordinates).unwrap_or_else(|| self.leading().iter().product())
    }

    /// The array's shape without its last axis.
    pub fn leading(&self) -> &[usize] {
        let shape = self.array.shape();
        &shape[..shape.len() - 1]
    }
}

/// A shape as Python writes it.
pub fn shape_words(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        several => format!("({})", several.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
    }
}

/// A contiguous array of f64, without a copy.
pub fn in_order<'py>(given: &Bound<'py, PyAny>) -> Option<Bound<'py, PyArrayDyn<f64>>> {
    given.cast::<PyArrayDyn<f64>>().ok().filter(|array| array.is_c_contiguous()).cloned()
}

/// An array without names of columns.
fn unnamed<'py>(q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let fields = q.getattr("dtype").and_then(|dtype| dtype.getattr("names")).is_ok_and(|names| !names.is_none());
    if fields {
        return Err(argument(
            "q is a structured array; give a data frame, a mapping by joint name, or plain rows of numbers",
        ));
    }
    contiguous(q).map_err(|error| argument(format!("q is not an array of numbers ({error})")))
}

/// Whatever numpy converts to a contiguous array of f64.
pub fn contiguous<'py>(given: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let py = given.py();
    let options = PyDict::new(py);
    options.set_item("dtype", "float64")?;
    let made = PyModule::import(py, "numpy")?.getattr("ascontiguousarray")?.call((given,), Some(&options))?;
    // A number becomes an array of one; it has no axis of coordinates.
    Ok(made.cast_into::<PyArrayDyn<f64>>()?)
}

/// A new array of zeros. Numpy's own function raises `MemoryError` where there is no room; `PyArray::zeros` panics.
fn zeros<'py>(py: Python<'py>, shape: &[usize]) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    static ZEROS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let made = ZEROS.import(py, "numpy", "zeros")?.call1((PyTuple::new(py, shape)?,))?;
    Ok(made.cast_into::<PyArrayDyn<f64>>()?)
}

/// A result array: `out` where it is given, else a new one.
pub fn result<'py>(
    py: Python<'py>,
    out: Option<&Bound<'py, PyAny>>,
    shape: &[usize],
) -> PyResult<(Bound<'py, PyArrayDyn<f64>>, PyReadwriteArrayDyn<'py, f64>)> {
    let array = match out {
        None => zeros(py, shape)?,
        Some(out) => {
            let wanted = shape_words(shape);
            let refused =
                |why: String| argument(format!("out {why}; give a C-contiguous float64 array of shape {wanted}"));
            let Ok(array) = out.cast::<PyArrayDyn<f64>>() else {
                return Err(refused("is not an array of float64".into()));
            };
            if array.shape() != shape {
                return Err(refused(format!("has shape {}", shape_words(array.shape()))));
            }
            if !array.is_c_contiguous() {
                return Err(refused("is not C-contiguous".into()));
            }
            array.clone()
        }
    };
    let writable = array.try_readwrite();
    let writable = writable.map_err(|error| argument(format!("out cannot be written to: {error}")))?;
    Ok((array, writable))
}

/// How many threads to share the work among; 0: as many as there are cores.
pub fn threads(wanted: usize, count: usize) -> NonZeroUsize {
    let all = || std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
    let wanted = NonZeroUsize::new(wanted).unwrap_or_else(all);
    if count < FEW { NonZeroUsize::MIN } else { wanted }
}
