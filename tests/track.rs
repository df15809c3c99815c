//! `yorp track` through the program: fates, wrong inputs, and the same orbits by REBOUND's Python package.

use assert_cmd::Command;
use serde_json::Value;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

const HEADER: &str = "x_m,y_m,z_m,vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s,mass_kg,radius_m";
const SPIN_RATE: f64 = TAU / (4.4 * 3600.0);
const MASS_KG: f64 = 1.2e12;

fn yorp(arguments: &[&str]) -> std::process::Output {
    Command::cargo_bin("yorp").unwrap().args(arguments).output().unwrap()
}

/// A prolate body of 80 spheres that turns rigidly, in `folder`.
fn primary(folder: &Path) -> PathBuf {
    let mut text = format!("{HEADER}\n");
    for k in 0..80 {
        let k = f64::from(k);
        let z = 1.0 - 2.0 * ((k * 0.754_877_666) % 1.0);
        let azimuth = TAU * ((k * 0.569_840_29) % 1.0);
        let (r, level) = (((k + 0.5) / 80.0).cbrt(), (1.0 - z * z).sqrt());
        let (x, y, z) = (700.0 * r * level * azimuth.cos(), 420.0 * r * level * azimuth.sin(), 400.0 * r * z);
        let (vx, vy, mass) = (-SPIN_RATE * y, SPIN_RATE * x, MASS_KG / 80.0);
        writeln!(text, "{x:?},{y:?},{z:?},{vx:?},{vy:?},0,0,0,{SPIN_RATE:?},{mass:?},60").unwrap();
    }
    write(folder, "primary.csv", &text)
}

/// Spheres thrown from over the equator at different speeds.
fn thrown(folder: &Path) -> PathBuf {
    let mut text = format!("{HEADER}\n");
    let escape = (2.0 * 6.674_30e-11 * MASS_KG / 900.0).sqrt();
    for k in 0..7 {
        let (angle, share) = (0.7 * f64::from(k), 0.55 + 0.1 * f64::from(k));
        let (s, c) = angle.sin_cos();
        let (x, y, z) = (900.0 * c, 900.0 * s, 30.0 * f64::from(k) - 100.0);
        let (vx, vy) = (-share * escape * s, share * escape * c);
        writeln!(text, "{x:?},{y:?},{z:?},{vx:?},{vy:?},0.01,0,0,0,1000,5").unwrap();
    }
    write(folder, "shed.csv", &text)
}

fn write(folder: &Path, name: &str, text: &str) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

