//! Thresholds that turn the paper's words for the types of evolution into numbers.
//!
//! Cotto-Figueroa et al. (2015), ApJ 803, 25, section 3.1, describes the types in words; all numbers are ours, chosen so
//! that they say what the words say of the paper's own Tables 2 and 3.

use crate::evolve::rigid::REV_PER_DAY;

/// Thresholds of the classification; the defaults are what `yorp classify` uses.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Criteria {
    /// A change of the spin rate over an interval smaller than this share of it has no sign \[1e-4\]: a fiftieth of the
    /// spin increment after which the shape is asked.
    pub no_spin_change: f64,
    /// A change of obliquity over an interval smaller than this has no sign, deg \[0.01\]: far less than a leg of 0.5 %
    /// in spin turns the axis, more than the integration's error.
    pub no_obliquity_change_deg: f64,
    /// Reversals that a stochastic evolution has at least \[2\]: one is chance.
    pub stochastic_reversals: usize,
    /// Intervals that it has at least \[5\].
    pub stochastic_intervals: usize,
    /// Intervals in a row that must alternate to be self-governed \[6\]: three round trips; by chance one series in 32 of
    /// six random signs does, but its shapes do not recur.
    pub self_governed_intervals: usize,
    /// Largest peak-to-peak range of the spin rate of a self-governed stretch, over its mean \[0.03\]: six legs of 0.5 %.
    pub self_governed_spin_range: f64,
    /// Largest peak-to-peak range of the obliquity of a stretch that is self-governed in obliquity, deg \[5\].
    pub self_governed_obliquity_range_deg: f64,
    /// Share of the spheres of every second shape that must be where they were, within the movement limit \[0.95\].
    pub recurrence: f64,
    /// Slower than this share of the run's median rate of change is stagnating \[0.05\].
    pub stagnating_rate: f64,
    /// For at least this long, Myr \[1\]: the lifetimes that the paper compares with are 10 Myr ...
    pub stagnating_myr: f64,
    /// ... and for at least this share of the run \[0.15\].
    pub stagnating_share: f64,
    /// A body that turns more slowly than this, rad/s, has ended its YORP cycle and does not stagnate
    /// \[0.1 revolutions a day\].
    pub slowest_spin: f64,
    /// An obliquity this close to where the rigid body ends, deg, has ended its YORP cycle and does not stagnate \[2\].
    pub end_state_deg: f64,
    /// An obliquity this close to 0 or 180 deg has nowhere to go, because the obliquity torque vanishes there, and does
    /// not stagnate, deg \[1\]: Table 3 calls its simulations 6 and 10, which end at 0 deg, stochastic only.
    pub pole_deg: f64,
    /// Share of the run over which its last tendency is judged \[0.2\].
    pub trend_share: f64,
    /// Over that share the spin is constant if it changes by less than this share of itself \[0.01\] ...
    pub constant_spin: f64,
    /// ... and the obliquity if it changes by less than this, deg \[1\].
    pub constant_obliquity_deg: f64,
}

impl Default for Criteria {
    fn default() -> Self {
        Self {
            no_spin_change: 1e-4,
            no_obliquity_change_deg: 0.01,
            stochastic_reversals: 2,
            stochastic_intervals: 5,
            self_governed_intervals: 6,
            self_governed_spin_range: 0.03,
            self_governed_obliquity_range_deg: 5.0,
            recurrence: 0.95,
            stagnating_rate: 0.05,
            stagnating_myr: 1.0,
            stagnating_share: 0.15,
            slowest_spin: 0.1 * REV_PER_DAY,
            end_state_deg: 2.0,
            pole_deg: 1.0,
            trend_share: 0.2,
            constant_spin: 0.01,
            constant_obliquity_deg: 1.0,
        }
    }
}
