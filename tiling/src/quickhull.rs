//! Convex hull of points by the quickhull algorithm (Barber, Dobkin & Huhdanpaa 1996, ACM Trans. Math. Softw. 22, 469).
//!
//! Written here because bodies carved from lattices have many centres in one plane: the hull of the ray-casting library
//! that was tried (parry3d 0.31) returns open or degenerate surfaces for those. Coplanar points are met as in Qhull's
//! option QJ: if the result is not convex or not closed, the points are displaced a little and hulled again.

use crate::fibonacci::fibonacci_points;
use crate::{Mesh, TilingError};
use nalgebra::Vector3;

/// Displacements tried one after the other, over the largest coordinate.
const JOGGLES: [f64; 4] = [0.0, 1e-9, 1e-7, 1e-5];

/// Height above a facet from which on a point counts as outside, over the largest coordinate: above round-off, below the
/// first joggle.
const THICKNESS: f64 = 1e-13;

/// Convex hull of points (m), oriented outward. Its vertices are the points on the hull, in their order.
///
/// # Errors
/// [`TilingError::Hull`] if there are fewer than 4 points, if they lie in a plane, or if one is not finite.
pub fn convex_hull(points: &[[f64; 3]]) -> Result<Mesh, TilingError> {
    let size = points.iter().flatten().fold(0f64, |size, c| size.max(c.abs()));
    let failed = TilingError::Hull { points: points.len() };
    if points.len() < 4 || points.iter().flatten().any(|c| !c.is_finite()) {
        return Err(failed);
    }
    let shifts = fibonacci_points(points.len());
    let unmoved: Vec<Vector3<f64>> = points.iter().map(|p| Vector3::from(*p)).collect();
    // Displacing flat points would only give them a hull of round-off.
    Hull::new(&unmoved, THICKNESS * size).first_tetrahedron().ok_or(failed.clone())?;
    let attempt = |joggle: &f64| {
        let moved = unmoved.iter().zip(&shifts).map(|(p, d)| p + Vector3::from(*d) * (joggle * size));
        let moved: Vec<Vector3<f64>> = moved.collect();
        let facets = Hull::of(&moved, THICKNESS * size)?.facets();
        let mesh = in_use(&moved, facets);
        is_convex(&mesh, size).then_some(mesh)
    };
    JOGGLES.iter().find_map(attempt).ok_or(failed)
}

/// The mesh of those points that have facets.
fn in_use(points: &[Vector3<f64>], mut facets: Vec<[u32; 3]>) -> Mesh {
    let mut number = vec![u32::MAX; points.len()];
    facets.iter().flatten().for_each(|v| number[*v as usize] = 0);
    let used = (0..points.len()).filter(|v| number[*v] == 0).collect::<Vec<_>>();
    used.iter().zip(0..).for_each(|(v, new)| number[*v] = new);
    facets.iter_mut().flatten().for_each(|v| *v = number[*v as usize]);
    Mesh { vertices: used.iter().map(|v| points[*v].into()).collect(), facets }
}

/// Whether a mesh is closed and convex at every edge, hence convex.
fn is_convex(mesh: &Mesh, size: f64) -> bool {
    let below = |f: usize, p: &Vector3<f64>| {
        let [a, b, c] = mesh.corners(f);
        (b - a).cross(&(c - a)).dot(&(p - a)) < 1e-9 * size.powi(3)
    };
    let convex = || mesh.edge_neighbours().all(|(_, left, right)| mesh.corners(right).iter().all(|p| below(left, p)));
    mesh.check_edges().is_ok() && mesh.euler_characteristic() == 2 && convex()
}

/// A hull under construction.
struct Hull<'a> {
    points: &'a [Vector3<f64>],
    thickness: f64,
    facets: Vec<Facet>,
}

struct Facet {
    corners: [u32; 3],
    /// Facet across the side from corner `k` to corner `k + 1`.
    neighbours: [usize; 3],
    normal: Vector3<f64>,
    /// Points above this facet that are not yet in the hull; each is in the list of one facet only.
    outside: Vec<u32>,
    /// Cleared once a point above it has taken its place.
    alive: bool,
}

impl<'a> Hull<'a> {
    fn new(points: &'a [Vector3<f64>], thickness: f64) -> Self {
        Self { points, thickness, facets: Vec::new() }
    }

