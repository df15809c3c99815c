//! What settling will cost, told before it is spent.

use pkd::Spheres;
use pkd::packing::Grain;
use pkd::soft_sphere::Stiffness;

use super::{Body, Contact, Scene};

/// CPU time of a step of n hard spheres, s, is this times n^1.5: the impacts within a step, and the rounds that they take,
/// grow with the depth of the pile. Measured with `yorp relax` on resting piles of 30 to 3000 spheres: within 15 %.
const HARD_STEP_S: f64 = 1.8e-7;
/// CPU time of a step of n soft spheres, s, over n; likewise.
const SOFT_STEP_S: f64 = 9e-8;

/// CPU time above which the user is told when a run starts, s.
const TOLD_S: f64 = 300.0;
/// CPU time above which a first block is long, s.
const LONG_S: f64 = 3600.0;

/// An estimate of the CPU time that settling takes.
#[derive(Debug, Clone, PartialEq)]
pub struct SettlingCost {
    /// Of the first block of rotations, s: no body settles in less.
    pub first_s: f64,
    /// Of all rotations that the scene allows, s.
    pub most_s: f64,
    /// What is reckoned with.
    of: String,
}

impl SettlingCost {
    /// The cost for this number of spheres that rotate with `period_s` and are followed in steps of `step_s`.
    pub fn new(scene: &Scene, spheres: usize, period_s: f64, step_s: f64) -> Self {
        let n = spheres as f64;
        let a_step = match scene.contact {
            Contact::HardSphere(_) => HARD_STEP_S * n.powf(1.5),
            Contact::SoftSphere(_) => SOFT_STEP_S * n,
        };
        let (rotations, most) = (scene.settling.rotations, scene.settling.max_rotations);
        let a_rotation = a_step * (period_s / step_s).ceil();
        Self {
            first_s: f64::from(rotations.min(most)) * a_rotation,
            most_s: f64::from(most) * a_rotation,
            of: format!("{rotations} to {most} rotations of {:.4} h in steps of {step_s:.3} s", period_s / 3600.0),
        }
    }

    /// The cost for the body of `scene`, as far as that is known without making it.
    pub fn of_scene(scene: &Scene) -> Option<Self> {
        let Body::PackedEllipsoid(body) = &scene.body else { return None };
        let step_s = match &scene.contact {
            Contact::HardSphere(contact) => contact.step_s,
            // Of two of its spheres that fall onto each other: nothing else asks for stiffer contacts in bodies below 10^5.
            Contact::SoftSphere(contact) => {
                let pair = touching_pair(body.radius_m, body.grain_density_kg_m3);
                Stiffness::of(&contact.to_pkd(&scene.gravity), &pair).ok()?.step_s
            }
        };
        Some(Self::new(scene, body.spheres as usize, 3600.0 * scene.spin.period_h, step_s))
    }

    /// What to tell when a run starts, if it is worth telling.
    pub fn warning(&self) -> Option<String> {
        let advice = "; longer steps, fewer settling.rotations or a shorter spin.period_h cost less";
        (self.most_s > TOLD_S)
            .then(|| format!("settling takes {self}{}", if self.first_s > LONG_S { advice } else { "" }))
    }
}

impl std::fmt::Display for SettlingCost {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [first, most] = [self.first_s, self.most_s].map(in_words);
        write!(f, "about {first} to {most} of one processor ({})", self.of)
    }
}

/// Two equal spheres in contact, at rest.
pub fn touching_pair(radius_m: f64, density_kg_m3: f64) -> Spheres {
    let mass = Grain { radius: radius_m, density: density_kg_m3 }.mass();
    let mut pair = Spheres::default();
    for side in [-1.0, 1.0] {
        pair.push([side * radius_m, 0.0, 0.0], [0.0; 3], [0.0; 3], mass, radius_m);
    }
    pair
}

/// `40 s`, `7 min`, `3.5 h`, `12 days`.
fn in_words(seconds: f64) -> String {
    let (minutes, hours, days) = (seconds / 60.0, seconds / 3600.0, seconds / 86_400.0);
    if seconds < 1.0 {
        "1 s".to_owned()
    } else if seconds < 90.0 {
        format!("{seconds:.0} s")
    } else if minutes < 90.0 {
        format!("{minutes:.0} min")
    } else if hours < 48.0 {
        format!("{hours:.1} h")
    } else {
        format!("{days:.0} days")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{PackedEllipsoid, SoftSphereContact};

    fn scene(spheres: u32, period_h: f64) -> Scene {
        let body =
            PackedEllipsoid { spheres, radius_m: 50.0, grain_density_kg_m3: 2960.0, b_over_a: 0.9, c_over_a: 0.8 };
        let mut scene = Scene::from_body(Body::PackedEllipsoid(body));
        scene.spin.period_h = period_h;
        scene
    }

    #[test]
    fn the_cost_goes_with_rotations_period_and_steps() {
        let cost = |scene: &Scene| SettlingCost::of_scene(scene).unwrap();
        let usual = cost(&scene(1000, 6.0));
        // 5 rotations of 432 steps of 50 s, 5.7e-6 s a sphere and step.
        assert!((usual.first_s / (5.0 * 432.0 * 1000.0 * 5.69e-6) - 1.0).abs() < 0.01, "{usual}");
        assert_eq!((usual.most_s / usual.first_s).round(), 10.0);
        assert!((cost(&scene(1000, 600.0)).first_s / usual.first_s - 100.0).abs() < 1e-9);
        assert_eq!(usual.warning(), None);

        let mut soft = scene(1000, 6.0);
        soft.contact = Contact::SoftSphere(SoftSphereContact::default());
        let soft = cost(&soft);
        assert!((soft.first_s / (5.0 * 21_600.0 / 0.5755 * 1000.0 * 9e-8) - 1.0).abs() < 0.01, "{soft}");
    }

    #[test]
    fn what_takes_long_is_told_in_hours() {
        let slow = SettlingCost::of_scene(&scene(1000, 10_000.0)).unwrap().warning().unwrap();
        assert!(slow.starts_with("settling takes about 5.7 h to 2 days of one processor (5 to 50 rotations"), "{slow}");
        assert!(slow.contains("settling.rotations or a shorter spin.period_h cost less"), "{slow}");
        assert_eq!([0.1, 41.0, 400.0, 9000.0, 1e6].map(in_words), ["1 s", "41 s", "7 min", "2.5 h", "12 days"]);
    }
}
