//! The transactions of a run: built, settling block, object 0, leg, ending.

use pkd::soft_sphere::Contact;
use rusqlite::{Transaction, named_params, params};

use super::blob::{f64_to_blob, points_to_blob, u32_to_blob};
use super::*;

/// Everything that one leg adds to the database.
#[derive(Debug)]
pub struct LegCommit<'a> {
    /// The leg itself.
    pub leg: &'a LegRecord,
    /// State that the next turn starts from.
    pub state: &'a State,
    /// The new configuration, if spheres moved, and what each of them did.
    pub configuration: Option<(&'a ConfigurationRecord, &'a [MovementRecord])>,
    /// Spheres that left.
    pub shedding: &'a Shedding,
}

impl RunStore {
    /// Stores the aggregate as constructed, before settling.
    ///
    /// # Errors
    /// The database cannot be written.
    pub fn save_built(&mut self, built: &BuiltRecord, state: &State, ledger: &Ledger) -> Result<(), StoreError> {
        let session = self.session;
        self.transaction(|tx| {
            let mut insert = tx.prepare("INSERT INTO sphere VALUES (?1, ?2, ?3)")?;
            for (i, id) in state.sphere_ids.iter().enumerate() {
                insert.execute(params![id, state.spheres.mass[i], state.spheres.radius[i]])?;
            }
            tx.execute(
                "INSERT INTO built VALUES (1, ?1, ?2, ?3, ?4)",
                params![built.b_over_a, built.c_over_a, built.density_kg_m3, built.period_s],
            )?;
            write_state(tx, state)?;
            write_ledger(tx, session, ledger)
        })
    }

    /// Stores one block of settling.
    ///
    /// # Errors
    /// The database cannot be written.
    pub fn save_settling(
        &mut self,
        block: &SettlingRecord,
        shedding: &Shedding,
        state: &State,
        ledger: &Ledger,
    ) -> Result<(), StoreError> {
        let session = self.session;
        self.transaction(|tx| {
            tx.execute(
                "INSERT INTO settling VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16)",
                params![
                    block.block,
                    block.dynamics.rotations,
                    block.period_s,
                    block.moved,
                    block.max_displacement_radii,
                    block.b_over_a,
                    block.c_over_a,
                    block.dynamics.collisions as i64,
                    block.dynamics.slide_rule as i64,
                    block.dynamics.collapse_rule as i64,
                    block.dynamics.capped as i64,
                    block.dynamics.momentum_drift,
                    block.dynamics.angular_momentum_drift,
                    block.angular_momentum,
                    block.non_axial,
                    block.shed,
                ],
            )?;
            write_shedding(tx, -1, shedding)?;
            write_state(tx, state)?;
            write_ledger(tx, session, ledger)
        })
    }

    /// Stores object 0 and its rigid reference curve.
    ///
    /// # Errors
    /// The database cannot be written.
    pub fn save_object_0(
        &mut self,
        tiling: &TilingRecord,
        configuration: &ConfigurationRecord,
        rigid: &[RigidRecord],
        state: &State,
        ledger: &Ledger,
    ) -> Result<(), StoreError> {
        let session = self.session;
        self.transaction(|tx| {
            tx.execute(
                "INSERT INTO tiling VALUES (1, ?1, ?2, ?3)",
                params![
                    u32_to_blob(tiling.facets.iter().flatten().copied()),
                    f64_to_blob(tiling.ellipsoid_axes_m),
                    points_to_blob(&tiling.frame_rotation),
                ],
            )?;
            write_configuration(tx, configuration)?;
            let mut insert = tx.prepare("INSERT INTO rigid VALUES (?1, ?2, ?3, ?4)")?;
            for (sample, r) in rigid.iter().enumerate() {
                insert.execute(params![sample as i64, r.t_s, r.omega, r.obliquity])?;
            }
            write_state(tx, state)?;
            write_ledger(tx, session, ledger)
        })
    }

    /// Stores one leg with all that followed from it.
    ///
    /// # Errors
    /// The database cannot be written.
    pub fn save_leg(&mut self, commit: &LegCommit, ledger: &Ledger) -> Result<(), StoreError> {
        let session = self.session;
        self.transaction(|tx| {
            write_leg(tx, commit.leg)?;
            if let Some((configuration, movements)) = &commit.configuration {
                close_interval(tx, commit.leg)?;
                write_configuration(tx, configuration)?;
                let mut insert = tx.prepare("INSERT INTO movement VALUES (?1, ?2, ?3, ?4)")?;
                for m in *movements {
                    insert.execute(params![
                        configuration.configuration,
                        m.sphere,
                        m.displacement_m,
                        m.enclosed_mass_fraction
                    ])?;
                }
            }
            write_shedding(tx, i64::from(commit.leg.leg), commit.shedding)?;
            tx.execute("DELETE FROM ending", [])?;
            write_state(tx, commit.state)?;
            write_ledger(tx, session, ledger)
        })
    }

