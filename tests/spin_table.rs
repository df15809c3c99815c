//! The spin integrator through a tabulated torque curve: what the interpolation between obliquities costs.

use taco::{Interpolation, TorqueError, TorqueTable};
use yorp::evolve::spin::{LegLimits, SpinState, YEAR_S, integrate_leg};

const A: f64 = 1e-18;
const INERTIA: f64 = 3.7e17;

/// `T_omega = A C cos eps`, `T_epsilon = A C sin eps`, tabulated every `step_deg`.
fn table(step_deg: f64) -> TorqueTable {
    let intervals = (180.0 / step_deg).round() as usize;
    let obliquity: Vec<f64> = (0..=intervals).map(|k| std::f64::consts::PI * k as f64 / intervals as f64).collect();
    TorqueTable {
        spin_torque_n_m: vec![obliquity.iter().map(|e| A * INERTIA * e.cos()).collect()],
        obliquity_torque_n_m: vec![obliquity.iter().map(|e| A * INERTIA * e.sin()).collect()],
        omega: vec![0.0],
        obliquity,
        error: TorqueError::default(),
        transverse_force_n: Vec::new(),
        shaded_facets: 0,
    }
}

/// Relative error of the spin rate and error of the obliquity, rad, after 10 Myr from 6 h and 5 degrees.
fn errors(step_deg: f64, interpolation: Interpolation) -> (f64, f64) {
    let curve = table(step_deg).interpolant(interpolation).unwrap();
    let end_time_s = 1e7 * YEAR_S;
    let start = SpinState { t_s: 0.0, omega: std::f64::consts::TAU / 21_600.0, obliquity: 5_f64.to_radians() };
    let limits = LegLimits {
        spin_change: f64::INFINITY,
        stop_period_s: None,
        end_state_fraction: None,
        ..LegLimits::until(end_time_s)
    };
    let leg = integrate_leg(&|e, omega| curve.at(e, omega), INERTIA, start, &limits).unwrap();
    // Equal amplitudes: eps = eps0 + A sin(eps0) t / omega0, omega = omega0 sin eps / sin eps0.
    let obliquity = start.obliquity + A * start.obliquity.sin() * end_time_s / start.omega;
    let omega = start.omega * obliquity.sin() / start.obliquity.sin();
    ((leg.end.omega / omega - 1.0).abs(), (leg.end.obliquity - obliquity).abs())
}

#[test]
fn five_degree_table_costs_less_than_1e_minus_7_by_splines_and_1e_minus_3_by_lines() {
    for (interpolation, spin_limit, obliquity_limit) in
        [(Interpolation::Cubic, 1e-7, 1e-7), (Interpolation::Linear, 1e-3, 1e-3)]
    {
        let (spin, obliquity) = errors(5.0, interpolation);
        println!("5-degree table, {interpolation:?}: spin {spin:.1e} (relative), obliquity {obliquity:.1e} rad");
        assert!(spin < spin_limit && obliquity < obliquity_limit, "{interpolation:?}: {spin:e} {obliquity:e}");
    }
}

#[test]
fn interpolation_error_falls_with_the_fourth_or_second_power_of_the_spacing() {
    for (interpolation, order) in [(Interpolation::Cubic, 4.0), (Interpolation::Linear, 2.0)] {
        let (coarse, fine) = (errors(10.0, interpolation).0, errors(5.0, interpolation).0);
        assert!(((coarse / fine).log2() - order).abs() < 0.5, "{interpolation:?}: {coarse:e} {fine:e}");
    }
}
