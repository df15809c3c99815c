//! Best rigid superposition of two sets of labelled points by Levenberg-Marquardt, started from the closed form.
//!
//! The paper minimises over three Euler angles and three displacements (its LMDIF); here the three angles are a rotation
//! vector about the closed-form solution, so that there is no gimbal and the minimum lies at the origin.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::storage::Owned;
use nalgebra::{DVector, Dyn, Matrix3, OMatrix, Rotation3, U3, U6, Vector3, Vector6};
use pkd::rigid_fit::{FitRank, RigidMotion, rigid_fit};

use super::Coordinates;

/// The motion that takes the `before` points whose flag in `used` is set closest to the `after` points, and whether the
/// points determine it (three or more, not on a line).
///
/// # Panics
/// If the arrays differ in length.
pub fn superposition(before: Coordinates, after: Coordinates, used: &[bool]) -> (RigidMotion, bool) {
    let closed = rigid_fit(before, after, used);
    if closed.rank != FitRank::Full {
        return (closed.motion, false);
    }
    (refine(before, after, used, &closed.motion), true)
}

/// Levenberg-Marquardt from a start value; the start where the fit finds nothing better.
pub(super) fn refine(before: Coordinates, after: Coordinates, used: &[bool], start: &RigidMotion) -> RigidMotion {
    let problem = Superposition::new(before, after, used, start);
    let (solved, report) = LevenbergMarquardt::new().minimize(problem);
    if report.objective_function.is_finite() { solved.motion(start) } else { *start }
}

/// Least-squares problem: six parameters, three residuals a point.
struct Superposition {
    /// Points turned by the start rotation, relative to their mean, m.
    arms: Vec<Vector3<f64>>,
    /// What is left at the start: start motion minus target, m.
    offsets: Vec<Vector3<f64>>,
    /// Mean of the turned points, m.
    mean: Vector3<f64>,
    /// Root mean square arm, m: the unit of the rotation parameters, so that all six are lengths of one size.
    size: f64,
    parameters: Vector6<f64>,
    turn: Rotation3<f64>,
}

impl Superposition {
    fn new(before: Coordinates, after: Coordinates, used: &[bool], start: &RigidMotion) -> Self {
        let at = |of: Coordinates, i: usize| Vector3::new(of[0][i], of[1][i], of[2][i]);
        let chosen = || (0..used.len()).filter(|&i| used[i]);
        let mut arms: Vec<_> = chosen().map(|i| start.rotation * at(before, i)).collect();
        let offsets = chosen().zip(&arms).map(|(i, arm)| arm + start.translation - at(after, i)).collect();
        let mean = arms.iter().sum::<Vector3<f64>>() / arms.len() as f64;
        arms.iter_mut().for_each(|arm| *arm -= mean);
        let size = (arms.iter().map(Vector3::norm_squared).sum::<f64>() / arms.len() as f64).sqrt();
        Self { arms, offsets, mean, size, parameters: Vector6::zeros(), turn: Rotation3::identity() }
    }

    fn shift(&self) -> Vector3<f64> {
        self.parameters.fixed_rows::<3>(3).into_owned()
    }

    /// The whole motion: the start, then the turn about the mean, then the shift.
    fn motion(&self, start: &RigidMotion) -> RigidMotion {
        let rotation = self.turn * start.rotation;
        // `start` takes a point to arm + mean + start.translation.
        let translation = self.mean - self.turn * self.mean + start.translation + self.shift();
        RigidMotion { rotation, translation }
    }
}

impl LeastSquaresProblem<f64, Dyn, U6> for Superposition {
    type ParameterStorage = Owned<f64, U6>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, U6>;

    fn set_params(&mut self, parameters: &Vector6<f64>) {
        self.parameters = *parameters;
        self.turn = Rotation3::from_scaled_axis(parameters.fixed_rows::<3>(0) / self.size);
    }

    fn params(&self) -> Vector6<f64> {
        self.parameters
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        // turn(arm) - arm rather than turn(arm): at the start both offsets and turn are small, no digits are lost.
        let (difference, shift) = (self.turn.matrix() - Matrix3::identity(), self.shift());
        let values = self.arms.iter().zip(&self.offsets).map(|(arm, offset)| difference * arm + offset + shift);
        let flat: Vec<f64> = values.flat_map(|v| [v.x, v.y, v.z]).collect();
        Some(DVector::from_vec(flat))
    }

