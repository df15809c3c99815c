//! Torques of single facets against closed forms, and of whole bodies against brute force.

mod common;

use common::{at_obliquities, bumpy, lambert, off, table};
use nalgebra::Vector3;
use std::f64::consts::{PI, TAU};
use taco::{HorizonMap, Orbit, Reflectance, Sampling, Surface, torque_table_of_facets};
use tiling::Mesh;

/// A facet of unit area with this centroid and normal.
fn facet(centroid: [f64; 3], normal: [f64; 3]) -> Mesh {
    let (c, n) = (Vector3::from(centroid), Vector3::from(normal));
    let u = n.cross(&Vector3::new(0.3, -0.5, 0.8)).normalize();
    let v = n.cross(&u);
    // Equilateral: circumradius r has area 3 sqrt(3)/4 r^2.
    let r = (4.0 / (3.0 * 3f64.sqrt())).sqrt();
    let corner = |k: f64| (c + (u * (TAU * k / 3.0).cos() + v * (TAU * k / 3.0).sin()) * r).into();
    Mesh { vertices: vec![corner(0.0), corner(1.0), corner(2.0)], facets: vec![[0, 1, 2]] }
}

fn black() -> Surface {
    Surface { reflectance: Reflectance::None, ..Surface::default() }
}

/// A single facet has kinks in declination where its pole nights begin, the worst case of the spline: many nodes.
fn fine(degrees: &[f64]) -> Sampling {
    Sampling { declination_nodes: 1441, ..at_obliquities(degrees) }
}

/// `d_z <Q>` and `d_r <K sin lambda cos eps / cos dec>` of a facet with n = (0.6, 0, 0.8), r = (0.3, 0.5, 0.2), which has
/// `d = r x n = (0.4, -0.12, -0.3)`; Lambert emission multiplies by -2/3 of the pressure.
#[test]
fn single_facet_matches_the_closed_forms() {
    let mesh = facet([0.3, 0.5, 0.2], [0.6, 0.0, 0.8]);
    let table = torque_table_of_facets(&mesh, &black(), &Orbit::default(), &fine(&[0.0, 30.0, 60.0, 90.0])).unwrap();
    let factor = -2.0 / 3.0 * Orbit::default().mean_pressure_pa();
    let expected = [(-0.05729578, 0.0), (-0.06090554, 0.02260795), (-0.07761221, 0.01756994), (-0.08620913, 0.0)];
    for (k, (spin, tilt)) in expected.into_iter().enumerate() {
        let got = (table.spin_torque_n_m[0][k] / factor, table.obliquity_torque_n_m[0][k] / factor);
        assert!((got.0 - spin).abs() < 1e-7 && (got.1 - tilt).abs() < 1e-7, "{k}: {got:?}");
    }
}

/// Mean insolation `<Q>` of a facet, from its spin torque; the centroid is to make `(r x n)_z = 1`.
fn mean_insolation(normal: [f64; 3], centroid: [f64; 3], degrees: f64) -> f64 {
    let table =
        torque_table_of_facets(&facet(centroid, normal), &black(), &Orbit::default(), &fine(&[degrees])).unwrap();
    table.spin_torque_n_m[0][0] / (-2.0 / 3.0 * Orbit::default().mean_pressure_pa())
}

#[test]
fn mean_insolation_of_the_equator_matches_the_closed_forms() {
    for (degrees, expected) in [(0.0, 1.0 / PI), (45.0, 0.2736977), (90.0, 2.0 / (PI * PI))] {
        let q = mean_insolation([1.0, 0.0, 0.0], [0.0, -1.0, 0.0], degrees);
        assert!((q - expected).abs() < 1e-6, "{degrees}: {q}");
    }
}

#[test]
fn mean_insolation_of_poles_and_of_the_sphere_match_the_closed_forms() {
    // A pole facet receives sin eps / pi, whatever its torque: taken by an arm that tips the normal a hair.
    let tip: f64 = 1e-4;
    for degrees in [10f64, 50.0, 90.0] {
        let q = mean_insolation([tip, 0.0, 1.0], [0.0, -1.0 / tip, 0.0], degrees);
        let expected = degrees.to_radians().sin() / PI;
        assert!((q * (1.0 + tip * tip).sqrt() - expected).abs() < 2e-5, "{degrees}: {q}");
        // Mean over the sphere, equal steps in the sine of the latitude.
        let n = 200;
        let mean = (0..n)
            .map(|k| (2.0 * f64::from(k) + 1.0) / f64::from(n) - 1.0)
            .map(|z| {
                let c = (1.0 - z * z).sqrt();
                mean_insolation([c, 0.0, z], [0.0, -1.0 / c, 0.0], degrees)
            })
            .sum::<f64>()
            / f64::from(n);
        assert!((mean - 0.25).abs() < 2e-5, "{degrees}: {mean}");
    }
}

