//! A calibration as a page with plots, in one file.

use crate::calibration::{Calibration, StageResiduals};
use crate::measurements::MeasurementKind;
use crate::report::plots::{self, Plot, PlotError};
use crate::report::text;
use denavit_model::nalgebra::Vector3;
use minijinja::value::Serde;
use minijinja::{AutoEscape, Environment, Value, context};
use thiserror::Error;

const PAGE: &str = include_str!("page.html");

/// The page could not be made.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PageError {
    /// A plot has values that are not finite.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// The template does not take the result.
    #[error("the page could not be filled in")]
    Template(#[source] Box<dyn std::error::Error + Send + Sync>),
}

/// The page: summary, residuals on the robot, histograms, residuals against each joint, parameters.
///
/// # Errors
/// A plot has values that are not finite.
pub fn page(result: &Calibration) -> Result<String, PageError> {
    let (Some(before), Some(after)) = (result.residuals.first(), result.residuals.last()) else {
        return Err(PlotError.into());
    };
    let joint_plots: Vec<Plot> = (0..result.train.joints.len())
        .map(|coordinate| plots::against_joint(&result.train, coordinate, before, after))
        .collect::<Result<_, _>>()?;
    let mut environment = Environment::new();
    environment.set_auto_escape_callback(|_| AutoEscape::Html);
    environment
        .render_str(
            PAGE,
            context! {
                robot => result.report.robot.clone(),
                last => after.name.clone(),
                rows => result.train.len(),
                summary => text::calibration(result),
                robot_plots => Value::from(Serde(on_robot(result, before, after)?)),
                histograms => Value::from(Serde([plots::histogram(before, after)?])),
                joint_plots => Value::from(Serde(joint_plots)),
                parameters => text::parameters(&result.identification.geometric),
            },
        )
        .map_err(|error| PageError::Template(Box::new(error)))
}

/// Side and top view; none for distances, which have no direction.
fn on_robot(result: &Calibration, before: &StageResiduals, after: &StageResiduals) -> Result<Vec<Plot>, PlotError> {
    if result.train.kind == MeasurementKind::Distance {
        return Ok(Vec::new());
    }
    let arm = result.arm();
    let chain = &arm.nominal;
    let skeleton: Vec<Vector3<f64>> = chain.skeleton().iter().map(|point| point.coords).collect();
    let (mut places, mut first, mut last) = (Vec::new(), Vec::new(), Vec::new());
    for residual in &after.train {
        let twin = before.train.iter().find(|other| (other.row, other.target) == (residual.row, residual.target));
        let Some(twin) = twin else { continue };
        let tip = chain.fk(result.train.reading(residual.row));
        places.push(tip.rotation * arm.targets[residual.target].translation.vector + tip.translation.vector);
        first.push(twin.position);
        last.push(residual.position);
    }
    let view = |axes| plots::on_robot(&skeleton, &places, [&first, &last], axes);
    Ok(vec![view([0, 2])?, view([0, 1])?])
}
