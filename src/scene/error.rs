//! Why a scene was refused: always with file, line, column, the path inside, what was found and what is allowed.

use std::path::PathBuf;
use std::sync::Arc;

/// A place in a scene file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Location {
    /// The file, as the caller named it.
    pub file: PathBuf,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// The same place as a byte offset into `text`.
    pub offset: usize,
    /// The whole text of the file, for showing the line.
    pub text: Arc<str>,
}

impl std::fmt::Display for Location {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}:{}:{}", self.file.display(), self.line, self.column)
    }
}

/// Why a scene was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The file cannot be read.
    #[error("{}: cannot read the scene", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// The file is larger than any scene.
    #[error("{}: larger than {limit} bytes, which no scene is", file.display())]
    TooLarge {
        /// The file.
        file: PathBuf,
        /// Largest size, bytes.
        limit: u64,
    },
    /// The file is not UTF-8.
    #[error("{}: not UTF-8 text from byte {valid_up_to} on; save it as UTF-8", file.display())]
    NotText {
        /// The file.
        file: PathBuf,
        /// Bytes before the first that is not.
        valid_up_to: usize,
    },
    /// Not JSON.
    #[error("{at}: broken JSON{}: {message}", if matches!(path.as_str(), "." | "?") { String::new() } else { format!(" at `{path}`") })]
    Syntax {
        /// Where.
        at: Box<Location>,
        /// Path of the innermost key that was reached.
        path: String,
        /// What the parser said.
        message: String,
    },
    /// JSON, but not a scene: an unknown or missing key, a wrong type.
    #[error("{at}: `{path}`: {message}")]
    Structure {
        /// Where.
        at: Box<Location>,
        /// Path of the key.
        path: String,
        /// What was found, and what is allowed.
        message: String,
    },
    /// None of the alternatives that there are.
    #[error("{at}: `{path}` takes {takes}, found {found}")]
    Alternative {
        /// Where.
        at: Box<Location>,
        /// Path of the key.
        path: String,
        /// What may stand there.
        takes: String,
        /// What stands there.
        found: String,
    },
    /// A value that is not allowed.
    #[error("{at}: `{path}` is {found}; allowed: {allowed}")]
    Value {
        /// Where.
        at: Box<Location>,
        /// Path of the key.
        path: String,
        /// The value found.
        found: String,
        /// What is allowed.
        allowed: String,
    },
    /// A file named by the scene cannot be read.
    #[error(
        "{at}: `{path}` is {found}, which is no readable file; allowed: a path relative to the folder of the scene"
    )]
    Missing {
        /// Where.
        at: Box<Location>,
        /// Path of the key.
        path: String,
        /// The value found.
        found: String,
        /// What the operating system said.
        source: std::io::Error,
    },
}

impl SceneError {
    /// The place in the file, where there is one.
    pub fn location(&self) -> Option<&Location> {
        match self {
            Self::Syntax { at, .. }
            | Self::Structure { at, .. }
            | Self::Alternative { at, .. }
            | Self::Value { at, .. }
            | Self::Missing { at, .. } => Some(at),
            Self::Read { .. } | Self::TooLarge { .. } | Self::NotText { .. } => None,
        }
    }
}
