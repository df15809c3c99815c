//! Soft spheres on whole bodies: what is conserved, what stays in shape, and that spheres and history are all the state.

use nalgebra::{Matrix3, Rotation3, Vector3};
use pkd::frame::set_rigid_rotation;
use pkd::mass_properties::mass_properties;
use pkd::packing::{EllipsoidPacking, Grain, PACKING_FRACTION, Seed, ellipsoid_packing};
use pkd::soft_sphere::{ContactHistory, Gravity, SoftSphere, SoftSphereParameters};
use pkd::{PkdError, Spheres};

const GRAIN: Grain = Grain { radius: 50.2, density: 2960.0 };
const PERIOD: f64 = 21_600.0;

/// An ellipsoid of axis ratios 0.8 and 0.7, packed and turning in six hours.
fn packed(count: usize) -> Spheres {
    let mut body = ellipsoid_packing(&EllipsoidPacking {
        count,
        grain: GRAIN,
        b_over_a: 0.8,
        c_over_a: 0.7,
        packing_fraction: PACKING_FRACTION,
        seed: Seed::default(),
    })
    .unwrap();
    set_rigid_rotation(&mut body, Vector3::z() * (std::f64::consts::TAU / PERIOD)).unwrap();
    body
}

fn bits(body: &Spheres) -> Vec<u64> {
    body.columns().iter().flat_map(|c| c.iter().map(|v| v.to_bits())).collect()
}

/// Every preset, and cohesion.
fn presets() -> [SoftSphereParameters; 5] {
    let cohesive = SoftSphereParameters { cohesion_pa: 100.0, ..SoftSphereParameters::zhang_2017() };
    [
        SoftSphereParameters::zhang_2017(),
        SoftSphereParameters::gravel(),
        SoftSphereParameters::glass_beads(),
        SoftSphereParameters::frictionless(),
        cohesive,
    ]
}

/// A packing falls together and comes to rest: then it keeps its shape, momentum and angular momentum. The frozen field
/// is the only thing that does not conserve energy.
#[test]
fn a_settled_body_keeps_its_shape_and_conserves() {
    let mut body = packed(300);
    let mut soft = SoftSphere::new(SoftSphereParameters { ledger: true, ..Default::default() });
    let k_n = soft.stiffness(&body).unwrap().normal_n_m;
    soft = SoftSphere::new(SoftSphereParameters { normal_stiffness_n_m: Some(k_n), ..soft.parameters().clone() });
    let falling = soft.evolve(&mut body, 12_000.0).unwrap();
    let ledger = falling.ledger.unwrap();
    assert!(ledger.residual_j().abs() < 0.02 * ledger.dissipated_j(), "{falling:?}");
    assert!(falling.frozen_field_error < 5e-3 && falling.gravity_evaluations > 3, "{falling:?}");

    let before = mass_properties(&body).unwrap();
    let report = soft.evolve(&mut body, PERIOD).unwrap();
    let after = mass_properties(&body).unwrap();
    println!("{falling:?}\n{report:?}");
    let l = (after.angular_momentum - before.angular_momentum).norm() / before.angular_momentum.norm();
    assert!(l < 1e-12 && report.angular_momentum_drift < 1e-12, "angular momentum drifts by {l:e}");
    assert!(report.momentum_drift < 1e-12, "{report:?}");
    // Even of a field that nothing made it renew.
    assert!((1e-9..5e-3).contains(&report.frozen_field_error), "{report:?}");
    assert!(report.max_overlap_over_radius < 0.01 && report.contacts_per_sphere > 3.0, "{report:?}");
    assert!(report.energy_drift().unwrap().abs() < 1e-4, "{:?}", report.energy_drift());
    let axes = after.deeve_axes().component_div(&before.deeve_axes()) - Vector3::repeat(1.0);
    assert!(axes.amax() < 1e-3, "the axes change by {axes:?}");
}

#[test]
fn a_run_cut_in_two_and_restored_has_the_same_bytes() {
    for parameters in presets() {
        let start = packed(120);
        let mut whole = (start.clone(), SoftSphere::new(parameters.clone()));
        let mut report = whole.1.evolve(&mut whole.0, 800.0).unwrap();
        let mut cut = (whole.0.clone(), SoftSphere::new(parameters));
        cut.1.set_history(ContactHistory::new(whole.1.history().contacts().to_vec()).unwrap());
        for (body, soft) in [&mut whole, &mut cut] {
            report.add(&soft.evolve(body, 500.0).unwrap());
        }
        assert_eq!(bits(&whole.0), bits(&cut.0));
        assert_eq!(whole.1.history(), cut.1.history());
        assert_eq!(report.duration_s, 1800.0);
    }
}

