//! The run directory: `scene.json` and `run.sqlite`, locked, transactional, resumable.
//!
//! Clusters keep run directories on network file systems, so the database uses a rollback journal instead of a
//! write-ahead log, and the directory is held by an operating-system lock on `.lock`, which a killed process releases by
//! dying. Every write of this module is one transaction with `synchronous = FULL`.

mod blob;
mod error;
mod files;
mod history;
mod ledger;
mod read;
mod reader;
mod records;
#[cfg(test)]
mod tests;
mod wait;
mod write;

use std::fs::File;
use std::path::{Path, PathBuf};

use rusqlite::Connection;

pub use error::StoreError;
pub use files::{database_path, run_directory, scene_of_torn_copy};
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
    /// The directory holds a run and `resume` is not set, is locked, holds a run of another scene, a foreign or newer
    /// database or a foreign file in the place of one of the run's, or cannot be written.
    pub fn open(directory: &Path, scene: &Scene, resume: bool) -> Result<(Self, bool), StoreError> {
        if directory.exists() && !directory.is_dir() {
            return Err(StoreError::NotADirectory(directory.to_owned()));
        }
        let database = database_path(directory);
        let existing = |directory: &Path| match files::open_existing(&database)? {
            Some(_) if !resume => Err(StoreError::HoldsRun(directory.to_owned())),
            other => Ok(other),
        };
        // A refusal leaves the directory as it is, without a lock file too.
        if existing(directory)?.is_none() {
            files::SceneCopy::of(directory)?.is_outdated(scene, None)?;
        }
        let cannot_write = |source| StoreError::Write { path: directory.to_owned(), source };
        std::fs::create_dir_all(directory).map_err(cannot_write)?;
        let lock = files::lock(directory)?;
        // Another process may have created the run between the first look and the lock.
        let found = existing(directory)?;
        let existed = found.is_some();
        let copy = files::SceneCopy::of(directory)?;
        let connection = match found {
            Some(connection) => connection,
            None => {
                copy.is_outdated(scene, None)?;
                files::create(&database, scene)?;
                files::open_existing(&database)?.ok_or_else(|| StoreError::NoRun(directory.to_owned()))?
            }
        };
        prepare(&connection, &database)?;
        let mut store = Self { reader: RunReader { connection, database }, session: 0, _lock: lock };
        store.adopt(scene, directory, &copy)?;
        store.begin_session()?;
        Ok((store, existed))
    }

    /// Checks that the run in the database is one of `scene`, takes over a longer duration, and writes the copy of the
    /// scene if it is missing, torn or of the shorter run.
    fn adopt(&mut self, scene: &Scene, directory: &Path, copy: &files::SceneCopy) -> Result<(), StoreError> {
        let stored = self.scene()?;
        if let Some(difference) = crate::scene::first_difference(&stored, scene) {
            return Err(StoreError::SceneDiffers {
                directory: directory.to_owned(),
                difference: difference.to_string(),
            });
        }
        let outdated = copy.is_outdated(scene, Some(&stored))?;
        if stored != *scene {
            let json = scene.to_json();
            self.transaction(|tx| {
                tx.execute("UPDATE run SET value = ?1 WHERE key = 'scene'", [json])?;
                Ok(())
            })?;
        }
        if outdated { copy.write(scene) } else { Ok(()) }
    }

    fn begin_session(&mut self) -> Result<(), StoreError> {
        let started = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).map_or(0, |d| d.as_secs());
        let host = std::env::var("HOSTNAME")
            .or_else(|_| std::fs::read_to_string("/etc/hostname").map(|h| h.trim().to_owned()))
            .unwrap_or_default();
        let threads = rayon::current_num_threads() as i64;
        let sql = "INSERT INTO meta_session (started_unix_s, host, threads, version, processor, seconds, cpu_seconds) \
                   VALUES (?1, ?2, ?3, ?4, ?5, 0, 0)";
        let row = (started as i64, host, threads, crate::VERSION, processor());
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

/// Name of the processor, where the system tells it, and the level of vector instructions in use.
fn processor() -> String {
    let told = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = told.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": ").map(|(_, name)| name));
    let level = pkd::simd::Level::asked().unwrap_or_else(|_| pkd::simd::Level::present()).name();
    format!("{} ({level})", name.unwrap_or(std::env::consts::ARCH))
}

/// Makes an open database ready for the transactions of a run.
fn prepare(connection: &Connection, path: &Path) -> Result<(), StoreError> {
    connection
        .execute_batch("PRAGMA journal_mode = TRUNCATE; PRAGMA synchronous = FULL; PRAGMA trusted_schema = OFF;")
        .map_err(|source| StoreError::WriteDatabase { path: path.to_owned(), source })
}
