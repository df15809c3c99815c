//! `yorp torque MESH`: spin and obliquity torque of a shape model at every obliquity.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::time::Instant;

use serde_json::{Map, Value, json};
use taco::{AU_PER_MYR, Obliquities, Orbit, Sampling, SpinRates, TorqueTable};

use super::sunlit_mesh::{MeshBody, SunlitMesh, torque_failed};
use super::{CliError, arguments, output};
use crate::evolve::driver::MYR_S;
use crate::evolve::spin::YEAR_S;
use crate::exchange::{check_table_name, write_table};

/// One day, s.
const DAY_S: f64 = 86_400.0;

/// Arguments of `yorp torque`.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct Arguments {
    /// The shape model, a closed mesh (OBJ, PLY, STL, OFF or plate table)
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
    let (wanted, sampling) = arguments.obliquities()?;
    let body = arguments.sunlit.body(&arguments.mesh)?;
    arguments.sunlit.warn_of_seasons(&surface);
    body.warn_of_period(arguments.period_h);
    let orbit = arguments.sunlit.orbit();
    let table = taco::torque_table(&body.mesh, &surface, &orbit, &sampling).map_err(torque_failed)?;
    let rates = Rates {
        inertia_kg_m2: body.inertia_kg_m2,
        spin_rad_s: arguments.spin_rad_s(),
        mass_kg: body.volume_m3 * arguments.sunlit.density_kg_m3,
        orbit: &orbit,
    };
    let curve: Vec<Row> = wanted.iter().map(|obliquity_deg| Row::of(&table, *obliquity_deg, &rates)).collect();
    if let Some(file) = &arguments.out {
        write_table(&columns(arguments, &curve), file)?;
    }
    if as_json {
        output::json(&as_value(&body, &curve, &table, start.elapsed().as_secs_f64()))
    } else {
        output::text(&as_text(arguments, &body, &curve, &table))
    }
}

/// One obliquity.
struct Row {
    obliquity_deg: f64,
    spin_torque_n_m: f64,
    obliquity_torque_n_m: f64,
    /// `d omega/dt`, rad/s^2.
    spin_acceleration: f64,
    /// `d epsilon/dt`, rad/s.
    obliquity_rate: f64,
    yarkovsky: Option<Yarkovsky>,
}

/// What stored heat does to the orbit.
#[derive(Clone, Copy)]
struct Yarkovsky {
    /// Force along the orbital motion, N.
    force_n: f64,
    /// What it does to the semimajor axis, m/s.
    drift_m_s: f64,
}

/// What turns torques and forces into rates.
struct Rates<'a> {
    inertia_kg_m2: f64,
    spin_rad_s: f64,
    mass_kg: f64,
    orbit: &'a Orbit,
}

impl Row {
    /// The node of the table at an obliquity that it was made for.
    fn of(table: &TorqueTable, obliquity_deg: f64, rates: &Rates) -> Self {
        let distance = |k: &usize| (table.obliquity[*k].to_degrees() - obliquity_deg).abs();
        let nodes = 0..table.obliquity.len();
        let k = nodes.min_by(|i, j| distance(i).total_cmp(&distance(j))).expect("a table has at least one node");
        let (spin_torque_n_m, obliquity_torque_n_m) = (table.spin_torque_n_m[0][k], table.obliquity_torque_n_m[0][k]);
        Self {
            obliquity_deg,
            spin_torque_n_m,
            obliquity_torque_n_m,
            spin_acceleration: spin_torque_n_m / rates.inertia_kg_m2,
            obliquity_rate: obliquity_torque_n_m / (rates.inertia_kg_m2 * rates.spin_rad_s),
            yarkovsky: table.transverse_force_n.first().map(|row| Yarkovsky {
                force_n: row[k],
                drift_m_s: rates.orbit.semimajor_axis_drift_m_s(row[k], rates.mass_kg),
            }),
        }
    }

    /// deg/day^2.
    fn acceleration_deg_day2(&self) -> f64 {
        self.spin_acceleration.to_degrees() * DAY_S * DAY_S
    }

    /// rev/day/Myr.
    fn acceleration_rev_day_myr(&self) -> f64 {
        self.spin_acceleration * DAY_S / TAU * MYR_S
    }

    /// deg/Myr.
    fn obliquity_rate_deg_myr(&self) -> f64 {
        self.obliquity_rate.to_degrees() * MYR_S
    }
}

impl Yarkovsky {
    /// au/Myr.
    fn drift_au_myr(self) -> f64 {
        self.drift_m_s * AU_PER_MYR
    }

    /// m/yr.
    fn drift_m_yr(self) -> f64 {
        self.drift_m_s * YEAR_S
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
        ("spin_acceleration_deg_day2", column(&Row::acceleration_deg_day2)),
        ("spin_acceleration_rev_day_myr", column(&Row::acceleration_rev_day_myr)),
        ("obliquity_rate_deg_myr", column(&Row::obliquity_rate_deg_myr)),
    ];
    if let Some(rows) = curve.iter().map(|row| row.yarkovsky).collect::<Option<Vec<_>>>() {
        let column = |value: fn(Yarkovsky) -> f64| rows.iter().map(|row| value(*row)).collect::<Vec<_>>();
        columns.push(("transverse_force_n", column(|y| y.force_n)));
        columns.push(("semimajor_axis_drift_au_myr", column(Yarkovsky::drift_au_myr)));
        columns.push(("semimajor_axis_drift_m_yr", column(Yarkovsky::drift_m_yr)));
    }
    columns
}

