//! Minimal re-tiling after a movement: only vertices near the moved spheres change.
//!
//! Source: Cotto-Figueroa et al. (2015), section 2.4.2: the tiling is rebuilt from the original ellipsoid in the original
//! frame. A sphere moved by `d` at distance `D` still changes `G` by about `4 d R^4 / D^5` everywhere, so a vertex whose
//! new place is within a thousandth of a radius of the old one keeps the old one exactly. So does a vertex that had to be
//! moved off the surface, where the surface has not changed: mending anew would move it by what its neighbours' digits
//! changed.

use crate::implicit::ImplicitSurface;
use crate::project::{EllipsoidTiling, Placed, Placement, Tiling, flagged};
use crate::{Mesh, TilingError};
use nalgebra::Vector3;
use rayon::prelude::*;

/// Shift of a vertex that counts as none, over the smallest radius.
const UNMOVED: f64 = 1e-3;

/// The tiling before a movement.
#[derive(Debug, Clone, Copy)]
pub struct Previous<'a> {
    /// Its mesh.
    pub mesh: &'a Mesh,
    /// The surface that it was fitted to.
    pub surface: &'a ImplicitSurface,
}

impl EllipsoidTiling {
    /// Fits the tiling to the surface of the moved spheres, given in the frame of this original ellipsoid, keeping the
    /// vertices of `previous` where the surface is unchanged. The mesh passes [`Mesh::check_body`].
    ///
    /// # Errors
    /// [`TilingError::OtherTiling`] if `previous` is not a tiling of this ellipsoid; the fault of a tiling that cannot be
    /// mended.
    pub fn retiled(&self, surface: &ImplicitSurface, previous: Previous) -> Result<Tiling, TilingError> {
        let (found, expected) = (previous.mesh.vertices.len(), self.mesh.vertices.len());
        if found != expected {
            return Err(TilingError::OtherTiling { found, expected });
        }
        let tolerance = UNMOVED * surface.radii().0;
        let near = |a: [f64; 3], b: [f64; 3]| (Vector3::from(a) - Vector3::from(b)).norm() <= tolerance;
        // Its place and whether it is another one than before.
        let vertex = |v: usize| -> (Placed, bool) {
            let (new, old) = (self.placed_vertex(v, surface), previous.mesh.vertices[v]);
            if near(new.0, old) {
                return ((old, new.1), false);
            }
            let before = self.placed_vertex(v, previous.surface).0;
            let was_mended = !near(before, old);
            if was_mended && near(new.0, before) { ((old, Placement::Mended), false) } else { (new, true) }
        };
        let (mut placed, changed): (Vec<Placed>, Vec<bool>) = (0..expected).into_par_iter().map(vertex).unzip();
        self.mend(surface, &mut placed, &changed)?;
        let kept = placed.iter().zip(&previous.mesh.vertices).filter(|(new, old)| new.0 == **old).count();
        let mesh = Mesh { vertices: placed.iter().map(|p| p.0).collect(), facets: self.mesh.facets.clone() };
        Ok(Tiling { mesh, flagged: flagged(&placed), kept, moved: expected - kept })
    }
}
