//! `yorp report DIR`: what a run looks like, as one page that opens from disk, and its figures as files.

use std::path::{Path, PathBuf};
use std::time::Duration;

use serde_json::{Value, json};

use super::{CliError, output, progress};
use crate::exchange::{WriteError, check_page, write_whole};
use crate::report::figures::{FigureError, Missing, Plot, SaveError, of_run, of_runs, save, svg};
use crate::report::page::{Extras, Picture, page, page_of_several};
use crate::report::{RunData, Watched, watch};
use crate::store::{Outcome, run_directory};

/// How often a watched run is looked at, and its page loaded again, s.
const LOOK_EVERY_S: u32 = 3;
/// The page in a report's folder.
const PAGE: &str = "index.html";
/// Where its figures stand below the folder.
const FIGURES: &str = "figures";

/// Arguments of `yorp report`.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The run directory; with several, a page and figures that put runs together
    #[arg(required = true, value_name = "DIR")]
    runs: Vec<PathBuf>,
    /// Where the report goes; needed with several runs [default: DIR/report]
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Write the page again whenever the run has got further, until it is at its end or Ctrl-C; the page reloads itself
    #[arg(long)]
    watch: bool,
}

/// Writes the report.
pub(super) fn run(arguments: &Arguments, as_json: bool) -> Result<(), CliError> {
    let runs: Vec<PathBuf> = arguments.runs.iter().map(|run| run_directory(run)).collect();
    let (folder, directory) = match (&arguments.out, &runs[..]) {
        (out, [run]) => (out.clone().unwrap_or_else(|| run.join("report")), run),
        (None, _) => return Err(CliError::refused("a report on several runs needs --out FOLDER")),
        (Some(_), _) if arguments.watch => return Err(CliError::refused("--watch is for one run")),
        (Some(out), runs) => return several(runs, out, as_json),
    };
    let run = RunData::read(directory)?;
    claim(&folder)?;
    let (run, written) = if arguments.watch && !is_over(&run) {
        match keep_up(directory, &folder)? {
            (run, written, Watched::Over) => (run, written),
            (_, _, Watched::Stopped) => {
                return Err(CliError::interrupted());
            }
        }
    } else {
        let written = write(&run, &folder, None)?;
        (run, written)
    };
    let figures = Figures::save(of_run(&run), &folder)?;
    let page = written.display();
    match as_json {
        true => output::json(&figures.as_value(Some(&written))),
        false => output::text(&format!("{page}\n{}", figures.as_text())),
    }
}

/// The page and figures of several runs together.
fn several(directories: &[PathBuf], folder: &Path, as_json: bool) -> Result<(), CliError> {
    let runs = directories.iter().map(|run| RunData::read(run)).collect::<Result<Vec<_>, _>>()?;
    claim(folder)?;
    let file = folder.join(PAGE);
    let text = page_of_several(&runs, &extras(of_runs(&runs), None).map_err(SaveError::from)?);
    write_whole(&file, text.as_bytes())?;
    let figures = Figures::save(of_runs(&runs), folder)?;
    match as_json {
        true => output::json(&figures.as_value(Some(&file))),
        false => output::text(&format!("{}\n{}", file.display(), figures.as_text())),
    }
}

/// Makes the folder, unless it holds a page or figures of somebody else.
fn claim(folder: &Path) -> Result<(), CliError> {
    check_page(&folder.join(PAGE), [folder.join(FIGURES)])?;
    create(folder)
}

fn create(folder: &Path) -> Result<(), CliError> {
    let failed = |source| CliError::write(WriteError { file: folder.to_owned(), source });
    std::fs::create_dir_all(folder).map_err(failed)
}

/// Figures as files, and those that are not there.
struct Figures {
    folder: PathBuf,
    drawn: Vec<([PathBuf; 3], Plot)>,
    left_out: Vec<Missing>,
}

