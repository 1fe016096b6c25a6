//! Plots of what the tracer found and of the residuals.

use crate::report::plots::{AFTER, ARM, BEFORE, Plot, PlotError, svg};
use denavit_identify::residual_statistics::Residual;
use denavit_identify::solve::Noise;
use denavit_measurements::Scene;
use denavit_model::nalgebra::Vector3;
use denavit_trace::PartialResiduals;
use plotters::prelude::*;
use statrs::distribution::{ContinuousCDF, Normal};

/// Lags of the autocorrelation that are drawn at most.
const LAGS: usize = 25;
/// Two-sided 95 % of a normal distribution.
const NORMAL_95: f64 = 1.96;

type Points = Vec<(f64, f64)>;

pub(super) fn bounds(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let low = values.clone().fold(f64::INFINITY, f64::min);
    let high = values.fold(f64::NEG_INFINITY, f64::max);
    let margin = 0.06 * (high - low).max(1e-12);
    (low - margin, high + margin)
}

/// Scatters of several colours with a line through sorted points.
pub(super) fn scatter(sets: &[(&Points, RGBColor)], line: &Points, words: [&str; 2]) -> Result<String, PlotError> {
    let all = || sets.iter().flat_map(|(points, _)| points.iter()).chain(line);
    let (low_x, high_x) = bounds(all().map(|point| point.0));
    let (low_y, high_y) = bounds(all().map(|point| point.1));
    svg(|area| {
        let mut chart = ChartBuilder::on(area)
            .margin(8)
            .x_label_area_size(36)
            .y_label_area_size(62)
            .build_cartesian_2d(low_x..high_x, low_y..high_y)?;
        chart.configure_mesh().light_line_style(TRANSPARENT).x_desc(words[0]).y_desc(words[1]).draw()?;
        for (points, colour) in sets {
            chart.draw_series(points.iter().map(|point| Circle::new(*point, 2, colour.mix(0.7).filled())))?;
        }
        chart.draw_series(LineSeries::new(line.iter().copied(), BLACK.stroke_width(2)))?;
        Ok(())
    })
}

/// The effect's partial residual with its model, and the residual before and after, both against its driver.
///
/// # Errors
/// A value is not finite.
pub fn partial_residuals(partial_residuals: &PartialResiduals, name: &str) -> Result<[Plot; 2], PlotError> {
    let (factor, ordinate) = in_thousandths(&partial_residuals.ordinate);
    let points = |value: fn(&denavit_trace::PartialResidual) -> Option<f64>| -> Points {
        partial_residuals.points.iter().filter_map(|point| Some((point.driver, value(point)? * factor))).collect()
    };
    let mut model = points(|point| Some(point.model));
    model.sort_by(|a, b| a.0.total_cmp(&b.0));
    let partial = points(|point| Some(point.partial));
    let (before, after) = (points(|point| point.before), points(|point| Some(point.after)));
    let words = [partial_residuals.abscissa.as_str(), ordinate.as_str()];
    Ok([
        Plot {
            svg: scatter(&[(&partial, AFTER)], &model, words)?,
            caption: format!("{name}: partial residual (points) and what the effect explains (line)"),
        },
        Plot {
            svg: scatter(&[(&before, BEFORE), (&after, AFTER)], &Vec::new(), words)?,
            caption: format!("{name}: residual along it, with geometry alone and with all effects"),
        },
    ])
}

/// rad and m as mrad and mm.
fn in_thousandths(ordinate: &str) -> (f64, String) {
    for (unit, small) in [(", rad", ", mrad"), (", m", ", mm")] {
        if let Some(words) = ordinate.strip_suffix(unit) {
            return (1e3, format!("{words}{small}"));
        }
    }
    (1.0, ordinate.into())
}

/// Residual components over the noise, channel by channel and component by component in row order.
fn standardised(residuals: &[Residual], scene: &Scene, noise: &Noise) -> Vec<Vec<f64>> {
    let mut components = Vec::new();
    for (channel, (part, level)) in scene.channels.iter().zip(&noise.levels).enumerate() {
        let own = |residual: &Residual| {
            let which = scene.series[residual.series].channels.iter().position(|own| *own == Some(channel))?;
            Some(if which == 0 { residual.place } else { residual.turn } / *level)
        };
        let vectors: Vec<Vector3<f64>> = residuals.iter().filter_map(own).collect();
        components.extend((0..part.height).map(|k| vectors.iter().map(|vector| vector[k]).collect::<Vec<f64>>()));
    }
    components.retain(|values| values.iter().any(|value| *value != 0.0));
    components
}

/// Quantiles of the residuals against those of a normal distribution.
///
/// # Errors
/// A value is not finite.
pub fn quantiles(residuals: &[Residual], scene: &Scene, noise: &Noise) -> Result<Plot, PlotError> {
    let mut values: Vec<f64> = standardised(residuals, scene, noise).concat();
    values.sort_by(f64::total_cmp);
    let normal = Normal::standard();
    let count = values.len() as f64;
    let points: Points = values
        .iter()
        .enumerate()
        .map(|(index, value)| (normal.inverse_cdf((index as f64 + 0.5) / count), *value))
        .collect();
    let ends = points.first().map_or(1.0, |point| point.0.abs());
    let svg = scatter(
        &[(&points, AFTER)],
        &vec![(-ends, -ends), (ends, ends)],
        ["normal quantile", "residual, in units of the noise"],
    )?;
    Ok(Plot { svg, caption: "residuals against a normal distribution (line)".into() })
}

/// Autocorrelation of the residuals over lags in rows.
///
/// # Errors
/// A value is not finite.
pub fn autocorrelation(residuals: &[Residual], scene: &Scene, noise: &Noise) -> Result<Plot, PlotError> {
    let components = standardised(residuals, scene, noise);
    let rows = components.iter().map(Vec::len).min().unwrap_or(0);
    let lags = LAGS.min(rows / 4);
    let at = |lag: usize| -> f64 {
        let (mut product, mut square) = (0.0, 0.0);
        for values in &components {
            product += values.iter().zip(&values[lag..]).map(|(a, b)| a * b).sum::<f64>();
            square += values.iter().map(|a| a * a).sum::<f64>();
        }
        if square > 0.0 { product / square } else { 0.0 }
    };
    let bars: Vec<(usize, f64)> = (1..=lags).map(|lag| (lag, at(lag))).collect();
    let chance = NORMAL_95 / ((rows * components.len()).max(1) as f64).sqrt();
    let top = bars.iter().map(|bar| bar.1.abs()).fold(2.0 * chance, f64::max) * 1.1;
    let svg = svg(|area| {
        let mut chart = ChartBuilder::on(area)
            .margin(8)
            .x_label_area_size(36)
            .y_label_area_size(62)
            .build_cartesian_2d(0.0..lags as f64 + 1.0, -top..top)?;
        chart.configure_mesh().light_line_style(TRANSPARENT).x_desc("rows apart").y_desc("correlation").draw()?;
        let band = [(0.0, -chance), (lags as f64 + 1.0, chance)];
        chart.draw_series([Rectangle::new(band, ARM.mix(0.35).filled())])?;
        chart.draw_series(bars.iter().map(|(lag, height)| {
            Rectangle::new([(*lag as f64 - 0.3, 0.0), (*lag as f64 + 0.3, *height)], AFTER.mix(0.8).filled())
        }))?;
        Ok(())
    })?;
    Ok(Plot { svg, caption: "autocorrelation of the residuals in run order; grey: 95 % of chance".into() })
}
