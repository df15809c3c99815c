//! How spheres, pairs and sums are laid out in memory, for each model of friction: nothing is kept that is not used.

use super::parameters::Friction;

/// Spheres without spin, contacts without memory.
pub(super) const FRICTIONLESS: u8 = 0;
/// A spring against sliding.
pub(super) const SLIDING: u8 = 1;
/// Springs against sliding, rolling and twisting.
pub(super) const FULL: u8 = 2;
/// A spring against sliding, constant torques against rolling and twisting.
pub(super) const DIRECTIONAL: u8 = 3;

/// Quads of a sphere's record. The first three numbers of each are a vector; the fourth is in brackets.
/// Centre, m \[radius, m\].
pub(super) const PLACE: usize = 0;
/// Velocity predicted for the time of the centre, m/s \[mass, kg\].
pub(super) const PREDICTED: usize = 1;
/// Velocity in the middle of the step that ended there, m/s \[1 / mass\].
pub(super) const VELOCITY: usize = 2;
/// Predicted spin, rad/s \[moment of inertia, kg m²\].
pub(super) const PREDICTED_SPIN: usize = 3;
/// Spin in the middle of the step, rad/s \[1 / moment of inertia\].
pub(super) const SPIN: usize = 4;

/// Model of a friction.
pub(super) fn model(friction: &Friction) -> u8 {
    match friction {
        Friction::None => FRICTIONLESS,
        Friction::Sliding(_) => SLIDING,
        Friction::RollingAndTwisting { .. } => FULL,
        Friction::Directional { .. } => DIRECTIONAL,
    }
}

/// Quads in a sphere's record.
pub(super) const fn quads(model: u8) -> usize {
    if model == FRICTIONLESS { 3 } else { 5 }
}

/// Quads in a sphere's sums: force, and torque where there are spins.
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
