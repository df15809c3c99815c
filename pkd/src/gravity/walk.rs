//! The walk that gives each sphere the field of far cells by expansion and that of near spheres pair by pair.
//!
//! Dehnen 2002 (J. Comput. Phys. 179, 27), one side at a time: a cell goes down the tree with the cells that have not
//! acted on it yet. One that is far enough for what it is acts through its expansion; otherwise the larger of the two
//! is opened. Both sides of a pair decide alike, so action equals reaction to round-off though every cell writes to
//! itself only, and the bytes do not depend on the number of threads.

use super::dispatch::Kernels;
use super::far::Expansion;
use super::harmonic::NARROW;
use super::near::Action;
use super::tree::{Cell, Tree, second_child};

/// Cells with fewer blocks are walked on one thread.
const PARALLEL_BLOCKS: usize = 32;

/// A walk over all of `tree`.
pub(super) struct Walk<'a> {
    pub tree: &'a Tree,
    pub kernels: &'a Kernels,
    /// Cells act by expansion if the sum of their reaches is at most this share of their distance, 0 to below 1.
    pub opening: f64,
    /// Whether potentials are wanted.
    pub depth: bool,
}

/// Memory of one thread's part of a walk.
#[derive(Default)]
struct Scratch {
    /// Cells that are still to act, in layers from the root to the present cell.
    waiting: Vec<u32>,
    stack: Vec<u32>,
    far: Vec<u32>,
    near: Vec<u32>,
}

impl Walk<'_> {
    /// Writes to `out`, one entry per block.
    pub fn run(&self, out: &mut [Action]) {
        let mut scratch = Scratch::default();
        scratch.waiting.push(0);
        self.descend(0, 0, &[0.0; NARROW], &mut scratch, out);
    }

    /// The walk from cell `at` down; `waiting` from `start` on has not acted yet, all else is in `local`.
    fn descend(&self, at: usize, start: usize, local: &Expansion, scratch: &mut Scratch, out: &mut [Action]) {
        let cells = &self.tree.cells;
        let own = &cells[at];
        let end = scratch.waiting.len();
        scratch.far.clear();
        scratch.near.clear();
        scratch.stack.extend(scratch.waiting[start..end].iter().rev());
        let mut coincident = false;
        while let Some(other) = scratch.stack.pop() {
            let cell = &cells[other as usize];
            if other as usize == at {
                coincident = own.reach == 0.0 && own.spheres > 1;
                if !own.is_leaf() {
                    scratch.waiting.extend([at as u32 + 1, second_child(cells, at) as u32]);
                }
            } else if self.far_enough(own, cell) {
                scratch.far.push(other);
            } else if own.is_leaf() && cell.is_leaf() {
                scratch.near.extend(cell.first..cell.end);
            } else if own.is_leaf() || (!cell.is_leaf() && (cell.reach, other) > (own.reach, at as u32)) {
                scratch.stack.extend([second_child(cells, other as usize) as u32, other + 1]);
            } else {
                scratch.waiting.push(other);
            }
        }
        let mut local = *local;
        self.kernels.local(own.centre, &scratch.far, cells, &self.tree.moments, &mut local);
        if coincident {
            // Centres in one place have no acceleration; without this they would be summed pair by pair.
            out.fill(Action::NONE);
        } else if own.is_leaf() {
            self.finish(own, &local, scratch, out);
        } else {
            let children = [at + 1, second_child(cells, at)];
            let locals = children.map(|child| {
                let mut shifted = [0.0; NARROW];
                let shift = [0, 1, 2].map(|k| cells[child].centre[k] - own.centre[k]);
                self.kernels.shift_local(&local, shift, &mut shifted);
                shifted
            });
            let (left, right) = out.split_at_mut((cells[children[0]].end - own.first) as usize);
            if left.len() >= PARALLEL_BLOCKS {
                let mut other = Scratch { waiting: scratch.waiting[end..].to_vec(), ..Scratch::default() };
                rayon::join(
                    || self.descend(children[0], end, &locals[0], scratch, left),
                    || self.descend(children[1], 0, &locals[1], &mut other, right),
                );
            } else {
                self.descend(children[0], end, &locals[0], scratch, left);
                self.descend(children[1], end, &locals[1], scratch, right);
            }
        }
        scratch.waiting.truncate(end);
    }

    /// What acts on the spheres of a leaf.
    fn finish(&self, own: &Cell, local: &Expansion, scratch: &mut Scratch, out: &mut [Action]) {
        let blocks = &self.tree.blocks;
        let (near, far_blocks) = (&mut scratch.near, own.first..own.end);
        let foreign = near.len();
        for (block, out) in far_blocks.clone().zip(out) {
            near.truncate(foreign);
            near.extend(far_blocks.clone().filter(|b| *b != block));
            *out = Action::default();
            self.kernels.near(self.depth, blocks, block as usize, near, out);
            self.kernels.apply(&blocks[block as usize], own.centre, local, out);
        }
    }

    /// Whether two cells may act on each other by expansion.
    fn far_enough(&self, one: &Cell, other: &Cell) -> bool {
        let d = [0, 1, 2].map(|k| one.centre[k] - other.centre[k]);
        let reach = one.reach + other.reach;
        reach * reach <= self.opening * self.opening * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
    }
}
