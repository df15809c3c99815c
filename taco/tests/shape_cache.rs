//! A re-tiled shape has the table of a fresh one, to the last bit; the axes of the body enter as a rotation.

mod common;

use common::{at_obliquities, bumpy, lambert, off, table};
use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;
use taco::{Orbit, Pose, Sampling, ShapeCache, Surface, torque_table_of_facets};
use tiling::Mesh;

fn cache(mesh: &Mesh, surface: &Surface, sampling: &Sampling) -> ShapeCache {
    ShapeCache::new(mesh.clone(), surface, &Orbit::default(), sampling).expect("a valid mesh")
}

/// Centre and axes some way off those of the mesh.
fn pose(angles: [f64; 3], centre: [f64; 3]) -> Pose {
    let rotation = Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
    let m = rotation.matrix();
    Pose { centre, axes: [0, 1, 2].map(|i| [0, 1, 2].map(|j| m[(i, j)])) }
}

/// The mesh with the vertices within `reach` of vertex `middle` pushed out or in by the factor `stretch` at most.
fn dented(mesh: &Mesh, middle: usize, reach: f64, stretch: f64) -> Mesh {
    let mut dented = mesh.clone();
    let centre = Vector3::from(mesh.vertices[middle]);
    for v in &mut dented.vertices {
        let near = 1.0 - (Vector3::from(*v) - centre).norm() / reach;
        if near > 0.0 {
            *v = v.map(|c| c * (1.0 + (stretch - 1.0) * near));
        }
    }
    dented
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn prop_retiled_shape_equals_a_fresh_one_to_the_last_bit(
        changes in prop::collection::vec((0usize..250, 0.15f64..0.5, 0.6f64..1.5, any::<bool>()), 1..4),
        angles in prop::array::uniform3(-3.0f64..3.0),
        facet_samples in prop::sample::select(vec![1usize, 4]),
    ) {
        let sampling = Sampling { azimuth_bins: 24, declination_nodes: 9, facet_samples, ..Sampling::default() };
        let surface = Surface::default();
        let mut mesh = bumpy(250);
        let mut poses = [Pose::default(), pose(angles, [0.02, -0.01, 0.03])].into_iter().cycle();
        let mut pose = poses.next().unwrap();
        let mut kept = cache(&mesh, &surface, &sampling);
        kept.torque_table(&pose).unwrap();
        for (middle, reach, stretch, turns) in changes {
            mesh = dented(&mesh, middle, reach, stretch);
            if turns {
                pose = poses.next().unwrap();
            }
            let touched = kept.retile(mesh.clone()).unwrap();
            prop_assert!(touched <= mesh.facets.len());
            let fresh = cache(&mesh, &surface, &sampling).torque_table(&pose).unwrap();
            prop_assert_eq!(&kept.torque_table(&pose).unwrap(), &fresh);
            // And again, now that everything is known.
            prop_assert_eq!(&kept.torque_table(&pose).unwrap(), &fresh);
        }
    }
}

#[test]
fn cached_table_in_the_frame_of_the_mesh_is_the_plain_table() {
    let mesh = bumpy(300);
    for surface in [Surface::default(), Surface { shadows: false, sky_blockage: false, ..Surface::default() }] {
        let plain = table(&mesh, &surface);
        assert_eq!(cache(&mesh, &surface, &Sampling::default()).torque_table(&Pose::default()).unwrap(), plain);
    }
}

/// Between the azimuths horizons are great circles, which ones depends on where the azimuths begin: to the error of 480.
#[test]
fn pose_is_the_same_as_a_mesh_turned_to_its_axes() {
    let mesh = bumpy(300);
    for surface in [Surface::default(), lambert(0.3), Surface { sky_blockage_reflected: true, ..Surface::default() }] {
        for (angles, centre) in [([0.4, -0.2, 1.3], [0.1, 0.0, -0.2]), ([3.0, 0.1, -2.0], [0.0, 0.3, 0.0])] {
            let pose = pose(angles, centre);
            let turn = Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
            let turned = mesh.translated(centre.map(|c| -c)).rotated(turn.matrix());
            let sampling = Sampling { azimuth_bins: 480, ..Sampling::default() };
            let posed = cache(&mesh, &surface, &sampling).torque_table(&pose).unwrap();
            let off = off(&torque_table_of_facets(&turned, &surface, &Orbit::default(), &sampling).unwrap(), &posed);
            println!("{off:e}");
            assert!(off < 5e-4, "{off}");
        }
    }
}

#[test]
fn only_what_a_dent_touches_is_looked_at_again() {
    let mesh = bumpy(1000);
    let mut cache = cache(&mesh, &Surface::default(), &at_obliquities(&[30.0]));
    assert_eq!(cache.retile(mesh.clone()).unwrap(), 0);
    let touched = cache.retile(dented(&mesh, 400, 0.15, 1.05)).unwrap();
    assert!(touched > 20 && touched < mesh.facets.len() / 4, "{touched} of {}", mesh.facets.len());
}

#[test]
fn another_mesh_altogether_is_computed_afresh_and_a_broken_one_is_refused() {
    let sampling = Sampling { azimuth_bins: 24, declination_nodes: 9, ..Sampling::default() };
    let mut kept = cache(&bumpy(100), &Surface::default(), &sampling);
    kept.torque_table(&Pose::default()).unwrap();
    let other = bumpy(150);
    assert_eq!(kept.retile(other.clone()).unwrap(), other.facets.len());
    let fresh = torque_table_of_facets(&other, &Surface::default(), &Orbit::default(), &sampling).unwrap();
    assert_eq!(kept.torque_table(&Pose::default()).unwrap(), fresh);
    assert!(kept.retile(Mesh::default()).is_err());
    assert_eq!(kept.torque_table(&Pose::default()).unwrap(), fresh);
}
