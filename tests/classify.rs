//! `yorp classify` as a user meets it: on a run that is through, on one that has hardly begun, on one that goes on, and
//! on what is no run.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use common::{json, open, refused, yorp};
use rusqlite::Connection;
use serde_json::Value;
use synthetic::{Synthetic, Until};

mod common;
mod synthetic;

/// A body that settles, takes legs and moves within seconds.
const SCENE: &str = r#"{
  "name": "loose body",
  "seed": 4,
  "body": {"packed_ellipsoid": {"spheres": 100, "radius_m": 50.2, "grain_density_kg_m3": 2960, "b_over_a": 0.8, "c_over_a": 0.7}},
  "spin": {"period_h": 4.5, "obliquity_deg": 40},
  "contact": {"hard_sphere": {"collapse_limit": 1e-3, "step_s": 100}},
  "settling": {"rotations": 1, "max_rotations": 10},
  "tiling": {"facets": 200},
  "torque": {"obliquity_step_deg": 15},
  "evolution": {"duration_myr": 0.1, "spin_change": 0.01, "movement_radius_fraction": 0.1}
}"#;

fn run(folder: &Path, more: &[&str]) -> (Command, PathBuf) {
    let (scene, out) = (folder.join("scene.json"), folder.join("out"));
    std::fs::write(&scene, SCENE).unwrap();
    let mut command = yorp();
    command.args(["run", "--json"]).arg(scene).arg("--out").arg(&out).args(more);
    (command, out)
}

