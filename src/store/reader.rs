//! Read access to a run database, safe while the run goes on.

use rusqlite::{OpenFlags, OptionalExtension, Row};

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
        let database = directory.join("run.sqlite");
        if !database.metadata().is_ok_and(|m| m.is_file() && m.len() > 0) {
            return Err(StoreError::NoRun(directory.to_owned()));
        }
        let read_error = |source| StoreError::ReadDatabase { path: database.clone(), source };
        // Not read-only for the system: a killed run leaves half a transaction in its journal, and the first who opens
        // the database has to take it back. Nothing else is written.
        let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let connection = Connection::open_with_flags(&database, flags).map_err(read_error)?;
        check_format(&connection, &database)?;
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

/// Whether the database is one of ours and of this build's format.
pub(super) fn check_format(connection: &Connection, path: &Path) -> Result<(), StoreError> {
    let read_error = |source| StoreError::ReadDatabase { path: path.to_owned(), source };
    let pragma = |name: &str| connection.pragma_query_value(None, name, |row| row.get::<_, i64>(0));
    let id = pragma("application_id").map_err(|source| match source.sqlite_error_code() {
        Some(rusqlite::ErrorCode::NotADatabase) => {
            StoreError::Foreign { path: path.to_owned(), found: "no SQLite database".into() }
        }
        _ => read_error(source),
    })?;
    if id != APPLICATION_ID {
        return Err(StoreError::Foreign { path: path.to_owned(), found: format!("application id {id:#x}") });
    }
    let version = pragma("user_version").map_err(read_error)?;
    if version != FORMAT_VERSION {
        return Err(StoreError::Version { path: path.to_owned(), found: version, expected: FORMAT_VERSION });
    }
    Ok(())
}
