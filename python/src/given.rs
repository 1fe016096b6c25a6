//! Effects that a calibration found: error curves of joints, and joint commands that reach poses in spite of them.

#![expect(clippy::needless_pass_by_value, reason = "what Python calls with is handed over by value")]

use crate::chain::Chain;
use crate::errors::{argument, data, measured};
use crate::given_file::Given;
use crate::robot::{ORTHONORMAL, reading};
use crate::run::joint_rows;
use denavit_calibrate::apply::compensate::{Allowed, in_order};
use denavit_calibrate::report::commands::{summary, to_csv, to_json};
use denavit_identify::effects::driver::{APPROACH, Conditions};
use denavit_identify::effects::{SavedEffects, recorded};
use denavit_load::measured::{all_known, with_given, without_part_in_the_tip};
use denavit_measurements::Units;
use denavit_measurements::poses::{self, Poses};
use denavit_model::Pose;
use denavit_model::nalgebra::{Matrix3, Rotation3, Vector3};
use denavit_model::se3;
use numpy::{
    PyArray1, PyArray3, PyArrayMethods as _, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3,
    PyUntypedArrayMethods as _,
};
use pyo3::prelude::*;

/// What messages call the effects.
const EFFECTS: &str = "effects";

/// Effects and error curves of a robot.
#[pyclass(frozen, module = "denavit._denavit")]
pub struct Effects {
    model: SavedEffects,
}

/// Values of a curve and their standard deviations.
type CurveValues<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// Poses to reach.
#[derive(FromPyObject)]
#[expect(clippy::large_enum_variant, reason = "one is held at a time")]
pub enum Wanted<'py> {
    /// A file.
    File(Given),
    /// base_from_tip, shape (N, 4, 4).
    Matrices(PyReadonlyArray3<'py, f64>),
    /// Joint values, which stand for the poses that the robot as drawn has there, shape (N, n).
    Joints(PyReadonlyArray2<'py, f64>),
}

#[pymethods]
impl Effects {
    /// Reads the effects of a chain.
    #[new]
    fn new(chain: &Chain, text: &str) -> PyResult<Self> {
        let statics = chain.loaded.statics(&chain.chain, reading(chain.exact));
        let model =
            SavedEffects::from_json(EFFECTS, text, &statics).map_err(|failure| argument(failure.to_string()))?;
        Ok(Self { model })
    }

    /// The error curve of a joint at readings (rad, m), and its standard deviation there; `None` where it has none. What was found
    /// beside an earlier curve is a curve of its own: they add up.
    fn curve<'py>(
        &self,
        py: Python<'py>,
        joint: &str,
        q: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Option<CurveValues<'py>>> {
        let joints = self.model.statics.chain.joints();
        let own: Vec<_> = self.model.curves.iter().filter(|curve| joints[curve.joint].name == joint).collect();
        if own.is_empty() {
            return Ok(None);
        }
        let q = q.as_slice().map_err(|failure| argument(failure.to_string()))?;
        let value = |at: &f64| own.iter().map(|curve| curve.value(*at)).sum::<f64>();
        let deviation = |at: &f64| own.iter().map(|curve| curve.deviation(*at).powi(2)).sum::<f64>().sqrt();
        let values = PyArray1::from_iter(py, q.iter().map(value));
        Ok(Some((values, PyArray1::from_iter(py, q.iter().map(deviation)))))
    }

    /// base_from_tip of a calibrated chain with these effects, homogeneous matrices row by row, shape (N, 4, 4).
    fn fk<'py>(
        &self,
        py: Python<'py>,
        calibrated: &Chain,
        q: PyReadonlyArray2<'py, f64>,
        given: Vec<(String, f64)>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let chain = &calibrated.chain;
        let rows = joint_rows("q", &q, chain)?;
        let (model, recorded) = with_given(EFFECTS, &self.model, &given).map_err(|failure| measured(&failure))?;
        let poses = py.detach(|| {
            let pose = |reading: &Vec<f64>| {
                model.fk(chain, &Conditions { reading, recorded: recorded.row(0), tip: 0 }).to_homogeneous().transpose()
            };
            rows.iter().flat_map(|reading| pose(reading).as_slice().to_vec()).collect::<Vec<f64>>()
        });
        PyArray1::from_vec(py, poses).reshape([rows.len(), 4, 4])
    }

    /// Commands with which the calibrated robot reaches poses: JSON and CSV of `denavit compensate`, text, notes.
    fn compensate(
        &self,
        py: Python<'_>,
        nominal: &Chain,
        calibrated: &Chain,
        wanted: Wanted<'_>,
        given: Vec<(String, f64)>,
        allowed: (f64, f64),
    ) -> PyResult<(String, String, String, Vec<String>)> {
        let (drawn, as_it_is) = (&nominal.chain, &calibrated.chain);
        let poses = match wanted {
            Wanted::File(given) => {
                let file = given.file()?;
                poses::read_export(&file.name, file.content.open(), as_it_is, file.units, &file.import)
                    .map_err(|failure| data(&failure))?
            }
            Wanted::Matrices(array) => of_matrices(&array)?,
            Wanted::Joints(array) => of_joints(joint_rows("poses", &array, drawn)?),
        };
        let allowed = Allowed { position: allowed.0, orientation: allowed.1 };
        let good = [allowed.position, allowed.orientation].iter().all(|miss| miss.is_finite() && *miss >= 0.0);
        if !good {
            return Err(argument("allowed_miss: write two numbers of 0 or more, m and rad"));
        }
        let known = |name: &str| {
            recorded::plain(name).ends_with(APPROACH)
                || recorded::given(&given, name).is_some()
                || poses.covariates.iter().any(|column| column.name == name)
        };
        all_known(EFFECTS, &self.model, &known).map_err(|failure| measured(&failure))?;
        let commands = py.detach(|| in_order(drawn, as_it_is, &self.model, &poses, &given, allowed));
        let commands = commands.map_err(|missing| argument(missing.to_string()))?;
        let said = summary(&commands, &poses.lines, allowed);
        let csv = to_csv(drawn, &commands, allowed, Units::default(), &said);
        let notes = without_part_in_the_tip(EFFECTS, &self.model);
        Ok((to_json(drawn, &commands, &poses.lines, allowed), csv, said, notes))
    }
}

