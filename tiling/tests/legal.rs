//! Tilings of bodies that are far from an ellipsoid bound a body all the same, and what did not move keeps its vertices.

use nalgebra::Vector3;
use proptest::prelude::*;
use tiling::{EllipsoidTiling, ImplicitSurface, Mesh, Placement, Previous, Tiling, sphere_hull_volume};

/// Spheres, (x, y, z, radius).
type Spheres = Vec<[f64; 4]>;

/// Equal spheres in hexagonal close packing within a ball of radius `reach` (sphere radii) about `centre`.
fn lobe(reach: f64, centre: [f64; 3]) -> Spheres {
    let mut spheres = Vec::new();
    for (layer, row, place) in (-9..=9).flat_map(|l| (-9..=9).flat_map(move |r| (-9..=9).map(move |p| (l, r, p)))) {
        let odd = f64::from(i32::rem_euclid(layer, 2));
        let x = 2.0 * f64::from(place) + f64::from(i32::rem_euclid(row, 2)) + odd;
        let y = 3f64.sqrt() * f64::from(row) + odd / 3f64.sqrt();
        let z = (8f64 / 3.0).sqrt() * f64::from(layer);
        if x * x + y * y + z * z < reach * reach {
            spheres.push([x + centre[0], y + centre[1], z + centre[2], 1.0]);
        }
    }
    spheres
}

fn column(spheres: &Spheres, k: usize) -> Vec<f64> {
    spheres.iter().map(|s| s[k]).collect()
}

fn surface(spheres: &Spheres) -> ImplicitSurface {
    let [x, y, z, radius] = [0, 1, 2, 3].map(|k| column(spheres, k));
    ImplicitSurface::new(&x, &y, &z, &radius, 2, 1.25).unwrap()
}

/// The ellipsoid of equal moments with the hull's volume; turns the spheres into its frame.
fn ellipsoid(spheres: &mut Spheres, vertices: usize) -> EllipsoidTiling {
    let weight = |s: &[f64; 4]| s[3].powi(3);
    let total: f64 = spheres.iter().map(weight).sum();
    let centre = spheres.iter().map(|s| Vector3::new(s[0], s[1], s[2]) * weight(s)).sum::<Vector3<f64>>() / total;
    let mut second = nalgebra::Matrix3::identity() * spheres.iter().map(|s| 0.2 * s[3].powi(5)).sum::<f64>();
    for s in spheres.iter() {
        let d = Vector3::new(s[0], s[1], s[2]) - centre;
        second += d * d.transpose() * weight(s);
    }
    let eigen = second.symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|i, j| eigen.eigenvalues[*j].total_cmp(&eigen.eigenvalues[*i]));
    for s in spheres.iter_mut() {
        let d = Vector3::new(s[0], s[1], s[2]) - centre;
        for k in 0..3 {
            s[k] = eigen.eigenvectors.column(order[k]).dot(&d);
        }
    }
    let [x, y, z, radius] = [0, 1, 2, 3].map(|k| column(spheres, k));
    let hull = sphere_hull_volume(&x, &y, &z, &radius).unwrap();
    let axes = order.map(|k| (5.0 * eigen.eigenvalues[k] / total).sqrt());
    let scale = (hull / (4.0 / 3.0 * std::f64::consts::PI * axes.iter().product::<f64>())).cbrt();
    EllipsoidTiling::new(axes.map(|a| a * scale), vertices).unwrap()
}

/// Tiles a body, says what became of it, and checks that it is one.
fn tiled(name: &str, mut spheres: Spheres, vertices: usize) -> Tiling {
    let ellipsoid = ellipsoid(&mut spheres, vertices);
    let fitted = ellipsoid.projected(&surface(&spheres)).unwrap_or_else(|fault| panic!("{name}, {vertices}: {fault}"));
    assert!(fitted.mesh.check_body().is_ok(), "{name}");
    let count = |p: Placement| fitted.flagged.iter().filter(|f| f.placement == p).count();
    let solid: f64 = spheres.iter().map(|s| 4.0 / 3.0 * std::f64::consts::PI * s[3].powi(3)).sum();
    println!(
        "{name}: {} spheres, {vertices} vertices, {} mended, {} radial, {} nearest, volume {:.2} of the spheres'",
        spheres.len(),
        count(Placement::Mended),
        count(Placement::Radial),
        count(Placement::Nearest),
        fitted.mesh.volume() / solid
    );
    fitted
}

fn bodies() -> Vec<(&'static str, Spheres)> {
    let two = |reach: f64, other: f64, gap: f64| {
        let mut both = lobe(reach, [0.0; 3]);
        both.extend(lobe(other, [reach + other + gap, 0.3, 0.2]));
        both
    };
    let line = |n: i32| (0..n).map(|i| [2.0 * f64::from(i), 0.0, 0.0, 1.0]).collect::<Spheres>();
    let ring = |n: i32| {
        let radius = 1.0 / (std::f64::consts::PI / f64::from(n)).sin();
        let angle = |i: i32| std::f64::consts::TAU * f64::from(i) / f64::from(n);
        (0..n).map(|i| [radius * angle(i).cos(), radius * angle(i).sin(), 0.0, 1.0]).collect::<Spheres>()
    };
    let mut loose = lobe(4.0, [0.0; 3]);
    loose.extend([[9.0, 0.0, 0.0, 1.0], [0.0, 7.0, 6.0, 1.0]]);
    let mut three = two(4.0, 3.0, -0.5);
    three.extend(lobe(3.0, [-1.0, 7.0, 0.0]));
    let mut arm = lobe(4.5, [0.0; 3]);
    arm.extend((0..6).map(|i| [5.5 + 1.9 * f64::from(i), 0.4 * f64::from(i), 0.0, 1.0]));
    vec![
        ("contact binary", two(5.8, 5.8, 0.3)),
        ("contact binary of unequal lobes", two(6.0, 3.5, 0.3)),
        ("two lobes grown together", two(5.0, 5.0, -2.0)),
        ("two lobes apart", two(4.5, 4.5, 2.0)),
        ("three lobes", three),
        ("two spheres", line(2)),
        ("a chain", line(12)),
        ("a ring", ring(20)),
        ("a body with loose spheres", loose),
        ("a body with an arm", arm),
        ("a flat sheet", (0..64).map(|i| [2.0 * f64::from(i % 8), 2.0 * f64::from(i / 8), 0.0, 1.0]).collect()),
        ("one sphere", vec![[0.0, 0.0, 0.0, 1.0]]),
    ]
}

