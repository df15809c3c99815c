//! A mesh that is a body: closed, facing outward, about its centre of mass, with the spin axis along +z.
//!
//! A torque about a point a tenth of the radius off the centre of mass has another sign at half of the obliquities, and a
//! mesh with a hole or inside out gives numbers just as smooth. So [`crate::torque_table`] takes nothing else.

use crate::error::TacoError;
use crate::pose::Pose;
use nalgebra::Vector3;
use tiling::{Mesh, Shells, Solid};

/// A closed, outward-facing mesh whose centre of mass is the origin and which spins about +z.
///
/// # Examples
/// ```
/// use taco::{BodyMesh, SpinAxis, TacoError};
/// let sphere = tiling::fibonacci::unit_sphere(200).map_err(TacoError::from)?;
/// let body = BodyMesh::uniform(sphere.scaled(500.0).translated([0.0, 0.0, 4000.0]), SpinAxis::Largest)?;
/// assert!(body.solid().centre_of_mass.iter().all(|c| c.abs() < 1e-9));
/// let mut open = body.mesh().clone();
/// open.facets.pop();
/// assert!(BodyMesh::uniform(open, SpinAxis::Z).is_err());
/// # Ok::<(), TacoError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct BodyMesh {
    mesh: Mesh,
    solid: Solid,
    /// The shells that sunlight can reach, where there are others.
    lit: Option<Mesh>,
    bodies: usize,
}

/// The axis that a uniform body spins about.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum SpinAxis {
    /// The z axis of its mesh.
    #[default]
    Z,
    /// The principal axis of largest moment, towards the mesh's +z.
    Largest,
}

impl BodyMesh {
    /// A body of uniform density: the mesh moved to the centroid of its volume and, if asked for, turned.
    ///
    /// # Errors
    /// [`TacoError::Body`] if [`Mesh::check_body`] refuses the mesh.
    pub fn uniform(mesh: Mesh, axis: SpinAxis) -> Result<Self, TacoError> {
        let (mesh, _) = mesh.without_unused_vertices();
        let shells = mesh.check_body()?;
        let solid = mesh.solid();
        let centred = mesh.translated(solid.centre_of_mass.map(|c| -c));
        let placed = match axis {
            SpinAxis::Z => centred,
            SpinAxis::Largest => centred.rotated(&solid.principal_axes().rotation),
        };
        Ok(Self::checked(placed, &shells))
    }

    /// A body whose centre of mass and axes are known, in the frame of the mesh, from elsewhere: its density need not be
    /// uniform.
    ///
    /// # Errors
    /// [`TacoError::Body`] as for [`Self::uniform`], [`TacoError::OutOfRange`] if the axes are no rotation,
    /// [`TacoError::CentreOutside`] if the centre of mass is not in the bounding box of the mesh.
    pub fn posed(mesh: &Mesh, pose: &Pose) -> Result<Self, TacoError> {
        pose.validate()?;
        let shells = mesh.check_body()?;
        for k in 0..3 {
            let (low, high) =
                mesh.facets.iter().flatten().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                    let c = mesh.vertices[*v as usize][k];
                    (low.min(c), high.max(c))
                });
            if !(low..=high).contains(&pose.centre[k]) {
                return Err(TacoError::CentreOutside { centre: pose.centre });
            }
        }
        let rows = pose.axes.map(|row| Vector3::from(row).transpose());
        let placed = mesh.translated(pose.centre.map(|c| -c)).rotated(&nalgebra::Matrix3::from_rows(&rows));
        Ok(Self::checked(placed, &shells))
    }

    fn checked(mesh: Mesh, shells: &Shells) -> Self {
        let solid = mesh.solid();
        // No light reaches the wall of a void or what floats in it, and what it radiates stays there.
        let lit = shells.depth.iter().any(|depth| *depth > 0).then(|| {
            let is_lit = |f: &usize| shells.depth[shells.of_facet[*f]] == 0;
            let facets = (0..mesh.facets.len()).filter(is_lit).map(|f| mesh.facets[f]).collect();
            Mesh { vertices: mesh.vertices.clone(), facets }.without_unused_vertices().0
        });
        Self { mesh, solid, lit, bodies: shells.outermost() }
    }

    /// The mesh, m: origin at the centre of mass, spin along +z.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The facets that light can reach.
    pub(crate) fn lit(&self) -> &Mesh {
        self.lit.as_ref().unwrap_or(&self.mesh)
    }

    /// Integrals over its volume for unit density, in the frame of the body.
    pub fn solid(&self) -> &Solid {
        &self.solid
    }

    /// Separate bodies, taken as one rigid one.
    pub fn bodies(&self) -> usize {
        self.bodies
    }

    /// Moment of inertia about the spin axis over the density, m^5, if the density is uniform.
    pub fn spin_moment(&self) -> f64 {
        self.solid.inertia[(2, 2)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_bodies::cuboid;
    use tiling::TilingError;

    fn slab() -> Mesh {
        let mut mesh = Mesh::default();
        cuboid(&mut mesh, [10.0, 10.0, 10.0], [11.0, 13.0, 12.0]);
        mesh
    }

    #[test]
    fn uniform_bodies_are_moved_and_turned() {
        let plain = BodyMesh::uniform(slab(), SpinAxis::Z).unwrap();
        assert!(plain.solid().centre_of_mass.iter().all(|c| c.abs() < 1e-12));
        // 6 m^3 of sides 1 and 3 across z; the shortest side is x.
        assert!((plain.spin_moment() / (6.0 * (1.0 + 9.0) / 12.0) - 1.0).abs() < 1e-12);
        let turned = BodyMesh::uniform(slab(), SpinAxis::Largest).unwrap();
        assert!((turned.spin_moment() / (6.0 * (4.0 + 9.0) / 12.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn what_is_no_body_is_refused() {
        let refused = |mesh: Mesh| match BodyMesh::uniform(mesh, SpinAxis::Z) {
            Err(TacoError::Body(fault)) => fault,
            other => panic!("{other:?}"),
        };
        let mut open = slab();
        open.facets.pop();
        assert!(matches!(refused(open), TilingError::Open { .. }));
        let mut inverted = slab();
        inverted.facets.iter_mut().for_each(|f| f.swap(0, 1));
        assert!(matches!(refused(inverted), TilingError::InsideOut { .. }));
        let mut folded = slab();
        folded.vertices[0] = [10.5, 14.0, 11.0];
        assert!(matches!(refused(folded), TilingError::SelfContact { .. }));
        let outside = Pose { centre: [0.0; 3], ..Pose::default() };
        assert_eq!(BodyMesh::posed(&slab(), &outside), Err(TacoError::CentreOutside { centre: [0.0; 3] }));
    }

    #[test]
    fn walls_of_voids_are_not_lit() {
        let mut hollow = Mesh::default();
        cuboid(&mut hollow, [0.0; 3], [4.0; 3]);
        cuboid(&mut hollow, [1.0; 3], [2.0, 3.0, 2.5]);
        hollow.facets[12..].iter_mut().for_each(|f| f.swap(0, 1));
        let body = BodyMesh::uniform(hollow, SpinAxis::Z).unwrap();
        assert_eq!((body.mesh().facets.len(), body.lit().facets.len(), body.lit().vertices.len()), (24, 12, 8));
        assert!((body.solid().volume - 61.0).abs() < 1e-12);
    }
}
