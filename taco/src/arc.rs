//! Recoil of a facet integrated over an arc of hour angles, by Gauss quadrature.
//!
//! With `mu0 = a + b cos H` the integrand is nearly a polynomial of low degree in `cos H`. 8 points give arcs up to half a
//! turn to 1e-8 for a Lambert surface and to 2e-5 for a rough Hapke surface, whose scattering bends towards grazing
//! incidence; 16 give longer ones better still.

use crate::quadrature::gauss_legendre;
use crate::recoil::{Recoil, RecoilKernel};
use std::f64::consts::PI;

/// Arcs up to this half-width take 4 points, rad.
const SHORT: f64 = 0.3;

/// Integrals over the lit part of the day of the three recoil terms times 1, cos H and sin H (those that are needed).
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Lit {
    pub emitted: [f64; 3],
    pub normal: [f64; 3],
    pub solar: [f64; 2],
}

/// Positive half of a symmetric rule: nodes and weights.
type HalfRule<const N: usize> = ([f64; N], [f64; N]);

/// Integrates over arcs for one surface.
#[derive(Debug)]
pub(crate) struct Arcs<'a, K> {
    kernel: &'a K,
    short: HalfRule<2>,
    medium: HalfRule<4>,
    long: HalfRule<8>,
}

impl<'a, K: RecoilKernel> Arcs<'a, K> {
    pub fn new(kernel: &'a K) -> Self {
        Self { kernel, short: half_rule(), medium: half_rule(), long: half_rule() }
    }

    /// Adds the arc of half-width `half` (at most pi) about the hour angle `middle`.
    #[inline]
    pub fn add(&self, a: f64, b: f64, middle: f64, half: f64, lit: &mut Lit) {
        if half < SHORT {
            self.add_with(&self.short, a, b, middle, half, lit);
        } else if half <= 0.5 * PI {
            self.add_with(&self.medium, a, b, middle, half, lit);
        } else {
            self.add_with(&self.long, a, b, middle, half, lit);
        }
    }

    /// Adds the day over an open horizon, which is symmetric about noon.
    #[inline]
    pub fn add_open_day(&self, a: f64, b: f64, lit: &mut Lit) {
        let half = half_day(a, b);
        if half > 0.5 * PI {
            self.add_open_with(&self.long, a, b, half, lit);
        } else if half > 0.0 {
            self.add_open_with(&self.medium, a, b, half, lit);
        }
    }

    #[inline]
    fn add_with<const N: usize>(&self, rule: &HalfRule<N>, a: f64, b: f64, middle: f64, half: f64, lit: &mut Lit) {
        if half <= 0.0 {
            return;
        }
        let (sin_m, cos_m) = middle.sin_cos();
        let (sin_x, cos_x) = sines_and_cosines(&rule.0, half);
        // Sums in the arc's own frame, turned to the facet's afterwards.
        let mut even = Lit::default();
        let mut odd = Lit::default();
        for ((weight, cos_x), sin_x) in rule.1.iter().zip(&cos_x).zip(&sin_x) {
            let (c, s) = (cos_m * cos_x, sin_m * sin_x);
            let later = self.kernel.at(a + b * (c - s));
            let earlier = self.kernel.at(a + b * (c + s));
            even.accumulate(half * weight, *cos_x, &later.plus(&earlier));
            odd.accumulate(half * weight, *sin_x, &later.minus(&earlier));
        }
        let turn = |c: f64, s: f64| [cos_m * c - sin_m * s, sin_m * c + cos_m * s];
        let (emitted, normal) = (turn(even.emitted[1], odd.emitted[1]), turn(even.normal[1], odd.normal[1]));
        let solar = turn(even.solar[0], odd.solar[0]);
        lit.emitted[0] += even.emitted[0];
        lit.normal[0] += even.normal[0];
        for k in 0..2 {
            lit.emitted[k + 1] += emitted[k];
            lit.normal[k + 1] += normal[k];
            lit.solar[k] += solar[k];
        }
    }

    #[inline]
    fn add_open_with<const N: usize>(&self, rule: &HalfRule<N>, a: f64, b: f64, half: f64, lit: &mut Lit) {
        let (_, cos_x) = sines_and_cosines(&rule.0, half);
        for (weight, cos_x) in rule.1.iter().zip(&cos_x) {
            lit.accumulate(2.0 * half * weight, *cos_x, &self.kernel.at(a + b * cos_x));
        }
    }
}

impl Lit {
    /// Adds a recoil times 1 and times `factor`, in the places of 1 and cos H.
    #[inline(always)]
    fn accumulate(&mut self, weight: f64, factor: f64, recoil: &Recoil) {
        let turned = weight * factor;
        self.emitted[0] += weight * recoil.emitted;
        self.emitted[1] += turned * recoil.emitted;
        self.normal[0] += weight * recoil.normal;
        self.normal[1] += turned * recoil.normal;
        self.solar[0] += turned * recoil.solar;
    }
}

