//! Small files become one, and rows that newer ones replace go: a merge is done wholly, or by whoever opens the store next.

use super::schema::{RUNS, TABLES};
use super::table::{Cell, Rows};
use super::{HIDDEN, Store, key_of};
use crate::error::FleetError;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::HashSet;
use std::path::PathBuf;

/// What a merge is about to do.
const JOURNAL: &str = ".merge.json";

/// Names below the store's folder.
#[derive(Debug, Serialize, Deserialize)]
struct Plan {
    /// Goes.
    remove: Vec<PathBuf>,
    /// Hidden name, name.
    rename: Vec<(PathBuf, PathBuf)>,
}

impl Store {
    /// Merges the small files of finished runs, those in `gone` left out.
    ///
    /// Runs that are being written meanwhile keep their files: only keys that have their row in `runs` are merged. Merged
    /// files are read again only where a run in `gone` stands in them.
    ///
    /// # Errors
    /// The system refuses; the store is then as before.
    pub(crate) fn merge(&self, gone: &HashSet<String>) -> Result<(), FleetError> {
        let keys: HashSet<String> = self.files(&RUNS)?.iter().filter_map(|path| key_of(path)).collect();
        if keys.is_empty() && gone.is_empty() {
            return Ok(());
        }
        let mut plan = Plan { remove: Vec::new(), rename: Vec::new() };
        for table in TABLES {
            let key = table.index("key");
            let mut merged = Rows::of(table);
            for path in self.files(table)? {
                let of_key = key_of(&path);
                if of_key.as_ref().is_some_and(|key| !keys.contains(key)) {
                    continue;
                }
                let stays = of_key.is_none() && !holds(&path, table, gone)?;
                if stays {
                    continue;
                }
                merged.read(&path, &[])?;
                plan.remove.push(self.below(&path));
            }
            merged.rows.retain(|row| !gone.contains(row[key].text()));
            if merged.rows.is_empty() {
                continue;
            }
            // Files are read in the order of their names, so the rows stand in that of their keys.
            let file = self.fill(&merged)?;
            let (_, hidden) = file.keep().map_err(|error| FleetError::store(&self.folder)(error.error))?;
            let name = format!("rows-{}.parquet", digest(merged.rows.iter().map(|row| row[key].text())));
            plan.rename.push((self.below(&hidden), PathBuf::from(table.name).join(name)));
        }
        // A file that keeps its name is replaced by the renaming.
        plan.remove.retain(|path| !plan.rename.iter().any(|(_, name)| name == path));
        self.write_plan(&plan)?;
        self.carry_out(&plan)
    }

    /// Ends a merge that was begun.
    pub(super) fn finish_merge(&self) -> Result<(), FleetError> {
        let path = self.folder.join(JOURNAL);
        let text = match std::fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(()),
            Err(error) => return Err(FleetError::store(&path)(error)),
        };
        let plan: Plan = serde_json::from_str(&text)
            .map_err(|error| FleetError::NotOurs { file: path.clone(), reason: error.to_string() })?;
        self.carry_out(&plan)
    }

    fn write_plan(&self, plan: &Plan) -> Result<(), FleetError> {
        let refused = FleetError::store;
        let file = tempfile::Builder::new().prefix(HIDDEN).tempfile_in(&self.folder).map_err(refused(&self.folder))?;
        serde_json::to_writer(file.as_file(), plan).map_err(|error| refused(file.path())(error.into()))?;
        file.as_file().sync_all().map_err(refused(file.path()))?;
        let target = self.folder.join(JOURNAL);
        file.persist(&target).map_err(|error| refused(&target)(error.error))?;
        Ok(())
    }

    /// Every step may have been done already. The small files go first: a reader may for a moment miss rows, but sees none
    /// twice.
    fn carry_out(&self, plan: &Plan) -> Result<(), FleetError> {
        for path in plan.remove.iter().map(|path| self.folder.join(path)) {
            match std::fs::remove_file(&path) {
                Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                    return Err(FleetError::store(&path)(error));
                }
                _ => {}
            }
        }
        for (hidden, name) in &plan.rename {
            let (hidden, name) = (self.folder.join(hidden), self.folder.join(name));
            if hidden.exists() {
                std::fs::rename(&hidden, &name).map_err(FleetError::store(&name))?;
            }
        }
        let journal = self.folder.join(JOURNAL);
        std::fs::remove_file(&journal).map_err(FleetError::store(&journal))
    }

    fn below(&self, path: &std::path::Path) -> PathBuf {
        path.strip_prefix(&self.folder).unwrap_or(path).to_owned()
    }
}

/// Whether a file holds rows of runs that go.
fn holds(path: &std::path::Path, table: &'static super::TableKind, gone: &HashSet<String>) -> Result<bool, FleetError> {
    if gone.is_empty() {
        return Ok(false);
    }
    let mut rows = Rows::of(table);
    rows.read(path, &["key"])?;
    let key = table.index("key");
    Ok(rows.rows.iter().any(|row: &Vec<Cell>| gone.contains(row[key].text())))
}

/// A name for a set of rows: the same rows, the same name.
fn digest<'a>(keys: impl Iterator<Item = &'a str>) -> String {
    let mut hash = Sha256::new();
    keys.for_each(|key| hash.update(key.as_bytes()));
    base16ct::lower::encode_string(&hash.finalize()[..8])
}
