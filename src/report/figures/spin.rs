//! Spin rate and obliquity against time, a colour for each configuration, the rigid body in black.
//!
//! After Figures 4, 5, 7, 10 and 14 of Cotto-Figueroa et al. (2015), ApJ 803, 25: squares mark mass loss, and where the
//! rigid body wanders much further than the aggregate a second column shows the aggregate alone.

use super::course::{rigid, within};
use super::palette::{BLACK, Colour, GREY, sequential};
use super::plot::{Axis, ColourBar, Kind, Layer, LegendEntry, Mark, Missing, Panel, Plot, extent};
use crate::classify::{Quantity, Segment, segments};
use crate::evolve::driver::MYR_S;
use crate::evolve::rigid::{REV_PER_DAY, sphere_limit};
use crate::evolve::spin::SpinState;
use crate::report::RunData;
use crate::store::LegRecord;

const NAME: &str = "spin";
const TITLE: &str = "Spin and obliquity";
/// The aggregate is shown apart where it fills less than this of the common axis.
const NARROW: f64 = 0.35;
const WIDE_LINE: f64 = 2.6;
/// The axis is stretched to the spin barrier where that is less than this times the largest spin rate.
const BARRIER_IN_SIGHT: f64 = 1.4;

/// The figure of one run.
///
/// # Errors
/// Before the first leg there is nothing to draw.
pub fn plot(run: &RunData) -> Result<Plot, Missing> {
    let stretches = stretches(run);
    let end = stretches.iter().flat_map(|s| s.points.last()).map(|p| p[0]).fold(0.0, f64::max);
    if end <= 0.0 {
        return Err(Missing::new(NAME, TITLE, "nothing has evolved yet"));
    }
    let quantities = [
        Shown {
            label: "Spin rate (rev/day)",
            value: |p| p[1],
            rigid: |r| r.omega / REV_PER_DAY,
            barrier: spin_barrier(run),
        },
        Shown { label: "Obliquity (deg)", value: |p| p[2], rigid: |r| r.obliquity.to_degrees(), barrier: None },
    ];
    let rigid = rigid(run, end * MYR_S);
    let common: Vec<Panel> = quantities.iter().map(|q| q.panel(run, &stretches, end, &rigid)).collect();
    let alone: Vec<Panel> = quantities.iter().map(|q| q.panel(run, &stretches, end, &[])).collect();
    let height = |panel: &Panel| panel.y.range[1] - panel.y.range[0];
    let narrow = common.iter().zip(&alone).any(|(c, a)| height(a) < NARROW * height(c));
    let rows: Vec<Vec<Panel>> = match narrow {
        true => common.into_iter().zip(alone).map(|(c, a)| vec![c, a]).collect(),
        false => common.into_iter().map(|panel| vec![panel]).collect(),
    };
    let mut legend = vec![LegendEntry { label: "rigid body".into(), kind: Kind::Line(1.4), colour: BLACK }];
    if !losses(run).is_empty() {
        let kind = Kind::Marks(Mark::Square, 4.5);
        legend.push(LegendEntry { label: "mass loss".into(), kind, colour: BLACK });
    }
    if let Some(barrier) = quantities[0].barrier {
        let [low, high] = rows_range(&rows);
        if (low..=high).contains(&barrier) {
            legend.push(LegendEntry { label: "spin barrier".into(), kind: Kind::Dashed(1.2), colour: GREY });
        }
    }
    let last = run.configurations.len().saturating_sub(1) as u32;
    let barrier = quantities[0].barrier.map_or(String::new(), |rate| {
        format!(" A sphere of the body's density (by the hull of its spheres) sheds its equator at {rate:.2} rev/day, the spin barrier.")
    });
    let zoom = if narrow { " On the right, the aggregate alone." } else { "" };
    Ok(Plot {
        name: NAME,
        title: TITLE.into(),
        caption: format!(
            "Spin rate and obliquity of the aggregate; every colour is a configuration, every change of colour a movement. \
             Black: the same body, were it rigid.{zoom}{barrier}"
        ),
        rows,
        panel_height: 230.0,
        legend,
        colour_bar: (last > 0).then_some(ColourBar { label: "configuration", last }),
    })
}

/// One of the two panels.
struct Shown {
    label: &'static str,
    /// From time, spin rate and obliquity of the aggregate.
    value: fn(&[f64; 3]) -> f64,
    rigid: fn(&SpinState) -> f64,
    /// Where the spin barrier of the body lies.
    barrier: Option<f64>,
}

/// The spin rate at which a sphere of the body's first density sheds its equator, rev/day.
fn spin_barrier(run: &RunData) -> Option<f64> {
    run.configurations.first().map(|c| sphere_limit(c.densities_kg_m3[2]) / REV_PER_DAY)
}

