//! The store: a folder of Parquet files that DuckDB, pandas and Polars read directly.
//!
//! ```text
//! STORE/runs/KEY.parquet        one small file per finished run and table
//! STORE/runs/rows-….parquet     many of them, merged
//! STORE/.merge.json             plan of a merge: read first when the store is opened after a crash
//! ```
//! A run's row is written after its other tables: a key in `runs` means that the run is complete. Files are written under
//! a hidden name and renamed; a merge first writes its plan, so that the next process can finish it.

mod cells;
mod merge;
pub mod schema;
pub mod table;

use self::schema::{RUNS, TABLES, TableKind};
use self::table::{Reader, Rows};
use crate::day::Day;
use crate::error::FleetError;
use std::collections::{HashMap, HashSet};
use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Prefix of the names of unfinished files.
pub(crate) const HIDDEN: &str = ".denavit-";
/// The file that one run at a time holds.
const LOCK: &str = ".lock";

/// A store.
#[derive(Debug)]
pub struct Store {
    folder: PathBuf,
}

/// A store that this process alone writes.
#[derive(Debug)]
pub struct LockedStore {
    /// The store.
    pub store: Store,
    /// Released when the process ends, in any way.
    _lock: File,
}

/// The runs of a store, by key.
#[derive(Debug, Clone, Default)]
pub struct Runs {
    /// Those that succeeded: they are not done again.
    pub done: HashMap<String, Slot>,
    /// Rows of those that failed, whether or not they succeeded later. The next run does them again.
    pub failed: HashMap<String, Failure>,
}

/// A run that failed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Failure {
    /// What it is of.
    pub slot: Slot,
    /// Why.
    pub error: String,
}

impl Runs {
    /// Runs that failed and have not succeeded since, by robot, night and task.
    pub fn still_failed(&self) -> Vec<&Failure> {
        let open = self.failed.iter().filter(|(key, _)| !self.done.contains_key(*key));
        let mut open: Vec<&Failure> = open.map(|(_, failure)| failure).collect();
        let order = |failure: &Failure| (failure.slot.serial.clone(), failure.slot.date, failure.slot.task.clone());
        open.sort_by_cached_key(|failure| order(failure));
        open
    }

    /// What every run is of, by key.
    pub(crate) fn slots(&self) -> impl Iterator<Item = (&String, &Slot)> {
        let failed = self.failed.iter().filter(|(key, _)| !self.done.contains_key(*key));
        self.done.iter().chain(failed.map(|(key, failure)| (key, &failure.slot)))
    }
}

/// What a run is of: a robot, a night, a task.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Slot {
    /// The robot.
    pub serial: String,
    /// The night.
    pub date: Option<Day>,
    /// Its name.
    pub task: String,
}

impl Store {
    /// A store to read.
    ///
    /// # Errors
    /// The folder has none.
    pub fn open(folder: &Path) -> Result<Self, FleetError> {
        if !folder.join(RUNS.name).is_dir() {
            return Err(FleetError::NoStore(folder.to_owned()));
        }
        Ok(Self { folder: folder.to_owned() })
    }

