//! Closed-form solutions and laws that a leg of the spin evolution must meet.

use std::f64::consts::PI;

use super::*;

const OMEGA_6H: f64 = std::f64::consts::TAU / (6.0 * 3600.0);
const A: f64 = 1e-18;
const MYR_S: f64 = 1e6 * YEAR_S;
const INERTIA: f64 = 3.7e17;

/// Only the end time ends a leg.
fn to_the_end(end_time_s: f64, step_yr: f64) -> LegLimits {
    LegLimits {
        integrator: Integrator::Rk4 { step_s: step_yr * YEAR_S },
        spin_change: f64::INFINITY,
        end_time_s,
        stop_period_s: None,
        end_state_fraction: None,
    }
}

/// `T_omega = A C cos eps`, `T_epsilon = B C sin eps` with `k = A / B`.
fn cosine_pair(a: f64, b: f64) -> impl Fn(f64, f64) -> (f64, f64) {
    move |e, _| (a * INERTIA * e.cos(), b * INERTIA * e.sin())
}

/// The same with steps that keep a tolerance.
fn within(end_time_s: f64, tolerance: f64) -> LegLimits {
    LegLimits { integrator: Integrator::Adaptive { tolerance }, ..to_the_end(end_time_s, 1000.0) }
}

fn start(obliquity_deg: f64) -> SpinState {
    SpinState { t_s: 0.0, omega: OMEGA_6H, obliquity: obliquity_deg.to_radians() }
}

#[test]
fn cosine_pair_follows_its_closed_form_to_1e_minus_12() {
    // Rubincam's equations with d ln omega / d eps = k cot eps; values for 1 Myr from 6 h and 5 degrees.
    let e0 = 5.0_f64.to_radians();
    let s0 = e0.sin();
    let bt = |k: f64| A / k * MYR_S / OMEGA_6H;
    let closed = [
        (1.0, 1.108_027_900_510, 5.541_746_969_545, e0 + bt(1.0) * s0),
        (2.0, 1.108_051_861_038, 5.263_926_406_899, (e0.cos() - bt(2.0) * s0 * s0).acos()),
        (-1.0, 1.108_114_552_034, 4.511_103_303_649, (e0.cos() / s0 - bt(-1.0) / s0).recip().atan()),
    ];
    for (k, ratio, degrees, obliquity) in closed {
        let leg = integrate_leg(&cosine_pair(A, A / k), INERTIA, start(5.0), &to_the_end(MYR_S, 1000.0)).unwrap();
        let omega = OMEGA_6H * (obliquity.sin() / s0).powf(k);
        assert!((leg.end.omega / omega - 1.0).abs() < 1e-12, "k = {k}: {}", leg.end.omega / omega - 1.0);
        assert!((leg.end.obliquity - obliquity).abs() < 1e-12, "k = {k}: {}", leg.end.obliquity - obliquity);
        assert!((leg.end.omega / OMEGA_6H - ratio).abs() < 1e-12, "k = {k}");
        assert!((leg.end.obliquity.to_degrees() - degrees).abs() < 1e-12, "k = {k}");
        assert_eq!((leg.reason, leg.end.t_s, leg.steps), (StopReason::EndTime, MYR_S, 1000));
        let adaptive = integrate_leg(&cosine_pair(A, A / k), INERTIA, start(5.0), &within(MYR_S, 1e-12)).unwrap();
        assert!((adaptive.end.omega / omega - 1.0).abs() < 1e-11, "k = {k}: {}", adaptive.end.omega / omega - 1.0);
        assert!((adaptive.end.obliquity - obliquity).abs() < 1e-11, "k = {k}");
        assert!(adaptive.steps < 100, "{}", adaptive.steps);
    }
}

#[test]
fn constant_spin_turns_its_axis_exponentially() {
    // A = 0: tan(eps/2) grows as exp(B t / omega0).
    let leg = integrate_leg(&cosine_pair(0.0, 2e-18), INERTIA, start(40.0), &to_the_end(2.0 * MYR_S, 1000.0)).unwrap();
    let tangent = 20.0_f64.to_radians().tan() * (2e-18 * 2.0 * MYR_S / OMEGA_6H).exp();
    assert_eq!(leg.end.omega, OMEGA_6H);
    assert!((leg.end.obliquity - 2.0 * tangent.atan()).abs() < 1e-12);
}

