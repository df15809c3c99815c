//! The hard-sphere integrator on whole bodies: what is conserved, what stays in shape, and that nothing but the spheres is state.

use nalgebra::Vector3;
use pkd::Spheres;
use pkd::frame::set_rigid_rotation;
use pkd::gravity::potential_energy;
use pkd::hard_sphere::{HardSphere, HardSphereParameters, Report};
use pkd::mass_properties::{MassProperties, mass_properties};
use pkd::packing::{EllipsoidPacking, Grain, PACKING_FRACTION, Seed, ellipsoid_packing};

const GRAIN: Grain = Grain { radius: 50.2, density: 2960.0 };

/// An ellipsoid of axis ratios 0.8 and 0.7, packed and turning in six hours.
fn packed(count: usize, seed: u64) -> Spheres {
    let mut body = ellipsoid_packing(&EllipsoidPacking {
        count,
        grain: GRAIN,
        b_over_a: 0.8,
        c_over_a: 0.7,
        packing_fraction: PACKING_FRACTION,
        seed: Seed { seed, stream: 0 },
    })
    .unwrap();
    set_rigid_rotation(&mut body, Vector3::z() * (std::f64::consts::TAU / 21_600.0)).unwrap();
    body
}

/// The same spheres with all distances multiplied, at rest.
fn dilated(mut body: Spheres, factor: f64) -> Spheres {
    for column in [&mut body.x, &mut body.y, &mut body.z] {
        column.iter_mut().for_each(|v| *v *= factor);
    }
    set_rigid_rotation(&mut body, Vector3::zeros()).unwrap();
    body
}

/// Evolves with the defaults, and looks at all pairs afterwards: the engine itself only sees those of its lists.
fn evolve(body: &mut Spheres, duration_s: f64) -> Report {
    let report = HardSphere::new(HardSphereParameters::default()).evolve(body, duration_s).unwrap();
    for j in 0..body.len() {
        for i in 0..j {
            let distance = (Vector3::from(body.position(j)) - Vector3::from(body.position(i))).norm();
            let overlap = body.radius[i] + body.radius[j] - distance;
            assert!(overlap < 1e-9 * body.radius[i].min(body.radius[j]), "{i} and {j} overlap by {overlap} m");
        }
    }
    report
}

fn bits(body: &Spheres) -> Vec<u64> {
    body.columns().iter().flat_map(|c| c.iter().map(|v| v.to_bits())).collect()
}

/// Sum of m |v| about the centre of mass, kg m/s: what momentum is compared with.
fn momentum_scale(body: &Spheres, of: &MassProperties) -> f64 {
    (0..body.len()).map(|i| body.mass[i] * (Vector3::from(body.velocity(i)) - of.velocity).norm()).sum()
}

/// Settles a body for four rotations, then follows it for ten and compares with the demands of a release.
fn ten_rotations(count: usize) -> Report {
    let mut body = packed(count, 1);
    evolve(&mut body, 4.0 * 21_600.0);
    let before = mass_properties(&body).unwrap();
    let period = std::f64::consts::TAU / before.spin_rate();
    let report = evolve(&mut body, 10.0 * period);
    let after = mass_properties(&body).unwrap();

    let l = (after.angular_momentum - before.angular_momentum).norm() / before.angular_momentum.norm();
    assert!(l < 1e-10, "angular momentum drifts by {l:e}");
    let p = after.mass * (after.velocity - before.velocity).norm() / momentum_scale(&body, &after);
    assert!(p < 1e-12, "momentum drifts by {p:e}");
    assert!(report.max_overlap_over_radius < 1e-6, "{report:?}");
    let radius = after.mean_radius() / before.mean_radius() - 1.0;
    assert!(radius.abs() < 0.002, "the mean radius changes by {radius}");
    let axes = after.deeve_axes().component_div(&before.deeve_axes()) - Vector3::repeat(1.0);
    assert!(axes.amax() < 0.005, "the axes change by {axes:?}");
    assert_eq!(report.counts.capped, 0);
    let counts = report.counts;
    assert_eq!(counts.collisions, counts.nominal + counts.slide + counts.collapse + counts.capped);
    report
}

#[test]
fn a_settled_body_conserves_and_keeps_its_shape_over_ten_rotations() {
    ten_rotations(120);
}

#[test]
#[ignore = "half a minute: the same for the size of body that the program is for"]
fn a_settled_body_of_a_thousand_spheres_keeps_its_shape() {
    println!("{:?}", ten_rotations(1000));
}

/// A cloud at rest falls together: energy only falls, no sphere gets lost in another, a compact body remains.
#[test]
fn a_loose_cloud_collapses_without_overlaps() {
    let mut body = dilated(packed(150, 2), 1.6);
    let energy = |s: &Spheres| mass_properties(s).unwrap().kinetic_energy + potential_energy(s);
    let start = mass_properties(&body).unwrap();
    let mut last = energy(&body);
    for _ in 0..8 {
        let report = evolve(&mut body, 1000.0);
        let now = energy(&body);
        // The leapfrog's own error of second order: (h / free-fall time)² of the energy at most.
        assert!(now < last + 1e-3 * last.abs() && report.max_overlap_over_radius < 1e-9, "{now:e} {last:e} {report:?}");
        last = now;
    }
    let end = mass_properties(&body).unwrap();
    assert!(end.mean_radius() < 0.75 * start.mean_radius(), "{} {}", end.mean_radius(), start.mean_radius());
    assert!(end.velocity.norm() < 1e-15);
}

