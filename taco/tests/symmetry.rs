//! What symmetry demands of YORP torques.

mod common;

use common::{at_obliquities, bumpy, centred, lambert, off, peak, rings, table};
use nalgebra::Rotation3;
use taco::{Orbit, Sampling, Surface, TorqueTable, torque_table_of_facets};
use tiling::Mesh;

/// Torque in units of pressure times radius cubed.
fn relative_peak(table: &TorqueTable, radius: f64) -> f64 {
    let worst = peak(&table.spin_torque_n_m[0]).max(peak(&table.obliquity_torque_n_m[0]));
    worst / (Orbit::default().mean_pressure_pa() * radius.powi(3))
}

#[test]
fn mirror_symmetric_sphere_and_ellipsoid_have_no_torque() {
    for axes in [[1.0, 1.0, 1.0], [1.0, 0.8, 0.6], [700.0, 490.0, 490.0]] {
        let mesh = rings(20, 40, axes, |_, _| 1.0);
        mesh.check().expect("closed");
        for surface in [Surface::default(), lambert(0.1)] {
            let table = table(&mesh, &surface);
            assert_eq!(table.shaded_facets, 0);
            let torque = relative_peak(&table, axes[0]);
            assert!(torque < 1e-12, "{axes:?}: {torque:e}");
        }
    }
}

#[test]
fn mirror_symmetric_body_with_shadows_has_no_torque() {
    let waist = |_: f64, latitude: f64| 1.0 + 0.5 * (2.0 * latitude).sin().powi(2);
    let mesh = rings(20, 40, [1.0, 0.8, 1.2], waist);
    let table = table(&mesh, &Surface::default());
    assert!(table.shaded_facets > 100);
    let torque = relative_peak(&table, 1.0);
    assert!(torque < 1e-9, "{torque:e}");
}

#[test]
fn fibonacci_sphere_and_ellipsoid_have_next_to_no_torque() {
    for vertices in [394, 1594] {
        for axes in [[1.0, 1.0, 1.0], [1.0, 0.8, 0.6]] {
            let mut mesh = tiling::fibonacci::unit_sphere(vertices).unwrap();
            mesh.vertices.iter_mut().for_each(|v| (0..3).for_each(|k| v[k] *= axes[k]));
            let torque = relative_peak(&table(&centred(mesh), &Surface::default()), 1.0);
            println!("{vertices} {axes:?}: {torque:e}");
            assert!(torque < 1e-5, "{vertices} {axes:?}: {torque:e}");
        }
    }
}

#[test]
fn turning_about_the_spin_axis_changes_nothing() {
    let mesh = bumpy(394);
    let reference = table(&mesh, &Surface::default());
    assert!(reference.shaded_facets > 50, "{}", reference.shaded_facets);
    for angle in [0.1f64, 1.0, 2.5, 4.0] {
        let turned = mesh.rotated(Rotation3::from_axis_angle(&nalgebra::Vector3::z_axis(), angle).matrix());
        let change = off(&reference, &table(&turned, &Surface::default()));
        // The frame of a facet turns with it, so only round-off is left; 1e-3 is what a fixed grid would be allowed.
        assert!(change < 1e-6, "{angle}: {change:e}");
    }
}

fn mirrored(mesh: &Mesh) -> Mesh {
    Mesh {
        vertices: mesh.vertices.iter().map(|[x, y, z]| [*x, -y, *z]).collect(),
        facets: mesh.facets.iter().map(|[a, b, c]| [*a, *c, *b]).collect(),
    }
}

#[test]
fn mirroring_in_a_meridian_plane_flips_both_torques() {
    let mesh = bumpy(394);
    let mut image = table(&mirrored(&mesh), &Surface::default());
    for row in image.spin_torque_n_m.iter_mut().chain(&mut image.obliquity_torque_n_m) {
        row.iter_mut().for_each(|t| *t = -*t);
    }
    let change = off(&table(&mesh, &Surface::default()), &image);
    assert!(change < 1e-6, "{change:e}");
}

#[test]
fn spin_torque_is_even_and_obliquity_torque_odd_about_90_deg() {
    let table = table(&bumpy(394), &Surface::default());
    let (spin, tilt) = (&table.spin_torque_n_m[0], &table.obliquity_torque_n_m[0]);
    for k in 0..37 {
        assert_eq!(spin[k], spin[36 - k]);
        assert_eq!(tilt[k], -tilt[36 - k]);
    }
    assert_eq!([tilt[0], tilt[18], tilt[36]], [0.0; 3]);
    assert!(peak(tilt) > 0.0);
}

#[test]
fn doubling_the_size_multiplies_the_torque_by_eight() {
    let mesh = bumpy(394);
    let (small, large) = (table(&mesh, &Surface::default()), table(&mesh.scaled(2.0), &Surface::default()));
    for (s, l) in small.spin_torque_n_m[0].iter().zip(&large.spin_torque_n_m[0]) {
        assert!((l - 8.0 * s).abs() < 1e-12 * 8.0 * peak(&small.spin_torque_n_m[0]));
    }
}

#[test]
fn torque_scales_with_the_mean_flux() {
    let mesh = bumpy(100);
    let at = |orbit| torque_table_of_facets(&mesh, &Surface::default(), &orbit, &Sampling::default()).unwrap();
    let near = at(Orbit::default());
    let far = at(Orbit { semimajor_axis_au: 2.0, eccentricity: 0.6 });
    // 1 / (4 * 0.8)
    let ratio = far.spin_torque_n_m[0][7] / near.spin_torque_n_m[0][7];
    assert!((ratio - 0.3125).abs() < 1e-12, "{ratio}");
}

#[test]
fn lambert_torque_without_blockage_does_not_depend_on_the_albedo() {
    let mesh = bumpy(200);
    assert!(off(&table(&mesh, &lambert(0.0)), &table(&mesh, &lambert(0.9))) < 1e-12);
}

#[test]
fn a_list_of_obliquities_gives_the_values_of_the_grid() {
    let mesh = bumpy(200);
    let grid = table(&mesh, &Surface::default());
    let list =
        torque_table_of_facets(&mesh, &Surface::default(), &Orbit::default(), &at_obliquities(&[35.0, 90.0, 145.0]))
            .unwrap();
    for (k, n) in [7, 18, 29].into_iter().enumerate() {
        assert_eq!(list.spin_torque_n_m[0][k], grid.spin_torque_n_m[0][n]);
        assert_eq!(list.obliquity_torque_n_m[0][k], grid.obliquity_torque_n_m[0][n]);
    }
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let mesh = bumpy(394);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| table(&mesh, &Surface::default()))
    };
    let one = on(1);
    for threads in [2, 3] {
        assert_eq!(one, on(threads));
    }
}
