//! One shape of the body with its tiling and torques, in the original frame of object 0.
//!
//! The frame, the equivalent ellipsoid and the tiling's connectivity are fixed at object 0 (Cotto-Figueroa et al. 2015,
//! section 2.4.2). Every later object is superposed on the previous one by its unmoved spheres, and those that have done no
//! more than rattle keep their rows exactly. So an undisturbed neighbourhood keeps its tiling bit for bit and the frame does not
//! drift, while the surface follows what shifted with a movement, though less than counts as one.

use nalgebra::{Matrix3, Vector3};
use pkd::Spheres;
use pkd::effective_potential::{effective_potentials, enclosed_mass_fractions};
use pkd::frame::set_rigid_rotation;
use pkd::mass_properties::mass_properties;
use taco::{BodyMesh, Pose, TorqueInterpolant, TorqueTable};
use tiling::checks::FitReport;
use tiling::hull::sphere_hull_volume;
use tiling::implicit::ImplicitSurface;
use tiling::project::EllipsoidTiling;
use tiling::{Mesh, Previous, project};

use super::EvolveError;
use super::block::positions;
use super::movement::Movement;
use super::rigid::TorqueErrors;
use super::spin::TorqueFunction;
use crate::scene::{Scene, TilingOptions};
use crate::store::*;

impl TorqueFunction for TorqueInterpolant {
    fn at(&self, obliquity: f64, omega: f64) -> (f64, f64) {
        TorqueInterpolant::at(self, obliquity, omega)
    }
}

/// A configuration ready for spin legs.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// What is stored of it.
    pub record: ConfigurationRecord,
    /// Its torques between the nodes.
    pub torque: TorqueInterpolant,
}

impl Shape {
    /// The shape of a stored configuration.
    ///
    /// # Errors
    /// A torque table that no build of this program can have written.
    pub fn from_record(scene: &Scene, record: ConfigurationRecord) -> Result<Self, EvolveError> {
        let torque = interpolant(scene, &record.torque)?;
        Ok(Self { record, torque })
    }

    /// Errors of the torques.
    pub fn torque_errors(&self) -> TorqueErrors {
        let torque = &self.record.torque;
        TorqueErrors { spin: torque.spin_torque_error, obliquity: torque.obliquity_torque_error }
    }

    /// Moment of inertia about the spin axis, kg m^2.
    pub fn inertia(&self) -> f64 {
        self.record.moments_kg_m2[2]
    }
}

/// The original frame and the ellipsoid in it: made from object 0, the same for the whole run.
#[derive(Debug, Clone, PartialEq)]
pub struct Original {
    ellipsoid: EllipsoidTiling,
    frame_rotation: [[f64; 3]; 3],
}

impl Original {
    /// The principal-axis frame of `spheres` and the ellipsoid that has their B1 axis ratios and B3 density.
    ///
    /// # Errors
    /// Spheres without a hull.
    pub fn new(scene: &Scene, spheres: &Spheres) -> Result<Self, EvolveError> {
        let properties = mass_properties(spheres)?;
        let axes = properties.deeve_axes();
        let volume = sphere_hull_volume(&spheres.x, &spheres.y, &spheres.z, &spheres.radius)?;
        let scale = (volume / (4.0 / 3.0 * std::f64::consts::PI * axes.product())).cbrt();
        let ellipsoid = EllipsoidTiling::new((axes * scale).into(), scene.tiling.vertices())?;
        Ok(Self { ellipsoid, frame_rotation: rows(&properties.axes.transpose()) })
    }

    /// The frame and ellipsoid on record.
    ///
    /// # Errors
    /// Axes that no build of this program can have written.
    pub fn from_record(scene: &Scene, record: &TilingRecord) -> Result<Self, EvolveError> {
        let ellipsoid = EllipsoidTiling::new(record.ellipsoid_axes_m, scene.tiling.vertices())?;
        Ok(Self { ellipsoid, frame_rotation: record.frame_rotation })
    }

