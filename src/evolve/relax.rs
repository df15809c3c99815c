//! An aggregate alone, at constant angular momentum: how it moves, and how well the integrator conserves what it should.

use cpu_time::ProcessTime;
use nalgebra::Vector3;
use pkd::Spheres;
use pkd::clusters::{CONTACT_GAP_OVER_RADIUS, contact_count};
use pkd::gravity::potential_energy;
use pkd::mass_properties::{MassProperties, mass_properties};
use pkd::soft_sphere::{ContactHistory, Stiffness};

use super::block::{momentum_drift, movement_within};
use super::engine::{ContactLaw, Engine, Work};
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
    pub work: Work,
    /// Stiffness of soft contacts and what asked for it.
    pub stiffness: Option<Stiffness>,
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
    /// Of hard spheres the change of the energy (motion, spin, gravity) over its initial size; collisions make it
    /// negative. Of soft spheres, which keep books of springs and heat as well, what the books are off by, over the
    /// largest energy in them.
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
    law: &ContactLaw,
    duration: Duration,
    movement_radius_fraction: f64,
    observer: &mut dyn Observer,
) -> Result<Relaxed, EvolveError> {
    let clock = (std::time::Instant::now(), ProcessTime::now());
    let start = spheres.clone();
    let before = mass_properties(spheres)?;
    let energy_before = total_energy(spheres, &before, law.has_gravity());
    let stiffness = law.stiffness(spheres).map_err(EvolveError::Contact)?;
    let engine = law.engine(stiffness.map(|s| s.normal_n_m));
    let mut run = Run { work: engine.no_work(), engine, contacts: ContactHistory::default() };
    let (mut rotations, mut settled) = (0.0, None);
    match duration {
        Duration::Seconds(seconds) => run.evolve(spheres, seconds, observer)?,
        Duration::Rotations(wanted) => {
            let period_s = period(&before)?;
            while rotations < wanted {
                let part = (wanted - rotations).min(1.0);
                run.evolve(spheres, part * period_s, observer)?;
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
                    run.evolve(spheres, period_s, observer)?;
                    rotations += 1.0;
                    one_rotation_done(observer, rotations)?;
                }
                settled = Some(movement_within(&block, spheres, movement_radius_fraction).count() == 0);
            }
        }
    }
    let after = mass_properties(spheres)?;
    let energy_after = total_energy(spheres, &after, law.has_gravity());
    let spin_scale = before.angular_momentum.norm();
    let (axes_before, axes_after) = (before.deeve_axes(), after.deeve_axes());
    Ok(Relaxed {
        stiffness,
        rotations,
        settled,
        seconds: clock.0.elapsed().as_secs_f64(),
        cpu_seconds: clock.1.elapsed().as_secs_f64(),
        contacts_per_sphere: 2.0 * contact_count(spheres, CONTACT_GAP_OVER_RADIUS) as f64 / spheres.len() as f64,
        energy_drift: match &run.work {
            Work::Soft(report) if report.ledger.is_some() => report.energy_drift().unwrap_or_default(),
            _ => (energy_after - energy_before) / energy_before.abs().max(f64::MIN_POSITIVE),
        },
        work: run.work,
        momentum_drift: momentum_drift(spheres, &before, &after),
        angular_momentum_drift: (spin_scale > 0.0)
            .then(|| (after.angular_momentum - before.angular_momentum).norm() / spin_scale),
        moved_spheres: movement_within(&start, spheres, movement_radius_fraction).count(),
        shape_change: (axes_after - axes_before).component_div(&axes_before).abs().max(),
    })
}

/// An engine at work, with what it has to remember.
struct Run {
    engine: Engine,
    contacts: ContactHistory,
    work: Work,
}

impl Run {
    fn evolve(&mut self, spheres: &mut Spheres, duration_s: f64, observer: &dyn Observer) -> Result<(), EvolveError> {
        let work = self.engine.evolve(spheres, &mut self.contacts, duration_s, &mut || !observer.interrupted())?;
        self.work.add(&work);
        Ok(())
    }
}

fn one_rotation_done(observer: &mut dyn Observer, rotations: f64) -> Result<(), EvolveError> {
    observer.progress(Progress::Settling { rotations });
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
