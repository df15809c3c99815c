//! Numbers and switches on the command line, refused where clap can say which flag they belong to.

use clap::ValueEnum;

/// A switch that is spelled out, so that scripts can set it either way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Switch {
    On,
    Off,
}

impl Switch {
    pub(super) fn is_on(self) -> bool {
        self == Self::On
    }
}

/// A number that `fits`, or what is allowed.
fn number(text: &str, fits: impl Fn(f64) -> bool, allowed: &str) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|_| format!("not a number; allowed: {allowed}"))?;
    if number.is_finite() && fits(number) { Ok(number) } else { Err(format!("allowed: {allowed}")) }
}

pub(super) fn positive(text: &str) -> Result<f64, String> {
    number(text, |x| x > 0.0, "a finite number above 0")
}

pub(super) fn semimajor_axis_au(text: &str) -> Result<f64, String> {
    number(text, |x| (0.01..=1000.0).contains(&x), "at least 0.01, at most 1000")
}

pub(super) fn eccentricity(text: &str) -> Result<f64, String> {
    number(text, |x| (0.0..1.0).contains(&x), "at least 0, below 1")
}

pub(super) fn fraction(text: &str) -> Result<f64, String> {
    number(text, |x| (0.0..=1.0).contains(&x), "at least 0, at most 1")
}

pub(super) fn single_scattering_albedo(text: &str) -> Result<f64, String> {
    number(text, |x| (0.0..1.0).contains(&x), "at least 0, below 1")
}

pub(super) fn roughness_deg(text: &str) -> Result<f64, String> {
    number(text, |x| (0.0..60.0).contains(&x), "at least 0, below 60")
}

pub(super) fn asymmetry(text: &str) -> Result<f64, String> {
    number(text, |x| x > -1.0 && x < 1.0, "above -1, below 1")
}

pub(super) fn emissivity(text: &str) -> Result<f64, String> {
    number(text, |x| x > 0.0 && x <= 1.0, "above 0, at most 1")
}

pub(super) fn thermal_inertia(text: &str) -> Result<f64, String> {
    number(text, |x| (0.0..=1e4).contains(&x), "at least 0, at most 10000")
}

pub(super) fn wall_thickness_m(text: &str) -> Result<f64, String> {
    number(text, |x| (1e-5..=100.0).contains(&x), "at least 0.00001, at most 100")
}

pub(super) fn wall_conductivity_w_m_k(text: &str) -> Result<f64, String> {
    number(text, |x| (1e-4..=100.0).contains(&x), "at least 0.0001, at most 100")
}

pub(super) fn wall_thermal_inertia(text: &str) -> Result<f64, String> {
    number(text, |x| (1.0..=1e4).contains(&x), "at least 1, at most 10000")
}

pub(super) fn period_h(text: &str) -> Result<f64, String> {
    number(text, |x| (0.002..=1e9).contains(&x), "at least 0.002, at most 1e9")
}

/// A whole number that `fits`, or what is allowed.
fn count(text: &str, fits: impl Fn(usize) -> bool, allowed: &str) -> Result<usize, String> {
    text.parse().ok().filter(|n| fits(*n)).ok_or_else(|| format!("allowed: {allowed}"))
}

pub(super) fn facet_samples(text: &str) -> Result<usize, String> {
    let fits = |n: usize| (1..=256).contains(&n) && n.isqrt().pow(2) == n;
    count(text, fits, "a square number, at least 1, at most 256")
}

pub(super) fn azimuth_bins(text: &str) -> Result<usize, String> {
    let fits = |n: usize| (16..=2880).contains(&n) && n.is_multiple_of(8);
    count(text, fits, "a multiple of 8, at least 16, at most 2880")
}

pub(super) fn declination_nodes(text: &str) -> Result<usize, String> {
    let fits = |n: usize| (5..=1441).contains(&n) && !n.is_multiple_of(2);
    count(text, fits, "an odd number, at least 5, at most 1441")
}

pub(super) fn rotation_cells(text: &str) -> Result<usize, String> {
    let fits = |n: usize| (16..=1024).contains(&n) && n.is_multiple_of(2);
    count(text, fits, "an even number, at least 16, at most 1024")
}

pub(super) fn obliquity_deg(text: &str) -> Result<f64, String> {
    number(text, |x| (0.0..=180.0).contains(&x), "at least 0, at most 180")
}

pub(super) fn obliquity_step_deg(text: &str) -> Result<f64, String> {
    let divides = |x: f64| (0.1..=180.0).contains(&x) && ((180.0 / x).round() * x - 180.0).abs() < 1e-9;
    number(text, divides, "at least 0.1, at most 180, and a divisor of 180")
}

pub(super) fn tolerance(text: &str) -> Result<f64, String> {
    number(text, |x| (1e-13..=1e-2).contains(&x), "at least 1e-13, at most 0.01")
}

pub(super) fn rk4_step_yr(text: &str) -> Result<f64, String> {
    number(text, |x| (1.0..=1e6).contains(&x), "at least 1, at most 1000000")
}

pub(super) fn facets(text: &str) -> Result<u32, String> {
    let fits = |n: usize| (4..=200_000).contains(&n) && n.is_multiple_of(2);
    count(text, fits, "an even number, at least 4, at most 200000").map(|n| n as u32)
}

pub(super) fn level(text: &str) -> Result<f64, String> {
    number(text, |x| (0.1..=10.0).contains(&x), "at least 0.1, at most 10")
}

pub(super) fn until_myr(text: &str) -> Result<f64, String> {
    number(text, |x| x >= 0.0, "a finite number, at least 0")
}

pub(super) fn field_tolerance(text: &str) -> Result<f64, String> {
    number(text, |x| (0.0..=0.1).contains(&x), "at least 0, at most 0.1")
}

pub(super) fn ias15_tolerance(text: &str) -> Result<f64, String> {
    number(text, |x| (1e-16..=1e-3).contains(&x), "at least 1e-16, at most 1e-3")
}

pub(super) fn multipole_error(text: &str) -> Result<f64, String> {
    number(text, |x| (1e-15..=0.1).contains(&x), "at least 1e-15, at most 0.1")
}

pub(super) fn radiation_pressure_coefficient(text: &str) -> Result<f64, String> {
    number(text, |x| (0.0..=3.0).contains(&x), "at least 0, at most 3")
}

pub(super) fn turn_deg(text: &str) -> Result<f64, String> {
    number(text, |x| (-360.0..=360.0).contains(&x), "at least -360, at most 360")
}
