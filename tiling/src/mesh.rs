//! A triangle mesh: vertices and facets, counter-clockwise seen from outside.

/// Triangle mesh, m.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Vertex coordinates, m.
    pub vertices: Vec<[f64; 3]>,
    /// Vertex indices of each facet, counter-clockwise seen from outside.
    pub facets: Vec<[u32; 3]>,
}
