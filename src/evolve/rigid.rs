//! The YORP cycle of a body that keeps its shape: spin and obliquity under one torque curve to their end state.
//!
//! Source: Cotto-Figueroa et al. (2015), ApJ 803, 25, section 2.5 and Tables 2 and 3: largest, smallest and final spin
//! rate, final obliquity and the time `t_YC` of the cycle; "infinite" where the spin grows for ever. SI units.

use std::f64::consts::{PI, TAU};

use pkd::constants::G;

use super::spin::{
    Course, Integrator, LegLimits, SpinError, SpinState, StopReason, TorqueFunction, TorqueScale, follow_leg,
    standstill,
};

/// Spin rate of one revolution per day, rad/s.
pub const REV_PER_DAY: f64 = TAU / 86_400.0;

/// Default of [`Integrator::Adaptive`]: the error of the integration stays a thousandth of that of the best torques.
pub const TOLERANCE: f64 = 1e-9;

/// Output points that the time span is divided into at least; the spin rate adds points of its own.
const TIME_POINTS: f64 = 400.0;
/// Relative change of the spin rate between output points.
const SPIN_POINTS: f64 = 0.02;
/// Relative change of the spin rate after which a new leg begins, because what counts as no torque may depend on it.
const LEG_SPIN_CHANGE: f64 = 0.5;

/// Spin rate, rad/s, at which loose material floats off the equator of a sphere of density `density_kg_m3`.
pub fn sphere_limit(density_kg_m3: f64) -> f64 {
    (4.0 / 3.0 * PI * G * density_kg_m3).sqrt()
}

/// How the cycle of a rigid body ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RigidEnd {
    /// The end of the YORP cycle: slowed down beyond a period of 20 days, where real bodies tumble.
    SpunDown,
    /// The obliquity tends to a value at which the torque spins the body up for ever.
    InfiniteSpinUp,
    /// Both torques vanish at a finite spin rate.
    Stalled,
    /// The time ended first.
    TimeLimit,
    /// Neither torque exceeds its error at any obliquity: nothing is known to change.
    NoTorque,
}

/// Errors of the two torques, N m. A torque that nowhere exceeds its error is taken as none, and one that does not at the
/// obliquity where it would decide whether the body spins up or down decides nothing.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TorqueErrors {
    /// Of `T_omega`.
    pub spin: f64,
    /// Of `T_epsilon`.
    pub obliquity: f64,
}

/// The evolution of a rigid body.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidCycle {
    /// States at uneven times: wherever the spin rate changed by about 2 % or passed an extremum, and one for each
    /// four-hundredth of the time asked for. The first is the initial state.
    pub states: Vec<SpinState>,
    /// How it ends.
    pub end: RigidEnd,
    /// Largest spin rate reached, rad/s; infinite for [`RigidEnd::InfiniteSpinUp`].
    pub max_omega: f64,
    /// Smallest spin rate reached, rad/s; zero for [`RigidEnd::SpunDown`], unless the spin turns just before.
    pub min_omega: f64,
    /// Spin rate of the end state, rad/s: zero, infinite, or the last one.
    pub end_omega: f64,
    /// Obliquity of the last state, rad; for [`RigidEnd::SpunDown`] when the spin vanishes.
    pub end_obliquity: f64,
    /// Rate of change of the spin rate at the last state, rad/s^2.
    pub end_omega_rate: f64,
    /// Where the axis tends from the last state, in however long a time; `None` for [`RigidEnd::NoTorque`].
    pub attractor: Option<Attractor>,
    /// Whether `T_omega` and `T_epsilon` exceed their errors somewhere; what does not is taken as none.
    pub above_error: [bool; 2],
    /// Time to complete the cycle (`t_YC`), s since the initial state: when the spin vanishes, or, where it turns before,
    /// when it is smallest. `None` unless the body spins down.
    pub cycle_time_s: Option<f64>,
    /// Steps taken to the last state.
    pub steps: u64,
    /// Estimated relative error of the last spin rate from the finite step, summed over the legs.
    pub omega_error: f64,
    /// Estimated error of the last obliquity from the finite step, rad, summed over the legs.
    pub obliquity_error: f64,
}

