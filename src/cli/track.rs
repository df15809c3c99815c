//! `yorp track AGGREGATE`: follows shed spheres, or the other half of a fission, around an aggregate.

use std::path::{Path, PathBuf};
use std::time::Instant;

use pkd::Spheres;
use pkd::mass_properties::mass_properties;
use serde_json::{Value, json};

use super::{CliError, arguments as value, output};
use crate::exchange::csv::CsvFault;
use crate::exchange::{AggregateFileError, read_aggregate};
use crate::shed::*;

/// Arguments of `yorp track`.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true, group = clap::ArgGroup::new("others").required(true))]
pub(super) struct Arguments {
    /// The primary (CSV): turns rigidly about z with the mean spin of its velocities
    aggregate: PathBuf,
    /// Shed spheres (CSV, same frame): each is followed as a sphere of its own
    #[arg(long, value_name = "FILE", group = "others")]
    shed: Option<PathBuf>,
    /// Another aggregate (CSV, same frame): both are followed as rigid bodies about their own axes
    #[arg(long, value_name = "FILE", group = "others")]
    companion: Option<PathBuf>,
    /// Follow for at most this long, days
    #[arg(long, value_name = "T", default_value_t = 365.0, value_parser = value::positive)]
    t_max_days: f64,
    /// Semimajor axis of the heliocentric orbit, au: sets the Hill sphere
    #[arg(long, value_name = "A", default_value_t = 1.0, value_parser = value::semimajor_axis_au)]
    orbit_au: f64,
    /// Tolerance of the integrator (IAS15)
    #[arg(long, value_name = "EPS", default_value_t = 1e-9, value_parser = value::ias15_tolerance)]
    ias15_tolerance: f64,
    /// Largest relative error of the attraction where multipoles stand for the primary's spheres
    #[arg(long, value_name = "E", default_value_t = 1e-8, value_parser = value::multipole_error)]
    multipole_error: f64,
    /// Let the Sun's tide act
    #[arg(long, requires = "shed")]
    solar_tide: bool,
    /// Let sunlight push with this coefficient C_R (1: black, 13/9: white Lambert sphere)
    #[arg(long, value_name = "C_R", requires = "shed", value_parser = value::radiation_pressure_coefficient)]
    radiation_pressure: Option<f64>,
    /// Obliquity of the primary, deg: where the Sun goes, if it acts
    #[arg(long, value_name = "EPS", default_value_t = 0.0, value_parser = value::obliquity_deg)]
    obliquity_deg: f64,
}

/// A spin axis farther than this from z is told, deg.
const TILTED_DEG: f64 = 1.0;

pub(super) fn run(arguments: &Arguments, as_json: bool) -> Result<(), CliError> {
    let watch = Instant::now();
    let primary = read_aggregate(&arguments.aggregate)?;
    let acts = arguments.solar_tide || arguments.radiation_pressure.is_some();
    let options = TrackOptions {
        t_max_s: arguments.t_max_days * 86_400.0,
        semimajor_axis_au: arguments.orbit_au,
        ias15_tolerance: arguments.ias15_tolerance,
        multipole_error: arguments.multipole_error,
        sun: acts.then_some(Sun {
            obliquity: arguments.obliquity_deg.to_radians(),
            tide: arguments.solar_tide,
            radiation_pressure_coefficient: arguments.radiation_pressure,
        }),
    };
    if let Some(file) = &arguments.companion {
        let track = follow_pair(&primary, &read_aggregate(file)?, &options)?;
        let seconds = watch.elapsed().as_secs_f64();
        return if as_json { output::json(&pair_value(&track, seconds)) } else { output::text(&pair_text(&track)) };
    }
    // clap asks for one of the two.
    let shed = arguments.shed.as_deref().map_or_else(|| Ok(Spheres::default()), read_shed)?;
    let (primary, shed) = about_the_primary(primary, &shed)?;
    let tracks = follow(&primary, &shed, &options)?;
    let seconds = watch.elapsed().as_secs_f64();
    if as_json { output::json(&as_value(&tracks, seconds)) } else { output::text(&as_text(&tracks)) }
}

