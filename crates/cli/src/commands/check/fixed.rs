//! Files that `--fix` changed: all are written, or none.

use crate::failure::Failure;
use crate::output::{self, Outputs, Slot};
use std::path::Path;

pub(super) struct Fixed {
    outputs: Outputs,
    texts: Vec<(Slot, String)>,
    said: Vec<String>,
}

impl Fixed {
    pub fn new() -> Self {
        Self { outputs: Outputs::in_place(), texts: Vec::new(), said: Vec::new() }
    }

    pub fn add(&mut self, name: &str, text: String, made: usize) -> Result<(), Failure> {
        self.texts.push((self.outputs.add("--fix", Path::new(name))?, text));
        self.said.push(format!("{name}: {made} fixed"));
        Ok(())
    }

    pub fn write(&self) -> Result<(), Failure> {
        self.outputs.write(&self.texts)?;
        self.said.iter().for_each(output::mention);
        Ok(())
    }
}
