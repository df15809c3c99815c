//! The random walk: how fast each interval changes spin and obliquity, negative where it turns back, against its length.
//!
//! After Figure 17 of Cotto-Figueroa et al. (2015), ApJ 803, 25; several runs are drawn together.

use super::palette::BLACK;
use super::plot::{Axis, Kind, Layer, Missing, Panel, Plot};
use super::series::{RunStyle, legend, too_short};
use crate::classify::{Interval, Walk, closed_intervals, segments};
use crate::report::RunData;

const NAME: &str = "walk";
const TITLE: &str = "Random walk";

/// The figure of one or several runs.
///
/// # Errors
/// Too few intervals have been closed by movements.
pub fn plot(runs: &[RunData]) -> Result<Plot, Missing> {
    let walks: Vec<Walk> = runs.iter().map(|run| Walk::of(&closed_intervals(run, &segments(run)))).collect();
    let panel = |label: &str, of: fn(&Interval) -> Option<f64>| {
        let point = |i: &Interval| of(i).map(|rate| [i.length_myr.log10(), rate]);
        let points: Vec<Vec<[f64; 2]>> = walks.iter().map(|w| w.intervals.iter().filter_map(point).collect()).collect();
        let all = || points.iter().flatten();
        let (x, y) = (
            Axis::around("log₁₀ of the interval's length (Myr)", all().map(|p| p[0])),
            Axis::around(label, all().map(|p| p[1]).chain([0.0])),
        );
        let mut layers = vec![Layer::line(vec![[x.range[0], 0.0], [x.range[1], 0.0]], 1.0, BLACK)];
        for (index, (run, points)) in runs.iter().zip(points).enumerate() {
            let style = if runs.len() > 1 { RunStyle::of(index, run) } else { RunStyle::alone() };
            layers.push(Layer::marks(points, style.mark, 3.5, style.colour));
        }
        Panel { x, y, layers }
    };
    if let Some(reason) = too_short(runs) {
        return Err(Missing::new(NAME, TITLE, reason));
    }
    let drawn: Vec<_> = runs
        .iter()
        .enumerate()
        .map(|(index, run)| (run, RunStyle::of(index, run)))
        .map(|(run, style)| (run, Kind::Marks(style.mark, 4.0), style.colour))
        .collect();
    let rows = vec![vec![panel("αₛ (rev/day per Myr)", |i| i.alpha_s)], vec![panel("ζₛ (deg per Myr)", |i| i.zeta_s)]];
    Ok(Plot {
        name: NAME,
        title: TITLE.into(),
        caption:
            "Rate of change of spin (above) and obliquity (below) over each interval between two movements; negative \
                  where the interval goes against the one before it."
                .into(),
        rows,
        panel_height: 260.0,
        legend: legend(&drawn, runs.len()),
        colour_bar: None,
    })
}
