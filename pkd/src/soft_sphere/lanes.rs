//! Four or eight numbers at a time: with AVX2 or AVX-512 where the processor has it, plainly elsewhere, with the same bytes.
//!
//! There is no fused multiply-add and no approximate reciprocal in it, so all kinds round alike. A value of a vector
//! type can only be made by an unsafe constructor, whose caller vouches for the processor; all else is safe then.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Numbers in a register.
pub(super) const LANES: usize = 4;

/// Numbers in two registers, or in one of twice the width.
pub(super) const WIDE: usize = 2 * LANES;

/// Four numbers of one sphere, such as x, y, z and a fourth that belongs to it, aligned like a register.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C, align(32))]
pub(super) struct Quad(pub [f64; LANES]);

impl Quad {
    pub fn xyz(self) -> nalgebra::Vector3<f64> {
        nalgebra::Vector3::new(self.0[0], self.0[1], self.0[2])
    }
}

/// One number of each of eight pairs, aligned like a register of eight.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C, align(64))]
pub(super) struct Octet(pub [f64; WIDE]);

/// Numbers that are reckoned with side by side. Masks are such numbers whose lanes are all ones or all zeros.
pub(super) trait Numbers:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self> + 'static
{
    /// The same number in all lanes.
    ///
    /// # Safety
    /// The processor must have the instructions of the type, here and wherever the result goes.
    unsafe fn splat(value: f64) -> Self;
    /// # Safety
    /// As [`Self::splat`]; `from` must point at a number for each lane, aligned like a [`Quad`] or [`Octet`] of as many.
    unsafe fn load(from: *const f64) -> Self;
    /// # Safety
    /// As [`Self::load`], for writing.
    unsafe fn store(self, to: *mut f64);
    fn sqrt(self) -> Self;
    fn abs(self) -> Self;
    /// Mask of the lanes that are less than those of `other`; false if one is not a number.
    fn less(self, other: Self) -> Self;
    /// Lanes that are set in the mask `self` of `value`, 0 elsewhere.
    fn keep(self, value: Self) -> Self;
    /// `one` where the mask `self` is set, `other` elsewhere.
    fn choose(self, one: Self, other: Self) -> Self;
    /// The lanes of the mask `self` that are not set in `other`.
    fn without(self, other: Self) -> Self;
    /// Whether a lane of the mask is set.
    fn any(self) -> bool;
    /// Sum of the lanes, in order.
    fn total(self) -> f64;
    /// The largest lane, or 0 if none is positive.
    fn largest(self) -> f64;
}

/// A register of four `f64`.
pub(super) trait Lanes: Numbers {
    /// Two consecutive numbers from each of four places, to be taken apart by [`Self::unzip`].
    ///
    /// # Safety
    /// As [`Self::splat`]; two numbers must follow each pointer.
    unsafe fn pairs(from: [*const f64; LANES]) -> [Self; 2];
    /// Makes the four first and the four second numbers of what [`Self::pairs`] gave, or of sums and differences.
    fn unzip(pairs: [Self; 2]) -> [Self; 2];
    /// Two consecutive numbers, twice.
    ///
    /// # Safety
    /// As [`Self::pairs`].
    unsafe fn twice(from: *const f64) -> Self;
    /// The last two lanes, twice.
    fn last_twice(self) -> Self;
    /// Adds the first two lanes to two numbers, and the last two to two others, which may be the same.
    ///
    /// # Safety
    /// As [`Self::pairs`], for writing; `first` and `last` must be aligned like two numbers.
    unsafe fn add_halves(self, first: *mut f64, last: *mut f64);
    /// Rows to columns.
    fn transpose(rows: [Self; LANES]) -> [Self; LANES];
    /// As [`Eights::fetch`].
    fn fetch(from: *const f64);
}