/// Shed spheres; a file with a header alone is an empty list.
fn read_shed(file: &Path) -> Result<Spheres, CliError> {
    match read_aggregate(file) {
        Err(AggregateFileError::Csv { source: CsvFault::NoSphere, .. }) => Ok(Spheres::default()),
        other => Ok(other?),
    }
}

/// The primary with its mean spin, and the shed spheres relative to its centre of mass.
fn about_the_primary(spheres: Spheres, shed: &Spheres) -> Result<(Primary, Vec<ShedBody>), CliError> {
    let properties = mass_properties(&spheres).map_err(CliError::input)?;
    let omega = properties.angular_velocity();
    if omega.norm() == 0.0 {
        eprintln!(
            "warning: the aggregate does not rotate: its velocities and spins carry no angular momentum (columns vx_m_s to wz_rad_s)"
        );
    }
    let tilt_deg = omega.xy().norm().atan2(omega.z.abs()).to_degrees();
    if tilt_deg > TILTED_DEG {
        eprintln!(
            "warning: the aggregate turns about an axis {tilt_deg:.1} deg from z; it is followed about z, and what lies across z is \
             left out"
        );
    }
    let body = |i: usize| ShedBody {
        position: (nalgebra::Vector3::from(shed.position(i)) - properties.centre).into(),
        velocity: (nalgebra::Vector3::from(shed.velocity(i)) - properties.velocity).into(),
        spin: shed.spin(i),
        mass: shed.mass[i],
        radius: shed.radius[i],
    };
    Ok((Primary { spheres, spin_rate: omega.z }, (0..shed.len()).map(body).collect()))
}

fn as_value(tracks: &Tracks, seconds: f64) -> Value {
    let fate = |(fate, drift): (&Fate, &Option<f64>)| {
        let mut value = fate_value(fate);
        value["jacobi_drift"] = json!(drift);
        value
    };
    let fates: Vec<Value> = tracks.fates.iter().zip(&tracks.jacobi_drift).map(fate).collect();
    let share =
        |s: &Share| json!({"bodies": s.bodies, "mass_kg": s.mass_kg, "angular_momentum_kg_m2_s": s.angular_momentum});
    let budget = &tracks.budget;
    json!({
        "fates": fates,
        "budget": {
            "shed": share(&budget.shed),
            "reimpact": share(&budget.reimpact),
            "escape": share(&budget.escape),
            "bound": share(&budget.bound),
            "torque_on_primary_kg_m2_s": budget.torque_on_primary,
        },
        "steps": tracks.steps,
        "unconverged_steps": tracks.unconverged_steps,
        "mascon_evaluations": tracks.evaluations.mascons,
        "multipole_evaluations": tracks.evaluations.multipoles,
        "multipole_switch_radius_m": tracks.multipole_switch_radius_m,
        "seconds": seconds,
    })
}

fn fate_value(fate: &Fate) -> Value {
    let mut value = match fate {
        Fate::Reimpact { t_s, speed_m_s, position_m, velocity_m_s, sphere } => json!({
            "t_s": t_s, "speed_m_s": speed_m_s, "position_m": position_m, "velocity_m_s": velocity_m_s, "sphere": sphere
        }),
        Fate::Escape { t_s, speed_m_s } => json!({"t_s": t_s, "speed_m_s": speed_m_s}),
        Fate::Bound { t_s, mean, within_3_radii } => json!({
            "t_s": t_s, "mean": mean.as_ref().map(elements_value), "within_3_radii": within_3_radii
        }),
        Fate::Merged { t_s, speed_m_s, into } => json!({"t_s": t_s, "speed_m_s": speed_m_s, "into": into}),
    };
    value["fate"] = json!(fate.name());
    value
}

fn elements_value(elements: &Elements) -> Value {
    json!({
        "semimajor_axis_m": elements.semimajor_axis_m,
        "eccentricity": elements.eccentricity,
        "inclination_deg": elements.inclination.to_degrees(),
    })
}

