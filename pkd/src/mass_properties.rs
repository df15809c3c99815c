//! Mass, motion, moments of inertia and size of an aggregate of solid spheres.
//!
//! Inertia by the parallel-axis theorem, one solid sphere adding 2/5 m r² about its own centre. Two sizes are offered
//! because the literature uses both: the dynamically equivalent equal-volume ellipsoid ("DEEVE", from the moments) and
//! the half extents along the principal axes, sphere radii included (Richardson et al. 2005, Icarus 173, 349).
//! SI units, the caller's frame. Sums run in index order, so nothing depends on the thread count.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector3};

use crate::{PkdError, Spheres};

/// Moments that differ by less than this share are equal to round-off, which grows with the number of spheres.
const EQUAL_MOMENTS: f64 = 1e-10;

/// What an aggregate weighs, how it moves and how large it is.
#[derive(Debug, Clone, PartialEq)]
pub struct MassProperties {
    /// Total mass, kg.
    pub mass: f64,
    /// Centre of mass, m.
    pub centre: Vector3<f64>,
    /// Velocity of the centre of mass, m/s.
    pub velocity: Vector3<f64>,
    /// Inertia tensor about the centre of mass, kg m².
    pub inertia: Matrix3<f64>,
    /// Principal moments A <= B <= C, kg m².
    pub moments: Vector3<f64>,
    /// Principal axes as columns: x long (moment A), y middle, z short (moment C); right-handed.
    ///
    /// z points to the side of the angular momentum and, in a body at rest, to where its largest component is
    /// positive; x always to where its largest component is positive. So the body frame has the spin along +z.
    pub axes: Matrix3<f64>,
    /// Angular momentum about the centre of mass, orbital motion of the spheres plus their spins, kg m²/s.
    pub angular_momentum: Vector3<f64>,
    /// Kinetic energy in the caller's frame, of motion and of spin, J.
    pub kinetic_energy: f64,
    /// Half the full width along each principal axis, sphere radii included, m.
    pub half_extents: Vector3<f64>,
}

/// Mass properties of `spheres`.
///
/// # Errors
/// Whatever [`Spheres::validate`] finds, and [`PkdError::NotFinite`] where the inertia tensor overflows.
pub fn mass_properties(spheres: &Spheres) -> Result<MassProperties, PkdError> {
    spheres.validate()?;
    let indices = 0..spheres.len();
    let mass = spheres.total_mass();
    let weighted_mean = |of: &dyn Fn(usize) -> [f64; 3]| {
        indices.clone().map(|i| Vector3::from(of(i)) * spheres.mass[i]).sum::<Vector3<f64>>() / mass
    };
    let centre = weighted_mean(&|i| spheres.position(i));
    let velocity = weighted_mean(&|i| spheres.velocity(i));

    let mut inertia = Matrix3::zeros();
    let mut angular_momentum = Vector3::zeros();
    let mut kinetic_energy = 0.0;
    for i in indices.clone() {
        let (m, own) = (spheres.mass[i], own_inertia(spheres, i));
        let (d, v) = (Vector3::from(spheres.position(i)) - centre, Vector3::from(spheres.velocity(i)));
        let w = Vector3::from(spheres.spin(i));
        inertia += Matrix3::identity() * (own + m * d.norm_squared()) - d * d.transpose() * m;
        angular_momentum += d.cross(&(v - velocity)) * m + w * own;
        kinetic_energy += 0.5 * m * v.norm_squared() + 0.5 * own * w.norm_squared();
    }

    // The eigenvalue iteration need not end on values that are not finite.
    if !inertia.norm().is_finite() {
        return Err(PkdError::NotFinite { quantity: "inertia tensor" });
    }
    let (moments, axes) = principal_axes(&inertia, &angular_momentum);
    let mut half_extents = Vector3::zeros();
    for k in 0..3 {
        let axis = axes.column(k);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for i in indices.clone() {
            let along = axis.dot(&(Vector3::from(spheres.position(i)) - centre));
            low = low.min(along - spheres.radius[i]);
            high = high.max(along + spheres.radius[i]);
        }
        half_extents[k] = 0.5 * (high - low);
    }
    Ok(MassProperties {
        mass,
        centre,
        velocity,
        inertia,
        moments,
        axes,
        angular_momentum,
        kinetic_energy,
        half_extents,
    })
}

/// Moment of inertia of sphere `i` about its own centre, kg m².
fn own_inertia(spheres: &Spheres, i: usize) -> f64 {
    0.4 * spheres.mass[i] * spheres.radius[i] * spheres.radius[i]
}

