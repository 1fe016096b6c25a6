//! A chain: forward kinematics, Jacobians, joint values, tables.

use crate::arrays::{self, Configurations, FEW, result};
use crate::errors::{argument, load, said};
use crate::poses::{Matrices, pose};
use crate::robot::{convention, reading};
use crate::table::Table;
use denavit_dh::Gauge;
use denavit_export::{Units, poe};
use denavit_identify::simulate;
use denavit_ik::{Branch, Solutions, Solver};
use denavit_load::{Loaded, Selection, TableOptions};
use denavit_model::chain::Quantity;
use denavit_model::{CompiledChain, JacobianFrame, Note, Noted};
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;
use std::num::NonZeroUsize;
use std::sync::{Arc, OnceLock};

/// Name, `angle` or `length`, lower and upper limit, velocity, effort, continuous.
type CoordinateEntry = (String, &'static str, Option<f64>, Option<f64>, Option<f64>, Option<f64>, bool);

/// Solutions of inverse kinematics for each pose, as many as the pose with the most has: joint values (NaN where there are fewer), branches by their
/// place among [`branch_names`], whether they reach the pose within limits; for each pose whether it is reached; the method.
type Branches<'py> = (
    Bound<'py, PyArrayDyn<f64>>,
    Bound<'py, PyArrayDyn<i8>>,
    Bound<'py, PyArrayDyn<bool>>,
    Bound<'py, PyArrayDyn<bool>>,
    String,
);

/// The index for an unnamed branch.
const NAMELESS: i8 = 8;

/// The place of a branch among the names.
fn code(branch: Option<Branch>) -> i8 {
    branch.map_or(NAMELESS, |Branch { front, elbow_up, flipped }| {
        i8::from(front) | (i8::from(elbow_up) << 1) | (i8::from(flipped) << 2)
    })
}

/// Names of branches in the order of their indices; the last means no branch.
#[pyfunction]
pub fn branch_names() -> Vec<Option<String>> {
    let named = |code: u8| Branch { front: code & 1 != 0, elbow_up: code & 2 != 0, flipped: code & 4 != 0 };
    (0..8).map(|code| Some(named(code).to_string())).chain([None]).collect()
}

/// A chain of joints from a base to a tip.
#[pyclass(frozen, module = "denavit._denavit")]
#[expect(clippy::struct_field_names, reason = "it wraps the chain of the library, under the same name")]
pub struct Chain {
    pub loaded: Arc<Loaded>,
    pub file: Arc<str>,
    pub chain: denavit_model::Chain,
    pub notes: Vec<Note>,
    pub exact: bool,
    compiled: CompiledChain,
    /// Made where it is first asked for: a general arm's costs as much as some hundred poses.
    solver: OnceLock<Solver>,
    method: OnceLock<String>,
}

impl Chain {
    pub fn new(loaded: Arc<Loaded>, file: Arc<str>, noted: Noted<denavit_model::Chain>, exact: bool) -> Self {
        let Noted { value: chain, notes } = noted;
        let compiled = CompiledChain::new(&chain);
        Self { loaded, file, chain, notes, exact, compiled, solver: OnceLock::new(), method: OnceLock::new() }
    }

    fn selection(&self) -> Selection<'_> {
        Selection {
            file: &self.file,
            base: Some(self.chain.base()),
            tip: Some(self.chain.tip()),
            reading: reading(self.exact),
        }
    }
}

/// Solutions for one pose after another, as many places for each.
struct Rows {
    n: usize,
    places: usize,
    joints: Vec<f64>,
    codes: Vec<i8>,
    within: Vec<bool>,
    reached: Vec<bool>,
    /// The most solutions of a pose.
    most: usize,
}

impl Rows {
    /// Places for the branches that have names.
    fn new(poses: usize, n: usize) -> Self {
        let places = usize::from(NAMELESS.unsigned_abs());
        Self {
            n,
            places,
            joints: Vec::with_capacity(poses * places * n),
            codes: Vec::with_capacity(poses * places),
            within: Vec::with_capacity(poses * places),
            reached: Vec::with_capacity(poses),
            most: 0,
        }
    }

