//! The YORP cycle of a body that keeps its shape: spin and obliquity under one torque curve to their end state.
//!
//! Source: Cotto-Figueroa et al. (2015), ApJ 803, 25, section 2.5 and Tables 2 and 3: largest, smallest and final spin
//! rate, final obliquity and the time `t_YC` of the cycle; "infinite" where the spin grows for ever. SI units.

use std::f64::consts::{PI, TAU};

use super::spin::{LegLimits, SpinError, SpinState, StopReason, TorqueFunction, TorqueScale, integrate_leg};

/// Spin rate of one revolution per day, rad/s.
pub const REV_PER_DAY: f64 = TAU / 86_400.0;

/// Output points that the time span is divided into at least; the spin rate adds points of its own.
const TIME_POINTS: f64 = 400.0;
/// Relative change of the spin rate between output points.
const SPIN_POINTS: f64 = 0.02;

/// How the cycle of a rigid body ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RigidEnd {
    /// Spin zero after a finite time.
    SpunDown,
    /// The obliquity tends to a value at which the torque spins the body up for ever.
    InfiniteSpinUp,
    /// Both torques vanish at a finite spin rate.
    Stalled,
    /// The time ended first; the body would spin down to zero later.
    TimeLimit,
}

/// The evolution of a rigid body.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidCycle {
    /// States at uneven times: wherever the spin rate changed by 2 % or passed an extremum, and at least 400 over the
    /// time span. The first is the initial state.
    pub states: Vec<SpinState>,
    /// How it ends.
    pub end: RigidEnd,
    /// Largest spin rate reached, rad/s; infinite for [`RigidEnd::InfiniteSpinUp`].
    pub max_omega: f64,
    /// Smallest spin rate reached, rad/s; zero for [`RigidEnd::SpunDown`].
    pub min_omega: f64,
    /// Spin rate of the end state, rad/s: zero, infinite, or the last one.
    pub end_omega: f64,
    /// Obliquity of the end state, rad: the one towards which the axis tends.
    pub end_obliquity: f64,
    /// Time to complete the cycle (`t_YC`), s since the initial state; `None` unless the body spins down. From a period
    /// of 20 days on, the last percent, the spin is taken to fall linearly.
    pub cycle_time_s: Option<f64>,
    /// Runge-Kutta steps taken.
    pub steps: u64,
    /// Estimated relative error of the last spin rate from the finite step, summed over the legs.
    pub omega_error: f64,
    /// Estimated error of the last obliquity from the finite step, rad, summed over the legs.
    pub obliquity_error: f64,
}

/// Follows a rigid body with the principal moment of inertia `inertia` (kg m^2) from `start` for at most `duration_s`,
/// with Runge-Kutta steps of `step_s` seconds (1000 yr in the paper).
///
/// # Errors
/// As [`integrate_leg`].
pub fn rigid_cycle<T: TorqueFunction>(
    torque: &T,
    inertia: f64,
    start: SpinState,
    duration_s: f64,
    step_s: f64,
) -> Result<RigidCycle, SpinError> {
    let end_time_s = start.t_s + duration_s;
    let limits = LegLimits { step_s, spin_change: SPIN_POINTS, stop_period_s: None, ..LegLimits::until(end_time_s) };
    let mut cycle = RigidCycle {
        states: vec![start],
        end: RigidEnd::TimeLimit,
        max_omega: start.omega,
        min_omega: start.omega,
        end_omega: start.omega,
        end_obliquity: start.obliquity,
        cycle_time_s: None,
        steps: 0,
        omega_error: 0.0,
        obliquity_error: 0.0,
    };
    let mut state = start;
    let reason = loop {
        let until = (state.t_s + (duration_s / TIME_POINTS).max(step_s)).min(end_time_s);
        let leg = integrate_leg(torque, inertia, state, &LegLimits { end_time_s: until, ..limits })?;
        cycle.steps += leg.steps;
        cycle.omega_error += leg.error.omega;
        cycle.obliquity_error += leg.error.obliquity;
        state = leg.end;
        if leg.steps > 0 {
            cycle.states.push(state);
        }
        cycle.max_omega = cycle.max_omega.max(state.omega);
        cycle.min_omega = cycle.min_omega.min(state.omega);
        let goes_on = matches!(leg.reason, StopReason::SpinChange | StopReason::Extremum)
            || leg.reason == StopReason::EndTime && state.t_s < end_time_s;
        if !goes_on {
            break leg.reason;
        }
    };

    let (obliquity, spin_torque) = attractor(torque, &state);
    (cycle.end_omega, cycle.end_obliquity) = (state.omega, obliquity);
    match reason {
        StopReason::CycleEnd => {
            let (spin_torque, _) = torque.at(state.obliquity, state.omega);
            cycle.end = RigidEnd::SpunDown;
            cycle.cycle_time_s = Some(state.t_s - start.t_s + inertia * state.omega / spin_torque.abs());
            (cycle.end_omega, cycle.min_omega) = (0.0, 0.0);
        }
        StopReason::EndState => cycle.end = RigidEnd::Stalled,
        _ if spin_torque > 0.0 => {
            cycle.end = RigidEnd::InfiniteSpinUp;
            (cycle.end_omega, cycle.max_omega) = (f64::INFINITY, f64::INFINITY);
        }
        _ => {}
    }
    Ok(cycle)
}

