//! Whether a closed mesh touches or crosses itself.
//!
//! A body that casts shadows must have an inside and an outside everywhere: facets may meet only in the edges and vertices
//! that they share, and around a vertex they must form a single fan. Candidates come from a tree of bounding boxes; a pair
//! is then in contact if an edge of one meets the other, in the plane or through it.

use crate::{Mesh, TilingError};
use nalgebra::Vector3;

/// Distance, over the diagonal of the bounding box, within which facets count as touching: round-off of coordinates, far
/// below the steps between facets of any shape model.
const TOUCHING: f64 = 1e-9;
/// Facets in a leaf of the tree.
const LEAF: usize = 4;

/// Lowest and highest coordinates of a box.
type Bounds = ([f64; 3], [f64; 3]);

impl Mesh {
    /// Checks that no facet of a mesh that passes [`Mesh::check`] touches or crosses another except in the edges and
    /// vertices that they share, and that no vertex joins sheets that are otherwise apart.
    ///
    /// # Errors
    /// [`TilingError::PinchedVertices`] or [`TilingError::SelfContact`], with all facets that are at fault.
    pub fn check_contact(&self) -> Result<(), TilingError> {
        let (vertices, facets) = self.pinched();
        if !vertices.is_empty() {
            return Err(TilingError::PinchedVertices { vertices, facets });
        }
        let (low, high) = bounds(self.facets.iter().flatten().map(|v| &self.vertices[*v as usize]));
        let tolerance = TOUCHING * (Vector3::from(high) - Vector3::from(low)).norm();
        let tree = BoxTree::new(self, tolerance);
        let mut facets = Vec::new();
        let mut pairs = 0;
        let mut stack = Vec::new();
        for one in 0..self.facets.len() {
            tree.overlapping(one, &mut stack, |other| {
                if self.in_contact(one, other, tolerance) {
                    facets.extend([one, other]);
                    pairs += 1;
                }
            });
        }
        if pairs == 0 {
            return Ok(());
        }
        facets.sort_unstable();
        facets.dedup();
        Err(TilingError::SelfContact { pairs, facets })
    }

    /// Vertices whose facets form more than one fan, and those facets.
    fn pinched(&self) -> (Vec<usize>, Vec<usize>) {
        // Around a vertex every facet leads from one neighbour to the next.
        let mut links: Vec<[u32; 4]> = Vec::with_capacity(3 * self.facets.len());
        for (f, &[a, b, c]) in self.facets.iter().enumerate() {
            links.extend([[a, b, c, f as u32], [b, c, a, f as u32], [c, a, b, f as u32]]);
        }
        links.sort_unstable();
        let (mut vertices, mut facets) = (Vec::new(), Vec::new());
        for around in links.chunk_by(|a, b| a[0] == b[0]) {
            let mut at = around[0][2];
            let mut fan = 1;
            while at != around[0][1] && fan <= around.len() {
                let Ok(next) = around.binary_search_by_key(&at, |link| link[1]) else { break };
                at = around[next][2];
                fan += 1;
            }
            if fan != around.len() {
                vertices.push(around[0][0] as usize);
                facets.extend(around.iter().map(|link| link[3] as usize));
            }
        }
        facets.sort_unstable();
        facets.dedup();
        (vertices, facets)
    }