    fn push(&mut self, solutions: &Solutions) {
        if solutions.len() > self.places {
            self.relay(solutions.len());
        }
        self.most = self.most.max(solutions.len());
        for (joints, found) in solutions.iter() {
            self.joints.extend_from_slice(joints);
            self.codes.push(code(found.branch));
            self.within.push(found.within_limits && solutions.reached());
        }
        self.reached.push(solutions.reached());
        let filled = self.reached.len() * self.places;
        self.joints.resize(filled * self.n, f64::NAN);
        self.codes.resize(filled, NAMELESS);
        self.within.resize(filled, false);
    }

    /// Gives each pose another number of places.
    fn relay(&mut self, places: usize) {
        fn relaid<T: Copy>(rows: &[T], from: usize, to: usize, with: T) -> Vec<T> {
            let kept = from.min(to);
            rows.chunks_exact(from)
                .flat_map(|row| row[..kept].iter().copied().chain(std::iter::repeat_n(with, to - kept)))
                .collect()
        }
        if places != self.places {
            self.joints = relaid(&self.joints, self.places * self.n, places * self.n, f64::NAN);
            self.codes = relaid(&self.codes, self.places, places, NAMELESS);
            self.within = relaid(&self.within, self.places, places, false);
            self.places = places;
        }
    }
}

/// The work, with the interpreter unlocked where there is much of it.
pub(crate) fn worked(py: Python<'_>, count: usize, work: impl FnOnce() + Send) {
    if count < FEW { work() } else { py.detach(work) }
}

/// A result for each of the configurations: into `out` where it is given, else into a new array of their shape and `each`.
///
/// `fill` takes how many threads may share the work, the joint values one after the other, and the numbers to fill.
fn filled<'py>(
    q: &Configurations<'py>,
    each: &[usize],
    out: Option<&Bound<'py, PyAny>>,
    threads: usize,
    py: Python<'py>,
    fill: impl FnOnce(NonZeroUsize, &[f64], &mut [f64]) + Send,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let shape: Vec<usize> = q.leading().iter().chain(each).copied().collect();
    let (array, mut writable) = result(py, out, &shape)?;
    let (values, count) = (q.values()?, q.count());
    let numbers = writable.as_slice_mut().map_err(|error| argument(error.to_string()))?;
    worked(py, count, || fill(arrays::threads(threads, count), values, numbers));
    Ok(array)
}

#[pymethods]
impl Chain {
    /// The robot's name.
    #[getter]
    fn name(&self) -> &str {
        self.chain.name()
    }

    /// Base link.
    #[getter]
    fn base(&self) -> &str {
        self.chain.base()
    }

    /// Tip link.
    #[getter]
    fn tip(&self) -> &str {
        self.chain.tip()
    }

    /// The robot's size, m.
    #[getter]
    fn size(&self) -> f64 {
        self.chain.size()
    }

    /// Whether every number was read exactly as written.
    #[getter]
    fn exact(&self) -> bool {
        self.exact
    }

