//! Parameters of the hard-sphere method, with the values of Cotto-Figueroa et al. 2015 (ApJ 803, 25, section 2.4) as defaults.

use crate::PkdError;
use crate::gravity::GravityOptions;

/// Which relative speed the slide limit looks at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SlideVelocity {
    /// Speed of the two centres relative to each other, spins ignored: the published rule (default). In a body that
    /// turns in a few hours it hardly ever fires, because touching spheres pass each other at up to `2 R omega`.
    #[default]
    Centre,
    /// Relative speed of the two surfaces at the point of contact, which vanishes in rigid rotation.
    Surface,
}

/// How hard spheres bounce and how finely time is cut.
#[derive(Debug, Clone, PartialEq)]
pub struct HardSphereParameters {
    /// Normal restitution, 0..=1 \[0.2\]. Collisions take energy out of the body unless it is 1.
    pub restitution_normal: f64,
    /// Tangential restitution, -1..=1 \[0.5\]: 1 is perfectly smooth (spins never change, and the cheaper code
    /// without spins runs), 0 sticks, -1 reverses the sliding.
    pub restitution_tangential: f64,
    /// Impacts slower than this fraction of the pair's mutual escape speed at contact lose nothing, >= 0 \[0.01\].
    pub slide_limit: f64,
    /// Which speed is compared with the slide limit \[centres\].
    pub slide_velocity: SlideVelocity,
    /// An impact loses nothing if one of the pair closed less than this fraction of its radius since its previous
    /// collision of the step, >= 0 \[1e-5\]. This is what ends inelastic collapse, and what sets the cost:
    /// a tenth of it doubles the number of collisions, a hundred times it leaves a third.
    pub collapse_limit: f64,
    /// Longest time between two evaluations of gravity, s, > 0 \[50\]. Good values keep the step below
    /// `0.03 / sqrt(G rho)` and the motion of a sphere during it below a tenth of its radius.
    pub step_s: f64,
    /// A sphere that collides more often than this in one step bounces without loss for the rest of it, >= 1
    /// \[10 000\]. Reported when it happens; a hundred times as many stop the run.
    pub max_collisions_per_sphere: u32,
    /// How the attraction of the spheres is summed, if there is any \[auto at 1e-3\].
    pub gravity: Option<GravityOptions>,
}

impl Default for HardSphereParameters {
    fn default() -> Self {
        Self {
            restitution_normal: 0.2,
            restitution_tangential: 0.5,
            slide_limit: 0.01,
            slide_velocity: SlideVelocity::Centre,
            collapse_limit: 1e-5,
            step_s: 50.0,
            max_collisions_per_sphere: 10_000,
            gravity: Some(GravityOptions::default()),
        }
    }
}

impl HardSphereParameters {
    /// Checks every value against its range.
    ///
    /// # Errors
    /// [`PkdError::BadParameter`] for the first one outside.
    pub fn validate(&self) -> Result<(), PkdError> {
        let limit = f64::MAX;
        let checks = [
            ("restitution_normal", self.restitution_normal, 0.0..=1.0, "0 to 1"),
            ("restitution_tangential", self.restitution_tangential, -1.0..=1.0, "-1 to 1"),
            ("slide_limit", self.slide_limit, 0.0..=limit, "0 or more"),
            ("collapse_limit", self.collapse_limit, 0.0..=limit, "0 or more"),
            ("step_s", self.step_s, f64::MIN_POSITIVE..=limit, "more than 0"),
            ("max_collisions_per_sphere", f64::from(self.max_collisions_per_sphere), 1.0..=limit, "1 or more"),
        ];
        for (name, value, range, allowed) in checks {
            if !range.contains(&value) {
                return Err(PkdError::BadParameter { name, value, allowed });
            }
        }
        self.gravity.map_or(Ok(()), |gravity| gravity.validate())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_valid_and_each_bad_value_is_named() {
        let good = HardSphereParameters::default();
        good.validate().unwrap();
        let bad = [
            ("restitution_normal", HardSphereParameters { restitution_normal: 1.1, ..good.clone() }),
            ("restitution_tangential", HardSphereParameters { restitution_tangential: -1.1, ..good.clone() }),
            ("slide_limit", HardSphereParameters { slide_limit: -0.1, ..good.clone() }),
            ("collapse_limit", HardSphereParameters { collapse_limit: f64::NAN, ..good.clone() }),
            ("step_s", HardSphereParameters { step_s: 0.0, ..good.clone() }),
            ("max_collisions_per_sphere", HardSphereParameters { max_collisions_per_sphere: 0, ..good.clone() }),
            (
                "force_error",
                HardSphereParameters {
                    gravity: Some(GravityOptions { force_error: 0.0, ..GravityOptions::default() }),
                    ..good
                },
            ),
        ];
        for (expected, parameters) in bad {
            match parameters.validate() {
                Err(PkdError::BadParameter { name, .. }) => assert_eq!(name, expected),
                other => panic!("{expected}: {other:?}"),
            }
        }
    }
}
