//! Triangle meshes of asteroids: the mesh type and its integrals, OBJ files, the fit to an aggregate of spheres.
//!
//! SI units and `f64` throughout.
#![warn(missing_docs)]

mod error;
pub mod mesh;
pub mod obj;
pub mod solid;
pub mod topology;

pub use error::TilingError;
pub use mesh::Mesh;
pub use solid::{PrincipalAxes, Solid};
