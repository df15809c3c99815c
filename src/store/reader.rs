//! Read access to a run database, safe while the run goes on.

use rusqlite::{OptionalExtension, Row};

use super::*;

/// A run database open for reading. Takes no lock on the run directory: a run in it goes on.
#[derive(Debug)]
pub struct RunReader {
    pub(super) connection: Connection,
    pub(super) database: PathBuf,
}

impl RunReader {
    /// Opens the run in `directory`.
    ///
    /// # Errors
    /// The directory holds no run, or one that is foreign, of another version or unreadable.
    pub fn open(directory: &Path) -> Result<Self, StoreError> {
        let database = database_path(directory);
        // Not read-only for the system: a killed run leaves half a transaction in its journal, and the first who opens
        // the database has to take it back. Nothing else is written.
        let connection = files::open_existing(&database)?.ok_or_else(|| StoreError::NoRun(directory.to_owned()))?;
        let read_error = |source| StoreError::ReadDatabase { path: database.clone(), source };
        connection.execute_batch("PRAGMA query_only = ON; PRAGMA trusted_schema = OFF;").map_err(read_error)?;
        Ok(Self { connection, database })
    }

    /// The database file.
    pub fn database(&self) -> &Path {
        &self.database
    }

    /// Runs `read`, which sees the run as it is between two of its transactions. The run waits for it with its next
    /// one, so what takes long (drawing, writing files) comes afterwards.
    ///
    /// # Errors
    /// The database cannot be read, or what `read` returns.
    pub fn snapshot<T>(&self, read: impl FnOnce(&Self) -> Result<T, StoreError>) -> Result<T, StoreError> {
        let transaction = self.connection.unchecked_transaction().map_err(|source| self.unreadable(source))?;
        let result = read(self);
        drop(transaction);
        result
    }

    /// The first row of a query.
    pub(super) fn query<T>(
        &self,
        sql: &str,
        read: impl FnOnce(&Row) -> rusqlite::Result<T>,
    ) -> Result<Option<T>, StoreError> {
        self.connection.query_row(sql, [], read).optional().map_err(|source| self.unreadable(source))
    }

    /// All rows of a query.
    pub(super) fn rows<T>(
        &self,
        sql: &str,
        read: impl FnMut(&Row) -> rusqlite::Result<T>,
    ) -> Result<Vec<T>, StoreError> {
        let mut statement = self.connection.prepare(sql).map_err(|source| self.unreadable(source))?;
        let rows = statement.query_map([], read).map_err(|source| self.unreadable(source))?;
        rows.collect::<Result<_, _>>().map_err(|source| self.unreadable(source))
    }

    fn unreadable(&self, source: rusqlite::Error) -> StoreError {
        StoreError::ReadDatabase { path: self.database.clone(), source }
    }

    /// The error of a database that lacks something or holds nonsense.
    pub fn damaged(&self, what: impl Into<String>) -> StoreError {
        StoreError::Damaged { path: self.database.clone(), what: what.into() }
    }
}
