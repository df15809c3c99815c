//! Polygons of mesh files cut into triangles.
//!
//! A polygon first becomes the fan around its first corner, which is right wherever it is convex; that keeps the triangles
//! of ordinary files what they always were. Where that fan folds over, the fan around another corner is tried, then ears are
//! cut off one by one. Own code because every corner has to stay in use: libraries that cut ears (earcut and its ports) drop
//! corners on straight sides, and the neighbour that uses such a corner is then left with a hole beside it.

use nalgebra::{Vector2, Vector3};

/// Corners up to which every fan is tried, at quadratic cost; few longer polygons are star-shaped.
const MOST_FANS: usize = 64;
/// Corners up to which ears are cut, at cubic cost in the worst case.
const MOST_EARS: usize = 2000;
/// Twice the area of a triangle over its longest side squared, from which on its corners are not on a line.
const FLAT: f64 = 1e-12;

/// Why a polygon cannot be cut into triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PolygonFault {
    /// Its outline crosses itself, or it has no area.
    #[error("the polygon of {corners} corners crosses itself or has no area; give the facet as triangles")]
    NotSimple {
        /// Its corners.
        corners: usize,
    },
    /// A concave polygon with too many corners.
    #[error("a concave polygon may have up to {MOST_EARS} corners, not {corners}; give the facet as triangles")]
    TooManyCorners {
        /// Its corners.
        corners: usize,
    },
}

/// Turns the fan of a polygon around its first corner, as [`fan`] makes it, into triangles that do not overlap. They have
/// the polygon's orientation.
///
/// # Errors
/// [`PolygonFault`] for outlines that bound no area.
///
/// # Examples
/// ```
/// // A dart: the fan around its first corner would fold over the concave one.
/// let vertices = [[0.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.5, 1.0, 0.0], [0.0, 3.0, 0.0]];
/// let mut facets = Vec::new();
/// tiling::polygon::fan(&[1, 2, 3, 0], &mut facets);
/// tiling::polygon::mend_fan(&vertices, &mut facets)?;
/// assert_eq!(facets, [[2, 3, 0], [2, 0, 1]]);
/// # Ok::<(), tiling::polygon::PolygonFault>(())
/// ```
pub fn mend_fan(vertices: &[[f64; 3]], facets: &mut [[u32; 3]]) -> Result<(), PolygonFault> {
    if facets.len() < 2 {
        return Ok(());
    }
    let corners: Vec<u32> = [facets[0][0], facets[0][1]].into_iter().chain(facets.iter().map(|f| f[2])).collect();
    let n = corners.len();
    let Some(flat) = flattened(vertices, &corners) else { return Err(PolygonFault::NotSimple { corners: n }) };
    let fans = if n <= MOST_FANS { n } else { 1 };
    let fan_around = |first: usize| (1..n - 1).map(move |k| [first, (first + k) % n, (first + k + 1) % n]);
    let good = (0..fans).find(|first| fan_around(*first).all(|t| turns_left(&flat, t)));
    let triangles: Vec<[usize; 3]> = match good {
        Some(0) => return Ok(()),
        Some(first) => fan_around(first).collect(),
        None if n > MOST_EARS => return Err(PolygonFault::TooManyCorners { corners: n }),
        None => cut_ears(&flat, &corners).ok_or(PolygonFault::NotSimple { corners: n })?,
    };
    for (facet, triangle) in facets.iter_mut().zip(triangles) {
        *facet = triangle.map(|k| corners[k]);
    }
    Ok(())
}

/// Adds the fan of a polygon around its first corner. Corners that repeat the one before are left out as long as three
/// remain: some programs write triangles as quadrangles.
pub fn fan(corners: &[u32], facets: &mut Vec<[u32; 3]>) {
    let mut distinct = corners.to_vec();
    if distinct.len() > 3 {
        distinct.dedup();
        if distinct.len() > 1 && distinct.first() == distinct.last() {
            distinct.pop();
        }
    }
    let corners = if distinct.len() < 3 { corners } else { &distinct };
    if let [first, rest @ ..] = corners {
        facets.extend(rest.windows(2).map(|pair| [*first, pair[0], pair[1]]));
    }
}

