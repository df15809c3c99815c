//! The last of a spin-down: from a slow rotation to the moment at which the spin vanishes.
//!
//! In the components of the spin vector nothing is singular there. A spin that falls towards a stable obliquity reaches
//! zero in finite time; another may turn before and grow again.

use super::adaptive::Adaptive;
use super::events::locate;
use super::problem::Problem;
use super::{CYCLE_END_OMEGA, SpinError, SpinState, TorqueFunction, TorqueScale};

/// Error allowed to one step, relative to [`CYCLE_END_OMEGA`].
const TOLERANCE: f64 = 1e-9;
/// Fraction of [`CYCLE_END_OMEGA`] from which on the torque is taken as constant.
const ALMOST_ZERO: f64 = 1e-4;
/// Fraction of the largest spin torque below which the spin no longer falls.
const NO_TORQUE: f64 = 1e-9;

/// Where and when a spin-down comes to an end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Standstill {
    /// Time from the slow rotation on, s.
    pub duration_s: f64,
    /// The spin rate there, rad/s: 0, or the smallest one where the spin turns or stalls before.
    pub omega: f64,
    /// Obliquity there, rad.
    pub obliquity: f64,
}

/// Follows a body that turns slowly and slows down until it stops or spins up again.
///
/// # Errors
/// A torque that is not finite.
pub(crate) fn standstill<T: TorqueFunction>(
    torque: &T,
    inertia: f64,
    from: &SpinState,
) -> Result<Standstill, SpinError> {
    let problem = Problem { torque, inertia, t0: from.t_s, slope: 0.0 };
    let mut stepper = Adaptive::new(TOLERANCE);
    let least = NO_TORQUE * TorqueScale::of(torque, from.omega).spin / inertia;
    let (sin, cos) = from.obliquity.sin_cos();
    let mut y = [from.omega * cos, from.omega * sin];
    let mut tau = 0.0;
    // Negative rate of the spin rate, rad/s^2.
    let slowing = |tau: f64, y: [f64; 2]| {
        problem.vector_rates(tau, y).map(|rates| -(y[0] * rates[0] + y[1] * rates[1]) / y[0].hypot(y[1]))
    };
    loop {
        let (omega, falls) = (y[0].hypot(y[1]), slowing(tau, y)?);
        let stop = |duration_s, omega| Standstill { duration_s, omega, obliquity: y[1].abs().atan2(y[0]) };
        if falls <= least {
            return Ok(stop(tau, omega));
        }
        if omega <= ALMOST_ZERO * CYCLE_END_OMEGA {
            return Ok(stop(tau + omega / falls, 0.0));
        }
        // Half-way to where a constant torque would stop it: no step passes zero unseen.
        let step = stepper.advance(&problem, tau, y, 0.5 * omega / falls)?;
        let turned = |theta: f64| slowing(tau, step.vector_at(theta)).is_ok_and(|falls| falls <= least);
        let theta = if turned(1.0) { locate(turned, 1.0) } else { 1.0 };
        y = step.vector_at(theta);
        tau += theta * step.h;
    }
}
