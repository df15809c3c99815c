//! Particle dynamics of rubble piles: aggregates of spheres, their gravity, contacts and settling.
//!
//! SI units and `f64` throughout. Nothing here knows of sunlight, files or the command line.
#![warn(missing_docs)]

mod cells;
pub mod clusters;
pub mod constants;
pub mod effective_potential;
pub mod equilibrium;
mod error;
pub mod frame;
pub mod gravity;
pub mod hard_sphere;
pub mod mass_properties;
pub mod packing;
pub mod rigid_fit;
pub mod simd;
pub mod soft_sphere;
mod spheres;

pub use error::PkdError;
pub use spheres::Spheres;
