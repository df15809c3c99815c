//! Runge-Kutta steps of order 5 whose length follows from a tolerance, in the components of the spin vector.
//!
//! Source: Dormand & Prince (1980), J. Comput. Appl. Math. 6, 19, with the dense output of Hairer, Norsett & Wanner,
//! Solving Ordinary Differential Equations I (1993), II.6. The variables `p = omega cos epsilon`, `q = omega sin epsilon`
//! are regular at the poles and where the spin vanishes, which spin rate and obliquity are not.

use super::problem::{Dense, Point, Problem, Stepper, Taken, without_sliver};
use super::{CYCLE_END_OMEGA, SpinError, TorqueFunction};

/// Rows of the tableau; the last one is the fifth-order result.
const A: [&[f64]; 6] = [
    &[1.0 / 5.0],
    &[3.0 / 40.0, 9.0 / 40.0],
    &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
    &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
    &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
    &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
/// Times of the stages in units of the step.
const C: [f64; 6] = [1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0];
/// Fifth-order minus fourth-order weights.
const E: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339_200.0, 22.0 / 525.0, -1.0 / 40.0];
/// Weights of the fourth-power term of the dense output.
const D: [f64; 7] = [
    -12_715_105_075.0 / 11_282_082_432.0,
    0.0,
    87_487_479_700.0 / 32_700_410_799.0,
    -10_690_763_975.0 / 1_880_347_072.0,
    701_980_252_875.0 / 199_316_789_632.0,
    -1_453_857_185.0 / 822_651_844.0,
    69_997_945.0 / 29_380_423.0,
];

/// Largest change of the spin vector within one step, relative to its length. A looser tolerance shall not step over a
/// feature of a table with nodes 5 degrees apart, nor over two sign changes of a torque at once. From 1e-8 on upwards it
/// is what bounds the steps.
const LARGEST_CHANGE: f64 = 0.1;
/// Spin rate, rad/s, below which errors are no longer relative to the spin rate but to this.
const SMALLEST_SCALE: f64 = CYCLE_END_OMEGA;
/// More steps than any tolerance needs; a leg that takes more does not end.
const MAX_STEPS: u64 = 5_000_000;

/// Steps as long as the tolerance allows.
pub(super) struct Adaptive {
    /// Error allowed to one step, relative to the spin rate (so for the obliquity in rad).
    tolerance: f64,
    /// Change of the spin vector allowed to one step, relative to its length.
    largest_change: f64,
    /// Length to try next, s; 0 before the first step.
    next_s: f64,
    steps: u64,
}

impl Adaptive {
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, largest_change: LARGEST_CHANGE, next_s: 0.0, steps: 0 }
    }

    /// The next step from the spin vector `y`, `tau` seconds into the leg and at most `left` seconds long.
    pub fn advance<T: TorqueFunction>(
        &mut self,
        problem: &Problem<T>,
        tau: f64,
        y: [f64; 2],
        left: f64,
    ) -> Result<DormandPrince, SpinError> {
        let first = problem.vector_rates(tau, y)?;
        let length = norm(y).max(SMALLEST_SCALE);
        // Infinite for a body without torque, which then takes all that is left in one step.
        let longest = self.largest_change * length / norm(first);
        if self.next_s == 0.0 {
            self.next_s = 1e-2 * longest;
        }
        loop {
            let h = without_sliver(self.next_s.min(longest), left);
            self.steps += 1;
            if self.steps > MAX_STEPS || tau + h <= tau {
                return Err(SpinError::StepTooSmall { t_s: problem.t0 + tau, step_s: h, tolerance: self.tolerance });
            }
            let step = DormandPrince::new(problem, tau, y, first, h)?;
            let error = step.error() / (self.tolerance * length.max(norm(step.end())));
            // Fifth root, because the estimate is of the fourth-order result.
            let factor = (0.9 * error.powf(-0.2)).clamp(0.2, 5.0);
            if error <= 1.0 {
                // What is left may have cut the step: no reason to go on with small ones.
                self.next_s = (factor * h).max(if h == left { self.next_s } else { 0.0 });
                return Ok(step);
            }
            self.next_s = factor * h;
        }
    }
}

impl<T: TorqueFunction> Stepper<T> for Adaptive {
    type Step = DormandPrince;
    const WHOLE_STEPS: bool = false;

