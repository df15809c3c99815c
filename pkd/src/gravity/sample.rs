//! The error of a tree's field, from spheres for which it is compared with the sum over all pairs.

use rayon::prelude::*;

use super::dispatch::Kernels;
use super::field::BLOCK;
use super::near::Action;
use super::tree::{NOBODY, Tree};

/// Spheres looked at, four at a time: their scatter leaves about a tenth of uncertainty in the error.
const FOURS: usize = 16;

/// Some spheres, spread evenly through the tree, with what all others do to them.
#[derive(Debug, Default)]
pub(super) struct Sample {
    spheres: Vec<[usize; 2]>,
    exact: Vec<[f64; 4]>,
}

impl Sample {
    /// Sums over all pairs of the sample.
    pub fn take(&mut self, tree: &Tree, kernels: &Kernels) {
        let count = 4 * FOURS;
        self.spheres.clear();
        self.spheres.extend((0..count).map(|k| {
            // The golden ratio keeps the place in a block independent of the block.
            let (block, row) = (k * tree.blocks.len() / count, (k as f64 * 0.618_033_988_75).fract());
            let row = (row * BLOCK as f64) as usize;
            // The first place of a block is always taken.
            [block, if tree.order[block][row] == NOBODY { 0 } else { row }]
        }));
        let fours: Vec<[[f64; 4]; 4]> = self
            .spheres
            .par_chunks_exact(4)
            .map(|four| kernels.four(&tree.blocks, [four[0], four[1], four[2], four[3]]))
            .collect();
        self.exact.clear();
        self.exact.extend(fours.into_iter().flatten());
    }

    /// The rms error of accelerations, or of potentials, over the rms of their exact values.
    pub fn error(&self, field: &[Action], potentials: bool) -> f64 {
        let components = if potentials { 3..4 } else { 0..3 };
        let (mut errors, mut sizes) = (0.0, 0.0);
        for (&[block, row], exact) in self.spheres.iter().zip(&self.exact) {
            let action = &field[block];
            let [x, y, z] = action.pull.0.map(|component| component[row]);
            let found = [x, y, z, action.depth[row]];
            for k in components.clone() {
                errors += (found[k] - exact[k]) * (found[k] - exact[k]);
                sizes += exact[k] * exact[k];
            }
        }
        if sizes > 0.0 { (errors / sizes).sqrt() } else { 0.0 }
    }
}
