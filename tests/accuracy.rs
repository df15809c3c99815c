//! `yorp accuracy` as a user runs it.

use assert_cmd::Command;
use serde_json::Value;

fn yorp() -> Command {
    Command::cargo_bin("yorp").expect("built with the tests")
}

#[test]
fn quick_accuracy_prints_one_curve_per_knob_and_writes_figure_and_page() {
    let folder = tempfile::tempdir().expect("a directory");
    let output = yorp().args(["accuracy", "--quick", "--json", "--out"]).arg(folder.path()).output().expect("it runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let value: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
    let knobs = value["knobs"].as_array().expect("a list");
    let names: Vec<_> = knobs.iter().map(|k| k["name"].as_str().expect("a name")).collect();
    let expected = [
        "hard_sphere_step",
        "steps_per_contact",
        "field_tolerance",
        "skin",
        "force_error",
        "facets",
        "azimuth_bins",
        "declination_nodes",
        "obliquity_step",
        "facet_samples",
        "rotation_cells",
        "spin_rates",
        "rk4_step",
        "spin_tolerance",
        "ias15_tolerance",
        "multipole_error",
    ];
    assert_eq!(names, expected);
    for knob in knobs {
        let points = knob["points"].as_array().expect("a list");
        assert!(points.iter().any(|p| p["value"] == knob["default"]), "{knob}");
        for point in points {
            // The skin of the neighbour lists may change nothing at all.
            assert!(point["error"].as_f64() >= Some(0.0) && point["seconds"].as_f64() > Some(0.0), "{point}");
        }
    }
    let read = |name: &str| std::fs::read(folder.path().join(name)).expect(name);
    assert_eq!(serde_json::from_slice::<Value>(&read("accuracy.json")).expect("JSON"), value);
    assert!(read("accuracy.svg").starts_with(b"<svg"));
    assert!(read("accuracy.png").starts_with(b"\x89PNG"));
    let page = String::from_utf8(read("accuracy.html")).expect("UTF-8");
    assert!(page.contains("<svg") && page.contains("contact.hard_sphere.step_s") && !page.contains("src="));
}

#[test]
fn a_part_that_does_not_exist_is_answered_with_those_that_do() {
    let output = yorp().args(["accuracy", "warp", "--json"]).output().expect("it runs");
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(output.stdout.is_empty());
    for word in ["warp", "hard_sphere_step", "facets", "pkd", "tiling"] {
        assert!(message.contains(word), "{message}");
    }
}

#[test]
fn a_directory_that_cannot_be_made_is_a_write_failure_before_anything_is_measured() {
    let folder = tempfile::tempdir().expect("a directory");
    let file = folder.path().join("file");
    std::fs::write(&file, "in the way").expect("written");
    let output = yorp().args(["accuracy", "--quick", "--out"]).arg(file.join("out")).output().expect("it runs");
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(4), "{message}");
    assert!(!message.contains("settling"), "{message}");
}
