//! `yorp accuracy [PART]`: error against run time of each numerical knob.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::{CliError, output};
use crate::accuracy::{self, Accuracy, Effort};
use crate::exchange::{WriteError, check_page, write_whole};

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
        let [page, others @ ..] = FILES.map(|name| folder.join(name));
        check_page(&page, others)?;
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

/// What is written, the page first.
const FILES: [&str; 4] = ["accuracy.html", "accuracy.json", "accuracy.svg", "accuracy.png"];

/// Writes the page, the numbers and the figure.
fn save(measured: &Accuracy, folder: &Path) -> Result<(), CliError> {
    let [page, numbers, svg, png] = FILES.map(|name| folder.join(name));
    let figure = accuracy::svg(&measured.knobs).map_err(CliError::write)?;
    // The page first: by it a later measurement knows that the others are ours.
    write_whole(&page, accuracy::page(measured, &figure).as_bytes())?;
    let text = serde_json::to_string_pretty(measured).expect("plain data with string keys");
    write_whole(&numbers, text.as_bytes())?;
    write_whole(&svg, figure.as_bytes())?;
    accuracy::save_png(&measured.knobs, &png).map_err(CliError::write)
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
