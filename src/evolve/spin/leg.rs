//! One leg of the spin evolution: Runge-Kutta steps from a state to the first event that ends the leg.
//!
//! A leg is a pure function of torque, moment of inertia, start state and limits: its step grid starts with it, so a
//! run that is resumed at a leg's start repeats the same bytes.

use std::f64::consts::{PI, TAU};

use super::events::{Point, Step, locate};
use super::{
    CYCLE_END_OMEGA, Leg, LegError, LegLimits, SpinError, SpinState, StopReason, TorqueFunction, TorqueScale, YEAR_S,
};

/// Largest turn of the obliquity within one step, rad. Near zero spin `d epsilon/dt ~ 1/omega` runs away.
const OBLIQUITY_STEP: f64 = 0.01;
/// Largest relative change of the spin rate within one step.
const SPIN_STEP: f64 = 0.05;
/// Largest step in units of the relaxation time towards a stable obliquity. RK4 is stable up to 2.78 of them; a body
/// that sits there has no `T_epsilon` left by which [`OBLIQUITY_STEP`] could notice the stiffness.
const RELAXATION_STEP: f64 = 0.5;
/// `T_omega` below this fraction of its largest value has no sign: it is round-off at a fixed point.
const NO_SIGN: f64 = 1e-9;
/// An extremum in this first fraction of a leg's first step is the one that ended the leg before.
const SAME_EXTREMUM: f64 = 1e-3;

/// Torque, inertia and clock: all that the right-hand side needs.
struct Problem<'a, T> {
    torque: &'a T,
    inertia: f64,
    t0: f64,
    slope: f64,
}

/// Brings an obliquity that left `[0, pi]` back: the same axis seen from the other side. The second value is the sign
/// that rates of the obliquity take with it.
fn fold(obliquity: f64) -> (f64, f64) {
    let e = obliquity.rem_euclid(TAU);
    if e > PI { (TAU - e, -1.0) } else { (e, 1.0) }
}

impl<T: TorqueFunction> Problem<'_, T> {
    /// State and rates `tau` seconds after the start of the leg.
    #[inline]
    fn point(&self, tau: f64, omega: f64, obliquity: f64) -> Result<Point, SpinError> {
        let (folded, sign) = fold(obliquity);
        let (spin_torque, mut obliquity_torque) = self.torque.at(folded, omega);
        // A spin axis along the orbit normal has no direction to move in.
        if folded == 0.0 || folded == PI {
            obliquity_torque *= 0.0;
        }
        let omega_rate = spin_torque / self.inertia;
        let obliquity_rate = sign * obliquity_torque / (self.inertia * omega);
        if !(omega_rate.is_finite() && obliquity_rate.is_finite() && omega > 0.0) {
            let t_s = self.t0 + tau;
            return Err(SpinError::NonFinite { t_s, omega, obliquity: folded, spin_torque, obliquity_torque });
        }
        Ok(Point { omega, obliquity, omega_rate, obliquity_rate })
    }

    /// One classical fourth-order Runge-Kutta step of `h` seconds.
    fn rk4(&self, tau: f64, p: &Point, h: f64) -> Result<Point, SpinError> {
        let stage =
            |q: &Point, dt: f64| self.point(tau + dt, p.omega + dt * q.omega_rate, p.obliquity + dt * q.obliquity_rate);
        let k2 = stage(p, 0.5 * h)?;
        let k3 = stage(&k2, 0.5 * h)?;
        let k4 = stage(&k3, h)?;
        let mean = |a: f64, b: f64, c: f64, d: f64| h / 6.0 * (a + 2.0 * (b + c) + d);
        self.point(
            tau + h,
            p.omega + mean(p.omega_rate, k2.omega_rate, k3.omega_rate, k4.omega_rate),
            p.obliquity + mean(p.obliquity_rate, k2.obliquity_rate, k3.obliquity_rate, k4.obliquity_rate),
        )
    }

    /// Step length, s: `step`, cut for slow spin (`fineness` 1, or 0.5 for the control run) and to what is left.
    fn step_length(&self, p: &Point, step: f64, fineness: f64, left: f64) -> f64 {
        let turn = fineness * OBLIQUITY_STEP / p.obliquity_rate.abs();
        let change = fineness * SPIN_STEP * p.omega / p.omega_rate.abs();
        let relaxation = fineness * RELAXATION_STEP * self.inertia * p.omega / self.slope;
        // A vanishing rate makes its bound infinite; 0/0 cannot occur since omega > 0. The floor keeps the clock moving
        // under an absurd torque: it stops as not finite, it does not hang.
        let h = step.min(turn).min(change).min(relaxation).max(1e-9 * step);
        // No sliver at the end: it would cost a step and gain nothing.
        if left < h * (1.0 + 1e-9) { left } else { h }
    }

    /// State `duration` seconds on, with half the step of the leg and no events: the control run.
    fn halved(&self, start: &Point, duration: f64, step_s: f64) -> Result<Point, SpinError> {
        let (mut p, mut tau) = (*start, 0.0);
        while tau < duration {
            let h = self.step_length(&p, 0.5 * step_s, 0.5, duration - tau);
            p = self.rk4(tau, &p, h)?;
            if h == duration - tau {
                break;
            }
            tau += h;
        }
        Ok(p)
    }
}

