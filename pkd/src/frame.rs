//! Rigid changes of an aggregate: moving its frame to its principal axes, imposing and adding rotation.
//!
//! SI units. Relative positions and velocities of the spheres stay what they were, to round-off.

use nalgebra::{Matrix3, Rotation3, Vector3};

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

/// Adds the angular momentum `change` (kg m²/s) about the centre of mass as a rigid rotation I⁻¹ `change`.
///
/// # Errors
/// Whatever [`Spheres::validate`] finds; nothing is changed then.
pub fn add_angular_momentum(spheres: &mut Spheres, change: Vector3<f64>) -> Result<(), PkdError> {
    let d_omega = mass_properties(spheres)?.rigid_rotation_of(change);
    add_spin(spheres, d_omega)
}

/// What [`align_with_angular_momentum`] did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alignment {
    /// The rotation that took the old positions about the centre of mass to the new ones.
    pub rotation: Matrix3<f64>,
    /// Angle between the axis of largest moment and the angular momentum before, rad, 0 to pi/2.
    pub angle: f64,
}

/// Makes `spheres` a rigid body that turns about its axis of largest moment with the angular momentum that it has: what
/// dissipation within the body comes to in the long run.
///
/// The angular momentum stays as it is and the body is turned, by the smallest angle, so that its axis lies along it.
/// Where the two largest moments are equal to round-off any axis between them serves and the nearest one is taken. A body
/// without angular momentum is left as it is.
///
/// # Errors
/// Whatever [`Spheres::validate`] finds; nothing is changed then.
pub fn align_with_angular_momentum(spheres: &mut Spheres) -> Result<Alignment, PkdError> {
    let p = mass_properties(spheres)?;
    let momentum = p.angular_momentum;
    let Some(along) = momentum.try_normalize(0.0) else {
        return Ok(Alignment { rotation: Matrix3::identity(), angle: 0.0 });
    };
    let axis = p.axis_of_largest_moment_nearest_to(along);
    let rotation = Rotation3::rotation_between(&axis, &along).unwrap_or_else(Rotation3::identity).into_inner();
    for i in 0..spheres.len() {
        let r = rotation * (Vector3::from(spheres.position(i)) - p.centre);
        spheres.set(i, r.into(), [0.0; 3], [0.0; 3]);
    }
    // The spin that gives back exactly this angular momentum: |L|/C about the axis, to the round-off of the axis.
    add_angular_momentum(spheres, momentum)?;
    Ok(Alignment { rotation, angle: axis.cross(&along).norm().atan2(axis.dot(&along)) })
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

    #[test]
    fn alignment_keeps_the_angular_momentum_and_leaves_rotation_about_the_axis_of_largest_moment() {
        let mut body = lumpy_body();
        let before = mass_properties(&body).unwrap();
        let done = align_with_angular_momentum(&mut body).unwrap();
        let after = mass_properties(&body).unwrap();
        assert!(done.angle > 0.1 && (done.angle.sin() - before.across_axis()).abs() < 1e-12);
        let momentum = before.angular_momentum;
        assert!((after.angular_momentum - momentum).norm() < 1e-13 * momentum.norm());
        assert!((after.moments - before.moments).norm() < 1e-13 * before.moments.norm());
        assert!(after.across_axis() < 1e-12 && after.velocity.norm() < 1e-16);
        assert!(align_with_angular_momentum(&mut body).unwrap().angle < 1e-12);
    }

    /// Two spheres have B = C: their line is turned across the angular momentum and no farther.
    #[test]
    fn a_pair_that_turns_about_any_axis_across_its_line_is_aligned_already() {
        for axis in [Vector3::y(), Vector3::z(), Vector3::new(0.0, 0.6, -0.8)] {
            let mut pair = Spheres::default();
            pair.push([-100.0, 0.0, 0.0], [0.0; 3], [0.0; 3], 8e9, 100.0);
            pair.push([100.0, 0.0, 0.0], [0.0; 3], [0.0; 3], 8e9, 100.0);
            set_rigid_rotation(&mut pair, axis * 2e-4).unwrap();
            let done = align_with_angular_momentum(&mut pair).unwrap();
            assert!(done.angle < 1e-15 && pair.position(1) == [100.0, 0.0, 0.0], "{done:?}");
        }
    }

    #[test]
    fn added_angular_momentum_is_what_was_asked_for_and_a_body_at_rest_stays_as_it_lies() {
        let mut body = lumpy_body();
        let before = mass_properties(&body).unwrap().angular_momentum;
        let change = Vector3::new(0.1, -0.2, 0.4) * before.norm();
        add_angular_momentum(&mut body, change).unwrap();
        let after = mass_properties(&body).unwrap().angular_momentum;
        assert!((after - before - change).norm() < 1e-13 * before.norm());
        set_rigid_rotation(&mut body, Vector3::zeros()).unwrap();
        let still = body.clone();
        assert_eq!(align_with_angular_momentum(&mut body).unwrap().angle, 0.0);
        assert_eq!(body, still);
    }
}
