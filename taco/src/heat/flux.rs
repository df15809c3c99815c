//! Fluxes of sunlight at which heat is conducted on an eccentric orbit.
//!
//! `J dt` is proportional to `df`, `f` the true anomaly, so the time average of `J g(J)` is the mean flux times the plain
//! average of `g` over `f`: the midpoint rule in `f`, which converges geometrically because `g` is smooth in `J`.

use crate::constants::{SOLAR_CONSTANT_W_M2, STEFAN_BOLTZMANN_W_M2_K4};
use crate::orbit::Orbit;
use std::f64::consts::PI;

/// Relative error of the rule, and the most fluxes it takes: enough for it up to an eccentricity of 0.95.
const TOLERANCE: f64 = 1e-4;
const NODES: usize = 16;

/// Sunlight at one distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FluxNode {
    /// Flux of the beam, W/m^2.
    pub flux_w_m2: f64,
    /// Weight of torques per unit of the mean pressure; the weights sum to 1.
    pub torque: f64,
    /// Weight of transverse forces likewise, such that `da/dt = 2 F / (n m)` for the averaged force `F`.
    ///
    /// Averaged over the perihelion's direction, only the transverse part of Gauss' equation survives,
    /// `da/dt = 2 (1 + e cos f) S / (n sqrt(1 - e^2))`.
    pub force: f64,
}

/// The fluxes of an orbit; one if it is circular.
pub(crate) fn flux_nodes(orbit: &Orbit) -> Vec<FluxNode> {
    let (a, e) = (orbit.semimajor_axis_au, orbit.eccentricity);
    let minor = ((1.0 - e) * (1.0 + e)).sqrt();
    // Functions of 1 + e cos f have harmonics that fall as the powers of this.
    let ratio = e / (1.0 + minor);
    let nodes = if e == 0.0 { 1 } else { ((0.5 * TOLERANCE.ln() / ratio.ln()).ceil() as usize).clamp(1, NODES) };
    (0..nodes)
        .map(|k| {
            let over_parameter = 1.0 + e * (PI * (k as f64 + 0.5) / nodes as f64).cos();
            let distance_au = a * minor * minor / over_parameter;
            FluxNode {
                flux_w_m2: SOLAR_CONSTANT_W_M2 / (distance_au * distance_au),
                torque: 1.0 / nodes as f64,
                force: over_parameter / minor / nodes as f64,
            }
        })
        .collect()
}

/// `sqrt(omega) Gamma / (emissivity sigma T_*^3)` for unit thermal inertia and `omega` = 1, with `T_*` the temperature that
/// emits the whole beam.
pub(crate) fn unit_thermal_parameter(flux_w_m2: f64, emissivity: f64) -> f64 {
    1.0 / ((emissivity * STEFAN_BOLTZMANN_W_M2_K4).powf(0.25) * flux_w_m2.powf(0.75))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_average_powers_of_the_flux_over_time() {
        for e in [0.0, 0.2, 0.6, 0.9] {
            let orbit = Orbit { semimajor_axis_au: 1.3, eccentricity: e };
            let nodes = flux_nodes(&orbit);
            assert!(e > 0.0 || nodes.len() == 1);
            // <J^1.75> and <J^1.75 sqrt(1 - e^2) a / r> over the mean anomaly.
            let n = 20_000;
            let mut exact = [0.0; 2];
            for k in 0..n {
                let r = 1.0 - e * (2.0 * PI * f64::from(k) / f64::from(n)).cos();
                let flux = SOLAR_CONSTANT_W_M2 / (1.3 * 1.3 * r * r);
                let term = r * flux.powf(1.75) / f64::from(n);
                exact[0] += term;
                exact[1] += term * (1.0 - e * e).sqrt() / r;
            }
            let sum = |weight: fn(&FluxNode) -> f64| -> f64 {
                nodes.iter().map(|n| weight(n) * n.flux_w_m2.powf(0.75)).sum::<f64>() * orbit.mean_flux_w_m2()
            };
            let got = [sum(|n| n.torque), sum(|n| n.force)];
            for k in 0..2 {
                assert!((got[k] / exact[k] - 1.0).abs() < 2e-4, "{e}: {got:?} {exact:?}");
            }
        }
    }

    /// Gamma = 200, a period of 6 h, an absorptivity of 0.9328 and an emissivity of 0.9 at 1 au.
    #[test]
    fn thermal_parameter_matches_published_conventions() {
        let absorbed = 0.9328 * SOLAR_CONSTANT_W_M2;
        let theta = 200.0 * (2.0 * PI / 21_600.0f64).sqrt() * unit_thermal_parameter(absorbed, 0.9);
        assert!((theta - 1.067).abs() < 1e-3, "{theta}");
    }
}