/// Eight numbers, one of each of eight pairs of spheres.
pub(super) trait Eights: Numbers {
    /// Four numbers of one sphere.
    type Row: Lanes;
    /// Of the quads `at` which these places of the eight first and second spheres have: the columns of their differences,
    /// second minus first, and of their sums. What is not used of them costs nothing.
    ///
    /// # Safety
    /// As [`Numbers::splat`]; a quad must be `at` numbers behind each pointer.
    unsafe fn columns(
        first: &[*const f64; WIDE],
        second: &[*const f64; WIDE],
        at: usize,
    ) -> ([Self; LANES], [Self; LANES]);
    /// Asks for the line of the cache at a place, which need not exist.
    fn fetch(from: *const f64);
    /// Columns to rows: four numbers of each of eight.
    fn rows(columns: [Self; LANES]) -> [Self::Row; WIDE];
}

/// Two registers side by side: the second keeps the processor busy while the first waits for its divisions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wide<V>(pub [V; 2]);

macro_rules! wide_operator {
    ($($name:ident $function:ident),*) => {$(
        impl<V: Lanes> $name for Wide<V> {
            type Output = Self;
            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                Self([self.0[0].$function(other.0[0]), self.0[1].$function(other.0[1])])
            }
        }
    )*};
}
wide_operator!(Add add, Sub sub, Mul mul, Div div);

impl<V: Lanes> Neg for Wide<V> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self([-self.0[0], -self.0[1]])
    }
}

impl<V: Lanes> Numbers for Wide<V> {
    #[inline(always)]
    unsafe fn splat(value: f64) -> Self {
        unsafe { Self([V::splat(value); 2]) }
    }
    #[inline(always)]
    unsafe fn load(from: *const f64) -> Self {
        unsafe { Self([V::load(from), V::load(from.add(LANES))]) }
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut f64) {
        unsafe {
            self.0[0].store(to);
            self.0[1].store(to.add(LANES));
        }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self([self.0[0].sqrt(), self.0[1].sqrt()])
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self([self.0[0].abs(), self.0[1].abs()])
    }
    #[inline(always)]
    fn less(self, other: Self) -> Self {
        Self([self.0[0].less(other.0[0]), self.0[1].less(other.0[1])])
    }
    #[inline(always)]
    fn keep(self, value: Self) -> Self {
        Self([self.0[0].keep(value.0[0]), self.0[1].keep(value.0[1])])
    }
    #[inline(always)]
    fn choose(self, one: Self, other: Self) -> Self {
        Self([self.0[0].choose(one.0[0], other.0[0]), self.0[1].choose(one.0[1], other.0[1])])
    }
    #[inline(always)]
    fn without(self, other: Self) -> Self {
        Self([self.0[0].without(other.0[0]), self.0[1].without(other.0[1])])
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.0[0].any() | self.0[1].any()
    }
    #[inline(always)]
    fn total(self) -> f64 {
        self.0[0].total() + self.0[1].total()
    }
    #[inline(always)]
    fn largest(self) -> f64 {
        self.0[0].largest().max(self.0[1].largest())
    }
}

impl<V: Lanes> Eights for Wide<V> {
    type Row = V;

    #[inline(always)]
    unsafe fn columns(
        first: &[*const f64; WIDE],
        second: &[*const f64; WIDE],
        at: usize,
    ) -> ([Self; LANES], [Self; LANES]) {
        unsafe {
            let ([x, y], [sx, sy]) = two_columns(first, second, at);
            let ([z, w], [sz, sw]) = two_columns(first, second, at + 2);
            ([x, y, z, w], [sx, sy, sz, sw])
        }
    }

    #[inline(always)]
    fn fetch(from: *const f64) {
        V::fetch(from);
    }

    #[inline(always)]
    fn rows([a, b, c, d]: [Self; LANES]) -> [V; WIDE] {
        let low = V::transpose([a.0[0], b.0[0], c.0[0], d.0[0]]);
        let high = V::transpose([a.0[1], b.0[1], c.0[1], d.0[1]]);
        [low[0], low[1], low[2], low[3], high[0], high[1], high[2], high[3]]
    }
}