fn of_joints(joints: Vec<Vec<f64>>) -> Poses {
    let lines = (1..=joints.len()).collect();
    Poses { joints, poses: Vec::new(), covariates: Vec::new(), lines }
}

fn of_matrices(array: &PyReadonlyArray3<'_, f64>) -> PyResult<Poses> {
    let shape = array.shape();
    if shape[1..] != [4, 4] || shape[0] == 0 {
        return Err(argument(format!("poses has shape {shape:?}; write one or more homogeneous matrices, (N, 4, 4)")));
    }
    let values = array.as_slice().map_err(|failure| argument(format!("poses: {failure}")))?;
    let (matrices, _) = values.as_chunks::<16>();
    let poses = matrices.iter().enumerate().map(|(index, matrix)| {
        rigid(matrix).ok_or_else(|| {
            argument(format!(
                "poses[{index}] is not a homogeneous matrix; its upper left 3 by 3 must be a rotation, its last row 0 0 0 1"
            ))
        })
    });
    let poses = poses.collect::<PyResult<Vec<Pose>>>()?;
    let lines = (1..=poses.len()).collect();
    Ok(Poses { joints: Vec::new(), poses, covariates: Vec::new(), lines })
}

fn rigid(m: &[f64; 16]) -> Option<Pose> {
    let turn = Matrix3::new(m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]);
    let off = (turn.transpose() * turn - Matrix3::identity()).amax();
    let good = off < ORTHONORMAL && turn.determinant() > 0.0 && m[12..] == [0.0, 0.0, 0.0, 1.0];
    let place = Vector3::new(m[3], m[7], m[11]);
    (good && place.iter().all(|value| value.is_finite())).then(|| se3::pose(Rotation3::from_matrix(&turn), place))
}
