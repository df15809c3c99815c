//! Figures as files: SVG for papers and pages, PNG for everything else, and the points that are drawn as CSV.

use std::path::{Path, PathBuf};

use plotters::prelude::{BitMapBackend, DrawingBackend};

use super::canvas::FigureError;
use super::plot::Plot;
use super::render::{image, svg};
use crate::exchange::{WriteError, write_whole};

/// A figure that is not in its file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SaveError {
    /// It could not be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// Its file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// Endings of the files of a figure.
pub const ENDINGS: [&str; 3] = ["svg", "png", "csv"];

/// Writes the figure into an existing folder as SVG and as PNG, and what it draws as CSV; the three files.
///
/// # Errors
/// It cannot be drawn or written; files that were there before are unchanged then.
pub fn save(plot: &Plot, folder: &Path) -> Result<[PathBuf; 3], SaveError> {
    let files = ENDINGS.map(|ending| folder.join(plot.name).with_extension(ending));
    write_whole(&files[0], svg(plot)?.as_bytes())?;
    write_png(plot, &files[1])?;
    write_whole(&files[2], points(plot).as_bytes())?;
    Ok(files)
}

/// All points, with the quantities of their axes and the number of what they belong to: a curve, or a set of marks.
fn points(plot: &Plot) -> String {
    let quoted = |words: &str| format!("\"{}\"", words.replace('"', "\"\""));
    let mut text = String::from("panel,x_quantity,y_quantity,series,x,y\n");
    for (number, panel) in plot.rows.iter().flatten().enumerate() {
        let [x, y] = [&panel.x, &panel.y].map(|axis| quoted(&axis.label));
        for (series, layer) in panel.layers.iter().enumerate() {
            for [a, b] in &layer.points {
                text.push_str(&format!("{number},{x},{y},{series},{a},{b}\n"));
            }
        }
    }
    text
}

fn write_png(plot: &Plot, file: &Path) -> Result<(), SaveError> {
    let (width, height, pixels) = image(plot)?;
    let partial = file.with_extension("partial.png");
    let written = (|| {
        let mut page = BitMapBackend::new(&partial, (width, height));
        page.blit_bitmap((0, 0), (width, height), &pixels).map_err(std::io::Error::other)?;
        page.present().map_err(std::io::Error::other)?;
        // It has been presented, so that dropping it writes nothing more.
        drop(page);
        std::fs::rename(&partial, file)
    })();
    written.map_err(|source| {
        // The first failure is the one to report.
        let _ = std::fs::remove_file(&partial);
        WriteError { file: file.to_owned(), source }.into()
    })
}
