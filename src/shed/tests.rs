//! What must hold of shed bodies whatever the primary.

use std::f64::consts::{PI, TAU};

use pkd::Spheres;
use pkd::constants::G;

use super::forces::Field;
use super::mascons::{cross, dot, norm};
use super::orbit::{elements, specific_energy};
use super::rebound::Simulation;
use super::test_bodies::prolate;
use super::*;

const DAY_S: f64 = 86_400.0;

fn body(position: [f64; 3], velocity: [f64; 3], mass: f64, radius: f64) -> ShedBody {
    ShedBody { position, velocity, spin: [0.0; 3], mass, radius }
}

fn ball(mass: f64, radius: f64) -> Primary {
    let mut spheres = Spheres::default();
    spheres.push([0.0; 3], [0.0; 3], [0.0; 3], mass, radius);
    Primary { spheres, spin_rate: 3e-4 }
}

/// Steps to `t_s` without looking for events.
fn fly(field: &mut Field, body: ShedBody, epsilon: f64, t_s: f64, mut each: impl FnMut(f64, [f64; 3], [f64; 3])) {
    let mut simulation = Simulation::new(&[body], epsilon, 0.0, 10.0).unwrap();
    while simulation.t() < t_s {
        simulation.limit_dt(t_s - simulation.t());
        simulation.step(field);
        let (position, velocity) = simulation.states().next().unwrap();
        each(simulation.t(), position, velocity);
    }
}

/// Kepler orbit around one mascon: a and e constant to 1e-12.
#[test]
fn one_mascon_keeps_the_kepler_orbit() {
    let primary = ball(1.5e12, 300.0);
    let mut field = Field::new(&primary, &TrackOptions::default()).unwrap();
    let gm = G * 1.5e12;
    let start = body([2000.0, 0.0, 0.0], [0.01, 1.1 * (gm / 2000.0f64).sqrt(), 0.05], 1e-3, 1.0);
    let first = elements(gm, start.position, start.velocity);
    let mut worst = 0.0f64;
    fly(&mut field, start, 1e-9, 30.0 * DAY_S, |_, r, v| {
        let now = elements(gm, r, v);
        worst = worst.max((now.semimajor_axis_m / first.semimajor_axis_m - 1.0).abs());
        worst = worst.max((now.eccentricity - first.eccentricity).abs());
    });
    assert!(worst < 1e-12, "{worst:e}");
}

/// Jacobi constant around 1000 turning mascons to 1e-9 over 10 d, while the two-body energy varies by percents.
#[test]
fn jacobi_constant_is_kept_while_the_two_body_energy_varies() {
    let primary = Primary { spheres: prolate(1000), spin_rate: TAU / (4.5 * 3600.0) };
    let exact = TrackOptions { multipole_error: 1e-15, ..TrackOptions::default() };
    let mut field = Field::new(&primary, &exact).unwrap();
    let mascons = mascons::Mascons::new(&primary.spheres).unwrap();
    let (gm, omega) = (mascons.gm, primary.spin_rate);
    let start = body([2500.0, 0.0, 0.0], [0.0, 1.02 * (gm / 2500.0).sqrt(), 0.02], 1e-3, 1.0);
    let jacobi = |t: f64, r: [f64; 3], v: [f64; 3]| {
        let (s, c) = (omega * t).sin_cos();
        let at = [c * r[0] + s * r[1], c * r[1] - s * r[0], r[2]];
        0.5 * dot(v, v) + mascons.potential(at) - omega * cross(r, v)[2]
    };
    let options = TrackOptions { t_max_s: 10.0 * DAY_S, ..exact.clone() };
    let tracks = follow(&primary, &[start], &options).unwrap();
    assert!(tracks.jacobi_drift[0].is_some_and(|drift| drift < 1e-12), "{:?}", tracks.jacobi_drift);
    let first = [jacobi(0.0, start.position, start.velocity), specific_energy(gm, start.position, start.velocity)];
    let mut worst = [0.0f64; 2];
    fly(&mut field, start, 1e-9, 10.0 * DAY_S, |t, r, v| {
        let now = [jacobi(t, r, v), specific_energy(gm, r, v)];
        for k in 0..2 {
            worst[k] = worst[k].max((now[k] / first[k] - 1.0).abs());
        }
    });
    assert!(worst[0] < 1e-9 && worst[1] > 0.01, "{worst:?}");
}

