//! A run database of any size, made up: what a report needs, without the hours that a run takes.
//!
//! The body is a lattice of equal spheres in an ellipsoid; each movement shifts some of its spheres, and now and then one
//! leaves. Nothing in it is physics, but every table is filled as a run fills it.
#![allow(dead_code)]

use std::path::Path;

use yorp::scene::{Body, FileBody, Rebound, Scene, Track};
use yorp::store::*;

/// How far the made-up run has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Until {
    /// Only the directory exists.
    Begun,
    /// The aggregate is built.
    Built,
    /// A block of settling is done.
    Settling,
    /// Object 0 exists, no leg has been taken.
    Object0,
    /// All legs.
    Legs,
    /// The end.
    End,
}

/// Size of a made-up run.
#[derive(Debug, Clone)]
pub struct Synthetic {
    /// Name of its scene.
    pub name: String,
    /// Spheres.
    pub spheres: usize,
    /// Vertices of its tilings.
    pub vertices: usize,
    /// Configurations, object 0 included.
    pub configurations: u32,
    /// Share of the spheres that a movement shifts.
    pub moved: f64,
    /// How far it has come.
    pub until: Until,
}

impl Default for Synthetic {
    fn default() -> Self {
        let name = "made up".to_owned();
        Self { name, spheres: 120, vertices: 102, configurations: 12, moved: 0.1, until: Until::End }
    }
}

const RADIUS_M: f64 = 50.0;
const MASS_KG: f64 = 1.5e9;
const YEAR_S: f64 = 3.155_76e7;
const TRACKED: &str = "escape";

/// A generator of numbers in 0..1 that is the same everywhere.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

impl Synthetic {
    /// Writes the run into `directory`, which must hold none.
    pub fn write(&self, directory: &Path) {
        let mut scene = Scene::from_body(Body::File(FileBody { path: "made-up.csv".into() }));
        scene.name = self.name.clone();
        scene.shed.track = Track::Rebound(Rebound::default());
        let (mut store, _) = RunStore::open(directory, &scene, false).unwrap();
        if self.until == Until::Begun {
            return;
        }
        let mut ledger = Ledger::default();
        let mut numbers = Numbers(1);
        let home = lattice(self.spheres);
        let mut positions = home.clone();
        let mut state = state(&positions);
        let built = BuiltRecord { b_over_a: 0.8, c_over_a: 0.6, density_kg_m3: 1700.0, period_s: 20_000.0 };
        store.save_built(&built, &state, &ledger).unwrap();
        if self.until == Until::Built {
            return;
        }
        state.blocks = 1;
        store.save_settling(&settling(), &Shedding::default(), &state, &ledger).unwrap();
        if self.until == Until::Settling {
            return;
        }
        let mesh = tiling::fibonacci::unit_sphere(self.vertices).unwrap();
        let record = TilingRecord {
            facets: mesh.facets.clone(),
            ellipsoid_axes_m: [600.0, 500.0, 400.0],
            frame_rotation: IDENTITY,
        };
        let reach = positions.iter().map(|p| p[0].hypot(p[1]).hypot(p[2])).fold(0.0, f64::max) + RADIUS_M;
        let sphere: Vec<[f64; 3]> = mesh.vertices.iter().map(|v| v.map(|c| c * reach)).collect();
        let mut vertices = sphere.clone();
        let mut ids: Vec<u32> = (0..positions.len() as u32).collect();
        let rigid: Vec<RigidRecord> =
            (0..200).map(|i| RigidRecord { t_s: f64::from(i) * 1e4 * YEAR_S, omega: 3e-4, obliquity: 0.1 }).collect();
        (state.stage, state.configuration) = (Stage::Evolving, Some(0));
        let object_0 = configuration(0, &ids, &positions, &vertices);
        store.save_object_0(&record, &object_0, &rigid, &state, &ledger).unwrap();
        if self.until == Until::Object0 {
            return;
        }
        for number in 1..self.configurations {
            let leg = leg(number, self.moved * ids.len() as f64);
            let mut movements = Vec::new();
            for (row, id) in ids.iter().enumerate() {
                if numbers.next() < self.moved {
                    let shift: [f64; 3] = std::array::from_fn(|_| 40.0 * (numbers.next() - 0.5));
                    positions[row] = std::array::from_fn(|k| home[row][k] + shift[k]);
                    let displacement_m = shift.iter().map(|s| s * s).sum::<f64>().sqrt();
                    let enclosed_mass_fraction = (row + 1) as f64 / ids.len() as f64;
                    movements.push(MovementRecord { sphere: *id, displacement_m, enclosed_mass_fraction });
                }
            }
            for (vertex, at) in vertices.iter_mut().zip(&sphere) {
                if numbers.next() < self.moved {
                    let factor = 0.95 + 0.1 * numbers.next();
                    *vertex = at.map(|c| c * factor);
                }
            }
            let mut shedding = Shedding::default();
            if number % 10 == 5 {
                positions.pop();
                for column in state.spheres.columns_mut() {
                    column.pop();
                }
                let sphere = ids.pop().unwrap();
                shedding = shed(sphere, &leg);
            }
            state.sphere_ids.clone_from(&ids);
            (state.leg, state.configuration) = (number, Some(number));
            (state.t_s, state.omega, state.obliquity) = (leg.t_s[1], leg.omega_after, leg.obliquity[1]);
            let shape = configuration(number, &ids, &positions, &vertices);
            ledger.time(Part::Movement, || ());
            let commit =
                LegCommit { leg: &leg, state: &state, configuration: Some((&shape, &movements)), shedding: &shedding };
            store.save_leg(&commit, &ledger).unwrap();
        }
        if self.until == Until::End {
            let (t_s, omega, obliquity) = (state.t_s, state.omega, state.obliquity);
            store.save_ending(&Ending { t_s, omega, obliquity, outcome: Outcome::EndTime }, &ledger).unwrap();
        }
    }
}

