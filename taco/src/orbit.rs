//! The heliocentric orbit, as far as a torque that stores no heat feels it.

use crate::constants::{ASTRONOMICAL_UNIT_M, SOLAR_CONSTANT_W_M2, SPEED_OF_LIGHT_M_S, SUN_GM_M3_S2};
use crate::error::{TacoError, require};

/// Size and shape of the heliocentric orbit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orbit {
    /// Semimajor axis, au, in [0.01, 1000] (default: 1).
    pub semimajor_axis_au: f64,
    /// Eccentricity, in [0, 1) (default: 0).
    pub eccentricity: f64,
}

/// One metre per second in au per million Julian years.
pub const AU_PER_MYR: f64 = 3.155_76e13 / ASTRONOMICAL_UNIT_M;

impl Default for Orbit {
    fn default() -> Self {
        Self { semimajor_axis_au: 1.0, eccentricity: 0.0 }
    }
}

impl Orbit {
    /// Flux of sunlight that makes the time average over the orbit equal to the plain average over true longitude,
    /// W/m^2: `S0 / (a^2 sqrt(1 - e^2))`, exact because `dt ~ r^2 d lambda` takes out the `1/r^2` of the flux.
    pub fn mean_flux_w_m2(&self) -> f64 {
        let (a, e) = (self.semimajor_axis_au, self.eccentricity);
        SOLAR_CONSTANT_W_M2 / (a * a * ((1.0 - e) * (1.0 + e)).sqrt())
    }

    /// [`Self::mean_flux_w_m2`] as a pressure, Pa.
    pub fn mean_pressure_pa(&self) -> f64 {
        self.mean_flux_w_m2() / SPEED_OF_LIGHT_M_S
    }

    /// Mean motion, rad/s.
    pub fn mean_motion_rad_s(&self) -> f64 {
        (SUN_GM_M3_S2 / (self.semimajor_axis_au * ASTRONOMICAL_UNIT_M).powi(3)).sqrt()
    }

    /// Drift of the semimajor axis of a body of the mass `mass_kg`, m/s, under the orbit-averaged transverse force of a
    /// [`TorqueTable`](crate::TorqueTable), N: `2 F / (n m)`. Times [`AU_PER_MYR`] it is in au per Myr.
    pub fn semimajor_axis_drift_m_s(&self, transverse_force_n: f64, mass_kg: f64) -> f64 {
        2.0 * transverse_force_n / (self.mean_motion_rad_s() * mass_kg)
    }

    /// Refuses impossible values.
    ///
    /// # Errors
    /// [`TacoError::OutOfRange`] with the path of the value.
    pub fn validate(&self) -> Result<(), TacoError> {
        let (a, e) = (self.semimajor_axis_au, self.eccentricity);
        require((0.01..=1000.0).contains(&a), "orbit.semimajor_axis_au", a, "[0.01, 1000] au")?;
        require((0.0..1.0).contains(&e), "orbit.eccentricity", e, "[0, 1)")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eccentric_orbit_receives_the_time_average_of_the_flux() {
        let orbit = Orbit { semimajor_axis_au: 1.7, eccentricity: 0.6 };
        // Kepler's equation in the eccentric anomaly: dt = (1 - e cos E) dE, r = a (1 - e cos E).
        let n = 1000;
        let average = (0..n)
            .map(|k| {
                let r = 1.0 - 0.6 * (std::f64::consts::TAU * f64::from(k) / f64::from(n)).cos();
                r / (r * r)
            })
            .sum::<f64>()
            / f64::from(n);
        let expected = SOLAR_CONSTANT_W_M2 * average / (1.7 * 1.7);
        assert!((orbit.mean_flux_w_m2() / expected - 1.0).abs() < 1e-12);
        assert!((Orbit::default().mean_pressure_pa() / 4.53981e-6 - 1.0).abs() < 1e-6);
    }

    #[test]
    fn unbound_orbit_is_refused() {
        let orbit = Orbit { eccentricity: 1.0, ..Orbit::default() };
        assert!(matches!(orbit.validate(), Err(TacoError::OutOfRange { path: "orbit.eccentricity", .. })));
    }
}
