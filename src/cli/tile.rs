//! `yorp tile AGGREGATE --out MESH`: the triangle surface of an aggregate, in the aggregate's own frame.

use std::path::PathBuf;
use std::time::Instant;

use nalgebra::Vector3;
use pkd::Spheres;
use pkd::mass_properties::mass_properties;
use serde_json::{Value, json};
use tiling::checks::VOLUME_RATIOS;
use tiling::{EllipsoidTiling, FitReport, ImplicitSurface, Mesh, Placement, TilingError};

use super::{CliError, arguments, guard, output};
use crate::exchange::{MeshFormat, read_aggregate, write_mesh};

/// Arguments of `yorp tile`.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct Arguments {
    /// The aggregate (CSV)
    aggregate: PathBuf,
    /// Where the mesh goes; .obj or .vtp
    #[arg(long, value_name = "MESH")]
    out: PathBuf,
    /// Number of triangles, even
    #[arg(long, value_name = "N", default_value_t = 784, value_parser = arguments::facets)]
    facets: u32,
    /// Exponent n of the implicit surface sum (R/|x - x_j|)^(2n) = G0
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=10))]
    exponent: u32,
    /// Its level G0
    #[arg(long, value_name = "G0", default_value_t = 1.25, value_parser = arguments::level)]
    level: f64,
    /// Turn the pattern of vertices about the short axis by this, deg: another sample of the same surface
    #[arg(long, value_name = "DEG", default_value_t = 0.0, value_parser = arguments::turn_deg)]
    turn_deg: f64,
}

/// A tiling in the aggregate's frame and how good it is.
struct Fit {
    mesh: Mesh,
    report: FitReport,
    flagged: usize,
    /// Vertices that were moved off the surface because facets would cross.
    mended: usize,
    semi_axes_m: [f64; 3],
    mass_kg: f64,
}

/// Fits the tiling and writes it.
pub(super) fn run(arguments: &Arguments, as_json: bool) -> Result<(), CliError> {
    let start = Instant::now();
    let format = MeshFormat::of(&arguments.out)?;
    let spheres = read_aggregate(&arguments.aggregate)?;
    let mass_kg = spheres.total_mass();
    let radius_m = spheres.radius.iter().map(|r| r.powi(3)).sum::<f64>().cbrt();
    guard::warn(guard::size(radius_m, "an aggregate is in metres and kilograms"));
    let fit = fit(arguments, &spheres, mass_kg)?;
    guard::warn(oddities(&fit));
    guard::warn(guard::density(mass_kg / fit.report.volume, "the density of the tiling"));
    write_mesh(&fit.mesh, &arguments.out, format)?;
    let value = as_value(&fit, start.elapsed().as_secs_f64());
    if as_json { output::json(&value) } else { output::text(&as_text(&fit, &arguments.out)) }
}

/// What is odd about the tiling, though it bounds a body.
fn oddities(fit: &Fit) -> Option<String> {
    let counted = |n: usize, one: &str, many: &str| match n {
        0 => None,
        1 => Some(format!("1 {one}")),
        n => Some(format!("{n} {many}")),
    };
    let (report, [low, high]) = (&fit.report, VOLUME_RATIOS);
    let odd: Vec<String> = [
        counted(report.folded.len(), "facet turned over", "facets turned over"),
        counted(report.slivers.len(), "sliver", "slivers"),
        counted(
            fit.mended,
            "vertex off the surface, where facets would cross",
            "vertices off the surface, where facets would cross",
        ),
        (!(low..=high).contains(&report.volume_ratio))
            .then(|| format!("volume {:.3} of the ellipsoid's", report.volume_ratio)),
    ]
    .into_iter()
    .flatten()
    .collect();
    (!odd.is_empty()).then(|| format!("the tiling has {}", odd.join(", ")))
}

/// The equivalent ellipsoid has the axis ratios of the moments of inertia and the volume of the convex hull; the tiling
/// is fitted in its frame and put back into the aggregate's.
fn fit(arguments: &Arguments, spheres: &Spheres, mass_kg: f64) -> Result<Fit, CliError> {
    let properties = mass_properties(spheres).map_err(CliError::input)?;
    let to_body = properties.axes.transpose();
    let centred = (0..spheres.len()).map(|i| to_body * (Vector3::from(spheres.position(i)) - properties.centre));
    let centred: Vec<Vector3<f64>> = centred.collect();
    let column = |k: usize| centred.iter().map(|p| p[k]).collect::<Vec<_>>();
    let [x, y, z] = [column(0), column(1), column(2)];
    let tile = || -> Result<Fit, TilingError> {
        let hull_m3 = tiling::sphere_hull_volume(&x, &y, &z, &spheres.radius)?;
        let axes = properties.deeve_axes();
        let scale = (hull_m3 / (4.0 / 3.0 * std::f64::consts::PI * axes.product())).cbrt();
        let vertices = arguments.facets as usize / 2 + 2;
        let ellipsoid = EllipsoidTiling::turned((axes * scale).into(), vertices, arguments.turn_deg.to_radians())?;
        let surface = ImplicitSurface::new(&x, &y, &z, &spheres.radius, arguments.exponent, arguments.level)?;
        let tiling = ellipsoid.projected(&surface)?;
        let report = FitReport::new(&ellipsoid, &tiling.mesh);
        let mesh = tiling.mesh.rotated(&properties.axes).translated(properties.centre.into());
        mesh.check_body()?;
        let mended = tiling.flagged.iter().filter(|f| f.placement == Placement::Mended).count();
        Ok(Fit { mesh, report, flagged: tiling.flagged.len(), mended, semi_axes_m: ellipsoid.semi_axes, mass_kg })
    };
    tile().map_err(|error| match error {
        // Spheres of which no legal surface could be made, rather than arguments that make none.
        TilingError::SelfContact { .. } | TilingError::Degenerate { .. } | TilingError::NoInertia { .. } => {
            CliError::numerical(error)
        }
        other => CliError::input(other),
    })
}

fn as_value(fit: &Fit, seconds: f64) -> Value {
    json!({
        "facets": fit.mesh.facets.len(),
        "vertices": fit.mesh.vertices.len(),
        "vertices_flagged": fit.flagged,
        "vertices_mended": fit.mended,
        "facets_folded": fit.report.folded.len(),
        "slivers": fit.report.slivers.len(),
        "volume_m3": fit.report.volume,
        "density_kg_m3": fit.mass_kg / fit.report.volume,
        "ellipsoid_semi_axes_m": fit.semi_axes_m,
        "seconds": seconds,
    })
}

fn as_text(fit: &Fit, out: &std::path::Path) -> String {
    let [a, b, c] = fit.semi_axes_m;
    format!(
        "{} facets, {} vertices ({} off their normal), volume {:.6e} m^3, density {:.1} kg/m^3\n\
         fitted from an ellipsoid of {a:.2} x {b:.2} x {c:.2} m, written to {}\n",
        fit.mesh.facets.len(),
        fit.mesh.vertices.len(),
        fit.flagged,
        fit.report.volume,
        fit.mass_kg / fit.report.volume,
        out.display(),
    )
}