const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The lattice points nearest to the centre, in a flattened measure.
fn lattice(count: usize) -> Vec<[f64; 3]> {
    let side = (count as f64).cbrt().ceil() as i32 + 1;
    let axis = || -side..=side;
    let mut all: Vec<[f64; 3]> = axis()
        .flat_map(|x| axis().flat_map(move |y| axis().map(move |z| [x, y, z])))
        .map(|p| p.map(|c| f64::from(c) * 2.0 * RADIUS_M))
        .collect();
    let measure = |p: &[f64; 3]| p[0].powi(2) + (p[1] / 0.8).powi(2) + (p[2] / 0.6).powi(2);
    all.sort_by(|a, b| measure(a).total_cmp(&measure(b)));
    all.truncate(count);
    all
}

fn state(positions: &[[f64; 3]]) -> State {
    let mut spheres = pkd::Spheres::default();
    positions.iter().for_each(|p| spheres.push(*p, [0.0; 3], [0.0; 3], MASS_KG, RADIUS_M));
    State {
        stage: Stage::Built,
        outcome: None,
        blocks: 0,
        leg: 0,
        configuration: None,
        refinement: 0,
        t_s: 0.0,
        omega: 3e-4,
        obliquity: 0.1,
        spheres,
        sphere_ids: (0..positions.len() as u32).collect(),
        normal_stiffness_n_m: None,
        contacts: pkd::soft_sphere::ContactHistory::default(),
        rest: None,
    }
}

fn dynamics() -> DynamicsRecord {
    DynamicsRecord { rotations: 5.0, collisions: 1000, momentum_drift: 1e-15, ..DynamicsRecord::default() }
}

fn settling() -> SettlingRecord {
    SettlingRecord {
        block: 0,
        period_s: 20_000.0,
        moved: 0,
        max_displacement_radii: 0.05,
        b_over_a: 0.8,
        c_over_a: 0.6,
        dynamics: dynamics(),
        angular_momentum: 4.8e13,
        non_axial: 1e-3,
        shed: 0,
    }
}