    /// Whether two facets meet anywhere but in the vertices that they share.
    fn in_contact(&self, one: usize, other: usize, tolerance: f64) -> bool {
        let (f, g) = (self.facets[one], self.facets[other]);
        let shared = |v: &u32, of: &[u32; 3]| of.contains(v);
        let (a, b) = (self.corners(one), self.corners(other));
        match f.iter().filter(|v| shared(v, &g)).count() {
            0 => {
                let sides = |t: &[Vector3<f64>; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
                sides(&a).iter().any(|s| meets(s, &b, tolerance)) || sides(&b).iter().any(|s| meets(s, &a, tolerance))
            }
            1 => {
                // Any line through the shared vertex meets the other plane there; the opposite sides decide.
                let opposite = |t: &[Vector3<f64>; 3], own: &[u32; 3], of: &[u32; 3]| {
                    let k = own.iter().position(|v| shared(v, of)).expect("one vertex is shared");
                    [t[(k + 1) % 3], t[(k + 2) % 3]]
                };
                meets(&opposite(&a, &f, &g), &b, tolerance) || meets(&opposite(&b, &g, &f), &a, tolerance)
            }
            2 => {
                // Neighbours touch only if one is folded back onto the other.
                let apex = |t: &[Vector3<f64>; 3], own: &[u32; 3], of: &[u32; 3]| {
                    let k = own.iter().position(|v| !shared(v, of)).expect("one vertex is not shared");
                    (t[k], t[(k + 1) % 3], t[(k + 2) % 3])
                };
                let ((p, u, v), (q, ..)) = (apex(&a, &f, &g), apex(&b, &g, &f));
                let along = (v - u).normalize();
                let off = |x: Vector3<f64>| (x - u) - along * (x - u).dot(&along);
                let (p, q) = (off(p), off(q));
                // The lower apex lies in the plane of the higher one, on its side.
                let (low, high) = if p.norm() < q.norm() { (p, q) } else { (q, p) };
                low.dot(&high) > 0.0 && low.cross(&high).norm() <= tolerance * high.norm()
            }
            _ => true,
        }
    }
}

/// Whether a segment comes within about the tolerance of a triangle.
fn meets(segment: &[Vector3<f64>; 2], triangle: &[Vector3<f64>; 3], tolerance: f64) -> bool {
    let [a, b, c] = triangle;
    let normal = (b - a).cross(&(c - a)).normalize();
    let height = |p: &Vector3<f64>| {
        let height = normal.dot(&(p - a));
        if height.abs() <= tolerance { 0.0 } else { height }
    };
    let (from, to) = (height(&segment[0]), height(&segment[1]));
    if from * to > 0.0 {
        return false;
    }
    if from == 0.0 && to == 0.0 {
        return meets_in_plane(segment, triangle, &normal, tolerance);
    }
    let point = segment[0] + (segment[1] - segment[0]) * (from / (from - to));
    is_inside(&point, triangle, &normal, tolerance)
}

/// Whether a point of the triangle's plane lies in it.
fn is_inside(point: &Vector3<f64>, triangle: &[Vector3<f64>; 3], normal: &Vector3<f64>, tolerance: f64) -> bool {
    (0..3).all(|k| {
        let (u, v) = (triangle[k], triangle[(k + 1) % 3]);
        normal.cross(&(v - u)).normalize().dot(&(point - u)) >= -tolerance
    })
}

/// Whether a segment in the triangle's plane meets it: it ends inside or crosses a side.
fn meets_in_plane(
    segment: &[Vector3<f64>; 2],
    triangle: &[Vector3<f64>; 3],
    normal: &Vector3<f64>,
    tolerance: f64,
) -> bool {
    if segment.iter().any(|p| is_inside(p, triangle, normal, tolerance)) {
        return true;
    }
    let side = |from: &Vector3<f64>, to: &Vector3<f64>, p: &Vector3<f64>| normal.cross(&(to - from)).dot(&(p - from));
    let [p, q] = segment;
    (0..3).any(|k| {
        let (u, v) = (&triangle[k], &triangle[(k + 1) % 3]);
        side(p, q, u) * side(p, q, v) < 0.0 && side(u, v, p) * side(u, v, q) < 0.0
    })
}

/// The box around points.
fn bounds<'a>(points: impl Iterator<Item = &'a [f64; 3]>) -> Bounds {
    let start = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    points.fold(start, |(low, high), p| {
        (std::array::from_fn(|k| low[k].min(p[k])), std::array::from_fn(|k| high[k].max(p[k])))
    })
}

/// Axis-aligned boxes of the facets, a hair larger than they are, in a binary tree.
struct BoxTree {
    boxes: Vec<Bounds>,
    /// Facets in the order of the leaves.
    order: Vec<u32>,
    /// Box, range in `order`, and second child of an inner node (0 in a leaf); the first child follows its parent.
    nodes: Vec<(Bounds, [u32; 2], u32)>,
}

impl BoxTree {
    fn new(mesh: &Mesh, tolerance: f64) -> Self {
        let of = |f: &[u32; 3]| {
            let (low, high) = bounds(f.iter().map(|v| &mesh.vertices[*v as usize]));
            (low.map(|c| c - tolerance), high.map(|c| c + tolerance))
        };
        let boxes = mesh.facets.iter().map(of).collect();
        let order = (0..mesh.facets.len() as u32).collect();
        let mut tree = Self { boxes, order, nodes: Vec::new() };
        tree.build(0, mesh.facets.len());
        tree
    }

    fn build(&mut self, from: usize, to: usize) {
        let all = &self.order[from..to];
        let start = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        let (low, high) = all.iter().map(|f| &self.boxes[*f as usize]).fold(start, |(low, high), b| {
            (std::array::from_fn(|k| low[k].min(b.0[k])), std::array::from_fn(|k| high[k].max(b.1[k])))
        });
        let node = self.nodes.len();
        self.nodes.push(((low, high), [from as u32, to as u32], 0));
        if to - from <= LEAF {
            return;
        }
        let axis = (0..3).max_by(|&i, &j| (high[i] - low[i]).total_cmp(&(high[j] - low[j]))).expect("three axes");
        let middle = (from + to) / 2;
        let boxes = &self.boxes;
        let place = |f: &u32| boxes[*f as usize].0[axis] + boxes[*f as usize].1[axis];
        let by_place = |f: &u32, g: &u32| place(f).total_cmp(&place(g)).then(f.cmp(g));
        self.order[from..to].select_nth_unstable_by(middle - from, by_place);
        self.build(from, middle);
        self.nodes[node].2 = self.nodes.len() as u32;
        self.build(middle, to);
    }

