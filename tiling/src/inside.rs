//! Whether points lie inside a closed mesh.
//!
//! The winding number of the mesh about the point, counted on a ray along +z. Facets are found in a grid of columns.
//! Whether the ray passes a facet is decided edge by edge: both facets of an edge evaluate the same expression in the
//! same order, so a ray through an edge or a vertex is never counted twice or lost. Only points within round-off of the
//! surface itself are left to chance.

use crate::{Mesh, TilingError};

/// Facet entries over facets above which the grid is made coarser: long facets cross many columns.
const MOST_ENTRIES: usize = 16;

/// A closed mesh prepared for many inside tests.
#[derive(Debug, Clone)]
pub struct Inside {
    mesh: Mesh,
    lower: [f64; 2],
    upper: [f64; 2],
    cells_per_metre: [f64; 2],
    cells: usize,
    /// Facets of column `c`: `entries[starts[c]..starts[c + 1]]`.
    starts: Vec<u32>,
    entries: Vec<u32>,
}

impl Inside {
    /// Prepares a mesh.
    ///
    /// # Errors
    /// Those of [`Mesh::check`].
    pub fn new(mesh: Mesh) -> Result<Self, TilingError> {
        mesh.check()?;
        Ok(Self::of_surface(mesh))
    }

    /// Prepares a closed surface, whatever its orientation.
    pub(crate) fn of_surface(mesh: Mesh) -> Self {
        let bound = |axis: usize, start: f64, pick: fn(f64, f64) -> f64| {
            mesh.vertices.iter().map(|v| v[axis]).fold(start, pick)
        };
        let lower = [0, 1].map(|axis| bound(axis, f64::INFINITY, f64::min));
        let upper = [0, 1].map(|axis| bound(axis, f64::NEG_INFINITY, f64::max));
        let mut grid =
            Self { lower, upper, cells_per_metre: [0.0; 2], cells: 0, starts: vec![], entries: vec![], mesh };
        let facets = grid.mesh.facets.len();
        grid.cells = (facets as f64).sqrt() as usize;
        loop {
            grid.cells_per_metre = [0, 1].map(|axis| grid.cells as f64 / (upper[axis] - lower[axis]));
            let entries: usize = (0..facets).map(|f| grid.columns_of(f).count()).sum();
            if entries <= MOST_ENTRIES * facets || grid.cells == 1 {
                break;
            }
            grid.cells = (grid.cells / 2).max(1);
        }
        grid.fill();
        grid
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Whether `point` (m) is inside. False for a point that is not finite.
    pub fn contains(&self, point: [f64; 3]) -> bool {
        self.crossings(point).map(|(_, crossing)| crossing).sum::<i32>() > 0
    }

    /// The facets that the upward ray from `point` passes, each with +1 where it leaves and -1 where it enters.
    pub(crate) fn crossings(&self, point: [f64; 3]) -> impl Iterator<Item = (usize, i32)> {
        let column = self.cell([point[0], point[1]]).map(|[i, j]| j * self.cells + i);
        let facets = column.map_or(0..0, |c| self.starts[c] as usize..self.starts[c + 1] as usize);
        let crossing = move |f: &u32| (*f as usize, self.crossing(*f as usize, point));
        self.entries[facets].iter().map(crossing).filter(|(_, crossing)| *crossing != 0)
    }

    /// Column of a point of the xy plane, if it is in the grid.
    fn cell(&self, point: [f64; 2]) -> Option<[usize; 2]> {
        let index = |axis: usize| {
            // NaN fails the comparison. The upper rim, which round-off may put beyond, belongs to the last cell.
            let within = (self.lower[axis]..=self.upper[axis]).contains(&point[axis]);
            let scaled = (point[axis] - self.lower[axis]) * self.cells_per_metre[axis];
            within.then(|| (scaled as usize).min(self.cells - 1))
        };
        Some([index(0)?, index(1)?])
    }

    /// Columns that the bounding box of facet `f` touches. Points are put into columns by the same monotonic function, so
    /// that the column of a point below a facet is always among them.
    fn columns_of(&self, f: usize) -> impl Iterator<Item = usize> + use<> {
        let corners = self.mesh.facets[f].map(|v| {
            let [x, y, _] = self.mesh.vertices[v as usize];
            self.cell([x, y]).expect("the grid spans all vertices")
        });
        let range = |axis: usize| {
            let [a, b, c] = corners.map(|cell| cell[axis]);
            a.min(b).min(c)..=a.max(b).max(c)
        };
        let (columns, cells) = (range(0), self.cells);
        range(1).flat_map(move |j| columns.clone().map(move |i| j * cells + i))
    }

    fn fill(&mut self) {
        let facets = self.mesh.facets.len();
        let mut starts = vec![0u32; self.cells * self.cells + 1];
        for f in 0..facets {
            self.columns_of(f).for_each(|column| starts[column + 1] += 1);
        }
        for column in 1..starts.len() {
            starts[column] += starts[column - 1];
        }
        let mut next = starts.clone();
        self.entries = vec![0; starts[starts.len() - 1] as usize];
        for f in 0..facets {
            for column in self.columns_of(f) {
                self.entries[next[column] as usize] = f as u32;
                next[column] += 1;
            }
        }
        self.starts = starts;
    }

    /// +1 if the upward ray from the point leaves the body through facet `f`, -1 if it enters, 0 if it passes by.
    fn crossing(&self, f: usize, [px, py, pz]: [f64; 3]) -> i32 {
        let corners = self.mesh.facets[f];
        let [a, b, c] = corners.map(|v| self.mesh.vertices[v as usize]);
        let highest = a[2].max(b[2]).max(c[2]);
        if highest <= pz {
            return 0;
        }
        // Winding number of the facet's outline about the ray, by the edges that a horizontal line to +x crosses.
        let mut winding = 0;
        for (from, to) in [(0, 1), (1, 2), (2, 0)] {
            let upward = corners[from] < corners[to];
            // Always from the smaller vertex number to the larger one, whichever facet asks.
            let (p, q) = if upward { (corners[from], corners[to]) } else { (corners[to], corners[from]) };
            let (p, q) = (self.mesh.vertices[p as usize], self.mesh.vertices[q as usize]);
            if (p[1] > py) == (q[1] > py) {
                continue;
            }
            let x = p[0] + (q[0] - p[0]) * ((py - p[1]) / (q[1] - p[1]));
            if x > px {
                let rises = q[1] > p[1];
                winding += if rises == upward { 1 } else { -1 };
            }
        }
        if winding == 0 || a[2].min(b[2]).min(c[2]) > pz {
            return winding;
        }
        // Height of the facet's plane above the point; a facet seen edge-on has none, but then the point is beside it.
        let u = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
        let v = [c[0] - a[0], c[1] - a[1], c[2] - a[2]];
        let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        let below = normal[0] * (a[0] - px) + normal[1] * (a[1] - py) + normal[2] * (a[2] - pz);
        if (below > 0.0) == (normal[2] > 0.0) { winding } else { 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::EllipsoidTiling;
    use crate::mesh::tests::cuboid;

    #[test]
    fn box_contains_what_its_coordinates_say_through_edges_and_vertices_too() {
        // The lattice's rays run along sides, through edges, diagonals and corners of the box.
        let inside = Inside::new(cuboid(4.0, 4.0, 4.0)).unwrap();
        let steps: Vec<f64> = (-4..=20).map(|i| 0.25 * f64::from(i)).collect();
        for x in &steps {
            for y in &steps {
                for z in &steps {
                    let within = |c: &f64| *c > 0.0 && *c < 4.0;
                    let on_surface = [x, y, z].iter().any(|c| **c == 0.0 || **c == 4.0);
                    if !on_surface {
                        assert_eq!(inside.contains([*x, *y, *z]), within(x) && within(y) && within(z), "{x} {y} {z}");
                    }
                }
            }
        }
    }

    /// The grid's upper rim, whatever round-off makes of it.
    #[test]
    fn any_box_is_prepared() {
        for i in 1..2000 {
            let side = (f64::from(i) * 0.7).sin().abs() + 0.1;
            let inside = Inside::new(cuboid(side, 0.3 * side, 3.0).translated([-side / 3.0, side, 1.0])).unwrap();
            assert!(inside.contains([0.0, 1.1 * side, 2.0]));
        }
    }

    /// Rays exactly through vertices and edge midpoints of a convex body, from points well inside and well outside.
    #[test]
    fn rays_through_vertices_and_edges_count_once() {
        let body = EllipsoidTiling::new([3.0, 2.0, 1.0], 500).unwrap().mesh;
        let inside = Inside::new(body.clone()).unwrap();
        for corners in &body.facets {
            let [a, b, _] = corners.map(|v| body.vertices[v as usize]);
            for p in [a, [0, 1, 2].map(|k| 0.5 * (a[k] + b[k]))] {
                let rim = (p[0] / 3.0).powi(2) + (p[1] / 2.0).powi(2);
                if rim < 0.95 {
                    assert!(inside.contains([p[0], p[1], 0.0]), "{p:?}");
                }
                assert!(!inside.contains([p[0], p[1], -1.01]) && !inside.contains([p[0], p[1], 1.01]), "{p:?}");
            }
        }
    }

    /// The share of a box's lattice points inside an ellipsoid's mesh is its volume's, to the boundary's roughness.
    #[test]
    fn lattice_points_inside_measure_the_volume() {
        let body = EllipsoidTiling::new([3.0, 2.0, 1.0], 1594).unwrap().mesh;
        let volume = body.volume();
        let inside = Inside::new(body).unwrap();
        let step = 0.04;
        let along = |half: f64| move |i: i32| (f64::from(i) + 0.5) * step - half;
        let mut count = 0;
        for i in 0..150 {
            for j in 0..100 {
                for k in 0..50 {
                    count += usize::from(inside.contains([along(3.0)(i), along(2.0)(j), along(1.0)(k)]));
                }
            }
        }
        assert!((count as f64 * step.powi(3) / volume - 1.0).abs() < 1e-3, "{count}");
    }

    #[test]
    fn non_finite_points_are_outside_and_open_meshes_are_refused() {
        let mut mesh = cuboid(1.0, 1.0, 1.0);
        let inside = Inside::new(mesh.clone()).unwrap();
        assert!(!inside.contains([f64::NAN, 0.5, 0.5]) && !inside.contains([0.5, 0.5, f64::NAN]));
        assert!(!inside.contains([f64::INFINITY, 0.5, 0.5]) && !inside.contains([0.5, 0.5, f64::NEG_INFINITY]));
        mesh.facets.pop();
        assert!(matches!(Inside::new(mesh), Err(TilingError::Open { .. })));
    }
}