#[test]
fn double_angle_pair_follows_its_closed_form_to_1e_minus_12() {
    // The symmetry of real torques without thermal inertia: T_omega even, T_epsilon odd about 90 degrees.
    let (b, q) = (0.7e-18, 0.3);
    let k = A / b;
    let torque = move |e: f64, _: f64| (A * INERTIA * ((2.0 * e).cos() + q), b * INERTIA * (2.0 * e).sin());
    let s = start(20.0);
    let leg = integrate_leg(&torque, INERTIA, s, &to_the_end(8.0 * MYR_S, 1000.0)).unwrap();
    let e = leg.end.obliquity;
    assert!(e > 40.0_f64.to_radians(), "the test must cover a wide range: {e}");
    let expected = OMEGA_6H
        * ((2.0 * e).sin() / (2.0 * s.obliquity).sin()).powf(k / 2.0)
        * (e.tan() / s.obliquity.tan()).powf(k * q / 2.0);
    assert!((leg.end.omega / expected - 1.0).abs() < 1e-12, "{}", leg.end.omega / expected - 1.0);
}

#[test]
fn error_falls_with_the_fourth_power_of_the_step() {
    let torque = cosine_pair(A, A);
    let end = 10.0 * MYR_S;
    let e0 = 5.0_f64.to_radians();
    let exact = e0 + A * e0.sin() * end / OMEGA_6H;
    let run = |step_yr| integrate_leg(&torque, INERTIA, start(5.0), &to_the_end(end, step_yr)).unwrap();
    let (fine, coarse) = (run(1e5), run(2e5));
    let ratio = (coarse.end.obliquity - exact) / (fine.end.obliquity - exact);
    assert!((ratio.log2() - 4.0).abs() < 0.3, "error ratio {ratio}");
    // The estimate that a run prints is the true error within a third.
    let estimate = coarse.error.obliquity / (coarse.end.obliquity - exact).abs();
    assert!((0.7..1.4).contains(&estimate), "estimate / error = {estimate}");
}

#[test]
fn error_follows_the_tolerance_and_the_estimate_follows_the_error() {
    let torque = cosine_pair(A, A);
    let end = 60.0 * MYR_S;
    let e0 = 5.0_f64.to_radians();
    let exact = e0 + A * e0.sin() * end / OMEGA_6H;
    let mut last = f64::INFINITY;
    for tolerance in [1e-8, 1e-9, 1e-10, 1e-11] {
        let leg = integrate_leg(&torque, INERTIA, start(5.0), &within(end, tolerance)).unwrap();
        let error = (leg.end.obliquity - exact).abs();
        println!(
            "tolerance {tolerance:e}: {} steps, error {error:.1e}, estimate {:.1e}",
            leg.steps, leg.error.obliquity
        );
        assert!(error < 10.0 * tolerance && error < 0.5 * last, "{tolerance:e}: {error:e}");
        assert!((0.5..2.0).contains(&(leg.error.obliquity / error)), "{:e} for {error:e}", leg.error.obliquity);
        last = error;
    }
}

#[test]
fn course_within_an_adaptive_step_is_of_fourth_order() {
    let torque = cosine_pair(A, A);
    let s = start(30.0);
    let worst = |tolerance: f64| {
        let mut worst = 0.0_f64;
        let mut look = |course: &Course| {
            for k in 1..10 {
                let state = course.at(0.1 * f64::from(k));
                let exact = s.obliquity + A * s.obliquity.sin() * state.t_s / OMEGA_6H;
                worst = worst.max((state.obliquity - exact).abs());
            }
        };
        follow_leg(&torque, INERTIA, s, &within(20.0 * MYR_S, tolerance), &mut look).unwrap();
        worst
    };
    for tolerance in [1e-6, 1e-9] {
        assert!(worst(tolerance) < 20.0 * tolerance, "{tolerance:e}: {:e}", worst(tolerance));
    }
}

/// Independent integration in `p = omega cos eps`, `q = omega sin eps`, which is regular at the poles and at zero spin.
fn integrate_pq(torque: impl Fn(f64, f64) -> (f64, f64), start: &SpinState, duration_s: f64, steps: u32) -> (f64, f64) {
    let rate = |p: f64, q: f64| {
        let (omega, e) = (p.hypot(q), q.atan2(p));
        let (spin, obliquity) = torque(e.abs(), omega);
        let turn = obliquity * e.signum();
        ((spin * e.cos() - turn * e.sin()) / INERTIA, (spin * e.sin() + turn * e.cos()) / INERTIA)
    };
    let (mut p, mut q) = (start.omega * start.obliquity.cos(), start.omega * start.obliquity.sin());
    let h = duration_s / f64::from(steps);
    for _ in 0..steps {
        let a = rate(p, q);
        let b = rate(p + 0.5 * h * a.0, q + 0.5 * h * a.1);
        let c = rate(p + 0.5 * h * b.0, q + 0.5 * h * b.1);
        let d = rate(p + h * c.0, q + h * c.1);
        p += h / 6.0 * (a.0 + 2.0 * (b.0 + c.0) + d.0);
        q += h / 6.0 * (a.1 + 2.0 * (b.1 + c.1) + d.1);
    }
    (p, q)
}

