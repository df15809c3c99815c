//! Whether a tiling fitted to an aggregate is good enough to cast shadows: volume, folds, slivers, closure.
//!
//! Nothing is refused here: bodies with overhangs or loose spheres can make a tiling fold, and what to do about it is for
//! the caller to decide.

use crate::{EllipsoidTiling, Mesh};
use nalgebra::Vector3;

/// Facets with a [`Mesh::quality`] below this are slivers.
pub const LEAST_QUALITY: f64 = 0.05;

/// Range of the enclosed volume over the expected one.
pub const VOLUME_RATIOS: [f64; 2] = [0.85, 1.15];

/// What a fitted tiling looks like.
#[derive(Debug, Clone, PartialEq)]
pub struct FitReport {
    /// Volume enclosed, m^3.
    pub volume: f64,
    /// That over the volume of the ellipsoid from which the tiling started.
    pub volume_ratio: f64,
    /// Facets whose normal points against that of the ellipsoid's facet: the tiling is folded there.
    pub folded: Vec<usize>,
    /// Facets with a quality below [`LEAST_QUALITY`].
    pub slivers: Vec<usize>,
    /// Sum of the area vectors over the sum of the areas: round-off, below 1e-12, if the mesh is closed.
    pub closure: f64,
}

impl FitReport {
    /// Report on `mesh`, made of `ellipsoid` by moving vertices.
    ///
    /// # Panics
    /// If the two do not have the same number of facets.
    pub fn new(ellipsoid: &EllipsoidTiling, mesh: &Mesh) -> Self {
        assert_eq!(ellipsoid.mesh.facets.len(), mesh.facets.len(), "a tiling has its ellipsoid's facets");
        // Facets that do not pass, rather than facets that fail: NaN counts as a fault.
        let all_but = |passes: &dyn Fn(usize) -> bool| (0..mesh.facets.len()).filter(|f| !passes(*f)).collect();
        let volume = mesh.volume();
        let ellipsoid_volume = 4.0 / 3.0 * std::f64::consts::PI * ellipsoid.semi_axes.iter().product::<f64>();
        Self {
            volume,
            volume_ratio: volume / ellipsoid_volume,
            folded: all_but(&|f| mesh.area_vector(f).dot(&ellipsoid.mesh.area_vector(f)) > 0.0),
            slivers: all_but(&|f| mesh.quality(f) >= LEAST_QUALITY),
            closure: Vector3::from(mesh.area_vector_sum()).norm() / mesh.surface_area(),
        }
    }

    /// Whether nothing is folded, no facet is a sliver, the mesh is closed and the volume is within [`VOLUME_RATIOS`].
    pub fn is_sound(&self) -> bool {
        self.folded.is_empty()
            && self.slivers.is_empty()
            && self.closure < 1e-12
            && (VOLUME_RATIOS[0]..=VOLUME_RATIOS[1]).contains(&self.volume_ratio)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_untouched_ellipsoid_is_sound_and_each_fault_is_found() {
        let ellipsoid = EllipsoidTiling::new([3.0, 2.5, 2.0], 394).unwrap();
        let sound = FitReport::new(&ellipsoid, &ellipsoid.mesh);
        assert!(sound.is_sound(), "{sound:?}");
        assert!((sound.volume_ratio - 0.98539).abs() < 1e-4 && sound.closure < 1e-15);

        let shrunk = FitReport::new(&ellipsoid, &ellipsoid.mesh.scaled(0.9));
        assert!(!shrunk.is_sound() && shrunk.folded.is_empty() && shrunk.slivers.is_empty());

        let mut pulled = ellipsoid.mesh.clone();
        let neighbour = pulled.facets.iter().find_map(|f| (f[0] == 200).then_some(f[1] as usize)).unwrap();
        let beyond = 1.3;
        pulled.vertices[200] =
            [0, 1, 2].map(|k| (1.0 - beyond) * pulled.vertices[200][k] + beyond * pulled.vertices[neighbour][k]);
        assert!(!FitReport::new(&ellipsoid, &pulled).folded.is_empty());

        pulled.vertices[200] =
            [0, 1, 2].map(|k| 1e-3 * ellipsoid.mesh.vertices[200][k] + 0.999 * pulled.vertices[neighbour][k]);
        assert!(!FitReport::new(&ellipsoid, &pulled).slivers.is_empty());
    }
}
