//! How spin and shape evolve together in a scene, on which surface.
//!
//! Defaults are those of Cotto-Figueroa et al. (2015), sections 2.4 and 2.6.

use serde::{Deserialize, Serialize};

/// The surface fitted to the spheres: zero level of `sum (R/|x - x_j|)^(2n) - G0` (equation 1 of the paper).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct TilingOptions {
    /// Number of triangles, even: `2 V - 4` with `V` vertices (default 784).
    pub facets: u32,
    /// Exponent n of the implicit function (default 2).
    pub exponent: u32,
    /// Level G0 (default 1.25).
    pub level: f64,
}

impl Default for TilingOptions {
    fn default() -> Self {
        Self { facets: 784, exponent: 2, level: 1.25 }
    }
}

impl TilingOptions {
    /// Number of vertices of a closed surface without handles that has so many triangles.
    pub fn vertices(&self) -> usize {
        self.facets as usize / 2 + 2
    }
}

/// Spin evolution and its coupling to the shape.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Evolution {
    /// End of the evolution, Myr (default 15).
    pub duration_myr: f64,
    /// Relative change of the spin rate after which the aggregate is looked at again (default 0.005).
    pub spin_change: f64,
    /// Step of the fourth-order Runge-Kutta integration of spin and obliquity, yr (default 1000).
    pub rk4_step_yr: f64,
    /// A sphere counts as moved when it shifted by more than this fraction of its radius (default 0.25).
    pub movement_radius_fraction: f64,
    /// How moved spheres are told from the rest (default robust).
    pub movement_rule: MovementRule,
    /// When something moved, spheres that shifted by no more than this fraction of their radius keep their places on the new
    /// surface: that is how far spheres at rest rattle (default 0.05).
    pub rattle_radius_fraction: f64,
    /// If more than this fraction of the spheres moved at once, the step is taken again in fifths (default 0.5).
    pub moved_fraction_limit: f64,
    /// Period beyond which the body counts as spun down, h (default 20). Null leaves 480 h (20 days), beyond which every run
    /// ends: slower bodies tumble and meet resonances that are not computed.
    pub stop_period_h: Option<f64>,
}

/// Period, h, beyond which a body that slows down has come to the end of its YORP cycle, whatever `stop_period_h` says:
/// real bodies tumble there and meet resonances. 20 days.
pub const CYCLE_END_PERIOD_H: f64 = 480.0;

impl Default for Evolution {
    fn default() -> Self {
        Self {
            duration_myr: 15.0,
            spin_change: 0.005,
            rk4_step_yr: 1000.0,
            movement_radius_fraction: 0.25,
            movement_rule: MovementRule::Robust,
            rattle_radius_fraction: 0.05,
            moved_fraction_limit: 0.5,
            stop_period_h: Some(20.0),
        }
    }
}

/// How moved spheres are excluded from the fit of the rigid motion.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MovementRule {
    /// Tolerance shrinking from the median residual, spheres may come back: a coherent slide of a part is found.
    #[default]
    Robust,
    /// The rule as the paper words it: whatever is beyond the limit is left out for good.
    Literal,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_of_a_cycle_is_that_of_the_integrator() {
        let period_h = std::f64::consts::TAU / crate::evolve::spin::CYCLE_END_OMEGA / 3600.0;
        assert!((period_h / CYCLE_END_PERIOD_H - 1.0).abs() < 1e-12);
    }
}