#[test]
fn thread_count_does_not_change_a_byte() {
    let body = packed(5000);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut body = body.clone();
        let mut soft = SoftSphere::new(SoftSphereParameters::default());
        let report = pool.install(|| soft.evolve(&mut body, 60.0)).unwrap();
        (bits(&body), soft.history().clone(), report)
    };
    let one = on(1);
    assert!(one.2.contacts > 1000);
    assert_eq!(one, on(2));
    assert_eq!(one, on(5));
}

/// The order of the caller's rows is his own affair: results come back in it, and differ by round-off.
#[test]
fn rows_may_come_in_any_order() {
    let body = packed(100);
    let mut reversed = Spheres::default();
    for i in (0..100).rev() {
        reversed.push(body.position(i), body.velocity(i), body.spin(i), body.mass[i], body.radius[i]);
    }
    let run = |mut body: Spheres| {
        SoftSphere::default().evolve(&mut body, 200.0).unwrap();
        body
    };
    let (one, other) = (run(body), run(reversed));
    for i in 0..100 {
        let d = Vector3::from(one.position(i)) - Vector3::from(other.position(99 - i));
        assert!(d.norm() < 1e-9, "{i}: {d:?}");
    }
}

/// A body and its history turned together go on as if nothing had happened.
#[test]
fn history_turns_with_the_frame() {
    let mut body = packed(80);
    let mut soft = SoftSphere::default();
    soft.evolve(&mut body, 600.0).unwrap();
    let turn: Matrix3<f64> = Rotation3::from_euler_angles(0.3, -1.1, 2.0).into_inner();
    let turned = |body: &Spheres| {
        let mut out = body.clone();
        for i in 0..body.len() {
            let [r, v, w] =
                [body.position(i), body.velocity(i), body.spin(i)].map(|u| (turn * Vector3::from(u)).into());
            out.set(i, r, v, w);
        }
        out
    };
    let mut other = turned(&body);
    let mut history = soft.history().clone();
    history.rotate(&turn);
    let mut again = SoftSphere::default();
    again.set_history(history);
    soft.evolve(&mut body, 30.0).unwrap();
    again.evolve(&mut other, 30.0).unwrap();
    let body = turned(&body);
    for i in 0..body.len() {
        let d = Vector3::from(body.position(i)) - Vector3::from(other.position(i));
        assert!(d.norm() < 1e-8, "{i}: {d:?}");
    }
}

#[test]
fn bad_input_is_named() {
    let good = packed(20);
    let evolve = |body: &Spheres, parameters: SoftSphereParameters| {
        let mut body = body.clone();
        SoftSphere::new(parameters).evolve(&mut body, 10.0)
    };
    let mut nan = good.clone();
    nan.wy[7] = f64::NAN;
    let got = evolve(&nan, Default::default());
    assert!(matches!(got, Err(PkdError::BadValue { sphere: 7, column: "wy", .. })), "{got:?}");

    let mut twice = good.clone();
    twice.set(11, good.position(4), good.velocity(4), good.spin(4));
    let got = evolve(&twice, Default::default());
    assert_eq!(got, Err(PkdError::Coincident { first: 4, second: 11 }));

    let long = SoftSphereParameters { step_s: Some(60.0), ..Default::default() };
    let got = evolve(&good, long);
    assert!(matches!(got, Err(PkdError::StepTooLarge { step_s: 60.0, .. })), "{got:?}");

    let mut deep = good.clone();
    let r = Vector3::from(good.position(3)) + Vector3::new(70.0, 0.0, 0.0);
    deep.set(9, r.into(), good.velocity(9), good.spin(9));
    let got = evolve(&deep, Default::default());
    assert!(matches!(got, Err(PkdError::TooSoft { limit: 0.01, .. })), "{got:?}");

    let mut soft = SoftSphere::default();
    let contact = pkd::soft_sphere::Contact { first: 3, second: 30, ..Default::default() };
    soft.set_history(ContactHistory::new(vec![contact]).unwrap());
    let got = soft.evolve(&mut good.clone(), 1.0);
    assert!(matches!(got, Err(PkdError::BadContact { first: 3, second: 30, .. })), "{got:?}");

    for duration in [-1.0, f64::NAN, f64::INFINITY] {
        let got = SoftSphere::default().evolve(&mut good.clone(), duration);
        assert!(matches!(got, Err(PkdError::BadParameter { name: "duration_s", .. })), "{got:?}");
    }
    assert_eq!(SoftSphere::default().evolve(&mut Spheres::default(), 1.0), Err(PkdError::Empty));
}

/// An impact faster than the stiffness is made for stops the run with the pair, and leaves the body as it was.
#[test]
fn too_deep_an_overlap_stops_the_run() {
    let mut pair = Spheres::default();
    pair.push([0.0; 3], [0.0; 3], [0.0; 3], 1.5e9, 50.0);
    pair.push([110.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0; 3], 1.5e9, 50.0);
    let before = pair.clone();
    let slow = SoftSphereParameters { expected_speed_m_s: Some(0.05), ..Default::default() };
    match SoftSphere::new(slow).evolve(&mut pair, 100.0) {
        Err(PkdError::TooSoft { first: 0, second: 1, fraction, limit: 0.01, time_s }) => {
            assert!(fraction > 0.01 && time_s > 9.0 && time_s < 20.0, "{fraction} {time_s}");
        }
        other => panic!("{other:?}"),
    }
    assert_eq!(pair, before);
    SoftSphere::default().evolve(&mut pair, 100.0).unwrap();
}

