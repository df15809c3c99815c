//! A scene that means something else than it says, or asks for what cannot be, is told so in its own words: refused where it is
//! impossible, warned about where it is odd, and never blamed on what is right.

use std::path::Path;
use std::process::Output;

use common::{ask, file, json, refused, yorp};
use serde_json::{Value, json as value};

mod common;

/// A small body, quick to make, with `changes` put over it.
fn scene(changes: &Value) -> String {
    let mut scene = value!({
        "seed": 1,
        "body": {"packed_ellipsoid": {"spheres": 30, "radius_m": 50, "grain_density_kg_m3": 2960, "b_over_a": 0.9, "c_over_a": 0.8}},
        "spin": {"period_h": 8, "obliquity_deg": 20},
        "settling": {"rotations": 1, "max_rotations": 1, "allow_reshaping": true},
        "tiling": {"facets": 100},
        "torque": {"obliquity_step_deg": 45, "declination_nodes": 5, "azimuth_bins": 16},
        "evolution": {"duration_myr": 0.01, "spin_change": 0.05}
    });
    merge(&mut scene, changes);
    scene.to_string()
}

/// Puts the keys of `changes` over those of `base`; a body or contact replaces the one before it.
fn merge(base: &mut Value, changes: &Value) {
    for (key, change) in changes.as_object().unwrap() {
        match (base.get_mut(key), key.as_str()) {
            (Some(old @ Value::Object(_)), key) if key != "body" && key != "contact" && change.is_object() => {
                merge(old, change)
            }
            _ => base[key] = change.clone(),
        }
    }
}

fn build(folder: &Path, changes: &Value) -> Output {
    let scene = file(folder, "scene.json", &scene(changes));
    ask(&[&"build", &scene, &"--unsettled", &"--out", &folder.join("made.csv")])
}

fn plan(changes: &Value) -> Output {
    let folder = tempfile::tempdir().unwrap();
    ask(&[&"plan", &file(folder.path(), "scene.json", &scene(changes))])
}

/// Asserts that it was done, and what was told.
fn told(output: &Output, words: &str) {
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && said.contains(words), "{said}");
}

fn silent(output: &Output) {
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && !said.contains("warning"), "{said}");
}

/// An octahedron whose corners are `radius` units from its centre.
fn octahedron(radius: f64) -> String {
    let corners = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
    let vertices =
        corners.map(|corner| format!("v {}\n", corner.map(|x| (f64::from(x) * radius).to_string()).join(" ")));
    let facets = "f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n";
    vertices.concat() + facets
}

fn carved(unit: &str, radius_m: f64) -> Value {
    value!({"body": {"carved_mesh": {"path": "mesh.obj", "unit": unit, "packing": {"hcp": {"radius_m": radius_m, "grain_density_kg_m3": 2700}}}}})
}

#[test]
fn a_mesh_is_the_same_body_in_every_unit() {
    let folder = tempfile::tempdir().unwrap();
    let bodies = [("m", 1.0), ("km", 1e-3), ("cm", 100.0)].map(|(unit, a_metre)| {
        file(folder.path(), "mesh.obj", &octahedron(200.0 * a_metre));
        silent(&build(folder.path(), &carved(unit, 30.0)));
        yorp::exchange::read_aggregate(&folder.path().join("made.csv")).unwrap()
    });
    assert!(bodies[0].len() > 40);
    for body in &bodies[1..] {
        assert_eq!(body.len(), bodies[0].len());
        assert!(body.x.iter().zip(&bodies[0].x).all(|(a, b)| (a - b).abs() < 1e-9));
    }
}

#[test]
fn a_wrong_unit_is_asked_about() {
    let folder = tempfile::tempdir().unwrap();
    for (corner, unit, packing, fault) in [
        (0.4, "m", "hcp", "spheres of 30 m do not give its shape: is `unit` (m) right?"),
        (0.4, "m", "random", "spheres of 30 m do not give its shape: is `unit` (m) right?"),
        (400.0, "cm", "hcp", "is `unit` (cm) right?"),
        (400.0, "km", "hcp", "spheres of 30 m (at most 1e7): is `unit` (km) right?"),
        (40_000.0, "m", "random", "spheres of 30 m (at most 1e7): is `unit` (m) right?"),
        (149.0, "m", "hcp", "is `unit` (m) right?"),
    ] {
        file(folder.path(), "mesh.obj", &octahedron(corner));
        let mut changes = carved(unit, 30.0);
        let spheres = changes["body"]["carved_mesh"]["packing"]["hcp"].clone();
        changes["body"]["carved_mesh"]["packing"] = value!({packing: spheres});
        refused(&build(folder.path(), &changes), 2, fault);
        let out = folder.path().join("run");
        refused(&ask(&[&"run", &folder.path().join("scene.json"), &"--out", &out]), 2, "mesh.obj");
        assert!(!out.exists());
    }
}

