//! Doing something again whenever a run has got further.

use std::path::Path;
use std::time::{Duration, Instant, SystemTime};

/// How soon a stop is noticed.
const TICK: Duration = Duration::from_millis(100);

/// Size and time of the last change of the run's database: what every transaction changes.
fn stamp(directory: &Path) -> Option<(SystemTime, u64)> {
    let metadata = directory.join("run.sqlite").metadata().ok()?;
    Some((metadata.modified().ok()?, metadata.len()))
}

/// Why watching ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Watched {
    /// The run is over.
    Over,
    /// It was asked to stop.
    Stopped,
}

/// Calls `write` once, and again after each transaction of the run in `directory`, looking every `every`; until `write`
/// says that the run is over, or `stop` is true.
///
/// After a `write` that took long it waits nine times as long, so that it takes at most a tenth of a processor.
///
/// # Errors
/// Those of `write`.
pub fn watch<E>(
    directory: &Path,
    every: Duration,
    stop: impl Fn() -> bool,
    mut write: impl FnMut() -> Result<bool, E>,
) -> Result<Watched, E> {
    loop {
        // Taken before reading: what is written meanwhile is read the next time.
        let seen = stamp(directory);
        let start = Instant::now();
        if write()? {
            return Ok(Watched::Over);
        }
        let earliest = Instant::now() + every.max(9 * start.elapsed());
        while Instant::now() < earliest || stamp(directory) == seen {
            if stop() {
                return Ok(Watched::Stopped);
            }
            std::thread::sleep(TICK.min(every));
        }
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    const SOON: Duration = Duration::from_millis(1);

    #[test]
    fn each_change_is_written_once_until_the_end() {
        let folder = tempfile::tempdir().unwrap();
        let database = folder.path().join("run.sqlite");
        std::fs::write(&database, "").unwrap();
        let (written, looked) = (Cell::new(0), Cell::new(0));
        let stop = || {
            // Nothing changes for some time, then it does.
            looked.set(looked.get() + 1);
            if looked.get() % 20 == 0 {
                std::fs::write(&database, "x".repeat(looked.get())).unwrap();
            }
            false
        };
        let write = || {
            written.set(written.get() + 1);
            Ok::<_, ()>(written.get() == 3)
        };
        assert_eq!(watch(folder.path(), SOON, stop, write), Ok(Watched::Over));
        assert!(looked.get() >= 40 && written.get() == 3, "{looked:?} {written:?}");
    }

    #[test]
    fn it_stops_when_asked_and_hands_errors_on() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(watch(folder.path(), SOON, || true, || Ok::<_, ()>(false)), Ok(Watched::Stopped));
        assert_eq!(watch(folder.path(), SOON, || false, || Err("x")), Err("x"));
    }
}
