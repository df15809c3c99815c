//! Eight `f64` at a time behind one trait, so that one text of a kernel serves every instruction set with the same bytes.
//!
//! Eight numbers fill one register of AVX-512, two of AVX2 or NEON, four of SSE2. Products are fused at every level, since most of
//! the time of gravity is in them; without the instruction a library makes them, which rounds alike and takes ten times as long.

use super::field::{BLOCK, Pull};

/// Eight numbers, or one that stands for itself.
///
/// # Safety
/// All functions need the instruction set of the implementing type, and must be inlined into a function that is
/// compiled for it. `load` and `store` want as many values that are aligned like a [`Pull`].
pub(super) trait Lanes: Copy {
    unsafe fn splat(value: f64) -> Self;
    unsafe fn load(from: *const f64) -> Self;
    unsafe fn store(self, to: *mut f64);
    unsafe fn minus(self, other: Self) -> Self;
    unsafe fn times(self, other: Self) -> Self;
    /// self · factor + addend, rounded once.
    unsafe fn times_plus(self, factor: Self, addend: Self) -> Self;
    /// addend - self · factor, rounded once.
    unsafe fn times_from(self, factor: Self, addend: Self) -> Self;
    unsafe fn plus(self, other: Self) -> Self;
    /// 1/√self in single precision.
    unsafe fn inverse_root_guess(self) -> Self;
}

/// Sum of eight lanes, in order.
///
/// # Safety
/// That of [`Lanes`].
#[inline(always)]
pub(super) unsafe fn total<V: Eight>(lanes: V) -> f64 {
    let mut stored = Pull::default();
    unsafe { lanes.store(stored.0[0].as_mut_ptr()) };
    stored.0[0].iter().sum()
}

/// [`Lanes`] that are eight.
pub(super) trait Eight: Lanes {}

/// A single number; the expansions of one cell are shifted with it. Its products are not fused, at no level.
impl Lanes for f64 {
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

/// Eight numbers in whatever registers the compiler finds.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Plain([f64; BLOCK]);

impl Eight for Plain {}

impl Plain {
    #[inline(always)]
    fn by(self, other: Self, of: impl Fn(f64, f64) -> f64) -> Self {
        Self(std::array::from_fn(|k| of(self.0[k], other.0[k])))
    }
}

impl Lanes for Plain {
    #[inline(always)]
    unsafe fn splat(value: f64) -> Self {
        Self([value; BLOCK])
    }
    #[inline(always)]
    unsafe fn load(from: *const f64) -> Self {
        unsafe { *from.cast() }
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut f64) {
        unsafe { *to.cast() = self }
    }
    #[inline(always)]
    unsafe fn plus(self, other: Self) -> Self {
        self.by(other, |a, b| a + b)
    }
    #[inline(always)]
    unsafe fn minus(self, other: Self) -> Self {
        self.by(other, |a, b| a - b)
    }
    #[inline(always)]
    unsafe fn times(self, other: Self) -> Self {
        self.by(other, |a, b| a * b)
    }
    #[inline(always)]
    unsafe fn times_plus(self, factor: Self, addend: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k].mul_add(factor.0[k], addend.0[k])))
    }
    #[inline(always)]
    unsafe fn times_from(self, factor: Self, addend: Self) -> Self {
        Self(std::array::from_fn(|k| (-self.0[k]).mul_add(factor.0[k], addend.0[k])))
    }
    #[inline(always)]
    unsafe fn inverse_root_guess(self) -> Self {
        Self(self.0.map(|v| f64::from(1.0 / (v as f32).sqrt())))
    }
}

#[cfg(target_arch = "x86_64")]
pub(super) use x86::Avx2;

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use super::{Eight, Lanes};

    impl Eight for __m512d {}

    impl Lanes for __m512d {
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

    /// Two registers of four.
    #[derive(Clone, Copy)]
    pub(in super::super) struct Avx2([__m256d; 2]);

    impl Eight for Avx2 {}

    impl Lanes for Avx2 {
        #[inline(always)]
        unsafe fn splat(value: f64) -> Self {
            unsafe { Self([_mm256_set1_pd(value); 2]) }
        }
        #[inline(always)]
        unsafe fn load(from: *const f64) -> Self {
            unsafe { Self([_mm256_load_pd(from), _mm256_load_pd(from.add(4))]) }
        }
        #[inline(always)]
        unsafe fn store(self, to: *mut f64) {
            unsafe {
                _mm256_store_pd(to, self.0[0]);
                _mm256_store_pd(to.add(4), self.0[1]);
            }
        }
        #[inline(always)]
        unsafe fn plus(self, other: Self) -> Self {
            unsafe { Self([_mm256_add_pd(self.0[0], other.0[0]), _mm256_add_pd(self.0[1], other.0[1])]) }
        }
        #[inline(always)]
        unsafe fn minus(self, other: Self) -> Self {
            unsafe { Self([_mm256_sub_pd(self.0[0], other.0[0]), _mm256_sub_pd(self.0[1], other.0[1])]) }
        }
        #[inline(always)]
        unsafe fn times(self, other: Self) -> Self {
            unsafe { Self([_mm256_mul_pd(self.0[0], other.0[0]), _mm256_mul_pd(self.0[1], other.0[1])]) }
        }
        #[inline(always)]
        unsafe fn times_plus(self, factor: Self, addend: Self) -> Self {
            unsafe {
                Self([
                    _mm256_fmadd_pd(self.0[0], factor.0[0], addend.0[0]),
                    _mm256_fmadd_pd(self.0[1], factor.0[1], addend.0[1]),
                ])
            }
        }
        #[inline(always)]
        unsafe fn times_from(self, factor: Self, addend: Self) -> Self {
            unsafe {
                Self([
                    _mm256_fnmadd_pd(self.0[0], factor.0[0], addend.0[0]),
                    _mm256_fnmadd_pd(self.0[1], factor.0[1], addend.0[1]),
                ])
            }
        }
        #[inline(always)]
        unsafe fn inverse_root_guess(self) -> Self {
            unsafe {
                // Both halves at once.
                let both = _mm256_set_m128(_mm256_cvtpd_ps(self.0[1]), _mm256_cvtpd_ps(self.0[0]));
                let guess = _mm256_div_ps(_mm256_set1_ps(1.0), _mm256_sqrt_ps(both));
                Self([
                    _mm256_cvtps_pd(_mm256_castps256_ps128(guess)),
                    _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(guess)),
                ])
            }
        }
    }
}
