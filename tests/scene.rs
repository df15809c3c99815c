//! Scenes through the program: shipped ones are accepted, broken ones refused with everything one needs to mend them.

use std::path::{Path, PathBuf};

use assert_cmd::Command;
use common::judge::conforms;
use proptest::prelude::*;
use serde_json::{Value, json};
use yorp::scene::{Body, Contact, Reflectance, Scene, SceneError, SceneFile, json_schema};

mod common;

fn yorp() -> Command {
    Command::cargo_bin("yorp").unwrap()
}

fn scenarios() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios")
}

fn shipped() -> Vec<PathBuf> {
    let paper = ["06h", "08h", "10h", "13h"].map(String::from).into_iter().chain((1..=16).map(|n| format!("{n:02}")));
    let mut files: Vec<PathBuf> =
        paper.map(|name| scenarios().join(format!("cotto_figueroa_2015/{name}.json"))).collect();
    for entry in std::fs::read_dir(scenarios()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "json") {
            files.push(path);
        }
    }
    files
}

/// The normative scene of the format, every key written out.
const COMPLETE: &str = r#"{
  "format": 1,
  "name": "cotto-figueroa-2015-07",
  "seed": 7,
  "body": {"packed_ellipsoid": {"spheres": 1000, "radius_m": 50.2, "grain_density_kg_m3": 2960, "b_over_a": 0.70, "c_over_a": 0.70}},
  "spin": {"period_h": 5.74, "obliquity_deg": 5},
  "contact": {"hard_sphere": {"restitution_normal": 0.2, "restitution_tangential": 0.5, "slide_limit": 0.01, "collapse_limit": 1e-5, "step_s": 50}},
  "gravity": {"method": "auto", "force_error": 1e-3},
  "settling": {"rotations": 5, "max_rotations": 50},
  "tiling": {"facets": 784, "exponent": 2, "level": 1.25},
  "orbit": {"semimajor_axis_au": 1.0, "eccentricity": 0.0},
  "surface": {
    "reflectance": {"hapke": {"single_scattering_albedo": 0.23, "roughness_deg": 20, "asymmetry": -0.35, "multiple_scattering": "h2002"}},
    "thermal_inertia": 0, "emissivity": 0.9, "shadows": true, "sky_blockage": true, "self_heating": "none", "tangential_yorp": "none"
  },
  "torque": {"obliquity_step_deg": 5},
  "evolution": {"duration_myr": 15, "spin_change": 0.005, "rk4_step_yr": 1000, "movement_radius_fraction": 0.25, "movement_rule": "robust", "moved_fraction_limit": 0.5, "stop_period_h": 20},
  "shed": {"track": "none"}
}"#;

/// A value of `surface.tangential_yorp`.
const WALL: &str = r#""tangential_yorp": {"wall": {"coverage": 0.1, "thickness_m": 0.05, "conductivity_w_m_k": 1, "thermal_inertia": 1500}}"#;

fn parse(text: &str) -> Result<Scene, SceneError> {
    Scene::parse(text, Path::new("scene.json"))
}

/// The complete scene with one piece of text replaced.
fn with(old: &str, new: &str) -> String {
    assert_eq!(COMPLETE.matches(old).count(), 1, "{old} must stand once in the scene");
    COMPLETE.replace(old, new)
}

#[test]
fn the_complete_scene_is_the_scene_of_its_body_with_every_default() {
    let scene = parse(COMPLETE).unwrap();
    let mut defaults = Scene::from_body(scene.body.clone());
    (defaults.name, defaults.seed, defaults.spin) = (scene.name.clone(), scene.seed, scene.spin.clone());
    assert_eq!(scene, defaults);
}

#[test]
fn a_written_scene_reads_back_equal() {
    let scene = parse(COMPLETE).unwrap();
    assert_eq!(parse(&scene.to_json()).unwrap(), scene);
}

