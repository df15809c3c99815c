//! Expansions of cells: moments of their spheres, the field of far cells around their centres, and that at the spheres.

// Indices, as the closures of iterators would be compiled for the instruction set of the crate and called.
#![allow(clippy::needless_range_loop)]

use super::field::{BLOCK, Sources};
use super::harmonic::{NARROW, WIDE, contract, derivatives, evaluate, multiply, narrow_len, powers, widened};
use super::lanes::{Eight, total};
use super::near::Action;
use super::tree::Cell;

/// Moments or local expansion of one cell; only the first (order + 1)² are in use.
pub(super) type Expansion = [f64; NARROW];

/// Adds the moments of `blocks` about `centre` to `out`: Σ strength (centre - x)ⁿ/n!.
///
/// # Safety
/// That of [`Lanes`](super::lanes::Lanes).
#[inline(always)]
pub(super) unsafe fn moments<V: Eight, const P: usize>(blocks: &[Sources], centre: [f64; 3], out: &mut Expansion) {
    unsafe {
        let zero = V::splat(0.0);
        let (mut sum, mut power) = ([zero; NARROW], [zero; NARROW]);
        let centre = [V::splat(centre[0]), V::splat(centre[1]), V::splat(centre[2])];
        for block in blocks {
            let mut s = centre;
            for k in 0..3 {
                s[k] = s[k].minus(V::load(block.at[k].as_ptr()));
            }
            powers::<V, P>(s, &mut power);
            let strength = V::load(block.strength.as_ptr());
            for k in 0..narrow_len(P) {
                sum[k] = power[k].times_plus(strength, sum[k]);
            }
        }
        for k in 0..narrow_len(P) {
            out[k] += total(sum[k]);
        }
    }
}

/// Adds moments about a centre that lies `shift` from the new one to `out`.
///
/// # Safety
/// That of [`Lanes`](super::lanes::Lanes).
#[inline(always)]
pub(super) unsafe fn shift_moments<const P: usize>(moments: &[f64], shift: [f64; 3], out: &mut Expansion) {
    unsafe {
        let (mut power, mut from) = ([0.0; NARROW], [0.0; NARROW]);
        from[..moments.len()].copy_from_slice(moments);
        powers::<f64, P>([-shift[0], -shift[1], -shift[2]], &mut power);
        multiply::<f64, P>(&from, &power, out);
    }
}

/// The local expansion at `shift` from the centre of `local`.
///
/// # Safety
/// That of [`Lanes`](super::lanes::Lanes).
#[inline(always)]
pub(super) unsafe fn shift_local<const P: usize>(local: &Expansion, shift: [f64; 3], out: &mut Expansion) {
    unsafe {
        let (mut power, mut wide) = ([0.0; NARROW], [0.0; WIDE]);
        powers::<f64, P>(shift, &mut power);
        widened::<f64, P>(local, &mut wide);
        contract::<f64, P>(&power, &wide, out);
    }
}

/// Eight cells.
#[repr(C, align(64))]
struct Batch {
    offset: [[f64; BLOCK]; 3],
    moments: [[f64; BLOCK]; NARROW],
}

/// Adds the field of the cells `list` around `centre` to `out`.
///
/// # Safety
/// That of [`Lanes`](super::lanes::Lanes).
#[inline(always)]
pub(super) unsafe fn local<V: Eight, const P: usize>(
    centre: [f64; 3],
    list: &[u32],
    cells: &[Cell],
    expansions: &[f64],
    out: &mut Expansion,
) {
    unsafe {
        let (zero, one) = (V::splat(0.0), V::splat(1.0));
        let (mut sum, mut moment, mut derivative) = ([zero; NARROW], [zero; NARROW], [zero; WIDE]);
        let mut batch = Batch { offset: [[0.0; BLOCK]; 3], moments: [[0.0; BLOCK]; NARROW] };
        let stride = narrow_len(P);
        for chunk in list.chunks(BLOCK) {
            for (lane, &cell) in chunk.iter().enumerate() {
                let from = cells[cell as usize].centre;
                for k in 0..3 {
                    batch.offset[k][lane] = centre[k] - from[k];
                }
                let moments = &expansions[cell as usize * stride..][..stride];
                for k in 0..stride {
                    batch.moments[k][lane] = moments[k];
                }
            }
            for lane in chunk.len()..BLOCK {
                batch.offset[0][lane] = 1.0;
                for k in 0..stride {
                    batch.moments[k][lane] = 0.0;
                }
            }
            let r = [
                V::load(batch.offset[0].as_ptr()),
                V::load(batch.offset[1].as_ptr()),
                V::load(batch.offset[2].as_ptr()),
            ];
            let r2 = r[0].times_plus(r[0], r[1].times_plus(r[1], r[2].times(r[2])));
            let guess = r2.inverse_root_guess();
            let e = r2.times_from(guess.times(guess), one);
            let inverse = guess.times(e.times_plus(e.times_plus(V::splat(0.375), V::splat(0.5)), one));
            derivatives::<V, P>(r, inverse, &mut derivative);
            for k in 0..stride {
                moment[k] = V::load(batch.moments[k].as_ptr());
            }
            contract::<V, P>(&moment, &derivative, &mut sum);
        }
        for k in 0..stride {
            out[k] += total(sum[k]);
        }
    }
}

/// Adds the field of a local expansion about `centre` at the spheres of `block` to `out`.
///
/// # Safety
/// That of [`Lanes`](super::lanes::Lanes).
#[inline(always)]
pub(super) unsafe fn apply<V: Eight, const P: usize>(
    block: &Sources,
    centre: [f64; 3],
    local: &Expansion,
    out: &mut Action,
) {
    unsafe {
        let zero = V::splat(0.0);
        let (mut power, mut narrow, mut wide) = ([zero; NARROW], [zero; NARROW], [zero; WIDE]);
        for k in 0..narrow_len(P) {
            narrow[k] = V::splat(local[k]);
        }
        widened::<V, P>(&narrow, &mut wide);
        let mut s = [zero; 3];
        for k in 0..3 {
            s[k] = V::load(block.at[k].as_ptr()).minus(V::splat(centre[k]));
        }
        powers::<V, P>(s, &mut power);
        let field = evaluate::<V, P>(&power, &wide);
        for k in 0..3 {
            let to = out.pull.0[k].as_mut_ptr();
            V::load(to).plus(field[k]).store(to);
        }
        let to = out.depth.as_mut_ptr();
        V::load(to).plus(field[3]).store(to);
    }
}
