//! The pair sum itself: a row of spheres against the blocks after it, in vector registers or plain.
//!
//! Each pair is computed once and acts on both members. The vector kernels guess 1/r in `f32` (square root and
//! division are correctly rounded, so every processor guesses alike) and sharpen its cube by one third-order step,
//! 1/r³ = y³ (1 - e)^(-3/2) = y³ (1 + 3e/2 + 15e²/8 + ...), e = 1 - r² y²: since |e| < 2⁻²¹, what is left out is far
//! below the round-off of `f64`.

use super::field::{BLOCK, Blocks3, Field};

/// Adds to `acc` what the pairs (i, j), i in the blocks `rows`, j > i, do to both members.
///
/// `acc` starts at the block `rows.start`.
pub(super) type Kernel = fn(field: &Field, rows: std::ops::Range<usize>, acc: &mut Blocks3);

/// The fastest kernel for this processor.
pub(super) fn fastest() -> Kernel {
    #[cfg(target_arch = "x86_64")]
    {
        if std::arch::is_x86_feature_detected!("avx512f") {
            return x86::avx512;
        }
        if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
            return x86::avx2;
        }
    }
    plain
}

/// All kernels that this processor can run.
#[cfg(test)]
pub(super) fn available() -> Vec<Kernel> {
    let mut kernels: Vec<Kernel> = vec![plain];
    #[cfg(target_arch = "x86_64")]
    {
        if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
            kernels.push(x86::avx2);
        }
        if std::arch::is_x86_feature_detected!("avx512f") {
            kernels.push(x86::avx512);
        }
    }
    kernels
}

/// One pair at a time; the oracle of the other kernels.
pub(super) fn plain(field: &Field, rows: std::ops::Range<usize>, acc: &mut Blocks3) {
    let first = rows.start;
    for row in rows {
        within_block(field, row, first, acc);
        for column in row + 1..field.blocks() {
            for i in 0..BLOCK {
                for j in 0..BLOCK {
                    pair(field, [row, i], [column, j], first, acc);
                }
            }
        }
    }
}

/// The pairs inside one block, without the massless points.
fn within_block(field: &Field, row: usize, first: usize, acc: &mut Blocks3) {
    let real = BLOCK.min(field.len - row * BLOCK);
    for i in 0..real {
        for j in i + 1..real {
            pair(field, [row, i], [row, j], first, acc);
        }
    }
}

