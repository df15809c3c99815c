//! The hard-sphere integrator on a few spheres: free flight, orbits, impacts, the two limits, and what it refuses.

use pkd::gravity::{GravityMethod, GravityOptions, potential_energy};
use pkd::hard_sphere::{HardSphere, HardSphereParameters, Report, SlideVelocity};
use pkd::mass_properties::mass_properties;
use pkd::{PkdError, Spheres};

/// Radius (m) and mass (kg) of the spheres of Cotto-Figueroa et al. 2015: 50.2 m of 2960 kg/m³.
const R: f64 = 50.2;
const M: f64 = 1.568_525e9;

fn defaults() -> HardSphereParameters {
    HardSphereParameters::default()
}

fn without_gravity() -> HardSphereParameters {
    HardSphereParameters { gravity: None, ..defaults() }
}

fn spheres(rows: &[([f64; 3], [f64; 3], f64, f64)]) -> Spheres {
    let mut s = Spheres::default();
    for &(r, v, mass, radius) in rows {
        s.push(r, v, [0.0; 3], mass, radius);
    }
    s
}

fn evolve(s: &mut Spheres, parameters: &HardSphereParameters, duration_s: f64) -> Report {
    HardSphere::new(parameters.clone()).evolve(s, duration_s).unwrap()
}

fn energy(s: &Spheres) -> f64 {
    mass_properties(s).unwrap().kinetic_energy + potential_energy(s)
}

/// All numbers are short binary fractions, so that nothing is rounded.
#[test]
fn drift_without_gravity_and_collisions_is_exact() {
    let mut s = spheres(&[([0.0, 1.0, 0.0], [0.5, 0.25, -1.0], M, R), ([256.0, 0.0, 0.0], [1.0, 0.125, 2.0], M, R)]);
    let report = evolve(&mut s, &HardSphereParameters { step_s: 64.0, ..without_gravity() }, 1024.0);
    assert_eq!(report.counts.collisions, 0);
    assert_eq!((s.x[0], s.y[0], s.z[0]), (512.0, 257.0, -1024.0));
    assert_eq!((s.x[1], s.y[1], s.z[1]), (1280.0, 128.0, 2048.0));
}

#[test]
fn a_single_sphere_flies_straight() {
    let mut s = spheres(&[([1.0, 2.0, 3.0], [0.5, 0.0, -0.25], M, R)]);
    s.wz[0] = 3e-4;
    evolve(&mut s, &defaults(), 500.0);
    assert!((s.x[0] - 251.0).abs() < 1e-12 && s.y[0] == 2.0 && (s.z[0] + 122.0).abs() < 1e-12 && s.wz[0] == 3e-4);
}

/// Two spheres 4 R apart, started with `speed` times the circular velocity: largest error of the energy over one
/// circular period, relative to the initial energy.
fn orbit_error(speed: f64, steps: u32) -> f64 {
    let d = 4.0 * R;
    let v = speed * 0.5 * (pkd::constants::G * 2.0 * M / d).sqrt();
    let period = std::f64::consts::TAU * 0.5 * d / (v / speed);
    let mut s = spheres(&[([-0.5 * d, 0.0, 0.0], [0.0, -v, 0.0], M, R), ([0.5 * d, 0.0, 0.0], [0.0, v, 0.0], M, R)]);
    let mut engine = HardSphere::new(HardSphereParameters { step_s: period / f64::from(steps), ..defaults() });
    let start = energy(&s);
    let mut worst = 0.0_f64;
    for _ in 0..steps {
        assert_eq!(engine.step(&mut s).unwrap().counts.collisions, 0);
        worst = worst.max((energy(&s) / start - 1.0).abs());
    }
    worst
}

/// Second order: half the step leaves a quarter of the error. The higher orders add a few per cent at these steps.
#[test]
fn orbit_energy_error_falls_with_the_square_of_the_step() {
    let [coarse, middle, fine] = [200, 400, 800].map(|steps| orbit_error(1.1, steps));
    for ratio in [coarse / middle, middle / fine] {
        assert!((ratio - 4.0).abs() < 0.1, "{ratio}: {coarse:e} {middle:e} {fine:e}");
    }
    // A circular orbit has no other phase to compare with, so its error is of a higher order still.
    assert!(orbit_error(1.0, 200) / orbit_error(1.0, 400) > 4.0 * 0.97);
}

