//! The record of a moving sphere that the event loop works on.

use crate::Spheres;
use nalgebra::Vector3;

/// Trajectory, size and mass of a sphere: one cache line, because events jump from sphere to sphere, in two vectors of four,
/// so that what is written is read back as it was written.
///
/// The position is where the sphere would have been at the start of the step on its present straight line. So a common
/// drift moves all spheres, whenever they last collided, and no record changes but those of colliding spheres.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub(super) struct Ball {
    /// Position at the start of the step, m, and radius, m.
    pub place: [f64; 4],
    /// Velocity, m/s, and mass, kg.
    pub course: [f64; 4],
}

impl Ball {
    /// Fills the last places of rows of neighbours: so far away that nothing reaches it within a step.
    pub const NOWHERE: Self = Self { place: [1e30, 1e30, 1e30, 0.0], course: [0.0, 0.0, 0.0, 1.0] };

    /// A sphere at the start of a step.
    pub fn new(position: [f64; 3], radius: f64, velocity: [f64; 3], mass: f64) -> Self {
        let [x, y, z] = position;
        let [vx, vy, vz] = velocity;
        Self { place: [x, y, z, radius], course: [vx, vy, vz, mass] }
    }

    /// Sphere `i` at the start of a step.
    pub fn of(spheres: &Spheres, i: usize) -> Self {
        Self::new(spheres.position(i), spheres.radius[i], spheres.velocity(i), spheres.mass[i])
    }

    /// Radius, m.
    #[inline(always)]
    pub fn radius(&self) -> f64 {
        self.place[3]
    }

    /// Mass, kg.
    #[inline(always)]
    pub fn mass(&self) -> f64 {
        self.course[3]
    }

    /// Position at the start of the step, m.
    #[inline(always)]
    pub fn origin(&self) -> Vector3<f64> {
        Vector3::new(self.place[0], self.place[1], self.place[2])
    }

    /// Velocity, m/s.
    #[inline(always)]
    pub fn velocity(&self) -> Vector3<f64> {
        Vector3::new(self.course[0], self.course[1], self.course[2])
    }

    /// Position at time `t` (s) of the step, m.
    #[inline(always)]
    pub fn position_at(&self, t: f64) -> Vector3<f64> {
        self.origin() + self.velocity() * t
    }

    /// Puts the sphere somewhere else, `by` from where it is (m).
    pub fn shift(&mut self, by: Vector3<f64>) {
        for k in 0..3 {
            self.place[k] += by[k];
        }
    }

    /// Changes the velocity at time `t` (s), where the sphere is then staying the same.
    #[inline(always)]
    pub fn deflect(&mut self, change: Vector3<f64>, t: f64) {
        for k in 0..3 {
            self.place[k] -= change[k] * t;
            self.course[k] += change[k];
        }
    }
}
