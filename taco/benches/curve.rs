//! Time of horizon maps and of full 37-obliquity torque curves, on one thread.
//!
//! `cargo bench -p yorp-taco`; real shapes are taken from `../shared/shapes` next to the repository where they exist.

use divan::Bencher;
use taco::{
    BodyMesh, Hapke, HorizonMap, Orbit, Pose, RecoilTable, Sampling, ShapeCache, SpinAxis, SpinRates, Surface,
    torque_table,
};
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

fn body(mesh: Mesh) -> BodyMesh {
    BodyMesh::uniform(mesh, SpinAxis::Z).expect("a sound mesh")
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
    let body = body(bumpy(facets / 2 + 2));
    bencher.bench(|| torque_table(&body, &Surface::default(), &Orbit::default(), &Sampling::default()));
}

/// Thermal inertia 200 at one spin rate (6 h).
#[divan::bench(args = ["didymos_800", "ryugu_3200", "itokawa_3200"], sample_count = 3, sample_size = 1)]
fn heat_of_shape(bencher: Bencher, name: &str) {
    let surface = Surface { thermal_inertia: 200.0, ..Surface::default() };
    let spin_rates = SpinRates::ListRadS(vec![std::f64::consts::TAU / 21_600.0]);
    let sampling = Sampling { spin_rates, ..Sampling::default() };
    match shape(name) {
        Some(mesh) => {
            let body = body(mesh);
            bencher.bench(|| torque_table(&body, &surface, &Orbit::default(), &sampling));
        }
        None => println!("skipped: no shape {name}"),
    }
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
            let body = body(mesh);
            bencher.bench(|| torque_table(&body, &Surface::default(), &Orbit::default(), &Sampling::default()));
        }
        None => println!("skipped: no shape {name}"),
    }
}

/// The body with three patches of five vertices pushed out, as three moved spheres leave it.
fn pushed(mesh: &Mesh) -> Mesh {
    let mut pushed = mesh.clone();
    for part in 1..4 {
        let middle = mesh.vertices[part * mesh.vertices.len() / 4];
        let distance = |v: &[f64; 3]| (0..3).map(|k| (v[k] - middle[k]).powi(2)).sum::<f64>();
        let mut nearest: Vec<usize> = (0..mesh.vertices.len()).collect();
        nearest.sort_by(|i, j| distance(&mesh.vertices[*i]).total_cmp(&distance(&mesh.vertices[*j])));
        nearest[..5].iter().for_each(|v| pushed.vertices[*v] = mesh.vertices[*v].map(|c| 1.03 * c));
    }
    pushed
}

/// The whole table of the pushed body, the other one being known: in the same axes, and in axes turned by half a degree.
#[divan::bench(args = [(784, false), (784, true), (3184, false), (3184, true)], sample_count = 9, sample_size = 1)]
fn retiled(bencher: Bencher, (facets, turned): (usize, bool)) {
    let mesh = bumpy(facets / 2 + 2);
    let pushed = pushed(&mesh);
    let (s, c) = 0.5f64.to_radians().sin_cos();
    let axes = [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]];
    let pose = if turned { Pose { axes, ..Pose::default() } } else { Pose::default() };
    let known = || {
        let cache = ShapeCache::new(mesh.clone(), &Surface::default(), &Orbit::default(), &Sampling::default());
        let mut cache = cache.expect("a sound mesh");
        cache.torque_table(&Pose::default()).expect("finite torques");
        (cache, pushed.clone())
    };
    bencher.with_inputs(known).bench_values(|(mut cache, pushed)| {
        cache.retile(pushed).expect("a sound mesh");
        cache.torque_table(&pose)
    });
}

/// Four and nine points a facet.
#[divan::bench(args = [1, 4, 9], sample_count = 3, sample_size = 1)]
fn facet_samples(bencher: Bencher, facet_samples: usize) {
    let body = body(bumpy(394));
    let sampling = Sampling { facet_samples, ..Sampling::default() };
    bencher.bench(|| torque_table(&body, &Surface::default(), &Orbit::default(), &sampling));
}
