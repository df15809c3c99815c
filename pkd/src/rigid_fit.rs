//! The rigid motion that best superposes one set of labelled points on another, in closed form.
//!
//! Horn 1987, J. Opt. Soc. Am. A 4, 629: the rotation that minimises the summed squared distances is the quaternion
//! of the largest eigenvalue of a symmetric 4 x 4 matrix. It is never a reflection, and unlike a decomposition into
//! singular values it needs no care when two of them are equal. Units: those of the coordinates.

use nalgebra::{Matrix3, Matrix4, Quaternion, UnitQuaternion, Vector3, Vector4};

/// Below this ratio of singular values the points count as lying on a line.
const LINE_RATIO: f64 = 1e-6;

/// A proper rotation followed by a shift: `y = rotation x + translation`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidMotion {
    /// Rotation matrix, determinant +1.
    pub rotation: Matrix3<f64>,
    /// Shift, in the unit of the coordinates.
    pub translation: Vector3<f64>,
}

impl RigidMotion {
    /// The motion that leaves everything in place.
    pub fn identity() -> Self {
        Self { rotation: Matrix3::identity(), translation: Vector3::zeros() }
    }

    /// Where the motion takes a point.
    pub fn apply(&self, point: Vector3<f64>) -> Vector3<f64> {
        self.rotation * point + self.translation
    }

    /// The motion that undoes this one.
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        Self { rotation, translation: -(rotation * self.translation) }
    }

    /// This motion after `first`.
    pub fn after(&self, first: &Self) -> Self {
        Self { rotation: self.rotation * first.rotation, translation: self.apply(first.translation) }
    }

    /// Distance of every `to` point from the moved `from` point, written to `out`; all arrays are `N` long.
    pub fn residuals(&self, from: [&[f64]; 3], to: [&[f64]; 3], out: &mut Vec<f64>) {
        out.clear();
        out.extend((0..from[0].len()).map(|i| (point(to, i) - self.apply(point(from, i))).norm()));
    }
}

/// How much of the motion the points determine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum FitRank {
    /// Rotation and translation.
    Full,
    /// The points lie on a line, or are mirrored so that several rotations fit equally well: the motion is one of many.
    AmbiguousRotation,
    /// One point, or all points coincide: the rotation is the identity by default.
    TranslationOnly,
    /// No point at all, or coordinates that are not finite: the motion is the identity by default.
    Nothing,
}

/// A motion and how far the points determine it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidFit {
    /// The best motion.
    pub motion: RigidMotion,
    /// Whether it is the only best one.
    pub rank: FitRank,
}

/// The rigid motion that takes the `from` points closest to the `to` points, by least squares over the points whose
/// flag in `used` is set.
///
/// # Panics
/// If the arrays differ in length.
pub fn rigid_fit(from: [&[f64]; 3], to: [&[f64]; 3], used: &[bool]) -> RigidFit {
    let n = used.len();
    assert!(from.iter().chain(&to).all(|c| c.len() == n), "one entry per point in every array");
    let chosen = || (0..n).filter(|&i| used[i]);
    let count = chosen().count();
    if count == 0 {
        return RigidFit { motion: RigidMotion::identity(), rank: FitRank::Nothing };
    }
    let mean = |of| chosen().map(|i| point(of, i)).sum::<Vector3<f64>>() / count as f64;
    let (from_mean, to_mean) = (mean(from), mean(to));
    let mut correlation = Matrix3::zeros();
    for i in chosen() {
        correlation += (point(from, i) - from_mean) * (point(to, i) - to_mean).transpose();
    }
    // The eigenvalue iteration need not end on values that are not finite.
    if !correlation.norm().is_finite() {
        return RigidFit { motion: RigidMotion::identity(), rank: FitRank::Nothing };
    }
    let (rotation, rank) = best_rotation(&correlation);
    RigidFit { motion: RigidMotion { rotation, translation: to_mean - rotation * from_mean }, rank }
}

/// The rotation Q that maximises the sum of y · Q x, given the correlation matrix: the sum of x yᵀ.
fn best_rotation(s: &Matrix3<f64>) -> (Matrix3<f64>, FitRank) {
    if s.norm() == 0.0 {
        return (Matrix3::identity(), FitRank::TranslationOnly);
    }
    let curl = Vector3::new(s[(1, 2)] - s[(2, 1)], s[(2, 0)] - s[(0, 2)], s[(0, 1)] - s[(1, 0)]);
    let symmetric = s + s.transpose() - Matrix3::identity() * s.trace();
    let mut quaternion_matrix = Matrix4::zeros();
    quaternion_matrix[(0, 0)] = s.trace();
    quaternion_matrix.fixed_view_mut::<1, 3>(0, 1).copy_from(&curl.transpose());
    quaternion_matrix.fixed_view_mut::<3, 1>(1, 0).copy_from(&curl);
    quaternion_matrix.fixed_view_mut::<3, 3>(1, 1).copy_from(&symmetric);

    let eigen = quaternion_matrix.symmetric_eigen();
    let mut order = [0, 1, 2, 3];
    order.sort_by(|&p, &q| eigen.eigenvalues[q].total_cmp(&eigen.eigenvalues[p]));
    let q: Vector4<f64> = eigen.eigenvectors.column(order[0]).into_owned();
    let rotation = UnitQuaternion::from_quaternion(Quaternion::new(q[0], q[1], q[2], q[3])).to_rotation_matrix();
    // With singular values s1 >= s2 >= s3 of the correlation (s3 signed by its determinant), the two largest
    // eigenvalues are s1 + s2 + s3 and s1 - s2 - s3: their gap is what separates the best rotation from the next.
    let [first, second] = [0, 1].map(|k| eigen.eigenvalues[order[k]]);
    let unique = first - second > LINE_RATIO * (first + second);
    (rotation.into_inner(), if unique { FitRank::Full } else { FitRank::AmbiguousRotation })
}

