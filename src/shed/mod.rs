//! Where mass goes that a body sheds: orbits around the turning primary with REBOUND, until each shed body falls back,
//! merges with another, escapes or has stayed for the time asked.
//!
//! The primary is a set of mascons that turns uniformly about +z; the shed bodies attract it, each other and it moves in
//! return, but its spin does not change: what angular momentum it takes up is booked. Method: Rein & Spiegel 2015 (MNRAS
//! 446, 1424); setting: Scheeres 2007 (Icarus 189, 370) and section 3.3 of Cotto-Figueroa et al. 2015 (ApJ 803, 25).

mod budget;
mod follow;
mod forces;
mod mascons;
mod multipole;
mod orbit;
mod pair;
mod rebound;
#[cfg(test)]
mod test_bodies;
#[cfg(test)]
mod tests;

pub use budget::{Budget, Share};
pub use follow::follow;
pub use forces::Evaluations;
pub use orbit::Elements;
pub use pair::{PairFate, PairTrack, follow_pair};

use pkd::Spheres;

/// The body that sheds.
#[derive(Debug, Clone)]
pub struct Primary {
    /// Its spheres where they are at time 0; their common velocity and spin do not matter.
    pub spheres: Spheres,
    /// Spin rate about +z, rad/s.
    pub spin_rate: f64,
}

/// A shed body, relative to the primary's centre of mass, inertial axes with +z along the primary's spin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShedBody {
    /// Position, m.
    pub position: [f64; 3],
    /// Velocity, m/s.
    pub velocity: [f64; 3],
    /// Spin, rad/s.
    pub spin: [f64; 3],
    /// Mass, kg.
    pub mass: f64,
    /// Radius, m.
    pub radius: f64,
}

/// How shed bodies are followed.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackOptions {
    /// Longest time, s (default: 365 d).
    pub t_max_s: f64,
    /// Semimajor axis of the heliocentric orbit, au (default: 1): the size of the Hill sphere.
    pub semimajor_axis_au: f64,
    /// Tolerance of IAS15 (default: 1e-9).
    pub ias15_tolerance: f64,
    /// Largest relative error of the primary's attraction where multipoles stand for its mascons (default: 1e-8).
    pub multipole_error: f64,
    /// What the Sun does (default: nothing).
    pub sun: Option<Sun>,
}

impl Default for TrackOptions {
    fn default() -> Self {
        Self {
            t_max_s: 365.0 * 86_400.0,
            semimajor_axis_au: 1.0,
            ias15_tolerance: 1e-9,
            multipole_error: 1e-8,
            sun: None,
        }
    }
}

/// The Sun on a circular orbit; it stands at the equinox at time 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sun {
    /// Obliquity of the primary, rad.
    pub obliquity: f64,
    /// Whether its tide acts.
    pub tide: bool,
    /// C_R of its radiation pressure: 1 for a body that absorbs all light, 13/9 for one that scatters all as Lambert;
    /// `None` for no pressure.
    pub radiation_pressure_coefficient: Option<f64>,
}

/// What became of a shed body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fate {
    /// It fell back onto the primary.
    Reimpact {
        /// When, s.
        t_s: f64,
        /// Its speed relative to the turning surface, m/s.
        speed_m_s: f64,
        /// Its centre at contact in the body frame (the axes at time 0, turning with the primary), m.
        position_m: [f64; 3],
        /// Its velocity relative to the turning surface, body frame, m/s.
        velocity_m_s: [f64; 3],
        /// The sphere of the primary that it met.
        sphere: usize,
    },
    /// It left for good: outwards with positive two-body energy beyond 20 radii of the body and half of its Hill sphere.
    Escape {
        /// When it crossed that distance, s.
        t_s: f64,
        /// Speed at infinity, m/s.
        speed_m_s: f64,
    },
    /// It was still there at the end.
    Bound {
        /// How long it was followed, s.
        t_s: f64,
        /// Means over the time in which its two-body energy was negative; `None` if there was none.
        mean: Option<Elements>,
        /// Share of the time within 3 radii of the body.
        within_3_radii: f64,
    },
    /// It met another shed body and became part of it.
    Merged {
        /// When, s.
        t_s: f64,
        /// Speed at which they met, m/s.
        speed_m_s: f64,
        /// Index of the other one, the heavier of the two, which goes on.
        into: usize,
    },
}

impl Fate {
    /// Name in the database and in JSON.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Reimpact { .. } => "reimpact",
            Self::Escape { .. } => "escape",
            Self::Bound { .. } => "bound",
            Self::Merged { .. } => "merged",
        }
    }
}

