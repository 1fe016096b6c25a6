//! Merges small files into one and removes replaced rows: an interrupted merge is finished when the store is next opened.

use super::schema::{RUNS, TABLES, TableKind};
use super::table::{Groups, Rows};
use super::{HIDDEN, Runs, Store, key_of};
use crate::error::FleetError;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// The plan of a merge.
const JOURNAL: &str = ".merge.json";

/// Names below the store's folder.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Plan {
    /// To be removed.
    remove: Vec<PathBuf>,
    /// Hidden name, name.
    rename: Vec<(PathBuf, PathBuf)>,
}

impl Store {
    /// Merges the small files of finished runs, except those in `gone`. Rows of failed runs (`before`) that were repeated
    /// are replaced.
    ///
    /// Runs that are being written meanwhile keep their files: only keys that have their row in `runs` are merged. Merged
    /// files are rewritten only if they hold a run in `gone`, each by itself, so that memory does not grow with the store.
    ///
    /// # Errors
    /// An operating system error; the store is then unchanged.
    pub(crate) fn merge(&self, gone: &HashSet<String>, before: &Runs) -> Result<(), FleetError> {
        let keys: HashSet<String> = self.files(&RUNS)?.iter().filter_map(|path| key_of(path)).collect();
        if keys.is_empty() && gone.is_empty() {
            return Ok(());
        }
        // Merged files hold the failures that the small files replace.
        let again = keys.iter().filter(|key| before.failed.contains_key(*key));
        let old: HashSet<String> = gone.iter().chain(again).cloned().collect();
        let mut plan = Plan::default();
        for table in TABLES {
            let (small, merged): (Vec<_>, Vec<_>) =
                self.files(table)?.into_iter().partition(|path| key_of(path).is_some());
            let ended = |path: &PathBuf| key_of(path).is_some_and(|key| keys.contains(&key));
            // In the order of their names, so that the rows are in the order of their keys.
            self.rewrite(table, &small.into_iter().filter(ended).collect::<Vec<_>>(), gone, &mut plan)?;
            for path in merged {
                if holds(&path, table, &old)? {
                    self.rewrite(table, &[path], &old, &mut plan)?;
                }
            }
        }
        // A file that keeps its name is replaced by the renaming.
        plan.remove.retain(|path| !plan.rename.iter().any(|(_, name)| name == path));
        // The replacing files are on the disk, under their names, before the plan.
        self.sync_tables()?;
        self.write_plan(&plan)?;
        self.carry_out(&plan)
    }

    /// The rows of some files, without those of runs in `gone`, in one hidden file that the plan renames.
    fn rewrite(
        &self,
        table: &'static TableKind,
        paths: &[PathBuf],
        gone: &HashSet<String>,
        plan: &mut Plan,
    ) -> Result<(), FleetError> {
        if paths.is_empty() {
            return Ok(());
        }
        let key = table.index("key");
        // The same rows, the same name.
        let mut hash = Sha256::new();
        let mut any = false;
        let file = self.fill(table, |file| {
            let mut groups = Groups::begin(table, file)?;
            for path in paths {
                Rows::each_group(table, path, &[], &mut |rows| {
                    for row in rows.iter().filter(|row| !gone.contains(row[key].text())) {
                        hash.update(row[key].text().as_bytes());
                        any = true;
                        groups.push(row.clone())?;
                    }
                    Ok(())
                })?;
            }
            groups.end()
        })?;
        plan.remove.extend(paths.iter().map(|path| self.below(path)));
        if any {
            let (_, hidden) = file.keep().map_err(|error| FleetError::store(&self.folder)(error.error))?;
            let name = format!("rows-{}.parquet", base16ct::lower::encode_string(&hash.finalize()[..8]));
            plan.rename.push((self.below(&hidden), PathBuf::from(table.name).join(name)));
        }
        Ok(())
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
        sync_folder(&self.folder)
    }

    /// Every step may have been done already. The small files go first: a reader may for a moment miss rows, but sees none
    /// twice. The plan goes when the names of all files are on the disk.
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
            match std::fs::rename(&hidden, &name) {
                Ok(()) => {}
                // Done already, if its result is there.
                Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                    std::fs::symlink_metadata(&name).map_err(FleetError::store(&name))?;
                }
                Err(error) => return Err(FleetError::store(&name)(error)),
            }
        }
        self.sync_tables()?;
        let journal = self.folder.join(JOURNAL);
        std::fs::remove_file(&journal).map_err(FleetError::store(&journal))?;
        sync_folder(&self.folder)
    }

    fn sync_tables(&self) -> Result<(), FleetError> {
        TABLES.iter().map(|table| self.folder.join(table.name)).try_for_each(|folder| sync_folder(&folder))
    }

    fn below(&self, path: &Path) -> PathBuf {
        path.strip_prefix(&self.folder).unwrap_or(path).to_owned()
    }
}

/// Writes the names of a folder's files to the disk. Systems other than Unix open no folders; they keep names in order by themselves.
fn sync_folder(folder: &Path) -> Result<(), FleetError> {
    if cfg!(unix) {
        let opened = std::fs::File::open(folder).map_err(FleetError::store(folder))?;
        opened.sync_all().map_err(FleetError::store(folder))?;
    }
    Ok(())
}

/// Whether a file holds rows of removed runs.
fn holds(path: &Path, table: &'static TableKind, gone: &HashSet<String>) -> Result<bool, FleetError> {
    let mut found = false;
    if !gone.is_empty() {
        let key = table.index("key");
        Rows::each_group(table, path, &["key"], &mut |rows| {
            found |= rows.iter().any(|row| gone.contains(row[key].text()));
            Ok(())
        })?;
    }
    Ok(found)
}