#[test]
fn bodies_far_from_ellipsoids_have_legal_tilings() {
    for (name, spheres) in bodies() {
        for vertices in [52, 202, 394, 1594] {
            tiled(name, spheres.clone(), vertices);
        }
    }
}

/// The volume of the two lobes, not that of their hull.
#[test]
fn a_contact_binary_keeps_its_neck() {
    let (name, spheres) = bodies().swap_remove(0);
    let fitted = tiled(name, spheres.clone(), 1594);
    let [x, y, z, radius] = [0, 1, 2, 3].map(|k| column(&spheres, k));
    let hull = sphere_hull_volume(&x, &y, &z, &radius).unwrap();
    let volume = fitted.mesh.volume();
    println!("{:.3} of the hull", volume / hull);
    assert!(volume < 0.85 * hull, "{:.3}", volume / hull);
    let waist = fitted.mesh.vertices.iter().filter(|v| v[0].abs() < 1.0).map(|v| v[1].hypot(v[2]));
    let tallest = fitted.mesh.vertices.iter().map(|v| v[1].hypot(v[2])).fold(0.0, f64::max);
    assert!(waist.fold(0.0, f64::max) < 0.7 * tallest);
}

/// A sphere moves on one lobe: the other lobe and the neck keep their vertices to the last bit, mended ones included.
#[test]
fn mended_vertices_stay_where_nothing_moved() {
    for (name, mut spheres) in bodies() {
        let ellipsoid = ellipsoid(&mut spheres, 394);
        let before = surface(&spheres);
        let first = ellipsoid.projected(&before).unwrap();
        let same = ellipsoid.retiled(&before, Previous { mesh: &first.mesh, surface: &before }).unwrap();
        assert_eq!((same.kept, &same.mesh), (394, &first.mesh), "{name}");
        assert_eq!(same.flagged, first.flagged, "{name}");
        // Settled spheres jitter by far less than the tolerance.
        let jittered: Spheres = (spheres.iter().enumerate())
            .map(|(i, s)| [s[0] + 1e-6 * (i as f64).sin(), s[1], s[2] - 1e-6 * (i as f64).cos(), s[3]])
            .collect();
        let again = ellipsoid.retiled(&surface(&jittered), Previous { mesh: &first.mesh, surface: &before }).unwrap();
        assert_eq!(again.mesh, first.mesh, "{name}");
        // The outermost sphere to +x moves half a radius outward.
        if spheres.len() < 30 {
            continue;
        }
        let outermost = (0..spheres.len()).max_by(|i, j| spheres[*i][0].total_cmp(&spheres[*j][0])).unwrap();
        let mut moved = spheres.clone();
        moved[outermost][0] += 0.5;
        let second = ellipsoid.retiled(&surface(&moved), Previous { mesh: &first.mesh, surface: &before }).unwrap();
        assert!(second.mesh.check_body().is_ok() && second.moved > 0, "{name}");
        let far = |v: &[f64; 3]| v[0] < 0.0;
        let changed = (0..394).filter(|v| second.mesh.vertices[*v] != first.mesh.vertices[*v]);
        let far_changed = changed.filter(|v| far(&first.mesh.vertices[*v])).count();
        println!("{name}: kept {}, moved {}", second.kept, second.moved);
        assert_eq!(far_changed, 0, "{name}");
    }
}

/// A random walk of spheres, re-tiled at every step.
#[test]
fn every_tiling_of_a_moving_contact_binary_is_legal() {
    let (_, mut spheres) = bodies().swap_remove(0);
    let ellipsoid = ellipsoid(&mut spheres, 394);
    let mut before = surface(&spheres);
    let mut mesh: Mesh = ellipsoid.projected(&before).unwrap().mesh;
    let mut state = 1_u64;
    let mut uniform = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    for step in 0..60 {
        for s in spheres.iter_mut() {
            let shift = [uniform(), uniform(), uniform()];
            (0..3).for_each(|k| s[k] += 0.3 * shift[k]);
        }
        let now = surface(&spheres);
        let next = ellipsoid.retiled(&now, Previous { mesh: &mesh, surface: &before });
        let next = next.unwrap_or_else(|fault| panic!("step {step}: {fault}"));
        assert!(next.mesh.check_body().is_ok(), "step {step}");
        (mesh, before) = (next.mesh, now);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever cloud of spheres, however loose.
    #[test]
    fn prop_any_cloud_of_spheres_has_a_legal_tiling(
        spheres in prop::collection::vec((prop::array::uniform3(-6.0f64..6.0), 0.3f64..1.5), 1..60),
        vertices in prop::sample::select(vec![30usize, 100, 394]),
        stretch in prop::array::uniform3(0.3f64..2.0),
    ) {
        let spheres: Spheres =
            spheres.iter().map(|(c, r)| [c[0] * stretch[0], c[1] * stretch[1], c[2] * stretch[2], *r]).collect();
        tiled("cloud", spheres, vertices);
    }
}
