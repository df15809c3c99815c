//! Rubble piles of soft spheres: contacts with springs, dashpots and sliders that remember, integrated by a leapfrog.
//!
//! Sources: Schwartz et al. 2012 (Granular Matter 14, 363), Zhang et al. 2017 (Icarus 294, 98), Jiang et al. 2015 (Computers and
//! Geotechnics 65, 147), Zhang et al. 2018 (ApJ 857, 15). Spheres overlap by less than a percent of their radius, which
//! stands for the deformation at the contact; unlike hard spheres they can rest on each other, and friction holds them.
//!
//! The state of a run is in the spheres and in the [`ContactHistory`] of the integrator, and nowhere else. Calls of
//! [`SoftSphere::evolve`] are the joints where a run can be cut: restored there, it goes on with the same bytes.

mod body_frame;
mod coefficients;
mod dispatch;
mod engine;
mod history;
mod kernel;
mod lanes;
mod layout;
mod motion;
mod pairs;
mod parameters;
mod record;
mod report;
mod search;
mod stiffness;

pub use history::{Contact, ContactHistory};
pub use parameters::{Friction, Gravity, Sliding, SlidingCap, SoftSphereParameters, TangentialDamping};
pub use report::{Energy, Ledger, Report};
pub use stiffness::{FEWEST_STEPS_PER_CONTACT, Stiffness, TARGET_OVERLAP};

use nalgebra::Vector3;

use crate::gravity::potential_energy;
use crate::mass_properties::{MassProperties, mass_properties};
use crate::simd::Level;
use crate::{PkdError, Spheres};
use coefficients::Coefficients;
use engine::Engine;

/// The soft-sphere integrator: parameters, the history of the contacts, and scratch memory.
///
/// # Examples
/// Two spheres fall onto each other from rest and come to lie on each other:
/// ```
/// use pkd::{Spheres, soft_sphere::{SoftSphere, SoftSphereParameters}};
/// let mut pair = Spheres::default();
/// pair.push([-60.0, 0.0, 0.0], [0.0; 3], [0.0; 3], 1.5e9, 50.0);
/// pair.push([60.0, 0.0, 0.0], [0.0; 3], [0.0; 3], 1.5e9, 50.0);
/// let report = SoftSphere::new(SoftSphereParameters::default()).evolve(&mut pair, 18_000.0)?;
/// assert!((pair.x[1] - 50.0).abs() < 0.1 && report.contacts == 1);
/// # Ok::<(), pkd::PkdError>(())
/// ```
#[derive(Debug, Default)]
pub struct SoftSphere {
    parameters: SoftSphereParameters,
    history: ContactHistory,
    gravity: crate::gravity::Gravity,
}

/// Forces and torques of contacts; index = sphere.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ContactForces {
    /// Forces, N.
    pub force_n: Vec<[f64; 3]>,
    /// Torques about the centres, N m; zero without friction.
    pub torque_n_m: Vec<[f64; 3]>,
}

impl SoftSphere {
    /// An integrator whose contacts remember nothing; the parameters are checked when it is used.
    pub fn new(parameters: SoftSphereParameters) -> Self {
        let gravity = crate::gravity::Gravity::new(parameters.gravity_options);
        Self { parameters, history: ContactHistory::default(), gravity }
    }

    /// The parameters.
    pub fn parameters(&self) -> &SoftSphereParameters {
        &self.parameters
    }

    /// What the contacts remember: to be stored with the spheres.
    pub fn history(&self) -> &ContactHistory {
        &self.history
    }

    /// The same for changes of frame or number that the spheres go through between calls.
    pub fn history_mut(&mut self) -> &mut ContactHistory {
        &mut self.history
    }

    /// Takes what the contacts remember out of the integrator, which is left without.
    pub fn take_history(&mut self) -> ContactHistory {
        std::mem::take(&mut self.history)
    }

    /// Goes on with this history: that of a stored run, or an empty one for another body.
    pub fn set_history(&mut self, history: ContactHistory) {
        self.history = history;
    }

    /// Stiffness and step that [`Self::evolve`] is going to use for these spheres.
    ///
    /// # Errors
    /// As [`Stiffness::of`].
    pub fn stiffness(&self, spheres: &Spheres) -> Result<Stiffness, PkdError> {
        Stiffness::of(&self.parameters, spheres)
    }

    /// Integrates for `duration_s` (s, >= 0) in equal steps, as many as are needed to keep them within
    /// [`Stiffness::step_s`].
    ///
    /// The stiffness is that for the spheres at the start, unless the parameters give one; a run in several calls
    /// takes it from the first and gives it to the others, or its springs change strength between them.
    /// Runs on the threads of the current `rayon` pool; the bytes do not depend on their number.
    ///
    /// # Errors
    /// - [`PkdError::BadParameter`], [`PkdError::Empty`], [`PkdError::BadValue`], [`PkdError::BadContact`],
    ///   [`PkdError::Coincident`], [`PkdError::StepTooLarge`] for what was passed in;
    /// - [`PkdError::TooSoft`] if a pair overlaps by more than [`SoftSphereParameters::max_overlap`];
    /// - [`PkdError::BecameNonFinite`], [`PkdError::NotFinite`] if a value stops being finite.
    ///
    /// After an error spheres and history are what they were.
    pub fn evolve(&mut self, spheres: &mut Spheres, duration_s: f64) -> Result<Report, PkdError> {
        self.evolve_while(spheres, duration_s, &mut || true)
    }

