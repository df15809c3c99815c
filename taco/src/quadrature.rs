//! Gauss-Legendre rules and cubic tables on [0, 1].

use gauss_quad::GaussLegendre;
use std::num::NonZeroUsize;

/// Nodes and weights of the `n`-point Gauss-Legendre rule on [-1, 1], nodes ascending; `n` >= 1.
pub(crate) fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    let degree = NonZeroUsize::new(n).expect("callers ask for at least one point");
    GaussLegendre::new(degree).as_node_weight_pairs().to_vec()
}

/// `C` functions on [0, 1] tabulated at equal steps and interpolated by cubics through the four nearest nodes.
///
/// The polynomials are stored rather than the nodes: one lookup serves all functions and costs three multiply-adds each.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CubicTable<const C: usize> {
    /// `[interval][power][function]`, in the variable that runs from 0 to 1 over the interval.
    coefficients: Vec<[[f64; C]; 4]>,
}

impl<const C: usize> CubicTable<C> {
    /// Table through `nodes`, at least four, the first at 0 and the last at 1.
    pub fn new(nodes: &[[f64; C]]) -> Self {
        let intervals = nodes.len() - 1;
        let coefficients = (0..intervals)
            .map(|k| {
                // Leftmost of the four nodes; the outer intervals use the same four as their neighbours.
                let first = k.saturating_sub(1).min(intervals - 3);
                let mut cubic = [[0.0; C]; 4];
                for (c, y) in (0..C).map(|c| (c, [0, 1, 2, 3].map(|j| nodes[first + j][c]))) {
                    let powers = cubic_through(y, (k - first) as f64);
                    for p in 0..4 {
                        cubic[p][c] = powers[p];
                    }
                }
                cubic
            })
            .collect();
        Self { coefficients }
    }

    /// The functions at `x`, which is clamped to [0, 1].
    #[inline(always)]
    pub fn at(&self, x: f64) -> [f64; C] {
        let intervals = self.coefficients.len();
        let scaled = x.clamp(0.0, 1.0) * intervals as f64;
        let k = (scaled as usize).min(intervals - 1);
        let t = scaled - k as f64;
        let [c0, c1, c2, c3] = &self.coefficients[k];
        std::array::from_fn(|c| c0[c] + t * (c1[c] + t * (c2[c] + t * c3[c])))
    }
}

/// Coefficients, in powers of `t`, of the cubic through `(j, y[j])`, j = 0..3, with `t` counted from `origin`.
fn cubic_through(y: [f64; 4], origin: f64) -> [f64; 4] {
    // Newton's divided differences, then shifted to the origin.
    let d1 = y[1] - y[0];
    let d2 = (y[2] - 2.0 * y[1] + y[0]) / 2.0;
    let d3 = (y[3] - 3.0 * (y[2] - y[1]) - y[0]) / 6.0;
    let (a, b, c) = (origin, origin - 1.0, origin - 2.0);
    // y0 + d1 (t+a) + d2 (t+a)(t+b) + d3 (t+a)(t+b)(t+c)
    [
        y[0] + d1 * a + d2 * a * b + d3 * a * b * c,
        d1 + d2 * (a + b) + d3 * (a * b + a * c + b * c),
        d2 + d3 * (a + b + c),
        d3,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rule_is_exact_for_polynomials() {
        let sum: f64 = gauss_legendre(8).iter().map(|(x, w)| w * x.powi(14)).sum();
        assert!((sum - 2.0 / 15.0).abs() < 1e-15);
    }

    #[test]
    fn table_reproduces_cubics_and_converges_at_fourth_order() {
        let cubic = |x: f64| 1.0 - 2.0 * x + 3.0 * x * x - 4.0 * x * x * x;
        let error = |n: usize| {
            let nodes: Vec<_> = (0..=n).map(|k| k as f64 / n as f64).map(|x| [cubic(x), (3.0 * x).sin()]).collect();
            let table = CubicTable::new(&nodes);
            (0..=1000).map(|k| f64::from(k) / 1000.0).fold((0.0f64, 0.0f64), |worst, x| {
                let [p, s] = table.at(x);
                (worst.0.max((p - cubic(x)).abs()), worst.1.max((s - (3.0 * x).sin()).abs()))
            })
        };
        assert!(error(3).0 < 1e-14 && error(20).0 < 1e-14);
        let order = (error(20).1 / error(40).1).log2();
        assert!((3.7..4.5).contains(&order), "{order}");
    }
}
