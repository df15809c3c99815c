//! What the public interface cannot set up: loads, spheres that are held, prescribed motion, and the plain kernels.

use nalgebra::{Rotation3, Unit};

use super::*;
use crate::packing::{EllipsoidPacking, Grain, PACKING_FRACTION, Seed, ellipsoid_packing};
use crate::simd::Level;
use crate::soft_sphere::record::SPINS;
use crate::soft_sphere::{Friction, Sliding, SlidingCap, SoftSphere};

const STIFFNESS: f64 = 1e6;

fn law(parameters: &SoftSphereParameters, step: f64) -> Coefficients {
    Coefficients::new(parameters, STIFFNESS, step)
}

/// A sphere of 1 m and 1000 kg on one of 1000 m that is held in place, pressed down by gravity and pulled sideways, m/s²,
/// for a time (s): how fast it is in the end, m/s, and how fast it spins, rad/s.
fn on_a_plane(sliding: Sliding, held: bool, load: f64, pull: f64, duration: f64) -> (f64, f64) {
    let parameters = SoftSphereParameters {
        restitution: 0.2,
        friction: Friction::Sliding(sliding),
        gravity: Gravity::EveryStep,
        skin: 1.0,
        ..SoftSphereParameters::default()
    };
    let mut spheres = Spheres::default();
    spheres.push([0.0, 0.0, -1000.0], [0.0; 3], [0.0; 3], 1000.0, 1000.0);
    // Where the spring carries the load.
    spheres.push([0.0, 0.0, 1.0 - 1000.0 * load / STIFFNESS], [0.0; 3], [0.0; 3], 1000.0, 1.0);
    let step = std::f64::consts::PI * (1000.0 / STIFFNESS).sqrt() / 100.0;
    let (mut gravity, history) = (crate::gravity::Gravity::default(), ContactHistory::default());
    let law = law(&parameters, step);
    let mut engine = Engine::new(Level::in_use(), &mut gravity, &parameters, law, &spheres, &history).unwrap();
    let quads = record::quads(engine.model);
    let row = |engine: &Engine, caller: u32| engine.rows.iter().position(|r| *r == caller).unwrap() * quads;
    let (plane, block) = (row(&engine, 0), row(&engine, 1));
    engine.inverses[plane / quads] = [0.0; 2];
    if held {
        engine.inverses[block / quads][1] = 0.0;
    }
    engine.list(&[]);
    for guide in engine.guides.chunks_exact_mut(guide_quads(GIVEN)) {
        for k in 0..3 {
            guide[FIELD + k].0 = [0.0; LANES];
            guide[FIELD + k].0[block / quads % LANES] = [pull, 0.0, -load][k];
        }
    }
    engine.push(0.0).unwrap();
    engine.kick(-0.5 * step);
    for _ in 0..(duration / step) as u64 {
        let frames = engine.frames(step);
        engine.advance(step, &frames);
        engine.push(step).unwrap();
    }
    engine.kick(0.5 * step);
    (engine.records[block + VELOCITY].0[0], record::spin(&engine.records[block..]).y)
}

/// A block that cannot turn rests while T < mu N, and slides with (T - mu N) / m beyond.
#[test]
fn blocks_stick_and_slip_at_the_right_load() {
    let (mu, load) = (0.5, 1.0);
    let resting = |sliding| on_a_plane(sliding, true, load, 0.9 * mu * load, 5.0).0;
    // From a time on when it slides: before, the spring takes a while to stretch.
    let accelerating = |sliding| {
        let [early, late] = [2.0, 5.0].map(|duration| on_a_plane(sliding, true, load, 1.2 * mu * load, duration).0);
        (late - early) / 3.0
    };
    for cap in [SlidingCap::Smaller, SlidingCap::Rescale] {
        let sliding = Sliding { coefficient: mu, cap, ..Sliding::default() };
        let (speed, acceleration) = (resting(sliding), accelerating(sliding));
        assert!(speed.abs() < 1e-4, "{cap:?}: {speed}");
        // The plane falls away by a thousandth of a radian on the way, which adds a percent.
        assert!((acceleration / (0.2 * mu * load) - 1.0).abs() < 0.02, "{cap:?}: {acceleration}");
    }
    // The stick-slip rule loses its strength when it slips, but it does slip.
    let dropping = Sliding { coefficient: mu, cap: SlidingCap::Drop, ..Sliding::default() };
    assert!(accelerating(dropping) > 0.2 * mu * load);
}

