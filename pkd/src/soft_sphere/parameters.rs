//! Parameters of the soft-sphere method, and the published sets of them.
//!
//! Sources: Schwartz et al. 2012 (Granular Matter 14, 363), Zhang et al. 2017 (Icarus 294, 98), Jiang et al. 2015 (Computers and
//! Geotechnics 65, 147), Zhang et al. 2018 (ApJ 857, 15) for cohesion, Yu et al. 2014 (Icarus 242, 82) for gravel and
//! glass beads. Nothing derived is stored here; [`Stiffness`](super::Stiffness) is what follows from a body.

use crate::PkdError;
use crate::gravity::GravityOptions;

/// Which rule limits the tangential force to mu_S times the normal force.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SlidingCap {
    /// The smaller of the force of spring and dashpot and of the limit along the spring, which goes on stretching
    /// (Zhang et al. 2017, eq. 2).
    Smaller,
    /// A contact that slips loses its spring and keeps its dashpot, up to the limit (pkdgrav with b = 0).
    Drop,
    /// A slipping spring is shortened so that spring and dashpot together are at the limit (Cundall & Strack 1979), and
    /// never beyond what it can hold alone (default).
    #[default]
    Rescale,
}

/// What the tangential restitution means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TangentialDamping {
    /// The dashpot has the form of the normal one (pkdgrav; default). The tangential motion of a contact that sticks
    /// then ends reversed and smaller than the nominal value: -0.251 for 0.5, -0.310 for 0.55.
    #[default]
    Pkdgrav,
    /// The dashpot is such that it ends at minus the nominal value (Schwartz et al. 2012, section 2.6).
    Exact,
}

/// Sliding friction of a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sliding {
    /// Coefficient of static friction mu_S, >= 0 \[1.0\].
    pub coefficient: f64,
    /// Tangential restitution, 0..=1 \[0.55\].
    pub restitution: f64,
    /// What it means \[pkdgrav's way\].
    pub damping: TangentialDamping,
    /// How slipping is limited \[rescaled springs\].
    pub cap: SlidingCap,
}

impl Default for Sliding {
    fn default() -> Self {
        Self { coefficient: 1.0, restitution: 0.55, damping: TangentialDamping::default(), cap: SlidingCap::default() }
    }
}

/// What resists sliding, rolling and twisting in a contact. What is off costs neither time nor memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Friction {
    /// Nothing: spins never change, and contacts have no memory.
    None,
    /// A spring, a dashpot and a slider against sliding.
    Sliding(Sliding),
    /// The same, and springs, dashpots and sliders against rolling and twisting (Zhang et al. 2017, eqs 4-12; Jiang et
    /// al. 2015).
    RollingAndTwisting {
        /// Against sliding.
        sliding: Sliding,
        /// Rolling coefficient mu_R, >= 0.
        rolling: f64,
        /// Twisting coefficient mu_T, >= 0.
        twisting: f64,
    },
    /// The older model: torques of constant size against rolling and twisting, from one contact time after first
    /// touch on (Schwartz et al. 2012, eqs 20-21). It takes rotation away but does not hold a load at rest.
    Directional {
        /// Against sliding.
        sliding: Sliding,
        /// Rolling coefficient mu_r, >= 0.
        rolling: f64,
        /// Twisting coefficient mu_t, >= 0.
        twisting: f64,
    },
}

impl Friction {
    /// Sliding friction, if there is any.
    pub fn sliding(&self) -> Option<&Sliding> {
        match self {
            Self::None => None,
            Self::Sliding(sliding) | Self::RollingAndTwisting { sliding, .. } | Self::Directional { sliding, .. } => {
                Some(sliding)
            }
        }
    }
}

/// How the spheres attract each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Gravity {
    /// Not at all.
    Off,
    /// Evaluated in every step.
    EveryStep,
    /// Evaluated anew when a sphere has moved, against the rigid motion of the body, by this fraction of its radius
    /// (0 < tolerance <= 0.1); in between the field turns with the body. Net force and torque are kept at zero.
    BodyFrame {
        /// The fraction \[0.01\]: an error of the field of 1.5e-3 while a thousand spheres fall together, less at rest.
        tolerance: f64,
    },
}