/// An obliquity at which `T_epsilon` vanishes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attractor {
    /// The obliquity, rad.
    pub obliquity: f64,
    /// Rate of change of the spin rate there, rad/s^2; 0 below the error of the torque.
    pub omega_rate: f64,
}

impl RigidCycle {
    /// Obliquity at which the body ends, rad: where the axis tends, unless the time ended first.
    pub fn final_obliquity(&self) -> f64 {
        match (self.end, self.attractor) {
            (RigidEnd::SpunDown | RigidEnd::InfiniteSpinUp | RigidEnd::Stalled, Some(attractor)) => attractor.obliquity,
            _ => self.end_obliquity,
        }
    }

    /// When the spin rate first rises above `omega` (rad/s), s, linear between the states; `None` if it does not.
    pub fn first_above(&self, omega: f64) -> Option<f64> {
        if self.states.first().is_some_and(|s| s.omega > omega) {
            return self.states.first().map(|s| s.t_s);
        }
        self.states.windows(2).find(|w| w[1].omega > omega).map(|w| {
            let fraction = (omega - w[0].omega) / (w[1].omega - w[0].omega);
            w[0].t_s + fraction * (w[1].t_s - w[0].t_s)
        })
    }
}

/// Follows a rigid body with the principal moment of inertia `inertia` (kg m^2) from `start` for at most `duration_s`, under
/// a torque that is known to within `errors`.
///
/// # Errors
/// As [`integrate_leg`](super::spin::integrate_leg).
pub fn rigid_cycle<T: TorqueFunction>(
    torque: &T,
    errors: TorqueErrors,
    inertia: f64,
    start: SpinState,
    duration_s: f64,
    integrator: Integrator,
) -> Result<RigidCycle, SpinError> {
    let scale = TorqueScale::of(torque, start.omega);
    // A torque of exactly zero without error is known to be zero.
    let above_error = [scale.spin >= errors.spin, scale.obliquity >= errors.obliquity];
    let torque = &move |obliquity: f64, omega: f64| {
        let (spin, turn) = torque.at(obliquity, omega);
        (if above_error[0] { spin } else { 0.0 }, if above_error[1] { turn } else { 0.0 })
    };
    let limits = LegLimits {
        integrator,
        spin_change: LEG_SPIN_CHANGE,
        stop_period_s: None,
        ..LegLimits::until(start.t_s + duration_s)
    };
    let mut track = Track { states: vec![start], spacing_s: duration_s / TIME_POINTS };
    let (mut state, mut steps) = (start, 0);
    let (mut omega_error, mut obliquity_error) = (0.0, 0.0);
    let reason = loop {
        let leg = follow_leg(torque, inertia, state, &limits, &mut |course| track.follow(course))?;
        steps += leg.steps;
        omega_error += leg.error.omega;
        obliquity_error += leg.error.obliquity;
        state = leg.end;
        if leg.steps > 0 {
            track.end(state);
        }
        if !matches!(leg.reason, StopReason::SpinChange | StopReason::Extremum) {
            break leg.reason;
        }
    };

    let omegas = || track.states.iter().map(|s| s.omega);
    let mut cycle = RigidCycle {
        end: RigidEnd::TimeLimit,
        max_omega: omegas().fold(0.0, f64::max),
        min_omega: omegas().fold(f64::INFINITY, f64::min),
        end_omega: state.omega,
        end_obliquity: state.obliquity,
        end_omega_rate: torque(state.obliquity, state.omega).0 / inertia,
        attractor: Some(attractor(torque, errors, inertia, &state)),
        above_error,
        cycle_time_s: None,
        steps,
        omega_error,
        obliquity_error,
        states: track.states,
    };
    match reason {
        _ if above_error == [false; 2] => {
            cycle.end = RigidEnd::NoTorque;
            cycle.attractor = None;
            cycle.states.push(SpinState { t_s: start.t_s + duration_s, ..start });
        }
        StopReason::CycleEnd => {
            let stop = standstill(torque, inertia, &state)?;
            cycle.end = RigidEnd::SpunDown;
            cycle.cycle_time_s = Some(state.t_s - start.t_s + stop.duration_s);
            (cycle.end_omega, cycle.min_omega, cycle.end_obliquity) = (stop.omega, stop.omega, stop.obliquity);
            cycle.end_omega_rate = torque(stop.obliquity, stop.omega).0 / inertia;
            let last = SpinState { t_s: state.t_s, omega: stop.omega, obliquity: stop.obliquity };
            cycle.attractor = Some(attractor(torque, errors, inertia, &last));
        }
        StopReason::EndState => cycle.end = RigidEnd::Stalled,
        _ if cycle.attractor.is_some_and(|a| a.omega_rate > 0.0) => {
            cycle.end = RigidEnd::InfiniteSpinUp;
            (cycle.end_omega, cycle.max_omega) = (f64::INFINITY, f64::INFINITY);
        }
        _ => {}
    }
    Ok(cycle)
}

