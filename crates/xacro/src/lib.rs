//! Xacro expansion and package resolution, in process and without ROS.
//!
//! ```text
//! Source ─► Element tree (with places) ─► expand: properties, macros, includes, conditions ─► URDF text
//!                                            │
//!                       ${expression} ◄──────┼──────► $(find pkg) … PackagePath
//! ```
//!
//! [`expand`] turns xacro into URDF the way the Python tool `xacro` does, with three differences: an error
//! knows its file, line, column and the calls that led there; [`Limits`] end runaway documents; and files are
//! read only below [known folders](FileAccess). No program is ever run: `$(eval …)` does not use a shell.
//!
//! [`PackagePath`] finds ROS packages for `$(find …)`, `package://`, `model://` and `file://` from folders that
//! it is given.
//!
//! ```
//! use denavit_xacro::{Options, Source, expand};
//!
//! let source = Source::text(
//!     "arm.urdf.xacro",
//!     r#"<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
//!          <xacro:property name="length" value="0.5"/>
//!          <link name="upper" length="${length / 2}"/>
//!        </robot>"#,
//! );
//! let expanded = expand(&source, &[], &Options::default())?;
//! assert!(expanded.urdf.contains(r#"length="0.25""#));
//! # Ok::<(), denavit_xacro::XacroError>(())
//! ```

mod access;
mod detect;
mod error;
mod expand;
mod expression;
pub mod files;
mod limits;
mod packages;
mod place;
mod scope;
mod substitution;
mod text;
mod trace;
mod tree;
mod write;
mod yaml;

pub use access::FileAccess;
pub use detect::is_xacro;
pub use error::{ErrorKind, Frame, XacroError};
pub use expand::{Argument, Expanded, Note, Options, Source, expand};
pub use limits::Limits;
pub use packages::{Environment, PackageError, PackagePath, package_name};
pub use place::Place;
pub use trace::{AttributeOrigin, Evaluated, Origin, Span, Trace};
