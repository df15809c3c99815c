//! Knobs of soft spheres: how finely contacts are resolved, how long a field of gravity serves, how wide neighbours are
//! searched, and the force error of the tree that sums gravity.
//!
//! All but the last are measured on random spheres that fall together under their own gravity, turning, with the friction
//! of Zhang et al. 2017: every sphere collides, slips and comes to rest within the stretch that is timed.

use cpu_time::ProcessTime;
use nalgebra::Vector3;
use pkd::Spheres;
use pkd::frame::set_rigid_rotation;
use pkd::gravity::{Accelerations, Gravity, GravityMethod, GravityOptions};
use pkd::soft_sphere::{self, Report, SoftSphere, SoftSphereParameters};

use super::body::{Bench, PERIOD_S};
use super::{About, AccuracyError, Effort, Knob, Point};

/// Duration of a stretch, s: a tenth of a rotation, in which the spheres come together.
const STRETCH_S: f64 = 0.1 * PERIOD_S;

/// Speed that the stiffness is made for, m/s: what spheres reach in the fall.
const SPEED_M_S: f64 = 0.1;

/// The spheres before they fall.
fn cloud(bench: &Bench) -> Result<Spheres, AccuracyError> {
    let mut body = bench.packed_body(11)?;
    set_rigid_rotation(&mut body, Vector3::z() * std::f64::consts::TAU / PERIOD_S)?;
    Ok(body)
}

/// The parameters that a knob is set in.
fn parameters() -> SoftSphereParameters {
    SoftSphereParameters { expected_speed_m_s: Some(SPEED_M_S), max_overlap: 0.1, ..SoftSphereParameters::default() }
}

/// A stretch of `duration_s`, with the CPU seconds that it took.
fn stretch(
    body: &mut Spheres,
    parameters: SoftSphereParameters,
    duration_s: f64,
) -> Result<(Report, f64), AccuracyError> {
    let clock = ProcessTime::now();
    let report = SoftSphere::new(parameters).evolve(body, duration_s)?;
    Ok((report, clock.elapsed().as_secs_f64()))
}

/// Steps in the duration of the quickest contact.
pub(super) struct StepsPerContact;

impl Knob for StepsPerContact {
    fn about(&self) -> About {
        About {
            name: "steps_per_contact",
            part: "pkd",
            unit: "steps",
            scene_key: "contact.soft_sphere.steps_per_contact",
            default: parameters().steps_per_contact,
            error_is: "what the books of energy are off by while spheres fall together, over the heat made; reference: 0",
        }
    }

    fn points(&self, bench: &mut Bench) -> Result<Vec<Point>, AccuracyError> {
        let body = cloud(bench)?;
        let mut points = Vec::new();
        for value in [10.0, 20.0, 30.0, 50.0, 100.0, 200.0] {
            // A field renewed in every step, so that the steps are all that errs.
            let parameters = SoftSphereParameters {
                steps_per_contact: value,
                gravity: soft_sphere::Gravity::EveryStep,
                ledger: true,
                ..parameters()
            };
            let (report, seconds) = stretch(&mut body.clone(), parameters, STRETCH_S)?;
            let ledger = report.ledger.unwrap_or_default();
            let error = ledger.residual_j().abs() / ledger.dissipated_j();
            bench.say(&format!("steps_per_contact {value}: error {error:.2e} in {seconds:.2} s"));
            points.push(Point { value, error, spread: None, seconds });
        }
        Ok(points)
    }
}

/// How far spheres move before gravity is evaluated anew.
pub(super) struct FieldTolerance;

impl Knob for FieldTolerance {
    fn about(&self) -> About {
        About {
            name: "field_tolerance",
            part: "pkd",
            unit: "radii",
            scene_key: "contact.soft_sphere.field_tolerance",
            default: 0.01,
            error_is: "rms error of the accelerations just before they are evaluated anew, over their rms: the largest while \
                       spheres fall together; reference: the field at that moment",
        }
    }

    fn points(&self, bench: &mut Bench) -> Result<Vec<Point>, AccuracyError> {
        let body = cloud(bench)?;
        let mut points = Vec::new();
        for tolerance in [0.1, 0.03, 0.01, 0.003, 0.001] {
            let gravity = soft_sphere::Gravity::BodyFrame { tolerance };
            let parameters = SoftSphereParameters { gravity, ..parameters() };
            let (report, seconds) = stretch(&mut body.clone(), parameters, STRETCH_S)?;
            let (error, evaluations) = (report.frozen_field_error, report.gravity_evaluations);
            bench.say(&format!(
                "field_tolerance {tolerance}: error {error:.2e}, {evaluations} evaluations in {seconds:.2} s"
            ));
            points.push(Point { value: tolerance, error, spread: None, seconds });
        }
        Ok(points)
    }
}

