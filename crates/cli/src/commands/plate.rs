//! `denavit plate`: a plate of holes to touch, as a solid and as a drawing.

use crate::args::PlateArguments;
use crate::failure::Failure;
use crate::output::{self, Outputs, Slot, Status};
use denavit_calibrate::apply::print_plate::PrintPlate;
use denavit_measurements::plate::{Plate, PlateError};
use denavit_model::Quantity;
use denavit_model::units::Unit;
use denavit_model::words::quoted;
use std::path::Path;

/// Runs the command.
pub fn run(arguments: &PlateArguments) -> Result<Status, Failure> {
    let plate: Plate = arguments.plate.parse().map_err(|error: PlateError| Failure::Argument(error.to_string()))?;
    let ball = Unit::value(&arguments.ball, Quantity::Length).ok_or_else(|| {
        Failure::Argument(format!("--ball: \"{}\" is not a length; write 10mm", quoted(&arguments.ball)))
    })?;
    let made = PrintPlate::new(plate, ball).map_err(|error| Failure::Argument(format!("--ball: {error}")))?;
    let mut outputs = Outputs::beside(std::iter::empty::<&str>());
    let mut texts: Vec<(Slot, String)> = Vec::new();
    for path in &arguments.output {
        let text = text(&made, path)?;
        texts.push((outputs.add("--output", path)?, text));
    }
    outputs.write(&texts)?;
    let [width, height] = made.size().map(|size| size * 1e3);
    output::mention(format!(
        "{} holes, A1 (at the cut corner) to {}; plate {width} x {height} x {:.1} mm; a ball's centre is {:.2} mm above it",
        plate.holes().count(),
        plate.last(),
        made.thickness() * 1e3,
        made.ball_height() * 1e3
    ));
    Ok(Status::Same)
}

fn text(made: &PrintPlate, path: &Path) -> Result<String, Failure> {
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("stl") => Ok(made.stl()),
        Some("svg") => Ok(made.drawing()),
        _ => Err(Failure::Argument(format!(
            "--output {}: the extension chooses the format; end it in .stl or .svg",
            path.display()
        ))),
    }
}
