//! How deep the movements go: their cumulative distribution over the mass enclosed by surfaces of equal potential.
//!
//! After Figure 11 of Cotto-Figueroa et al. (2015), ApJ 803, 25; several runs are drawn together.

use super::palette::GREY;
use super::plot::{Axis, Kind, Layer, LegendEntry, Missing, Panel, Plot};
use super::series::{RunStyle, legend, too_short};
use crate::report::RunData;

const NAME: &str = "movements";
const TITLE: &str = "Movements against depth";

/// The figure of one or several runs.
///
/// # Errors
/// Too few intervals have been closed by movements.
pub fn plot(runs: &[RunData]) -> Result<Plot, Missing> {
    let depths = |run: &RunData| {
        let mut depths: Vec<f64> = run.movements.iter().flatten().map(|m| m.enclosed_mass_fraction).collect();
        depths.retain(|d| d.is_finite());
        depths.sort_by(f64::total_cmp);
        depths
    };
    let mut layers = vec![Layer { points: vec![[0.0, 0.0], [1.0, 1.0]], kind: Kind::Dashed(1.2), colour: GREY }];
    let mut drawn = Vec::new();
    for (index, run) in runs.iter().enumerate() {
        let depths = depths(run);
        if depths.is_empty() {
            continue;
        }
        let style = if runs.len() > 1 { RunStyle::of(index, run) } else { RunStyle::alone() };
        layers.push(Layer { points: cumulative(&depths), kind: style.line(2.0), colour: style.colour });
        if runs.len() > 1 {
            // A mark at every tenth, each run's a little further along than the one before.
            let share = |k: usize| (k as f64 + (index as f64 + 0.5) / runs.len() as f64) / 10.0;
            let at = |share: f64| [depths[(share * depths.len() as f64) as usize], share];
            layers.push(Layer::marks((0..10).map(share).map(at).collect(), style.mark, 4.0, style.colour));
        }
        drawn.push((run, Kind::Marks(style.mark, 4.0), style.colour));
    }
    if let Some(reason) = too_short(runs) {
        return Err(Missing::new(NAME, TITLE, reason));
    }
    let even = LegendEntry { label: "equally mobile".into(), kind: Kind::Dashed(1.2), colour: GREY };
    let count: usize = runs.iter().flat_map(|run| &run.movements).map(Vec::len).sum();
    let shed = if runs.len() > 1 { " Dashed: bodies that lost no mass." } else { "" };
    Ok(Plot {
        name: NAME,
        title: TITLE.into(),
        caption: format!(
            "Share of the {count} movements of single spheres that happened within the surface of equal effective potential \
             that encloses this share of the mass: 0 is the deepest place, 1 the surface.{shed}"
        ),
        rows: vec![vec![Panel {
            x: Axis::between("Enclosed mass fraction", 0.0, 1.0),
            y: Axis::between("Cumulative share of movements", 0.0, 1.0),
            layers,
        }]],
        panel_height: 400.0,
        legend: std::iter::once(even).chain(legend(&drawn, runs.len())).collect(),
        colour_bar: None,
    })
}

/// Steps of the cumulative distribution of sorted values between 0 and 1.
fn cumulative(sorted: &[f64]) -> Vec<[f64; 2]> {
    let total = sorted.len() as f64;
    let mut points = vec![[0.0, 0.0]];
    for (below, value) in sorted.iter().enumerate() {
        points.push([*value, below as f64 / total]);
        points.push([*value, (below + 1) as f64 / total]);
    }
    points.push([1.0, 1.0]);
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distribution_steps_at_each_value_from_none_to_all() {
        let points = cumulative(&[0.25, 0.5]);
        assert_eq!(points, [[0.0, 0.0], [0.25, 0.0], [0.25, 0.5], [0.5, 0.5], [0.5, 1.0], [1.0, 1.0]]);
    }
}