#[test]
fn a_head_on_impact_leaves_the_restitution_times_the_speed() {
    let mut s = spheres(&[([-101.2, 0.0, 0.0], [1.0, 0.0, 0.0], M, R), ([0.0; 3], [0.0; 3], M, R)]);
    let report = evolve(&mut s, &without_gravity(), 50.0);
    // Contact after 0.8 s; then 0.4 and 0.6 m/s for the remaining 49.2 s.
    assert_eq!((report.counts.collisions, report.counts.nominal), (1, 1));
    assert!((s.vx[0] - 0.4).abs() < 1e-15 && (s.vx[1] - 0.6).abs() < 1e-15);
    assert!((s.x[0] - (-100.4 + 0.4 * 49.2)).abs() < 1e-12 && (s.x[1] - 0.6 * 49.2).abs() < 1e-12);
}

/// 5 m to the contact at 0.5 m/s each and steps of 1 s: the meeting falls on the end of a step, so on the start of the next.
/// Anything faster than the escape speed of the pair loses what it should there; slower impacts count as contacts at rest.
#[test]
fn an_impact_at_the_very_start_of_a_step_loses_what_the_restitution_says() {
    for speed in [0.03125, 0.125, 0.5, 4.0] {
        let mut s = spheres(&[
            ([-5.0, 0.0, 0.0], [speed, 0.0, 0.0], 1000.0, 1.0),
            ([5.0, 0.0, 0.0], [-speed, 0.0, 0.0], 1000.0, 1.0),
        ]);
        let step_s = 0.5 / speed;
        let report = evolve(&mut s, &HardSphereParameters { step_s, ..without_gravity() }, 20.0 * step_s);
        assert_eq!((report.counts.collisions, report.counts.nominal), (1, 1), "{speed}");
        assert!((energy_of_motion(&s) / (1000.0 * speed * speed) - 0.04).abs() < 1e-14, "{speed}");
    }
}

fn energy_of_motion(s: &Spheres) -> f64 {
    mass_properties(s).unwrap().kinetic_energy
}

/// Escape velocity at contact of two such spheres is 6.458 cm/s, so the limit of 0.01 is at 0.6458 mm/s.
#[test]
fn slide_limit_compares_with_the_mutual_escape_speed() {
    for (speed, slides) in [(6.4e-4, 1), (6.5e-4, 0)] {
        // A whole radius to go: the limit on collapse stays out of it.
        let mut s = spheres(&[([-3.0 * R, 0.0, 0.0], [speed, 0.0, 0.0], M, R), ([0.0; 3], [0.0; 3], M, R)]);
        let long_step = HardSphereParameters { step_s: 1e5, ..without_gravity() };
        let counts = evolve(&mut s, &long_step, 1e5).counts;
        assert_eq!((counts.collisions, counts.slide, counts.nominal), (1, slides, 1 - slides));
        let expected = if slides == 1 { [0.0, speed] } else { [0.4 * speed, 0.6 * speed] };
        assert!((s.vx[0] - expected[0]).abs() < 1e-18 && (s.vx[1] - expected[1]).abs() < 1e-18);
    }
}

/// The centres pass each other at 2 cm/s, thirty times the limit, but the surfaces roll on each other.
#[test]
fn slide_limit_on_the_surfaces_sees_rolling_spheres_at_rest() {
    for (slide_velocity, slides) in [(SlideVelocity::Centre, 0), (SlideVelocity::Surface, 1)] {
        let mut s = spheres(&[([0.0; 3], [0.0; 3], M, R), ([2.0 * R + 5e-6, 0.0, 0.0], [-1e-5, 0.02, 0.0], M, R)]);
        s.wz = vec![0.01 / R; 2];
        let parameters = HardSphereParameters { slide_velocity, collapse_limit: 0.0, ..without_gravity() };
        let counts = evolve(&mut s, &parameters, 50.0).counts;
        assert_eq!((counts.collisions, counts.slide, counts.nominal), (1, slides, 1 - slides));
    }
}

