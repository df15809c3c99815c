//! How stiff contacts must be, and how short the step then is.
//!
//! Schwartz et al. 2012 (Granular Matter 14, 363, sections 2.1 and 2.7): spheres should overlap by no more than 1 % of
//! their radius, in impacts, under the weight of the body and under cohesion; a step is a small part of the duration of
//! the quickest contact.

use std::f64::consts::PI;

use nalgebra::Vector3;

use super::parameters::{Gravity, SoftSphereParameters};
use crate::constants::G;
use crate::mass_properties::mass_properties;
use crate::{PkdError, Spheres};

/// Overlap that stiffnesses aim at, as a fraction of the radius.
pub const TARGET_OVERLAP: f64 = 0.01;

/// Fewest steps that a contact may be resolved with: the restitution is 3 % off there, and it goes unstable at a third
/// of that.
pub const FEWEST_STEPS_PER_CONTACT: f64 = 10.0;

/// Stiffness and step for a body, with what asked for them.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Stiffness {
    /// Normal stiffness k_n in use, N/m.
    pub normal_n_m: f64,
    /// What impacts ask for, N/m.
    pub kinetic_n_m: f64,
    /// What the weight of the body asks for, N/m; 0 without gravity.
    pub static_n_m: f64,
    /// What cohesion asks for, N/m.
    pub cohesive_n_m: f64,
    /// Speed of impact reckoned with, m/s.
    pub speed_m_s: f64,
    /// Duration of the quickest contact without damping, s: that of the two lightest spheres.
    pub contact_time_s: f64,
    /// Longest step in use, s.
    pub step_s: f64,
}

impl Stiffness {
    /// Stiffness and step of `parameters` for `spheres`.
    ///
    /// # Errors
    /// [`PkdError::BadParameter`], [`PkdError::Empty`] or [`PkdError::BadValue`] for what was passed in,
    /// [`PkdError::StepTooLarge`] for a given step that resolves contacts with fewer than
    /// [`FEWEST_STEPS_PER_CONTACT`] steps, [`PkdError::NotFinite`] for a body out of the range of `f64`.
    pub fn of(parameters: &SoftSphereParameters, spheres: &Spheres) -> Result<Self, PkdError> {
        parameters.validate()?;
        let body = mass_properties(spheres)?;
        let largest = (0..spheres.len()).fold(0, |a, b| if spheres.radius[b] > spheres.radius[a] { b } else { a });
        let (mass, radius) = (spheres.mass[largest], spheres.radius[largest]);

        let speed_m_s = parameters.expected_speed_m_s.unwrap_or_else(|| {
            let omega = body.angular_velocity();
            let against_rotation = |i: usize| {
                let (r, v) = (Vector3::from(spheres.position(i)), Vector3::from(spheres.velocity(i)));
                (v - body.velocity - omega.cross(&(r - body.centre))).norm()
            };
            let escape = (2.0 * G * mass / radius).sqrt();
            // Two of the fastest may meet head on.
            (0..spheres.len()).map(|i| 2.0 * against_rotation(i)).filter(|v| v.is_finite()).fold(escape, f64::max)
        });
        let kinetic = |i: usize| kinetic_stiffness(spheres.mass[i], speed_m_s, TARGET_OVERLAP * spheres.radius[i]);
        let kinetic_n_m = (0..spheres.len()).map(kinetic).fold(0.0, f64::max);
        let static_n_m = if parameters.gravity == Gravity::Off {
            0.0
        } else {
            let h = body.half_extents.product().cbrt();
            let density = body.mass / (4.0 / 3.0 * PI * h.powi(3));
            static_stiffness(density, G * body.mass / (h * h), h, radius)
        };
        let q = parameters.shape * 0.5 * radius;
        let cohesive_n_m = 4.0 * parameters.cohesion_pa * q * q / (TARGET_OVERLAP * radius);

        let normal_n_m = parameters.normal_stiffness_n_m.unwrap_or(kinetic_n_m.max(static_n_m).max(cohesive_n_m));
        let contact_time_s = PI * (0.5 * lightest(spheres) / normal_n_m).sqrt();
        let step_s = parameters.step_s.unwrap_or(contact_time_s / parameters.steps_per_contact);
        if !(normal_n_m.is_finite() && normal_n_m > 0.0 && step_s.is_finite() && step_s > 0.0) {
            return Err(PkdError::NotFinite { quantity: "stiffness" });
        }
        let limit_s = contact_time_s / FEWEST_STEPS_PER_CONTACT;
        // A step derived from the fewest steps must not fail by round-off.
        if step_s > limit_s * (1.0 + 1e-12) {
            return Err(PkdError::StepTooLarge { step_s, limit_s });
        }
        Ok(Self { normal_n_m, kinetic_n_m, static_n_m, cohesive_n_m, speed_m_s, contact_time_s, step_s })
    }
}

