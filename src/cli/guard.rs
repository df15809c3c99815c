//! Values that are possible but odd: told on stderr with what was probably meant.
//!
//! Limits are wide of what is known of real bodies, so that a warning means a wrong unit rather than a rare asteroid.

use tiling::Solid;

use crate::evolve::rigid::sphere_limit;

/// Densities of rock, metal and rubble, kg/m^3.
const DENSITIES: std::ops::RangeInclusive<f64> = 500.0..=8000.0;
/// Radii of bodies on which sunlight has been seen to act, and far beyond, m.
const RADII: std::ops::RangeInclusive<f64> = 1.0..=1e6;
/// The slowest rotators known turn in some 2000 h.
const SLOWEST_H: f64 = 3000.0;
/// Bodies above this radius, m, do not turn faster than loose material bears; none is known to exceed that by this factor.
const RUBBLE_RADIUS_M: f64 = 300.0;
const FASTEST_OVER_LIMIT: f64 = 2.0;
/// Moment about z below the largest by this fraction: z is some other axis, not a round body's arbitrary one.
const LESS_MOMENT: f64 = 0.01;

/// Prints a warning, if there is one.
pub(super) fn warn(warning: Option<String>) {
    if let Some(warning) = warning {
        eprintln!("warning: {warning}");
    }
}

/// The size of a body, with what to ask.
pub(super) fn size(radius_m: f64, question: &str) -> Option<String> {
    (!RADII.contains(&radius_m))
        .then(|| format!("the sphere of equal volume has a radius of {radius_m:.3e} m; {question}"))
}

/// The density of a body.
pub(super) fn density(density_kg_m3: f64, name: &str) -> Option<String> {
    if DENSITIES.contains(&density_kg_m3) {
        return None;
    }
    let hint = if (0.5..=8.0).contains(&density_kg_m3) { ": is it in g/cm^3?" } else { "" };
    Some(format!("{name} is {density_kg_m3} kg/m^3, asteroids have 500 to 8000{hint}"))
}

/// The rotation period of a body of this size.
pub(super) fn period(period_h: f64, radius_m: f64, density_kg_m3: f64) -> Option<String> {
    if period_h > SLOWEST_H {
        return Some(format!("a period of {period_h} h is longer than that of any known asteroid: is it in seconds?"));
    }
    let limit_h = std::f64::consts::TAU / sphere_limit(density_kg_m3) / 3600.0;
    (radius_m > RUBBLE_RADIUS_M && period_h * FASTEST_OVER_LIMIT < limit_h).then(|| {
        format!(
            "a period of {period_h} h is far below the {limit_h:.2} h at which loose material floats off the equator of a body of \
             this density: is it in days?"
        )
    })
}

/// A spin axis, z, that is not the axis of largest moment.
pub(super) fn spin_axis(solid: &Solid) -> Option<String> {
    let axes = solid.principal_axes();
    let (about_z, largest) = (solid.inertia[(2, 2)], axes.moments[2]);
    let tilt_deg = axes.rotation[(2, 2)].clamp(-1.0, 1.0).acos().to_degrees();
    (about_z < (1.0 - LESS_MOMENT) * largest).then(|| {
        format!(
            "z is {tilt_deg:.1} deg off the axis of largest moment (moment about z {:.1} % smaller): no relaxed body spins so",
            100.0 * (1.0 - about_z / largest)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usual_bodies_pass_and_wrong_units_are_asked_about() {
        assert_eq!((size(245.0, ""), density(1190.0, ""), period(4.296, 245.0, 1190.0)), (None, None, None));
        assert_eq!(period(0.004, 10.0, 2000.0), None);
        assert!(size(0.245, "is --unit right?").is_some_and(|w| w.contains("2.450e-1 m; is --unit right?")));
        assert!(density(2.7, "--density-kg-m3").is_some_and(|w| w.contains("g/cm^3")));
        assert!(density(19_000.0, "--density-kg-m3").is_some_and(|w| !w.contains("g/cm^3")));
        assert!(period(21_600.0, 500.0, 2000.0).is_some_and(|w| w.contains("in seconds?")));
        assert!(period(0.25, 500.0, 2000.0).is_some_and(|w| w.contains("in days?")));
    }
}
