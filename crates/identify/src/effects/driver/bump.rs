//! An error in one part of a joint's range.

use serde::{Deserialize, Serialize};

/// The outline of a bump over u = (value - at)/width.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BumpShape {
    /// exp(-u²/2).
    Bell,
    /// 1 - |u|/2, 0 beyond.
    Tent,
    /// (1 + cos(π u/2.5))/2, 0 beyond.
    Wave,
}

impl BumpShape {
    /// Every outline.
    pub const ALL: [Self; 3] = [Self::Bell, Self::Tent, Self::Wave];

    /// Height at u.
    pub fn height(self, u: f64) -> f64 {
        match self {
            Self::Bell => (-0.5 * u * u).exp(),
            Self::Tent => (1.0 - 0.5 * u.abs()).max(0.0),
            Self::Wave if u.abs() > 2.5 => 0.0,
            Self::Wave => 0.5 + 0.5 * (std::f64::consts::PI * u / 2.5).cos(),
        }
    }
}