/// Spheres of 1 m and 32 m in one body: nothing is lost, and contacts are found.
#[test]
fn sizes_of_one_to_thirty_two_live_together() {
    let mut body = Spheres::default();
    let mass = |radius: f64| 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3) * 3000.0;
    body.push([0.0; 3], [0.0; 3], [0.0; 3], mass(32.0), 32.0);
    // Pebbles all over a boulder, a hair above it and not touching each other.
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    for i in 0..600 {
        let z: f64 = 1.0 - (2.0 * f64::from(i) + 1.0) / 600.0;
        let (s, phi) = ((1.0 - z * z).sqrt(), golden * f64::from(i));
        let n = Vector3::new(s * phi.cos(), s * phi.sin(), z);
        body.push((n * 33.001).into(), [0.0; 3], [0.0; 3], mass(1.0), 1.0);
    }
    let gravity = Gravity::BodyFrame { tolerance: 0.01 };
    let mut soft = SoftSphere::new(SoftSphereParameters { gravity, ..Default::default() });
    let report = soft.evolve(&mut body, 45.0).unwrap();
    assert_eq!(report.contacts, 600, "{report:?}");
    assert!(report.max_overlap_over_radius < 0.01, "{report:?}");
}

/// Contacts oblique to the spin must not be seen to slip because they turn: springs would be stretched without end, and
/// drive the body.
#[test]
fn a_pile_that_turns_at_rest_makes_neither_energy_nor_heat() {
    let mut body = ellipsoid_packing(&EllipsoidPacking {
        count: 200,
        grain: GRAIN,
        b_over_a: 0.7,
        c_over_a: 0.7,
        packing_fraction: PACKING_FRACTION,
        seed: Seed::default(),
    })
    .unwrap();
    set_rigid_rotation(&mut body, Vector3::z() * (std::f64::consts::TAU / 18_000.0)).unwrap();
    let mut soft = SoftSphere::new(SoftSphereParameters {
        normal_stiffness_n_m: Some(2.6e7),
        gravity: Gravity::EveryStep,
        ledger: true,
        ..SoftSphereParameters::default()
    });
    for _ in 0..3 {
        soft.evolve(&mut body, 9000.0).unwrap();
    }
    let ledger = soft.evolve(&mut body, 9000.0).unwrap().ledger.unwrap();
    let scale = ledger.start.kinetic_j;
    assert!(ledger.residual_j().abs() < 1e-8 * scale && ledger.dissipated_j() < 1e-6 * scale, "{ledger:?}");
}

/// Inertia is singular for pairs and lines, where a frozen field's net torque still has to be taken out.
#[test]
fn pairs_and_lines_on_any_orbit_keep_angular_momentum() {
    let mass = 4.0 / 3.0 * std::f64::consts::PI * 1e6 * 2000.0;
    let circular = (6.6743e-11 * 2.0 * mass / 200.2_f64.powi(3)).sqrt();
    let mut bodies: Vec<(String, Spheres)> = Vec::new();
    for factor in [0.95, 1.0, 1.1, 1.3] {
        for across in [Vector3::z(), Vector3::new(0.0, 0.6, 0.8)] {
            let mut pair = Spheres::default();
            pair.push([100.1, 0.0, 0.0], [0.0; 3], [0.0; 3], mass, 100.0);
            pair.push([-100.1, 0.0, 0.0], [0.0; 3], [0.0; 3], mass, 100.0);
            set_rigid_rotation(&mut pair, across * (factor * circular)).unwrap();
            bodies.push((format!("pair {factor}"), pair));
        }
    }
    let mut line = Spheres::default();
    let along = Vector3::new(0.6, 0.64, 0.48);
    for k in 0..20 {
        line.push((along * (200.05 * f64::from(k) - 1900.0)).into(), [0.0; 3], [0.0; 3], mass, 100.0);
    }
    set_rigid_rotation(&mut line, along.cross(&Vector3::z()).normalize() * 1e-5).unwrap();
    bodies.push(("line".into(), line));
    for (name, mut body) in bodies {
        let before = mass_properties(&body).unwrap();
        SoftSphere::new(SoftSphereParameters::default()).evolve(&mut body, 30_000.0).unwrap();
        let after = mass_properties(&body).unwrap();
        let drift = (after.angular_momentum - before.angular_momentum).norm() / before.angular_momentum.norm();
        assert!(drift < 1e-12, "{name}: {drift:e}");
    }
}
