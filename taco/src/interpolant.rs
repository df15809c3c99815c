//! Torques between the nodes of a table.

use crate::error::TacoError;
use crate::spline::{Symmetry, curvatures, weights};
use crate::torque::TorqueTable;
use std::f64::consts::{PI, TAU};

/// How to interpolate in obliquity.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// Cubic splines that are even (spin torque) or odd (obliquity torque) about 0 and 180 deg.
    #[default]
    Cubic,
    /// Straight lines.
    Linear,
}

/// A torque table made ready for many look-ups.
#[derive(Debug, Clone, PartialEq)]
pub struct TorqueInterpolant {
    obliquity: Vec<f64>,
    omega: Vec<f64>,
    /// Torque and curvature of the spin torque, then of the obliquity torque, `[omega][obliquity]`.
    nodes: Vec<Vec<[f64; 4]>>,
}

impl TorqueInterpolant {
    pub(crate) fn new(table: &TorqueTable, interpolation: Interpolation) -> Result<Self, TacoError> {
        let bad = |problem| Err(TacoError::BadTable { problem });
        let TorqueTable { obliquity, omega, spin_torque_n_m, obliquity_torque_n_m, .. } = table;
        let n = obliquity.len();
        let rows = spin_torque_n_m.iter().chain(obliquity_torque_n_m);
        if n < 2 || obliquity.windows(2).any(|w| !w[0].lt(&w[1])) {
            return bad("it needs at least two obliquities in ascending order");
        }
        if obliquity[0] != 0.0 || (obliquity[n - 1] - PI).abs() > 1e-12 {
            return bad("its obliquities do not run from 0 to 180 deg");
        }
        if omega.is_empty() || omega.windows(2).any(|w| !w[0].lt(&w[1])) {
            return bad("it needs spin rates in ascending order");
        }
        if spin_torque_n_m.len() != omega.len() || obliquity_torque_n_m.len() != omega.len() {
            return bad("it needs one row of torques per spin rate");
        }
        if rows.clone().any(|row| row.len() != n) || rows.flatten().any(|t| !t.is_finite()) {
            return bad("it needs one finite torque per obliquity");
        }
        let nodes = spin_torque_n_m.iter().zip(obliquity_torque_n_m).map(|(spin, tilt)| {
            // Zero by symmetry; a table from elsewhere may carry round-off.
            let mut tilt = tilt.clone();
            (tilt[0], tilt[n - 1]) = (0.0, 0.0);
            let [m_spin, m_tilt] = match interpolation {
                Interpolation::Linear => [vec![0.0; n], vec![0.0; n]],
                Interpolation::Cubic => {
                    [curvatures(obliquity, spin, Symmetry::Even), curvatures(obliquity, &tilt, Symmetry::Odd)]
                }
            };
            (0..n).map(|k| [spin[k], m_spin[k], tilt[k], m_tilt[k]]).collect()
        });
        Ok(Self { obliquity: obliquity.clone(), omega: omega.clone(), nodes: nodes.collect() })
    }

