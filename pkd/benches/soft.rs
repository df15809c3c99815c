//! Soft spheres: time per contact and step of each model, and of one rotation of a settled body:
//! `cargo bench -p yorp-pkd --bench soft`.
//!
//! The counter is contacts times steps, so 25 Mitem/s are 40 ns per contact and step. Everything a step does is in it:
//! forces, motion, the field in the body frame and the watch over the lists of neighbours. The body is at rest, so that
//! contacts are what takes the time: each call of 800 to 2000 steps lays out the spheres, lists the neighbours and
//! evaluates gravity at its start and its end, as any call does, and not between.

use divan::{Bencher, counter::ItemsCount};
use nalgebra::Vector3;
use pkd::Spheres;
use pkd::frame::set_rigid_rotation;
use pkd::packing::{EllipsoidPacking, Grain, PACKING_FRACTION, Seed, ellipsoid_packing};
use pkd::soft_sphere::{ContactHistory, Friction, Gravity, Sliding, SoftSphere, SoftSphereParameters};
use std::sync::OnceLock;

/// Sidereal period of the rotating body, s.
const PERIOD: f64 = 18_000.0;
/// Sizes of body.
const SIZES: [usize; 3] = [1_000, 10_000, 40_000];

fn main() {
    divan::main();
}

fn packed(count: usize, axis_ratio: f64) -> Spheres {
    ellipsoid_packing(&EllipsoidPacking {
        count,
        grain: Grain { radius: 50.2, density: 2960.0 },
        b_over_a: axis_ratio,
        c_over_a: axis_ratio,
        packing_fraction: PACKING_FRACTION,
        seed: Seed::default(),
    })
    .expect("a valid packing")
}

/// Stiffness of contacts that are only pressed together, over the one that keeps overlaps within a percent.
const STIFFER: f64 = 2.0;

/// How much of space random spheres fill, against what the packing does, when they begin to touch.
const DRAWN_TOGETHER: f64 = 1.035;

/// Random spheres that lie on each other under their own gravity, smooth and strongly damped: about five contacts each,
/// and a shape that needs no friction.
fn dense(count: usize) -> &'static (Spheres, f64) {
    static BODIES: [OnceLock<(Spheres, f64)>; 3] = [const { OnceLock::new() }; 3];
    let cell = SIZES.iter().position(|size| *size == count).expect("one of the sizes");
    BODIES[cell].get_or_init(|| {
        let mut body = packed(count, 1.0);
        for c in [&mut body.x, &mut body.y, &mut body.z] {
            c.iter_mut().for_each(|c| *c /= DRAWN_TOGETHER.cbrt());
        }
        let stiffness = STIFFER * SoftSphere::default().stiffness(&body).expect("a valid body").static_n_m;
        let mut smooth = SoftSphere::new(SoftSphereParameters {
            restitution: 0.2,
            max_overlap: 0.5,
            normal_stiffness_n_m: Some(stiffness),
            gravity: Gravity::BodyFrame { tolerance: 0.1 },
            skin: 0.15,
            ..SoftSphereParameters::frictionless()
        });
        // Stopped about when it moves fastest, each of its slow oscillations dies at once.
        let duration = 250.0 * smooth.stiffness(&body).expect("a valid body").step_s;
        for _ in 0..14 {
            smooth.evolve(&mut body, duration).expect("it comes to rest");
            set_rigid_rotation(&mut body, Vector3::zeros()).expect("a valid body");
        }
        (body, stiffness)
    })
}

/// Times some steps of a model.
fn contacts(bencher: Bencher, count: usize, friction: Friction, threads: usize) {
    let (body, stiffness) = dense(count);
    let steps = (32_000_000 / count).clamp(800, 2000) as f64;
    let parameters = SoftSphereParameters {
        friction,
        max_overlap: 0.5,
        normal_stiffness_n_m: Some(*stiffness),
        // All in a tenth of the time of a contact: a step takes as long however short it is, and nothing moves.
        steps_per_contact: 10.0 * steps,
        ..SoftSphereParameters::zhang_2017()
    };
    let mut soft = SoftSphere::new(parameters);
    let duration = 0.1 * soft.stiffness(body).expect("a valid body").contact_time_s;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
    let mut stretch = |mut body: Spheres| {
        soft.set_history(ContactHistory::default());
        let report = pool.install(|| soft.evolve(&mut body, duration)).expect("a stretch");
        assert!(report.list_rebuilds == 1 && report.gravity_evaluations == 2, "a body at rest: {report:?}");
        report.contacts * report.steps
    };
    let work = stretch(body.clone());
    bencher.counter(ItemsCount::new(work)).with_inputs(|| body.clone()).bench_local_values(stretch);
}

fn full() -> Friction {
    SoftSphereParameters::zhang_2017().friction
}

#[divan::bench(args = SIZES, sample_count = 5, sample_size = 1)]
fn frictionless(bencher: Bencher, count: usize) {
    contacts(bencher, count, Friction::None, 1);
}

#[divan::bench(args = SIZES, sample_count = 5, sample_size = 1)]
fn tangential(bencher: Bencher, count: usize) {
    contacts(bencher, count, Friction::Sliding(Sliding::default()), 1);
}

#[divan::bench(args = SIZES, sample_count = 5, sample_size = 1)]
fn full_model(bencher: Bencher, count: usize) {
    contacts(bencher, count, full(), 1);
}

#[divan::bench(args = SIZES, sample_count = 5, sample_size = 1)]
fn full_model_on_two_threads(bencher: Bencher, count: usize) {
    contacts(bencher, count, full(), 2);
}

/// A packing that has settled for two rotations with full friction, and the history of its contacts.
fn settled() -> &'static (Spheres, ContactHistory, f64) {
    static BODY: OnceLock<(Spheres, ContactHistory, f64)> = OnceLock::new();
    BODY.get_or_init(|| {
        let mut body = packed(1000, 0.7);
        set_rigid_rotation(&mut body, Vector3::z() * (std::f64::consts::TAU / PERIOD)).expect("a valid body");
        let mut soft = SoftSphere::default();
        let stiffness = soft.stiffness(&body).expect("a valid body").normal_n_m;
        soft = SoftSphere::new(SoftSphereParameters { normal_stiffness_n_m: Some(stiffness), ..Default::default() });
        soft.evolve(&mut body, 2.0 * PERIOD).expect("it settles");
        (body, soft.history().clone(), stiffness)
    })
}

/// One rotation with the defaults.
#[divan::bench(sample_count = 3, sample_size = 1)]
fn rotation_of_a_thousand(bencher: Bencher) {
    let (body, history, stiffness) = settled();
    let parameters = SoftSphereParameters { normal_stiffness_n_m: Some(*stiffness), ..Default::default() };
    let mut soft = SoftSphere::new(parameters);
    let mut turn = |mut body: Spheres| {
        soft.set_history(history.clone());
        soft.evolve(&mut body, PERIOD).expect("a rotation")
    };
    let report = turn(body.clone());
    bencher
        .counter(ItemsCount::new(report.contacts * report.steps))
        .with_inputs(|| body.clone())
        .bench_local_values(turn);
}
