//! Osculating orbits about the primary as a point mass.

use super::mascons::{cross, dot, norm};

/// Osculating elements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elements {
    /// Semimajor axis, m; negative on a hyperbola.
    pub semimajor_axis_m: f64,
    /// Eccentricity.
    pub eccentricity: f64,
    /// Inclination to the equator of the primary, rad.
    pub inclination: f64,
}

/// Two-body energy per mass, m^2/s^2, of a position (m) and velocity (m/s) about `gm` (m^3/s^2).
pub(super) fn specific_energy(gm: f64, position: [f64; 3], velocity: [f64; 3]) -> f64 {
    0.5 * dot(velocity, velocity) - gm / norm(position)
}

/// Whether a position (m) and velocity (m/s) lead away for good: outwards, beyond `far` (m), with positive two-body energy.
pub(super) fn leaves_for_good(gm: f64, far: f64, position: [f64; 3], velocity: [f64; 3]) -> bool {
    norm(position) > far && dot(position, velocity) > 0.0 && specific_energy(gm, position, velocity) > 0.0
}

/// Elements of a position (m) and velocity (m/s) about `gm` (m^3/s^2).
pub(super) fn elements(gm: f64, position: [f64; 3], velocity: [f64; 3]) -> Elements {
    let h = cross(position, velocity);
    let along = cross(velocity, h);
    let r = norm(position);
    let eccentricity: [f64; 3] = std::array::from_fn(|k| along[k] / gm - position[k] / r);
    Elements {
        semimajor_axis_m: -0.5 * gm / specific_energy(gm, position, velocity),
        eccentricity: norm(eccentricity),
        inclination: (h[0] * h[0] + h[1] * h[1]).sqrt().atan2(h[2]),
    }
}
