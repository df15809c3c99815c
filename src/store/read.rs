//! What a resumed run and its summary read back.

use pkd::soft_sphere::{Contact, ContactHistory};
use rusqlite::Row;

use super::blob::{blob_to_f64, blob_to_points, blob_to_u32};
use super::*;

/// Totals over all sessions of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Totals {
    /// Wall time, s.
    pub seconds: f64,
    /// CPU time, s.
    pub cpu_seconds: f64,
    /// Cost of each part, in the order of [`Part::ALL`].
    pub parts: Vec<(Part, PartTotal)>,
    /// Intervals closed.
    pub intervals: u32,
    /// Legs whose check moved spheres.
    pub movements: u32,
    /// Mass that has left over the initial mass.
    pub shed_mass_fraction: f64,
    /// Largest momentum drift of a check.
    pub momentum_drift: f64,
    /// Largest angular momentum drift of a check.
    pub angular_momentum_drift: f64,
    /// Angular momentum from object 0 until now, kg m^2/s; zero before object 0.
    pub angular_momentum: AngularMomentumRecord,
    /// Largest [`AngularMomentumRecord::error`] of a leg.
    pub angular_momentum_error: f64,
    /// Deepest overlap of a check, radii.
    pub max_overlap_radii: f64,
    /// Largest step-doubling error of a leg, relative.
    pub spin_error: f64,
    /// Torque errors of the latest configuration, N m: spin, obliquity.
    pub torque_error: Option<(f64, f64)>,
    /// Vertices of the latest configuration that needed the fallback direction.
    pub vertices_flagged: Option<u32>,
}

impl RunReader {
    /// The scene of the run, with every default filled in.
    ///
    /// # Errors
    /// The database cannot be read or is damaged.
    pub fn scene(&self) -> Result<Scene, StoreError> {
        let text = self
            .query("SELECT value FROM run WHERE key = 'scene'", |row| row.get::<_, String>(0))?
            .ok_or_else(|| self.damaged("it holds no scene"))?;
        Scene::parse(&text, &self.database).map_err(|error| self.damaged(format!("its scene does not parse: {error}")))
    }

    /// The state that the next turn starts from; `None` before the aggregate is built.
    ///
    /// # Errors
    /// The database cannot be read or is damaged.
    pub fn state(&self) -> Result<Option<State>, StoreError> {
        type Columns = (String, Option<String>, u32, u32, i64, u32, f64, f64, f64, Vec<u8>, Vec<u8>);
        type Contacts = (Option<f64>, Option<Vec<u8>>, Option<Vec<u8>>);
        let row = self.query(
            "SELECT stage, outcome, blocks, leg, configuration, refinement, t_s, omega, obliquity, spheres, sphere_ids FROM state",
            |row| Columns::try_from(row),
        )?;
        let contacts = self
            .query("SELECT normal_stiffness_n_m, contact_rows, contacts FROM state", |row| Contacts::try_from(row))?;
        let (normal_stiffness_n_m, rows, memory) = contacts.unwrap_or_default();
        let Some((stage, outcome, blocks, leg, configuration, refinement, t_s, omega, obliquity, spheres, ids)) = row
        else {
            return Ok(None);
        };
        let sphere_ids = blob_to_u32(&ids).ok_or_else(|| self.damaged("state.sphere_ids"))?;
        let values = blob_to_f64(&spheres).ok_or_else(|| self.damaged("state.spheres"))?;
        if values.len() != 11 * sphere_ids.len() || sphere_ids.is_empty() {
            return Err(self.damaged("state.spheres and state.sphere_ids do not match"));
        }
        let mut body = pkd::Spheres::default();
        for (column, chunk) in body.columns_mut().into_iter().zip(values.chunks_exact(sphere_ids.len())) {
            *column = chunk.to_vec();
        }
        let rest = self.rest(sphere_ids.len())?;
        let outcome = match outcome {
            None => None,
            Some(name) => Some(Outcome::from_name(&name).ok_or_else(|| self.damaged("state.outcome"))?),
        };
        Ok(Some(State {
            stage: Stage::from_name(&stage).ok_or_else(|| self.damaged("state.stage"))?,
            outcome,
            blocks,
            leg,
            configuration: u32::try_from(configuration).ok(),
            refinement,
            t_s,
            omega,
            obliquity,
            contacts: self.contacts(&rows.unwrap_or_default(), &memory.unwrap_or_default(), sphere_ids.len())?,
            normal_stiffness_n_m,
            spheres: body,
            sphere_ids,
            rest,
        }))
    }