    fn jacobian(&self) -> Option<OMatrix<f64, Dyn, U6>> {
        // d(exp(v) a)/dv = -[exp(v) a]x J(v), with the left Jacobian J of the rotation group.
        let v = self.turn.scaled_axis();
        let left = left_jacobian(&v) / self.size;
        let mut out = OMatrix::<f64, Dyn, U6>::zeros(3 * self.arms.len());
        for (i, arm) in self.arms.iter().enumerate() {
            let by_turn = -(self.turn * arm).cross_matrix() * left;
            out.fixed_view_mut::<3, 3>(3 * i, 0).copy_from(&by_turn);
            out.fixed_view_mut::<3, 3>(3 * i, 3).fill_with_identity();
        }
        Some(out)
    }
}

/// Left Jacobian of the rotation by the vector `v` (Barfoot 2017, State Estimation for Robotics, equation 7.77).
fn left_jacobian(v: &Vector3<f64>) -> OMatrix<f64, U3, U3> {
    let angle = v.norm();
    let cross = v.cross_matrix();
    // Below this the next terms of the series are under round-off.
    let (a, b) = if angle < 1e-4 {
        (0.5 - angle * angle / 24.0, 1.0 / 6.0 - angle * angle / 120.0)
    } else {
        ((1.0 - angle.cos()) / angle.powi(2), (angle - angle.sin()) / angle.powi(3))
    };
    Matrix3::identity() + cross * a + cross * cross * b
}

#[cfg(test)]
mod tests {
    use super::*;
    use levenberg_marquardt::differentiate_numerically;

    fn cloud(n: usize, phase: f64) -> [Vec<f64>; 3] {
        let wave = |a: f64| (0..n).map(|i| 500.0 * (a * i as f64 + phase).sin()).collect();
        [wave(1.3), wave(2.7), wave(0.9)]
    }

    fn slices(x: &[Vec<f64>; 3]) -> Coordinates<'_> {
        [&x[0], &x[1], &x[2]]
    }

    /// A turned, shifted and roughly shaken copy.
    fn shaken(x: &[Vec<f64>; 3], motion: &RigidMotion, noise: f64) -> [Vec<f64>; 3] {
        let mut out = x.clone();
        for i in 0..x[0].len() {
            let y = motion.apply(Vector3::new(x[0][i], x[1][i], x[2][i]));
            for k in 0..3 {
                out[k][i] = y[k] + noise * (7.1 * i as f64 + 2.3 * k as f64).sin();
            }
        }
        out
    }

    fn motion(angles: [f64; 3]) -> RigidMotion {
        RigidMotion {
            rotation: Rotation3::from_scaled_axis(Vector3::from(angles)).into_inner(),
            translation: Vector3::new(30.0, -2.0, 11.0),
        }
    }

    #[test]
    fn jacobian_matches_finite_differences() {
        let x = cloud(6, 0.3);
        let y = shaken(&x, &motion([0.4, -0.2, 0.9]), 20.0);
        let mut problem = Superposition::new(slices(&x), slices(&y), &[true; 6], &RigidMotion::identity());
        for step in [0.0, 1e-3, 0.5] {
            problem.set_params(&(Vector6::new(1.0, -2.0, 0.5, 3.0, 1.0, -1.0) * step * problem.size));
            let numeric = differentiate_numerically(&mut problem).unwrap();
            let difference = (problem.jacobian().unwrap() - numeric).amax();
            assert!(difference < 1e-6, "{difference} at {step}");
        }
    }

    #[test]
    fn levenberg_marquardt_and_the_closed_form_agree_to_1e_minus_9() {
        let n = 1000;
        let x = cloud(n, 0.2);
        let used: Vec<bool> = (0..n).map(|i| i % 7 != 0).collect();
        for angles in [[0.0, 0.0, 0.0], [1e-5, -2e-5, 1e-6], [0.3, -0.8, 1.1], [0.0, 0.0, 3.1]] {
            let y = shaken(&x, &motion(angles), 15.0);
            let closed = rigid_fit(slices(&x), slices(&y), &used).motion;
            // Far from the minimum, so that the fit has to work for it.
            let nudge = Rotation3::from_scaled_axis(Vector3::new(0.2, 0.1, -0.3)).into_inner();
            let start = RigidMotion { rotation: nudge * closed.rotation, translation: Vector3::zeros() };
            for start in [closed, start] {
                let fitted = refine(slices(&x), slices(&y), &used, &start);
                assert!((fitted.rotation - closed.rotation).amax() < 1e-9, "{angles:?}");
                assert!((fitted.translation - closed.translation).amax() < 1e-9 * 500.0, "{angles:?}");
            }
        }
    }
}