    /// What is stored of it.
    pub fn record(&self) -> TilingRecord {
        TilingRecord {
            facets: self.ellipsoid.mesh.facets.clone(),
            ellipsoid_axes_m: self.ellipsoid.semi_axes,
            frame_rotation: self.frame_rotation,
        }
    }
}

/// Object 0: the settled aggregate of `state`.
///
/// # Errors
/// The body cannot be tiled, or its torques are not finite.
pub fn object_0(scene: &Scene, original: &Original, state: &State, ledger: &mut Ledger) -> Result<Shape, EvolveError> {
    let properties = mass_properties(&state.spheres)?;
    let to_original = properties.axes.transpose();
    let centres: Vec<[f64; 3]> = (0..state.spheres.len())
        .map(|i| (to_original * (Vector3::from(state.spheres.position(i)) - properties.centre)).into())
        .collect();
    let placed = placed(&state.spheres, &centres, &to_original)?;
    let origin = Origin { number: 0, after_leg: None, t_s: state.t_s };
    shape(scene, original, origin, &placed, &state.sphere_ids, None, ledger)
}

/// The object that follows `previous` after `movement`, with what each moved sphere did; `before` and `after` are the
/// states around the check that moved it.
///
/// # Errors
/// The body cannot be tiled, or its torques are not finite.
pub fn next_object(
    scene: &Scene,
    original: &Original,
    previous: &Shape,
    before: &State,
    after: &State,
    movement: &Movement,
    ledger: &mut Ledger,
) -> Result<(Shape, Vec<MovementRecord>), EvolveError> {
    let old = &previous.record;
    let to_original = movement.motion.inverse();
    let rattle = scene.evolution.rattle_radius_fraction;
    let mut old_rows = old.sphere_ids.iter().zip(&old.positions);
    let centres = after.sphere_ids.iter().enumerate().map(|(i, id)| {
        let row = old_rows.find(|(old_id, _)| *old_id == id).map(|(_, position)| *position);
        match row {
            Some(position) if !movement.moved[i] && movement.residual_m[i] <= rattle * after.spheres.radius[i] => {
                position
            }
            _ => to_original.apply(Vector3::from(after.spheres.position(i))).into(),
        }
    });
    let centres: Vec<[f64; 3]> = centres.collect();
    let placed = placed(&after.spheres, &centres, &to_original.rotation)?;
    let origin = Origin { number: old.configuration + 1, after_leg: Some(before.leg), t_s: after.t_s };
    let earlier = Earlier::new(scene, original, old, [before, after])?;
    let shape = shape(scene, original, origin, &placed, &after.sphere_ids, Some(&earlier), ledger)?;
    Ok((shape, movements(before, after, movement)?))
}

/// Which spheres moved how far, and how deep they sat before.
fn movements(before: &State, after: &State, movement: &Movement) -> Result<Vec<MovementRecord>, EvolveError> {
    let properties = mass_properties(&before.spheres)?;
    let potentials = effective_potentials(&before.spheres, properties.angular_velocity())?;
    let depths = enclosed_mass_fractions(&potentials);
    let mut rows = before.sphere_ids.iter().zip(&depths);
    let mut moved = Vec::new();
    for (i, id) in after.sphere_ids.iter().enumerate() {
        let depth = rows.find(|(row, _)| *row == id).map_or(f64::NAN, |(_, depth)| *depth);
        if movement.moved[i] {
            moved.push(MovementRecord {
                sphere: *id,
                displacement_m: movement.residual_m[i],
                enclosed_mass_fraction: depth,
            });
        }
    }
    Ok(moved)
}

/// Where an object comes from.
#[derive(Clone, Copy)]
struct Origin {
    number: u32,
    after_leg: Option<u32>,
    t_s: f64,
}