#[test]
fn densities_in_other_units_are_asked_about() {
    let packed = |density: f64| {
        let body =
            value!({"spheres": 30, "radius_m": 50, "grain_density_kg_m3": density, "b_over_a": 0.9, "c_over_a": 0.8});
        plan(
            &value!({"body": {"packed_ellipsoid": body}, "spin": {"period_h": 100}, "evolution": {"stop_period_h": null}}),
        )
    };
    told(&packed(2.7), "body.packed_ellipsoid.grain_density_kg_m3 is 2.7 kg/m3 (g/cm3? 1 g/cm3 is 1000 kg/m3)");
    told(&packed(15_000.0), "is 15000 kg/m3 (rock has 500 to 8000)");
    told(&packed(80.0), "is 80 kg/m3 (rock has 500 to 8000)");
    for usual in [500.0, 2700.0, 8000.0] {
        silent(&packed(usual));
    }
    // Impossible rather than odd where the body is to rotate faster than its spheres can bear.
    let body = value!({"spheres": 30, "radius_m": 50, "grain_density_kg_m3": 2.7, "b_over_a": 0.9, "c_over_a": 0.8});
    let light = plan(&value!({"body": {"packed_ellipsoid": body}, "spin": {"period_h": 8}}));
    refused(&light, 2, "`spin.period_h` is 8; allowed: at least 63.5");
    refused(&light, 2, "g/cm3?");
}

#[test]
fn a_period_is_compared_with_the_limit_of_the_density() {
    // sqrt(3 pi/(G 2960 kg/m3)) = 1.919 h; of a heap of them, 60 % filled, 2.477 h.
    for impossible in [0.1, 1.0, 1.91] {
        let fast = plan(&value!({"spin": {"period_h": impossible}}));
        refused(&fast, 2, &format!("`spin.period_h` is {impossible:?}; allowed: at least 1.919"));
        refused(&fast, 2, "body.packed_ellipsoid.grain_density_kg_m3 = 2960 flies apart");
    }
    told(&plan(&value!({"spin": {"period_h": 2.2}})), "loses material below 2.48 h");
    silent(&plan(&value!({"spin": {"period_h": 2.5}})));
    // Cohesion holds what gravity does not.
    let sticky = value!({"spin": {"period_h": 1}, "contact": {"soft_sphere": {"cohesion_pa": 1000}}});
    told(&plan(&sticky), "loses material below 2.48 h");
    let loose = value!({"spin": {"period_h": 1}, "contact": {"soft_sphere": {}}});
    refused(&plan(&loose), 2, "`spin.period_h` is 1");
    let carved = value!({"spin": {"period_h": 1}, "body": carved("m", 30.0)["body"]});
    let folder = tempfile::tempdir().unwrap();
    file(folder.path(), "mesh.obj", &octahedron(200.0));
    refused(&build(folder.path(), &carved), 2, "body.carved_mesh.packing.hcp.grain_density_kg_m3 = 2700 flies apart");
}

#[test]
fn a_period_in_seconds_is_asked_about() {
    let seconds = |period: f64| plan(&value!({"spin": {"period_h": period}, "evolution": {"stop_period_h": null}}));
    told(&seconds(21_600.0), "spin.period_h is 21600 h: in seconds? 21600 s are 6.000 h");
    silent(&seconds(1900.0));
}

