//! The aggregate that a scene describes: spheres turning rigidly about their axis of largest moment, not yet settled.

use std::path::PathBuf;

use nalgebra::Vector3;
use pkd::Spheres;
use pkd::frame::{set_rigid_rotation, to_principal_axes};
use pkd::hard_sphere::repair_overlaps;
use pkd::packing::{
    EllipsoidPacking, Grain, PACKING_FRACTION, Seed, carve, ellipsoid_packing, hcp_lattice, random_fill,
};
use tiling::inside::Inside;

use super::{EvolveError, Observer};
use crate::exchange::{read_aggregate, read_mesh};
use crate::scene::{Body, CarvedMesh, PackedEllipsoid, Packing, SceneFile};

/// Random numbers of the body come from this stream of the scene's seed.
const BODY_STREAM: u64 = 0;

/// Constructs the body of `scene` in its principal-axis frame.
///
/// It turns rigidly about z at the scene's period, unless it comes from a file in which spheres already move.
///
/// # Errors
/// A file that cannot be read or understood, or spheres that cannot be packed or freed of overlaps.
pub fn aggregate(scene: &SceneFile, observer: &mut dyn Observer) -> Result<Spheres, EvolveError> {
    construct(scene, observer).map_err(|error| match error {
        // What does not fit here is the scene's, not the integrator's.
        EvolveError::Dynamics(cause) => EvolveError::Aggregate(cause),
        other => other,
    })
}

fn construct(scene: &SceneFile, observer: &mut dyn Observer) -> Result<Spheres, EvolveError> {
    let seed = Seed { seed: scene.scene.seed, stream: BODY_STREAM };
    let mut spheres = match &scene.scene.body {
        Body::PackedEllipsoid(body) => packed(body, seed)?,
        Body::File(body) => from_file(scene.resolve(&body.path), scene, observer)?,
        Body::CarvedMesh(body) => carved(body, scene.resolve(&body.path), seed)?,
    };
    to_principal_axes(&mut spheres)?;
    let at_rest = spheres.columns()[3..9].iter().all(|column| column.iter().all(|v| *v == 0.0));
    if at_rest {
        set_rigid_rotation(&mut spheres, Vector3::z() * scene.scene.spin.rate_rad_s())?;
    }
    Ok(spheres)
}

fn packed(body: &PackedEllipsoid, seed: Seed) -> Result<Spheres, EvolveError> {
    Ok(ellipsoid_packing(&EllipsoidPacking {
        count: body.spheres as usize,
        grain: Grain { radius: body.radius_m, density: body.grain_density_kg_m3 },
        b_over_a: body.b_over_a,
        c_over_a: body.c_over_a,
        packing_fraction: PACKING_FRACTION,
        seed,
    })?)
}

fn from_file(path: PathBuf, scene: &SceneFile, observer: &mut dyn Observer) -> Result<Spheres, EvolveError> {
    let mut spheres = read_aggregate(&path)?;
    let report = repair_overlaps(&mut spheres, &scene.scene.contact.to_pkd())?;
    if report.overlap_repairs > 0 {
        observer.warn(&format!(
            "{}: pushed {} overlapping pairs apart, the deepest by {:.2e} radii",
            path.display(),
            report.overlap_repairs,
            report.max_overlap_over_radius
        ));
    }
    Ok(spheres)
}

fn carved(body: &CarvedMesh, path: PathBuf, seed: Seed) -> Result<Spheres, EvolveError> {
    let mesh = read_mesh(&path, body.unit.metres())?;
    let centre = mesh.solid().centre_of_mass;
    let mesh = mesh.translated(centre.map(|c| -c));
    let mut half_widths = [0.0_f64; 3];
    for vertex in &mesh.vertices {
        for (half_width, coordinate) in half_widths.iter_mut().zip(vertex) {
            *half_width = half_width.max(coordinate.abs());
        }
    }
    let spheres = body.packing.spheres();
    let grain = Grain { radius: spheres.radius_m, density: spheres.grain_density_kg_m3 };
    let block = match &body.packing {
        Packing::Random(_) => random_fill(half_widths, grain, seed)?,
        Packing::Hcp(_) => hcp_lattice(half_widths, grain)?,
    };
    let inside = Inside::new(mesh)?;
    Ok(carve(&block, |point| inside.contains(point))?)
}
