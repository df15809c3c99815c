//! Why a run directory cannot be opened, read or written.

use std::path::PathBuf;

/// Failure of the run store.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// The directory holds a run and resuming was not asked for.
    #[error("{} already holds a run; continue it with --resume or choose another directory", .0.display())]
    HoldsRun(PathBuf),
    /// The directory holds no run.
    #[error("{} holds no run: there is no run.sqlite with one in it", .0.display())]
    NoRun(PathBuf),
    /// Another process works in the directory.
    #[error("{} is in use by another yorp process", .0.display())]
    Locked(PathBuf),
    /// The path exists and is no directory.
    #[error("{} is not a directory", .0.display())]
    NotADirectory(PathBuf),
    /// A file of somebody else has the place of one of the run's.
    #[error(
        "{} is not a file of this run and would be lost; move it away, or choose another directory", .0.display()
    )]
    ForeignFile(PathBuf),
    /// The file is not a database of this program.
    #[error("{} is not a yorp run database ({found})", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// What was found instead.
        found: String,
    },
    /// The database was written by another version of the format.
    #[error("{} has run format {found}; this build reads format {expected}", path.display())]
    Version {
        /// The file.
        path: PathBuf,
        /// `user_version` found.
        found: i64,
        /// `user_version` of this build.
        expected: i64,
    },
    /// The directory holds a run of another scene.
    #[error("{} holds a run of another scene: {difference}", directory.display())]
    SceneDiffers {
        /// The run directory.
        directory: PathBuf,
        /// First path that differs, with both values.
        difference: String,
    },
    /// A stored value that no build of this program can have written.
    #[error("{} is damaged: {what}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What was wrong.
        what: String,
    },
    /// The operating system refused to write.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file or directory.
        path: PathBuf,
        /// Cause.
        source: std::io::Error,
    },
    /// SQLite could not write (disk full, read-only file system).
    #[error("cannot write {}: {source}", path.display())]
    WriteDatabase {
        /// The file.
        path: PathBuf,
        /// Cause.
        source: rusqlite::Error,
    },
    /// SQLite could not read.
    #[error("cannot read {}: {source}", path.display())]
    ReadDatabase {
        /// The file.
        path: PathBuf,
        /// Cause.
        source: rusqlite::Error,
    },
}

impl StoreError {
    /// Whether the cause is a failed write (exit code 4) rather than a wrong input (exit code 2).
    pub fn is_write_failure(&self) -> bool {
        matches!(self, Self::Write { .. } | Self::WriteDatabase { .. })
    }
}
