//! Movements of known spheres in a body of a thousand are found, and only they.

use nalgebra::{Rotation3, Vector3};

use super::*;

const RADIUS_M: f64 = 50.2;
const N: usize = 1000;

/// A thousand centres in a kilometre-sized cloud, reproducible without a generator.
fn body() -> [Vec<f64>; 3] {
    let golden = |k: f64| (0..N).map(|i| 700.0 * (2.0 * ((i as f64 + 0.5) * k).fract() - 1.0)).collect();
    [golden(0.618_033_988_7), golden(0.754_877_666_2), golden(0.569_840_290_9)]
}

fn slices(x: &[Vec<f64>; 3]) -> Coordinates<'_> {
    [&x[0], &x[1], &x[2]]
}

/// The body turned and carried away, with the chosen spheres displaced by `shift_m` in the moved frame.
fn displaced(x: &[Vec<f64>; 3], chosen: &[bool], shift_m: Vector3<f64>) -> ([Vec<f64>; 3], RigidMotion) {
    let rotation = Rotation3::from_scaled_axis(Vector3::new(0.02, -0.01, 2.4)).into_inner();
    let motion = RigidMotion { rotation, translation: Vector3::new(12.0, -700.0, 3.0) };
    let mut y = x.clone();
    for i in 0..N {
        let mut p = motion.apply(Vector3::new(x[0][i], x[1][i], x[2][i]));
        if chosen[i] {
            p += shift_m;
        }
        (0..3).for_each(|k| y[k][i] = p[k]);
    }
    (y, motion)
}

/// `count` spheres scattered over the body.
fn subset(count: usize) -> Vec<bool> {
    let mut chosen = vec![false; N];
    (0..count).for_each(|k| chosen[(k * 367 + 11) % N] = true);
    assert_eq!(chosen.iter().filter(|c| **c).count(), count);
    chosen
}

#[test]
fn three_spheres_moved_by_three_tenths_of_a_radius_are_the_three_found() {
    let (x, chosen) = (body(), subset(3));
    let (y, motion) = displaced(&x, &chosen, Vector3::new(0.3 * RADIUS_M, 0.0, 0.0));
    for rule in [MovementRule::Robust, MovementRule::Literal] {
        let found = detect_movement(slices(&x), slices(&y), &[RADIUS_M; N], 0.25, rule);
        assert_eq!(found.moved, chosen);
        assert_eq!((found.count(), found.robust_count, found.literal_count), (3, 3, 3));
        // After the exclusion nothing but the rigid motion is left.
        assert!((found.motion.rotation - motion.rotation).amax() < 1e-12);
        assert!((found.motion.translation - motion.translation).amax() < 1e-9);
        assert!(!found.fully_rearranged);
    }
}

#[test]
fn a_shift_below_a_quarter_radius_is_no_movement() {
    let (x, chosen) = (body(), subset(3));
    let (y, _) = displaced(&x, &chosen, Vector3::new(0.0, 0.24 * RADIUS_M, 0.0));
    let found = detect_movement(slices(&x), slices(&y), &[RADIUS_M; N], 0.25, MovementRule::Robust);
    assert_eq!((found.count(), found.literal_count, found.fits), (0, 0, 1));
}

#[test]
fn rigid_motion_alone_is_recovered_to_round_off() {
    let x = body();
    let (y, motion) = displaced(&x, &[false; N], Vector3::zeros());
    let found = detect_movement(slices(&x), slices(&y), &[RADIUS_M; N], 0.25, MovementRule::Robust);
    assert!((found.motion.rotation - motion.rotation).amax() < 1e-12);
    assert!((found.motion.translation - motion.translation).amax() < 1e-12 * 700.0);
    assert!(found.residual_m.iter().all(|e| *e < 1e-10));
}

#[test]
fn coherent_shift_of_a_large_part_is_found_exactly_by_the_robust_rule() {
    // (fraction, displacement in radii, whether the literal rule survives)
    for (fraction, shift, literal_works) in
        [(0.10, 1.0, true), (0.30, 0.5, true), (0.40, 1.0, false), (0.45, 3.0, false), (0.30, 10.0, false)]
    {
        let count = (fraction * N as f64) as usize;
        let (x, chosen) = (body(), subset(count));
        let (y, _) = displaced(&x, &chosen, Vector3::new(0.0, 0.0, shift * RADIUS_M));
        let robust = detect_movement(slices(&x), slices(&y), &[RADIUS_M; N], 0.25, MovementRule::Robust);
        assert_eq!(robust.moved, chosen, "({fraction}, {shift})");
        assert!(robust.fits <= 3, "({fraction}, {shift}): {} fits", robust.fits);
        assert_eq!(robust.literal_count, if literal_works { count } else { N });
        let literal = detect_movement(slices(&x), slices(&y), &[RADIUS_M; N], 0.25, MovementRule::Literal);
        assert_eq!((literal.count(), literal.robust_count), (robust.literal_count, count));
        assert_eq!(literal.fully_rearranged, !literal_works);
    }
}

#[test]
fn each_sphere_is_measured_by_its_own_radius() {
    let (x, chosen) = (body(), subset(2));
    let (y, _) = displaced(&x, &chosen, Vector3::new(10.0, 0.0, 0.0));
    let mut radius = vec![RADIUS_M; N];
    radius[chosen.iter().position(|c| *c).unwrap()] = 30.0;
    let found = detect_movement(slices(&x), slices(&y), &radius, 0.25, MovementRule::Robust);
    assert_eq!(found.count(), 1);
    assert!(found.moved[chosen.iter().position(|c| *c).unwrap()]);
}

#[test]
fn a_body_shaken_to_pieces_is_fully_rearranged_or_all_moved() {
    let x = body();
    let mut y = body();
    y[0].reverse();
    y[1].rotate_left(300);
    let found = detect_movement(slices(&x), slices(&y), &[RADIUS_M; N], 0.25, MovementRule::Robust);
    assert!(found.count() > 900, "{}", found.count());
    assert!((found.motion.rotation.determinant() - 1.0).abs() < 1e-12);
}

#[test]
fn small_sets_and_values_that_are_no_numbers_do_not_panic() {
    for n in 0..4_usize {
        let x: [Vec<f64>; 3] = [0.0, 1.0, 2.0].map(|k| (0..n).map(|i| 100.0 * (i as f64 + k).sin()).collect());
        let found = detect_movement(slices(&x), slices(&x), &vec![1.0; n], 0.25, MovementRule::Robust);
        assert_eq!(found.count(), 0, "{n} spheres in place");
    }
    let (x, mut y) = (body(), body());
    y[1][5] = f64::NAN;
    let found = detect_movement(slices(&x), slices(&y), &[RADIUS_M; N], 0.25, MovementRule::Robust);
    assert!(found.moved[5]);
}
