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
    /// Square roots of the spin rates, in which the torque is smooth: the thermal parameter goes with them.
    root_omega: Vec<f64>,
    /// Torque and curvature of the spin torque, then of the obliquity torque, `[omega][obliquity]`.
    nodes: Vec<Vec<[f64; 4]>>,
    /// Their slopes in the root of the spin rate.
    slopes: Vec<Vec<[f64; 4]>>,
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
        if omega.is_empty() || !(0.0..=f64::MAX).contains(&omega[0]) || omega.windows(2).any(|w| !w[0].lt(&w[1])) {
            return bad("it needs spin rates in ascending order, none negative");
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
        let nodes: Vec<Vec<_>> = nodes.collect();
        let root_omega: Vec<f64> = omega.iter().map(|o| o.sqrt()).collect();
        let slopes = (0..omega.len()).map(|w| slopes(&root_omega, &nodes, w)).collect();
        Ok(Self { obliquity: obliquity.clone(), root_omega, nodes, slopes })
    }

    /// Spin torque `T_omega` and obliquity torque `T_epsilon`, N m, at an obliquity (rad) and a spin rate (rad/s).
    ///
    /// Any obliquity is allowed: beyond 0 and 180 deg the torques go on by their symmetry. `T_epsilon` is exactly zero
    /// at both. Between spin rates the torques are cubics in the root of the spin rate, with continuous slopes; beyond the
    /// outer ones they are constant, and a table with one spin rate does not depend on it. NaN in, NaN out.
    pub fn at(&self, obliquity: f64, omega: f64) -> (f64, f64) {
        let turned = obliquity.rem_euclid(TAU);
        let (folded, sign) = if turned > PI { (TAU - turned, -1.0) } else { (turned, 1.0) };
        let x = &self.obliquity;
        let k = (x.partition_point(|node| *node <= folded)).clamp(1, x.len() - 1) - 1;
        let h = x[k + 1] - x[k];
        let [y0, y1, m0, m1] = weights(h, ((folded - x[k]) / h).clamp(0.0, 1.0));
        let row = |rows: &[Vec<[f64; 4]>], w: usize| {
            let (a, b) = (&rows[w][k], &rows[w][k + 1]);
            let value = |c: usize| y0 * a[c] + y1 * b[c] + m0 * a[c + 1] + m1 * b[c + 1];
            [value(0), sign * value(2)]
        };
        let roots = &self.root_omega;
        let (last, root) = (roots.len() - 1, if omega < 0.0 { 0.0 } else { omega.sqrt() });
        let above = roots.partition_point(|node| *node <= root);
        if last > 0 && omega.is_nan() {
            return (f64::NAN, f64::NAN);
        }
        if above == 0 || above > last {
            let [spin, tilt] = row(&self.nodes, above.min(last));
            return (spin, tilt);
        }
        let step = roots[above] - roots[above - 1];
        let t = (root - roots[above - 1]) / step;
        let s = 1.0 - t;
        let hermite = [s * s * (1.0 + 2.0 * t), t * t * (1.0 + 2.0 * s), step * t * s * s, -step * s * t * t];
        let terms = [
            row(&self.nodes, above - 1),
            row(&self.nodes, above),
            row(&self.slopes, above - 1),
            row(&self.slopes, above),
        ];
        let sum = |c: usize| hermite.iter().zip(&terms).map(|(h, t)| h * t[c]).sum();
        (sum(0), sum(1))
    }
}

/// Slopes at node `w` of the parabola through it and its neighbours, or through the outermost three; of the straight line
/// where there are but two nodes.
fn slopes(x: &[f64], nodes: &[Vec<[f64; 4]>], w: usize) -> Vec<[f64; 4]> {
    let obliquities = 0..nodes[w].len();
    let secant = |w: usize, k: usize, c: usize| (nodes[w + 1][k][c] - nodes[w][k][c]) / (x[w + 1] - x[w]);
    match x.len() {
        1 => obliquities.map(|_| [0.0; 4]).collect(),
        2 => obliquities.map(|k| std::array::from_fn(|c| secant(0, k, c))).collect(),
        n => {
            let middle = w.clamp(1, n - 2);
            let slope = |k: usize, c: usize| {
                let (left, right) = (secant(middle - 1, k, c), secant(middle, k, c));
                let curvature = (right - left) / (x[middle + 1] - x[middle - 1]);
                left + curvature * (2.0 * x[w] - x[middle - 1] - x[middle])
            };
            obliquities.map(|k| std::array::from_fn(|c| slope(k, c))).collect()
        }
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
            transverse_force_n: Vec::new(),
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
        let half_way = (0.5 * (1e-2 + 3e-4f64.sqrt())).powi(2);
        assert!((at(half_way) - 2.0).abs() < 1e-12, "{}", at(half_way));
        assert!(curve.at(0.0, f64::NAN).0.is_nan());
    }

    /// A parabola in the root of the spin rate is kept, whatever the nodes.
    #[test]
    fn parabolas_in_the_root_of_the_spin_rate_are_exact() {
        let mut table = table(30);
        table.omega = vec![0.0, 1e-6, 1e-5, 4e-5, 1e-4];
        let parabola = |omega: f64| 2.0 + 300.0 * omega.sqrt() - 4e4 * omega;
        let row = |omega: &f64| table.obliquity.iter().map(|_| parabola(*omega)).collect();
        table.spin_torque_n_m = table.omega.iter().map(row).collect();
        table.obliquity_torque_n_m = vec![vec![0.0; 7]; 5];
        let curve = table.interpolant(Interpolation::Linear).unwrap();
        for omega in [0.0, 3e-7, 2e-6, 2e-5, 9e-5, 1e-4] {
            assert!((curve.at(0.7, omega).0 - parabola(omega)).abs() < 1e-12, "{omega}");
        }
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
