//! Surface temperature over a rotation above ground that conducts and stores heat, in the frequency domain.
//!
//! A half-space of thermal inertia `Gamma` takes up the flux `Gamma sqrt(i n omega) T_n` at the n-th harmonic of the
//! rotation (Spencer, Lebofsky & Sykes 1989, Icarus 78, 337, give the parameters). With temperatures in units of the
//! subsolar `T_*` the balance at the surface is `T^4 + Theta F^-1[sqrt(i n) T_n] = f`,
//! `Theta = Gamma sqrt(omega) / (emissivity sigma T_*^3)`; the mean flux into the ground is zero.
//!
//! What is emitted is taken as `f` less what is conducted, so that the energy of a rotation is exact whatever is left of
//! the residual.

use crate::heat::balance::{Balance, Conductor};
use crate::heat::filter::{Filter, divide_by, half_derivative};
use realfft::num_complex::Complex;
use std::f64::consts::PI;

/// The ground as a [`Conductor`].
struct HalfSpace {
    filter: Filter,
    /// `sqrt(i n) / cells`.
    admittance: Vec<Complex<f64>>,
    /// `1 / (c + theta sqrt(i n)) / cells`.
    divisor: Vec<Complex<f64>>,
}

/// Solves for the temperature of a facet; one per thread.
pub(crate) struct Conduction {
    ground: HalfSpace,
    balance: Balance,
    scaled: Vec<f64>,
    flux: Vec<f64>,
    /// Cosine and sine of the angle from the middle of cell 0, over the number of cells and over what a mean over a cell
    /// takes off a first harmonic.
    turn: Vec<[f64; 2]>,
}

impl Conduction {
    /// For `cells` equal cells of a rotation (even, at least 4).
    pub fn new(cells: usize) -> Self {
        let half = PI / cells as f64;
        let weight = half / half.sin() / cells as f64;
        let turn = |k: usize| (2.0 * half * k as f64).sin_cos();
        Self {
            ground: HalfSpace::new(cells),
            balance: Balance::new(cells),
            scaled: vec![0.0; cells],
            flux: vec![0.0; cells],
            turn: (0..cells).map(turn).map(|(sin, cos)| [weight * cos, weight * sin]).collect(),
        }
    }

    /// Temperature (units of `T_*`) of a facet that absorbs `f >= 0` (units of `emissivity sigma T_*^4`, one number a cell in
    /// order of time), until the residual is below `tolerance` of the mean of `f`. `temperature` comes in as a guess, all
    /// zero if there is none. Returns how many Newton steps it took.
    pub fn solve(&mut self, theta: f64, f: &[f64], tolerance: f64, temperature: &mut [f64]) -> usize {
        let n = f.len() as f64;
        let mean = f.iter().sum::<f64>() / n;
        self.flux.fill(0.0);
        // In units of the temperature that emits the mean, nothing is very small or very large.
        let unit = mean.sqrt().sqrt();
        let theta = theta / (unit * unit * unit);
        if mean <= 0.0 || !theta.is_finite() {
            temperature.fill(0.0);
            return 0;
        }
        if theta == 0.0 {
            temperature.iter_mut().zip(f).for_each(|(t, f)| *t = f.sqrt().sqrt());
            return 0;
        }
        let guessed = temperature.iter().sum::<f64>() / n;
        self.scaled.iter_mut().zip(f).for_each(|(s, f)| *s = f / mean);
        if guessed > 0.0 {
            // A guess for another flux is one of the shape.
            let fourth = temperature.iter().map(|t| t.powi(4)).sum::<f64>() / n;
            let scale = 1.0 / fourth.sqrt().sqrt();
            temperature.iter_mut().for_each(|t| *t *= scale);
        } else {
            // Between the temperatures without conduction and the mean of infinite conduction.
            let guess = |f: f64| ((f + theta) / (1.0 + theta)).sqrt().sqrt();
            temperature.iter_mut().zip(&self.scaled).for_each(|(t, f)| *t = guess(*f));
        }
        let steps = self.balance.solve(&mut self.ground, theta, &self.scaled, tolerance, temperature, &mut self.flux);
        temperature.iter_mut().for_each(|t| *t *= unit);
        self.flux.iter_mut().for_each(|q| *q *= mean);
        steps
    }

    /// Flux into the ground at the last solution, in the units of `f`: the facet emits `f` less this. Its mean is zero.
    pub fn conducted(&self) -> &[f64] {
        &self.flux
    }

    /// First harmonic of [`Self::conducted`]: its mean times the cosine and times the sine of the angle from the middle
    /// of cell 0, in direction of time; as of a flux that is smooth within the cells.
    pub fn conducted_harmonic(&self) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for (q, [cos, sin]) in self.flux.iter().zip(&self.turn) {
            sums[0] += q * cos;
            sums[1] += q * sin;
        }
        sums
    }
}

impl HalfSpace {
    fn new(cells: usize) -> Self {
        let admittance = half_derivative(cells);
        Self { filter: Filter::new(cells), divisor: admittance.clone(), admittance }
    }
}

impl Conductor for HalfSpace {
    fn conduct(&mut self, x: &[f64], out: &mut [f64]) {
        self.filter.apply(x.iter().copied(), &self.admittance, out);
    }

    fn prepare(&mut self, c: f64, theta: f64) {
        divide_by(c, theta, &self.admittance, &mut self.divisor);
    }

