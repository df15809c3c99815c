//! Where the time went, part by part, and the error that each part estimates of itself.

use super::palette::{BLUE, ORANGE};
use super::plot::{Axis, Kind, Layer, LegendEntry, Mark, Missing, Panel, Plot};
use crate::report::RunData;
use crate::store::{Part, TorqueRecord};

const NAME: &str = "cost";
const TITLE: &str = "Time and error of each part";
/// Below this an error is round-off.
const ROUND_OFF: f64 = 1e-17;

/// The figure of one run.
///
/// # Errors
/// Nothing has been recorded yet.
pub fn plot(run: &RunData) -> Result<Plot, Missing> {
    let parts: Vec<_> = run.totals.parts.iter().filter(|(_, total)| total.count > 0).collect();
    if parts.is_empty() {
        return Err(Missing::new(NAME, TITLE, "no time has been recorded yet"));
    }
    let names = || Axis::rows(parts.iter().map(|(part, total)| format!("{} ×{}", part.name(), total.count)).collect());
    let bars = |of: fn(&crate::store::PartTotal) -> f64| -> Vec<[f64; 2]> {
        parts.iter().enumerate().map(|(row, (_, total))| [of(total), row as f64]).collect()
    };
    let (wall, cpu) = (bars(|t| t.seconds), bars(|t| t.cpu_seconds));
    let longest = wall.iter().chain(&cpu).map(|p| p[0]).fold(1e-6, f64::max);
    let time = Panel {
        x: Axis::between("Time (s)", 0.0, 1.05 * longest),
        y: names(),
        layers: vec![
            Layer { points: wall, kind: Kind::Bars, colour: BLUE },
            Layer::marks(cpu, Mark::Diamond, 5.0, ORANGE),
        ],
    };
    let errors: Vec<[f64; 2]> = parts
        .iter()
        .enumerate()
        .filter_map(|(row, (part, _))| Some([error(run, *part)?.max(ROUND_OFF), row as f64]))
        .collect();
    let estimated = Panel {
        x: Axis::logarithmic("Error estimate, relative", errors.iter().map(|p| p[0])),
        y: Axis::rows(vec![String::new(); parts.len()]),
        layers: vec![Layer::marks(errors.clone(), Mark::Disc, 6.0, BLUE)],
    };
    let shown = if errors.is_empty() { vec![time] } else { vec![time, estimated] };
    Ok(Plot {
        name: NAME,
        title: TITLE.into(),
        caption: "Wall and CPU time of each part of the loop with the number of times it ran, and the largest error that it \
                  estimates of itself: angular momentum for the dynamics (checks without and with movement), torque error over the \
                  largest torque, step doubling for the spin. Parts without an estimate have no mark."
            .into(),
        rows: vec![shown],
        panel_height: 34.0 * parts.len() as f64 + 20.0,
        legend: vec![
            LegendEntry { label: "wall time".into(), kind: Kind::Bars, colour: BLUE },
            LegendEntry { label: "CPU time".into(), kind: Kind::Marks(Mark::Diamond, 5.0), colour: ORANGE },
        ],
        colour_bar: None,
    })
}

/// The largest relative error that a part has estimated.
fn error(run: &RunData, part: Part) -> Option<f64> {
    let largest = |values: &mut dyn Iterator<Item = f64>| values.reduce(f64::max);
    let of_legs = |moved: bool| {
        let legs = run.legs.iter().filter(|leg| (leg.result != "quiet") == moved);
        largest(&mut legs.map(|leg| leg.dynamics.angular_momentum_drift))
    };
    match part {
        Part::Check => of_legs(false),
        Part::Movement => of_legs(true),
        Part::Spin => largest(&mut run.legs.iter().map(|leg| leg.spin_error)),
        Part::Torque => largest(&mut run.configurations.iter().filter_map(|c| torque_error(&c.torque))),
        _ => None,
    }
}

/// Error of the spin torque over its largest value; `None` where there is no torque.
pub(super) fn torque_error(torque: &TorqueRecord) -> Option<f64> {
    let largest = torque.spin_torque.iter().map(|t| t.abs()).fold(0.0, f64::max);
    (largest > 0.0).then(|| torque.spin_torque_error / largest)
}
