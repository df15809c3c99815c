//! Aggregate files: read with a limit on their size.

use std::io::Read as _;
use std::path::{Path, PathBuf};

use pkd::Spheres;

use super::csv::{CsvFault, parse_aggregate};

/// Largest aggregate file, bytes: a million spheres with all digits of all columns.
pub const MAX_AGGREGATE_BYTES: u64 = 1 << 28;

/// Why an aggregate file was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AggregateFileError {
    /// The file cannot be read.
    #[error("{}: cannot read the aggregate", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// The file is larger than any aggregate that can be worked with.
    #[error("{}: larger than {MAX_AGGREGATE_BYTES} bytes", file.display())]
    TooLarge {
        /// The file.
        file: PathBuf,
    },
    /// The file is no aggregate.
    #[error("{}: no aggregate", file.display())]
    Csv {
        /// The file.
        file: PathBuf,
        /// What is wrong, with line and column.
        source: CsvFault,
    },
}

/// The aggregate in a CSV file; see [`super::csv`] for its columns.
///
/// # Errors
/// [`AggregateFileError`], naming the line and column that is not understood.
pub fn read_aggregate(file: &Path) -> Result<Spheres, AggregateFileError> {
    let unreadable = |source| AggregateFileError::Read { file: file.to_owned(), source };
    let mut bytes = Vec::new();
    let open = std::fs::File::open(file).map_err(unreadable)?;
    open.take(MAX_AGGREGATE_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > MAX_AGGREGATE_BYTES {
        return Err(AggregateFileError::TooLarge { file: file.to_owned() });
    }
    parse_aggregate(&bytes).map_err(|source| AggregateFileError::Csv { file: file.to_owned(), source })
}
