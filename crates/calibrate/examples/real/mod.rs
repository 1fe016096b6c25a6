//! The robot of the first argument (a URDF or a D-H table), with the `TIP` and `UNITS` of the environment, and its files of measurements.

use denavit_calibrate::effects::Statics;
use denavit_calibrate::observation::measurements::{Measurements, Units, read};
use denavit_export::sources::{self, Source, Stated};
use denavit_model::Chain;
use denavit_model::tree::Reading;

pub struct Real {
    pub chain: Chain,
    pub statics: Statics,
    units: Units,
}

impl Real {
    #[allow(dead_code)] // As below.
    pub fn robot(path: &str) -> Self {
        Self::in_units(path, &std::env::var("UNITS").unwrap_or_default())
    }

    /// The robot whose rows are in these units, such as `mm,deg`; SI units where nothing is said.
    #[allow(dead_code)] // Some studies have one robot alone.
    pub fn in_units(path: &str, units: &str) -> Self {
        let units = if units.is_empty() { Units::default() } else { units.parse().unwrap() };
        let text = std::fs::read_to_string(path).unwrap();
        if std::path::Path::new(path).extension().is_some_and(|ending| ending == "csv") {
            let Source::Table { table, .. } = sources::read(path, &text, Stated::default()).unwrap() else {
                panic!("{path}: no D-H table")
            };
            let chain = table.chain().unwrap();
            return Self { statics: Statics::of_chain(&chain), chain, units };
        }
        let robot = denavit_model::urdf::read(path, &text).unwrap();
        let tip = std::env::var("TIP").ok();
        let chain = robot.chain(None, tip.as_deref(), Reading::Intended).unwrap().value;
        let statics = Statics::of(&robot, &chain);
        Self { chain, statics, units }
    }

    pub fn rows(&self, path: &str) -> Measurements {
        let file = std::fs::File::open(path).unwrap();
        read(path, file, &self.chain, self.units).unwrap_or_else(|error| panic!("{error}")).data
    }
}