/// Obliquity towards which the axis turns, rad, and `T_omega` there, N m: the next zero of `T_epsilon` on its way. The
/// sign of that torque decides between spinning down in finite time and spinning up for ever.
fn attractor<T: TorqueFunction>(torque: &T, state: &SpinState) -> (f64, f64) {
    let at = |obliquity: f64| torque.at(obliquity, state.omega);
    let (_, pull) = at(state.obliquity);
    let negligible = 1e-12 * TorqueScale::of(torque, state.omega).obliquity;
    let step = PI / 360.0 * pull.signum();
    let mut here = state.obliquity;
    if pull.abs() > negligible {
        loop {
            let next = (here + step).clamp(0.0, PI);
            if at(next).1 * pull <= 0.0 || next == 0.0 || next == PI {
                let (mut before, mut beyond) = (here, next);
                // To round-off; a pole at which the torque has not changed sign stays the end.
                for _ in 0..60 {
                    let middle = 0.5 * (before + beyond);
                    if at(middle).1 * pull <= 0.0 { beyond = middle } else { before = middle }
                }
                here = beyond;
                break;
            }
            here = next;
        }
    }
    (here, at(here).0)
}

#[cfg(test)]
mod tests {
    use super::super::spin::YEAR_S;
    use super::*;

    const INERTIA: f64 = 3.7e17;
    const MYR_S: f64 = 1e6 * YEAR_S;

    fn start(period_h: f64, obliquity_deg: f64) -> SpinState {
        SpinState { t_s: 0.0, omega: TAU / (period_h * 3600.0), obliquity: obliquity_deg.to_radians() }
    }

    /// Torque without thermal inertia: T_omega = A C (cos 2 eps + q), T_epsilon = B C sin 2 eps.
    fn double_angle(a: f64, b: f64, q: f64) -> impl Fn(f64, f64) -> (f64, f64) {
        move |e, _| (a * INERTIA * ((2.0 * e).cos() + q), b * INERTIA * (2.0 * e).sin())
    }

    #[test]
    fn a_body_that_ends_at_90_degrees_spins_up_then_down_to_zero() {
        let (a, b, q) = (1e-18, 0.8e-18, 0.0);
        let s = start(6.0, 5.0);
        let cycle = rigid_cycle(&double_angle(a, b, q), INERTIA, s, 300.0 * MYR_S, 1000.0 * YEAR_S).unwrap();
        assert_eq!(cycle.end, RigidEnd::SpunDown);
        assert_eq!((cycle.end_omega, cycle.min_omega), (0.0, 0.0));
        assert!((cycle.end_obliquity - PI / 2.0).abs() < 1e-9);
        // omega = omega0 (sin 2 eps / sin 2 eps0)^(k/2): the maximum lies at 45 degrees.
        let peak = s.omega * (1.0 / (2.0 * s.obliquity).sin()).powf(a / b / 2.0);
        assert!((cycle.max_omega / peak - 1.0).abs() < 1e-9, "{}", cycle.max_omega / peak - 1.0);
        assert!(cycle.states.windows(2).all(|w| w[1].t_s > w[0].t_s));
        assert!(cycle.states.len() < 2000);
        // The time of the cycle does not hang on where the last percent begins.
        let fine = rigid_cycle(&double_angle(a, b, q), INERTIA, s, 300.0 * MYR_S, 250.0 * YEAR_S).unwrap();
        let (t, t_fine) = (cycle.cycle_time_s.unwrap(), fine.cycle_time_s.unwrap());
        assert!((t / t_fine - 1.0).abs() < 1e-8, "{t} {t_fine}");
        assert!(cycle.omega_error < 1e-8 && cycle.omega_error >= 0.0, "{}", cycle.omega_error);
    }

