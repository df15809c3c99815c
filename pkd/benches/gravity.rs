//! Time of one direct summation on one thread and on all: `cargo bench -p yorp-pkd --bench gravity`.

use divan::{Bencher, black_box};
use pkd::gravity::{Accelerations, DirectGravity};
use pkd::packing::{EllipsoidPacking, Grain, PACKING_FRACTION, Seed, ellipsoid_packing};

fn main() {
    // The default pool is this thread alone, so that `one_thread` times the sum and not the way to another thread.
    rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global().expect("the first pool");
    divan::main();
}

/// A body of `count` spheres and a closure that sums up its gravity.
fn summation(count: usize) -> impl FnMut() + Send {
    let body = ellipsoid_packing(&EllipsoidPacking {
        count,
        grain: Grain { radius: 50.2, density: 2960.0 },
        b_over_a: 0.7,
        c_over_a: 0.7,
        packing_fraction: PACKING_FRACTION,
        seed: Seed::default(),
    })
    .expect("a valid packing");
    let mut gravity = DirectGravity::default();
    let mut out = Accelerations::default();
    move || gravity.accelerations(&body.x, &body.y, &body.z, &body.mass, black_box(&mut out))
}

#[divan::bench(args = [100, 1000, 4000])]
fn one_thread(bencher: Bencher, count: usize) {
    bencher.bench_local(summation(count));
}

/// With some microseconds for entering the pool.
#[divan::bench(args = [100, 1000, 4000])]
fn all_threads(bencher: Bencher, count: usize) {
    let pool = rayon::ThreadPoolBuilder::new().build().expect("threads");
    let mut sum = summation(count);
    bencher.bench_local(|| pool.install(&mut sum));
}