/// Vertical range of the first panel.
fn rows_range(rows: &[Vec<Panel>]) -> [f64; 2] {
    rows.first().and_then(|row| row.first()).map_or([0.0; 2], |panel| panel.y.range)
}

/// The evolution with one configuration: Myr, revolutions a day, degrees.
struct Stretch {
    configuration: u32,
    points: Vec<[f64; 3]>,
}

fn stretches(run: &RunData) -> Vec<Stretch> {
    let point = |s: &Segment, k: usize| [s.t_s[k] / MYR_S, Quantity::Spin.of(s)[k], Quantity::Obliquity.of(s)[k]];
    let between = |s: &SpinState| [s.t_s / MYR_S, s.omega / REV_PER_DAY, s.obliquity.to_degrees()];
    let after_start = |s: &Segment| within(run, s).iter().map(between).chain([point(s, 1)]).collect::<Vec<_>>();
    let stretch = |of: &[Segment]| Stretch {
        configuration: of[0].configuration,
        points: std::iter::once(point(&of[0], 0)).chain(of.iter().flat_map(after_start)).collect(),
    };
    segments(run).chunk_by(|a, b| a.configuration == b.configuration).map(stretch).collect()
}

/// The whole course of a run: Myr, revolutions a day, degrees.
pub(super) fn course_of(run: &RunData) -> Vec<[f64; 3]> {
    stretches(run).into_iter().flat_map(|stretch| stretch.points).collect()
}

/// Legs whose check shed something.
fn losses(run: &RunData) -> Vec<&LegRecord> {
    run.accepted_legs().filter(|leg| leg.shed > 0).collect()
}

impl Shown {
    /// With the `rigid` curve behind, unless it is empty.
    fn panel(&self, run: &RunData, stretches: &[Stretch], end: f64, rigid: &[SpinState]) -> Panel {
        let samples: Vec<[f64; 2]> = rigid.iter().map(|r| [r.t_s / MYR_S, (self.rigid)(r)]).collect();
        let rigid = until(&samples, end);
        let own = stretches.iter().flat_map(|s| &s.points).map(self.value);
        let mut values: Vec<f64> = own.chain(rigid.iter().map(|p| p[1])).collect();
        let mut layers = Vec::new();
        if let Some(barrier) = self.barrier {
            // Drawn where the body or its rigid twin comes near; far above, it would only flatten the curves.
            if barrier < BARRIER_IN_SIGHT * extent(values.iter().copied())[1] {
                values.push(barrier);
            }
            layers.push(Layer { points: vec![[0.0, barrier], [end, barrier]], kind: Kind::Dashed(1.2), colour: GREY });
        }
        layers.push(Layer::line(rigid, 1.4, BLACK));
        let last = run.configurations.len().saturating_sub(1).max(1);
        for stretch in stretches {
            let points = stretch.points.iter().map(|p| [p[0], (self.value)(p)]).collect();
            let colour: Colour = sequential(f64::from(stretch.configuration) / last as f64);
            layers.push(Layer::line(points, WIDE_LINE, colour));
        }
        let marks = losses(run).into_iter().map(|leg| {
            let point = [leg.t_s[1] / MYR_S, leg.omega[1] / REV_PER_DAY, leg.obliquity[1].to_degrees()];
            [point[0], (self.value)(&point)]
        });
        layers.push(Layer::marks(marks.collect(), Mark::Square, 4.5, BLACK));
        let mut y = Axis::around(self.label, values.iter().copied());
        let [low, high] = extent(values);
        // Neither spin rates nor obliquities go below zero; the air around zero is not for them.
        if low >= 0.0 && y.range[0] < 0.0 {
            y.range[0] = -0.02 * high;
        }
        Panel { x: Axis::between("Time (Myr)", 0.0, end), y, layers }
    }
}

/// A curve up to `end`, which it reaches if it goes on beyond it.
fn until(curve: &[[f64; 2]], end: f64) -> Vec<[f64; 2]> {
    let within = curve.partition_point(|p| p[0] <= end);
    let mut shown = curve[..within].to_vec();
    if let (Some(last), Some(next)) = (shown.last().copied(), curve.get(within)) {
        let share = (end - last[0]) / (next[0] - last[0]);
        shown.push([end, last[1] + share * (next[1] - last[1])]);
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rigid_curve_ends_where_the_run_does() {
        let curve = [[0.0, 1.0], [2.0, 3.0], [4.0, 7.0]];
        assert_eq!(until(&curve, 3.0), [[0.0, 1.0], [2.0, 3.0], [3.0, 5.0]]);
        assert_eq!(until(&curve, 9.0), curve);
        assert!(until(&[], 1.0).is_empty());
    }
}
