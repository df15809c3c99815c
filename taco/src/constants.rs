//! Physical constants of sunlight, SI.

/// Astronomical unit, m (IAU 2012 resolution B2).
pub const ASTRONOMICAL_UNIT_M: f64 = 1.495978707e11;

/// Speed of light, m/s (exact).
pub const SPEED_OF_LIGHT_M_S: f64 = 299_792_458.0;

/// Solar constant at 1 au, W/m^2 (IAU 2015 resolution B3, nominal total irradiance).
pub const SOLAR_CONSTANT_W_M2: f64 = 1361.0;
