//! Eight numbers in one register, for processors with AVX-512: half the instructions of two registers of four.

use std::arch::x86_64::*;

use super::{Add, Avx2, Div, Eights, LANES, Lanes, Mul, Neg, Numbers, Octet, Sub, WIDE};

/// [`Eights`] for processors with AVX-512 (F, VL and DQ). Having a value of it is the proof that the processor has.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Avx512(__m512d);

macro_rules! operator {
    ($($name:ident $function:ident $intrinsic:ident),*) => {$(
        impl $name for Avx512 {
            type Output = Self;
            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                // SAFETY: a value of the type exists only where the processor has AVX-512; so everywhere below.
                Self(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    )*};
}
operator!(Add add _mm512_add_pd, Sub sub _mm512_sub_pd, Mul mul _mm512_mul_pd, Div div _mm512_div_pd);

impl Neg for Avx512 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(unsafe { _mm512_xor_pd(self.0, _mm512_set1_pd(-0.0)) })
    }
}

impl Avx512 {
    /// The mask as the processor has it: the compiler sees through the detour, and no lanes of ones are made.
    #[inline(always)]
    fn bits(self) -> __mmask8 {
        unsafe { _mm512_movepi64_mask(_mm512_castpd_si512(self.0)) }
    }

    #[inline(always)]
    fn of_bits(bits: __mmask8) -> Self {
        Self(unsafe { _mm512_castsi512_pd(_mm512_movm_epi64(bits)) })
    }

    #[inline(always)]
    fn to_array(self) -> [f64; WIDE] {
        let mut out = Octet::default();
        unsafe { self.store(out.0.as_mut_ptr()) };
        out.0
    }
}

impl Numbers for Avx512 {
    #[inline(always)]
    unsafe fn splat(value: f64) -> Self {
        Self(unsafe { _mm512_set1_pd(value) })
    }
    #[inline(always)]
    unsafe fn load(from: *const f64) -> Self {
        Self(unsafe { _mm512_load_pd(from) })
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut f64) {
        unsafe { _mm512_store_pd(to, self.0) }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(unsafe { _mm512_sqrt_pd(self.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(unsafe { _mm512_andnot_pd(_mm512_set1_pd(-0.0), self.0) })
    }
    #[inline(always)]
    fn less(self, other: Self) -> Self {
        Self::of_bits(unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, other.0) })
    }
    #[inline(always)]
    fn keep(self, value: Self) -> Self {
        Self(unsafe { _mm512_maskz_mov_pd(self.bits(), value.0) })
    }
    #[inline(always)]
    fn choose(self, one: Self, other: Self) -> Self {
        Self(unsafe { _mm512_mask_blend_pd(self.bits(), other.0, one.0) })
    }
    #[inline(always)]
    fn without(self, other: Self) -> Self {
        Self::of_bits(self.bits() & !other.bits())
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.bits() != 0
    }
    #[inline(always)]
    fn total(self) -> f64 {
        // As two registers of four would add.
        let lanes = self.to_array();
        lanes[..LANES].iter().sum::<f64>() + lanes[LANES..].iter().sum::<f64>()
    }
    #[inline(always)]
    fn largest(self) -> f64 {
        self.to_array().into_iter().fold(0.0, f64::max)
    }
}

impl Eights for Avx512 {
    type Row = Avx2;

    #[inline(always)]
    unsafe fn columns(
        first: &[*const f64; WIDE],
        second: &[*const f64; WIDE],
        at: usize,
    ) -> ([Self; LANES], [Self; LANES]) {
        unsafe {
            let ([a, b, c, d], [p, q, r, s]) = (quads(first, at), quads(second, at));
            (columns([p - a, q - b, r - c, s - d]), columns([p + a, q + b, r + c, s + d]))
        }
    }

    #[inline(always)]
    fn fetch(from: *const f64) {
        Avx2::fetch(from);
    }

    #[inline(always)]
    fn rows([Self(x), Self(y), Self(z), Self(w)]: [Self; LANES]) -> [Avx2; WIDE] {
        unsafe {
            let (xy_even, xy_odd) = (_mm512_unpacklo_pd(x, y), _mm512_unpackhi_pd(x, y));
            let (zw_even, zw_odd) = (_mm512_unpacklo_pd(z, w), _mm512_unpackhi_pd(z, w));
            let low = _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11);
            let high = _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15);
            let [r0, r2] = halves(_mm512_permutex2var_pd(xy_even, low, zw_even));
            let [r1, r3] = halves(_mm512_permutex2var_pd(xy_odd, low, zw_odd));
            let [r4, r6] = halves(_mm512_permutex2var_pd(xy_even, high, zw_even));
            let [r5, r7] = halves(_mm512_permutex2var_pd(xy_odd, high, zw_odd));
            [r0, r1, r2, r3, r4, r5, r6, r7]
        }
    }
}

// Functions and not closures: a closure is compiled without the instructions of the function around it.

/// The quads `at` of eight places, two in a register, such that [`columns`] leaves the lanes in order.
#[inline(always)]
unsafe fn quads(from: &[*const f64; WIDE], at: usize) -> [Avx512; LANES] {
    unsafe {
        [two(from[0], from[2], at), two(from[1], from[3], at), two(from[4], from[6], at), two(from[5], from[7], at)]
    }
}

#[inline(always)]
unsafe fn two(low: *const f64, high: *const f64, at: usize) -> Avx512 {
    unsafe {
        let low = _mm512_castpd256_pd512(_mm256_load_pd(low.add(at)));
        Avx512(_mm512_insertf64x4::<1>(low, _mm256_load_pd(high.add(at))))
    }
}

/// Rows to columns.
#[inline(always)]
fn columns([a, b, c, d]: [Avx512; LANES]) -> [Avx512; LANES] {
    unsafe {
        let (xz, yw) = (_mm512_unpacklo_pd(a.0, b.0), _mm512_unpackhi_pd(a.0, b.0));
        let (xz_4, yw_4) = (_mm512_unpacklo_pd(c.0, d.0), _mm512_unpackhi_pd(c.0, d.0));
        [
            Avx512(_mm512_shuffle_f64x2::<0x88>(xz, xz_4)),
            Avx512(_mm512_shuffle_f64x2::<0x88>(yw, yw_4)),
            Avx512(_mm512_shuffle_f64x2::<0xdd>(xz, xz_4)),
            Avx512(_mm512_shuffle_f64x2::<0xdd>(yw, yw_4)),
        ]
    }
}

#[inline(always)]
fn halves(two: __m512d) -> [Avx2; 2] {
    unsafe { [Avx2(_mm512_castpd512_pd256(two)), Avx2(_mm512_extractf64x4_pd::<1>(two))] }
}
