//! Where inside a Runge-Kutta step something happens: cubic Hermite interpolation between its ends, and bisection.

/// State and rates at one end of a step. The obliquity may lie a little outside `[0, pi]` here.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    /// Spin rate, rad/s.
    pub omega: f64,
    /// Obliquity, rad, unfolded.
    pub obliquity: f64,
    /// `d omega/dt`, rad/s^2.
    pub omega_rate: f64,
    /// `d epsilon/dt`, rad/s.
    pub obliquity_rate: f64,
}

/// A step between two points, `h` seconds long.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    pub start: Point,
    pub end: Point,
    pub h: f64,
}

impl Step {
    /// `(omega, obliquity)` at the fraction `theta` of the step.
    pub fn at(&self, theta: f64) -> (f64, f64) {
        let (a, b, h) = (&self.start, &self.end, self.h);
        (
            hermite(a.omega, a.omega_rate * h, b.omega, b.omega_rate * h, theta),
            hermite(a.obliquity, a.obliquity_rate * h, b.obliquity, b.obliquity_rate * h, theta),
        )
    }
}

/// Cubic with given values and slopes (per unit of `theta`) at 0 and 1.
fn hermite(y0: f64, d0: f64, y1: f64, d1: f64, theta: f64) -> f64 {
    let rise = y1 - y0;
    // Written as a correction of the start value: a tiny change of a large number keeps its digits.
    y0 + theta * (d0 + theta * ((3.0 * rise - 2.0 * d0 - d1) + theta * (d0 + d1 - 2.0 * rise)))
}

/// Smallest fraction in `[0, hi]` at which `happened` holds, to 1e-12; it must hold at `hi`.
pub(super) fn locate(happened: impl Fn(f64) -> bool, hi: f64) -> f64 {
    let (mut lo, mut hi) = (0.0, hi);
    while hi - lo > 1e-12 {
        let middle = 0.5 * (lo + hi);
        if happened(middle) { hi = middle } else { lo = middle }
    }
    hi
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hermite_reproduces_a_cubic() {
        let f = |x: f64| 2.0 - x + 3.0 * x * x - 0.5 * x * x * x;
        let d = |x: f64| -1.0 + 6.0 * x - 1.5 * x * x;
        for theta in [0.0, 0.2, 0.5, 0.9, 1.0] {
            assert!((hermite(f(0.0), d(0.0), f(1.0), d(1.0), theta) - f(theta)).abs() < 1e-14);
        }
    }

    #[test]
    fn bisection_finds_the_edge_to_1e_minus_12() {
        assert!((locate(|x| x >= 0.3, 1.0) - 0.3).abs() < 1e-12);
        assert!(locate(|_| true, 1.0) < 1e-11);
    }
}
