//! Spin state of a body under a torque, and one leg of its evolution: the types; `leg` follows it from event to event,
//! `rk4` and `adaptive` take the steps.
//!
//! Source: Rubincam (2000), Icarus 148, 2, as in Cotto-Figueroa et al. (2015), ApJ 803, 25, equations 2 and 3:
//! `d omega/dt = T_omega / C`, `d epsilon/dt = T_epsilon / (C omega)`.
//! SI units; obliquity is the angle between the spin vector and the orbit normal, 0 to pi rad.

mod adaptive;
mod events;
mod leg;
mod problem;
mod rk4;
#[cfg(test)]
mod tests;
mod zero;

pub use leg::integrate_leg;
pub(crate) use leg::{Course, follow_leg};
pub(crate) use zero::standstill;

/// Julian year, s.
pub const YEAR_S: f64 = 365.25 * 86_400.0;

/// Spin rate below which a leg ends as [`StopReason::CycleEnd`], rad/s: a period of 20 days. More slowly than that a
/// real body tumbles and meets spin-orbit resonances, which principal-axis equations do not know.
pub const CYCLE_END_OMEGA: f64 = std::f64::consts::TAU / (20.0 * 86_400.0);

/// Spin- and orbit-averaged torque of a body as a function of its spin state.
///
/// The integrator is compiled for each implementation, so that tests put closed forms in the place of a table.
pub trait TorqueFunction {
    /// `(T_omega, T_epsilon)` in N m at an obliquity in `[0, pi]` rad and a spin rate in rad/s.
    fn at(&self, obliquity: f64, omega: f64) -> (f64, f64);
}

impl<F: Fn(f64, f64) -> (f64, f64)> TorqueFunction for F {
    fn at(&self, obliquity: f64, omega: f64) -> (f64, f64) {
        self(obliquity, omega)
    }
}

/// Spin state of a body that turns about its axis of largest moment of inertia.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpinState {
    /// Time since the start of the run, s.
    pub t_s: f64,
    /// Spin rate, rad/s, > 0.
    pub omega: f64,
    /// Obliquity, rad, `[0, pi]`.
    pub obliquity: f64,
}

/// How a leg is integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Integrator {
    /// Fourth-order Runge-Kutta in spin rate and obliquity.
    Rk4 {
        /// Step, s; 1000 yr in the paper. Cut where the obliquity would turn by more than 0.01 rad or the spin rate
        /// change by more than 5 % within one.
        step_s: f64,
    },
    /// Embedded Runge-Kutta of order 5 in the components of the spin vector along and across the orbit normal.
    Adaptive {
        /// Error allowed to one step, relative to the spin rate, hence in rad for the obliquity; 1e-13 to 0.01.
        tolerance: f64,
    },
}

/// When a leg ends, and the steps it is taken with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LegLimits {
    /// How it is integrated \[fourth-order Runge-Kutta, 1000 yr\].
    pub integrator: Integrator,
    /// Relative change of the spin rate since the start of the leg that ends it \[0.005\]; infinite for never.
    pub spin_change: f64,
    /// Time at which the run ends, s on the clock of [`SpinState::t_s`].
    pub end_time_s: f64,
    /// Period, s, beyond which a body that slows down is given up \[20 h\]; `None` leaves only [`CYCLE_END_OMEGA`].
    pub stop_period_s: Option<f64>,
    /// A leg ends where both torques have fallen to this fraction of their largest values over all obliquities: the
    /// end state of a rigid body \[1e-3\]. `None` where a body that stalls shall be followed to the end time.
    pub end_state_fraction: Option<f64>,
}

impl LegLimits {
    /// The values of Cotto-Figueroa et al. (2015), section 2.4 and 3, with the given end time, s.
    pub fn until(end_time_s: f64) -> Self {
        Self {
            integrator: Integrator::Rk4 { step_s: 1000.0 * YEAR_S },
            spin_change: 0.005,
            end_time_s,
            stop_period_s: Some(20.0 * 3600.0),
            end_state_fraction: Some(1e-3),
        }
    }
}