#[test]
fn regular_variables_give_the_same_evolution_down_to_1e_minus_6_rad_per_s() {
    // Spin-down at 70 degrees towards 90: the obliquity turns ever faster as the spin vanishes.
    let torque = |e: f64, _: f64| (A * INERTIA * ((2.0 * e).cos() - 0.2), 0.5e-18 * INERTIA * (2.0 * e).sin());
    let s = start(70.0);
    let mut limits = to_the_end(30.0 * MYR_S, 1000.0);
    limits.stop_period_s = None;
    let leg = integrate_leg(&torque, INERTIA, s, &limits).unwrap();
    assert_eq!(leg.reason, StopReason::CycleEnd);
    assert!((leg.end.omega / CYCLE_END_OMEGA - 1.0).abs() < 1e-9);
    let (p, q) = integrate_pq(torque, &s, leg.end.t_s, 200_000);
    // The spin has fallen by a factor of 80 since the start; round-off of either form grows by as much.
    assert!((p.hypot(q) - leg.end.omega).abs() < 1e-10 * OMEGA_6H, "{} {}", p.hypot(q), leg.end.omega);
    assert!((q.atan2(p) - leg.end.obliquity).abs() < 1e-10, "{}", q.atan2(p) - leg.end.obliquity);
    // The adaptive integrator, which works in these variables, to 1e-10 down to 1e-6 rad/s as well.
    limits.integrator = Integrator::Adaptive { tolerance: 1e-13 };
    let adaptive = integrate_leg(&torque, INERTIA, s, &limits).unwrap();
    assert_eq!(adaptive.reason, StopReason::CycleEnd);
    assert!((adaptive.end.t_s / leg.end.t_s - 1.0).abs() < 1e-10, "{}", adaptive.end.t_s / leg.end.t_s - 1.0);
    assert!((adaptive.end.obliquity - leg.end.obliquity).abs() < 1e-10);
}

#[test]
fn regular_variables_pass_zero_spin_and_the_leg_ends_before_it() {
    let torque = cosine_pair(-A, -A);
    let s = start(60.0);
    // eps = eps0 + B sin(eps0) t / omega0 reaches 0, and the spin with it, here:
    let zero_s = s.obliquity * OMEGA_6H / (A * s.obliquity.sin());
    let (p, q) = integrate_pq(&torque, &s, 2.0 * zero_s, 20_000);
    assert!(p.is_finite() && q.is_finite(), "beyond zero spin: {p} {q}");
    for limits in [to_the_end(2.0 * zero_s, 1000.0), within(2.0 * zero_s, 1e-9)] {
        let leg = integrate_leg(&torque, INERTIA, s, &limits).unwrap();
        assert_eq!(leg.reason, StopReason::CycleEnd);
        assert!((leg.end.t_s / zero_s - 1.0).abs() < 0.02);
        // From there to zero, at the time of the closed form.
        let stop = standstill(&torque, INERTIA, &leg.end).unwrap();
        let t_s = leg.end.t_s + stop.duration_s;
        assert!((t_s / zero_s - 1.0).abs() < 1e-7, "{}", t_s / zero_s - 1.0);
        assert_eq!(stop.omega, 0.0);
        assert!(stop.obliquity < 1e-4);
    }
}

#[test]
fn a_spin_that_turns_before_it_vanishes_is_found_at_its_minimum() {
    // T_omega < 0 below 45 degrees and > 0 above, the axis on its way up: omega^2 = omega0^2 sin 2 eps0 / sin 2 eps.
    let torque = |e: f64, _: f64| (-A * INERTIA * (2.0 * e).cos(), A * INERTIA * (2.0 * e).sin());
    let slow = SpinState { t_s: 0.0, omega: 0.9 * CYCLE_END_OMEGA, obliquity: 0.5 };
    let stop = standstill(&torque, INERTIA, &slow).unwrap();
    let least = slow.omega * (2.0 * slow.obliquity).sin().sqrt();
    assert!((stop.omega / least - 1.0).abs() < 1e-8, "{} {least}", stop.omega);
    assert!((stop.obliquity - PI / 4.0).abs() < 1e-8);
}

