//! Plots of error curves and of the deflection of joints under gravity.

use crate::calibration::Calibration;
use crate::calibration::contract::CurveEntry;
use crate::report::plots::{AFTER, Plot, PlotError, svg};
use crate::report::trace_plots::{bounds, scatter};
use denavit_identify::effects::model::Effect;
use denavit_trace::infer::deflection::amounts;
use plotters::prelude::*;

/// Two-sided 95 % of a normal distribution.
const NORMAL_95: f64 = 1.96;
/// Rows that are drawn at most, spread over the run.
const MOST_DRAWN: usize = 1500;

/// A curve over the readings that were fitted, and the band that holds the truth with 95 %.
///
/// # Errors
/// A value is not finite.
pub fn curve(entry: &CurveEntry) -> Result<Plot, PlotError> {
    let (unit, small) = if entry.unit == "m" { ("m", "mm") } else { ("rad", "mrad") };
    let at = |value: f64| entry.table.iter().map(move |point| (point.at, (point.value + value * point.std) * 1e3));
    let line: Vec<(f64, f64)> = at(0.0).collect();
    let mut band: Vec<(f64, f64)> = at(NORMAL_95).collect();
    band.extend(at(-NORMAL_95).collect::<Vec<_>>().into_iter().rev());
    let (low_x, high_x) = bounds(line.iter().map(|point| point.0));
    let (low_y, high_y) = bounds(band.iter().map(|point| point.1));
    let drawn = svg(|area| {
        let mut chart = ChartBuilder::on(area)
            .margin(8)
            .x_label_area_size(36)
            .y_label_area_size(62)
            .build_cartesian_2d(low_x..high_x, low_y..high_y)?;
        let words = (format!("reading, {unit}"), format!("added to the reading, {small}"));
        chart.configure_mesh().light_line_style(TRANSPARENT).x_desc(words.0).y_desc(words.1).draw()?;
        chart.draw_series(std::iter::once(Polygon::new(band, AFTER.mix(0.2))))?;
        chart.draw_series(LineSeries::new(line, AFTER.stroke_width(2)))?;
        Ok(())
    })?;
    Ok(Plot { svg: drawn, caption: format!("{}: error curve and its 95 % band, no cause claimed", entry.joint) })
}

/// For each joint with a deflection under gravity besides the curves: the deflection in the fitted rows against the joint's reading.
/// Points of one reading lie apart because of the other joints.
///
/// # Errors
/// A value is not finite.
pub fn fields(result: &Calibration) -> Result<Vec<Plot>, PlotError> {
    let Some(fit) = result.named() else { return Ok(Vec::new()) };
    let effects = &fit.effects.effects;
    let stride = result.train.len().div_ceil(MOST_DRAWN).max(1);
    let plot = |effect: &Effect| {
        let turned = amounts(&result.train, fit, effect);
        let joint = effect.term.carrier.joint().map(|joint| &fit.arm.nominal.joints()[joint]);
        let reading = |row: usize| joint.map_or(0.0, |joint| joint.value(result.train.reading(row)));
        let points: Vec<(f64, f64)> =
            turned.iter().enumerate().step_by(stride).map(|(row, turned)| (reading(row), turned * 1e3)).collect();
        let words = ["reading, rad", "deflection under gravity, mrad"];
        let place = effect.term.carrier.place(&fit.effects.statics.chain);
        let caption = format!("{place}: deflection under gravity in the fitted rows; it depends on other joints, too");
        Ok(Plot { svg: scatter(&[(&points, AFTER)], &Vec::new(), words)?, caption })
    };
    effects[effects.len() - result.report.fields.len()..].iter().map(plot).collect()
}
