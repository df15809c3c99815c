//! Volume, centre of mass, inertia tensor and principal axes of the uniform solid that a closed mesh bounds.
//!
//! Exact for polyhedra: the solid is a signed sum of tetrahedra, each with volume `a . (b x c) / 6`, centroid
//! `(a + b + c) / 4` and second moments `V/20 (s s^T + a a^T + b b^T + c c^T)`, `s = a + b + c` (Tonon 2005,
//! J. Math. Stat. 1, 8). The common apex is the mean vertex, so that a mesh far from the origin loses no digits.
//! Sums run in facet order.

use crate::Mesh;
use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// Integrals over the solid inside a closed mesh, for unit density.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solid {
    /// Volume, m^3; negative if the facets are ordered inside out.
    pub volume: f64,
    /// Centre of mass, m.
    pub centre_of_mass: [f64; 3],
    /// Inertia tensor about the centre of mass divided by the density, m^5, along the mesh's axes.
    pub inertia: Matrix3<f64>,
}

/// Principal moments and axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrincipalAxes {
    /// Principal moments `A <= B <= C`, in the unit of the tensor.
    pub moments: [f64; 3],
    /// Rotation into the principal frame: its rows are the long, middle and short axis as unit vectors. Right-handed;
    /// the short axis points to the old +z side and the long one to the old +x side, so that the sense of spin stays.
    pub rotation: Matrix3<f64>,
}

impl Mesh {
    /// Volume enclosed, m^3; negative if the facets are ordered inside out.
    pub fn volume(&self) -> f64 {
        let apex = self.mean_vertex();
        let sixfold = |f| {
            let [a, b, c] = self.corners(f).map(|v| v - apex);
            a.dot(&b.cross(&c))
        };
        (0..self.facets.len()).map(sixfold).sum::<f64>() / 6.0
    }

    /// Volume, centre of mass and inertia tensor of the uniform solid inside.
    ///
    /// Meaningful for closed meshes only ([`Mesh::check`]); centre and tensor are NaN for one without volume.
    pub fn solid(&self) -> Solid {
        let apex = self.mean_vertex();
        let mut sixfold_volume = 0.0;
        let mut first = Vector3::zeros();
        let mut second = Matrix3::zeros();
        for f in 0..self.facets.len() {
            let [a, b, c] = self.corners(f).map(|v| v - apex);
            let det = a.dot(&b.cross(&c));
            let sum = a + b + c;
            sixfold_volume += det;
            first += sum * det;
            second += (sum * sum.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose()) * det;
        }
        let volume = sixfold_volume / 6.0;
        let offset = first / (4.0 * sixfold_volume);
        let central = second / 120.0 - offset * offset.transpose() * volume;
        let inertia = Matrix3::identity() * central.trace() - central;
        Solid { volume, centre_of_mass: (apex + offset).into(), inertia }
    }

    /// The mean of the vertices in use: one far away that no facet uses would cost digits.
    fn mean_vertex(&self) -> Vector3<f64> {
        let used = self.used_vertices();
        let (mut sum, mut count) = (Vector3::zeros(), 0_usize);
        for (v, _) in self.vertices.iter().zip(used).filter(|(_, used)| *used) {
            sum += Vector3::from(*v);
            count += 1;
        }
        sum / count.max(1) as f64
    }
}

impl Solid {
    /// Radius of the sphere of equal volume, m.
    pub fn equal_volume_radius(&self) -> f64 {
        (self.volume * 3.0 / (4.0 * std::f64::consts::PI)).cbrt()
    }

    /// Principal axes of the inertia tensor.
    pub fn principal_axes(&self) -> PrincipalAxes {
        PrincipalAxes::of(&self.inertia)
    }
}

impl PrincipalAxes {
    /// Principal axes of a symmetric tensor.
    ///
    /// Where two moments are equal their axes are any orthogonal pair in the common plane.
    pub fn of(inertia: &Matrix3<f64>) -> Self {
        let eigen = SymmetricEigen::new(*inertia);
        let mut order = [0, 1, 2];
        order.sort_by(|i, j| eigen.eigenvalues[*i].total_cmp(&eigen.eigenvalues[*j]));
        let towards = |axis: Vector3<f64>, side: usize| {
            // An axis at right angles to its side is turned by its largest component, to be definite.
            let decisive = if axis[side].abs() > 1e-9 { axis[side] } else { axis[axis.iamax()] };
            axis * decisive.signum()
        };
        let long = towards(eigen.eigenvectors.column(order[0]).into(), 0);
        let short = towards(eigen.eigenvectors.column(order[2]).into(), 2);
        let middle = short.cross(&long);
        Self {
            moments: order.map(|i| eigen.eigenvalues[i]),
            rotation: Matrix3::from_rows(&[long.transpose(), middle.transpose(), short.transpose()]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::tests::cuboid;

    fn relative(got: f64, want: f64) -> f64 {
        (got / want - 1.0).abs()
    }

    /// Box of sides a, b, c: V = abc, centre at half, I_xx/V = (b^2 + c^2)/12, far from the origin too.
    #[test]
    fn box_integrals_are_exact_wherever_it_stands() {
        let (a, b, c) = (1.0, 2.0, 4.0);
        for shift in [[0.0; 3], [1e6, -2e6, 3e6]] {
            let solid = cuboid(a, b, c).translated(shift).solid();
            assert!(relative(solid.volume, 8.0) < 1e-14);
            assert!(
                (Vector3::from(solid.centre_of_mass) - Vector3::from(shift) - Vector3::new(0.5, 1.0, 2.0)).norm()
                    < 1e-9
            );
            let want = Matrix3::from_diagonal(&Vector3::new(20.0, 17.0, 5.0)) * (8.0 / 12.0);
            assert!((solid.inertia - want).norm() < 1e-12 * want.norm());
        }
    }

    #[test]
    fn inside_out_box_has_negative_volume() {
        let mut mesh = cuboid(1.0, 2.0, 4.0);
        mesh.facets.iter_mut().for_each(|f| f.swap(0, 1));
        assert_eq!(mesh.volume(), -8.0);
    }

    #[test]
    fn principal_axes_undo_a_rotation_and_keep_the_sense_of_spin() {
        let turn = *nalgebra::Rotation3::from_euler_angles(0.3, -0.4, 0.5).matrix();
        let solid = cuboid(4.0, 2.0, 1.0).rotated(&turn).solid();
        let axes = solid.principal_axes();
        let want = [5.0, 17.0, 20.0].map(|m| m * 8.0 / 12.0);
        assert!(axes.moments.iter().zip(want).all(|(got, want)| relative(*got, want) < 1e-13));
        assert!((axes.rotation * turn - Matrix3::identity()).norm() < 1e-12);
        assert!((axes.rotation.determinant() - 1.0).abs() < 1e-12);
        let flat = axes.rotation * solid.inertia * axes.rotation.transpose();
        assert!((flat - Matrix3::from_diagonal(&Vector3::from(axes.moments))).norm() < 1e-12);
    }
}
