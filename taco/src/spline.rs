//! Cubic splines of functions that are even or odd about each end of their interval.

/// How the function goes on beyond both ends of its interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Symmetry {
    /// Mirrored: zero slope at the ends.
    Even,
    /// Mirrored with its sign changed: zero value (the caller's business) and zero curvature at the ends.
    Odd,
    /// Even about the first end and odd about the last.
    EvenOdd,
}

impl Symmetry {
    /// Whether the function is even about the end at node `k` (the first or the last).
    fn is_even_at(self, k: usize) -> bool {
        self == Self::Even || (self == Self::EvenOdd && k == 0)
    }
}

/// The equations of the second derivatives `m`: `lower m[k-1] + diagonal m[k] + upper m[k+1] = right-hand side`.
fn row(x: &[f64], k: usize, symmetry: Symmetry) -> [f64; 3] {
    let n = x.len();
    let h = |k: usize| x[k + 1] - x[k];
    if k > 0 && k < n - 1 {
        [h(k - 1), 2.0 * (h(k - 1) + h(k)), h(k)]
    } else if !symmetry.is_even_at(k) {
        [0.0, 1.0, 0.0]
    } else if k == 0 {
        [0.0, 2.0 * h(0), h(0)]
    } else {
        [h(n - 2), 2.0 * h(n - 2), 0.0]
    }
}

/// Whether the difference quotient left (right) of node `k` enters its right-hand side, `6 (right - left)`.
fn quotients(n: usize, k: usize, symmetry: Symmetry) -> [bool; 2] {
    let inner = k > 0 && k < n - 1;
    let even = symmetry.is_even_at(k);
    [inner || (even && k > 0), inner || (even && k == 0)]
}

/// Second derivatives at the nodes `x` (ascending, at least two) of the spline through `y`.
pub(crate) fn curvatures(x: &[f64], y: &[f64], symmetry: Symmetry) -> Vec<f64> {
    let n = x.len();
    let slope = |k: usize| (y[k + 1] - y[k]) / (x[k + 1] - x[k]);
    let right_hand_side = (0..n)
        .map(|k| {
            let [left, right] = quotients(n, k, symmetry);
            6.0 * (if right { slope(k) } else { 0.0 } - if left { slope(k - 1) } else { 0.0 })
        })
        .collect();
    solve((0..n).map(|k| row(x, k, symmetry)), right_hand_side)
}

/// Weights on the values that equal these weights on the second derivatives: the transpose of [`curvatures`].
pub(crate) fn weights_on_values(x: &[f64], on_curvatures: Vec<f64>, symmetry: Symmetry) -> Vec<f64> {
    let n = x.len();
    let transposed = (0..n).map(|k| {
        let lower = if k > 0 { row(x, k - 1, symmetry)[2] } else { 0.0 };
        let upper = if k + 1 < n { row(x, k + 1, symmetry)[0] } else { 0.0 };
        [lower, row(x, k, symmetry)[1], upper]
    });
    let v = solve(transposed, on_curvatures);
    let mut weights = vec![0.0; n];
    for k in 0..n {
        let [left, right] = quotients(n, k, symmetry);
        if right {
            let w = 6.0 * v[k] / (x[k + 1] - x[k]);
            weights[k + 1] += w;
            weights[k] -= w;
        }
        if left {
            let w = 6.0 * v[k] / (x[k] - x[k - 1]);
            weights[k] -= w;
            weights[k - 1] += w;
        }
    }
    weights
}

/// Solves a diagonally dominant tridiagonal system; `m` comes in as the right-hand side.
fn solve(rows: impl Iterator<Item = [f64; 3]>, mut m: Vec<f64>) -> Vec<f64> {
    let n = m.len();
    let mut upper = vec![0.0; n];
    for (k, [lower, diagonal, above]) in rows.enumerate() {
        let (u, v) = if k > 0 { (upper[k - 1], m[k - 1]) } else { (0.0, 0.0) };
        let pivot = diagonal - lower * u;
        upper[k] = above / pivot;
        m[k] = (m[k] - lower * v) / pivot;
    }
    for k in (0..n - 1).rev() {
        m[k] -= upper[k] * m[k + 1];
    }
    m
}

/// Weights of `y[0], y[1], m[0], m[1]` at the fraction `t` in [0, 1] of an interval of length `h`.
pub(crate) fn weights(h: f64, t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    let sixth = h * h / 6.0;
    [s, t, (s * s - 1.0) * s * sixth, (t * t - 1.0) * t * sixth]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn worst(n: usize, symmetry: Symmetry, f: impl Fn(f64) -> f64) -> f64 {
        // Uneven nodes.
        let x: Vec<f64> = (0..=n).map(|k| k as f64 / n as f64).map(|u| u + 0.1 * (6.0 * u * (1.0 - u)).sin()).collect();
        let x: Vec<f64> = x.iter().map(|v| v * std::f64::consts::PI).collect();
        let y: Vec<f64> = x.iter().map(|x| f(*x)).collect();
        let m = curvatures(&x, &y, symmetry);
        let mut worst = 0.0f64;
        for k in 0..n {
            for t in [0.0, 0.2, 0.5, 0.9, 1.0] {
                let [a, b, c, d] = weights(x[k + 1] - x[k], t);
                let got = a * y[k] + b * y[k + 1] + c * m[k] + d * m[k + 1];
                worst = worst.max((got - f(x[k] + t * (x[k + 1] - x[k]))).abs());
            }
        }
        worst
    }

    #[test]
    fn splines_converge_at_fourth_order() {
        for (symmetry, f) in [
            (Symmetry::Even, (|x: f64| (2.0 * x).cos()) as fn(f64) -> f64),
            (Symmetry::Odd, |x| (3.0 * x).sin()),
            (Symmetry::EvenOdd, |x| (2.5 * x).cos()),
        ] {
            let order = (worst(20, symmetry, f) / worst(40, symmetry, f)).log2();
            assert!((3.6..4.6).contains(&order), "{order}");
        }
    }

    #[test]
    fn weights_on_values_are_the_transpose() {
        let x = [0.0, 0.3, 0.4, 1.0, 1.7];
        let (y, w) = ([1.0, -2.0, 0.5, 3.0, 0.2], [0.7, 0.1, -0.4, 2.0, 1.1]);
        for symmetry in [Symmetry::Even, Symmetry::Odd, Symmetry::EvenOdd] {
            let direct: f64 = curvatures(&x, &y, symmetry).iter().zip(w).map(|(m, w)| m * w).sum();
            let values = weights_on_values(&x, w.to_vec(), symmetry);
            let transposed: f64 = values.iter().zip(y).map(|(v, y)| v * y).sum();
            assert!((direct - transposed).abs() < 1e-12 * direct.abs(), "{symmetry:?}: {direct} {transposed}");
        }
    }
}
