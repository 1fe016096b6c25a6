//! The scalars of a YAML document by their paths.

use super::KEYS;
use crate::kinematics_yaml::KinematicsFileError;
use saphyr_parser::{Event, Parser};

/// A document's scalars: path, text, line.
pub(crate) struct Scalars {
    pub file: String,
    all: Vec<(Vec<String>, String, usize)>,
}

impl Scalars {
    pub fn read(file: &str, text: &str) -> Result<Self, KinematicsFileError> {
        let mut path: Vec<String> = Vec::new();
        let mut key: Option<String> = None;
        let mut all = Vec::new();
        for event in Parser::new_from_str(text) {
            let (event, span) = event.map_err(|error| KinematicsFileError::Yaml {
                file: file.into(),
                line: error.marker().line(),
                what: error.info().into(),
            })?;
            match event {
                Event::MappingStart(..) => path.push(key.take().unwrap_or_default()),
                Event::MappingEnd => {
                    path.pop();
                }
                Event::Scalar(value, ..) => match key.take() {
                    None => key = Some(value.into_owned()),
                    Some(name) => {
                        let whole = path.iter().skip(1).cloned().chain([name]).collect();
                        all.push((whole, value.into_owned(), span.start.line()));
                    }
                },
                _ => {}
            }
        }
        Ok(Self { file: file.to_owned(), all })
    }

    /// Whether something stands below this path.
    pub fn has(&self, path: &[&str]) -> bool {
        self.all.iter().any(|(own, _, _)| own.len() > path.len() && own.iter().zip(path).all(|(own, key)| own == key))
    }

    /// The text at a path.
    pub fn text(&self, path: &[&str]) -> Option<&str> {
        self.all.iter().find(|(own, _, _)| own.iter().eq(path.iter())).map(|(_, text, _)| text.as_str())
    }

    /// The six numbers of an origin below this path.
    pub fn origin(&self, path: &[&str]) -> Result<[f64; 6], KinematicsFileError> {
        let mut numbers = [0.0; 6];
        for (number, key) in numbers.iter_mut().zip(KEYS) {
            let whole: Vec<&str> = path.iter().copied().chain([key]).collect();
            let found = self.all.iter().find(|(own, _, _)| own.iter().eq(whole.iter()));
            let Some((_, text, line)) = found else {
                let (file, name) = (self.file.clone(), path.join("."));
                return Err(KinematicsFileError::Missing { file, name, key });
            };
            let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
            *number = value.ok_or_else(|| KinematicsFileError::NotANumber {
                file: self.file.clone(),
                line: *line,
                path: whole.join("."),
                text: text.clone(),
            })?;
        }
        Ok(numbers)
    }
}
