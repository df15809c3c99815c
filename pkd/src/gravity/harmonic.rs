//! Harmonic polynomials and the derivatives of 1/r in Cartesian components, as few as there can be.
//!
//! Where r ≠ 0 the derivatives of 1/r obey ∂z² = -∂x² - ∂y², so of order n only the 2n + 1 components with at most one ∂z
//! are needed. Three kinds of things are stored that way: moments and powers (polynomials modulo x² + y² + z²), the
//! derivatives themselves, and local expansions, which are sums of derivatives. One contraction serves the shift from
//! moments to a local expansion and the shift of local expansions, one product the shift of moments.
//! Expansions end at a total order `P` counted over both ends (Dehnen 2002, J. Comput. Phys. 179, 27), so that the
//! forces between any two spheres are opposite and equal.
//!
//! The functions here are compiled for an instruction set by being inlined into the kernels that call them; all are
//! `unsafe` for that reason alone, as [`Lanes`] is.

// Orders are constants here, and some bodies are never reached.
#![allow(clippy::absurd_extreme_comparisons, clippy::reversed_empty_ranges)]

use super::lanes::Lanes;

/// Highest order of an expansion.
pub(super) const MAX_ORDER: usize = 8;
/// Components up to [`MAX_ORDER`] with at most one z.
pub(super) const NARROW: usize = narrow_len(MAX_ORDER);
/// Components up to [`MAX_ORDER`] with at most two z.
pub(super) const WIDE: usize = wide_at(MAX_ORDER + 1, 0, 0);

/// Number of components with at most one z up to `order`.
pub(super) const fn narrow_len(order: usize) -> usize {
    (order + 1) * (order + 1)
}

/// Place of the component of order `n` with `b` times y and `c` ≤ 1 times z.
const fn narrow_at(n: usize, c: usize, b: usize) -> usize {
    n * n + c * (n + 1) + b
}

/// Place of the component of order `n` with `b` times y and `c` ≤ 2 times z.
const fn wide_at(n: usize, c: usize, b: usize) -> usize {
    if n == 0 { b } else { 1 + 3 * n * (n - 1) / 2 + [0, n + 1, 2 * n + 1][c] + b }
}

/// Writes a block once for each order, so that the compiler sees the order as a constant and unrolls what is in it.
macro_rules! for_each_order {
    ($n:ident, $body:block) => {
        for_each_order!($n, $body, 0, 1, 2, 3, 4, 5, 6, 7, 8)
    };
    ($n:ident, $body:block, $($value:literal),*) => {
        $({
            const $n: usize = $value;
            $body
        })*
    };
}

/// The powers sⁿ/n! up to order `P`, narrow.
#[inline(always)]
pub(super) unsafe fn powers<V: Lanes, const P: usize>(s: [V; 3], out: &mut [V; NARROW]) {
    unsafe {
        out[0] = V::splat(1.0);
        for_each_order!(N, {
            if N > 0 && N <= P {
                let share = V::splat(1.0 / N as f64);
                let (x, y, z) = (s[0].times(share), s[1].times(share), s[2].times(share));
                for b in 0..=N {
                    let mut sum = V::splat(0.0);
                    if b < N {
                        sum = x.times_plus(out[narrow_at(N - 1, 0, b)], sum);
                    }
                    if b > 0 {
                        sum = y.times_plus(out[narrow_at(N - 1, 0, b - 1)], sum);
                    }
                    // z² = -x² - y².
                    if b + 2 <= N {
                        sum = z.times_from(out[narrow_at(N - 1, 1, b)], sum);
                    }
                    if b >= 2 {
                        sum = z.times_from(out[narrow_at(N - 1, 1, b - 2)], sum);
                    }
                    out[narrow_at(N, 0, b)] = sum;
                }
                for b in 0..N {
                    let mut sum = z.times(out[narrow_at(N - 1, 0, b)]);
                    if b + 1 < N {
                        sum = x.times_plus(out[narrow_at(N - 1, 1, b)], sum);
                    }
                    if b > 0 {
                        sum = y.times_plus(out[narrow_at(N - 1, 1, b - 1)], sum);
                    }
                    out[narrow_at(N, 1, b)] = sum;
                }
            }
        });
    }
}

/// The derivatives of 1/r at `r`, whose inverse length is `inverse`, up to order `P`, wide.
///
/// McMurchie and Davidson 1978 (J. Comput. Phys. 26, 218): with the functions (-1)ʲ (2j - 1)!! / r^(2j + 1) at order 0,
/// each derivative is r_k times one of the next function, plus a multiple of one two orders lower.
#[inline(always)]
pub(super) unsafe fn derivatives<V: Lanes, const P: usize>(r: [V; 3], inverse: V, out: &mut [V; WIDE]) {
    unsafe {
        let square = inverse.times(inverse);
        let mut start = [inverse; MAX_ORDER + 1];
        for j in 1..=P {
            start[j] = start[j - 1].times(square).times(V::splat(1.0 - 2.0 * j as f64));
        }
        for_each_order!(LEVEL, {
            if LEVEL <= P {
                // After this level the orders up to LEVEL belong to function P - LEVEL.
                for_each_order!(BELOW, {
                    if BELOW < LEVEL {
                        raise::<V>(r, LEVEL - BELOW, out);
                    }
                });
                out[0] = start[P - LEVEL];
            }
        });
        widen::<V, P>(out);
    }
}