fn point(of: [&[f64]; 3], i: usize) -> Vector3<f64> {
    Vector3::new(of[0][i], of[1][i], of[2][i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;
    use std::f64::consts::PI;

    fn cloud(n: usize) -> [Vec<f64>; 3] {
        let wave = |a: f64, b: f64| (0..n).map(|i| 500.0 * (a * i as f64 + b).sin()).collect();
        [wave(1.3, 0.2), wave(2.7, 1.1), wave(0.9, 2.5)]
    }

    fn moved(x: &[Vec<f64>; 3], m: &RigidMotion) -> [Vec<f64>; 3] {
        let mut out = [vec![], vec![], vec![]];
        for i in 0..x[0].len() {
            let y = m.apply(point(slices(x), i));
            (0..3).for_each(|k| out[k].push(y[k]));
        }
        out
    }

    fn slices(x: &[Vec<f64>; 3]) -> [&[f64]; 3] {
        [&x[0], &x[1], &x[2]]
    }

    #[test]
    fn known_motions_up_to_half_a_turn_are_recovered() {
        let x = cloud(50);
        for (k, angle) in [0.0, 1e-6, 0.7, 2.0, 3.0, PI].into_iter().enumerate() {
            let axis = Vector3::new(k as f64 - 2.0, 1.0, 0.3 * k as f64);
            let rotation = Rotation3::from_axis_angle(&nalgebra::Unit::new_normalize(axis), angle).into_inner();
            let truth = RigidMotion { rotation, translation: Vector3::new(3.0, -40.0, 1.5) };
            let y = moved(&x, &truth);
            let fit = rigid_fit(slices(&x), slices(&y), &[true; 50]);
            assert_eq!(fit.rank, FitRank::Full);
            assert!((fit.motion.rotation - rotation).amax() < 1e-12, "angle {angle}");
            assert!((fit.motion.translation - truth.translation).amax() < 1e-12 * 500.0, "angle {angle}");
            let mut e = Vec::new();
            fit.motion.residuals(slices(&x), slices(&y), &mut e);
            assert!(e.iter().all(|e| *e < 1e-12 * 500.0));
            let there_and_back = fit.motion.inverse().after(&fit.motion);
            assert!((there_and_back.rotation - Matrix3::identity()).amax() < 1e-14);
            assert!(there_and_back.translation.amax() < 1e-12);
        }
    }

    #[test]
    fn unused_points_do_not_count() {
        let x = cloud(20);
        let truth = RigidMotion { rotation: Matrix3::identity(), translation: Vector3::new(1.0, 2.0, 3.0) };
        let mut y = moved(&x, &truth);
        y[0][7] += 1e6;
        let mut used = [true; 20];
        used[7] = false;
        let fit = rigid_fit(slices(&x), slices(&y), &used);
        assert!((fit.motion.rotation - Matrix3::identity()).amax() < 1e-12);
    }

    #[test]
    fn mirrored_copy_gives_a_proper_rotation_and_large_residuals() {
        let x = cloud(50);
        let mut y = x.clone();
        y[2].iter_mut().for_each(|z| *z = -*z);
        let fit = rigid_fit(slices(&x), slices(&y), &[true; 50]);
        assert!((fit.motion.rotation.determinant() - 1.0).abs() < 1e-12);
        let mut e = Vec::new();
        fit.motion.residuals(slices(&x), slices(&y), &mut e);
        assert!(e.iter().copied().fold(0.0, f64::max) > 100.0);
    }

    #[test]
    fn planar_points_suffice_but_a_line_a_point_and_nothing_are_told_apart() {
        let mut x = cloud(10);
        x[2].fill(0.0);
        let rank = |x: &[Vec<f64>; 3], used: &[bool]| rigid_fit(slices(x), slices(x), used).rank;
        assert_eq!(rank(&x, &[true; 10]), FitRank::Full);
        x[1].fill(4.0);
        assert_eq!(rank(&x, &[true; 10]), FitRank::AmbiguousRotation);
        let mut one = [false; 10];
        one[3] = true;
        assert_eq!(rank(&x, &one), FitRank::TranslationOnly);
        assert_eq!(rank(&x, &[false; 10]), FitRank::Nothing);
        x[0][2] = f64::NAN;
        assert_eq!(rank(&x, &[true; 10]), FitRank::Nothing);
    }
}
