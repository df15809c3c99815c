//! Everything that figures, pages and exports need from a run, read at one moment of it.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use crate::scene::Scene;
use crate::store::{
    ConfigurationRecord, Ending, FateRecord, FissionRecord, IntervalRecord, LegRecord, LossRecord, MovementRecord,
    RigidRecord, RunReader, SessionRecord, SettlingRecord, State, StoreError, TilingRecord, Totals,
};

/// A run as recorded so far; what it has not come to yet is empty or `None`.
///
/// Indices fit: sphere numbers are rows of [`Self::sphere_radius_m`], configuration numbers are rows of
/// [`Self::configurations`] and of [`Self::movements`], facets name vertices that every configuration has.
#[derive(Debug, Clone, PartialEq)]
pub struct RunData {
    /// The run directory.
    pub directory: PathBuf,
    /// The scene, with every default filled in.
    pub scene: Scene,
    /// Version of the build that began the run.
    pub version: String,
    /// Mass of each sphere of the body as constructed, kg.
    pub sphere_mass_kg: Vec<f64>,
    /// Radius likewise, m.
    pub sphere_radius_m: Vec<f64>,
    /// Blocks of settling.
    pub settling: Vec<SettlingRecord>,
    /// What the next turn of the loop starts from; `None` before the aggregate is built.
    pub state: Option<State>,
    /// What all tilings share; `None` before object 0.
    pub tiling: Option<TilingRecord>,
    /// All shapes of the body.
    pub configurations: Vec<ConfigurationRecord>,
    /// For each configuration the spheres whose movement made it, by number; empty for object 0.
    pub movements: Vec<Vec<MovementRecord>>,
    /// All legs, backtracked ones included; see [`Self::accepted_legs`].
    pub legs: Vec<LegRecord>,
    /// The intervals that a movement has closed; see [`Self::open_interval`].
    pub intervals: Vec<IntervalRecord>,
    /// Spheres that left, with the leg whose check shed them (`None`: while settling).
    pub losses: Vec<(Option<u32>, LossRecord)>,
    /// What became of spheres that left, likewise.
    pub fates: Vec<(Option<u32>, FateRecord)>,
    /// How the pieces of a fission went on, likewise.
    pub fission: Option<(Option<u32>, FissionRecord)>,
    /// The curve that object 0 would follow were it rigid.
    pub rigid: Vec<RigidRecord>,
    /// Where the run stands, if it was brought to a requested time or its end.
    pub ending: Option<Ending>,
    /// Every start of the program.
    pub sessions: Vec<SessionRecord>,
    /// Cost and errors over all sessions.
    pub totals: Totals,
}

impl RunData {
    /// Reads the run in `directory`, as it is between two of its transactions; a run that goes on is not disturbed.
    ///
    /// # Errors
    /// The directory holds no run, or one that is foreign, of another version, unreadable or damaged.
    pub fn read(directory: &Path) -> Result<Self, StoreError> {
        RunReader::open(directory)?.snapshot(|reader| {
            let (sphere_mass_kg, sphere_radius_m) = reader.spheres()?.into_iter().map(|[m, r]| (m, r)).unzip();
            let configurations = reader.configurations()?;
            let mut movements = vec![Vec::new(); configurations.len()];
            for (configuration, movement) in reader.movements()? {
                let row = movements.get_mut(configuration as usize);
                row.ok_or_else(|| reader.damaged("movement.configuration"))?.push(movement);
            }
            let run = Self {
                directory: directory.to_owned(),
                scene: reader.scene()?,
                version: reader.version()?,
                sphere_mass_kg,
                sphere_radius_m,
                settling: reader.settling()?,
                state: reader.state()?,
                tiling: reader.tiling()?,
                configurations,
                movements,
                legs: reader.legs()?,
                intervals: reader.intervals()?,
                losses: reader.losses()?,
                fates: reader.fates()?,
                fission: reader.fission()?,
                rigid: reader.rigid()?,
                ending: reader.ending()?,
                sessions: reader.sessions()?,
                totals: reader.totals()?,
            };
            match run.first_misfit() {
                None => Ok(run),
                Some(what) => Err(reader.damaged(what)),
            }
        })
    }

