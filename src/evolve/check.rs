//! Whether an aggregate bears a new spin rate: it is given the spin, evolves at constant angular momentum, and is
//! compared with its present configuration.

use nalgebra::Vector3;
use pkd::frame::add_spin;
use pkd::mass_properties::mass_properties;

use super::EvolveError;
use super::block::{Aggregate, coordinates, evolve_block};
use super::engine::Engine;
use super::fate::shed;
use super::movement::{Movement, detect_movement};
use super::observer::{Observer, Progress};
use super::shedding::Breakup;
use crate::scene::Scene;
use crate::store::{ConfigurationRecord, DynamicsRecord, Shedding, State};

/// How the aggregate answered.
#[derive(Debug, Clone, PartialEq)]
pub struct Check {
    /// The aggregate afterwards, without what left it.
    pub body: Aggregate,
    /// The rigid motion from the configuration to the aggregate and who departed from it; `None` if nothing moved.
    pub movement: Option<Movement>,
    /// Work and conservation.
    pub dynamics: DynamicsRecord,
    /// Whether the last block was without movement.
    pub settled: bool,
    /// What left.
    pub shedding: Shedding,
    /// Set if what left is so heavy that the run ends.
    pub breakup: Option<Breakup>,
}

/// Gives the aggregate of `state`, at evolution time `t_s`, the spin rate `omega` (rad/s, about its axis of largest moment) and evolves it until
/// nothing differs from `configuration` or, if something does, until a block of rotations shows no further movement.
///
/// # Errors
/// The integration failed, or the observer asked to stop.
pub fn check_spin(
    engine: &mut Engine,
    scene: &Scene,
    state: &State,
    [t_s, omega]: [f64; 2],
    configuration: &ConfigurationRecord,
    observer: &mut dyn Observer,
    progress: Progress,
) -> Result<Check, EvolveError> {
    let mut body = Aggregate::of(state);
    let properties = mass_properties(&body.spheres)?;
    let axis = Vector3::from(properties.axes.column(2));
    let present = properties.angular_momentum.dot(&axis) / properties.moments.z;
    add_spin(&mut body.spheres, axis * (omega - present))?;

    let settling = &scene.settling;
    let fraction = scene.evolution.movement_radius_fraction;
    let mut dynamics = DynamicsRecord::default();
    let mut shedding = Shedding::default();
    let mut left = false;
    loop {
        let rotations = settling.rotations.min(settling.max_rotations - dynamics.rotations);
        let mut after_rotation = |_, observer: &mut dyn Observer| observer.progress(progress);
        let block = evolve_block(engine, &mut body, rotations, fraction, observer, &mut after_rotation)?;
        dynamics.add(&block.dynamics);
        let leaves = !block.departures.spheres.is_empty();
        let quiet = block.moved == 0 && !leaves;
        let breakup = block.departures.breakup;
        let over = breakup.is_some() || dynamics.rotations >= settling.max_rotations;
        if leaves {
            left = true;
            let more = shed(scene, &mut body, &block.departures, [t_s, omega, state.obliquity])?;
            shedding.losses.extend(more.losses);
            shedding.fates.extend(more.fates);
            shedding.fission = more.fission;
        }
        let movement = compare(scene, configuration, &body);
        let moved = movement.count() > 0 || left;
        if !moved || quiet || over {
            let movement = moved.then_some(movement);
            return Ok(Check { body, movement, dynamics, settled: quiet || !moved, shedding, breakup });
        }
    }
}

/// Compares `body` with the present configuration, sphere by sphere among those that are in both.
pub fn compare(scene: &Scene, configuration: &ConfigurationRecord, body: &Aggregate) -> Movement {
    let mut ids = body.ids.iter().peekable();
    let mut recorded: [Vec<f64>; 3] = Default::default();
    for (id, position) in configuration.sphere_ids.iter().zip(&configuration.positions) {
        if ids.next_if_eq(&id).is_some() {
            for (column, value) in recorded.iter_mut().zip(position) {
                column.push(*value);
            }
        }
    }
    let [x, y, z] = &recorded;
    let evolution = &scene.evolution;
    detect_movement(
        [x, y, z],
        coordinates(&body.spheres),
        &body.spheres.radius,
        evolution.movement_radius_fraction,
        evolution.movement_rule,
    )
}
