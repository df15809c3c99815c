//! Where the shape goes: triaxiality against c/a, with the Jacobi ellipsoids.
//!
//! After Figure 16 of Cotto-Figueroa et al. (2015), ApJ 803, 25; axes by the half extents. Several runs are drawn together.

use super::palette::{BLACK, GREY};
use super::plot::{Axis, Kind, Layer, LegendEntry, Mark, Missing, Panel, Plot, extent};
use super::series::{RunStyle, legend};
use crate::classify::{JacobiSequence, Proportions};
use crate::report::RunData;
use crate::store::ConfigurationRecord;

const NAME: &str = "shape";
const TITLE: &str = "Triaxiality and flattening";

/// The figure of one or several runs.
///
/// # Errors
/// Before object 0 there are no shapes.
pub fn plot(runs: &[RunData]) -> Result<Plot, Missing> {
    let point = |c: &ConfigurationRecord| {
        let shape = Proportions::of_half_extents(c);
        shape.triaxiality.map(|t| [shape.c_over_a, t])
    };
    let (mut tracks, mut marks, mut losses, mut drawn) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (index, run) in runs.iter().enumerate() {
        let points: Vec<[f64; 2]> = run.configurations.iter().filter_map(point).collect();
        let (Some(first), Some(last)) = (points.first().copied(), points.last().copied()) else { continue };
        let alone = runs.len() == 1;
        let style = if alone { RunStyle::alone() } else { RunStyle::of(index, run) };
        let start = if alone { Mark::OpenSquare } else { style.mark };
        tracks.push(Layer { points, kind: style.line(1.6), colour: style.colour });
        marks.push(Layer::marks(vec![first], start, 5.5, style.colour));
        marks.push(Layer::marks(vec![last], Mark::Cross, 6.0, style.colour));
        let shedding = run.accepted_legs().filter(|leg| leg.shed > 0);
        losses.extend(shedding.filter_map(|leg| point(&run.configurations[leg.configuration as usize])));
        drawn.push((run, Kind::Marks(start, 5.5), style.colour));
    }
    if drawn.is_empty() {
        return Err(Missing::new(NAME, TITLE, "there is no tiled body yet"));
    }
    let jacobi: Vec<[f64; 2]> = JacobiSequence::new().points().iter().map(|[t, c_over_a]| [*c_over_a, *t]).collect();
    let all = tracks.iter().flat_map(|l: &Layer| &l.points);
    let [low, high] = extent(all.clone().map(|p| p[0]));
    let [flat, round] = extent(all.map(|p| p[1]));
    let mut entries = vec![
        LegendEntry { label: "Jacobi ellipsoids".into(), kind: Kind::Line(1.8), colour: BLACK },
        LegendEntry { label: "end".into(), kind: Kind::Marks(Mark::Cross, 5.0), colour: GREY },
    ];
    if runs.len() == 1 {
        entries.push(LegendEntry { label: "start".into(), kind: Kind::Marks(Mark::OpenSquare, 5.0), colour: GREY });
    }
    if !losses.is_empty() {
        entries.push(LegendEntry { label: "mass loss".into(), kind: Kind::Marks(Mark::Diamond, 4.0), colour: BLACK });
    }
    entries.extend(legend(&drawn, runs.len()));
    let mut layers = vec![Layer::line(jacobi, 1.8, BLACK)];
    layers.extend(tracks);
    layers.push(Layer::marks(losses, Mark::Diamond, 4.0, BLACK));
    layers.extend(marks);
    // The paper's window, wider where a body leaves it: a small track in a small window would look like a long way.
    let window = |low: f64, high: f64, usual: [f64; 2]| [usual[0].min(low - 0.02), usual[1].max(high + 0.02)];
    let ([left, right], [bottom, top]) = (window(low, high, [0.4, 0.9]), window(flat, round, [0.0, 1.0]));
    let others = if runs.len() > 1 { " Marks: starts; solid lines: bodies that lost mass." } else { "" };
    Ok(Plot {
        name: NAME,
        title: TITLE.into(),
        caption: format!(
            "Triaxiality T = (1 − (b/a)²) / (1 − (c/a)²) against c/a of every configuration, by half extents: 0 is oblate, 1 prolate. \
             Left of the black curve a body is flatter than the fluid ellipsoid of its triaxiality.{others}"
        ),
        rows: vec![vec![Panel {
            x: Axis::between("c/a", left, right),
            y: Axis::between("Triaxiality T", bottom, top.min(1.02)),
            layers,
        }]],
        panel_height: 430.0,
        legend: entries,
        colour_bar: None,
    })
}
