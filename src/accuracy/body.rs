//! The bodies that knobs are measured on: ellipsoids of randomly packed spheres, one of them settled.

use nalgebra::Vector3;
use pkd::Spheres;
use pkd::frame::{set_rigid_rotation, to_principal_axes};
use pkd::hard_sphere::{HardSphere, HardSphereParameters};
use pkd::packing::{EllipsoidPacking, Grain, PACKING_FRACTION, Seed, ellipsoid_packing};

use super::{AccuracyError, Effort};

/// Period at which the body turns, s: body 7 of Cotto-Figueroa et al. (2015), Table 1.
pub(super) const PERIOD_S: f64 = 5.74 * 3600.0;

/// Radius of its spheres, m.
pub(super) const RADIUS_M: f64 = 50.2;

/// What a measurement has at hand.
pub struct Bench<'a> {
    /// How much time it may take.
    pub effort: Effort,
    progress: &'a mut dyn FnMut(&str),
}

impl<'a> Bench<'a> {
    pub(super) fn new(effort: Effort, progress: &'a mut dyn FnMut(&str)) -> Self {
        Self { effort, progress }
    }

    /// Tells how far the measurement is.
    pub fn say(&mut self, line: &str) {
        (self.progress)(line);
    }

    /// A packed body in its principal-axis frame, at rest; another one for each `seed`.
    ///
    /// # Errors
    /// If the spheres cannot be packed.
    pub fn packed_body(&self, seed: u64) -> Result<Spheres, AccuracyError> {
        self.packed_body_of(self.effort.spheres(), seed)
    }

    /// The same of this many spheres.
    ///
    /// # Errors
    /// If the spheres cannot be packed.
    pub fn packed_body_of(&self, count: usize, seed: u64) -> Result<Spheres, AccuracyError> {
        let mut body = ellipsoid_packing(&EllipsoidPacking {
            count,
            grain: Grain { radius: RADIUS_M, density: 2960.0 },
            b_over_a: 0.7,
            c_over_a: 0.7,
            packing_fraction: PACKING_FRACTION,
            seed: Seed { seed, stream: 0 },
        })?;
        to_principal_axes(&mut body)?;
        Ok(body)
    }

    /// A settled body, turning about z, centre of mass at rest in the origin.
    ///
    /// # Errors
    /// If the spheres cannot be packed or their dynamics fail.
    pub fn settled_body(&mut self) -> Result<Spheres, AccuracyError> {
        // Ten rotations bring a thousand spheres to rest; what a small body still does after six is of no matter here.
        let rotations = match self.effort {
            Effort::Quick => 6,
            Effort::Full => 10,
        };
        self.say(&format!("settling a body of {} spheres for {rotations} rotations", self.effort.spheres()));
        let mut body = self.packed_body(7)?;
        set_rigid_rotation(&mut body, Vector3::z() * std::f64::consts::TAU / PERIOD_S)?;
        HardSphere::new(HardSphereParameters::default()).evolve(&mut body, f64::from(rotations) * PERIOD_S)?;
        to_principal_axes(&mut body)?;
        Ok(body)
    }
}