#[test]
fn every_shipped_scene_is_valid_and_has_a_plan() {
    let files = shipped();
    assert!(files.len() >= 21);
    for file in files {
        let scene = SceneFile::read(&file).unwrap_or_else(|error| panic!("{error}")).scene;
        assert!(conforms(&serde_json::from_str(&scene.to_json()).unwrap(), &json_schema()), "{}", file.display());
        let text: Value = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
        assert!(conforms(&text, &json_schema()), "{}", file.display());
    }
    let plan = yorp().args(["plan", "--json"]).arg(scenarios().join("cotto_figueroa_2015/07.json")).output().unwrap();
    assert!(plan.status.success());
    let plan: Value = serde_json::from_slice(&plan.stdout).unwrap();
    assert_eq!(plan["name"], "cotto-figueroa-2015-07");
    let conduction = plan["parts"].as_array().unwrap().iter().find(|part| part["name"] == "heat conduction").unwrap();
    assert_eq!((&conduction["on"], &conduction["method"]), (&json!(false), &Value::Null));
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("warm.json");
    std::fs::write(&file, with("\"thermal_inertia\": 0", "\"thermal_inertia\": 200")).unwrap();
    let plan = yorp().arg("plan").arg(&file).output().unwrap();
    let text = String::from_utf8(plan.stdout).unwrap();
    assert!(
        text.contains("half-space of Gamma = 200") && text.contains("11 spin rates from 0 to a period of 2 h"),
        "{text}"
    );
}

#[test]
fn paper_table_1_is_what_the_scenes_hold() {
    // Table 1 of Cotto-Figueroa et al. 2015: b/a, c/a, period (h), simulations 2 to 16.
    let table = [
        (0.88, 0.87, 10.00),
        (0.94, 0.83, 10.51),
        (0.86, 0.74, 5.52),
        (0.88, 0.82, 10.34),
        (0.78, 0.69, 5.72),
        (0.70, 0.70, 5.74),
        (0.74, 0.65, 6.09),
        (0.77, 0.62, 6.26),
        (0.99, 0.76, 5.70),
        (0.97, 0.89, 5.00),
        (0.51, 0.50, 5.28),
        (0.68, 0.55, 4.54),
        (0.59, 0.53, 4.84),
        (0.78, 0.59, 4.35),
        (0.92, 0.64, 4.19),
    ];
    for (number, expected) in (2..).zip(table) {
        let scene = SceneFile::read(&scenarios().join(format!("cotto_figueroa_2015/{number:02}.json"))).unwrap().scene;
        let Body::PackedEllipsoid(body) = &scene.body else { panic!("a packing") };
        assert_eq!((body.b_over_a, body.c_over_a, scene.spin.period_h), expected, "simulation {number}");
        assert_eq!((body.spheres, body.radius_m, body.grain_density_kg_m3), (1000, 50.2, 2960.0));
        // The first packing of the series n, n + 100, ... that would spin up.
        assert_eq!((scene.seed % 100, scene.tiling.facets), (number, 784));
        assert_eq!(scene.spin.obliquity_deg, if number == 16 { 85.0 } else { 5.0 });
    }
    for number in [6, 8, 10, 13] {
        let read = |suffix| {
            SceneFile::read(&scenarios().join(format!("cotto_figueroa_2015/{number:02}{suffix}.json"))).unwrap().scene
        };
        let (high, low) = (read("h"), read(""));
        assert_eq!((high.tiling.facets, high.body, high.seed), (3184, low.body, low.seed));
    }
}

#[test]
fn the_schema_refuses_what_the_reader_refuses() {
    let schema = json_schema();
    let conforming = |text: &str| conforms(&serde_json::from_str(text).unwrap(), &schema);
    assert!(conforming(COMPLETE));
    assert!(conforming(&with("\"stop_period_h\": 20", "\"stop_period_h\": null")));
    assert!(!conforming(&with("\"eccentricity\": 0.0", "\"eccentricity\": 1")));
    assert!(!conforming(&with("\"radius_m\": 50.2", "\"radius_m\": -50.2")));
    assert!(!conforming(&with("\"thermal_inertia\": 0", "\"thermal_inertia\": -200")));
    assert!(conforming(&with("\"tangential_yorp\": \"none\"", WALL)));
    assert!(!conforming(&with("\"tangential_yorp\": \"none\"", &WALL.replace("0.05", "-0.05"))));
    assert!(!conforming(&with("\"level\"", "\"levle\"")));
    let printed = yorp().arg("schema").output().unwrap();
    assert_eq!(serde_json::from_slice::<Value>(&printed.stdout).unwrap(), schema);
}

