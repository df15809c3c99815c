//! `yorp accuracy [PART]`: error against run time of each numerical knob.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::{CliError, output};
use crate::accuracy::{self, Accuracy, Effort};
use crate::exchange::WriteError;

/// Arguments of `yorp accuracy`.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// Only this knob, or the knobs of this module
    part: Option<String>,
    /// Small bodies and few points: seconds instead of minutes
    #[arg(long)]
    quick: bool,
    /// Also write accuracy.json, a figure (SVG and PNG) and a page (HTML) into this directory
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Measures and prints.
pub(super) fn run(arguments: &Arguments, json: bool) -> Result<(), CliError> {
    let knobs = accuracy::select(arguments.part.as_deref()).map_err(CliError::input)?;
    if let Some(folder) = &arguments.out {
        // Before the minutes of measuring, not after them.
        std::fs::create_dir_all(folder)
            .map_err(|source| CliError::write(WriteError { file: folder.clone(), source }))?;
    }
    let effort = if arguments.quick { Effort::Quick } else { Effort::Full };
    let measured = accuracy::measure(&knobs, effort, &mut |line| eprintln!("{line}")).map_err(CliError::numerical)?;
    if let Some(folder) = &arguments.out {
        save(&measured, folder)?;
    }
    if json { output::json(&measured) } else { output::text(&table(&measured)) }
}

/// Writes the numbers, the figure and the page.
fn save(measured: &Accuracy, folder: &Path) -> Result<(), CliError> {
    let failed = |file: PathBuf| move |source| CliError::write(WriteError { file, source });
    let write = |name: &str, text: &str| {
        let file = folder.join(name);
        std::fs::write(&file, text).map_err(failed(file))
    };
    let figure = accuracy::svg(&measured.knobs).map_err(CliError::write)?;
    write("accuracy.json", &serde_json::to_string_pretty(measured).expect("plain data with string keys"))?;
    write("accuracy.svg", &figure)?;
    write("accuracy.html", &accuracy::page(measured, &figure))?;
    accuracy::save_png(&measured.knobs, &folder.join("accuracy.png")).map_err(CliError::write)
}

fn table(measured: &Accuracy) -> String {
    let mut text = String::new();
    for curve in &measured.knobs {
        let about = &curve.about;
        let _ = writeln!(text, "{} ({})\n  error: {}", about.name, about.scene_key, about.error_is);
        let _ = writeln!(text, "  {:>10}  {:>9}  {:>9}  {:>9}", about.unit, "error", "spread", "CPU s");
        for point in &curve.points {
            let spread = point.spread.map_or_else(|| "-".to_owned(), |s| format!("{s:.1e}"));
            let mark = if point.value == about.default { "  default" } else { "" };
            let _ = writeln!(
                text,
                "  {:>10}  {:>9.2e}  {spread:>9}  {:>9}{mark}",
                accuracy::number(point.value),
                point.error,
                accuracy::seconds(point.seconds)
            );
        }
    }
    text
}
