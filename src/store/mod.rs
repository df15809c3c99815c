//! The run directory: `scene.json` and `run.sqlite`, locked, transactional, resumable.
//!
//! Clusters keep run directories on network file systems, so the database uses a rollback journal instead of a
//! write-ahead log, and the directory is held by an operating-system lock on `scene.json`, which a killed process
//! releases by dying. Every write of this module is one transaction with `synchronous = FULL`.

mod blob;
mod error;
mod history;
mod ledger;
mod read;
mod reader;
mod records;
#[cfg(test)]
mod tests;
mod write;

use std::fs::{File, OpenOptions, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};

use rusqlite::Connection;

pub use error::StoreError;
pub use ledger::{Ledger, Part, PartTotal, Stopwatch};
pub use read::Totals;
pub use reader::RunReader;
pub use records::*;
pub use write::LegCommit;

use crate::scene::Scene;

/// `application_id` of a run database: "yorp" in ASCII.
const APPLICATION_ID: i64 = 0x796f_7270;
/// `user_version` of the tables in `schema.sql`.
const FORMAT_VERSION: i64 = 5;

/// An open run directory, held by this process until it is dropped.
#[derive(Debug)]
pub struct RunStore {
    reader: RunReader,
    session: i64,
    // Holds the operating system's lock on the directory.
    _lock: File,
}

/// What a run reads back of itself is what everybody else may read.
impl std::ops::Deref for RunStore {
    type Target = RunReader;

    fn deref(&self) -> &RunReader {
        &self.reader
    }
}

impl RunStore {
    /// Opens `directory` for a run of `scene`: starts one in an absent or run-free directory, continues one if
    /// `resume` is set. The flag returned with the store says whether a run was there.
    ///
    /// # Errors
    /// The directory holds a run and `resume` is not set, is locked, holds a run of another scene or a foreign or
    /// newer database, or cannot be written.
    pub fn open(directory: &Path, scene: &Scene, resume: bool) -> Result<(Self, bool), StoreError> {
        if directory.exists() && !directory.is_dir() {
            return Err(StoreError::NotADirectory(directory.to_owned()));
        }
        let database = directory.join("run.sqlite");
        let holds_run = |path: &Path| path.metadata().is_ok_and(|m| m.len() > 0);
        if holds_run(&database) && !resume {
            return Err(StoreError::HoldsRun(directory.to_owned()));
        }
        let write_error = |path: &Path| {
            let path = path.to_owned();
            move |source| StoreError::Write { path, source }
        };
        std::fs::create_dir_all(directory).map_err(write_error(directory))?;
        let scene_path = directory.join("scene.json");
        let mut lock = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(&scene_path)
            .map_err(write_error(&scene_path))?;
        match lock.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(StoreError::Locked(directory.to_owned())),
            Err(TryLockError::Error(source)) => return Err(StoreError::Write { path: scene_path, source }),
        }
        // Another process may have created the run between the first look and the lock.
        let existing = holds_run(&database);
        if existing && !resume {
            return Err(StoreError::HoldsRun(directory.to_owned()));
        }
        let reader = RunReader { connection: open_database(&database, existing)?, database };
        let mut store = Self { reader, session: 0, _lock: lock.try_clone().map_err(write_error(&scene_path))? };
        if existing {
            store.adopt(scene, directory)?;
        } else {
            store.create(scene)?;
        }
        lock.set_len(0).map_err(write_error(&scene_path))?;
        lock.write_all(scene.to_json().as_bytes()).map_err(write_error(&scene_path))?;
        lock.sync_all().map_err(write_error(&scene_path))?;
        store.begin_session()?;
        Ok((store, existing))
    }

    /// Writes the empty tables and the scene in one transaction: a kill leaves either no run or a whole one.
    fn create(&mut self, scene: &Scene) -> Result<(), StoreError> {
        let tables = format!(
            "PRAGMA application_id = {APPLICATION_ID}; PRAGMA user_version = {FORMAT_VERSION};\n{}",
            include_str!("schema.sql")
        );
        self.transaction(|tx| {
            tx.execute_batch(&tables)?;
            tx.execute("INSERT INTO run VALUES ('version', ?1)", [env!("CARGO_PKG_VERSION")])?;
            tx.execute("INSERT INTO run VALUES ('scene', ?1)", [scene.to_json()])?;
            Ok(())
        })
    }

    /// Checks that the run in the database is one of `scene`, and takes over a longer duration.
    fn adopt(&mut self, scene: &Scene, directory: &Path) -> Result<(), StoreError> {
        let stored = self.scene()?;
        if let Some(difference) = crate::scene::first_difference(&stored, scene) {
            return Err(StoreError::SceneDiffers {
                directory: directory.to_owned(),
                difference: difference.to_string(),
            });
        }
        let json = scene.to_json();
        self.transaction(|tx| {
            tx.execute("UPDATE run SET value = ?1 WHERE key = 'scene'", [json])?;
            Ok(())
        })
    }

    fn begin_session(&mut self) -> Result<(), StoreError> {
        let started = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).map_or(0, |d| d.as_secs());
        let host = std::env::var("HOSTNAME")
            .or_else(|_| std::fs::read_to_string("/etc/hostname").map(|h| h.trim().to_owned()))
            .unwrap_or_default();
        let threads = rayon::current_num_threads() as i64;
        let sql = "INSERT INTO meta_session (started_unix_s, host, threads, version, seconds, cpu_seconds) \
                   VALUES (?1, ?2, ?3, ?4, 0, 0)";
        let row = (started as i64, host, threads, crate::VERSION);
        self.transaction(|tx| tx.execute(sql, row).map(|_| ()))?;
        self.session = self.connection.last_insert_rowid();
        Ok(())
    }

    /// Runs `body` in one durable transaction.
    fn transaction(
        &mut self,
        body: impl FnOnce(&rusqlite::Transaction) -> Result<(), rusqlite::Error>,
    ) -> Result<(), StoreError> {
        let result = (|| {
            let tx = self.reader.connection.transaction_with_behavior(rusqlite::TransactionBehavior::Immediate)?;
            body(&tx)?;
            tx.commit()
        })();
        result.map_err(|source| StoreError::WriteDatabase { path: self.database.clone(), source })
    }
}

/// How long a transaction waits for somebody who reads: a report of a large run is no reason to end it.
const PATIENCE: std::time::Duration = std::time::Duration::from_secs(600);

/// Opens the database file for writing and checks that it is ours.
fn open_database(path: &Path, existing: bool) -> Result<Connection, StoreError> {
    let write_error = |source| StoreError::WriteDatabase { path: path.to_owned(), source };
    let connection = Connection::open(path).map_err(write_error)?;
    if existing {
        reader::check_format(&connection, path)?;
    }
    connection.busy_timeout(PATIENCE).map_err(write_error)?;
    connection
        .execute_batch("PRAGMA journal_mode = TRUNCATE; PRAGMA synchronous = FULL; PRAGMA trusted_schema = OFF;")
        .map_err(write_error)?;
    Ok(connection)
}
