//! Results on stdout, one write at the end where a closed pipe is no failure; and names of files to be written.

use std::io::Write as _;
use std::path::Path;

use super::CliError;
use crate::exchange::check_output;

/// Writes `text` to stdout.
pub(super) fn text(text: &str) -> Result<(), CliError> {
    let mut stdout = std::io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        // The reader (`head`, a pager) has what it wanted.
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        other => other.map_err(CliError::write),
    }
}

/// Writes `value` to stdout as one JSON object; a number that is not finite becomes null.
pub(super) fn json(value: &impl serde::Serialize) -> Result<(), CliError> {
    let mut line = serde_json::to_string(value).expect("results are plain data with string keys");
    line.push('\n');
    text(&line)
}

/// Refuses to write `file` over an input of the command, or where it cannot go: before the work, not after it.
pub(super) fn check(file: &Path, inputs: &[impl AsRef<Path>]) -> Result<(), CliError> {
    let inputs: Vec<&Path> = inputs.iter().map(AsRef::as_ref).collect();
    Ok(check_output(file, &inputs)?)
}