/// A sphere pulled at its centre rolls while T < 7/2 mu N with 5/7 of the acceleration, and slips beyond.
#[test]
fn spheres_roll_and_slip_at_the_right_load() {
    let (mu, load, duration) = (0.1, 1.0, 5.0);
    let sliding = Sliding { coefficient: mu, ..Sliding::default() };
    let pull = 3.0 * mu * load;
    let (speed, spin) = on_a_plane(sliding, false, load, pull, duration);
    assert!((speed / (5.0 / 7.0 * pull * duration) - 1.0).abs() < 0.005, "{speed}");
    // Rolling on the inside of nothing: the surface of the plane curves away by 1/1000.
    assert!((spin / speed - 1.0).abs() < 0.005, "{spin} {speed}");
    let pull = 4.0 * mu * load;
    let (speed, spin) = on_a_plane(sliding, false, load, pull, duration);
    assert!((speed / ((pull - mu * load) * duration) - 1.0).abs() < 0.01, "{speed}");
    assert!((spin / (2.5 * mu * load * duration) - 1.0).abs() < 0.01, "{spin}");
}

/// Two spheres with stretched springs, moved by hand through ten thousand revolutions about an axis.
fn revolve(axis: Vector3<f64>) {
    const STEPS: u32 = 40;
    // Springs so long and strong that the round-off of velocities is nothing beside them.
    let sliding = Sliding { coefficient: 1e6, ..Sliding::default() };
    let parameters = SoftSphereParameters {
        friction: Friction::RollingAndTwisting { sliding, rolling: 1e6, twisting: 1e6 },
        gravity: Gravity::Off,
        ..SoftSphereParameters::default()
    };
    let axis = Unit::new_normalize(axis);
    let mut spheres = Spheres::default();
    let place = Vector3::new(1.0 - 1e-3, 0.0, 0.0);
    spheres.push((-place).into(), [0.0; 3], [0.0; 3], 1000.0, 1.0);
    spheres.push(place.into(), [0.0; 3], [0.0; 3], 1000.0, 1.0);
    let start = Contact {
        first: 0,
        second: 1,
        sliding_m: [0.0, 0.3, -0.2],
        rolling_rad: [0.0, 0.1, 0.2],
        twisting_rad: 0.1,
        age_s: 0.0,
    };
    let history = ContactHistory::new(vec![start]).unwrap();
    let mut gravity = crate::gravity::Gravity::default();
    let angle = std::f64::consts::TAU / f64::from(STEPS);
    // The spin for which the steps, which are not small, hold no sliding: the chord in place of the arc.
    let spin = 2.0 * (0.5 * angle).tan();
    let mut engine =
        Engine::new(Level::in_use(), &mut gravity, &parameters, law(&parameters, 1.0), &spheres, &history).unwrap();
    let quads = record::quads(engine.model);
    for turn in 1..=10_000 * STEPS {
        let at = |k: u32| Rotation3::from_axis_angle(&axis, angle * f64::from(k % STEPS)) * place;
        let (now, before) = (at(turn), at(turn - 1));
        for (k, row) in engine.rows.iter().enumerate() {
            let side = if *row == 0 { -1.0 } else { 1.0 };
            let s = &mut engine.records[k * quads..(k + 1) * quads];
            // Steps of a second.
            for (quad, v) in
                [(PLACE, now * side), (VELOCITY, (now - before) * side), (PREDICTED, (now - before) * side)]
            {
                s[quad].0[..3].copy_from_slice(v.as_slice());
            }
            let spin = *axis * spin;
            (s[PREDICTED].0[3], s[VELOCITY].0[3]) = (spin.x, spin.x);
            s[SPINS].0 = [spin.y, spin.z, spin.y, spin.z];
        }
        engine.push(1.0).unwrap();
    }
    let mut end = spheres.clone();
    let got = engine.finish(&mut end).contacts()[0];
    for (got, start) in [(got.sliding_m, start.sliding_m), (got.rolling_rad, start.rolling_rad)] {
        let (got, start) = (Vector3::from(got), Vector3::from(start));
        assert!((got.norm() / start.norm() - 1.0).abs() < 1e-10, "{:e}", got.norm() / start.norm() - 1.0);
        // A whole number of turns later it points where it pointed.
        assert!((got - start).norm() < 1e-8 * start.norm(), "{got:?} {start:?}");
    }
    assert!((got.twisting_rad - start.twisting_rad).abs() < 1e-13);
}