#[test]
fn a_leg_ends_at_half_a_percent_of_spin_change() {
    // At T/C = 1e-18 and 6 h: 1.45e12 s, the "few 1e4 yr" of the paper.
    let leg = integrate_leg(&cosine_pair(A, 0.0), INERTIA, start(0.0), &LegLimits::until(MYR_S)).unwrap();
    assert_eq!((leg.reason, leg.steps), (StopReason::SpinChange, 47));
    assert!((leg.end.t_s - 0.005 * OMEGA_6H / A).abs() < 1e-6 * 1000.0 * YEAR_S);
    assert_eq!(leg.end.obliquity, 0.0);
    let down = integrate_leg(&cosine_pair(-A, 0.0), INERTIA, start(0.0), &LegLimits::until(MYR_S)).unwrap();
    assert!((down.end.omega / OMEGA_6H - 0.995).abs() < 1e-9);
}

#[test]
fn a_leg_ends_at_an_extremum_and_the_next_one_leaves_it() {
    // cos 2 eps changes sign at 45 degrees, which the obliquity passes.
    let torque = |e: f64, _: f64| (A * INERTIA * (2.0 * e).cos(), 1e-17 * INERTIA * (2.0 * e).sin());
    let limits = LegLimits { spin_change: 0.5, ..LegLimits::until(100.0 * MYR_S) };
    let top = integrate_leg(&torque, INERTIA, start(44.0), &limits).unwrap();
    assert_eq!(top.reason, StopReason::Extremum);
    assert!((top.end.obliquity - PI / 4.0).abs() < 1e-9, "{}", top.end.obliquity - PI / 4.0);
    let next = integrate_leg(&torque, INERTIA, top.end, &limits).unwrap();
    assert!(next.end.t_s > top.end.t_s + 1000.0 * YEAR_S);
    assert_ne!(next.reason, StopReason::Extremum);
    assert!(next.end.omega < top.end.omega);
}

#[test]
fn legs_cut_anywhere_meet_at_the_same_state() {
    let torque = cosine_pair(A, 2.0 * A);
    let whole = integrate_leg(&torque, INERTIA, start(30.0), &to_the_end(MYR_S, 1000.0)).unwrap();
    let half = integrate_leg(&torque, INERTIA, start(30.0), &to_the_end(0.5 * MYR_S, 1000.0)).unwrap();
    let rest = integrate_leg(&torque, INERTIA, half.end, &to_the_end(MYR_S, 1000.0)).unwrap();
    assert!((rest.end.omega / whole.end.omega - 1.0).abs() < 1e-13);
    assert_eq!(rest, integrate_leg(&torque, INERTIA, half.end, &to_the_end(MYR_S, 1000.0)).unwrap());
}

/// A run that stops at a time and goes on later must be the one that never stopped.
#[test]
fn where_a_leg_ends_does_not_depend_on_when_the_time_is_up() {
    let torque = |e: f64, _: f64| (60.0 * A * INERTIA * (e - 0.101).sin(), 40.0 * A * INERTIA * e.sin());
    let limits = |end_time_s| LegLimits { spin_change: 0.005, ..to_the_end(end_time_s, 1000.0) };
    let from = SpinState { obliquity: 0.1, ..start(0.0) };
    let free = integrate_leg(&torque, INERTIA, from, &limits(MYR_S)).unwrap();
    assert_ne!(free.reason, StopReason::EndTime);
    for beyond in [1.0 + 1e-12, 1.0001, 1.01, 1.5, 3.0] {
        assert_eq!(integrate_leg(&torque, INERTIA, from, &limits(beyond * free.end.t_s)).unwrap().end, free.end);
    }
    let before = integrate_leg(&torque, INERTIA, from, &limits(0.9 * free.end.t_s)).unwrap();
    assert_eq!((before.reason, before.end.t_s), (StopReason::EndTime, 0.9 * free.end.t_s));
}

#[test]
fn slow_bodies_stop_only_while_they_slow_down() {
    let slow = SpinState { t_s: 0.0, omega: std::f64::consts::TAU / (30.0 * 3600.0), obliquity: 0.0 };
    let up = integrate_leg(&cosine_pair(A, 0.0), INERTIA, slow, &LegLimits::until(MYR_S)).unwrap();
    assert_eq!(up.reason, StopReason::SpinChange);
    let down = integrate_leg(&cosine_pair(-A, 0.0), INERTIA, slow, &LegLimits::until(MYR_S)).unwrap();
    assert_eq!((down.reason, down.steps, down.end), (StopReason::StopPeriod, 0, slow));
    let limits = LegLimits { spin_change: f64::INFINITY, ..LegLimits::until(100.0 * MYR_S) };
    let crossing = integrate_leg(&cosine_pair(-A, 0.0), INERTIA, start(0.0), &limits).unwrap();
    assert_eq!(crossing.reason, StopReason::StopPeriod);
    assert!((crossing.end.omega * 20.0 * 3600.0 / std::f64::consts::TAU - 1.0).abs() < 1e-9);
}

