//! The robot of the first argument, with the `TIP` and `UNITS` of the environment, and its files of measurements.

use denavit_calibrate::effects::Statics;
use denavit_calibrate::observation::measurements::{Measurements, Units, read};
use denavit_model::Chain;
use denavit_model::tree::Reading;

pub struct Real {
    pub chain: Chain,
    pub statics: Statics,
    units: Units,
}

impl Real {
    pub fn robot(path: &str) -> Self {
        let robot = denavit_model::urdf::read(path, &std::fs::read_to_string(path).unwrap()).unwrap();
        let tip = std::env::var("TIP").ok();
        let chain = robot.chain(None, tip.as_deref(), Reading::Intended).unwrap().value;
        let statics = Statics::of(&robot, &chain);
        let units = std::env::var("UNITS").map_or_else(|_| Units::default(), |word| word.parse().unwrap());
        Self { chain, statics, units }
    }

    pub fn rows(&self, path: &str) -> Measurements {
        let file = std::fs::File::open(path).unwrap();
        read(path, file, &self.chain, self.units).unwrap_or_else(|error| panic!("{error}")).data
    }
}
