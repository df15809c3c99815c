//! Random packing of equal spheres in an ellipsoid.

use nalgebra::Vector3;

use super::relax::{Outcome, push_apart};
use super::{Grain, MAX_COUNT, Seed, Uniform, in_range};
use crate::{PkdError, Spheres};

/// Share of the container that the spheres fill unless asked otherwise: loose enough to be made quickly, a little below
/// the 0.60 that is left inside it, away from its walls.
pub const PACKING_FRACTION: f64 = 0.55;

/// Width, in diameters, of the rind that is packed too and then peeled off.
const RIND: f64 = 1.0;

/// Axis ratios that can be packed: in a needle or a disc most of what is packed would be rind.
const RATIOS: std::ops::RangeInclusive<f64> = 0.05..=2.0;

/// By how much the packing fraction falls when the spheres do not fit.
const LOOSEN: f64 = 0.95;

/// A random packing to make.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EllipsoidPacking {
    /// Number of spheres, 1 to [`MAX_COUNT`].
    pub count: usize,
    /// What they are.
    pub grain: Grain,
    /// Extent along y over that along x, 0.05 to 2.
    pub b_over_a: f64,
    /// Extent along z over that along x, 0.05 to 2.
    pub c_over_a: f64,
    /// Share of the container's volume that the spheres should fill, in (0, 0.64); less where they do not fit, as few
    /// spheres in a narrow ellipsoid may not. [`PACKING_FRACTION`] is a good value.
    pub packing_fraction: f64,
    /// Which random packing.
    pub seed: Seed,
}

impl EllipsoidPacking {
    fn validate(&self) -> Result<(), PkdError> {
        let Self { count, b_over_a: b, c_over_a: c, packing_fraction: fraction, .. } = *self;
        self.grain.validate()?;
        in_range("count", count as f64, (1..=MAX_COUNT).contains(&count), "1 to 10 million")?;
        in_range("b_over_a", b, RATIOS.contains(&b), "0.05 to 2")?;
        in_range("c_over_a", c, RATIOS.contains(&c), "0.05 to 2")?;
        in_range("packing_fraction", fraction, fraction > 0.0 && fraction < 0.64, "between 0 and 0.64")
    }
}

/// Spheres at random places of an ellipsoid with its axes along x, y and z.
///
/// Centres are drawn uniformly in a larger ellipsoid and pushed apart until no two spheres overlap; those furthest
/// inside are kept. So the body is as disordered and as isotropic as one gets, with a rough surface that no wall has
/// smoothed. It has gaps, and neither gravity nor spin has acted on it yet.
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
    // Each turn the container grows, and one as wide as all spheres in a row has room for any of them.
    loop {
        if let Some(centres) = innermost(packing, fraction) {
            return Ok(packing.grain.at(centres));
        }
        fraction *= LOOSEN;
    }
}

/// The centres (in diameters) of the innermost spheres of a container filled to `fraction`; none if they do not fit.
fn innermost(packing: &EllipsoidPacking, fraction: f64) -> Option<Vec<Vector3<f64>>> {
    let ratios = Vector3::new(1.0, packing.b_over_a, packing.c_over_a);
    let body = ratios * (packing.count as f64 / (8.0 * fraction * ratios.product())).cbrt();
    let container = body.add_scalar(RIND);
    let filled = packing.count.max((8.0 * fraction * container.product()).round() as usize);

    let room = container.add_scalar(-0.5);
    let mut uniform = Uniform::new(packing.seed);
    let mut centres: Vec<Vector3<f64>> = (0..filled).map(|_| uniform.in_ball().component_mul(&room)).collect();
    let outcome = push_apart(&mut centres, |centre| {
        let level = centre.component_div(&room).norm_squared();
        if level > 1.0 { centre / level.sqrt() } else { centre }
    });
    if outcome == Outcome::Jammed {
        return None;
    }
    // Half a diameter inside the surface is where the centres of the outermost spheres lie. In a body thinner than a
    // sphere they all lie in its middle plane.
    let rank = body.map(|s| (s - 0.5).max(1e-3));
    let level = |centre: &Vector3<f64>| centre.component_div(&rank).norm_squared();
    let mut order: Vec<usize> = (0..filled).collect();
    order.sort_by(|&i, &j| level(&centres[i]).total_cmp(&level(&centres[j])));
    order.truncate(packing.count);
    // In the order in which they were drawn, so that neighbours in the list are not neighbours in space.
    order.sort_unstable();
    Some(order.into_iter().map(|i| centres[i]).collect())
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
            assert!((1.0..1.01).contains(&closest_over_diameter(&body)));
            let p = mass_properties(&body).unwrap();
            let e = p.half_extents;
            assert!((e.y / e.x - b).abs() < 0.03 && (e.z / e.x - c).abs() < 0.03, "{e}");
            assert!((1400.0..1600.0).contains(&p.extents_density()), "{}", p.extents_density());
        }
    }

    #[test]
    fn few_spheres_and_needles_fit_after_loosening() {
        for count in [1, 2, 3, 10, 30] {
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
            ("b_over_a", EllipsoidPacking { b_over_a: 2.1, ..good }),
            ("c_over_a", EllipsoidPacking { c_over_a: 1e-300, ..good }),
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