/// The states that are shown, out of all that the integrator passes.
struct Track {
    states: Vec<SpinState>,
    spacing_s: f64,
}

impl Track {
    fn last(&self) -> SpinState {
        *self.states.last().expect("the initial state is always there")
    }

    /// Distance between two states in units of the spacing that is wanted.
    fn distance(&self, from: &SpinState, to: &SpinState) -> f64 {
        ((to.omega / from.omega).ln().abs() / SPIN_POINTS).max((to.t_s - from.t_s) / self.spacing_s)
    }

    /// Adds the states of a step that are one spacing after the other from the last one on.
    fn follow(&mut self, course: &Course) {
        let last = self.last();
        let (before, after) = (self.distance(&last, &course.at(0.0)), self.distance(&last, &course.at(1.0)));
        for k in 1..=after as u32 {
            let fraction = (f64::from(k) - before) / (after - before);
            self.states.push(course.at(fraction.clamp(0.0, 1.0)));
        }
    }

    /// The end of a leg, in the place of a state within a millionth of the spacing of it.
    fn end(&mut self, state: SpinState) {
        if self.states.len() > 1 && state.t_s - self.last().t_s < 1e-6 * self.spacing_s {
            self.states.pop();
        }
        self.states.push(state);
    }
}

/// Where the axis turns to: the next zero of `T_epsilon` on its way. The sign of `T_omega` there decides between spinning down
/// in finite time and spinning up for ever.
fn attractor<T: TorqueFunction>(torque: &T, errors: TorqueErrors, inertia: f64, state: &SpinState) -> Attractor {
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
    let (spin_torque, _) = at(here);
    let is_known = spin_torque.abs() > errors.spin;
    Attractor { obliquity: here, omega_rate: if is_known { spin_torque / inertia } else { 0.0 } }
}

#[cfg(test)]
mod tests {
    use super::super::spin::YEAR_S;
    use super::*;

    const INERTIA: f64 = 3.7e17;
    const MYR_S: f64 = 1e6 * YEAR_S;
    const ADAPTIVE: Integrator = Integrator::Adaptive { tolerance: TOLERANCE };

    fn rk4(step_yr: f64) -> Integrator {
        Integrator::Rk4 { step_s: step_yr * YEAR_S }
    }

    fn start(period_h: f64, obliquity_deg: f64) -> SpinState {
        SpinState { t_s: 0.0, omega: TAU / (period_h * 3600.0), obliquity: obliquity_deg.to_radians() }
    }

    /// The cycle under a torque without error.
    fn known(
        torque: &impl TorqueFunction,
        inertia: f64,
        start: SpinState,
        duration_s: f64,
        integrator: Integrator,
    ) -> Result<RigidCycle, SpinError> {
        rigid_cycle(torque, TorqueErrors::default(), inertia, start, duration_s, integrator)
    }

    /// Torque without thermal inertia: T_omega = A C (cos 2 eps + q), T_epsilon = B C sin 2 eps.
    fn double_angle(a: f64, b: f64, q: f64) -> impl Fn(f64, f64) -> (f64, f64) {
        move |e, _| (a * INERTIA * ((2.0 * e).cos() + q), b * INERTIA * (2.0 * e).sin())
    }

