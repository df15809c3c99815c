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
        "spin_acceleration_deg_day2",
        "spin_acceleration_rev_day_myr",
        "obliquity_rate_deg_myr",
        "transverse_force_n",
        "semimajor_axis_drift_au_myr",
        "semimajor_axis_drift_m_yr",
        "inertia_kg_m2",
        "volume_m3",
        "facets",
        "error_estimate",
        "seconds",
    ];
    assert_eq!(keys, expected.each_ref());
    assert_eq!(numbers(&table["obliquity_deg"]), (0..=36).map(|k| 5.0 * f64::from(k)).collect::<Vec<_>>());
    assert_eq!(table["facets"], 4);
    // Without stored heat there is no Yarkovsky force to speak of, and none is computed.
    assert_eq!((&table["transverse_force_n"], &table["semimajor_axis_drift_au_myr"]), (&Value::Null, &Value::Null));
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

/// The same rates in the units that observers and theorists use.
#[test]
fn rates_are_those_of_the_torques() {
    let folder = tempfile::tempdir().unwrap();
    let table = torque(&write(&folder, LOPSIDED), &["--thermal-inertia", "200", "--obliquity-deg", "20,60"]);
    let inertia = table["inertia_kg_m2"].as_f64().unwrap();
    let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
    let of = |key: &str| numbers(&table[key]);
    for k in 0..2 {
        let acceleration = of("spin_torque_n_m")[k] / inertia;
        close(of("spin_acceleration_deg_day2")[k], acceleration.to_degrees() * 86_400.0 * 86_400.0);
        close(of("spin_acceleration_rev_day_myr")[k], of("spin_acceleration_deg_day2")[k] / 360.0 * 365.25e6);
        let tilt = of("obliquity_torque_n_m")[k] / (inertia * std::f64::consts::TAU / 21_600.0);
        close(of("obliquity_rate_deg_myr")[k], tilt.to_degrees() * 365.25e6 * 86_400.0);
        close(of("semimajor_axis_drift_m_yr")[k], of("semimajor_axis_drift_au_myr")[k] * 149_597.870_7);
    }
    let text = yorp().arg("torque").arg(write(&folder, LOPSIDED)).args(["--thermal-inertia", "200"]).output().unwrap();
    let text = String::from_utf8(text.stdout).unwrap();
    let heads = text.lines().find(|line| line.contains("obliquity torque")).unwrap();
    let mut columns: Vec<&str> = heads.split("  ").map(str::trim).filter(|name| !name.is_empty()).collect();
    assert_eq!(columns.len(), 9, "{heads}");
    columns.sort_unstable();
    assert!(columns.windows(2).all(|pair| pair[0] != pair[1]), "{columns:?}");
}

#[test]
fn chosen_obliquities_carry_no_error_of_an_interpolation() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(&folder, LOPSIDED);
    for list in ["45", "0,60,120,180"] {
        let parts = torque(&file, &["--obliquity-deg", list])["error_estimate"]["parts"].clone();
        assert!(parts.get("declination_nodes").is_some() && parts.get("obliquity_interpolation").is_none(), "{parts}");
    }
    assert!(torque(&file, &[])["error_estimate"]["parts"].get("obliquity_interpolation").is_some());
}

#[test]
fn hapke_parameters_change_the_torques_and_have_the_ranges_of_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(&folder, LOPSIDED);
    let list = ["--obliquity-deg", "30"];
    let spin = |arguments: &[&str]| torque(&file, &[&list, arguments].concat())["spin_torque_n_m"].clone();
    let usual = spin(&[]);
    assert_eq!(spin(&["--hapke-single-scattering-albedo", "0.23", "--hapke-asymmetry", "-0.35"]), usual);
    for changed in [
        ["--hapke-single-scattering-albedo", "0.4"],
        ["--hapke-roughness-deg", "0"],
        ["--hapke-asymmetry", "0.1"],
        ["--hapke-multiple-scattering", "imsa"],
    ] {
        assert_ne!(spin(&changed), usual, "{changed:?}");
    }
}

