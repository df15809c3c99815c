//! `yorp rigid`: the YORP cycle of a body, were it rigid.

use std::path::{Path, PathBuf};

use serde_json::json;
use taco::{Interpolation, Sampling, TorqueInterpolant};

use super::progress::Reporter;
use super::sunlit_mesh::{SunlitMesh, torque_failed};
use super::{CliError, arguments as value, output};
use crate::evolve::build::build;
use crate::evolve::configuration::{Original, object_0};
use crate::evolve::driver::MYR_S;
use crate::evolve::rigid::{REV_PER_DAY, RigidCycle, RigidEnd, rigid_cycle};
use crate::evolve::settling::begin;
use crate::evolve::spin::{SpinState, YEAR_S};
use crate::scene::SceneFile;
use crate::store::Ledger;

/// Arguments of `yorp rigid`.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct Arguments {
    /// A shape model (OBJ), or a scene (JSON), whose body is built and settled first
    body: PathBuf,
    /// Initial rotation period, h [default: 6, or the scene's]
    #[arg(long, value_name = "P", value_parser = value::positive)]
    period_h: Option<f64>,
    /// Initial obliquity, deg [default: 5, or the scene's]
    #[arg(long, value_name = "EPS", value_parser = value::obliquity_deg)]
    obliquity_deg: Option<f64>,
    /// Follow the body for at most this long, Myr
    #[arg(long, value_name = "T", default_value_t = 30.0, value_parser = value::positive)]
    duration_myr: f64,
    /// Runge-Kutta step, yr
    #[arg(long, value_name = "H", default_value_t = 1000.0, value_parser = value::positive)]
    rk4_step_yr: f64,
    #[command(flatten, next_help_heading = "For a shape model (a scene has its own)")]
    sunlit: SunlitMesh,
}

/// A body whose cycle can be followed.
struct Rigid {
    torque: TorqueInterpolant,
    inertia_kg_m2: f64,
    omega: f64,
    obliquity: f64,
}

pub(super) fn run(arguments: &Arguments, as_json: bool) -> Result<(), CliError> {
    let is_scene = arguments.body.extension().is_some_and(|e| e.eq_ignore_ascii_case("json"));
    let mut rigid = if is_scene { of_scene(&arguments.body)? } else { of_mesh(arguments)? };
    if let Some(period_h) = arguments.period_h {
        rigid.omega = std::f64::consts::TAU / (period_h * 3600.0);
    }
    if let Some(obliquity_deg) = arguments.obliquity_deg {
        rigid.obliquity = obliquity_deg.to_radians();
    }
    let start = SpinState { t_s: 0.0, omega: rigid.omega, obliquity: rigid.obliquity };
    let (duration_s, step_s) = (arguments.duration_myr * MYR_S, arguments.rk4_step_yr * YEAR_S);
    let cycle =
        rigid_cycle(&rigid.torque, rigid.inertia_kg_m2, start, duration_s, step_s).map_err(CliError::numerical)?;
    if as_json { output::json(&as_value(&cycle)) } else { output::text(&as_text(&cycle)) }
}

fn of_mesh(arguments: &Arguments) -> Result<Rigid, CliError> {
    let surface = arguments.sunlit.surface()?;
    let body = arguments.sunlit.body(&arguments.body)?;
    let table = taco::torque_table(&body.mesh, &surface, &arguments.sunlit.orbit(), &Sampling::default());
    let torque = table.and_then(|t| t.interpolant(Interpolation::Cubic)).map_err(torque_failed)?;
    let omega = std::f64::consts::TAU / (6.0 * 3600.0);
    Ok(Rigid { torque, inertia_kg_m2: body.inertia_kg_m2, omega, obliquity: 5_f64.to_radians() })
}

fn of_scene(path: &Path) -> Result<Rigid, CliError> {
    let file = SceneFile::read(path)?;
    let scene = &file.scene;
    let mut reporter = Reporter::start()?;
    let built = build(&file, true, &mut reporter)?;
    drop(reporter);
    let original = Original::new(scene, &built.spheres)?;
    let state = begin(scene, built.spheres)?;
    let shape = object_0(scene, &original, &state, &mut Ledger::default())?;
    Ok(Rigid { inertia_kg_m2: shape.inertia(), torque: shape.torque, omega: state.omega, obliquity: state.obliquity })
}

fn end_name(end: RigidEnd) -> &'static str {
    match end {
        RigidEnd::SpunDown => "spun_down",
        RigidEnd::InfiniteSpinUp => "infinite_spin_up",
        RigidEnd::Stalled => "stalled",
        RigidEnd::TimeLimit => "time_limit",
    }
}

fn as_value(cycle: &RigidCycle) -> serde_json::Value {
    // JSON has no infinity: a spin that grows for ever is null, and `end` says so.
    let rev_per_day = |omega: f64| omega.is_finite().then(|| omega / REV_PER_DAY);
    let column = |value: fn(&SpinState) -> f64| cycle.states.iter().map(value).collect::<Vec<_>>();
    json!({
        "end": end_name(cycle.end),
        "max_spin_rev_day": rev_per_day(cycle.max_omega),
        "min_spin_rev_day": rev_per_day(cycle.min_omega),
        "end_spin_rev_day": rev_per_day(cycle.end_omega),
        "end_obliquity_deg": cycle.end_obliquity.to_degrees(),
        "cycle_time_myr": cycle.cycle_time_s.map(|t| t / MYR_S),
        "t_myr": column(|s| s.t_s / MYR_S),
        "spin_rev_day": column(|s| s.omega / REV_PER_DAY),
        "obliquity_deg": column(|s| s.obliquity.to_degrees()),
        "steps": cycle.steps,
        "error_estimate": {"spin_rate_relative": cycle.omega_error, "obliquity_deg": cycle.obliquity_error.to_degrees()},
    })
}

fn as_text(cycle: &RigidCycle) -> String {
    let spin = |omega: f64| match omega.is_finite() {
        true => format!("{:.3} rev/day", omega / REV_PER_DAY),
        false => "infinite".to_owned(),
    };
    let last = cycle.states.last().expect("the initial state is always there");
    let time = match (cycle.end, cycle.cycle_time_s) {
        (_, Some(t)) => format!("spins down to zero after {:.3} Myr", t / MYR_S),
        (RigidEnd::InfiniteSpinUp, _) => "spins up for ever".to_owned(),
        (RigidEnd::Stalled, _) => format!("stalls after {:.3} Myr", last.t_s / MYR_S),
        _ => format!("on its way after {:.3} Myr", last.t_s / MYR_S),
    };
    format!(
        "{time}\nspin: largest {}, smallest {}, in the end {}\nobliquity in the end: {:.2} deg\n\
         {} Runge-Kutta steps, error of the spin {:.1e} (relative), of the obliquity {:.1e} deg\n",
        spin(cycle.max_omega),
        spin(cycle.min_omega),
        spin(cycle.end_omega),
        cycle.end_obliquity.to_degrees(),
        cycle.steps,
        cycle.omega_error,
        cycle.obliquity_error.to_degrees(),
    )
}