#[inline(always)]
fn pair(field: &Field, [bi, i]: [usize; 2], [bj, j]: [usize; 2], first: usize, acc: &mut Blocks3) {
    let at = &field.at;
    let d = [&at.x, &at.y, &at.z].map(|c| c[bj].0[j] - c[bi].0[i]);
    let r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    let inverse_cube = 1.0 / (r2 * r2.sqrt());
    let on_i = field.strength[bj].0[j] * inverse_cube;
    let on_j = field.strength[bi].0[i] * inverse_cube;
    for (acc, d) in [&mut acc.x, &mut acc.y, &mut acc.z].into_iter().zip(d) {
        acc[bi - first].0[i] += on_i * d;
        acc[bj - first].0[j] -= on_j * d;
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;
    use std::ops::Range;

    use super::super::field::Block;
    use super::*;

    /// A vector register of `f64`.
    ///
    /// # Safety
    /// All functions need the instruction set of the implementing type, and must be inlined into a function that is
    /// compiled for it. `load` and `store` want `LANES` values that are aligned like a [`Block`].
    trait Lanes: Copy {
        const LANES: usize;
        unsafe fn splat(value: f64) -> Self;
        unsafe fn load(from: *const f64) -> Self;
        unsafe fn store(self, to: *mut f64);
        unsafe fn minus(self, other: Self) -> Self;
        unsafe fn times(self, other: Self) -> Self;
        /// self · factor + addend.
        unsafe fn times_plus(self, factor: Self, addend: Self) -> Self;
        /// addend - self · factor.
        unsafe fn times_from(self, factor: Self, addend: Self) -> Self;
        /// 1/√self in single precision.
        unsafe fn inverse_root_guess(self) -> Self;
    }

    impl Lanes for __m512d {
        const LANES: usize = 8;
        #[inline(always)]
        unsafe fn splat(value: f64) -> Self {
            unsafe { _mm512_set1_pd(value) }
        }
        #[inline(always)]
        unsafe fn load(from: *const f64) -> Self {
            unsafe { _mm512_load_pd(from) }
        }
        #[inline(always)]
        unsafe fn store(self, to: *mut f64) {
            unsafe { _mm512_store_pd(to, self) }
        }
        #[inline(always)]
        unsafe fn minus(self, other: Self) -> Self {
            unsafe { _mm512_sub_pd(self, other) }
        }
        #[inline(always)]
        unsafe fn times(self, other: Self) -> Self {
            unsafe { _mm512_mul_pd(self, other) }
        }
        #[inline(always)]
        unsafe fn times_plus(self, factor: Self, addend: Self) -> Self {
            unsafe { _mm512_fmadd_pd(self, factor, addend) }
        }
        #[inline(always)]
        unsafe fn times_from(self, factor: Self, addend: Self) -> Self {
            unsafe { _mm512_fnmadd_pd(self, factor, addend) }
        }
        #[inline(always)]
        unsafe fn inverse_root_guess(self) -> Self {
            unsafe { _mm512_cvtps_pd(_mm256_div_ps(_mm256_set1_ps(1.0), _mm256_sqrt_ps(_mm512_cvtpd_ps(self)))) }
        }
    }

    impl Lanes for __m256d {
        const LANES: usize = 4;
        #[inline(always)]
        unsafe fn splat(value: f64) -> Self {
            unsafe { _mm256_set1_pd(value) }
        }
        #[inline(always)]
        unsafe fn load(from: *const f64) -> Self {
            unsafe { _mm256_load_pd(from) }
        }
        #[inline(always)]
        unsafe fn store(self, to: *mut f64) {
            unsafe { _mm256_store_pd(to, self) }
        }
        #[inline(always)]
        unsafe fn minus(self, other: Self) -> Self {
            unsafe { _mm256_sub_pd(self, other) }
        }
        #[inline(always)]
        unsafe fn times(self, other: Self) -> Self {
            unsafe { _mm256_mul_pd(self, other) }
        }
        #[inline(always)]
        unsafe fn times_plus(self, factor: Self, addend: Self) -> Self {
            unsafe { _mm256_fmadd_pd(self, factor, addend) }
        }
        #[inline(always)]
        unsafe fn times_from(self, factor: Self, addend: Self) -> Self {
            unsafe { _mm256_fnmadd_pd(self, factor, addend) }
        }
        #[inline(always)]
        unsafe fn inverse_root_guess(self) -> Self {
            unsafe { _mm256_cvtps_pd(_mm_div_ps(_mm_set1_ps(1.0), _mm_sqrt_ps(_mm256_cvtpd_ps(self)))) }
        }
    }

    pub fn avx512(field: &Field, rows: Range<usize>, acc: &mut Blocks3) {
        #[target_feature(enable = "avx512f,avx2,fma")]
        unsafe fn compiled(field: &Field, rows: Range<usize>, acc: &mut Blocks3) {
            unsafe { sum::<__m512d, 4>(field, rows, acc) }
        }
        assert!(std::arch::is_x86_feature_detected!("avx512f"), "chosen for processors that have it");
        // SAFETY: the line above; AVX-512 processors have AVX2 and FMA.
        unsafe { compiled(field, rows, acc) }
    }

    pub fn avx2(field: &Field, rows: Range<usize>, acc: &mut Blocks3) {
        #[target_feature(enable = "avx2,fma")]
        unsafe fn compiled(field: &Field, rows: Range<usize>, acc: &mut Blocks3) {
            unsafe { sum::<__m256d, 2>(field, rows, acc) }
        }
        assert!(
            std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma"),
            "chosen for processors that have it"
        );
        // SAFETY: the line above.
        unsafe { compiled(field, rows, acc) }
    }

    /// The kernel, `ROWS` spheres at a time so that the partners' accelerations are loaded and stored less often.
    ///
    /// # Safety
    /// That of [`Lanes`].
    #[inline(always)]
    unsafe fn sum<V: Lanes, const ROWS: usize>(field: &Field, rows: Range<usize>, acc: &mut Blocks3) {
        let (first, blocks) = (rows.start, field.blocks());
        assert!(rows.end <= blocks && acc.x.len() == blocks - first, "one block of accelerations per block of spheres");
        assert!(acc.y.len() == acc.x.len() && acc.z.len() == acc.x.len());
        for row in rows {
            within_block(field, row, first, acc);
            for i in (0..BLOCK).step_by(ROWS) {
                // SAFETY: the caller's; row < blocks, and all arrays have `blocks` blocks or as many as follow `first`.
                let sums = unsafe { against_later_blocks::<V, ROWS>(field, row, i, first, acc) };
                for (k, [x, y, z]) in sums.into_iter().enumerate() {
                    acc.x[row - first].0[i + k] += x;
                    acc.y[row - first].0[i + k] += y;
                    acc.z[row - first].0[i + k] += z;
                }
            }
        }
    }

    #[inline(always)]
    unsafe fn against_later_blocks<V: Lanes, const ROWS: usize>(
        field: &Field,
        row: usize,
        i: usize,
        first: usize,
        acc: &mut Blocks3,
    ) -> [[f64; 3]; ROWS] {
        let from = |array: &[Block]| array[row + 1..].as_ptr().cast::<f64>();
        let (xj, yj, zj, gj) = (from(&field.at.x), from(&field.at.y), from(&field.at.z), from(&field.strength));
        let to = |array: &mut [Block]| array[row + 1 - first..].as_mut_ptr().cast::<f64>();
        let (axj, ayj, azj) = (to(&mut acc.x), to(&mut acc.y), to(&mut acc.z));
        let of_row = |array: &[Block], k: usize| array[row].0[i + k];
        unsafe {
            let own: [[V; 4]; ROWS] = std::array::from_fn(|k| {
                [&field.at.x, &field.at.y, &field.at.z, &field.strength].map(|a| V::splat(of_row(a, k)))
            });
            let mut sums = [[V::splat(0.0); 3]; ROWS];
            let (one, three_halves, fifteen_eighths) = (V::splat(1.0), V::splat(1.5), V::splat(1.875));
            for at in (0..(field.blocks() - row - 1) * BLOCK).step_by(V::LANES) {
                let (x, y, z, g) = (V::load(xj.add(at)), V::load(yj.add(at)), V::load(zj.add(at)), V::load(gj.add(at)));
                let (mut ax, mut ay, mut az) = (V::load(axj.add(at)), V::load(ayj.add(at)), V::load(azj.add(at)));
                for (own, sum) in own.iter().zip(&mut sums) {
                    let (dx, dy, dz) = (x.minus(own[0]), y.minus(own[1]), z.minus(own[2]));
                    let r2 = dx.times_plus(dx, dy.times_plus(dy, dz.times(dz)));
                    let guess = r2.inverse_root_guess();
                    let guess2 = guess.times(guess);
                    let e = r2.times_from(guess2, one);
                    let cube =
                        guess2.times(guess).times(e.times_plus(e.times_plus(fifteen_eighths, three_halves), one));
                    let (on_own, on_other) = (cube.times(g), cube.times(own[3]));
                    sum[0] = dx.times_plus(on_own, sum[0]);
                    sum[1] = dy.times_plus(on_own, sum[1]);
                    sum[2] = dz.times_plus(on_own, sum[2]);
                    ax = dx.times_from(on_other, ax);
                    ay = dy.times_from(on_other, ay);
                    az = dz.times_from(on_other, az);
                }
                ax.store(axj.add(at));
                ay.store(ayj.add(at));
                az.store(azj.add(at));
            }
            sums.map(|components| components.map(|v| total(v)))
        }
    }

    /// Sum over the lanes, in order.
    #[inline(always)]
    unsafe fn total<V: Lanes>(v: V) -> f64 {
        let mut lanes = Block::default();
        unsafe { v.store(lanes.0.as_mut_ptr()) };
        lanes.0[..V::LANES].iter().sum()
    }
}
