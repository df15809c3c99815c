//! `yorp relax AGGREGATE`: evolves an aggregate alone at constant angular momentum.

use std::path::PathBuf;

use clap::ValueEnum;
use nalgebra::Vector3;
use pkd::frame::set_rigid_rotation;
use pkd::gravity::{GravityMethod, GravityOptions};
use pkd::hard_sphere::{HardSphereParameters, repair_overlaps};
use pkd::mass_properties::mass_properties;
use serde_json::json;

use super::progress::Reporter;
use super::{CliError, arguments as value, output};
use crate::evolve::relax::{Duration, Relaxed, relax};
use crate::exchange::{AggregateFormat, read_aggregate, write_aggregate};
use crate::scene::{self, Contact, Evolution};

/// Arguments of `yorp relax`.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true, group = clap::ArgGroup::new("length").required(true))]
pub(super) struct Arguments {
    /// The aggregate (CSV)
    aggregate: PathBuf,
    /// Contact model
    #[arg(long, value_enum, default_value_t = ContactModel::Hard)]
    contact: ContactModel,
    /// Evolve for this long, s
    #[arg(long, value_name = "S", group = "length", value_parser = value::positive)]
    duration_s: Option<f64>,
    /// Evolve for this many rotations
    #[arg(long, value_name = "N", group = "length", value_parser = value::positive)]
    rotations: Option<f64>,
    /// Evolve until a block of 5 rotations shows no movement, at most 50 rotations
    #[arg(long, group = "length")]
    until_settled: bool,
    /// Replace all velocities and spins by a rigid rotation of this period, h, about the axis of largest moment
    #[arg(long, value_name = "P", value_parser = value::positive)]
    period_h: Option<f64>,
    /// Time step, s
    #[arg(long, value_name = "H", default_value_t = 50.0, value_parser = value::positive)]
    step_s: f64,
    /// How gravity is summed
    #[arg(long, value_enum, default_value_t = Gravity::Auto)]
    gravity: Gravity,
    /// Where the aggregate goes afterwards: .csv or .vtp
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum ContactModel {
    /// Hard spheres
    Hard,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Gravity {
    /// The fastest method with forces good to 1e-3: the direct sum for small bodies, the tree for large ones
    Auto,
    /// Every pair
    Direct,
    /// The tree
    Tree,
    /// None
    Off,
}

impl Gravity {
    fn method(self) -> Option<GravityMethod> {
        match self {
            Self::Auto => Some(GravityMethod::Auto),
            Self::Direct => Some(GravityMethod::Direct),
            Self::Tree => Some(GravityMethod::Tree),
            Self::Off => None,
        }
    }
}

pub(super) fn run(arguments: &Arguments, as_json: bool) -> Result<(), CliError> {
    let ContactModel::Hard = arguments.contact;
    let parameters = HardSphereParameters {
        step_s: arguments.step_s,
        gravity: arguments.gravity.method().map(|method| GravityOptions { method, ..GravityOptions::default() }),
        ..Contact::default().to_pkd(&scene::GravityOptions::default())
    };
    let format = arguments.out.as_deref().map(AggregateFormat::of).transpose().map_err(CliError::input)?;
    let mut spheres = read_aggregate(&arguments.aggregate).map_err(CliError::input)?;
    if let Some(period_h) = arguments.period_h {
        let axis = Vector3::from(mass_properties(&spheres).map_err(CliError::input)?.axes.column(2));
        let omega = std::f64::consts::TAU / (period_h * 3600.0);
        set_rigid_rotation(&mut spheres, axis * omega).map_err(CliError::input)?;
    }
    let repair = repair_overlaps(&mut spheres, &parameters).map_err(CliError::input)?;
    if repair.overlap_repairs > 0 {
        let (pairs, deepest) = (repair.overlap_repairs, repair.max_overlap_over_radius);
        eprintln!("warning: pushed {pairs} overlapping pairs apart, the deepest by {deepest:.2e} radii");
    }
    let duration = match (arguments.duration_s, arguments.rotations) {
        (Some(seconds), _) => Duration::Seconds(seconds),
        (_, Some(rotations)) => Duration::Rotations(rotations),
        _ => Duration::UntilSettled,
    };
    let mut reporter = Reporter::start()?;
    let fraction = Evolution::default().movement_radius_fraction;
    let relaxed = relax(&mut spheres, &parameters, duration, fraction, &mut reporter)?;
    drop(reporter);
    if let (Some(file), Some(format)) = (&arguments.out, format) {
        write_aggregate(&spheres, file, format).map_err(CliError::write)?;
    }
    if as_json { output::json(&as_value(&relaxed, &parameters)) } else { output::text(&as_text(&relaxed)) }
}

fn as_value(relaxed: &Relaxed, parameters: &HardSphereParameters) -> serde_json::Value {
    let (report, counts) = (&relaxed.report, &relaxed.report.counts);
    json!({
        "steps": report.steps,
        "step_s": if report.steps > 0 { report.duration_s / report.steps as f64 } else { parameters.step_s },
        "seconds": relaxed.seconds,
        "cpu_seconds": relaxed.cpu_seconds,
        "contacts_per_sphere": relaxed.contacts_per_sphere,
        "energy_drift": relaxed.energy_drift,
        "momentum_drift": relaxed.momentum_drift,
        "angular_momentum_drift": relaxed.angular_momentum_drift,
        "max_overlap_over_radius": report.max_overlap_over_radius,
        "collisions": counts.collisions,
        "moved_spheres": relaxed.moved_spheres,
        "shape_change": relaxed.shape_change,
        "rotations": relaxed.rotations,
        "settled": relaxed.settled,
        "parts": {
            "collisions": {
                "nominal": counts.nominal,
                "slide_rule": counts.slide,
                "collapse_rule": counts.collapse,
                "capped": counts.capped,
                "repredictions": counts.repredictions,
                "list_rebuilds": counts.list_rebuilds,
            },
        },
    })
}

fn as_text(relaxed: &Relaxed) -> String {
    let (report, counts) = (&relaxed.report, &relaxed.report.counts);
    let settled = match relaxed.settled {
        None => String::new(),
        Some(true) => format!(", settled after {} rotations", relaxed.rotations),
        Some(false) => format!(", still moving after {} rotations", relaxed.rotations),
    };
    let spin = relaxed.angular_momentum_drift.map_or("not determined".to_owned(), |d| format!("{d:.1e}"));
    format!(
        "{} steps, {:.0} s simulated in {:.1} s ({:.1} CPU s){settled}\n\
         {} collisions: {} nominal, {} by the slide rule, {} by the collapse rule, {} beyond the cap\n\
         {:.2} contacts a sphere, {} spheres moved, shape changed by {:.2e}\n\
         drift: energy {:.2e}, momentum {:.1e}, angular momentum {spin}; deepest overlap {:.1e} radii\n",
        report.steps,
        report.duration_s,
        relaxed.seconds,
        relaxed.cpu_seconds,
        counts.collisions,
        counts.nominal,
        counts.slide,
        counts.collapse,
        counts.capped,
        relaxed.contacts_per_sphere,
        relaxed.moved_spheres,
        relaxed.shape_change,
        relaxed.energy_drift,
        relaxed.momentum_drift,
        report.max_overlap_over_radius,
    )
}