/// Order `n` of one function from the orders n - 1 and n - 2 of the next.
#[inline(always)]
unsafe fn raise<V: Lanes>([x, y, z]: [V; 3], n: usize, out: &mut [V; WIDE]) {
    unsafe {
        for b in 0..n {
            out[wide_at(n, 1, b)] = z.times(out[wide_at(n - 1, 0, b)]);
        }
        for b in (1..=n).rev() {
            let mut value = y.times(out[wide_at(n - 1, 0, b - 1)]);
            if b >= 2 {
                value = V::splat((b - 1) as f64).times_plus(out[wide_at(n - 2, 0, b - 2)], value);
            }
            out[wide_at(n, 0, b)] = value;
        }
        let mut value = x.times(out[wide_at(n - 1, 0, 0)]);
        if n >= 2 {
            value = V::splat((n - 1) as f64).times_plus(out[wide_at(n - 2, 0, 0)], value);
        }
        out[wide_at(n, 0, 0)] = value;
    }
}

/// Fills in the components with two z.
#[inline(always)]
unsafe fn widen<V: Lanes, const P: usize>(out: &mut [V; WIDE]) {
    unsafe {
        for_each_order!(N, {
            if N >= 2 && N <= P {
                for b in 0..N - 1 {
                    let sum = out[wide_at(N, 0, b)].plus(out[wide_at(N, 0, b + 2)]);
                    out[wide_at(N, 2, b)] = V::splat(0.0).minus(sum);
                }
            }
        });
    }
}

/// A local expansion with the components with two z.
#[inline(always)]
pub(super) unsafe fn widened<V: Lanes, const P: usize>(narrow: &[V; NARROW], out: &mut [V; WIDE]) {
    unsafe {
        for_each_order!(N, {
            if N <= P {
                for c in 0..2 {
                    for b in 0..(N + 1 - c) {
                        out[wide_at(N, c, b)] = narrow[narrow_at(N, c, b)];
                    }
                }
            }
        });
        widen::<V, P>(out);
    }
}

/// Adds Σ_n factor_n derivative_(m + n) over n + m ≤ `P` to `out`_m.
#[inline(always)]
pub(super) unsafe fn contract<V: Lanes, const P: usize>(
    factor: &[V; NARROW],
    derivative: &[V; WIDE],
    out: &mut [V; NARROW],
) {
    unsafe {
        for_each_order!(M, {
            for_each_order!(N, {
                if M + N <= P {
                    contract_orders::<V>(M, N, factor, derivative, out);
                }
            });
        });
    }
}

#[inline(always)]
unsafe fn contract_orders<V: Lanes>(
    m: usize,
    n: usize,
    factor: &[V; NARROW],
    derivative: &[V; WIDE],
    out: &mut [V; NARROW],
) {
    unsafe {
        for cm in 0..2 {
            for bm in 0..(m + 1 - cm) {
                let mut sum = out[narrow_at(m, cm, bm)];
                for cn in 0..2 {
                    for bn in 0..(n + 1 - cn) {
                        let d = derivative[wide_at(m + n, cm + cn, bm + bn)];
                        sum = factor[narrow_at(n, cn, bn)].times_plus(d, sum);
                    }
                }
                out[narrow_at(m, cm, bm)] = sum;
            }
        }
    }
}

/// Adds the product of two polynomials up to order `P` to `out`.
#[inline(always)]
pub(super) unsafe fn multiply<V: Lanes, const P: usize>(one: &[V; NARROW], other: &[V; NARROW], out: &mut [V; NARROW]) {
    unsafe {
        for_each_order!(M, {
            for_each_order!(N, {
                if M + N <= P {
                    multiply_orders::<V>(M, N, one, other, out);
                }
            });
        });
    }
}

#[inline(always)]
unsafe fn multiply_orders<V: Lanes>(m: usize, n: usize, one: &[V; NARROW], other: &[V; NARROW], out: &mut [V; NARROW]) {
    unsafe {
        for cm in 0..2 {
            for bm in 0..(m + 1 - cm) {
                for cn in 0..2 {
                    for bn in 0..(n + 1 - cn) {
                        let (p, q) = (one[narrow_at(m, cm, bm)], other[narrow_at(n, cn, bn)]);
                        if cm + cn < 2 {
                            let sum = &mut out[narrow_at(m + n, cm + cn, bm + bn)];
                            *sum = p.times_plus(q, *sum);
                        } else {
                            // z² = -x² - y².
                            for b in [bm + bn, bm + bn + 2] {
                                let sum = &mut out[narrow_at(m + n, 0, b)];
                                *sum = p.times_from(q, *sum);
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Value and gradient of a local expansion at a place whose powers are given.
#[inline(always)]
pub(super) unsafe fn evaluate<V: Lanes, const P: usize>(power: &[V; NARROW], local: &[V; WIDE]) -> [V; 4] {
    unsafe {
        let mut sum = [V::splat(0.0); 4];
        for_each_order!(N, {
            if N <= P {
                for c in 0..2 {
                    for b in 0..(N + 1 - c) {
                        let f = power[narrow_at(N, c, b)];
                        sum[3] = f.times_plus(local[wide_at(N, c, b)], sum[3]);
                        if N < P {
                            sum[0] = f.times_plus(local[wide_at(N + 1, c, b)], sum[0]);
                            sum[1] = f.times_plus(local[wide_at(N + 1, c, b + 1)], sum[1]);
                            sum[2] = f.times_plus(local[wide_at(N + 1, c + 1, b)], sum[2]);
                        }
                    }
                }
            }
        });
        sum
    }
}