    /// The hull, unless the points are flat to the thickness or round-off tore it.
    fn of(points: &'a [Vector3<f64>], thickness: f64) -> Option<Self> {
        let mut hull = Self::new(points, thickness);
        let corners = hull.first_tetrahedron()?;
        let rest: Vec<u32> = (0..points.len() as u32).filter(|p| !corners.contains(p)).collect();
        hull.distribute(&rest, 0);
        let mut start_of = vec![usize::MAX; points.len()];
        let mut f = 0;
        while f < hull.facets.len() {
            if hull.facets[f].alive && !hull.facets[f].outside.is_empty() {
                hull.raise(f, &mut start_of)?;
            }
            f += 1;
        }
        Some(hull)
    }

    fn facets(self) -> Vec<[u32; 3]> {
        self.facets.into_iter().filter(|f| f.alive).map(|f| f.corners).collect()
    }

    fn height(&self, f: usize, point: u32) -> f64 {
        let facet = &self.facets[f];
        facet.normal.dot(&(self.points[point as usize] - self.points[facet.corners[0] as usize]))
    }

    fn push(&mut self, corners: [u32; 3], neighbours: [usize; 3]) {
        let [a, b, c] = corners.map(|p| self.points[p as usize]);
        let normal = (b - a).cross(&(c - a)).normalize();
        self.facets.push(Facet { corners, neighbours, normal, outside: Vec::new(), alive: true });
    }

    /// Four points far apart and the facets between them.
    fn first_tetrahedron(&mut self) -> Option<[u32; 4]> {
        let points = self.points;
        let furthest = |measure: &dyn Fn(&Vector3<f64>) -> f64| {
            (0..points.len()).max_by(|i, j| measure(&points[*i]).total_cmp(&measure(&points[*j])))
        };
        let a = furthest(&|p| p.x)?;
        let b = furthest(&|p| (p - points[a]).norm_squared())?;
        let along = (points[b] - points[a]).normalize();
        let c = furthest(&|p| (p - points[a]).cross(&along).norm_squared())?;
        let normal = along.cross(&(points[c] - points[a])).normalize();
        let d = furthest(&|p| (p - points[a]).dot(&normal).abs())?;
        let height = (points[d] - points[a]).dot(&normal);
        // Coincident points make it NaN.
        if height.is_nan() || height.abs() <= self.thickness {
            return None;
        }
        let (b, c) = if height < 0.0 { (b, c) } else { (c, b) };
        let [a, b, c, d] = [a, b, c, d].map(|i| i as u32);
        self.push([a, b, c], [1, 2, 3]);
        self.push([b, a, d], [0, 3, 2]);
        self.push([c, b, d], [0, 1, 3]);
        self.push([a, c, d], [0, 2, 1]);
        Some([a, b, c, d])
    }

    /// Puts each point that is outside into the list of the first facet, from `first` on, that it is above.
    fn distribute(&mut self, points: &[u32], first: usize) {
        for point in points {
            if let Some(f) = (first..self.facets.len()).find(|f| self.height(*f, *point) > self.thickness) {
                self.facets[f].outside.push(*point);
            }
        }
    }