    /// Where the aggregate of `count` spheres was last seen at rest.
    fn rest(&self, count: usize) -> Result<Option<[Vec<f64>; 3]>, StoreError> {
        let row = self.query("SELECT rest FROM state WHERE rest IS NOT NULL", |row| row.get::<_, Vec<u8>>(0))?;
        row.map(|blob| {
            let values = blob_to_f64(&blob).filter(|values| values.len() == 3 * count)?;
            let column = |k: usize| values[k * count..][..count].to_vec();
            Some([0, 1, 2].map(column))
        })
        .map(|decoded| decoded.ok_or_else(|| self.damaged("state.rest")))
        .transpose()
    }

    /// What the contacts of `spheres` spheres remember.
    fn contacts(&self, rows: &[u8], memory: &[u8], spheres: usize) -> Result<ContactHistory, StoreError> {
        let decoded = || {
            let (rows, memory) = (blob_to_u32(rows)?, blob_to_f64(memory)?);
            let ((rows, no_row), (memory, no_memory)) = (rows.as_chunks::<2>(), memory.as_chunks::<8>());
            let fits = no_row.is_empty() && no_memory.is_empty() && rows.len() == memory.len();
            let fits = fits && rows.iter().flatten().all(|row| (*row as usize) < spheres);
            let contacts = rows.iter().zip(memory).map(|(rows, memory)| Contact::from_memory(*rows, *memory));
            if fits { ContactHistory::new(contacts.collect()).ok() } else { None }
        };
        decoded().ok_or_else(|| self.damaged("state.contacts"))
    }

    /// What all tilings of the run share; `None` before object 0.
    ///
    /// # Errors
    /// The database cannot be read or is damaged.
    pub fn tiling(&self) -> Result<Option<TilingRecord>, StoreError> {
        let row = self.query("SELECT facets, ellipsoid_axes_m, frame_rotation FROM tiling", |row| {
            <(Vec<u8>, Vec<u8>, Vec<u8>)>::try_from(row)
        })?;
        row.map(|(facets, axes, frame)| {
            let flat = blob_to_u32(&facets)?;
            Some(TilingRecord {
                facets: flat.as_chunks::<3>().0.to_vec(),
                ellipsoid_axes_m: blob_to_f64(&axes)?.try_into().ok()?,
                frame_rotation: blob_to_points(&frame)?.try_into().ok()?,
            })
        })
        .map(|decoded| decoded.ok_or_else(|| self.damaged("tiling")))
        .transpose()
    }

    /// The latest configuration; `None` before object 0.
    ///
    /// # Errors
    /// The database cannot be read or is damaged.
    pub fn latest_configuration(&self) -> Result<Option<ConfigurationRecord>, StoreError> {
        let record =
            self.query("SELECT * FROM configuration ORDER BY configuration DESC LIMIT 1", read_configuration)?;
        record.map(|decoded| decoded.ok_or_else(|| self.damaged("configuration"))).transpose()
    }

    /// Where the run stands after its last leg, if it was brought to a requested time or its end.
    ///
    /// # Errors
    /// The database cannot be read or is damaged.
    pub fn ending(&self) -> Result<Option<Ending>, StoreError> {
        let row = self.query("SELECT t_s, omega, obliquity, outcome FROM ending", |row| {
            Ok((row.get(0)?, row.get(1)?, row.get(2)?, row.get::<_, String>(3)?))
        })?;
        let Some((t_s, omega, obliquity, outcome)) = row else { return Ok(None) };
        let outcome = Outcome::from_name(&outcome).ok_or_else(|| self.damaged("ending.outcome"))?;
        Ok(Some(Ending { t_s, omega, obliquity, outcome }))
    }

