//! The hand-off keeps angular momentum: what sunlight gives and shed mass takes is all that changes it, in every leg.

use std::path::Path;

use common::{file, json, open, yorp};
use serde_json::Value;

mod common;

/// Angular momentum of a leg: before, by sunlight, by shed mass, after, over C omega, and the spin rate at its end.
type Books = [f64; 6];

fn legs(run: &Path) -> Vec<Books> {
    let db = open(run);
    let sql = "SELECT angular_momentum0, angular_momentum_torque, angular_momentum_shed, angular_momentum1, \
               angular_momentum_over_spin, omega1 FROM leg ORDER BY leg";
    let mut rows = db.prepare(sql).unwrap();
    let rows = rows.query_map([], |row| Ok([0, 1, 2, 3, 4, 5].map(|k| row.get_unwrap(k))));
    rows.unwrap().map(Result::unwrap).collect()
}

/// Runs the scene and asserts that its books close: 1e-12 per leg, 1e-10 in all, |L| = C omega wherever it is stored.
fn books_close(folder: &Path, name: &str, scene: &str) -> (Value, Vec<Books>) {
    let (scene, out) = (file(folder, &format!("{name}.json"), scene), folder.join(name));
    let output = yorp().args(["run", "--json", "--out"]).arg(&out).arg(&scene).output().unwrap();
    let result = json(&output);
    let legs = legs(&out);
    assert!(legs.len() >= 5, "{name}: {} legs", legs.len());
    for (n, [start, torque, shed, end, over_spin, _]) in legs.iter().enumerate() {
        let error = (end - start - torque - shed) / start;
        assert!(error.abs() < 1e-12, "{name}: leg {n} is off by {error:e}");
        assert!((over_spin - 1.0).abs() < 1e-12, "{name}: leg {n}: |L| is {over_spin} C omega");
        assert_eq!(*start, legs[n.saturating_sub(1)][if n == 0 { 0 } else { 3 }], "{name}: leg {n}");
    }
    let whole = &result["angular_momentum"];
    assert!(whole["error"].as_f64().unwrap() < 1e-10, "{name}: {whole}");
    (result, legs)
}

const CHEAP: &str = r#""tiling": {"facets": 128},
    "torque": {"obliquity_step_deg": 15, "azimuth_bins": 48, "declination_nodes": 9, "facet_samples": 1, "rotation_cells": 32}"#;

/// A packed ellipsoid whose legs take little time, at 0.2 AU.
fn ellipsoid(spheres: u32, [b, c]: [f64; 2], contact: &str, seed: u32, more: &str) -> String {
    format!(
        r#"{{"seed": {seed}, "body": {{"packed_ellipsoid": {{"spheres": {spheres}, "radius_m": 50, "grain_density_kg_m3": 2960,
        "b_over_a": {b}, "c_over_a": {c}}}}}, "spin": {{"period_h": 7, "obliquity_deg": 20}}, "contact": {contact},
        "settling": {{"rotations": 1, "max_rotations": 4, "allow_reshaping": true}}, "orbit": {{"semimajor_axis_au": 0.2}}, {CHEAP},
        "evolution": {{"duration_myr": 1, "spin_change": 0.02, "stop_period_h": 9}} {more}}}"#
    )
}

