//! Synthetic series of known type.

use super::*;
use crate::evolve::rigid::{REV_PER_DAY, TorqueErrors, rigid_cycle};
use crate::evolve::spin::{Integrator, SpinState, YEAR_S};

/// No shape is like another.
fn strangers(_: u32, _: u32) -> f64 {
    0.0
}

/// Every second shape is the same; neighbours share 90 % of the spheres.
fn two_shapes(a: u32, b: u32) -> f64 {
    if (a + b).is_multiple_of(2) { 1.0 } else { 0.9 }
}

/// A segment of that many Myr from one value to another; the other quantity follows its own pair.
fn segment(t_myr: [f64; 2], spin_rev_day: [f64; 2], obliquity_deg: [f64; 2], configuration: u32) -> Segment {
    Segment {
        t_s: t_myr.map(|t| t * MYR_S),
        omega: spin_rev_day.map(|w| w * REV_PER_DAY),
        obliquity: obliquity_deg.map(f64::to_radians),
        configuration,
    }
}

/// Intervals of `length_myr` that change the spin (revolutions a day) and the obliquity (deg) by these amounts, each with
/// a shape of its own.
fn walk(length_myr: f64, start: [f64; 2], changes: &[[f64; 2]]) -> Vec<Segment> {
    let mut at = start;
    let step = |(k, change): (usize, &[f64; 2])| {
        let t = length_myr * k as f64;
        let next = [at[0] + change[0], at[1] + change[1]];
        let segment = segment([t, t + length_myr], [at[0], next[0]], [at[1], next[1]], k as u32);
        at = next;
        segment
    };
    changes.iter().enumerate().map(step).collect()
}

fn course(segments: &[Segment]) -> Course<'_> {
    Course { segments, rigid_end_obliquity_deg: Some(90.0), broke_up: false }
}

fn verdicts(segments: &[Segment], alike: fn(u32, u32) -> f64) -> [Verdict; 2] {
    let criteria = Criteria::default();
    [Quantity::Spin, Quantity::Obliquity].map(|q| classify_quantity(q, &course(segments), alike, &criteria))
}

fn labels(segments: &[Segment], alike: fn(u32, u32) -> f64) -> [String; 2] {
    verdicts(segments, alike).map(|v| v.label)
}

/// Signs that look random and never repeat: bits of the golden ratio's multiples.
fn sign(k: usize) -> f64 {
    if (k as f64 * 0.618_033_988_75).fract() < 0.5 && !k.is_multiple_of(3) { 1.0 } else { -1.0 }
}

/// The torques of a rigid body, cut into legs and given a new shape number now and then: up, over and down to the end.
#[test]
fn a_rigid_yorp_cycle_is_a_modified_cycle() {
    let torque = |obliquity: f64, _: f64| (1e-18 * (2.0 * obliquity).cos() + 2e-19, 1e-18 * (2.0 * obliquity).sin());
    let start = SpinState { t_s: 0.0, omega: 4.0 * REV_PER_DAY, obliquity: 5_f64.to_radians() };
    let integrator = Integrator::Rk4 { step_s: 1000.0 * YEAR_S };
    let cycle = rigid_cycle(&torque, TorqueErrors::default(), 1.0, start, 30.0 * MYR_S, integrator).unwrap();
    let segments: Vec<Segment> = cycle
        .states
        .windows(2)
        .enumerate()
        .map(|(k, w)| Segment {
            t_s: [w[0].t_s, w[1].t_s],
            omega: [w[0].omega, w[1].omega],
            obliquity: [w[0].obliquity, w[1].obliquity],
            configuration: k as u32 / 4,
        })
        .collect();
    let [spin, obliquity] = verdicts(&segments, strangers);
    assert_eq!((spin.label.as_str(), obliquity.label.as_str()), ("MYC", "MYC"), "{spin:?} {obliquity:?}");
    assert_eq!((spin.reversals, spin.trend), (1, Some(Trend::Decreasing)));
    assert_eq!(obliquity.reversals, 0);
}