/// Spin and obliquity torque by rays, hour angles and true longitudes, straight from their definition.
fn brute_force(mesh: &Mesh, obliquity: f64, longitudes: usize, hours: usize) -> (f64, f64) {
    let n = mesh.facets.len();
    let corners: Vec<_> = (0..n).map(|f| mesh.corners(f)).collect();
    let hidden = |from: &Vector3<f64>, sun: &Vector3<f64>, own: usize| {
        corners.iter().enumerate().any(|(g, [a, b, c])| {
            let (e1, e2) = (b - a, c - a);
            let q = sun.cross(&e2);
            let det = e1.dot(&q);
            if g == own || det == 0.0 {
                return false;
            }
            let t = from - a;
            let u = t.dot(&q) / det;
            let r = t.cross(&e1);
            let v = sun.dot(&r) / det;
            u >= 0.0 && v >= 0.0 && u + v <= 1.0 && e2.dot(&r) / det > 0.0
        })
    };
    // Spin axis z, e_1 = x: N = cos eps z - sin eps x.
    let (s, c) = obliquity.sin_cos();
    let mut torque = Vector3::zeros();
    for l in 0..longitudes {
        // Staggered, so that the grids of longitude and rotation do not beat.
        let lambda = TAU * (l as f64 + 0.5) / longitudes as f64;
        let sun = Vector3::new(lambda.sin() * c, -lambda.cos(), lambda.sin() * s);
        for h in 0..hours {
            let phase = TAU * (h as f64 + (l as f64 * 0.618_034).fract()) / hours as f64;
            let (sp, cp) = phase.sin_cos();
            let to_body = |v: Vector3<f64>| Vector3::new(cp * v.x + sp * v.y, cp * v.y - sp * v.x, v.z);
            let to_space = |v: Vector3<f64>| Vector3::new(cp * v.x - sp * v.y, cp * v.y + sp * v.x, v.z);
            let sun = to_body(sun);
            let mut sum = Vector3::zeros();
            for f in 0..n {
                let (normal, centroid) = (mesh.normal(f), mesh.centroid(f));
                let mu0 = normal.dot(&sun);
                if mu0 > 0.0 && !hidden(&centroid, &sun, f) {
                    sum -= centroid.cross(&normal) * (2.0 / 3.0 * mu0 * mesh.area(f));
                }
            }
            torque += to_space(sum);
        }
    }
    torque *= Orbit::default().mean_pressure_pa() / (longitudes * hours) as f64;
    (torque.z, torque.x)
}

#[test]
fn body_with_shadows_matches_brute_force() {
    let mesh = bumpy(60);
    let degrees = [0.0, 20.0, 60.0, 130.0];
    let table = torque_table_of_facets(&mesh, &lambert(0.2), &Orbit::default(), &at_obliquities(&degrees)).unwrap();
    assert!(table.shaded_facets > 10);
    let unshaded = Surface { shadows: false, ..lambert(0.2) };
    let unshaded = torque_table_of_facets(&mesh, &unshaded, &Orbit::default(), &at_obliquities(&degrees)).unwrap();
    let scale = common::peak(&table.spin_torque_n_m[0]);
    for (k, degree) in degrees.iter().enumerate() {
        let (spin, tilt) = brute_force(&mesh, degree.to_radians(), 36, 180);
        let (got_spin, got_tilt) = (table.spin_torque_n_m[0][k], table.obliquity_torque_n_m[0][k]);
        println!(
            "{degree}: {got_spin:e} {spin:e}, {got_tilt:e} {tilt:e}, no shadows {:e}",
            unshaded.spin_torque_n_m[0][k]
        );
        assert!((got_spin - spin).abs() < 0.01 * scale && (got_tilt - tilt).abs() < 0.01 * scale, "{degree}");
    }
    assert!(common::distance(&table.spin_torque_n_m[0], &unshaded.spin_torque_n_m[0]) > 0.03 * scale);
}

/// A slab that hovers over part of the body: the sky is open below and above it.
#[test]
fn body_below_an_overhang_matches_brute_force() {
    let mut mesh = bumpy(60);
    let first = mesh.vertices.len() as u32;
    let (low, high) = ([0.2, -0.6, 1.0], [1.4, 0.5, 1.1]);
    let corner = |i: usize| std::array::from_fn(|k| if i >> k & 1 == 0 { low[k] } else { high[k] });
    mesh.vertices.extend((0..8).map(corner));
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|q: &[u32; 4]| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]);
    mesh.facets.extend(triangles.map(|t| t.map(|v| v + first)));
    let map = HorizonMap::new(&mesh, 120).unwrap();
    let overhung = (0..mesh.facets.len()).filter(|f| map.horizon(*f).is_some_and(|h| !h.overhangs.is_empty())).count();
    assert!(overhung > 5, "{overhung}");
    let degrees = [25.0, 75.0];
    // Twelve facets of the slab are as large as the body, so that single edges of shadows matter.
    let sampling = Sampling { azimuth_bins: 480, ..at_obliquities(&degrees) };
    let table = torque_table_of_facets(&mesh, &lambert(0.2), &Orbit::default(), &sampling).unwrap();
    let scale = common::peak(&table.spin_torque_n_m[0]);
    for (k, degree) in degrees.iter().enumerate() {
        let (spin, tilt) = brute_force(&mesh, degree.to_radians(), 180, 60);
        let (got_spin, got_tilt) = (table.spin_torque_n_m[0][k], table.obliquity_torque_n_m[0][k]);
        println!("{degree}: {got_spin:e} {spin:e}, {got_tilt:e} {tilt:e}, {overhung} facets below the slab");
        assert!((got_spin - spin).abs() < 0.015 * scale && (got_tilt - tilt).abs() < 0.015 * scale, "{degree}");
    }
}

/// All light that leaves a Lambert surface leaves alike, absorbed before or not, and loses alike what the body blocks.
#[test]
fn blocked_reflection_makes_the_torque_of_a_lambert_body_independent_of_its_albedo() {
    let mesh = bumpy(300);
    let with = |bond_albedo| Surface { sky_blockage: true, sky_blockage_reflected: true, ..lambert(bond_albedo) };
    let black = table(&mesh, &with(0.0));
    for albedo in [0.1, 0.5, 1.0] {
        assert!(off(&black, &table(&mesh, &with(albedo))) < 1e-12);
        let unblocked = Surface { sky_blockage_reflected: false, ..with(albedo) };
        assert!(off(&black, &table(&mesh, &unblocked)) > 3e-3 * albedo);
    }
}
