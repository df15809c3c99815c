//! Time of horizon maps and of full 37-obliquity torque curves, on one thread.
//!
//! `cargo bench -p yorp-taco`; real shapes are taken from `../shared/shapes` next to the repository where they exist.

use divan::Bencher;
use taco::{Hapke, HorizonMap, Orbit, RecoilTable, Sampling, Surface, torque_table};
use tiling::Mesh;

fn main() {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("no pool before main");
    // Tables of the reflectance are made once per process.
    RecoilTable::cached(&Hapke::default());
    divan::main();
}

/// An ellipsoid with waves, so that about half of its facets have a horizon.
fn bumpy(vertices: usize) -> Mesh {
    let mut mesh = tiling::fibonacci::unit_sphere(vertices).expect("enough vertices");
    for v in &mut mesh.vertices {
        let [x, y, z] = *v;
        let r = 1.0 + 0.06 * (5.0 * x + 1.0).sin() * (6.0 * y).cos() + 0.05 * (7.0 * z + 2.0 * x).sin();
        *v = [500.0 * r * x, 400.0 * r * y, 350.0 * r * z];
    }
    centred(mesh)
}

fn centred(mesh: Mesh) -> Mesh {
    let centre = mesh.solid().centre_of_mass;
    mesh.translated(centre.map(|c| -c))
}

/// A real shape, or `None` where the files are not there.
fn shape(name: &str) -> Option<Mesh> {
    let path = format!("{}/../../shared/shapes/{name}.obj", env!("CARGO_MANIFEST_DIR"));
    Some(centred(tiling::obj::read(&std::fs::read(path).ok()?).ok()?))
}

const TILINGS: [usize; 2] = [784, 3184];
const SHAPES: [&str; 8] = [
    "didymos_800",
    "ryugu_3200",
    "itokawa_3200",
    "eros_3200",
    "didymos_12000",
    "itokawa_12000",
    "didymos_49152",
    "ryugu_49152",
];

#[divan::bench(args = TILINGS, sample_count = 9, sample_size = 1)]
fn horizons(bencher: Bencher, facets: usize) {
    let mesh = bumpy(facets / 2 + 2);
    bencher.bench(|| HorizonMap::new(&mesh, Sampling::default().azimuth_bins));
}

#[divan::bench(args = TILINGS, sample_count = 9, sample_size = 1)]
fn curve(bencher: Bencher, facets: usize) {
    let mesh = bumpy(facets / 2 + 2);
    bencher.bench(|| torque_table(&mesh, &Surface::default(), &Orbit::default(), &Sampling::default()));
}

#[divan::bench(args = SHAPES, sample_count = 3, sample_size = 1)]
fn horizons_of_shape(bencher: Bencher, name: &str) {
    match shape(name) {
        Some(mesh) => bencher.bench(|| HorizonMap::new(&mesh, Sampling::default().azimuth_bins)),
        None => println!("skipped: no shape {name}"),
    }
}

#[divan::bench(args = SHAPES, sample_count = 3, sample_size = 1)]
fn curve_of_shape(bencher: Bencher, name: &str) {
    match shape(name) {
        Some(mesh) => {
            bencher.bench(|| torque_table(&mesh, &Surface::default(), &Orbit::default(), &Sampling::default()))
        }
        None => println!("skipped: no shape {name}"),
    }
}
