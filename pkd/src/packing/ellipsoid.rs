//! Random packing of equal spheres in an ellipsoid.

use nalgebra::Vector3;

use super::relax::{Outcome, push_apart};
use super::{Grain, MAX_COUNT, Seed, Uniform, in_range};
use crate::{PkdError, Spheres};

/// Share of the ellipsoid that the spheres fill unless asked otherwise.
///
/// Because spheres cannot fill the rim, 0.54 of the whole is 0.595 in the inner half. For grains of 2960 kg/m³ it is a
/// mass over hull volume of 1.63 g/cm³ at a thousand spheres.
pub const PACKING_FRACTION: f64 = 0.54;

/// By how much the packing fraction falls when the spheres do not fit.
const LOOSEN: f64 = 0.95;

/// A random packing to make.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EllipsoidPacking {
    /// Number of spheres, 1 to [`MAX_COUNT`].
    pub count: usize,
    /// What they are.
    pub grain: Grain,
    /// Middle over long axis of the ellipsoid, in (0, 1].
    pub b_over_a: f64,
    /// Short over long axis, in (0, `b_over_a`].
    pub c_over_a: f64,
    /// Share of the ellipsoid's volume that the spheres should fill, in (0, 0.64); less where they do not fit, as few
    /// spheres in a narrow ellipsoid may not. [`PACKING_FRACTION`] is a good value.
    pub packing_fraction: f64,
    /// Which random packing.
    pub seed: Seed,
}

impl EllipsoidPacking {
    fn validate(&self) -> Result<(), PkdError> {
        let (b, c, count, fraction) = (self.b_over_a, self.c_over_a, self.count, self.packing_fraction);
        self.grain.validate()?;
        in_range("count", count as f64, (1..=MAX_COUNT).contains(&count), "1 to 10 million")?;
        in_range("b_over_a", b, b > 0.0 && b <= 1.0, "above 0, at most 1")?;
        in_range("c_over_a", c, c > 0.0 && c <= b, "above 0, at most b_over_a")?;
        in_range("packing_fraction", fraction, fraction > 0.0 && fraction < 0.64, "between 0 and 0.64")
    }
}

/// Spheres at random places of an ellipsoid with its long axis along x and its short one along z.
///
/// Centres are drawn uniformly and pushed apart until no two spheres overlap, so the packing is as disordered and as
/// isotropic as one gets; it has gaps, and neither gravity nor spin has acted on it yet.
///
/// # Errors
/// [`PkdError::BadParameter`] for a value out of its range.
/// # Examples
/// ```
/// use pkd::packing::{EllipsoidPacking, Grain, PACKING_FRACTION, Seed, ellipsoid_packing};
///
/// let body = ellipsoid_packing(&EllipsoidPacking {
///     count: 100,
///     grain: Grain { radius: 50.2, density: 2960.0 },
///     b_over_a: 0.7,
///     c_over_a: 0.7,
///     packing_fraction: PACKING_FRACTION,
///     seed: Seed { seed: 7, stream: 0 },
/// })?;
/// assert_eq!(body.len(), 100);
/// # Ok::<(), pkd::PkdError>(())
/// ```
pub fn ellipsoid_packing(packing: &EllipsoidPacking) -> Result<Spheres, PkdError> {
    packing.validate()?;
    let mut fraction = packing.packing_fraction;
    // Each turn the ellipsoid grows, and one as wide as all spheres in a row has room for any of them.
    loop {
        let mut centres = Vec::new();
        if push_apart_in_ellipsoid(packing, fraction, &mut centres) == Outcome::Separated {
            return Ok(packing.grain.at(centres));
        }
        fraction *= LOOSEN;
    }
}

fn push_apart_in_ellipsoid(packing: &EllipsoidPacking, fraction: f64, centres: &mut Vec<Vector3<f64>>) -> Outcome {
    let long = (packing.count as f64 / (8.0 * fraction * packing.b_over_a * packing.c_over_a)).cbrt();
    // Room for the centres, in diameters; not quite nothing where a single layer of spheres is all that fits.
    let room = Vector3::new(1.0, packing.b_over_a, packing.c_over_a).map(|ratio| (long * ratio - 0.5).max(1e-6));
    let mut uniform = Uniform::new(packing.seed);
    centres.extend((0..packing.count).map(|_| uniform.in_ball().component_mul(&room)));
    push_apart(centres, |centre| {
        let level = centre.component_div(&room).norm_squared();
        if level > 1.0 { centre / level.sqrt() } else { centre }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass_properties::mass_properties;

    fn packing(count: usize, b_over_a: f64, c_over_a: f64) -> EllipsoidPacking {
        let grain = Grain { radius: 50.2, density: 2960.0 };
        let seed = Seed { seed: 7, stream: 0 };
        EllipsoidPacking { count, grain, b_over_a, c_over_a, packing_fraction: PACKING_FRACTION, seed }
    }

    fn closest_over_diameter(s: &Spheres) -> f64 {
        let mut closest = f64::INFINITY;
        for i in 0..s.len() {
            for j in 0..i {
                let d = Vector3::from(s.position(i)) - Vector3::from(s.position(j));
                closest = closest.min(d.norm() / (s.radius[i] + s.radius[j]));
            }
        }
        closest
    }

    #[test]
    fn spheres_do_not_overlap_and_extents_have_the_asked_ratios() {
        for (b, c) in [(0.7, 0.7), (0.51, 0.50), (0.97, 0.89), (0.92, 0.64)] {
            let body = ellipsoid_packing(&packing(1000, b, c)).unwrap();
            assert!((1.0..1.0 + 1e-11).contains(&closest_over_diameter(&body)));
            let p = mass_properties(&body).unwrap();
            let e = p.half_extents;
            assert!((e.y / e.x - b).abs() < 0.03 && (e.z / e.x - c).abs() < 0.03, "{e}");
            assert!((1550.0..1680.0).contains(&p.extents_density()), "{}", p.extents_density());
        }
    }

    #[test]
    fn few_spheres_and_needles_fit_after_loosening() {
        for count in [1, 2, 3, 5, 10, 40] {
            for (b, c) in [(1.0, 1.0), (0.3, 0.1)] {
                let body = ellipsoid_packing(&packing(count, b, c)).unwrap();
                assert!(count == 1 || closest_over_diameter(&body) >= 1.0, "{count} {b} {c}");
            }
        }
    }

    #[test]
    fn same_seed_gives_the_same_bytes_and_another_stream_another_body() {
        let asked = packing(60, 0.8, 0.7);
        let body = ellipsoid_packing(&asked).unwrap();
        assert_eq!(body, ellipsoid_packing(&asked).unwrap());
        let other = EllipsoidPacking { seed: Seed { seed: 7, stream: 1 }, ..asked };
        assert_ne!(body, ellipsoid_packing(&other).unwrap());
    }

    #[test]
    fn impossible_packings_are_refused_by_name() {
        let good = packing(10, 0.8, 0.7);
        let bad = [
            ("count", EllipsoidPacking { count: 0, ..good }),
            ("b_over_a", EllipsoidPacking { b_over_a: 1.2, ..good }),
            ("c_over_a", EllipsoidPacking { c_over_a: 0.9, ..good }),
            ("packing_fraction", EllipsoidPacking { packing_fraction: f64::NAN, ..good }),
            ("radius", EllipsoidPacking { grain: Grain { radius: -1.0, density: 2960.0 }, ..good }),
        ];
        for (expected, packing) in bad {
            assert!(
                matches!(ellipsoid_packing(&packing), Err(PkdError::BadParameter { name, .. }) if name == expected)
            );
        }
    }
}
