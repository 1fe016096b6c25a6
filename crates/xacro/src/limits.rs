//! Bounds on the resources of a document.

use crate::error::{ErrorKind, XacroError};

/// Bounds that stop an expansion which would not end, or would fill the memory.
///
/// The defaults are far above what robots need: every vendor file in the tests needs at most a tenth of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Limits {
    /// Nested elements, macro calls and includes together.
    pub depth: usize,
    /// Nested includes.
    pub includes: usize,
    /// Elements, texts and comments that are produced.
    pub nodes: usize,
    /// Bytes of the result, of any file read, and of any value of an expression.
    pub bytes: usize,
    /// Steps of evaluation: one for each operation and for each 16 bytes or 1 item that it handles.
    pub steps: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { depth: 1000, includes: 64, nodes: 1_000_000, bytes: 64 << 20, steps: 20_000_000 }
    }
}

/// The used part of the limits.
#[derive(Debug)]
pub(crate) struct Meter {
    pub limits: Limits,
    depth: usize,
    operations: usize,
    nodes: usize,
    bytes: usize,
    steps: u64,
}

/// Operations nested in one another, through properties and functions too. Evaluation recurses: the bound keeps it on
/// the stack that [`crate::expand`] provides.
const NESTED_OPERATIONS: usize = 4000;

impl Meter {
    pub fn new(limits: Limits) -> Self {
        Self { limits, depth: 0, operations: 0, nodes: 0, bytes: 0, steps: 0 }
    }

    /// Counts `count` steps.
    pub fn step(&mut self, count: usize) -> Result<(), Box<XacroError>> {
        self.steps = self.steps.saturating_add(count as u64);
        if self.steps > self.limits.steps {
            return Err(passed(format!("more than {} evaluation steps", self.limits.steps)));
        }
        Ok(())
    }

    /// Counts the work on a text of `bytes` bytes, which must be below the limit.
    pub fn text(&mut self, bytes: usize) -> Result<(), Box<XacroError>> {
        if bytes > self.limits.bytes {
            return Err(passed(format!("a text with more than {} bytes", self.limits.bytes)));
        }
        self.step(bytes / 16 + 1)
    }

    /// Counts a node of the result with `bytes` bytes of names and values.
    pub fn node(&mut self, bytes: usize) -> Result<(), Box<XacroError>> {
        self.nodes += 1;
        self.bytes = self.bytes.saturating_add(bytes);
        if self.nodes > self.limits.nodes {
            return Err(passed(format!("more than {} nodes are produced", self.limits.nodes)));
        }
        if self.bytes > self.limits.bytes {
            return Err(passed(format!("more than {} bytes are produced", self.limits.bytes)));
        }
        Ok(())
    }

    pub fn enter(&mut self) -> Result<(), Box<XacroError>> {
        self.depth += 1;
        if self.depth > self.limits.depth {
            return Err(passed(format!(
                "elements, macro calls and includes are nested more than {} deep",
                self.limits.depth
            ))
            .help("does a macro call itself endlessly, or a file include itself?"));
        }
        Ok(())
    }

    pub fn leave(&mut self) {
        self.depth -= 1;
    }

    /// Enters one more level of an expression.
    pub fn descend(&mut self) -> Result<(), Box<XacroError>> {
        self.operations += 1;
        if self.operations > NESTED_OPERATIONS {
            return Err(passed(format!("operations are nested more than {NESTED_OPERATIONS} deep"))
                .help("does a function call itself endlessly?"));
        }
        self.step(1)
    }

    pub fn ascend(&mut self) {
        self.operations -= 1;
    }
}

fn passed(what: String) -> Box<XacroError> {
    XacroError::new(ErrorKind::Limit, what)
}
