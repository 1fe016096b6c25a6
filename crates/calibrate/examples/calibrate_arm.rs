//! Calibrates a URDF's longest chain, and prints the report: `calibrate_arm ROBOT.urdf MEASUREMENTS.csv` (m, rad).

use denavit_calibrate::{CalibrateOptions, Statics, Units, calibrate, read, report};
use denavit_model::{Reading, urdf};

#[expect(clippy::print_stdout, reason = "this is a program")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut words = std::env::args().skip(1);
    let (Some(file), Some(data)) = (words.next(), words.next()) else {
        return Err("usage: calibrate_arm ROBOT.urdf MEASUREMENTS.csv".into());
    };
    let robot = urdf::read(&file, &std::fs::read_to_string(&file)?)?;
    let chain = robot.chain(None, None, Reading::Intended)?.value;
    let rows = read(&data, std::fs::File::open(&data)?, &chain, Units::default())?.data;
    let options = CalibrateOptions::geometry(&chain);
    let found = calibrate(&chain, &Statics::of(&robot, &chain), rows, None, &options)?;
    print!("{}", report(&found));
    Ok(())
}
