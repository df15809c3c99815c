//! Time of one direct summation on one thread and on all: `cargo bench -p yorp-pkd --bench gravity`.

use divan::{Bencher, black_box};
use pkd::gravity::{Accelerations, DirectGravity};
use pkd::packing::{EllipsoidPacking, Grain, PACKING_FRACTION, Seed, ellipsoid_packing};

fn main() {
    divan::main();
}

fn time(bencher: Bencher, count: usize, threads: usize) {
    let body = ellipsoid_packing(&EllipsoidPacking {
        count,
        grain: Grain { radius: 50.2, density: 2960.0 },
        b_over_a: 0.7,
        c_over_a: 0.7,
        packing_fraction: PACKING_FRACTION,
        seed: Seed::default(),
    })
    .expect("a valid packing");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let mut gravity = DirectGravity::default();
    let mut out = Accelerations::default();
    // Entering the pool is part of the time: some microseconds.
    bencher.bench_local(|| {
        pool.install(|| gravity.accelerations(&body.x, &body.y, &body.z, &body.mass, black_box(&mut out)));
    });
}

#[divan::bench(args = [100, 1000, 4000])]
fn one_thread(bencher: Bencher, count: usize) {
    time(bencher, count, 1);
}

#[divan::bench(args = [100, 1000, 4000])]
fn all_threads(bencher: Bencher, count: usize) {
    time(bencher, count, 0);
}
