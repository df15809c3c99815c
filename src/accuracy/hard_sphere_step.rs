//! Knob: the step between two evaluations of gravity in the hard-sphere method.
//!
//! Contacts are chaotic, so no trajectory can be the reference. A settled body is: its spheres rest on each other, and
//! in the limit of short steps they turn rigidly with it. A finite step keeps them bouncing, because each kick throws
//! them at their neighbours with the speed that gravity gathered over a step. The error is that speed: the rms over
//! spheres and over half a rotation (quick) or one of the motion relative to rigid rotation, over the escape speed from
//! the mean radius. It falls in proportion to the step until what is left is real: slow creep, and spheres that rattle
//! in their cages.

use cpu_time::ProcessTime;
use nalgebra::Vector3;
use pkd::Spheres;
use pkd::constants::G;
use pkd::hard_sphere::{HardSphere, HardSphereParameters};
use pkd::mass_properties::mass_properties;

use super::body::{Bench, PERIOD_S};
use super::{About, AccuracyError, Effort, Knob, Point, half_range};

/// Rotations that a body is given to forget the step it was settled with.
const WARM_UP: f64 = 0.5;
/// Samples per rotation.
const SAMPLES: u32 = 20;
/// Relative size of the perturbation that sets the copies apart; contacts blow it up within a rotation.
const PERTURBATION: f64 = 1e-9;

/// The step of [`HardSphereParameters::step_s`].
pub(super) struct HardSphereStep;

impl Knob for HardSphereStep {
    fn about(&self) -> About {
        About {
            name: "hard_sphere_step",
            part: "pkd",
            unit: "s",
            scene_key: "contact.hard_sphere.step_s",
            default: HardSphereParameters::default().step_s,
            error_is: "rms speed of the spheres of a settled body relative to rigid rotation, over the escape speed; \
                       reference: rest",
        }
    }

    fn points(&self, bench: &mut Bench) -> Result<Vec<Point>, AccuracyError> {
        let (steps_s, copies, rotations): (&[f64], u32, u32) = match bench.effort {
            Effort::Quick => (&[200.0, 100.0, 50.0, 25.0], 2, 1),
            Effort::Full => (&[400.0, 200.0, 100.0, 50.0, 25.0, 12.5], 3, 1),
        };
        let body = bench.settled_body()?;
        let mut points = Vec::new();
        for &step_s in steps_s {
            let clock = ProcessTime::now();
            let errors: Vec<f64> = (0..copies)
                .map(|copy| restlessness(&perturbed(&body, copy), step_s, rotations))
                .collect::<Result<_, _>>()?;
            let seconds = clock.elapsed().as_secs_f64() / f64::from(copies);
            let error = errors.iter().sum::<f64>() / f64::from(copies);
            bench.say(&format!("hard_sphere_step {step_s} s: error {error:.2e} in {seconds:.2} s"));
            points.push(Point { value: step_s, error, spread: Some(half_range(&errors)), seconds });
        }
        Ok(points)
    }
}

/// A copy that differs by a billionth of its velocities.
fn perturbed(body: &Spheres, copy: u32) -> Spheres {
    let mut other = body.clone();
    for (i, v) in other.vx.iter_mut().enumerate() {
        *v *= 1.0 + PERTURBATION * f64::from(copy) * (i as f64).sin();
    }
    other
}

/// Rms speed relative to rigid rotation over the escape speed, after a warm-up, for `rotations` with the given step.
fn restlessness(body: &Spheres, step_s: f64, rotations: u32) -> Result<f64, AccuracyError> {
    let mut body = body.clone();
    let mut engine = HardSphere::new(HardSphereParameters { step_s, ..HardSphereParameters::default() });
    engine.evolve(&mut body, WARM_UP * PERIOD_S)?;
    let samples = rotations * SAMPLES;
    let mut sum = 0.0;
    for _ in 0..samples {
        engine.evolve(&mut body, PERIOD_S / f64::from(SAMPLES))?;
        sum += mean_square_speed(&body)?;
    }
    let properties = mass_properties(&body)?;
    let escape_squared = 2.0 * G * properties.mass / properties.mean_radius();
    Ok((sum / f64::from(samples) / escape_squared).sqrt())
}

/// Mean square speed of the spheres relative to the rigid rotation of the whole, m^2/s^2.
fn mean_square_speed(body: &Spheres) -> Result<f64, AccuracyError> {
    let properties = mass_properties(body)?;
    let omega = properties.angular_velocity();
    let square = |i: usize| {
        let arm = Vector3::from(body.position(i)) - properties.centre;
        (Vector3::from(body.velocity(i)) - properties.velocity - omega.cross(&arm)).norm_squared()
    };
    Ok((0..body.len()).map(square).sum::<f64>() / body.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_falls_with_the_step_and_the_default_is_among_the_points() {
        let mut silent = |_: &str| {};
        let points = HardSphereStep.points(&mut Bench::new(Effort::Quick, &mut silent)).unwrap();
        assert!(points.iter().any(|p| p.value == HardSphereStep.about().default));
        for pair in points.windows(2) {
            // In proportion to the step, give or take the chaos of a small body.
            let ratio = pair[0].error / pair[1].error;
            assert!((1.2..3.5).contains(&ratio), "{points:?}");
        }
    }

    #[test]
    fn rigid_rotation_is_rest() {
        let mut body = Spheres::default();
        body.push([1.0, 0.0, 0.0], [0.0; 3], [0.0; 3], 2.0, 0.5);
        body.push([0.0, 2.0, 0.0], [0.0; 3], [0.0; 3], 1.0, 0.5);
        body.push([0.0, 0.0, -3.0], [0.0; 3], [0.0; 3], 1.5, 0.5);
        pkd::frame::set_rigid_rotation(&mut body, Vector3::new(1e-4, -2e-4, 3e-4)).unwrap();
        assert!(mean_square_speed(&body).unwrap() < 1e-36);
    }
}