/// Node and pericentre of a low orbit around a ring of mascons turn as first-order theory has it.
#[test]
fn nodes_precess_as_the_oblateness_says() {
    // A ball with a light ring in its equator, of 48 mascons: J2 = m a^2 / (2 M R^2) and no sectoral terms below 48.
    let mut spheres = Spheres::default();
    spheres.push([0.0; 3], [0.0; 3], [0.0; 3], 1.0e12, 100.0);
    let (ring_mass, ring) = (1e9, 400.0);
    for k in 0..48 {
        let angle = TAU * f64::from(k) / 48.0;
        let at = [ring * angle.cos(), ring * angle.sin(), 0.0];
        spheres.push(at, [0.0; 3], [0.0; 3], ring_mass / 48.0, 10.0);
    }
    let mass = 1.0e12 + ring_mass;
    let primary = Primary { spheres, spin_rate: 1e-4 };
    let exact = TrackOptions { multipole_error: 1e-12, ..TrackOptions::default() };
    let mut field = Field::new(&primary, &exact).unwrap();
    let (gm, a, inclination) = (G * mass, 4000.0, 0.6f64);
    let speed = (gm / a).sqrt();
    let start = body([a, 0.0, 0.0], [0.0, speed * inclination.cos(), speed * inclination.sin()], 1e-3, 1.0);
    let n = (gm / a.powi(3)).sqrt();
    let j2_r2 = 0.5 * ring_mass * ring * ring / mass;
    let expected = -1.5 * n * j2_r2 / (a * a) * inclination.cos();
    // Angle of the node against time, after whole numbers of orbits, by least squares.
    let mut samples = Vec::new();
    fly(&mut field, start, 1e-9, 100.0 * TAU / n, |t, r, v| {
        let h = cross(r, v);
        samples.push((t, h[0].atan2(-h[1])));
    });
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| samples.iter().map(f).sum::<f64>() / samples.len() as f64;
    let (t0, w0) = (mean(&|s| s.0), mean(&|s| s.1));
    let rate = mean(&|s| (s.0 - t0) * (s.1 - w0)) / mean(&|s| (s.0 - t0).powi(2));
    assert!((rate / expected - 1.0).abs() < 0.01, "{rate:e} {expected:e}");
}

#[test]
fn a_stone_thrown_up_falls_back_as_kepler_says() {
    // Straight up from the surface of a ball at half of the escape energy.
    let (mass, radius) = (1.0e12, 400.0);
    let primary = Primary { spin_rate: 0.0, ..ball(mass, radius) };
    let gm = G * mass;
    let (stone, r0) = (1.0, 401.0);
    let v0 = (gm / r0).sqrt();
    let tracks = follow(&primary, &[body([r0, 0.0, 0.0], [v0, 0.0, 0.0], 1.0, stone)], &TrackOptions::default());
    let tracks = tracks.unwrap();
    // Radial ellipse with a = r0: up and down takes 2 (pi / 2 + 1) sqrt(a^3 / GM).
    let expected = 2.0 * (0.5 * PI + 1.0) * (r0.powi(3) / gm).sqrt();
    let Fate::Reimpact { t_s, speed_m_s, position_m, sphere, .. } = tracks.fates[0] else { panic!("{tracks:?}") };
    assert!((t_s / expected - 1.0).abs() < 1e-6, "{t_s} {expected}");
    assert!((speed_m_s / v0 - 1.0).abs() < 1e-6 && sphere == 0);
    assert!((position_m[0] - r0).abs() < 1e-5 && norm([0.0, position_m[1], position_m[2]]) < 1e-6);
}

#[test]
fn fast_bodies_escape_and_circling_ones_stay() {
    let primary = ball(1.0e12, 400.0);
    let gm = G * 1.0e12;
    let options = TrackOptions { t_max_s: 30.0 * DAY_S, ..TrackOptions::default() };
    let fast = body([0.0, 500.0, 0.0], [2.0 * (gm / 500.0f64).sqrt(), 0.0, 0.0], 1.0, 1.0);
    let circling = body([0.0, 0.0, 1000.0], [0.0, (gm / 1000.0f64).sqrt(), 0.0], 1.0, 1.0);
    let tracks = follow(&primary, &[fast, circling], &options).unwrap();
    let Fate::Escape { speed_m_s, .. } = tracks.fates[0] else { panic!("{tracks:?}") };
    assert!((speed_m_s / (2.0 * gm / 500.0).sqrt() - 1.0).abs() < 1e-9);
    let Fate::Bound { mean: Some(mean), within_3_radii, .. } = tracks.fates[1] else { panic!("{tracks:?}") };
    assert!((mean.semimajor_axis_m - 1000.0).abs() < 1e-3 && mean.eccentricity < 1e-6);
    assert!((mean.inclination - 0.5 * PI).abs() < 1e-6 && (within_3_radii - 1.0).abs() < 1e-9);
}

