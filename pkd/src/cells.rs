//! Pairs of points closer than a given distance, found through a sorted list of cubic cells.
//!
//! The cells are kept as a sorted list, not as a grid, so memory depends on the number of points alone, however far
//! they are scattered. Pairs come in an order that depends on the coordinates only.

/// Calls `visit(i, j)`, i < j, once for every pair of points that may be closer than `reach` (> 0), and for some that
/// are not: those in the same or in touching cells of that size.
pub(crate) fn visit_near_pairs(coordinates: [&[f64]; 3], reach: f64, mut visit: impl FnMut(usize, usize)) {
    let cell = |i: usize| coordinates.map(|c| (c[i] / reach).floor() as i64);
    let mut sorted: Vec<([i64; 3], u32)> = (0..coordinates[0].len()).map(|i| (cell(i), i as u32)).collect();
    sorted.sort_unstable();

    let mut pair = |p: u32, q: u32| visit(p.min(q) as usize, p.max(q) as usize);
    // Columns of cells ahead of a point's own in the sort order; each is searched over three cells in z.
    const AHEAD: [[i64; 2]; 4] = [[0, 1], [1, -1], [1, 0], [1, 1]];
    let mut cursor = [0; 4];
    for (at, &([cx, cy, cz], i)) in sorted.iter().enumerate() {
        // The rest of the own cell and the one above it follow directly.
        for &(c, j) in sorted[at + 1..].iter().take_while(|(c, _)| *c <= [cx, cy, cz.saturating_add(1)]) {
            debug_assert!(c >= [cx, cy, cz]);
            pair(i, j);
        }
        for (cursor, [dx, dy]) in cursor.iter_mut().zip(AHEAD) {
            let column = [cx.saturating_add(dx), cy.saturating_add(dy)];
            let (low, high) =
                ([column[0], column[1], cz.saturating_sub(1)], [column[0], column[1], cz.saturating_add(1)]);
            // Points come in the order of their cells, so each cursor only ever moves forward.
            while *cursor < sorted.len() && sorted[*cursor].0 < low {
                *cursor += 1;
            }
            for &(_, j) in sorted[*cursor..].iter().take_while(|(c, _)| *c <= high) {
                pair(i, j);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn prop_every_close_pair_is_visited_exactly_once(
            points in proptest::collection::vec([-5.0..5.0f64, -5.0..5.0, -3.0..3.0], 0..80),
            reach in 0.3..4.0f64,
        ) {
            let c: Vec<Vec<f64>> = (0..3).map(|k| points.iter().map(|p| p[k]).collect()).collect();
            let mut seen = vec![0; points.len() * points.len()];
            visit_near_pairs([&c[0], &c[1], &c[2]], reach, |i, j| seen[i * points.len() + j] += 1);
            for i in 0..points.len() {
                for j in 0..points.len() {
                    let d2: f64 = (0..3).map(|k| (c[k][i] - c[k][j]).powi(2)).sum();
                    let visits = seen[i * points.len() + j];
                    prop_assert!(visits <= 1 && (visits == 0 || i < j));
                    prop_assert!(i >= j || d2 >= reach * reach || visits == 1);
                }
            }
        }
    }
}