#[test]
fn prolate_oblate_and_round_bodies_of_hard_spheres_keep_their_angular_momentum() {
    let folder = tempfile::tempdir().unwrap();
    let mut seed = 0;
    for (shape, ratios) in
        [("prolate", [0.6, 0.6]), ("oblate", [1.0, 0.6]), ("round", [1.0, 1.0]), ("triaxial", [0.8, 0.6])]
    {
        for spheres in [12, 30, 60] {
            seed += 1;
            let scene = ellipsoid(spheres, ratios, r#"{"hard_sphere": {}}"#, seed, "");
            books_close(folder.path(), &format!("{shape}{spheres}"), &scene);
        }
    }
}

#[test]
fn prolate_and_round_bodies_of_soft_spheres_keep_their_angular_momentum() {
    let folder = tempfile::tempdir().unwrap();
    for (shape, ratios) in [("prolate", [0.7, 0.7]), ("round", [1.0, 1.0])] {
        let scene = ellipsoid(24, ratios, r#"{"soft_sphere": {"preset": "gravel"}}"#, 3, "");
        books_close(folder.path(), shape, &scene);
    }
}

#[test]
fn residual_rotation_that_is_kept_does_not_spoil_the_books() {
    let folder = tempfile::tempdir().unwrap();
    let scene = ellipsoid(30, [0.7, 0.7], r#"{"hard_sphere": {}}"#, 2, "")
        .replace("\"allow_reshaping\"", "\"residual_rotation\": \"keep\", \"allow_reshaping\"");
    books_close(folder.path(), "keep", &scene);
    let wobble: f64 =
        open(&folder.path().join("keep")).query_row("SELECT max(non_axial) FROM leg", [], |r| r.get(0)).unwrap();
    assert!(wobble > 0.01, "{wobble}");
}

/// Two touching spheres of 100 m and 2000 kg/m3.
fn pair(folder: &Path, period_h: f64, obliquity: f64, contact: &str) -> String {
    let mass = 4.0 / 3.0 * std::f64::consts::PI * 1e6 * 2000.0;
    let rows = format!("x_m,y_m,z_m,mass_kg,radius_m\n-100,0,0,{mass},100\n100,0,0,{mass},100\n");
    file(folder, "pair.csv", &rows);
    format!(
        r#"{{"body": {{"file": {{"path": "pair.csv"}}}}, "spin": {{"period_h": {period_h}, "obliquity_deg": {obliquity}}}, "contact": {contact},
        {CHEAP}, "evolution": {{"duration_myr": 2, "stop_period_h": 20}}}}"#
    )
}

/// Their contact carries nothing any more at omega^2 = pi G rho / 3 (two spheres on the circular orbit of contact).
#[test]
fn two_spheres_hold_each_other_down_to_the_period_of_their_circular_orbit() {
    let limit_h = 4.668;
    let closed_form = std::f64::consts::TAU / (std::f64::consts::PI * 6.6743e-11 * 2000.0_f64 / 3.0).sqrt() / 3600.0;
    assert!((closed_form / limit_h - 1.0).abs() < 1e-3);
    let folder = tempfile::tempdir().unwrap();
    for contact in [r#"{"hard_sphere": {}}"#, r#"{"soft_sphere": {}}"#] {
        for period_h in [5.0, 4.9] {
            let name = format!("{}{period_h}", &contact[2..6]);
            let (result, legs) = books_close(folder.path(), &name, &pair(folder.path(), period_h, 20.0, contact));
            assert_eq!(result["outcome"], "fission", "{name}");
            let period = result["period_h"].as_f64().unwrap();
            assert!((period / closed_form - 1.0).abs() < 5e-3, "{name}: fission at {period} h");
            let broke = std::f64::consts::TAU / legs.last().unwrap()[5] / 3600.0;
            assert!((broke / period - 1.0).abs() < 1e-12);
        }
    }
}

/// A pair has B = C, so the eigenvector of the largest moment may point anywhere across its line.
#[test]
fn a_pair_far_from_its_limit_only_follows_the_torque() {
    let folder = tempfile::tempdir().unwrap();
    for (period_h, obliquity) in [(12.0, 20.0), (8.0, 20.0), (8.0, 120.0), (6.0, 75.0)] {
        let name = format!("pair{period_h}at{obliquity}");
        let scene = pair(folder.path(), period_h, obliquity, r#"{"hard_sphere": {}}"#);
        let (result, _) = books_close(folder.path(), &name, &scene);
        assert_eq!((&result["movements"], &result["shed_mass_fraction"]), (&0.into(), &0.0.into()), "{name}: {result}");
    }
}

/// 300 legs up and down of a body that creeps.
#[test]
fn the_books_of_a_long_run_close() {
    let folder = tempfile::tempdir().unwrap();
    let scene = ellipsoid(20, [0.9, 0.8], r#"{"hard_sphere": {}}"#, 5, "")
        .replace("0.02, \"stop_period_h\": 9", "0.002, \"stop_period_h\": 20");
    let (_, legs) = books_close(folder.path(), "long", &scene);
    assert!(legs.len() >= 300, "{}", legs.len());
}

/// A tree's torques do not balance by themselves.
#[test]
fn settling_with_tree_gravity_keeps_angular_momentum() {
    let folder = tempfile::tempdir().unwrap();
    for (contact, force_error) in [("hard_sphere", 1e-2), ("hard_sphere", 1e-3), ("soft_sphere", 1e-3)] {
        let name = format!("{contact}{force_error}");
        let scene = ellipsoid(
            150,
            [0.8, 0.7],
            &format!(r#"{{"{contact}": {{}}}}"#),
            1,
            &format!(r#", "gravity": {{"method": "tree", "force_error": {force_error}}}"#),
        );
        let (scene, out) = (file(folder.path(), "tree.json", &scene), folder.path().join(name));
        json(&yorp().args(["run", "--until-myr", "0", "--json", "--out"]).arg(&out).arg(&scene).output().unwrap());
        let drift: f64 =
            open(&out).query_row("SELECT max(angular_momentum_drift) FROM settling", [], |row| row.get(0)).unwrap();
        assert!(drift > 0.0 && drift < 1e-12, "{drift:e}");
    }
}
