//! `yorp torque MESH`: spin and obliquity torque of a shape model at every obliquity.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::time::Instant;

use serde_json::{Map, Value, json};
use taco::{AU_PER_MYR, Obliquities, Sampling, SpinRates, TorqueTable};

use super::sunlit_mesh::{MeshBody, SunlitMesh, torque_failed};
use super::{CliError, arguments, output};
use crate::exchange::{check_table_name, write_table};

/// Arguments of `yorp torque`.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct Arguments {
    /// The shape model, a closed OBJ mesh
    mesh: PathBuf,
    /// Rotation period; without stored heat only the obliquity's rate depends on it
    #[arg(long, value_name = "P", default_value_t = 6.0, value_parser = arguments::period_h)]
    period_h: f64,
    /// Obliquities from 0 to 180 in steps of this
    #[arg(long, value_name = "STEP", default_value_t = 5.0, value_parser = arguments::obliquity_step_deg)]
    obliquity_step_deg: f64,
    /// These obliquities only
    #[arg(long, value_name = "A,B,...", value_delimiter = ',', conflicts_with = "obliquity_step_deg",
          value_parser = arguments::obliquity_deg)]
    obliquity_deg: Option<Vec<f64>>,
    /// Also write the torques as a table (CSV)
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    sunlit: SunlitMesh,
}

impl Arguments {
    fn spin_rad_s(&self) -> f64 {
        TAU / (self.period_h * 3600.0)
    }

    fn sampling(&self, obliquities: Obliquities) -> Sampling {
        Sampling { obliquities, ..self.sunlit.sampling(SpinRates::ListRadS(vec![self.spin_rad_s()])) }
    }

    /// The obliquities asked for, and the sampling that has them: a table wants ascending ones, the user's may have any
    /// order.
    fn obliquities(&self) -> Result<(Vec<f64>, Sampling), CliError> {
        match &self.obliquity_deg {
            None => {
                let sampling = self.sampling(Obliquities::StepDeg(self.obliquity_step_deg));
                Ok((sampling.obliquities_deg().map_err(torque_failed)?, sampling))
            }
            Some(list) => {
                let mut ascending = list.clone();
                ascending.sort_by(f64::total_cmp);
                ascending.dedup();
                Ok((list.clone(), self.sampling(Obliquities::ListDeg(ascending))))
            }
        }
    }
}

/// Prints the torque table of a mesh.
pub(super) fn run(arguments: &Arguments, as_json: bool) -> Result<(), CliError> {
    let start = Instant::now();
    let surface = arguments.sunlit.surface()?;
    arguments.out.as_deref().map_or(Ok(()), check_table_name)?;
    arguments.out.as_ref().map_or(Ok(()), |file| output::check(file, &[&arguments.mesh]))?;
    let (wanted, sampling) = arguments.obliquities()?;
    let body = arguments.sunlit.body(&arguments.mesh)?;
    arguments.sunlit.warn_of_seasons(&surface);
    let orbit = arguments.sunlit.orbit();
    let table = taco::torque_table(&body.mesh, &surface, &orbit, &sampling).map_err(torque_failed)?;
    let drift = |force: f64| {
        let mass_kg = body.volume_m3 * arguments.sunlit.density_kg_m3;
        orbit.semimajor_axis_drift_m_s(force, mass_kg) * AU_PER_MYR
    };
    let curve: Vec<Row> = wanted.iter().map(|obliquity_deg| Row::of(&table, *obliquity_deg, &drift)).collect();
    if let Some(file) = &arguments.out {
        write_table(&columns(arguments, &curve), file)?;
    }
    if as_json {
        output::json(&as_value(&body, &curve, &table, start.elapsed().as_secs_f64()))
    } else {
        output::text(&as_text(arguments, &body, &curve, &table))
    }
}

struct Row {
    obliquity_deg: f64,
    spin_torque_n_m: f64,
    obliquity_torque_n_m: f64,
    /// Force along the orbital motion, N, and what it does to the semimajor axis, au/Myr; `None` unless heat is stored.
    yarkovsky: Option<(f64, f64)>,
}

