//! What a run has recorded so far, table by table, for reports, exports and statistics.

use std::borrow::Cow;

use rusqlite::Row;

use super::blob::{blob_to_f64, blob_to_u32};
use super::read::read_configuration;
use super::*;

type Read<T> = rusqlite::Result<T>;

impl RunReader {
    /// Version of the build that began the run.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn version(&self) -> Result<String, StoreError> {
        Ok(self.query("SELECT value FROM run WHERE key = 'version'", |row| row.get(0))?.unwrap_or_default())
    }

    /// Mass (kg) and radius (m) of every sphere of the body as constructed; the index is the sphere's number.
    ///
    /// # Errors
    /// The database cannot be read or is damaged.
    pub fn spheres(&self) -> Result<Vec<[f64; 2]>, StoreError> {
        let rows = self.rows("SELECT sphere, mass_kg, radius_m FROM sphere ORDER BY sphere", |row| {
            Ok((row.get::<_, i64>(0)?, [row.get(1)?, row.get(2)?]))
        })?;
        if rows.iter().enumerate().any(|(i, (sphere, _))| *sphere != i as i64) {
            return Err(self.damaged("the numbers in sphere have gaps"));
        }
        Ok(rows.into_iter().map(|(_, sphere)| sphere).collect())
    }

    /// The body as it was made; `None` before that.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn built(&self) -> Result<Option<BuiltRecord>, StoreError> {
        self.query("SELECT * FROM built", |row| {
            Ok(BuiltRecord {
                b_over_a: row.get("b1_b_over_a")?,
                c_over_a: row.get("b1_c_over_a")?,
                density_kg_m3: row.get("density_b1_kg_m3")?,
                period_s: row.get("period_s")?,
            })
        })
    }

    /// The blocks of settling.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn settling(&self) -> Result<Vec<SettlingRecord>, StoreError> {
        self.rows("SELECT * FROM settling ORDER BY block", |row| {
            Ok(SettlingRecord {
                block: row.get("block")?,
                period_s: row.get("period_s")?,
                moved: row.get("moved")?,
                max_displacement_radii: row.get("max_displacement_radii")?,
                b_over_a: row.get("b1_b_over_a")?,
                c_over_a: row.get("b1_c_over_a")?,
                dynamics: drifts(row, work(row)?)?,
                angular_momentum: row.get("angular_momentum")?,
                non_axial: row.get("non_axial")?,
                shed: row.get("shed")?,
            })
        })
    }

    /// All shapes of the body.
    ///
    /// # Errors
    /// The database cannot be read or is damaged.
    pub fn configurations(&self) -> Result<Vec<ConfigurationRecord>, StoreError> {
        let rows = self.rows("SELECT * FROM configuration ORDER BY configuration", read_configuration)?;
        rows.into_iter().map(|decoded| decoded.ok_or_else(|| self.damaged("configuration"))).collect()
    }

    /// All legs, those that were backtracked included.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn legs(&self) -> Result<Vec<LegRecord>, StoreError> {
        self.rows("SELECT * FROM leg ORDER BY leg", read_leg)
    }

    /// The last of them.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn last_leg(&self) -> Result<Option<LegRecord>, StoreError> {
        self.query("SELECT * FROM leg ORDER BY leg DESC LIMIT 1", read_leg)
    }

    /// The intervals that a movement has closed.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn intervals(&self) -> Result<Vec<IntervalRecord>, StoreError> {
        self.rows("SELECT * FROM interval ORDER BY interval", |row| {
            Ok(IntervalRecord {
                interval: row.get("interval")?,
                configuration: row.get("configuration")?,
                legs: row.get("legs")?,
                t_s: [row.get("t0_s")?, row.get("t1_s")?],
                omega: [row.get("omega0")?, row.get("omega1")?],
                obliquity: [row.get("obliquity0")?, row.get("obliquity1")?],
            })
        })
    }

    /// The spheres that moved, each with the configuration that came out of the movement.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn movements(&self) -> Result<Vec<(u32, MovementRecord)>, StoreError> {
        self.rows("SELECT * FROM movement ORDER BY configuration, sphere", |row| {
            let movement = MovementRecord {
                sphere: row.get("sphere")?,
                displacement_m: row.get("displacement_m")?,
                enclosed_mass_fraction: row.get("enclosed_mass_fraction")?,
            };
            Ok((row.get("configuration")?, movement))
        })
    }

    /// The spheres that left, each with the leg whose check shed it (`None`: while settling).
    ///
    /// # Errors
    /// The database cannot be read or is damaged.
    pub fn losses(&self) -> Result<Vec<(Option<u32>, LossRecord)>, StoreError> {
        let rows = self.rows("SELECT * FROM loss ORDER BY leg, sphere", |row| {
            let vectors = (vector(row, "position")?, vector(row, "velocity")?, vector(row, "spin")?);
            let (sphere, t_s, omega) = (row.get("sphere")?, row.get("t_s")?, row.get("omega")?);
            let (leg, energy_j) = (leg(row)?, row.get("energy_j")?);
            let (Some(position), Some(velocity), Some(spin)) = vectors else { return Ok(None) };
            Ok(Some((leg, LossRecord { sphere, t_s, omega, position, velocity, spin, energy_j })))
        })?;
        rows.into_iter().collect::<Option<_>>().ok_or_else(|| self.damaged("loss"))
    }

    /// What became of spheres that left, with the leg whose check shed them (`None`: while settling).
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn fates(&self) -> Result<Vec<(Option<u32>, FateRecord)>, StoreError> {
        self.rows("SELECT * FROM fate ORDER BY id", |row| {
            let fate = FateRecord {
                sphere: row.get("sphere")?,
                fate: text(row, "fate")?,
                t_s: row.get("t_s")?,
                speed_m_s: row.get("speed_m_s")?,
                position: vector(row, "position")?,
                orbit: vector(row, "orbit")?,
                within_3_radii: row.get("within_3_radii")?,
                into: row.get("into_sphere")?,
                returned: row.get("returned")?,
                angular_momentum: vector(row, "angular_momentum")?,
            };
            Ok((leg(row)?, fate))
        })
    }

    /// How the pieces of a fission went on, with the leg that ended in it.
    ///
    /// # Errors
    /// The database cannot be read or is damaged.
    pub fn fission(&self) -> Result<Option<(Option<u32>, FissionRecord)>, StoreError> {
        let row = self.query("SELECT * FROM fission ORDER BY leg", |row| {
            let blob = |name: &str| row.get::<_, Vec<u8>>(name);
            let pair = |name: &str| Ok::<_, rusqlite::Error>(blob_to_f64(&blob(name)?).and_then(|v| v.try_into().ok()));
            let (mass_kg, spin_rate) = (pair("mass_kg")?, pair("spin_rate")?);
            let spheres = blob_to_u32(&blob("spheres")?);
            let (Some(mass_kg), Some(spin_rate), Some(spheres)) = (mass_kg, spin_rate, spheres) else {
                return Ok(None);
            };
            let (fate, orbit) = (text(row, "fate")?, vector(row, "orbit")?);
            let (t_s, speed_m_s) = (row.get("t_s")?, row.get("speed_m_s")?);
            Ok(Some((leg(row)?, FissionRecord { mass_kg, spheres, fate, t_s, speed_m_s, orbit, spin_rate })))
        })?;
        row.map(|decoded| decoded.ok_or_else(|| self.damaged("fission"))).transpose()
    }

    /// The curve that object 0 would follow were it rigid.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn rigid(&self) -> Result<Vec<RigidRecord>, StoreError> {
        self.rows("SELECT t_s, omega, obliquity FROM rigid ORDER BY sample", |row| {
            Ok(RigidRecord { t_s: row.get(0)?, omega: row.get(1)?, obliquity: row.get(2)? })
        })
    }

    /// Every start of the program on this run.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn sessions(&self) -> Result<Vec<SessionRecord>, StoreError> {
        self.rows("SELECT * FROM meta_session ORDER BY session", |row| {
            Ok(SessionRecord {
                started_unix_s: row.get("started_unix_s")?,
                host: row.get("host")?,
                threads: row.get("threads")?,
                version: row.get("version")?,
                processor: row.get("processor")?,
                seconds: row.get("seconds")?,
                cpu_seconds: row.get("cpu_seconds")?,
            })
        })
    }
}