fn classify(directory: &Path, more: &[&str]) -> Output {
    yorp().arg("classify").arg(directory).args(more).output().unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn a_finished_run_has_types_and_statistics_that_fit_its_database() {
    let folder = tempfile::tempdir().unwrap();
    let (mut command, out) = run(folder.path(), &[]);
    let summary = json(&command.output().unwrap());
    let found = json(&classify(&out, &["--json"]));
    assert_eq!((&found["name"], &found["outcome"]), (&"loose body".into(), &"end_time".into()));
    assert!((number(&found["t_myr"]) - 0.1).abs() < 1e-12);
    for quantity in ["spin", "obliquity"] {
        let label = found[quantity]["type"].as_str().unwrap();
        assert!(["MYC", "Sto", "SG", "Sto/SG", "SG/Sto", "too short to say"].contains(&label), "{quantity}: {label}");
        let stretch = &found[quantity]["stretches"][0];
        assert!(stretch["why"].as_str().is_some_and(|why| !why.is_empty()), "{stretch}");
        assert!(number(&stretch["from_myr"]) < number(&stretch["to_myr"]));
    }
    assert_eq!(found["self_limited"], found["spin"]["type"] != "MYC");

    let db = open(&out);
    let count = |sql: &str| db.query_row(sql, [], |row| row.get::<_, f64>(0)).unwrap();
    let intervals = found["walk"]["intervals"].as_array().unwrap();
    assert_eq!(intervals.len() as f64, count("SELECT total(1) FROM interval"));
    assert_eq!(found["movements"]["count"], summary["movements"]);
    assert_eq!(number(&found["movements"]["spheres_moved"]), count("SELECT total(1) FROM movement"));
    let inner = count("SELECT total(enclosed_mass_fraction <= 0.5) / total(1) FROM movement");
    assert!((number(&found["movements"]["inner_half"]) - inner).abs() < 1e-12);
    assert_eq!(intervals[0]["alpha_s"], Value::Null);
    let [rev_day, myr] = [std::f64::consts::TAU / 86_400.0, 3.155_76e13];
    for (k, interval) in intervals.iter().enumerate().skip(1) {
        let row = format!("FROM interval ORDER BY interval LIMIT 1 OFFSET {k}");
        let rate = count(&format!("SELECT abs(omega1 - omega0) / (t1_s - t0_s) {row}")) / rev_day * myr;
        assert!((number(&interval["alpha_s"]).abs() / rate - 1.0).abs() < 1e-9, "interval {k}");
    }

    // The largest spins: the aggregate's from its legs, the rigid body's from the curve on record.
    let max = count("SELECT max(max(omega0, omega1)) FROM leg") / rev_day;
    assert!((number(&found["aggregate"]["max_spin_rev_day"]) / max - 1.0).abs() < 1e-12);
    if found["rigid"]["end"] == "spun_down" {
        let max = count("SELECT max(omega) FROM rigid") / rev_day;
        assert!((number(&found["rigid"]["max_spin_rev_day"]) / max - 1.0).abs() < 1e-12);
    }
    let text = String::from_utf8(classify(&out, &[]).stdout).unwrap();
    assert!(text.contains("loose body") && text.contains("obliquity") && text.contains("movements"), "{text}");
}

#[test]
fn a_run_that_has_only_settled_is_described_without_types() {
    let folder = tempfile::tempdir().unwrap();
    let (mut command, out) = run(folder.path(), &["--until-myr", "0"]);
    json(&command.output().unwrap());
    let found = json(&classify(&out, &["--json"]));
    assert_eq!((&found["spin"]["type"], &found["self_limited"]), (&"".into(), &Value::Null));
    assert_eq!((&found["aggregate"], &found["movements"]["inner_half"]), (&Value::Null, &Value::Null));
    assert!(number(&found["shape"]["start"]["half_extents"]["c_over_a"]) > 0.5);
    assert!(found["rigid"]["end_obliquity_deg"].is_number());
    let text = String::from_utf8(classify(&out, &[]).stdout).unwrap();
    assert!(text.contains("nothing to classify yet"), "{text}");
}

#[test]
fn a_run_is_classified_while_it_goes_on_and_is_not_disturbed() {
    let folder = tempfile::tempdir().unwrap();
    let (mut command, out) = run(folder.path(), &[]);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let mut seen = 0.0_f64;
    while child.try_wait().unwrap().is_none() {
        let output = classify(&out, &["--json"]);
        if output.status.success() {
            let now = number(&json(&output)["t_myr"]);
            assert!(now >= seen, "{now} after {seen}");
            seen = now;
        } else {
            // Before its first transaction there is no run.
            let stderr = String::from_utf8_lossy(&output.stderr);
            assert!(seen == 0.0 && stderr.contains("no run"), "{stderr}");
        }
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let output = child.wait_with_output().unwrap();
    assert_eq!(json(&output)["outcome"], "end_time");
    assert!(seen > 0.0, "the run was never seen on its way");
}

#[test]
fn what_is_no_run_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |directory: &Path, message: &str| refused(&classify(directory, &["--json"]), 2, message);
    refused(folder.path(), "no run");
    refused(&folder.path().join("absent"), "no run");
    std::fs::write(folder.path().join("run.sqlite"), "not a database, but long enough to be one".repeat(100)).unwrap();
    refused(folder.path(), "run.sqlite");
    std::fs::remove_file(folder.path().join("run.sqlite")).unwrap();
    let foreign = Connection::open(folder.path().join("run.sqlite")).unwrap();
    foreign.execute_batch("CREATE TABLE leg (leg INTEGER)").unwrap();
    drop(foreign);
    refused(folder.path(), "not a yorp run database");
}

#[test]
fn a_run_is_classified_at_every_stage_and_its_losses_are_those_on_record() {
    for until in [Until::Begun, Until::Built, Until::Settling, Until::Object0, Until::Legs, Until::End] {
        let folder = tempfile::tempdir().unwrap();
        Synthetic { until, configurations: 30, ..Synthetic::default() }.write(folder.path());
        let found = json(&classify(folder.path(), &["--json"]));
        assert!(classify(folder.path(), &[]).status.success());
        let evolved = matches!(until, Until::Legs | Until::End);
        assert_eq!(found["spin"]["type"] != "", evolved, "{until:?}");
        if evolved {
            let count = |sql: &str| open(folder.path()).query_row(sql, [], |row| row.get::<_, f64>(0)).unwrap();
            let events = found["losses"]["events"].as_array().unwrap();
            assert_eq!(events.len() as f64, count("SELECT count(DISTINCT leg) * 1.0 FROM loss WHERE leg >= 0"));
            let share = "SELECT 100 * (SELECT total(mass_kg) FROM sphere JOIN loss USING (sphere) WHERE leg >= 0) / total(mass_kg) FROM sphere";
            assert!((number(&found["losses"]["mass_percent"]) - count(share)).abs() < 1e-9);
            let fates = &found["losses"]["fates"];
            for fate in ["reimpact", "escape", "bound", "merged"] {
                let of = format!("SELECT total(1) FROM fate WHERE leg >= 0 AND fate = '{fate}'");
                assert_eq!(number(&fates[fate]), count(&of), "{fate}");
            }
            let event = &events[0];
            let sphere = number(&event["sphere_limit_rev_day"]);
            assert!(
                (number(&event["prolate_limit_rev_day"]) / sphere - number(&event["b_over_a"]).sqrt()).abs() < 1e-12
            );
        }
    }
}
