//! Plots of a calibration as SVG.

use crate::calibration::StageResiduals;
use denavit_measurements::Measurements;
use denavit_model::nalgebra::Vector3;
use plotters::prelude::*;
use serde::Serialize;
use thiserror::Error;

/// A plot and what it shows.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Plot {
    /// SVG element.
    pub svg: String,
    /// One sentence.
    pub caption: String,
}

/// A plot could not be drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("a plot could not be drawn: its values are not finite")]
pub struct PlotError;

const SIZE: (u32, u32) = (460, 320);
pub(super) const BEFORE: RGBColor = RGBColor(0xb3, 0x54, 0x1e);
pub(super) const AFTER: RGBColor = RGBColor(0x1f, 0x5f, 0xa8);
pub(super) const ARM: RGBColor = RGBColor(0x9a, 0xa4, 0xb2);
const BINS: usize = 24;

pub(super) type ReferenceRobot = Result<(), Box<dyn std::error::Error>>;
pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

pub(super) fn svg(draw: impl FnOnce(&Area<'_>) -> ReferenceRobot) -> Result<String, PlotError> {
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        area.fill(&WHITE).map_err(|_| PlotError)?;
        draw(&area).map_err(|_| PlotError)?;
        area.present().map_err(|_| PlotError)?;
    }
    Ok(text)
}

fn millimetres(stage: &StageResiduals) -> Vec<f64> {
    stage.train.iter().map(|residual| residual.distance() * 1e3).collect()
}

/// How many residuals have which size, before and after.
///
/// # Errors
/// A value is not finite.
pub fn histogram(before: &StageResiduals, after: &StageResiduals) -> Result<Plot, PlotError> {
    let (a, b) = (millimetres(before), millimetres(after));
    let highest = a.iter().chain(&b).copied().fold(0.0f64, f64::max).max(1e-9) * 1.02;
    let count = |values: &[f64]| {
        (0..BINS)
            .map(|bin| {
                let (low, high) = (bin as f64 * highest / BINS as f64, (bin + 1) as f64 * highest / BINS as f64);
                values.iter().filter(|value| **value >= low && **value < high).count()
            })
            .collect::<Vec<usize>>()
    };
    let (a, b) = (count(&a), count(&b));
    let top = a.iter().chain(&b).copied().max().unwrap_or(1) as f64 * 1.05;
    let drawn = svg(|area| {
        let mut chart = ChartBuilder::on(area)
            .margin(8)
            .x_label_area_size(36)
            .y_label_area_size(44)
            .build_cartesian_2d(0.0..highest, 0.0..top)?;
        chart.configure_mesh().light_line_style(TRANSPARENT).x_desc("error, mm").y_desc("rows").draw()?;
        for (counts, colour) in [(&a, BEFORE), (&b, AFTER)] {
            chart.draw_series(counts.iter().enumerate().map(|(bin, count)| {
                let (low, high) = (bin as f64 * highest / BINS as f64, (bin + 1) as f64 * highest / BINS as f64);
                Rectangle::new([(low, 0.0), (high, *count as f64)], colour.mix(0.55).filled())
            }))?;
        }
        Ok(())
    })?;
    Ok(Plot { svg: drawn, caption: format!("size of the residuals, {} and {}", before.name, after.name) })
}

/// Residuals against one joint's reading, before and after.
///
/// # Errors
/// A value is not finite.
pub fn against_joint(
    data: &Measurements,
    coordinate: usize,
    before: &StageResiduals,
    after: &StageResiduals,
) -> Result<Plot, PlotError> {
    let points = |stage: &StageResiduals| -> Vec<(f64, f64)> {
        stage.train.iter().map(|r| (data.reading(r.row)[coordinate], r.distance() * 1e3)).collect()
    };
    let (a, b) = (points(before), points(after));
    let all = || a.iter().chain(&b);
    let low = all().map(|point| point.0).fold(f64::INFINITY, f64::min);
    let high = all().map(|point| point.0).fold(f64::NEG_INFINITY, f64::max);
    let inset = 0.03 * (high - low).max(1e-6);
    let top = all().map(|point| point.1).fold(0.0f64, f64::max).max(1e-9) * 1.05;
    let drawn = svg(|area| {
        let mut chart = ChartBuilder::on(area)
            .margin(8)
            .x_label_area_size(36)
            .y_label_area_size(44)
            .build_cartesian_2d(low - inset..high + inset, 0.0..top)?;
        chart.configure_mesh().light_line_style(TRANSPARENT).x_desc("reading, rad or m").y_desc("error, mm").draw()?;
        for (points, colour) in [(&a, BEFORE), (&b, AFTER)] {
            chart.draw_series(points.iter().map(|point| Circle::new(*point, 2, colour.mix(0.7).filled())))?;
        }
        Ok(())
    })?;
    Ok(Plot { svg: drawn, caption: format!("{}: error against its reading", data.joints[coordinate]) })
}

/// One view of the robot: its skeleton at home, the measured places, residuals as vectors.
///
/// # Shape and units
/// `places`: base frame, m, one per residual of both stages. `axes`: the two coordinates that are drawn.
///
/// # Errors
/// A value is not finite.
pub fn on_robot(
    skeleton: &[Vector3<f64>],
    places: &[Vector3<f64>],
    stages: [&[Vector3<f64>]; 2],
    axes: [usize; 2],
) -> Result<Plot, PlotError> {
    let [i, k] = axes;
    let flat = |point: &Vector3<f64>| (point[i], point[k]);
    let all: Vec<(f64, f64)> = skeleton.iter().chain(places).map(flat).collect();
    let bound = |pick: fn(&(f64, f64)) -> f64, least: bool| {
        let values = all.iter().map(pick);
        if least { values.fold(f64::INFINITY, f64::min) } else { values.fold(f64::NEG_INFINITY, f64::max) }
    };
    let (low_x, high_x) = (bound(|p| p.0, true), bound(|p| p.0, false));
    let (low_y, high_y) = (bound(|p| p.1, true), bound(|p| p.1, false));
    // Equal scales on both axes: the plot is 390 by 260 pixels inside its margins.
    let half = (0.5 * (high_x - low_x) / 390.0).max(0.5 * (high_y - low_y) / 260.0).max(1e-6) * 1.1;
    let (x, y) = (0.5 * (low_x + high_x), 0.5 * (low_y + high_y));
    let longest = stages[0].iter().map(Vector3::norm).fold(1e-12, f64::max);
    let stretch = 60.0 * half / longest;
    let drawn = svg(|area| {
        let mut chart = ChartBuilder::on(area)
            .margin(8)
            .x_label_area_size(36)
            .y_label_area_size(44)
            .build_cartesian_2d(x - 390.0 * half..x + 390.0 * half, y - 260.0 * half..y + 260.0 * half)?;
        let names = ["x, m", "y, m", "z, m"];
        chart.configure_mesh().light_line_style(TRANSPARENT).x_desc(names[i]).y_desc(names[k]).draw()?;
        chart.draw_series(LineSeries::new(skeleton.iter().map(flat), ARM.stroke_width(5)))?;
        for (vectors, colour) in stages.iter().zip([BEFORE, AFTER]) {
            chart.draw_series(places.iter().zip(*vectors).map(|(place, vector)| {
                PathElement::new(vec![flat(place), flat(&(place + vector * stretch))], colour.stroke_width(2))
            }))?;
        }
        Ok(())
    })?;
    let names = ["x", "y", "z"];
    let caption = format!("residuals drawn {stretch:.0} times as long, in the {}{} plane", names[i], names[k]);
    Ok(Plot { svg: drawn, caption })
}
