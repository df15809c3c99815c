//! The files of a run directory: which of them are ours, known by what they hold, and how they come into being.
//!
//! A kill at any moment leaves each of them whole, absent, or in a state that the next start knows and mends; a file of
//! somebody else is never replaced.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Read as _};
use std::path::{Path, PathBuf};

use rusqlite::{Connection, OpenFlags};

use super::{APPLICATION_ID, FORMAT_VERSION, StoreError};
use crate::exchange::{folder_of, sync_folder, write_durably};
use crate::scene::{MAX_SCENE_BYTES, Scene};

/// The database.
const DATABASE: &str = "run.sqlite";
/// The scene as run.
const SCENE: &str = "scene.json";
/// What a process that works in the directory holds locked; it stays empty.
const LOCK: &str = ".lock";
/// First bytes of every SQLite database.
const MAGIC: &[u8; 16] = b"SQLite format 3\0";
/// First bytes of its journal.
const JOURNAL_MAGIC: [u8; 8] = [0xd9, 0xd5, 0x05, 0xf9, 0x20, 0xa1, 0x63, 0xd7];

/// The database of the run in `directory`.
pub fn database_path(directory: &Path) -> PathBuf {
    directory.join(DATABASE)
}

/// The run that `path` leads into: that of a file in a run directory is the directory.
///
/// Anything else comes back as it is.
pub fn run_directory(path: &Path) -> PathBuf {
    let holds_run = |folder: &&Path| database_path(folder).is_file();
    let folder = path.is_file().then(|| path.ancestors().skip(1).map(|f| folder_of(&f.join(LOCK)).to_owned()));
    let found = folder.and_then(|mut folders| folders.find(|folder| holds_run(&folder.as_path())));
    found.unwrap_or_else(|| path.to_owned())
}

/// Locks `directory` for this process, until the file is dropped.
///
/// The lock is the operating system's, on a file of its own: a killed process releases it by dying.
pub(super) fn lock(directory: &Path) -> Result<File, StoreError> {
    let path = directory.join(LOCK);
    let write_error = |source| StoreError::Write { path: path.clone(), source };
    let options = &mut OpenOptions::new();
    let file = options.read(true).write(true).create(true).truncate(false).open(&path).map_err(write_error)?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(StoreError::Locked(directory.to_owned())),
        Err(TryLockError::Error(source)) => Err(write_error(source)),
    }
}

/// Opens the database of an existing run for reading and writing; `None` if there is no run in it.
///
/// There is none in a file that is absent or empty, nor in one that a kill left during its very first transaction, which
/// held nothing but the scene.
pub(super) fn open_existing(path: &Path) -> Result<Option<Connection>, StoreError> {
    if !path.metadata().is_ok_and(|found| found.is_file() && found.len() > 0) || is_cut_off(path) {
        return Ok(None);
    }
    let read_error = |source| StoreError::ReadDatabase { path: path.to_owned(), source };
    let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let mut connection = Connection::open_with_flags(path, flags).map_err(read_error)?;
    super::wait::patiently(&mut connection).map_err(read_error)?;
    // The first look takes back what a killed process has left in the journal.
    let pages = connection.pragma_query_value(None, "page_count", |row| row.get::<_, i64>(0));
    match pages {
        Ok(0) => return Ok(None),
        Err(error) if error.sqlite_error_code() != Some(rusqlite::ErrorCode::NotADatabase) => {
            return Err(read_error(error));
        }
        // What is no database is told apart below.
        _ => {}
    }
    check_format(&connection, path)?;
    Ok(Some(connection))
}

/// Whether the file ends before the pages do that its first transaction announced.
fn is_cut_off(path: &Path) -> bool {
    let (head, length) = (head(path), path.metadata().map_or(0, |found| found.len()));
    if head.len() < 100 {
        return !head.is_empty() && MAGIC.starts_with(&head[..head.len().min(16)]);
    }
    let number = |at: usize| u32::from_be_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]);
    // Offsets of the SQLite file format: page size 16, change counter 24, pages 28, application id 68.
    let page_bytes = u64::from(u16::from_be_bytes([head[16], head[17]]));
    let first = number(24) <= 1 && i64::from(number(68)) == APPLICATION_ID;
    head.starts_with(MAGIC) && first && length < page_bytes * u64::from(number(28))
}

/// The first hundred bytes of a file: the header of a database.
fn head(path: &Path) -> Vec<u8> {
    let mut head = Vec::new();
    // A file that cannot be read has no head that is known.
    let _ = File::open(path).and_then(|file| file.take(100).read_to_end(&mut head));
    head
}