    #[test]
    fn a_body_that_ends_at_90_degrees_spins_up_then_down_to_zero() {
        let (a, b, q) = (1e-18, 0.8e-18, 0.0);
        let s = start(6.0, 5.0);
        let times = [rk4(1000.0), rk4(250.0), ADAPTIVE].map(|integrator| {
            let cycle = known(&double_angle(a, b, q), INERTIA, s, 300.0 * MYR_S, integrator).unwrap();
            assert_eq!(cycle.end, RigidEnd::SpunDown);
            assert_eq!((cycle.end_omega, cycle.min_omega), (0.0, 0.0));
            assert!((cycle.final_obliquity() - PI / 2.0).abs() < 1e-9);
            assert!((cycle.attractor.unwrap().omega_rate / -a - 1.0).abs() < 1e-9);
            // omega = omega0 (sin 2 eps / sin 2 eps0)^(k/2): the maximum lies at 45 degrees.
            let peak = s.omega * (1.0 / (2.0 * s.obliquity).sin()).powf(a / b / 2.0);
            assert!((cycle.max_omega / peak - 1.0).abs() < 1e-7, "{:e}", cycle.max_omega / peak - 1.0);
            assert!(cycle.states.windows(2).all(|w| w[1].t_s > w[0].t_s));
            assert!((200..2000).contains(&cycle.states.len()), "{}", cycle.states.len());
            assert!((0.0..1e-6).contains(&cycle.omega_error), "{:e}", cycle.omega_error);
            assert_eq!(cycle.first_above(cycle.max_omega), None);
            cycle.cycle_time_s.unwrap()
        });
        assert!((times[0] / times[1] - 1.0).abs() < 1e-8 && (times[2] / times[1] - 1.0).abs() < 1e-7, "{times:?}");
    }

    #[test]
    fn linear_spin_down_takes_the_time_of_its_closed_form() {
        for integrator in [rk4(1000.0), ADAPTIVE] {
            let torque = |_: f64, _: f64| (-1e-18 * INERTIA, 0.0);
            let cycle = known(&torque, INERTIA, start(6.0, 30.0), 30.0 * MYR_S, integrator).unwrap();
            let exact = TAU / (6.0 * 3600.0) / 1e-18;
            assert!((cycle.cycle_time_s.unwrap() / exact - 1.0).abs() < 1e-9);
            assert_eq!(cycle.max_omega, cycle.states[0].omega);
        }
    }

    #[test]
    fn a_body_whose_stable_obliquity_spins_it_up_ends_infinitely_fast() {
        // q = 1.5: T_omega > 0 at the stable 90 degrees.
        let torque = double_angle(1e-18, 0.8e-18, 1.5);
        for integrator in [rk4(1000.0), ADAPTIVE] {
            let cycle = known(&torque, INERTIA, start(6.0, 5.0), 30.0 * MYR_S, integrator).unwrap();
            assert_eq!((cycle.end, cycle.cycle_time_s), (RigidEnd::InfiniteSpinUp, None));
            assert!(cycle.end_omega.is_infinite() && cycle.max_omega.is_infinite());
            assert!((cycle.final_obliquity() - PI / 2.0).abs() < 1e-9);
            assert!((cycle.attractor.unwrap().omega_rate / 0.5e-18 - 1.0).abs() < 1e-9);
            assert_eq!(cycle.end_obliquity, cycle.states.last().unwrap().obliquity);
            assert_eq!(cycle.min_omega, cycle.states[0].omega);
            // Half-way in spin between two states that the integrator passed: its time lies between theirs.
            let (k, middle) =
                (cycle.states.len() / 2, |k: usize| 0.5 * (cycle.states[k].omega + cycle.states[k + 1].omega));
            let t = cycle.first_above(middle(k)).unwrap();
            assert!(cycle.states[k].t_s < t && t < cycle.states[k + 1].t_s);
        }
    }

