//! The command line as a user meets it: help with ranges and examples, version, completions, man pages, and its end by a signal.

use std::process::Stdio;
use std::time::{Duration, Instant};

use common::{count, file, yorp};

mod common;

const VERBS: [&str; 14] = [
    "run",
    "rigid",
    "build",
    "relax",
    "plan",
    "schema",
    "tile",
    "torque",
    "track",
    "report",
    "classify",
    "export",
    "accuracy",
    "completions",
];

fn stdout(arguments: &[&str]) -> String {
    let output = yorp().args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn every_help_has_an_example_and_the_next_step_and_ends_with_global_options() {
    for verb in VERBS {
        let help = stdout(&[verb, "--help"]);
        let at = |words: &str| help.find(words).unwrap_or_else(|| panic!("{verb}: no {words:?} in its help"));
        assert!(at("Usage:") < at("Global options:") && at("Global options:") < at("Example:\n  yorp "));
        assert!(at("Example:") < at("Next:\n  "));
        assert!(at("--json") > at("Global options:") && at("--threads") > at("Global options:"));
    }
    assert!(stdout(&["--help"]).contains("completions"));
}

#[test]
fn help_names_the_ranges_that_refusals_name() {
    let help = stdout(&["torque", "--help"]);
    let refusal = yorp().args(["torque", "--emissivity=2", "x.obj"]).output().unwrap();
    assert_eq!(refusal.status.code(), Some(2));
    let refusal = String::from_utf8(refusal.stderr).unwrap();
    assert!(
        refusal.contains("allowed: above 0, at most 1") && help.contains("[allowed: above 0, at most 1]"),
        "{refusal}"
    );
    let help = stdout(&["accuracy", "--help"]);
    assert!(help.contains("facet_samples") && help.contains("taco"));
}

#[test]
fn the_version_carries_the_commit() {
    let version = stdout(&["--version"]);
    assert!(
        version.starts_with("yorp ") && version.contains(" (commit ") && version.trim_end().ends_with(')'),
        "{version}"
    );
}

#[test]
fn completions_and_man_pages_know_every_verb() {
    for shell in ["bash", "zsh", "fish"] {
        let text = stdout(&["completions", shell]);
        assert!(VERBS.iter().all(|verb| text.contains(verb)), "{shell}");
    }
    let folder = tempfile::tempdir().unwrap();
    stdout(&["man", folder.path().to_str().unwrap()]);
    for verb in VERBS {
        let page = std::fs::read_to_string(folder.path().join(format!("yorp-{verb}.1"))).unwrap();
        assert!(page.contains("Example:"), "{verb}");
    }
}

/// A body whose single steps take long: whatever the program is doing, SIGTERM ends it within two seconds.
#[test]
#[cfg(unix)]
fn sigterm_is_answered_within_two_seconds_with_the_truth() {
    let folder = tempfile::tempdir().unwrap();
    let body = |spheres: u32| {
        format!(
            r#"{{"body": {{"packed_ellipsoid": {{"spheres": {spheres}, "radius_m": 20, "grain_density_kg_m3": 2960,
            "b_over_a": 0.9, "c_over_a": 0.8}}}}, "spin": {{"period_h": 7}}}}"#
        )
    };
    let large = file(folder.path(), "large.json", &body(20_000));
    let small = file(folder.path(), "small.json", &body(400));
    let out = folder.path().join("run");
    let path = |p: &std::path::Path| p.to_str().unwrap().to_owned();
    let cases = [
        (vec!["run".to_owned(), path(&large), "--out".into(), path(&out)], 700, "--resume goes on"),
        (
            vec!["build".into(), path(&small), "--out".into(), path(&folder.path().join("a.csv"))],
            700,
            "nothing was written",
        ),
        (vec!["run".into(), path(&small), "--out".into(), path(&folder.path().join("b"))], 2500, "--resume goes on"),
    ];
    for (arguments, after_ms, words) in cases {
        let child = yorp().args(&arguments).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(after_ms));
        let asked = Instant::now();
        let kill = std::process::Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap();
        assert!(kill.success());
        let output = child.wait_with_output().unwrap();
        let (seconds, stderr) = (asked.elapsed().as_secs_f64(), String::from_utf8_lossy(&output.stderr).into_owned());
        assert_eq!(output.status.code(), Some(130), "{arguments:?}: {stderr}");
        assert!(seconds < 2.0 + 1.0, "{arguments:?}: {seconds} s");
        assert!(stderr.contains(words), "{arguments:?}: {stderr}");
    }
    assert!(count(&out, "leg") == 0 && !folder.path().join("a.csv").exists());
}

#[test]
fn a_level_of_vector_instructions_that_is_none_is_refused_and_the_plain_one_is_everywhere() {
    let ask = |level: &str| yorp().env("YORP_SIMD", level).arg("schema").output().unwrap();
    let refused = ask("neon9");
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("scalar, sse2, avx2 or avx512"));
    assert!(ask("scalar").status.success());
}

/// Hard spheres, direct and tree gravity, at every level that the processor has.
#[test]
fn relaxed_bodies_are_the_same_bytes_at_every_level() {
    let folder = tempfile::tempdir().unwrap();
    let scene = r#"{"body": {"packed_ellipsoid": {"spheres": 60, "radius_m": 50, "grain_density_kg_m3": 2960, "b_over_a": 0.8,
        "c_over_a": 0.7}}}"#;
    let scene = file(folder.path(), "scene.json", scene);
    let body = folder.path().join("body.csv");
    let built = yorp().args(["build", "--unsettled", "--out"]).arg(&body).arg(&scene).output().unwrap();
    assert!(built.status.success());
    for (contact, gravity) in [("hard", "direct"), ("hard", "tree"), ("soft", "direct"), ("soft", "tree")] {
        let at = |level: &str| {
            let out = folder.path().join(format!("{level}.csv"));
            let arguments = [
                "relax",
                "--contact",
                contact,
                "--gravity",
                gravity,
                "--duration-s",
                "2000",
                "--period-h",
                "6",
                "--out",
            ];
            let done = yorp().env("YORP_SIMD", level).args(arguments).arg(&out).arg(&body).output().unwrap();
            done.status.success().then(|| std::fs::read(out).unwrap())
        };
        let plain = at("scalar").unwrap();
        for level in ["sse2", "avx2", "avx512"] {
            match at(level) {
                Some(bytes) => assert!(bytes == plain, "{contact} {gravity} at {level}"),
                None => println!("skipped: this processor lacks {level}"),
            }
        }
    }
}
