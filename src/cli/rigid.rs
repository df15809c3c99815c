//! `yorp rigid`: the YORP cycle of a body, were it rigid.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use serde_json::json;
use taco::{Interpolation, SpinRates, TorqueInterpolant};

use super::progress::{Leaves, Reporter};
use super::sunlit_mesh::{SunlitMesh, torque_failed};
use super::{CliError, arguments as value, output};
use crate::evolve::build::build;
use crate::evolve::configuration::{Original, object_0};
use crate::evolve::driver::MYR_S;
use crate::evolve::rigid::{REV_PER_DAY, RigidCycle, RigidEnd, TOLERANCE, TorqueErrors, rigid_cycle, sphere_limit};
use crate::evolve::settling::begin;
use crate::evolve::spin::{Integrator, SpinState, YEAR_S};
use crate::exchange::{check_table_name, write_table};
use crate::scene::SceneFile;
use crate::store::Ledger;

/// Arguments of `yorp rigid`.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct Arguments {
    /// A shape model (OBJ, PLY, STL, OFF or plate table), or a scene (JSON), whose body is built and settled first
    body: PathBuf,
    /// Initial rotation period, h [default: 6, or the scene's]
    #[arg(long, value_name = "P", value_parser = value::period_h)]
    period_h: Option<f64>,
    /// Initial obliquity, deg [default: 5, or the scene's]
    #[arg(long, value_name = "EPS", value_parser = value::obliquity_deg)]
    obliquity_deg: Option<f64>,
    /// Follow the body for at most this long, Myr
    #[arg(long, value_name = "T", default_value_t = 30.0, value_parser = value::positive)]
    duration_myr: f64,
    /// Steps of order 5 that keep a tolerance, or steps of order 4 and fixed length [default: adaptive]
    #[arg(long, value_enum)]
    integrator: Option<Method>,
    /// Error allowed to one adaptive step, relative to the spin rate [default: 1e-9]
    #[arg(long, value_name = "TOL", value_parser = value::tolerance)]
    tolerance: Option<f64>,
    /// Step of rk4, yr [default: 1000]
    #[arg(long, value_name = "H", value_parser = value::rk4_step_yr)]
    rk4_step_yr: Option<f64>,
    /// Also write the way there as a table (CSV)
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten, next_help_heading = "For a shape model (a scene has its own)")]
    sunlit: SunlitMesh,
}

/// Period of a shape model, h.
const DEFAULT_PERIOD_H: f64 = 6.0;

/// How the spin is integrated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Method {
    Adaptive,
    Rk4,
}

impl Arguments {
    /// The integrator, once the flags fit together.
    fn integrator(&self) -> Result<Integrator, CliError> {
        let implied = if self.rk4_step_yr.is_some() { Method::Rk4 } else { Method::Adaptive };
        match (self.integrator.unwrap_or(implied), self.tolerance, self.rk4_step_yr) {
            (Method::Adaptive, tolerance, None) => {
                Ok(Integrator::Adaptive { tolerance: tolerance.unwrap_or(TOLERANCE) })
            }
            (Method::Rk4, None, step_yr) => Ok(Integrator::Rk4 { step_s: step_yr.unwrap_or(1000.0) * YEAR_S }),
            (Method::Adaptive, _, Some(step)) => {
                Err(CliError::refused(format!("--rk4-step-yr {step} has a meaning with --integrator rk4 only")))
            }
            (Method::Rk4, Some(tolerance), _) => {
                Err(CliError::refused(format!("--tolerance {tolerance} has a meaning with --integrator adaptive only")))
            }
        }
    }
}

/// A body whose cycle can be followed.
struct Rigid {
    torque: TorqueInterpolant,
    errors: TorqueErrors,
    /// Spin rates of the table behind it, rad/s; one if the torque does not depend on them.
    spin_rates: Vec<f64>,
    inertia_kg_m2: f64,
    /// Mass over the volume of the mesh, or of the convex hull of the spheres, kg/m^3.
    density_kg_m3: f64,
    omega: f64,
    obliquity: f64,
}

pub(super) fn run(arguments: &Arguments, as_json: bool) -> Result<(), CliError> {
    let integrator = arguments.integrator()?;
    arguments.out.as_deref().map_or(Ok(()), check_table_name)?;
    let is_scene = arguments.body.extension().is_some_and(|e| e.eq_ignore_ascii_case("json"));
    let mut rigid = if is_scene { of_scene(&arguments.body)? } else { of_mesh(arguments)? };
    if let Some(period_h) = arguments.period_h {
        rigid.omega = TAU / (period_h * 3600.0);
    }
    if let Some(obliquity_deg) = arguments.obliquity_deg {
        rigid.obliquity = obliquity_deg.to_radians();
    }
    let start = SpinState { t_s: 0.0, omega: rigid.omega, obliquity: rigid.obliquity };
    let duration_s = arguments.duration_myr * MYR_S;
    let cycle = rigid_cycle(&rigid.torque, rigid.errors, rigid.inertia_kg_m2, start, duration_s, integrator)
        .map_err(CliError::numerical)?;
    if let Some(file) = &arguments.out {
        write_table(&columns(&cycle, &rigid.torque), file)?;
    }
    let limits = SpinLimits::of(&rigid, &cycle);
    if as_json {
        output::json(&as_value(&cycle, &limits, integrator))
    } else {
        output::text(&as_text(&cycle, &limits, integrator))
    }
}