    /// Takes the highest point above facet `f` into the hull: the facets that it sees give way to a cone.
    /// `start_of` is scratch, one entry a point.
    fn raise(&mut self, f: usize, start_of: &mut [usize]) -> Option<()> {
        let higher = |i: &&u32, j: &&u32| self.height(f, **i).total_cmp(&self.height(f, **j));
        let apex = *self.facets[f].outside.iter().max_by(higher)?;
        let mut seen = vec![f];
        let mut orphans = Vec::new();
        let mut horizon = Vec::new();
        self.facets[f].alive = false;
        let mut next = 0;
        while next < seen.len() {
            let here = seen[next];
            orphans.append(&mut self.facets[here].outside);
            for side in 0..3 {
                let there = self.facets[here].neighbours[side];
                if !self.facets[there].alive {
                    continue;
                }
                if self.height(there, apex) > self.thickness {
                    self.facets[there].alive = false;
                    seen.push(there);
                } else {
                    let corners = self.facets[here].corners;
                    horizon.push((corners[side], corners[(side + 1) % 3], there));
                }
            }
            next += 1;
        }
        let first = self.facets.len();
        for (from, to, there) in &horizon {
            // A vertex met twice: round-off made the horizon something else than a simple loop.
            if start_of[*from as usize] != usize::MAX {
                return None;
            }
            start_of[*from as usize] = self.facets.len();
            let side = self.facets[*there].corners.iter().position(|c| c == to)?;
            self.facets[*there].neighbours[side] = self.facets.len();
            self.push([*from, *to, apex], [*there, usize::MAX, usize::MAX]);
        }
        for new in first..self.facets.len() {
            let to = self.facets[new].corners[1];
            let following = start_of[to as usize];
            self.facets[new].neighbours[1] = following;
            self.facets.get_mut(following)?.neighbours[2] = new;
        }
        for (from, _, _) in &horizon {
            start_of[*from as usize] = usize::MAX;
        }
        orphans.retain(|p| *p != apex);
        self.distribute(&orphans, first);
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn cube_with_points_inside_on_its_faces_and_twice_is_a_cube() {
        let axis = [-1.0, -0.5, 0.0, 0.5, 1.0];
        let mut points: Vec<[f64; 3]> =
            axis.iter().flat_map(|x| axis.iter().flat_map(move |y| axis.map(|z| [*x, *y, z]))).collect();
        points.extend(points.clone());
        let hull = convex_hull(&points).unwrap();
        assert!((hull.volume() - 8.0).abs() < 1e-3, "{}", hull.volume());
    }

    fn contains_all(hull: &Mesh, points: &[[f64; 3]], thickness: f64) -> bool {
        (0..hull.facets.len()).all(|f| {
            let (normal, on) = (hull.normal(f), hull.corners(f)[0]);
            points.iter().all(|p| normal.dot(&(Vector3::from(*p) - on)) < thickness)
        })
    }

    proptest! {
        #[test]
        fn prop_hull_contains_all_points_and_is_a_closed_surface(
            points in prop::collection::vec(prop::array::uniform3(-1.0f64..1.0), 4..60),
        ) {
            let hull = convex_hull(&points).unwrap();
            prop_assert!(contains_all(&hull, &points, 1e-9));
            prop_assert!(hull.euler_characteristic() == 2 && hull.volume() > 0.0);
            prop_assert!(hull.vertices.iter().all(|v| points.contains(v)));
        }

        /// Small integers: many points twice, on lines and in planes.
        #[test]
        fn prop_hull_of_lattice_points_contains_them_or_they_are_flat(
            points in prop::collection::vec(prop::array::uniform3(-2i32..=2), 4..80),
        ) {
            let points: Vec<[f64; 3]> = points.iter().map(|p| p.map(f64::from)).collect();
            match convex_hull(&points) {
                Ok(hull) => prop_assert!(contains_all(&hull, &points, 1e-3) && hull.volume() > 0.1),
                Err(_) => {
                    let p = points.iter().map(|p| Vector3::from(*p)).collect::<Vec<_>>();
                    let spans = |b: &Vector3<f64>, c: &Vector3<f64>| {
                        p.iter().any(|d| (b - p[0]).cross(&(c - p[0])).dot(&(d - p[0])) != 0.0)
                    };
                    prop_assert!(!p.iter().any(|b| p.iter().any(|c| spans(b, c))));
                }
            }
        }
    }

    #[test]
    fn points_on_a_sphere_are_all_kept_in_order() {
        let points = fibonacci_points(1000);
        assert_eq!(convex_hull(&points).unwrap().vertices, points);
        let with_inner: Vec<_> = points.iter().flat_map(|p| [p.map(|c| 0.5 * c), *p]).collect();
        assert_eq!(convex_hull(&with_inner).unwrap().vertices, points);
    }

    #[test]
    fn flat_few_or_non_finite_points_are_refused() {
        assert_eq!(convex_hull(&[]), Err(TilingError::Hull { points: 0 }));
        assert_eq!(convex_hull(&[[1.0, 2.0, 3.0]; 9]), Err(TilingError::Hull { points: 9 }));
        let mut points = fibonacci_points(9);
        points[4][1] = f64::NAN;
        assert_eq!(convex_hull(&points), Err(TilingError::Hull { points: 9 }));
    }
}
