//! Spin rate and obliquity of several runs against time, one colour and mark for each run.

use super::plot::{Axis, Layer, Missing, Panel, Plot};
use super::series::{RunStyle, legend};
use super::spin::course_of;
use crate::report::RunData;

const NAME: &str = "together";
const TITLE: &str = "Spin and obliquity of all runs";

/// The figure of several runs.
///
/// # Errors
/// Before the first leg of any of them there is nothing to draw.
pub fn plot(runs: &[RunData]) -> Result<Plot, Missing> {
    let courses: Vec<Vec<[f64; 3]>> = runs.iter().map(course_of).collect();
    let end = courses.iter().flatten().map(|p| p[0]).fold(0.0, f64::max);
    if end <= 0.0 {
        return Err(Missing::new(NAME, TITLE, "nothing has evolved yet"));
    }
    let styles: Vec<RunStyle> = runs.iter().enumerate().map(|(index, run)| RunStyle::of(index, run)).collect();
    let panel = |label: &str, k: usize| {
        let mut layers = Vec::new();
        for (points, style) in courses.iter().zip(&styles) {
            let points: Vec<[f64; 2]> = points.iter().map(|p| [p[0], p[k]]).collect();
            layers.push(Layer::marks(points.last().copied().into_iter().collect(), style.mark, 4.5, style.colour));
            layers.push(Layer::line(points, 1.8, style.colour));
        }
        let y = Axis::around(label, courses.iter().flatten().map(|p| p[k]));
        Panel { x: Axis::between("Time (Myr)", 0.0, end), y, layers }
    };
    let drawn: Vec<_> = runs.iter().zip(&styles).map(|(run, style)| (run, style.line(2.0), style.colour)).collect();
    Ok(Plot {
        name: NAME,
        title: TITLE.into(),
        caption: "Spin rate and obliquity of each run; a mark stands where it has come to. Dashed in the legend: bodies that lost no \
                  mass."
            .into(),
        rows: vec![vec![panel("Spin rate (rev/day)", 1)], vec![panel("Obliquity (deg)", 2)]],
        panel_height: 250.0,
        legend: legend(&drawn, runs.len()),
        colour_bar: None,
    })
}