    /// What in the database points to something that is not there.
    fn first_misfit(&self) -> Option<&'static str> {
        let spheres = self.sphere_mass_kg.len();
        let is_sphere = |sphere: u32| (sphere as usize) < spheres;
        let is_configuration = |number: u32| (number as usize) < self.configurations.len();
        let vertices = self.configurations.first().map_or(0, |c| c.vertices.len());
        let fits = |number: usize, c: &ConfigurationRecord| {
            let torques = c.torque.obliquity.len() * c.torque.spin_rate.len();
            c.configuration as usize == number
                && c.positions.len() == c.sphere_ids.len()
                && c.sphere_ids.iter().all(|s| is_sphere(*s))
                && c.vertices.len() == vertices
                && [&c.torque.spin_torque, &c.torque.obliquity_torque].iter().all(|t| t.len() == torques)
        };
        let facets = self.tiling.as_ref().map_or(&[][..], |t| &t.facets);
        let state = self.state.as_ref().map_or(&[][..], |s| &s.sphere_ids);
        let checks = [
            (self.configurations.iter().enumerate().all(|(i, c)| fits(i, c)), "configuration"),
            (self.tiling.is_some() || self.configurations.is_empty(), "tiling"),
            (facets.iter().flatten().all(|v| (*v as usize) < vertices), "tiling.facets"),
            (state.iter().all(|s| is_sphere(*s)), "state.sphere_ids"),
            (self.movements.iter().flatten().all(|m| is_sphere(m.sphere)), "movement.sphere"),
            (self.legs.iter().all(|l| is_configuration(l.configuration)), "leg.configuration"),
            (self.intervals.iter().all(|i| is_configuration(i.configuration)), "interval.configuration"),
            (self.losses.iter().all(|(_, l)| is_sphere(l.sphere)), "loss.sphere"),
            (self.fates.iter().all(|(_, f)| is_sphere(f.sphere)), "fate.sphere"),
        ];
        checks.into_iter().find(|(holds, _)| !holds).map(|(_, what)| what)
    }

    /// The legs that the run kept, in order.
    pub fn accepted_legs(&self) -> impl DoubleEndedIterator<Item = &LegRecord> {
        self.legs.iter().filter(|leg| leg.result != "backtracked")
    }

    /// The interval since the last movement, if legs have been taken since: what [`Self::intervals`] does not hold yet.
    pub fn open_interval(&self) -> Option<IntervalRecord> {
        let configuration = self.configurations.last()?.configuration;
        let legs: Vec<_> = self.accepted_legs().filter(|leg| leg.configuration == configuration).collect();
        let (first, last) = (legs.first()?, legs.last()?);
        Some(IntervalRecord {
            interval: self.intervals.last().map_or(1, |i| i.interval + 1),
            configuration,
            legs: legs.len() as u32,
            t_s: [first.t_s[0], last.t_s[1]],
            omega: [first.omega[0], last.omega[1]],
            obliquity: [first.obliquity[0], last.obliquity[1]],
        })
    }

    /// Centres of a configuration's spheres in its own body frame (x long, z spin axis), m, in the order of its
    /// `sphere_ids`.
    pub fn body_positions(configuration: &ConfigurationRecord) -> Vec<[f64; 3]> {
        in_body_frame(configuration, &configuration.positions)
    }

    /// Tiling vertices of a configuration in its own body frame, m.
    pub fn body_vertices(configuration: &ConfigurationRecord) -> Vec<[f64; 3]> {
        in_body_frame(configuration, &configuration.vertices)
    }

    /// Rotation period in hours, of a spin rate in rad/s; `None` for a body that does not turn.
    pub fn period_h(omega: f64) -> Option<f64> {
        (omega > 0.0).then(|| TAU / omega / 3600.0)
    }

    /// Mass of the body as constructed, kg.
    pub fn initial_mass_kg(&self) -> f64 {
        self.sphere_mass_kg.iter().sum()
    }
}

fn in_body_frame(configuration: &ConfigurationRecord, points: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let (axes, centre) = (&configuration.body_axes, &configuration.centre_of_mass);
    let turned = |p: &[f64; 3]| axes.map(|axis| (0..3).map(|k| axis[k] * (p[k] - centre[k])).sum());
    points.iter().map(turned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Body, FileBody};
    use crate::store::RunStore;

    #[test]
    fn a_run_that_has_only_begun_is_empty_and_its_directory_stays_usable() {
        let folder = tempfile::tempdir().unwrap();
        let scene = Scene::from_body(Body::File(FileBody { path: "a.csv".into() }));
        let store = RunStore::open(folder.path(), &scene, false).unwrap();
        let run = RunData::read(folder.path()).unwrap();
        assert_eq!(run.scene, scene);
        assert!(run.state.is_none() && run.configurations.is_empty() && run.open_interval().is_none());
        drop(store);
        assert!(RunStore::open(folder.path(), &scene, true).is_ok());
    }

    #[test]
    fn what_holds_no_run_of_this_program_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let refused = |folder: &Path| RunData::read(folder).unwrap_err();
        assert!(matches!(refused(&folder.path().join("absent")), StoreError::NoRun(_)));
        std::fs::write(folder.path().join("run.sqlite"), "no database, only a long enough text of some other kind")
            .unwrap();
        assert!(matches!(refused(folder.path()), StoreError::Foreign { .. } | StoreError::ReadDatabase { .. }));
    }
}
