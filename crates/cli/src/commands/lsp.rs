//! `denavit lsp`: a language server for editors.

use crate::args::LspArguments;
use crate::failure::Failure;
use crate::output::Status;

/// Runs the command, until the editor says that it is done.
pub fn run(_arguments: &LspArguments) -> Result<Status, Failure> {
    denavit_lsp::serve_stdio(env!("CARGO_PKG_VERSION")).map_err(|error| Failure::Argument(format!("lsp: {error}")))?;
    Ok(Status::Same)
}