/// Eigenvalues in rising order and the axes that belong to them, as [`MassProperties::axes`] promises them.
fn principal_axes(inertia: &Matrix3<f64>, angular_momentum: &Vector3<f64>) -> (Vector3<f64>, Matrix3<f64>) {
    let eigen = inertia.symmetric_eigen();
    let mut order = [0, 1, 2];
    // Stable: equal moments keep the solver's order, which is a pure function of the tensor.
    order.sort_by(|&p, &q| eigen.eigenvalues[p].total_cmp(&eigen.eigenvalues[q]));
    let moments = Vector3::from_fn(|k, _| eigen.eigenvalues[order[k]]);
    let x = with_largest_component_positive(eigen.eigenvectors.column(order[0]).into_owned());
    let mut z = with_largest_component_positive(eigen.eigenvectors.column(order[2]).into_owned());
    if z.dot(angular_momentum) < 0.0 {
        z = -z;
    }
    (moments, Matrix3::from_columns(&[x, z.cross(&x), z]))
}

/// `axis` or its opposite, so that its component of largest magnitude (the first of equals) is positive.
fn with_largest_component_positive(axis: Vector3<f64>) -> Vector3<f64> {
    if axis[axis.iamax()] < 0.0 { -axis } else { axis }
}

impl MassProperties {
    /// Semi-axes a >= b >= c of the homogeneous ellipsoid with the same mass and moments, m.
    ///
    /// a² = (5/2)(B + C - A)/M and cyclic.
    pub fn deeve_axes(&self) -> Vector3<f64> {
        Vector3::from_fn(|k, _| (2.5 * (self.moments.sum() - 2.0 * self.moments[k]) / self.mass).sqrt())
    }

    /// Mass over the volume of the dynamically equivalent ellipsoid, kg/m³.
    pub fn deeve_density(&self) -> f64 {
        self.mass / ellipsoid_volume(&self.deeve_axes())
    }

    /// Mass over the volume of the ellipsoid whose semi-axes are the half extents, kg/m³.
    pub fn extents_density(&self) -> f64 {
        self.mass / ellipsoid_volume(&self.half_extents)
    }

    /// Geometric mean of the semi-axes of the dynamically equivalent ellipsoid, m.
    pub fn mean_radius(&self) -> f64 {
        self.deeve_axes().product().cbrt()
    }

    /// Spin rate |L|/C of principal-axis rotation with this angular momentum, rad/s.
    pub fn spin_rate(&self) -> f64 {
        self.angular_momentum.norm() / self.moments[2]
    }

    /// Angular velocity of the rigid body with this angular momentum, I⁻¹ L, rad/s.
    pub fn angular_velocity(&self) -> Vector3<f64> {
        self.rigid_rotation_of(self.angular_momentum)
    }

    /// The rigid rotation that carries `angular_momentum` (kg m²/s), I⁻¹ L, rad/s.
    pub fn rigid_rotation_of(&self, angular_momentum: Vector3<f64>) -> Vector3<f64> {
        self.axes * self.axes.tr_mul(&angular_momentum).component_div(&self.moments)
    }

    /// Share of the angular momentum that lies across the axis of largest moment, the sine of the angle between them; zero
    /// for a body at rest.
    pub fn across_axis(&self) -> f64 {
        let momentum = self.angular_momentum;
        let Some(along) = momentum.try_normalize(0.0) else { return 0.0 };
        self.axis_of_largest_moment_nearest_to(along).cross(&along).norm()
    }

    /// The axis of largest moment on the side of `direction` (a unit vector). Where the two largest moments are equal to
    /// round-off, as those of two spheres are, the one of their plane that is nearest to it: the eigenvectors alone are
    /// arbitrary there.
    pub fn axis_of_largest_moment_nearest_to(&self, direction: Vector3<f64>) -> Vector3<f64> {
        let [_, b, c] = [self.moments.x, self.moments.y, self.moments.z];
        let z = self.axes.column(2).into_owned();
        if c - b > EQUAL_MOMENTS * c {
            return if z.dot(&direction) < 0.0 { -z } else { z };
        }
        let y = self.axes.column(1).into_owned();
        (y * y.dot(&direction) + z * z.dot(&direction)).try_normalize(0.0).unwrap_or(z)
    }
}

