//! Newtonian gravity of a set of spheres by direct summation over pairs.
//!
//! Outside each other, spheres attract like points (Newton's theorem), so nothing is softened. Every pair is visited
//! once and acts on both of its members with opposite forces: momentum is conserved to round-off.
//! SI units. Centres must be distinct; coincident centres give non-finite values, which callers check for.

use crate::Spheres;
use crate::constants::G;

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

/// Direct summation with its scratch memory; holds no state, a new one gives the same bytes.
#[derive(Debug, Default)]
pub struct DirectGravity {}

impl DirectGravity {
    /// Accelerations (m/s²) of spheres at `x`, `y`, `z` (m) with `mass` (kg), written to `out`.
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn accelerations(&mut self, x: &[f64], y: &[f64], z: &[f64], mass: &[f64], out: &mut Accelerations) {
        let n = x.len();
        assert!(y.len() == n && z.len() == n && mass.len() == n, "one entry per sphere in every array");
        for component in [&mut out.x, &mut out.y, &mut out.z] {
            component.clear();
            component.resize(n, 0.0);
        }
        for i in 0..n {
            for j in i + 1..n {
                let (dx, dy, dz) = (x[j] - x[i], y[j] - y[i], z[j] - z[i]);
                let r2 = dx * dx + dy * dy + dz * dz;
                let g = G / (r2 * r2.sqrt());
                let (on_i, on_j) = (g * mass[j], g * mass[i]);
                out.x[i] += on_i * dx;
                out.y[i] += on_i * dy;
                out.z[i] += on_i * dz;
                out.x[j] -= on_j * dx;
                out.y[j] -= on_j * dy;
                out.z[j] -= on_j * dz;
            }
        }
    }

    /// Potential at each centre due to all other spheres, m²/s², negative, written to `out`.
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn potentials(&mut self, x: &[f64], y: &[f64], z: &[f64], mass: &[f64], out: &mut Vec<f64>) {
        let n = x.len();
        assert!(y.len() == n && z.len() == n && mass.len() == n, "one entry per sphere in every array");
        out.clear();
        out.resize(n, 0.0);
        for i in 0..n {
            for j in i + 1..n {
                let (dx, dy, dz) = (x[j] - x[i], y[j] - y[i], z[j] - z[i]);
                let g = G / (dx * dx + dy * dy + dz * dz).sqrt();
                out[i] -= g * mass[j];
                out[j] -= g * mass[i];
            }
        }
    }
}

/// Gravitational potential energy of the spheres' mutual attraction, J, negative; self-energies are left out.
pub fn potential_energy(spheres: &Spheres) -> f64 {
    let mut potential = Vec::new();
    DirectGravity::default().potentials(&spheres.x, &spheres.y, &spheres.z, &spheres.mass, &mut potential);
    0.5 * potential.iter().zip(&spheres.mass).map(|(phi, m)| phi * m).sum::<f64>()
}
