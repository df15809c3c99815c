//! Torque and force of the light that a facet emits, from harmonics of its emission over the rotation.

use crate::day::{cross, emission_vector};
use crate::exchange::Wrench;
use crate::facets::Facet;
use crate::sky::SkyView;

/// A facet as an emitter, in its (meridian, east, spin axis) frame.
pub(crate) struct Emission {
    /// Momentum that leaves per emitted energy, times area and the speed of light, m^2.
    vector: [f64; 3],
    /// The facet's point crossed with it, m^3.
    arm: [f64; 3],
}

impl Emission {
    /// Of the share `share` of a facet.
    pub fn new(facet: &Facet, sky: &SkyView, share: f64) -> Self {
        let vector = emission_vector(facet, sky).map(|p| share * facet.area * p);
        Self { vector, arm: cross(facet.local_point(), vector) }
    }

    /// Of the share `share` of a facet part of whose light leaves from other facets, at once.
    pub fn followed(facet: &Facet, wrench: &Wrench, share: f64) -> Self {
        let local = |v: [f64; 3]| facet.local(v).map(|c| share * facet.area * c);
        Self { vector: local(wrench.momentum), arm: local(wrench.angular_momentum) }
    }

    /// Torque along the Sun's equatorial direction of the emission's means times the cosine and the sine of the Sun's hour
    /// angle, N m per pressure (emission over speed of light).
    pub fn along_sun(&self, [cos, sin]: [f64; 2]) -> f64 {
        -self.arm[0] * cos - self.arm[1] * sin
    }

    /// Force along the direction of orbital motion at zero obliquity, `u x z` with `u` the Sun's equatorial direction, N per
    /// pressure, of the same means.
    pub fn transverse(&self, [cos, sin]: [f64; 2]) -> f64 {
        self.vector[1] * cos - self.vector[0] * sin
    }
}