    /// As [`Self::evolve`], and asks before each step whether to `go_on`.
    ///
    /// # Errors
    /// As [`Self::evolve`], and [`PkdError::Stopped`] if the answer was no.
    pub fn evolve_while(
        &mut self,
        spheres: &mut Spheres,
        duration_s: f64,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Report, PkdError> {
        self.evolve_on(Level::in_use(), spheres, duration_s, go_on)
    }

    /// What the contacts do to each sphere at this moment: forces (N) and torques about its centre (N m), without gravity.
    ///
    /// # Errors
    /// As [`Self::evolve`].
    pub fn contact_forces(&mut self, spheres: &Spheres) -> Result<ContactForces, PkdError> {
        let stiffness = self.stiffness(spheres)?;
        self.history.fits(spheres.len())?;
        let parameters = SoftSphereParameters { gravity: Gravity::Off, ..self.parameters.clone() };
        let law = Coefficients::new(&parameters, stiffness.normal_n_m, stiffness.step_s);
        let (level, gravity) = (Level::in_use(), &mut self.gravity);
        let mut engine = Engine::new(level, gravity, &parameters, law, spheres, &self.history)?;
        let (force_n, torque_n_m) = engine.contact_forces();
        Ok(ContactForces { force_n, torque_n_m })
    }

    fn evolve_on(
        &mut self,
        level: Level,
        spheres: &mut Spheres,
        duration_s: f64,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Report, PkdError> {
        let stiffness = self.stiffness(spheres)?;
        if !(duration_s >= 0.0 && duration_s.is_finite()) {
            return Err(PkdError::BadParameter { name: "duration_s", value: duration_s, allowed: "0 or more" });
        }
        self.history.fits(spheres.len())?;
        // A whole number of steps must not become one more by round-off of the quotient.
        let steps = (duration_s / stiffness.step_s * (1.0 - 1e-12)).ceil();
        let step_s = if steps > 0.0 { duration_s / steps } else { stiffness.step_s };
        let law = Coefficients::new(&self.parameters, stiffness.normal_n_m, step_s);

        let before = mass_properties(spheres)?;
        let mut start = self.parameters.ledger.then(|| self.energy(spheres, &before));
        let mut engine = Engine::new(level, &mut self.gravity, &self.parameters, law, spheres, &self.history)?;
        if let Some(start) = &mut start {
            start.add_springs(&engine.springs().1);
        }
        engine.run(steps as u64, step_s, go_on)?;
        engine.finite()?;
        engine.judge_field()?;
        let history = engine.finish(spheres);
        let (contacts, springs) = engine.springs();
        let (deepest, heat, work, bytes) = (engine.deepest(), engine.heat(), engine.work, engine.bytes());
        self.history = history;

        let after = mass_properties(spheres)?;
        let (momentum, angular_momentum) = scales(spheres, &after);
        let ledger = start.map(|start| {
            let mut end = self.energy(spheres, &after);
            end.add_springs(&springs);
            Ledger::new(start, end, &heat)
        });
        let over = |change: f64, scale: f64| if scale > 0.0 { change / scale } else { 0.0 };
        Ok(Report {
            steps: steps as u64,
            duration_s,
            step_s,
            stiffness,
            contacts,
            contacts_per_sphere: 2.0 * contacts as f64 / spheres.len() as f64,
            max_overlap_over_radius: deepest,
            momentum_drift: over(after.mass * (after.velocity - before.velocity).norm(), momentum),
            angular_momentum_drift: over((after.angular_momentum - before.angular_momentum).norm(), angular_momentum),
            gravity_evaluations: work.gravity_evaluations,
            frozen_field_error: work.frozen_field_error,
            list_rebuilds: work.list_rebuilds,
            bytes: bytes as u64,
            ledger,
        })
    }

    /// Energy without that of springs.
    fn energy(&self, spheres: &Spheres, properties: &MassProperties) -> Energy {
        let gravity_j = if self.parameters.gravity == Gravity::Off { 0.0 } else { potential_energy(spheres) };
        Energy { kinetic_j: properties.kinetic_energy, gravity_j, ..Energy::default() }
    }
}

/// Sums of m |v| and of the sizes of the spheres' shares in the angular momentum about the centre of mass.
fn scales(spheres: &Spheres, properties: &MassProperties) -> (f64, f64) {
    (0..spheres.len()).fold((0.0, 0.0), |(p, l), i| {
        let (m, radius) = (spheres.mass[i], spheres.radius[i]);
        let (r, v) = (Vector3::from(spheres.position(i)), Vector3::from(spheres.velocity(i)));
        let orbital = (r - properties.centre).cross(&(v - properties.velocity)) * m;
        let own = Vector3::from(spheres.spin(i)) * (0.4 * m * radius * radius);
        (p + m * v.norm(), l + orbital.norm() + own.norm())
    })
}