/// Spin rates up to which the result stands for a real body; the cycle is followed beyond them.
struct SpinLimits {
    /// Where a sphere of the body's density no longer holds what lies on its equator, rad/s: a pile of rubble would have
    /// changed its shape.
    gravity: f64,
    /// When the spin first rises above that, s; `None` if it does not.
    gravity_s: Option<f64>,
    /// The largest spin rate of the torque table, rad/s, beyond which its torques are taken as constant; `None` if they do
    /// not depend on the spin rate.
    table: Option<f64>,
}

impl SpinLimits {
    fn of(rigid: &Rigid, cycle: &RigidCycle) -> Self {
        let gravity = sphere_limit(rigid.density_kg_m3);
        let table = rigid.spin_rates.last().copied().filter(|_| rigid.spin_rates.len() > 1);
        Self { gravity, gravity_s: cycle.first_above(gravity), table }
    }
}

/// The way of the body, one row a state.
fn columns(cycle: &RigidCycle, torque: &TorqueInterpolant) -> [(&'static str, Vec<f64>); 6] {
    let column = |value: &dyn Fn(&SpinState) -> f64| cycle.states.iter().map(value).collect::<Vec<_>>();
    [
        ("t_myr", column(&|s| s.t_s / MYR_S)),
        ("period_h", column(&|s| TAU / s.omega / 3600.0)),
        ("spin_rev_day", column(&|s| s.omega / REV_PER_DAY)),
        ("obliquity_deg", column(&|s| s.obliquity.to_degrees())),
        ("spin_torque_n_m", column(&|s| torque.at(s.obliquity, s.omega).0)),
        ("obliquity_torque_n_m", column(&|s| torque.at(s.obliquity, s.omega).1)),
    ]
}

fn of_mesh(arguments: &Arguments) -> Result<Rigid, CliError> {
    let surface = arguments.sunlit.surface()?;
    let body = arguments.sunlit.body(&arguments.body)?;
    arguments.sunlit.warn_of_seasons(&surface);
    body.warn_of_period(arguments.period_h.unwrap_or(DEFAULT_PERIOD_H));
    let sampling = arguments.sunlit.sampling(SpinRates::default());
    let table =
        taco::torque_table(&body.mesh, &surface, &arguments.sunlit.orbit(), &sampling).map_err(torque_failed)?;
    Ok(Rigid {
        errors: TorqueErrors { spin: table.error.spin_torque_n_m, obliquity: table.error.obliquity_torque_n_m },
        torque: table.interpolant(Interpolation::Cubic).map_err(torque_failed)?,
        spin_rates: table.omega,
        inertia_kg_m2: body.inertia_kg_m2,
        density_kg_m3: arguments.sunlit.density_kg_m3,
        omega: TAU / (DEFAULT_PERIOD_H * 3600.0),
        obliquity: 5_f64.to_radians(),
    })
}

fn of_scene(path: &Path) -> Result<Rigid, CliError> {
    let file = SceneFile::read(path)?;
    let scene = &file.scene;
    let mut reporter = Reporter::start(Leaves::Nothing)?;
    let built = build(&file, true, &mut reporter)?;
    drop(reporter);
    let original = Original::new(scene, &built.spheres)?;
    let state = begin(scene, built.spheres)?;
    let shape = object_0(scene, &original, &state, &mut Ledger::default())?;
    Ok(Rigid {
        errors: shape.torque_errors(),
        spin_rates: shape.record.torque.spin_rate.clone(),
        inertia_kg_m2: shape.inertia(),
        density_kg_m3: shape.record.densities_kg_m3[2],
        torque: shape.torque,
        omega: state.omega,
        obliquity: state.obliquity,
    })
}

fn end_name(end: RigidEnd) -> &'static str {
    match end {
        RigidEnd::SpunDown => "spun_down",
        RigidEnd::InfiniteSpinUp => "infinite_spin_up",
        RigidEnd::Stalled => "stalled",
        RigidEnd::TimeLimit => "time_limit",
        RigidEnd::NoTorque => "no_torque",
    }
}

/// Revolutions per day and million years in one rad/s^2.
fn rev_day_myr(omega_rate: f64) -> f64 {
    omega_rate / REV_PER_DAY * MYR_S
}