/// Integrates spin rate and obliquity from `start` to the first event of `limits`, for the principal moment of inertia
/// `inertia` (kg m^2) about the spin axis.
///
/// A leg that starts where one ended at an extremum of the spin rate leaves it: every leg is longer than a thousandth of
/// a step unless its start already is an end (time up, or too slow and slowing down, or at an end state).
///
/// # Errors
/// [`SpinError::BadInput`] for impossible inputs, [`SpinError::NonFinite`] where a torque stops being a number.
///
/// # Examples
/// ```
/// use yorp::evolve::spin::{LegLimits, SpinState, StopReason, YEAR_S, integrate_leg};
/// let spin_up = |_obliquity: f64, _omega: f64| (1.0, 0.0);
/// let start = SpinState { t_s: 0.0, omega: 3e-4, obliquity: 0.1 };
/// let leg = integrate_leg(&spin_up, 1e18, start, &LegLimits::until(1e7 * YEAR_S))?;
/// assert_eq!(leg.reason, StopReason::SpinChange);
/// assert!((leg.end.omega / 3e-4 - 1.005).abs() < 1e-12);
/// # Ok::<(), yorp::evolve::spin::SpinError>(())
/// ```
pub fn integrate_leg<T: TorqueFunction>(
    torque: &T,
    inertia: f64,
    start: SpinState,
    limits: &LegLimits,
) -> Result<Leg, SpinError> {
    check(inertia, &start, limits)?;
    let scale = TorqueScale::of(torque, start.omega);
    let problem = Problem { torque, inertia, t0: start.t_s, slope: scale.obliquity_slope };
    let first = problem.point(0.0, start.omega, start.obliquity)?;
    let duration = limits.end_time_s - start.t_s;
    let stop_omega = limits.stop_period_s.map_or(0.0, |period| TAU / period);
    let sign_of =
        |p: &Point| if p.omega_rate.abs() * inertia > NO_SIGN * scale.spin { p.omega_rate.signum() } else { 0.0 };
    let ended = |p: &Point| {
        let slowing = p.omega_rate < 0.0;
        let vanished = limits.end_state_fraction.is_some_and(|f| {
            let obliquity_torque = p.obliquity_rate * inertia * p.omega;
            (p.omega_rate * inertia).abs() <= f * scale.spin && obliquity_torque.abs() <= f * scale.obliquity
        });
        match () {
            () if slowing && p.omega <= CYCLE_END_OMEGA => Some(StopReason::CycleEnd),
            () if slowing && p.omega <= stop_omega => Some(StopReason::StopPeriod),
            () if vanished => Some(StopReason::EndState),
            () => None,
        }
    };
    let finish = |p: &Point, tau: f64, reason: StopReason, steps: u64| {
        let control = problem.halved(&first, tau, limits.step_s)?;
        // Fourth order: halving the step leaves a sixteenth of the error.
        let error = LegError {
            omega: 16.0 / 15.0 * (p.omega - control.omega).abs() / p.omega,
            obliquity: 16.0 / 15.0 * (p.obliquity - control.obliquity).abs(),
        };
        let t_s = if reason == StopReason::EndTime { start.t_s.max(limits.end_time_s) } else { start.t_s + tau };
        let end = SpinState { t_s, omega: p.omega, obliquity: fold(p.obliquity).0 };
        Ok(Leg { end, reason, steps, error })
    };

    if duration <= 0.0 {
        return finish(&first, 0.0, StopReason::EndTime, 0);
    }
    if let Some(reason) = ended(&first) {
        return finish(&first, 0.0, reason, 0);
    }
    let (mut p, mut tau, mut steps) = (first, 0.0, 0_u64);
    let mut sign = sign_of(&first);
    loop {
        let left = duration - tau;
        let h = problem.step_length(&p, limits.step_s, 1.0, left);
        let end = problem.rk4(tau, &p, h)?;
        let step = Step { start: p, end, h };
        steps += 1;

        // Each event is sought only before the ones already found, so the last one found is the first in time.
        let (mut theta, mut reason) = (1.0, None);
        let new_sign = sign_of(&end);
        if new_sign * sign < 0.0 {
            let turned = |x: f64| {
                let (omega, obliquity) = step.at(x);
                let along = torque.at(fold(obliquity).0, omega).0 * sign;
                // A torque that is no number counts as found: the step taken there reports it.
                along <= 0.0 || along.is_nan()
            };
            let at = locate(turned, 1.0);
            if steps > 1 || at > SAME_EXTREMUM {
                (theta, reason) = (at, Some(StopReason::Extremum));
            }
        }
        let changed = |x: f64| (step.at(x).0 / start.omega - 1.0).abs() >= limits.spin_change;
        if changed(theta) {
            (theta, reason) = (locate(changed, theta), Some(StopReason::SpinChange));
        }
        for (slowest, why) in [(stop_omega, StopReason::StopPeriod), (CYCLE_END_OMEGA, StopReason::CycleEnd)] {
            let slow = |x: f64| step.at(x).0 <= slowest;
            // A body that starts slower and speeds up is not stopped; once it turns, `ended` sees it.
            if p.omega > slowest && slow(theta) {
                (theta, reason) = (locate(slow, theta), Some(why));
            }
        }
        if let Some(reason) = reason {
            let h = theta * h;
            let stop = if theta < 1.0 { problem.rk4(tau, &p, h)? } else { end };
            return finish(&stop, tau + h, reason, steps);
        }
        if let Some(reason) = ended(&end) {
            return finish(&end, tau + h, reason, steps);
        }
        if h == left {
            return finish(&end, duration, StopReason::EndTime, steps);
        }
        p = end;
        tau += h;
        if new_sign != 0.0 {
            sign = new_sign;
        }
    }
}

/// Refuses what no leg can start from.
fn check(inertia: f64, start: &SpinState, limits: &LegLimits) -> Result<(), SpinError> {
    let positive = "finite and > 0";
    let inputs = [
        ("moment of inertia (kg m^2)", inertia, inertia.is_finite() && inertia > 0.0, positive),
        ("spin rate (rad/s)", start.omega, start.omega.is_finite() && start.omega > 0.0, positive),
        ("obliquity (rad)", start.obliquity, (0.0..=PI).contains(&start.obliquity), "0 to pi"),
        ("time (s)", start.t_s, start.t_s.is_finite(), "finite"),
        ("end time (s)", limits.end_time_s, limits.end_time_s.is_finite(), "finite"),
        ("Runge-Kutta step (s)", limits.step_s, limits.step_s >= 1e-6 * YEAR_S, "at least 1e-6 yr"),
        ("relative spin change", limits.spin_change, limits.spin_change > 0.0, "> 0"),
    ];
    match inputs.into_iter().find(|(_, _, ok, _)| !ok) {
        Some((what, value, _, allowed)) => Err(SpinError::BadInput { what, value, allowed }),
        None => Ok(()),
    }
}
