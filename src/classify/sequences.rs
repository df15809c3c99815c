//! Figures of equilibrium of a turning fluid, with which the shapes of aggregates are compared.
//!
//! Source: Chandrasekhar (1969), Ellipsoidal Figures of Equilibrium, sections 32 and 39: Maclaurin spheroids and Jacobi
//! ellipsoids; the integrals A_i by Carlson (1995), Numerical Algorithms 10, 13. The paper's Figure 16 draws the Jacobi
//! ellipsoids over the triaxiality T and c/a. Semi-axes a >= b >= c are in units of a.

/// Triaxiality of axis ratios (equation 4 of Cotto-Figueroa et al. 2015): 0 for an oblate body, 1 for a prolate one;
/// `None` for a sphere.
///
/// # Examples
/// ```
/// use yorp::classify::triaxiality;
/// assert_eq!(triaxiality(1.0, 0.8), Some(0.0));
/// assert_eq!(triaxiality(0.5, 0.5), Some(1.0));
/// assert_eq!(triaxiality(1.0, 1.0), None);
/// ```
pub fn triaxiality(b_over_a: f64, c_over_a: f64) -> Option<f64> {
    let flattening = 1.0 - c_over_a * c_over_a;
    (flattening > 0.0).then(|| (1.0 - b_over_a * b_over_a) / flattening)
}

/// A fluid ellipsoid in equilibrium.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figure {
    /// Ratio of the axes in the equator.
    pub b_over_a: f64,
    /// Ratio of the polar axis to the long one.
    pub c_over_a: f64,
    /// Square of its spin rate over pi G rho.
    pub spin_squared: f64,
}

impl Figure {
    /// The Maclaurin spheroid of that flattening, `0 < c_over_a < 1`.
    pub fn maclaurin(c_over_a: f64) -> Self {
        Self::turning(1.0, c_over_a)
    }

    /// The Jacobi ellipsoid with that ratio in the equator, `0 < b_over_a < 1`.
    pub fn jacobi(b_over_a: f64) -> Self {
        // Its polar axis is where a^2 b^2 (A_y - A_x) / (a^2 - b^2) = c^2 A_z.
        let excess = |c: f64| {
            let [x, y, z] = index_symbols(b_over_a, c);
            b_over_a.powi(2) * (y - x) / (1.0 - b_over_a.powi(2)) - c * c * z
        };
        let (mut low, mut high) = (0.0, b_over_a);
        // Halved to the last digit.
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if excess(middle) > 0.0 { low = middle } else { high = middle }
        }
        Self::turning(b_over_a, 0.5 * (low + high))
    }

    fn turning(b_over_a: f64, c_over_a: f64) -> Self {
        let [x, _, z] = index_symbols(b_over_a, c_over_a);
        Self { b_over_a, c_over_a, spin_squared: 2.0 * (x - c_over_a.powi(2) * z) }
    }

    /// Triaxiality, 0 to 1.
    pub fn triaxiality(&self) -> f64 {
        triaxiality(self.b_over_a, self.c_over_a).expect("c < a")
    }
}

/// The Jacobi ellipsoids from the bifurcation, T = 0, to a needle, T = 1.
#[derive(Debug, Clone, PartialEq)]
pub struct JacobiSequence {
    /// Triaxiality, ascending, and c/a.
    points: Vec<[f64; 2]>,
}

/// Figures on the way; straight lines between them are within 1e-4 in c/a up to T = 0.999 (tested).
const FIGURES: usize = 200;
/// b/a of the first one: so close to a spheroid that c/a is that of the bifurcation to ten digits, but still apart from it,
/// where the equation of its polar axis is 0/0.
const NEARLY_ROUND: f64 = 1.0 - 1e-6;

impl JacobiSequence {
    /// Solves for the figures.
    pub fn new() -> Self {
        let figure = |i: usize| {
            let figure = Figure::jacobi(NEARLY_ROUND.min(1.0 - i as f64 / FIGURES as f64));
            [figure.triaxiality(), figure.c_over_a]
        };
        let mut points: Vec<_> = (0..FIGURES).map(figure).collect();
        points[0][0] = 0.0;
        points.push([1.0, 0.0]);
        Self { points }
    }

    /// Triaxiality and c/a of figures along the sequence, from T = 0 to T = 1: the curve to draw.
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// c/a of the Jacobi ellipsoid with that triaxiality, which is taken into 0 to 1.
    pub fn c_over_a(&self, triaxiality: f64) -> f64 {
        let t = triaxiality.clamp(0.0, 1.0);
        let next = self.points.partition_point(|p| p[0] <= t).clamp(1, self.points.len() - 1);
        let ([t0, c0], [t1, c1]) = (self.points[next - 1], self.points[next]);
        c0 + (c1 - c0) * (t - t0) / (t1 - t0)
    }

    /// Whether a body lies below the sequence in the plane of T and c/a, flatter than the Jacobi ellipsoid of its
    /// triaxiality; a sphere does not.
    pub fn has_below(&self, b_over_a: f64, c_over_a: f64) -> bool {
        triaxiality(b_over_a, c_over_a).is_some_and(|t| c_over_a < self.c_over_a(t))
    }
}

impl Default for JacobiSequence {
    fn default() -> Self {
        Self::new()
    }
}

/// The integrals A_x, A_y, A_z of an ellipsoid with a = 1; their sum is 2.
fn index_symbols(b: f64, c: f64) -> [f64; 3] {
    let (b2, c2) = (b * b, c * c);
    let scale = 2.0 / 3.0 * b * c;
    [scale * carlson_rd(b2, c2, 1.0), scale * carlson_rd(1.0, c2, b2), scale * carlson_rd(1.0, b2, c2)]
}