/// How spheres push, rub and attract each other, and how finely time is cut. The default is the nominal set of Zhang et
/// al. 2017.
#[derive(Debug, Clone, PartialEq)]
pub struct SoftSphereParameters {
    /// Normal restitution, 0..=1 \[0.55\].
    pub restitution: f64,
    /// Friction \[rolling and twisting, mu_S = 1, mu_R = 1.05, mu_T = 1.3\].
    pub friction: Friction,
    /// Shape parameter beta: how wide contacts are, as a fraction of the effective radius, > 0 and <= 1 \[0.5\]. Of use
    /// to rolling, twisting and cohesion.
    pub shape: f64,
    /// Cohesion between spheres c, Pa, >= 0 \[0\]: a contact attracts with c times 4 (beta R_eff)². The cohesion of the bulk
    /// is another, much smaller number.
    pub cohesion_pa: f64,
    /// Normal stiffness k_n, N/m, > 0 \[from the body\].
    pub normal_stiffness_n_m: Option<f64>,
    /// Fastest impact that is to overlap by no more than 1 % of the radius, m/s, > 0 \[the larger of the escape speed of
    /// the largest pair and of twice the fastest motion against the rigid rotation at the start\]. Not looked at when the
    /// stiffness is given.
    pub expected_speed_m_s: Option<f64>,
    /// Steps in the duration of the quickest contact, 10 or more \[30\]. With 30 the restitution comes out 0.4 % too low
    /// at 0.55, with 50 by 0.1 %.
    pub steps_per_contact: f64,
    /// Time step, s, > 0 \[from stiffness and steps per contact\]. Refused where it leaves fewer than ten steps in a
    /// contact.
    pub step_s: Option<f64>,
    /// Overlap, as a fraction of the smaller radius, beyond which a run stops, > 0 and <= 0.5 \[0.01\].
    pub max_overlap: f64,
    /// Gravity \[in the body frame, tolerance 0.01\].
    pub gravity: Gravity,
    /// How an evaluation of gravity is done \[automatic, force error 1e-3\].
    pub gravity_options: GravityOptions,
    /// How far a sphere may move against the rigid motion before the lists of neighbours are made anew, as a fraction
    /// of its radius, > 0 and <= 1 \[0.02\]. Changes the cost, and when within its tolerance gravity is evaluated anew.
    pub skin: f64,
    /// Whether to keep the books of energy \[no\]: some percent of the time, and a potential energy
    /// at the start and end of each call.
    pub ledger: bool,
}

impl Default for SoftSphereParameters {
    fn default() -> Self {
        Self::zhang_2017()
    }
}

impl SoftSphereParameters {
    /// Nominal set of Zhang et al. 2017: mu_S = 1, mu_R = 1.05, mu_T = 1.3, beta = 0.5, restitutions 0.55.
    pub fn zhang_2017() -> Self {
        Self {
            restitution: 0.55,
            friction: Friction::RollingAndTwisting { sliding: Sliding::default(), rolling: 1.05, twisting: 1.3 },
            shape: 0.5,
            cohesion_pa: 0.0,
            normal_stiffness_n_m: None,
            expected_speed_m_s: None,
            steps_per_contact: 30.0,
            step_s: None,
            max_overlap: 0.01,
            gravity: Gravity::BodyFrame { tolerance: 0.01 },
            gravity_options: GravityOptions::default(),
            skin: 0.02,
            ledger: false,
        }
    }

    /// The gravel attributed to Yu et al. 2014, with the older rolling model: mu_S = 1.31, mu_r = 3.0, restitutions 0.55,
    /// no twisting torque. Unverified numbers; they stand for a friction angle of about 40 degrees.
    pub fn gravel() -> Self {
        let sliding = Sliding { coefficient: 1.31, ..Sliding::default() };
        Self { friction: Friction::Directional { sliding, rolling: 3.0, twisting: 0.0 }, ..Self::zhang_2017() }
    }

    /// The glass beads attributed to Yu et al. 2014, with the older rolling model: mu_S = 0.43, mu_r = 0.1, restitution 0.95
    /// along the normal (and here 0.95 across it, where nothing is published), no twisting torque. Unverified numbers;
    /// they stand for a friction angle of about 20 degrees.
    pub fn glass_beads() -> Self {
        let sliding = Sliding { coefficient: 0.43, restitution: 0.95, ..Sliding::default() };
        let friction = Friction::Directional { sliding, rolling: 0.1, twisting: 0.0 };
        Self { restitution: 0.95, friction, ..Self::zhang_2017() }
    }

    /// Perfectly smooth spheres with the restitution of Zhang et al. 2017.
    pub fn frictionless() -> Self {
        Self { friction: Friction::None, ..Self::zhang_2017() }
    }

