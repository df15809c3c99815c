//! Which spins the aggregate reaches, and which it would reach were it rigid.
//!
//! Source: Cotto-Figueroa et al. (2015), ApJ 803, 25, section 3.1 and Tables 2 and 3.

use super::series::{Quantity, Segment};
use crate::evolve::EvolveError;
use crate::evolve::configuration::Shape;
use crate::evolve::driver::{MYR_S, RIGID_LIMIT_MYR};
use crate::evolve::rigid::{REV_PER_DAY, RigidEnd, rigid_cycle};
use crate::evolve::spin::{Integrator, SpinState, YEAR_S};
use crate::report::RunData;

/// Spin and obliquity of the aggregate over the run.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct AggregateRange {
    /// At the start, revolutions a day.
    pub initial_spin_rev_day: f64,
    /// Largest.
    pub max_spin_rev_day: f64,
    /// Smallest.
    pub min_spin_rev_day: f64,
    /// At the end.
    pub end_spin_rev_day: f64,
    /// Obliquity at the start, deg.
    pub initial_obliquity_deg: f64,
    /// Obliquity at the end, deg.
    pub end_obliquity_deg: f64,
}

impl AggregateRange {
    /// Of a run's evolution; `None` before it has begun.
    pub fn of(segments: &[Segment]) -> Option<Self> {
        let (first, last) = (segments.first()?, segments.last()?);
        // A leg ends where the spin has an extremum, so that its ends are enough.
        let spins = || segments.iter().flat_map(|s| Quantity::Spin.of(s));
        Some(Self {
            initial_spin_rev_day: Quantity::Spin.of(first)[0],
            max_spin_rev_day: spins().fold(0.0, f64::max),
            min_spin_rev_day: spins().fold(f64::INFINITY, f64::min),
            end_spin_rev_day: Quantity::Spin.of(last)[1],
            initial_obliquity_deg: Quantity::Obliquity.of(first)[0],
            end_obliquity_deg: Quantity::Obliquity.of(last)[1],
        })
    }
}

/// The same of object 0, were it rigid, over the paper's 30 Myr or to its end.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct RigidRange {
    /// How it ends.
    pub end: RigidEnd,
    /// Largest spin, revolutions a day; `None` if it grows for ever.
    pub max_spin_rev_day: Option<f64>,
    /// Smallest.
    pub min_spin_rev_day: f64,
    /// In the end; `None` if it grows for ever.
    pub end_spin_rev_day: Option<f64>,
    /// Obliquity to which it tends, deg; that of the last state where the time ended first.
    pub end_obliquity_deg: f64,
    /// Time of the YORP cycle (t_YC), Myr; `None` if it does not end.
    pub cycle_time_myr: Option<f64>,
}

impl RigidRange {
    /// Follows object 0 of a run; `None` before it exists.
    ///
    /// # Errors
    /// A torque table that cannot be followed.
    pub fn of(run: &RunData) -> Result<Option<Self>, EvolveError> {
        let (Some(start), Some(record)) = (run.rigid.first(), run.configurations.first()) else { return Ok(None) };
        let shape = Shape::from_record(&run.scene, record.clone())?;
        let start = SpinState { t_s: start.t_s, omega: start.omega, obliquity: start.obliquity };
        let integrator = Integrator::Rk4 { step_s: run.scene.evolution.rk4_step_yr * YEAR_S };
        let (errors, duration_s) = (shape.torque_errors(), RIGID_LIMIT_MYR * MYR_S);
        let cycle = rigid_cycle(&shape.torque, errors, shape.inertia(), start, duration_s, integrator)?;
        let finite = |omega: f64| omega.is_finite().then(|| omega / REV_PER_DAY);
        Ok(Some(Self {
            end: cycle.end,
            max_spin_rev_day: finite(cycle.max_omega),
            min_spin_rev_day: cycle.min_omega / REV_PER_DAY,
            end_spin_rev_day: finite(cycle.end_omega),
            end_obliquity_deg: cycle.final_obliquity().to_degrees(),
            cycle_time_myr: cycle.cycle_time_s.map(|t| t / MYR_S),
        }))
    }
}