/// Whether the database is one of ours and of this build's format.
fn check_format(connection: &Connection, path: &Path) -> Result<(), StoreError> {
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

/// Makes the database of a run of `scene`: beside its place first, so that a kill leaves no run or a whole one.
pub(super) fn create(path: &Path, scene: &Scene) -> Result<(), StoreError> {
    let aside = path.with_extension("sqlite.partial");
    // What an earlier build or a kill has left. A journal without its database would be taken for that of the new one.
    remove_if(&aside, |head| {
        let id = head.get(68..72).map(|id| i64::from(u32::from_be_bytes([id[0], id[1], id[2], id[3]])));
        MAGIC.starts_with(&head[..head.len().min(16)]) && id.is_none_or(|id| id == APPLICATION_ID)
    })?;
    remove_if(&path.with_extension("sqlite-journal"), |head| {
        head.iter().all(|byte| *byte == 0) || head.starts_with(&JOURNAL_MAGIC)
    })?;
    let write_error = |source| StoreError::WriteDatabase { path: aside.clone(), source };
    let connection = Connection::open(&aside).map_err(write_error)?;
    let fill = || {
        // What is cut off is thrown away, so nothing has to be taken back.
        connection.execute_batch("PRAGMA journal_mode = OFF; PRAGMA synchronous = FULL; BEGIN IMMEDIATE;")?;
        connection.execute_batch(&format!(
            "PRAGMA application_id = {APPLICATION_ID}; PRAGMA user_version = {FORMAT_VERSION};\n{}",
            include_str!("schema.sql")
        ))?;
        connection.execute("INSERT INTO run VALUES ('version', ?1)", [env!("CARGO_PKG_VERSION")])?;
        connection.execute("INSERT INTO run VALUES ('scene', ?1)", [scene.to_json()])?;
        connection.execute_batch("COMMIT")
    };
    fill().map_err(write_error)?;
    connection.close().map_err(|(_, source)| write_error(source))?;
    std::fs::rename(&aside, path).map_err(|source| StoreError::Write { path: path.to_owned(), source })?;
    sync_folder(folder_of(path));
    Ok(())
}

/// Removes a file if its first bytes say that it is ours; `Ok` also if there is none.
fn remove_if(path: &Path, ours: impl Fn(&[u8]) -> bool) -> Result<(), StoreError> {
    match path.symlink_metadata() {
        Err(_) => Ok(()),
        Ok(found) if found.is_file() && ours(&head(path)) => {
            std::fs::remove_file(path).map_err(|source| StoreError::Write { path: path.to_owned(), source })
        }
        Ok(_) => Err(StoreError::ForeignFile(path.to_owned())),
    }
}

/// The copy of the scene in a run directory.
#[derive(Debug)]
pub(super) struct SceneCopy {
    path: PathBuf,
    found: Option<Vec<u8>>,
}

impl SceneCopy {
    /// What stands there now.
    pub(super) fn of(directory: &Path) -> Result<Self, StoreError> {
        let path = directory.join(SCENE);
        let found = match path.symlink_metadata() {
            Err(error) if error.kind() == ErrorKind::NotFound => None,
            Err(source) => return Err(StoreError::Write { path, source }),
            Ok(_) => {
                let mut bytes = Vec::new();
                let read = path.is_file()
                    && File::open(&path).and_then(|f| f.take(MAX_SCENE_BYTES + 1).read_to_end(&mut bytes)).is_ok();
                if !read {
                    return Err(StoreError::ForeignFile(path));
                }
                Some(bytes)
            }
        };
        Ok(Self { path, found })
    }

    /// Whether it has to be written, `stored` being the scene that the database holds until now.
    ///
    /// # Errors
    /// [`StoreError::ForeignFile`]: it is no copy of either scene, whole or cut off.
    pub(super) fn is_outdated(&self, scene: &Scene, stored: Option<&Scene>) -> Result<bool, StoreError> {
        let Some(found) = &self.found else { return Ok(true) };
        // The user's own words for the same scene stay.
        let read = std::str::from_utf8(found).ok().and_then(|text| Scene::parse(text, &self.path).ok());
        if read.as_ref() == Some(scene) {
            return Ok(false);
        }
        let torn = |scene: &Scene| is_torn(found, &scene.to_json());
        match (read.is_some() && read.as_ref() == stored) || torn(scene) || stored.is_some_and(torn) {
            true => Ok(true),
            false => Err(StoreError::ForeignFile(self.path.clone())),
        }
    }

    /// Writes `scene` in its place.
    pub(super) fn write(&self, scene: &Scene) -> Result<(), StoreError> {
        write_durably(&self.path, scene.to_json().as_bytes())
            .map_err(|error| StoreError::Write { path: self.path.clone(), source: error.source })
    }
}

/// Whether `found` is what a power failure or a full disk may leave of `whole`.
fn is_torn(found: &[u8], whole: &str) -> bool {
    let end = found.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
    whole.as_bytes().starts_with(&found[..end])
}

/// The scene of the run in `directory`, if `file` is its copy in there and is lost or cut off.
pub fn scene_of_torn_copy(file: &Path, directory: &Path) -> Option<Scene> {
    let same_folder = folder_of(file).canonicalize().ok()? == directory.canonicalize().ok()?;
    if !same_folder || file.file_name()? != SCENE {
        return None;
    }
    let stored = super::RunReader::open(directory).ok()?.scene().ok()?;
    let found = SceneCopy::of(directory).ok()?.found.unwrap_or_default();
    is_torn(&found, &stored.to_json()).then_some(stored)
}
