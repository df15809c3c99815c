//! The pair sum itself: a row of spheres against the blocks after it, eight pairs at a time.
//!
//! Each pair is computed once and acts on both members. The kernels guess 1/r in `f32` (square root and
//! division are correctly rounded, so every processor guesses alike) and sharpen its cube by one third-order step,
//! 1/r³ = y³ (1 - e)^(-3/2) = y³ (1 + 3e/2 + 15e²/8 + ...), e = 1 - r² y²: since |e| < 2⁻²¹, what is left out is far
//! below the round-off of `f64`.

use std::ops::Range;

use super::field::{BLOCK, Field, Pull, Sources};
use super::lanes::{Eight, Plain, total};
use crate::simd::Level;

/// Adds to `acc` what the pairs (i, j), i in the blocks `rows`, j > i, do to both members.
///
/// `acc` starts at the block `rows.start` and reaches to the last.
pub(super) type Kernel = fn(field: &Field, rows: Range<usize>, acc: &mut [Pull]);

/// The kernel that is in use.
pub(super) fn fastest() -> Kernel {
    at(Level::in_use())
}

/// The kernel of a level.
///
/// # Panics
/// When it is called, if the processor cannot run it.
pub(super) fn at(level: Level) -> Kernel {
    match level {
        // SAFETY: plain numbers need no instructions of their own.
        Level::Scalar => |field, rows, acc| unsafe { sum::<Plain, 1>(field, rows, acc) },
        #[cfg(target_arch = "x86_64")]
        Level::Avx2 => x86::avx2,
        #[cfg(target_arch = "x86_64")]
        Level::Avx512 => x86::avx512,
    }
}

/// One pair at a time with a true square root and division; the oracle of the kernels.
#[cfg(test)]
pub(super) fn exact(field: &Field, rows: Range<usize>, acc: &mut [Pull]) {
    let first = rows.start;
    for row in rows {
        within_block(field, row, first, acc);
        for column in row + 1..field.blocks.len() {
            for i in 0..BLOCK {
                for j in 0..BLOCK {
                    pair(field, [row, i], [column, j], first, acc);
                }
            }
        }
    }
}

/// The pairs inside one block, without the massless points.
fn within_block(field: &Field, row: usize, first: usize, acc: &mut [Pull]) {
    let real = BLOCK.min(field.len - row * BLOCK);
    for i in 0..real {
        for j in i + 1..real {
            pair(field, [row, i], [row, j], first, acc);
        }
    }
}

