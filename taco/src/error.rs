//! Why a torque cannot be computed.

/// Errors of this crate; each names the parameter as its path, the value found and what is allowed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TacoError {
    /// A number outside its range.
    #[error("{path} is {value}; allowed: {allowed}")]
    OutOfRange {
        /// Path of the parameter, for example `surface.reflectance.hapke.roughness_deg`.
        path: &'static str,
        /// The value found.
        value: f64,
        /// The range, in words.
        allowed: &'static str,
    },
    /// Obliquities that are missing or not in ascending order.
    #[error("sampling.obliquities: {problem} (entry {index})")]
    BadObliquities {
        /// First offending entry, counted from 0.
        index: usize,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// Spin rates that are missing or not in ascending order.
    #[error("sampling.spin_rates: {problem} (entry {index})")]
    BadSpinRates {
        /// First offending entry, counted from 0.
        index: usize,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// A mesh without facets.
    #[error("the mesh has no facets")]
    EmptyMesh,
    /// A vertex coordinate that is NaN or infinite.
    #[error("vertex {vertex} of the mesh has a coordinate that is not finite")]
    BadVertex {
        /// Index of the vertex, counted from 0.
        vertex: usize,
    },
    /// A facet that refers to a vertex that does not exist.
    #[error("facet {facet} refers to vertex {vertex}, but the mesh has {vertices} vertices")]
    BadFacet {
        /// Index of the facet, counted from 0.
        facet: usize,
        /// The vertex it asks for, counted from 0.
        vertex: u32,
        /// Number of vertices in the mesh.
        vertices: usize,
    },
    /// A mesh that bounds no body.
    #[error("no mesh of a body: {0}")]
    Body(#[from] tiling::TilingError),
    /// A centre of mass that cannot be that of the mesh.
    #[error("the centre of mass {centre:?} m lies outside the mesh")]
    CentreOutside {
        /// The centre of mass in the frame of the mesh, m.
        centre: [f64; 3],
    },
    /// A torque that is NaN or infinite, for example because the mesh is so large that areas overflow.
    #[error("the torque at obliquity {obliquity_deg} deg is not finite")]
    NotFinite {
        /// Obliquity at which it first appears, deg.
        obliquity_deg: f64,
    },
    /// A table that cannot be interpolated over all obliquities.
    #[error("the torque table cannot be interpolated: {problem}")]
    BadTable {
        /// What is wrong with it.
        problem: &'static str,
    },
}

/// Refuses a value outside its range.
pub(crate) fn require(ok: bool, path: &'static str, value: f64, allowed: &'static str) -> Result<(), TacoError> {
    if ok { Ok(()) } else { Err(TacoError::OutOfRange { path, value, allowed }) }
}
