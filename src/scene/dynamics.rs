//! How the spheres of a scene move: spin, contacts, gravity, settling, what becomes of shed spheres.
//!
//! Defaults are those of Cotto-Figueroa et al. (2015), section 2.6, unless a line says otherwise.

use serde::{Deserialize, Serialize};

use super::soft_sphere::SoftSphereContact;
use crate::shed::TrackOptions;

/// Spin state at the beginning; the body turns about its axis of largest moment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Spin {
    /// Rotation period, h (default 6, a common value for bodies of a kilometre).
    pub period_h: f64,
    /// Angle between spin vector and orbit normal, deg, 0 to 180 (default 5, Table 3).
    pub obliquity_deg: f64,
}

impl Default for Spin {
    fn default() -> Self {
        Self { period_h: 6.0, obliquity_deg: 5.0 }
    }
}

impl Spin {
    /// Spin rate, rad/s.
    pub fn rate_rad_s(&self) -> f64 {
        std::f64::consts::TAU / (self.period_h * 3600.0)
    }

    /// Obliquity, rad.
    pub fn obliquity_rad(&self) -> f64 {
        self.obliquity_deg.to_radians()
    }
}

/// The contact model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Contact {
    /// Impulses between hard spheres (Richardson et al. 2011, Icarus 212, 427).
    HardSphere(HardSphereContact),
    /// Springs, dashpots and sliders between spheres that overlap a little.
    SoftSphere(SoftSphereContact),
}

impl Default for Contact {
    fn default() -> Self {
        Self::HardSphere(HardSphereContact::default())
    }
}

/// Hard spheres: restitution and the two limits that end bouncing (Richardson 1994, MNRAS 269, 493).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct HardSphereContact {
    /// Normal restitution: 1 is elastic, 0 takes all normal speed (default 0.2).
    pub restitution_normal: f64,
    /// Tangential restitution: 1 is frictionless (spheres then carry no spin), 0 sticks, -1 reverses (default 0.5).
    pub restitution_tangential: f64,
    /// Impacts slower than this fraction of the pair's escape speed lose nothing (default 0.01).
    pub slide_limit: f64,
    /// Which speed the slide limit looks at (default centre, as in pkdgrav).
    pub slide_velocity: SlideVelocity,
    /// A sphere that moved less than this fraction of its radius since its last impact loses nothing (default 1e-5);
    /// smaller is dearer (1e-6 about doubles the cost).
    pub collapse_limit: f64,
    /// Time step of gravity, s (default 50); a fifth of it about doubles the cost. Gravity wants at most
    /// 0.03/sqrt(G rho), rho the density of the spheres.
    pub step_s: f64,
    /// Impacts of one sphere within a step after which it loses nothing more; counted when it happens (default 10000).
    pub max_collisions_per_sphere: u32,
}

impl Default for HardSphereContact {
    fn default() -> Self {
        Self {
            restitution_normal: 0.2,
            restitution_tangential: 0.5,
            slide_limit: 0.01,
            slide_velocity: SlideVelocity::Centre,
            collapse_limit: 1e-5,
            step_s: 50.0,
            max_collisions_per_sphere: 10_000,
        }
    }
}

/// The speed that the slide limit is compared with.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SlideVelocity {
    /// Of the centres, spins ignored.
    #[default]
    Centre,
    /// Of the surfaces at the point of contact.
    Surface,
}

/// How gravity is summed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct GravityOptions {
    /// The method (default auto).
    pub method: GravityMethod,
    /// Relative error of the force that an approximate method may make (default 1e-3); the direct sum makes none.
    pub force_error: f64,
}

impl Default for GravityOptions {
    fn default() -> Self {
        Self { method: GravityMethod::Auto, force_error: 1e-3 }
    }
}

/// Method of summing gravity.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GravityMethod {
    /// The fastest method that keeps `force_error`.
    #[default]
    Auto,
    /// Every pair, exact to round-off.
    Direct,
    /// A tree with expansions, whatever the size.
    Tree,
}

