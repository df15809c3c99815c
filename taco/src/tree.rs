//! The facets of a mesh in a tree of flat bounding discs.

use tiling::Mesh;

/// Facets in a leaf of the tree.
const LEAF: usize = 4;

/// Disc around a run of facets.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Node {
    pub centre: [f64; 3],
    pub radius: f64,
    /// Mean normal of the facets; zero if they cancel.
    pub normal: [f64; 3],
    /// Largest distance of a corner from the disc's plane, m.
    pub thickness: f64,
    /// Cosine and sine of the largest angle between `normal` and a facet's; 0 and 1 for any angle beyond 90 deg.
    pub spread: [f64; 2],
    /// Largest height of the centre above the plane of a facet, m.
    pub behind: f64,
    /// First facet of a leaf; the second child of an inner node, whose first child follows it in the array.
    pub at: u32,
    /// Facets of a leaf, 0 for an inner node.
    pub facets: u32,
    /// Coordinate that tells an inner node's children apart; the first child has the smaller ones.
    pub axis: usize,
}

impl Node {
    /// Whether no facet faces an observer from whom the centre is this far `away`, m.
    #[inline]
    pub fn faces_away(&self, away: &[f64; 3]) -> bool {
        let along = dot(&self.normal, away);
        if along <= 0.0 {
            return false;
        }
        // The highest that the observer can stand above a plane through the centre with a normal of the spread.
        let aside = (dot(away, away) - along * along).max(0.0).sqrt();
        aside * self.spread[1] - along * self.spread[0] + self.behind <= 0.0
    }
}

/// A facet with its plane: `normal . x > offset` on the side that it faces.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Occluder {
    pub corners: [[f64; 3]; 3],
    pub normal: [f64; 3],
    pub offset: f64,
    /// Index of the facet in its mesh.
    pub facet: u32,
}

/// All facets of a mesh in the order of their tree, and the tree: the root first.
pub(crate) fn tree(mesh: &Mesh) -> (Vec<Occluder>, Vec<Node>) {
    let occluder = |f| {
        let corners = mesh.corners(f);
        let normal = mesh.area_vector(f);
        let offset = normal.dot(&corners[0]);
        Occluder { corners: corners.map(Into::into), normal: normal.into(), offset, facet: f as u32 }
    };
    let mut occluders: Vec<_> = (0..mesh.facets.len()).map(occluder).collect();
    let mut nodes = Vec::with_capacity(occluders.len());
    build(&mut occluders, 0, &mut nodes);
    (occluders, nodes)
}

/// Sorts `occluders`, the slice that starts at number `offset`, into a tree that is appended to `nodes`.
fn build(occluders: &mut [Occluder], offset: usize, nodes: &mut Vec<Node>) {
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    let mut normal = [0.0; 3];
    for occluder in &*occluders {
        for k in 0..3 {
            for corner in &occluder.corners {
                low[k] = low[k].min(corner[k]);
                high[k] = high[k].max(corner[k]);
            }
            normal[k] += occluder.normal[k];
        }
    }
    let centre: [f64; 3] = std::array::from_fn(|k| 0.5 * (low[k] + high[k]));
    let length = dot(&normal, &normal).sqrt();
    normal = if length > 0.0 { normal.map(|c| c / length) } else { [0.0; 3] };
    let corners = || occluders.iter().flat_map(|o| &o.corners);
    let off_plane = |p: &[f64; 3]| (0..3).map(|k| normal[k] * (p[k] - centre[k])).sum::<f64>().abs();
    // A hair larger than it is, so that round-off cannot put a corner outside.
    let radius = corners().map(|p| square_distance(p, &centre)).fold(0.0, f64::max).sqrt() * (1.0 + 1e-12);
    let thickness = corners().map(off_plane).fold(0.0, f64::max) + 1e-12 * radius;
    let mut cosine = 1.0f64;
    let mut behind = 0.0f64;
    for occluder in &*occluders {
        let length = dot(&occluder.normal, &occluder.normal).sqrt();
        // A facet without area faces nobody.
        if length > 0.0 {
            cosine = cosine.min(dot(&normal, &occluder.normal) / length);
            behind = behind.max((dot(&occluder.normal, &centre) - occluder.offset) / length);
        }
    }
    let spread = if cosine > 0.0 { [cosine, (1.0 - cosine * cosine).max(0.0).sqrt()] } else { [0.0, 1.0] };
    // The same hair as above.
    let behind = behind + 1e-12 * radius;
    let index = nodes.len();
    nodes.push(Node {
        centre,
        radius,
        normal,
        thickness,
        spread,
        behind,
        at: offset as u32,
        facets: occluders.len() as u32,
        axis: 0,
    });
    if occluders.len() <= LEAF {
        return;
    }
    let axis = (0..3).max_by(|&i, &j| (high[i] - low[i]).total_cmp(&(high[j] - low[j]))).expect("three axes");
    let middle = occluders.len() / 2;
    let place = |o: &Occluder| o.corners.iter().map(|c| c[axis]).sum::<f64>();
    occluders.select_nth_unstable_by(middle, |a, b| place(a).total_cmp(&place(b)));
    let (left, right) = occluders.split_at_mut(middle);
    build(left, offset, nodes);
    let second = nodes.len() as u32;
    build(right, offset + middle, nodes);
    nodes[index] = Node { at: second, facets: 0, axis, ..nodes[index] };
}

fn square_distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum()
}

#[inline(always)]
pub(crate) fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
