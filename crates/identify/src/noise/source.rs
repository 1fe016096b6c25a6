//! Sources of noise.

/// Where a source acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Equally in every value of a channel.
    Level(usize),
    /// Along the instrument's line of sight.
    Range,
    /// Across it, growing with the distance.
    Angle,
    /// In the value of a joint's coordinate.
    Joint(usize),
}

/// A source of noise, and the size at which it alone would explain all noise.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// Where it acts.
    pub place: Place,
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// The size, in the unit.
    pub unit_size: f64,
}