fn lightest(spheres: &Spheres) -> f64 {
    spheres.mass.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Stiffness, N/m, that stops a sphere of this mass (kg) and speed (m/s) within an overlap (m).
fn kinetic_stiffness(mass: f64, speed: f64, overlap: f64) -> f64 {
    mass * (speed / overlap).powi(2)
}

/// Stiffness, N/m, that carries the weight of a body (bulk density kg/m³, surface gravity m/s², radius m) on spheres of a
/// radius (m).
fn static_stiffness(bulk_density: f64, gravity: f64, body_radius: f64, radius: f64) -> f64 {
    bulk_density * gravity * body_radius * radius / TARGET_OVERLAP
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(radius: f64, density: f64) -> Spheres {
        let mut pair = Spheres::default();
        let mass = 4.0 / 3.0 * PI * radius.powi(3) * density;
        for side in [-1.0, 1.0] {
            pair.push([side * radius, 0.0, 0.0], [0.0; 3], [0.0; 3], mass, radius);
        }
        pair
    }

    /// Bodies of Cotto-Figueroa et al. 2015 and Zhang et al. 2017 with the rules of Schwartz et al. 2012.
    #[test]
    fn paper_stiffnesses_and_steps() {
        let g = |mass: f64, radius: f64| G * mass / (radius * radius);
        let s1 = static_stiffness(1630.0, g(1.5685e12, 626.0), 626.0, 50.2);
        assert!((s1 / 1.368e6 - 1.0).abs() < 1e-3, "{s1:e}");
        let didymos = static_stiffness(2100.0, g(5.23e11, 390.0), 390.0, 10.0);
        assert!((didymos / 1.88e5 - 1.0).abs() < 2e-3, "{didymos:e}");

        let spheres = pair(50.2, 2960.0);
        let got = Stiffness::of(&SoftSphereParameters::default(), &spheres).unwrap();
        assert!((got.speed_m_s / 0.0646 - 1.0).abs() < 1e-3, "{got:?}");
        assert!((got.kinetic_n_m / 2.596e7 - 1.0).abs() < 2e-3, "{got:?}");
        assert!((got.contact_time_s - 17.3).abs() < 0.05 && (got.step_s - 0.576).abs() < 0.001, "{got:?}");
        let fine = SoftSphereParameters { steps_per_contact: 50.0, ..Default::default() };
        assert!((Stiffness::of(&fine, &spheres).unwrap().step_s - 0.345).abs() < 0.001);

        let given = SoftSphereParameters { normal_stiffness_n_m: Some(didymos), ..Default::default() };
        let got = Stiffness::of(&given, &pair(10.0, 3420.0)).unwrap();
        assert!((got.contact_time_s - 19.4).abs() < 0.05 && (got.step_s - 0.646).abs() < 0.002, "{got:?}");
    }

    #[test]
    fn steps_that_resolve_no_contact_are_refused_with_the_limit() {
        let spheres = pair(50.2, 2960.0);
        let long = SoftSphereParameters { step_s: Some(5.0), ..Default::default() };
        match Stiffness::of(&long, &spheres) {
            Err(PkdError::StepTooLarge { step_s, limit_s }) => {
                assert_eq!(step_s, 5.0);
                let longest = SoftSphereParameters { step_s: Some(limit_s), ..Default::default() };
                Stiffness::of(&longest, &spheres).unwrap();
            }
            other => panic!("{other:?}"),
        }
    }
}