    /// Checks every value against its range.
    ///
    /// # Errors
    /// [`PkdError::BadParameter`] for the first one outside.
    pub fn validate(&self) -> Result<(), PkdError> {
        let (limit, tiny) = (f64::MAX, f64::MIN_POSITIVE);
        let (positive, unit) = ((tiny, limit, "more than 0"), (0.0, 1.0, "0 to 1"));
        let mut checks = vec![
            ("restitution", self.restitution, unit),
            ("shape", self.shape, (tiny, 1.0, "more than 0, at most 1")),
            ("cohesion_pa", self.cohesion_pa, (0.0, limit, "0 or more")),
            ("steps_per_contact", self.steps_per_contact, (super::FEWEST_STEPS_PER_CONTACT, 1e6, "10 to a million")),
            ("max_overlap", self.max_overlap, (tiny, 0.5, "more than 0, at most 0.5")),
            ("skin", self.skin, (1e-6, 1.0, "1e-6 to 1")),
        ];
        let optional = [
            ("normal_stiffness_n_m", self.normal_stiffness_n_m),
            ("expected_speed_m_s", self.expected_speed_m_s),
            ("step_s", self.step_s),
        ];
        checks.extend(optional.into_iter().filter_map(|(name, value)| Some((name, value?, positive))));
        if let Gravity::BodyFrame { tolerance } = self.gravity {
            checks.push(("gravity.tolerance", tolerance, (1e-9, 0.1, "1e-9 to 0.1")));
        }
        if let Some(sliding) = self.friction.sliding() {
            checks.push(("friction.coefficient", sliding.coefficient, (0.0, limit, "0 or more")));
            checks.push(("friction.restitution", sliding.restitution, unit));
        }
        if let Friction::RollingAndTwisting { rolling, twisting, .. }
        | Friction::Directional { rolling, twisting, .. } = self.friction
        {
            checks.push(("friction.rolling", rolling, (0.0, limit, "0 or more")));
            checks.push(("friction.twisting", twisting, (0.0, limit, "0 or more")));
        }
        for (name, value, (low, high, allowed)) in checks {
            if !(low..=high).contains(&value) {
                return Err(PkdError::BadParameter { name, value, allowed });
            }
        }
        self.gravity_options.validate()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_are_valid_and_each_bad_value_is_named() {
        let good = SoftSphereParameters::default();
        for preset in [
            SoftSphereParameters::gravel(),
            SoftSphereParameters::glass_beads(),
            SoftSphereParameters::frictionless(),
            good.clone(),
        ] {
            preset.validate().unwrap();
        }
        let sliding =
            |coefficient, restitution| Friction::Sliding(Sliding { coefficient, restitution, ..Sliding::default() });
        let rolling = |rolling, twisting| Friction::Directional { sliding: Sliding::default(), rolling, twisting };
        let bad = [
            ("restitution", SoftSphereParameters { restitution: 1.1, ..good.clone() }),
            ("shape", SoftSphereParameters { shape: 0.0, ..good.clone() }),
            ("cohesion_pa", SoftSphereParameters { cohesion_pa: -1.0, ..good.clone() }),
            ("steps_per_contact", SoftSphereParameters { steps_per_contact: 9.0, ..good.clone() }),
            ("max_overlap", SoftSphereParameters { max_overlap: f64::NAN, ..good.clone() }),
            ("skin", SoftSphereParameters { skin: 0.0, ..good.clone() }),
            ("normal_stiffness_n_m", SoftSphereParameters { normal_stiffness_n_m: Some(0.0), ..good.clone() }),
            ("expected_speed_m_s", SoftSphereParameters { expected_speed_m_s: Some(f64::INFINITY), ..good.clone() }),
            ("step_s", SoftSphereParameters { step_s: Some(-1.0), ..good.clone() }),
            (
                "gravity.tolerance",
                SoftSphereParameters { gravity: Gravity::BodyFrame { tolerance: 0.2 }, ..good.clone() },
            ),
            ("friction.coefficient", SoftSphereParameters { friction: sliding(-1.0, 0.5), ..good.clone() }),
            ("friction.restitution", SoftSphereParameters { friction: sliding(1.0, 1.5), ..good.clone() }),
            ("friction.rolling", SoftSphereParameters { friction: rolling(-1.0, 0.0), ..good.clone() }),
            ("friction.twisting", SoftSphereParameters { friction: rolling(0.0, -1.0), ..good }),
        ];
        for (expected, parameters) in bad {
            match parameters.validate() {
                Err(PkdError::BadParameter { name, .. }) => assert_eq!(name, expected),
                other => panic!("{expected}: {other:?}"),
            }
        }
    }
}
