//! Which files a document may cause to be read.

use std::path::{Path, PathBuf};

use crate::error::{ErrorKind, XacroError};
use crate::files;

/// Which files may be read for a document.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FileAccess {
    /// Files below the folder of the document or of its package, below packages that are found, and below these
    /// folders too.
    Below(Vec<PathBuf>),
    /// Any file that the user can read.
    Any,
}

impl Default for FileAccess {
    fn default() -> Self {
        Self::Below(Vec::new())
    }
}

/// The folders that are open, links resolved.
#[derive(Debug)]
pub(crate) struct Gate {
    roots: Option<Vec<PathBuf>>,
}

impl Gate {
    pub fn new(access: &FileAccess) -> Self {
        match access {
            FileAccess::Any => Self { roots: None },
            FileAccess::Below(folders) => {
                let mut gate = Self { roots: Some(Vec::new()) };
                for folder in folders {
                    gate.open(folder);
                }
                gate
            }
        }
    }

    /// Opens a folder. Where a build tool has linked an installed package to its sources, the sources are open too.
    pub fn open(&mut self, folder: &Path) {
        let Some(roots) = &mut self.roots else { return };
        let real = files::canonical(folder).ok();
        let sources = files::canonical(&folder.join("package.xml"))
            .ok()
            .and_then(|manifest| manifest.parent().map(Path::to_path_buf));
        for root in [real, sources].into_iter().flatten() {
            if !roots.contains(&root) {
                roots.push(root);
            }
        }
    }

    /// Reads a text file, if it may be read and has at most `bytes` bytes.
    pub fn read(&self, path: &Path, bytes: usize) -> Result<String, Box<XacroError>> {
        let failure = |error: &std::io::Error| {
            let reason = match error.kind() {
                std::io::ErrorKind::NotFound => "there is no such file".to_owned(),
                _ => error.to_string(),
            };
            XacroError::new(ErrorKind::Read, format!("\"{}\" cannot be read: {reason}", path.display()))
        };
        let real = files::canonical(path).map_err(|error| failure(&error))?;
        if let Some(roots) = &self.roots
            && !roots.iter().any(|root| real.starts_with(root))
        {
            let open: Vec<String> = roots.iter().map(|root| root.display().to_string()).collect();
            return Err(XacroError::new(
                ErrorKind::Access,
                format!("\"{}\" is outside the folders that may be read ({})", real.display(), open.join(", ")),
            )
            .help("if you trust the document, allow any file, or add the folder to the package path"));
        }
        let Some(size) = files::size(&real).map_err(|error| failure(&error))? else {
            return Err(XacroError::new(ErrorKind::Read, format!("\"{}\" is not a file", path.display())));
        };
        if size > bytes as u64 {
            return Err(XacroError::new(
                ErrorKind::Limit,
                format!("\"{}\" has more than {bytes} bytes", path.display()),
            ));
        }
        let content = files::read(&real).map_err(|error| failure(&error))?;
        String::from_utf8(content)
            .map_err(|_| XacroError::new(ErrorKind::Read, format!("\"{}\" is not text in UTF-8", path.display())))
    }
}
