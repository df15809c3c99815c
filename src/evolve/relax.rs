//! An aggregate alone, at constant angular momentum: how it moves, and how well the integrator conserves what it should.

use cpu_time::ProcessTime;
use nalgebra::Vector3;
use pkd::Spheres;
use pkd::clusters::{CONTACT_GAP_OVER_RADIUS, contact_count};
use pkd::gravity::potential_energy;
use pkd::hard_sphere::{HardSphere, HardSphereParameters, Report};
use pkd::mass_properties::{MassProperties, mass_properties};

use super::block::{momentum_drift, movement_within};
use super::{EvolveError, Observer, Progress};
use crate::scene::Settling;

/// How long to evolve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Duration {
    /// Seconds.
    Seconds(f64),
    /// Rotations of the initial period.
    Rotations(f64),
    /// Blocks of rotations until one shows no movement, see [`Settling`].
    UntilSettled,
}

/// What became of the aggregate.
#[derive(Debug, Clone, PartialEq)]
pub struct Relaxed {
    /// Work of the engine.
    pub report: Report,
    /// Rotations done, of the period at the start of each block.
    pub rotations: f64,
    /// For [`Duration::UntilSettled`] whether the last block was without movement.
    pub settled: Option<bool>,
    /// Wall time, s.
    pub seconds: f64,
    /// CPU time, s.
    pub cpu_seconds: f64,
    /// Touching neighbours of a sphere, on average.
    pub contacts_per_sphere: f64,
    /// Change of the energy (motion, spin, gravity) over its initial size; collisions make it negative.
    pub energy_drift: f64,
    /// Change of the momentum over the sum of m|v|.
    pub momentum_drift: f64,
    /// Relative change of the angular momentum; not determined for a body without any.
    pub angular_momentum_drift: Option<f64>,
    /// Spheres displaced by more than the movement limit between start and end.
    pub moved_spheres: usize,
    /// Largest relative change of the B1 axes.
    pub shape_change: f64,
}

/// Evolves `spheres` in place.
///
/// # Errors
/// The engine failed, the body does not rotate although rotations are asked for, or the observer asked to stop.
pub fn relax(
    spheres: &mut Spheres,
    parameters: &HardSphereParameters,
    duration: Duration,
    movement_radius_fraction: f64,
    observer: &mut dyn Observer,
) -> Result<Relaxed, EvolveError> {
    let clock = (std::time::Instant::now(), ProcessTime::now());
    let start = spheres.clone();
    let before = mass_properties(spheres)?;
    let energy_before = total_energy(spheres, &before, parameters.gravity.is_some());
    let mut engine = HardSphere::new(parameters.clone());
    let mut report = Report::default();
    let (mut rotations, mut settled) = (0.0, None);
    match duration {
        Duration::Seconds(seconds) => report = engine.evolve(spheres, seconds)?,
        Duration::Rotations(wanted) => {
            let period_s = period(&before)?;
            while rotations < wanted {
                let part = (wanted - rotations).min(1.0);
                report.add(&engine.evolve(spheres, part * period_s)?);
                rotations += part;
                one_rotation_done(observer, rotations)?;
            }
        }
        Duration::UntilSettled => {
            let settling = Settling::default();
            while settled != Some(true) && rotations < f64::from(settling.max_rotations) {
                let block = spheres.clone();
                let period_s = period(&mass_properties(spheres)?)?;
                for _ in 0..settling.rotations {
                    report.add(&engine.evolve(spheres, period_s)?);
                    rotations += 1.0;
                    one_rotation_done(observer, rotations)?;
                }
                settled = Some(movement_within(&block, spheres, movement_radius_fraction).count() == 0);
            }
        }
    }
    let after = mass_properties(spheres)?;
    let energy_after = total_energy(spheres, &after, parameters.gravity.is_some());
    let spin_scale = before.angular_momentum.norm();
    let (axes_before, axes_after) = (before.deeve_axes(), after.deeve_axes());
    Ok(Relaxed {
        report,
        rotations,
        settled,
        seconds: clock.0.elapsed().as_secs_f64(),
        cpu_seconds: clock.1.elapsed().as_secs_f64(),
        contacts_per_sphere: 2.0 * contact_count(spheres, CONTACT_GAP_OVER_RADIUS) as f64 / spheres.len() as f64,
        energy_drift: (energy_after - energy_before) / energy_before.abs().max(f64::MIN_POSITIVE),
        momentum_drift: momentum_drift(spheres, &before, &after),
        angular_momentum_drift: (spin_scale > 0.0)
            .then(|| (after.angular_momentum - before.angular_momentum).norm() / spin_scale),
        moved_spheres: movement_within(&start, spheres, movement_radius_fraction).count(),
        shape_change: (axes_after - axes_before).component_div(&axes_before).abs().max(),
    })
}

fn one_rotation_done(observer: &mut dyn Observer, rotations: f64) -> Result<(), EvolveError> {
    observer.progress(Progress::Settling { rotations: rotations as u32 });
    if observer.interrupted() { Err(EvolveError::Interrupted) } else { Ok(()) }
}

fn period(properties: &MassProperties) -> Result<f64, EvolveError> {
    let omega = properties.spin_rate();
    if omega > 0.0 { Ok(std::f64::consts::TAU / omega) } else { Err(EvolveError::NoRotation) }
}

/// Energy of motion about the centre of mass, of spin and of gravity, J.
fn total_energy(spheres: &Spheres, properties: &MassProperties, gravity: bool) -> f64 {
    let potential = if gravity { potential_energy(spheres) } else { 0.0 };
    let drift = 0.5 * properties.mass * Vector3::from(properties.velocity).norm_squared();
    properties.kinetic_energy - drift + potential
}
