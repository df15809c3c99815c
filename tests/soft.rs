//! Soft spheres as a user meets them: runs that are killed and resumed, `relax` with its books of energy, and refusals.

use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use common::{ask, assert_same, count, file, json, open, refused, yorp};
use serde_json::Value;

mod common;

/// A body small enough to settle and take some legs within seconds.
const SCENE: &str = r#"{
  "seed": 4,
  "body": {"packed_ellipsoid": {"spheres": 40, "radius_m": 50.2, "grain_density_kg_m3": 2960, "b_over_a": 0.8, "c_over_a": 0.7}},
  "spin": {"period_h": 4.5, "obliquity_deg": 40},
  "contact": {"soft_sphere": {"preset": "glass_beads", "steps_per_contact": 15}},
  "settling": {"rotations": 1, "max_rotations": 2},
  "tiling": {"facets": 100},
  "torque": {"obliquity_step_deg": 30},
  "evolution": {"duration_myr": 0.02, "spin_change": 0.02, "movement_radius_fraction": 0.1}
}"#;

/// Three spheres on a line that touch and turn as one.
const CHAIN: &str = "x_m,y_m,z_m,mass_kg,radius_m\n-100,0,0,1.5e9,50\n0,0,0,1.5e9,50\n100,0,0,1.5e9,50\n";

#[test]
fn a_soft_run_that_is_killed_and_resumed_on_another_thread_count_is_the_same_run() {
    let folder = tempfile::tempdir().unwrap();
    let scene = file(folder.path(), "scene.json", SCENE);
    let (whole, killed) = (folder.path().join("whole"), folder.path().join("killed"));
    let summary = json(&ask(&[&"run", &scene, &"--out", &whole, &"--json", &"--threads", &"1"]));
    let legs = count(&whole, "leg");
    assert!(legs >= 3, "{summary}");
    assert!(summary["normal_stiffness_n_m"].as_f64().unwrap() > 1e6);
    let remembered: i64 =
        open(&whole).query_row("SELECT length(contacts) / 64 FROM state", [], |row| row.get(0)).unwrap();
    assert!(remembered > 40, "{remembered} contacts of 40 spheres");

    for (table, rows) in [("settling", 1), ("leg", 1), ("leg", legs - 1)] {
        let mut child = yorp()
            .args(["run", "--resume", "--threads", "2"])
            .arg(&scene)
            .arg("--out")
            .arg(&killed)
            .stderr(Stdio::null())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        let start = Instant::now();
        while count(&killed, table) < rows && child.try_wait().unwrap().is_none() {
            assert!(start.elapsed() < Duration::from_secs(300), "the run does not get to {rows} rows of {table}");
            std::thread::sleep(Duration::from_millis(5));
        }
        child.kill().unwrap();
        child.wait().unwrap();
    }
    json(&ask(&[&"run", &scene, &"--out", &killed, &"--json", &"--resume"]));
    assert_same(&whole, &killed);
}

#[test]
fn relax_reports_stiffness_contacts_and_books_of_energy_that_close() {
    let folder = tempfile::tempdir().unwrap();
    let chain = file(folder.path(), "chain.csv", CHAIN);
    for preset in ["zhang_2017", "gravel", "glass_beads", "frictionless"] {
        let result = json(&ask(&[
            &"relax",
            &chain,
            &"--contact",
            &"soft",
            &"--preset",
            &preset,
            &"--period-h",
            &"8",
            &"--rotations",
            &"0.1",
            &"--field-tolerance",
            &"0",
            &"--json",
        ]));
        let number = |value: &Value| value.as_f64().unwrap_or_else(|| panic!("{preset}: {result}"));
        assert!(number(&result["energy_drift"]).abs() < 1e-5, "{preset}: {result}");
        assert!(number(&result["angular_momentum_drift"]) < 1e-12, "{preset}: {result}");
        assert!((1e-5..0.01).contains(&number(&result["max_overlap_over_radius"])), "{preset}: {result}");
        assert!((number(&result["contacts_per_sphere"]) - 4.0 / 3.0).abs() < 1e-12, "{preset}: {result}");
        let parts = &result["parts"];
        assert!(number(&parts["stiffness"]["normal_n_m"]) >= number(&parts["stiffness"]["for_impacts_n_m"]));
        assert!(number(&parts["energy"]["heat"]["normal_dashpots_j"]) > 0.0, "{preset}: {result}");
        assert_eq!(result["collisions"], 0);
    }
}

