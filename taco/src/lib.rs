//! Radiation recoil torques (YORP) of a triangle mesh.
//!
//! SI units and `f64` throughout. Nothing here knows of spheres.
#![warn(missing_docs)]
