//! `yorp torque` through the program: its contract, its symmetries, and what it refuses.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use serde_json::Value;

fn yorp() -> Command {
    Command::cargo_bin("yorp").unwrap()
}

/// A tetrahedron without symmetry, about 300 m across, as OBJ text.
const LOPSIDED: &str = "v 190 20 -10\nv -110 140 0\nv -90 -150 30\nv -20 10 170\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

fn write(folder: &tempfile::TempDir, text: &str) -> PathBuf {
    let file = folder.path().join("shape.obj");
    std::fs::write(&file, text).unwrap();
    file
}

fn torque(file: &Path, arguments: &[&str]) -> Value {
    let output = yorp().arg("torque").arg(file).arg("--json").args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

#[test]
fn the_object_has_exactly_the_keys_of_the_contract() {
    let folder = tempfile::tempdir().unwrap();
    let table = torque(&write(&folder, LOPSIDED), &[]);
    let keys: Vec<&String> = table.as_object().unwrap().keys().collect();
    let expected = [
        "obliquity_deg",
        "spin_torque_n_m",
        "obliquity_torque_n_m",
        "inertia_kg_m2",
        "volume_m3",
        "facets",
        "error_estimate",
        "seconds",
    ];
    assert_eq!(keys, expected.each_ref());
    assert_eq!(numbers(&table["obliquity_deg"]), (0..=36).map(|k| 5.0 * f64::from(k)).collect::<Vec<_>>());
    assert_eq!(table["facets"], 4);
    let estimate = &table["error_estimate"];
    let parts = estimate["parts"].as_object().unwrap();
    for key in ["spin_torque_n_m", "obliquity_torque_n_m"] {
        let sum: f64 = parts.values().map(|part| part[key].as_f64().unwrap()).sum();
        assert!((estimate[key].as_f64().unwrap() - sum).abs() <= 1e-12 * sum);
    }
}

#[test]
fn kilometres_principal_axes_and_density_mean_what_they_say() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(&folder, LOPSIDED);
    let (metres, kilometres) = (torque(&file, &[]), torque(&file, &["--unit", "km"]));
    let ratio = |key: &str| kilometres[key].as_f64().unwrap() / metres[key].as_f64().unwrap();
    assert!((ratio("volume_m3") / 1e9 - 1.0).abs() < 1e-12 && (ratio("inertia_kg_m2") / 1e15 - 1.0).abs() < 1e-12);
    let (small, large) = (numbers(&metres["spin_torque_n_m"]), numbers(&kilometres["spin_torque_n_m"]));
    assert!(small.iter().zip(&large).all(|(s, l)| (l - s * 1e9).abs() <= 1e-9 * l.abs()));
    let principal = torque(&file, &["--axes", "principal", "--density-kg-m3", "1000"]);
    assert!(2.0 * principal["inertia_kg_m2"].as_f64().unwrap() > metres["inertia_kg_m2"].as_f64().unwrap());
}

#[test]
fn a_list_of_obliquities_is_answered_in_its_own_order() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(&folder, LOPSIDED);
    let (table, list) = (torque(&file, &[]), torque(&file, &["--obliquity-deg", "90,0,171.64,45,90"]));
    assert_eq!(numbers(&list["obliquity_deg"]), [90.0, 0.0, 171.64, 45.0, 90.0]);
    let (all, some) = (numbers(&table["spin_torque_n_m"]), numbers(&list["spin_torque_n_m"]));
    assert_eq!((some[0], some[1], some[3], some[4]), (all[18], all[0], all[9], all[18]));
}

#[test]
fn results_do_not_depend_on_the_thread_count() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(&folder, LOPSIDED);
    let run = |threads: &str| {
        let mut table = torque(&file, &["--threads", threads]);
        table.as_object_mut().unwrap().remove("seconds");
        table.to_string()
    };
    assert_eq!(run("1"), run("2"));
}

#[test]
fn the_text_is_a_table_with_rates_and_errors() {
    let folder = tempfile::tempdir().unwrap();
    let output = yorp().arg("torque").arg(write(&folder, LOPSIDED)).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("4 facets") && text.contains("rev/day/Myr") && text.contains("declination_nodes"), "{text}");
    assert!(text.lines().count() > 40);
}

