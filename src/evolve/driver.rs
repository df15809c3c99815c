//! The hand-off loop: spin leg, dynamical check, movement, re-tiling, record, next (appendix of Cotto-Figueroa et al.
//! 2015).
//!
//! Each turn is a pure function of the stored state and ends in one transaction, so a killed run repeats at most the
//! turn it was in and arrives at the same bytes. Building and every block of settling are turns too.

use std::path::Path;

use pkd::hard_sphere::HardSphere;
use pkd::mass_properties;

use super::aggregate::aggregate;
use super::block::{Aggregate, Block, evolve_block};
use super::check::{Answer, Check, check_spin};
use super::configuration::{Shape, next_object, object_0, tiling_frame};
use super::observer::{Observer, Progress};
use super::rigid::rigid_reference;
use super::shedding::{Breakup, Departures};
use super::spin::{Leg, LegLimits, SpinState, StopReason, YEAR_S, integrate_leg};
use super::EvolveError;
use crate::scene::{Scene, SceneFile};
use crate::store::*;

/// Seconds in a million years of 365.25 days.
pub const MYR_S: f64 = 1e6 * YEAR_S;

/// How often the spin increment may be cut to a fifth before a movement of most spheres is accepted.
const MAX_REFINEMENT: u32 = 2;

/// A share of the angular momentum across the spin axis above which the user is told.
const NON_AXIAL_WARNING: f64 = 0.02;

/// Where a run stands when it returns.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Where and how it ended.
    pub ending: Ending,
    /// Legs done.
    pub legs: u32,
    /// Costs and errors over all sessions.
    pub totals: Totals,
}

/// Brings the run of `scene` in `directory` to `until_myr`, or to its end if that comes first.
///
/// # Errors
/// A wrong input, a directory that cannot be used, a numerical failure, a failed write, or [`EvolveError::Interrupted`];
/// whatever was committed before stays.
pub fn run(
    scene: &SceneFile,
    directory: &Path,
    resume: bool,
    until_myr: Option<f64>,
    observer: &mut dyn Observer,
) -> Result<Summary, EvolveError> {
    let end_s = until_myr.unwrap_or(f64::INFINITY).min(scene.scene.evolution.duration_myr) * MYR_S;
    // The body is made before the directory is touched, so that a wrong input leaves nothing behind.
    let mut ledger = Ledger::default();
    let fresh = if directory.join("run.sqlite").exists() {
        None
    } else {
        observer.progress(Progress::Building);
        Some(ledger.time(Part::Build, || aggregate(&scene.scene, scene.folder(), observer))?)
    };
    let (store, _) = RunStore::open(directory, &scene.scene, resume)?;
    let mut driver = Driver { scene: &scene.scene, store, ledger, engine: engine(&scene.scene), observer, end_s, movements: 0 };
    driver.run(scene, fresh)
}

/// The engine that the scene's contacts ask for.
pub fn engine(scene: &Scene) -> HardSphere {
    HardSphere::new(scene.contact.to_hard_sphere())
}

struct Driver<'a> {
    scene: &'a Scene,
    store: RunStore,
    ledger: Ledger,
    engine: HardSphere,
    observer: &'a mut dyn Observer,
    end_s: f64,
    movements: u32,
}

