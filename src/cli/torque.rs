//! `yorp torque MESH`: spin and obliquity torque of a shape model at every obliquity.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::time::Instant;

use serde_json::{Map, Value, json};
use taco::{Obliquities, Sampling, TorqueTable};

use super::sunlit_mesh::{MeshBody, SunlitMesh, torque_failed};
use super::{CliError, arguments, output};

/// Arguments of `yorp torque`.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct Arguments {
    /// The shape model, a closed OBJ mesh
    mesh: PathBuf,
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
    #[command(flatten)]
    sunlit: SunlitMesh,
}

/// Prints the torque table of a mesh.
pub(super) fn run(arguments: &Arguments, as_json: bool) -> Result<(), CliError> {
    let start = Instant::now();
    let surface = arguments.sunlit.surface()?;
    let body = arguments.sunlit.body(&arguments.mesh)?;
    let wanted = match &arguments.obliquity_deg {
        Some(list) => list.clone(),
        None => step_sampling(arguments).obliquities_deg().map_err(torque_failed)?,
    };
    let table = taco::torque_table(&body.mesh, &surface, &arguments.sunlit.orbit(), &sampling(arguments));
    let table = table.map_err(torque_failed)?;
    let curve: Vec<Row> = wanted.iter().map(|obliquity_deg| Row::of(&table, *obliquity_deg)).collect();
    if as_json {
        output::json(&as_value(&body, &curve, &table, start.elapsed().as_secs_f64()))
    } else {
        output::text(&as_text(arguments, &body, &curve, &table))
    }
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

fn as_value(body: &MeshBody, curve: &[Row], table: &TorqueTable, seconds: f64) -> Value {
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

fn as_text(arguments: &Arguments, body: &MeshBody, curve: &[Row], table: &TorqueTable) -> String {
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
        arguments.sunlit.density_kg_m3,
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