fn as_text(tracks: &Tracks) -> String {
    let mut text = String::new();
    for (k, fate) in tracks.fates.iter().enumerate() {
        text.push_str(&format!("{k:>6}  {}\n", fate_text(fate)));
    }
    let b = &tracks.budget;
    text.push_str(&format!(
        "{} shed: {} fell back, {} escaped, {} stayed ({:.3e}, {:.3e}, {:.3e} kg)\n",
        b.shed.bodies,
        b.reimpact.bodies,
        b.escape.bodies,
        b.bound.bodies,
        b.reimpact.mass_kg,
        b.escape.mass_kg,
        b.bound.mass_kg
    ));
    let worst = tracks.jacobi_drift.iter().flatten().fold(0.0f64, |a, b| a.max(*b));
    text.push_str(&format!("largest change of a Jacobi constant: {worst:.1e} of GM / r\n"));
    text
}

fn fate_text(fate: &Fate) -> String {
    let days = |t_s: &f64| t_s / 86_400.0;
    match fate {
        Fate::Reimpact { t_s, speed_m_s, sphere, .. } => {
            format!("fell back after {:.3} d at {speed_m_s:.4} m/s onto sphere {sphere}", days(t_s))
        }
        Fate::Escape { t_s, speed_m_s } => format!("escaped after {:.3} d, {speed_m_s:.4} m/s at infinity", days(t_s)),
        Fate::Merged { t_s, speed_m_s, into } => {
            format!("merged with {into} after {:.3} d at {speed_m_s:.4} m/s", days(t_s))
        }
        Fate::Bound { t_s, mean, within_3_radii } => {
            let percent = 100.0 * within_3_radii;
            let orbit = mean.as_ref().map_or(String::new(), |mean| format!(", {}", orbit_text(mean)));
            format!("in orbit after {:.1} d{orbit}, {percent:.0} % of the time within 3 radii", days(t_s))
        }
    }
}

fn orbit_text(mean: &Elements) -> String {
    let Elements { semimajor_axis_m: a, eccentricity: e, inclination } = mean;
    format!("mean a {a:.1} m, e {e:.4}, i {:.2} deg", inclination.to_degrees())
}

fn pair_value(track: &PairTrack, seconds: f64) -> Value {
    let mut value = json!({
        "fate": track.fate.name(),
        "t_s": track.t_s,
        "period_h": track.spin_rate.map(|omega| std::f64::consts::TAU / omega / 3600.0),
        "energy_drift": track.energy_drift,
        "angular_momentum_drift": track.angular_momentum_drift,
        "steps": track.steps,
        "step_s": track.step_s,
        "seconds": seconds,
    });
    match &track.fate {
        PairFate::Collided { speed_m_s } | PairFate::Separated { speed_m_s } => value["speed_m_s"] = json!(speed_m_s),
        PairFate::Bound { mean } => value["mean"] = json!(mean.as_ref().map(elements_value)),
    }
    value
}

fn pair_text(track: &PairTrack) -> String {
    let days = track.t_s / 86_400.0;
    let fate = match &track.fate {
        PairFate::Collided { speed_m_s } => format!("touched again after {days:.3} d at {speed_m_s:.4} m/s"),
        PairFate::Separated { speed_m_s } => format!("parted after {days:.3} d, {speed_m_s:.4} m/s at infinity"),
        PairFate::Bound { mean } => {
            let orbit = mean.as_ref().map_or(String::new(), |mean| format!(", {}", orbit_text(mean)));
            format!("in orbit after {days:.1} d{orbit}")
        }
    };
    let [one, other] = track.spin_rate.map(|omega| match omega {
        0.0 => "none".to_owned(),
        _ => format!("{:.4} h", std::f64::consts::TAU / omega / 3600.0),
    });
    format!(
        "{fate}\nspin periods {one} and {other}; {} steps of {:.1} s, drift: energy {:.1e}, angular momentum {:.1e}\n",
        track.steps, track.step_s, track.energy_drift, track.angular_momentum_drift
    )
}