/// The corners in the plane that the polygon lies in best (Newell's normal), counter-clockwise; `None` without an area.
fn flattened(vertices: &[[f64; 3]], corners: &[u32]) -> Option<Vec<Vector2<f64>>> {
    let at = |k: usize| Vector3::from(vertices[corners[k] as usize]);
    let origin = at(0);
    let normal: Vector3<f64> =
        (1..corners.len() - 1).map(|k| (at(k) - origin).cross(&(at(k + 1) - origin))).sum::<Vector3<f64>>();
    let normal = normal.try_normalize(0.0)?;
    let least = if normal.x.abs() < 0.6 { Vector3::x() } else { Vector3::y() };
    let u = normal.cross(&least).normalize();
    let v = normal.cross(&u);
    let flat: Vec<Vector2<f64>> =
        (0..corners.len()).map(|k| Vector2::new((at(k) - origin).dot(&u), (at(k) - origin).dot(&v))).collect();
    flat.iter().all(|p| p.x.is_finite() && p.y.is_finite()).then_some(flat)
}

fn cross(a: Vector2<f64>, b: Vector2<f64>) -> f64 {
    a.x * b.y - a.y * b.x
}

/// Whether three corners make a triangle of the polygon's orientation that is not flat.
fn turns_left(flat: &[Vector2<f64>], [a, b, c]: [usize; 3]) -> bool {
    let (a, b, c) = (flat[a], flat[b], flat[c]);
    let longest = (b - a).norm_squared().max((c - b).norm_squared()).max((a - c).norm_squared());
    cross(b - a, c - a) > FLAT * longest
}

/// Ears: corners whose triangle with both neighbours holds no other corner, not even on its sides. A simple polygon always
/// has one, corners on straight sides included, because it has a triangulation that uses all of them.
fn cut_ears(flat: &[Vector2<f64>], corners: &[u32]) -> Option<Vec<[usize; 3]>> {
    let mut left: Vec<usize> = (0..flat.len()).collect();
    let mut triangles = Vec::with_capacity(flat.len() - 2);
    while left.len() > 3 {
        let n = left.len();
        let around = |i: usize| [left[(i + n - 1) % n], left[i], left[(i + 1) % n]];
        let is_ear = |ear: &[usize; 3]| {
            // A vertex that the outline passes twice, as on the bridge to a hole, does not stand in its own way.
            let own = |k: usize| ear.iter().any(|e| corners[*e] == corners[k]);
            turns_left(flat, *ear) && left.iter().all(|k| own(*k) || !holds(flat, *ear, flat[*k]))
        };
        let i = (0..n).find(|i| is_ear(&around(*i)))?;
        triangles.push(around(i));
        left.remove(i);
    }
    let last = [left[0], left[1], left[2]];
    turns_left(flat, last).then(|| {
        triangles.push(last);
        triangles
    })
}

