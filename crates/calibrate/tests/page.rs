//! The page of a calibration: one file, every plot in it.

#![allow(clippy::unwrap_used)] // Tests: a panic is a failure.

use denavit_calibrate::calibration::{CalibrateOptions, calibrate};
use denavit_calibrate::effects::driver::Statics;
use denavit_calibrate::report::html::page;
use denavit_calibrate::simulate::{SimulationOptions, simulate};
use denavit_calibrate::{MeasurementKind, NoEffects};
use denavit_model::examples::puma_like;

#[test]
fn holds_every_plot_and_no_link() {
    let chain = puma_like();
    for (kind, plots) in [(MeasurementKind::Position, 9), (MeasurementKind::Distance, 7)] {
        let run = simulate(&chain, &SimulationOptions { kind, rows: 80, ..Default::default() }, &NoEffects);
        let options = CalibrateOptions::geometry(&chain);
        let result = calibrate(&chain, &Statics::of_chain(&chain), run.data, None, &options).unwrap();
        let text = page(&result).unwrap();
        assert_eq!(text.matches("<svg").count(), plots);
        assert!(!text.contains("href=") && !text.contains("src="));
        assert!(text.contains("Calibration of puma_like"));
        if let Ok(folder) = std::env::var("DENAVIT_SHOW") {
            std::fs::write(format!("{folder}/page_{plots}.html"), text).unwrap();
        }
    }
}