/// When a body counts as settled.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Settling {
    /// Rotations in a block; a block without movement ends the settling (default 5, "several" in section 2.4).
    pub rotations: u32,
    /// Rotations after which settling ends in any case and says so (default 50).
    pub max_rotations: u32,
    /// How long the aggregate is watched after a small change of its spin (default brief).
    pub question: Question,
    /// What becomes of rotation that is not about the axis of largest moment once the body has come to rest (default align).
    pub residual_rotation: ResidualRotation,
    /// Whether the settled body may be quite another than the one that was made: an axis ratio changed by more than 0.15, or
    /// the period by more than a quarter (default false: such a body is refused).
    pub allow_reshaping: bool,
}

/// Rotation that is left over when a body has settled or a movement has ended.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ResidualRotation {
    /// It dissipates, as in the long time between two movements: the same angular momentum, about the axis of largest moment.
    #[default]
    Align,
    /// It stays as the spheres have it, although torques are those of a body that turns about its axis of largest moment.
    Keep,
}

impl Default for Settling {
    fn default() -> Self {
        Self {
            rotations: 5,
            max_rotations: 50,
            question: Question::default(),
            residual_rotation: ResidualRotation::default(),
            allow_reshaping: false,
        }
    }
}

/// How a leg asks the aggregate whether it bears its new spin.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Question {
    /// As Cotto-Figueroa et al. (2015), section 2.4: blocks of `settling.rotations`, whatever they show.
    Full,
    /// A look as long as the load that the spin adds is large.
    Brief(BriefQuestion),
}

impl Default for Question {
    fn default() -> Self {
        Self::Brief(BriefQuestion::default())
    }
}

/// How long a look is and when it is enough, see [`crate::evolve::check`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct BriefQuestion {
    /// Rotations that a look lasts for each unit of load, which is the change of the spin rate squared over its value at
    /// the limit of a sphere, 4 pi G rho / 3 (default 500: 1 at half that rate for a change of 0.4 %).
    pub rotations_per_load: f64,
    /// Rotations of the shortest look (default 0.1).
    pub glance_rotations: f64,
    /// Rotations of the longest look, and of the blocks in which a movement is followed (default 1).
    pub block_rotations: f64,
    /// The body is at rest while no sphere has shifted by more than this fraction of what counts as a movement, in a
    /// block or in all looks since it was last found at rest (default 0.5; rattling of loose spheres reaches 0.3).
    pub rest_fraction: f64,
}

impl Default for BriefQuestion {
    fn default() -> Self {
        Self { rotations_per_load: 500.0, glance_rotations: 0.1, block_rotations: 1.0, rest_fraction: 0.5 }
    }
}

/// What becomes of spheres that left the body.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Shed {
    /// How they are followed (default none).
    pub track: Track,
}

/// How shed spheres are followed.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Track {
    /// Removed with their mass, momentum and angular momentum, and recorded.
    #[default]
    None,
    /// Followed with REBOUND around the body they left; what became of them is recorded.
    Rebound(Rebound),
}

/// Orbits of shed spheres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Rebound {
    /// Followed for at most this long, days (default 365).
    pub t_max_days: f64,
    /// Tolerance of the integrator IAS15 (default 1e-9).
    pub ias15_tolerance: f64,
    /// Largest relative error of the body's attraction where multipoles stand for its spheres (default 1e-8).
    pub multipole_error: f64,
    /// Whether the Sun's tide acts (default false).
    pub solar_tide: bool,
    /// C_R of sunlight's pressure: 1 for black spheres, 13/9 for white Lambert spheres, 0 for none (default 0).
    pub radiation_pressure: f64,
    /// Whether a sphere that falls back returns to the body where it struck it (default false: it is gone from the run).
    pub return_reimpacts: bool,
}

impl Default for Rebound {
    fn default() -> Self {
        let TrackOptions { t_max_s, ias15_tolerance, multipole_error, .. } = TrackOptions::default();
        Self {
            t_max_days: t_max_s / 86_400.0,
            ias15_tolerance,
            multipole_error,
            solar_tide: false,
            radiation_pressure: 0.0,
            return_reimpacts: false,
        }
    }
}