#[test]
fn a_body_without_torque_is_at_its_end_state_or_goes_on_to_the_end_time() {
    let none = |_: f64, _: f64| (0.0, 0.0);
    let s = start(30.0);
    let leg = integrate_leg(&none, INERTIA, s, &LegLimits::until(MYR_S)).unwrap();
    assert_eq!((leg.reason, leg.end), (StopReason::EndState, s));
    let limits = LegLimits { end_state_fraction: None, ..LegLimits::until(MYR_S) };
    let on = integrate_leg(&none, INERTIA, s, &limits).unwrap();
    assert_eq!((on.reason, on.end), (StopReason::EndTime, SpinState { t_s: MYR_S, ..s }));
}

#[test]
fn fixed_point_of_both_torques_is_approached_without_a_storm_of_legs() {
    // At 90 degrees T_epsilon vanishes with a stable slope and T_omega with it.
    let torque = |e: f64, _: f64| (A * INERTIA * (2.0 * e).sin(), 1e-16 * INERTIA * (2.0 * e).sin());
    let limits = LegLimits { end_state_fraction: None, ..LegLimits::until(15.0 * MYR_S) };
    let (mut state, mut legs) = (start(60.0), 0);
    while state.t_s < 15.0 * MYR_S {
        let leg = integrate_leg(&torque, INERTIA, state, &limits).unwrap();
        assert!(leg.end.t_s > state.t_s);
        state = leg.end;
        legs += 1;
        assert!(legs < 20, "{legs} legs at {}", state.t_s / MYR_S);
    }
    assert!((state.obliquity - PI / 2.0).abs() < 1e-9);
}

#[test]
fn a_stiff_small_body_settles_at_its_stable_obliquity() {
    // A metre-sized body relaxes within years, far below the 1000-yr step.
    let torque = |e: f64, _: f64| (0.0, 1e-12 * INERTIA * (2.0 * e).sin());
    let leg = integrate_leg(&torque, INERTIA, start(10.0), &to_the_end(0.01 * MYR_S, 1000.0)).unwrap();
    assert!((leg.end.obliquity - PI / 2.0).abs() < 1e-12);
}

#[test]
fn obliquity_stays_within_its_range_at_the_poles() {
    let torque = |e: f64, _: f64| (0.0, INERTIA * 1e-16 * if e < 1.0 { -1.0 } else { 1.0 });
    for (from, pole) in [(0.5, 0.0), (179.5, PI)] {
        let leg = integrate_leg(&torque, INERTIA, start(from), &to_the_end(MYR_S, 1000.0)).unwrap();
        assert!((0.0..=PI).contains(&leg.end.obliquity) && (leg.end.obliquity - pole).abs() < 0.01);
    }
    // Exactly at the pole nothing pulls, whatever the table says.
    let at_pole = integrate_leg(&torque, INERTIA, start(0.0), &to_the_end(MYR_S, 1000.0)).unwrap();
    assert_eq!(at_pole.end.obliquity, 0.0);
}

#[test]
fn a_torque_that_is_no_number_is_named_with_its_time() {
    let bad = |e: f64, _: f64| (if e > 0.1 { f64::NAN } else { A * INERTIA }, 1e-17 * INERTIA);
    let error = integrate_leg(&bad, INERTIA, start(5.0), &to_the_end(100.0 * MYR_S, 1000.0)).unwrap_err();
    let SpinError::NonFinite { t_s, obliquity, spin_torque, .. } = &error else { panic!("{error}") };
    assert!(*t_s > 0.0 && *obliquity > 0.1 && spin_torque.is_nan(), "{error}");
    assert!(error.to_string().contains("Myr"), "{error}");
}

#[test]
fn impossible_inputs_are_refused_by_name() {
    let torque = cosine_pair(A, A);
    let limits = LegLimits::until(MYR_S);
    for (inertia, state, name) in [
        (0.0, start(5.0), "moment of inertia"),
        (f64::NAN, start(5.0), "moment of inertia"),
        (INERTIA, SpinState { omega: -1.0, ..start(5.0) }, "spin rate"),
        (INERTIA, start(181.0), "obliquity"),
        (INERTIA, SpinState { t_s: f64::INFINITY, ..start(5.0) }, "time"),
    ] {
        let error = integrate_leg(&torque, inertia, state, &limits).unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
    }
}
