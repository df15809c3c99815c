//! The pull of listed blocks on the spheres of one block, pair by pair, each pair seen from one side.
//!
//! Arithmetic of [`super::kernel`]. Seen from both sides a pair would cost little more than from one, but then two
//! threads would write to the same sphere; here every block is written by the one that owns it.

// Indices, as the closures of iterators would be compiled for the instruction set of the crate and called.
#![allow(clippy::needless_range_loop)]

use super::field::{BLOCK, Pull, Sources};
use super::lanes::{Eight, total};

/// What acts on the spheres of a block.
#[derive(Debug, Clone, Copy, Default)]
#[repr(C, align(64))]
pub(super) struct Action {
    /// Accelerations.
    pub pull: Pull,
    /// Potentials with the sign changed; left alone where they were not asked for.
    pub depth: [f64; BLOCK],
}

impl Action {
    /// What acts on spheres in one and the same place.
    pub const NONE: Self = Self { pull: Pull([[f64::NAN; BLOCK]; 3]), depth: [f64::NAN; BLOCK] };
}

/// Ones on the diagonal: row `i` singles out sphere `i` of its block.
#[repr(C, align(64))]
struct Diagonal([[f64; BLOCK]; BLOCK]);

static DIAGONAL: Diagonal = {
    let mut rows = [[0.0; BLOCK]; BLOCK];
    let mut i = 0;
    while i < BLOCK {
        rows[i][i] = 1.0;
        i += 1;
    }
    Diagonal(rows)
};

/// Adds to `out` what the blocks `list` and the other spheres of block `own` do to the spheres of block `own`.
///
/// # Safety
/// That of [`Lanes`](super::lanes::Lanes).
#[inline(always)]
pub(super) unsafe fn block<V: Eight, const ROWS: usize, const DEPTH: bool>(
    blocks: &[Sources],
    own: usize,
    list: &[u32],
    out: &mut Action,
) {
    for row in (0..BLOCK).step_by(ROWS) {
        // SAFETY: the caller's.
        unsafe {
            let mut sums = [[V::splat(0.0); 4]; ROWS];
            let mut targets = [[0.0; 3]; ROWS];
            for k in 0..ROWS {
                targets[k] = place(blocks, [own, row + k]);
                inside::<V, DEPTH>(blocks, [own, row + k], &mut sums[k]);
            }
            others::<V, ROWS, DEPTH>(blocks, targets, list.iter().map(|b| *b as usize), &mut sums);
            for k in 0..ROWS {
                for c in 0..3 {
                    out.pull.0[c][row + k] += total(sums[k][c]);
                }
                out.depth[row + k] += total(sums[k][3]);
            }
        }
    }
}

/// Acceleration and depth of four spheres, each given by block and row, by all others.
///
/// # Safety
/// That of [`Lanes`](super::lanes::Lanes).
#[inline(always)]
pub(super) unsafe fn four<V: Eight>(blocks: &[Sources], spheres: [[usize; 2]; 4]) -> [[f64; 4]; 4] {
    let mut own = spheres.map(|[b, _]| b);
    own.sort_unstable();
    // SAFETY: the caller's.
    unsafe {
        let mut sums = [[V::splat(0.0); 4]; 4];
        let mut targets = [[0.0; 3]; 4];
        for k in 0..4 {
            targets[k] = place(blocks, spheres[k]);
        }
        let mut next = 0;
        for b in own {
            others::<V, 4, true>(blocks, targets, next..b, &mut sums);
            next = next.max(b + 1);
        }
        others::<V, 4, true>(blocks, targets, next..blocks.len(), &mut sums);
        let mut totals = [[0.0; 4]; 4];
        for k in 0..4 {
            inside::<V, true>(blocks, spheres[k], &mut sums[k]);
            for i in 0..4 {
                if own[i] != spheres[k][0] && (i == 0 || own[i] != own[i - 1]) {
                    let mut sum = [sums[k]];
                    others::<V, 1, true>(blocks, [targets[k]], own[i]..own[i] + 1, &mut sum);
                    sums[k] = sum[0];
                }
            }
            for c in 0..4 {
                totals[k][c] = total(sums[k][c]);
            }
        }
        totals
    }
}

fn place(blocks: &[Sources], [b, row]: [usize; 2]) -> [f64; 3] {
    [blocks[b].at[0][row], blocks[b].at[1][row], blocks[b].at[2][row]]
}

/// Adds what the other spheres of its block do to one.
///
/// # Safety
/// That of [`Lanes`](super::lanes::Lanes).
#[inline(always)]
unsafe fn inside<V: Eight, const DEPTH: bool>(blocks: &[Sources], [b, row]: [usize; 2], sums: &mut [V; 4]) {
    unsafe {
        let [x, y, z] = place(blocks, [b, row]);
        let target = [V::splat(x), V::splat(y), V::splat(z)];
        let itself = V::load(DIAGONAL.0[row].as_ptr());
        add::<V, true, DEPTH>(&blocks[b], target, itself, sums);
    }
}

/// Adds what the blocks `list` do to spheres outside them.
///
/// # Safety
/// That of [`Lanes`](super::lanes::Lanes).
#[inline(always)]
unsafe fn others<V: Eight, const ROWS: usize, const DEPTH: bool>(
    blocks: &[Sources],
    targets: [[f64; 3]; ROWS],
    list: impl Iterator<Item = usize>,
    sums: &mut [[V; 4]; ROWS],
) {
    unsafe {
        let zero = V::splat(0.0);
        let mut target = [[zero; 3]; ROWS];
        for k in 0..ROWS {
            for c in 0..3 {
                target[k][c] = V::splat(targets[k][c]);
            }
        }
        // A copy, so that it stays in registers.
        let mut sum = *sums;
        for b in list {
            for k in 0..ROWS {
                add::<V, false, DEPTH>(&blocks[b], target[k], zero, &mut sum[k]);
            }
        }
        *sums = sum;
    }
}

/// Adds the pull of one block of spheres; with `OWN`, without the one that `itself` singles out.
///
/// # Safety
/// That of [`Lanes`](super::lanes::Lanes).
#[inline(always)]
unsafe fn add<V: Eight, const OWN: bool, const DEPTH: bool>(
    source: &Sources,
    target: [V; 3],
    itself: V,
    sums: &mut [V; 4],
) {
    unsafe {
        let one = V::splat(1.0);
        let dx = V::load(source.at[0].as_ptr()).minus(target[0]);
        let dy = V::load(source.at[1].as_ptr()).minus(target[1]);
        let dz = V::load(source.at[2].as_ptr()).minus(target[2]);
        let mut strength = V::load(source.strength.as_ptr());
        let mut r2 = dx.times_plus(dx, dy.times_plus(dy, dz.times(dz)));
        if OWN {
            // Its distance becomes one and its strength zero.
            r2 = r2.plus(itself);
            strength = itself.times_from(strength, strength);
        }
        let guess = r2.inverse_root_guess();
        let guess2 = guess.times(guess);
        let e = r2.times_from(guess2, one);
        let series = e.times_plus(e.times_plus(V::splat(1.875), V::splat(1.5)), one);
        let pull = guess2.times(guess).times(series).times(strength);
        sums[0] = dx.times_plus(pull, sums[0]);
        sums[1] = dy.times_plus(pull, sums[1]);
        sums[2] = dz.times_plus(pull, sums[2]);
        if DEPTH {
            let series = e.times_plus(e.times_plus(V::splat(0.375), V::splat(0.5)), one);
            sums[3] = guess.times(series).times_plus(strength, sums[3]);
        }
    }
}
