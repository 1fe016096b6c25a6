//! Drivers as in a file: their quantities are names, which are bound to columns before anything is computed.

use crate::effects::driver::{Driver, JointVelocity, VELOCITY};
use crate::effects::model::Effect;
use denavit_model::Chain;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value;

/// The word in a file for the velocities of all joints of the chain.
const VELOCITIES: &str = "velocities";

/// A [`Driver`] as in a file: sides and velocities are not named, since the chain gives their names.
#[derive(Debug, Clone, PartialEq)]
pub struct WrittenDriver(Driver<String>);

impl WrittenDriver {
    /// The file form.
    pub fn of<C>(driver: &Driver<C>) -> Self
    where
        C: AsRef<str>,
    {
        let named: Result<_, std::convert::Infallible> = driver.named_by(|column| Ok(column.as_ref().to_owned()));
        let Ok(named) = named;
        Self(named)
    }

    /// The driver with the names of its columns.
    pub fn named(self, chain: &Chain) -> Driver<String> {
        let mut driver = self.0;
        if let Some(side) = driver.side_mut() {
            side.name_column(chain);
        } else if let Driver::Velocities(moving) = &mut driver {
            let coordinate = |joint: usize| &chain.coordinates()[chain.joints()[joint].coordinate].name;
            let of = |joint| JointVelocity { joint, of_coordinate: format!("{}{VELOCITY}", coordinate(joint)) };
            *moving = (0..chain.joints().len()).map(of).collect();
        }
        driver
    }

    /// Every joint that it depends on.
    pub fn joints(&self) -> Vec<usize> {
        self.0.joints()
    }

    /// The fault of its numbers.
    pub(super) fn fault(&self) -> Option<String> {
        let good = match &self.0 {
            Driver::Harmonic { order, .. } => order.is_finite(),
            Driver::HardeningTorque { knee, .. } => *knee > 0.0,
            Driver::FrictionSide { friction, .. } => *friction >= 0.0,
            Driver::Bump { at, width, .. } => at.is_finite() && *width > 0.0,
            Driver::Decay { from, constant, .. } => from.is_finite() && *constant > 0.0,
            Driver::Steps { at, .. } => !at.is_empty() && at.is_sorted(),
            Driver::Smooth { knots, .. } => knots.len() > 1 && knots.windows(2).all(|pair| pair[0] < pair[1]),
            _ => true,
        };
        (!good).then(|| {
            "a number of its driver is out of range; width, constant and knee must be above 0, friction at least 0, steps must ascend, \
             two or more knots must rise, and ranges must not be empty"
                .into()
        })
    }
}

/// An effect with the names of the columns that it depends on.
pub fn named(effect: &Effect, chain: &Chain) -> Effect<Driver<String>> {
    effect.with_driver(WrittenDriver::of(&effect.term.driver).named(chain))
}

impl Serialize for WrittenDriver {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match &self.0 {
            Driver::Velocities(_) => VELOCITIES.serialize(serializer),
            driver => driver.serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for WrittenDriver {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let written = Value::deserialize(deserializer)?;
        if written == VELOCITIES {
            return Ok(Self(Driver::Velocities(Vec::new())));
        }
        serde_json::from_value(written).map(Self).map_err(D::Error::custom)
    }
}
