//! Time of one evaluation of gravity, by pairs and by the tree: `cargo bench -p yorp-pkd --bench gravity`.

use divan::{Bencher, black_box};
use pkd::Spheres;
use pkd::gravity::{Accelerations, Gravity, GravityMethod, GravityOptions};

fn main() {
    // The default pool is this thread alone, so that `one_thread` times the sum and not the way to another thread.
    rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global().expect("the first pool");
    divan::main();
}

/// A ball of `count` spheres on a lattice, each shaken by a tenth of its spacing.
fn ball(count: usize) -> Spheres {
    let (spacing, mut spheres) = (100.0, Spheres::default());
    let radius = spacing * (count as f64 * 0.75 / std::f64::consts::PI).cbrt();
    let reach = (radius / spacing).ceil() as i32;
    let shake =
        |a: i32, b: i32, c: i32| 10.0 * (f64::from(a) * 12.9898 + f64::from(b) * 78.233 + f64::from(c) * 37.7).sin();
    for i in -reach..=reach {
        for j in -reach..=reach {
            for k in -reach..=reach {
                let p = [i, j, k].map(|c| f64::from(c) * spacing);
                if p.iter().map(|c| c * c).sum::<f64>() < radius * radius {
                    let at = [p[0] + shake(i, j, k), p[1] + shake(j, k, i), p[2] + shake(k, i, j)];
                    spheres.push(at, [0.0; 3], [0.0; 3], 1.5e9, 45.0);
                }
            }
        }
    }
    spheres
}

/// A closure that evaluates the gravity of a ball of `count` spheres.
fn evaluation(count: usize, method: GravityMethod, force_error: f64) -> impl FnMut() + Send {
    let body = ball(count);
    let mut gravity = Gravity::new(GravityOptions { method, force_error });
    let mut out = Accelerations::default();
    move || gravity.accelerations(&body.x, &body.y, &body.z, &body.mass, black_box(&mut out))
}

mod one_thread {
    use super::*;

    #[divan::bench(args = [100, 1000, 2000, 3000, 4000, 6000, 10_000])]
    fn direct(bencher: Bencher, count: usize) {
        bencher.bench_local(evaluation(count, GravityMethod::Direct, 1e-3));
    }

    #[divan::bench(args = [1000, 2000, 3000, 4000, 10_000, 40_000], max_time = 3)]
    fn tree_to_1e_3(bencher: Bencher, count: usize) {
        bencher.bench_local(evaluation(count, GravityMethod::Tree, 1e-3));
    }

    #[divan::bench(args = [2000, 3000, 4000, 6000, 10_000, 40_000], max_time = 3)]
    fn tree_to_1e_4(bencher: Bencher, count: usize) {
        bencher.bench_local(evaluation(count, GravityMethod::Tree, 1e-4));
    }

    #[divan::bench(args = [200_000, 1_000_000], sample_count = 1, sample_size = 1)]
    fn large_tree_to_1e_3(bencher: Bencher, count: usize) {
        bencher.bench_local(evaluation(count, GravityMethod::Tree, 1e-3));
    }

    #[divan::bench(args = [200_000, 1_000_000], sample_count = 1, sample_size = 1)]
    fn large_tree_to_1e_4(bencher: Bencher, count: usize) {
        bencher.bench_local(evaluation(count, GravityMethod::Tree, 1e-4));
    }
}

/// With some microseconds for entering the pool.
#[divan::bench_group(max_time = 3)]
mod two_threads {
    use super::*;

    fn run(bencher: Bencher, mut evaluation: impl FnMut() + Send) {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
        bencher.bench_local(|| pool.install(&mut evaluation));
    }

    #[divan::bench(args = [100, 1000, 4000])]
    fn direct(bencher: Bencher, count: usize) {
        run(bencher, evaluation(count, GravityMethod::Direct, 1e-3));
    }

    #[divan::bench(args = [10_000, 40_000])]
    fn tree_to_1e_3(bencher: Bencher, count: usize) {
        run(bencher, evaluation(count, GravityMethod::Tree, 1e-3));
    }

    #[divan::bench(args = [10_000, 40_000])]
    fn tree_to_1e_4(bencher: Bencher, count: usize) {
        run(bencher, evaluation(count, GravityMethod::Tree, 1e-4));
    }
}
