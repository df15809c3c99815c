//! The aggregate that a scene describes: spheres turning rigidly about their axis of largest moment, not yet settled.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use pkd::Spheres;
use pkd::clusters::clusters;
use pkd::equilibrium::compact_ellipsoid;
use pkd::frame::{set_rigid_rotation, to_principal_axes};
use pkd::hard_sphere::HardSphereParameters;
use pkd::mass_properties::mass_properties;
use pkd::packing::{EllipsoidPacking, Grain, PACKING_FRACTION, Seed, carve, hcp_lattice, random_fill};
use tiling::inside::Inside;

use super::blame::largest_density;
use super::engine::ContactLaw;
use super::{EvolveError, Observer, Progress};
use crate::exchange::{read_aggregate, read_mesh};
use crate::scene::{
    Body, CarvedMesh, Contact, PackedEllipsoid, Packing, Scene, SceneFile, SettlingCost, USUAL_DENSITIES,
    about_density, oddities, shortest_period_h, touching_pair,
};

/// Random numbers of the body come from this stream of the scene's seed.
const BODY_STREAM: u64 = 0;

/// Axis ratios farther than this from the scene's are told to the user.
const RATIO_WARNING: f64 = 0.03;

/// Spheres of a file farther from the rest than this, radii, are told to the user.
const FAR_OVER_RADIUS: f64 = 1.0;

/// Largest sphere that a mesh is filled with, over the smallest half width of the body: fewer do not give its shape.
const LARGEST_SPHERE: f64 = 0.2;
/// Most spheres that a mesh is filled with.
const MOST_SPHERES: f64 = 1e7;
/// Share of a volume that close-packed spheres fill.
const DENSEST: f64 = 0.74;

/// Constructs the body of `scene` in its principal-axis frame.
///
/// It turns rigidly about z at the scene's period, unless it comes from a file in which spheres already move.
///
/// # Errors
/// A file that cannot be read or understood, or spheres that cannot be packed or freed of overlaps.
pub fn aggregate(scene: &SceneFile, observer: &mut dyn Observer) -> Result<Spheres, EvolveError> {
    oddities(&scene.scene).iter().for_each(|odd| observer.warn(odd));
    // Before the spheres are packed, where their number is known; else as soon as they are there.
    let known = SettlingCost::of_scene(&scene.scene);
    tell_cost(known.as_ref(), observer);
    let spheres = make(scene, observer)?;
    if known.is_none() {
        tell_cost(cost_of(&scene.scene, &spheres).as_ref(), observer);
    }
    Ok(spheres)
}

fn tell_cost(cost: Option<&SettlingCost>, observer: &mut dyn Observer) {
    if let Some(warning) = cost.and_then(SettlingCost::warning) {
        observer.warn(&warning);
    }
}

/// `None` for a body that does not rotate or whose contacts cannot be resolved, which is told elsewhere.
fn cost_of(scene: &Scene, spheres: &Spheres) -> Option<SettlingCost> {
    let omega = mass_properties(spheres).ok().map(|body| body.spin_rate()).filter(|omega| *omega > 0.0)?;
    let step_s = match &scene.contact {
        Contact::HardSphere(contact) => contact.step_s,
        Contact::SoftSphere(_) => ContactLaw::of(scene).stiffness(spheres).ok()??.step_s,
    };
    Some(SettlingCost::new(scene, spheres.len(), TAU / omega, step_s))
}

fn make(scene: &SceneFile, observer: &mut dyn Observer) -> Result<Spheres, EvolveError> {
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
    if is_at_rest(&spheres) {
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
        let pair = touching_pair(body.radius_m, body.grain_density_kg_m3);
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
    look_at(&spheres, &path, &scene.scene, observer)?;
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

/// Tells what is odd about the spheres of a file.
///
/// # Errors
/// [`EvolveError::TooFast`].
fn look_at(spheres: &Spheres, path: &Path, scene: &Scene, observer: &mut dyn Observer) -> Result<(), EvolveError> {
    let density = largest_density(spheres);
    if !USUAL_DENSITIES.contains(&density) {
        let about = about_density(density);
        observer.warn(&format!("{}: the densest sphere has {density:.3} kg/m3{about}", path.display()));
    }
    if spheres.len() == 1 {
        observer.warn(&format!("{}: one sphere only, which can neither settle nor move", path.display()));
        return Ok(());
    }
    let apart = spheres.len() - clusters(spheres, FAR_OVER_RADIUS).first().map_or(0, |body| body.members.len());
    if apart > 0 {
        let of = spheres.len();
        observer.warn(&format!(
            "{}: {apart} of {of} spheres lie apart from the rest, by more than their radius; they may fall onto it or get lost",
            path.display()
        ));
    }
    let (period_h, limit_h) = (scene.spin.period_h, shortest_period_h(density));
    match is_at_rest(spheres) && !scene.is_cohesive() && period_h < limit_h {
        true => Err(EvolveError::TooFast { file: path.to_owned(), period_h, density_kg_m3: density, limit_h }),
        false => Ok(()),
    }
}

/// Whether nothing moves, so that the scene's spin is given to the spheres.
fn is_at_rest(spheres: &Spheres) -> bool {
    spheres.columns()[3..9].iter().all(|column| column.iter().all(|v| *v == 0.0))
}

fn carved(body: &CarvedMesh, path: PathBuf, seed: Seed, observer: &mut dyn Observer) -> Result<Spheres, EvolveError> {
    let read = read_mesh(&path, body.unit.metres())?;
    for remark in read.remarks() {
        observer.warn(&format!("{}: {remark}", path.display()));
    }
    let mesh = read.mesh;
    let solid = mesh.solid();
    let mesh = mesh.translated(solid.centre_of_mass.map(|c| -c));
    let mut half_widths = [0.0_f64; 3];
    for vertex in &mesh.vertices {
        for (half_width, coordinate) in half_widths.iter_mut().zip(vertex) {
            *half_width = half_width.max(coordinate.abs());
        }
    }
    let spheres = body.packing.spheres();
    let grain = Grain { radius: spheres.radius_m, density: spheres.grain_density_kg_m3 };
    if let Some(fault) = does_not_fit(half_widths, solid.volume, grain.radius) {
        return Err(EvolveError::Unit { file: path, fault, unit: body.unit.name() });
    }
    let block = match &body.packing {
        Packing::Random(_) => random_fill(half_widths, grain, seed)?,
        Packing::Hcp(_) => hcp_lattice(half_widths, grain)?,
    };
    let inside = Inside::new(mesh)?;
    Ok(carve(&block, |point| inside.contains(point))?)
}

/// Why a body of these half widths and volume is not one of spheres of this radius, SI.
fn does_not_fit(half_widths: [f64; 3], volume: f64, radius: f64) -> Option<String> {
    let smallest = half_widths.into_iter().fold(f64::INFINITY, f64::min);
    let [x, y, z] = half_widths.map(|half_width| 2.0 * half_width);
    if radius > LARGEST_SPHERE * smallest {
        return Some(format!(
            "the body is {x:.4} x {y:.4} x {z:.4} m, and spheres of {radius} m do not give its shape"
        ));
    }
    let count = DENSEST * volume / Grain { radius, density: 1.0 }.mass();
    (count > MOST_SPHERES).then(|| {
        format!(
            "the body is {x:.4e} x {y:.4e} x {z:.4e} m and takes about {count:.0e} spheres of {radius} m (at most 1e7)"
        )
    })
}
