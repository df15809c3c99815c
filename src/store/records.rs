//! The rows of a run database as plain data; columns are described in `schema.sql`.

use std::borrow::Cow;

use pkd::Spheres;
use pkd::soft_sphere::ContactHistory;

/// How far a run has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// The aggregate exists and has not settled yet.
    Built,
    /// The aggregate is at rest in its rotating frame.
    Settled,
    /// Object 0 and its torques exist; legs follow.
    Evolving,
    /// Nothing can follow: see [`State::outcome`].
    Finished,
}

impl Stage {
    /// Name in the database.
    pub fn name(self) -> &'static str {
        match self {
            Self::Built => "built",
            Self::Settled => "settled",
            Self::Evolving => "evolving",
            Self::Finished => "finished",
        }
    }

    /// The stage of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Built, Self::Settled, Self::Evolving, Self::Finished].into_iter().find(|s| s.name() == name)
    }
}

/// How a run, or the part of it that was asked for, ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// `evolution.duration_myr` was reached.
    EndTime,
    /// `--until-myr` was reached.
    Until,
    /// The period grew beyond `evolution.stop_period_h`, or the spin reached the end of its YORP cycle.
    SpunDown,
    /// A piece of at least a tenth of the mass separated.
    Fission,
    /// The largest piece holds less than half of the mass.
    Disrupted,
}

impl Outcome {
    /// Name in the database and in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::EndTime => "end_time",
            Self::Until => "until",
            Self::SpunDown => "spun_down",
            Self::Fission => "fission",
            Self::Disrupted => "disrupted",
        }
    }

    /// The outcome of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::EndTime, Self::Until, Self::SpunDown, Self::Fission, Self::Disrupted]
            .into_iter()
            .find(|o| o.name() == name)
    }
}

/// What the next turn of the loop starts from.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Progress.
    pub stage: Stage,
    /// Set when finished.
    pub outcome: Option<Outcome>,
    /// Settling blocks done.
    pub blocks: u32,
    /// Legs done.
    pub leg: u32,
    /// Present configuration; `None` before object 0.
    pub configuration: Option<u32>,
    /// How often the spin increment has been cut to a fifth.
    pub refinement: u32,
    /// Evolution time, s.
    pub t_s: f64,
    /// Spin rate, rad/s.
    pub omega: f64,
    /// Obliquity, rad.
    pub obliquity: f64,
    /// The aggregate, inertial frame.
    pub spheres: Spheres,
    /// Row of each sphere in table `sphere`, ascending.
    pub sphere_ids: Vec<u32>,
    /// Where the aggregate was last seen at rest: x, y and z of all spheres, m, axes of no meaning; `None` before object 0,
    /// and where no question needs it.
    pub rest: Option<[Vec<f64>; 3]>,
    /// Normal stiffness of soft contacts, N/m, found at the start of the run; `None` for hard spheres.
    pub normal_stiffness_n_m: Option<f64>,
    /// What soft contacts remember.
    pub contacts: ContactHistory,
}

/// Work and conservation counters of a stretch of dynamics.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DynamicsRecord {
    /// Rotations done.
    pub rotations: f64,
    /// Collisions resolved.
    pub collisions: u64,
    /// Of these, by the slide rule.
    pub slide_rule: u64,
    /// Of these, by the collapse rule.
    pub collapse_rule: u64,
    /// Of these, beyond the cap per sphere and step.
    pub capped: u64,
    /// Deepest overlap seen, in radii of the smaller sphere.
    pub max_overlap_radii: f64,
    /// Change of the linear momentum over the sum of m|v|.
    pub momentum_drift: f64,
    /// Relative change of the angular momentum.
    pub angular_momentum_drift: f64,
}