#[test]
fn odd_spheres_of_a_file_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let made = |rows: &str, period_h: f64| {
        file(folder.path(), "body.csv", &format!("x_m,y_m,z_m,mass_kg,radius_m\n{rows}"));
        build(
            folder.path(),
            &value!({"body": {"file": {"path": "body.csv"}}, "spin": {"period_h": period_h}, "evolution": {"stop_period_h": null}}),
        )
    };
    // 2000 kg/m3.
    let [a, b, far] = ["-50,0,0,1.0472e9,50\n", "50,0,0,1.0472e9,50\n", "5000,0,0,1.0472e9,50\n"];
    silent(&made(&[a, b].concat(), 8.0));
    told(&made(a, 8.0), "one sphere only");
    told(&made(&[a, b, far].concat(), 8.0), "1 of 3 spheres lie apart from the rest");
    told(&made(&[a, b].concat().replace("1.0472e9", "1.0472e6"), 400.0), "the densest sphere has 2.000 kg/m3 (g/cm3?");
    let fast = made(&[a, b].concat(), 2.0);
    refused(&fast, 2, "spin.period_h is 2; a sphere of 2000 kg/m3, as the densest in");
    refused(&fast, 2, "flies apart below 2.334 h");
    // Spheres that move already have their own spin.
    file(
        folder.path(),
        "body.csv",
        "x_m,y_m,z_m,vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s,mass_kg,radius_m\n-50,0,0,0,-0.01,0,0,0,2e-4,1.0472e9,50\n50,0,0,0,0.01,0,0,0,2e-4,1.0472e9,50\n",
    );
    silent(&build(folder.path(), &value!({"body": {"file": {"path": "body.csv"}}, "spin": {"period_h": 2}})));
}

#[test]
fn a_body_that_falls_apart_is_blamed_on_what_is_likely() {
    let folder = tempfile::tempdir().unwrap();
    let settle = |changes: &Value| {
        let mut slow = value!({"settling": {"max_rotations": 5}});
        merge(&mut slow, changes);
        let scene = file(folder.path(), "scene.json", &scene(&slow));
        ask(&[&"build", &scene, &"--out", &folder.path().join("made.csv")])
    };
    let long = settle(&value!({"contact": {"hard_sphere": {"step_s": 1000}}}));
    refused(&long, 3, "contact.hard_sphere.step_s = 1000 s is too long: at most 67 s");
    let soft = settle(&value!({"contact": {"soft_sphere": {"normal_stiffness_n_m": 1e-3}}}));
    refused(&soft, 3, "contact.soft_sphere.normal_stiffness_n_m = 0.001 N/m is too soft");
    for output in [&long, &soft] {
        assert!(!String::from_utf8_lossy(&output.stderr).contains("longer spin.period_h"));
    }
    refused(&settle(&value!({"spin": {"period_h": 2}})), 3, "a longer spin.period_h would ask less of it");
}

#[test]
fn the_cost_of_settling_is_told_before_it_is_spent() {
    let slow =
        value!({"spin": {"period_h": 1500}, "evolution": {"stop_period_h": null}, "settling": {"max_rotations": 1000}});
    told(
        &plan(&slow),
        "settling takes about 3 s to 53 min of one processor (1 to 1000 rotations of 1500.0000 h in steps of 50.000 s)",
    );
    let soft = value!({"contact": {"soft_sphere": {}}, "settling": {"rotations": 1000, "max_rotations": 1000},
                       "body": {"packed_ellipsoid": {"spheres": 10000, "radius_m": 50, "grain_density_kg_m3": 2960, "b_over_a": 0.9, "c_over_a": 0.8}}});
    told(&plan(&soft), "longer steps, fewer settling.rotations or a shorter spin.period_h cost less");
    silent(&plan(&value!({})));
    let folder = tempfile::tempdir().unwrap();
    let json = ask(&[&"plan", &"--json", &file(folder.path(), "scene.json", &scene(&slow))]);
    let warnings = common::json(&json)["warnings"].as_array().unwrap().len();
    assert_eq!(warnings, 1);
}

#[test]
fn the_period_at_which_every_run_ends_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let slow = value!({"spin": {"period_h": 300, "obliquity_deg": 70}, "evolution": {"stop_period_h": null, "duration_myr": 1},
                       "orbit": {"semimajor_axis_au": 0.01}, "seed": 3});
    let text = scene(&slow);
    let file = file(folder.path(), "scene.json", &text);
    let planned = String::from_utf8(yorp().arg("plan").arg(&file).output().unwrap().stdout).unwrap();
    assert!(planned.contains("beyond 480 h, whatever evolution.stop_period_h says"), "{planned}");
    let mut run = yorp();
    run.args(["run", "--json", "--until-myr", "2"]).arg(&file).arg("--out").arg(folder.path().join("run"));
    let output = run.output().unwrap();
    assert_eq!(json(&output)["outcome"], "spun_down");
    told(
        &output,
        "spun down beyond a period of 480 h, the end of its YORP cycle, though evolution.stop_period_h is null",
    );
    told(&output, "--until-myr 2 is beyond evolution.duration_myr = 1, at which the run ends");
}
