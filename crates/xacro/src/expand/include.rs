//! `<xacro:include>`

use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::expander::{Expander, Outcome, Sight};
use super::glob::{files_matching, is_pattern};
use super::output::Output;
use crate::error::{ErrorKind, Frame, XacroError};
use crate::expression::Value;
use crate::place::Spot;
use crate::scope::{Entry, Macros, Scope};
use crate::tree::Element;

impl Expander<'_> {
    pub fn include(&mut self, element: &Rc<Element>, sight: &Sight, output: &mut Output) -> Outcome<()> {
        let [filename] = self.attributes(element, ["filename"], &["ns", "optional"])?;
        let spot = element.spot_of(filename);
        let inner = match element.attribute("ns").filter(|ns| !ns.value.is_empty()) {
            None => sight.clone(),
            Some(ns) => {
                let name = self.words(&ns.value, &element.spot_of(ns), &sight.symbols)?;
                let inner = Sight { macros: Rc::new(Macros::default()), symbols: Scope::namespace(&sight.symbols) };
                sight.macros.define_namespace(Rc::clone(&name), Rc::clone(&inner.macros));
                sight.symbols.set(name, Entry::Ready(Value::Namespace(Rc::clone(&inner.symbols))));
                inner
            }
        };
        let optional = match element.attribute("optional") {
            None => false,
            Some(optional) => {
                let spot = element.spot_of(optional);
                let value = self.value(&optional.value, &spot, &sight.symbols)?;
                Self::truth(&value, &optional.value, &spot)?
            }
        };
        self.note_content(element);
        let name = self.words(&filename.value, &spot, &sight.symbols)?;
        let mut included = Vec::new();
        for path in self.included_files(&name, &spot)? {
            match self.included(&path, &spot, &inner) {
                Ok(root) => included.push(root),
                // What is optional may be absent, but not wrong.
                Err(error) if optional && error.kind == ErrorKind::Read && error.stack.is_empty() => {}
                Err(error) => return Err(error),
            }
        }
        output.drop_comments();
        for root in included {
            self.adopt(root, element, output);
        }
        Ok(())
    }

    fn included_files(&mut self, name: &str, spot: &Spot) -> Outcome<Vec<PathBuf>> {
        let path = self.absolute(name);
        if !is_pattern(name) {
            return Ok(vec![path]);
        }
        let files = files_matching(&path, &mut self.meter).map_err(|error| error.at(spot))?;
        if files.is_empty() {
            self.note(spot, format!("no file matches \"{name}\""));
        }
        Ok(files)
    }

    fn included(&mut self, path: &Path, spot: &Spot, sight: &Sight) -> Outcome<Element> {
        let document = self.document(path).map_err(|error| match error.place {
            None => error.at(spot),
            Some(_) => error.within(Frame::Include { file: path.to_path_buf(), at: spot.place() }),
        })?;
        let depth = self.files.len();
        if depth > self.meter.limits.includes {
            let shown: Vec<String> =
                self.files[depth - 3.min(depth)..].iter().map(|file| file.display().to_string()).collect();
            return Err(XacroError::new(
                ErrorKind::Limit,
                format!("files are included more than {} deep: … → {}", self.meter.limits.includes, shown.join(" → ")),
            )
            .help("does a file include itself?")
            .at(spot));
        }
        self.files.push(path.to_path_buf());
        self.meter.enter().map_err(|error| error.at(spot))?;
        let root = self
            .element(&document.root, sight)
            .map_err(|error| error.within(Frame::Include { file: path.to_path_buf(), at: spot.place() }))?;
        self.meter.leave();
        self.files.pop();
        Ok(root)
    }
}