fn ellipsoid_volume(semi_axes: &Vector3<f64>) -> f64 {
    4.0 / 3.0 * PI * semi_axes.product()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn single_sphere_is_its_own_equivalent_ellipsoid() {
        let mut one = Spheres::default();
        one.push([3.0, -1.0, 2.0], [0.0; 3], [0.0; 3], 5.0, 2.0);
        let p = mass_properties(&one).unwrap();
        assert_eq!(p.moments, Vector3::repeat(0.4 * 5.0 * 4.0));
        assert!((p.deeve_axes() - Vector3::repeat(2.0)).norm() < 1e-15);
        assert_eq!(p.half_extents, Vector3::repeat(2.0));
        assert_eq!(p.axes, Matrix3::identity());
        assert!((p.mean_radius() - 2.0).abs() < 1e-15);
    }

    /// Two unit spheres touching on y: about y 2·(2/5), about x and z 2·(2/5 + 1).
    #[test]
    fn touching_pair_matches_the_parallel_axis_theorem() {
        let mut pair = Spheres::default();
        pair.push([0.0, 2.0, 0.0], [0.0; 3], [0.0; 3], 1.0, 1.0);
        pair.push([0.0, 4.0, 0.0], [0.0; 3], [0.0; 3], 1.0, 1.0);
        let p = mass_properties(&pair).unwrap();
        assert_eq!((p.mass, p.centre), (2.0, Vector3::new(0.0, 3.0, 0.0)));
        assert!((p.inertia - Matrix3::from_diagonal(&Vector3::new(2.8, 0.8, 2.8))).norm() < 1e-15);
        assert!((p.axes.column(0) - Vector3::y()).norm() < 1e-15);
        assert!((p.half_extents - Vector3::new(2.0, 1.0, 1.0)).norm() < 1e-15);
    }

    /// Points on a fine grid in an ellipsoid; the sampling error falls with the grid step (here a / 30).
    #[test]
    fn densely_sampled_ellipsoid_returns_its_axes() {
        let (a, b, c) = (3.0, 2.0, 1.5);
        let step = 0.1;
        let mut grid = Spheres::default();
        for i in -30..=30 {
            for j in -20..=20 {
                for k in -15..=15 {
                    let r = [f64::from(i) * step, f64::from(j) * step, f64::from(k) * step];
                    if (r[0] / a).powi(2) + (r[1] / b).powi(2) + (r[2] / c).powi(2) <= 1.0 {
                        grid.push(r, [0.0; 3], [0.0; 3], 1.0, 1e-6);
                    }
                }
            }
        }
        let p = mass_properties(&grid).unwrap();
        assert!((p.deeve_axes() - Vector3::new(a, b, c)).amax() < 0.01, "{}", p.deeve_axes());
    }

    #[test]
    fn rigidly_rotating_body_has_momentum_inertia_times_spin() {
        let omega = Vector3::new(1e-4, -2e-4, 3e-4);
        let mut body = Spheres::default();
        for i in 0..20 {
            let t = f64::from(i);
            let r = Vector3::new((1.3 * t).sin() * 40.0, (2.1 * t).cos() * 20.0, (0.7 * t).sin() * 10.0);
            body.push(r.into(), (omega.cross(&r)).into(), omega.into(), 1.0 + 0.1 * t, 2.0);
        }
        let p = mass_properties(&body).unwrap();
        assert!((p.angular_momentum - p.inertia * omega).norm() < 1e-13 * p.angular_momentum.norm());
        assert!((p.angular_velocity() - omega).norm() < 1e-13 * omega.norm());
        assert!((p.axes.determinant() - 1.0).abs() < 1e-14);
        assert!(p.axes.column(2).dot(&p.angular_momentum) > 0.0);
        assert!(
            (p.axes.transpose() * p.inertia * p.axes - Matrix3::from_diagonal(&p.moments)).norm()
                < 1e-13 * p.moments[2]
        );
        let spin_energy = 0.5 * omega.dot(&(p.inertia * omega));
        let drift_energy = 0.5 * p.mass * p.velocity.norm_squared();
        assert!((p.kinetic_energy - spin_energy - drift_energy).abs() < 1e-13 * p.kinetic_energy);
    }

    #[test]
    fn empty_and_bad_aggregates_are_refused() {
        assert_eq!(mass_properties(&Spheres::default()), Err(PkdError::Empty));
        let mut bad = Spheres::default();
        bad.push([0.0; 3], [0.0; 3], [0.0; 3], -1.0, 1.0);
        assert!(matches!(mass_properties(&bad), Err(PkdError::BadValue { column: "mass", .. })));
        let mut vast = Spheres::default();
        vast.push([1e200, 0.0, 0.0], [0.0; 3], [0.0; 3], 1.0, 1.0);
        vast.push([-1e200, 0.0, 0.0], [0.0; 3], [0.0; 3], 1.0, 1.0);
        assert_eq!(mass_properties(&vast), Err(PkdError::NotFinite { quantity: "inertia tensor" }));
    }
}
