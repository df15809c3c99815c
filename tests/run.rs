//! `yorp run` as a user meets it: a run to its end, killed and resumed, on one thread and two, and refused.

use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use common::{assert_same, contents, count, file, json, open, refused, yorp};

mod common;

/// A body small and loose enough to settle, take legs, move and be tiled again within seconds.
const SCENE: &str = r#"{
  "name": "test",
  "seed": 4,
  "body": {"packed_ellipsoid": {"spheres": 100, "radius_m": 50.2, "grain_density_kg_m3": 2960, "b_over_a": 0.8, "c_over_a": 0.7}},
  "spin": {"period_h": 4.5, "obliquity_deg": 40},
  "contact": {"hard_sphere": {"collapse_limit": 1e-3, "step_s": 100}},
  "settling": {"rotations": 1, "max_rotations": 10},
  "tiling": {"facets": 200},
  "torque": {"obliquity_step_deg": 15},
  "evolution": {"duration_myr": 0.1, "spin_change": 0.01, "movement_radius_fraction": 0.1}
}"#;

fn run(scene: &Path, out: &Path, more: &[&str]) -> Output {
    yorp().arg("run").arg(scene).arg("--out").arg(out).args(more).output().unwrap()
}

#[test]
fn a_run_reaches_its_end_with_legs_movements_and_new_torques() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, out) = (file(folder.path(), "scene.json", SCENE), folder.path().join("out"));
    let result = json(&run(&scene, &out, &["--json"]));
    assert_eq!(result["outcome"], "end_time");
    assert!((result["t_myr"].as_f64().unwrap() - 0.1).abs() < 1e-12);
    assert!(result["movements"].as_i64().unwrap() >= 1 && result["legs"].as_i64().unwrap() >= 2, "{result}");
    for part in ["build", "settle", "check", "movement", "torque", "tiling", "spin", "store"] {
        assert!(result["parts"][part]["seconds"].is_number(), "{part}");
    }
    let db = open(&out);
    let torques: Vec<Vec<u8>> = db
        .prepare("SELECT spin_torque FROM configuration ORDER BY configuration")
        .unwrap()
        .query_map([], |row| row.get(0))
        .unwrap()
        .map(Result::unwrap)
        .collect();
    assert!(torques.windows(2).all(|pair| pair[0] != pair[1]), "a movement must change the torques");
    let wrong_intervals: i64 = db
        .query_row("SELECT count(*) FROM interval AS i JOIN interval AS j ON j.interval = i.interval + 1 WHERE j.t0_s <> i.t1_s", [], |r| r.get(0))
        .unwrap();
    assert_eq!(wrong_intervals, 0, "intervals must follow each other");
    // Finished: the same summary again, and nothing changes.
    let before = contents(&out);
    let again = json(&run(&scene, &out, &["--json", "--resume"]));
    assert_eq!(
        (&again["legs"], &again["outcome"], &again["period_h"]),
        (&result["legs"], &result["outcome"], &result["period_h"])
    );
    assert!(before == contents(&out));
}

#[test]
fn killed_resumed_and_on_other_thread_counts_it_is_the_same_run() {
    let folder = tempfile::tempdir().unwrap();
    let scene = file(folder.path(), "scene.json", SCENE);
    let (whole, killed, two) = (folder.path().join("whole"), folder.path().join("killed"), folder.path().join("two"));
    json(&run(&scene, &whole, &["--json", "--threads", "1"]));
    json(&run(&scene, &two, &["--json", "--threads", "2"]));
    assert_same(&whole, &two);

    let legs = count(&whole, "leg");
    for stop_at in [("settling", 1), ("leg", 1), ("leg", legs / 2), ("leg", legs - 1)] {
        let mut child = yorp()
            .args(["run", "--resume"])
            .arg(&scene)
            .arg("--out")
            .arg(&killed)
            .stderr(Stdio::null())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        let start = Instant::now();
        while count(&killed, stop_at.0) < stop_at.1 && child.try_wait().unwrap().is_none() {
            assert!(start.elapsed() < Duration::from_secs(300), "the run does not get to {stop_at:?}");
            std::thread::sleep(Duration::from_millis(5));
        }
        child.kill().unwrap();
        child.wait().unwrap();
    }
    json(&run(&scene, &killed, &["--json", "--resume"]));
    assert_same(&whole, &killed);
}

