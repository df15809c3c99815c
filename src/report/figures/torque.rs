//! Torque curves of all configurations: both components over the moment of inertia, against obliquity.
//!
//! After Figures 6 and 9 of Cotto-Figueroa et al. (2015), ApJ 803, 25, whose unit this is.

use super::palette::{BLACK, GREY, sequential};
use super::plot::{Axis, ColourBar, Kind, Layer, LegendEntry, Missing, Panel, Plot, extent};
use crate::evolve::configuration::Shape;
use crate::report::RunData;
use crate::store::ConfigurationRecord;

const NAME: &str = "torque";
const TITLE: &str = "Torque curves";
/// 10^-18 s^-2.
const UNIT: f64 = 1e-18;
/// More curves than this nobody can tell apart; evenly chosen ones are drawn.
const CURVES: usize = 400;

/// The figure of one run.
///
/// # Errors
/// Before object 0 there are no torques.
pub fn plot(run: &RunData) -> Result<Plot, Missing> {
    if run.configurations.is_empty() {
        return Err(Missing::new(NAME, TITLE, "there is no tiled body yet"));
    }
    let last = run.configurations.len() - 1;
    let every = run.configurations.len().div_ceil(CURVES);
    let drawn: Vec<&ConfigurationRecord> =
        run.configurations.iter().filter(|c| (c.configuration as usize).is_multiple_of(every)).collect();
    let met = extent(run.accepted_legs().flat_map(|leg| leg.obliquity).map(f64::to_degrees));
    let panel = |label: &str, component: Component| {
        let curves: Vec<_> = drawn.iter().map(|c| (c.configuration, curve(run, c, component))).collect();
        let y = Axis::around(label, curves.iter().flat_map(|(_, curve)| curve.iter().map(|p| p[1])).chain([0.0]));
        let mut layers = Vec::new();
        if let (Some(latest), Some((_, points))) = (drawn.last(), curves.last()) {
            let error = component.error(latest) / latest.moments_kg_m2[2] / UNIT;
            let edge = |sign: f64| points.iter().map(move |p| [p[0], p[1] + sign * error]);
            let points = edge(1.0).chain(edge(-1.0).rev()).collect();
            layers.push(Layer { points, kind: Kind::Band, colour: GREY });
        }
        layers.push(Layer::line(vec![[0.0, 0.0], [180.0, 0.0]], 1.0, BLACK));
        let width = if curves.len() > 20 { 1.2 } else { 1.8 };
        for (number, points) in curves {
            layers.push(Layer::line(points, width, sequential(f64::from(number) / last.max(1) as f64)));
        }
        if !run.legs.is_empty() {
            for edge in met {
                let points = vec![[edge, y.range[0]], [edge, y.range[1]]];
                layers.push(Layer { points, kind: Kind::Dashed(1.2), colour: GREY });
            }
        }
        Panel { x: Axis::obliquity(), y, layers }
    };
    let rows = vec![
        vec![panel("Spin torque / C (10⁻¹⁸ s⁻²)", Component::Spin)],
        vec![panel("Obliquity torque / C (10⁻¹⁸ s⁻²)", Component::Obliquity)],
    ];
    let left_out = match every {
        1 => String::new(),
        n => format!(" Of the {} curves every {n}th is drawn.", run.configurations.len()),
    };
    let mut legend =
        vec![LegendEntry { label: "estimated error, latest shape".into(), kind: Kind::Band, colour: GREY }];
    if !run.legs.is_empty() {
        legend.push(LegendEntry { label: "obliquities met".into(), kind: Kind::Dashed(1.2), colour: GREY });
    }
    Ok(Plot {
        name: NAME,
        title: TITLE.into(),
        caption: format!(
            "Both torque components over the largest moment of inertia C, for every configuration of the body; \
             the body stayed between the dashed lines.{left_out}"
        ),
        rows,
        panel_height: 260.0,
        legend,
        colour_bar: (last > 0).then_some(ColourBar { label: "configuration", last: last as u32 }),
    })
}

/// One of the two torques.
#[derive(Clone, Copy)]
enum Component {
    Spin,
    Obliquity,
}

impl Component {
    /// Its estimated error, N m.
    fn error(self, c: &ConfigurationRecord) -> f64 {
        match self {
            Self::Spin => c.torque.spin_torque_error,
            Self::Obliquity => c.torque.obliquity_torque_error,
        }
    }
}

/// The curve between the nodes as a run looks it up, at every degree and at the spin rate of the middle node: with stored heat
/// there are several, and one is shown. Nodes alone where the table cannot be looked up.
fn curve(run: &RunData, c: &ConfigurationRecord, component: Component) -> Vec<[f64; 2]> {
    let scaled = |(degrees, torque): (f64, f64)| [degrees, torque / c.moments_kg_m2[2] / UNIT];
    let row = c.torque.spin_rate.len() / 2;
    let Ok(shape) = Shape::from_record(&run.scene, c.clone()) else {
        let nodes = c.torque.obliquity.len();
        let values = match component {
            Component::Spin => &c.torque.spin_torque,
            Component::Obliquity => &c.torque.obliquity_torque,
        };
        let values = values.get(row * nodes..(row + 1) * nodes).unwrap_or_default();
        return c.torque.obliquity.iter().map(|o| o.to_degrees()).zip(values.iter().copied()).map(scaled).collect();
    };
    let omega = c.torque.spin_rate.get(row).copied().unwrap_or_default();
    let at = |degrees: u32| {
        let (spin, obliquity) = shape.torque.at(f64::from(degrees).to_radians(), omega);
        let torque = match component {
            Component::Spin => spin,
            Component::Obliquity => obliquity,
        };
        scaled((f64::from(degrees), torque))
    };
    (0..=180).map(at).collect()
}
