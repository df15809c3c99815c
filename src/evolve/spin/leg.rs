//! One leg of the spin evolution: steps of an integrator from a state to the first event that ends the leg.
//!
//! A leg is a pure function of torque, moment of inertia, start state and limits: its step grid starts with it, so a
//! run that is resumed at a leg's start repeats the same bytes.

use std::f64::consts::{PI, TAU};

use super::adaptive::Adaptive;
use super::events::locate;
use super::problem::{Dense, Point, Problem, Stepper, fold, without_sliver};
use super::rk4::Rk4;
use super::{
    CYCLE_END_OMEGA, Integrator, Leg, LegError, LegLimits, SpinError, SpinState, StopReason, TorqueFunction,
    TorqueScale, YEAR_S,
};

/// `T_omega` below this fraction of its largest value has no sign: it is round-off at a fixed point.
const NO_SIGN: f64 = 1e-9;
/// An extremum in this first fraction of a leg's first step is the one that ended the leg before.
const SAME_EXTREMUM: f64 = 1e-3;

/// The course of the state within one step of a leg, for a caller that draws it.
pub(crate) struct Course<'a> {
    start_s: f64,
    h: f64,
    /// Fraction of the step at which the leg ends; 1 if it goes on.
    until: f64,
    dense: &'a dyn Dense,
}

impl Course<'_> {
    /// State at a fraction of what the leg has of the step, in `[0, 1]`.
    pub fn at(&self, fraction: f64) -> SpinState {
        let theta = fraction * self.until;
        let (omega, obliquity) = self.dense.at(theta);
        SpinState { t_s: self.start_s + theta * self.h, omega, obliquity: fold(obliquity).0 }
    }
}

/// Integrates spin rate and obliquity from `start` to the first event of `limits`, for the principal moment of inertia
/// `inertia` (kg m^2) about the spin axis.
///
/// A leg that starts where one ended at an extremum of the spin rate leaves it: every leg is longer than a thousandth of
/// a step unless its start already is an end (time up, or too slow and slowing down, or at an end state).
///
/// # Errors
/// [`SpinError::BadInput`] for impossible inputs, [`SpinError::NonFinite`] where a torque stops being a number,
/// [`SpinError::StepTooSmall`] where an adaptive step can meet its tolerance no longer.
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
    follow_leg(torque, inertia, start, limits, &mut |_| ())
}

/// [`integrate_leg`], showing every step on the way, the last one cut where the leg ends.
pub(crate) fn follow_leg<T: TorqueFunction>(
    torque: &T,
    inertia: f64,
    start: SpinState,
    limits: &LegLimits,
    watch: &mut dyn FnMut(&Course),
) -> Result<Leg, SpinError> {
    check(inertia, &start, limits)?;
    let scale = TorqueScale::of(torque, start.omega);
    let problem = Problem { torque, inertia, t0: start.t_s, slope: scale.obliquity_slope };
    let route = Route { problem, scale, start, limits };
    match limits.integrator {
        Integrator::Rk4 { step_s } => route.follow(Rk4::new(step_s), watch),
        Integrator::Adaptive { tolerance } => route.follow(Adaptive::new(tolerance), watch),
    }
}

/// A leg before it is taken.
struct Route<'a, T> {
    problem: Problem<'a, T>,
    scale: TorqueScale,
    start: SpinState,
    limits: &'a LegLimits,
}

