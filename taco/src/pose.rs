//! How the body's axes of the moment lie in the frame in which its mesh is given.
//!
//! Horizons belong to the mesh: they are kept in its frame, with azimuths from the direction of its z axis. Torques
//! belong to the body's axes. After a re-tiling the centre of mass and the principal axes have shifted a little; the mesh
//! and most of its horizons have not.

use crate::error::{TacoError, require};
use crate::exchange::Wrench;
use crate::facets::Facet;
use tiling::Mesh;

/// Centre of mass and principal axes in the frame of the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Centre of mass, m.
    pub centre: [f64; 3],
    /// Unit vectors of the body's x, y and z axis, right-handed; the body spins about z.
    pub axes: [[f64; 3]; 3],
}

impl Default for Pose {
    /// The frame of the mesh.
    fn default() -> Self {
        Self { centre: [0.0; 3], axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] }
    }
}

impl Pose {
    /// Refuses axes that are no rotation.
    ///
    /// # Errors
    /// [`TacoError::OutOfRange`] with what is wrong.
    pub fn validate(&self) -> Result<(), TacoError> {
        let bad = self.centre.into_iter().find(|c| !c.is_finite());
        require(bad.is_none(), "pose.centre", bad.unwrap_or(0.0), "finite coordinates")?;
        let [x, y, z] = self.axes.map(nalgebra::Vector3::from);
        let off = (x.cross(&y) - z).norm() + (y.cross(&z) - x).norm() + (x.norm() - 1.0).abs();
        require(off < 1e-9, "pose.axes", off, "right-handed orthonormal axes, to 1e-9")
    }

    /// A point of the mesh in the body's frame, m.
    pub(crate) fn point(&self, p: [f64; 3]) -> [f64; 3] {
        self.direction(std::array::from_fn(|k| p[k] - self.centre[k]))
    }

    fn direction(&self, d: [f64; 3]) -> [f64; 3] {
        self.axes.map(|a| a[0] * d[0] + a[1] * d[1] + a[2] * d[2])
    }

    /// What the light of a facet does to the body, about its centre and along its axes.
    pub(crate) fn wrench(&self, wrench: &Wrench) -> Wrench {
        let (c, p, l) = (self.centre, wrench.momentum, wrench.angular_momentum);
        let about_centre =
            std::array::from_fn(|i| l[i] - (c[(i + 1) % 3] * p[(i + 2) % 3] - c[(i + 2) % 3] * p[(i + 1) % 3]));
        Wrench { momentum: self.direction(p), angular_momentum: self.direction(about_centre) }
    }

    /// All facets of a mesh in the body's frame.
    pub(crate) fn facets(&self, mesh: &Mesh, facets: &[Facet]) -> Vec<Facet> {
        if *self == Self::default() {
            return facets.to_vec();
        }
        let posed = |(f, facet): (usize, &Facet)| {
            let [north, ..] = facet.horizon_axes();
            let normal = self.direction(mesh.area_vector(f).into());
            Facet::new(self.point(facet.point), normal).with_azimuths_from(self.direction(north))
        };
        facets.iter().enumerate().map(posed).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_that_are_no_rotation_are_refused() {
        let pose = Pose::default();
        assert_eq!(pose.validate(), Ok(()));
        let [x, y, z] = pose.axes;
        for axes in [[x, y, x], [y, x, z], [x.map(|c| 2.0 * c), y, z], [x, [f64::NAN; 3], z]] {
            assert!(Pose { axes, ..pose }.validate().is_err(), "{axes:?}");
        }
        assert!(Pose { centre: [f64::INFINITY, 0.0, 0.0], ..pose }.validate().is_err());
    }
}
