//! Arguments of what the program says of itself.

use clap::Args;
use clap_complete::Shell;
use std::path::PathBuf;

const COMPLETIONS_EXAMPLES: &str = "\
Examples:
  denavit completions bash > ~/.local/share/bash-completion/completions/denavit
  denavit completions zsh -o ~/.zfunc/_denavit
  denavit completions fish > ~/.config/fish/completions/denavit.fish";

/// Arguments of `denavit completions`.
#[derive(Debug, Args)]
#[command(after_help = COMPLETIONS_EXAMPLES)]
pub struct CompletionsArguments {
    /// The shell
    #[arg(value_enum)]
    pub shell: Shell,
    /// Write to a file, as a whole or not at all [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

const LSP_EXAMPLES: &str = "\
An editor starts it and speaks the Language Server Protocol with it over standard input and output:
  VS Code    the extension in editors/vscode
  Neovim     vim.lsp.start({ name = 'denavit', cmd = { 'denavit', 'lsp' } })
  Helix      [language-server.denavit] command = \"denavit\", args = [\"lsp\"]
docs/editor.md has the rest, and the settings.";

/// Arguments of `denavit lsp`.
#[derive(Debug, Args)]
#[command(after_help = LSP_EXAMPLES)]
pub struct LspArguments {}

/// Arguments of `denavit man`.
#[derive(Debug, Args)]
pub struct ManArguments {
    /// Folder for a page per command, denavit.1, denavit-table.1 … [default: the page of denavit on standard output]
    #[arg(long, short, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
}
