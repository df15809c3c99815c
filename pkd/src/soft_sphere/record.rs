//! How spheres, pairs and sums are laid out in memory, for each model of friction: nothing is kept that is not used.

use std::ops::{Deref, DerefMut, Range};

use nalgebra::Vector3;

use super::lanes::{Octet, Quad};
use super::parameters::Friction;

/// Spheres without spin, contacts without memory.
pub(super) const FRICTIONLESS: u8 = 0;
/// A spring against sliding.
pub(super) const SLIDING: u8 = 1;
/// Springs against sliding, rolling and twisting.
pub(super) const FULL: u8 = 2;
/// A spring against sliding, constant torques against rolling and twisting.
pub(super) const DIRECTIONAL: u8 = 3;

/// Quads of a sphere's record, which fill two lines of the cache where there are spins. Three numbers and a fourth:
/// Centre, m; radius, m.
pub(super) const PLACE: usize = 0;
/// Velocity predicted for the time of the centre, m/s; x of the spin predicted for it, rad/s.
pub(super) const PREDICTED: usize = 1;
/// Velocity in the middle of the step that ended there, m/s; x of the spin then, rad/s.
pub(super) const VELOCITY: usize = 2;
/// y and z of the predicted spin, and of that in the middle of the step, rad/s.
pub(super) const SPINS: usize = 3;

/// Model of a friction.
pub(super) fn model(friction: &Friction) -> u8 {
    match friction {
        Friction::None => FRICTIONLESS,
        Friction::Sliding(_) => SLIDING,
        Friction::RollingAndTwisting { .. } => FULL,
        Friction::Directional { .. } => DIRECTIONAL,
    }
}

/// Quads that begin with a line of the cache.
#[derive(Debug)]
pub(super) struct Lines {
    quads: Vec<Quad>,
    within: Range<usize>,
}

impl Lines {
    pub fn new(count: usize) -> Self {
        let quads = vec![Quad::default(); count + 1];
        // A quad is half a line and begins with one half.
        let from = usize::from(!quads.as_ptr().cast::<Octet>().is_aligned());
        Self { quads, within: from..from + count }
    }
}

impl Deref for Lines {
    type Target = [Quad];
    fn deref(&self) -> &[Quad] {
        &self.quads[self.within.clone()]
    }
}

impl DerefMut for Lines {
    fn deref_mut(&mut self) -> &mut [Quad] {
        &mut self.quads[self.within.clone()]
    }
}

/// Quads in a sphere's record.
pub(super) const fn quads(model: u8) -> usize {
    if model == FRICTIONLESS { 3 } else { 4 }
}

/// The spin in the middle of the step, rad/s, from a record that has one.
pub(super) fn spin(record: &[Quad]) -> Vector3<f64> {
    Vector3::new(record[VELOCITY].0[3], record[SPINS].0[2], record[SPINS].0[3])
}

/// Writes the spin in the middle of the step, rad/s.
pub(super) fn set_spin(record: &mut [Quad], spin: Vector3<f64>) {
    (record[VELOCITY].0[3], record[SPINS].0[2], record[SPINS].0[3]) = (spin.x, spin.y, spin.z);
}

/// The torque, N m, from sums that have one.
pub(super) fn torque(sums: &[Quad]) -> Vector3<f64> {
    Vector3::new(sums[0].0[3], sums[1].0[0], sums[1].0[1])
}

/// Quads in a sphere's sums: force and x of the torque, then, where there are spins, y and z of it and two unused.
pub(super) const fn sums(model: u8) -> usize {
    if model == FRICTIONLESS { 1 } else { 2 }
}

/// How many constants a pair has, in this order: square root of the reduced mass; beta R_eff, for rolling, twisting or
/// cohesion; the inertias against rolling (kg m) and twisting (kg m²) of the directional model.
pub(super) const fn constants(model: u8, cohesive: bool) -> usize {
    1 + has_width(model, cohesive) as usize + if model == DIRECTIONAL { 2 } else { 0 }
}

/// Whether beta R_eff is among the constants.
pub(super) const fn has_width(model: u8, cohesive: bool) -> bool {
    model == FULL || cohesive
}

/// How many numbers a pair remembers: sliding spring (3), then rolling (3) and twisting spring (1), or the age (1).
pub(super) const fn memory(model: u8) -> usize {
    match model {
        FRICTIONLESS => 0,
        SLIDING => 3,
        FULL => 7,
        _ => 4,
    }
}

/// Constants and memory of a pair: each takes an octet for eight pairs.
pub(super) const fn fields(model: u8, cohesive: bool) -> usize {
    constants(model, cohesive) + memory(model)
}
