//! Whether a mesh bounds a solid: every edge between two facets that agree on the orientation.

use crate::{Mesh, TilingError};

/// Twice a facet's area over its longest edge squared, below which the facet counts as degenerate: its normal would
/// be made of round-off.
const DEGENERATE: f64 = 1e-12;

impl Mesh {
    /// Checks that the mesh is a closed, consistently oriented surface around a positive volume, with finite vertices and
    /// non-degenerate facets. Several bodies and any number of handles are accepted. [`Mesh::check_body`] asks for more.
    ///
    /// # Errors
    /// The first kind of fault, in the order of [`TilingError`]'s variants, with all facets that have it.
    pub fn check(&self) -> Result<(), TilingError> {
        self.check_surface()?;
        let volume_m3 = self.volume();
        if volume_m3.is_nan() || volume_m3 <= 0.0 {
            return Err(TilingError::InsideOut { volume_m3 });
        }
        Ok(())
    }

    /// What [`Mesh::check`] asks for but the volume.
    pub(crate) fn check_surface(&self) -> Result<(), TilingError> {
        if self.vertices.len() < 4 || self.facets.len() < 4 {
            return Err(TilingError::Empty { vertices: self.vertices.len(), facets: self.facets.len() });
        }
        for (facet, corners) in self.facets.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|v| **v as usize >= self.vertices.len()) {
                return Err(TilingError::MissingVertex { facet, vertex, vertices: self.vertices.len() });
            }
        }
        for (vertex, coordinates) in self.vertices.iter().enumerate() {
            if let Some(axis) = coordinates.iter().position(|c| !c.is_finite()) {
                return Err(TilingError::NonFinite { vertex, axis, value: coordinates[axis] });
            }
        }
        let degenerate: Vec<usize> = (0..self.facets.len()).filter(|f| self.is_degenerate(*f)).collect();
        if !degenerate.is_empty() {
            return Err(TilingError::Degenerate { facets: degenerate });
        }
        self.check_edges()
    }

    /// Of a mesh with so many open edges: whether most of them close as soon as vertices in the same place are one vertex.
    fn unwelded(&self, open: usize) -> Option<TilingError> {
        let mut order: Vec<u32> = (0..self.vertices.len() as u32).collect();
        let at = |v: u32| self.vertices[v as usize];
        let compare =
            |a: &[f64; 3], b: &[f64; 3]| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])).then(a[2].total_cmp(&b[2]));
        order.sort_by(|a, b| compare(&at(*a), &at(*b)).then(a.cmp(b)));
        let mut first_there: Vec<u32> = (0..self.vertices.len() as u32).collect();
        let mut repeated = 0;
        for pair in order.windows(2) {
            if at(pair[0]) == at(pair[1]) {
                first_there[pair[1] as usize] = first_there[pair[0] as usize];
                repeated += 1;
            }
        }
        let facets = self.facets.iter().map(|f| f.map(|v| first_there[v as usize])).collect();
        let welded = Self { vertices: self.vertices.clone(), facets };
        let edges = welded.sorted_edges();
        let still_open = edges.chunk_by(|a, b| a.ends == b.ends).filter(|group| group.len() == 1).count();
        (2 * still_open < open).then_some(TilingError::Unwelded { repeated, vertices: self.vertices.len() })
    }

    /// `V - E + F` of the vertices in use: 2 for a closed body without handles, twice the number of such bodies.
    pub fn euler_characteristic(&self) -> i64 {
        let vertices = self.used_vertices().iter().filter(|used| **used).count();
        let edges = self.sorted_edges().chunk_by(|a, b| a.ends == b.ends).count();
        vertices as i64 - edges as i64 + self.facets.len() as i64
    }

    fn is_degenerate(&self, f: usize) -> bool {
        let [a, b, c] = self.corners(f);
        let longest = (b - a).norm_squared().max((c - b).norm_squared()).max((a - c).norm_squared());
        let has_area = 2.0 * self.area(f) > DEGENERATE * longest;
        // Said this way round, an overflow to NaN counts as degenerate.
        !has_area
    }

    pub(crate) fn check_edges(&self) -> Result<(), TilingError> {
        let (mut open, mut crowded, mut twisted) = (Vec::new(), Vec::new(), Vec::new());
        let edges = self.sorted_edges();
        for group in edges.chunk_by(|a, b| a.ends == b.ends) {
            match group {
                [_] => open.push(group),
                [a, b] if a.forward != b.forward => {}
                [_, _] => twisted.push(group),
                _ => crowded.push(group),
            }
        }
        let facets = |groups: &[&[Edge]]| {
            let mut facets: Vec<usize> = groups.iter().flat_map(|g| g.iter().map(|e| e.facet as usize)).collect();
            facets.sort_unstable();
            facets.dedup();
            facets
        };
        if !open.is_empty() {
            return Err(self
                .unwelded(open.len())
                .unwrap_or(TilingError::Open { edges: open.len(), facets: facets(&open) }));
        }
        if !crowded.is_empty() {
            return Err(TilingError::NonManifold { edges: crowded.len(), facets: facets(&crowded) });
        }
        if !twisted.is_empty() {
            return Err(TilingError::Orientation { edges: twisted.len(), facets: facets(&twisted) });
        }
        Ok(())
    }

    /// Of every edge between two facets: its vertices, the facet to its left (seen from outside, going from the first
    /// vertex to the second) and the one to its right. In ascending order of the vertices.
    pub(crate) fn edge_neighbours(&self) -> impl Iterator<Item = ((u32, u32), usize, usize)> {
        let mut edges = self.sorted_edges().into_iter().peekable();
        std::iter::from_fn(move || {
            loop {
                let one = edges.next()?;
                if let Some(other) = edges.next_if(|other| other.ends == one.ends) {
                    let (left, right) = if one.forward { (one.facet, other.facet) } else { (other.facet, one.facet) };
                    return Some((one.ends, left as usize, right as usize));
                }
            }
        })
    }

    /// Every facet's three edges, equal ones side by side. Sorted rather than hashed: the order reaches error messages.
    fn sorted_edges(&self) -> Vec<Edge> {
        let mut edges = Vec::with_capacity(3 * self.facets.len());
        for (facet, [a, b, c]) in self.facets.iter().enumerate() {
            for (from, to) in [(*a, *b), (*b, *c), (*c, *a)] {
                edges.push(Edge { ends: (from.min(to), from.max(to)), forward: from < to, facet: facet as u32 });
            }
        }
        edges.sort_unstable();
        edges
    }
}