#[test]
fn a_rigidly_rotating_pair_keeps_its_springs_for_ten_thousand_turns() {
    revolve(Vector3::z());
    revolve(Vector3::new(0.0, 1.0, 0.4));
    // About the line of centres.
    revolve(Vector3::x());
}

fn packed(count: usize) -> Spheres {
    ellipsoid_packing(&EllipsoidPacking {
        count,
        grain: Grain { radius: 50.2, density: 2960.0 },
        b_over_a: 0.8,
        c_over_a: 0.7,
        packing_fraction: PACKING_FRACTION,
        seed: Seed::default(),
    })
    .unwrap()
}

/// The field of a body that has turned is the turned field; of spheres moved by delta at random it is off by 0.1 delta / R.
#[test]
fn frozen_field_is_exact_in_rigid_rotation_and_off_by_a_tenth_of_displacements() {
    let spheres = packed(1000);
    let parameters = SoftSphereParameters::default();
    let turn = Rotation3::from_euler_angles(0.4, 1.0, -2.0);
    for delta in [0.0, 1e-3, 1e-2, 5e-2] {
        let (mut gravity, history) = (crate::gravity::Gravity::default(), ContactHistory::default());
        let law = law(&parameters, 1.0);
        let mut engine = Engine::new(Level::in_use(), &mut gravity, &parameters, law, &spheres, &history).unwrap();
        let quads = record::quads(engine.model);
        // Normal deviates of rms size delta from a fixed sequence.
        let mut state = 1_u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        for s in engine.records.chunks_exact_mut(quads).take(engine.n) {
            let shift = Vector3::from_fn(|_, _| (0..12).map(|_| uniform()).sum::<f64>() - 6.0);
            let place = turn * s[PLACE].xyz() + shift * (delta * 50.2 / 3.0_f64.sqrt());
            s[PLACE].0[..3].copy_from_slice(place.as_slice());
        }
        engine.frame = BodyFrame::of(engine.model, &engine.records, &engine.masses, *turn.matrix());
        engine.attract().unwrap();
        let error = engine.work.frozen_field_error;
        if delta == 0.0 {
            assert!(error < 1e-12, "{error:e}");
        } else {
            assert!((error / (0.1 * delta) - 1.0).abs() < 0.3, "{delta}: {error:e}");
        }
    }
}

#[test]
fn plain_kernels_give_the_bytes_of_the_vector_ones() {
    for ledger in [false, true] {
        for preset in [
            SoftSphereParameters::zhang_2017(),
            SoftSphereParameters::gravel(),
            SoftSphereParameters::frictionless(),
            SoftSphereParameters { friction: Friction::Sliding(Sliding::default()), ..Default::default() },
        ] {
            for (cohesion_pa, gravity) in [(0.0, preset.gravity), (50.0, Gravity::EveryStep), (1e3, Gravity::Off)] {
                let parameters =
                    SoftSphereParameters { ledger, cohesion_pa, gravity, max_overlap: 0.1, ..preset.clone() };
                let mut start = packed(100);
                start.vx.iter_mut().zip(&start.y).for_each(|(v, y)| *v = -1e-4 * y);
                // Closer together, so that there are contacts.
                for c in [&mut start.x, &mut start.y, &mut start.z] {
                    c.iter_mut().for_each(|c| *c *= 0.98);
                }
                let on = |level| {
                    let (mut spheres, mut soft) = (start.clone(), SoftSphere::new(parameters.clone()));
                    let report = soft.evolve_on(level, &mut spheres, 4.0, &mut || true).unwrap();
                    (spheres, soft.history, report)
                };
                let plain = on(Level::Scalar);
                assert!(plain.2.contacts > 10, "{:?}", plain.2);
                for level in Level::available() {
                    assert_eq!(plain, on(level), "{}", level.name());
                }
            }
        }
    }
}
