//! Where the frame of the present object lies in the frame of the first one (Object 0 of Cotto-Figueroa et al. 2015).
//!
//! The tiling is kept in the frame of Object 0, in which a sphere that never moved has its original coordinates for ever.
//! Each movement gives one rigid motion of the unmoved spheres; this is their composition. SI units.

use nalgebra::Vector3;
use pkd::rigid_fit::RigidMotion;

use super::movement::Coordinates;

/// Rigid transform from the frame of the present object to that of Object 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orientation {
    /// `X_0 = rotation x + translation`, m.
    to_original: RigidMotion,
}

impl Default for Orientation {
    /// Object 0 itself.
    fn default() -> Self {
        Self { to_original: RigidMotion::identity() }
    }
}

impl Orientation {
    /// From a stored transform `X_0 = rotation x + translation`.
    pub fn from_motion(to_original: RigidMotion) -> Self {
        Self { to_original }
    }

    /// The transform to the frame of Object 0.
    pub fn motion(&self) -> &RigidMotion {
        &self.to_original
    }

    /// Position in the frame of Object 0, m, of a point of the present object.
    pub fn original(&self, point: Vector3<f64>) -> Vector3<f64> {
        self.to_original.apply(point)
    }

    /// Position in the frame of the present object, m, of a point given in the frame of Object 0.
    pub fn present(&self, point: Vector3<f64>) -> Vector3<f64> {
        self.to_original.inverse().apply(point)
    }

    /// The orientation after the frame changed by `motion`: `new = rotation old + translation` for every point that
    /// stayed in place, be it a fit of the unmoved spheres or a change of axes. The product of many rotations is drawn
    /// back to a rotation each time, so that round-off cannot grow into a stretch.
    pub fn followed_by(&self, motion: &RigidMotion) -> Self {
        let mut to_original = self.to_original.after(&motion.inverse());
        let decomposition = to_original.rotation.svd(true, true);
        if let (Some(u), Some(v_t)) = (decomposition.u, decomposition.v_t) {
            to_original.rotation = u * v_t;
        }
        Self { to_original }
    }

    /// Root mean square distance, m, of the spheres that never moved from their places in Object 0: what the fits, each
    /// disturbed by the jitter of the contacts, have added up to. `None` if every sphere has moved.
    ///
    /// # Panics
    /// If the arrays differ in length.
    pub fn drift(&self, present: Coordinates, original: Coordinates, never_moved: &[bool]) -> Option<f64> {
        let at = |of: Coordinates, i: usize| Vector3::new(of[0][i], of[1][i], of[2][i]);
        let (mut sum, mut count) = (0.0, 0_usize);
        for i in (0..never_moved.len()).filter(|&i| never_moved[i]) {
            sum += (self.original(at(present, i)) - at(original, i)).norm_squared();
            count += 1;
        }
        (count > 0).then(|| (sum / count as f64).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evolve::movement::{MovementRule, detect_movement};
    use nalgebra::{Matrix3, Rotation3};

    const RADIUS_M: f64 = 50.2;

    fn body(n: usize) -> [Vec<f64>; 3] {
        [1.3, 2.7, 0.9].map(|a| (0..n).map(|i| 700.0 * (a * i as f64 + 0.2).sin()).collect())
    }

    fn slices(x: &[Vec<f64>; 3]) -> Coordinates<'_> {
        [&x[0], &x[1], &x[2]]
    }

    fn carried(x: &[Vec<f64>; 3], motion: &RigidMotion, jitter_m: f64, seed: f64) -> [Vec<f64>; 3] {
        let mut y = x.clone();
        for i in 0..x[0].len() {
            let p = motion.apply(Vector3::new(x[0][i], x[1][i], x[2][i]));
            for k in 0..3 {
                y[k][i] = p[k] + jitter_m * (12.9 * i as f64 + 78.2 * k as f64 + seed).sin();
            }
        }
        y
    }

    fn turn(k: f64) -> RigidMotion {
        let rotation = Rotation3::from_scaled_axis(Vector3::new(k.sin(), 0.3 * k, (2.0 * k).cos())).into_inner();
        RigidMotion { rotation, translation: Vector3::new(5.0 * k.cos(), -3.0, 100.0 * (3.0 * k).sin()) }
    }

    #[test]
    fn a_hundred_segments_without_movement_leave_the_original_coordinates() {
        let original = body(300);
        let (mut present, mut orientation) = (original.clone(), Orientation::default());
        for k in 0..100 {
            let next = carried(&present, &turn(k as f64), 0.0, 0.0);
            let found = detect_movement(slices(&present), slices(&next), &[RADIUS_M; 300], 0.25, MovementRule::Robust);
            assert_eq!(found.count(), 0);
            orientation = orientation.followed_by(&found.motion);
            present = next;
        }
        let worst = (0..300)
            .map(|i| {
                let p = Vector3::new(present[0][i], present[1][i], present[2][i]);
                (orientation.original(p) - Vector3::new(original[0][i], original[1][i], original[2][i])).norm()
            })
            .fold(0.0, f64::max);
        assert!(worst < 1e-9 * RADIUS_M, "{worst} m");
        let rotation = orientation.motion().rotation;
        assert!((rotation * rotation.transpose() - Matrix3::identity()).amax() < 1e-14);
    }

    #[test]
    fn drift_reports_the_jitter_that_was_put_in() {
        let original = body(300);
        let mut orientation = Orientation::default();
        let mut present = original.clone();
        for k in 0..30 {
            let next = carried(&present, &turn(k as f64), 0.01 * RADIUS_M, k as f64);
            let found = detect_movement(slices(&present), slices(&next), &[RADIUS_M; 300], 0.25, MovementRule::Robust);
            orientation = orientation.followed_by(&found.motion);
            present = next;
        }
        let drift = orientation.drift(slices(&present), slices(&original), &[true; 300]).unwrap();
        // Thirty independent shakes of rms 0.01 R sqrt(3/2) add in squares; none of it is lost or invented.
        assert!((0.02..0.1).contains(&(drift / RADIUS_M)), "{}", drift / RADIUS_M);
        assert_eq!(orientation.drift(slices(&present), slices(&original), &[false; 300]), None);
    }

    #[test]
    fn original_and_present_undo_each_other() {
        let orientation = Orientation::default().followed_by(&turn(0.7)).followed_by(&turn(2.1));
        let p = Vector3::new(10.0, -400.0, 77.0);
        assert!((orientation.present(orientation.original(p)) - p).norm() < 1e-12 * 400.0);
        assert!((orientation.original(turn(2.1).apply(turn(0.7).apply(p))) - p).norm() < 1e-12 * 400.0);
    }
}
