//! Triangle meshes of asteroids: the mesh type and its integrals, OBJ files, the fit to an aggregate of spheres.
//!
//! SI units and `f64` throughout.
#![warn(missing_docs)]

pub mod checks;
mod contact;
mod error;
pub mod fibonacci;
pub mod hull;
pub mod implicit;
pub mod inside;
mod mend;
pub mod mesh;
pub mod obj;
pub mod polygon;
pub mod project;
pub mod quickhull;
mod retile;
mod shells;
pub mod solid;
pub mod top;
pub mod topology;

pub use checks::FitReport;
pub use error::TilingError;
pub use hull::sphere_hull_volume;
pub use implicit::ImplicitSurface;
pub use inside::Inside;
pub use mesh::Mesh;
pub use project::{EllipsoidTiling, FlaggedVertex, Placement, Tiling};
pub use retile::Previous;
pub use shells::Shells;
pub use solid::{PrincipalAxes, Solid};
