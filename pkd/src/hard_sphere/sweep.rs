//! Pairs of spheres that nearly touch, found by a sweep along one axis.
//!
//! The spheres are sorted by the lower ends of their extents on the axis on which they spread most; each is compared with
//! those that begin before it ends. Unlike a grid this needs no cell size, so that neither a sphere far away nor very
//! different radii cost more than their share.

#[cfg(target_arch = "x86_64")]
use crate::simd::Level;

/// Spheres compared at a time.
const BLOCK: usize = 8;

/// A ball around the centre of a sphere; two that overlap are a pair.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reach {
    /// Centre, m.
    pub centre: [f64; 3],
    /// Radius, m.
    pub reach: f64,
}

/// Memory of the search.
#[derive(Debug, Default)]
pub(super) struct Sweep {
    /// Lower end and index of every extent, ascending.
    order: Vec<(f64, u32)>,
    /// x, y, z and reach in that order, filled up to a block with spheres that are nowhere near.
    columns: [Vec<f64>; 4],
}

impl Sweep {
    /// Calls `visit(i, j)` once for every overlapping pair, in an order that depends on the reaches alone.
    pub fn visit_pairs(&mut self, reaches: &[Reach], visit: impl FnMut(u32, u32)) {
        let axis = self.sort(reaches);
        #[cfg(target_arch = "x86_64")]
        if Level::in_use() >= Level::Avx2 {
            // SAFETY: the processor has AVX2.
            return unsafe { self.compare_avx2(axis, visit) };
        }
        self.compare(axis, visit, overlaps);
    }

    /// Fills the sorted columns and returns the axis.
    fn sort(&mut self, reaches: &[Reach]) -> usize {
        let extent = |k: usize| {
            let ends = reaches.iter().map(|r| r.centre[k]);
            ends.clone().fold(f64::NEG_INFINITY, f64::max) - ends.fold(f64::INFINITY, f64::min)
        };
        let axis = (1..3).fold(0, |best, k| if extent(k) > extent(best) { k } else { best });
        self.order.clear();
        self.order.extend(reaches.iter().zip(0..).map(|(r, i)| (r.centre[axis] - r.reach, i)));
        self.order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (k, column) in self.columns.iter_mut().enumerate() {
            column.clear();
            column.extend(self.order.iter().map(|&(_, i)| {
                let r = &reaches[i as usize];
                if k < 3 { r.centre[k] } else { r.reach }
            }));
            column.resize(reaches.len() + BLOCK, if k < 3 { 1e30 } else { 0.0 });
        }
        axis
    }

    /// [`Self::compare`] compiled for AVX2.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn compare_avx2(&self, axis: usize, visit: impl FnMut(u32, u32)) {
        self.compare(axis, visit, |one, block| overlaps_avx2(one, block));
    }

    /// Compares neighbours along the axis; `overlaps` gives one bit for each sphere of a block that one sphere overlaps.
    #[inline(always)]
    fn compare(
        &self,
        axis: usize,
        mut visit: impl FnMut(u32, u32),
        overlaps: impl Fn([f64; 4], [&[f64; BLOCK]; 4]) -> u32,
    ) {
        let [x, y, z, reach] = &self.columns;
        for (at, &(_, i)) in self.order.iter().enumerate() {
            let one = [x[at], y[at], z[at], reach[at]];
            let upper = one[axis] + one[3];
            let mut start = at + 1;
            // A block may go beyond the upper end: those spheres are too far away to be taken for neighbours.
            while self.order.get(start).is_some_and(|&(lower, _)| lower <= upper) {
                let block = [x, y, z, reach].map(|c| c[start..].first_chunk().expect("filled up to a block"));
                let mut bits = overlaps(one, block);
                while bits != 0 {
                    visit(i, self.order[start + bits.trailing_zeros() as usize].1);
                    bits &= bits - 1;
                }
                start += BLOCK;
            }
        }
    }
}

/// One bit for each sphere of a block that overlaps one sphere (x, y, z, reach).
fn overlaps(one: [f64; 4], block: [&[f64; BLOCK]; 4]) -> u32 {
    let [x, y, z, reach] = block;
    (0..BLOCK).fold(0, |bits, k| {
        let (dx, dy, dz) = (x[k] - one[0], y[k] - one[1], z[k] - one[2]);
        let limit = reach[k] + one[3];
        bits | u32::from(dx * dx + dy * dy + dz * dz <= limit * limit) << k
    })
}

/// [`overlaps`] with vectors.
#[cfg(target_arch = "x86_64")]
#[inline]
#[target_feature(enable = "avx2")]
fn overlaps_avx2(one: [f64; 4], block: [&[f64; BLOCK]; 4]) -> u32 {
    use std::arch::x86_64::*;
    let one = one.map(|value| _mm256_set1_pd(value));
    let half = |at: usize| {
        // SAFETY: a block is two vectors long.
        let [x, y, z, reach] = block.map(|column| unsafe { _mm256_loadu_pd(column.as_ptr().add(at)) });
        let [dx, dy, dz] = [_mm256_sub_pd(x, one[0]), _mm256_sub_pd(y, one[1]), _mm256_sub_pd(z, one[2])];
        let limit = _mm256_add_pd(reach, one[3]);
        let square = |a| _mm256_mul_pd(a, a);
        let distance2 = _mm256_add_pd(_mm256_add_pd(square(dx), square(dy)), square(dz));
        _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LE_OQ>(distance2, square(limit))).cast_unsigned()
    };
    half(0) | half(4) << 4
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn prop_every_overlapping_pair_is_visited_once(
            balls in prop::collection::vec(([-9.0f64..9.0, -5.0..5.0, -3.0..3.0], 0.1f64..2.0), 0..60),
        ) {
            let reaches: Vec<Reach> = balls.iter().map(|&(centre, reach)| Reach { centre, reach }).collect();
            let mut found = Vec::new();
            Sweep::default().visit_pairs(&reaches, |i, j| found.push((i.min(j), i.max(j))));
            found.sort_unstable();
            let mut expected = Vec::new();
            for j in 0..reaches.len() {
                for i in 0..j {
                    let [one, two] = [&reaches[i], &reaches[j]];
                    let r2: f64 = (0..3).map(|k| (two.centre[k] - one.centre[k]).powi(2)).sum();
                    if r2 <= (one.reach + two.reach).powi(2) {
                        expected.push((i as u32, j as u32));
                    }
                }
            }
            expected.sort_unstable();
            prop_assert_eq!(found, expected);
        }
    }
}
