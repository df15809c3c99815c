//! What can go wrong with a mesh or its fit.
//!
//! Facets and vertices are numbered from 0 in the fields and from 1, as in OBJ files, in the messages.

use crate::implicit::MAX_EXPONENT;
use crate::obj::ObjFault;

/// Why a mesh was refused or could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TilingError {
    /// No vertex or no facet.
    #[error("the mesh has {vertices} vertices and {facets} facets; a closed body needs at least 4 of each")]
    Empty {
        /// Vertices found.
        vertices: usize,
        /// Facets found.
        facets: usize,
    },
    /// A facet refers to a vertex that does not exist.
    #[error("facet {} refers to vertex {}, but there are {vertices}", facet + 1, u64::from(*vertex) + 1)]
    MissingVertex {
        /// The facet.
        facet: usize,
        /// The vertex it names.
        vertex: u32,
        /// Vertices there are.
        vertices: usize,
    },
    /// A coordinate that is NaN or infinite.
    #[error("vertex {}: coordinate {} is {value}, which must be finite", vertex + 1, ["x", "y", "z"][*axis])]
    NonFinite {
        /// The vertex.
        vertex: usize,
        /// 0, 1, 2 for x, y, z.
        axis: usize,
        /// The value found, m.
        value: f64,
    },
    /// Facets without area: repeated or collinear corners.
    #[error("degenerate mesh: no area in {}", list("facet", facets))]
    Degenerate {
        /// The facets.
        facets: Vec<usize>,
    },
    /// Edges with a facet on one side only.
    #[error("open mesh: a hole beside {} ({edges} edges have one facet instead of two)", list("facet", facets))]
    Open {
        /// Number of such edges.
        edges: usize,
        /// The facets at these edges, ascending.
        facets: Vec<usize>,
    },
    /// Facets that share no vertices although their corners lie in the same places.
    #[error(
        "the facets are not joined: each has corners of its own, {repeated} of the {vertices} vertices stand where another \
         one does; weld the vertices (merge those in the same place) and export the mesh again"
    )]
    Unwelded {
        /// Vertices that repeat the coordinates of another one.
        repeated: usize,
        /// All vertices.
        vertices: usize,
    },
    /// Edges with three facets or more.
    #[error("not a surface: {edges} edges have more than two facets, at {}", list("facet", facets))]
    NonManifold {
        /// Number of such edges.
        edges: usize,
        /// The facets at these edges, ascending.
        facets: Vec<usize>,
    },
    /// Edges that both facets run through in the same direction.
    #[error(
        "inconsistent orientation: neighbours turn opposite ways across {edges} edges, at {}",
        list("facet", facets)
    )]
    Orientation {
        /// Number of such edges.
        edges: usize,
        /// The facets at these edges, ascending.
        facets: Vec<usize>,
    },
    /// Vertices at which sheets meet that share nothing else.
    #[error("self-touching mesh: separate sheets meet in single vertices ({}), of {}", vertices.len(), list("facet", facets))]
    PinchedVertices {
        /// The vertices, ascending.
        vertices: Vec<usize>,
        /// The facets at these vertices, ascending.
        facets: Vec<usize>,
    },
    /// Facets that cross or touch others elsewhere than in common edges and vertices.
    #[error("self-touching mesh: {pairs} pairs of facets cross or touch, among {}", list("facet", facets))]
    SelfContact {
        /// Number of such pairs.
        pairs: usize,
        /// The facets of these pairs, ascending.
        facets: Vec<usize>,
    },
    /// All normals point inward, or the body is flat.
    #[error(
        "inside-out mesh: the enclosed volume is {volume_m3} m^3 and must be positive (facets counter-clockwise seen from outside)"
    )]
    InsideOut {
        /// Signed volume, m^3.
        volume_m3: f64,
    },
    /// A closed shell that is oriented against its place: the outermost outward, voids inward, bodies in voids outward.
    #[error(
        "the shell of {} is oriented {}, but must be {}: {}",
        list("facet", facets),
        if *depth % 2 == 0 { "inward" } else { "outward" },
        if *depth % 2 == 0 { "outward" } else { "inward" },
        match depth {
            0 => "it lies in no other shell".to_owned(),
            1 => "it lies in another one, where a void is expected (overlapping solids would count twice)".to_owned(),
            depth => format!("it lies in {depth} others"),
        }
    )]
    ShellOrientation {
        /// Number of shells around it.
        depth: usize,
        /// Its facets, ascending.
        facets: Vec<usize>,
    },
    /// A solid whose volume or moments of inertia are not finite and positive numbers.
    #[error(
        "the solid has a volume of {volume_m3:e} m^3 and a largest moment of inertia over the density of {moment_m5:e} m^5; \
         both must be finite and above 0 (is the unit of the coordinates right?)"
    )]
    NoInertia {
        /// Volume, m^3.
        volume_m3: f64,
        /// Largest principal moment over the density, m^5.
        moment_m5: f64,
    },
    /// A sphere cannot be triangulated with this number of vertices.
    #[error("a tiling needs between 4 and {} vertices, not {vertices}", u32::MAX / 2)]
    VertexCount {
        /// The number asked for.
        vertices: usize,
    },
    /// Points without a convex hull.
    #[error("no convex hull of {points} points: there are too few, they lie in a plane, or a coordinate is not finite")]
    Hull {
        /// Number of points.
        points: usize,
    },
    /// A sphere with a value that is not finite, or without a positive radius.
    #[error("sphere {}: centre {centre:?} m, radius {radius} m; all must be finite and the radius positive", sphere + 1)]
    BadSphere {
        /// Row of the sphere.
        sphere: usize,
        /// Its centre, m.
        centre: [f64; 3],
        /// Its radius, m.
        radius: f64,
    },
    /// Parameters that make no closed surface.
    #[error(
        "no surface of {spheres} spheres with exponent {exponent} and level {level}: at least one sphere, an exponent of 1 to {MAX_EXPONENT} and a positive level are needed"
    )]
    BadSurface {
        /// Number of spheres.
        spheres: usize,
        /// Half the power of the distance.
        exponent: u32,
        /// The level `G0`.
        level: f64,
    },
    /// An ellipsoid with an axis that is not finite and positive.
    #[error("ellipsoid with semi-axes {semi_axes:?} m: all must be finite and positive")]
    BadEllipsoid {
        /// Semi-axes along x, y, z, m.
        semi_axes: [f64; 3],
    },
    /// A previous tiling with another number of vertices.
    #[error("the previous tiling has {found} vertices, the ellipsoid's has {expected}")]
    OtherTiling {
        /// Vertices of the previous tiling.
        found: usize,
        /// Vertices of the ellipsoid's tiling.
        expected: usize,
    },
    /// A line of an OBJ file that is not understood.
    #[error("line {line}: {fault}")]
    Obj {
        /// The line, from 1; the first one of a statement continued with a backslash.
        line: usize,
        /// What is wrong with it.
        fault: ObjFault,
    },
}

/// `facet 3`, `facets 1, 2, 9`, `facets 1, 2, ... and 90 more`, counted from 1.
fn list(noun: &str, indices: &[usize]) -> String {
    const SHOWN: usize = 8;
    let shown = indices.iter().take(SHOWN).map(|i| (i + 1).to_string()).collect::<Vec<_>>().join(", ");
    let noun = match (noun, indices.len()) {
        (noun, 1) => noun.to_owned(),
        ("vertex", _) => "vertices".to_owned(),
        (noun, _) => format!("{noun}s"),
    };
    match indices.len().saturating_sub(SHOWN) {
        0 => format!("{noun} {shown}"),
        more => format!("{noun} {shown} and {more} more"),
    }
}