/// Carlson's symmetric elliptic integral of the second kind, R_D(x, y, z), for x, y >= 0, at most one zero, and z > 0.
fn carlson_rd(x: f64, y: f64, z: f64) -> f64 {
    let mut v = [x, y, z];
    let mean0 = (x + y + 3.0 * z) / 5.0;
    let mut mean = mean0;
    let (mut sum, mut quarter) = (0.0, 1.0);
    let spread = v.iter().map(|p| (mean0 - p).abs()).fold(0.0, f64::max);
    // The series below leaves a relative error of spread^6 over its argument: round-off from here on.
    while quarter * spread > 2e-3 * mean.abs() {
        let [a, b, c] = v.map(f64::sqrt);
        let lambda = a * b + a * c + b * c;
        sum += quarter / (c * (v[2] + lambda));
        quarter /= 4.0;
        v = v.map(|p| (p + lambda) / 4.0);
        mean = (mean + lambda) / 4.0;
    }
    let [dx, dy] = [x, y].map(|p| quarter * (mean0 - p) / mean);
    let dz = -(dx + dy) / 3.0;
    let e2 = dx * dy - 6.0 * dz * dz;
    let e3 = (3.0 * dx * dy - 8.0 * dz * dz) * dz;
    let e4 = 3.0 * (dx * dy - dz * dz) * dz * dz;
    let e5 = dx * dy * dz.powi(3);
    let series = 1.0 - 3.0 * e2 / 14.0 + e3 / 6.0 + 9.0 * e2 * e2 / 88.0 - 3.0 * e4 / 22.0 - 9.0 * e2 * e3 / 52.0
        + 3.0 * e5 / 26.0;
    quarter * series / mean.powf(1.5) + 3.0 * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_close(found: f64, expected: f64, tolerance: f64) {
        assert!((found - expected).abs() < tolerance, "{found} is not {expected} within {tolerance}");
    }

    #[test]
    fn index_symbols_sum_to_two_and_are_thirds_for_a_sphere() {
        for [b, c] in [[0.9, 0.3], [1.0, 1e-3], [0.05, 0.04], [1.0, 1.0]] {
            assert_close(index_symbols(b, c).iter().sum::<f64>(), 2.0, 1e-13);
        }
        assert!(index_symbols(1.0, 1.0).iter().all(|a| (a - 2.0 / 3.0).abs() < 1e-15));
    }

    /// Carlson (1995), section 5: R_D(0, 2, 1) and R_D(2, 3, 4).
    #[test]
    fn ref_carlson_printed_values() {
        assert_close(carlson_rd(0.0, 2.0, 1.0), 1.797_210_352_103_388_3, 1e-14);
        assert_close(carlson_rd(2.0, 3.0, 4.0), 0.165_105_272_942_610_53, 1e-15);
    }

    /// Chandrasekhar (1969), Tables I, IV and XVI: bifurcation, fission limit, a Maclaurin spheroid and the fastest one.
    #[test]
    fn paper_chandrasekhar_sequences() {
        let bifurcation = Figure::jacobi(NEARLY_ROUND);
        assert_close(bifurcation.c_over_a, 0.582_724, 1e-6);
        assert_close(bifurcation.spin_squared, 0.374_230, 1e-6);
        let fission = Figure::jacobi(0.432_232);
        assert_close(fission.c_over_a, 0.3451, 5e-5);
        assert_close(fission.spin_squared, 0.284_030, 1e-6);
        assert_close(Figure::maclaurin(0.5).spin_squared, 0.418_399, 1e-6);
        let fastest = (1..10_000).map(|i| Figure::maclaurin(f64::from(i) * 1e-4));
        let fastest = fastest.max_by(|a, b| a.spin_squared.total_cmp(&b.spin_squared)).unwrap();
        assert_close(fastest.c_over_a, 0.3677, 1.1e-4);
        assert_close(fastest.spin_squared, 0.449_331, 1e-6);
    }

    /// The Jacobi curve of the paper's Figure 16, solved elsewhere to four digits.
    #[test]
    fn jacobi_curve_over_triaxiality() {
        let curve = JacobiSequence::new();
        let expected = [0.5827, 0.5726, 0.5612, 0.5482, 0.5333, 0.5156, 0.4940, 0.4665, 0.4285, 0.3670];
        for (i, c_over_a) in expected.into_iter().enumerate() {
            assert_close(curve.c_over_a(0.1 * i as f64), c_over_a, 1e-4);
        }
        assert_eq!((curve.c_over_a(1.0), curve.c_over_a(2.0)), (0.0, 0.0));
        assert!(curve.points().is_sorted_by(|p, q| p[0] < q[0] && p[1] > q[1]));
    }

    #[test]
    fn lines_between_figures_are_within_1e_minus_4_of_the_curve() {
        let curve = JacobiSequence::new();
        for i in 100..1000 {
            let figure = Figure::jacobi(f64::from(i) / 1000.0);
            assert_close(curve.c_over_a(figure.triaxiality()), figure.c_over_a, 1e-4);
        }
    }

    #[test]
    fn a_long_flat_body_is_below_the_sequence_and_a_round_one_is_not() {
        let curve = JacobiSequence::new();
        assert!(curve.has_below(0.5, 0.3) && !curve.has_below(0.7, 0.7) && !curve.has_below(1.0, 1.0));
    }
}