#[test]
fn an_unlikely_size_is_questioned_on_stderr() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(&folder, LOPSIDED);
    let warned = |arguments: &[&str], file: &Path| {
        let output = yorp().arg("torque").arg(file).args(arguments).output().unwrap();
        assert!(output.status.success());
        String::from_utf8(output.stderr).unwrap().contains("--unit")
    };
    assert!(!warned(&[], &file));
    let mut tiny = String::new();
    for line in LOPSIDED.lines() {
        match line.strip_prefix("v ") {
            None => writeln!(tiny, "{line}").unwrap(),
            Some(numbers) => {
                let scaled: Vec<String> =
                    numbers.split(' ').map(|x| (x.parse::<f64>().unwrap() * 1e-3).to_string()).collect();
                writeln!(tiny, "v {}", scaled.join(" ")).unwrap();
            }
        }
    }
    let file = write(&folder, &tiny);
    assert!(warned(&[], &file) && !warned(&["--unit", "km"], &file));
}

#[test]
fn bad_meshes_are_refused_with_line_or_facets() {
    let folder = tempfile::tempdir().unwrap();
    // Two pyramids on one triangle, of which a side is missing.
    let hole = "v 0 0 100\nv 100 0 0\nv -50 90 0\nv -50 -90 0\nv 0 0 -100\n\
                f 1 2 3\nf 1 3 4\nf 1 4 2\nf 5 3 2\nf 5 4 3\n";
    let inside_out = LOPSIDED.replace("f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4", "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1");
    let turned = LOPSIDED.replace("f 1 3 2", "f 1 2 3");
    // A second body that pokes into the first one.
    let crossing = format!(
        "{LOPSIDED}{}f 5 7 6\nf 5 6 8\nf 6 7 8\nf 7 5 8\n",
        "v 240 70 40\nv -60 190 50\nv -40 -100 80\nv 30 60 220\n"
    );
    let cases = [
        (&*crossing, "self-touching mesh"),
        (hole, "a hole beside facets 3, 4, 5"),
        (&inside_out, "inside-out"),
        (&turned, "orientation"),
        (&LOPSIDED.replace("190", "NaN"), "line 1: coordinate `NaN` must be finite"),
        (&LOPSIDED.replace("190", "inf"), "line 1: coordinate `inf` must be finite"),
        (&LOPSIDED.replace("f 1 3 2", "f 1 3 9"), "line 5"),
        ("", "0 vertices"),
        ("\u{0}\u{1}binary", "line 1"),
    ];
    for (text, expected) in cases {
        let file = write(&folder, text);
        let output = yorp().arg("torque").arg(&file).arg("--json").output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{message}");
        assert!(message.contains("shape.obj") && message.contains(expected), "{expected} is missing in:\n{message}");
    }
    let absent = yorp().args(["torque", "no-such.obj"]).output().unwrap();
    assert_eq!(absent.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&absent.stderr).contains("no-such.obj: cannot read the mesh"));
}

#[test]
fn impossible_arguments_are_refused_with_what_is_allowed() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(&folder, LOPSIDED);
    let cases: [(&[&str], &str); 12] = [
        (&["--density-kg-m3", "-5"], "above 0"),
        (&["--eccentricity", "1"], "at least 0, below 1"),
        (&["--orbit-au", "0"], "at least 0.01, at most 1000"),
        (&["--obliquity-step-deg", "7"], "a divisor of 180"),
        (&["--obliquity-deg", "181"], "at most 180"),
        (&["--obliquity-deg", "5", "--obliquity-step-deg", "5"], "cannot be used with"),
        (&["--thermal-inertia", "200"], "only 0"),
        (&["--self-heating", "single"], "possible values: none"),
        (&["--bond-albedo", "0.1"], "--reflectance lambert"),
        (&["--reflectance", "lambert", "--bond-albedo", "1.5"], "at most 1"),
        (&["--period-h", "nan"], "above 0"),
        (&["--emissivity", "0"], "above 0, at most 1"),
    ];
    for (arguments, expected) in cases {
        let output = yorp().arg("torque").arg(&file).args(arguments).output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{arguments:?}: {message}");
        assert!(message.contains(expected), "{arguments:?}: {expected} is missing in:\n{message}");
    }
}
