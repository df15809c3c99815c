//! Triangle meshes of asteroids: the mesh type and its integrals, OBJ files, the fit to an aggregate of spheres.
//!
//! SI units and `f64` throughout.
#![warn(missing_docs)]

pub mod mesh;

pub use mesh::Mesh;
