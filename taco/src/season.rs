//! From torques at fixed solar declination to torques averaged over the orbit, for every obliquity.
//!
//! With the spin axis at obliquity eps and the Sun at true longitude lambda, `sin dec = sin eps sin lambda`, and the Sun's
//! equatorial direction has the component `sin lambda cos eps / cos dec` along `e_1 = (e cos eps - N) / sin eps`, the
//! direction that raises the obliquity (Rubincam 2000, Icarus 148, 2). Hence, averaging over lambda,
//! `T_omega = <tau_z>` and `T_eps = <tau_u sin lambda cos eps / cos dec>`. Only the part of `tau_z` even and of `tau_u`
//! odd in declination survives, which makes `T_omega` even and `T_eps` odd about 90 deg. The torque across the Sun's
//! direction enters `T_eps` with `cos lambda / cos dec`, which has no mean as long as all true longitudes are alike. Heat
//! that is stored from day to day keeps them alike; only heat stored over seasons would not.
//!
//! Likewise the force along the orbital motion is `F_w cos eps / cos dec`, averaged, `F_w` that along the Sun's equatorial
//! direction crossed with the spin axis.

use crate::declination::northern_declinations;
use crate::spline::{Symmetry, weights, weights_on_values};
use std::f64::consts::FRAC_PI_2;

/// Points of the midpoint rule over a quarter of the orbit; the integrand is a spline in the declination, on which 180
/// points are good to 1e-7.
const LONGITUDES: usize = 180;

/// The averages as weights on the torques at each northern declination: everything after the facets is linear.
#[derive(Debug)]
pub(crate) struct Season {
    nodes: usize,
    /// `[obliquity][declination]`, for `tau_z`.
    spin: Vec<f64>,
    /// `[obliquity][declination]`, for `tau_u`.
    obliquity: Vec<f64>,
}

/// Spin and obliquity torque at each obliquity.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Curve {
    pub spin: Vec<f64>,
    pub obliquity: Vec<f64>,
}

impl Season {
    /// For `nodes` declinations from the equator to the pole, as [`northern_declinations`] spreads them.
    pub fn new(nodes: usize, obliquities_deg: &[f64]) -> Self {
        let spin = averages(nodes, obliquities_deg, Symmetry::Even, |_, _, _| 1.0);
        let mut obliquity = averages(nodes, obliquities_deg, Symmetry::Odd, |sin_lambda, cos_eps, cos_dec| {
            sin_lambda * cos_eps / cos_dec
        });
        for (row, &degrees) in obliquity.chunks_mut(nodes).zip(obliquities_deg) {
            // An odd function has no value at its ends; what round-off leaves there is dropped.
            (row[0], row[nodes - 1]) = (0.0, 0.0);
            if degrees == 0.0 || degrees == 180.0 {
                row.fill(0.0);
            }
        }
        Self { nodes, spin, obliquity }
    }

    /// The curve of a response that has every `stride`-th of its declinations here: `[tau_z, tau_u]` from pole to pole.
    pub fn curve(&self, response: &[f64], stride: usize) -> Curve {
        let equator = (self.nodes - 1) * stride;
        let at = |index: usize, c: usize| response[2 * index + c];
        let folded: Vec<[f64; 2]> = (0..self.nodes)
            .map(|n| {
                let (north, south) = (equator + n * stride, equator - n * stride);
                [0.5 * (at(north, 0) + at(south, 0)), 0.5 * (at(north, 1) - at(south, 1))]
            })
            .collect();
        let average = |weights: &[f64], c: usize| {
            let row = |w: &[f64]| w.iter().zip(&folded).map(|(w, t)| w * t[c]).sum();
            weights.chunks(self.nodes).map(row).collect()
        };
        Curve { spin: average(&self.spin, 0), obliquity: average(&self.obliquity, 1) }
    }
}

/// Weights on the values at each northern declination of the average over true longitude of a function with this
/// symmetry, times a factor of `sin lambda`, `cos eps` and `cos dec`: `[obliquity][declination]`.
fn averages(
    nodes: usize,
    obliquities_deg: &[f64],
    symmetry: Symmetry,
    factor: impl Fn(f64, f64, f64) -> f64,
) -> Vec<f64> {
    let declinations = northern_declinations(nodes);
    let mut weights_on = vec![0.0; nodes * obliquities_deg.len()];
    for (values, &degrees) in weights_on.chunks_mut(nodes).zip(obliquities_deg) {
        // Folded about 90 deg, so that the symmetries hold to the last bit.
        let folded = degrees.min(180.0 - degrees).to_radians();
        let sign = if degrees > 90.0 { -1.0 } else { 1.0 };
        let sin_eps = folded.sin();
        let cos_eps = if degrees == 90.0 { 0.0 } else { sign * folded.cos() };
        let mut on_curvature = vec![0.0; nodes];
        let mut k = 0;
        for l in 0..LONGITUDES {
            let sin_lambda = (FRAC_PI_2 * (l as f64 + 0.5) / LONGITUDES as f64).sin();
            let sin_dec = sin_eps * sin_lambda;
            let cos_dec = ((1.0 - sin_dec) * (1.0 + sin_dec)).sqrt();
            let declination = sin_dec.asin();
            while k < nodes - 2 && declinations[k + 1] <= declination {
                k += 1;
            }
            let step = declinations[k + 1] - declinations[k];
            let basis = weights(step, (declination - declinations[k]) / step);
            let factor = factor(sin_lambda, cos_eps, cos_dec) / LONGITUDES as f64;
            values[k] += factor * basis[0];
            values[k + 1] += factor * basis[1];
            on_curvature[k] += factor * basis[2];
            on_curvature[k + 1] += factor * basis[3];
        }
        let more = weights_on_values(&declinations, on_curvature, symmetry);
        values.iter_mut().zip(more).for_each(|(v, w)| *v += w);
    }
    weights_on
}

