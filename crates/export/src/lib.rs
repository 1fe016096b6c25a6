//! Writes tables, documents and URDF; formats that are also sources are read back.
//!
//! ```text
//! Table, Chain ──► formats (text · md · csv · json · tex) ──► String
//! csv, json ──► sources ──► Chain
//! ```
//! The crate opens no files. A new format is a file in `formats/` and a line in [`formats::FORMATS`].

pub mod deltas;
pub mod drawing;
pub mod formats;
pub mod kinematics_yaml;
pub mod makers;
pub mod matched;
pub mod numbers;
pub mod offsets;
pub mod page;
pub mod poe;
pub mod shapes;
pub mod sheet;
pub mod sources;
pub mod urdf;

pub use formats::{FORMATS, Format, RenderError};
pub use numbers::{AngleUnit, LengthUnit, Units, UnknownUnit};
pub use sheet::Sheet;
