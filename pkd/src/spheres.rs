//! A set of spheres as one array per quantity.
//!
//! SI units, an inertial frame unless a function says otherwise. Index `i` is the same sphere in every array, and
//! keeps being it through a run: identity is what movement detection relies on.

use crate::PkdError;

/// Spheres with velocities and spins; every array is `N` long.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Spheres {
    /// Centre, x coordinate, m.
    pub x: Vec<f64>,
    /// Centre, y coordinate, m.
    pub y: Vec<f64>,
    /// Centre, z coordinate, m.
    pub z: Vec<f64>,
    /// Velocity, x component, m/s.
    pub vx: Vec<f64>,
    /// Velocity, y component, m/s.
    pub vy: Vec<f64>,
    /// Velocity, z component, m/s.
    pub vz: Vec<f64>,
    /// Spin, x component, rad/s.
    pub wx: Vec<f64>,
    /// Spin, y component, rad/s.
    pub wy: Vec<f64>,
    /// Spin, z component, rad/s.
    pub wz: Vec<f64>,
    /// Mass, kg, > 0.
    pub mass: Vec<f64>,
    /// Radius, m, > 0.
    pub radius: Vec<f64>,
}

impl Spheres {
    /// Number of spheres.
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Whether there is no sphere at all.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Appends one sphere: centre (m), velocity (m/s), spin (rad/s), mass (kg), radius (m).
    pub fn push(&mut self, r: [f64; 3], v: [f64; 3], w: [f64; 3], mass: f64, radius: f64) {
        self.x.push(r[0]);
        self.y.push(r[1]);
        self.z.push(r[2]);
        self.vx.push(v[0]);
        self.vy.push(v[1]);
        self.vz.push(v[2]);
        self.wx.push(w[0]);
        self.wy.push(w[1]);
        self.wz.push(w[2]);
        self.mass.push(mass);
        self.radius.push(radius);
    }

    /// Centre of sphere `i`, m.
    pub fn position(&self, i: usize) -> [f64; 3] {
        [self.x[i], self.y[i], self.z[i]]
    }

    /// Velocity of sphere `i`, m/s.
    pub fn velocity(&self, i: usize) -> [f64; 3] {
        [self.vx[i], self.vy[i], self.vz[i]]
    }

    /// Spin of sphere `i`, rad/s.
    pub fn spin(&self, i: usize) -> [f64; 3] {
        [self.wx[i], self.wy[i], self.wz[i]]
    }

    /// Overwrites centre (m), velocity (m/s) and spin (rad/s) of sphere `i`.
    pub fn set(&mut self, i: usize, r: [f64; 3], v: [f64; 3], w: [f64; 3]) {
        [self.x[i], self.y[i], self.z[i]] = r;
        [self.vx[i], self.vy[i], self.vz[i]] = v;
        [self.wx[i], self.wy[i], self.wz[i]] = w;
    }

    /// The arrays of centre coordinates x, y, z, m.
    pub fn coordinates(&self) -> [&[f64]; 3] {
        [&self.x, &self.y, &self.z]
    }

    /// Total mass, kg, summed in index order.
    pub fn total_mass(&self) -> f64 {
        self.mass.iter().sum()
    }

    /// The eleven arrays in the order x y z vx vy vz wx wy wz mass radius.
    pub fn columns(&self) -> [&Vec<f64>; 11] {
        [
            &self.x,
            &self.y,
            &self.z,
            &self.vx,
            &self.vy,
            &self.vz,
            &self.wx,
            &self.wy,
            &self.wz,
            &self.mass,
            &self.radius,
        ]
    }

    /// The same arrays as [`Self::columns`], for writing.
    pub fn columns_mut(&mut self) -> [&mut Vec<f64>; 11] {
        [
            &mut self.x,
            &mut self.y,
            &mut self.z,
            &mut self.vx,
            &mut self.vy,
            &mut self.vz,
            &mut self.wx,
            &mut self.wy,
            &mut self.wz,
            &mut self.mass,
            &mut self.radius,
        ]
    }

    /// A copy that keeps only the spheres whose flag is set; `keep` is `N` long.
    pub fn filtered(&self, keep: &[bool]) -> Self {
        let mut out = Self::default();
        for (target, source) in out.columns_mut().into_iter().zip(self.columns()) {
            target.extend(source.iter().zip(keep).filter(|(_, k)| **k).map(|(v, _)| *v));
        }
        out
    }

    /// Checks that there is a sphere, that all values are finite, and that masses and radii are positive.
    ///
    /// # Errors
    /// The first offending row and column.
    pub fn validate(&self) -> Result<(), PkdError> {
        const NAMES: [&str; 11] = ["x", "y", "z", "vx", "vy", "vz", "wx", "wy", "wz", "mass", "radius"];
        if self.is_empty() {
            return Err(PkdError::Empty);
        }
        for i in 0..self.len() {
            for (column, name) in self.columns().iter().zip(NAMES) {
                let value = column[i];
                let positive = matches!(name, "mass" | "radius");
                if !value.is_finite() || (positive && value <= 0.0) {
                    return Err(PkdError::BadValue { sphere: i, column: name, value });
                }
            }
        }
        Ok(())
    }
}