fn tracked(primary: &Path, shed: &Path, more: &[&str]) -> Value {
    let (primary, shed) = (primary.to_str().unwrap(), shed.to_str().unwrap());
    let output = yorp(&[&["track", primary, "--shed", shed, "--json"], more].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn every_sphere_has_a_fate_and_the_budget_closes() {
    let folder = tempfile::tempdir().unwrap();
    let (primary, shed) = (primary(folder.path()), thrown(folder.path()));
    let result = tracked(&primary, &shed, &["--t-max-days", "30"]);
    let fates = result["fates"].as_array().unwrap();
    assert_eq!(fates.len(), 7);
    let kinds: Vec<_> = fates.iter().map(|f| f["fate"].as_str().unwrap()).collect();
    assert!(kinds.contains(&"reimpact") && kinds.contains(&"escape"), "{kinds:?}");
    assert!(fates.iter().all(|f| f["t_s"].as_f64().unwrap() > 0.0 && f["jacobi_drift"].as_f64().unwrap() < 1e-6));
    let mass = |name: &str| result["budget"][name]["mass_kg"].as_f64().unwrap();
    assert!((mass("reimpact") + mass("escape") + mass("bound") - mass("shed")).abs() < 1e-9);
    let on_one_thread = tracked(&primary, &shed, &["--t-max-days", "30", "--threads", "1"]);
    assert_eq!(on_one_thread["fates"], result["fates"]);
}

#[test]
fn two_aggregates_are_followed_as_rigid_bodies() {
    let folder = tempfile::tempdir().unwrap();
    let primary = primary(folder.path());
    let text = std::fs::read_to_string(&primary).unwrap();
    let shifted: Vec<String> = text
        .lines()
        .skip(1)
        .map(|line| {
            let mut fields: Vec<f64> = line.split(',').map(|f| f.parse().unwrap()).collect();
            fields[0] += 2000.0;
            fields[4] += 1.0;
            fields.iter().map(|f| format!("{f:?}")).collect::<Vec<_>>().join(",")
        })
        .collect();
    let companion = write(folder.path(), "companion.csv", &format!("{HEADER}\n{}\n", shifted.join("\n")));
    let output = yorp(&["track", primary.to_str().unwrap(), "--companion", companion.to_str().unwrap(), "--json"]);
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(result["fate"], "separated");
    assert!(result["angular_momentum_drift"].as_f64().unwrap() < 1e-10, "{result}");
}

#[test]
fn wrong_inputs_are_refused_and_an_empty_list_is_an_empty_result() {
    let folder = tempfile::tempdir().unwrap();
    let (primary, shed) = (primary(folder.path()), thrown(folder.path()));
    let none = write(folder.path(), "none.csv", &format!("{HEADER}\n"));
    assert_eq!(tracked(&primary, &none, &[])["fates"], serde_json::json!([]));
    let inside = write(folder.path(), "inside.csv", &format!("{HEADER}\n0,0,73,0,0,0,0,0,0,1,20\n"));
    let nan = write(folder.path(), "nan.csv", &format!("{HEADER}\nnan,0,0,0,0,0,0,0,0,1,1\n"));
    let p = primary.to_str().unwrap();
    let s = shed.to_str().unwrap();
    for (arguments, words) in [
        (vec!["track", p, "--shed", inside.to_str().unwrap()], "inside the primary"),
        (vec!["track", p, "--shed", nan.to_str().unwrap()], "line 2"),
        (vec!["track", p, "--shed", "absent.csv"], "absent.csv"),
        (vec!["track", p], "--shed"),
        (vec!["track", p, "--companion", p], "overlap"),
        (vec!["track", p, "--shed", s, "--t-max-days", "-1"], "above 0"),
        (vec!["track", p, "--shed", s, "--ias15-tolerance", "1"], "1e-3"),
    ] {
        let output = yorp(&arguments);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(words) && output.stdout.is_empty(), "{arguments:?}: {message}");
    }
}

/// The same set-up in Python: mascons in `additional_forces`, outcomes looked at every four minutes.
const PYTHON: &str = r#"
import csv, json, sys
import numpy as np, rebound
rows = lambda name: [{k: float(v) for k, v in row.items()} for row in csv.DictReader(open(name))]
body, shed, omega, days = rows(sys.argv[1]), rows(sys.argv[2]), float(sys.argv[3]), float(sys.argv[4])
G, au, gm_sun = 6.67430e-11, 1.495978707e11, 1.32712440018e20
x = np.array([[r["x_m"], r["y_m"], r["z_m"]] for r in body]); m = np.array([r["mass_kg"] for r in body])
radius = np.array([r["radius_m"] for r in body])
v = np.array([[r["vx_m_s"], r["vy_m_s"], r["vz_m_s"]] for r in body])
x0, v0 = (m[:, None] * x).sum(0) / m.sum(), (m[:, None] * v).sum(0) / m.sum()
x -= x0
far = max(20 * (np.linalg.norm(x, axis=1) + radius).max(), 0.5 * au * (G * m.sum() / (3 * gm_sun)) ** (1 / 3))
def mascons(t):
    c, s = np.cos(omega * t), np.sin(omega * t)
    return np.stack([c * x[:, 0] - s * x[:, 1], s * x[:, 0] + c * x[:, 1], x[:, 2]], axis=1)
fates = []
for row in shed:
    sim = rebound.Simulation()
    sim.G = G
    sim.integrator = "ias15"
    p, u = np.array([row["x_m"], row["y_m"], row["z_m"]]) - x0, np.array([row["vx_m_s"], row["vy_m_s"], row["vz_m_s"]]) - v0
    sim.add(m=row["mass_kg"], x=p[0], y=p[1], z=p[2], vx=u[0], vy=u[1], vz=u[2])
    def pull(reb_sim):
        p = sim.particles[0]
        d = mascons(sim.t) - np.array([p.x, p.y, p.z])
        a = (G * m / (d * d).sum(1) ** 1.5) @ d
        p.ax += a[0]; p.ay += a[1]; p.az += a[2]
    sim.additional_forces = pull
    fate, t = "bound", 0.0
    while t < days * 86400:
        t += 240.0
        sim.integrate(t)
        p = sim.particles[0]
        r = np.array([p.x, p.y, p.z])
        if (np.linalg.norm(mascons(t) - r, axis=1) - radius).min() < row["radius_m"]:
            fate = "reimpact"; break
        if np.linalg.norm(r) > far and 0.5 * (p.vx**2 + p.vy**2 + p.vz**2) > G * m.sum() / np.linalg.norm(r):
            fate = "escape"; break
    fates.append({"fate": fate, "t_s": t})
print(json.dumps(fates))
"#;

#[test]
fn python_package_gives_the_same_outcomes() {
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let has = std::process::Command::new(&python).args(["-c", "import rebound, numpy"]).output();
    if !has.is_ok_and(|output| output.status.success()) {
        println!("skipped: {python} has no packages rebound and numpy (set PYTHON to one that has)");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let (primary, shed) = (primary(folder.path()), thrown(folder.path()));
    let days = "2";
    let ours = tracked(&primary, &shed, &["--t-max-days", days]);
    let output = std::process::Command::new(&python)
        .args(["-c", PYTHON, primary.to_str().unwrap(), shed.to_str().unwrap(), &format!("{SPIN_RATE:?}"), days])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let theirs: Value = serde_json::from_slice(&output.stdout).unwrap();
    for (ours, theirs) in ours["fates"].as_array().unwrap().iter().zip(theirs.as_array().unwrap()) {
        assert_eq!(ours["fate"], theirs["fate"], "{ours} {theirs}");
        let late = theirs["t_s"].as_f64().unwrap() - ours["t_s"].as_f64().unwrap();
        // They look every four minutes; that a sphere is far enough to have escaped, we look after each step, which is at
        // most a quarter of a rotation.
        let early = if ours["fate"] == "escape" { 0.25 * TAU / SPIN_RATE } else { 1.0 };
        assert!((-early..480.0).contains(&late), "{ours} {theirs}");
    }
}

/// One sphere of 100 m and 2000 kg/m3 at the origin, at rest.
const STONE: &str = "x_m,y_m,z_m,vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s,mass_kg,radius_m\n\
                     0,0,0,0,0,0,0,0,0,8377580409.57,100\n";

fn one_row(position: [f64; 3], velocity: [f64; 3], mass: f64, radius: f64) -> String {
    let [x, y, z] = position;
    let [vx, vy, vz] = velocity;
    format!(
        "x_m,y_m,z_m,vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s,mass_kg,radius_m\n\
         {x},{y},{z},{vx},{vy},{vz},0,0,0,{mass},{radius}\n"
    )
}

/// Follows one body against the stone, as a shed one or as a companion.
fn against_the_stone(how: &str, row: &str) -> serde_json::Value {
    let folder = tempfile::tempdir().unwrap();
    let [stone, other] = ["stone.csv", "other.csv"].map(|name| folder.path().join(name));
    std::fs::write(&stone, STONE).unwrap();
    std::fs::write(&other, row).unwrap();
    let output = yorp(&["track", stone.to_str().unwrap(), how, other.to_str().unwrap(), "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Time (s) in which two points fall from a distance to another with this speed inwards at first: the integral of dr / v.
fn fall_s(gm: f64, from: f64, to: f64, speed: f64) -> f64 {
    let steps = 200_000;
    let dr = (from - to) / f64::from(steps);
    let v = |r: f64| (speed * speed + 2.0 * gm * (1.0 / r - 1.0 / from)).sqrt();
    (0..steps).map(|k| dr / v(to + (f64::from(k) + 0.5) * dr)).sum()
}

#[test]
fn what_comes_in_from_afar_falls_and_does_not_escape() {
    let gm = 6.6743e-11 * 8377580409.57;
    for (distance, speed) in [(10_000.0, 10.0), (10_000.0, 1.0), (50_000.0, 25.0), (3000.0, 0.2)] {
        let result = against_the_stone("--shed", &one_row([distance, 0.0, 0.0], [-speed, 0.0, 0.0], 1.0, 0.01));
        let fate = &result["fates"][0];
        assert_eq!(fate["fate"], "reimpact", "{fate}");
        let (t, expected) = (fate["t_s"].as_f64().unwrap(), fall_s(gm, distance, 100.01, speed));
        assert!((t / expected - 1.0).abs() < 1e-4, "{t} {expected}");
    }
    // The same speed outwards is an escape.
    let result = against_the_stone("--shed", &one_row([10_000.0, 0.0, 0.0], [10.0, 0.0, 0.0], 1.0, 0.01));
    assert_eq!(result["fates"][0]["fate"], "escape");
}

#[test]
fn passes_are_hits_by_their_nearest_point_whatever_the_speed() {
    for speed in [30.0, 300.0, 1000.0, 30_000.0] {
        for (distance, fate) in
            [(100.009, "reimpact"), (100.0, "reimpact"), (99.0, "reimpact"), (100.02, "escape"), (103.0, "escape")]
        {
            for sign in [1.0, -1.0] {
                let row = one_row([5000.0, sign * distance, 0.0], [-speed, 0.0, 0.0], 1.0, 0.01);
                let found = against_the_stone("--shed", &row);
                // Gravity bends the slow ones inwards.
                let bent = 6.6743e-11 * 8377580409.57 / (speed * speed);
                let fate = if distance - bent < 100.01 { "reimpact" } else { fate };
                assert_eq!(found["fates"][0]["fate"], fate, "{speed} {distance}: {found}");
            }
        }
    }
}

#[test]
fn two_bodies_that_close_in_collide_when_they_meet() {
    let mass = 8377580409.57;
    let gm = 6.6743e-11 * 2.0 * mass;
    for (distance, speed) in
        [(5000.0, 1.0), (5000.0, 0.0), (20_000.0, 5.0), (20_000.0, 100.0), (1000.0, 0.01), (202.0, 0.0)]
    {
        let result = against_the_stone("--companion", &one_row([distance, 0.0, 0.0], [-speed, 0.0, 0.0], mass, 100.0));
        assert_eq!(result["fate"], "collided", "{distance} {speed}: {result}");
        let (t, expected) = (result["t_s"].as_f64().unwrap(), fall_s(gm, distance, 200.0, speed));
        assert!((t / expected - 1.0).abs() < 1e-3, "{distance} {speed}: {t} {expected}");
        assert!(result["energy_drift"].as_f64().unwrap() < 1e-3, "{result}");
    }
}

#[test]
fn two_bodies_graze_by_their_nearest_point() {
    let mass = 8377580409.57;
    for speed in [20.0, 200.0, 5000.0] {
        for (distance, fate) in [(199.5, "collided"), (199.99, "collided"), (200.5, "separated")] {
            let row = one_row([9000.0, distance, 0.0], [-speed, 0.0, 0.0], mass, 100.0);
            let result = against_the_stone("--companion", &row);
            assert_eq!(result["fate"], fate, "{speed} {distance}: {result}");
        }
    }
}