#[test]
fn odd_densities_periods_and_axes_are_questioned_on_stderr() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(&folder, LOPSIDED);
    let says = |arguments: &[&str]| {
        let output = yorp().arg("torque").arg(&file).args(["--obliquity-deg", "30"]).args(arguments).output().unwrap();
        assert!(output.status.success());
        String::from_utf8(output.stderr).unwrap()
    };
    assert!(says(&["--density-kg-m3", "2.7"]).contains("is it in g/cm^3?"));
    assert!(says(&["--period-h", "21600"]).contains("is it in seconds?"));
    assert!(says(&["--period-h", "0.25", "--unit", "km"]).contains("is it in days?"));
    assert!(says(&[]).contains("off the axis of largest moment") && says(&[]).contains("--axes principal"));
    assert!(says(&["--axes", "principal"]).is_empty());
    assert!(says(&["--unit", "cm", "--axes", "principal"]).contains("is --unit right?"));
    let volume = |unit: &str| torque(&file, &["--unit", unit])["volume_m3"].as_f64().unwrap();
    assert!((volume("cm") / volume("m") * 1e6 - 1.0).abs() < 1e-12);
    assert!(says(&["--unit", "cm", "--density-kg-m3", "1e5"]).contains("asteroids have 500 to 8000"));
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
    let wall = ["--wall-coverage", "0.1", "--wall-thickness-m", "0.1", "--wall-conductivity-w-m-k", "1"];
    let cases: [(&[&str], &str); 30] = [
        (&["--density-kg-m3", "-5"], "above 0"),
        (&["--eccentricity", "1"], "at least 0, below 1"),
        (&["--orbit-au", "0"], "at least 0.01, at most 1000"),
        (&["--obliquity-step-deg", "7"], "a divisor of 180"),
        (&["--obliquity-deg", "181"], "at most 180"),
        (&["--obliquity-deg", "5", "--obliquity-step-deg", "5"], "cannot be used with"),
        (&["--thermal-inertia", "-1"], "at least 0, at most 10000"),
        (&["--thermal-inertia", "1e5"], "at least 0, at most 10000"),
        (&["--self-heating", "twice"], "possible values: none, single, multiple"),
        (&["--sky-blockage", "off", "--sky-blockage-reflected", "on"], "--sky-blockage on only"),
        (&["--facet-samples", "3"], "a square number"),
        (&["--azimuth-bins", "100"], "a multiple of 8"),
        (&["--declination-nodes", "36"], "an odd number"),
        (&["--rotation-cells", "15"], "an even number"),
        (&wall, "--wall-thermal-inertia"),
        (&["--wall-thickness-m", "0.1"], "--wall-coverage"),
        (&["--wall-coverage", "1.5"], "at least 0, at most 1"),
        (&["--wall-thickness-m", "0"], "at least 0.00001, at most 100"),
        (&["--wall-conductivity-w-m-k", "1e9"], "at least 0.0001, at most 100"),
        (&["--wall-thermal-inertia", "0"], "at least 1, at most 10000"),
        (&["--out", "curve.dat"], ".csv"),
        (&["--bond-albedo", "0.1"], "--reflectance lambert"),
        (&["--reflectance", "lambert", "--bond-albedo", "1.5"], "at most 1"),
        (&["--period-h", "nan"], "at least 0.002, at most 1e9"),
        (&["--emissivity", "0"], "above 0, at most 1"),
        (&["--hapke-single-scattering-albedo", "1"], "at least 0, below 1"),
        (&["--hapke-roughness-deg", "60"], "at least 0, below 60"),
        (&["--hapke-asymmetry", "-1"], "above -1, below 1"),
        (&["--hapke-roughness-deg", "10", "--reflectance", "none"], "--reflectance hapke only"),
        (&["--hapke-multiple-scattering", "imsa", "--reflectance", "lambert"], "--reflectance hapke only"),
    ];
    for (arguments, expected) in cases {
        let output = yorp().arg("torque").arg(&file).args(arguments).output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{arguments:?}: {message}");
        assert!(message.contains(expected), "{arguments:?}: {expected} is missing in:\n{message}");
    }
}