    #[test]
    fn linear_spin_down_takes_the_time_of_its_closed_form() {
        let cycle = rigid_cycle(
            &|_: f64, _: f64| (-1e-18 * INERTIA, 0.0),
            INERTIA,
            start(6.0, 30.0),
            30.0 * MYR_S,
            1000.0 * YEAR_S,
        )
        .unwrap();
        let exact = TAU / (6.0 * 3600.0) / 1e-18;
        assert!((cycle.cycle_time_s.unwrap() / exact - 1.0).abs() < 1e-9);
        assert_eq!(cycle.max_omega, cycle.states[0].omega);
    }

    #[test]
    fn a_body_whose_stable_obliquity_spins_it_up_ends_infinitely_fast() {
        // q = 1.5: T_omega > 0 at the stable 90 degrees.
        let torque = double_angle(1e-18, 0.8e-18, 1.5);
        let cycle = rigid_cycle(&torque, INERTIA, start(6.0, 5.0), 30.0 * MYR_S, 1000.0 * YEAR_S).unwrap();
        assert_eq!((cycle.end, cycle.cycle_time_s), (RigidEnd::InfiniteSpinUp, None));
        assert!(cycle.end_omega.is_infinite() && cycle.max_omega.is_infinite());
        assert!((cycle.end_obliquity - PI / 2.0).abs() < 1e-9);
        assert_eq!(cycle.min_omega, cycle.states[0].omega);
    }

    #[test]
    fn a_time_limit_before_the_end_is_said_to_be_one() {
        let torque = double_angle(1e-18, 0.8e-18, 0.0);
        let cycle = rigid_cycle(&torque, INERTIA, start(6.0, 5.0), MYR_S, 1000.0 * YEAR_S).unwrap();
        assert_eq!((cycle.end, cycle.cycle_time_s), (RigidEnd::TimeLimit, None));
        assert_eq!(cycle.states.last().unwrap().t_s, MYR_S);
    }

    #[test]
    fn torques_that_vanish_together_stall_the_body() {
        let torque = |e: f64, _: f64| (1e-18 * INERTIA * (2.0 * e).sin(), 1e-17 * INERTIA * (2.0 * e).sin());
        let cycle = rigid_cycle(&torque, INERTIA, start(6.0, 60.0), 60.0 * MYR_S, 1000.0 * YEAR_S).unwrap();
        assert_eq!(cycle.end, RigidEnd::Stalled);
        assert!((cycle.end_obliquity - PI / 2.0).abs() < 1e-6);
        let none = rigid_cycle(&|_: f64, _: f64| (0.0, 0.0), INERTIA, start(6.0, 60.0), MYR_S, 1e3 * YEAR_S).unwrap();
        assert_eq!((none.end, none.states.len()), (RigidEnd::Stalled, 1));
    }

    #[test]
    fn axis_pulled_to_a_pole_ends_there() {
        let torque = |e: f64, _: f64| (-1e-18 * INERTIA, -1e-17 * INERTIA * e.sin());
        let cycle = rigid_cycle(&torque, INERTIA, start(6.0, 60.0), 60.0 * MYR_S, 1000.0 * YEAR_S).unwrap();
        assert_eq!(cycle.end, RigidEnd::SpunDown);
        assert!(cycle.end_obliquity < 1e-9);
    }
}
