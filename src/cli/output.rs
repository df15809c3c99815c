//! Results on stdout: one write at the end, a closed pipe is no failure.

use std::io::Write as _;

use super::CliError;

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