impl Driver<'_> {
    fn run(&mut self, file: &SceneFile, fresh: Option<pkd::Spheres>) -> Result<Summary, EvolveError> {
        let mut state = match self.store.state()? {
            Some(state) => state,
            None => {
                let spheres = match fresh {
                    Some(spheres) => spheres,
                    None => {
                        let observer = &mut *self.observer;
                        self.ledger.time(Part::Build, || aggregate(self.scene, file.folder(), observer))?
                    }
                };
                self.begin(spheres)?
            }
        };
        while state.stage == Stage::Built {
            state = self.settle(state)?;
        }
        if state.stage == Stage::Settled {
            state = self.found_object_0(state)?;
        }
        self.movements = self.store.totals()?.movements;
        let ending = self.evolve(state)?;
        if self.store.ending()? != Some(ending) {
            self.store.save_ending(&ending, &self.ledger)?;
        }
        let legs = self.store.state()?.map_or(0, |s| s.leg);
        Ok(Summary { ending, legs, totals: self.store.totals()? })
    }

    /// Stores the aggregate as constructed.
    fn begin(&mut self, spheres: pkd::Spheres) -> Result<State, EvolveError> {
        let state = State {
            stage: Stage::Built,
            outcome: None,
            blocks: 0,
            leg: 0,
            configuration: None,
            refinement: 0,
            t_s: 0.0,
            omega: mass_properties(&spheres)?.spin_rate(),
            obliquity: self.scene.spin.obliquity_rad(),
            sphere_ids: (0..spheres.len() as u32).collect(),
            spheres,
        };
        self.save(|store, ledger| store.save_built(&state, ledger))?;
        Ok(state)
    }

    /// One block of settling.
    fn settle(&mut self, mut state: State) -> Result<State, EvolveError> {
        let settling = &self.scene.settling;
        let done = state.blocks * settling.rotations;
        let watch = Stopwatch::start();
        let mut body = Aggregate { spheres: state.spheres, ids: state.sphere_ids };
        let block = evolve_block(
            &mut self.engine,
            &mut body,
            settling.rotations.min(settling.max_rotations - done),
            self.scene.evolution.movement_radius_fraction,
            self.observer,
            |rotation, observer| observer.progress(Progress::Settling { rotations: done + rotation }),
        )?;
        self.ledger.stop(Part::Settle, watch);
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
            shed: block.departures.spheres.len() as u32,
        };
        state.spheres = body.spheres;
        state.sphere_ids = body.ids;
        state.omega = properties.spin_rate();
        state.blocks += 1;
        let quiet = block.moved == 0 && block.departures.spheres.is_empty();
        if block.departures.breakup.is_some() {
            return Err(EvolveError::BrokeUpWhileSettling { rotations: done + block.dynamics.rotations });
        }
        let out_of_time = state.blocks * settling.rotations >= settling.max_rotations;
        if quiet || out_of_time {
            state.stage = Stage::Settled;
        }
        if out_of_time && !quiet {
            let rotations = settling.max_rotations;
            self.observer.warn(&format!(
                "the body still moves after {rotations} rotations (settling.max_rotations): {} spheres in the last block",
                block.moved
            ));
        }
        let losses = losses(&block.departures, 0.0, state.omega);
        self.save(|store, ledger| store.save_settling(&record, &losses, &state, ledger))?;
        Ok(state)
    }

    /// Tiles the settled body, computes its torques and the curve it would follow were it rigid.
    fn found_object_0(&mut self, mut state: State) -> Result<State, EvolveError> {
        let watch = Stopwatch::start();
        let (tiling, base) = tiling_frame(self.scene, &state.spheres)?;
        self.ledger.stop(Part::Tiling, watch);
        let shape = object_0(self.scene, &tiling, base, &state, &mut self.ledger)?;
        state.omega = shape.spin_rate;
        let watch = Stopwatch::start();
        let rigid = rigid_reference(&shape.torque, shape.inertia(), state.omega, state.obliquity, &self.scene.evolution)?;
        self.ledger.stop(Part::Spin, watch);
        state.stage = Stage::Evolving;
        state.configuration = Some(0);
        self.save(|store, ledger| store.save_object_0(&tiling, &shape.record, &rigid, &state, ledger))?;
        Ok(state)
    }

    /// Legs until the requested time or an end.
    fn evolve(&mut self, mut state: State) -> Result<Ending, EvolveError> {
        let damaged = || EvolveError::Store(self.store.damaged("it lacks the tiling or configuration of its state"));
        let tiling = self.store.tiling()?.ok_or_else(damaged)?;
        let record = self.store.latest_configuration()?.ok_or_else(damaged)?;
        let mut shape = Shape::from_record(self.scene, record);
        loop {
            self.report(&state);
            if let Some(outcome) = state.outcome {
                return Ok(Ending { t_s: state.t_s, omega: state.omega, obliquity: state.obliquity, outcome });
            }
            let leg = self.spin_leg(&state, &shape)?;
            if leg.reason == StopReason::EndTime {
                let outcome = if self.end_s < self.scene.evolution.duration_myr * MYR_S { Outcome::Until } else { Outcome::EndTime };
                return Ok(Ending { t_s: leg.end.t_s, omega: leg.end.omega, obliquity: leg.end.obliquity, outcome });
            }
            state = self.turn(state, &tiling, &mut shape, &leg)?;
        }
    }

    fn spin_leg(&mut self, state: &State, shape: &Shape) -> Result<Leg, EvolveError> {
        let evolution = &self.scene.evolution;
        let limits = LegLimits {
            end_s: self.end_s,
            spin_change: evolution.spin_change / 5_f64.powi(state.refinement as i32),
            stop_period_s: evolution.stop_period_h.map(|h| h * 3600.0),
            step_s: evolution.rk4_step_yr * YEAR_S,
        };
        let start = SpinState { t_s: state.t_s, omega: state.omega, obliquity: state.obliquity };
        let watch = Stopwatch::start();
        let leg = integrate_leg(&shape.torque, shape.inertia(), start, &limits)?;
        self.ledger.stop(Part::Spin, watch);
        Ok(leg)
    }

    /// Asks the aggregate whether it bears the spin at the end of `leg`, and records the answer.
    fn turn(&mut self, state: State, tiling: &TilingRecord, shape: &mut Shape, leg: &Leg) -> Result<State, EvolveError> {
        let mut next = state.clone();
        next.leg += 1;
        next.t_s = leg.end.t_s;
        next.omega = leg.end.omega;
        next.obliquity = leg.end.obliquity;
        let mut record = leg_record(&state, leg);
        if matches!(leg.reason, StopReason::StopPeriod | StopReason::CycleEnd) {
            next.stage = Stage::Finished;
            next.outcome = Some(Outcome::SpunDown);
            record.result = "stopped";
            return self.commit_leg(record, next, None, &[]);
        }
        let watch = Stopwatch::start();
        let progress = self.progress(&state);
        let Check { body, answer, dynamics, settled, departures } = check_spin(
            &mut self.engine,
            self.scene,
            &state,
            leg.end.omega,
            &shape.record,
            self.observer,
            progress,
        )?;
        record.dynamics = dynamics;
        record.settled = settled;
        record.shed = departures.iter().map(|d| d.spheres.len() as u32).sum();
        let properties = mass_properties(&body.spheres)?;
        record.non_axial = properties.non_axial_fraction();
        if record.non_axial > NON_AXIAL_WARNING {
            let percent = 100.0 * record.non_axial;
            self.observer.warn(&format!("leg {}: {percent:.1} % of the angular momentum is across the spin axis", state.leg));
        }
        let Answer::Moved(movements) = answer else {
            self.ledger.stop(Part::Check, watch);
            next.spheres = body.spheres;
            next.refinement = state.refinement;
            record.result = "quiet";
            return self.commit_leg(record, next, None, &[]);
        };
        self.ledger.stop(Part::Movement, watch);
        record.moved = movements.counts();
        let moved_fraction = f64::from(record.moved[0]) / state.spheres.len() as f64;
        if moved_fraction > self.scene.evolution.moved_fraction_limit && state.refinement < MAX_REFINEMENT {
            // Back to the start of the leg with a fifth of the increment.
            record.result = "backtracked";
            record.omega_after = state.omega;
            let next = State { leg: next.leg, refinement: state.refinement + 1, ..state };
            return self.commit_leg(record, next, None, &[]);
        }
        record.result = "movement";
        next.spheres = body.spheres;
        next.sphere_ids = body.ids;
        next.refinement = 0;
        next.configuration = Some(shape.record.configuration + 1);
        let (object, moved) = next_object(self.scene, tiling, shape, &state, &next, &movements, &mut self.ledger)?;
        *shape = object;
        next.omega = shape.spin_rate;
        record.omega_after = next.omega;
        let losses: Vec<_> = departures.iter().flat_map(|d| losses(d, next.t_s, leg.end.omega)).collect();
        next.outcome = departures.iter().find_map(|d| d.breakup).map(|b| match b {
            Breakup::Fission => Outcome::Fission,
            Breakup::Disrupted => Outcome::Disrupted,
        });
        if next.outcome.is_some() {
            next.stage = Stage::Finished;
        }
        self.movements += 1;
        self.commit_leg(record, next, Some((&shape.record, &moved)), &losses)
    }

    fn commit_leg(
        &mut self,
        mut leg: LegRecord,
        state: State,
        configuration: Option<(&ConfigurationRecord, &[MovementRecord])>,
        losses: &[LossRecord],
    ) -> Result<State, EvolveError> {
        if leg.result != "backtracked" {
            leg.omega_after = state.omega;
        }
        let commit = LegCommit { leg: &leg, state: &state, configuration, losses };
        self.save(|store, ledger| store.save_leg(&commit, ledger))?;
        Ok(state)
    }

    fn save(&mut self, write: impl FnOnce(&mut RunStore, &Ledger) -> Result<(), StoreError>) -> Result<(), EvolveError> {
        let watch = Stopwatch::start();
        write(&mut self.store, &self.ledger)?;
        self.ledger.stop(Part::Store, watch);
        Ok(())
    }

    fn progress(&self, state: &State) -> Progress {
        Progress::Evolving {
            t_s: state.t_s,
            end_s: self.end_s,
            omega: state.omega,
            obliquity: state.obliquity,
            legs: state.leg,
            movements: self.movements,
        }
    }

    fn report(&mut self, state: &State) {
        let progress = self.progress(state);
        self.observer.progress(progress);
    }
}