// Functions and not closures: a closure is compiled without the instructions of the function around it.

/// Two columns of [`Eights::columns`], from the one `at` numbers behind each pointer.
#[inline(always)]
unsafe fn two_columns<V: Lanes>(
    first: &[*const f64; WIDE],
    second: &[*const f64; WIDE],
    at: usize,
) -> ([Wide<V>; 2], [Wide<V>; 2]) {
    unsafe {
        let (i, j) = (V::pairs(four(first, 0, at)), V::pairs(four(second, 0, at)));
        let [d0, e0] = V::unzip([j[0] - i[0], j[1] - i[1]]);
        let [s0, t0] = V::unzip([j[0] + i[0], j[1] + i[1]]);
        let (i, j) = (V::pairs(four(first, LANES, at)), V::pairs(four(second, LANES, at)));
        let [d1, e1] = V::unzip([j[0] - i[0], j[1] - i[1]]);
        let [s1, t1] = V::unzip([j[0] + i[0], j[1] + i[1]]);
        ([Wide([d0, d1]), Wide([e0, e1])], [Wide([s0, s1]), Wide([t0, t1])])
    }
}

/// `at` numbers behind four of the pointers.
#[inline(always)]
unsafe fn four(p: &[*const f64; WIDE], k: usize, at: usize) -> [*const f64; LANES] {
    unsafe { [p[k].add(at), p[k + 1].add(at), p[k + 2].add(at), p[k + 3].add(at)] }
}

/// [`Lanes`] for any processor.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct Plain([f64; LANES]);

impl Plain {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self(std::array::from_fn(|k| f(self.0[k], other.0[k])))
    }

    #[inline(always)]
    fn bits(self, other: Self, f: impl Fn(u64, u64) -> u64) -> Self {
        self.zip(other, |a, b| f64::from_bits(f(a.to_bits(), b.to_bits())))
    }
}

macro_rules! plain_operator {
    ($($name:ident $function:ident $symbol:tt),*) => {$(
        impl $name for Plain {
            type Output = Self;
            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                self.zip(other, |a, b| a $symbol b)
            }
        }
    )*};
}
plain_operator!(Add add +, Sub sub -, Mul mul *, Div div /);

impl Neg for Plain {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0.map(|a| -a))
    }
}

impl Numbers for Plain {
    #[inline(always)]
    unsafe fn splat(value: f64) -> Self {
        Self([value; LANES])
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
    fn sqrt(self) -> Self {
        Self(self.0.map(f64::sqrt))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f64::abs))
    }
    #[inline(always)]
    fn less(self, other: Self) -> Self {
        self.zip(other, |a, b| f64::from_bits(if a < b { u64::MAX } else { 0 }))
    }
    #[inline(always)]
    fn keep(self, value: Self) -> Self {
        self.bits(value, |m, v| m & v)
    }
    #[inline(always)]
    fn choose(self, one: Self, other: Self) -> Self {
        Self(std::array::from_fn(|k| if self.0[k].to_bits() != 0 { one.0[k] } else { other.0[k] }))
    }
    #[inline(always)]
    fn without(self, other: Self) -> Self {
        self.bits(other, |m, o| m & !o)
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.0.iter().any(|m| m.to_bits() != 0)
    }
    #[inline(always)]
    fn total(self) -> f64 {
        self.0.iter().sum()
    }
    #[inline(always)]
    fn largest(self) -> f64 {
        self.0.into_iter().fold(0.0, f64::max)
    }
}

