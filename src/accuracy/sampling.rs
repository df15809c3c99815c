//! Knobs: how finely a torque table samples horizons, seasons, obliquities, and heat.
//!
//! The same tiled bodies are computed with ever finer sampling and compared with the finest. The torque of a body is what
//! is left when its sides cancel, so the error of one body is partly luck: it is taken over several, as the root mean
//! square of the largest difference over all obliquities, over that of the largest torque, for the worse of the two
//! components.

use std::f64::consts::TAU;

use cpu_time::ProcessTime;
use taco::{BodyMesh, Interpolation, Obliquities, Orbit, Sampling, SpinRates, Surface, TorqueTable, torque_table};

use super::body::Bench;
use super::facets::{BodyToTile, difference};
use super::{About, AccuracyError, Effort, Knob, Point};

/// Bodies over which the error is taken: seeds of their packings.
const SEEDS: std::ops::Range<u64> = 1..5;

/// Facets of the tilings.
const FACETS: u32 = 784;
/// Facets of the tilings on which heat is followed.
const FACETS_WITH_HEAT: u32 = 196;
/// Largest spin rate of a table, rad/s: a period of 2 h.
const FASTEST: f64 = TAU / 7200.0;

/// A field of [`Sampling`].
pub(super) struct SamplingKnob {
    name: &'static str,
    unit: &'static str,
    scene_key: &'static str,
    /// Facets of the tilings, and what they are made of.
    facets: u32,
    surface: fn() -> Surface,
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
    facets: FACETS,
    surface: Surface::default,
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
    facets: FACETS,
    surface: Surface::default,
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
    facets: FACETS,
    surface: Surface::default,
    default: |sampling| match &sampling.obliquities {
        Obliquities::StepDeg(step) => *step,
        Obliquities::ListDeg(_) => f64::NAN,
    },
    with: |value| Sampling { obliquities: Obliquities::StepDeg(value), ..Sampling::default() },
    values: &[30.0, 15.0, 10.0, 5.0, 2.5],
    reference: 0.5,
};

/// [`Sampling::facet_samples`].
pub(super) const FACET_SAMPLES: SamplingKnob = SamplingKnob {
    name: "facet_samples",
    unit: "points",
    scene_key: "torque.facet_samples",
    facets: FACETS,
    surface: Surface::default,
    default: |sampling| sampling.facet_samples as f64,
    with: |value| Sampling { facet_samples: value as usize, ..Sampling::default() },
    values: &[1.0, 4.0, 9.0, 16.0],
    reference: 64.0,
};

/// [`Sampling::rotation_cells`], which is also twice the number of harmonics in which heat is followed.
pub(super) const ROTATION_CELLS: SamplingKnob = SamplingKnob {
    name: "rotation_cells",
    unit: "cells (two per harmonic)",
    scene_key: "torque.rotation_cells",
    facets: FACETS_WITH_HEAT,
    surface: warm,
    default: |sampling| sampling.rotation_cells as f64,
    with: |value| Sampling {
        rotation_cells: value as usize,
        spin_rates: SpinRates::ListRadS(vec![TAU / 21_600.0]),
        ..coarse_seasons()
    },
    values: &[16.0, 32.0, 64.0, 128.0],
    reference: 256.0,
};

/// Number of spin rates of [`SpinRates::UpTo`].
pub(super) const SPIN_RATES: SamplingKnob = SamplingKnob {
    name: "spin_rates",
    unit: "spin rates",
    scene_key: "torque.spin_rates",
    facets: FACETS_WITH_HEAT,
    surface: warm,
    default: |sampling| match sampling.spin_rates {
        SpinRates::UpTo { nodes, .. } => nodes as f64,
        SpinRates::ListRadS(_) => f64::NAN,
    },
    with: |value| Sampling {
        spin_rates: SpinRates::UpTo { max_rad_s: FASTEST, nodes: value as usize },
        ..coarse_seasons()
    },
    values: &[3.0, 6.0, 11.0, 21.0],
    reference: 41.0,
};

/// The ground of the paper's test with stored heat.
fn warm() -> Surface {
    Surface { thermal_inertia: 200.0, ..Surface::default() }
}

/// A quarter of the declinations, because heat takes long and its sampling has nothing to do with theirs.
fn coarse_seasons() -> Sampling {
    Sampling { declination_nodes: 9, ..Sampling::default() }
}

impl Knob for SamplingKnob {
    fn about(&self) -> About {
        About {
            name: self.name,
            part: "taco",
            unit: self.unit,
            scene_key: self.scene_key,
            default: (self.default)(&Sampling::default()),
            // Tables over spin rates are compared at eight of them.
            error_is: "largest difference of a torque component over obliquities 0.5 deg apart, over its largest value, \
                       rms of two (quick) or four bodies; reference: the finest sampling of the same bodies",
        }
    }

    fn points(&self, bench: &mut Bench) -> Result<Vec<Point>, AccuracyError> {
        let count = match bench.effort {
            Effort::Quick => 2,
            Effort::Full => 4,
        };
        let bodies = SEEDS
            .take(count)
            .map(|seed| BodyToTile::new(bench, seed)?.tiled(self.facets))
            .collect::<Result<Vec<_>, _>>()?;
        let curves = |value: f64| -> Result<(Vec<TorqueTable>, f64), AccuracyError> {
            let clock = ProcessTime::now();
            let tables = bodies.iter().map(|body| self.curve(body, value)).collect::<Result<Vec<_>, _>>()?;
            let seconds = clock.elapsed().as_secs_f64() / bodies.len() as f64;
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
    fn curve(&self, body: &BodyMesh, value: f64) -> Result<TorqueTable, AccuracyError> {
        Ok(torque_table(body, &(self.surface)(), &Orbit::default(), &(self.with)(value))?)
    }
}

/// The torques of a table every half degree, as its interpolant gives them; if they depend on the spin rate, at eight
/// rates from a period of 200 h to one of 2 h.
fn between(table: &TorqueTable) -> Result<TorqueTable, AccuracyError> {
    let curve = table.interpolant(Interpolation::Cubic)?;
    let obliquity: Vec<f64> = (0..=360).map(|k| (0.5 * f64::from(k)).to_radians()).collect();
    let omega: Vec<f64> = match table.omega.len() {
        1 => table.omega.clone(),
        _ => (0..8).map(|k| FASTEST * 100_f64.powf(f64::from(k) / 7.0 - 1.0)).collect(),
    };
    let rows = omega.iter().map(|omega| obliquity.iter().map(|e| curve.at(*e, *omega)).unzip());
    let (spin_torque_n_m, obliquity_torque_n_m) = rows.unzip();
    Ok(TorqueTable { obliquity, omega, spin_torque_n_m, obliquity_torque_n_m, ..table.clone() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_fall_with_finer_sampling_and_are_a_few_percent_at_the_defaults() {
        let mut silent = |_: &str| {};
        // A packed body is rough: most of a facet's shadow comes from the sphere beside it, and the centroid is a poor witness.
        let usual =
            [AZIMUTH_BINS, DECLINATION_NODES, OBLIQUITY_STEP, ROTATION_CELLS, SPIN_RATES].map(|knob| (knob, 0.05));
        for (knob, bound) in usual.into_iter().chain([(FACET_SAMPLES, 0.5)]) {
            let points = knob.points(&mut Bench::new(Effort::Quick, &mut silent)).unwrap();
            let at = points.iter().position(|p| p.value == knob.about().default).expect("the default is a point");
            assert!(points[at].error < bound && points[0].error > 2.0 * points[points.len() - 1].error, "{points:?}");
        }
    }
}
