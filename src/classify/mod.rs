//! What kind of evolution a run shows, and its statistics.
//!
//! Source: Cotto-Figueroa et al. (2015), ApJ 803, 25, sections 3.1 to 3.5: types of spin and obliquity evolution
//! ([`kinds`]), the random walk of Figure 17 ([`Walk`]), movements against depth ([`Movements`]), mass loss ([`Losses`]),
//! proportions ([`ShapeHistory`]), the aggregate against the rigid body ([`AggregateRange`], [`RigidRange`]).
//! Everything is worked out from what the run has recorded so far, so a run that goes on can be asked at any time.
//! Unlike elsewhere the results are in the units of the paper, because they are made to be read: revolutions a day, degrees, Myr.

mod criteria;
mod distribution;
pub mod kinds;
mod likeness;
mod losses;
mod movements;
mod range;
mod sequences;
mod series;
mod shape;
#[cfg(test)]
mod tests;
mod walk;

use std::path::Path;

pub use criteria::Criteria;
pub use distribution::Distribution;
pub use kinds::{Course, Kind, Stretch, Trend, Verdict, classify_quantity};
pub use likeness::Likeness;
pub use losses::{Fates, LossEvent, Losses, prolate_limit};
pub use movements::Movements;
pub use range::{AggregateRange, RigidRange};
pub use sequences::{Figure, JacobiSequence, triaxiality};
pub use series::{Quantity, Segment, intervals};
pub use shape::{Proportions, ShapeHistory, ShapeState};
pub use walk::{Interval, Walk, persistence, signed_rates};

use crate::evolve::EvolveError;
use crate::evolve::driver::MYR_S;
use crate::report::RunData;
use crate::store::{Outcome, Part, PartTotal};

/// What a run shows so far.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct RunClassification {
    /// Name of the scene.
    pub name: String,
    /// How far the run has come: built, settled, evolving, finished; `None` before the body is built.
    pub stage: Option<&'static str>,
    /// How it ended, or why it paused: end_time, until, spun_down, fission, disrupted; `None` while it goes on or after a
    /// kill.
    pub outcome: Option<&'static str>,
    /// Time evolved, Myr.
    pub t_myr: f64,
    /// Spheres of the body as constructed.
    pub spheres: usize,
    /// Type of the spin evolution.
    pub spin: Verdict,
    /// Type of the obliquity evolution.
    pub obliquity: Verdict,
    /// Whether the spin is something else than a modified YORP cycle: what the paper counts as two thirds of its bodies.
    /// `None` before anything has evolved, and where it is too short to say.
    pub self_limited: Option<bool>,
    /// Spin and obliquity over the run; `None` before it has evolved.
    pub aggregate: Option<AggregateRange>,
    /// The same were the body rigid; `None` before object 0.
    pub rigid: Option<RigidRange>,
    /// Axis ratios.
    pub shape: ShapeHistory,
    /// Movements against depth.
    pub movements: Movements,
    /// Mass loss.
    pub losses: Losses,
    /// Intervals, alpha_s and zeta_s.
    pub walk: Walk,
    /// What the run has cost.
    pub cost: Cost,
    /// The thresholds used.
    pub criteria: Criteria,
}

/// CPU time of a run and of its hand-offs.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Cost {
    /// All sessions, s.
    pub cpu_seconds: f64,
    /// Wall time of all sessions, s.
    pub seconds: f64,
    /// Hand-offs in which nothing moved.
    pub checks: u64,
    /// CPU time of one of them, s; `None` without any.
    pub cpu_seconds_per_check: Option<f64>,
    /// Hand-offs in which spheres moved, those taken back included.
    pub movements: u64,
    /// CPU time of one of them, s; `None` without any.
    pub cpu_seconds_per_movement: Option<f64>,
}