/// Half the length of the day over an open horizon, rad.
pub(crate) fn half_day(a: f64, b: f64) -> f64 {
    if a >= b {
        PI
    } else if a <= -b {
        0.0
    } else {
        (-a / b).acos()
    }
}

fn half_rule<const N: usize>() -> HalfRule<N> {
    let rule = gauss_legendre(2 * N);
    (std::array::from_fn(|k| rule[N + k].0), std::array::from_fn(|k| rule[N + k].1))
}

/// Ratios of successive coefficients of the sine and cosine series, `1 / (2n (2n + 1))` and `1 / (2n (2n - 1))`, last
/// term first.
const RATIOS: [[f64; 2]; 9] = {
    let mut ratios = [[0.0; 2]; 9];
    let mut k = 0;
    while k < 9 {
        let n = 2.0 * (9 - k) as f64;
        ratios[k] = [1.0 / (n * (n + 1.0)), 1.0 / (n * (n - 1.0))];
        k += 1;
    }
    ratios
};

/// Sines and cosines of `half * x`, at most pi, to 1e-13: series of the half angle, which the compiler turns into vector
/// code, and one doubling. The library function would take half the time of the whole quadrature.
#[inline(always)]
fn sines_and_cosines<const N: usize>(x: &[f64; N], half: f64) -> ([f64; N], [f64; N]) {
    let (mut sines, mut cosines) = ([0.0; N], [0.0; N]);
    for k in 0..N {
        let y = 0.5 * half * x[k];
        let q = y * y;
        let (mut s, mut c) = (1.0, 1.0);
        for [next_s, next_c] in RATIOS {
            s = 1.0 - q * s * next_s;
            c = 1.0 - q * c * next_c;
        }
        s *= y;
        sines[k] = 2.0 * s * c;
        cosines[k] = 1.0 - 2.0 * s * s;
    }
    (sines, cosines)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recoil::{LambertRecoil, RecoilTable};
    use crate::surface::Hapke;

    #[test]
    fn series_matches_the_library() {
        for half in [1e-3, 0.5, 1.0, 2.0, PI] {
            let x = [0.1, 0.3, 0.7, 1.0];
            let (s, c) = sines_and_cosines(&x, half);
            for k in 0..4 {
                let (sin, cos) = (half * x[k]).sin_cos();
                assert!((s[k] - sin).abs() < 2e-13 && (c[k] - cos).abs() < 2e-13);
            }
        }
    }

    /// Against the midpoint rule with 20 000 steps.
    #[test]
    fn arcs_match_a_fine_sum() {
        let table = RecoilTable::cached(&Hapke::default());
        let arcs = Arcs::new(&*table);
        for (a, b, middle, half) in [
            (0.0, 1.0, 0.0, 0.5 * PI),
            (0.1, 0.8, -0.4, 1.2),
            (0.5, 0.5, 0.3, 2.6),
            (0.7, 0.2, 0.0, PI),
            (0.3, 0.6, 1.0, 0.2),
        ] {
            let mut lit = Lit::default();
            arcs.add(a, b, middle, half, &mut lit);
            let n = 20_000;
            let mut sum = [0.0; 8];
            for k in 0..n {
                let h = middle + half * ((2.0 * f64::from(k) + 1.0) / f64::from(n) - 1.0);
                let r = table.at(a + b * h.cos());
                let step = 2.0 * half / f64::from(n);
                let terms = [r.emitted, r.normal].map(|r| [r, r * h.cos(), r * h.sin()]);
                let terms = terms.into_iter().flatten().chain([r.solar * h.cos(), r.solar * h.sin()]);
                sum.iter_mut().zip(terms).for_each(|(s, t)| *s += step * t);
            }
            let got = lit.emitted.into_iter().chain(lit.normal).chain(lit.solar);
            for (got, want) in got.zip(sum) {
                assert!((got - want).abs() < 2e-5 * sum[0], "{a} {b} {middle} {half}: {got} {want}");
            }
            let mut lambert = Lit::default();
            Arcs::new(&LambertRecoil { albedo: 0.0 }).add(a, b, middle, half, &mut lambert);
            let exact = 2.0 * (a * half + b * half.sin() * middle.cos());
            assert!((lambert.emitted[0] / exact - 1.0).abs() < 1e-8, "{}", lambert.emitted[0] / exact - 1.0);
            if middle == 0.0 && half == half_day(a, b) {
                let mut open = Lit::default();
                arcs.add_open_day(a, b, &mut open);
                assert!((open.emitted[1] - lit.emitted[1]).abs() < 1e-14);
            }
        }
    }
}
