//! The record of a moving sphere that the event loop works on.

use crate::Spheres;
use nalgebra::Vector3;

/// Trajectory, size and mass of a sphere: one cache line, because events jump from sphere to sphere.
///
/// The position is where the sphere would have been at the start of the step on its present straight line. So a common
/// drift moves all spheres, whenever they last collided, and no record changes but those of colliding spheres.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub(super) struct Ball {
    /// Position at the start of the step, m.
    pub position: [f64; 3],
    /// Radius, m.
    pub radius: f64,
    /// Velocity, m/s.
    pub velocity: [f64; 3],
    /// Mass, kg.
    pub mass: f64,
}

impl Ball {
    /// Fills the last places of rows of neighbours: so far away that nothing reaches it within a step.
    pub const NOWHERE: Self = Self { position: [1e30; 3], radius: 0.0, velocity: [0.0; 3], mass: 1.0 };

    /// Sphere `i` at the start of a step.
    pub fn new(spheres: &Spheres, i: usize) -> Self {
        Self {
            position: spheres.position(i),
            radius: spheres.radius[i],
            velocity: spheres.velocity(i),
            mass: spheres.mass[i],
        }
    }

    /// Position at the start of the step, m.
    #[inline]
    pub fn origin(&self) -> Vector3<f64> {
        self.position.into()
    }

    /// Velocity, m/s.
    #[inline]
    pub fn velocity(&self) -> Vector3<f64> {
        self.velocity.into()
    }

    /// Position at time `t` (s) of the step, m.
    #[inline]
    pub fn position_at(&self, t: f64) -> Vector3<f64> {
        self.origin() + self.velocity() * t
    }

    /// Changes the velocity at time `t` (s), where the sphere is then staying the same.
    #[inline]
    pub fn deflect(&mut self, change: Vector3<f64>, t: f64) {
        self.position = (self.origin() - change * t).into();
        self.velocity = (self.velocity() + change).into();
    }
}