impl Row {
    /// The node of the table at an obliquity that it was made for.
    fn of(table: &TorqueTable, obliquity_deg: f64, drift: &dyn Fn(f64) -> f64) -> Self {
        let distance = |k: &usize| (table.obliquity[*k].to_degrees() - obliquity_deg).abs();
        let nodes = 0..table.obliquity.len();
        let k = nodes.min_by(|i, j| distance(i).total_cmp(&distance(j))).expect("a table has at least one node");
        Self {
            obliquity_deg,
            spin_torque_n_m: table.spin_torque_n_m[0][k],
            obliquity_torque_n_m: table.obliquity_torque_n_m[0][k],
            yarkovsky: table.transverse_force_n.first().map(|row| (row[k], drift(row[k]))),
        }
    }
}

/// The curve as columns of a file; those of the force only where there is one.
fn columns(arguments: &Arguments, curve: &[Row]) -> Vec<(&'static str, Vec<f64>)> {
    let column = |value: &dyn Fn(&Row) -> f64| curve.iter().map(value).collect::<Vec<_>>();
    let mut columns = vec![
        ("obliquity_deg", column(&|row| row.obliquity_deg)),
        ("spin_rate_rad_s", column(&|_| arguments.spin_rad_s())),
        ("spin_torque_n_m", column(&|row| row.spin_torque_n_m)),
        ("obliquity_torque_n_m", column(&|row| row.obliquity_torque_n_m)),
    ];
    if let Some(rows) = curve.iter().map(|row| row.yarkovsky).collect::<Option<Vec<_>>>() {
        let (force, drift) = rows.into_iter().unzip();
        columns.push(("transverse_force_n", force));
        columns.push(("semimajor_axis_drift_au_myr", drift));
    }
    columns
}

fn as_value(body: &MeshBody, curve: &[Row], table: &TorqueTable, seconds: f64) -> Value {
    let column = |value: fn(&Row) -> f64| curve.iter().map(value).collect::<Vec<_>>();
    let yarkovsky =
        |value: fn((f64, f64)) -> f64| curve.iter().map(|row| row.yarkovsky.map(value)).collect::<Option<Vec<_>>>();
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
        "transverse_force_n": yarkovsky(|(force, _)| force),
        "semimajor_axis_drift_au_myr": yarkovsky(|(_, drift)| drift),
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
    let spin_rad_s = arguments.spin_rad_s();
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
    let mut heads = vec![
        ("spin torque", "N m"),
        ("obliquity torque", "N m"),
        ("spin rate", "rev/day/Myr"),
        ("obliquity", "deg/Myr"),
    ];
    if curve.iter().any(|row| row.yarkovsky.is_some()) {
        heads.extend([("Yarkovsky force", "N"), ("semimajor axis", "au/Myr")]);
    }
    let line = |first: &str, rest: Vec<String>| {
        rest.iter().fold(format!("{first:>10}"), |line, field| line + &format!("{field:>18}")) + "\n"
    };
    text += &line("obliquity", heads.iter().map(|(name, _)| (*name).to_owned()).collect());
    text += &line("deg", heads.iter().map(|(_, unit)| (*unit).to_owned()).collect());
    for row in curve {
        let spin = row.spin_torque_n_m / body.inertia_kg_m2;
        let obliquity = row.obliquity_torque_n_m / (body.inertia_kg_m2 * spin_rad_s);
        let mut fields = vec![
            format!("{:.6e}", row.spin_torque_n_m),
            format!("{:.6e}", row.obliquity_torque_n_m),
            format!("{:.4e}", spin * 86_400.0 / TAU * myr_s),
            format!("{:.4e}", obliquity.to_degrees() * myr_s),
        ];
        if let Some((force, drift)) = row.yarkovsky {
            fields.extend([format!("{force:.4e}"), format!("{drift:.4e}")]);
        }
        text += &line(&row.obliquity_deg.to_string(), fields);
    }
    let _ = writeln!(text, "\n{:<26}{:>16}{:>18}", "estimated error", "spin torque", "obliquity torque");
    let total = ("all", table.error.spin_torque_n_m, table.error.obliquity_torque_n_m);
    let parts = table.error.parts.iter().map(|p| (p.name.as_str(), p.spin_torque_n_m, p.obliquity_torque_n_m));
    for (name, spin, obliquity) in parts.chain([total]) {
        let _ = writeln!(text, "  {name:<24}{spin:>16.1e}{obliquity:>18.1e}");
    }
    text
}