/// Tiles the `placed` spheres (original frame), starting from the previous tiling where there is one, and computes their
/// moments and torques.
fn shape(
    scene: &Scene,
    original: &Original,
    origin: Origin,
    placed: &Spheres,
    ids: &[u32],
    earlier: Option<&Earlier>,
    ledger: &mut Ledger,
) -> Result<Shape, EvolveError> {
    let properties = mass_properties(placed)?;
    let body_axes = properties.axes.transpose();
    let (fit, hull) = ledger.time(Part::Tiling, || {
        let hull = sphere_hull_volume(&placed.x, &placed.y, &placed.z, &placed.radius)?;
        Ok::<_, EvolveError>((fit(scene, original, origin, placed, earlier)?, hull))
    })?;
    let report = FitReport::new(&original.ellipsoid, &fit.mesh);
    let pose = Pose { centre: properties.centre.into(), axes: rows(&body_axes) };
    let body = BodyMesh::posed(&fit.mesh, &pose)
        .map_err(|source| EvolveError::Surface { configuration: origin.number, source })?;
    let table = ledger.time(Part::Torque, || {
        let (surface, orbit) = (scene.surface.to_taco(), scene.orbit.to_taco());
        taco::torque_table(&body, &surface, &orbit, &scene.torque.to_taco())
    })?;
    let record = ConfigurationRecord {
        configuration: origin.number,
        after_leg: origin.after_leg,
        t_s: origin.t_s,
        mass_kg: properties.mass,
        sphere_ids: ids.to_vec(),
        positions: positions(placed),
        body_axes: rows(&body_axes),
        centre_of_mass: properties.centre.into(),
        moments_kg_m2: properties.moments.into(),
        b1_axes_m: properties.deeve_axes().into(),
        b2_axes_m: properties.half_extents.into(),
        densities_kg_m3: [
            properties.deeve_density(),
            properties.extents_density(),
            properties.mass / hull,
            properties.mass / report.volume,
        ],
        vertices: fit.mesh.vertices,
        vertices_kept: fit.kept as u32,
        vertices_flagged: fit.flagged.len() as u32,
        facets_folded: report.folded.len() as u32,
        torque: TorqueRecord {
            obliquity: table.obliquity,
            spin_rate: table.omega,
            spin_torque: table.spin_torque_n_m.concat(),
            obliquity_torque: table.obliquity_torque_n_m.concat(),
            spin_torque_error: table.error.spin_torque_n_m,
            obliquity_torque_error: table.error.obliquity_torque_n_m,
        },
    };
    Shape::from_record(scene, record)
}

/// The spheres of `present` at `centres`, turning rigidly as `motion` turns their angular momentum: a body in the
/// original frame whose principal axes have the spin along +z.
fn placed(present: &Spheres, centres: &[[f64; 3]], to_original: &Matrix3<f64>) -> Result<Spheres, EvolveError> {
    let mut spheres = Spheres::default();
    for (i, centre) in centres.iter().enumerate() {
        spheres.push(*centre, [0.0; 3], [0.0; 3], present.mass[i], present.radius[i]);
    }
    let omega = mass_properties(present)?.angular_velocity();
    set_rigid_rotation(&mut spheres, to_original * omega)?;
    Ok(spheres)
}

/// The tiling before a movement and the surface that it was fitted to.
struct Earlier {
    mesh: Mesh,
    surface: ImplicitSurface,
}

impl Earlier {
    /// Of a configuration; the radii of its spheres are those of the `states` around the movement.
    fn new(
        scene: &Scene,
        original: &Original,
        record: &ConfigurationRecord,
        states: [&State; 2],
    ) -> Result<Self, EvolveError> {
        let radius_of = |id: &u32| {
            let of = |state: &State| Some(state.spheres.radius[state.sphere_ids.iter().position(|known| known == id)?]);
            states.into_iter().find_map(of)
        };
        let mut spheres = Spheres::default();
        for (id, centre) in record.sphere_ids.iter().zip(&record.positions) {
            if let Some(radius) = radius_of(id) {
                spheres.push(*centre, [0.0; 3], [0.0; 3], 1.0, radius);
            }
        }
        let mesh = Mesh { vertices: record.vertices.clone(), facets: original.ellipsoid.mesh.facets.clone() };
        Ok(Self { mesh, surface: surface_of(scene, &spheres)? })
    }
}

fn surface_of(scene: &Scene, s: &Spheres) -> Result<ImplicitSurface, EvolveError> {
    let TilingOptions { exponent, level, .. } = scene.tiling;
    Ok(ImplicitSurface::new(&s.x, &s.y, &s.z, &s.radius, exponent, level)?)
}

