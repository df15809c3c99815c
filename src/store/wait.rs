//! How long a run waits for somebody who holds its database, and when it says so.

use std::time::Duration;

use rusqlite::Connection;

/// Between two tries.
const PAUSE: Duration = Duration::from_millis(100);
/// Tries until the user is told.
const TOLD_AFTER: i32 = 20;
/// Tries in all, ten minutes: a report of a large run is no reason to end it.
const MOST: i32 = 6000;

/// Makes every statement of `connection` wait.
pub(super) fn patiently(connection: &mut Connection) -> rusqlite::Result<()> {
    connection.busy_handler(Some(wait))
}

fn wait(tries: i32) -> bool {
    if tries == TOLD_AFTER {
        // SQLite hands no context to this function, and what is waited for is told while waiting.
        eprintln!(
            "warning: another process holds the database of the run (run.sqlite); waiting for it, at most ten minutes"
        );
    }
    std::thread::sleep(PAUSE);
    tries < MOST
}
