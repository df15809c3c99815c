//! Periodic surface temperature from the balance of emission, conduction and sunlight, `T |T|^3 + theta K T = f`.
//!
//! Newton's method; each linear step `(D + theta K) d = r`, `D = 4 |T|^3`, by GMRES (Saad & Schultz 1986) with the
//! product `(c + D)(c + theta K) / 2c` as its right preconditioner (Peaceman & Rachford 1955): `D` is diagonal in time, `K`
//! in frequency. Emission grows with temperature and `K` is positive, so the solution is unique, and `T^4` is convex, so
//! Newton's steps hardly ever need to be shortened. `|T|^3` instead of `T^3` keeps them defined where a step undershoots a
//! cold night; the solution itself is positive up to the cells' resolution.

/// A body that conducts heat: the flux into it as a linear function of the temperature of its surface.
pub(crate) trait Conductor {
    /// `out = K x`.
    fn conduct(&mut self, x: &[f64], out: &mut [f64]);
    /// Makes [`Self::divide`] ready for these numbers.
    fn prepare(&mut self, c: f64, theta: f64);
    /// `out = (c + theta K)^-1 x`.
    fn divide(&mut self, x: &[f64], out: &mut [f64]);
}

/// Krylov vectors of one linear solution.
const KRYLOV: usize = 16;
/// Newton steps at most; a warm start takes two or three.
const STEPS: usize = 60;
/// What a linear solution leaves of the residual.
const INNER: f64 = 0.03;

/// Buffers of the solution.
#[derive(Debug)]
pub(crate) struct Balance {
    residual: Vec<f64>,
    trial: Vec<f64>,
    slope: Vec<f64>,
    step: Vec<f64>,
    work: Vec<f64>,
    basis: Vec<f64>,
    /// Upper triangle that the rotations leave, column by column.
    triangle: [[f64; KRYLOV]; KRYLOV],
}

impl Balance {
    /// For `len` temperatures.
    pub fn new(len: usize) -> Self {
        let zero = || vec![0.0; len];
        Self {
            residual: zero(),
            trial: zero(),
            slope: zero(),
            step: zero(),
            work: zero(),
            basis: vec![0.0; (KRYLOV + 1) * len],
            triangle: [[0.0; KRYLOV]; KRYLOV],
        }
    }

    /// Solves for `x`, which comes in as a guess, until the root mean square of the residual is below `tolerance`; the mean
    /// of `f` should be about 1. Returns the conducted flux `theta K x` in `flux`, and how many Newton steps it took.
    pub fn solve(
        &mut self,
        conductor: &mut impl Conductor,
        theta: f64,
        f: &[f64],
        tolerance: f64,
        x: &mut [f64],
        flux: &mut [f64],
    ) -> usize {
        let n = x.len();
        // Round-off of the conducted flux, which nothing can go below.
        let tolerance = tolerance.max(2e-15 * theta * (n as f64).sqrt()) * (n as f64).sqrt();
        let mut norm = self.evaluate(conductor, theta, f, x, flux);
        for steps in 0..STEPS {
            if norm <= tolerance {
                return steps;
            }
            let (mut low, mut high) = (f64::INFINITY, 0.0f64);
            for (slope, x) in self.slope.iter_mut().zip(&*x) {
                *slope = (4.0 * x * x * x.abs()).max(1e-12);
                low = low.min(*slope);
                high = high.max(*slope);
            }
            // A cold night is kept by conduction, so that nothing below theta counts.
            let c = (low.max(theta) * high).sqrt().min(high);
            conductor.prepare(c, theta);
            self.linear(conductor, c, norm, (0.3 * tolerance / norm).max(INNER * norm.min(1.0)).min(INNER));
            let before = norm;
            let mut fraction = 1.0;
            loop {
                for ((trial, x), step) in self.trial.iter_mut().zip(&*x).zip(&self.step) {
                    *trial = x - fraction * step;
                }
                let trial = std::mem::take(&mut self.trial);
                norm = self.evaluate(conductor, theta, f, &trial, flux);
                self.trial = trial;
                if norm < before || fraction < 1e-3 {
                    break;
                }
                fraction *= 0.5;
            }
            if norm >= before {
                // Round-off: what there was is as good as it gets.
                self.evaluate(conductor, theta, f, x, flux);
                return steps;
            }
            x.copy_from_slice(&self.trial);
        }
        STEPS
    }

