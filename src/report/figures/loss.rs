//! Mass-loss events: how much left, at which rotation period.
//!
//! After Figure 12 of Cotto-Figueroa et al. (2015), ApJ 803, 25; several runs are drawn together.

use super::palette::GREY;
use super::plot::{Axis, Kind, Layer, LegendEntry, Mark, Missing, Panel, Plot};
use super::series::{RunStyle, legend};
use crate::classify::{JacobiSequence, LossEvent, Losses};
use crate::report::RunData;

const NAME: &str = "losses";
const TITLE: &str = "Mass loss";

/// The figure of one or several runs.
///
/// # Errors
/// No body has lost mass since its run began.
pub fn plot(runs: &[RunData]) -> Result<Plot, Missing> {
    let jacobi = JacobiSequence::new();
    let events: Vec<Vec<LossEvent>> = runs.iter().map(|run| Losses::of(run, &jacobi).events).collect();
    let point = |e: &LossEvent| [24.0 / e.spin_rev_day, e.mass_percent];
    let points: Vec<[f64; 2]> = events.iter().flatten().map(point).collect();
    if points.is_empty() {
        return Err(Missing::new(NAME, TITLE, "no mass has been lost since the run began"));
    }
    let (mut layers, mut drawn) = (Vec::new(), Vec::new());
    for (index, (run, events)) in runs.iter().zip(&events).enumerate() {
        if events.is_empty() {
            continue;
        }
        let style = if runs.len() > 1 { RunStyle::of(index, run) } else { RunStyle::alone() };
        layers.push(Layer::marks(events.iter().map(point).collect(), style.mark, 5.0, style.colour));
        drawn.push((run, Kind::Marks(style.mark, 5.0), style.colour));
    }
    let breakups: Vec<_> = events.iter().flatten().filter(|e| e.breakup).map(point).collect();
    let mut entries = legend(&drawn, runs.len());
    if !breakups.is_empty() {
        layers.push(Layer::marks(breakups, Mark::OpenSquare, 8.0, GREY));
        let kind = Kind::Marks(Mark::OpenSquare, 6.0);
        entries.push(LegendEntry { label: "the body broke up".into(), kind, colour: GREY });
    }
    Ok(Plot {
        name: NAME,
        title: TITLE.into(),
        caption: format!(
            "Mass that left the body in each of {} events, over its initial mass, against the rotation period at that time.",
            points.len()
        ),
        rows: vec![vec![Panel {
            x: Axis::around("Rotation period (h)", points.iter().map(|p| p[0])),
            y: Axis::logarithmic("Mass lost (% of the initial body)", points.iter().map(|p| p[1])),
            layers,
        }]],
        panel_height: 380.0,
        legend: entries,
        colour_bar: None,
    })
}