/// How far spheres move before neighbours are searched anew.
pub(super) struct Skin;

impl Knob for Skin {
    fn about(&self) -> About {
        About {
            name: "skin",
            part: "pkd",
            unit: "radii",
            scene_key: "contact.soft_sphere.skin",
            default: parameters().skin,
            error_is: "largest difference of a position after a hundredth of a rotation, over the radius; reference: the \
                       default. The knob changes the cost and the order of sums only",
        }
    }

    fn points(&self, bench: &mut Bench) -> Result<Vec<Point>, AccuracyError> {
        let body = cloud(bench)?;
        let run = |skin| {
            let mut end = body.clone();
            let gravity = soft_sphere::Gravity::EveryStep;
            let (_, seconds) =
                stretch(&mut end, SoftSphereParameters { skin, gravity, ..parameters() }, 0.1 * STRETCH_S)?;
            Ok::<_, AccuracyError>((end, seconds))
        };
        let (reference, _) = run(parameters().skin)?;
        let mut points = Vec::new();
        for skin in [0.1, 0.05, 0.02, 0.01, 0.005] {
            let (end, seconds) = run(skin)?;
            let error = (0..end.len())
                .map(|i| (Vector3::from(end.position(i)) - Vector3::from(reference.position(i))).norm() / end.radius[i])
                .fold(0.0, f64::max);
            bench.say(&format!("skin {skin}: error {error:.2e} in {seconds:.2} s"));
            points.push(Point { value: skin, error, spread: None, seconds });
        }
        Ok(points)
    }
}

/// Relative error of the force that the tree may make.
pub(super) struct ForceError;

impl Knob for ForceError {
    fn about(&self) -> About {
        About {
            name: "force_error",
            part: "pkd",
            unit: "relative",
            scene_key: "gravity.force_error",
            default: GravityOptions::default().force_error,
            error_is: "rms error of the tree's accelerations over their rms; reference: the direct sum",
        }
    }

    fn points(&self, bench: &mut Bench) -> Result<Vec<Point>, AccuracyError> {
        let body = bench.packed_body_of(
            match bench.effort {
                Effort::Quick => 3000,
                Effort::Full => 20_000,
            },
            11,
        )?;
        let evaluate = |method, force_error| {
            let mut gravity = Gravity::new(GravityOptions { method, force_error });
            let mut a = Accelerations::default();
            // The first evaluation makes what later ones only renew.
            gravity.accelerations(&body.x, &body.y, &body.z, &body.mass, &mut a);
            let clock = ProcessTime::now();
            gravity.accelerations(&body.x, &body.y, &body.z, &body.mass, &mut a);
            (a, clock.elapsed().as_secs_f64())
        };
        let (exact, _) = evaluate(GravityMethod::Direct, 1e-3);
        let sum = |a: &Accelerations, b: Option<&Accelerations>| {
            let square = |i: usize| {
                let of = |a: &Accelerations| Vector3::new(a.x[i], a.y[i], a.z[i]);
                (of(a) - b.map_or(Vector3::zeros(), of)).norm_squared()
            };
            (0..body.len()).map(square).sum::<f64>()
        };
        let mut points = Vec::new();
        for force_error in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6] {
            let (a, seconds) = evaluate(GravityMethod::Tree, force_error);
            let error = (sum(&a, Some(&exact)) / sum(&exact, None)).sqrt();
            bench.say(&format!("force_error {force_error:e}: error {error:.2e} in {seconds:.1e} s"));
            points.push(Point { value: force_error, error, spread: None, seconds });
        }
        Ok(points)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(knob: &dyn Knob) -> Vec<Point> {
        let mut silent = |_: &str| {};
        let points = knob.points(&mut Bench::new(Effort::Quick, &mut silent)).unwrap();
        assert!(points.iter().any(|p| p.value == knob.about().default), "{points:?}");
        points
    }

    #[test]
    fn books_of_energy_close_better_with_every_refinement() {
        let points = measured(&StepsPerContact);
        assert!(points.windows(2).all(|pair| pair[1].error < pair[0].error), "{points:?}");
        assert!(points[2].error < 0.02 && points[5].error < 1e-3, "{points:?}");
    }

    #[test]
    fn fields_renewed_earlier_err_less() {
        let points = measured(&FieldTolerance);
        assert!(points.windows(2).all(|pair| pair[1].error < pair[0].error), "{points:?}");
        assert!(points[2].error < 3e-3, "{points:?}");
    }

    #[test]
    fn the_skin_changes_nothing_but_round_off() {
        let points = measured(&Skin);
        assert!(points.iter().all(|p| p.error < 1e-9), "{points:?}");
    }

    #[test]
    fn the_tree_keeps_the_error_asked_for() {
        let points = measured(&ForceError);
        assert!(points.iter().all(|p| p.error < p.value), "{points:?}");
    }
}