#[test]
fn merging_bodies_and_the_whole_budget_close() {
    // A point mass exerts no torque about itself: what was shed must be found again to round-off.
    let primary = ball(1.0e12, 400.0);
    let gm = G * 1.0e12;
    let v = (gm / 1500.0f64).sqrt();
    let mut one = body([1500.0, 0.0, 0.0], [0.0, v, 0.1 * v], 2.0e6, 5.0);
    one.spin = [1e-4, 0.0, 3e-4];
    let other = body([0.0, 1500.0, 0.0], [v, 0.0, 0.0], 1.0e6, 4.0);
    let meeting = body([1500.0 * 0.9f64.cos(), 1500.0 * 0.9f64.sin(), 0.0], [0.0, 0.0, 0.0], 1.0e6, 4.0);
    let options = TrackOptions { t_max_s: 5.0 * DAY_S, ..TrackOptions::default() };
    let tracks = follow(&primary, &[one, other, meeting], &options).unwrap();
    let ends = [tracks.budget.reimpact, tracks.budget.escape, tracks.budget.bound];
    let mass: f64 = ends.iter().map(|share| share.mass_kg).sum();
    assert!((mass / 4.0e6 - 1.0).abs() < 1e-15);
    assert_eq!(ends.iter().map(|share| share.bodies).sum::<usize>(), 3);
    let scale = norm(tracks.budget.shed.angular_momentum);
    assert!(norm(tracks.budget.torque_on_primary) < 1e-6 * scale, "{tracks:?}");
    // Two that fly at each other along their orbit merge.
    let near = |angle: f64, sense: f64, mass: f64| {
        let (s, c) = angle.sin_cos();
        body([1500.0 * c, 1500.0 * s, 0.0], [-sense * v * s, sense * v * c, 0.0], mass, 5.0)
    };
    let tracks = follow(&primary, &[near(0.0, 1.0, 1.0e6), near(0.5, -1.0, 2.0e6)], &options).unwrap();
    let Fate::Merged { t_s, speed_m_s, into: 1 } = tracks.fates[0] else { panic!("{tracks:?}") };
    let expected = (1500.0 * 0.5 - 10.0) / (2.0 * v);
    assert!((t_s / expected - 1.0).abs() < 1e-3 && (speed_m_s / (2.0 * v) - 1.0).abs() < 1e-3, "{t_s} {expected}");
}

#[test]
fn what_the_primary_takes_up_is_the_torque_over_time() {
    let primary = Primary { spheres: prolate(300), spin_rate: TAU / (4.5 * 3600.0) };
    let exact = TrackOptions { multipole_error: 1e-15, t_max_s: 2.0 * DAY_S, ..TrackOptions::default() };
    let gm = G * primary.spheres.total_mass();
    let start = body([2000.0, 0.0, 0.0], [0.0, (gm / 2000.0).sqrt(), 0.1], 1.0, 1.0);
    let tracks = follow(&primary, &[start], &exact).unwrap();
    let mut field = Field::new(&primary, &exact).unwrap();
    // Trapezoids over the same orbit in small steps.
    let mut simulation = Simulation::new(&[start], 1e-9, 0.0, 10.0).unwrap();
    let torque = |field: &mut Field, t: f64, r: [f64; 3]| cross(r, field.attraction(t, r)).map(|c| -c);
    let mut taken = [0.0; 3];
    let mut last = (0.0, torque(&mut field, 0.0, start.position));
    while simulation.t() < exact.t_max_s {
        simulation.limit_dt((exact.t_max_s - simulation.t()).min(50.0));
        simulation.step(&mut field);
        let t = simulation.t();
        let now = torque(&mut field, t, simulation.states().next().unwrap().0);
        for k in 0..3 {
            taken[k] += 0.5 * (t - last.0) * (last.1[k] + now[k]);
        }
        last = (t, now);
    }
    let booked = tracks.budget.torque_on_primary;
    assert!(norm(std::array::from_fn(|k| booked[k] - taken[k])) < 1e-4 * norm(taken), "{booked:?} {taken:?}");
}

#[test]
fn multipoles_change_no_fate_and_are_used_far_out() {
    let primary = Primary { spheres: prolate(300), spin_rate: TAU / (4.5 * 3600.0) };
    let gm = G * primary.spheres.total_mass();
    let shed: Vec<ShedBody> = (0..12)
        .map(|k| {
            let angle = TAU * f64::from(k) / 12.0;
            let (s, c) = angle.sin_cos();
            let speed = (0.8 + 0.07 * f64::from(k)) * (2.0 * gm / 1100.0).sqrt();
            body([1100.0 * c, 1100.0 * s, 10.0 * f64::from(k)], [-speed * s, speed * c, 0.0], 1.0, 10.0)
        })
        .collect();
    let fates = |multipole_error| {
        let options = TrackOptions { multipole_error, t_max_s: 20.0 * DAY_S, ..TrackOptions::default() };
        let tracks = follow(&primary, &shed, &options).unwrap();
        let kinds: Vec<_> = tracks.fates.iter().map(std::mem::discriminant).collect();
        (kinds, tracks.evaluations)
    };
    let ((kinds, few), (exact, all)) = (fates(1e-8), fates(1e-15));
    assert_eq!(kinds, exact);
    assert!(few.multipoles > few.mascons && all.multipoles < few.multipoles, "{few:?} {all:?}");
}

