//! Settling of a freshly made aggregate, block by block, until a block of rotations shows no movement.

use pkd::Spheres;
use pkd::mass_properties::mass_properties;
use pkd::soft_sphere::ContactHistory;

use super::alignment::{TILT_LIMIT, align};
use super::blame::likely_causes;
use super::block::{Aggregate, evolve_block};
use super::engine::{ContactLaw, Engine};
use super::fate::shed;
use super::shedding::on_one_body;
use super::{EvolveError, Observer, Progress};
use crate::scene::Scene;
use crate::store::{SettlingRecord, Shedding, Stage, State};

/// The state of a run whose aggregate has just been made.
///
/// Its stiffness, if the contacts are soft, is found here, once for the whole run.
///
/// # Errors
/// A sphere that is not finite, or contacts that cannot be resolved.
pub fn begin(scene: &Scene, spheres: Spheres) -> Result<State, EvolveError> {
    let stiffness = ContactLaw::of(scene).stiffness(&spheres).map_err(EvolveError::Contact)?;
    Ok(State {
        stage: Stage::Built,
        outcome: None,
        blocks: 0,
        leg: 0,
        configuration: None,
        refinement: 0,
        t_s: 0.0,
        omega: mass_properties(&spheres)?.spin_rate(),
        rest: None,
        obliquity: scene.spin.obliquity_rad(),
        sphere_ids: (0..spheres.len() as u32).collect(),
        spheres,
        normal_stiffness_n_m: stiffness.map(|s| s.normal_n_m),
        contacts: ContactHistory::default(),
    })
}

/// One block of settling: the state after it, its record, and what left the body.
///
/// The stage becomes [`Stage::Settled`] when nothing moved or the scene's rotations are used up.
///
/// # Errors
/// The integration failed, the body fell apart, or the observer asked to stop.
pub fn settle_block(
    scene: &Scene,
    engine: &mut Engine,
    mut state: State,
    observer: &mut dyn Observer,
) -> Result<(State, SettlingRecord, Shedding), EvolveError> {
    let settling = &scene.settling;
    let done = f64::from(state.blocks * settling.rotations);
    let period_s = std::f64::consts::TAU / state.omega;
    let (spheres, ids, contacts) = (state.spheres, state.sphere_ids, state.contacts);
    let mut body = Aggregate { spheres, ids, contacts };
    let block = evolve_block(
        engine,
        &mut body,
        f64::from(settling.rotations).min(f64::from(settling.max_rotations) - done),
        scene.evolution.movement_radius_fraction,
        observer,
        |rotation, observer| observer.progress(Progress::Settling { rotations: done + rotation }),
    )?;
    let rotations = done + block.dynamics.rotations;
    if block.departures.breakup.is_some() {
        let likely = likely_causes(scene, &body.spheres, period_s);
        return Err(EvolveError::BrokeUpWhileSettling { rotations, likely });
    }
    let omega = mass_properties(&body.spheres)?.spin_rate();
    let shedding = shed(scene, &mut body, &block.departures, [0.0, omega, state.obliquity])?;
    let quiet = block.moved == 0 && block.departures.spheres.is_empty();
    let last = rotations >= f64::from(settling.max_rotations);
    let tilt = mass_properties(&body.spheres)?.across_axis();
    // A body that was turned much has another block about its new axis before it counts as settled.
    let turned = (quiet || last) && on_one_body(&body.spheres) && align(scene, &mut body)? && tilt > TILT_LIMIT;
    let properties = mass_properties(&body.spheres)?;
    let axes = properties.deeve_axes();
    let record = SettlingRecord {
        block: state.blocks,
        period_s: block.period_s,
        moved: block.moved,
        max_displacement_radii: block.max_displacement_radii,
        b_over_a: axes.y / axes.x,
        c_over_a: axes.z / axes.x,
        dynamics: block.dynamics,
        angular_momentum: properties.angular_momentum.norm(),
        non_axial: tilt,
        shed: shedding.losses.len() as u32,
    };
    state.spheres = body.spheres;
    state.sphere_ids = body.ids;
    state.contacts = body.contacts;
    state.omega = properties.spin_rate();
    state.blocks += 1;
    if (quiet && !turned) || last {
        state.stage = Stage::Settled;
    }
    if turned {
        let angle = tilt.min(1.0).asin().to_degrees();
        observer.warn(&format!(
            "after {rotations} rotations of settling the body was turned by {angle:.1} deg, so that its axis of largest moment lies \
             along its angular momentum (settling.residual_rotation)"
        ));
    }
    if !quiet && state.stage == Stage::Settled {
        let moved = block.moved;
        observer.warn(&format!(
            "the body still moves after {rotations} rotations (settling.max_rotations): {moved} spheres in the last block"
        ));
    }
    Ok((state, record, shedding))
}
