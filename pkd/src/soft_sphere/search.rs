//! All pairs of spheres within reach of each other, whatever their sizes: one grid of cells for each size class.
//!
//! Spheres are sorted into classes by factors of two in reach. Those of one class are searched with cells of their own
//! size, and those of a smaller class among the cells of each larger one: so a boulder among pebbles does not make
//! every pebble look through cells of the boulder's size.

use crate::cells::visit_near_pairs;

/// Pairs (i, j), i < j, of spheres whose centres are closer than the sum of their reaches (> 0), sorted, written to `out`.
pub(super) fn near_pairs(coordinates: [&[f64]; 3], reach: &[f64], out: &mut Vec<(u32, u32)>) {
    out.clear();
    let least = reach.iter().copied().fold(f64::INFINITY, f64::min);
    let mut classes: Vec<Class> = Vec::new();
    for (i, &reach) in reach.iter().enumerate() {
        let k = (reach / least).log2() as usize;
        if classes.len() <= k {
            classes.resize_with(k + 1, Class::default);
        }
        classes[k].members.push(i as u32);
        classes[k].reach = classes[k].reach.max(reach);
    }
    classes.retain(|class| !class.members.is_empty());

    let mut pair = |i: u32, j: u32| {
        let (a, b) = (i as usize, j as usize);
        let d2: f64 = coordinates.iter().map(|c| (c[a] - c[b]) * (c[a] - c[b])).sum();
        let s = reach[a] + reach[b];
        if d2 < s * s {
            out.push((i.min(j), i.max(j)));
        }
    };
    for (k, large) in classes.iter().enumerate() {
        let of = coordinates.map(|c| large.members.iter().map(|&i| c[i as usize]).collect::<Vec<_>>());
        let cell = 2.0 * large.reach;
        visit_near_pairs([&of[0], &of[1], &of[2]], cell, |p, q| pair(large.members[p], large.members[q]));
        if k > 0 {
            let cells = large.sorted(coordinates, cell);
            for small in &classes[..k] {
                visit_pairs_across(&small.sorted(coordinates, cell), &cells, &mut pair);
            }
        }
    }
    out.sort_unstable();
}

/// Spheres of about one size.
#[derive(Debug, Default)]
struct Class {
    members: Vec<u32>,
    /// Largest reach, m.
    reach: f64,
}

/// Spheres by their cells.
type Cells = Vec<([i64; 3], u32)>;

impl Class {
    fn sorted(&self, coordinates: [&[f64]; 3], cell: f64) -> Cells {
        let cell_of = |i: u32| coordinates.map(|c| (c[i as usize] / cell).floor() as i64);
        let mut cells: Cells = self.members.iter().map(|&i| (cell_of(i), i)).collect();
        cells.sort_unstable();
        cells
    }
}

/// Calls `visit` for every sphere of `one` and every one of `other` in the same or in touching cells.
fn visit_pairs_across(one: &Cells, other: &Cells, visit: &mut impl FnMut(u32, u32)) {
    let mut cursors = [0; 9];
    for &([cx, cy, cz], i) in one {
        for (k, cursor) in cursors.iter_mut().enumerate() {
            let column = [cx.saturating_add(k as i64 / 3 - 1), cy.saturating_add(k as i64 % 3 - 1)];
            let low = [column[0], column[1], cz.saturating_sub(1)];
            let high = [column[0], column[1], cz.saturating_add(1)];
            // Spheres come in the order of their cells, so each cursor only ever moves forward.
            while *cursor < other.len() && other[*cursor].0 < low {
                *cursor += 1;
            }
            for &(_, j) in other[*cursor..].iter().take_while(|(c, _)| *c <= high) {
                visit(i, j);
            }
        }
    }
}

/// An order of points in which neighbours in space are mostly neighbours in the list: along Morton's curve.
pub(super) fn order_in_space(coordinates: [&[f64]; 3]) -> Vec<u32> {
    const BITS: u32 = 21;
    let n = coordinates[0].len();
    let low = coordinates.map(|c| c.iter().copied().fold(f64::INFINITY, f64::min));
    let extent = (0..3)
        .map(|k| coordinates[k].iter().copied().fold(f64::NEG_INFINITY, f64::max) - low[k])
        .fold(f64::MIN_POSITIVE, f64::max);
    let scale = f64::from((1_u32 << BITS) - 1) / extent;
    let code =
        |i: usize| (0..3).fold(0_u64, |code, k| code | spread(((coordinates[k][i] - low[k]) * scale) as u64) << k);
    let mut order: Vec<(u64, u32)> = (0..n).map(|i| (code(i), i as u32)).collect();
    order.sort_unstable();
    order.into_iter().map(|(_, i)| i).collect()
}

/// The lowest 21 bits, each with two zeros above it.
fn spread(value: u64) -> u64 {
    let mut v = value & 0x1f_ffff;
    for (shift, mask) in [
        (32, 0x001f_0000_0000_ffff),
        (16, 0x001f_0000_ff00_00ff),
        (8, 0x100f_00f0_0f00_f00f),
        (4, 0x10c3_0c30_c30c_30c3),
        (2, 0x1249_2492_4924_9249),
    ] {
        v = (v | v << shift) & mask;
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn prop_pairs_of_any_sizes_are_those_of_a_search_through_all(
            points in proptest::collection::vec(([-9.0..9.0f64, -9.0..9.0, -5.0..5.0], -5.0..0.5f64), 1..120),
        ) {
            let c: Vec<Vec<f64>> = (0..3).map(|k| points.iter().map(|p| p.0[k]).collect()).collect();
            // Reaches from 1/32 to 1.4.
            let reach: Vec<f64> = points.iter().map(|p| p.1.exp2()).collect();
            let mut got = Vec::new();
            near_pairs([&c[0], &c[1], &c[2]], &reach, &mut got);
            let mut expected = Vec::new();
            for i in 0..points.len() {
                for j in i + 1..points.len() {
                    let d2: f64 = (0..3).map(|k| (c[k][i] - c[k][j]) * (c[k][i] - c[k][j])).sum();
                    if d2 < (reach[i] + reach[j]) * (reach[i] + reach[j]) {
                        expected.push((i as u32, j as u32));
                    }
                }
            }
            prop_assert_eq!(got, expected);
        }
    }

    #[test]
    fn order_in_space_keeps_octants_together_and_is_a_permutation() {
        let points: Vec<[f64; 3]> =
            (0..512).map(|i| [0, 3, 6].map(|shift| f64::from((((i * 293 + 7) % 512) >> shift) & 7))).collect();
        let c: Vec<Vec<f64>> = (0..3).map(|k| points.iter().map(|p| p[k]).collect()).collect();
        let order = order_in_space([&c[0], &c[1], &c[2]]);
        let mut all = order.clone();
        all.sort_unstable();
        assert_eq!(all, (0..512).collect::<Vec<u32>>());
        // Eight in a row are the corners of a cube.
        for eight in order.chunks(8) {
            for axis in &c {
                let values = || eight.iter().map(|&i| axis[i as usize]);
                assert!(values().fold(0.0, f64::max) - values().fold(9.0, f64::min) == 1.0);
            }
        }
        assert_eq!(order_in_space([&[2.0], &[0.0], &[1.0]]), [0]);
    }
}
