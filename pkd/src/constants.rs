//! Physical constants of this crate.

/// Newton's constant, m^3 kg^-1 s^-2 (CODATA 2018).
pub const G: f64 = 6.674_30e-11;
