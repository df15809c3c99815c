//! Tiling, re-tiling and hull of a 1000-sphere aggregate. One thread, so that times are CPU times.

#[path = "../tests/support/mod.rs"]
mod support;

use divan::Bencher;
use std::hint::black_box;
use std::sync::OnceLock;
use tiling::{EllipsoidTiling, ImplicitSurface, Inside, Previous, sphere_hull_volume};

const COUNT: usize = 1000;
/// Semi-axes of the packing's hull, radii.
const AXES: [f64; 3] = [13.0, 11.8, 11.0];

fn main() {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("the pool is built once");
    divan::main();
}

fn centres() -> &'static [Vec<f64>; 3] {
    static CENTRES: OnceLock<[Vec<f64>; 3]> = OnceLock::new();
    CENTRES.get_or_init(|| support::packing(COUNT, 1.0, AXES))
}

fn surface([x, y, z]: &[Vec<f64>; 3]) -> ImplicitSurface {
    ImplicitSurface::new(x, y, z, &[1.0; COUNT], 2, 1.25).expect("unit spheres make a surface")
}

#[divan::bench(args = [784, 3184, 19_960])]
fn unit_sphere(bencher: Bencher, facets: usize) {
    bencher.bench(|| tiling::fibonacci::unit_sphere(black_box(facets / 2 + 2)));
}

#[divan::bench(args = [784, 3184])]
fn tile(bencher: Bencher, facets: usize) {
    let surface = surface(centres());
    bencher.bench(|| EllipsoidTiling::new(AXES, facets / 2 + 2).and_then(|e| e.projected(black_box(&surface))));
}

#[divan::bench(args = [784, 3184])]
fn retile_three_moved(bencher: Bencher, facets: usize) {
    let mut moved = centres().clone();
    let ellipsoid = EllipsoidTiling::new(AXES, facets / 2 + 2).expect("the axes are positive");
    let before = surface(&moved);
    let first = ellipsoid.projected(&before).expect("a packed ellipsoid can be tiled");
    moved.iter_mut().for_each(|column| (0..3).for_each(|j| column[j] *= 1.05));
    let surface = surface(&moved);
    let previous = Previous { mesh: &first.mesh, surface: &before };
    bencher.bench(|| ellipsoid.retiled(black_box(&surface), previous));
}

#[divan::bench]
fn hull_volume(bencher: Bencher) {
    let [x, y, z] = centres();
    bencher.bench(|| sphere_hull_volume(black_box(x), y, z, &[1.0; COUNT]));
}

#[divan::bench]
fn hundred_thousand_inside_tests(bencher: Bencher) {
    let body = EllipsoidTiling::new(AXES, 6002).expect("the axes are positive").mesh;
    let inside = Inside::new(body).expect("an ellipsoid is closed");
    let points: Vec<[f64; 3]> =
        (0..100_000).map(|i| [0.9, 1.7, 2.3].map(|k: f64| 13.0 * (k * f64::from(i)).sin())).collect();
    bencher.bench(|| points.iter().filter(|p| inside.contains(black_box(**p))).count());
}

#[divan::bench(args = [3184, 49_152])]
fn check_contact(bencher: Bencher, facets: usize) {
    let body = EllipsoidTiling::new(AXES, facets / 2 + 2).expect("the axes are positive").mesh;
    bencher.bench(|| body.check_contact());
}