impl DynamicsRecord {
    /// Adds the work of a later stretch; drifts and overlaps keep their largest value.
    pub fn add(&mut self, later: &Self) {
        self.rotations += later.rotations;
        self.collisions += later.collisions;
        self.slide_rule += later.slide_rule;
        self.collapse_rule += later.collapse_rule;
        self.capped += later.capped;
        self.max_overlap_radii = self.max_overlap_radii.max(later.max_overlap_radii);
        self.momentum_drift = self.momentum_drift.max(later.momentum_drift);
        self.angular_momentum_drift = self.angular_momentum_drift.max(later.angular_momentum_drift);
    }
}

/// One block of settling.
#[derive(Debug, Clone, PartialEq)]
pub struct SettlingRecord {
    /// Number of the block, from 0.
    pub block: u32,
    /// Rotation period at the block's start, s.
    pub period_s: f64,
    /// Spheres displaced beyond the movement limit in this block.
    pub moved: u32,
    /// Largest displacement in radii.
    pub max_displacement_radii: f64,
    /// B1 axis ratio b/a at the end.
    pub b_over_a: f64,
    /// B1 axis ratio c/a at the end.
    pub c_over_a: f64,
    /// Work counters.
    pub dynamics: DynamicsRecord,
    /// Angular momentum at its end, kg m^2/s.
    pub angular_momentum: f64,
    /// Sine of the angle between it and the axis of largest moment, before the body is aligned.
    pub non_axial: f64,
    /// Spheres removed at the end.
    pub shed: u32,
}

/// What all tilings of a run share.
#[derive(Debug, Clone, PartialEq)]
pub struct TilingRecord {
    /// Vertex indices of the facets.
    pub facets: Vec<[u32; 3]>,
    /// Semi-axes of the original equivalent ellipsoid, m.
    pub ellipsoid_axes_m: [f64; 3],
    /// Rotation from the inertial to the original frame at object 0, rows.
    pub frame_rotation: [[f64; 3]; 3],
}

/// One shape of the body, with its torques.
#[derive(Debug, Clone, PartialEq)]
pub struct ConfigurationRecord {
    /// Number, from 0.
    pub configuration: u32,
    /// Leg whose check produced it; `None` for object 0.
    pub after_leg: Option<u32>,
    /// Time of its birth, s.
    pub t_s: f64,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Spheres it consists of.
    pub sphere_ids: Vec<u32>,
    /// Centres in the original frame, m; spheres that did not move keep their earlier values exactly.
    pub positions: Vec<[f64; 3]>,
    /// Rotation from the original to the body frame, rows.
    pub body_axes: [[f64; 3]; 3],
    /// Centre of mass in the original frame, m.
    pub centre_of_mass: [f64; 3],
    /// Principal moments A <= B <= C, kg m^2.
    pub moments_kg_m2: [f64; 3],
    /// Axes of the dynamically equivalent ellipsoid, m.
    pub b1_axes_m: [f64; 3],
    /// Half extents, m.
    pub b2_axes_m: [f64; 3],
    /// Densities by the definitions B1 to B4, kg/m^3.
    pub densities_kg_m3: [f64; 4],
    /// Tiling vertices in the original frame, m.
    pub vertices: Vec<[f64; 3]>,
    /// Vertices equal to the previous configuration's.
    pub vertices_kept: u32,
    /// Vertices that needed the fallback direction.
    pub vertices_flagged: u32,
    /// Facets turned over with respect to the ellipsoid's.
    pub facets_folded: u32,
    /// Torques.
    pub torque: TorqueRecord,
}

/// A torque table with its error estimate.
#[derive(Debug, Clone, PartialEq)]
pub struct TorqueRecord {
    /// Obliquity nodes, rad.
    pub obliquity: Vec<f64>,
    /// Spin-rate nodes, rad/s.
    pub spin_rate: Vec<f64>,
    /// Spin torque at (spin rate, obliquity), row-major, N m.
    pub spin_torque: Vec<f64>,
    /// Obliquity torque likewise, N m.
    pub obliquity_torque: Vec<f64>,
    /// Error estimate of the spin torque, N m.
    pub spin_torque_error: f64,
    /// Error estimate of the obliquity torque, N m.
    pub obliquity_torque_error: f64,
}