    /// What was read differently from what is written.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.iter().map(said).collect()
    }

    /// The largest motion of the tip due to what the notes describe, m.
    #[getter]
    fn tip_moves_at_most(&self) -> f64 {
        self.notes.iter().map(Note::tip_moves).sum()
    }

    /// Its coordinates, in order.
    fn coordinates(&self) -> Vec<CoordinateEntry> {
        let entry = |coordinate: &denavit_model::Coordinate| {
            let quantity = match coordinate.quantity {
                Quantity::Angle => "angle",
                Quantity::Length => "length",
            };
            let limits = coordinate.limits;
            (
                coordinate.name.clone(),
                quantity,
                limits.range.map(|(lower, _)| lower),
                limits.range.map(|(_, upper)| upper),
                limits.velocity,
                limits.effort,
                coordinate.continuous,
            )
        };
        self.chain.coordinates().iter().map(entry).collect()
    }

    /// Lowest and highest value of each coordinate that sampling takes, one after the other.
    fn ranges<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let ends = self.chain.coordinates().iter().flat_map(|coordinate| <[f64; 2]>::from(coordinate.range()));
        PyArray1::from_iter(py, ends)
    }

    /// Screw axes and home pose: `text`, `csv` or `json`.
    fn poe(&self, format: &str) -> PyResult<String> {
        match format {
            "json" => Ok(poe::json(&self.chain, &self.notes)),
            "csv" => Ok(poe::csv(&self.chain)),
            "text" => Ok(said(poe::text(&self.chain, &self.notes, Units::default()))),
            other => Err(argument(format!("format is \"{other}\"; write text, csv or json"))),
        }
    }

    /// base_from_tip as homogeneous matrices.
    #[pyo3(signature = (q, out, threads))]
    fn fk<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
        threads: usize,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let q = Configurations::of(q, self.compiled.coordinates())?;
        filled(&q, &[4, 4], out, threads, py, |threads, values, numbers| {
            self.compiled.matrices_into_by_threads(threads, values, numbers.as_chunks_mut::<16>().0);
        })
    }

    /// Joint values that reach poses, one after the other; the next pose is sought next to the solution of the one before.
    fn ik<'py>(&self, py: Python<'py>, poses: &Bound<'py, PyAny>, near: Option<Vec<f64>>) -> PyResult<Branches<'py>> {
        let poses = Matrices::of("poses", poses)?;
        let matrices = poses.each()?;
        let count = matrices.len();
        let n = self.compiled.coordinates();
        let solver = self.solver.get_or_init(|| Solver::new(&self.chain));
        let mut rows = Rows::new(count, n);
        worked(py, count, || {
            let (mut solutions, mut from) = (Solutions::default(), near.unwrap_or_else(|| vec![0.0; n]));
            for matrix in matrices {
                solver.solve_into(&pose(matrix), &from, &mut solutions);
                if let Some((joints, _)) = solutions.iter().next().filter(|_| solutions.reached()) {
                    from.copy_from_slice(joints);
                }
                rows.push(&solutions);
            }
        });
        rows.relay(rows.most);
        let Rows { joints, codes, within, reached, most, .. } = rows;
        Ok((
            PyArray1::from_vec(py, joints).reshape(poses.shape(&[most, n]))?,
            PyArray1::from_vec(py, codes).reshape(poses.shape(&[most]))?,
            PyArray1::from_vec(py, within).reshape(poses.shape(&[most]))?,
            PyArray1::from_vec(py, reached).reshape(poses.shape(&[]))?,
            self.method.get_or_init(|| solver.method().to_string()).clone(),
        ))
    }

    /// The tip's origin in the base frame.
    #[pyo3(signature = (q, out, threads))]
    fn tips<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
        threads: usize,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let q = Configurations::of(q, self.compiled.coordinates())?;
        filled(&q, &[3], out, threads, py, |threads, values, numbers| {
            self.compiled.tips_into_by_threads(threads, values, numbers.as_chunks_mut::<3>().0);
        })
    }

    /// Jacobians, angular rows first.
    #[pyo3(signature = (q, frame, out, threads))]
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        frame: &str,
        out: Option<&Bound<'py, PyAny>>,
        threads: usize,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let frame = match frame {
            "space" | "world" => JacobianFrame::Space,
            "body" | "local" => JacobianFrame::Body,
            "tip" | "local_world_aligned" => JacobianFrame::Tip,
            other => {
                return Err(argument(format!(
                    "frame is \"{other}\"; write space (world), body (local) or tip (local_world_aligned)"
                )));
            }
        };
        let n = self.compiled.coordinates();
        let q = Configurations::of(q, n)?;
        filled(&q, &[6, n], out, threads, py, |threads, values, numbers| {
            self.compiled.jacobians_into_by_threads(threads, frame, values, numbers);
        })
    }

    /// Random joint values within the limits.
    #[pyo3(signature = (count, seed))]
    fn sample<'py>(&self, py: Python<'py>, count: usize, seed: u64) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (array, mut writable) = result(py, None, &[count, self.compiled.coordinates()])?;
        let numbers = writable.as_slice_mut().map_err(|error| argument(error.to_string()))?;
        worked(py, count, || simulate::readings_into(&self.chain, seed, numbers));
        Ok(array)
    }

    /// The chain's table.
    #[pyo3(signature = (convention, gauge, tolerance))]
    fn table(&self, py: Python<'_>, convention: Option<&str>, gauge: Option<&str>, tolerance: f64) -> PyResult<Table> {
        let options = TableOptions {
            convention: convention.map(|word| self::convention("convention", word)).transpose()?,
            gauge: match gauge {
                None => None,
                Some("simple") => Some(Gauge::Simple),
                Some("paper") => Some(Gauge::Paper),
                Some(other) => return Err(argument(format!("gauge is \"{other}\"; write simple or paper"))),
            },
            tolerance,
        };
        let made = py.detach(|| self.loaded.table(&self.selection(), &options)).map_err(|error| load(&error))?;
        Ok(Table { made, chain: self.chain.clone(), file: Arc::clone(&self.file) })
    }
}
