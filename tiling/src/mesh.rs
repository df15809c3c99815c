//! A triangle mesh: vertices and facets, counter-clockwise seen from outside.
//!
//! Facet quantities are functions of the index rather than stored arrays, so that nothing can disagree with the
//! vertices. Indexing a facet that refers to a missing vertex panics: run [`Mesh::check`] on meshes from outside first.

use nalgebra::{Matrix3, Vector3};

/// Triangle mesh, m.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Vertex coordinates, m.
    pub vertices: Vec<[f64; 3]>,
    /// Vertex indices of each facet, counter-clockwise seen from outside.
    pub facets: Vec<[u32; 3]>,
}

impl Mesh {
    /// The three corners of facet `f`, m.
    pub fn corners(&self, f: usize) -> [Vector3<f64>; 3] {
        self.facets[f].map(|v| Vector3::from(self.vertices[v as usize]))
    }

    /// Outward normal of facet `f` times its area, m^2.
    pub fn area_vector(&self, f: usize) -> Vector3<f64> {
        let [a, b, c] = self.corners(f);
        (b - a).cross(&(c - a)) * 0.5
    }

    /// Area of facet `f`, m^2.
    pub fn area(&self, f: usize) -> f64 {
        self.area_vector(f).norm()
    }

    /// Outward unit normal of facet `f`; NaN for a facet without area.
    pub fn normal(&self, f: usize) -> Vector3<f64> {
        self.area_vector(f).normalize()
    }

    /// Centroid of facet `f`, m.
    pub fn centroid(&self, f: usize) -> Vector3<f64> {
        let [a, b, c] = self.corners(f);
        (a + b + c) / 3.0
    }

    /// Shape quality of facet `f`: `4 sqrt(3) A / (l1^2 + l2^2 + l3^2)`, 1 for an equilateral triangle, 0 for a sliver.
    pub fn quality(&self, f: usize) -> f64 {
        let [a, b, c] = self.corners(f);
        let squares = (b - a).norm_squared() + (c - b).norm_squared() + (a - c).norm_squared();
        4.0 * 3f64.sqrt() * self.area(f) / squares
    }

    /// Areas of all facets, m^2.
    pub fn areas(&self) -> Vec<f64> {
        (0..self.facets.len()).map(|f| self.area(f)).collect()
    }

    /// Outward unit normals of all facets.
    pub fn normals(&self) -> Vec<[f64; 3]> {
        (0..self.facets.len()).map(|f| self.normal(f).into()).collect()
    }

    /// Centroids of all facets, m.
    pub fn centroids(&self) -> Vec<[f64; 3]> {
        (0..self.facets.len()).map(|f| self.centroid(f).into()).collect()
    }

    /// Total area, m^2.
    pub fn surface_area(&self) -> f64 {
        (0..self.facets.len()).map(|f| self.area(f)).sum()
    }

    /// Sum of the area vectors, m^2: zero to round-off exactly if the mesh is closed.
    pub fn area_vector_sum(&self) -> [f64; 3] {
        (0..self.facets.len()).map(|f| self.area_vector(f)).sum::<Vector3<f64>>().into()
    }

    /// A copy moved by `shift`, m.
    pub fn translated(&self, shift: [f64; 3]) -> Self {
        self.mapped(|[x, y, z]| [x + shift[0], y + shift[1], z + shift[2]])
    }

    /// A copy turned by the rotation matrix: each vertex `v` becomes `rotation * v`.
    pub fn rotated(&self, rotation: &Matrix3<f64>) -> Self {
        self.mapped(|v| (rotation * Vector3::from(v)).into())
    }

    /// A copy with every coordinate multiplied by `factor` (> 0).
    pub fn scaled(&self, factor: f64) -> Self {
        self.mapped(|v| v.map(|c| c * factor))
    }

