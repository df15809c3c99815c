//! What a scene may hold and rarely means: told to the user, and done all the same.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use pkd::constants::G;

use super::{Contact, Scene};

/// Densities of grains, kg/m^3, that nobody asks about: between a loose clod of ice and iron.
pub const USUAL_DENSITIES: RangeInclusive<f64> = 500.0..=8000.0;

/// Periods, h, above which one may have been given in seconds: the slowest rotators known take 2000 h, and 2000 s are less
/// than any pile of rubble.
const LONGEST_USUAL_PERIOD_H: f64 = 2000.0;

/// Share of its volume that a heap of equal spheres fills.
const FILLED: f64 = 0.6;

/// Period, h, below which a sphere of this density (kg/m^3) no longer holds what lies on its equator: sqrt(3 pi/(G rho)).
pub fn shortest_period_h(density_kg_m3: f64) -> f64 {
    (3.0 * PI / (G * density_kg_m3)).sqrt() / 3600.0
}

/// The same as a question about a density, where it is one that is rarely meant; else empty.
pub fn about_density(density_kg_m3: f64) -> &'static str {
    if USUAL_DENSITIES.contains(&density_kg_m3) {
        ""
    } else if USUAL_DENSITIES.contains(&(1000.0 * density_kg_m3)) {
        " (g/cm3? 1 g/cm3 is 1000 kg/m3)"
    } else {
        " (rock has 500 to 8000)"
    }
}

impl Scene {
    /// Whether something other than gravity holds spheres together.
    pub fn is_cohesive(&self) -> bool {
        matches!(&self.contact, Contact::SoftSphere(contact) if contact.cohesion_pa > 0.0)
    }
}

/// What in `scene` is allowed and odd, a sentence each.
pub fn oddities(scene: &Scene) -> Vec<String> {
    let mut told = Vec::new();
    let period_h = scene.spin.period_h;
    if period_h > LONGEST_USUAL_PERIOD_H {
        told.push(format!("spin.period_h is {period_h} h: in seconds? {period_h} s are {:.3} h", period_h / 3600.0));
    }
    let Some(grain) = scene.body.grain() else { return told };
    let density = grain.density_kg_m3;
    if !USUAL_DENSITIES.contains(&density) {
        told.push(format!("{} is {density} kg/m3{}", grain.density_key, about_density(density)));
    }
    let limit_h = shortest_period_h(FILLED * density);
    if period_h < limit_h {
        let rubble = FILLED * density;
        told.push(format!(
            "spin.period_h is {period_h} h: a round heap of these spheres, of about {rubble:.0} kg/m3, loses material below {limit_h:.2} h"
        ));
    }
    told
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Body, PackedEllipsoid};

    fn scene(density: f64, period_h: f64) -> Scene {
        let body = PackedEllipsoid {
            spheres: 100,
            radius_m: 50.0,
            grain_density_kg_m3: density,
            b_over_a: 0.9,
            c_over_a: 0.8,
        };
        let mut scene = Scene::from_body(Body::PackedEllipsoid(body));
        scene.spin.period_h = period_h;
        scene
    }

    #[test]
    fn the_limit_of_a_sphere_is_where_gravity_and_centrifugal_force_cancel_on_its_equator() {
        // (4/3) pi G rho = omega^2, for water 3.3 h.
        let omega = 2.0 * PI / (3600.0 * shortest_period_h(1000.0));
        assert!((omega * omega / (4.0 / 3.0 * PI * G * 1000.0) - 1.0).abs() < 1e-12);
        assert!((shortest_period_h(1000.0) - 3.3).abs() < 0.01);
    }

    #[test]
    fn usual_scenes_are_not_commented_on() {
        for (density, period_h) in [(2960.0, 5.0), (500.0, 9.0), (8000.0, 1.6), (2000.0, 1900.0)] {
            assert_eq!(oddities(&scene(density, period_h)), Vec::<String>::new());
        }
    }

    #[test]
    fn units_that_are_rarely_meant_are_asked_about() {
        let says = |density, period_h, what: &str| {
            let told = oddities(&scene(density, period_h)).join("\n");
            assert!(told.contains(what), "{told}");
        };
        says(2.7, 100.0, "is 2.7 kg/m3 (g/cm3?");
        says(0.5, 500.0, "g/cm3?");
        says(30_000.0, 6.0, "is 30000 kg/m3 (rock has 500 to 8000)");
        says(2960.0, 21_600.0, "in seconds? 21600 s are 6.000 h");
        says(2960.0, 2.2, "of about 1776 kg/m3, loses material below 2.48 h");
    }
}