    /// Totals over all sessions.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn totals(&self) -> Result<Totals, StoreError> {
        let number =
            |sql: &str| self.query(sql, |row| row.get::<_, Option<f64>>(0)).map(|v| v.flatten().unwrap_or(0.0));
        let mut parts = Vec::new();
        for part in Part::ALL {
            let sql = format!(
                "SELECT total(seconds), total(cpu_seconds), coalesce(sum(count), 0) FROM meta_part WHERE part = '{}'",
                part.name()
            );
            let total = self.query(&sql, |row| {
                Ok(PartTotal { seconds: row.get(0)?, cpu_seconds: row.get(1)?, count: row.get::<_, i64>(2)? as u64 })
            })?;
            parts.push((part, total.unwrap_or_default()));
        }
        Ok(Totals {
            seconds: number("SELECT total(seconds) FROM meta_session")?,
            cpu_seconds: number("SELECT total(cpu_seconds) FROM meta_session")?,
            parts,
            intervals: number("SELECT total(1) FROM interval")? as u32,
            movements: number("SELECT total(1) FROM leg WHERE result = 'movement'")? as u32,
            shed_mass_fraction: number(
                "SELECT (SELECT total(mass_kg) FROM sphere JOIN loss USING (sphere)) / (SELECT nullif(total(mass_kg), 0) FROM sphere)",
            )?,
            angular_momentum: AngularMomentumRecord {
                start: number("SELECT angular_momentum0 FROM leg ORDER BY leg LIMIT 1")?,
                torque: number("SELECT total(angular_momentum_torque) FROM leg")?,
                shed: number("SELECT total(angular_momentum_shed) FROM leg")?,
                end: number("SELECT angular_momentum1 FROM leg ORDER BY leg DESC LIMIT 1")?,
                over_spin: number("SELECT angular_momentum_over_spin FROM leg ORDER BY leg DESC LIMIT 1")?,
            },
            angular_momentum_error: number(
                "SELECT max(abs(angular_momentum1 - angular_momentum0 - angular_momentum_torque - angular_momentum_shed) \
                 / max(angular_momentum0, angular_momentum1)) FROM leg",
            )?,
            momentum_drift: number("SELECT max(momentum_drift) FROM leg")?,
            angular_momentum_drift: number("SELECT max(angular_momentum_drift) FROM leg")?,
            max_overlap_radii: number("SELECT max(max_overlap_radii) FROM leg")?,
            spin_error: number("SELECT max(spin_error) FROM leg")?,
            torque_error: self.query(
                "SELECT spin_torque_error, obliquity_torque_error FROM configuration ORDER BY configuration DESC LIMIT 1",
                |row| Ok((row.get(0)?, row.get(1)?)),
            )?,
            vertices_flagged: self.query(
                "SELECT vertices_flagged FROM configuration ORDER BY configuration DESC LIMIT 1",
                |row| row.get(0),
            )?,
        })
    }
}

pub(super) fn read_configuration(row: &Row) -> rusqlite::Result<Option<ConfigurationRecord>> {
    let blob = |name: &str| row.get::<_, Vec<u8>>(name);
    let numbers = |name: &str| Ok::<_, rusqlite::Error>(blob_to_f64(&blob(name)?));
    let points = |name: &str| Ok::<_, rusqlite::Error>(blob_to_points(&blob(name)?));
    let triple = |name: &str| Ok::<_, rusqlite::Error>(numbers(name)?.and_then(|v| <[f64; 3]>::try_from(v).ok()));
    let (sphere_ids, positions) = (blob_to_u32(&blob("sphere_ids")?), points("positions")?);
    let (body_axes, centre) = (points("body_axes")?.and_then(|v| v.try_into().ok()), triple("centre_of_mass")?);
    let (moments, b1, b2) = (triple("moments_kg_m2")?, triple("b1_axes_m")?, triple("b2_axes_m")?);
    let densities = [
        row.get("density_b1_kg_m3")?,
        row.get("density_b2_kg_m3")?,
        row.get("density_b3_kg_m3")?,
        row.get("density_b4_kg_m3")?,
    ];
    let (vertices, obliquity, spin_rate) = (points("vertices")?, numbers("obliquity")?, numbers("spin_rate")?);
    let (spin_torque, obliquity_torque) = (numbers("spin_torque")?, numbers("obliquity_torque")?);
    let (spin_error, obliquity_error) = (row.get("spin_torque_error")?, row.get("obliquity_torque_error")?);
    let (configuration, after_leg) = (row.get("configuration")?, row.get::<_, i64>("after_leg")?);
    let (t_s, mass_kg) = (row.get("t_s")?, row.get("mass_kg")?);
    let counts = (row.get("vertices_kept")?, row.get("vertices_flagged")?, row.get("facets_folded")?);
    Ok((|| {
        Some(ConfigurationRecord {
            configuration,
            after_leg: u32::try_from(after_leg).ok(),
            t_s,
            mass_kg,
            sphere_ids: sphere_ids?,
            positions: positions?,
            body_axes: body_axes?,
            centre_of_mass: centre?,
            moments_kg_m2: moments?,
            b1_axes_m: b1?,
            b2_axes_m: b2?,
            densities_kg_m3: densities,
            vertices: vertices?,
            vertices_kept: counts.0,
            vertices_flagged: counts.1,
            facets_folded: counts.2,
            torque: TorqueRecord {
                obliquity: obliquity?,
                spin_rate: spin_rate?,
                spin_torque: spin_torque?,
                obliquity_torque: obliquity_torque?,
                spin_torque_error: spin_error,
                obliquity_torque_error: obliquity_error,
            },
        })
    })())
}
