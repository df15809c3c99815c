//! The spin axis: rotation that is left over after spheres have come to rest, and what a leg adds along it.

use nalgebra::Vector3;
use pkd::Spheres;
use pkd::frame::{add_angular_momentum, align_with_angular_momentum};
use pkd::mass_properties::mass_properties;

use super::EvolveError;
use super::block::Aggregate;
use crate::scene::{ResidualRotation, Scene};
use crate::store::AngularMomentumRecord;

/// A share of the angular momentum across the axis of largest moment above which the user is told, and above which the
/// turned body is followed for another block: its new axis loads it in another way.
pub const TILT_LIMIT: f64 = 0.02;

/// Gives `spheres` the angular momentum `change` (kg m^2/s) along the one that they have, as a rigid rotation.
///
/// Along L and not along an axis of the body: torques are those of a body that turns about its axis of largest moment, and
/// with the two largest moments nearly equal the eigenvector of the third says nothing about where that is.
///
/// # Errors
/// A sphere that is not finite.
pub fn give_along_spin(spheres: &mut Spheres, change: f64) -> Result<(), EvolveError> {
    let properties = mass_properties(spheres)?;
    let axis = properties.angular_momentum.try_normalize(0.0);
    let axis = axis.unwrap_or_else(|| Vector3::from(properties.axes.column(2)));
    Ok(add_angular_momentum(spheres, axis * change)?)
}

/// Lets the rotation that is left over dissipate if the scene wants it: the same angular momentum, about the axis of largest
/// moment. Returns whether the body was turned.
///
/// # Errors
/// A sphere that is not finite.
pub fn align(scene: &Scene, body: &mut Aggregate) -> Result<bool, EvolveError> {
    if scene.settling.residual_rotation == ResidualRotation::Keep {
        return Ok(false);
    }
    let done = align_with_angular_momentum(&mut body.spheres)?;
    body.contacts.rotate(&done.rotation);
    Ok(true)
}

/// Closes the books of a leg, whose spheres are `spheres` in the end, for the spin rate `omega` (rad/s) of the next one.
///
/// # Errors
/// A sphere that is not finite.
pub fn close_books(
    books: AngularMomentumRecord,
    spheres: &Spheres,
    omega: f64,
) -> Result<AngularMomentumRecord, EvolveError> {
    let properties = mass_properties(spheres)?;
    let end = properties.angular_momentum.norm();
    let carried = properties.moments.z * omega;
    let over_spin = if carried > 0.0 { end / carried } else { 1.0 };
    Ok(AngularMomentumRecord { end, over_spin, ..books })
}