fn configuration(number: u32, ids: &[u32], positions: &[[f64; 3]], vertices: &[[f64; 3]]) -> ConfigurationRecord {
    let obliquity: Vec<f64> = (0..37).map(|i| f64::from(i) * std::f64::consts::PI / 36.0).collect();
    let n = f64::from(number);
    let curve = |phase: f64| obliquity.iter().map(|e| (2.0 * e + phase + 0.01 * n).cos()).collect();
    // Turned a little more each time about the spin axis.
    let (sin, cos) = (0.01 * n).sin_cos();
    ConfigurationRecord {
        configuration: number,
        after_leg: number.checked_sub(1),
        t_s: n * 5e4 * YEAR_S,
        mass_kg: MASS_KG * ids.len() as f64,
        sphere_ids: ids.to_vec(),
        positions: positions.to_vec(),
        body_axes: [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]],
        centre_of_mass: [0.1, 0.2, 0.3],
        moments_kg_m2: [1.0e17, 1.3e17, 1.6e17],
        b1_axes_m: [600.0, 500.0 - 0.1 * n, 400.0],
        b2_axes_m: [620.0, 510.0, 410.0],
        densities_kg_m3: [2000.0, 1800.0, 1700.0, 1900.0],
        vertices: vertices.to_vec(),
        vertices_kept: 0,
        vertices_flagged: 0,
        facets_folded: 0,
        torque: TorqueRecord {
            spin_torque: curve(0.0),
            obliquity_torque: curve(1.5),
            obliquity,
            spin_rate: vec![0.0],
            spin_torque_error: 1e-3,
            obliquity_torque_error: 2e-3,
        },
    }
}

/// The leg that ends in configuration `number`.
fn leg(number: u32, moved: f64) -> LegRecord {
    let n = f64::from(number);
    let omega = |n: f64| 3e-4 * (1.0 + 0.2 * (0.3 * n).sin());
    LegRecord {
        leg: number - 1,
        configuration: number - 1,
        t_s: [(n - 1.0) * 5e4 * YEAR_S, n * 5e4 * YEAR_S],
        omega: [omega(n - 1.0), omega(n)],
        obliquity: [0.1 + 0.01 * (n - 1.0), 0.1 + 0.01 * n],
        reason: "spin_change".into(),
        refinement: 0,
        rk4_steps: 50,
        spin_error: 1e-12,
        obliquity_error: 1e-12,
        result: "movement".into(),
        omega_after: omega(n),
        dynamics: dynamics(),
        moved: [moved as u32; 3],
        settled: true,
        non_axial: 1e-3,
        angular_momentum: AngularMomentumRecord {
            start: 1.6e17 * omega(n - 1.0),
            torque: 1.6e17 * (omega(n) - omega(n - 1.0)),
            shed: 0.0,
            end: 1.6e17 * omega(n),
            over_spin: 1.0,
        },
        shed: u32::from(number % 10 == 5),
    }
}

fn shed(sphere: u32, leg: &LegRecord) -> Shedding {
    let [t_s, omega] = [leg.t_s[1], leg.omega[1]];
    let (position, velocity) = ([700.0, 100.0, 30.0], [0.05, 0.35, 0.01]);
    let loss = LossRecord { sphere, t_s, omega, position, velocity, spin: [0.0; 3], energy_j: 1e6 };
    let fate = FateRecord {
        sphere,
        fate: TRACKED.into(),
        t_s: 86_400.0,
        speed_m_s: Some(0.1),
        position: None,
        orbit: None,
        within_3_radii: None,
        into: None,
        returned: false,
        angular_momentum: Some([0.0; 3]),
    };
    Shedding { losses: vec![loss], fates: vec![fate], ..Shedding::default() }
}
