//! The aggregate that a scene describes: spheres turning rigidly about their axis of largest moment, not yet settled.

use std::path::PathBuf;

use nalgebra::Vector3;
use pkd::Spheres;
use pkd::equilibrium::compact_ellipsoid;
use pkd::frame::{set_rigid_rotation, to_principal_axes};
use pkd::hard_sphere::HardSphereParameters;
use pkd::packing::{EllipsoidPacking, Grain, PACKING_FRACTION, Seed, carve, hcp_lattice, random_fill};
use tiling::inside::Inside;

use super::engine::ContactLaw;
use super::{EvolveError, Observer, Progress};
use crate::exchange::{read_aggregate, read_mesh};
use crate::scene::{Body, CarvedMesh, PackedEllipsoid, Packing, Scene, SceneFile};

/// Random numbers of the body come from this stream of the scene's seed.
const BODY_STREAM: u64 = 0;

/// Axis ratios farther than this from the scene's are told to the user.
const RATIO_WARNING: f64 = 0.03;

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
        Body::PackedEllipsoid(body) => packed(body, &scene.scene, seed, observer)?,
        Body::File(body) => from_file(scene.resolve(&body.path), scene, observer)?,
        Body::CarvedMesh(body) => carved(body, scene.resolve(&body.path), seed, observer)?,
    };
    to_principal_axes(&mut spheres)?;
    let at_rest = spheres.columns()[3..9].iter().all(|column| column.iter().all(|v| *v == 0.0));
    if at_rest {
        set_rigid_rotation(&mut spheres, Vector3::z() * scene.scene.spin.rate_rad_s())?;
    }
    Ok(spheres)
}

/// Refuses contacts that no body of these spheres can be resolved with: building one takes long.
///
/// The stiffness of a body is at least that of two of its spheres, which fall onto each other.
///
/// # Errors
/// [`EvolveError::Contact`].
pub fn refuse_early(scene: &Scene) -> Result<(), EvolveError> {
    if let Body::PackedEllipsoid(body) = &scene.body {
        let mass = Grain { radius: body.radius_m, density: body.grain_density_kg_m3 }.mass();
        let mut pair = Spheres::default();
        for side in [-1.0, 1.0] {
            pair.push([side * body.radius_m, 0.0, 0.0], [0.0; 3], [0.0; 3], mass, body.radius_m);
        }
        ContactLaw::of(scene).stiffness(&pair).map_err(EvolveError::Contact)?;
    }
    Ok(())
}

/// Packs and compacts an ellipsoid until the compact body has the ratios wanted.
fn packed(
    body: &PackedEllipsoid,
    scene: &Scene,
    seed: Seed,
    observer: &mut dyn Observer,
) -> Result<Spheres, EvolveError> {
    let asked = EllipsoidPacking {
        count: body.spheres as usize,
        grain: Grain { radius: body.radius_m, density: body.grain_density_kg_m3 },
        b_over_a: body.b_over_a,
        c_over_a: body.c_over_a,
        packing_fraction: PACKING_FRACTION,
        seed,
    };
    // The recipe of the collapse is fixed, so that scenes that differ in their contacts only start from the same spheres.
    let contact = HardSphereParameters::default();
    let compact = compact_ellipsoid(&asked, scene.spin.rate_rad_s(), &contact, |stretches| {
        observer.progress(Progress::Building { stretches });
        !observer.interrupted()
    })?;
    let (b, c) = (compact.b_over_a, compact.c_over_a);
    if (b - body.b_over_a).abs().max((c - body.c_over_a).abs()) > RATIO_WARNING {
        observer.warn(&format!(
            "axis ratios of {} and {} were asked for; compaction at a period of {} h leads to {b:.3} and {c:.3}",
            body.b_over_a, body.c_over_a, scene.spin.period_h
        ));
    }
    Ok(compact.spheres)
}

fn from_file(path: PathBuf, scene: &SceneFile, observer: &mut dyn Observer) -> Result<Spheres, EvolveError> {
    let mut spheres = read_aggregate(&path)?;
    if let Some(report) = ContactLaw::of(&scene.scene).part_overlaps(&mut spheres)? {
        observer.warn(&format!(
            "{}: pushed {} overlapping pairs apart, the deepest by {:.2e} radii",
            path.display(),
            report.overlap_repairs,
            report.max_overlap_over_radius
        ));
    }
    Ok(spheres)
}

fn carved(body: &CarvedMesh, path: PathBuf, seed: Seed, observer: &mut dyn Observer) -> Result<Spheres, EvolveError> {
    let read = read_mesh(&path, body.unit.metres())?;
    for remark in read.remarks() {
        observer.warn(&format!("{}: {remark}", path.display()));
    }
    let mesh = read.mesh;
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
