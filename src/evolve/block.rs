//! A block of dynamics at constant angular momentum: some rotations, then who moved and who left.
//!
//! Settling of object 0, the check after a change of spin and `yorp relax` are all made of such blocks.

use nalgebra::Vector3;
use pkd::hard_sphere::HardSphere;
use pkd::{MassProperties, Spheres, mass_properties};

use super::movement::{MovementRule, Movements, detect};
use super::shedding::{Departures, departures};
use super::{EvolveError, Observer};
use crate::store::DynamicsRecord;

/// An aggregate and the identity of its spheres through losses.
#[derive(Debug, Clone, PartialEq)]
pub struct Aggregate {
    /// The spheres, inertial frame.
    pub spheres: Spheres,
    /// Row of each sphere in the run's list of spheres, ascending.
    pub ids: Vec<u32>,
}

/// What one block did.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Rotation period at its start, s.
    pub period_s: f64,
    /// Spheres displaced beyond the movement limit within the block.
    pub moved: u32,
    /// Largest displacement within the block, radii.
    pub max_displacement_radii: f64,
    /// Work counters and conservation.
    pub dynamics: DynamicsRecord,
    /// Spheres that left, already removed from the aggregate.
    pub departures: Departures,
}

/// Evolves `aggregate` for `rotations` of its present period, one rotation at a time, and removes what left it.
///
/// A sphere counts as moved when it is displaced by more than `movement_radius_fraction` of its radius.
/// `after_rotation` is called with the number of rotations done.
///
/// # Errors
/// The integration failed, or the observer asked to stop.
pub fn evolve_block(
    engine: &mut HardSphere,
    aggregate: &mut Aggregate,
    rotations: u32,
    movement_radius_fraction: f64,
    observer: &mut dyn Observer,
    mut after_rotation: impl FnMut(u32, &mut dyn Observer),
) -> Result<Block, EvolveError> {
    let before = mass_properties(&aggregate.spheres)?;
    let start = aggregate.spheres.clone();
    let period_s = std::f64::consts::TAU / before.spin_rate();
    let mut dynamics = DynamicsRecord { rotations, ..DynamicsRecord::default() };
    for done in 1..=rotations {
        let report = engine.evolve(&mut aggregate.spheres, period_s)?;
        dynamics.collisions += report.counts.collisions;
        dynamics.slide_rule += report.counts.slide;
        dynamics.collapse_rule += report.counts.collapse;
        dynamics.capped += report.counts.capped;
        dynamics.max_overlap_radii = dynamics.max_overlap_radii.max(report.max_overlap_over_radius);
        if observer.interrupted() {
            return Err(EvolveError::Interrupted);
        }
        after_rotation(done, observer);
    }
    let after = mass_properties(&aggregate.spheres)?;
    dynamics.momentum_drift = momentum_drift(&aggregate.spheres, &before, &after);
    dynamics.angular_momentum_drift =
        (after.angular_momentum - before.angular_momentum).norm() / before.angular_momentum.norm();
    let departures = departures(&start, aggregate, &after)?;
    let keep = departures.stays();
    let movements = detect_block(&start, &aggregate.spheres, keep, movement_radius_fraction)?;
    let max_displacement_radii =
        movements.residuals.iter().zip(kept(&start.radius, keep)).fold(0.0_f64, |m, (d, r)| m.max(d / r));
    departures.remove_from(aggregate)?;
    Ok(Block { period_s, moved: movements.count(), max_displacement_radii, dynamics, departures })
}

/// Movement within the block among the spheres that stay.
fn detect_block(start: &Spheres, end: &Spheres, keep: &[bool], fraction: f64) -> Result<Movements, EvolveError> {
    let (start, end) = (start.filtered(keep), end.filtered(keep));
    Ok(detect(&positions(&start), &positions(&end), &start.radius, fraction, MovementRule::Robust)?)
}

/// Centres as points, m.
pub fn positions(spheres: &Spheres) -> Vec<[f64; 3]> {
    (0..spheres.len()).map(|i| spheres.position(i)).collect()
}

fn kept<'a>(values: &'a [f64], keep: &'a [bool]) -> impl Iterator<Item = f64> + 'a {
    values.iter().zip(keep).filter(|(_, k)| **k).map(|(v, _)| *v)
}

/// Change of the total momentum over the sum of m|v| of the spheres.
fn momentum_drift(spheres: &Spheres, before: &MassProperties, after: &MassProperties) -> f64 {
    let scale: f64 = (0..spheres.len()).map(|i| spheres.mass[i] * Vector3::from(spheres.velocity(i)).norm()).sum();
    if scale == 0.0 { 0.0 } else { before.mass * (after.velocity - before.velocity).norm() / scale }
}