#[test]
fn stopping_at_a_time_and_going_on_is_the_same_run() {
    let folder = tempfile::tempdir().unwrap();
    let scene = file(folder.path(), "scene.json", SCENE);
    let (whole, parts) = (folder.path().join("whole"), folder.path().join("parts"));
    json(&run(&scene, &whole, &["--json", "--until-myr", "0.07"]));
    let built = json(&run(&scene, &parts, &["--json", "--until-myr", "0"]));
    assert_eq!((built["t_myr"].as_f64(), built["outcome"].as_str()), (Some(0.0), Some("until")));
    assert_eq!(built["legs"], 0);
    let first = json(&run(&scene, &parts, &["--json", "--resume", "--until-myr", "0.0433"]));
    assert!((first["t_myr"].as_f64().unwrap() - 0.0433).abs() < 1e-12);
    json(&run(&scene, &parts, &["--json", "--resume", "--until-myr", "0.07"]));
    assert_same(&whole, &parts);
}

/// With stored heat the torques are a table over spin rates, and shed spheres are followed: both must come back as they were.
#[test]
fn a_run_with_heat_and_orbits_goes_on_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let text = SCENE.replace(
        r#""torque": {"obliquity_step_deg": 15},"#,
        r#""torque": {"obliquity_step_deg": 15, "declination_nodes": 9, "azimuth_bins": 24, "rotation_cells": 16, "spin_rates": 5},
           "surface": {"thermal_inertia": 200, "self_heating": "single"}, "shed": {"track": {"rebound": {}}},"#,
    );
    let scene = file(folder.path(), "scene.json", &text);
    let [straight, stopped] = ["straight", "stopped"].map(|name| folder.path().join(name));
    json(&run(&scene, &straight, &["--json", "--threads", "2", "--until-myr", "0.04"]));
    json(&run(&scene, &stopped, &["--json", "--threads", "1", "--until-myr", "0.013"]));
    json(&run(&scene, &stopped, &["--json", "--resume", "--until-myr", "0.04"]));
    assert_same(&straight, &stopped);
    let nodes = open(&straight).query_row("SELECT length(spin_rate) / 8 FROM configuration", [], |row| row.get(0));
    assert_eq!(nodes, Ok(5));
}

#[test]
fn a_directory_that_holds_a_run_is_locked_or_is_not_a_directory_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, out) = (file(folder.path(), "scene.json", SCENE), folder.path().join("out"));
    json(&run(&scene, &out, &["--json", "--until-myr", "0"]));
    refused(&run(&scene, &out, &[]), 2, "already holds a run");

    let other = folder.path().join("other.json");
    std::fs::write(&other, SCENE.replace("\"seed\": 4", "\"seed\": 5")).unwrap();
    refused(&run(&other, &out, &["--resume"]), 2, "seed");

    let lock = std::fs::File::open(out.join(".lock")).unwrap();
    lock.lock().unwrap();
    refused(&run(&scene, &out, &["--resume"]), 2, "in use");
    drop(lock);

    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    refused(&run(&scene, &file, &[]), 2, "not a directory");
    refused(&run(&scene, &file.join("below"), &[]), 4, "cannot write");
}

#[test]
fn a_wrong_input_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let scene = file(folder.path(), "scene.json", &SCENE.replace("50.2", "-50.2"));
    refused(&run(&scene, &out, &[]), 2, "body.packed_ellipsoid.radius_m");
    refused(&run(&folder.path().join("absent.json"), &out, &[]), 2, "absent.json");

    // A file body whose content is wrong is only found when it is read.
    std::fs::write(folder.path().join("body.csv"), "x_m,y_m,z_m,mass_kg,radius_m\n0,0,NaN,1e9,50\n").unwrap();
    let scene = file(folder.path(), "scene.json", r#"{"body": {"file": {"path": "body.csv"}}}"#);
    refused(&run(&scene, &out, &[]), 2, "body.csv");
    std::fs::write(folder.path().join("body.csv"), "x_m,y_m,z_m,mass_kg,radius_m\n").unwrap();
    refused(&run(&scene, &out, &[]), 2, "body.csv");
    assert!(!out.exists());
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_saves_its_state_and_exits_130() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, out) = (
        file(folder.path(), "scene.json", &SCENE.replace("\"duration_myr\": 0.1", "\"duration_myr\": 50")),
        folder.path().join("out"),
    );
    let child = yorp()
        .arg("run")
        .arg(&scene)
        .arg("--out")
        .arg(&out)
        .stderr(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let start = Instant::now();
    while count(&out, "leg") < 1 {
        assert!(start.elapsed() < Duration::from_secs(300));
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    refused(&output, 130, "interrupted");
    assert!(count(&out, "leg") >= 1);
}
