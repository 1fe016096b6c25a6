//! Products of exponentials to Denavit-Hartenberg numbers and back.
//!
//! ```text
//! Chain ──► convert::table ──► Table (paper's form) ◄──► conventions (distal · proximal · paper · Hayati)
//!   ▲                            │
//!   └────────── Table::chain ────┘
//! ```
//! The crate reads and writes no text. Lengths are m, angles rad.

mod candidates;
pub mod conventions;
pub mod convert;
pub mod gauge;
pub mod matching;
pub mod nearest;
pub mod opw;
pub mod straighten;
pub mod table;

pub use conventions::{Convention, ConventionRow, RowLabel};
pub use convert::{NearParallel, Options};
pub use gauge::Gauge;
pub use straighten::Parallelism;
pub use table::{DhRow, HayatiRow, Motion, Row, Table, TableJoint, ToolPart};
