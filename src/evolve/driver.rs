//! The hand-off loop: spin leg, dynamical check, movement, re-tiling, record, next (appendix of Cotto-Figueroa et al.
//! 2015).
//!
//! Each turn is a pure function of the stored state and ends in one transaction, so a killed run repeats at most the
//! turn it was in and arrives at the same bytes. Building and every block of settling are turns too.

use std::path::Path;

use pkd::mass_properties::mass_properties;

use super::EvolveError;
use super::aggregate::{aggregate, refuse_early};
use super::alignment::{TILT_LIMIT, close_books, give_along_spin};
use super::check::{Check, check_spin, rest_of};
use super::configuration::{Original, Shape, next_object, object_0};
use super::engine::{ContactLaw, Engine};
use super::observer::{Observer, Progress};
use super::reshaping::{compare_with_asked, measure};
use super::rigid::rigid_cycle;
use super::settling::{begin, settle_block};
use super::shedding::Breakup;
use super::spin::{Integrator, Leg, LegLimits, SpinState, StopReason, YEAR_S, integrate_leg};
use crate::scene::{Body, ResidualRotation, Scene, SceneFile};
use crate::store::*;

/// Seconds in a million years of 365.25 days.
pub const MYR_S: f64 = 1e6 * YEAR_S;

/// How far the rigid reference curve is followed, Myr: twice the 15 Myr of most runs (Table 2: bodies that would spin up
/// for ever were followed for 30 Myr). It does not depend on the scene's duration, which may grow when a run resumes.
pub const RIGID_LIMIT_MYR: f64 = 30.0;

/// Where a run stands when it returns.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Where and how it ended.
    pub ending: Ending,
    /// Legs done.
    pub legs: u32,
    /// Normal stiffness of soft contacts, N/m; `None` for hard spheres.
    pub normal_stiffness_n_m: Option<f64>,
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
    // A body from a file is read before the directory is touched, so that a wrong input leaves nothing behind. Packing
    // has no input that can be wrong and takes long, so it waits until the directory is ours.
    let mut ledger = Ledger::default();
    let packed = matches!(scene.scene.body, Body::PackedEllipsoid(_));
    let fresh = if packed || directory.join("run.sqlite").exists() {
        None
    } else {
        Some(ledger.time(Part::Build, || aggregate(scene, observer))?)
    };
    refuse_early(&scene.scene)?;
    let (store, _) = RunStore::open(directory, &scene.scene, resume)?;
    let mut driver = Driver {
        scene: &scene.scene,
        store,
        ledger,
        engine: ContactLaw::of(&scene.scene).engine(None),
        observer,
        end_s,
        movements: 0,
        told_tilt: TILT_LIMIT,
    };
    driver.run(scene, fresh)
}