    fn divide(&mut self, x: &[f64], out: &mut [f64]) {
        self.filter.apply(x.iter().copied(), &self.divisor, out);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_1_PI, FRAC_PI_4, TAU};

    fn solved(theta: f64, f: &[f64], tolerance: f64) -> (Vec<f64>, Conduction) {
        let mut conduction = Conduction::new(f.len());
        let mut temperature = vec![0.0; f.len()];
        conduction.solve(theta, f, tolerance, &mut temperature);
        (temperature, conduction)
    }

    /// Equatorial facet at equinox, noon at the first sample.
    fn equator(n: usize) -> Vec<f64> {
        (0..n).map(|k| (TAU * k as f64 / n as f64).cos().max(0.0)).collect()
    }

    /// Maximum, minimum, lag of the maximum (deg) and sine component of T^4 by an independent solution, 1024 samples.
    #[test]
    fn equatorial_day_matches_independent_values() {
        let n = 1024;
        let f = equator(n);
        for (theta, max, min, lag, sine) in [
            (0.1, 0.9931, 0.3326, 1.4, 0.02239),
            (1.0, 0.9455, 0.5378, 10.9, 0.08881),
            (3.0, 0.8785, 0.6372, 22.5, 0.09024),
            (10.0, 0.8048, 0.7076, 31.6, 0.04688),
        ] {
            let (t, conduction) = solved(theta, &f, 1e-10);
            let hottest = (0..n).max_by(|a, b| t[*a].total_cmp(&t[*b])).unwrap();
            let coldest = t.iter().fold(f64::INFINITY, |m, t| m.min(*t));
            assert!((t[hottest] - max).abs() < 1e-4, "{theta}: {}", t[hottest]);
            assert!((coldest - min).abs() < 1e-4, "{theta}: {coldest}");
            assert!((360.0 * hottest as f64 / n as f64 - lag).abs() < 0.36, "{theta}: {hottest}");
            let sum: f64 = (0..n).map(|k| t[k].powi(4) * (TAU * k as f64 / n as f64).sin()).sum();
            assert!((2.0 * sum / n as f64 - sine).abs() < 1e-5, "{theta}: {sum}");
            let mean = t.iter().map(|t| t.powi(4)).sum::<f64>() / n as f64;
            assert!((mean - FRAC_1_PI).abs() < 1e-5, "{theta}: {mean}");
            let leaves: f64 = conduction.conducted().iter().sum::<f64>() / n as f64;
            assert!(leaves.abs() < 1e-14, "{leaves:e}");
        }
    }

    #[test]
    fn weak_variations_follow_linear_theory_and_lag_by_45_deg() {
        let n = 256;
        for theta in [1e3, 1e4, 1e6] {
            let (t, _) = solved(theta, &equator(n), 1e-9);
            let t0 = FRAC_1_PI.sqrt().sqrt();
            let first: Complex<f64> =
                (0..n).map(|k| Complex::from_polar(t[k] / n as f64, -TAU * k as f64 / n as f64)).sum();
            // f_1 = 1/4 in complex form.
            let expected = 0.25 / (4.0 * t0.powi(3) + Complex::from_polar(theta, FRAC_PI_4));
            assert!((first - expected).norm() < 2e-3 * expected.norm(), "{theta}: {first} {expected}");
            assert!(theta < 1e4 || (first.arg() + FRAC_PI_4).abs() < 1e-3);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]
        /// Any thermal parameter and any sunlight: few steps, energy kept, the balance met.
        #[test]
        fn always_converges(
            log_theta in -7.0f64..6.0, seed in proptest::collection::vec(0.0f64..1.0, 64), dark in 0.0f64..1.1, log_f in -9.0f64..1.0,
        ) {
            let f: Vec<f64> = seed.iter().map(|s| 10f64.powf(log_f) * (s - dark).max(0.0)).collect();
            let mut conduction = Conduction::new(64);
            let mut t = vec![0.0; 64];
            let theta = 10f64.powf(log_theta);
            let steps = conduction.solve(theta, &f, 1e-8, &mut t);
            let mean = f.iter().sum::<f64>() / 64.0;
            prop_assert!(steps < 60, "{steps} steps");
            // Round-off of what is conducted.
            let noise = 1e-13 * theta * mean.sqrt().sqrt();
            for k in 0..64 {
                let off = t[k] * t[k].abs().powi(3) + conduction.conducted()[k] - f[k];
                prop_assert!(off.abs() <= 1e-6 * mean + noise, "{off:e} of {mean:e} at theta {theta:e}");
            }
            prop_assert!((conduction.conducted().iter().sum::<f64>() / 64.0).abs() <= 1e-12 * mean + noise);
        }
    }

    #[test]
    fn darkness_is_cold_and_no_inertia_follows_the_sun() {
        let mut conduction = Conduction::new(8);
        let mut t = vec![0.3; 8];
        assert_eq!(conduction.solve(1.0, &[0.0; 8], 1e-6, &mut t), 0);
        assert_eq!((t, conduction.conducted()), (vec![0.0; 8], [0.0; 8].as_slice()));
        let f = [0.0, 0.0, 16.0, 81.0, 1.0, 0.0, 0.0, 0.0];
        let mut t = vec![0.0; 8];
        conduction.solve(0.0, &f, 1e-6, &mut t);
        assert_eq!(t, [0.0, 0.0, 2.0, 3.0, 1.0, 0.0, 0.0, 0.0]);
    }
}