    /// A store to write, created if missing; remains of a killed run are cleaned up.
    ///
    /// # Errors
    /// Another run holds it, or the folder cannot be written.
    pub fn hold(folder: &Path) -> Result<LockedStore, FleetError> {
        for table in TABLES {
            let folder = folder.join(table.name);
            std::fs::create_dir_all(&folder).map_err(FleetError::store(&folder))?;
        }
        let path = folder.join(LOCK);
        let lock = File::options().create(true).truncate(false).write(true).open(&path);
        let lock = lock.map_err(FleetError::store(&path))?;
        match lock.try_lock() {
            Ok(()) => {}
            Err(std::fs::TryLockError::WouldBlock) => return Err(FleetError::Busy(folder.to_owned())),
            Err(std::fs::TryLockError::Error(error)) => return Err(FleetError::store(&path)(error)),
        }
        let store = Self { folder: folder.to_owned() };
        store.finish_merge()?;
        store.clean()?;
        Ok(LockedStore { store, _lock: lock })
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The runs of the store: what each is of, and whether it succeeded.
    ///
    /// # Errors
    /// A file cannot be read.
    pub fn runs(&self) -> Result<Runs, FleetError> {
        let mut runs = Runs::default();
        let wanted = ["key", "serial", "date", "task", "ok", "error"];
        let [key, serial, date, task, ok, error] = wanted.map(|name| RUNS.index(name));
        self.each_group(&RUNS, &wanted, &mut |rows| {
            for row in rows {
                let key = row[key].text();
                let slot = Slot {
                    serial: row[serial].text().to_owned(),
                    date: row[date].day().map(Day),
                    task: row[task].text().to_owned(),
                };
                if row[ok].is_true() {
                    runs.done.insert(key.to_owned(), slot);
                } else {
                    runs.failed.insert(key.to_owned(), Failure { slot, error: row[error].text().to_owned() });
                }
            }
            Ok(())
        })?;
        Ok(runs)
    }

    /// Reads a table, some thousand rows at a time, so that memory does not grow with the store; `wanted`: see
    /// [`Rows::each_group`].
    ///
    /// # Errors
    /// A file cannot be read, or `each` fails.
    pub fn each_group(
        &self,
        table: &'static TableKind,
        wanted: &[&str],
        each: &mut Reader<'_>,
    ) -> Result<(), FleetError> {
        self.files(table)?.iter().try_for_each(|path| Rows::each_group(table, path, wanted, each))
    }

    /// Writes the result of a run, name and Parquet of each table with rows; its row in `runs` last. A run written
    /// twice is stored once.
    ///
    /// # Errors
    /// The system refuses.
    pub fn add(&self, key: &str, tables: &[(String, Vec<u8>)]) -> Result<(), FleetError> {
        for kind in TABLES {
            for (_, parquet) in tables.iter().filter(|(name, _)| name == kind.name) {
                let target = self.folder.join(kind.name).join(format!("{key}.parquet"));
                let file = self.fill(kind, |mut file| file.write_all(parquet).map_err(FleetError::store(&target)))?;
                file.persist(&target).map_err(|error| FleetError::store(&target)(error.error))?;
            }
        }
        Ok(())
    }

    /// A hidden file of a table, on the disk.
    fn fill(
        &self,
        table: &TableKind,
        write: impl FnOnce(&File) -> Result<(), FleetError>,
    ) -> Result<tempfile::NamedTempFile, FleetError> {
        let folder = self.folder.join(table.name);
        let refused = FleetError::store;
        let file = tempfile::Builder::new().prefix(HIDDEN).tempfile_in(&folder).map_err(refused(&folder))?;
        write(file.as_file())?;
        readable_by_all(file.as_file()).and_then(|()| file.as_file().sync_all()).map_err(refused(file.path()))?;
        Ok(file)
    }

    /// The Parquet files of a table, in order.
    fn files(&self, table: &TableKind) -> Result<Vec<PathBuf>, FleetError> {
        Ok(self.entries(table)?.into_iter().filter(|path| !is_hidden(path) && is_parquet(path)).collect())
    }

    fn entries(&self, table: &TableKind) -> Result<Vec<PathBuf>, FleetError> {
        let folder = self.folder.join(table.name);
        let failed = || FleetError::store(&folder);
        let entries = match std::fs::read_dir(&folder) {
            Ok(entries) => entries,
            // Stores of older versions lack the tables that came later.
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
            Err(error) => return Err(failed()(error)),
        };
        let mut paths = Vec::new();
        for entry in entries {
            paths.push(entry.map_err(failed())?.path());
        }
        paths.sort();
        Ok(paths)
    }

    /// Removes the remains of a killed run: hidden files, and tables of runs without a row.
    fn clean(&self) -> Result<(), FleetError> {
        let runs: HashSet<String> = self.files(&RUNS)?.iter().filter_map(|path| key_of(path)).collect();
        for table in TABLES {
            for path in self.entries(table)? {
                let abandoned = is_hidden(&path) || key_of(&path).is_some_and(|key| !runs.contains(&key));
                if abandoned {
                    std::fs::remove_file(&path).map_err(FleetError::store(&path))?;
                }
            }
        }
        Ok(())
    }
}

fn is_hidden(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(HIDDEN))
}

fn is_parquet(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "parquet")
}

/// The key of a small file; a merged one has none.
fn key_of(path: &Path) -> Option<String> {
    let stem = path.file_stem()?.to_string_lossy().into_owned();
    (is_parquet(path) && stem.len() == 64 && stem.bytes().all(|byte| byte.is_ascii_hexdigit())).then_some(stem)
}

/// Temporary files are private; the store's files are readable by others.
#[cfg(unix)]
fn readable_by_all(file: &File) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt as _;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn readable_by_all(_: &File) -> std::io::Result<()> {
    Ok(())
}
