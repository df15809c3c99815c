//! Knobs: the step and the tolerance of the two spin integrators.
//!
//! Spin and obliquity of a tiled body are followed from 6 h and 5 degrees for as long as its largest spin torque would
//! need to change the spin by half, and compared with the adaptive integrator at its finest. The torques are those of a
//! table, cubic in obliquity, whose third derivative jumps at the nodes: that is what the integrators meet in a run.

use std::f64::consts::TAU;

use cpu_time::ProcessTime;
use taco::{BodyMesh, Interpolation, Orbit, Sampling, SpinAxis, Surface, TorqueInterpolant, torque_table};

use super::body::Bench;
use super::facets::BodyToTile;
use super::{About, AccuracyError, Knob, Point};
use crate::evolve::rigid::TOLERANCE;
use crate::evolve::spin::{Integrator, LegLimits, SpinState, YEAR_S, integrate_leg};
use crate::scene::{Evolution, TilingOptions};

/// Density of the body, kg/m^3: that of the paper's bodies.
const DENSITY_KG_M3: f64 = 1630.0;
/// Part of the time in which the largest torque alone would stop the body.
const HALF: f64 = 0.5;
/// Tolerance of the reference.
const FINEST: f64 = 1e-13;
/// Legs that are timed together, because one takes less than a clock resolves.
const REPEATS: u32 = 100;

/// A number that sets the steps of an integrator.
pub(super) struct SpinKnob {
    name: &'static str,
    unit: &'static str,
    scene_key: &'static str,
    default: fn() -> f64,
    integrator: fn(f64) -> Integrator,
    /// From coarse to fine.
    values: &'static [f64],
}

/// The step of [`Integrator::Rk4`].
pub(super) const RK4_STEP: SpinKnob = SpinKnob {
    name: "rk4_step",
    unit: "yr",
    scene_key: "evolution.rk4_step_yr",
    default: || Evolution::default().rk4_step_yr,
    integrator: |step_yr| Integrator::Rk4 { step_s: step_yr * YEAR_S },
    values: &[10_000.0, 5000.0, 3000.0, 2000.0, 1000.0],
};

/// The tolerance of [`Integrator::Adaptive`].
pub(super) const SPIN_TOLERANCE: SpinKnob = SpinKnob {
    name: "spin_tolerance",
    unit: "relative",
    scene_key: "yorp rigid --tolerance",
    default: || TOLERANCE,
    integrator: |tolerance| Integrator::Adaptive { tolerance },
    values: &[1e-8, 1e-9, 1e-10, 1e-11, 1e-12],
};

impl Knob for SpinKnob {
    fn about(&self) -> About {
        About {
            name: self.name,
            part: "spin",
            unit: self.unit,
            scene_key: self.scene_key,
            default: (self.default)(),
            error_is: "length of the difference of the spin vectors over that of the spin vector, after the largest torque \
                       could have changed it by half; reference: adaptive steps to 1e-13",
        }
    }

    fn points(&self, bench: &mut Bench) -> Result<Vec<Point>, AccuracyError> {
        let body = BodyToTile::new(bench, 1)?.tiled(TilingOptions::default().facets)?;
        let body = Body::new(&body)?;
        let reference = body.end(Integrator::Adaptive { tolerance: FINEST })?;
        let mut points = Vec::new();
        for &value in self.values {
            let clock = ProcessTime::now();
            let mut end = body.end((self.integrator)(value))?;
            for _ in 1..REPEATS {
                end = std::hint::black_box(body.end((self.integrator)(value))?);
            }
            let seconds = clock.elapsed().as_secs_f64() / f64::from(REPEATS);
            let error = (end.omega / reference.omega - 1.0).hypot(end.obliquity - reference.obliquity);
            bench.say(&format!("{} {value}: error {error:.2e} in {seconds:.1e} s", self.name));
            points.push(Point { value, error, spread: None, seconds });
        }
        Ok(points)
    }
}

struct Body {
    torque: TorqueInterpolant,
    inertia: f64,
    start: SpinState,
    duration_s: f64,
}

impl Body {
    fn new(tiled: &BodyMesh) -> Result<Self, AccuracyError> {
        let body = BodyMesh::uniform(tiled.mesh().clone(), SpinAxis::Largest)?;
        let inertia = DENSITY_KG_M3 * body.spin_moment();
        let table = torque_table(&body, &Surface::default(), &Orbit::default(), &Sampling::default())?;
        let largest = table.spin_torque_n_m[0].iter().fold(0.0_f64, |m, t| m.max(t.abs()));
        let start = SpinState { t_s: 0.0, omega: TAU / 21_600.0, obliquity: 5_f64.to_radians() };
        let duration_s = HALF * start.omega * inertia / largest;
        Ok(Self { torque: table.interpolant(Interpolation::Cubic)?, inertia, start, duration_s })
    }

    fn end(&self, integrator: Integrator) -> Result<SpinState, AccuracyError> {
        let limits = LegLimits {
            integrator,
            spin_change: f64::INFINITY,
            stop_period_s: None,
            end_state_fraction: None,
            ..LegLimits::until(self.duration_s)
        };
        let mut state = self.start;
        // Legs end at extrema of the spin rate.
        while state.t_s < self.duration_s {
            state = integrate_leg(&self.torque, self.inertia, state, &limits)?.end;
        }
        Ok(state)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Effort;
    use super::*;

    #[test]
    fn errors_fall_with_the_step_and_with_the_tolerance() {
        let mut silent = |_: &str| {};
        for knob in [RK4_STEP, SPIN_TOLERANCE] {
            let points = knob.points(&mut Bench::new(Effort::Quick, &mut silent)).unwrap();
            assert!(points.iter().any(|p| p.value == knob.about().default));
            assert!(points.windows(2).all(|w| w[1].error <= w[0].error), "{points:?}");
        }
    }
}