/// Whether a point is in a triangle or on its sides.
fn holds(flat: &[Vector2<f64>], [a, b, c]: [usize; 3], p: Vector2<f64>) -> bool {
    [(a, b), (b, c), (c, a)].iter().all(|(from, to)| cross(flat[*to] - flat[*from], p - flat[*from]) >= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Triangles of a polygon in the plane z = x/2 and the sum of their areas in the xy plane, each counted positive.
    fn cut(outline: &[[f64; 2]]) -> Result<(Vec<[u32; 3]>, f64), PolygonFault> {
        let vertices: Vec<[f64; 3]> = outline.iter().map(|[x, y]| [*x, *y, 0.5 * x]).collect();
        let mut facets = Vec::new();
        fan(&(0..outline.len() as u32).collect::<Vec<_>>(), &mut facets);
        mend_fan(&vertices, &mut facets)?;
        let at = |v: u32| Vector2::from(outline[v as usize]);
        let area = |f: &[u32; 3]| 0.5 * cross(at(f[1]) - at(f[0]), at(f[2]) - at(f[0])).abs();
        let total = facets.iter().map(area).sum();
        Ok((facets, total))
    }

    fn shoelace(outline: &[[f64; 2]]) -> f64 {
        let n = outline.len();
        0.5 * (0..n).map(|i| cross(outline[i].into(), outline[(i + 1) % n].into())).sum::<f64>()
    }

    fn rotated(outline: &[[f64; 2]], first: usize) -> Vec<[f64; 2]> {
        outline[first..].iter().chain(&outline[..first]).copied().collect()
    }

    #[test]
    fn concave_outlines_keep_their_area_whatever_corner_comes_first() {
        let l = vec![[0.0, 0.0], [30.0, 0.0], [30.0, 10.0], [10.0, 10.0], [10.0, 30.0], [0.0, 30.0]];
        let u = vec![[0.0, 0.0], [9.0, 0.0], [9.0, 7.0], [6.0, 7.0], [6.0, 2.0], [3.0, 2.0], [3.0, 7.0], [0.0, 7.0]];
        // Corners on straight sides, which a neighbour may use.
        let flat = vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0], [0.0, 2.0], [0.0, 1.0]];
        let comb: Vec<[f64; 2]> = (0..20)
            .map(|i| [f64::from(i), if i % 2 == 0 { 5.0 } else { 0.5 }])
            .rev()
            .chain([[0.0, 0.0], [19.0, 0.0]])
            .collect();
        for outline in [l, u, flat, comb] {
            for first in 0..outline.len() {
                let outline = rotated(&outline, first);
                let (facets, area) = cut(&outline).unwrap();
                assert_eq!(facets.len(), outline.len() - 2);
                assert!((area / shoelace(&outline) - 1.0).abs() < 1e-12, "{outline:?}: {facets:?}");
            }
        }
    }

    #[test]
    fn an_outline_with_a_bridge_to_its_hole_is_cut() {
        // A square ring; the bridge joins (0,0) and (1,1).
        let vertices: Vec<[f64; 3]> = [[0, 0], [4, 0], [4, 4], [0, 4], [1, 1], [3, 1], [3, 3], [1, 3]]
            .map(|[x, y]| [f64::from(x), f64::from(y), 0.0])
            .to_vec();
        let mut facets = Vec::new();
        fan(&[0, 1, 2, 3, 0, 4, 7, 6, 5, 4], &mut facets);
        mend_fan(&vertices, &mut facets).unwrap();
        let mesh = crate::Mesh { vertices, facets };
        assert!((mesh.surface_area() - 12.0).abs() < 1e-12 && (0..8).all(|f| mesh.normal(f).z > 0.0));
    }

    #[test]
    fn outlines_that_cross_themselves_or_have_no_area_are_refused() {
        for outline in [
            vec![[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.1]],
            vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]],
            vec![[1.0, 1.0]; 5],
            vec![[f64::MAX, 0.0], [-f64::MAX, f64::MAX], [0.0, -f64::MAX], [f64::MAX, f64::MAX]],
        ] {
            assert!(matches!(cut(&outline), Err(PolygonFault::NotSimple { .. })), "{outline:?}");
        }
        let spiral: Vec<[f64; 2]> = (0..3000)
            .map(|i| (0.01 * f64::from(i), 1.0 + 0.1 * f64::from(i % 2)))
            .map(|(a, r)| [r * a.cos(), r * a.sin()])
            .collect();
        assert_eq!(cut(&spiral), Err(PolygonFault::TooManyCorners { corners: 3000 }));
    }

    #[test]
    fn repeated_corners_are_left_out() {
        let mut facets = Vec::new();
        fan(&[4, 5, 6, 6], &mut facets);
        fan(&[4, 4, 5, 6, 4], &mut facets);
        assert_eq!(facets, [[4, 5, 6], [4, 5, 6]]);
    }

    proptest! {
        /// Star-shaped about the origin, hence simple.
        #[test]
        fn prop_simple_outlines_keep_their_area(
            radii in prop::collection::vec(0.05f64..1.0, 4..40), first in any::<prop::sample::Index>(),
        ) {
            let n = radii.len() as f64;
            let angle = |i: usize| std::f64::consts::TAU * i as f64 / n;
            let outline: Vec<[f64; 2]> =
                radii.iter().enumerate().map(|(i, r)| [r * angle(i).cos(), r * angle(i).sin()]).collect();
            let outline = rotated(&outline, first.index(radii.len()));
            let (_, area) = cut(&outline).unwrap();
            prop_assert!((area / shoelace(&outline) - 1.0).abs() < 1e-9);
        }
    }
}
