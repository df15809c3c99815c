//! Rubble piles of hard spheres: gravity in leapfrog steps, and between its kicks collisions one by one at their exact times.
//!
//! Source: Richardson et al. 2000 (Icarus 143, 45) and Richardson 1994 (MNRAS 269, 493); parameters of Cotto-Figueroa et al.
//! 2015 (ApJ 803, 25). Spheres never overlap: contacts that rest are a rapid series of tiny bounces, which the limits on
//! sliding and on inelastic collapse keep finite. A step is a pure function of the spheres, so a run that is cut at any
//! step boundary goes on with the same bytes.

mod ball;
mod drift;
mod impact;
mod neighbours;
mod parameters;
mod predict;
mod repair;
mod report;
mod sweep;
mod tournament;

pub use parameters::{HardSphereParameters, SlideVelocity};
pub use repair::{RepairReport, repair_overlaps};
pub use report::{CollisionCounts, Report};

use crate::gravity::{Accelerations, Gravity, balance};
use crate::{PkdError, Spheres};
use drift::Drift;

/// Deepest overlap that is round-off, as a fraction of the smaller radius of the pair. Collisions at their exact times
/// leave about 1e-14; more than this means that a collision was missed, or a start that wants [`repair_overlaps`].
pub const OVERLAP_LIMIT: f64 = 1e-6;

/// The hard-sphere integrator: parameters and scratch memory. Its only state is in the spheres.
///
/// # Examples
/// Two spheres fall onto each other from rest and come to lie on each other:
/// ```
/// use pkd::{Spheres, hard_sphere::{HardSphere, HardSphereParameters}};
/// let mut pair = Spheres::default();
/// pair.push([-60.0, 0.0, 0.0], [0.0; 3], [0.0; 3], 1.5e9, 50.0);
/// pair.push([60.0, 0.0, 0.0], [0.0; 3], [0.0; 3], 1.5e9, 50.0);
/// let report = HardSphere::new(HardSphereParameters::default()).evolve(&mut pair, 18_000.0)?;
/// assert_eq!(report.steps, 360);
/// assert!((pair.x[1] - 50.0).abs() < 0.1 && report.counts.collisions > 10);
/// # Ok::<(), pkd::PkdError>(())
/// ```
#[derive(Debug, Default)]
pub struct HardSphere {
    parameters: HardSphereParameters,
    gravity: Gravity,
    accelerations: Accelerations,
    drift: Drift,
}

impl HardSphere {
    /// An integrator; the parameters are checked when it is used.
    pub fn new(parameters: HardSphereParameters) -> Self {
        let gravity = Gravity::new(parameters.gravity.unwrap_or_default());
        Self { parameters, gravity, ..Self::default() }
    }

    /// The parameters.
    pub fn parameters(&self) -> &HardSphereParameters {
        &self.parameters
    }

    /// One step of [`HardSphereParameters::step_s`].
    ///
    /// # Errors
    /// As [`Self::evolve`].
    pub fn step(&mut self, spheres: &mut Spheres) -> Result<Report, PkdError> {
        self.evolve(spheres, self.parameters.step_s)
    }

    /// Integrates for `duration_s` (s, >= 0) in equal steps, as many as are needed to keep them within
    /// [`HardSphereParameters::step_s`].
    ///
    /// # Errors
    /// - [`PkdError::BadParameter`], [`PkdError::Empty`], [`PkdError::BadValue`] for what was passed in;
    /// - [`PkdError::Overlap`] if a pair overlaps by more than [`OVERLAP_LIMIT`];
    /// - [`PkdError::BecameNonFinite`] if a value stops being finite;
    /// - [`PkdError::CollisionRunaway`] if collisions do not end.
    ///
    /// After an error the spheres are somewhere within a step: of use for a look, not to go on with.
    pub fn evolve(&mut self, spheres: &mut Spheres, duration_s: f64) -> Result<Report, PkdError> {
        self.parameters.validate()?;
        spheres.validate()?;
        if !(duration_s >= 0.0 && duration_s.is_finite()) {
            return Err(PkdError::BadParameter { name: "duration_s", value: duration_s, allowed: "0 or more" });
        }
        // A whole number of steps must not become one more by round-off of the quotient.
        let steps = (duration_s / self.parameters.step_s * (1.0 - 1e-12)).ceil();
        let step = duration_s / steps;
        let mut report = Report::default();
        if steps > 0.0 {
            self.attract(spheres, 0.0)?;
        }
        while (report.steps as f64) < steps {
            let start = report.steps as f64 * step;
            self.kick(spheres, 0.5 * step);
            let (counts, overlap) = self.drift.drift(spheres, &self.parameters, step, start)?;
            self.attract(spheres, start + step)?;
            self.kick(spheres, 0.5 * step);
            finite(spheres, start + step)?;
            report.add(&Report { steps: 1, duration_s: step, counts, max_overlap_over_radius: overlap });
        }
        Ok(report)
    }

    /// Evaluates gravity at the present positions.
    fn attract(&mut self, spheres: &Spheres, time_s: f64) -> Result<(), PkdError> {
        if self.parameters.gravity.is_none() {
            return Ok(());
        }
        let Spheres { x, y, z, mass, .. } = spheres;
        self.gravity.accelerations(x, y, z, mass, &mut self.accelerations);
        if self.gravity.last_error_estimate() > 0.0 {
            // A tree's action equals its reaction, but its torques balance only as far as its error goes: left in, they take
            // 1e-5 to 1e-4 of the angular momentum away in each rotation, always in the same sense.
            balance([x, y, z], mass, &mut self.accelerations);
        }
        let a = &self.accelerations;
        for component in [&a.x, &a.y, &a.z] {
            if let Some(sphere) = component.iter().position(|value| !value.is_finite()) {
                return Err(PkdError::BecameNonFinite { sphere, quantity: "acceleration", time_s });
            }
        }
        Ok(())
    }

    /// Lets the present accelerations act for `duration` (s); solid spheres feel no torque from gravity.
    fn kick(&self, spheres: &mut Spheres, duration: f64) {
        if self.parameters.gravity.is_none() {
            return;
        }
        let a = &self.accelerations;
        for (velocity, acceleration) in [(&mut spheres.vx, &a.x), (&mut spheres.vy, &a.y), (&mut spheres.vz, &a.z)] {
            for (v, a) in velocity.iter_mut().zip(acceleration) {
                *v += a * duration;
            }
        }
    }
}

/// Refuses values that are not finite.
fn finite(spheres: &Spheres, time_s: f64) -> Result<(), PkdError> {
    spheres.validate().map_err(|error| match error {
        PkdError::BadValue { sphere, column, .. } => PkdError::BecameNonFinite { sphere, quantity: column, time_s },
        other => other,
    })
}