/// What a refusal of `text` must say.
fn refused(text: &str, expected: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.json");
    std::fs::write(&file, text).unwrap();
    let output = yorp().args(["plan", "--json"]).arg(&file).output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(output.stdout.is_empty());
    for piece in expected {
        assert!(message.contains(piece), "{piece:?} is missing in:\n{message}");
    }
}

/// "file:line:column" of the one place where `piece` stands in `text`.
fn place(text: &str, piece: &str) -> String {
    let offset = text.find(piece).unwrap();
    let before = &text[..offset];
    let column = before.len() - before.rfind('\n').map_or(0, |newline| newline + 1) + 1;
    format!("scene.json:{}:{column}", before.matches('\n').count() + 1)
}

#[test]
fn a_value_out_of_range_is_refused_with_place_path_value_and_range() {
    let cases = [
        ("\"radius_m\": 50.2", "-1.5", "body.packed_ellipsoid.radius_m", "above 0, at most 1000000"),
        ("\"spheres\": 1000", "0", "body.packed_ellipsoid.spheres", "at least 10, at most 1000000"),
        ("\"spheres\": 1000", "4000000000", "body.packed_ellipsoid.spheres", "at least 10, at most 1000000"),
        ("\"b_over_a\": 0.70", "1.25", "body.packed_ellipsoid.b_over_a", "at least 0.1, at most 1"),
        ("\"c_over_a\": 0.70", "0.75", "body.packed_ellipsoid.c_over_a", "at most b_over_a = 0.7"),
        ("\"eccentricity\": 0.0", "1", "orbit.eccentricity", "at least 0, below 1"),
        ("\"roughness_deg\": 20", "90", "surface.reflectance.hapke.roughness_deg", "at least 0, below 60"),
        ("\"obliquity_step_deg\": 5", "7", "torque.obliquity_step_deg", "a divisor of 180"),
        ("\"facets\": 784", "785", "tiling.facets", "even"),
        ("\"thermal_inertia\": 0", "-200", "surface.thermal_inertia", "at least 0, at most 10000"),
        ("\"max_rotations\": 50", "4", "settling.max_rotations", "at least settling.rotations = 5"),
        ("\"stop_period_h\": 20", "5", "evolution.stop_period_h", "above spin.period_h = 5.74"),
        ("\"period_h\": 5.74", "1e300", "spin.period_h", "at least 0.1, at most 100000"),
        ("\"format\": 1", "2", "format", "only 1"),
    ];
    for (old, value, path, range) in cases {
        let key = old.split(": ").next().unwrap();
        let text = with(old, &format!("{key}: {value}"));
        let at = place(&text, &format!("{key}: {value}"));
        let (at, column) = at.rsplit_once(':').unwrap();
        let at = format!("{at}:{}", column.parse::<usize>().unwrap() + key.len() + 2);
        refused(&text, &[&at, &format!("`{path}` is {value}; allowed: "), range]);
    }
}

#[test]
fn knobs_of_the_torque_table_are_refused_with_their_ranges() {
    let sampling = |key: &str| with("\"obliquity_step_deg\": 5", &format!("\"obliquity_step_deg\": 5, {key}"));
    for (key, range) in [
        ("\"facet_samples\": 3", "at least 1, at most 256 (and a square number)"),
        ("\"rotation_cells\": 33", "at least 16, at most 1024 (and even)"),
        ("\"spin_rates\": 1", "at least 2, at most 100"),
        ("\"shortest_period_h\": 0", "at least 0.1, at most 1000"),
    ] {
        let (name, value) = key[1..].split_once("\": ").unwrap();
        refused(&sampling(key), &[&format!("`torque.{name}` is {value}; allowed: {range}")]);
    }
    let text = with("\"sky_blockage\": true", "\"sky_blockage\": false, \"sky_blockage_reflected\": true");
    refused(&text, &["`surface.sky_blockage_reflected` is true", "unless surface.sky_blockage is true"]);
}

#[test]
fn a_default_that_does_not_go_with_the_scene_is_refused_too() {
    let text = with("5.74", "24").replace(", \"stop_period_h\": 20", "");
    let at = place(&text, "{\"duration_myr\"");
    refused(&text, &[&at, "`evolution.stop_period_h` is 20; allowed: above spin.period_h = 24"]);
}