/// The average of the transverse force as weights on `F_w` at each northern declination.
#[derive(Debug)]
pub(crate) struct TransverseSeason {
    nodes: usize,
    weights: Vec<f64>,
}

impl TransverseSeason {
    /// As [`Season::new`].
    pub fn new(nodes: usize, obliquities_deg: &[f64]) -> Self {
        // Even about the equator; over the pole the direction turns round.
        let factor = |_: f64, cos_eps: f64, cos_dec: f64| cos_eps / cos_dec;
        let mut weights = averages(nodes, obliquities_deg, Symmetry::EvenOdd, factor);
        weights.chunks_mut(nodes).for_each(|row| row[nodes - 1] = 0.0);
        Self { nodes, weights }
    }

    /// The force at each obliquity from `F_w` at all declinations, from pole to pole.
    pub fn curve(&self, response: &[f64]) -> Vec<f64> {
        let equator = self.nodes - 1;
        let folded = |n: usize| 0.5 * (response[equator + n] + response[equator - n]);
        self.weights.chunks(self.nodes).map(|row| row.iter().enumerate().map(|(n, w)| w * folded(n)).sum()).collect()
    }
}

impl Curve {
    /// The curve times a factor.
    pub fn scaled(mut self, factor: f64) -> Self {
        self.spin.iter_mut().chain(&mut self.obliquity).for_each(|t| *t *= factor);
        self
    }

    /// Largest distance between two curves: of the spin and of the obliquity torque.
    pub fn distance(&self, other: &Self) -> [f64; 2] {
        let worst = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        [worst(&self.spin, &other.spin), worst(&self.obliquity, &other.obliquity)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// tau_z = cos 2 dec averages to 1 - sin^2 eps; tau_u = sin dec cos dec gives sin eps cos eps / 2.
    #[test]
    fn smooth_torques_average_to_their_closed_forms() {
        let nodes = 37;
        let obliquities = [0.0, 5.0, 30.0, 77.0, 90.0, 103.0, 150.0, 180.0];
        let season = Season::new(nodes, &obliquities);
        let northern = northern_declinations(nodes);
        let response: Vec<f64> = (northern[1..].iter().rev().map(|d| -d))
            .chain(northern.iter().copied())
            .flat_map(|dec| [(2.0 * dec).cos() + dec.sin(), dec.sin() * dec.cos() + dec.cos()])
            .collect();
        let curve = season.curve(&response, 1);
        for (k, eps) in obliquities.iter().map(|o| o.to_radians()).enumerate() {
            assert!((curve.spin[k] - (1.0 - eps.sin().powi(2))).abs() < 2e-7, "{}", curve.spin[k]);
            assert!((curve.obliquity[k] - 0.5 * eps.sin() * eps.cos()).abs() < 2e-7, "{}", curve.obliquity[k]);
        }
        assert_eq!([curve.obliquity[0], curve.obliquity[4], curve.obliquity[7]], [0.0; 3]);
        assert_eq!((curve.spin[3], curve.obliquity[3]), (curve.spin[5], -curve.obliquity[5]));
    }

    /// F_w = cos dec averages to cos eps, F_w = cos^3 dec to cos eps (1 - sin^2 eps / 2).
    #[test]
    fn transverse_forces_average_to_their_closed_forms() {
        let (nodes, obliquities) = (37, [0.0, 20.0, 90.0, 130.0, 180.0]);
        let season = TransverseSeason::new(nodes, &obliquities);
        let northern = northern_declinations(nodes);
        let all = northern[1..].iter().rev().map(|d| -d).chain(northern.iter().copied());
        let (one, three): (Vec<f64>, Vec<f64>) = all.map(|d| (d.cos() + d.sin(), d.cos().powi(3))).unzip();
        let (one, three) = (season.curve(&one), season.curve(&three));
        for (k, eps) in obliquities.iter().map(|o| o.to_radians()).enumerate() {
            assert!((one[k] - eps.cos()).abs() < 1e-6, "{}", one[k]);
            assert!((three[k] - eps.cos() * (1.0 - 0.5 * eps.sin().powi(2))).abs() < 1e-6, "{}", three[k]);
        }
        assert_eq!((one[2], one[1] > 0.0), (0.0, true));
    }
}
