//! Radiation recoil torques (YORP) of a triangle mesh.
//!
//! [`torque_table`] turns a [`BodyMesh`], a [`Surface`] and an [`Orbit`] into the torques that change its spin rate and its
//! obliquity, for all obliquities at once: the spin-averaged torque of a body that stores no heat depends on the Sun
//! through its declination alone, so facets are visited once per declination and every obliquity is an integral of
//! the result over the orbit.
//!
//! A [`BodyMesh`] is closed, has its centre of mass at the origin and spins about +z. SI units and `f64` throughout. Nothing here
//! knows of spheres. Sums run in a fixed order: the bytes of a result do not depend on the number of threads.
//!
//! ```
//! use taco::{BodyMesh, Interpolation, Orbit, Sampling, SpinAxis, Surface, torque_table};
//! # let mesh = tiling::Mesh {
//! #     vertices: vec![[9.0, 0.0, 0.0], [-3.0, 5.0, 0.0], [-3.0, -5.0, 1.0], [-3.0, 0.0, 4.0]],
//! #     facets: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
//! # };
//! let body = BodyMesh::uniform(mesh, SpinAxis::Largest)?;
//! let table = torque_table(&body, &Surface::default(), &Orbit::default(), &Sampling::default())?;
//! let (spin_torque, obliquity_torque) = table.interpolant(Interpolation::Cubic)?.at(0.4, 3e-4);
//! assert!(spin_torque.abs() > table.error.spin_torque_n_m && obliquity_torque.is_finite());
//! # Ok::<(), taco::TacoError>(())
//! ```
#![warn(missing_docs)]

mod arc;
mod azimuth;
mod body;
mod body_mesh;
pub mod constants;
mod day;
mod declination;
mod error;
mod exchange;
mod facets;
pub mod hapke;
mod heat;
mod hidden;
mod horizon;
mod interpolant;
mod orbit;
mod pose;
mod quadrature;
mod recoil;
mod samples;
mod sampling;
mod scanner;
mod season;
mod shape_cache;
mod sky;
mod spline;
mod surface;
#[cfg(test)]
mod test_bodies;
mod torque;
mod tree;

pub use body_mesh::{BodyMesh, SpinAxis};
pub use error::TacoError;
pub use heat::{SeasonalHeat, seasonal_heat};
pub use horizon::{Horizon, HorizonMap, Overhang};
pub use interpolant::{Interpolation, TorqueInterpolant};
pub use orbit::{AU_PER_MYR, Orbit};
pub use pose::Pose;
pub use recoil::RecoilTable;
pub use sampling::{Obliquities, Sampling, SpinRates};
pub use shape_cache::ShapeCache;
pub use sky::{SkyView, sky_view};
pub use surface::{Hapke, MultipleScattering, Reflectance, SelfHeating, Surface, Wall};
pub use torque::{ErrorPart, TorqueError, TorqueTable, torque_table, torque_table_of_facets};
