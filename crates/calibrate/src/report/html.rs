//! A calibration as a page with plots, in one file.

use crate::apply::plan::tell_apart::Prospect;
use crate::calibration::{Calibration, StageResiduals};
use crate::report::findings::{self, Said};
use crate::report::plots::{self, Plot, PlotError};
use crate::report::{curve_plots, rows, text, trace_plots, trust};
use denavit_identify::arm::Arm;
use denavit_identify::effects::catalogue::{KINDS, Kind};
use denavit_model::nalgebra::Vector3;
use denavit_trace::Trace;
use minijinja::value::Serde;
use minijinja::{AutoEscape, Environment, Value, context};
use serde::Serialize;
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

/// The page: summary, effects against their drivers, the scan, residuals, residuals on the robot and against each
/// joint, parameters.
///
/// # Errors
/// A plot has values that are not finite.
pub fn page(result: &Calibration) -> Result<String, PageError> {
    let [before, after] = &result.first_and_last();
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
                attention => trust::supposed(&result.report).lines().map(str::to_owned).collect::<Vec<String>>(),
                summary => text::calibration(result),
                robot_plots => Value::from(Serde(on_robot(result, before, after)?)),
                histograms => Value::from(Serde([plots::histogram(before, after)?])),
                joint_plots => Value::from(Serde(joint_plots)),
                stages => Value::from(Serde(&result.report.stages)),
                distances => result.train.scene.channels.iter().all(|part| part.height == 1),
                poses => result.train.scene.channels.iter().any(|part| part.unit == "rad"),
                effects => Value::from(Serde(effects(result)?)),
                curves => Value::from(Serde(curves(result)?)),
                prospect => result.report.prospect.as_ref().and_then(Prospect::in_short),
                structure => result.trace.as_ref().and_then(findings::structure),
                scan => Value::from(Serde(result.trace.as_ref().map(scan))),
                remains => Value::from(Serde(remains(result, after)?)),
                parameters => text::final_parameters(result),
                origin => Value::from(Serde(&result.report.origin)),
                worst_rows => rows::worst(&result.report.rows),
                placements => result.report.placements.as_ref().map(rows::placements),
                tables => Value::from(Serde(rows::tables(result))),
            },
        )
        .map_err(|error| PageError::Template(Box::new(error)))
}

/// Error curves, then deflections of joints under gravity.
fn curves(result: &Calibration) -> Result<Vec<Plot>, PlotError> {
    let mut plots = result.report.curves.iter().map(curve_plots::curve).collect::<Result<Vec<Plot>, PlotError>>()?;
    plots.extend(curve_plots::fields(result)?);
    Ok(plots)
}

/// An effect with its words and its two plots.
#[derive(Serialize)]
struct EffectShown {
    #[serde(flatten)]
    said: Said,
    plots: [Plot; 2],
}

fn effects(result: &Calibration) -> Result<Vec<EffectShown>, PlotError> {
    let Some(trace) = &result.trace else { return Ok(Vec::new()) };
    let shown = findings::named_first(trace).into_iter().map(|finding| {
        let name = format!("{} at {}", finding.term.kind.name(), finding.place);
        Ok(EffectShown {
            said: findings::said(finding, trace),
            plots: trace_plots::partial_residuals(&finding.partial_residuals, &name)?,
        })
    });
    shown.collect()
}

/// The first pass of the search as a table: kinds down, places across.
#[derive(Serialize)]
struct Scan {
    places: Vec<String>,
    kinds: Vec<ScanLine>,
}

#[derive(Serialize)]
struct ScanLine {
    kind: &'static str,
    cells: Vec<Option<ScanShown>>,
}

/// Decrease of the criterion, and the darkness of its cell, 0 to 1.
#[derive(Serialize)]
struct ScanShown {
    delta_bic: f64,
    shade: f64,
}

fn scan(trace: &Trace) -> Scan {
    let mut places: Vec<String> = Vec::new();
    for cell in &trace.scan {
        if !places.contains(&cell.place) {
            places.push(cell.place.clone());
        }
    }
    // Joints in the order of the arm, all else after them.
    let chain = &trace.fit.arm.nominal;
    let order = |place: &String| chain.joints().iter().position(|joint| joint.name == *place).unwrap_or(usize::MAX);
    places.sort_by_key(order);
    let most = trace.scan.iter().map(|cell| cell.delta_bic).fold(1.0, f64::max);
    let line = |kind: Kind| {
        let of_place = |place: &String| {
            let cell = trace.scan.iter().find(|cell| cell.kind == kind && cell.place == *place)?;
            let shade = (cell.delta_bic.max(0.0) / most).sqrt();
            cell.delta_bic.is_finite().then_some(ScanShown { delta_bic: cell.delta_bic.round(), shade })
        };
        ScanLine { kind: kind.name(), cells: places.iter().map(of_place).collect() }
    };
    let tried = KINDS.iter().filter(|entry| trace.scan.iter().any(|cell| cell.kind == entry.kind));
    Scan { kinds: tried.map(|entry| line(entry.kind)).collect(), places }
}

fn remains(result: &Calibration, after: &StageResiduals) -> Result<[Plot; 2], PlotError> {
    let noise = result.named().map_or(&result.identification.geometric.noise, |fit| &fit.noise);
    let scene = &result.train.scene;
    Ok([trace_plots::quantiles(&after.train, scene, noise)?, trace_plots::autocorrelation(&after.train, scene, noise)?])
}

/// One line along the arm, base to tip; of several arms each there and back but the last, m.
fn skeleton(arm: &Arm) -> Vec<Vector3<f64>> {
    let mut line: Vec<Vector3<f64>> = Vec::new();
    for tip in 0..arm.tips.all().len() {
        line.extend(line.clone().iter().rev());
        line.extend(arm.nominal_to(tip).skeleton().iter().map(|point| point.coords));
    }
    line
}

/// Side and top view; none for distances, which have no direction.
fn on_robot(result: &Calibration, before: &StageResiduals, after: &StageResiduals) -> Result<Vec<Plot>, PlotError> {
    let scene = &result.train.scene;
    if scene.channels.iter().all(|part| part.height == 1) {
        return Ok(Vec::new());
    }
    let arm = result.arm();
    let skeleton = skeleton(arm);
    let (mut places, mut first, mut last) = (Vec::new(), Vec::new(), Vec::new());
    for residual in after.train.iter().filter(|residual| scene.series[residual.series].kind.place().height == 3) {
        let twin = before.train.binary_search_by_key(&residual.observation, |other| other.observation);
        let Ok(twin) = twin.map(|at| &before.train[at]) else { continue };
        let of_tip = &arm.tips[result.train.tip_of(residual.row)];
        let tip = of_tip.fk(&arm.nominal, result.train.reading(residual.row));
        places.push(
            tip.rotation * arm.targets[scene.series[residual.series].target].translation.vector
                + tip.translation.vector,
        );
        first.push(twin.place);
        last.push(residual.place);
    }
    let view = |axes| plots::on_robot(&skeleton, &places, [&first, &last], axes);
    Ok(vec![view([0, 2])?, view([0, 1])?])
}
