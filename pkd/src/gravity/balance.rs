//! Net force and torque of an approximate field, taken out so that momentum and angular momentum are kept exactly.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use super::Accelerations;

/// Below this determinant over trace cubed the adjugate of an inertia tensor is mostly round-off: two spheres, a line of
/// spheres. Its eigenvectors still are good to round-off, so the axis of the line can be told from the other two.
const NEARLY_A_LINE: f64 = 1e-8;

/// Moments below this share of the trace are zero: nothing about that axis can take up a torque, and there is none.
const NO_MOMENT: f64 = 1e-14;

/// Sums of mass times products of coordinates about the centre of mass: xx, yy, zz, xy, xz, yz, kg m².
type SecondMoments = [f64; 6];

/// The angular acceleration (rad/s²) that `torque` (N m) gives to point masses with these second moments.
///
/// A field of accelerations with that net torque loses it, and no net force, when `alpha x r` is taken from it. The
/// moments are those of points: the spheres' own moments have no part in what forces at their centres do.
pub(crate) fn angular_acceleration(torque: [f64; 3], [xx, yy, zz, xy, xz, yz]: SecondMoments) -> [f64; 3] {
    let torque = Vector3::from(torque);
    let inertia = Matrix3::new(yy + zz, -xy, -xz, -xy, xx + zz, -yz, -xz, -yz, xx + yy);
    let trace = inertia.trace();
    if !(trace > 0.0 && trace.is_finite()) {
        return [0.0; 3];
    }
    if inertia.determinant() > NEARLY_A_LINE * trace * trace * trace {
        return inertia.try_inverse().map_or([0.0; 3], |inverse| (inverse * torque).into());
    }
    let eigen = SymmetricEigen::new(inertia);
    let share = |k: usize| {
        let (moment, axis) = (eigen.eigenvalues[k], eigen.eigenvectors.column(k));
        if moment > NO_MOMENT * trace { axis * (axis.dot(&torque) / moment) } else { Vector3::zeros() }
    };
    (share(0) + share(1) + share(2)).into()
}

/// Takes the net force and the net torque about the centre of mass out of `accelerations` (m/s²) of points at
/// `coordinates` (m) with `mass` (kg): a rigid acceleration of the whole, of the size of the field's error.
pub(crate) fn balance(coordinates: [&[f64]; 3], mass: &[f64], accelerations: &mut Accelerations) {
    let total: f64 = mass.iter().sum();
    let mean = |values: &[f64]| values.iter().zip(mass).map(|(v, m)| v * m).sum::<f64>() / total;
    let centre = coordinates.map(mean);
    let Accelerations { x, y, z } = accelerations;
    for component in [&mut *x, &mut *y, &mut *z] {
        let mean = mean(component);
        component.iter_mut().for_each(|a| *a -= mean);
    }
    let place = |i: usize| Vector3::from_fn(|k, _| coordinates[k][i] - centre[k]);
    let (mut torque, mut moments) = (Vector3::zeros(), [0.0; 6]);
    for (i, m) in mass.iter().enumerate() {
        let r = place(i);
        torque += r.cross(&Vector3::new(x[i], y[i], z[i])) * *m;
        let products = [r.x * r.x, r.y * r.y, r.z * r.z, r.x * r.y, r.x * r.z, r.y * r.z];
        moments.iter_mut().zip(products).for_each(|(sum, p)| *sum += m * p);
    }
    let alpha = Vector3::from(angular_acceleration(torque.into(), moments));
    for i in 0..mass.len() {
        let change = alpha.cross(&place(i));
        x[i] -= change.x;
        y[i] -= change.y;
        z[i] -= change.z;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn torque_and_force(at: [&[f64]; 3], mass: &[f64], a: &Accelerations) -> (f64, f64) {
        let (mut torque, mut force) = (Vector3::zeros(), Vector3::zeros());
        for (i, m) in mass.iter().enumerate() {
            let (r, a) = (Vector3::from_fn(|k, _| at[k][i]), Vector3::new(a.x[i], a.y[i], a.z[i]) * *m);
            torque += r.cross(&a);
            force += a;
        }
        (torque.norm(), force.norm())
    }

    /// Any field on points in space, on a plane, on a line in any direction, and on a pair.
    #[test]
    fn net_force_and_torque_are_taken_out_of_bodies_of_every_rank() {
        let n = 40;
        let wave = |a: f64, b: f64| (0..n).map(|i| (a * f64::from(i) + b).sin()).collect::<Vec<f64>>();
        let mass: Vec<f64> = wave(3.0, 0.0).iter().map(|m| 2.0 + m).collect();
        let (x, y, z) = (wave(1.1, 0.3), wave(1.7, 0.2), wave(2.3, 0.1));
        let line = |k: f64| x.iter().map(|x| k * x).collect::<Vec<f64>>();
        for at in [[x.clone(), y.clone(), z], [x.clone(), y, line(0.3)], [line(1.0), line(-0.7), line(0.2)]] {
            let at = at.each_ref().map(Vec::as_slice);
            let mut a = Accelerations { x: wave(0.9, 1.0), y: wave(1.3, 2.0), z: wave(0.7, 3.0) };
            if at[2][1] == 0.2 * at[0][1] {
                // Gravity of points on a line acts along it, but for its error.
                let along = wave(0.9, 1.0);
                (0..n as usize).for_each(|i| {
                    (a.x[i], a.y[i], a.z[i]) = (along[i] + 1e-3 * a.x[i], -0.7 * along[i], 0.2 * along[i]);
                });
            }
            balance(at, &mass, &mut a);
            let (torque, force) = torque_and_force(at, &mass, &a);
            assert!(torque < 1e-12 && force < 1e-12, "{torque} {force}");
        }
    }

    #[test]
    fn a_single_point_has_no_torque_to_lose() {
        assert_eq!(angular_acceleration([1.0, 2.0, 3.0], [0.0; 6]), [0.0; 3]);
    }
}