    fn step(
        &mut self,
        problem: &Problem<T>,
        tau: f64,
        from: &Point,
        left: f64,
    ) -> Result<Taken<DormandPrince>, SpinError> {
        let dense = self.advance(problem, tau, vector(from), left)?;
        let h = dense.h;
        let (omega, obliquity) = dense.at(1.0);
        Ok(Taken { end: problem.point(tau + h, omega, obliquity)?, h, dense })
    }

    fn exactly(&self, problem: &Problem<T>, tau: f64, from: &Point, h: f64) -> Result<Point, SpinError> {
        let y = vector(from);
        let (omega, obliquity) = DormandPrince::new(problem, tau, y, problem.vector_rates(tau, y)?, h)?.at(1.0);
        problem.point(tau + h, omega, obliquity)
    }

    fn finer(&self) -> (Self, f64) {
        // The error of the fifth-order result goes with the tolerance, or with the fifth power of steps that are bounded
        // by the change they make: a tenth of it is left.
        let largest_change = self.largest_change * 0.1_f64.powf(0.2);
        (Self { largest_change, ..Self::new(0.1 * self.tolerance) }, 10.0 / 9.0)
    }
}

/// One step with its dense output.
pub(super) struct DormandPrince {
    /// Length, s.
    pub h: f64,
    /// Coefficients of the dense output; the first is the start.
    course: [[f64; 2]; 5],
    /// Difference between the results of order 5 and 4.
    difference: [f64; 2],
}

impl DormandPrince {
    /// From `y` with the rates `first` there.
    fn new<T: TorqueFunction>(
        problem: &Problem<T>,
        tau: f64,
        y: [f64; 2],
        first: [f64; 2],
        h: f64,
    ) -> Result<Self, SpinError> {
        let mut k = [first; 7];
        let mut end = y;
        for (stage, (row, c)) in A.iter().zip(C).enumerate() {
            let change = combined(row, &k[..=stage]);
            end = [y[0] + h * change[0], y[1] + h * change[1]];
            k[stage + 1] = problem.vector_rates(tau + c * h, end)?;
        }
        let (high, last) = (combined(&D, &k), k[6]);
        let pairs = [0, 1].map(|i| {
            let rise = end[i] - y[i];
            let bend = h * first[i] - rise;
            [y[i], rise, bend, rise - h * last[i] - bend, h * high[i]]
        });
        let course = [0, 1, 2, 3, 4].map(|c| [pairs[0][c], pairs[1][c]]);
        let difference = combined(&E, &k).map(|e| h * e);
        Ok(Self { h, course, difference })
    }

    /// The spin vector at the fraction `theta` of the step.
    pub fn vector_at(&self, theta: f64) -> [f64; 2] {
        let rest = 1.0 - theta;
        let [c0, c1, c2, c3, c4] = self.course;
        [0, 1].map(|i| c0[i] + theta * (c1[i] + rest * (c2[i] + theta * (c3[i] + rest * c4[i]))))
    }

    fn end(&self) -> [f64; 2] {
        self.vector_at(1.0)
    }

    fn error(&self) -> f64 {
        norm(self.difference)
    }
}

impl Dense for DormandPrince {
    fn at(&self, theta: f64) -> (f64, f64) {
        let [p, q] = self.vector_at(theta);
        (p.hypot(q), q.atan2(p))
    }
}

fn vector(p: &Point) -> [f64; 2] {
    let (sin, cos) = p.obliquity.sin_cos();
    [p.omega * cos, p.omega * sin]
}

fn norm([p, q]: [f64; 2]) -> f64 {
    p.hypot(q)
}

fn combined(weights: &[f64], k: &[[f64; 2]]) -> [f64; 2] {
    let component = |i: usize| weights.iter().zip(k).map(|(w, k)| w * k[i]).sum();
    [component(0), component(1)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tableau_is_consistent() {
        for (row, c) in A.iter().zip(C) {
            assert!((row.iter().sum::<f64>() - c).abs() < 1e-14);
        }
        assert!(E.iter().sum::<f64>().abs() < 1e-16 && D.iter().sum::<f64>().abs() < 1e-15);
        // Order 5: the quadrature condition sum b c^4 = 1/5 of the result's weights.
        let nodes = [0.0, C[0], C[1], C[2], C[3], C[4]];
        let fourth: f64 = A[5].iter().zip(nodes).map(|(b, c)| b * c * c * c * c).sum();
        assert!((fourth - 0.2).abs() < 1e-15);
    }
}