    #[test]
    fn a_time_limit_before_the_end_is_said_to_be_one() {
        let torque = double_angle(1e-18, 0.8e-18, 0.0);
        for integrator in [rk4(1000.0), ADAPTIVE] {
            let cycle = known(&torque, INERTIA, start(6.0, 5.0), MYR_S, integrator).unwrap();
            assert_eq!((cycle.end, cycle.cycle_time_s), (RigidEnd::TimeLimit, None));
            assert_eq!((cycle.states.len(), cycle.states.last().unwrap().t_s), (401, MYR_S));
            // The last state, not where the axis tends.
            let last = cycle.states.last().unwrap();
            assert_eq!((cycle.end_omega, cycle.end_obliquity), (last.omega, last.obliquity));
            assert!(cycle.end_obliquity < 0.2 && cycle.final_obliquity() == cycle.end_obliquity);
            assert!((cycle.attractor.unwrap().obliquity - PI / 2.0).abs() < 1e-9);
        }
    }

    #[test]
    fn torques_below_their_errors_decide_nothing() {
        let (a, b) = (1e-18, 0.8e-18);
        let torque = double_angle(a, b, 1.5);
        let cycle = |spin: f64, obliquity: f64| {
            let errors = TorqueErrors { spin: spin * a * INERTIA, obliquity: obliquity * b * INERTIA };
            rigid_cycle(&torque, errors, INERTIA, start(6.0, 30.0), 30.0 * MYR_S, ADAPTIVE).unwrap()
        };
        assert_eq!(cycle(0.01, 0.01).end, RigidEnd::InfiniteSpinUp);
        let none = cycle(3.0, 1.1);
        assert_eq!((none.end, none.attractor, none.above_error), (RigidEnd::NoTorque, None, [false; 2]));
        assert_eq!(
            (none.max_omega, none.min_omega, none.end_omega),
            (none.states[0].omega, none.states[0].omega, none.states[0].omega)
        );
        assert!((none.end_obliquity.to_degrees() - 30.0).abs() < 1e-12 && none.states.len() == 2);
        // At the attractor T_omega is 0.5 a C: too little to be sure of its sign.
        let unsure = cycle(0.6, 0.01);
        assert_eq!((unsure.end, unsure.attractor.unwrap().omega_rate), (RigidEnd::TimeLimit, 0.0));
        // Only one of them is known: the obliquity stays, the spin goes on.
        let spin = cycle(0.01, 1.1);
        assert_eq!(spin.above_error, [true, false]);
        let turned = spin.states.iter().map(|s| (s.obliquity - spin.states[0].obliquity).abs());
        assert!(turned.fold(0.0, f64::max) < 1e-12 && spin.end == RigidEnd::InfiniteSpinUp);
        let turn = cycle(3.0, 0.01);
        assert!((turn.end_omega / turn.states[0].omega - 1.0).abs() < 1e-8);
        assert!(turn.end_obliquity > turn.states[0].obliquity + 0.1);
    }

    #[test]
    fn torques_that_vanish_together_stall_the_body() {
        let torque = |e: f64, _: f64| (1e-18 * INERTIA * (2.0 * e).sin(), 1e-17 * INERTIA * (2.0 * e).sin());
        for integrator in [rk4(1000.0), ADAPTIVE] {
            let cycle = known(&torque, INERTIA, start(6.0, 60.0), 60.0 * MYR_S, integrator).unwrap();
            assert_eq!(cycle.end, RigidEnd::Stalled);
            assert!((cycle.final_obliquity() - PI / 2.0).abs() < 1e-6);
            let none = known(&|_: f64, _: f64| (0.0, 0.0), INERTIA, start(6.0, 60.0), MYR_S, integrator).unwrap();
            assert_eq!((none.end, none.states.len()), (RigidEnd::Stalled, 1));
        }
    }

    #[test]
    fn axis_pulled_to_a_pole_ends_there() {
        let torque = |e: f64, _: f64| (-1e-18 * INERTIA, -1e-17 * INERTIA * e.sin());
        for integrator in [rk4(1000.0), ADAPTIVE] {
            let cycle = known(&torque, INERTIA, start(6.0, 60.0), 60.0 * MYR_S, integrator).unwrap();
            assert_eq!(cycle.end, RigidEnd::SpunDown);
            assert!(cycle.final_obliquity() < 1e-9 && cycle.end_obliquity < 0.1);
        }
    }
}
