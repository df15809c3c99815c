//! Contact forces beside those of LAMMPS (pair style granular), for the laws that both have.
//!
//! Both have the linear spring and dashpot, the sliding spring with its dashpot and limit, and rolling and twisting as springs,
//! dashpots and limits. They differ where spheres that touch also turn: LAMMPS lets surfaces pass each other with the
//! radius as lever, here it is the distance to the contact, which is shorter by half the overlap. So a packing is compared
//! without spins, and spins in pairs that turn against each other, where nothing slides. And a contact that slips before it
//! has a spring has no tangential force at all in LAMMPS, here that of its limit: so no contact slips in what follows.
//!
//! Needs a Python with the packages `lammps` and `mpich` (the first `python3` found, or the one that PYTHON names); without,
//! the test says so and passes.

use std::io::Write as _;
use std::process::{Command, Stdio};

use pkd::Spheres;
use pkd::packing::{Grain, hcp_lattice};
use pkd::soft_sphere::{Friction, Gravity, Sliding, SoftSphere, SoftSphereParameters};

const RADIUS: f64 = 50.2;
const K_N: f64 = 1e8;
const BETA: f64 = 0.5;
const MU_S: f64 = 1.0;
const MU_R: f64 = 1.05;
const MU_T: f64 = 1.3;
const RESTITUTION: f64 = 0.55;

/// A number between -1 and 1 that looks random.
fn noise(k: usize) -> f64 {
    ((k as f64 * 12.9898).sin() * 43_758.545_3).fract()
}

/// A hexagonal packing pressed together by half a percent and shaken, without spins.
fn packing() -> Spheres {
    let grain = Grain { radius: RADIUS, density: 2960.0 };
    let mut body = hcp_lattice([300.0; 3], grain).unwrap();
    for i in 0..body.len() {
        let [x, y, z] = body.position(i).map(|c| 0.996 * c);
        let n = |k| noise(7 * i + k);
        let place = [x + 0.1 * n(0), y + 0.1 * n(1), z + 0.1 * n(2)];
        body.set(i, place, [0.02 * n(3), 0.02 * n(4), 0.02 * n(5)], [0.0; 3]);
    }
    body
}

/// Pairs far from each other that collide, and turn against each other.
fn pairs() -> Spheres {
    let mass = 4.0 / 3.0 * std::f64::consts::PI * RADIUS.powi(3) * 2960.0;
    let mut body = Spheres::default();
    for k in 0..100_usize {
        let n = |j| noise(100 + 13 * k + j);
        let away = [n(0), n(1), n(2)];
        let length = away.iter().map(|c| c * c).sum::<f64>().sqrt();
        let distance = 2.0 * RADIUS * (1.0 - 0.004 * (1.2 + n(3)));
        let from = [300.0 * (k % 10) as f64, 300.0 * (k / 10) as f64, 0.0];
        let to = [0, 1, 2].map(|c| from[c] + distance / length * away[c]);
        let spin = [3e-4 * n(4), 3e-4 * n(5), 3e-4 * n(6)];
        body.push(from, [0.02 * n(7), 0.02 * n(8), 0.02 * n(9)], spin, mass, RADIUS);
        body.push(to, [0.0; 3], spin.map(|w| -w), mass, RADIUS);
    }
    body
}

/// Rows of forces and torques by LAMMPS; `None` where it is not there.
fn by_lammps(body: &Spheres, model: &str) -> Option<Vec<[f64; 6]>> {
    let mu = 0.5 * body.mass[0];
    let ln = RESTITUTION.ln();
    let damping = -2.0 * ln / (std::f64::consts::PI.powi(2) + ln * ln).sqrt();
    let k_t = 2.0 / 7.0 * K_N;
    let (c_n, c_t) = (damping * (K_N * mu).sqrt(), damping * (k_t * mu).sqrt());
    // LAMMPS rolls with a force at the effective radius and twists with a torque.
    let q = BETA * 0.5 * RADIUS;
    let rolling = [K_N * BETA * BETA, c_n * BETA * BETA, MU_R * BETA];
    let twisting = [2.0 * k_t * q * q, 2.0 * c_t * q * q, MU_T * MU_S * q];
    let arguments: Vec<String> =
        [K_N, c_n, k_t, c_t / c_n, MU_S].iter().chain(&rolling).chain(&twisting).map(|v| format!("{v:?}")).collect();
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/lammps_forces.py");
    let mut child = Command::new(python)
        .arg(script)
        .arg(model)
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .ok()?;
    let mut input = child.stdin.take()?;
    for i in 0..body.len() {
        let columns = body.columns().map(|column| format!("{:?}", column[i]));
        // A script that has ended already is judged by its exit code.
        let _ = writeln!(input, "{}", columns.join(","));
    }
    drop(input);
    let output = child.wait_with_output().unwrap();
    if output.status.code() == Some(77) {
        return None;
    }
    assert!(output.status.success());
    let row = |line: &str| {
        let values: Vec<f64> = line.split(',').map(|v| v.parse().unwrap()).collect();
        <[f64; 6]>::try_from(values).unwrap()
    };
    Some(String::from_utf8(output.stdout).unwrap().lines().map(row).collect())
}

#[test]
fn ref_lammps_forces_of_the_first_step() {
    let sliding = Sliding { coefficient: MU_S, restitution: RESTITUTION, ..Sliding::default() };
    for (model, friction) in [
        ("normal", Friction::None),
        ("tangential", Friction::Sliding(sliding)),
        ("full", Friction::RollingAndTwisting { sliding, rolling: MU_R, twisting: MU_T }),
    ] {
        for (body, name) in [(packing(), "packing"), (pairs(), "pairs")] {
            let Some(theirs) = by_lammps(&body, model) else {
                println!("skipped: no Python with LAMMPS (set PYTHON to one)");
                return;
            };
            let mut soft = SoftSphere::new(SoftSphereParameters {
                restitution: RESTITUTION,
                friction,
                shape: BETA,
                normal_stiffness_n_m: Some(K_N),
                max_overlap: 0.1,
                gravity: Gravity::Off,
                ..SoftSphereParameters::default()
            });
            let ours = soft.contact_forces(&body).unwrap();
            for (columns, ours) in [(0..3, &ours.force_n), (3..6, &ours.torque_n_m)] {
                let theirs: Vec<[f64; 3]> = theirs.iter().map(|r| r[columns.clone()].try_into().unwrap()).collect();
                let size = |v: [f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
                let scale = theirs.iter().map(|v| size(*v)).sum::<f64>() / theirs.len() as f64;
                let worst = ours
                    .iter()
                    .zip(&theirs)
                    .map(|(a, b)| size([a[0] - b[0], a[1] - b[1], a[2] - b[2]]))
                    .fold(0.0, f64::max);
                println!("{name}, {model}, columns {columns:?}: mean {scale:.3e}, largest difference {worst:.1e}");
                assert!(worst <= 1e-10 * scale, "{name}, {model}: {worst:e} of {scale:e}");
            }
        }
    }
}