    /// Calls `found` for each facet of a higher number whose box overlaps that of facet `one`.
    fn overlapping(&self, one: usize, stack: &mut Vec<u32>, mut found: impl FnMut(usize)) {
        let own = &self.boxes[one];
        let overlaps = |b: &Bounds| (0..3).all(|k| own.0[k] <= b.1[k] && b.0[k] <= own.1[k]);
        stack.clear();
        stack.push(0);
        while let Some(node) = stack.pop() {
            let (bounds, [from, to], second) = &self.nodes[node as usize];
            if !overlaps(bounds) {
                continue;
            }
            if *second > 0 {
                stack.extend([*second, node + 1]);
                continue;
            }
            for &other in &self.order[*from as usize..*to as usize] {
                if other as usize > one && overlaps(&self.boxes[other as usize]) {
                    found(other as usize);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::tests::cuboid;
    use nalgebra::Rotation3;

    /// Two bodies in one mesh.
    fn both(a: &Mesh, b: &Mesh) -> Mesh {
        let offset = a.vertices.len() as u32;
        let facets = a.facets.iter().copied().chain(b.facets.iter().map(|f| f.map(|v| v + offset)));
        Mesh { vertices: a.vertices.iter().chain(&b.vertices).copied().collect(), facets: facets.collect() }
    }

    fn turned(mesh: &Mesh) -> Mesh {
        mesh.rotated(Rotation3::from_euler_angles(0.3, -1.1, 0.7).matrix())
    }

    #[test]
    fn convex_bodies_and_bodies_apart_are_free_of_contact() {
        let cube = cuboid(1.0, 1.0, 1.0);
        let sphere = crate::fibonacci::unit_sphere(500).unwrap();
        for mesh in
            [cube.clone(), cuboid(1.0, 1.0, 1e-3), sphere, both(&cube, &cube.translated([1.0 + 1e-6, 0.0, 0.0]))]
        {
            assert_eq!(mesh.check_contact(), Ok(()));
            assert_eq!(turned(&mesh).check_contact(), Ok(()));
        }
    }

    #[test]
    fn bodies_that_cross_or_touch_are_named() {
        let cube = cuboid(1.0, 1.0, 1.0);
        // Crossing, face on face, face on part of a face, edge on edge, corner on corner, a corner on a face, inside touching.
        let shifts = [[0.5, 0.4, 0.3], [1.0, 0.0, 0.0], [1.0, 0.3, 0.2], [1.0, 1.0, 0.2], [1.0, 1.0, 1.0]];
        for shift in shifts {
            let mesh = both(&cube, &cube.translated(shift));
            for mesh in [turned(&mesh), mesh] {
                assert_eq!(mesh.check(), Ok(()));
                let fault = mesh.check_contact().unwrap_err();
                let TilingError::SelfContact { pairs, facets } = &fault else { panic!("{fault:?}") };
                assert!(*pairs > 0 && facets[0] < 12 && facets[facets.len() - 1] >= 12, "{shift:?}: {fault}");
                assert!(fault.to_string().starts_with("self-touching mesh: "), "{fault}");
            }
        }
    }

    #[test]
    fn sheets_that_share_a_vertex_are_named() {
        let cube = cuboid(1.0, 1.0, 1.0);
        let mut mesh = both(&cube, &cube.translated([1.0, 1.0, 1.0]));
        // The far corner of the first is the near corner of the second.
        mesh.facets.iter_mut().flatten().filter(|v| **v == 8).for_each(|v| *v = 7);
        let fault = mesh.check_contact().unwrap_err();
        assert!(matches!(&fault, TilingError::PinchedVertices { vertices, .. } if vertices == &[7]), "{fault:?}");
    }

    #[test]
    fn facet_folded_back_onto_its_neighbour_is_found() {
        let mut mesh = crate::fibonacci::unit_sphere(100).unwrap();
        let [a, b, c] = mesh.facets[10].map(|v| v as usize);
        // A vertex pushed across the opposite side, within the surface.
        mesh.vertices[a] = std::array::from_fn(|k| {
            0.5 * (mesh.vertices[b][k] + mesh.vertices[c][k]) * 1.6 - 0.6 * mesh.vertices[a][k]
        });
        assert!(matches!(mesh.check_contact(), Err(TilingError::SelfContact { .. })));
    }
}