impl Lanes for Plain {
    #[inline(always)]
    unsafe fn pairs(from: [*const f64; LANES]) -> [Self; 2] {
        let [a, b, c, d] = from.map(|p| unsafe { [*p, *p.add(1)] });
        [Self([a[0], a[1], c[0], c[1]]), Self([b[0], b[1], d[0], d[1]])]
    }
    #[inline(always)]
    fn unzip([e, o]: [Self; 2]) -> [Self; 2] {
        [Self([e.0[0], o.0[0], e.0[2], o.0[2]]), Self([e.0[1], o.0[1], e.0[3], o.0[3]])]
    }
    #[inline(always)]
    unsafe fn twice(from: *const f64) -> Self {
        let [a, b] = unsafe { [*from, *from.add(1)] };
        Self([a, b, a, b])
    }
    #[inline(always)]
    fn last_twice(self) -> Self {
        let [.., c, d] = self.0;
        Self([c, d, c, d])
    }
    #[inline(always)]
    unsafe fn add_halves(self, first: *mut f64, last: *mut f64) {
        unsafe {
            *first += self.0[0];
            *first.add(1) += self.0[1];
            *last += self.0[2];
            *last.add(1) += self.0[3];
        }
    }
    #[inline(always)]
    fn transpose(rows: [Self; LANES]) -> [Self; LANES] {
        std::array::from_fn(|k| Self(rows.map(|row| row.0[k])))
    }
    /// The processor finds what it needs when it needs it.
    #[inline(always)]
    fn fetch(_: *const f64) {}
}

