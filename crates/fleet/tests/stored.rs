//! What is put into a store comes out of it.

use denavit_fleet::store::Store;
use denavit_fleet::store::schema::{Column, NOTES, RUNS, TableKind};
use denavit_fleet::store::table::{Cell, Rows};
use denavit_fleet::{Day, FleetError};

fn row(table: &'static TableKind, key: &str, serial: &str) -> Vec<Cell> {
    let mut row = vec![Cell::Empty; table.columns().count()];
    row[0] = key.into();
    row[1] = serial.into();
    row[3] = "check".into();
    row
}

fn parquet(rows: &Rows) -> (String, Vec<u8>) {
    (rows.table.name.to_owned(), rows.parquet().unwrap())
}

#[test]
fn cells_of_every_kind_come_back_and_empty_ones_stay_empty() {
    let folder = tempfile::tempdir().unwrap();
    let held = Store::hold(folder.path()).unwrap();
    let key = "a".repeat(64);
    let mut full = row(&RUNS, &key, "SN ✓");
    full[2] = Cell::Day("2026-11-22".parse::<Day>().unwrap().0);
    full[RUNS.index("ok")] = false.into();
    full[RUNS.index("rms")] = f64::MIN_POSITIVE.into();
    full[RUNS.index("rows_fitted")] = 17_usize.into();
    let rows = Rows { table: &RUNS, rows: vec![row(&RUNS, &key, "first"), full.clone()] };
    let notes = Rows { table: &NOTES, rows: vec![row(&NOTES, &key, "first")] };
    held.store.add(&key, &[parquet(&rows), parquet(&notes)]).unwrap();
    let mut read = Vec::new();
    held.store
        .each_group(&RUNS, &[], &mut |rows| {
            read.extend_from_slice(rows);
            Ok(())
        })
        .unwrap();
    assert_eq!(read, [row(&RUNS, &key, "first"), full]);
}

#[test]
fn tables_without_their_run_are_taken_away_and_foreign_files_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let held = Store::hold(folder.path()).unwrap();
    let key = "b".repeat(64);
    let notes = Rows { table: &NOTES, rows: vec![row(&NOTES, &key, "A")] };
    held.store.add(&key, &[parquet(&notes)]).unwrap();
    assert!(matches!(Store::hold(folder.path()), Err(FleetError::Busy(_))));
    drop(held);
    std::fs::write(folder.path().join("runs/.denavit-half"), "half a file").unwrap();
    let held = Store::hold(folder.path()).unwrap();
    assert_eq!(std::fs::read_dir(folder.path().join("notes")).unwrap().count(), 0);
    assert_eq!(std::fs::read_dir(folder.path().join("runs")).unwrap().count(), 0);
    std::fs::write(folder.path().join("runs/mine.parquet"), "no parquet").unwrap();
    let error = held.store.runs().unwrap_err().to_string();
    assert!(error.contains("mine.parquet: this is not a file of a fleet store"), "{error}");
}

#[test]
fn a_store_of_an_older_version_has_empty_cells_where_columns_came_later() {
    let folder = tempfile::tempdir().unwrap();
    let held = Store::hold(folder.path()).unwrap();
    let own: Vec<Column> = RUNS.own.iter().filter(|column| !column.added).copied().collect();
    assert!(own.len() < RUNS.own.len());
    let old: &TableKind = Box::leak(Box::new(TableKind { name: RUNS.name, row: RUNS.row, own: own.leak() }));
    let key = "c".repeat(64);
    let mut written = row(old, &key, "A");
    written[old.index("ok")] = true.into();
    held.store.add(&key, &[parquet(&Rows { table: old, rows: vec![written] })]).unwrap();
    std::fs::remove_dir(folder.path().join("information")).unwrap();
    let mut expected = row(&RUNS, &key, "A");
    expected[RUNS.index("ok")] = true.into();
    let mut read = Vec::new();
    let mut take = |rows: &[Vec<Cell>]| {
        read.extend_from_slice(rows);
        Ok(())
    };
    held.store.each_group(&RUNS, &[], &mut take).unwrap();
    held.store.each_group(&denavit_fleet::store::schema::INFORMATION, &[], &mut |_| Ok(())).unwrap();
    assert_eq!(read, [expected]);
}

