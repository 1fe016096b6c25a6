//! The robot of the first argument (a URDF or a D-H table), with the environment variables `TIP` (links, separated by commas) and `UNITS`,
//! and its files of measurements.

use denavit_export::sources::{self, Source, Stated};
use denavit_identify::effects::Statics;
use denavit_measurements::import::ImportOptions;
use denavit_measurements::{Measurements, Units, read_export};
use denavit_model::tree::Reading;
use denavit_model::{Chain, PlacedRobot, Tips};
use std::sync::Arc;

pub struct Real {
    pub chain: Chain,
    pub statics: Statics,
    tips: Option<Arc<Tips>>,
    units: Units,
}

impl Real {
    #[allow(dead_code)] // As below.
    pub fn robot(path: &str) -> Self {
        Self::in_units(path, &std::env::var("UNITS").unwrap_or_default())
    }

    /// The robot whose rows are in these units, such as `mm,deg`; SI units if empty.
    #[allow(dead_code)] // Some studies have only one robot.
    pub fn in_units(path: &str, units: &str) -> Self {
        let units = if units.is_empty() { Units::default() } else { units.parse().unwrap() };
        let text = std::fs::read_to_string(path).unwrap();
        if std::path::Path::new(path).extension().is_some_and(|ending| ending == "csv") {
            let Source::Table { table, .. } = sources::read(path, &text, Stated::default()).unwrap() else {
                panic!("{path}: no D-H table")
            };
            let chain = table.chain().unwrap();
            return Self { statics: Statics::of_chain(&chain), chain, tips: None, units };
        }
        let robot = denavit_model::urdf::read(path, &text).unwrap();
        let tips = std::env::var("TIP").ok();
        let tips: Vec<Option<&str>> = tips.as_deref().map_or(vec![None], |tips| tips.split(',').map(Some).collect());
        let mut chains: Vec<Chain> =
            tips.iter().map(|tip| robot.chain(None, *tip, Reading::Intended).unwrap().value).collect();
        if chains.len() == 1 {
            let chain = chains.remove(0);
            return Self { statics: Statics::of(&robot, &chain), chain, tips: None, units };
        }
        let (chain, tips) = Chain::joined(&chains[0], &chains[1..]).unwrap();
        let tips = Arc::new(tips);
        let statics = Statics::placed_tips(&PlacedRobot::new(&robot, Reading::Intended), &chain, &tips);
        Self { chain, statics, tips: Some(tips), units }
    }

    pub fn rows(&self, path: &str) -> Measurements {
        let file = std::fs::File::open(path).unwrap();
        let options = ImportOptions { tips: self.tips.clone(), ..ImportOptions::default() };
        read_export(path, file, &self.chain, self.units, &options).unwrap_or_else(|error| panic!("{error}")).data
    }
}