#[test]
fn a_walk_with_random_signs_is_stochastic() {
    let changes: Vec<[f64; 2]> = (0..60).map(|k| [0.03 * sign(k), 0.5 * sign(k + 7)]).collect();
    let [spin, obliquity] = verdicts(&walk(0.04, [4.5, 40.0], &changes), strangers);
    assert_eq!((spin.label.as_str(), obliquity.label.as_str()), ("Sto", "Sto"));
    assert_eq!(spin.trend, Some(Trend::Varying));
    assert!(spin.reversals > 10, "{}", spin.reversals);
}

#[test]
fn a_toggle_between_two_shapes_is_self_governed_in_both_quantities() {
    let changes: Vec<[f64; 2]> = (0..20).map(|k| if k % 2 == 0 { [0.02, 0.3] } else { [-0.018, -0.28] }).collect();
    let segments = walk(0.03, [4.5, 25.0], &changes);
    assert_eq!(labels(&segments, two_shapes), ["SG", "SG"]);
    // The same changes with shapes that never come back, or that all are alike, are a random walk.
    assert_eq!(labels(&segments, strangers), ["Sto", "Sto"]);
    assert_eq!(labels(&segments, |_, _| 0.99), ["Sto", "Sto"]);
}

#[test]
fn a_toggle_over_a_wide_range_or_of_few_intervals_is_not_self_governed() {
    let wide: Vec<[f64; 2]> = (0..20).map(|k| if k % 2 == 0 { [0.2, 6.0] } else { [-0.2, -6.0] }).collect();
    assert_eq!(labels(&walk(0.03, [4.5, 25.0], &wide), two_shapes), ["Sto", "Sto"]);
    let few: Vec<[f64; 2]> = (0..5).map(|k| if k % 2 == 0 { [0.02, 0.3] } else { [-0.02, -0.3] }).collect();
    assert_eq!(labels(&walk(0.03, [4.5, 25.0], &few), two_shapes), ["Sto", "Sto"]);
}

#[test]
fn one_turn_in_three_intervals_is_too_short_to_say() {
    let down_up: Vec<[f64; 2]> = [[-0.05, 1.0], [-0.04, 1.0], [0.06, -1.0]].to_vec();
    let [spin, obliquity] = verdicts(&walk(0.03, [4.5, 25.0], &down_up), strangers);
    assert_eq!((spin.label.as_str(), obliquity.label.as_str()), ("too short to say", "too short to say"));
    assert_eq!(spin.stretches[0].why, "it turns once in 3 intervals; stochastic takes 2 reversals in 5 intervals");
    let often: Vec<[f64; 2]> = (0..4).map(|k| if k % 2 == 0 { [0.2, 6.0] } else { [-0.2, -6.0] }).collect();
    assert_eq!(labels(&walk(0.03, [4.5, 25.0], &often), strangers), ["too short to say", "too short to say"]);
}

#[test]
fn stochastic_evolution_that_becomes_self_governed_is_named_in_that_order() {
    let mut changes: Vec<[f64; 2]> = (0..30).map(|k| [0.06 * sign(k), 0.5 * sign(k + 7)]).collect();
    changes.extend((0..12).map(|k| if k % 2 == 0 { [0.02, 0.3] } else { [-0.02, -0.3] }));
    let shapes = |a: u32, b: u32| if a.min(b) >= 30 { two_shapes(a, b) } else { 0.0 };
    let [spin, _] = verdicts(&walk(0.04, [4.5, 40.0], &changes), shapes);
    assert_eq!(spin.label, "Sto/SG");
    let governed = spin.stretches.iter().find(|s| s.kind == Kind::SelfGoverned).unwrap();
    assert!((governed.from_myr - 1.2).abs() < 1e-9 && (governed.to_myr - 1.68).abs() < 1e-9, "{governed:?}");
}