    /// Stores where the run stands now that it has been brought to a requested time or cannot go on.
    ///
    /// # Errors
    /// The database cannot be written.
    pub fn save_ending(&mut self, ending: &Ending, ledger: &Ledger) -> Result<(), StoreError> {
        let session = self.session;
        self.transaction(|tx| {
            tx.execute(
                "INSERT OR REPLACE INTO ending VALUES (1, ?1, ?2, ?3, ?4)",
                params![ending.t_s, ending.omega, ending.obliquity, ending.outcome.name()],
            )?;
            write_ledger(tx, session, ledger)
        })
    }
}

fn write_state(tx: &Transaction, state: &State) -> rusqlite::Result<()> {
    let (soft, contacts) = (state.normal_stiffness_n_m.is_some(), state.contacts.contacts());
    tx.execute(
        "INSERT OR REPLACE INTO state VALUES \
         (1, :stage, :outcome, :blocks, :leg, :configuration, :refinement, :t_s, :omega, :obliquity, :spheres, :ids, \
         :rest, :stiffness, :rows, :contacts)",
        named_params! {
            ":stage": state.stage.name(),
            ":outcome": state.outcome.map(Outcome::name),
            ":blocks": state.blocks,
            ":leg": state.leg,
            ":configuration": state.configuration.map_or(-1, i64::from),
            ":refinement": state.refinement,
            ":t_s": state.t_s,
            ":omega": state.omega,
            ":obliquity": state.obliquity,
            ":spheres": f64_to_blob(state.spheres.columns().into_iter().flatten().copied()),
            ":ids": u32_to_blob(state.sphere_ids.iter().copied()),
            ":stiffness": state.normal_stiffness_n_m,
            ":rows": soft.then(|| u32_to_blob(contacts.iter().flat_map(|c| [c.first, c.second]))),
            ":contacts": soft.then(|| f64_to_blob(contacts.iter().flat_map(Contact::memory))),
            ":rest": state.rest.as_ref().map(|rest| f64_to_blob(rest.iter().flatten().copied())),
        },
    )?;
    Ok(())
}

fn write_configuration(tx: &Transaction, c: &ConfigurationRecord) -> rusqlite::Result<()> {
    tx.execute(
        "INSERT INTO configuration VALUES (:configuration, :after_leg, :t_s, :mass, :ids, :positions, :axes, :com, \
         :moments, :b1, :b2, :d1, :d2, :d3, :d4, :vertices, :kept, :flagged, :folded, :obliquity, :spin_rate, \
         :spin_torque, :obliquity_torque, :spin_error, :obliquity_error)",
        named_params! {
            ":configuration": c.configuration,
            ":after_leg": c.after_leg.map_or(-1, i64::from),
            ":t_s": c.t_s,
            ":mass": c.mass_kg,
            ":ids": u32_to_blob(c.sphere_ids.iter().copied()),
            ":positions": points_to_blob(&c.positions),
            ":axes": points_to_blob(&c.body_axes),
            ":com": f64_to_blob(c.centre_of_mass),
            ":moments": f64_to_blob(c.moments_kg_m2),
            ":b1": f64_to_blob(c.b1_axes_m),
            ":b2": f64_to_blob(c.b2_axes_m),
            ":d1": c.densities_kg_m3[0],
            ":d2": c.densities_kg_m3[1],
            ":d3": c.densities_kg_m3[2],
            ":d4": c.densities_kg_m3[3],
            ":vertices": points_to_blob(&c.vertices),
            ":kept": c.vertices_kept,
            ":flagged": c.vertices_flagged,
            ":folded": c.facets_folded,
            ":obliquity": f64_to_blob(c.torque.obliquity.iter().copied()),
            ":spin_rate": f64_to_blob(c.torque.spin_rate.iter().copied()),
            ":spin_torque": f64_to_blob(c.torque.spin_torque.iter().copied()),
            ":obliquity_torque": f64_to_blob(c.torque.obliquity_torque.iter().copied()),
            ":spin_error": c.torque.spin_torque_error,
            ":obliquity_error": c.torque.obliquity_torque_error,
        },
    )?;
    Ok(())
}

