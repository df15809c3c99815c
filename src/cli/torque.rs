//! `yorp torque MESH`: spin and obliquity torque of a shape model at every obliquity.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::time::Instant;

use clap::ValueEnum;
use serde_json::{Map, Value, json};
use taco::{Obliquities, Sampling, TacoError, TorqueTable};
use tiling::Mesh;

use super::arguments::{self, Switch};
use super::{CliError, output};
use crate::exchange::read_mesh;

/// Arguments of `yorp torque`.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct Arguments {
    /// The shape model, a closed OBJ mesh
    mesh: PathBuf,
    /// Unit of its coordinates
    #[arg(long, value_enum, default_value = "m")]
    unit: Unit,
    /// Density of the uniform body
    #[arg(long, value_name = "RHO", default_value_t = 2000.0, value_parser = arguments::positive)]
    density_kg_m3: f64,
    /// Spin about the file's z axis, or about the axis of largest moment
    #[arg(long, value_enum, default_value = "file")]
    axes: Axes,
    /// Semimajor axis of the orbit
    #[arg(long, value_name = "A", default_value_t = 1.0, value_parser = arguments::semimajor_axis_au)]
    orbit_au: f64,
    /// Eccentricity of the orbit
    #[arg(long, value_name = "E", default_value_t = 0.0, value_parser = arguments::eccentricity)]
    eccentricity: f64,
    /// Rotation period; without thermal inertia only the obliquity's rate depends on it
    #[arg(long, value_name = "P", default_value_t = 6.0, value_parser = arguments::positive)]
    period_h: f64,
    /// Obliquities from 0 to 180 in steps of this
    #[arg(long, value_name = "STEP", default_value_t = 5.0, value_parser = arguments::obliquity_step_deg)]
    obliquity_step_deg: f64,
    /// These obliquities only
    #[arg(long, value_name = "A,B,...", value_delimiter = ',', conflicts_with = "obliquity_step_deg",
          value_parser = arguments::obliquity_deg)]
    obliquity_deg: Option<Vec<f64>>,
    /// How the surface scatters; Hapke's is an average S-type
    #[arg(long, value_enum, default_value = "hapke")]
    reflectance: Scattering,
    /// Bond albedo of a Lambert surface [default: 0.1]
    #[arg(long, value_name = "ALBEDO", value_parser = arguments::fraction)]
    bond_albedo: Option<f64>,
    /// Whether one part of the body shades another
    #[arg(long, value_enum, default_value = "on")]
    shadows: Switch,
    /// Whether emitted light that meets another part of the body is taken off the recoil
    #[arg(long, value_enum, default_value = "on")]
    sky_blockage: Switch,
    /// Thermal inertia, J m^-2 K^-1 s^-1/2
    #[arg(long, value_name = "GAMMA", default_value_t = 0.0, value_parser = arguments::thermal_inertia)]
    thermal_inertia: f64,
    /// Thermal emissivity; cancels without thermal inertia
    #[arg(long, value_name = "EPSILON", default_value_t = 0.9, value_parser = arguments::emissivity)]
    emissivity: f64,
    /// Whether light from one part of the body heats another
    #[arg(long, value_enum, default_value = "none")]
    self_heating: SelfHeating,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Unit {
    M,
    Km,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Axes {
    File,
    Principal,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Scattering {
    Lambert,
    Hapke,
    None,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum SelfHeating {
    None,
}

/// A mesh ready for its torques: origin at the centre of mass, spin about +z.
struct Body {
    mesh: Mesh,
    volume_m3: f64,
    inertia_kg_m2: f64,
    radius_m: f64,
}

/// Prints the torque table of a mesh.
pub(super) fn run(arguments: &Arguments, as_json: bool) -> Result<(), CliError> {
    let start = Instant::now();
    // Both have one value so far, which the parser has made sure of.
    let (SelfHeating::None, 0.0) = (arguments.self_heating, arguments.thermal_inertia) else {
        return Err(CliError::refused("heat conduction is not part of this version"));
    };
    let surface = surface(arguments)?;
    let orbit = taco::Orbit { semimajor_axis_au: arguments.orbit_au, eccentricity: arguments.eccentricity };
    let body = body(arguments)?;
    if !(1.0..=1e6).contains(&body.radius_m) {
        let radius = body.radius_m;
        eprintln!("warning: the sphere of equal volume has a radius of {radius:.3e} m; is --unit right?");
    }
    let wanted = match &arguments.obliquity_deg {
        Some(list) => list.clone(),
        None => step_sampling(arguments).obliquities_deg().map_err(failed)?,
    };
    let table = taco::torque_table(&body.mesh, &surface, &orbit, &sampling(arguments)).map_err(failed)?;
    let curve: Vec<Row> = wanted.iter().map(|obliquity_deg| Row::of(&table, *obliquity_deg)).collect();
    if as_json {
        output::json(&as_value(&body, &curve, &table, start.elapsed().as_secs_f64()))
    } else {
        output::text(&as_text(arguments, &body, &curve, &table))
    }
}

fn surface(arguments: &Arguments) -> Result<taco::Surface, CliError> {
    let reflectance = match (arguments.reflectance, arguments.bond_albedo) {
        (Scattering::Lambert, albedo) => taco::Reflectance::Lambert { bond_albedo: albedo.unwrap_or(0.1) },
        (_, Some(albedo)) => {
            let message = format!("--bond-albedo {albedo} has a meaning with --reflectance lambert only");
            return Err(CliError::refused(message));
        }
        (Scattering::Hapke, None) => taco::Reflectance::default(),
        (Scattering::None, None) => taco::Reflectance::None,
    };
    Ok(taco::Surface {
        reflectance,
        emissivity: arguments.emissivity,
        shadows: arguments.shadows.is_on(),
        sky_blockage: arguments.sky_blockage.is_on(),
    })
}

fn body(arguments: &Arguments) -> Result<Body, CliError> {
    let metres = match arguments.unit {
        Unit::M => 1.0,
        Unit::Km => 1000.0,
    };
    let mesh = read_mesh(&arguments.mesh, metres)?;
    let solid = mesh.solid();
    let centred = mesh.translated(solid.centre_of_mass.map(|c| -c));
    let (mesh, moment) = match arguments.axes {
        Axes::File => (centred, solid.inertia[(2, 2)]),
        Axes::Principal => {
            let axes = solid.principal_axes();
            (centred.rotated(&axes.rotation), axes.moments[2])
        }
    };
    let inertia_kg_m2 = moment * arguments.density_kg_m3;
    Ok(Body { mesh, volume_m3: solid.volume, inertia_kg_m2, radius_m: solid.equal_volume_radius() })
}

fn step_sampling(arguments: &Arguments) -> Sampling {
    Sampling { obliquities: Obliquities::StepDeg(arguments.obliquity_step_deg), ..Sampling::default() }
}

/// The table wants a list in ascending order; the user's may have any.
fn sampling(arguments: &Arguments) -> Sampling {
    match &arguments.obliquity_deg {
        None => step_sampling(arguments),
        Some(list) => {
            let mut ascending = list.clone();
            ascending.sort_by(f64::total_cmp);
            ascending.dedup();
            Sampling { obliquities: Obliquities::ListDeg(ascending), ..Sampling::default() }
        }
    }
}

/// Inputs are the user's; a torque that is not finite is ours.
fn failed(error: TacoError) -> CliError {
    match error {
        TacoError::NotFinite { .. } => CliError::numerical(error),
        other => CliError::input(other),
    }
}

struct Row {
    obliquity_deg: f64,
    spin_torque_n_m: f64,
    obliquity_torque_n_m: f64,
}

impl Row {
    /// The node of the table at an obliquity that it was made for.
    fn of(table: &TorqueTable, obliquity_deg: f64) -> Self {
        let distance = |k: &usize| (table.obliquity[*k].to_degrees() - obliquity_deg).abs();
        let nodes = 0..table.obliquity.len();
        let k = nodes.min_by(|i, j| distance(i).total_cmp(&distance(j))).expect("a table has at least one node");
        Self {
            obliquity_deg,
            spin_torque_n_m: table.spin_torque_n_m[0][k],
            obliquity_torque_n_m: table.obliquity_torque_n_m[0][k],
        }
    }
}

fn as_value(body: &Body, curve: &[Row], table: &TorqueTable, seconds: f64) -> Value {
    let column = |value: fn(&Row) -> f64| curve.iter().map(value).collect::<Vec<_>>();
    let parts: Map<String, Value> = table
        .error
        .parts
        .iter()
        .map(|part| {
            let error =
                json!({"spin_torque_n_m": part.spin_torque_n_m, "obliquity_torque_n_m": part.obliquity_torque_n_m});
            (part.name.clone(), error)
        })
        .collect();
    json!({
        "obliquity_deg": column(|row| row.obliquity_deg),
        "spin_torque_n_m": column(|row| row.spin_torque_n_m),
        "obliquity_torque_n_m": column(|row| row.obliquity_torque_n_m),
        "inertia_kg_m2": body.inertia_kg_m2,
        "volume_m3": body.volume_m3,
        "facets": body.mesh.facets.len(),
        "error_estimate": {
            "spin_torque_n_m": table.error.spin_torque_n_m,
            "obliquity_torque_n_m": table.error.obliquity_torque_n_m,
            "parts": parts,
        },
        "seconds": seconds,
    })
}

fn as_text(arguments: &Arguments, body: &Body, curve: &[Row], table: &TorqueTable) -> String {
    let myr_s = 1e6 * 365.25 * 86_400.0;
    let spin_rad_s = std::f64::consts::TAU / (arguments.period_h * 3600.0);
    let mut text = String::new();
    let _ = writeln!(
        text,
        "{} facets ({} see others above their plane), volume {:.6e} m^3, radius of equal volume {:.2} m\nC = {:.6e} kg m^2 at {} kg/m^3, period {} h\n",
        body.mesh.facets.len(),
        table.shaded_facets,
        body.volume_m3,
        body.radius_m,
        body.inertia_kg_m2,
        arguments.density_kg_m3,
        arguments.period_h,
    );
    let _ = writeln!(
        text,
        "{:>10}{:>16}{:>18}{:>18}{:>18}\n{:>10}{:>16}{:>18}{:>18}{:>18}",
        "obliquity",
        "spin torque",
        "obliquity torque",
        "spin rate",
        "obliquity",
        "deg",
        "N m",
        "N m",
        "rev/day/Myr",
        "deg/Myr"
    );
    for row in curve {
        let spin = row.spin_torque_n_m / body.inertia_kg_m2;
        let obliquity = row.obliquity_torque_n_m / (body.inertia_kg_m2 * spin_rad_s);
        let _ = writeln!(
            text,
            "{:>10}{:>16.6e}{:>18.6e}{:>18.4e}{:>18.4e}",
            row.obliquity_deg,
            row.spin_torque_n_m,
            row.obliquity_torque_n_m,
            spin * 86_400.0 / std::f64::consts::TAU * myr_s,
            obliquity.to_degrees() * myr_s,
        );
    }
    let _ = writeln!(text, "\n{:<26}{:>16}{:>18}", "estimated error", "spin torque", "obliquity torque");
    let total = ("all", table.error.spin_torque_n_m, table.error.obliquity_torque_n_m);
    let parts = table.error.parts.iter().map(|p| (p.name.as_str(), p.spin_torque_n_m, p.obliquity_torque_n_m));
    for (name, spin, obliquity) in parts.chain([total]) {
        let _ = writeln!(text, "  {name:<24}{spin:>16.1e}{obliquity:>18.1e}");
    }
    text
}