struct Driver<'a> {
    scene: &'a Scene,
    store: RunStore,
    ledger: Ledger,
    engine: Engine,
    observer: &'a mut dyn Observer,
    end_s: f64,
    movements: u32,
    /// The user is told of a larger tilt than this.
    told_tilt: f64,
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
                        self.ledger.time(Part::Build, || aggregate(file, observer))?
                    }
                };
                let state = begin(self.scene, spheres)?;
                let built = measure(&state.spheres)?;
                self.save(|store, ledger| store.save_built(&built, &state, ledger))?;
                state
            }
        };
        self.engine = ContactLaw::of(self.scene).engine(state.normal_stiffness_n_m);
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
        let (legs, normal_stiffness_n_m) =
            self.store.state()?.map_or((0, None), |state| (state.leg, state.normal_stiffness_n_m));
        Ok(Summary { ending, legs, normal_stiffness_n_m, totals: self.store.totals()? })
    }

    /// One block of settling.
    fn settle(&mut self, state: State) -> Result<State, EvolveError> {
        let watch = Stopwatch::start();
        let (state, block, shedding) = settle_block(self.scene, &mut self.engine, state, self.observer)?;
        self.ledger.stop(Part::Settle, watch);
        self.save(|store, ledger| store.save_settling(&block, &shedding, &state, ledger))?;
        Ok(state)
    }

    /// Tiles the settled body, computes its torques and the curve it would follow were it rigid.
    fn found_object_0(&mut self, mut state: State) -> Result<State, EvolveError> {
        let built = self.store.built()?.ok_or_else(|| self.store.damaged("it lacks the body as made"))?;
        compare_with_asked(self.scene, &built, &state.spheres, self.observer)?;
        if let Some(warning) = taco::seasonal_heat(&self.scene.surface.to_taco(), &self.scene.orbit.to_taco()) {
            self.observer.warn(&warning.to_string());
        }
        let original = self.ledger.time(Part::Tiling, || Original::new(self.scene, &state.spheres))?;
        let shape = object_0(self.scene, &original, &state, &mut self.ledger)?;
        let start = SpinState { t_s: 0.0, omega: state.omega, obliquity: state.obliquity };
        let integrator = Integrator::Rk4 { step_s: self.scene.evolution.rk4_step_yr * YEAR_S };
        let duration_s = RIGID_LIMIT_MYR * MYR_S;
        let cycle = self.ledger.time(Part::Spin, || {
            rigid_cycle(&shape.torque, shape.torque_errors(), shape.inertia(), start, duration_s, integrator)
        })?;
        let sample = |s: &SpinState| RigidRecord { t_s: s.t_s, omega: s.omega, obliquity: s.obliquity };
        let rigid: Vec<_> = cycle.states.iter().map(sample).collect();
        state.stage = Stage::Evolving;
        state.configuration = Some(0);
        state.rest = rest_of(self.scene, &state.spheres);
        self.save(|store, ledger| store.save_object_0(&original.record(), &shape.record, &rigid, &state, ledger))?;
        Ok(state)
    }

    /// Legs until the requested time or an end.
    fn evolve(&mut self, mut state: State) -> Result<Ending, EvolveError> {
        if let Some(ending) = self.store.ending()?.filter(|ending| ending.t_s >= self.end_s) {
            return Ok(ending);
        }
        let missing = |what| EvolveError::Store(self.store.damaged(what));
        let tiling = self.store.tiling()?.ok_or_else(|| missing("it lacks the tiling of its state"))?;
        let record = self.store.latest_configuration()?.ok_or_else(|| missing("it lacks a configuration"))?;
        let original = Original::from_record(self.scene, &tiling)?;
        let mut shape = Shape::from_record(self.scene, record)?;
        loop {
            self.report(&state);
            if let Some(outcome) = state.outcome {
                let omega = match outcome {
                    // Of interest is the spin that broke the body, not that of what is left of it.
                    Outcome::Fission | Outcome::Disrupted => {
                        self.store.last_leg()?.map_or(state.omega, |leg| leg.omega[1])
                    }
                    _ => state.omega,
                };
                return Ok(Ending { t_s: state.t_s, omega, obliquity: state.obliquity, outcome });
            }
            let leg = self.spin_leg(&state, &shape)?;
            if leg.reason == StopReason::EndTime {
                let until = self.end_s < self.scene.evolution.duration_myr * MYR_S;
                let outcome = if until { Outcome::Until } else { Outcome::EndTime };
                return Ok(Ending { t_s: leg.end.t_s, omega: leg.end.omega, obliquity: leg.end.obliquity, outcome });
            }
            state = self.turn(state, &original, &mut shape, &leg)?;
        }
    }

    fn spin_leg(&mut self, state: &State, shape: &Shape) -> Result<Leg, EvolveError> {
        let evolution = &self.scene.evolution;
        let limits = LegLimits {
            end_time_s: self.end_s,
            spin_change: evolution.spin_change / 5_f64.powi(state.refinement as i32),
            stop_period_s: evolution.stop_period_h.map(|h| h * 3600.0),
            integrator: Integrator::Rk4 { step_s: evolution.rk4_step_yr * YEAR_S },
            // A body that stalls is followed to the end: the next movement may set it going again.
            end_state_fraction: None,
        };
        let start = SpinState { t_s: state.t_s, omega: state.omega, obliquity: state.obliquity };
        let watch = Stopwatch::start();
        let leg = integrate_leg(&shape.torque, shape.inertia(), start, &limits)?;
        self.ledger.stop(Part::Spin, watch);
        Ok(leg)
    }

    /// Asks the aggregate whether it bears the spin at the end of `leg`, and records the answer.
    fn turn(&mut self, state: State, original: &Original, shape: &mut Shape, leg: &Leg) -> Result<State, EvolveError> {
        let mut record = leg_record(&state, leg);
        let mut next = State {
            leg: state.leg + 1,
            t_s: leg.end.t_s,
            omega: leg.end.omega,
            obliquity: leg.end.obliquity,
            ..state.clone()
        };
        if matches!(leg.reason, StopReason::StopPeriod | StopReason::CycleEnd) {
            next.stage = Stage::Finished;
            next.outcome = Some(Outcome::SpunDown);
            record.result = "stopped".into();
            let torque = shape.inertia() * (leg.end.omega - state.omega);
            record.angular_momentum.start = mass_properties(&state.spheres)?.angular_momentum.norm();
            record.angular_momentum.torque = torque;
            give_along_spin(&mut next.spheres, torque)?;
            next.omega = mass_properties(&next.spheres)?.spin_rate();
            return self.commit_leg(record, next, None, &Shedding::default());
        }
        let watch = Stopwatch::start();
        let progress = self.progress(&state);
        let (engine, observer) = (&mut self.engine, &mut *self.observer);
        let check =
            check_spin(engine, self.scene, &state, [leg.end.t_s, leg.end.omega], &shape.record, observer, progress)?;
        self.ledger.stop(if check.movement.is_some() { Part::Movement } else { Part::Check }, watch);
        self.note_check(&mut record, &check);
        next.spheres = check.body.spheres;
        next.contacts = check.body.contacts;
        next.rest = check.rest;
        next.omega = mass_properties(&next.spheres)?.spin_rate();
        let Some(movement) = check.movement else {
            return self.commit_leg(LegRecord { result: "quiet".into(), ..record }, next, None, &Shedding::default());
        };
        if check.discarded {
            // Back to the start of the leg with a fifth of the increment.
            let back = State { leg: next.leg, refinement: state.refinement + 1, ..state };
            (record.angular_momentum.torque, record.angular_momentum.shed) = (0.0, 0.0);
            return self.commit_leg(
                LegRecord { result: "backtracked".into(), ..record },
                back,
                None,
                &Shedding::default(),
            );
        }
        next.sphere_ids = check.body.ids;
        next.refinement = 0;
        next.configuration = Some(shape.record.configuration + 1);
        let (object, moved) = next_object(self.scene, original, shape, &state, &next, &movement, &mut self.ledger)?;
        *shape = object;
        next.outcome = check.breakup.map(|breakup| match breakup {
            Breakup::Fission => Outcome::Fission,
            Breakup::Disrupted => Outcome::Disrupted,
        });
        if next.outcome.is_some() {
            next.stage = Stage::Finished;
        }
        self.movements += 1;
        self.commit_leg(
            LegRecord { result: "movement".into(), ..record },
            next,
            Some((&shape.record, &moved)),
            &check.shedding,
        )
    }

    /// Enters what the check found into the leg's row, and tells the user what is out of the ordinary.
    fn note_check(&mut self, record: &mut LegRecord, check: &Check) {
        record.dynamics = check.dynamics;
        record.settled = check.settled;
        record.shed = check.shedding.losses.len() as u32;
        if let Some(movement) = &check.movement {
            record.moved = [movement.count(), movement.robust_count, movement.literal_count].map(|n| n as u32);
        }
        record.angular_momentum = check.angular_momentum;
        record.non_axial = check.non_axial;
        if record.non_axial > self.told_tilt {
            // Told again only when it has grown.
            self.told_tilt = 2.0 * record.non_axial;
            let (leg, angle) = (record.leg, record.non_axial.min(1.0).asin().to_degrees());
            let then = match self.scene.settling.residual_rotation {
                ResidualRotation::Align if check.movement.is_some() => "; the body was turned so that it lies along it",
                _ => "",
            };
            self.observer.warn(&format!(
                "leg {leg}: the axis of largest moment stood {angle:.1} deg from the angular momentum{then} (column non_axial)"
            ));
        }
        if !check.settled {
            let (leg, rotations) = (record.leg, check.dynamics.rotations);
            self.observer.warn(&format!("leg {leg}: the body still moved after {rotations} rotations"));
        }
    }

    fn commit_leg(
        &mut self,
        leg: LegRecord,
        state: State,
        configuration: Option<(&ConfigurationRecord, &[MovementRecord])>,
        shedding: &Shedding,
    ) -> Result<State, EvolveError> {
        let angular_momentum = close_books(leg.angular_momentum, &state.spheres, state.omega)?;
        let leg = LegRecord { omega_after: state.omega, angular_momentum, ..leg };
        let commit = LegCommit { leg: &leg, state: &state, configuration, shedding };
        self.save(|store, ledger| store.save_leg(&commit, ledger))?;
        Ok(state)
    }

    fn save(
        &mut self,
        write: impl FnOnce(&mut RunStore, &Ledger) -> Result<(), StoreError>,
    ) -> Result<(), EvolveError> {
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
        reason: reason_name(leg.reason).into(),
        refinement: state.refinement,
        rk4_steps: leg.steps,
        spin_error: leg.error.omega,
        obliquity_error: leg.error.obliquity,
        result: "".into(),
        omega_after: leg.end.omega,
        dynamics: DynamicsRecord::default(),
        moved: [0; 3],
        settled: true,
        non_axial: 0.0,
        angular_momentum: AngularMomentumRecord::default(),
        shed: 0,
    }
}

/// Name of a reason in the database.
fn reason_name(reason: StopReason) -> &'static str {
    match reason {
        StopReason::SpinChange => "spin_change",
        StopReason::Extremum => "extremum",
        StopReason::EndTime => "end_time",
        StopReason::StopPeriod => "stop_period",
        StopReason::EndState => "end_state",
        StopReason::CycleEnd => "cycle_end",
    }
}
