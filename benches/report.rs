//! The report of a long run: reading the database, making the page.
//!
//! `cargo bench -p yorp --bench report`

#[path = "../tests/synthetic/mod.rs"]
mod synthetic;

use divan::Bencher;
use synthetic::Synthetic;
use yorp::report::RunData;
use yorp::report::page::{Extras, page};

fn main() {
    divan::main();
}

fn long_run(configurations: u32) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    Synthetic { spheres: 1000, vertices: 394, configurations, moved: 0.25, ..Synthetic::default() }
        .write(folder.path());
    folder
}

/// Reading 500 configurations of 1000 spheres, a quarter of which each movement shifts.
#[divan::bench(sample_count = 3)]
fn read(bencher: Bencher) {
    let folder = long_run(500);
    bencher.bench_local(|| RunData::read(folder.path()).unwrap());
}

/// The page of as many.
#[divan::bench(sample_count = 3)]
fn write_page(bencher: Bencher) {
    let folder = long_run(500);
    let run = RunData::read(folder.path()).unwrap();
    bencher.bench_local(|| page(&run, &Extras::default()));
}
