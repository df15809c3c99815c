//! Knobs: how finely a torque table samples horizons, seasons and obliquities.
//!
//! The same tiled bodies are computed with ever finer sampling and compared with the finest. The torque of a body is what
//! is left when its sides cancel, so the error of one body is partly luck: it is taken over several, as the root mean
//! square of the largest difference over all obliquities, over that of the largest torque, for the worse of the two
//! components.

use cpu_time::ProcessTime;
use taco::{Interpolation, Obliquities, Orbit, Sampling, Surface, TorqueTable, torque_table};
use tiling::Mesh;

use super::body::Bench;
use super::facets::{BodyToTile, difference};
use super::{About, AccuracyError, Effort, Knob, Point};
use crate::scene::TilingOptions;

/// Bodies over which the error is taken: seeds of their packings.
const SEEDS: std::ops::Range<u64> = 1..5;

/// A field of [`Sampling`].
pub(super) struct SamplingKnob {
    name: &'static str,
    unit: &'static str,
    scene_key: &'static str,
    default: fn(&Sampling) -> f64,
    /// The default sampling with this value of the knob.
    with: fn(f64) -> Sampling,
    /// From coarse to fine, and the reference.
    values: &'static [f64],
    reference: f64,
}

/// [`Sampling::azimuth_bins`].
pub(super) const AZIMUTH_BINS: SamplingKnob = SamplingKnob {
    name: "azimuth_bins",
    unit: "azimuths",
    scene_key: "torque.azimuth_bins",
    default: |sampling| sampling.azimuth_bins as f64,
    with: |value| Sampling { azimuth_bins: value as usize, ..Sampling::default() },
    values: &[24.0, 48.0, 72.0, 120.0, 240.0],
    reference: 960.0,
};

/// [`Sampling::declination_nodes`].
pub(super) const DECLINATION_NODES: SamplingKnob = SamplingKnob {
    name: "declination_nodes",
    unit: "nodes",
    scene_key: "torque.declination_nodes",
    default: |sampling| sampling.declination_nodes as f64,
    with: |value| Sampling { declination_nodes: value as usize, ..Sampling::default() },
    values: &[9.0, 13.0, 19.0, 37.0, 73.0],
    reference: 289.0,
};

/// [`Sampling::obliquities`] as a step; between its nodes a spline gives the torques.
pub(super) const OBLIQUITY_STEP: SamplingKnob = SamplingKnob {
    name: "obliquity_step",
    unit: "deg",
    scene_key: "torque.obliquity_step_deg",
    default: |sampling| match &sampling.obliquities {
        Obliquities::StepDeg(step) => *step,
        Obliquities::ListDeg(_) => f64::NAN,
    },
    with: |value| Sampling { obliquities: Obliquities::StepDeg(value), ..Sampling::default() },
    values: &[30.0, 15.0, 10.0, 5.0, 2.5],
    reference: 0.5,
};

impl Knob for SamplingKnob {
    fn about(&self) -> About {
        About {
            name: self.name,
            part: "taco",
            unit: self.unit,
            scene_key: self.scene_key,
            default: (self.default)(&Sampling::default()),
            error_is: "largest difference of a torque component over obliquities 0.5 deg apart, over its largest value, \
                       rms of two (quick) or four bodies; reference: the finest sampling of the same bodies",
        }
    }

    fn points(&self, bench: &mut Bench) -> Result<Vec<Point>, AccuracyError> {
        let count = match bench.effort {
            Effort::Quick => 2,
            Effort::Full => 4,
        };
        let facets = TilingOptions::default().facets;
        let meshes =
            SEEDS.take(count).map(|seed| BodyToTile::new(bench, seed)?.tiled(facets)).collect::<Result<Vec<_>, _>>()?;
        let curves = |value: f64| -> Result<(Vec<TorqueTable>, f64), AccuracyError> {
            let clock = ProcessTime::now();
            let tables = meshes.iter().map(|mesh| self.curve(mesh, value)).collect::<Result<Vec<_>, _>>()?;
            let seconds = clock.elapsed().as_secs_f64() / meshes.len() as f64;
            Ok((tables.iter().map(between).collect::<Result<_, _>>()?, seconds))
        };
        let (reference, _) = curves(self.reference)?;
        let mut points = Vec::new();
        for &value in self.values {
            let (tables, seconds) = curves(value)?;
            let (error, spread) = difference(&tables, &reference);
            bench.say(&format!("{} {value}: error {error:.2e} in {seconds:.3} s", self.name));
            points.push(Point { value, error, spread: Some(spread), seconds });
        }
        Ok(points)
    }
}

impl SamplingKnob {
    fn curve(&self, mesh: &Mesh, value: f64) -> Result<TorqueTable, AccuracyError> {
        Ok(torque_table(mesh, &Surface::default(), &Orbit::default(), &(self.with)(value))?)
    }
}

/// The torques of a table every half degree, as its interpolant gives them.
fn between(table: &TorqueTable) -> Result<TorqueTable, AccuracyError> {
    let curve = table.interpolant(Interpolation::Cubic)?;
    let obliquity: Vec<f64> = (0..=360).map(|k| (0.5 * f64::from(k)).to_radians()).collect();
    let (spin, tilt) = obliquity.iter().map(|e| curve.at(*e, table.omega[0])).unzip();
    let mut fine = table.clone();
    (fine.obliquity, fine.spin_torque_n_m, fine.obliquity_torque_n_m) = (obliquity, vec![spin], vec![tilt]);
    Ok(fine)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_fall_with_finer_sampling_and_are_a_few_percent_at_most_at_the_defaults() {
        let mut silent = |_: &str| {};
        for knob in [AZIMUTH_BINS, DECLINATION_NODES, OBLIQUITY_STEP] {
            let points = knob.points(&mut Bench::new(Effort::Quick, &mut silent)).unwrap();
            let at = points.iter().position(|p| p.value == knob.about().default).expect("the default is a point");
            assert!(points[at].error < 0.05 && points[0].error > 2.0 * points[at].error, "{points:?}");
        }
    }
}