/// The leg's row before the aggregate has been asked.
fn leg_record(state: &State, leg: &Leg) -> LegRecord {
    LegRecord {
        leg: state.leg,
        configuration: state.configuration.unwrap_or_default(),
        t_s: [state.t_s, leg.end.t_s],
        omega: [state.omega, leg.end.omega],
        obliquity: [state.obliquity, leg.end.obliquity],
        reason: leg.reason.name(),
        refinement: state.refinement,
        rk4_steps: leg.steps,
        spin_error: leg.error.omega,
        obliquity_error: leg.error.obliquity,
        result: "",
        omega_after: leg.end.omega,
        dynamics: DynamicsRecord::default(),
        moved: [0; 3],
        settled: true,
        non_axial: 0.0,
        shed: 0,
    }
}

fn losses(departures: &Departures, t_s: f64, omega: f64) -> Vec<LossRecord> {
    let loss = |d: &super::shedding::Departure| LossRecord {
        sphere: d.sphere,
        t_s,
        omega,
        position: d.position,
        velocity: d.velocity,
        spin: d.spin,
        energy_j_kg: d.energy_j_kg,
    };
    departures.spheres.iter().map(loss).collect()
}

/// Adds the work of `block` to `total`; drifts and overlaps keep their largest value.
pub(super) fn add_dynamics(total: &mut DynamicsRecord, block: &Block) {
    let d = &block.dynamics;
    total.rotations += d.rotations;
    total.collisions += d.collisions;
    total.slide_rule += d.slide_rule;
    total.collapse_rule += d.collapse_rule;
    total.capped += d.capped;
    total.max_overlap_radii = total.max_overlap_radii.max(d.max_overlap_radii);
    total.momentum_drift = total.momentum_drift.max(d.momentum_drift);
    total.angular_momentum_drift = total.angular_momentum_drift.max(d.angular_momentum_drift);
}
