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
    let error = held.store.finished().unwrap_err().to_string();
    assert!(error.contains("mine.parquet: this is no file of a fleet's store"), "{error}");
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
