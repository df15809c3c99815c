//! Gravity by a fast multipole method, with its accuracy asked for as an error of the accelerations.
//!
//! Dehnen 2002 (J. Comput. Phys. 179, 27) with higher orders: the work grows with the number of spheres, not with its
//! square, and action equals reaction to round-off. Torques balance only as far as the error goes.

use super::Accelerations;
use super::dispatch::Kernels;
use super::field;
use super::harmonic::narrow_len;
use super::near::Action;
use super::sample::Sample;
use super::tree::{NOBODY, Tree};
use super::walk::Walk;
use crate::constants::G;

/// The tree method with its scratch memory; holds no state, a new one gives the same bytes.
#[derive(Debug)]
pub struct TreeGravity {
    force_error: f64,
    tree: Tree,
    field: Vec<Action>,
    sample: Sample,
    error: f64,
}

/// An order of expansion and how its error follows from the opening.
#[derive(Debug, Clone, Copy)]
struct Order {
    order: usize,
    /// Error at opening 1; with the opening it falls as its power `order` + 1. Measured for even bodies of
    /// 2500 to 40 000 spheres, rounded up by a quarter or more.
    error: f64,
}

/// Enough for bodies at rest.
const LOW: Order = Order { order: 6, error: 6e-3 };
/// The faster one for errors below [`HIGH_BELOW`].
const HIGH: Order = Order { order: 8, error: 3.3e-3 };
const HIGH_BELOW: f64 = 2e-4;
/// Widest opening: towards one the error grows faster than the power, and little time is won.
const WIDEST: f64 = 0.88;
/// Excess of the sampled error over the wanted one that is left to its scatter.
const TOLERATED: f64 = 1.25;
/// What a repetition aims at, as a share of the wanted error.
const AIM: f64 = 0.7;
/// Errors that no walk can better.
const ROUND_OFF: f64 = 1e-14;
/// Most walks for one result.
const MAX_WALKS: usize = 3;

impl TreeGravity {
    /// Accelerations with an error of about `force_error` at most: rms of the error over the rms of the acceleration,
    /// over all spheres. Zero, negative or NaN allows none: every pair is summed.
    pub fn new(force_error: f64) -> Self {
        let force_error = if force_error > 0.0 { force_error } else { 0.0 };
        Self { force_error, tree: Tree::default(), field: Vec::new(), sample: Sample::default(), error: 0.0 }
    }

    /// Accelerations (m/s²) of spheres at `x`, `y`, `z` (m) with `mass` (kg), written to `out`.
    ///
    /// Runs on the threads of the current `rayon` pool; the bytes do not depend on their number.
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn accelerations(&mut self, x: &[f64], y: &[f64], z: &[f64], mass: &[f64], out: &mut Accelerations) {
        self.run([x, y, z], mass, false);
        for (out, k) in [&mut out.x, &mut out.y, &mut out.z].into_iter().zip(0..) {
            self.collect(mass.len(), |action| &action.pull.0[k], 1.0, out);
        }
    }

    /// Potential at each centre due to all other spheres, m²/s², negative, written to `out`.
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn potentials(&mut self, x: &[f64], y: &[f64], z: &[f64], mass: &[f64], out: &mut Vec<f64>) {
        self.run([x, y, z], mass, true);
        // Accelerations keep their size when lengths are scaled together with strengths, depths grow with the lengths.
        self.collect(mass.len(), |action| &action.depth, -1.0 / field::scale([x, y, z]), out);
    }

    /// Error of the last result, estimated from 64 of its spheres: rms error over rms value. Scatters by a tenth or two.
    pub fn last_error_estimate(&self) -> f64 {
        self.error
    }

    /// Fills `self.field`, which is left empty where there is nothing finite to find.
    fn run(&mut self, coordinates: [&[f64]; 3], mass: &[f64], potentials: bool) {
        let order = if self.force_error < HIGH_BELOW { HIGH } else { LOW };
        match order.order {
            6 => self.run_with::<6>(order, coordinates, mass, potentials),
            _ => self.run_with::<8>(order, coordinates, mass, potentials),
        }
    }

    fn run_with<const P: usize>(&mut self, order: Order, coordinates: [&[f64]; 3], mass: &[f64], potentials: bool) {
        assert!(coordinates.iter().all(|c| c.len() == mass.len()), "one entry per sphere in every array");
        self.field.clear();
        self.error = 0.0;
        let all_finite = coordinates.iter().chain([&mass]).all(|values| values.iter().all(|v| v.is_finite()));
        if mass.is_empty() || !all_finite {
            return;
        }
        let kernels = Kernels::fastest::<P>();
        let scale = field::scale(coordinates);
        self.tree.build(coordinates, mass, [scale, G * scale * scale], &kernels, narrow_len(P));
        self.sample.take(&self.tree, &kernels);
        self.field.resize(self.tree.blocks.len(), Action::default());
        let mut opening = opening(self.force_error, order);
        for walk in 1..=MAX_WALKS {
            Walk { tree: &self.tree, kernels: &kernels, opening, depth: potentials }.run(&mut self.field);
            self.error = self.sample.error(&self.field, potentials);
            // Not so where something is not finite: another walk would not help.
            let too_large = self.error > (TOLERATED * self.force_error).max(ROUND_OFF);
            if !too_large || walk == MAX_WALKS {
                break;
            }
            opening *= (AIM * self.force_error / self.error).powf(1.0 / (P + 1) as f64);
        }
    }

    /// Writes one quantity, times `factor`, in the caller's order; NaN where the field has nothing.
    fn collect(&self, count: usize, quantity: impl Fn(&Action) -> &[f64; 8], factor: f64, out: &mut Vec<f64>) {
        out.clear();
        out.resize(count, f64::NAN);
        for (order, action) in self.tree.order.iter().zip(&self.field) {
            for (index, value) in order.iter().zip(quantity(action)) {
                if *index != NOBODY {
                    out[*index as usize] = value * factor;
                }
            }
        }
    }
}

/// The widest opening that keeps `force_error`.
fn opening(force_error: f64, order: Order) -> f64 {
    (force_error / order.error).powf(1.0 / (order.order + 1) as f64).min(WIDEST)
}
