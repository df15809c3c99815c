//! The frame that goes along with a body: its origin moves with the centre of mass, its axes turn at a constant rate.
//!
//! It need not follow the body exactly: spheres are compared with it, and when one seems to have moved the frame is
//! fitted to the spheres first. Between fits it costs nothing.

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::lanes::Quad;
use super::record::{FRICTIONLESS, PLACE, VELOCITY, quads, spin};

/// Where the body frame is, as a function of time since it was last fitted.
#[derive(Debug, Clone, Copy)]
pub(super) struct BodyFrame {
    centre: Vector3<f64>,
    velocity: Vector3<f64>,
    turn: Matrix3<f64>,
    omega: Vector3<f64>,
    /// Time since the fit, s.
    time: f64,
}

impl BodyFrame {
    /// A frame at the centre of the `masses`, kg, of the first spheres that turns with their angular momentum, with the
    /// axes `turn`.
    pub fn of(model: u8, records: &[Quad], masses: &[f64], turn: Matrix3<f64>) -> Self {
        let spheres = || records.chunks_exact(quads(model)).zip(masses);
        let mass: f64 = masses.iter().sum();
        let mean = |quad: usize| spheres().map(|(s, m)| s[quad].xyz() * *m).sum::<Vector3<f64>>() / mass;
        let (centre, velocity) = (mean(PLACE), mean(VELOCITY));
        let (mut inertia, mut momentum) = (Matrix3::zeros(), Vector3::zeros());
        for (s, &m) in spheres() {
            let radius = s[PLACE].0[3];
            let (r, v) = (s[PLACE].xyz() - centre, s[VELOCITY].xyz() - velocity);
            let own = 0.4 * m * radius * radius;
            inertia += (Matrix3::identity() * r.norm_squared() - r * r.transpose()) * m + Matrix3::identity() * own;
            momentum += r.cross(&v) * m;
            if model != FRICTIONLESS {
                momentum += spin(s) * own;
            }
        }
        // Out of the range of f64 the frame stands still: any frame is right, only some are useful.
        let omega = inertia.try_inverse().map_or(Vector3::zeros(), |inverse| inverse * momentum);
        let omega = if omega.iter().all(|w| w.is_finite()) { omega } else { Vector3::zeros() };
        Self { centre, velocity, turn, omega, time: 0.0 }
    }

    /// Lets time (s) pass.
    pub fn pass(&mut self, duration: f64) {
        self.time += duration;
    }

    /// Matrix from the body frame to the outside.
    pub fn turn(&self) -> Matrix3<f64> {
        Rotation3::from_scaled_axis(self.omega * self.time) * self.turn
    }

    /// Origin, m.
    pub fn centre(&self) -> Vector3<f64> {
        self.centre + self.velocity * self.time
    }
}

/// Columns of a matrix.
pub(super) fn columns(m: &Matrix3<f64>) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|k| m.column(k).into_owned().into())
}
