//! `yorp build`, `relax` and `rigid` as a user meets them.

use std::ffi::OsStr;
use std::path::Path;

use common::{ask, file, json, refused};
use serde_json::Value;

mod common;

const SCENE: &str = r#"{
  "body": {"packed_ellipsoid": {"spheres": 60, "radius_m": 50.2, "grain_density_kg_m3": 2960, "b_over_a": 0.8, "c_over_a": 0.7}},
  "spin": {"period_h": 6}, "settling": {"rotations": 1, "max_rotations": 3}, "tiling": {"facets": 100},
  "torque": {"obliquity_step_deg": 30}
}"#;

fn scene(folder: &Path) -> std::path::PathBuf {
    file(folder, "scene.json", SCENE)
}

#[test]
fn a_built_aggregate_relaxes_alone_and_conserves_what_it_should() {
    let folder = tempfile::tempdir().unwrap();
    let body = folder.path().join("body.csv");
    let built = json(&ask(&[&"build", &scene(folder.path()), &"--out", &body, &"--json"]));
    assert_eq!(built["spheres"], 60);
    for ratio in [1, 2].map(|k| built["b1_axes_m"][k].as_f64().unwrap() / built["b1_axes_m"][0].as_f64().unwrap()) {
        assert!((0.6..=0.9).contains(&ratio), "{built}");
    }
    let after = folder.path().join("after.vtp");
    let relaxed = json(&ask(&[&"relax", &body, &"--rotations", &"0.5", &"--out", &after, &"--json"]));
    let number = |key: &str| relaxed[key].as_f64().unwrap_or_else(|| panic!("{key} in {relaxed}"));
    assert!(number("angular_momentum_drift") < 1e-12 && number("momentum_drift") < 1e-12, "{relaxed}");
    assert!(number("max_overlap_over_radius") < 1e-6 && number("contacts_per_sphere") > 3.0, "{relaxed}");
    for key in
        ["steps", "step_s", "seconds", "cpu_seconds", "energy_drift", "collisions", "moved_spheres", "shape_change"]
    {
        assert!(relaxed[key].is_number(), "{key} in {relaxed}");
    }
    assert!(relaxed["parts"].is_object());
    assert!(after.metadata().unwrap().len() > 1000);
}

#[test]
fn a_period_on_the_command_line_replaces_the_motion_in_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let pair = folder.path().join("pair.csv");
    std::fs::write(&pair, "x_m,y_m,z_m,mass_kg,radius_m\n-50,0,0,1e9,50\n50,0,0,1e9,50\n").unwrap();
    refused(&ask(&[&"relax", &pair, &"--rotations", &"1"]), 2, "does not rotate");
    let result = json(&ask(&[&"relax", &pair, &"--rotations", &"1", &"--period-h", &"10", &"--json"]));
    assert_eq!(result["moved_spheres"], 0);
    let still = json(&ask(&[&"relax", &pair, &"--duration-s", &"100", &"--gravity", &"off", &"--json"]));
    assert_eq!((&still["collisions"], &still["angular_momentum_drift"]), (&Value::from(0), &Value::Null));
}

#[test]
fn wrong_aggregates_and_flags_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("body.csv");
    std::fs::write(&file, "x_m,y_m,z_m,mass_kg,radius_m\n0,0,0,1e9,-50\n").unwrap();
    refused(&ask(&[&"relax", &file, &"--duration-s", &"10"]), 2, "radius");
    refused(&ask(&[&"relax", &file]), 2, "--duration-s");
    refused(&ask(&[&"relax", &file, &"--duration-s", &"-1"]), 2, "above 0");
    refused(&ask(&[&"build", &scene(folder.path()), &"--out", &folder.path().join("body.xyz")]), 2, ".csv");
}