#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "x86_64")]
pub(super) use {avx512::Avx512, x86::Avx2};

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::{Add, Div, LANES, Lanes, Mul, Neg, Numbers, Quad, Sub};
    use std::arch::x86_64::*;

    /// [`Lanes`] for processors with AVX2. Having a value of it is the proof that the processor has.
    #[derive(Debug, Clone, Copy)]
    pub(in super::super) struct Avx2(pub(super) __m256d);

    macro_rules! operator {
        ($($name:ident $function:ident $intrinsic:ident),*) => {$(
            impl $name for Avx2 {
                type Output = Self;
                #[inline(always)]
                fn $function(self, other: Self) -> Self {
                    // SAFETY: a value of the type exists only where the processor has AVX2; so everywhere below.
                    Self(unsafe { $intrinsic(self.0, other.0) })
                }
            }
        )*};
    }
    operator!(Add add _mm256_add_pd, Sub sub _mm256_sub_pd, Mul mul _mm256_mul_pd, Div div _mm256_div_pd);

    impl Neg for Avx2 {
        type Output = Self;
        #[inline(always)]
        fn neg(self) -> Self {
            Self(unsafe { _mm256_xor_pd(self.0, _mm256_set1_pd(-0.0)) })
        }
    }

    impl Numbers for Avx2 {
        #[inline(always)]
        unsafe fn splat(value: f64) -> Self {
            Self(unsafe { _mm256_set1_pd(value) })
        }
        #[inline(always)]
        unsafe fn load(from: *const f64) -> Self {
            Self(unsafe { _mm256_load_pd(from) })
        }
        #[inline(always)]
        unsafe fn store(self, to: *mut f64) {
            unsafe { _mm256_store_pd(to, self.0) }
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            Self(unsafe { _mm256_sqrt_pd(self.0) })
        }
        #[inline(always)]
        fn abs(self) -> Self {
            Self(unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0) })
        }
        #[inline(always)]
        fn less(self, other: Self) -> Self {
            Self(unsafe { _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, other.0) })
        }
        #[inline(always)]
        fn keep(self, value: Self) -> Self {
            Self(unsafe { _mm256_and_pd(self.0, value.0) })
        }
        #[inline(always)]
        fn choose(self, one: Self, other: Self) -> Self {
            Self(unsafe { _mm256_blendv_pd(other.0, one.0, self.0) })
        }
        #[inline(always)]
        fn without(self, other: Self) -> Self {
            Self(unsafe { _mm256_andnot_pd(other.0, self.0) })
        }
        #[inline(always)]
        fn any(self) -> bool {
            unsafe { _mm256_movemask_pd(self.0) != 0 }
        }
        #[inline(always)]
        fn total(self) -> f64 {
            self.to_array().iter().sum()
        }
        #[inline(always)]
        fn largest(self) -> f64 {
            self.to_array().into_iter().fold(0.0, f64::max)
        }
    }

    impl Lanes for Avx2 {
        #[inline(always)]
        fn fetch(from: *const f64) {
            unsafe { _mm_prefetch::<_MM_HINT_T0>(from.cast()) }
        }
        #[inline(always)]
        unsafe fn pairs([a, b, c, d]: [*const f64; LANES]) -> [Self; 2] {
            unsafe {
                [
                    Self(_mm256_set_m128d(_mm_loadu_pd(c), _mm_loadu_pd(a))),
                    Self(_mm256_set_m128d(_mm_loadu_pd(d), _mm_loadu_pd(b))),
                ]
            }
        }
        #[inline(always)]
        fn unzip([even, odd]: [Self; 2]) -> [Self; 2] {
            unsafe { [Self(_mm256_unpacklo_pd(even.0, odd.0)), Self(_mm256_unpackhi_pd(even.0, odd.0))] }
        }
        #[inline(always)]
        unsafe fn twice(from: *const f64) -> Self {
            unsafe { Self(_mm256_broadcast_pd(&*from.cast())) }
        }
        #[inline(always)]
        fn last_twice(self) -> Self {
            Self(unsafe { _mm256_permute2f128_pd::<0x11>(self.0, self.0) })
        }
        #[inline(always)]
        unsafe fn add_halves(self, first: *mut f64, last: *mut f64) {
            unsafe {
                _mm_store_pd(first, _mm_add_pd(_mm_load_pd(first), _mm256_castpd256_pd128(self.0)));
                _mm_store_pd(last, _mm_add_pd(_mm_load_pd(last), _mm256_extractf128_pd::<1>(self.0)));
            }
        }
        #[inline(always)]
        fn transpose([a, b, c, d]: [Self; LANES]) -> [Self; LANES] {
            unsafe {
                let (ab_even, ab_odd) = (_mm256_unpacklo_pd(a.0, b.0), _mm256_unpackhi_pd(a.0, b.0));
                let (cd_even, cd_odd) = (_mm256_unpacklo_pd(c.0, d.0), _mm256_unpackhi_pd(c.0, d.0));
                [
                    Self(_mm256_permute2f128_pd::<0x20>(ab_even, cd_even)),
                    Self(_mm256_permute2f128_pd::<0x20>(ab_odd, cd_odd)),
                    Self(_mm256_permute2f128_pd::<0x31>(ab_even, cd_even)),
                    Self(_mm256_permute2f128_pd::<0x31>(ab_odd, cd_odd)),
                ]
            }
        }
    }

    impl Avx2 {
        #[inline(always)]
        fn to_array(self) -> [f64; LANES] {
            let mut out = Quad::default();
            unsafe { self.store(out.0.as_mut_ptr()) };
            out.0
        }
    }
}

/// A vector in space for each lane.
#[derive(Clone, Copy)]
pub(super) struct Vector<V>(pub [V; 3]);

impl<V: Numbers> Vector<V> {
    #[inline(always)]
    pub fn dot(self, other: Self) -> V {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        a * x + b * y + c * z
    }
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([b * z - c * y, c * x - a * z, a * y - b * x])
    }
    #[inline(always)]
    pub fn times(self, factor: V) -> Self {
        let [a, b, c] = self.0;
        Self([a * factor, b * factor, c * factor])
    }
    /// The mask `mask` applied to each component.
    #[inline(always)]
    pub fn kept(self, mask: V) -> Self {
        let [a, b, c] = self.0;
        Self([mask.keep(a), mask.keep(b), mask.keep(c)])
    }
    /// `self` where the mask is set, `other` elsewhere.
    #[inline(always)]
    pub fn or(self, mask: V, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([mask.choose(a, x), mask.choose(b, y), mask.choose(c, z)])
    }
}

impl<V: Numbers> Add for Vector<V> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a + x, b + y, c + z])
    }
}

impl<V: Numbers> Sub for Vector<V> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a - x, b - y, c - z])
    }
}
