//! Vector registers of `f64` behind one trait, so that one text of a kernel serves every instruction set.

use super::field::Pull;

/// A vector register of `f64`.
///
/// # Safety
/// All functions need the instruction set of the implementing type, and must be inlined into a function that is
/// compiled for it. `load` and `store` want `LANES` values that are aligned like a [`Pull`].
pub(super) trait Lanes: Copy {
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
    unsafe fn plus(self, other: Self) -> Self;
    /// 1/√self in single precision.
    unsafe fn inverse_root_guess(self) -> Self;
    /// Sum over the lanes, in order.
    #[inline(always)]
    unsafe fn total(self) -> f64 {
        let mut lanes = Pull::default();
        unsafe { self.store(lanes.0[0].as_mut_ptr()) };
        lanes.0[0][..Self::LANES].iter().sum()
    }
}

/// One lane, for processors without wide registers; products are not fused, which would be a call into a library there.
impl Lanes for f64 {
    const LANES: usize = 1;
    #[inline(always)]
    unsafe fn splat(value: f64) -> Self {
        value
    }
    #[inline(always)]
    unsafe fn load(from: *const f64) -> Self {
        unsafe { *from }
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut f64) {
        unsafe { *to = self }
    }
    #[inline(always)]
    unsafe fn plus(self, other: Self) -> Self {
        self + other
    }
    #[inline(always)]
    unsafe fn minus(self, other: Self) -> Self {
        self - other
    }
    #[inline(always)]
    unsafe fn times(self, other: Self) -> Self {
        self * other
    }
    #[inline(always)]
    unsafe fn times_plus(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }
    #[inline(always)]
    unsafe fn times_from(self, factor: Self, addend: Self) -> Self {
        addend - self * factor
    }
    #[inline(always)]
    unsafe fn inverse_root_guess(self) -> Self {
        f64::from(1.0 / (self as f32).sqrt())
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use super::Lanes;

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
        unsafe fn plus(self, other: Self) -> Self {
            unsafe { _mm512_add_pd(self, other) }
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
        unsafe fn plus(self, other: Self) -> Self {
            unsafe { _mm256_add_pd(self, other) }
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
}
