//! `yorp relax AGGREGATE`: evolves an aggregate alone at constant angular momentum.

use std::path::PathBuf;

use clap::ValueEnum;
use nalgebra::Vector3;
use pkd::frame::set_rigid_rotation;
use pkd::gravity::{GravityMethod, GravityOptions};
use pkd::hard_sphere::HardSphereParameters;
use pkd::mass_properties::mass_properties;
use pkd::soft_sphere::{self, Energy, SoftSphereParameters};
use serde_json::{Value, json};

use super::progress::{Leaves, Reporter};
use super::{CliError, arguments as value, output};
use crate::evolve::engine::{ContactLaw, Work};
use crate::evolve::relax::{Duration, Relaxed, relax};
use crate::exchange::{AggregateFormat, read_aggregate, write_aggregate};
use crate::scene::{self, Evolution, HardSphereContact, SoftSphereContact, SoftSpherePreset};

/// Arguments of `yorp relax`.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true, group = clap::ArgGroup::new("length").required(true))]
pub(super) struct Arguments {
    /// The aggregate (CSV)
    aggregate: PathBuf,
    /// Contact model
    #[arg(long, value_enum, default_value_t = ContactModel::Hard)]
    contact: ContactModel,
    /// Parameters of soft contacts
    #[arg(long, value_enum, default_value_t = Preset::Zhang2017)]
    preset: Preset,
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
    /// Time step, s [default: 50 for hard spheres, a thirtieth of the quickest contact for soft ones]
    #[arg(long, value_name = "H", value_parser = value::positive)]
    step_s: Option<f64>,
    /// Normal stiffness of soft contacts, N/m [default: from the body, for overlaps of at most 1 %]
    #[arg(long, value_name = "K", value_parser = value::positive)]
    normal_stiffness_n_m: Option<f64>,
    /// How gravity is summed
    #[arg(long, value_enum, default_value_t = Gravity::Auto)]
    gravity: Gravity,
    /// Gravity of soft spheres is evaluated anew when one has moved by this fraction of its radius; 0: in every step
    #[arg(long, value_name = "F", default_value_t = 0.01, value_parser = value::field_tolerance)]
    field_tolerance: f64,
    /// Where the aggregate goes afterwards: .csv or .vtp
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ContactModel {
    /// Hard spheres
    Hard,
    /// Soft spheres
    Soft,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Preset {
    /// Zhang et al. 2017, nominal
    #[value(name = "zhang_2017")]
    Zhang2017,
    /// Gravel of Yu et al. 2014
    #[value(name = "gravel")]
    Gravel,
    /// Glass beads of Yu et al. 2014
    #[value(name = "glass_beads")]
    GlassBeads,
    /// Perfectly smooth
    #[value(name = "frictionless")]
    Frictionless,
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

impl Arguments {
    /// How the spheres touch and attract each other.
    ///
    /// # Errors
    /// A flag that the contact model has no use for.
    fn law(&self) -> Result<ContactLaw, CliError> {
        let gravity = scene::GravityOptions::default();
        let method = self.gravity.method();
        if self.contact == ContactModel::Hard {
            for (given, flag) in [
                (self.preset != Preset::Zhang2017, "--preset"),
                (self.normal_stiffness_n_m.is_some(), "--normal-stiffness-n-m"),
                (self.field_tolerance != SoftSphereContact::default().field_tolerance, "--field-tolerance"),
            ] {
                if given {
                    return Err(CliError::refused(format!("{flag} goes with --contact soft")));
                }
            }
            let parameters = HardSphereContact::default().to_pkd(&gravity);
            return Ok(ContactLaw::Hard(HardSphereParameters {
                step_s: self.step_s.unwrap_or(parameters.step_s),
                gravity: method.map(|method| GravityOptions { method, ..GravityOptions::default() }),
                ..parameters
            }));
        }
        let preset = match self.preset {
            Preset::Zhang2017 => SoftSpherePreset::Zhang2017,
            Preset::Gravel => SoftSpherePreset::Gravel,
            Preset::GlassBeads => SoftSpherePreset::GlassBeads,
            Preset::Frictionless => SoftSpherePreset::Frictionless,
        };
        let contact =
            SoftSphereContact { preset, field_tolerance: self.field_tolerance, ..SoftSphereContact::default() };
        let parameters = contact.to_pkd(&gravity);
        Ok(ContactLaw::Soft(SoftSphereParameters {
            normal_stiffness_n_m: self.normal_stiffness_n_m,
            step_s: self.step_s,
            gravity: if method.is_some() { parameters.gravity } else { soft_sphere::Gravity::Off },
            gravity_options: GravityOptions { method: method.unwrap_or_default(), ..GravityOptions::default() },
            ledger: true,
            ..parameters
        }))
    }
}

pub(super) fn run(arguments: &Arguments, as_json: bool) -> Result<(), CliError> {
    let law = arguments.law()?;
    let format = arguments.out.as_deref().map(AggregateFormat::of).transpose().map_err(CliError::input)?;
    arguments.out.as_ref().map_or(Ok(()), |file| output::check(file, &[&arguments.aggregate]))?;
    let mut spheres = read_aggregate(&arguments.aggregate).map_err(CliError::input)?;
    if let Some(period_h) = arguments.period_h {
        let axis = Vector3::from(mass_properties(&spheres).map_err(CliError::input)?.axes.column(2));
        let omega = std::f64::consts::TAU / (period_h * 3600.0);
        set_rigid_rotation(&mut spheres, axis * omega).map_err(CliError::input)?;
    }
    if let Some(repair) = law.part_overlaps(&mut spheres).map_err(CliError::input)? {
        let (pairs, deepest) = (repair.overlap_repairs, repair.max_overlap_over_radius);
        eprintln!("warning: pushed {pairs} overlapping pairs apart, the deepest by {deepest:.2e} radii");
    }
    let duration = match (arguments.duration_s, arguments.rotations) {
        (Some(seconds), _) => Duration::Seconds(seconds),
        (_, Some(rotations)) => Duration::Rotations(rotations),
        _ => Duration::UntilSettled,
    };
    let mut reporter = Reporter::start(Leaves::Nothing)?;
    let fraction = Evolution::default().movement_radius_fraction;
    let relaxed = relax(&mut spheres, &law, duration, fraction, &mut reporter)?;
    drop(reporter);
    if let (Some(file), Some(format)) = (&arguments.out, format) {
        write_aggregate(&spheres, file, format).map_err(CliError::write)?;
    }
    if as_json { output::json(&as_value(&relaxed)) } else { output::text(&as_text(&relaxed)) }
}

fn as_value(relaxed: &Relaxed) -> Value {
    let (work, counts) = (&relaxed.work, relaxed.work.collisions());
    json!({
        "steps": work.steps(),
        "step_s": work.duration_s() / work.steps() as f64,
        "seconds": relaxed.seconds,
        "cpu_seconds": relaxed.cpu_seconds,
        "contacts_per_sphere": relaxed.contacts_per_sphere,
        "energy_drift": relaxed.energy_drift,
        "momentum_drift": relaxed.momentum_drift,
        "angular_momentum_drift": relaxed.angular_momentum_drift,
        "max_overlap_over_radius": work.max_overlap_over_radius(),
        "collisions": counts.collisions,
        "moved_spheres": relaxed.moved_spheres,
        "shape_change": relaxed.shape_change,
        "rotations": relaxed.rotations,
        "settled": relaxed.settled,
        "parts": match work {
            Work::Hard(_) => json!({
                "collisions": {
                    "nominal": counts.nominal,
                    "slide_rule": counts.slide,
                    "collapse_rule": counts.collapse,
                    "capped": counts.capped,
                    "repredictions": counts.repredictions,
                    "list_rebuilds": counts.list_rebuilds,
                },
            }),
            Work::Soft(report) => soft_parts(report),
        },
    })
}

fn soft_parts(report: &soft_sphere::Report) -> Value {
    let (stiffness, ledger) = (&report.stiffness, report.ledger.unwrap_or_default());
    let energy = |e: &Energy| {
        json!({
            "kinetic_j": e.kinetic_j,
            "gravity_j": e.gravity_j,
            "normal_springs_j": e.normal_j,
            "sliding_springs_j": e.sliding_j,
            "rolling_springs_j": e.rolling_j,
            "twisting_springs_j": e.twisting_j,
        })
    };
    json!({
        "stiffness": {
            "normal_n_m": stiffness.normal_n_m,
            "for_impacts_n_m": stiffness.kinetic_n_m,
            "for_weight_n_m": stiffness.static_n_m,
            "for_cohesion_n_m": stiffness.cohesive_n_m,
            "speed_m_s": stiffness.speed_m_s,
            "contact_time_s": stiffness.contact_time_s,
        },
        "contacts": {"count": report.contacts, "list_rebuilds": report.list_rebuilds, "bytes": report.bytes},
        "gravity": {"evaluations": report.gravity_evaluations, "error": report.frozen_field_error},
        "energy": {
            "start": energy(&ledger.start),
            "end": energy(&ledger.end),
            "heat": {
                "normal_dashpots_j": ledger.normal_dashpot_j,
                "sliding_dashpots_j": ledger.sliding_dashpot_j,
                "sliding_j": ledger.sliding_slider_j,
                "rolling_dashpots_j": ledger.rolling_dashpot_j,
                "rolling_j": ledger.rolling_slider_j,
                "twisting_dashpots_j": ledger.twisting_dashpot_j,
                "twisting_j": ledger.twisting_slider_j,
            },
            "residual_j": ledger.residual_j(),
        },
    })
}

fn as_text(relaxed: &Relaxed) -> String {
    let work = &relaxed.work;
    let settled = match relaxed.settled {
        None => String::new(),
        Some(true) => format!(", settled after {} rotations", relaxed.rotations),
        Some(false) => format!(", still moving after {} rotations", relaxed.rotations),
    };
    let spin = relaxed.angular_momentum_drift.map_or("not determined".to_owned(), |d| format!("{d:.1e}"));
    let how = match work {
        Work::Hard(report) => {
            let counts = &report.counts;
            format!(
                "{} collisions: {} nominal, {} by the slide rule, {} by the collapse rule, {} beyond the cap",
                counts.collisions, counts.nominal, counts.slide, counts.collapse, counts.capped,
            )
        }
        Work::Soft(report) => format!(
            "stiffness {:.3e} N/m, steps of {:.3} s; {} evaluations of gravity, error {:.1e}; heat {:.3e} J, books off by {:.1e} J",
            report.stiffness.normal_n_m,
            report.step_s,
            report.gravity_evaluations,
            report.frozen_field_error,
            report.ledger.map_or(0.0, |ledger| ledger.dissipated_j()),
            report.ledger.map_or(0.0, |ledger| ledger.residual_j()),
        ),
    };
    format!(
        "{} steps, {:.0} s simulated in {:.1} s ({:.1} CPU s){settled}\n\
         {how}\n\
         {:.2} contacts a sphere, {} spheres moved, shape changed by {:.2e}\n\
         drift: energy {:.2e}, momentum {:.1e}, angular momentum {spin}; deepest overlap {:.1e} radii\n",
        work.steps(),
        work.duration_s(),
        relaxed.seconds,
        relaxed.cpu_seconds,
        relaxed.contacts_per_sphere,
        relaxed.moved_spheres,
        relaxed.shape_change,
        relaxed.energy_drift,
        relaxed.momentum_drift,
        work.max_overlap_over_radius(),
    )
}
