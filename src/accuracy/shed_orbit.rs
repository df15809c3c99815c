//! Knobs: the tolerance of the integrator of shed bodies, and the error of the multipoles that stand for mascons far out.
//!
//! One sphere on an eccentric retrograde orbit around the turning body, from close by to where multipoles take over. The
//! reference is exact: its Jacobi constant does not change.

use std::f64::consts::TAU;

use cpu_time::ProcessTime;
use pkd::constants::G;

use super::body::{Bench, PERIOD_S};
use super::{About, AccuracyError, Effort, Knob, Point};
use crate::scene::Rebound;
use crate::shed::{Primary, ShedBody, TrackOptions, follow};

/// Pericentre and apocentre of the orbit, in mean radii of the body.
const APSIDES: [f64; 2] = [4.0, 40.0];

/// The tolerance of IAS15.
pub(super) struct Ias15Tolerance;

/// The error at which multipoles take over, and with it the radius.
pub(super) struct MultipoleError;

impl Knob for Ias15Tolerance {
    fn about(&self) -> About {
        About {
            name: "ias15_tolerance",
            part: "shed",
            unit: "1",
            scene_key: "shed.track.rebound.ias15_tolerance",
            default: Rebound::default().ias15_tolerance,
            error_is: "change of the Jacobi constant of a shed sphere over GM/r, mascons everywhere; reference: no change",
        }
    }

    fn points(&self, bench: &mut Bench) -> Result<Vec<Point>, AccuracyError> {
        let exact = TrackOptions { multipole_error: 1e-15, ..TrackOptions::default() };
        points(bench, "ias15_tolerance", &[1e-3, 1e-5, 1e-7, 1e-9, 1e-11], |ias15_tolerance| TrackOptions {
            ias15_tolerance,
            ..exact
        })
    }
}

impl Knob for MultipoleError {
    fn about(&self) -> About {
        About {
            name: "multipole_error",
            part: "shed",
            unit: "1",
            scene_key: "shed.track.rebound.multipole_error",
            default: Rebound::default().multipole_error,
            error_is: "change of the Jacobi constant of a shed sphere over GM/r; reference: no change. Sets the radius beyond \
                       which multipoles stand for the body's spheres",
        }
    }

    fn points(&self, bench: &mut Bench) -> Result<Vec<Point>, AccuracyError> {
        points(bench, "multipole_error", &[1e-2, 1e-4, 1e-6, 1e-8, 1e-10], |multipole_error| TrackOptions {
            multipole_error,
            ..TrackOptions::default()
        })
    }
}

/// The drift and the cost at each value.
fn points(
    bench: &mut Bench,
    name: &str,
    values: &[f64],
    options: impl Fn(f64) -> TrackOptions,
) -> Result<Vec<Point>, AccuracyError> {
    let days = match bench.effort {
        Effort::Quick => 30.0,
        Effort::Full => 365.0,
    };
    let spheres = bench.settled_body()?;
    let properties = pkd::mass_properties::mass_properties(&spheres)?;
    let [near, far] = APSIDES.map(|radii| radii * properties.mean_radius());
    let speed = (2.0 * G * properties.mass * far / (near * (near + far))).sqrt();
    let shed = ShedBody {
        position: [near, 0.0, 0.0],
        velocity: [0.0, -0.9 * speed, 0.43 * speed],
        spin: [0.0; 3],
        mass: 1.0,
        radius: 1.0,
    };
    let primary = Primary { spheres, spin_rate: TAU / PERIOD_S };
    let mut points = Vec::new();
    for &value in values {
        let clock = ProcessTime::now();
        let tracks = follow(&primary, &[shed], &TrackOptions { t_max_s: days * 86_400.0, ..options(value) })?;
        let seconds = clock.elapsed().as_secs_f64();
        let error = tracks.jacobi_drift.first().copied().flatten().unwrap_or(f64::NAN);
        bench.say(&format!("{name} {value:e}: error {error:.2e} in {seconds:.2} s"));
        points.push(Point { value, error, spread: None, seconds });
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarse_settings_drift_more_and_the_defaults_are_among_the_points() {
        let mut silent = |_: &str| {};
        for knob in [&Ias15Tolerance as &dyn Knob, &MultipoleError] {
            let points = knob.points(&mut Bench::new(Effort::Quick, &mut silent)).unwrap();
            assert!(points.iter().any(|p| p.value == knob.about().default));
            let (coarse, fine) = (points[0].error, points[points.len() - 1].error);
            assert!(coarse > 10.0 * fine && fine < 1e-9, "{points:?}");
        }
    }
}