#[test]
fn the_cycle_of_a_rigid_body_ends_and_says_how() {
    // A figure of revolution: what torque its facets have is below the error.
    let top = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/shapes/top.obj");
    let cycle = json(&ask(&[&"rigid", &top, &"--period-h", &"5", &"--obliquity-deg", &"20", &"--json"]));
    assert_eq!(cycle["end"], "no_torque");
    let spin = cycle["spin_rev_day"].as_array().unwrap();
    assert!((spin[0].as_f64().unwrap() - 4.8).abs() < 1e-12);
    let folder = tempfile::tempdir().unwrap();
    let of_scene = json(&ask(&[&"rigid", &scene(folder.path()), &"--json"]));
    assert!(of_scene["max_spin_rev_day"].is_number() || of_scene["end"] == "infinite_spin_up");
    assert!(of_scene["spin_limit_rev_day"].as_f64().unwrap() > 5.0);
}

#[test]
fn both_integrators_follow_the_same_cycle_and_write_it_as_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let (shape, table) = (folder.path().join("lopsided.obj"), folder.path().join("cycle.csv"));
    let tetrahedron = "v 190 20 -10\nv -110 140 0\nv -90 -150 30\nv -20 10 170\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    std::fs::write(&shape, tetrahedron).unwrap();
    let follow = |arguments: &[&dyn AsRef<OsStr>]| {
        let common: [&dyn AsRef<OsStr>; 5] = [&"rigid", &shape, &"--json", &"--out", &table];
        json(&ask(&[&common[..], arguments].concat()))
    };
    let adaptive = follow(&[]);
    let fixed = follow(&[&"--integrator", &"rk4", &"--rk4-step-yr", &"10"]);
    assert_eq!(adaptive["integrator"], serde_json::json!({"adaptive": {"tolerance": 1e-9}}));
    assert_eq!(fixed["integrator"], serde_json::json!({"rk4": {"step_yr": 10.0}}));
    assert_eq!(adaptive["end"], fixed["end"]);
    for key in ["attractor_obliquity_deg", "cycle_time_myr", "attractor_spin_rate_change_rev_day_myr"] {
        let (a, b) = (adaptive[key].as_f64(), fixed[key].as_f64());
        assert_eq!(a.is_some(), b.is_some());
        assert!((a.unwrap_or(1.0) - b.unwrap_or(1.0)).abs() <= 1e-6 * b.unwrap_or(1.0).abs(), "{key}: {a:?} {b:?}");
    }
    // Near the pole, where the obliquity falls as a power of the spin rate.
    let end = |cycle: &serde_json::Value| cycle["end_obliquity_deg"].as_f64().unwrap();
    assert!((end(&adaptive) - end(&fixed)).abs() < 1e-5);
    let text = std::fs::read_to_string(&table).unwrap();
    assert!(
        text.starts_with("t_myr,period_h,spin_rev_day,obliquity_deg,spin_torque_n_m,obliquity_torque_n_m\n0.0,6.0")
    );
    assert_eq!(text.lines().count(), 1 + fixed["t_myr"].as_array().unwrap().len());
}

#[test]
fn integrators_take_their_own_knobs_only() {
    let top = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/shapes/top.obj");
    let cases: [(&[&dyn AsRef<OsStr>], &str); 7] = [
        (&[&"--tolerance", &"1"], "at least 1e-13, at most 0.01"),
        (&[&"--tolerance", &"nan"], "at least 1e-13, at most 0.01"),
        (&[&"--rk4-step-yr", &"0"], "at least 1, at most 1000000"),
        (&[&"--integrator", &"euler"], "adaptive, rk4"),
        (&[&"--integrator", &"rk4", &"--tolerance", &"1e-6"], "--integrator adaptive only"),
        (&[&"--integrator", &"adaptive", &"--rk4-step-yr", &"100"], "--integrator rk4 only"),
        (&[&"--out", &"cycle.txt"], ".csv"),
    ];
    for (arguments, expected) in cases {
        let common: [&dyn AsRef<OsStr>; 2] = [&"rigid", &top];
        refused(&ask(&[&common[..], arguments].concat()), 2, expected);
    }
}
