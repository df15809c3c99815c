//! Classical fourth-order Runge-Kutta steps of fixed length in spin rate and obliquity, as Cotto-Figueroa et al. (2015,
//! ApJ 803, 25, section 2.4.3) take them, with cubic Hermite interpolation inside a step.

use super::problem::{Dense, Point, Problem, Stepper, Taken, without_sliver};
use super::{SpinError, TorqueFunction};

/// Largest turn of the obliquity within one step, rad. Near zero spin `d epsilon/dt ~ 1/omega` runs away.
const OBLIQUITY_STEP: f64 = 0.01;
/// Largest relative change of the spin rate within one step.
const SPIN_STEP: f64 = 0.05;
/// Largest step in units of the relaxation time towards a stable obliquity. RK4 is stable up to 2.78 of them; a body
/// that sits there has no `T_epsilon` left by which [`OBLIQUITY_STEP`] could notice the stiffness.
const RELAXATION_STEP: f64 = 0.5;

/// Steps of one length, cut only where the equations would not bear it.
pub(super) struct Rk4 {
    step_s: f64,
    /// Factor on the other bounds of the step: 1, or less for a control run.
    fineness: f64,
}

impl Rk4 {
    pub fn new(step_s: f64) -> Self {
        Self { step_s, fineness: 1.0 }
    }

    /// Step length, s, not more than what is left.
    fn length<T: TorqueFunction>(&self, problem: &Problem<T>, p: &Point, left: f64) -> f64 {
        let turn = self.fineness * OBLIQUITY_STEP / p.obliquity_rate.abs();
        let change = self.fineness * SPIN_STEP * p.omega / p.omega_rate.abs();
        let relaxation = self.fineness * RELAXATION_STEP * problem.inertia * p.omega / problem.slope;
        // A vanishing rate makes its bound infinite; 0/0 cannot occur since omega > 0. The floor keeps the clock moving
        // under an absurd torque: it stops as not finite, it does not hang.
        let h = self.step_s.min(turn).min(change).min(relaxation).max(1e-9 * self.step_s);
        without_sliver(h, left)
    }
}

impl<T: TorqueFunction> Stepper<T> for Rk4 {
    type Step = Hermite;
    const WHOLE_STEPS: bool = true;

    fn step(&mut self, problem: &Problem<T>, tau: f64, from: &Point, left: f64) -> Result<Taken<Hermite>, SpinError> {
        let h = self.length(problem, from, left);
        let end = self.exactly(problem, tau, from, h)?;
        Ok(Taken { end, h, dense: Hermite { start: *from, end, h } })
    }

    fn exactly(&self, problem: &Problem<T>, tau: f64, p: &Point, h: f64) -> Result<Point, SpinError> {
        let stage = |q: &Point, dt: f64| {
            problem.point(tau + dt, p.omega + dt * q.omega_rate, p.obliquity + dt * q.obliquity_rate)
        };
        let k2 = stage(p, 0.5 * h)?;
        let k3 = stage(&k2, 0.5 * h)?;
        let k4 = stage(&k3, h)?;
        let mean = |a: f64, b: f64, c: f64, d: f64| h / 6.0 * (a + 2.0 * (b + c) + d);
        problem.point(
            tau + h,
            p.omega + mean(p.omega_rate, k2.omega_rate, k3.omega_rate, k4.omega_rate),
            p.obliquity + mean(p.obliquity_rate, k2.obliquity_rate, k3.obliquity_rate, k4.obliquity_rate),
        )
    }

    fn finer(&self) -> (Self, f64) {
        // Fourth order: halving the step leaves a sixteenth of the error.
        (Self { step_s: 0.5 * self.step_s, fineness: 0.5 * self.fineness }, 16.0 / 15.0)
    }
}

/// The cubics through the states and rates at both ends of a step.
pub(super) struct Hermite {
    start: Point,
    end: Point,
    h: f64,
}

impl Dense for Hermite {
    fn at(&self, theta: f64) -> (f64, f64) {
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
}
