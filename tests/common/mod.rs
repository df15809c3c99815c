//! What the tests of the program share: asking it, reading its answer, and comparing run databases.

#![allow(dead_code, reason = "each test file uses a part")]

pub mod judge;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use rusqlite::types::Value as Cell;
use rusqlite::{Connection, OpenFlags};
use serde_json::Value;

/// The program.
pub fn yorp() -> Command {
    Command::new(env!("CARGO_BIN_EXE_yorp"))
}

/// Its answer to these arguments.
pub fn ask(arguments: &[&dyn AsRef<OsStr>]) -> Output {
    yorp().args(arguments.iter().map(|a| a.as_ref())).output().unwrap()
}

/// The object that a successful answer prints.
pub fn json(output: &Output) -> Value {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Asserts that the program refused with this exit status, and said so.
pub fn refused(output: &Output, code: i32, message: &str) {
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{stderr}");
    assert!(stderr.contains(message), "{stderr}");
    assert!(output.stdout.is_empty());
}

/// A new file with this text.
pub fn file(folder: &Path, name: &str, text: &str) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

/// The database of a run.
pub fn open(run: &Path) -> Connection {
    Connection::open_with_flags(run.join("run.sqlite"), OpenFlags::SQLITE_OPEN_READ_ONLY).unwrap()
}

/// Rows of a table of a run; none while there is no table.
pub fn count(run: &Path, table: &str) -> i64 {
    let count = || open(run).query_row(&format!("SELECT count(*) FROM {table}"), [], |row| row.get(0));
    // Busy or not yet there while the program is writing.
    if run.join("run.sqlite").exists() { count().unwrap_or(0) } else { 0 }
}

/// Asserts that two runs hold the same, but for the tables `meta_*`.
pub fn assert_same(a: &Path, b: &Path) {
    for ((name, left), (other, right)) in contents(a).into_iter().zip(contents(b)) {
        assert_eq!(name, other);
        assert_eq!(left.len(), right.len(), "rows of {name}");
        for (row, (l, r)) in left.iter().zip(&right).enumerate() {
            assert!(l == r, "row {row} of {name} differs");
        }
    }
}

/// All rows of all tables but `meta_*`, table by table.
pub fn contents(run: &Path) -> Vec<(String, Vec<Vec<Cell>>)> {
    let db = open(run);
    let mut names = db.prepare("SELECT name FROM sqlite_schema WHERE type = 'table' ORDER BY name").unwrap();
    let names: Vec<String> = names.query_map([], |row| row.get(0)).unwrap().map(Result::unwrap).collect();
    let tables = names.into_iter().filter(|name| !name.starts_with("meta_") && !name.starts_with("sqlite_"));
    let rows = |table: &String| {
        let mut all = db.prepare(&format!("SELECT * FROM {table}")).unwrap();
        let columns = all.column_count();
        let rows = all.query_map([], |row| (0..columns).map(|c| row.get::<_, Cell>(c)).collect()).unwrap();
        rows.map(Result::unwrap).collect::<Vec<Vec<Cell>>>()
    };
    tables.map(|table| (table.clone(), rows(&table))).collect()
}