    /// The mesh without the vertices that no facet uses, and how many these are. Facets keep their numbers and the vertices
    /// that stay their order.
    ///
    /// A stray vertex is no part of the body, but would be of its bounding box.
    pub fn without_unused_vertices(mut self) -> (Self, usize) {
        let used = self.used_vertices();
        let unused = used.iter().filter(|used| !**used).count();
        if unused > 0 {
            let mut next = 0_u32;
            let numbers: Vec<u32> = used
                .iter()
                .map(|used| {
                    let number = next;
                    next += u32::from(*used);
                    number
                })
                .collect();
            let mut keep = used.iter();
            self.vertices.retain(|_| keep.next().is_some_and(|used| *used));
            // A facet that names a vertex beyond the end still does.
            let missing = next;
            let renumber = |v: &mut u32| *v = numbers.get(*v as usize).copied().unwrap_or(missing);
            self.facets.iter_mut().flatten().for_each(renumber);
        }
        (self, unused)
    }

    /// Of every vertex, whether a facet uses it.
    pub(crate) fn used_vertices(&self) -> Vec<bool> {
        let mut used = vec![false; self.vertices.len()];
        for v in self.facets.iter().flatten() {
            if let Some(used) = used.get_mut(*v as usize) {
                *used = true;
            }
        }
        used
    }

    fn mapped(&self, map: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        Self { vertices: self.vertices.iter().map(|v| map(*v)).collect(), facets: self.facets.clone() }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A box with one corner at the origin, two triangles a side.
    pub(crate) fn cuboid(a: f64, b: f64, c: f64) -> Mesh {
        let vertices = (0..8).map(|i| [a * (i & 1) as f64, b * (i >> 1 & 1) as f64, c * (i >> 2) as f64]).collect();
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let facets = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
        Mesh { vertices, facets }
    }

    #[test]
    fn box_facets_have_their_areas_normals_and_centroids() {
        let mesh = cuboid(1.0, 2.0, 4.0);
        assert_eq!(mesh.surface_area(), 2.0 * (2.0 + 4.0 + 8.0));
        assert_eq!(mesh.area_vector_sum(), [0.0; 3]);
        assert_eq!(mesh.normals()[0], [0.0, 0.0, -1.0]);
        assert_eq!(mesh.normals()[11], [1.0, 0.0, 0.0]);
        assert_eq!(mesh.areas()[0], 1.0);
        let c = mesh.centroids()[0];
        assert!((c[0] - 1.0 / 3.0).abs() < 1e-15 && (c[1] - 4.0 / 3.0).abs() < 1e-15 && c[2] == 0.0);
    }

    #[test]
    fn vertices_that_no_facet_uses_are_dropped_and_change_no_integral() {
        let plain = cuboid(1.0, 2.0, 4.0);
        let mut stray = plain.clone();
        for (place, far) in [(0, 1e6), (4, -1e9), (10, 3.0)] {
            stray.vertices.insert(place, [far, far, -far]);
            stray.facets.iter_mut().flatten().for_each(|v| *v += u32::from(*v >= place as u32));
        }
        let solid = stray.solid();
        assert_eq!(solid, plain.solid());
        assert_eq!((stray.volume(), stray.check_contact()), (8.0, Ok(())));
        assert_eq!(stray.without_unused_vertices(), (plain.clone(), 3));
        assert_eq!(plain.clone().without_unused_vertices(), (plain, 0));
    }

    #[test]
    fn equilateral_triangle_has_quality_one() {
        let mesh = Mesh { vertices: vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], facets: vec![[0, 1, 2]] };
        assert!((mesh.quality(0) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn copies_move_turn_and_scale() {
        let quarter_turn = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
        let mesh = cuboid(1.0, 2.0, 4.0).translated([1.0, 0.0, 0.0]).rotated(&quarter_turn).scaled(2.0);
        assert_eq!(mesh.vertices[0], [0.0, 2.0, 0.0]);
        assert_eq!(mesh.vertices[7], [-4.0, 4.0, 8.0]);
        assert!((mesh.volume() - 64.0).abs() < 1e-12);
    }
}
