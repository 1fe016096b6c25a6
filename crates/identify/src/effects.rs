//! Effects beyond geometry: where each acts (carrier) times what drives it (driver).

pub mod approach;
pub mod averaged;
pub mod candidates;
pub mod carrier;
pub mod catalogue;
pub mod columns;
pub mod correction;
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "numbers of waves and of places")]
pub mod curve;
pub mod curve_modes;
pub mod driver;
pub mod everything;
pub mod gravity;
pub mod history;
pub mod link_points;
pub mod model;
mod one_tip;
pub mod probe;
pub mod recorded;
pub mod reference_robot;
pub mod saved;
pub mod survey;
pub mod written;

pub use carrier::Carrier;
pub use catalogue::{KINDS, Kind};
pub use correction::Correction;
pub use curve::Curve;
pub use driver::{Conditions, Driver, Statics};
pub use gravity::Masses;
pub use model::{Coupling, Effect, EffectModel, Term};
pub use saved::SavedEffects;
pub use written::WrittenDriver;
