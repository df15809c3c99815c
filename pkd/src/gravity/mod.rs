//! Newtonian gravity of a set of spheres: every pair, or a tree with expansions where that is faster.
//!
//! Outside each other, spheres attract like points (Newton's theorem), so nothing is softened. SI units. Centres must be
//! distinct; coincident centres give non-finite values, which callers check for.

mod balance;
mod choice;
mod direct;
mod dispatch;
mod far;
mod field;
mod harmonic;
mod kernel;
mod lanes;
mod near;
mod sample;
mod tree;
mod tree_gravity;
mod walk;

pub(crate) use balance::{angular_acceleration, balance};
pub use choice::{Gravity, GravityMethod, GravityOptions};
pub use direct::DirectGravity;
pub use tree_gravity::TreeGravity;

use crate::Spheres;

/// Accelerations, m/s², one array per component, each `N` long.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Accelerations {
    /// x component, m/s².
    pub x: Vec<f64>,
    /// y component, m/s².
    pub y: Vec<f64>,
    /// z component, m/s².
    pub z: Vec<f64>,
}

impl Accelerations {
    /// Size of the total force over the sum of the sizes of the forces: round-off where action equals reaction.
    ///
    /// # Panics
    /// If `mass` (kg) differs in length.
    pub fn net_force(&self, mass: &[f64]) -> f64 {
        assert_eq!(mass.len(), self.x.len(), "one mass per acceleration");
        let (mut total, mut sizes) = ([0.0; 3], 0.0);
        for (i, m) in mass.iter().enumerate() {
            let force = [self.x[i], self.y[i], self.z[i]].map(|a| a * m);
            (0..3).for_each(|k| total[k] += force[k]);
            sizes += length(force);
        }
        if sizes > 0.0 { length(total) / sizes } else { 0.0 }
    }
}

fn length([x, y, z]: [f64; 3]) -> f64 {
    (x * x + y * y + z * z).sqrt()
}

/// Gravitational potential energy of the spheres' mutual attraction, J, negative; self-energies are left out.
///
/// The direct sum for small bodies; for large ones a tree that leaves an error of the order of 1e-9 of it.
pub fn potential_energy(spheres: &Spheres) -> f64 {
    let mut potential = Vec::new();
    let mut gravity = Gravity::new(GravityOptions::PRECISE);
    gravity.potentials(&spheres.x, &spheres.y, &spheres.z, &spheres.mass, &mut potential);
    0.5 * potential.iter().zip(&spheres.mass).map(|(phi, m)| phi * m).sum::<f64>()
}
