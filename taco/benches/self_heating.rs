//! Time of 37-obliquity torque curves with light exchanged between facets, on one thread.
//!
//! `cargo bench -p yorp-taco --bench self_heating`; real shapes are taken from `../shared/shapes` next to the repository
//! where they exist.

use divan::Bencher;
use taco::{BodyMesh, Hapke, Orbit, RecoilTable, Sampling, SelfHeating, SpinAxis, Surface, torque_table};
use tiling::Mesh;

fn main() {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("no pool before main");
    // Tables of the reflectance are made once per process.
    RecoilTable::cached(&Hapke::default());
    divan::main();
}

/// A real shape, or `None` where the files are not there.
fn shape(name: &str) -> Option<Mesh> {
    let path = format!("{}/../../shared/shapes/{name}.obj", env!("CARGO_MANIFEST_DIR"));
    tiling::obj::read(&std::fs::read(path).ok()?).ok()
}

/// A Fibonacci sphere with many craters, so that nearly all of its facets see others.
fn cratered(vertices: usize) -> Mesh {
    let mut mesh = tiling::fibonacci::unit_sphere(vertices).expect("enough vertices");
    let craters = tiling::fibonacci::unit_sphere(40).expect("enough vertices").vertices;
    for v in &mut mesh.vertices {
        let deep = |c: &[f64; 3]| {
            let cos = (0..3).map(|k| v[k] * c[k]).sum::<f64>();
            0.1 * (-((1.0 - cos) / 0.02).powi(2)).exp()
        };
        let r = 500.0 * (1.0 - craters.iter().map(deep).sum::<f64>());
        *v = v.map(|c| c * r);
    }
    mesh
}

fn curve(bencher: Bencher, mesh: Mesh, self_heating: SelfHeating) {
    let body = BodyMesh::uniform(mesh, SpinAxis::Z).expect("a sound mesh");
    let surface = Surface { self_heating, ..Surface::default() };
    bencher.bench(|| torque_table(&body, &surface, &Orbit::default(), &Sampling::default()));
}

const MODES: [SelfHeating; 3] = [SelfHeating::None, SelfHeating::Single, SelfHeating::Multiple];
const SHAPES: [&str; 6] =
    ["didymos_800", "itokawa_3200", "ryugu_3200", "itokawa_12000", "didymos_49152", "ryugu_49152"];

#[divan::bench(args = MODES, consts = [784, 3184], sample_count = 5, sample_size = 1)]
fn cratered_curve<const FACETS: usize>(bencher: Bencher, mode: &SelfHeating) {
    curve(bencher, cratered(FACETS / 2 + 2), *mode);
}

#[divan::bench(args = SHAPES, consts = [false, true], sample_count = 3, sample_size = 1)]
fn shape_curve<const MULTIPLE: bool>(bencher: Bencher, name: &str) {
    let mode = if MULTIPLE { SelfHeating::Multiple } else { SelfHeating::None };
    match shape(name) {
        Some(mesh) => curve(bencher, mesh, mode),
        None => println!("skipped: no shape {name}"),
    }
}
