//! `yorp build`: constructs and settles the aggregate of a scene, without sunlight.

use std::path::PathBuf;

use pkd::mass_properties::mass_properties;
use serde_json::json;

use super::progress::{Leaves, Reporter};
use super::{CliError, output};
use crate::evolve::build::build;
use crate::exchange::{AggregateFormat, write_aggregate};
use crate::scene::SceneFile;

/// Arguments of `yorp build`.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The scene file
    scene: PathBuf,
    /// Where the aggregate goes: .csv or .vtp (ParaView)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Leave out the settling
    #[arg(long)]
    unsettled: bool,
}

pub(super) fn run(arguments: &Arguments, as_json: bool) -> Result<(), CliError> {
    let scene = SceneFile::read(&arguments.scene)?;
    let format = AggregateFormat::of(&arguments.out).map_err(CliError::input)?;
    output::check(&arguments.out, &scene.inputs())?;
    let mut reporter = Reporter::start(Leaves::Nothing)?;
    let built = build(&scene, !arguments.unsettled, &mut reporter)?;
    drop(reporter);
    write_aggregate(&built.spheres, &arguments.out, format).map_err(CliError::write)?;
    let properties = mass_properties(&built.spheres).map_err(CliError::numerical)?;
    let (b1, b2) = (properties.deeve_axes(), properties.half_extents);
    let hull = built.hull_volume_m3;
    if as_json {
        return output::json(&json!({
            "spheres": built.spheres.len(),
            "mass_kg": properties.mass,
            "period_h": std::f64::consts::TAU / properties.spin_rate() / 3600.0,
            "rotations": built.rotations,
            "settled": built.settled,
            "b1_axes_m": b1.as_slice(),
            "b2_axes_m": b2.as_slice(),
            "density_kg_m3": {
                "b1": properties.deeve_density(),
                "b2": properties.extents_density(),
                "b3": properties.mass / hull,
            },
        }));
    }
    let ratios = |axes: &nalgebra::Vector3<f64>| format!("b/a {:.3}, c/a {:.3}", axes.y / axes.x, axes.z / axes.x);
    output::text(&format!(
        "{} spheres, {:.4e} kg, period {:.4} h, {}\n\
         equivalent ellipsoid (B1): a {:.1} m, {}, {:.0} kg/m^3\n\
         half extents (B2):         a {:.1} m, {}, {:.0} kg/m^3\n\
         convex hull (B3):          {:.0} kg/m^3\n\
         written to {}\n",
        built.spheres.len(),
        properties.mass,
        std::f64::consts::TAU / properties.spin_rate() / 3600.0,
        match built.settled {
            None => "not settled".to_owned(),
            Some(true) => format!("settled in {} rotations", built.rotations),
            Some(false) => format!("still moving after {} rotations", built.rotations),
        },
        b1.x,
        ratios(&b1),
        properties.deeve_density(),
        b2.x,
        ratios(&b2),
        properties.extents_density(),
        properties.mass / hull,
        arguments.out.display(),
    ))
}