    /// The residual at `x`, its norm, and the conducted flux.
    fn evaluate(&mut self, conductor: &mut impl Conductor, theta: f64, f: &[f64], x: &[f64], flux: &mut [f64]) -> f64 {
        conductor.conduct(x, flux);
        let mut square = 0.0;
        for (((residual, flux), x), f) in self.residual.iter_mut().zip(flux).zip(x).zip(f) {
            *flux *= theta;
            *residual = x * x * (x * x.abs()) + *flux - f;
            square += *residual * *residual;
        }
        square.sqrt()
    }

    /// `step = (D + theta K)^-1 residual` until the residual has come down by `reduction`.
    fn linear(&mut self, conductor: &mut impl Conductor, c: f64, norm: f64, reduction: f64) {
        let n = self.residual.len();
        let Self { residual, slope, step, work, basis, triangle, .. } = self;
        for (v, r) in basis[..n].iter_mut().zip(&*residual) {
            *v = r / norm;
        }
        let mut rotations = [[0.0; 2]; KRYLOV];
        let mut right = [0.0; KRYLOV + 1];
        right[0] = norm;
        let mut used = 0;
        for j in 0..KRYLOV {
            let (known, new) = basis.split_at_mut((j + 1) * n);
            let new = &mut new[..n];
            // u = 2c (c + D)^-1 v; w = (c + theta K)^-1 u; (D + theta K) w = u + (D - c) w.
            for ((w, v), d) in work.iter_mut().zip(&known[j * n..]).zip(&*slope) {
                *w = 2.0 * c / (c + d) * v;
            }
            conductor.divide(work, new);
            for ((v, u), d) in new.iter_mut().zip(&*work).zip(&*slope) {
                *v = u + (d - c) * *v;
            }
            let mut column = [0.0; KRYLOV + 1];
            for (h, old) in column.iter_mut().zip(known.chunks_exact(n)) {
                *h = dot(old, new);
                for (v, o) in new.iter_mut().zip(old) {
                    *v -= *h * o;
                }
            }
            let length = dot(new, new).sqrt();
            for (k, [cos, sin]) in rotations[..j].iter().enumerate() {
                let (above, below) = (column[k], column[k + 1]);
                column[k] = cos * above + sin * below;
                column[k + 1] = cos * below - sin * above;
            }
            let hypotenuse = column[j].hypot(length);
            if hypotenuse == 0.0 {
                break;
            }
            let [cos, sin] = [column[j] / hypotenuse, length / hypotenuse];
            rotations[j] = [cos, sin];
            column[j] = hypotenuse;
            triangle[j].copy_from_slice(&column[..KRYLOV]);
            right[j + 1] = -sin * right[j];
            right[j] *= cos;
            used = j + 1;
            if right[j + 1].abs() <= reduction * norm || length == 0.0 {
                break;
            }
            new.iter_mut().for_each(|v| *v /= length);
        }
        work.fill(0.0);
        for j in (0..used).rev() {
            right[j] /= triangle[j][j];
            for k in 0..j {
                right[k] -= triangle[j][k] * right[j];
            }
            for (w, v) in work.iter_mut().zip(&basis[j * n..(j + 1) * n]) {
                *w += right[j] * v;
            }
        }
        for (w, d) in work.iter_mut().zip(&*slope) {
            *w *= 2.0 * c / (c + d);
        }
        conductor.divide(work, step);
    }
}

/// Sum of products in a fixed order of four partial sums.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = a4.remainder().iter().zip(b4.remainder()).map(|(a, b)| a * b).sum();
    let mut sums = [0.0; 4];
    for (a, b) in a4.zip(b4) {
        for k in 0..4 {
            sums[k] += a[k] * b[k];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}
