//! Torques of asteroid shapes converge: in the steps of the default sampling, and in the points from which shadows are seen.
//!
//! The shapes are taken from `../shared/shapes` next to the repository; without them nothing is tested.

mod common;

use common::{centred, distance, off, peak};
use taco::{Orbit, Sampling, Surface, TorqueTable, torque_table_of_facets};
use tiling::Mesh;

fn shape(name: &str) -> Option<Mesh> {
    let path = format!("{}/../../shared/shapes/{name}.obj", env!("CARGO_MANIFEST_DIR"));
    let Ok(bytes) = std::fs::read(path) else {
        println!("skipped: no shape {name}");
        return None;
    };
    Some(centred(tiling::obj::read(&bytes).unwrap()))
}

fn table(mesh: &Mesh, sampling: &Sampling) -> TorqueTable {
    torque_table_of_facets(mesh, &Surface::default(), &Orbit::default(), sampling).unwrap()
}

/// Halving every step, from 240 azimuths on, changes the two torques by these fractions of their peaks. (From the default
/// 120 azimuths on it changes the obliquity torque of `ryugu_3200` by 0.8 %.)
fn change_by_halving(mesh: &Mesh) -> [f64; 2] {
    let whole = Sampling { azimuth_bins: 240, ..Sampling::default() };
    let halved = Sampling { azimuth_bins: 480, declination_nodes: 73, ..Sampling::default() };
    let (a, b) = (table(mesh, &whole), table(mesh, &halved));
    let change = |a: &[f64], b: &[f64]| distance(a, b) / peak(b);
    [
        change(&a.spin_torque_n_m[0], &b.spin_torque_n_m[0]),
        change(&a.obliquity_torque_n_m[0], &b.obliquity_torque_n_m[0]),
    ]
}

#[test]
fn halving_every_step_changes_ryugu_by_less_than_half_a_percent() {
    let Some(mesh) = shape("ryugu_3200") else { return };
    let changes = change_by_halving(&mesh);
    println!("ryugu_3200: {changes:?}");
    assert!(changes.iter().all(|c| *c < 0.005), "{changes:?}");
}

/// About a minute: `cargo test --release -p yorp-taco --test convergence -- --ignored`.
#[test]
#[ignore = "takes a minute"]
fn halving_every_step_changes_full_ryugu_by_less_than_half_a_percent() {
    let Some(mesh) = shape("ryugu_49152") else { return };
    let changes = change_by_halving(&mesh);
    println!("ryugu_49152: {changes:?}");
    assert!(changes.iter().all(|c| *c < 0.005), "{changes:?}");
}

/// Against 64 points a facet: a shadow's edge crosses a facet in steps a half, and a fourth, as large.
fn errors_of_samples(name: &str) -> Option<[f64; 3]> {
    let mesh = shape(name)?;
    let at = |facet_samples| {
        let sampling = Sampling { azimuth_bins: 48, declination_nodes: 13, facet_samples, ..Sampling::default() };
        table(&mesh, &sampling)
    };
    let reference = at(64);
    let errors = [1, 4, 16].map(|samples| off(&reference, &at(samples)));
    println!("{name}: {errors:?}");
    Some(errors)
}

#[test]
fn shadows_seen_from_more_points_converge() {
    let Some([one, four, sixteen]) = errors_of_samples("didymos_800") else { return };
    assert!(four < 0.5 * one && sixteen < 0.3 * one, "{one} {four} {sixteen}");
}

#[test]
#[ignore = "takes a minute"]
fn shadows_seen_from_more_points_converge_on_finer_shapes() {
    for name in ["itokawa_3200", "ryugu_3200"] {
        let Some([one, four, sixteen]) = errors_of_samples(name) else { return };
        assert!(four < one && sixteen < 0.4 * one, "{name}: {one} {four} {sixteen}");
    }
}