/// Spin approaches 2 rev/day and obliquity 60 deg with a time constant of 0.5 Myr.
fn approach(steps: usize, myr: f64, spin_end: f64, obliquity_end: f64) -> Vec<Segment> {
    let at = |t: f64| {
        let left = (-t / 0.5_f64).exp();
        [spin_end + (4.0 - spin_end) * left, obliquity_end + (20.0 - obliquity_end) * left]
    };
    let step = |k: usize| {
        let [t0, t1] = [k, k + 1].map(|k| myr * k as f64 / steps as f64);
        let ([w0, e0], [w1, e1]) = (at(t0), at(t1));
        segment([t0, t1], [w0, w1], [e0, e1], k as u32)
    };
    (0..steps).map(step).collect()
}

#[test]
fn an_approach_to_a_steady_spin_stagnates() {
    let [spin, obliquity] = verdicts(&approach(60, 6.0, 2.0, 60.0), strangers);
    assert_eq!((spin.label.as_str(), obliquity.label.as_str()), ("MYC/Stg", "MYC/Stg"), "{spin:?}");
    assert_eq!((spin.trend, obliquity.trend), (Some(Trend::Constant), Some(Trend::Constant)));
    let stretch = spin.stretches.last().unwrap();
    assert!(stretch.from_myr > 1.0 && (stretch.to_myr - 6.0).abs() < 1e-9, "{stretch:?}");
    // The legs end at 0.5 % of spin, so that the rest is one long last leg.
    let mut legs = approach(60, 6.0, 2.0, 60.0);
    let (first, last) = (legs[30], legs[59]);
    legs.truncate(30);
    legs.push(Segment {
        t_s: [first.t_s[0], last.t_s[1]],
        omega: [first.omega[0], last.omega[1]],
        obliquity: [first.obliquity[0], last.obliquity[1]],
        configuration: 30,
    });
    assert_eq!(labels(&legs, strangers), ["MYC/Stg", "MYC/Stg"]);
}

#[test]
fn the_end_of_a_cycle_is_no_stagnation() {
    // Hardly turning, at the obliquity where the rigid body ends; and at a pole.
    assert_eq!(labels(&approach(60, 6.0, 0.05, 90.0), strangers), ["MYC", "MYC"]);
    assert_eq!(labels(&approach(60, 6.0, 2.0, 0.0), strangers), ["MYC/Stg", "MYC"]);
}

#[test]
fn a_short_pause_is_no_stagnation() {
    assert_eq!(labels(&approach(20, 2.0, 2.0, 60.0), strangers), ["MYC", "MYC"]);
}

#[test]
fn one_turn_of_the_spin_from_down_to_up_or_of_the_obliquity_is_no_cycle() {
    let turn = |first: f64| walk(0.1, [4.0, 40.0], &[[first, first], [-first, -first]]);
    assert_eq!(labels(&turn(0.1), strangers), ["MYC", "too short to say"]);
    assert_eq!(labels(&turn(-0.1), strangers), ["too short to say", "too short to say"]);
}

#[test]
fn changes_without_a_sign_turn_nothing() {
    let tiny = 1e-5;
    let changes = [[0.1, 1.0], [-tiny, -1e-3], [0.1, 1.0], [tiny, 1e-3], [-tiny, -1e-3], [0.1, 1.0]];
    let [spin, obliquity] = verdicts(&walk(0.1, [4.0, 40.0], &changes), strangers);
    assert_eq!((spin.reversals, obliquity.reversals), (0, 0));
    assert_eq!((spin.label.as_str(), spin.trend), ("MYC", Some(Trend::Increasing)));
}

#[test]
fn a_fission_comes_last_and_nothing_gives_nothing() {
    let changes: Vec<[f64; 2]> = (0..10).map(|k| [0.06 * sign(k), 0.5 * sign(k + 7)]).collect();
    let segments = walk(0.04, [4.5, 40.0], &changes);
    let broken = Course { broke_up: true, ..course(&segments) };
    let criteria = Criteria::default();
    assert_eq!(classify_quantity(Quantity::Spin, &broken, strangers, &criteria).label, "Sto/F");
    let [spin, obliquity] = verdicts(&[], strangers);
    assert_eq!((spin.label.as_str(), spin.trend, obliquity.reversals), ("", None, 0));
}