/// A ball between two walls (a million times heavier) that close: with loss at every bounce it bounces ever faster while the
/// gap shrinks to nothing. The limit on collapse makes it lossless in time to throw the walls back.
#[test]
fn collapse_limit_ends_what_would_diverge() {
    let squeeze = |collapse_limit| {
        let walls = 1e6;
        let mut s = spheres(&[
            ([-2.1, 0.0, 0.0], [0.05, 0.0, 0.0], walls, 1.0),
            ([0.0; 3], [0.01, 0.0, 0.0], 1.0, 1.0),
            ([2.1, 0.0, 0.0], [-0.05, 0.0, 0.0], walls, 1.0),
        ]);
        let parameters = HardSphereParameters { collapse_limit, step_s: 10.0, ..without_gravity() };
        let report = evolve(&mut s, &parameters, 10.0);
        assert!(report.max_overlap_over_radius < 1e-9, "{report:?}");
        report.counts
    };
    let with = squeeze(1e-5);
    assert!(with.capped == 0 && with.collapse > 0 && with.collisions < 10_000, "{with:?}");
    let without = squeeze(0.0);
    assert!(without.capped > 0 && without.collisions > 10_000, "{without:?}");
}

/// A pair that touches must stay so under its own gravity, step after step: without rebound and limits it collides once a
/// kick and rests, otherwise it hops, by 0.1 m at most from 0.5 mm/s, the speed that one kick gives.
#[test]
fn resting_spheres_do_not_sink_into_each_other() {
    let sticky = HardSphereParameters { restitution_normal: 0.0, collapse_limit: 0.0, slide_limit: 0.0, ..defaults() };
    for (parameters, highest, collisions) in [(sticky, 1e-12, 2000), (defaults(), 0.2, 500)] {
        let mut s = spheres(&[([-R, 0.0, 0.0], [0.0; 3], M, R), ([R, 0.0, 0.0], [0.0; 3], M, R)]);
        let report = evolve(&mut s, &parameters, 100_000.0);
        let gap = s.x[1] - s.x[0] - 2.0 * R;
        assert!(report.max_overlap_over_radius < 1e-12 && (-1e-12..highest).contains(&gap), "{gap:e} {report:?}");
        assert!(report.counts.collisions >= collisions, "{report:?}");
    }
}

#[test]
fn smooth_spheres_keep_their_spins_to_the_bit() {
    let mut s = spheres(&[([-60.0, 3.0, 1.0], [0.02, 0.0, 0.0], M, R), ([60.0, -5.0, 0.0], [0.0; 3], M, R)]);
    s.wx = vec![1e-4, 3e-4];
    s.wz = vec![-2e-4, 0.0];
    let before = s.clone();
    let smooth = HardSphereParameters { restitution_tangential: 1.0, ..defaults() };
    assert!(evolve(&mut s, &smooth, 5000.0).counts.collisions > 10);
    assert_eq!((s.wx, s.wy, s.wz), (before.wx, before.wy, before.wz));
}

#[test]
fn a_pebble_bounces_on_a_boulder_a_billion_times_heavier() {
    let mut s = spheres(&[
        ([0.0; 3], [0.0; 3], M, R),
        ([R + 3.0, 0.0, 0.0], [0.0, 1e-3, 0.0], 1.0, 0.05),
        ([0.0, R + 1.0, 0.5], [0.0; 3], 40.0, 0.2),
    ]);
    let before = mass_properties(&s).unwrap();
    let report = evolve(&mut s, &HardSphereParameters { step_s: 5.0, ..defaults() }, 20_000.0);
    let after = mass_properties(&s).unwrap();
    assert!(report.max_overlap_over_radius < 1e-9 && report.counts.collisions > 100, "{report:?}");
    assert!((after.velocity - before.velocity).norm() < 1e-18);
    for i in 1..3 {
        let r = (s.x[i].powi(2) + s.y[i].powi(2) + s.z[i].powi(2)).sqrt();
        assert!(r - R - s.radius[i] < 0.1, "sphere {i} lies on the boulder, not at {r} m");
    }
}

#[test]
fn steps_are_equal_and_never_longer_than_asked_for() {
    let lone = || spheres(&[([0.0; 3], [1.0, 0.0, 0.0], M, R)]);
    for (duration, steps) in [(0.0, 0), (1.0, 1), (50.0, 1), (50.1, 2), (18_000.0, 360), (0.1 * 3.0 * 500.0, 3)] {
        let report = evolve(&mut lone(), &defaults(), duration);
        assert_eq!(report.steps, steps, "{duration} s");
        assert!((report.duration_s - duration).abs() <= 1e-13 * duration);
    }
}