fn read_leg(row: &Row) -> Read<LegRecord> {
    Ok(LegRecord {
        leg: row.get("leg")?,
        configuration: row.get("configuration")?,
        t_s: [row.get("t0_s")?, row.get("t1_s")?],
        omega: [row.get("omega0")?, row.get("omega1")?],
        obliquity: [row.get("obliquity0")?, row.get("obliquity1")?],
        reason: text(row, "reason")?,
        refinement: row.get("refinement")?,
        rk4_steps: count(row, "rk4_steps")?,
        spin_error: row.get("spin_error")?,
        obliquity_error: row.get("obliquity_error")?,
        result: text(row, "result")?,
        omega_after: row.get("omega_after")?,
        dynamics: DynamicsRecord { max_overlap_radii: row.get("max_overlap_radii")?, ..drifts(row, work(row)?)? },
        moved: [row.get("moved")?, row.get("moved_robust")?, row.get("moved_literal")?],
        settled: row.get("settled")?,
        non_axial: row.get("non_axial")?,
        angular_momentum: AngularMomentumRecord {
            start: row.get("angular_momentum0")?,
            torque: row.get("angular_momentum_torque")?,
            shed: row.get("angular_momentum_shed")?,
            end: row.get("angular_momentum1")?,
            over_spin: row.get("angular_momentum_over_spin")?,
        },
        shed: row.get("shed")?,
    })
}

/// The counters that legs and blocks of settling share.
fn work(row: &Row) -> Read<DynamicsRecord> {
    Ok(DynamicsRecord {
        rotations: row.get("rotations")?,
        collisions: count(row, "collisions")?,
        slide_rule: count(row, "slide_rule")?,
        collapse_rule: count(row, "collapse_rule")?,
        capped: count(row, "capped")?,
        ..DynamicsRecord::default()
    })
}

/// `counters` with the drifts of momentum that stand beside them.
fn drifts(row: &Row, counters: DynamicsRecord) -> Read<DynamicsRecord> {
    let (momentum_drift, angular_momentum_drift) = (row.get("momentum_drift")?, row.get("angular_momentum_drift")?);
    Ok(DynamicsRecord { momentum_drift, angular_momentum_drift, ..counters })
}

fn text(row: &Row, column: &str) -> Read<Cow<'static, str>> {
    row.get::<_, String>(column).map(Cow::Owned)
}

fn count(row: &Row, column: &str) -> Read<u64> {
    row.get::<_, i64>(column).map(|n| n.max(0) as u64)
}

/// -1 stands for settling.
fn leg(row: &Row) -> Read<Option<u32>> {
    row.get::<_, i64>("leg").map(|leg| u32::try_from(leg).ok())
}

/// `None` for NULL and for anything but three numbers.
fn vector(row: &Row, column: &str) -> Read<Option<[f64; 3]>> {
    let blob = row.get::<_, Option<Vec<u8>>>(column)?;
    Ok(blob.and_then(|blob| blob_to_f64(&blob)).and_then(|v| v.try_into().ok()))
}