/// One facet's side.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Edge {
    /// Vertices, the smaller number first.
    ends: (u32, u32),
    facet: u32,
    /// Whether the facet runs from the smaller to the larger vertex.
    forward: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::tests::cuboid;

    #[test]
    fn box_is_closed_and_has_euler_characteristic_two() {
        let mesh = cuboid(1.0, 2.0, 3.0);
        assert_eq!(mesh.check(), Ok(()));
        assert_eq!(mesh.euler_characteristic(), 2);
    }

    #[test]
    fn missing_facet_is_a_hole_beside_its_three_neighbours() {
        let mut mesh = cuboid(1.0, 2.0, 3.0);
        mesh.facets.remove(0);
        let fault = mesh.check().unwrap_err();
        assert!(matches!(&fault, TilingError::Open { edges: 3, facets } if facets.len() == 3), "{fault:?}");
        assert!(fault.to_string().starts_with("open mesh: a hole beside facets 1, "), "{fault}");
    }

    #[test]
    fn facets_with_corners_of_their_own_are_told_to_be_welded() {
        let mesh = cuboid(1.0, 2.0, 3.0);
        let vertices = mesh.facets.iter().flatten().map(|v| mesh.vertices[*v as usize]).collect();
        let soup = Mesh { vertices, facets: (0..12).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect() };
        let fault = soup.check().unwrap_err();
        assert_eq!(fault, TilingError::Unwelded { repeated: 28, vertices: 36 });
        assert!(fault.to_string().contains("weld the vertices"), "{fault}");
        // One seam, as programs leave it that cut a surface to unroll its picture: few vertices repeat.
        let mut seam = crate::fibonacci::unit_sphere(400).unwrap();
        let [a, b, _] = seam.facets[200];
        let copies = [a, b].map(|v| {
            seam.vertices.push(seam.vertices[v as usize]);
            seam.vertices.len() as u32 - 1
        });
        seam.facets[200][0] = copies[0];
        seam.facets[200][1] = copies[1];
        assert_eq!(seam.check(), Err(TilingError::Unwelded { repeated: 2, vertices: 402 }));
    }

    #[test]
    fn turned_facet_is_an_inconsistent_orientation() {
        let mut mesh = cuboid(1.0, 2.0, 3.0);
        mesh.facets[4].swap(0, 1);
        let fault = mesh.check().unwrap_err();
        assert!(matches!(&fault, TilingError::Orientation { edges: 3, facets } if facets.contains(&4)), "{fault:?}");
    }

    #[test]
    fn inside_out_body_is_refused_with_its_volume() {
        let mut mesh = cuboid(1.0, 2.0, 3.0);
        mesh.facets.iter_mut().for_each(|f| f.swap(0, 1));
        assert_eq!(mesh.check(), Err(TilingError::InsideOut { volume_m3: -6.0 }));
    }

    #[test]
    fn inner_wall_makes_edges_with_more_than_two_facets() {
        let mut mesh = cuboid(1.0, 1.0, 1.0);
        mesh.facets.extend([[0, 1, 7], [7, 6, 0]]);
        assert!(matches!(mesh.check(), Err(TilingError::NonManifold { .. })), "{:?}", mesh.check());
    }

    #[test]
    fn facet_without_area_is_named() {
        let mut mesh = cuboid(1.0, 2.0, 3.0);
        mesh.facets[7] = [3, 3, 1];
        mesh.facets[9] = [1, 2, 2];
        assert_eq!(mesh.check(), Err(TilingError::Degenerate { facets: vec![7, 9] }));
    }

    #[test]
    fn bad_vertices_are_named() {
        let mut mesh = cuboid(1.0, 2.0, 3.0);
        mesh.vertices[5][2] = f64::INFINITY;
        assert_eq!(mesh.check(), Err(TilingError::NonFinite { vertex: 5, axis: 2, value: f64::INFINITY }));
        mesh.facets[3][1] = 8;
        assert_eq!(mesh.check(), Err(TilingError::MissingVertex { facet: 3, vertex: 8, vertices: 8 }));
        assert!(matches!(Mesh::default().check(), Err(TilingError::Empty { vertices: 0, facets: 0 })));
    }
}