#[test]
fn steps_too_long_spheres_that_cannot_be_and_flags_of_the_other_model_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let chain = file(folder.path(), "chain.csv", CHAIN);
    let relax = |body: &PathBuf, more: [&str; 2]| {
        ask(&[&"relax", body, &"--contact", &"soft", &"--duration-s", &"1000", &more[0], &more[1]])
    };
    refused(&relax(&chain, ["--step-s", "20"]), 2, "a step of 20 s is too long");
    refused(&relax(&chain, ["--field-tolerance", "0.5"]), 2, "--field-tolerance");
    let same = file(folder.path(), "same.csv", "x_m,y_m,z_m,mass_kg,radius_m\n9,0,0,1e9,50\n9,0,0,1e9,50\n");
    refused(&relax(&same, ["--preset", "gravel"]), 2, "spheres 0 and 1 have the same centre");
    let nan = file(folder.path(), "nan.csv", "x_m,y_m,z_m,mass_kg,radius_m\n9,0,0,1e9,50\n0,NaN,0,1e9,50\n");
    refused(&relax(&nan, ["--preset", "gravel"]), 2, "nan.csv");
    let hard = ask(&[&"relax", &chain, &"--duration-s", &"1", &"--preset", &"gravel"]);
    refused(&hard, 2, "--preset goes with --contact soft");

    // Thrown at each other ten times faster than their stiffness is made for.
    let fast = "x_m,y_m,z_m,vx_m_s,vy_m_s,vz_m_s,mass_kg,radius_m\n-60,0,0,1,0,0,1e9,50\n60,0,0,-1,0,0,1e9,50\n";
    let fast = file(folder.path(), "fast.csv", fast);
    let output = relax(&fast, ["--normal-stiffness-n-m", "1e7"]);
    refused(&output, 3, "raise the expected speed or the normal stiffness");
    refused(&output, 3, "spheres 0 and 1 overlap");
}

#[test]
fn a_scene_with_impossible_soft_contacts_is_refused_with_its_path() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let with = |contact: &str| {
        let plain = r#"{"preset": "glass_beads", "steps_per_contact": 15}"#;
        let scene = file(folder.path(), "scene.json", &SCENE.replace(plain, contact));
        ask(&[&"run", &scene, &"--out", &out])
    };
    for (contact, message) in [
        (r#"{"preset": "sand"}"#, "contact.soft_sphere.preset"),
        (
            r#"{"restitution_normal": 1.2}"#,
            "`contact.soft_sphere.restitution_normal` is 1.2; allowed: at least 0, at most 1, or null",
        ),
        (r#"{"preset": "frictionless", "sliding_friction": 0.3}"#, "allowed: null, as friction_model is none"),
        (
            r#"{"preset": "gravel", "friction_model": "rolling_and_twisting"}"#,
            "`contact.soft_sphere.rolling_friction` is null",
        ),
        (r#"{"steps_per_contact": 5}"#, "contact.soft_sphere.steps_per_contact"),
        (r#"{"cohesion_pa": -1}"#, "contact.soft_sphere.cohesion_pa"),
        (r#"{"stiffness": 1e7}"#, "unknown field `stiffness`"),
    ] {
        refused(&with(contact), 2, message);
        assert!(!out.exists(), "{contact}");
    }
    refused(&with(r#"{"step_s": 30}"#), 2, "a step of 30 s is too long for the stiffness of the contacts: at most");
    assert!(!out.exists());
}

#[cfg(unix)]
#[test]
fn an_interrupted_relax_stops_within_a_rotation_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let chain = file(folder.path(), "chain.csv", CHAIN);
    let child = yorp()
        .arg("relax")
        .arg(&chain)
        .args(["--contact", "soft", "--duration-s", "1e12"])
        .stderr(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    // Long enough for the handler to be there; the run itself would take a year.
    std::thread::sleep(Duration::from_millis(500));
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    refused(&output, 130, "interrupted");
}