/// Two bodies meet off centre at their mutual escape speed.
#[test]
fn two_bodies_merge_at_escape_speed() {
    let one = dilated(packed(60, 3), 1.0);
    let properties = mass_properties(&one).unwrap();
    let (mass, size) = (properties.mass, properties.half_extents.x);
    let speed = (2.0 * pkd::constants::G * 2.0 * mass / (3.0 * size)).sqrt();
    let mut both = Spheres::default();
    for side in [-0.5, 0.5] {
        for i in 0..one.len() {
            let [x, y, z] = one.position(i);
            let r = [x + side * 3.0 * size, y + side * size, z];
            both.push(r, [-side * speed, 0.0, 0.0], [0.0; 3], one.mass[i], one.radius[i]);
        }
    }
    let before = mass_properties(&both).unwrap();
    let report = evolve(&mut both, 10_000.0);
    let after = mass_properties(&both).unwrap();
    assert!(report.counts.collisions > 10_000 && report.max_overlap_over_radius < 1e-9, "{report:?}");
    let l = (after.angular_momentum - before.angular_momentum).norm() / before.angular_momentum.norm();
    assert!(l < 1e-12, "{l:e}");
    assert!(after.kinetic_energy < before.kinetic_energy);
}

/// Radii from 1 to 8: pebbles among boulders, all of one density.
#[test]
fn spheres_of_very_different_sizes_settle() {
    let mut body = dilated(packed(120, 4), 1.3);
    for i in 0..body.len() {
        let factor = [1.0, 0.5, 0.25, 0.125][i % 4];
        body.radius[i] *= factor;
        body.mass[i] *= f64::powi(factor, 3);
    }
    let report = evolve(&mut body, 8000.0);
    assert!(report.max_overlap_over_radius < 1e-9 && report.counts.collisions > 10_000, "{report:?}");
}

/// A sphere thrown far out must neither hide the rest from each other nor slow the search down to a crawl.
#[test]
fn a_sphere_far_away_costs_nothing() {
    let mut body = packed(100, 5);
    body.push([3e7, -2e6, 0.0], [0.3, 0.0, 0.0], [0.0; 3], GRAIN.mass(), GRAIN.radius);
    let report = evolve(&mut body, 2000.0);
    assert!(report.counts.list_rebuilds < 3 * report.steps, "{report:?}");
    assert!(report.counts.collisions > 10_000 && report.max_overlap_over_radius < 1e-9, "{report:?}");
}

/// Elastic spheres thrown at each other at 5 m/s, without gravity, against a search through all pairs for every collision.
/// Each collision multiplies round-off by some ten, hence the tolerance after a few of them per sphere.
#[test]
fn fast_spheres_meet_as_in_a_search_through_all_pairs() {
    let mut cloud = dilated(packed(40, 8), 4.0);
    for i in 0..cloud.len() {
        let r = Vector3::from(cloud.position(i));
        let v = (r + Vector3::new(r.y, r.z, -r.x) * 0.1) * (-5.0 / r.norm());
        [cloud.vx[i], cloud.vy[i], cloud.vz[i]] = v.into();
    }
    let elastic = HardSphereParameters {
        restitution_normal: 1.0,
        restitution_tangential: 1.0,
        step_s: 400.0,
        gravity: None,
        ..HardSphereParameters::default()
    };
    let mut fast = cloud.clone();
    let report = HardSphere::new(elastic).evolve(&mut fast, 400.0).unwrap();

    let mut r: Vec<Vector3<f64>> = (0..cloud.len()).map(|i| cloud.position(i).into()).collect();
    let mut v: Vec<Vector3<f64>> = (0..cloud.len()).map(|i| cloud.velocity(i).into()).collect();
    let (mut left, mut collisions) = (400.0, 0);
    loop {
        let mut first = (left, 0, 0);
        for j in 0..r.len() {
            for i in 0..j {
                let (d, u) = (r[j] - r[i], v[j] - v[i]);
                let (b, c) = (d.dot(&u), d.norm_squared() - 4.0 * GRAIN.radius * GRAIN.radius);
                let disc = b * b - u.norm_squared() * c;
                if b < 0.0 && disc >= 0.0 {
                    let delay = (c / (disc.sqrt() - b)).max(0.0);
                    if delay < first.0 {
                        first = (delay, i, j);
                    }
                }
            }
        }
        let (delay, i, j) = first;
        r.iter_mut().zip(&v).for_each(|(r, v)| *r += v * delay);
        left -= delay;
        if i == j {
            break;
        }
        let n = (r[j] - r[i]).normalize();
        let exchanged = n * (v[j] - v[i]).dot(&n);
        v[i] += exchanged;
        v[j] -= exchanged;
        collisions += 1;
    }
    assert_eq!(report.counts.collisions, collisions);
    assert!(collisions > 30, "{collisions}");
    for (i, r) in r.iter().enumerate() {
        assert!((Vector3::from(fast.position(i)) - r).norm() < 1e-6, "sphere {i}");
    }
}

#[test]
fn equal_runs_are_equal_to_the_bit_wherever_they_are_cut() {
    let start = packed(80, 6);
    let mut whole = start.clone();
    let report = evolve(&mut whole, 500.0);
    let mut again = start.clone();
    assert_eq!(evolve(&mut again, 500.0), report);
    assert_eq!(bits(&again), bits(&whole));
    let mut pieces = start.clone();
    let mut sum = Report::default();
    for _ in 0..10 {
        sum.add(&HardSphere::new(HardSphereParameters::default()).step(&mut pieces).unwrap());
    }
    assert_eq!(sum.counts, report.counts);
    assert_eq!(bits(&pieces), bits(&whole));
}

#[test]
fn one_and_two_threads_give_the_same_bytes() {
    let run = |threads| {
        let mut body = packed(80, 7);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| evolve(&mut body, 500.0));
        bits(&body)
    };
    assert_eq!(run(1), run(2));
}