#[inline(always)]
fn pair(field: &Field, [bi, i]: [usize; 2], [bj, j]: [usize; 2], first: usize, acc: &mut [Pull]) {
    let (one, other) = (&field.blocks[bi], &field.blocks[bj]);
    let d = [0, 1, 2].map(|k| other.at[k][j] - one.at[k][i]);
    let r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    let inverse_cube = 1.0 / (r2 * r2.sqrt());
    let (on_one, on_other) = (other.strength[j] * inverse_cube, one.strength[i] * inverse_cube);
    for (k, d) in d.into_iter().enumerate() {
        acc[bi - first].0[k][i] += on_one * d;
        acc[bj - first].0[k][j] -= on_other * d;
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::__m512d;

    use super::super::lanes::Avx2;
    use super::*;

    pub fn avx512(field: &Field, rows: Range<usize>, acc: &mut [Pull]) {
        #[target_feature(enable = "avx512f,avx2,fma")]
        unsafe fn compiled(field: &Field, rows: Range<usize>, acc: &mut [Pull]) {
            unsafe { sum::<__m512d, 4>(field, rows, acc) }
        }
        assert!(Level::Avx512 <= Level::present(), "chosen for processors that have it");
        // SAFETY: the line above; AVX-512 processors have AVX2 and FMA.
        unsafe { compiled(field, rows, acc) }
    }

    pub fn avx2(field: &Field, rows: Range<usize>, acc: &mut [Pull]) {
        #[target_feature(enable = "avx2,fma")]
        unsafe fn compiled(field: &Field, rows: Range<usize>, acc: &mut [Pull]) {
            unsafe { sum::<Avx2, AVX2_ROWS>(field, rows, acc) }
        }
        assert!(Level::Avx2 <= Level::present(), "chosen for processors that have it");
        // SAFETY: the line above.
        unsafe { compiled(field, rows, acc) }
    }
}

/// Eight lanes take two registers of AVX2 each, of which there are sixteen.
#[cfg(target_arch = "x86_64")]
const AVX2_ROWS: usize = 2;

/// The kernel, `ROWS` spheres at a time so that the partners' accelerations are loaded and stored less often.
///
/// # Safety
/// That of [`Lanes`](super::lanes::Lanes).
#[inline(always)]
unsafe fn sum<V: Eight, const ROWS: usize>(field: &Field, rows: Range<usize>, acc: &mut [Pull]) {
    let first = rows.start;
    for row in rows {
        within_block(field, row, first, acc);
        let (done, later) = acc[row - first..].split_at_mut(1);
        for i in (0..BLOCK).step_by(ROWS) {
            let own = std::array::from_fn(|k| Row::of(&field.blocks[row], i + k));
            // SAFETY: the caller's.
            let sums = unsafe { against::<V, ROWS>(own, &field.blocks[row + 1..], later) };
            for (k, sum) in sums.into_iter().enumerate() {
                (0..3).for_each(|component| done[0].0[component][i + k] += sum[component]);
            }
        }
    }
}

/// One sphere: coordinates and strength.
#[derive(Clone, Copy)]
struct Row([f64; 4]);

impl Row {
    fn of(block: &Sources, i: usize) -> Self {
        Self([block.at[0][i], block.at[1][i], block.at[2][i], block.strength[i]])
    }
}

/// Accelerations of the spheres `own` by all `others`, whose own ones are added to `acc`.
///
/// The guess of 1/r has a long latency, so it is made one block ahead of its use.
///
/// # Safety
/// That of [`Lanes`](super::lanes::Lanes).
#[inline(always)]
unsafe fn against<V: Eight, const ROWS: usize>(
    own: [Row; ROWS],
    others: &[Sources],
    acc: &mut [Pull],
) -> [[f64; 3]; ROWS] {
    assert_eq!(others.len(), acc.len());
    let count = others.len();
    if count == 0 {
        return [[0.0; 3]; ROWS];
    }
    // SAFETY: the caller's for the instruction set; v < count.
    unsafe {
        let (one, three_halves, fifteen_eighths) = (V::splat(1.0), V::splat(1.5), V::splat(1.875));
        // Loops, as closures would be compiled for the instruction set of the crate and called.
        let mut target = [[one; 4]; ROWS];
        let mut ahead = [Approach { d: [one; 3], r2: one, guess: one }; ROWS];
        for k in 0..ROWS {
            let Row([x, y, z, strength]) = own[k];
            target[k] = [V::splat(x), V::splat(y), V::splat(z), V::splat(strength)];
            ahead[k] = Approach::of(target[k], others.as_ptr().cast());
        }
        let mut sums = [[V::splat(0.0); 3]; ROWS];
        for v in 0..count {
            let next = others.as_ptr().add((v + 1).min(count - 1)).cast::<f64>();
            let strength = V::load(others.as_ptr().add(v).cast::<f64>().add(3 * BLOCK));
            let pull = acc.as_mut_ptr().add(v).cast::<f64>();
            let mut p = [V::load(pull), V::load(pull.add(BLOCK)), V::load(pull.add(2 * BLOCK))];
            for k in 0..ROWS {
                let Approach { d, r2, guess } = ahead[k];
                ahead[k] = Approach::of(target[k], next);
                let guess2 = guess.times(guess);
                let e = r2.times_from(guess2, one);
                let series = e.times_plus(e.times_plus(fifteen_eighths, three_halves), one);
                let inverse_cube = guess2.times(guess).times(series);
                let (on_own, on_other) = (inverse_cube.times(strength), inverse_cube.times(target[k][3]));
                for c in 0..3 {
                    sums[k][c] = d[c].times_plus(on_own, sums[k][c]);
                    p[c] = d[c].times_from(on_other, p[c]);
                }
            }
            p[0].store(pull);
            p[1].store(pull.add(BLOCK));
            p[2].store(pull.add(2 * BLOCK));
        }
        let mut totals = [[0.0; 3]; ROWS];
        for k in 0..ROWS {
            for c in 0..3 {
                totals[k][c] = total(sums[k][c]);
            }
        }
        totals
    }
}

/// Distance vectors from one sphere to eight others, their squares, and guesses of 1/r.
#[derive(Clone, Copy)]
struct Approach<V> {
    d: [V; 3],
    r2: V,
    guess: V,
}

impl<V: Eight> Approach<V> {
    #[inline(always)]
    unsafe fn of(own: [V; 4], source: *const f64) -> Self {
        unsafe {
            let dx = V::load(source).minus(own[0]);
            let dy = V::load(source.add(BLOCK)).minus(own[1]);
            let dz = V::load(source.add(2 * BLOCK)).minus(own[2]);
            let r2 = dx.times_plus(dx, dy.times_plus(dy, dz.times(dz)));
            Self { d: [dx, dy, dz], r2, guess: r2.inverse_root_guess() }
        }
    }
}
