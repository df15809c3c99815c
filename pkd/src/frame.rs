//! Rigid changes of an aggregate: moving its frame to its principal axes, imposing and adding rotation.
//!
//! SI units. Relative positions and velocities of the spheres stay what they were, to round-off.

use nalgebra::{Matrix3, Vector3};

use crate::mass_properties::mass_properties;
use crate::{PkdError, Spheres};

/// How [`to_principal_axes`] moved an aggregate: `x_new = rotationᵀ (x_old - centre)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameChange {
    /// Principal axes as columns, in the old frame.
    pub rotation: Matrix3<f64>,
    /// Centre of mass in the old frame, m.
    pub centre: Vector3<f64>,
    /// Velocity of the centre of mass in the old frame, m/s.
    pub velocity: Vector3<f64>,
}

/// Moves `spheres` into the frame of their principal axes (x long, z short and on the side of the angular momentum),
/// with the centre of mass at rest in the origin.
///
/// # Errors
/// Whatever [`Spheres::validate`] finds; nothing is changed then.
pub fn to_principal_axes(spheres: &mut Spheres) -> Result<FrameChange, PkdError> {
    let p = mass_properties(spheres)?;
    let change = FrameChange { rotation: p.axes, centre: p.centre, velocity: p.velocity };
    for i in 0..spheres.len() {
        let r = p.axes.tr_mul(&(Vector3::from(spheres.position(i)) - p.centre));
        let v = p.axes.tr_mul(&(Vector3::from(spheres.velocity(i)) - p.velocity));
        let w = p.axes.tr_mul(&Vector3::from(spheres.spin(i)));
        spheres.set(i, r.into(), v.into(), w.into());
    }
    Ok(change)
}

/// Moves the centre of mass to the origin and takes its velocity away.
///
/// # Errors
/// Whatever [`Spheres::validate`] finds; nothing is changed then.
pub fn recentre(spheres: &mut Spheres) -> Result<(), PkdError> {
    let p = mass_properties(spheres)?;
    for i in 0..spheres.len() {
        let r = Vector3::from(spheres.position(i)) - p.centre;
        let v = Vector3::from(spheres.velocity(i)) - p.velocity;
        spheres.set(i, r.into(), v.into(), spheres.spin(i));
    }
    Ok(())
}

/// Replaces all velocities and spins by a rigid rotation `omega` (rad/s) about the centre of mass, which comes to rest.
///
/// # Errors
/// Whatever [`Spheres::validate`] finds; nothing is changed then.
pub fn set_rigid_rotation(spheres: &mut Spheres, omega: Vector3<f64>) -> Result<(), PkdError> {
    let p = mass_properties(spheres)?;
    for i in 0..spheres.len() {
        let r = Vector3::from(spheres.position(i));
        spheres.set(i, r.into(), omega.cross(&(r - p.centre)).into(), omega.into());
    }
    Ok(())
}

/// Adds a rigid rotation `d_omega` (rad/s) about the centre of mass to all velocities and spins.
///
/// # Errors
/// Whatever [`Spheres::validate`] finds; nothing is changed then.
pub fn add_spin(spheres: &mut Spheres, d_omega: Vector3<f64>) -> Result<(), PkdError> {
    let p = mass_properties(spheres)?;
    for i in 0..spheres.len() {
        let r = Vector3::from(spheres.position(i));
        let v = Vector3::from(spheres.velocity(i)) + d_omega.cross(&(r - p.centre));
        let w = Vector3::from(spheres.spin(i)) + d_omega;
        spheres.set(i, r.into(), v.into(), w.into());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lumpy_body() -> Spheres {
        let mut body = Spheres::default();
        for i in 0..30 {
            let t = f64::from(i);
            let r = [(1.3 * t).sin() * 60.0 + 7.0, (2.1 * t).cos() * 20.0 - 3.0, (0.7 * t).sin() * 10.0];
            let v = [0.01 * t.cos(), 0.02 * t.sin(), 0.03];
            body.push(r, v, [1e-4 * t, 0.0, -2e-4], 1.0 + 0.1 * t, 2.0);
        }
        body
    }

    #[test]
    fn principal_frame_diagonalises_the_inertia_tensor_and_keeps_distances_and_energy() {
        let before = lumpy_body();
        let mut after = before.clone();
        let change = to_principal_axes(&mut after).unwrap();
        let (p, q) = (mass_properties(&before).unwrap(), mass_properties(&after).unwrap());
        assert!((q.inertia - Matrix3::from_diagonal(&p.moments)).norm() < 1e-13 * p.moments[2]);
        assert!(q.centre.norm() < 1e-13 && q.velocity.norm() < 1e-16);
        let inner = p.kinetic_energy - 0.5 * p.mass * p.velocity.norm_squared();
        assert!((q.kinetic_energy - inner).abs() < 1e-13 * inner);
        assert!((change.rotation.tr_mul(&p.angular_momentum) - q.angular_momentum).norm() < 1e-12);
        let back = change.rotation * Vector3::from(after.position(5)) + change.centre;
        assert!((back - Vector3::from(before.position(5))).norm() < 1e-13);
    }

    #[test]
    fn imposed_rotation_gives_its_angular_momentum_and_added_spin_adds_to_it() {
        let mut body = lumpy_body();
        let omega = Vector3::new(1e-5, 2e-5, 3e-4);
        set_rigid_rotation(&mut body, omega).unwrap();
        let p = mass_properties(&body).unwrap();
        assert!((p.angular_momentum - p.inertia * omega).norm() < 1e-13 * p.angular_momentum.norm());
        assert!(p.velocity.norm() < 1e-17);
        add_spin(&mut body, omega * 0.005).unwrap();
        let q = mass_properties(&body).unwrap();
        assert!((q.angular_momentum - p.angular_momentum * 1.005).norm() < 1e-13 * p.angular_momentum.norm());
        recentre(&mut body).unwrap();
        let q = mass_properties(&body).unwrap();
        assert!(q.centre.norm() < 1e-13 && q.velocity.norm() < 1e-17);
    }
}