#[test]
fn wrong_inputs_are_refused_and_nothing_shed_is_nothing_to_do() {
    let primary = ball(1.0e12, 400.0);
    let options = TrackOptions::default();
    let tracks = follow(&primary, &[], &options).unwrap();
    assert!(tracks.fates.is_empty() && tracks.steps == 0);
    let inside = body([100.0, 0.0, 0.0], [0.0; 3], 1.0, 1.0);
    assert!(matches!(follow(&primary, &[inside], &options), Err(ShedError::InsidePrimary { body: 0, .. })));
    let bad = body([f64::NAN, 0.0, 0.0], [0.0; 3], 1.0, 1.0);
    let good = body([1000.0, 0.0, 0.0], [0.0; 3], 1.0, 1.0);
    assert!(matches!(follow(&primary, &[good, bad], &options), Err(ShedError::BadBody { body: 1, .. })));
    let massless = body([1000.0, 0.0, 0.0], [0.0; 3], 0.0, 1.0);
    assert!(matches!(follow(&primary, &[massless], &options), Err(ShedError::BadBody { quantity: "mass", .. })));
    let negative = TrackOptions { t_max_s: -1.0, ..options };
    assert!(matches!(follow(&primary, &[good], &negative), Err(ShedError::OutOfRange { path: "t_max_s", .. })));
}

#[test]
fn a_body_midway_between_two_spheres_has_a_fate_too() {
    let mut spheres = Spheres::default();
    for x in [-100.0, 100.0] {
        spheres.push([x, 0.0, 0.0], [0.0; 3], [0.0; 3], 1e10, 50.0);
    }
    let options = TrackOptions { t_max_s: DAY_S, ..TrackOptions::default() };
    let middle = body([0.0; 3], [0.0; 3], 1.0, 1.0);
    let primary = Primary { spheres: spheres.clone(), spin_rate: 1e-4 };
    let tracks = follow(&primary, &[middle], &options).unwrap();
    assert!(tracks.jacobi_drift[0].is_some_and(|drift| drift < 1e-9), "{tracks:?}");
    let mut small = Spheres::default();
    small.push([0.0; 3], [0.0; 3], [0.0; 3], 1.0, 1.0);
    let pair = follow_pair(&spheres, &small, &options).unwrap();
    assert!(pair.t_s > 0.0 && pair.energy_drift.is_finite(), "{pair:?}");
}

#[test]
fn sunlight_pushes_away_from_the_sun_and_its_tide_is_traceless() {
    let primary = ball(1.0, 1e-3);
    let sun = Sun { obliquity: 0.4, tide: true, radiation_pressure_coefficient: Some(1.0) };
    let options = TrackOptions { sun: Some(sun), ..TrackOptions::default() };
    let mut field = Field::new(&primary, &options).unwrap();
    let at = |position: [f64; 3], field: &mut Field| {
        let mut particle = [librebound_sys::ffi::reb_particle {
            x: position[0],
            y: position[1],
            z: position[2],
            m: 1.0e3,
            r: 0.05,
            ..Default::default()
        }];
        rebound::Force::add(field, 0.0, &mut particle);
        [particle[0].ax, particle[0].ay, particle[0].az]
    };
    let d = 1e6;
    let axes = [[d, 0.0, 0.0], [0.0, d, 0.0], [0.0, 0.0, d]];
    let there = axes.map(|p| at(p, &mut field));
    let back = axes.map(|p| at(p.map(|c| -c), &mut field));
    let pressure = (there[0][0] + back[0][0]) / 2.0;
    let expected = -1361.0 / 299_792_458.0 * PI * 0.05 * 0.05 / 1.0e3;
    assert!((pressure / expected - 1.0).abs() < 1e-6, "{pressure} {expected}");
    let tides: [f64; 3] = std::array::from_fn(|k| (there[k][k] - back[k][k]) / (2.0 * d));
    assert!((tides[0] / (2.0 * 1.327_124_400_18e20 / 1.495_978_707e11f64.powi(3)) - 1.0).abs() < 1e-6);
    assert!(tides.iter().sum::<f64>().abs() < 1e-6 * tides[0]);
}