/// The angular momentum of the body through one leg, kg m^2/s: sizes of the vector and what changed them.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AngularMomentumRecord {
    /// Of the spheres before the leg.
    pub start: f64,
    /// What sunlight gave along it: C of the configuration times the change of the spin rate.
    pub torque: f64,
    /// What shed mass changed, by the books of what left, pulled and came back.
    pub shed: f64,
    /// Of the spheres after the leg.
    pub end: f64,
    /// `end` over C omega of the state that the next leg starts from: 1 where the body turns with what it carries.
    pub over_spin: f64,
}

impl AngularMomentumRecord {
    /// What the end is off by, over the larger of start and end.
    pub fn error(&self) -> f64 {
        let scale = self.start.max(self.end);
        if scale > 0.0 { (self.end - self.start - self.torque - self.shed).abs() / scale } else { 0.0 }
    }
}

/// The body as it was made, before it settled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BuiltRecord {
    /// B1 axis ratio b/a.
    pub b_over_a: f64,
    /// B1 axis ratio c/a.
    pub c_over_a: f64,
    /// Mass over the volume of the B1 ellipsoid, kg/m^3.
    pub density_kg_m3: f64,
    /// Rotation period, s.
    pub period_s: f64,
}

/// One pass through the loop.
#[derive(Debug, Clone, PartialEq)]
pub struct LegRecord {
    /// Number, from 0.
    pub leg: u32,
    /// Configuration whose torques drove it.
    pub configuration: u32,
    /// Start and end, s.
    pub t_s: [f64; 2],
    /// Spin rate at start and end, rad/s.
    pub omega: [f64; 2],
    /// Obliquity at start and end, rad.
    pub obliquity: [f64; 2],
    /// Why it ended.
    pub reason: Cow<'static, str>,
    /// How often the spin increment had been cut to a fifth.
    pub refinement: u32,
    /// Steps of the spin integrator.
    pub rk4_steps: u64,
    /// Step-doubling error of the spin rate, relative.
    pub spin_error: f64,
    /// Step-doubling error of the obliquity, rad.
    pub obliquity_error: f64,
    /// Whether and how the body answered.
    pub result: Cow<'static, str>,
    /// Spin rate that the next leg starts from, rad/s.
    pub omega_after: f64,
    /// Work counters of the check.
    pub dynamics: DynamicsRecord,
    /// Spheres moved by the scene's rule, by the robust rule, by the literal rule.
    pub moved: [u32; 3],
    /// Whether the body was at rest at the end.
    pub settled: bool,
    /// Sine of the angle between the angular momentum and the axis of largest moment after the check, before the body is
    /// aligned.
    pub non_axial: f64,
    /// The angular momentum through the leg.
    pub angular_momentum: AngularMomentumRecord,
    /// Spheres removed.
    pub shed: u32,
}

/// One sphere's part in a movement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovementRecord {
    /// Sphere.
    pub sphere: u32,
    /// Displacement after the rigid motion is taken out, m.
    pub displacement_m: f64,
    /// Rank by effective potential before the movement, over N.
    pub enclosed_mass_fraction: f64,
}

/// One sphere that left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LossRecord {
    /// Sphere.
    pub sphere: u32,
    /// Evolution time, s.
    pub t_s: f64,
    /// Spin rate of the body, rad/s.
    pub omega: f64,
    /// Position relative to the body's centre of mass, inertial axes, m.
    pub position: [f64; 3],
    /// Velocity likewise, m/s.
    pub velocity: [f64; 3],
    /// Its own spin, rad/s.
    pub spin: [f64; 3],
    /// Two-body energy of its cluster relative to the main body, J.
    pub energy_j: f64,
}