fn write_leg(tx: &Transaction, l: &LegRecord) -> rusqlite::Result<()> {
    tx.execute(
        "INSERT INTO leg VALUES (:leg, :configuration, :t0, :t1, :omega0, :omega1, :obliquity0, :obliquity1, :reason, \
         :refinement, :steps, :spin_error, :obliquity_error, :result, :omega_after, :rotations, :collisions, :slide, \
         :collapse, :capped, :overlap, :moved, :robust, :literal, :settled, :non_axial, :l0, :l_torque, \
         :l_shed, :l1, :l_over_spin, :momentum, :angular, :shed)",
        named_params! {
            ":leg": l.leg,
            ":configuration": l.configuration,
            ":t0": l.t_s[0],
            ":t1": l.t_s[1],
            ":omega0": l.omega[0],
            ":omega1": l.omega[1],
            ":obliquity0": l.obliquity[0],
            ":obliquity1": l.obliquity[1],
            ":reason": l.reason,
            ":refinement": l.refinement,
            ":steps": l.rk4_steps as i64,
            ":spin_error": l.spin_error,
            ":obliquity_error": l.obliquity_error,
            ":result": l.result,
            ":omega_after": l.omega_after,
            ":rotations": l.dynamics.rotations,
            ":collisions": l.dynamics.collisions as i64,
            ":slide": l.dynamics.slide_rule as i64,
            ":collapse": l.dynamics.collapse_rule as i64,
            ":capped": l.dynamics.capped as i64,
            ":overlap": l.dynamics.max_overlap_radii,
            ":moved": l.moved[0],
            ":robust": l.moved[1],
            ":literal": l.moved[2],
            ":settled": l.settled,
            ":non_axial": l.non_axial,
            ":l0": l.angular_momentum.start,
            ":l_torque": l.angular_momentum.torque,
            ":l_shed": l.angular_momentum.shed,
            ":l1": l.angular_momentum.end,
            ":l_over_spin": l.angular_momentum.over_spin,
            ":momentum": l.dynamics.momentum_drift,
            ":angular": l.dynamics.angular_momentum_drift,
            ":shed": l.shed,
        },
    )?;
    Ok(())
}

/// Adds the interval that ends with `leg`: all accepted legs of its configuration.
fn close_interval(tx: &Transaction, leg: &LegRecord) -> rusqlite::Result<()> {
    tx.execute(
        "INSERT INTO interval (configuration, legs, t0_s, t1_s, omega0, omega1, obliquity0, obliquity1) \
         SELECT ?1, count(*), first.t0_s, ?2, first.omega0, ?3, first.obliquity0, ?4 FROM leg, \
         (SELECT t0_s, omega0, obliquity0 FROM leg WHERE configuration = ?1 ORDER BY leg LIMIT 1) AS first \
         WHERE configuration = ?1 AND result <> 'backtracked'",
        params![leg.configuration, leg.t_s[1], leg.omega[1], leg.obliquity[1]],
    )?;
    Ok(())
}

fn write_shedding(tx: &Transaction, leg: i64, shedding: &Shedding) -> rusqlite::Result<()> {
    let Shedding { losses, fates, fission, .. } = shedding;
    let mut insert = tx.prepare("INSERT INTO loss VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)")?;
    for l in losses {
        insert.execute(params![
            leg,
            l.sphere,
            l.t_s,
            l.omega,
            f64_to_blob(l.position),
            f64_to_blob(l.velocity),
            f64_to_blob(l.spin),
            l.energy_j
        ])?;
    }
    let mut insert = tx.prepare(
        "INSERT INTO fate (leg, sphere, fate, t_s, speed_m_s, position, orbit, within_3_radii, into_sphere, returned, \
         angular_momentum) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11)",
    )?;
    for f in fates {
        insert.execute(params![
            leg,
            f.sphere,
            f.fate,
            f.t_s,
            f.speed_m_s,
            f.position.map(f64_to_blob),
            f.orbit.map(f64_to_blob),
            f.within_3_radii,
            f.into,
            f.returned,
            f.angular_momentum.map(f64_to_blob)
        ])?;
    }
    if let Some(f) = fission {
        tx.execute(
            "INSERT INTO fission VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)",
            params![
                leg,
                f64_to_blob(f.mass_kg),
                u32_to_blob(f.spheres.iter().copied()),
                f.fate,
                f.t_s,
                f.speed_m_s,
                f.orbit.map(f64_to_blob),
                f64_to_blob(f.spin_rate)
            ],
        )?;
    }
    Ok(())
}

fn write_ledger(tx: &Transaction, session: i64, ledger: &Ledger) -> rusqlite::Result<()> {
    let (seconds, cpu_seconds) = ledger.elapsed();
    tx.execute(
        "UPDATE meta_session SET seconds = ?2, cpu_seconds = ?3 WHERE session = ?1",
        params![session, seconds, cpu_seconds],
    )?;
    let mut insert = tx.prepare("INSERT OR REPLACE INTO meta_part VALUES (?1, ?2, ?3, ?4, ?5)")?;
    for (part, total) in ledger.parts() {
        insert.execute(params![session, part.name(), total.seconds, total.cpu_seconds, total.count as i64])?;
    }
    Ok(())
}