fn as_value(cycle: &RigidCycle, limits: &SpinLimits, integrator: Integrator) -> serde_json::Value {
    // JSON has no infinity: a spin that grows for ever is null, and `end` says so.
    let rev_per_day = |omega: f64| omega.is_finite().then(|| omega / REV_PER_DAY);
    let column = |value: fn(&SpinState) -> f64| cycle.states.iter().map(value).collect::<Vec<_>>();
    json!({
        "end": end_name(cycle.end),
        "max_spin_rev_day": rev_per_day(cycle.max_omega),
        "min_spin_rev_day": rev_per_day(cycle.min_omega),
        "end_spin_rev_day": rev_per_day(cycle.end_omega),
        "end_obliquity_deg": cycle.end_obliquity.to_degrees(),
        "end_spin_rate_change_rev_day_myr": rev_day_myr(cycle.end_omega_rate),
        "attractor_obliquity_deg": cycle.attractor.map(|a| a.obliquity.to_degrees()),
        "attractor_spin_rate_change_rev_day_myr": cycle.attractor.map(|a| rev_day_myr(a.omega_rate)),
        "torque_above_error": {"spin": cycle.above_error[0], "obliquity": cycle.above_error[1]},
        "cycle_time_myr": cycle.cycle_time_s.map(|t| t / MYR_S),
        "t_myr": column(|s| s.t_s / MYR_S),
        "spin_rev_day": column(|s| s.omega / REV_PER_DAY),
        "obliquity_deg": column(|s| s.obliquity.to_degrees()),
        "spin_limit_rev_day": rev_per_day(limits.gravity),
        "spin_limit_myr": limits.gravity_s.map(|t| t / MYR_S),
        "torque_table_to_rev_day": limits.table.and_then(rev_per_day),
        "integrator": match integrator {
            Integrator::Adaptive { tolerance } => json!({"adaptive": {"tolerance": tolerance}}),
            Integrator::Rk4 { step_s } => json!({"rk4": {"step_yr": step_s / YEAR_S}}),
        },
        "steps": cycle.steps,
        "error_estimate": {"spin_rate_relative": cycle.omega_error, "obliquity_deg": cycle.obliquity_error.to_degrees()},
    })
}

fn as_text(cycle: &RigidCycle, limits: &SpinLimits, integrator: Integrator) -> String {
    let spin = |omega: f64| match omega.is_finite() {
        true => format!("{:.3} rev/day", omega / REV_PER_DAY),
        false => "infinite".to_owned(),
    };
    let last = cycle.states.last().expect("the initial state is always there");
    let myr = last.t_s / MYR_S;
    let time = match (cycle.end, cycle.cycle_time_s) {
        (_, Some(t)) => {
            format!("end of the YORP cycle (t_YC) after {:.4} Myr: spins down to {}", t / MYR_S, spin(cycle.end_omega))
        }
        (RigidEnd::InfiniteSpinUp, _) => format!("spins up for ever, followed for {myr:.3} Myr"),
        (RigidEnd::Stalled, _) => format!("stalls after {myr:.3} Myr"),
        (RigidEnd::NoTorque, _) => format!("no YORP torque above its error: spin and obliquity stay for {myr:.3} Myr"),
        _ => format!("on its way after {myr:.3} Myr"),
    };
    let mut limit = match limits.gravity_s {
        Some(t) => format!("passed after {:.3} Myr", t / MYR_S),
        None => "not reached".to_owned(),
    };
    if let Some(table) = limits.table {
        limit += &format!("\ntorques over spin rates up to {}, constant beyond", spin(table));
    }
    let steps = match integrator {
        Integrator::Adaptive { tolerance } => format!("adaptive steps to {tolerance:e}"),
        Integrator::Rk4 { step_s } => format!("Runge-Kutta steps of {} yr", step_s / YEAR_S),
    };
    format!(
        "{time}\nspin: largest {}, smallest {}, in the end {}\nobliquity: {:.2} deg after {myr:.3} Myr{}\n\
         spin limit of a sphere of this density: {}, {limit}\n\
         {} {steps}, error of the spin {:.1e} (relative), of the obliquity {:.1e} deg\n",
        spin(cycle.max_omega),
        spin(cycle.min_omega),
        spin(cycle.end_omega),
        last.obliquity.to_degrees(),
        trend(cycle),
        spin(limits.gravity),
        cycle.steps,
        cycle.omega_error,
        cycle.obliquity_error.to_degrees(),
    )
}

/// Where the axis tends, and what is not known of it.
fn trend(cycle: &RigidCycle) -> String {
    let unknown = match cycle.above_error {
        [true, true] | [false, false] => "",
        [false, true] => "\nno spin torque above its error: the spin stays",
        [true, false] => "\nno obliquity torque above its error: the obliquity stays",
    };
    let Some(attractor) = cycle.attractor else { return String::new() };
    let change = match attractor.omega_rate {
        0.0 => "where the spin torque does not exceed its error".to_owned(),
        rate => format!("where the spin changes by {:.3e} rev/day/Myr", rev_day_myr(rate)),
    };
    format!("; tends to {:.2} deg, {change}{unknown}", attractor.obliquity.to_degrees())
}
