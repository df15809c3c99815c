//! Minimal re-tiling after a movement: only vertices near the moved spheres change.
//!
//! Source: Cotto-Figueroa et al. (2015), section 2.4.2: the tiling is rebuilt from the original ellipsoid in the original
//! frame. A sphere moved by `d` at distance `D` still changes `G` by about `4 d R^4 / D^5` everywhere, so a vertex whose
//! new place is within a thousandth of a radius of the old one keeps the old one exactly.

use crate::implicit::ImplicitSurface;
use crate::project::{EllipsoidTiling, Tiling, flagged};
use crate::{Mesh, TilingError};
use nalgebra::Vector3;

/// Shift of a vertex that counts as none, over the smallest radius.
const UNMOVED: f64 = 1e-3;

impl EllipsoidTiling {
    /// Fits the tiling to the surface of the moved spheres, given in the frame of this original ellipsoid, keeping the
    /// vertices of `previous` where the surface is unchanged.
    ///
    /// # Errors
    /// [`TilingError::OtherTiling`] if `previous` is not a tiling of this ellipsoid.
    pub fn retiled(&self, surface: &ImplicitSurface, previous: &Mesh) -> Result<Tiling, TilingError> {
        let (found, expected) = (previous.vertices.len(), self.mesh.vertices.len());
        if found != expected {
            return Err(TilingError::OtherTiling { found, expected });
        }
        let placed = self.placed(surface);
        let tolerance = UNMOVED * surface.radii().0;
        let mut kept = 0;
        let vertices = (placed.iter().zip(&previous.vertices))
            .map(|((new, _), old)| {
                if (Vector3::from(*new) - Vector3::from(*old)).norm() <= tolerance {
                    kept += 1;
                    *old
                } else {
                    *new
                }
            })
            .collect();
        let mesh = Mesh { vertices, facets: self.mesh.facets.clone() };
        Ok(Tiling { mesh, flagged: flagged(&placed), kept, moved: expected - kept })
    }
}
