//! Whether heat stored over seasons, which is neglected, would matter.

use crate::heat::flux::unit_thermal_parameter;
use crate::orbit::Orbit;
use crate::recoil::RecoilTable;
use crate::surface::{Reflectance, Surface};
use std::fmt;

/// Change of the seasonal part of the emission above which [`seasonal_heat`] speaks up: the size of the torque's other
/// modelling errors.
const MATTERS: f64 = 0.05;

/// Heat stored over seasons, in numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeasonalHeat {
    /// `Gamma sqrt(n) / (emissivity sigma T_*^3)`, `n` the mean motion and `T_*` the subsolar temperature at the mean flux.
    pub thermal_parameter: f64,
    /// By how much of itself the annual harmonic of the emission would change, in linear theory: `|1 - 1 / (1 + z)|` with
    /// `z = Theta exp(i pi/4) / (4 T^3)` at the mean temperature `T = 4^(-1/4) T_*` of a sphere.
    pub relative_change: f64,
}

impl fmt::Display for SeasonalHeat {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            out,
            "heat stored over seasons is neglected, but would change the seasonal part of the emission by {:.0} % \
             (seasonal thermal parameter {:.3})",
            100.0 * self.relative_change,
            self.thermal_parameter
        )
    }
}

/// How much seasonal heat would change, if that is more than 5 %.
///
/// Without it the obliquity torque is odd and the spin torque even about 90 deg; the change given is the scale of what both
/// may be off by, in relation to the thermal part of the torque. The force lacks its seasonal part, which always shrinks
/// the orbit (Vokrouhlicky 1998, A&A 335, 1093).
pub fn seasonal_heat(surface: &Surface, orbit: &Orbit) -> Option<SeasonalHeat> {
    let albedo = match surface.reflectance {
        Reflectance::None => 0.0,
        Reflectance::Lambert { bond_albedo } => bond_albedo,
        Reflectance::Hapke(hapke) => RecoilTable::cached(&hapke).bond_albedo(),
    };
    let absorbed = (1.0 - albedo) * orbit.mean_flux_w_m2();
    let thermal_parameter = surface.thermal_inertia
        * orbit.mean_motion_rad_s().sqrt()
        * unit_thermal_parameter(absorbed, surface.emissivity);
    // 4 T^3 / T_*^3 = 4 4^(-3/4) = sqrt 2; z = x (1 + i).
    let x = thermal_parameter / 2.0;
    let relative_change = (2.0 * x * x / ((1.0 + x) * (1.0 + x) + x * x)).sqrt();
    (relative_change > MATTERS).then_some(SeasonalHeat { thermal_parameter, relative_change })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rock_far_from_the_sun_is_warned_about_and_dust_is_not() {
        let with = |thermal_inertia| Surface { thermal_inertia, ..Surface::default() };
        assert_eq!(seasonal_heat(&with(0.0), &Orbit::default()), None);
        assert_eq!(seasonal_heat(&with(50.0), &Orbit::default()), None);
        let far = Orbit { semimajor_axis_au: 2.8, eccentricity: 0.1 };
        let warning = seasonal_heat(&with(2000.0), &far).unwrap();
        // Gamma sqrt(n) / (0.9 sigma T_*^3), T_* = 244 K at 2.8 au.
        assert!((warning.thermal_parameter - 0.26 * 2000.0 / 2000.0).abs() < 0.4, "{warning:?}");
        assert!(warning.to_string().contains("seasonal"), "{warning}");
    }
}