impl Figures {
    /// Draws into `figures/` below `folder`; one that could be drawn by an earlier report and cannot now stays.
    fn save(plots: Vec<Result<Plot, Missing>>, folder: &Path) -> Result<Self, CliError> {
        let folder = folder.join(FIGURES);
        create(&folder)?;
        let (mut drawn, mut left_out) = (Vec::new(), Vec::new());
        for plot in plots {
            match plot {
                Ok(plot) => drawn.push((save(&plot, &folder)?, plot)),
                Err(missing) => left_out.push(missing),
            }
        }
        Ok(Self { folder, drawn, left_out })
    }

    fn as_value(&self, page: Option<&Path>) -> Value {
        let figure = |([svg, png, csv], plot): &([PathBuf; 3], Plot)| json!({"name": plot.name, "title": plot.title, "caption": plot.caption, "svg": svg, "png": png, "csv": csv});
        let left_out = |m: &Missing| json!({"name": m.name, "title": m.title, "reason": m.reason});
        json!({
            "page": page,
            "figures": self.drawn.iter().map(figure).collect::<Vec<_>>(),
            "left_out": self.left_out.iter().map(left_out).collect::<Vec<_>>(),
        })
    }

    fn as_text(&self) -> String {
        let mut lines: Vec<String> = Vec::new();
        lines.extend(self.left_out.iter().map(|m| format!("no figure \"{}\": {}", m.title, m.reason)));
        lines.push(format!("{} figures as SVG, PNG and CSV in {}", self.drawn.len(), self.folder.display()));
        lines.join("\n") + "\n"
    }
}

/// What stands in the page besides the run: its figures.
fn extras(plots: Vec<Result<Plot, Missing>>, fresh_every_s: Option<u32>) -> Result<Extras, FigureError> {
    let mut extras = Extras { fresh_every_s, ..Extras::default() };
    for plot in plots {
        match plot {
            Ok(plot) => {
                let (name, wide, svg) = (plot.name, plot.rows.iter().any(|row| row.len() > 1), svg(&plot)?);
                extras.pictures.push(Picture { name, wide, svg, title: plot.title, caption: plot.caption });
            }
            Err(missing) => extras.left_out.push((missing.title.into(), missing.reason)),
        }
    }
    Ok(extras)
}

/// Whether nothing will follow, unless a longer run is asked for.
fn is_over(run: &RunData) -> bool {
    run.ending.is_some_and(|ending| ending.outcome != Outcome::Until)
}

/// Writes the report of a run that goes on, again and again; in the end one that no longer reloads itself.
fn keep_up(directory: &Path, folder: &Path) -> Result<(RunData, PathBuf, Watched), CliError> {
    progress::catch_interrupt(progress::Leaves::Page)?;
    let again = || {
        let run = RunData::read(directory)?;
        let over = is_over(&run);
        // A page of many shapes takes its reader a while to open.
        let fresh_every_s = LOOK_EVERY_S + (run.configurations.len() / 25) as u32;
        let written = write(&run, folder, (!over).then_some(fresh_every_s))?;
        eprintln!("{}: {}", written.display(), standing(&run));
        Ok::<_, CliError>(over)
    };
    let every = Duration::from_secs(LOOK_EVERY_S.into());
    let watched = watch(directory, every, progress::is_interrupted, again)?;
    let run = RunData::read(directory)?;
    let written = write(&run, folder, None)?;
    Ok((run, written, watched))
}

/// Where a run stands, on a line of progress.
fn standing(run: &RunData) -> String {
    let state = run.state.as_ref();
    let t_myr = state.map_or(0.0, |s| s.t_s / crate::evolve::driver::MYR_S);
    format!("{t_myr:.4} Myr, {} legs, {} configurations", run.legs.len(), run.configurations.len())
}

/// Writes the page, whole or not at all.
fn write(run: &RunData, folder: &Path, fresh_every_s: Option<u32>) -> Result<PathBuf, CliError> {
    let file = folder.join(PAGE);
    let text = page(run, &extras(of_run(run), fresh_every_s).map_err(SaveError::from)?);
    write_whole(&file, text.as_bytes())?;
    Ok(file)
}
