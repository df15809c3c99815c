//! The spin equations of one leg as every integrator sees them: torque, inertia, clock, and what a step has to offer.
//!
//! Source: Rubincam (2000), Icarus 148, 2, in spin rate and obliquity, and in the components of the spin vector.

use std::f64::consts::{PI, TAU};

use super::{SpinError, TorqueFunction};

/// Torque, inertia and clock: all that the right-hand side needs.
pub(super) struct Problem<'a, T> {
    pub torque: &'a T,
    /// Moment of inertia about the spin axis, kg m^2.
    pub inertia: f64,
    /// Time at the start of the leg, s.
    pub t0: f64,
    /// Largest `|d T_epsilon / d epsilon|` at the start of the leg, N m/rad.
    pub slope: f64,
}

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

/// A step that was taken.
pub(super) struct Taken<D> {
    /// State at its end.
    pub end: Point,
    /// Length, s.
    pub h: f64,
    /// The way there.
    pub dense: D,
}

/// The course of the state within a step.
pub(super) trait Dense {
    /// `(omega, obliquity)` at the fraction `theta` of the step; the obliquity is unfolded.
    fn at(&self, theta: f64) -> (f64, f64);
}

/// A way to take steps.
pub(super) trait Stepper<T: TorqueFunction>: Sized {
    /// The course within a step.
    type Step: Dense;
    /// Whether steps are taken whole where the time is up within them. Events found on a step that was cut differ in the
    /// last digits, and a run that stops at a time and goes on later must be the one that never stopped.
    const WHOLE_STEPS: bool;

    /// One step from `from`, `tau` seconds into the leg, not longer than `left` seconds.
    fn step(&mut self, problem: &Problem<T>, tau: f64, from: &Point, left: f64)
    -> Result<Taken<Self::Step>, SpinError>;

    /// The state after exactly `h` seconds, which is not more than a step.
    fn exactly(&self, problem: &Problem<T>, tau: f64, from: &Point, h: f64) -> Result<Point, SpinError>;

    /// The same with finer steps, and the error of this one in units of the difference to it.
    fn finer(&self) -> (Self, f64);
}

/// Brings an obliquity that left `[0, pi]` back: the same axis seen from the other side. The second value is the sign
/// that rates of the obliquity take with it.
pub(super) fn fold(obliquity: f64) -> (f64, f64) {
    let e = obliquity.rem_euclid(TAU);
    if e > PI { (TAU - e, -1.0) } else { (e, 1.0) }
}

/// `left`, if a step of `h` would leave nothing or a sliver of it, which would cost a step and gain nothing; else `h`.
pub(super) fn without_sliver(h: f64, left: f64) -> f64 {
    if left < h * (1.0 + 1e-9) { left } else { h }
}

impl<T: TorqueFunction> Problem<'_, T> {
    /// `T_omega` and `T_epsilon`, N m, the latter with the sign that belongs to the unfolded obliquity.
    #[inline]
    fn torques(&self, omega: f64, obliquity: f64) -> (f64, f64) {
        let (folded, sign) = fold(obliquity);
        let (spin_torque, mut obliquity_torque) = self.torque.at(folded, omega);
        // A spin axis along the orbit normal has no direction to move in.
        if folded == 0.0 || folded == PI {
            obliquity_torque *= 0.0;
        }
        (spin_torque, sign * obliquity_torque)
    }

    /// State and rates `tau` seconds after the start of the leg.
    #[inline]
    pub fn point(&self, tau: f64, omega: f64, obliquity: f64) -> Result<Point, SpinError> {
        let (spin_torque, obliquity_torque) = self.torques(omega, obliquity);
        let omega_rate = spin_torque / self.inertia;
        let obliquity_rate = obliquity_torque / (self.inertia * omega);
        if !(omega_rate.is_finite() && obliquity_rate.is_finite() && omega > 0.0) {
            return Err(self.not_finite(tau, omega, obliquity));
        }
        Ok(Point { omega, obliquity, omega_rate, obliquity_rate })
    }

    /// Rates of `p = omega cos epsilon` and `q = omega sin epsilon`, rad/s^2:
    /// `dp/dt = (T_omega cos - T_epsilon sin) / C`, `dq/dt = (T_omega sin + T_epsilon cos) / C`. They stay finite where
    /// the spin vanishes. A negative `q` is the axis on the other side of the pole: `T_epsilon` is odd there.
    #[inline]
    pub fn vector_rates(&self, tau: f64, [p, q]: [f64; 2]) -> Result<[f64; 2], SpinError> {
        let (omega, obliquity) = (p.hypot(q), q.atan2(p));
        let (spin, turn) = self.torques(omega, obliquity);
        let (cos, sin) = if omega > 0.0 { (p / omega, q / omega) } else { (1.0, 0.0) };
        let rates = [(spin * cos - turn * sin) / self.inertia, (spin * sin + turn * cos) / self.inertia];
        if rates.iter().all(|r| r.is_finite()) { Ok(rates) } else { Err(self.not_finite(tau, omega, obliquity)) }
    }

    fn not_finite(&self, tau: f64, omega: f64, obliquity: f64) -> SpinError {
        let (spin_torque, obliquity_torque) = self.torques(omega, obliquity);
        SpinError::NonFinite { t_s: self.t0 + tau, omega, obliquity: fold(obliquity).0, spin_torque, obliquity_torque }
    }
}