/// Why a leg ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StopReason {
    /// The spin rate changed by [`LegLimits::spin_change`]: hand the body to the dynamics, then go on.
    SpinChange,
    /// The spin rate passed a maximum or minimum: hand the body to the dynamics, then go on.
    Extremum,
    /// [`LegLimits::end_time_s`] was reached.
    EndTime,
    /// The body slows down beyond [`LegLimits::stop_period_s`].
    StopPeriod,
    /// Both torques have vanished, see [`LegLimits::end_state_fraction`].
    EndState,
    /// The body slows down below [`CYCLE_END_OMEGA`]: the YORP cycle is over.
    CycleEnd,
}

/// What one leg did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leg {
    /// State at its end.
    pub end: SpinState,
    /// Why it ended.
    pub reason: StopReason,
    /// Runge-Kutta steps taken; 0 if the start state is already an end ([`StopReason::EndTime`] and the like).
    pub steps: u64,
    /// Difference to the same leg taken with half the step or a tenth of the tolerance, made an estimate of its error.
    pub error: LegError,
}

/// Estimated integration error at the end of a leg (not the error of the torque).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LegError {
    /// Of the spin rate, relative.
    pub omega: f64,
    /// Of the obliquity, rad.
    pub obliquity: f64,
}

/// Why a spin state cannot be integrated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpinError {
    /// An input outside its range.
    #[error("{what} is {value}, allowed: {allowed}")]
    BadInput {
        /// Which.
        what: &'static str,
        /// The value found.
        value: f64,
        /// The range.
        allowed: &'static str,
    },
    /// A torque that varies so wildly that no step keeps the tolerance.
    #[error(
        "at {:.6} Myr a step of {step_s:e} s does not meet the tolerance {tolerance:e}: the torque jumps or the body \
         is too small for this time span",
        t_s / (1e6 * YEAR_S)
    )]
    StepTooSmall {
        /// Time, s.
        t_s: f64,
        /// Last step, s.
        step_s: f64,
        /// The tolerance.
        tolerance: f64,
    },
    /// A torque or the state that followed from it is not finite.
    #[error(
        "at {:.6} Myr (spin {omega} rad/s, obliquity {obliquity} rad) the torque is not finite or too large: \
         T_omega = {spin_torque} N m, T_epsilon = {obliquity_torque} N m",
        t_s / (1e6 * YEAR_S)
    )]
    NonFinite {
        /// Time, s.
        t_s: f64,
        /// Spin rate, rad/s.
        omega: f64,
        /// Obliquity, rad.
        obliquity: f64,
        /// `T_omega`, N m.
        spin_torque: f64,
        /// `T_epsilon`, N m.
        obliquity_torque: f64,
    },
}

/// Largest torques over all obliquities at one spin rate: the scale against which a torque counts as nothing.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TorqueScale {
    /// Largest `|T_omega|`, N m.
    pub spin: f64,
    /// Largest `|T_epsilon|`, N m.
    pub obliquity: f64,
    /// Largest `|d T_epsilon / d epsilon|`, N m/rad.
    pub obliquity_slope: f64,
}

impl TorqueScale {
    /// Of samples one degree apart; curves are tabulated at 5 degrees, so nothing narrower is in them.
    pub(crate) fn of<T: TorqueFunction>(torque: &T, omega: f64) -> Self {
        let width = std::f64::consts::PI / 180.0;
        let mut scale = Self { spin: 0.0, obliquity: 0.0, obliquity_slope: 0.0 };
        let mut previous: Option<f64> = None;
        for degree in 0..=180 {
            let (spin, obliquity) = torque.at(f64::from(degree) * width, omega);
            scale.spin = scale.spin.max(spin.abs());
            scale.obliquity = scale.obliquity.max(obliquity.abs());
            if let Some(last) = previous {
                scale.obliquity_slope = scale.obliquity_slope.max((obliquity - last).abs() / width);
            }
            previous = Some(obliquity);
        }
        scale
    }
}
