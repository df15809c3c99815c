//! The figures of a run, or of several together: each a file that turns run data into a [`Plot`], drawn as SVG or PNG.
//!
//! Publication look: axes with units, colours safe for colour-blind readers, nothing drawn over the data. A figure that has
//! nothing to show says why instead.

mod canvas;
mod cost;
mod course;
mod error;
mod files;
mod loss;
mod movement;
mod palette;
mod plot;
mod render;
mod series;
mod shape;
mod spin;
mod ticks;
mod together;
mod torque;
mod walk;

pub use canvas::FigureError;
pub use files::{ENDINGS, SaveError, save};
pub use palette::{Colour, distinct, sequential};
pub use plot::{Axis, ColourBar, Kind, Layer, LegendEntry, Mark, Missing, Panel, Plot, Scale};
pub use render::svg;

use super::RunData;

/// All figures of one run in the order of a report; those without data are reasons.
pub fn of_run(run: &RunData) -> Vec<Result<Plot, Missing>> {
    let alone = std::slice::from_ref(run);
    vec![
        spin::plot(run),
        torque::plot(run),
        shape::plot(alone),
        movement::plot(alone),
        loss::plot(alone),
        walk::plot(alone),
        error::plot(run),
        cost::plot(run),
    ]
}

/// The figures that put several runs together, as the paper does.
pub fn of_runs(runs: &[RunData]) -> Vec<Result<Plot, Missing>> {
    vec![together::plot(runs), shape::plot(runs), movement::plot(runs), loss::plot(runs), walk::plot(runs)]
}
