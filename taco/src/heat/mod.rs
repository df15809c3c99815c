//! Heat that the ground stores from day to night: conduction, and what it does to torque and force.
//!
//! The torque depends on the Sun through its declination and, with heat, its flux. Averaged over the direction of the
//! perihelion, which precesses fast against the spin state, true longitudes are uniform at every distance; then what the
//! delayed emission adds across the Sun's direction averages out of the obliquity torque, and `T_omega` stays even, `T_epsilon`
//! odd about 90 deg as without heat. Only heat stored over seasons, which is neglected, breaks that symmetry.

pub(crate) mod balance;
pub(crate) mod conduction;
pub(crate) mod delayed;
pub(crate) mod emission;
pub(crate) mod filter;
pub(crate) mod flux;
pub(crate) mod insolation;
mod rates;
mod seasonal;
pub(crate) mod spin_rates;
mod wall;

pub(crate) use rates::Heat;
pub use seasonal::{SeasonalHeat, seasonal_heat};

/// First of the four nearest of `nodes` latitudes, even from pole to pole, and their weights in the cubic through them.
fn cubic_weights(latitude: f64, nodes: usize) -> (usize, [f64; 4]) {
    let x = (latitude / std::f64::consts::PI + 0.5) * (nodes - 1) as f64;
    let first = (x.max(0.0) as usize).saturating_sub(1).min(nodes - 4);
    let t = x - first as f64;
    let weights = [
        -(t - 1.0) * (t - 2.0) * (t - 3.0) / 6.0,
        t * (t - 2.0) * (t - 3.0) / 2.0,
        -t * (t - 1.0) * (t - 3.0) / 2.0,
        t * (t - 1.0) * (t - 2.0) / 6.0,
    ];
    (first, weights)
}