impl<T: TorqueFunction> Route<'_, T> {
    /// Sign of `T_omega`, 0 where it has none.
    fn sign(&self, p: &Point) -> f64 {
        if p.omega_rate.abs() * self.problem.inertia > NO_SIGN * self.scale.spin { p.omega_rate.signum() } else { 0.0 }
    }

    fn stop_omega(&self) -> f64 {
        self.limits.stop_period_s.map_or(0.0, |period| TAU / period)
    }

    /// Why a leg cannot go on from `p`.
    fn ended(&self, p: &Point) -> Option<StopReason> {
        let (scale, inertia) = (&self.scale, self.problem.inertia);
        let slowing = p.omega_rate < 0.0;
        let vanished = self.limits.end_state_fraction.is_some_and(|f| {
            let obliquity_torque = p.obliquity_rate * inertia * p.omega;
            (p.omega_rate * inertia).abs() <= f * scale.spin && obliquity_torque.abs() <= f * scale.obliquity
        });
        match () {
            () if slowing && p.omega <= CYCLE_END_OMEGA => Some(StopReason::CycleEnd),
            () if slowing && p.omega <= self.stop_omega() => Some(StopReason::StopPeriod),
            () if vanished => Some(StopReason::EndState),
            () => None,
        }
    }

    fn follow<S: Stepper<T>>(&self, mut stepper: S, watch: &mut dyn FnMut(&Course)) -> Result<Leg, SpinError> {
        let Self { problem, start, limits, .. } = self;
        let (mut finer, scale) = stepper.finer();
        let first = problem.point(0.0, start.omega, start.obliquity)?;
        let duration = limits.end_time_s - start.t_s;
        let mut finish = |p: &Point, tau: f64, reason: StopReason, steps: u64| {
            let control = walk(&mut finer, problem, &first, tau)?;
            let error = LegError {
                omega: scale * (p.omega - control.omega).abs() / p.omega,
                obliquity: scale * (fold(p.obliquity).0 - fold(control.obliquity).0).abs(),
            };
            let t_s = if reason == StopReason::EndTime { start.t_s.max(limits.end_time_s) } else { start.t_s + tau };
            let end = SpinState { t_s, omega: p.omega, obliquity: fold(p.obliquity).0 };
            Ok(Leg { end, reason, steps, error })
        };

        if duration <= 0.0 {
            return finish(&first, 0.0, StopReason::EndTime, 0);
        }
        if let Some(reason) = self.ended(&first) {
            return finish(&first, 0.0, reason, 0);
        }
        let (mut p, mut tau, mut steps) = (first, 0.0, 0_u64);
        let mut sign = self.sign(&first);
        loop {
            let left = duration - tau;
            let step = stepper.step(problem, tau, &p, if S::WHOLE_STEPS { f64::INFINITY } else { left })?;
            steps += 1;
            let last = without_sliver(step.h, left) == left;
            let in_time = |(theta, _): &(f64, StopReason)| !last || theta * step.h <= left;
            let event = self.event(&p, &step.end, &step.dense, sign, steps == 1).filter(in_time);
            let until = event.map_or((left / step.h).min(1.0), |(theta, _)| theta);
            watch(&Course { start_s: start.t_s + tau, h: step.h, until, dense: &step.dense });
            if let Some((theta, reason)) = event {
                let h = theta * step.h;
                let stop = if theta < 1.0 { stepper.exactly(problem, tau, &p, h)? } else { step.end };
                return finish(&stop, tau + h, reason, steps);
            }
            if last && step.h != left {
                return finish(&stepper.exactly(problem, tau, &p, left)?, duration, StopReason::EndTime, steps);
            }
            if let Some(reason) = self.ended(&step.end) {
                return finish(&step.end, tau + step.h, reason, steps);
            }
            if last {
                return finish(&step.end, duration, StopReason::EndTime, steps);
            }
            p = step.end;
            tau += step.h;
            if self.sign(&p) != 0.0 {
                sign = self.sign(&p);
            }
        }
    }

    /// The first event within a step from `p` to `end`, and where in it.
    fn event(
        &self,
        p: &Point,
        end: &Point,
        dense: &impl Dense,
        sign: f64,
        first_step: bool,
    ) -> Option<(f64, StopReason)> {
        // Each event is sought only before the ones already found, so the last one found is the first in time.
        let (mut theta, mut reason) = (1.0, None);
        if self.sign(end) * sign < 0.0 {
            let turned = |x: f64| {
                let (omega, obliquity) = dense.at(x);
                let along = self.problem.torque.at(fold(obliquity).0, omega).0 * sign;
                // A torque that is no number counts as found: the step taken there reports it.
                along <= 0.0 || along.is_nan()
            };
            let at = locate(turned, 1.0);
            if !first_step || at > SAME_EXTREMUM {
                (theta, reason) = (at, Some(StopReason::Extremum));
            }
        }
        let changed = |x: f64| (dense.at(x).0 / self.start.omega - 1.0).abs() >= self.limits.spin_change;
        if changed(theta) {
            (theta, reason) = (locate(changed, theta), Some(StopReason::SpinChange));
        }
        for (slowest, why) in [(self.stop_omega(), StopReason::StopPeriod), (CYCLE_END_OMEGA, StopReason::CycleEnd)] {
            let slow = |x: f64| dense.at(x).0 <= slowest;
            // A body that starts slower and speeds up is not stopped; once it turns, `ended` sees it.
            if p.omega > slowest && slow(theta) {
                (theta, reason) = (locate(slow, theta), Some(why));
            }
        }
        reason.map(|why| (theta, why))
    }
}

/// `duration` seconds without looking for events: the control run.
fn walk<T: TorqueFunction, S: Stepper<T>>(
    stepper: &mut S,
    problem: &Problem<T>,
    start: &Point,
    duration: f64,
) -> Result<Point, SpinError> {
    let (mut p, mut tau) = (*start, 0.0);
    while tau < duration {
        let step = stepper.step(problem, tau, &p, duration - tau)?;
        p = step.end;
        if step.h == duration - tau {
            break;
        }
        tau += step.h;
    }
    Ok(p)
}

/// Refuses what no leg can start from.
fn check(inertia: f64, start: &SpinState, limits: &LegLimits) -> Result<(), SpinError> {
    let positive = "finite and > 0";
    let knob = match limits.integrator {
        Integrator::Rk4 { step_s } => ("Runge-Kutta step (s)", step_s, step_s >= 1e-6 * YEAR_S, "at least 1e-6 yr"),
        Integrator::Adaptive { tolerance } => {
            ("tolerance", tolerance, (1e-13..=1e-2).contains(&tolerance), "at least 1e-13, at most 0.01")
        }
    };
    let inputs = [
        ("moment of inertia (kg m^2)", inertia, inertia.is_finite() && inertia > 0.0, positive),
        ("spin rate (rad/s)", start.omega, start.omega.is_finite() && start.omega > 0.0, positive),
        ("obliquity (rad)", start.obliquity, (0.0..=PI).contains(&start.obliquity), "0 to pi"),
        ("time (s)", start.t_s, start.t_s.is_finite(), "finite"),
        ("end time (s)", limits.end_time_s, limits.end_time_s.is_finite(), "finite"),
        knob,
        ("relative spin change", limits.spin_change, limits.spin_change > 0.0, "> 0"),
    ];
    match inputs.into_iter().find(|(_, _, ok, _)| !ok) {
        Some((what, value, _, allowed)) => Err(SpinError::BadInput { what, value, allowed }),
        None => Ok(()),
    }
}