#[test]
fn quadrangles_and_polygons_are_read_as_triangles() {
    let folder = tempfile::tempdir().unwrap();
    // A box, once of quadrangles and once of their triangles, shifted so that it has a torque to compare.
    let vertices: String = (0..8)
        .map(|k| format!("v {} {} {}\n", 100 * (k & 1), 80 * (k >> 1 & 1) + 20 * (k & 1), 60 * (k >> 2) + 15 * (k & 1)))
        .collect();
    let sides = ["1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"];
    let quadrangles: String = sides.iter().map(|side| format!("f {side}\n")).collect();
    let triangles: String = sides
        .iter()
        .map(|side| {
            let v: Vec<&str> = side.split(' ').collect();
            format!("f {} {} {}\nf {} {} {}\n", v[0], v[1], v[2], v[0], v[2], v[3])
        })
        .collect();
    let whole = torque(&write(&folder, &format!("{vertices}{quadrangles}")), &[]);
    let cut = torque(&write(&folder, &format!("{vertices}{triangles}")), &[]);
    assert_eq!((&whole["facets"], &whole["spin_torque_n_m"]), (&Value::from(12), &cut["spin_torque_n_m"]));
}

#[test]
fn stored_heat_moves_the_obliquity_torque_alone_and_brings_a_force() {
    let folder = tempfile::tempdir().unwrap();
    let (file, csv) = (write(&folder, LOPSIDED), folder.path().join("curve.csv"));
    let cold = torque(&file, &[]);
    let warm = torque(&file, &["--thermal-inertia", "200", "--out", csv.to_str().unwrap()]);
    let largest = |key: &str| numbers(&cold[key]).iter().fold(0.0_f64, |m, t| m.max(t.abs()));
    let change = |key: &str| {
        let pairs = numbers(&cold[key]).into_iter().zip(numbers(&warm[key]));
        pairs.fold(0.0_f64, |m, (c, w)| m.max((w - c).abs())) / largest(key)
    };
    assert!(change("spin_torque_n_m") < 1e-6, "{}", change("spin_torque_n_m"));
    assert!(change("obliquity_torque_n_m") > 0.05, "{}", change("obliquity_torque_n_m"));
    // A prograde body drifts outwards, a retrograde one inwards.
    let (force, drift) = (numbers(&warm["transverse_force_n"]), numbers(&warm["semimajor_axis_drift_au_myr"]));
    assert!(force[0] > 0.0 && drift[0] > 0.0 && force[36] < 0.0 && drift[36] < 0.0);
    let text = std::fs::read_to_string(csv).unwrap();
    let header = "obliquity_deg,spin_rate_rad_s,spin_torque_n_m,obliquity_torque_n_m,spin_acceleration_deg_day2,\
                  spin_acceleration_rev_day_myr,obliquity_rate_deg_myr,transverse_force_n,semimajor_axis_drift_au_myr,\
                  semimajor_axis_drift_m_yr";
    assert_eq!(text.lines().next(), Some(header));
    assert_eq!(text.lines().count(), 38);
    let row: Vec<f64> = text.lines().nth(2).unwrap().split(',').map(|x| x.parse().unwrap()).collect();
    assert_eq!((row[0], row[2], row[7]), (5.0, numbers(&warm["spin_torque_n_m"])[1], force[1]));
    // Another spin, another torque.
    let slow = torque(&file, &["--thermal-inertia", "200", "--period-h", "60"]);
    assert_ne!(slow["obliquity_torque_n_m"], warm["obliquity_torque_n_m"]);
}

#[test]
fn heat_that_lasts_for_seasons_is_warned_about() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(&folder, LOPSIDED);
    let warned = |arguments: &[&str]| {
        let output = yorp().arg("torque").arg(&file).args(arguments).output().unwrap();
        assert!(output.status.success());
        String::from_utf8(output.stderr).unwrap().contains("seasons is neglected")
    };
    assert!(!warned(&["--thermal-inertia", "20"]));
    assert!(warned(&["--thermal-inertia", "2000", "--orbit-au", "3"]));
}

#[test]
fn walls_push_the_spin_up() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(&folder, LOPSIDED);
    let wall = ["--wall-coverage", "0.5", "--wall-thickness-m", "0.02", "--wall-conductivity-w-m-k", "1"];
    let with = torque(&file, &[&wall[..], &["--wall-thermal-inertia", "1500"]].concat());
    let without = torque(&file, &[]);
    let spin = |table: &Value| numbers(&table["spin_torque_n_m"]);
    assert!(spin(&with).iter().zip(spin(&without)).all(|(w, o)| *w > o));
}
