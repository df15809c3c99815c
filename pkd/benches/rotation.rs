//! Time of one rotation (18 000 s) of a settled body of 1000 hard spheres: `cargo bench -p yorp-pkd --bench rotation`.
//!
//! The counter is collisions, so the figure beside the time is collisions per second.

use divan::{Bencher, counter::ItemsCount};
use nalgebra::Vector3;
use pkd::Spheres;
use pkd::frame::set_rigid_rotation;
use pkd::hard_sphere::{HardSphere, HardSphereParameters};
use pkd::packing::{EllipsoidPacking, Grain, PACKING_FRACTION, Seed, ellipsoid_packing};
use std::sync::OnceLock;

/// Sidereal period of the start, s.
const PERIOD: f64 = 21_600.0;

fn main() {
    divan::main();
}

/// A packing that has turned twice.
fn settled() -> &'static Spheres {
    static BODY: OnceLock<Spheres> = OnceLock::new();
    BODY.get_or_init(|| {
        let mut body = ellipsoid_packing(&EllipsoidPacking {
            count: 1000,
            grain: Grain { radius: 50.2, density: 2960.0 },
            b_over_a: 0.7,
            c_over_a: 0.7,
            packing_fraction: PACKING_FRACTION,
            seed: Seed::default(),
        })
        .expect("a valid packing");
        set_rigid_rotation(&mut body, Vector3::z() * (std::f64::consts::TAU / PERIOD)).expect("a valid body");
        HardSphere::default().evolve(&mut body, 2.0 * PERIOD).expect("it settles");
        body
    })
}

fn time(bencher: Bencher, parameters: HardSphereParameters) {
    let mut engine = HardSphere::new(parameters);
    let collisions = engine.evolve(&mut settled().clone(), 18_000.0).expect("a rotation").counts.collisions;
    bencher.counter(ItemsCount::new(collisions)).with_inputs(|| settled().clone()).bench_local_values(|mut body| {
        engine.evolve(&mut body, 18_000.0).expect("a rotation");
        body
    });
}

#[divan::bench(sample_count = 3, sample_size = 1)]
fn defaults(bencher: Bencher) {
    time(bencher, HardSphereParameters::default());
}

#[divan::bench(sample_count = 3, sample_size = 1)]
fn smooth(bencher: Bencher) {
    time(bencher, HardSphereParameters { restitution_tangential: 1.0, ..HardSphereParameters::default() });
}

#[divan::bench(sample_count = 3, sample_size = 1)]
fn step_of_100_s(bencher: Bencher) {
    time(bencher, HardSphereParameters { step_s: 100.0, ..HardSphereParameters::default() });
}
