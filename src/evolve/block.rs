//! Dynamics at constant angular momentum: a stretch of time, and a block of rotations after which it is asked who moved
//! and who left.
//!
//! Settling of object 0, the check after a change of spin and `yorp relax` are all made of these.

use nalgebra::Vector3;
use pkd::Spheres;
use pkd::mass_properties::{MassProperties, mass_properties};
use pkd::soft_sphere::ContactHistory;

use super::engine::Engine;
use super::movement::{Coordinates, Movement, MovementRule, detect_movement};
use super::shedding::{Departures, Parting, departures};
use super::{EvolveError, Observer};
use crate::store::{DynamicsRecord, State};

/// An aggregate and the identity of its spheres through losses.
#[derive(Debug, Clone, PartialEq)]
pub struct Aggregate {
    /// The spheres, inertial frame.
    pub spheres: Spheres,
    /// Row of each sphere in the run's list of spheres, ascending.
    pub ids: Vec<u32>,
    /// What their contacts remember; nothing in runs of hard spheres.
    pub contacts: ContactHistory,
}

impl Aggregate {
    /// A copy of the aggregate of a stored state.
    pub fn of(state: &State) -> Self {
        let (spheres, ids) = (state.spheres.clone(), state.sphere_ids.clone());
        Self { spheres, ids, contacts: state.contacts.clone() }
    }
}

/// What one block did.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Rotation period at its start, s.
    pub period_s: f64,
    /// Spheres displaced beyond the limit within the block.
    pub moved: u32,
    /// Largest displacement within the block, radii.
    pub max_displacement_radii: f64,
    /// Work counters and conservation.
    pub dynamics: DynamicsRecord,
    /// Whether a heavy piece was seen off the body.
    pub parted: bool,
    /// Spheres that left, already removed from the aggregate.
    pub departures: Departures,
}

/// Evolves `aggregate` for `rotations` of its present period, at most one rotation at a time, and removes what left it.
///
/// A sphere counts as moved when it is displaced by more than `radius_fraction` of its radius.
/// `after_rotation` is called with the number of rotations done.
///
/// # Errors
/// The integration failed, or the observer asked to stop.
pub fn evolve_block(
    engine: &mut Engine,
    aggregate: &mut Aggregate,
    rotations: f64,
    radius_fraction: f64,
    observer: &mut dyn Observer,
    after_rotation: impl FnMut(f64, &mut dyn Observer),
) -> Result<Block, EvolveError> {
    let start = aggregate.spheres.clone();
    let Stretch { period_s, dynamics, parting } =
        evolve_stretch(engine, aggregate, rotations, observer, after_rotation)?;
    let departures = departures(&start, aggregate, &parting)?;
    let keep = departures.stays();
    let movement = movement_within(&start.filtered(keep), &aggregate.spheres.filtered(keep), radius_fraction);
    let radius = start.radius.iter().zip(keep).filter(|(_, k)| **k).map(|(r, _)| r);
    let max_displacement_radii = movement.residual_m.iter().zip(radius).fold(0.0_f64, |m, (d, r)| m.max(d / r));
    let moved = movement.count() as u32;
    departures.remove_from(aggregate)?;
    Ok(Block { period_s, moved, max_displacement_radii, dynamics, parted: parting.was_off(), departures })
}

/// What a stretch of dynamics did.
pub(super) struct Stretch {
    /// Rotation period at its start, s.
    pub period_s: f64,
    /// Work counters and conservation.
    pub dynamics: DynamicsRecord,
    /// Whether heavy pieces were off the body.
    pub parting: Parting,
}

/// Evolves `aggregate` for `rotations` of their present period, half a rotation at a time.
///
/// # Errors
/// The integration failed, or the observer asked to stop.
pub(super) fn evolve_stretch(
    engine: &mut Engine,
    aggregate: &mut Aggregate,
    rotations: f64,
    observer: &mut dyn Observer,
    mut after_rotation: impl FnMut(f64, &mut dyn Observer),
) -> Result<Stretch, EvolveError> {
    let before = mass_properties(&aggregate.spheres)?;
    let period_s = std::f64::consts::TAU / before.spin_rate();
    let mut dynamics = DynamicsRecord::default();
    let mut parting = Parting::default();
    while dynamics.rotations < rotations {
        let part = (rotations - dynamics.rotations).min(0.5);
        let Aggregate { spheres, contacts, .. } = &mut *aggregate;
        let work = engine.evolve(spheres, contacts, part * period_s, &mut || !observer.interrupted())?;
        let counts = work.collisions();
        dynamics.rotations += part;
        dynamics.collisions += counts.collisions;
        dynamics.slide_rule += counts.slide;
        dynamics.collapse_rule += counts.collapse;
        dynamics.capped += counts.capped;
        dynamics.max_overlap_radii = dynamics.max_overlap_radii.max(work.max_overlap_over_radius());
        if observer.interrupted() {
            return Err(EvolveError::Interrupted);
        }
        parting.sample(&aggregate.spheres);
        if dynamics.rotations.fract() == 0.0 || dynamics.rotations >= rotations {
            after_rotation(dynamics.rotations, observer);
        }
    }
    let after = mass_properties(&aggregate.spheres)?;
    dynamics.momentum_drift = momentum_drift(&aggregate.spheres, &before, &after);
    dynamics.angular_momentum_drift =
        (after.angular_momentum - before.angular_momentum).norm() / before.angular_momentum.norm();
    Ok(Stretch { period_s, dynamics, parting })
}

/// Movement among the same spheres between two moments, by the robust rule.
pub(super) fn movement_within(start: &Spheres, end: &Spheres, radius_fraction: f64) -> Movement {
    detect_movement(coordinates(start), coordinates(end), &start.radius, radius_fraction, MovementRule::Robust)
}

/// Centres as one slice per coordinate.
pub(super) fn coordinates(spheres: &Spheres) -> Coordinates<'_> {
    [&spheres.x, &spheres.y, &spheres.z]
}

/// Centres as points, m.
pub(super) fn positions(spheres: &Spheres) -> Vec<[f64; 3]> {
    (0..spheres.len()).map(|i| spheres.position(i)).collect()
}

/// Change of the total momentum over the sum of m|v| of the spheres.
pub(super) fn momentum_drift(spheres: &Spheres, before: &MassProperties, after: &MassProperties) -> f64 {
    let scale: f64 = (0..spheres.len()).map(|i| spheres.mass[i] * Vector3::from(spheres.velocity(i)).norm()).sum();
    if scale == 0.0 { 0.0 } else { before.mass * (after.velocity - before.velocity).norm() / scale }
}
