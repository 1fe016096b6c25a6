//! Robots made to one drawing: the coordinates in which they are pooled, and the resulting prior.
//!
//! Instrument and target differ for each robot, and a fit holds the common motion of all axes by its own conditions. Robots
//! therefore share only the directions orthogonal to common motions, each in the drawing's tolerances.

use crate::information::Information;
use crate::parameters::{Freedom, Layout, Parameter, Tolerances};
use crate::posterior::{Earlier, KnownParameter};
use crate::prior::{SourceKind, free_of_common_motions, sources};
use denavit_measurements::Scene;
use denavit_model::Chain;
use denavit_model::nalgebra::{DMatrix, DVector};

/// The coordinates of robots made to one drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    chain: Chain,
    parameters: Vec<Parameter>,
    unit: DVector<f64>,
    /// Orthonormal, a column for each coordinate.
    free: DMatrix<f64>,
    /// Change of the coordinates by one standard deviation of each error that the drawing's tolerances allow: errors of one kind, a
    /// column for each.
    pub sources: Vec<(SourceKind, DMatrix<f64>)>,
}

impl Drawing {
    /// For a chain with free axes, no scale and no pitch of a revolute joint.
    pub fn of(chain: &Chain) -> Self {
        let (freedom, tolerances) = (Freedom::axes(chain.joints().len()), Tolerances::default());
        let layout = Layout::new(chain, &Scene::default(), &freedom, &tolerances, Vec::new());
        let parameters = layout.parameters[layout.joints.clone()].to_vec();
        let free = free_of_common_motions(&parameters, &layout.bases, &layout.frames);
        let all = sources(chain, &parameters, &layout.bases, &layout.frames, &tolerances);
        let mut kinds: Vec<SourceKind> = all.iter().map(|source| source.of).collect();
        kinds.sort_unstable();
        kinds.dedup();
        let of_kind = |kind: SourceKind| {
            let own = all.iter().filter(|source| source.of == kind);
            let columns: Vec<DVector<f64>> = own.map(|source| free.tr_mul(&source.moved)).collect();
            (kind, DMatrix::from_columns(&columns))
        };
        Self {
            chain: chain.clone(),
            unit: DVector::from_fn(parameters.len(), |k, _| parameters[k].tolerance.unwrap_or(1.0)),
            sources: kinds.into_iter().map(of_kind).collect(),
            parameters,
            free,
        }
    }

    /// The changes by the errors of each kind, without their names.
    pub fn moved(&self) -> Vec<DMatrix<f64>> {
        self.sources.iter().map(|(_, moved)| moved.clone()).collect()
    }

    /// Information of a robot's rows in the coordinates: matrix and vector. `None` where other parameters were fitted to them.
    pub fn in_coordinates(&self, by: &Information) -> Option<(DMatrix<f64>, DVector<f64>)> {
        if by.parameters.len() != self.parameters.len() {
            return None;
        }
        let at = |parameter: &Parameter| by.parameters.iter().position(|name| *name == parameter.name);
        let at = self.parameters.iter().map(at).collect::<Option<Vec<usize>>>()?;
        let scaled = |i: usize, k: usize| by.matrix[(at[i], at[k])] * self.unit[i] * self.unit[k];
        let matrix = DMatrix::from_fn(at.len(), at.len(), scaled);
        let pull = DVector::from_fn(at.len(), |i, _| by.pull[at[i]] * self.unit[i]);
        Some((self.free.transpose() * matrix * &self.free, self.free.tr_mul(&pull)))
    }

    /// The prior of a robot with this mean and covariance, both in the coordinates.
    pub fn prior(&self, mean: &DVector<f64>, covariance: &DMatrix<f64>) -> Earlier {
        let mean = (&self.free * mean).component_mul(&self.unit);
        let covariance = &self.free * covariance * self.free.transpose();
        let std = |k: usize| covariance[(k, k)].max(0.0).sqrt();
        let known = |(k, parameter): (usize, &Parameter)| KnownParameter {
            parameter: parameter.name.clone(),
            change: mean[k],
            std: std(k) * self.unit[k],
            unit: parameter.unit.into(),
        };
        let correlation = |i: usize, k: usize| {
            let size = std(i) * std(k);
            if size > 0.0 { (covariance[(i, k)] / size).clamp(-1.0, 1.0) } else { 0.0 }
        };
        let correlations = (0..self.parameters.len()).map(|i| (0..i).map(|k| correlation(i, k)).collect()).collect();
        Earlier::of_siblings(&self.chain, self.parameters.iter().enumerate().map(known).collect(), correlations)
    }
}
