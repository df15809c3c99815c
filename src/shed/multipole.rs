//! The field of the primary farther out: its spherical harmonics to the degree that a stated error asks for.
//!
//! Recursions of Cunningham 1970 (Celest. Mech. 2, 207), as in Montenbruck & Gill 2000 (Satellite Orbits, section 3.2).

use super::mascons::{Mascons, norm};

/// Highest degree; where it does not reach the asked accuracy the mascons are summed instead.
pub(super) const MAX_DEGREE: usize = 6;
/// Terms in the bound of what is left out.
const TERMS: usize = 60;
/// Rows of the triangle of solid harmonics: the acceleration takes one more than the potential.
const ROWS: usize = MAX_DEGREE + 2;

/// Unnormalised coefficients C_nm and S_nm in units of the farthest mascon's distance.
#[derive(Debug, Clone)]
pub(super) struct Multipole {
    gm: f64,
    reference_m: f64,
    c: [[f64; MAX_DEGREE + 1]; MAX_DEGREE + 1],
    s: [[f64; MAX_DEGREE + 1]; MAX_DEGREE + 1],
    /// From this distance on, m, the expansion to each degree is good enough.
    from_m: [f64; MAX_DEGREE + 1],
}

impl Multipole {
    /// The expansion of `mascons` that keeps to `error`, the largest relative error of the acceleration.
    pub fn new(mascons: &Mascons, error: f64) -> Self {
        // A lone mascon is a point mass: every term beyond the first vanishes.
        let reference_m = if mascons.farthest_m > 0.0 { mascons.farthest_m } else { mascons.bounding_radius_m };
        let mut c = [[0.0; MAX_DEGREE + 1]; MAX_DEGREE + 1];
        let mut s = c;
        let mut moments = [0.0; TERMS];
        for (point, gm) in mascons.points() {
            // The solid harmonics of the inverse point are r^n P_nm cos(m lambda) over powers of the reference.
            let r = norm(point) / reference_m;
            if r == 0.0 {
                c[0][0] += gm / mascons.gm;
                continue;
            }
            for (n, moment) in moments.iter_mut().enumerate() {
                *moment += gm / mascons.gm * r.powi(n as i32);
            }
            let (v, w) = irregular(point.map(|x| x / reference_m / (r * r)), MAX_DEGREE);
            for n in 0..=MAX_DEGREE {
                for m in 0..=n {
                    let twice = if m == 0 { 1.0 } else { 2.0 };
                    let weight = twice * factorial(n - m) / factorial(n + m) * gm / mascons.gm / r;
                    c[n][m] += weight * v[n][m];
                    s[n][m] += weight * w[n][m];
                }
            }
        }
        // The centre of mass is the origin: there is no dipole.
        moments[1] = 0.0;
        let from_m = std::array::from_fn(|degree| reference_m * reach(&moments, degree, error));
        Self { gm: mascons.gm, reference_m, c, s, from_m }
    }

    /// Distance beyond which the expansion is used, m.
    pub fn switch_radius_m(&self) -> f64 {
        self.from_m[MAX_DEGREE]
    }

    /// Acceleration (m/s^2) at a point of the body frame, or `None` where the expansion is not good enough.
    #[inline]
    pub fn acceleration(&self, at: [f64; 3]) -> Option<[f64; 3]> {
        let r = norm(at);
        let degree = self.from_m.iter().position(|from| r >= *from)?;
        let (v, w) = irregular(at.map(|x| x / self.reference_m), degree + 1);
        let mut a = [0.0; 3];
        for n in 0..=degree {
            for m in 0..=n {
                let (c, s) = (self.c[n][m], self.s[n][m]);
                let [v1, w1] = [v[n + 1][m + 1], w[n + 1][m + 1]];
                if m == 0 {
                    a[0] -= c * v1;
                    a[1] -= c * w1;
                } else {
                    let back = ((n - m + 2) * (n - m + 1)) as f64;
                    let [v0, w0] = [v[n + 1][m - 1], w[n + 1][m - 1]];
                    a[0] += 0.5 * (-c * v1 - s * w1 + back * (c * v0 + s * w0));
                    a[1] += 0.5 * (-c * w1 + s * v1 + back * (s * v0 - c * w0));
                }
                a[2] -= (n - m + 1) as f64 * (c * v[n + 1][m] + s * w[n + 1][m]);
            }
        }
        Some(a.map(|a| a * self.gm / self.reference_m.powi(2)))
    }
}

/// Distance, in units of the farthest mascon's, from which on the terms beyond `degree` are below `error` of the whole:
/// that of degree n is at most (n + 1) <rho^n> / r^n, rho the distances of the mascons.
fn reach(moments: &[f64; TERMS], degree: usize, error: f64) -> f64 {
    let rest = |x: f64| {
        let term = |n: usize| (n + 1) as f64 * moments[n] * x.powi(n as i32);
        (degree + 1..TERMS).map(term).sum::<f64>()
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let x = 0.5 * (low + high);
        if rest(x) <= error {
            low = x;
        } else {
            high = x;
        }
    }
    1.0 / low
}

type Triangle = [[f64; ROWS]; ROWS];

/// Irregular solid harmonics V_nm and W_nm up to degree `last` of a point in units of the reference distance.
#[inline]
fn irregular([x, y, z]: [f64; 3], last: usize) -> (Triangle, Triangle) {
    let mut v = [[0.0; ROWS]; ROWS];
    let mut w = v;
    let scale = 1.0 / (x * x + y * y + z * z);
    let [x, y, z] = [x, y, z].map(|c| c * scale);
    v[0][0] = scale.sqrt();
    for m in 0..=last {
        if m > 0 {
            let odd = (2 * m - 1) as f64;
            v[m][m] = odd * (x * v[m - 1][m - 1] - y * w[m - 1][m - 1]);
            w[m][m] = odd * (x * w[m - 1][m - 1] + y * v[m - 1][m - 1]);
        }
        for n in m + 1..=last {
            let (up, over) = ((2 * n - 1) as f64 / (n - m) as f64, (n + m - 1) as f64 / (n - m) as f64);
            let (before_v, before_w) = if n >= m + 2 { (v[n - 2][m], w[n - 2][m]) } else { (0.0, 0.0) };
            v[n][m] = up * z * v[n - 1][m] - over * scale * before_v;
            w[n][m] = up * z * w[n - 1][m] - over * scale * before_w;
        }
    }
    (v, w)
}

fn factorial(n: usize) -> f64 {
    (1..=n).map(|k| k as f64).product()
}

#[cfg(test)]
mod tests {
    use super::super::mascons::minus;
    use super::super::test_bodies::prolate;
    use super::*;

    #[test]
    fn expansion_keeps_to_the_error_asked_for() {
        let mascons = Mascons::new(&prolate(500)).unwrap();
        for error in [1e-4, 1e-6, 1e-8] {
            let multipole = Multipole::new(&mascons, error);
            let mut worst = 0.0f64;
            for degree in 0..=MAX_DEGREE {
                for direction in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.3, -0.5, 0.8], [-0.6, 0.1, -0.2]] {
                    let at = direction.map(|c| c / norm(direction) * multipole.from_m[degree] * 1.0001);
                    let exact = mascons.acceleration(at);
                    let found = multipole.acceleration(at).unwrap();
                    worst = worst.max(norm(minus(found, exact)) / norm(exact));
                }
            }
            assert!(worst < error && worst > 1e-3 * error, "{error}: {worst}");
        }
        assert_eq!(Multipole::new(&mascons, 1e-8).acceleration([0.0, 0.0, 800.0]), None);
    }
}
