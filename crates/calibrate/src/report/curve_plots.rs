//! Plots of error curves, of what joints give under gravity and of smooth functions of two joints.

use crate::calibration::Calibration;
use crate::calibration::contract::CurveEntry;
use crate::effects::driver::Driver;
use crate::effects::field::{Products, Shapes};
use crate::effects::model::{Effect, EffectModel};
use crate::identify::solve::Fit;
use crate::report::plots::{AFTER, BEFORE, Plot, PlotError, svg};
use crate::report::trace_plots::{bounds, scatter};
use crate::trace::infer::deflection::amounts;
use denavit_model::Screw;
use plotters::prelude::*;
use std::f64::consts::PI;

/// Two-sided 95 % of a normal distribution.
const NORMAL_95: f64 = 1.96;
/// Cells of a map along each side.
const CELLS: usize = 40;
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
        let words = (format!("reading, {unit}"), format!("added to it, {small}"));
        chart.configure_mesh().light_line_style(TRANSPARENT).x_desc(words.0).y_desc(words.1).draw()?;
        chart.draw_series(std::iter::once(Polygon::new(band, AFTER.mix(0.2))))?;
        chart.draw_series(LineSeries::new(line, AFTER.stroke_width(2)))?;
        Ok(())
    })?;
    Ok(Plot { svg: drawn, caption: format!("{}: error curve and its 95 % band, no cause claimed", entry.joint) })
}

/// For each joint that errs by a function of two readings a map of it; for each joint that gives under gravity beside the curves how far it turns in the fitted rows, against its own reading: where the
/// points of one reading lie apart, the other joints make the difference.
///
/// # Errors
/// A value is not finite.
pub fn fields(result: &Calibration) -> Result<Vec<Plot>, PlotError> {
    let Some(fit) = result.named() else { return Ok(Vec::new()) };
    let effects = &fit.effects.effects;
    let stride = result.train.len().div_ceil(MOST_DRAWN).max(1);
    let plot = |effect: &Effect| {
        if let Driver::Products(products) = &effect.term.driver {
            return map(fit, effect, products);
        }
        let turned = amounts(&result.train, fit, effect);
        let joint = effect.term.carrier.joint().map(|joint| &fit.arm.nominal.joints()[joint]);
        let reading = |row: usize| joint.map_or(0.0, |joint| joint.value(result.train.reading(row)));
        let points: Vec<(f64, f64)> =
            turned.iter().enumerate().step_by(stride).map(|(row, turned)| (reading(row), turned * 1e3)).collect();
        let words = ["reading, rad", "turned by gravity, mrad"];
        let place = effect.term.carrier.place(&fit.effects.statics.chain);
        let caption = format!("{place}: what it gives under gravity in the fitted rows; other joints spread it");
        Ok(Plot { svg: scatter(&[(&points, AFTER)], &Vec::new(), words)?, caption })
    };
    effects[effects.len() - result.report.fields.len()..].iter().map(plot).collect()
}

/// What a joint errs by over the readings of two joints: the darker, the more; one colour above 0 and one below.
fn map(fit: &Fit<EffectModel>, effect: &Effect, products: &Products) -> Result<Plot, PlotError> {
    let joints = fit.effects.statics.chain.joints();
    let slides = |joint: usize| matches!(joints[joint].screw, Screw::Prismatic(_));
    let [across, up] = products.of.map(|reading| match reading.shapes {
        Shapes::Range { low, high } => (low, high),
        Shapes::Turns => (-PI, PI),
    });
    let edge = |(low, high): (f64, f64), k: f64| low + (high - low) * k / CELLS as f64;
    let value = |column: usize, row: usize| -> f64 {
        let mut values = Vec::new();
        products.values_into([edge(across, column as f64 + 0.5), edge(up, row as f64 + 0.5)], &mut values);
        values.iter().zip(&effect.coefficients).map(|(value, coefficient)| value * coefficient).sum()
    };
    let cells =
        (0..CELLS * CELLS).map(|k| (k % CELLS, k / CELLS)).map(|(column, row)| (column, row, value(column, row)));
    let cells: Vec<(usize, usize, f64)> = cells.collect();
    let most = cells.iter().map(|cell| cell.2.abs()).fold(f64::MIN_POSITIVE, f64::max);
    let words = products.joints().map(|joint| {
        let unit = if slides(joint) { "m" } else { "rad" };
        format!("{}, {unit}", joints[joint].name)
    });
    let drawn = svg(|area| {
        let mut chart = ChartBuilder::on(area)
            .margin(8)
            .x_label_area_size(36)
            .y_label_area_size(62)
            .build_cartesian_2d(across.0..across.1, up.0..up.1)?;
        chart.configure_mesh().light_line_style(TRANSPARENT).x_desc(&words[0]).y_desc(&words[1]).draw()?;
        chart.draw_series(cells.iter().map(|&(column, row, value)| {
            let corner = |k: usize| (edge(across, (column + k) as f64), edge(up, (row + k) as f64));
            let colour = if value < 0.0 { BEFORE } else { AFTER };
            Rectangle::new([corner(0), corner(1)], colour.mix((value / most).abs()).filled())
        }))?;
        Ok(())
    })?;
    let place = effect.term.carrier.place(&fit.effects.statics.chain);
    let small = if effect.term.carrier.joint().is_some_and(slides) { "mm" } else { "mrad" };
    let caption = format!(
        "{place}: error as a smooth function of two joints, blue above 0 and brown below, {:.3} {small} at most; no cause claimed",
        most * 1e3
    );
    Ok(Plot { svg: drawn, caption })
}