/// A manifest's entry of a check of one robot, whose file is not there: it fails as long as that is so.
fn entries(folder: &std::path::Path) -> Vec<denavit_fleet::manifest::Entry> {
    let manifest = folder.join("plant.csv");
    std::fs::write(&manifest, "serial,robot,date,task\nSN-1,missing.urdf,2026-01-02,check\n").unwrap();
    denavit_fleet::manifest::read(manifest.to_str().unwrap(), &[]).unwrap()
}

#[test]
fn a_run_that_failed_is_done_again_and_stands_in_the_store_once() {
    let folder = tempfile::tempdir().unwrap();
    let entries = entries(folder.path());
    let store = folder.path().join("store");
    for _ in 0..3 {
        let held = Store::hold(&store).unwrap();
        let options = denavit_fleet::RunOptions { threads: 1, ..denavit_fleet::RunOptions::default() };
        let report =
            denavit_fleet::run(&entries, &held, &options, &|_, _| std::ops::ControlFlow::Continue(())).unwrap();
        assert_eq!((report.done, report.known, report.failed), (1, 0, 1));
        let runs = held.store.runs().unwrap();
        assert_eq!((runs.still_failed().len(), runs.done.len()), (1, 0));
        let mut rows = 0;
        let mut count = |some: &[Vec<Cell>]| {
            rows += some.len();
            Ok(())
        };
        held.store.each_group(&RUNS, &[], &mut count).unwrap();
        assert_eq!(rows, 1);
    }
}

#[test]
fn a_run_that_succeeds_later_is_failed_no_more() {
    let folder = tempfile::tempdir().unwrap();
    let entries = entries(folder.path());
    let held = Store::hold(&folder.path().join("store")).unwrap();
    let options = denavit_fleet::RunOptions { threads: 1, ..denavit_fleet::RunOptions::default() };
    let run = || denavit_fleet::run(&entries, &held, &options, &|_, _| std::ops::ControlFlow::Continue(())).unwrap();
    run();
    let key = held.store.runs().unwrap().failed.into_keys().next().unwrap();
    // The same inputs succeed: what failed was the machine.
    let mut row = row(&RUNS, &key, "SN-1");
    row[2] = Cell::Day("2026-01-02".parse::<Day>().unwrap().0);
    row[RUNS.index("ok")] = true.into();
    held.store.add(&key, &[parquet(&Rows { table: &RUNS, rows: vec![row] })]).unwrap();
    // Before they are merged both rows are there; the one that succeeded counts.
    assert!(held.store.runs().unwrap().still_failed().is_empty());
    let report = run();
    assert_eq!((report.done, report.known, report.failed), (0, 1, 0));
    let runs = held.store.runs().unwrap();
    assert_eq!((runs.done.len(), runs.failed.len()), (1, 0), "the merge replaces the failure");
}

/// A journal of a merge that was begun: hidden name and name below the store.
fn begun(store: &std::path::Path, hidden: &str, name: &str) {
    let plan = format!("{{\"remove\":[],\"rename\":[[\"{hidden}\",\"{name}\"]]}}");
    std::fs::write(store.join(".merge.json"), plan).unwrap();
}

#[test]
fn a_merge_is_not_done_where_the_system_refuses_or_a_file_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    let store = folder.path();
    drop(Store::hold(store).unwrap());
    // A name through a file: the system says that this is no folder, not that nothing is there.
    std::fs::write(store.join("file"), "").unwrap();
    for (hidden, name) in [("file/.denavit-1", "runs/rows-1.parquet"), ("runs/.denavit-1", "runs/rows-1.parquet")] {
        begun(store, hidden, name);
        let error = Store::hold(store).unwrap_err().to_string();
        assert!(error.contains("rows-1.parquet"), "{error}");
        assert!(store.join(".merge.json").exists(), "the journal stays until its files are in place");
    }
    // Done already: the result is there.
    std::fs::write(store.join("runs/rows-1.parquet"), "").unwrap();
    begun(store, "runs/.denavit-1", "runs/rows-1.parquet");
    drop(Store::hold(store).unwrap());
    assert!(!store.join(".merge.json").exists());
}