/// What became of a sphere that left; vectors in the inertial axes in which it left.
#[derive(Debug, Clone, PartialEq)]
pub struct FateRecord {
    /// Sphere.
    pub sphere: u32,
    /// Name of the fate.
    pub fate: Cow<'static, str>,
    /// When, s after it left.
    pub t_s: f64,
    /// Speed at contact or at infinity, m/s.
    pub speed_m_s: Option<f64>,
    /// Where it struck the body, turned back to where that place was when it left, m.
    pub position: Option<[f64; 3]>,
    /// Mean semimajor axis (m), eccentricity and inclination (rad) of what stayed in orbit.
    pub orbit: Option<[f64; 3]>,
    /// Share of the time within 3 radii of the body of what stayed in orbit.
    pub within_3_radii: Option<f64>,
    /// Sphere that it merged with.
    pub into: Option<u32>,
    /// Whether it went back to the body and is no loss.
    pub returned: bool,
    /// What it took away from the body, kg m^2/s; `None` for those that came back, and for merged ones, whose survivor has it.
    pub angular_momentum: Option<[f64; 3]>,
}

/// How the two pieces of a fission went on.
#[derive(Debug, Clone, PartialEq)]
pub struct FissionRecord {
    /// Masses of the body and of the piece that left, kg.
    pub mass_kg: [f64; 2],
    /// Spheres of the piece that left.
    pub spheres: Vec<u32>,
    /// Name of the fate.
    pub fate: Cow<'static, str>,
    /// When, s after they parted.
    pub t_s: f64,
    /// Speed at contact or at infinity, m/s.
    pub speed_m_s: Option<f64>,
    /// Mean semimajor axis (m), eccentricity and inclination (rad) of what stayed in orbit.
    pub orbit: Option<[f64; 3]>,
    /// Spin rates of both at the end, rad/s.
    pub spin_rate: [f64; 2],
}

/// All that left in one leg, or in one block of settling.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Shedding {
    /// What is gone from the body.
    pub losses: Vec<LossRecord>,
    /// What became of it; empty if the scene does not ask for it.
    pub fates: Vec<FateRecord>,
    /// Likewise of the two pieces of a fission.
    pub fission: Option<FissionRecord>,
    /// Change of the body's angular momentum about its centre of mass by all of this, kg m^2/s, inertial axes.
    pub angular_momentum_change: nalgebra::Vector3<f64>,
}

/// A sample of the rigid reference curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidRecord {
    /// Time, s.
    pub t_s: f64,
    /// Spin rate, rad/s.
    pub omega: f64,
    /// Obliquity, rad.
    pub obliquity: f64,
}

/// Where a run, or the part of it that was asked for, ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ending {
    /// Time, s.
    pub t_s: f64,
    /// Spin rate, rad/s.
    pub omega: f64,
    /// Obliquity, rad.
    pub obliquity: f64,
    /// How.
    pub outcome: Outcome,
}

/// The time between two movements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IntervalRecord {
    /// Number, from 1.
    pub interval: u32,
    /// Configuration whose torques drove it.
    pub configuration: u32,
    /// Legs it is made of.
    pub legs: u32,
    /// Start and end, s.
    pub t_s: [f64; 2],
    /// Spin rate at start and end, rad/s.
    pub omega: [f64; 2],
    /// Obliquity at start and end, rad.
    pub obliquity: [f64; 2],
}

/// One start of the program on a run.
#[derive(Debug, Clone, PartialEq)]
pub struct SessionRecord {
    /// When, seconds since 1970.
    pub started_unix_s: i64,
    /// Name of the machine.
    pub host: String,
    /// Worker threads.
    pub threads: u32,
    /// Version of the build.
    pub version: String,
    /// Name of the processor and level of vector instructions.
    pub processor: String,
    /// Wall time to its last transaction, s.
    pub seconds: f64,
    /// CPU time likewise, s.
    pub cpu_seconds: f64,
}
