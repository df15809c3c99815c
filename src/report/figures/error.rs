//! Error against evolution time: what each leg and each shape estimate of their own errors.

use super::cost::torque_error;
use super::palette::distinct;
use super::plot::{Axis, Kind, Layer, LegendEntry, Mark, Missing, Panel, Plot};
use crate::evolve::driver::MYR_S;
use crate::report::RunData;
use crate::store::LegRecord;

const NAME: &str = "error";
const TITLE: &str = "Errors along the run";

/// The figure of one run.
///
/// # Errors
/// Before the first leg there is nothing to draw.
pub fn plot(run: &RunData) -> Result<Plot, Missing> {
    if run.legs.is_empty() {
        return Err(Missing::new(NAME, TITLE, "nothing has evolved yet"));
    }
    let legs = |of: fn(&LegRecord) -> f64| -> Vec<[f64; 2]> {
        run.accepted_legs().map(|leg| [leg.t_s[1] / MYR_S, of(leg)]).collect()
    };
    let torques = run.configurations.iter().filter_map(|c| Some([c.t_s / MYR_S, torque_error(&c.torque)?]));
    let series: [(&str, Mark, Vec<[f64; 2]>); 5] = [
        ("torque, over its largest value", Mark::Diamond, torques.collect()),
        ("overlap, radii", Mark::Triangle, legs(|l| l.dynamics.max_overlap_radii)),
        ("angular momentum", Mark::Disc, legs(|l| l.dynamics.angular_momentum_drift)),
        ("spin rate", Mark::Square, legs(|l| l.spin_error)),
        ("obliquity (rad)", Mark::Cross, legs(|l| l.obliquity_error)),
    ];
    let end = run.accepted_legs().map(|leg| leg.t_s[1] / MYR_S).fold(0.0, f64::max);
    let everything = series.iter().flat_map(|(_, _, points)| points.iter().map(|p| p[1]));
    let y = Axis::logarithmic("Error estimate", everything);
    let (mut layers, mut entries) = (Vec::new(), Vec::new());
    for (index, (label, mark, points)) in series.into_iter().enumerate() {
        if !points.iter().any(|p| p[1] > 0.0) {
            continue;
        }
        let colour = distinct(index);
        layers.push(Layer::marks(points, mark, 3.0, colour));
        entries.push(LegendEntry { label: label.into(), kind: Kind::Marks(mark, 3.5), colour });
    }
    Ok(Plot {
        name: NAME,
        title: TITLE.into(),
        caption: "What each leg of the evolution and each torque table estimate of their own error. What is exactly zero has no mark.".into(),
        rows: vec![vec![Panel { x: Axis::between("Time (Myr)", -0.02 * end, 1.02 * end), y, layers }]],
        panel_height: 340.0,
        legend: entries,
        colour_bar: None,
    })
}
