//! `yorp report DIR`: what a run looks like, as one page that opens from disk.

use std::path::{Path, PathBuf};
use std::time::Duration;

use serde_json::json;

use super::{CliError, Failure, output, progress};
use crate::exchange::{WriteError, write_whole};
use crate::report::page::{Extras, page};
use crate::report::{RunData, Watched, watch};
use crate::store::Outcome;

/// How often a watched run is looked at, and its page loaded again, s.
const LOOK_EVERY_S: u32 = 3;

/// Arguments of `yorp report`.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The run directory
    run: PathBuf,
    /// Where the report goes [default: DIR/report]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write the report again whenever the run has got further, until it is at its end or Ctrl-C; the page reloads itself
    #[arg(long)]
    watch: bool,
}

/// Writes the report.
pub(super) fn run(arguments: &Arguments, as_json: bool) -> Result<(), CliError> {
    let folder = arguments.out.clone().unwrap_or_else(|| arguments.run.join("report"));
    let run = RunData::read(&arguments.run)?;
    let failed = |source| CliError::write(WriteError { file: folder.clone(), source });
    std::fs::create_dir_all(&folder).map_err(failed)?;
    let written = if arguments.watch && !is_over(&run) {
        match keep_up(&arguments.run, &folder)? {
            (written, Watched::Over) => written,
            (_, Watched::Stopped) => {
                return Err(CliError { code: Failure::Interrupted, report: miette::Report::msg("interrupted") });
            }
        }
    } else {
        write(&run, &folder, None)?
    };
    if as_json { output::json(&json!({"page": written})) } else { output::text(&format!("{}\n", written.display())) }
}

/// Whether nothing will follow, unless a longer run is asked for.
fn is_over(run: &RunData) -> bool {
    run.ending.is_some_and(|ending| ending.outcome != Outcome::Until)
}

/// Writes the report of a run that goes on, again and again; in the end one that no longer reloads itself.
fn keep_up(directory: &Path, folder: &Path) -> Result<(PathBuf, Watched), CliError> {
    progress::catch_interrupt()?;
    let again = || {
        let run = RunData::read(directory)?;
        let over = is_over(&run);
        let written = write(&run, folder, (!over).then_some(LOOK_EVERY_S))?;
        eprintln!("{}: {}", written.display(), standing(&run));
        Ok::<_, CliError>(over)
    };
    let every = Duration::from_secs(LOOK_EVERY_S.into());
    let watched = watch(directory, every, progress::is_interrupted, again)?;
    Ok((write(&RunData::read(directory)?, folder, None)?, watched))
}

/// Where a run stands, on a line of progress.
fn standing(run: &RunData) -> String {
    let state = run.state.as_ref();
    let t_myr = state.map_or(0.0, |s| s.t_s / crate::evolve::driver::MYR_S);
    format!("{t_myr:.4} Myr, {} legs, {} configurations", run.legs.len(), run.configurations.len())
}

/// Writes the page, whole or not at all.
fn write(run: &RunData, folder: &Path, fresh_every_s: Option<u32>) -> Result<PathBuf, CliError> {
    let file = folder.join("index.html");
    let text = page(run, &Extras { fresh_every_s, ..Extras::default() });
    write_whole(&file, text.as_bytes())?;
    Ok(file)
}
