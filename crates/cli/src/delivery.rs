//! One result in two views, the command's own and JSON, each written to its destination.

use crate::args::JsonArguments;
use crate::failure::Failure;
use crate::output::{self, Outputs, Slot};
use denavit_compare::report::{self, Report};
use std::ffi::OsStr;
use std::path::Path;

/// Where the two views go; checked before the work.
#[derive(Debug)]
pub struct Delivery {
    outputs: Outputs,
    own: Option<Slot>,
    json: Option<Slot>,
    own_is_printed: bool,
}

impl Delivery {
    /// `output` is that of `--output`; `inputs` are the files that the run reads. JSON on standard output takes the place of
    /// what would be printed there.
    pub fn of<'a>(
        output: Option<&Path>,
        json: &JsonArguments,
        inputs: impl IntoIterator<Item = &'a str>,
    ) -> Result<Self, Failure> {
        let mut outputs = Outputs::beside(inputs);
        let json = outputs.add_if("--json", json.place())?;
        let taken = outputs.take_standard_output();
        if let Some(path) = output.filter(|path| taken && path.extension() == Some(OsStr::new("json"))) {
            let path = path.display();
            return Err(Failure::Argument(format!(
                "--output {path}: --json without a file prints JSON, and {path} would hold the text; write --json {path}"
            )));
        }
        let own = match output {
            Some(path) => Some(outputs.add("--output", path)?),
            None if taken => None,
            None => Some(outputs.add("--output", Path::new("-"))?),
        };
        Ok(Self { own_is_printed: outputs.take_standard_output() && !taken, outputs, own, json })
    }

    /// The same for a command that has no JSON.
    pub fn plain<'a>(output: Option<&Path>, inputs: impl IntoIterator<Item = &'a str>) -> Result<Self, Failure> {
        Self::of(output, &JsonArguments::default(), inputs)
    }

    /// Whether the command's own view is requested.
    pub fn wants_own(&self) -> bool {
        self.own.is_some()
    }

    /// Makes the requested views, and writes all of them or none.
    pub fn deliver(
        &self,
        own: impl FnOnce() -> Result<String, Failure>,
        json: impl FnOnce() -> Result<String, Failure>,
    ) -> Result<(), Failure> {
        let mut texts = Vec::new();
        if let Some(slot) = self.json {
            texts.push((slot, json()?));
        }
        if let Some(slot) = self.own {
            texts.push((slot, own()?));
        }
        self.outputs.write(&texts)
    }

    /// Makes the requested views of a report. Text that is printed on a terminal is coloured and as wide as that.
    pub fn report(&self, format: &str, found: &Report) -> Result<(), Failure> {
        let rendered =
            |name: &str| Ok((report::format(name).expect("the argument parser knows the formats").render)(found));
        let own = || match format {
            "text" => {
                let text = report::text(found, output::colour(self.own_is_printed));
                Ok(if self.own_is_printed { output::fitted(&text).into_owned() } else { text })
            }
            name => rendered(name),
        };
        self.deliver(own, || rendered("json"))
    }

    /// The same for a command that has no JSON.
    pub fn text(&self, own: String) -> Result<(), Failure> {
        self.deliver(|| Ok(own), || Ok(String::new()))
    }

    /// Prints what is to be said beside the files; nothing where an output stands on standard output.
    pub fn summary(&self, text: &str) -> Result<(), Failure> {
        if self.outputs.take_standard_output() { Ok(()) } else { output::print(text) }
    }
}
