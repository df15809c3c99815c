//! Pushing apart randomly placed equal spheres in a closed container until none overlap.
//!
//! Steepest descent with momentum on the sum of squared overlaps, from random places: below the density of random
//! close packing (0.64) it ends without overlaps (O'Hern et al. 2003, Phys. Rev. E 68, 011306). What is left when it
//! stops is taken away exactly, by a uniform dilation of all centres. Lengths are in sphere diameters.

use nalgebra::Vector3;

use crate::cells::visit_near_pairs;

/// Share of the last displacement that is repeated.
const MOMENTUM: f64 = 0.8;
/// Share of each overlap that one iteration takes away at each of the two spheres.
const PUSH: f64 = 0.25;
/// Neighbours are listed up to this distance beyond contact, so that the list serves several iterations.
const SKIN: f64 = 0.3;
/// Overlap at which the descent stops: the dilation that removes it opens gaps of the same size.
const ENOUGH: f64 = 1e-3;
/// Iterations after which the container counts as too small; a body of a thousand takes 200 to 500.
const MAX_ITERATIONS: usize = 3_000;

/// How pushing apart ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// No two spheres overlap.
    Separated,
    /// Overlaps remain that only a visible dilation could remove: the container is too small.
    Jammed,
}

/// Moves `centres` (in diameters) apart until no two are closer than 1; `confine` returns the point of the container
/// closest to a centre, or the centre itself.
pub(crate) fn push_apart(centres: &mut [Vector3<f64>], confine: impl Fn(Vector3<f64>) -> Vector3<f64>) -> Outcome {
    let n = centres.len();
    let mut last_move = vec![Vector3::zeros(); n];
    let mut push = vec![Vector3::zeros(); n];
    let mut near = NearPairs::default();
    for _ in 0..MAX_ITERATIONS {
        near.follow(centres);
        push.fill(Vector3::zeros());
        let mut closest = 1.0_f64;
        for &(i, j) in &near.pairs {
            let apart = centres[i as usize] - centres[j as usize];
            let squared = apart.norm_squared();
            if squared < 1.0 {
                let distance = squared.sqrt();
                closest = closest.min(distance);
                // Coincident centres, which random points never are, part along x.
                let direction = if distance > 0.0 { apart / distance } else { Vector3::x() };
                let share = direction * (PUSH * (1.0 - distance));
                push[i as usize] += share;
                push[j as usize] -= share;
            }
        }
        if 1.0 - closest < ENOUGH {
            dilate(centres, closest);
            return Outcome::Separated;
        }
        for i in 0..n {
            let target = confine(centres[i] + last_move[i] * MOMENTUM + push[i]);
            last_move[i] = target - centres[i];
            centres[i] = target;
        }
    }
    Outcome::Jammed
}

/// Scales all centres about the origin, by a hair more than the closest pair (at distance `closest`) needs to touch.
fn dilate(centres: &mut [Vector3<f64>], closest: f64) {
    let factor = (1.0 + 1e-12) / closest;
    centres.iter_mut().for_each(|c| *c *= factor);
}

/// Pairs that may touch, valid until a centre has moved by half the skin.
#[derive(Default)]
struct NearPairs {
    pairs: Vec<(u32, u32)>,
    listed_at: Vec<Vector3<f64>>,
}

impl NearPairs {
    /// Lists the pairs anew where the centres have moved too far since the last time.
    fn follow(&mut self, centres: &[Vector3<f64>]) {
        let valid = self.listed_at.len() == centres.len()
            && self.listed_at.iter().zip(centres).all(|(a, b)| (a - b).norm_squared() < 0.25 * SKIN * SKIN);
        if valid {
            return;
        }
        self.listed_at.clear();
        self.listed_at.extend_from_slice(centres);
        let [x, y, z] = [0, 1, 2].map(|k| centres.iter().map(|c| c[k]).collect::<Vec<f64>>());
        self.pairs.clear();
        let reach = 1.0 + SKIN;
        visit_near_pairs([&x, &y, &z], reach, |i, j| {
            if (centres[i] - centres[j]).norm_squared() < reach * reach {
                self.pairs.push((i as u32, j as u32));
            }
        });
    }
}
