//! Why an evolution stopped before its end.

use crate::exchange::{AggregateFileError, MeshFileError};
use crate::shed::ShedError;
use crate::store::{BuiltRecord, StoreError};

use super::spin::SpinError;

/// Failure of a run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EvolveError {
    /// The run directory cannot be used.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The aggregate file of the scene was refused.
    #[error(transparent)]
    AggregateFile(#[from] AggregateFileError),
    /// The mesh file of the scene was refused.
    #[error(transparent)]
    MeshFile(#[from] MeshFileError),
    /// The aggregate cannot be made as the scene asks.
    #[error("the aggregate cannot be made: {0}")]
    Aggregate(pkd::PkdError),
    /// The contacts of the spheres cannot be resolved with the parameters given.
    #[error("the contacts cannot be resolved: {0}")]
    Contact(pkd::PkdError),
    /// The dynamics of the spheres failed.
    #[error("the dynamics of the spheres failed: {0}")]
    Dynamics(pkd::PkdError),
    /// The body cannot be tiled.
    #[error("the body cannot be tiled: {0}")]
    Tiling(#[from] tiling::TilingError),
    /// The tiling of the spheres bounds no body whose torque could be taken.
    #[error("configuration {configuration}: the surface fitted to the spheres is no surface of a body")]
    Surface {
        /// The configuration.
        configuration: u32,
        /// What is wrong with the surface.
        source: taco::TacoError,
    },
    /// The torques cannot be computed.
    #[error("the torques cannot be computed: {0}")]
    Torque(#[from] taco::TacoError),
    /// Shed spheres cannot be followed.
    #[error("shed spheres cannot be followed: {0}")]
    Shed(#[from] ShedError),
    /// The spin cannot be integrated.
    #[error("the spin cannot be integrated: {0}")]
    Spin(#[from] SpinError),
    /// The body fell apart before there was an object 0.
    #[error(
        "the body fell apart after {rotations} rotations of settling: it does not bear the scene's spin; \
         give it a longer spin.period_h"
    )]
    BrokeUpWhileSettling {
        /// Rotations done.
        rotations: f64,
    },
    /// Settling made another body of it.
    #[error(
        "settling reshaped the body: b/a {:.3} -> {:.3}, c/a {:.3} -> {:.3}, period {:.3} -> {:.3} h (at most 0.15 in a ratio and a \
         quarter of the period); spheres that roll freely do not hold this shape at this spin. Give it a longer spin.period_h, \
         `hcp` packing or soft contacts with friction, or set settling.allow_reshaping if that is meant",
        built.b_over_a, settled.b_over_a, built.c_over_a, settled.c_over_a, built.period_s / 3600.0, settled.period_s / 3600.0
    )]
    Reshaped {
        /// As it was made.
        built: Box<BuiltRecord>,
        /// As it settled.
        settled: Box<BuiltRecord>,
    },
    /// Rotations were asked of a body that does not rotate.
    #[error("the aggregate does not rotate; give it a period or ask for seconds")]
    NoRotation,
    /// The observer asked to stop; whatever was committed stays.
    #[error("interrupted")]
    Interrupted,
}

impl From<pkd::PkdError> for EvolveError {
    fn from(error: pkd::PkdError) -> Self {
        match error {
            pkd::PkdError::Stopped => Self::Interrupted,
            other => Self::Dynamics(other),
        }
    }
}