#[test]
fn bad_input_is_refused_with_its_reason() {
    let try_it = |s: &mut Spheres, p: HardSphereParameters, t: f64| HardSphere::new(p).evolve(s, t).unwrap_err();
    let mut pair = spheres(&[([0.0; 3], [0.0; 3], M, R), ([3.0 * R, 0.0, 0.0], [0.0; 3], M, R)]);
    let bad = HardSphereParameters { step_s: -1.0, ..defaults() };
    assert!(matches!(try_it(&mut pair, bad, 50.0), PkdError::BadParameter { name: "step_s", .. }));
    for t in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(try_it(&mut pair, defaults(), t), PkdError::BadParameter { name: "duration_s", .. }));
    }
    assert_eq!(try_it(&mut Spheres::default(), defaults(), 50.0), PkdError::Empty);
    pair.vy[1] = f64::NAN;
    assert!(matches!(try_it(&mut pair, defaults(), 50.0), PkdError::BadValue { sphere: 1, column: "vy", .. }));
}

#[test]
fn overlapping_starts_are_refused_with_the_pair_and_its_depth() {
    let mut s = spheres(&[
        ([0.0; 3], [0.0; 3], M, R),
        ([300.0, 0.0, 0.0], [0.0; 3], M, R),
        ([300.0, 1.5 * R, 0.0], [0.0; 3], M, R),
    ]);
    match HardSphere::new(defaults()).evolve(&mut s, 50.0) {
        Err(PkdError::Overlap { first: 1, second: 2, fraction, time_s: 0.0 }) => {
            assert!((fraction - 0.5).abs() < 1e-12)
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn numbers_out_of_range_stop_the_run() {
    let mut s = spheres(&[([0.0; 3], [0.0; 3], 1e300, 1.0), ([4.0, 0.0, 0.0], [0.0; 3], 1e300, 1.0)]);
    let huge = HardSphereParameters { step_s: 1e30, ..defaults() };
    let error = HardSphere::new(huge).evolve(&mut s, 3e30).unwrap_err();
    assert!(matches!(error, PkdError::BecameNonFinite { .. }), "{error}");
}

#[test]
fn collisions_without_end_stop_the_run() {
    let walls = 1e16;
    let mut s = spheres(&[
        ([-2.1, 0.0, 0.0], [0.05, 0.0, 0.0], walls, 1.0),
        ([0.0; 3], [0.01, 0.0, 0.0], 1.0, 1.0),
        ([2.1, 0.0, 0.0], [-0.05, 0.0, 0.0], walls, 1.0),
    ]);
    let parameters = HardSphereParameters { max_collisions_per_sphere: 100, step_s: 10.0, ..without_gravity() };
    let error = HardSphere::new(parameters).evolve(&mut s, 10.0).unwrap_err();
    match error {
        PkdError::CollisionRunaway { sphere: 1, collisions: 10_001, time_s } => assert!((1.9..2.1).contains(&time_s)),
        other => panic!("{other}"),
    }
}

/// With an error of the force of a percent; a tree's torques alone would take 1e-4 of the angular momentum in that time.
#[test]
fn gravity_of_a_tree_keeps_angular_momentum() {
    let mut s = Spheres::default();
    for k in 0..512_i32 {
        let at = |shift: i32| f64::from(k >> shift & 7) - 3.5;
        let r = [at(0) * 2.3 * R + f64::from(k % 5), at(3) * 2.1 * R, at(6) * 2.05 * R];
        s.push(r, [-2e-4 * r[1], 2e-4 * r[0], 0.0], [0.0, 0.0, 2e-4], M, R);
    }
    let gravity = GravityOptions { method: GravityMethod::Tree, force_error: 1e-2 };
    let before = mass_properties(&s).unwrap();
    evolve(&mut s, &HardSphereParameters { gravity: Some(gravity), ..defaults() }, 5000.0);
    let after = mass_properties(&s).unwrap();
    let drift = (after.angular_momentum - before.angular_momentum).norm() / before.angular_momentum.norm();
    assert!(drift < 1e-13, "{drift:e}");
}