/// Fates of all shed bodies.
#[derive(Debug, Clone, PartialEq)]
pub struct Tracks {
    /// One fate a body, in the order given.
    pub fates: Vec<Fate>,
    /// What each takes out of the angular momentum of all the rest about the rest's centre of mass when it is taken off the list,
    /// kg m^2/s: mu r x v and its spin. `None` for merged ones, whose survivor has it.
    pub angular_momentum: Vec<Option<[f64; 3]>>,
    /// Change of each Jacobi constant from start to end over GM / r, r where it started or the primary's radius if that is
    /// larger; `None` if it took part in a merger.
    /// The primary alone keeps it, so that this is the error of the orbit; other shed bodies and the Sun change it truly.
    pub jacobi_drift: Vec<Option<f64>>,
    /// Mass and angular momentum by outcome.
    pub budget: Budget,
    /// Steps of the integrator.
    pub steps: u64,
    /// Steps whose implicit equations REBOUND reports as not converged to the last bit.
    pub unconverged_steps: u64,
    /// Evaluations of the primary's attraction.
    pub evaluations: Evaluations,
    /// Distance beyond which multipoles were used, m.
    pub multipole_switch_radius_m: f64,
}

/// Why shed bodies cannot be followed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ShedError {
    /// A number outside its range.
    #[error("{path} is {value}; allowed: {allowed}")]
    OutOfRange {
        /// What it is.
        path: &'static str,
        /// The value found.
        value: f64,
        /// The range, in words.
        allowed: &'static str,
    },
    /// A value of a shed body that is not usable.
    #[error("shed body {body}: {quantity} is {value}; it must be finite{more}")]
    BadBody {
        /// Index of the body, from 0.
        body: usize,
        /// What is wrong.
        quantity: &'static str,
        /// The value found.
        value: f64,
        /// What else is asked of it.
        more: &'static str,
    },
    /// A shed body that overlaps the primary at the start.
    #[error("shed body {body} is inside the primary: it overlaps sphere {sphere} by {overlap_m} m")]
    InsidePrimary {
        /// Index of the body, from 0.
        body: usize,
        /// The sphere of the primary, from 0.
        sphere: usize,
        /// By how much, m.
        overlap_m: f64,
    },
    /// Two aggregates that overlap at the start.
    #[error("the aggregates overlap by {overlap_m} m at the start")]
    AggregatesOverlap {
        /// By how much, m.
        overlap_m: f64,
    },
    /// A primary that has no mass properties.
    #[error("the primary: {0}")]
    Primary(#[from] pkd::PkdError),
    /// REBOUND refused to start.
    #[error("REBOUND: {message}")]
    Rebound {
        /// What it says.
        message: String,
    },
    /// A value that stopped being finite.
    #[error("shed body {body} has a position that is not finite after {t_s} s")]
    BecameNonFinite {
        /// Index of the body, from 0.
        body: usize,
        /// When, s.
        t_s: f64,
    },
    /// Two aggregates whose energy is not kept however short the steps are.
    #[error(
        "the energy of the two bodies changed by {drift:.1e} of their largest kinetic energy in steps of {step_s:e} s on average; \
         at most {allowed:e} is allowed, and shorter steps did not help"
    )]
    EnergyNotKept {
        /// Change over the largest kinetic energy.
        drift: f64,
        /// What is allowed.
        allowed: f64,
        /// Mean step of the last try, s.
        step_s: f64,
    },
    /// Time stands still.
    #[error("the step of the integrator fell to {dt_s:e} s at {t_s} s; a larger ias15_tolerance may help")]
    StepVanished {
        /// When, s.
        t_s: f64,
        /// The step, s.
        dt_s: f64,
    },
}

impl TrackOptions {
    /// Refuses impossible values.
    ///
    /// # Errors
    /// [`ShedError::OutOfRange`].
    pub fn validate(&self) -> Result<(), ShedError> {
        let require = |ok: bool, path, value, allowed| {
            if ok { Ok(()) } else { Err(ShedError::OutOfRange { path, value, allowed }) }
        };
        let Self { t_max_s: t, semimajor_axis_au: a, ias15_tolerance: eps, multipole_error: error, sun } = self;
        require(*t >= 0.0 && t.is_finite(), "t_max_s", *t, "0 or more s")?;
        require((0.01..=1000.0).contains(a), "semimajor_axis_au", *a, "[0.01, 1000] au")?;
        require((1e-16..=1e-3).contains(eps), "ias15_tolerance", *eps, "[1e-16, 1e-3]")?;
        require((1e-15..=0.1).contains(error), "multipole_error", *error, "[1e-15, 0.1]")?;
        let Some(sun) = sun else { return Ok(()) };
        require((0.0..=std::f64::consts::PI).contains(&sun.obliquity), "obliquity", sun.obliquity, "[0, pi] rad")?;
        let c_r = sun.radiation_pressure_coefficient.unwrap_or(1.0);
        require((0.0..=3.0).contains(&c_r), "radiation_pressure_coefficient", c_r, "[0, 3]")
    }
}
