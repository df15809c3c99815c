//! Why a body fell apart while it settled, other than that its spin is too much for its shape.

use pkd::Spheres;
use pkd::constants::G;

use super::engine::ContactLaw;
use crate::scene::{Contact, Scene, USUAL_DENSITIES, about_density, shortest_period_h};

/// Longest step of hard spheres, over the time 1/sqrt(G rho) in which gravity acts. Resting piles of 1000 spheres keep
/// still at 0.03 and begin to shift at 0.045; those of 300 shift from 0.07 on and fly apart at 0.2 and more.
const LONGEST_STEP: f64 = 0.03;
/// A stiffness below this part of what the body asks for lets spheres fall through each other.
const SOFTEST: f64 = 0.01;

/// What is likely to blame, most likely first; empty if it is the spin alone. `period_s` is that of the body.
pub(super) fn likely_causes(scene: &Scene, spheres: &Spheres, period_s: f64) -> Vec<String> {
    let density = largest_density(spheres);
    let mut causes = Vec::new();
    if !USUAL_DENSITIES.contains(&density) {
        causes.push(format!("its densest sphere has {density:.3} kg/m3{}", about_density(density)));
    }
    match &scene.contact {
        Contact::HardSphere(contact) => {
            let longest = LONGEST_STEP / (G * density).sqrt();
            if contact.step_s > longest {
                let step = contact.step_s;
                causes.push(format!(
                    "contact.hard_sphere.step_s = {step} s is too long: at most {longest:.0} s for spheres of {density:.0} kg/m3"
                ));
            }
        }
        Contact::SoftSphere(contact) => {
            let mut asked = scene.clone();
            if let Contact::SoftSphere(contact) = &mut asked.contact {
                contact.normal_stiffness_n_m = None;
                contact.step_s = None;
            }
            let asked =
                ContactLaw::of(&asked).stiffness(spheres).ok().flatten().map(|s| s.kinetic_n_m.max(s.static_n_m));
            if let (Some(given), Some(asked)) = (contact.normal_stiffness_n_m, asked)
                && given < SOFTEST * asked
            {
                causes.push(format!(
                    "contact.soft_sphere.normal_stiffness_n_m = {given} N/m is too soft: the body asks for {asked:.1e} N/m, as null gives it"
                ));
            }
        }
    }
    let (period_h, limit_h) = (period_s / 3600.0, shortest_period_h(density));
    if period_h < limit_h {
        causes.push(format!(
            "its period of {period_h:.3} h is below {limit_h:.3} h, the limit of a sphere of that density"
        ));
    }
    causes
}

/// The largest density of a sphere, kg/m^3.
pub(super) fn largest_density(spheres: &Spheres) -> f64 {
    let volume = |radius: f64| 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
    spheres.mass.iter().zip(&spheres.radius).map(|(mass, radius)| mass / volume(*radius)).fold(0.0, f64::max)
}
