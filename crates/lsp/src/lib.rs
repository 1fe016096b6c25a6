//! A language server for robot descriptions: URDF, xacro, SRDF, SDF and MJCF.
//!
//! ```text
//! editor ◄──► Connection ◄──► server ──► session: buffers over the disk
//!                                          └─► analysis of a robot: text ─► expansion with its trace ─► robot, findings
//!                                                └─► diagnostics · hover · definition · rename · completion · outline · lens
//! ```
//! The server is synchronous: `lsp-server` is rust-analyzer's transport over channels, and needs no runtime, as tower-lsp-server
//! and async-lsp do (22 crates with the types, against 60 and 86); a robot is analysed in some milliseconds, so parallel
//! requests would gain nothing. `gen-lsp-types` is generated from the protocol's metamodel;
//! `lsp-types` had its last release in 2024.
//!
//! It changes no file: open buffers override the files on disk, and every change is a response that the editor applies.

// Tables of what names what are read line by line; names of files are in small letters where their ends are compared.
#![allow(clippy::match_same_arms, clippy::case_sensitive_file_extension_comparisons)]

mod analysis;
mod diagnostics;
mod features;
mod markup;
mod names;
mod server;
mod session;
mod settings;
mod text;
mod uri;
mod vocabulary;

pub use lsp_server::Connection;
pub use server::{ServeError, serve, serve_stdio};