impl Cost {
    /// Of a run so far.
    pub fn of(run: &RunData) -> Self {
        let part = |wanted: Part| {
            let found = run.totals.parts.iter().find(|(part, _)| *part == wanted);
            found.map_or(PartTotal::default(), |(_, total)| *total)
        };
        let each = |total: PartTotal| (total.count > 0).then(|| total.cpu_seconds / total.count as f64);
        let (check, movement) = (part(Part::Check), part(Part::Movement));
        Self {
            cpu_seconds: run.totals.cpu_seconds,
            seconds: run.totals.seconds,
            checks: check.count,
            cpu_seconds_per_check: each(check),
            movements: movement.count,
            cpu_seconds_per_movement: each(movement),
        }
    }
}

/// Classifies the run in a directory by the default criteria; safe while the run goes on.
///
/// # Errors
/// The directory holds no run that this build can read, or one with torques that cannot be followed.
pub fn classify_run(directory: &Path) -> Result<RunClassification, EvolveError> {
    classify(&RunData::read(directory)?, &Criteria::default())
}

/// Classifies a run that has been read.
///
/// # Errors
/// Torques of object 0 that cannot be followed.
pub fn classify(run: &RunData, criteria: &Criteria) -> Result<RunClassification, EvolveError> {
    let segments = segments(run);
    let rigid = RigidRange::of(run)?;
    let course = Course {
        segments: &segments,
        rigid_end_obliquity_deg: rigid.map(|r| r.end_obliquity_deg),
        broke_up: broke_up(run),
    };
    let fraction = run.scene.evolution.movement_radius_fraction;
    let mut likeness = Likeness::new(&run.configurations, &run.sphere_radius_m, fraction);
    let mut verdict = |quantity| classify_quantity(quantity, &course, |a, b| likeness.of(a, b), criteria);
    let (spin, obliquity) = (verdict(Quantity::Spin), verdict(Quantity::Obliquity));
    let jacobi = JacobiSequence::new();
    let state = run.state.as_ref();
    Ok(RunClassification {
        name: run.scene.name.clone(),
        stage: state.map(|s| s.stage.name()),
        outcome: run.ending.map(|ending| ending.outcome.name()),
        t_myr: segments.last().map_or(0.0, |s| s.t_s[1] / MYR_S),
        spheres: run.sphere_mass_kg.len(),
        self_limited: (!spin.label.is_empty() && !spin.has(Kind::TooShort)).then(|| !spin.has(Kind::ModifiedCycle)),
        spin,
        obliquity,
        aggregate: AggregateRange::of(&segments),
        rigid,
        shape: ShapeHistory::of(&run.configurations, &jacobi),
        movements: Movements::of(run.movements.get(1..).unwrap_or_default(), &run.sphere_radius_m, &run.legs),
        losses: Losses::of(run, &jacobi),
        walk: Walk::of(&closed_intervals(run, &segments)),
        cost: Cost::of(run),
        criteria: *criteria,
    })
}

/// The evolution that counts: all legs that were not taken back, and what follows the last one up to where the run was
/// asked to stop.
pub fn segments(run: &RunData) -> Vec<Segment> {
    let leg = |leg: &crate::store::LegRecord| Segment {
        t_s: leg.t_s,
        omega: leg.omega,
        obliquity: leg.obliquity,
        configuration: leg.configuration,
    };
    let mut segments: Vec<Segment> = run.accepted_legs().map(leg).collect();
    if let (Some(ending), Some(state)) = (run.ending, &run.state)
        && let Some(configuration) = state.configuration
        && ending.t_s > state.t_s
    {
        segments.push(Segment {
            t_s: [state.t_s, ending.t_s],
            omega: [state.omega, ending.omega],
            obliquity: [state.obliquity, ending.obliquity],
            configuration,
        });
    }
    segments
}

/// The intervals of those segments that a movement has closed: not the one of the present shape.
pub fn closed_intervals(run: &RunData, segments: &[Segment]) -> Vec<Segment> {
    let mut closed = intervals(segments);
    if closed.last().map(|i| i.configuration) == run.configurations.last().map(|c| c.configuration) {
        closed.pop();
    }
    closed
}

/// Whether the run ended because the body came apart.
fn broke_up(run: &RunData) -> bool {
    let outcome = run.state.as_ref().and_then(|state| state.outcome);
    matches!(outcome, Some(Outcome::Fission | Outcome::Disrupted))
}
