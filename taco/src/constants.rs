//! Physical constants of sunlight, SI.

/// Astronomical unit, m (IAU 2012 resolution B2).
pub const ASTRONOMICAL_UNIT_M: f64 = 1.495978707e11;

/// Speed of light, m/s (exact).
pub const SPEED_OF_LIGHT_M_S: f64 = 299_792_458.0;

/// Solar constant at 1 au, W/m^2 (IAU 2015 resolution B3, nominal total irradiance).
pub const SOLAR_CONSTANT_W_M2: f64 = 1361.0;

/// Stefan-Boltzmann constant, W m^-2 K^-4 (CODATA 2018).
pub const STEFAN_BOLTZMANN_W_M2_K4: f64 = 5.670374419e-8;

/// Gravitational parameter of the Sun, m^3 s^-2 (DE405).
pub const SUN_GM_M3_S2: f64 = 1.327_124_400_18e20;