fn as_value(body: &MeshBody, curve: &[Row], table: &TorqueTable, seconds: f64) -> Value {
    let column = |value: fn(&Row) -> f64| curve.iter().map(value).collect::<Vec<_>>();
    let yarkovsky =
        |value: fn(Yarkovsky) -> f64| curve.iter().map(|row| row.yarkovsky.map(value)).collect::<Option<Vec<_>>>();
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
        "spin_acceleration_deg_day2": column(Row::acceleration_deg_day2),
        "spin_acceleration_rev_day_myr": column(Row::acceleration_rev_day_myr),
        "obliquity_rate_deg_myr": column(Row::obliquity_rate_deg_myr),
        "transverse_force_n": yarkovsky(|y| y.force_n),
        "semimajor_axis_drift_au_myr": yarkovsky(Yarkovsky::drift_au_myr),
        "semimajor_axis_drift_m_yr": yarkovsky(Yarkovsky::drift_m_yr),
        "inertia_kg_m2": body.inertia_kg_m2,
        "volume_m3": body.volume_m3,
        "facets": body.mesh.mesh().facets.len(),
        "error_estimate": {
            "spin_torque_n_m": table.error.spin_torque_n_m,
            "obliquity_torque_n_m": table.error.obliquity_torque_n_m,
            "parts": parts,
        },
        "seconds": seconds,
    })
}

fn as_text(arguments: &Arguments, body: &MeshBody, curve: &[Row], table: &TorqueTable) -> String {
    let mut text = String::new();
    let _ = writeln!(
        text,
        "{} facets ({} see others above their plane), volume {:.6e} m^3, radius of equal volume {:.2} m\nC = {:.6e} kg m^2 at {} kg/m^3, period {} h\n",
        body.mesh.mesh().facets.len(),
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
        ("spin acceleration", "deg/day^2"),
        ("spin change", "rev/day/Myr"),
        ("obliquity change", "deg/Myr"),
    ];
    if curve.iter().any(|row| row.yarkovsky.is_some()) {
        heads.extend([("Yarkovsky force", "N"), ("Yarkovsky drift", "au/Myr"), ("drift in metres", "m/yr")]);
    }
    let line = |first: &str, rest: Vec<String>| {
        rest.iter().fold(format!("{first:>10}"), |line, field| line + &format!("{field:>19}")) + "\n"
    };
    text += &line("obliquity", heads.iter().map(|(name, _)| (*name).to_owned()).collect());
    text += &line("deg", heads.iter().map(|(_, unit)| (*unit).to_owned()).collect());
    for row in curve {
        let mut fields = vec![
            format!("{:.6e}", row.spin_torque_n_m),
            format!("{:.6e}", row.obliquity_torque_n_m),
            format!("{:.4e}", row.acceleration_deg_day2()),
            format!("{:.4e}", row.acceleration_rev_day_myr()),
            format!("{:.4e}", row.obliquity_rate_deg_myr()),
        ];
        if let Some(y) = row.yarkovsky {
            fields.extend([y.force_n, y.drift_au_myr(), y.drift_m_yr()].map(|value| format!("{value:.4e}")));
        }
        text += &line(&row.obliquity_deg.to_string(), fields);
    }
    text + &errors_as_text(curve, table)
}

/// The errors in N m and in per cent of the largest torque of the table above.
fn errors_as_text(curve: &[Row], table: &TorqueTable) -> String {
    let largest = |torque: fn(&Row) -> f64| curve.iter().map(torque).fold(0.0_f64, |m, t| m.max(t.abs()));
    let (spin_peak, obliquity_peak) = (largest(|r| r.spin_torque_n_m), largest(|r| r.obliquity_torque_n_m));
    let percent = |error: f64, peak: f64| match 100.0 * error / peak {
        share if share.is_finite() && share < 1e4 => format!("{share:.2}"),
        share if share.is_finite() => format!("{share:.0e}"),
        _ => "-".to_owned(),
    };
    let mut text = format!(
        "\n{:<26}{:>16}{:>14}{:>20}{:>14}\n{:<26}{:>16}{:>14}{:>20}{:>14}\n",
        "estimated error of",
        "spin torque,",
        "",
        "obliquity torque,",
        "",
        "",
        "N m",
        "% of largest",
        "N m",
        "% of largest"
    );
    let total = ("all", table.error.spin_torque_n_m, table.error.obliquity_torque_n_m);
    let parts = table.error.parts.iter().map(|p| (p.name.as_str(), p.spin_torque_n_m, p.obliquity_torque_n_m));
    for (name, spin, obliquity) in parts.chain([total]) {
        let (of_spin, of_obliquity) = (percent(spin, spin_peak), percent(obliquity, obliquity_peak));
        let _ = writeln!(text, "  {name:<24}{spin:>16.1e}{of_spin:>14}{obliquity:>20.1e}{of_obliquity:>14}");
    }
    for (name, peak, error) in [("spin", spin_peak, total.1), ("obliquity", obliquity_peak, total.2)] {
        if peak <= error {
            let _ = writeln!(text, "no {name} torque above its error at these obliquities");
        }
    }
    text
}
