//! `yorp tile` through the program: the mesh it writes, in which frame, and what it refuses.

use std::fmt::Write as _;
use std::path::PathBuf;

use assert_cmd::Command;
use serde_json::Value;

fn yorp() -> Command {
    Command::cargo_bin("yorp").unwrap()
}

/// A hexagonal close packing cut to an ellipsoid, its centre at (1000, -2000, 500) m, long axis along y.
fn aggregate(folder: &tempfile::TempDir) -> PathBuf {
    let mut text = String::from("x_m,y_m,z_m,mass_kg,radius_m\n");
    for layer in -12_i32..=12 {
        for row in -12_i32..=12 {
            for place in -12_i32..=12 {
                let shift = f64::from(layer.rem_euclid(2));
                let x = 100.0 * f64::from(place) + 50.0 * f64::from(row.rem_euclid(2)) + 50.0 * shift;
                let y = 50.0 * (3.0_f64.sqrt() * f64::from(row) + shift / 3.0_f64.sqrt());
                let z = 100.0 * (2.0_f64 / 3.0).sqrt() * f64::from(layer);
                if (x / 420.0).powi(2) + (y / 600.0).powi(2) + (z / 360.0).powi(2) < 1.0 {
                    writeln!(text, "{},{},{},1.5e9,50", x + 1000.0, y - 2000.0, z + 500.0).unwrap();
                }
            }
        }
    }
    let file = folder.path().join("aggregate.csv");
    std::fs::write(&file, text).unwrap();
    file
}

#[test]
fn the_mesh_is_closed_has_the_facets_asked_for_and_lies_over_the_spheres() {
    let folder = tempfile::tempdir().unwrap();
    let (file, out) = (aggregate(&folder), folder.path().join("mesh.obj"));
    let output =
        yorp().arg("tile").arg(&file).arg("--out").arg(&out).args(["--facets", "384", "--json"]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&report["facets"], &report["vertices"]), (&Value::from(384), &Value::from(194)));
    let mesh = yorp::exchange::read_mesh(&out, 1.0).unwrap().mesh;
    let solid = mesh.solid();
    assert!((report["volume_m3"].as_f64().unwrap() / solid.volume - 1.0).abs() < 1e-9);
    // The centre of mass of the spheres, and the long axis along y.
    for (centre, expected) in solid.centre_of_mass.iter().zip([1000.0, -2000.0, 500.0]) {
        assert!((centre - expected).abs() < 25.0, "{:?}", solid.centre_of_mass);
    }
    let half_width =
        |k: usize| mesh.vertices.iter().map(|v| (v[k] - solid.centre_of_mass[k]).abs()).fold(0.0, f64::max);
    assert!(half_width(1) > half_width(0) && half_width(0) > half_width(2));
}

#[test]
fn a_vtk_file_is_written_too() {
    let folder = tempfile::tempdir().unwrap();
    let (file, out) = (aggregate(&folder), folder.path().join("mesh.vtp"));
    let output = yorp().arg("tile").arg(&file).arg("--out").arg(&out).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8(output.stdout).unwrap().contains("784 facets, 394 vertices"));
    assert!(std::fs::read(out).unwrap().starts_with(b"<?xml"));
}

#[test]
fn bad_input_is_refused_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let file = aggregate(&folder);
    let nan = folder.path().join("nan.csv");
    std::fs::write(&nan, "x_m,y_m,z_m,mass_kg,radius_m\n0,0,0,1,1\n0,NaN,0,1,1\n").unwrap();
    let cases: [(&str, &PathBuf, &[&str], &str); 5] = [
        ("mesh.obj", &folder.path().join("absent.csv"), &[], "absent.csv: cannot read the aggregate"),
        ("mesh.obj", &nan, &[], "line 3"),
        ("mesh.stl", &file, &[], ".obj, .vtp"),
        ("mesh.obj", &file, &["--facets", "785"], "an even number"),
        ("mesh.obj", &file, &["--level", "-1"], "at least 0.1, at most 10"),
    ];
    for (name, file, arguments, expected) in cases {
        let out = folder.path().join(name);
        let output = yorp().arg("tile").arg(file).arg("--out").arg(&out).args(arguments).output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{message}");
        assert!(message.contains(expected) && !out.exists(), "{expected} is missing in:\n{message}");
    }
    let output = yorp().arg("tile").arg(&file).args(["--out", "/no-such-folder/mesh.obj"]).output().unwrap();
    assert_eq!((output.status.code(), output.stdout.len()), (Some(4), 0));
}
