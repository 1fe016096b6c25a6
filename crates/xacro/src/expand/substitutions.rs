//! `$(…)`: arguments, packages, environment.

use std::path::Path;
use std::rc::Rc;

use super::expander::{Expander, Outcome};
use super::folder_of;
use crate::error::{ErrorKind, XacroError, did_you_mean, near};
use crate::expression;
use crate::packages::PackageError;
use crate::place::Spot;
use crate::substitution::{Substitution, substitution};

impl Expander<'_> {
    /// The text that `$(inner)` stands for.
    pub fn substitution(&mut self, inner: &str, spot: &Spot) -> Outcome<Rc<str>> {
        let found = self.substitute(inner).map_err(|error| error.at(spot))?;
        // An argument may itself hold `$(find …)`.
        let Some(start) = found.find("$(find ") else { return Ok(found.into()) };
        let mut out = found[..start].to_owned();
        let mut rest = &found[start..];
        while let Some(after) = rest.strip_prefix("$(") {
            let Some((inner, after)) = after.split_once(')') else { break };
            if inner.starts_with("find ") {
                out.push_str(&self.substitute(inner).map_err(|error| error.at(spot))?);
            } else {
                out.extend(["$(", inner, ")"]);
            }
            let next = after.find("$(").unwrap_or(after.len());
            out.push_str(&after[..next]);
            rest = &after[next..];
        }
        out.push_str(rest);
        Ok(out.into())
    }

    fn substitute(&mut self, inner: &str) -> Outcome<String> {
        match substitution(inner) {
            Substitution::Environment(name) | Substitution::OptionalEnvironment { name, .. }
                if self.options.environment.is_unreadable(name) =>
            {
                let message = format!("the environment variable \"{name}\" is not text in UTF-8");
                Err(XacroError::new(ErrorKind::UndefinedVariable, message).help("set it to text, or unset it"))
            }
            Substitution::Argument(name) => self.argument(name),
            Substitution::Find(name) => self.find(name),
            Substitution::Environment(name) => {
                let environment = &self.options.environment;
                environment.get(name).map(str::to_owned).ok_or_else(|| {
                    let error = XacroError::new(
                        ErrorKind::UndefinedVariable,
                        format!("the environment variable \"{name}\" is not set"),
                    );
                    match did_you_mean(&near(name, environment.names())) {
                        Some(question) => error.help(question),
                        None => error.help(format!("set it, or write $(optenv {name} default)")),
                    }
                })
            }
            Substitution::OptionalEnvironment { name, default } => {
                Ok(self.options.environment.get(name).map_or(default, str::to_owned))
            }
            Substitution::Folder => {
                let file = self.files.last().cloned().unwrap_or_default();
                let file = crate::files::absolute(&file).unwrap_or(file);
                Ok(folder_of(&file).to_string_lossy().into_owned())
            }
            Substitution::WorkingFolder => {
                let folder = crate::files::absolute(Path::new(".")).unwrap_or_else(|_| ".".into());
                Ok(folder.to_string_lossy().into_owned())
            }
            Substitution::Expression(text) => {
                let names = self.arguments.clone();
                let value = expression::with_arguments(text, &names, &mut self.meter)
                    .and_then(|value| Ok(value.to_text(&mut self.meter)?.to_string()));
                value.map_err(|fault| {
                    let mut error = fault.error;
                    error.expression = Some(text.to_owned());
                    error
                })
            }
            Substitution::Refused(word) => {
                Err(XacroError::new(ErrorKind::Refused, format!("$({word} …) is never executed"))
                    .help("pass the value as an argument: name:=value"))
            }
            Substitution::Wrong(message) => Err(XacroError::new(ErrorKind::Syntax, message)
                .help("there are $(arg …), $(find …), $(env …), $(optenv …), $(dirname), $(cwd) and $(eval …)")),
        }
    }

    /// The value of an argument.
    pub fn argument(&self, name: &str) -> Outcome<String> {
        self.arguments.get(name).cloned().ok_or_else(|| {
            let error = XacroError::new(ErrorKind::UndefinedArgument, format!("the argument \"{name}\" has no value"));
            match did_you_mean(&near(name, self.arguments.keys().map(String::as_str))) {
                Some(question) => error.help(question),
                None => error.help(format!(
                    "give it as {name}:=value, or declare <xacro:arg name=\"{name}\" default=\"…\"/> before"
                )),
            }
        })
    }

    /// The folder of a package, which becomes readable.
    fn find(&mut self, name: &str) -> Outcome<String> {
        let folder = self.packages.find(name).map_err(|error| {
            let kind = match error {
                PackageError::Name { .. } => ErrorKind::Syntax,
                _ => ErrorKind::Package,
            };
            XacroError::new(kind, error.to_string())
        })?;
        self.gate.open(&folder);
        Ok(folder.to_string_lossy().into_owned())
    }
}