    /// Spin torque `T_omega` and obliquity torque `T_epsilon`, N m, at an obliquity (rad) and a spin rate (rad/s).
    ///
    /// Any obliquity is allowed: beyond 0 and 180 deg the torques go on by their symmetry. `T_epsilon` is exactly zero
    /// at both. Between spin rates the torques are interpolated linearly, beyond the outer ones they are constant; a
    /// table with one spin rate does not depend on it. NaN in, NaN out.
    pub fn at(&self, obliquity: f64, omega: f64) -> (f64, f64) {
        let turned = obliquity.rem_euclid(TAU);
        let (folded, sign) = if turned > PI { (TAU - turned, -1.0) } else { (turned, 1.0) };
        let x = &self.obliquity;
        let k = (x.partition_point(|node| *node <= folded)).clamp(1, x.len() - 1) - 1;
        let h = x[k + 1] - x[k];
        let [y0, y1, m0, m1] = weights(h, ((folded - x[k]) / h).clamp(0.0, 1.0));
        let row = |w: usize| {
            let (a, b) = (&self.nodes[w][k], &self.nodes[w][k + 1]);
            let value = |c: usize| y0 * a[c] + y1 * b[c] + m0 * a[c + 1] + m1 * b[c + 1];
            (value(0), sign * value(2))
        };
        let last = self.omega.len() - 1;
        let above = self.omega.partition_point(|node| *node <= omega);
        if above == 0 || above > last {
            return row(above.min(last));
        }
        let t = (omega - self.omega[above - 1]) / (self.omega[above] - self.omega[above - 1]);
        let ((spin0, tilt0), (spin1, tilt1)) = (row(above - 1), row(above));
        (spin0 + t * (spin1 - spin0), tilt0 + t * (tilt1 - tilt0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::torque::TorqueError;

    /// A table of cos 2 eps and sin 2 eps, scaled by 1 and 3 at two spin rates.
    fn table(step_deg: u32) -> TorqueTable {
        let obliquity: Vec<f64> = (0..=180 / step_deg).map(|k| f64::from(k * step_deg).to_radians()).collect();
        let rows = |f: fn(f64) -> f64| vec![obliquity.iter().map(|x| f(*x)).collect(); 2];
        let mut table = TorqueTable {
            omega: vec![1e-4, 3e-4],
            spin_torque_n_m: rows(|x| (2.0 * x).cos()),
            obliquity_torque_n_m: rows(|x| (2.0 * x).sin()),
            error: TorqueError::default(),
            shaded_facets: 0,
            obliquity,
        };
        for row in [&mut table.spin_torque_n_m[1], &mut table.obliquity_torque_n_m[1]] {
            row.iter_mut().for_each(|t| *t *= 3.0);
        }
        table
    }

    fn worst(step_deg: u32, interpolation: Interpolation) -> f64 {
        let curve = table(step_deg).interpolant(interpolation).unwrap();
        (0..=1800)
            .map(|k| (f64::from(k) * 0.1).to_radians())
            .map(|x| (x, curve.at(x, 0.0)))
            .map(|(x, (spin, tilt))| (spin - (2.0 * x).cos()).abs().max((tilt - (2.0 * x).sin()).abs()))
            .fold(0.0, f64::max)
    }

    #[test]
    fn cubic_is_of_fourth_and_linear_of_second_order() {
        for (interpolation, order) in [(Interpolation::Cubic, 4.0), (Interpolation::Linear, 2.0)] {
            let measured = (worst(10, interpolation) / worst(5, interpolation)).log2();
            assert!((measured - order).abs() < 0.2, "{interpolation:?}: {measured}");
        }
        assert!(worst(5, Interpolation::Cubic) < 1e-5);
    }

    #[test]
    fn symmetries_at_the_poles_are_exact() {
        let curve = table(5).interpolant(Interpolation::Cubic).unwrap();
        assert_eq!(curve.at(0.0, 1e-4), (1.0, 0.0));
        assert_eq!(curve.at(PI, 1e-4).1, 0.0);
        let (spin, tilt) = curve.at(0.3, 1e-4);
        assert_eq!(curve.at(-0.3, 1e-4), {
            let folded = TAU - (-0.3f64).rem_euclid(TAU);
            let (spin, tilt) = curve.at(folded, 1e-4);
            (spin, -tilt)
        });
        assert!((curve.at(-0.3, 1e-4).0 - spin).abs() < 1e-14 && (curve.at(-0.3, 1e-4).1 + tilt).abs() < 1e-14);
        assert!(curve.at(f64::NAN, 1e-4).0.is_nan());
    }

    #[test]
    fn spin_rates_are_interpolated_and_clamped() {
        let curve = table(5).interpolant(Interpolation::Cubic).unwrap();
        let at = |omega| curve.at(0.0, omega).0;
        assert_eq!([at(0.0), at(1e-4), at(3e-4), at(1.0)], [1.0, 1.0, 3.0, 3.0]);
        assert!((at(2e-4) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn partial_tables_are_refused() {
        let mut partial = table(5);
        partial.obliquity[0] = 0.1;
        assert!(matches!(partial.interpolant(Interpolation::Cubic), Err(TacoError::BadTable { .. })));
        let mut ragged = table(5);
        ragged.spin_torque_n_m[1].pop();
        assert!(matches!(ragged.interpolant(Interpolation::Cubic), Err(TacoError::BadTable { .. })));
    }
}