fn fit(
    scene: &Scene,
    original: &Original,
    origin: Origin,
    spheres: &Spheres,
    earlier: Option<&Earlier>,
) -> Result<project::Tiling, EvolveError> {
    let surface = surface_of(scene, spheres)?;
    let tiling = match earlier {
        None => original.ellipsoid.projected(&surface),
        Some(Earlier { mesh, surface: before }) => {
            original.ellipsoid.retiled(&surface, Previous { mesh, surface: before })
        }
    };
    tiling.map_err(|source| EvolveError::Surface { configuration: origin.number, source: source.into() })
}

/// The look-up of a stored table.
fn interpolant(scene: &Scene, record: &TorqueRecord) -> Result<TorqueInterpolant, EvolveError> {
    let by_spin_rate = |values: &[f64]| values.chunks(record.obliquity.len().max(1)).map(<[f64]>::to_vec).collect();
    let table = TorqueTable {
        obliquity: record.obliquity.clone(),
        omega: record.spin_rate.clone(),
        spin_torque_n_m: by_spin_rate(&record.spin_torque),
        obliquity_torque_n_m: by_spin_rate(&record.obliquity_torque),
        error: taco::TorqueError::default(),
        transverse_force_n: Vec::new(),
        shaded_facets: 0,
    };
    Ok(table.interpolant(scene.torque.interpolation.to_taco())?)
}

fn rows(m: &Matrix3<f64>) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| m[(i, j)]))
}

#[cfg(test)]
mod tests {
    use pkd::packing::{Grain, carve, hcp_lattice};

    use super::*;
    use crate::evolve::block::Aggregate;
    use crate::evolve::check::compare;
    use crate::evolve::settling::begin;

    /// Shifts of 0.03, 0.15 and 0.4 radii: the first is rattling, the third a movement, the second neither.
    #[test]
    fn the_surface_follows_shifts_beyond_rattling_and_nothing_else() {
        let text = r#"{"body": {"packed_ellipsoid": {"spheres": 10, "radius_m": 50, "grain_density_kg_m3": 2960, "b_over_a": 1, "c_over_a": 1}},
            "tiling": {"facets": 100}}"#;
        let scene = Scene::parse(text, std::path::Path::new("test")).unwrap();
        let block = hcp_lattice([400.0; 3], Grain { radius: 50.0, density: 2960.0 }).unwrap();
        let inside = |[x, y, z]: [f64; 3]| (x / 320.0).powi(2) + (y / 260.0).powi(2) + (z / 220.0).powi(2) < 1.0;
        let mut spheres = carve(&block, inside).unwrap();
        set_rigid_rotation(&mut spheres, Vector3::z() * 1.7e-4).unwrap();
        let before = begin(&scene, spheres).unwrap();
        let original = Original::new(&scene, &before.spheres).unwrap();
        let mut ledger = Ledger::default();
        let first = object_0(&scene, &original, &before, &mut ledger).unwrap();

        let mut after = before.clone();
        for (sphere, shift) in [(0, 0.03), (1, 0.15), (2, 0.4)] {
            after.spheres.z[sphere] += shift * 50.0;
        }
        let movement = compare(&scene, &first.record, &Aggregate::of(&after));
        let (next, moved) = next_object(&scene, &original, &first, &before, &after, &movement, &mut ledger).unwrap();
        let shifts: Vec<f64> = (first.record.positions.iter().zip(&next.record.positions))
            .map(|(old, new)| (Vector3::from(*new) - Vector3::from(*old)).norm() / 50.0)
            .collect();
        assert_eq!(moved.iter().map(|m| m.sphere).collect::<Vec<_>>(), [2]);
        assert_eq!(shifts[0], 0.0);
        assert!((shifts[1] - 0.15).abs() < 0.01 && (shifts[2] - 0.4).abs() < 0.01, "{shifts:?}");
        assert!(shifts[3..].iter().all(|shift| *shift == 0.0));
    }
}