#[test]
fn what_is_no_scene_is_refused_with_place_path_and_what_is_expected() {
    let text = with("\"level\"", "\"levle\"");
    refused(
        &text,
        &[&place(&text, "\"levle\""), "`tiling.levle`", "unknown field `levle`", "`facets`, `exponent`, `level`"],
    );
    let text = with("5.74", "\"fast\"");
    refused(
        &text,
        &[&place(&text, "\"fast\""), "`spin.period_h`", "found string \"fast\", expected a number", "at least 0.1"],
    );
    let text = with("\"spheres\": 1000", "\"spheres\": -3");
    refused(&text, &[&place(&text, "-3"), "`body.packed_ellipsoid.spheres`", "`-3`", "at least 10, at most 1000000"]);
    let text = with("\"hapke\"", "\"hapka\"");
    let takes =
        "`surface.reflectance` takes {\"hapke\": {..}}, {\"lambert\": {..}} or \"none\", found {\"hapka\": {..}}";
    refused(&text, &["scene.json:13:20", takes]);
    let text = with("\"self_heating\": \"none\"", "\"self_heating\": \"twice\"");
    let takes = "`surface.self_heating` takes \"none\", \"single\" or \"multiple\", found \"twice\"";
    refused(&text, &[&place(&text, "\"twice\""), takes]);
    let text = with("\"tangential_yorp\": \"none\"", &WALL.replace("0.05", "0"));
    let path = "`surface.tangential_yorp.wall.thickness_m` is 0; allowed: at least 0.00001, at most 100";
    refused(&text, &["scene.json:14:", path]);
    let text = with("\"tangential_yorp\": \"none\"", &WALL.replace("\"coverage\": 0.1, ", ""));
    refused(&text, &["scene.json:14:", "surface.tangential_yorp", "missing field `coverage`"]);
    let text = with(", \"b_over_a\": 0.70", "");
    refused(&text, &["scene.json:5:", "`body.packed_ellipsoid`", "missing field `b_over_a`"]);
    refused(r#"{"spin": {"period_h": 6}}"#, &["scene.json:1:", "missing field `body`"]);
    let text = with("\"seed\": 7,", "\"seed\": 7, \"seed\": 8,");
    refused(&text, &["scene.json:4:", "duplicate field `seed`"]);
    refused("[]", &["scene.json:1:1", "expected"]);
}

#[test]
fn broken_json_is_refused_with_its_place() {
    let text = with("\"obliquity_deg\": 5}", "\"obliquity_deg\": 5");
    refused(&text, &["scene.json:19:1", "broken JSON"]);
    refused("", &["scene.json:1:1", "broken JSON"]);
    refused(&with("5.74", "1e400"), &["scene.json:6:", "spin.period_h", "number out of range"]);
    refused(&with("5.74", "NaN"), &["scene.json:6:", "broken JSON"]);
    refused(&"[".repeat(100_000), &["scene.json:1:"]);
    refused(&format!("{COMPLETE} x"), &["scene.json:19:3", "trailing characters"]);
}

#[test]
fn what_json_does_not_have_is_said() {
    let name = "\"name\": \"cotto-figueroa-2015-07\",";
    for (old, new, hint) in [
        (name, "\"name\": \"x\", // body 7\n", "JSON has no comments"),
        (name, "/* body 7 */ \"name\": \"x\",", "JSON has no comments"),
        (name, "# body 7\n\"name\": \"x\",", "JSON has no comments"),
        ("\"obliquity_deg\": 5}", "\"obliquity_deg\": 5,}", "JSON has no comma after the last entry"),
        (
            "\"shed\": {\"track\": \"none\"}",
            "\"shed\": {\"track\": \"none\"},",
            "JSON has no comma after the last entry",
        ),
        (name, "'name': 'x',", "JSON puts texts in double quotes"),
        (name, "\"name\": 'x',", "JSON puts texts in double quotes"),
        (name, "name: \"x\",", "JSON puts keys in double quotes"),
        ("5.74", "NaN", "JSON has finite numbers only"),
        ("5.74", "-Infinity", "JSON has finite numbers only"),
        ("\"shadows\": true", "\"shadows\": True", "JSON writes true, false and null"),
        ("\"stop_period_h\": 20", "\"stop_period_h\": None", "JSON writes true, false and null"),
    ] {
        refused(&with(old, new), &["scene.json:", "broken JSON", hint]);
    }
    refused("// a body\n{}", &["scene.json:1:1", "JSON has no comments"]);
}

#[test]
fn a_byte_order_mark_is_no_part_of_a_scene() {
    assert_eq!(parse(&format!("\u{feff}{COMPLETE}")).unwrap(), parse(COMPLETE).unwrap());
    let text = with("\"radius_m\": 50.2", "\"radius_m\": -50.2");
    refused(&format!("\u{feff}{text}"), &[&place(&text, "-50.2"), "`body.packed_ellipsoid.radius_m` is -50.2"]);
}

#[test]
fn a_scene_may_name_its_schema() {
    let named = with("\"format\": 1,", "\"$schema\": \"./scene.schema.json\", \"format\": 1,");
    assert_eq!(parse(&named).unwrap(), parse(COMPLETE).unwrap());
    refused(&named.replace("\"./scene.schema.json\"", "1"), &["`$schema`: found `1`, expected a string"]);
}

#[test]
fn what_an_alternative_takes_is_said_as_it_would_stand_there() {
    let contact = "{\"hard_sphere\": {\"restitution_normal\": 0.2, \"restitution_tangential\": 0.5, \"slide_limit\": 0.01, \"collapse_limit\": 1e-5, \"step_s\": 50}}";
    let takes = "`contact` takes {\"hard_sphere\": {..}} or {\"soft_sphere\": {..}}, found ";
    for (given, found) in [
        ("\"soft_sphere\"", "\"soft_sphere\""),
        ("{\"soft\": {}}", "{\"soft\": {..}}"),
        ("{\"hard_sphere\": {}, \"soft_sphere\": {}}", "{\"hard_sphere\": {..}, \"soft_sphere\": {..}}"),
        ("{\"step_s\": 50}", "{\"step_s\": ..}"),
        ("{}", "{}"),
        ("null", "null"),
        ("3", "`3`"),
        ("[]", "an array"),
    ] {
        let text = with(contact, given);
        refused(&text, &["scene.json:7:14", &format!("{takes}{found}")]);
    }
    for (old, new, takes) in [
        (
            "\"track\": \"none\"",
            "\"track\": \"rebound\"",
            "`shed.track` takes \"none\" or {\"rebound\": {..}}, found \"rebound\"",
        ),
        ("\"track\": \"none\"", "\"track\": {\"none\": {}}", "found {\"none\": {..}}"),
        ("\"movement_rule\": \"robust\"", "\"movement_rule\": true", "takes \"robust\" or \"literal\", found true"),
        ("\"method\": \"auto\"", "\"method\": \"Direct\"", "takes \"auto\", \"direct\" or \"tree\", found \"Direct\""),
        (
            "\"settling\": {",
            "\"settling\": {\"question\": \"brief\", ",
            "takes \"full\" or {\"brief\": {..}}, found \"brief\"",
        ),
    ] {
        refused(&with(old, new), &["scene.json:", takes]);
    }
}

#[test]
fn a_tilde_in_a_path_is_the_home_folder() {
    let (home, folder) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    std::fs::write(home.path().join("pair.csv"), "x_m,y_m,z_m,mass_kg,radius_m\n-50,0,0,1e9,50\n50,0,0,1e9,50\n")
        .unwrap();
    std::fs::write(home.path().join("scene.json"), r#"{"body": {"file": {"path": "~/pair.csv"}}}"#).unwrap();
    // No shell has touched these arguments.
    let plan = |argument: &str| {
        let mut command = yorp();
        command.env("HOME", home.path()).current_dir(&folder).args(["plan", argument]).output().unwrap()
    };
    let output = plan("~/scene.json");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let output = plan("./~/scene.json");
    assert_eq!(output.status.code(), Some(2));
    let mut build = yorp();
    build.env("HOME", home.path()).current_dir(&folder).args([
        "build",
        "--unsettled",
        "~/scene.json",
        "--out=~/made.csv",
    ]);
    assert!(build.output().unwrap().status.success());
    assert!(home.path().join("made.csv").is_file() && !folder.path().join("~").exists());
}

#[test]
fn a_file_that_is_no_scene_at_all_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let cases: [(&str, Option<&[u8]>, &str); 4] = [
        ("absent.json", None, "cannot read the scene"),
        ("latin.json", Some(b"{\"name\": \"\xe9\"}"), "not UTF-8 text from byte 10"),
        ("large.json", Some(&[b' '; 1_100_000]), "larger than 1048576 bytes"),
        ("lonely.json", Some(br#"{"body": {"file": {"path": "no.csv"}}}"#), "`body.file.path` is \"no.csv\""),
    ];
    for (name, bytes, expected) in cases {
        let file = folder.path().join(name);
        if let Some(bytes) = bytes {
            std::fs::write(&file, bytes).unwrap();
        }
        let output = yorp().arg("plan").arg(&file).output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{message}");
        assert!(message.contains(name) && message.contains(expected), "{message}");
    }
}

#[test]
fn wrong_arguments_exit_with_2_and_help_with_0() {
    for arguments in
        [&["plan"][..], &["no-such-verb"], &["plan", "a", "--no-such-flag"], &["--threads", "0", "schema"], &[]]
    {
        let output = yorp().args(arguments).output().unwrap();
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{arguments:?}");
    }
    for arguments in ["--help", "--version"] {
        let output = yorp().arg(arguments).output().unwrap();
        assert!(output.status.success() && !output.stdout.is_empty());
    }
}

#[cfg(unix)]
#[test]
fn a_closed_pipe_is_success() {
    use std::process::{Command, Stdio};
    let mut child = Command::new(env!("CARGO_BIN_EXE_yorp")).arg("schema").stdout(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    assert!(child.wait().unwrap().success());
}

#[test]
fn a_scene_made_by_a_program_may_not_hold_a_nan() {
    // JSON has no NaN, so such a scene cannot even be written and read back.
    let mut scene = parse(COMPLETE).unwrap();
    scene.spin.period_h = f64::NAN;
    assert!(matches!(parse(&scene.to_json()), Err(SceneError::Structure { path, .. }) if path == "spin.period_h"));
}

#[test]
fn variants_of_every_enumeration_are_read() {
    let text = with(
        "{\"hapke\": {\"single_scattering_albedo\": 0.23, \"roughness_deg\": 20, \"asymmetry\": -0.35, \"multiple_scattering\": \"h2002\"}}",
        "\"none\"",
    );
    assert_eq!(parse(&text).unwrap().surface.reflectance, Reflectance::None);
    let text = r#"{"body": {"carved_mesh": {"path": "a.obj", "unit": "km", "packing": {"hcp": {"radius_m": 10, "grain_density_kg_m3": 3000}}}},
                   "contact": {"hard_sphere": {"slide_velocity": "surface"}}, "evolution": {"stop_period_h": null, "movement_rule": "literal"},
                   "surface": {"reflectance": {"lambert": {"bond_albedo": 0.2}}}, "torque": {"interpolation": "linear"}, "gravity": {"method": "direct"}}"#;
    let warm = with("\"tangential_yorp\": \"none\"", WALL)
        .replace("\"self_heating\": \"none\"", "\"self_heating\": \"multiple\"");
    assert_eq!(parse(&parse(&warm).unwrap().to_json()).unwrap(), parse(&warm).unwrap());
    let scene = parse(text).unwrap();
    let Contact::HardSphere(contact) = &scene.contact else { panic!("{:?}", scene.contact) };
    assert_eq!((contact.restitution_normal, scene.evolution.stop_period_h), (0.2, None));
    assert_eq!(parse(&scene.to_json()).unwrap(), scene);
}

proptest! {
    #[test]
    fn prop_arbitrary_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let _ = parse(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn prop_a_scene_with_one_piece_replaced_never_panics(
        at in 0..COMPLETE.len(), length in 0_usize..20, piece in "[-0-9eE.\\[\\]{}\",:a-z \\n]{0,12}"
    ) {
        let end = (at + length).min(COMPLETE.len());
        let _ = parse(&format!("{}{piece}{}", &COMPLETE[..at], &COMPLETE[end..]));
    }

    #[test]
    fn prop_any_number_in_any_place_is_read_or_refused(number in any::<f64>(), which in 0_usize..30) {
        let places: Vec<(usize, &str)> = COMPLETE.match_indices(|c: char| c.is_ascii_digit()).collect();
        let (at, digit) = places[which * places.len() / 30];
        let text = format!("{}{number:e}{}", &COMPLETE[..at], &COMPLETE[at + digit.len()..]);
        if let Ok(scene) = parse(&text) {
            prop_assert_eq!(parse(&scene.to_json()).unwrap(), scene);
        }
    }
}
