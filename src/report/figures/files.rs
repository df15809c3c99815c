//! Figures as files: SVG for papers and pages, PNG for everything else.

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

/// Writes the figure into an existing folder as SVG and as PNG; the two files.
///
/// # Errors
/// It cannot be drawn or written; files that were there before are unchanged then.
pub fn save(plot: &Plot, folder: &Path) -> Result<[PathBuf; 2], SaveError> {
    let files = ["svg", "png"].map(|ending| folder.join(plot.name).with_extension(ending));
    write_whole(&files[0], svg(plot)?.as_bytes())?;
    write_png(plot, &files[1])?;
    Ok(files)
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
