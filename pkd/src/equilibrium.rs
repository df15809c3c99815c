//! A random ellipsoidal body, compacted by its own gravity while it turns, that ends with the axis ratios asked for.
//!
//! A loose packing collapses to the density of random close packing, and flows while it does: from axis ratios of 0.7
//! and 0.7 at a period of six hours it goes to about 0.8 and 0.7. Straining the compact body back does not help, it
//! flows again. So bodies are packed with other ratios, compacted and measured until one comes out as wanted
//! (Cotto-Figueroa et al. 2015, ApJ 803, 25, section 2.5, and Tanga et al. 2009, ApJ 706, L197, select theirs from
//! many collapses). It is then ready to settle.

use nalgebra::{Vector2, Vector3};

use crate::constants::G;
use crate::frame::{recentre, set_rigid_rotation};
use crate::hard_sphere::{HardSphere, HardSphereParameters};
use crate::mass_properties::{MassProperties, mass_properties};
use crate::packing::{EllipsoidPacking, ellipsoid_packing};
use crate::{PkdError, Spheres};

/// Length of a stretch of compaction in units of 1/sqrt(G ρ) of the grains: 18 000 s at 2960 kg/m³.
const STRETCH_DYNAMICAL_TIMES: f64 = 8.0;
/// Stretches of compaction; the collapse itself takes the first.
const STRETCHES: u32 = 3;
/// Compaction is done with at least this limit on inelastic collapse. A hundred times the usual one, it keeps the spheres
/// shaking: the body comes to rest in a tenth of the rotations, creeps less afterwards, and a stretch costs half.
const SHAKING_COLLAPSE_LIMIT: f64 = 1e-3;
/// Bodies made at most; each costs about as much as a rotation or two of settling.
const MAX_ATTEMPTS: u32 = 8;
/// Both ratios this close to what was asked for will do: chance moves them by about as much.
const TOLERANCE: f64 = 0.012;
/// How much of a change of the packing's ratios is left in the compact body, measured at some hours of period.
const RESPONSE: f64 = 0.6;
/// Bodies over which the effect of compaction on the ratios is averaged: it depends on the ratios, and on chance.
const MEMORY: f64 = 3.0;
/// Ratios to pack with: a body that ends nearly round starts longer along its spin than across.
const RATIOS: std::ops::RangeInclusive<f64> = 0.05..=1.5;

/// A compact body.
#[derive(Debug, Clone, PartialEq)]
pub struct Compact {
    /// The spheres in rigid rotation about z, centre of mass at rest in the origin.
    pub spheres: Spheres,
    /// Its middle over its long axis: the mean of what the moments of inertia and what the extents say.
    pub b_over_a: f64,
    /// Its axis along the spin over its long axis, likewise.
    pub c_over_a: f64,
    /// Bodies made to get it.
    pub attempts: u32,
}

/// Packs `asked` spheres and compacts them at the spin rate `omega` (rad/s, about z) until the axis ratios are those of
/// `asked` within 0.012; the closest body of eight if they never are.
///
/// The ratios are measured halfway between those of the equivalent ellipsoid and of the extents, which differ by some
/// hundredths, so that neither is far off. `proceed` is asked before each stretch of compaction, with the number of
/// those done, whether to go on.
///
/// # Errors
/// [`PkdError::BadParameter`] for a value out of range, [`PkdError::Stopped`] when `proceed` says no, and what the
/// integration reports.
pub fn compact_ellipsoid(
    asked: &EllipsoidPacking,
    omega: f64,
    contact: &HardSphereParameters,
    mut proceed: impl FnMut(u32) -> bool,
) -> Result<Compact, PkdError> {
    let wanted = Vector2::new(asked.b_over_a, asked.c_over_a);
    let collapse_limit = contact.collapse_limit.max(SHAKING_COLLAPSE_LIMIT);
    let gravity = Some(contact.gravity.unwrap_or_default());
    let mut engine = HardSphere::new(HardSphereParameters { collapse_limit, gravity, ..contact.clone() });
    let duration = STRETCH_DYNAMICAL_TIMES / (G * asked.grain.density).sqrt();

    let mut packed = wanted;
    let mut effect = Vector2::zeros();
    let mut best: Option<(f64, Compact)> = None;
    for attempt in 0..MAX_ATTEMPTS {
        let mut spheres = ellipsoid_packing(&EllipsoidPacking { b_over_a: packed.x, c_over_a: packed.y, ..*asked })?;
        for stretch in 0..STRETCHES {
            if !proceed(attempt * STRETCHES + stretch) {
                return Err(PkdError::Stopped);
            }
            // Anew each time, because contraction speeds the body up.
            set_rigid_rotation(&mut spheres, Vector3::z() * omega)?;
            engine.evolve(&mut spheres, duration)?;
        }
        recentre(&mut spheres)?;
        set_rigid_rotation(&mut spheres, Vector3::z() * omega)?;
        let ratios = ratios_about_spin(&mass_properties(&spheres)?);
        let miss = (ratios - wanted).amax();
        if best.as_ref().is_none_or(|(least, _)| miss < *least) {
            let compact = Compact { spheres, b_over_a: ratios.x, c_over_a: ratios.y, attempts: attempt + 1 };
            best = Some((miss, compact));
        }
        if miss < TOLERANCE {
            break;
        }
        effect += (ratios - packed * RESPONSE - effect) / f64::from(attempt + 1).min(MEMORY);
        packed = ((wanted - effect) / RESPONSE).map(|ratio| ratio.clamp(*RATIOS.start(), *RATIOS.end()));
    }
    Ok(best.expect("the first attempt is the best so far").1)
}

/// Middle and spin axis over the long axis, where the spin axis is the principal axis closest to z.
fn ratios_about_spin(p: &MassProperties) -> Vector2<f64> {
    let [long, middle, spin] = match p.axes.row(2).transpose().iamax() {
        0 => [1, 2, 0],
        1 => [0, 2, 1],
        _ => [0, 1, 2],
    };
    let (moments, extents) = (p.deeve_axes(), p.half_extents);
    let ratio = |k: usize| 0.5 * (moments[k] / moments[long] + extents[k] / extents[long]);
    Vector2::new(ratio(middle), ratio(spin))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::packing::{Grain, PACKING_FRACTION, Seed};

    fn asked(b_over_a: f64, c_over_a: f64) -> EllipsoidPacking {
        EllipsoidPacking {
            count: 60,
            grain: Grain { radius: 50.2, density: 2960.0 },
            b_over_a,
            c_over_a,
            packing_fraction: PACKING_FRACTION,
            seed: Seed { seed: 3, stream: 0 },
        }
    }

    /// Spin rate at a period of six hours, rad/s.
    const OMEGA: f64 = std::f64::consts::TAU / 21_600.0;

    #[test]
    fn compact_body_has_the_axis_ratios_asked_for_and_turns_rigidly() {
        let contact = HardSphereParameters::default();
        let body = compact_ellipsoid(&asked(0.8, 0.7), OMEGA, &contact, |_| true).unwrap();
        assert!((body.b_over_a - 0.8).abs() < 0.03 && (body.c_over_a - 0.7).abs() < 0.03, "{body:?}");
        let p = mass_properties(&body.spheres).unwrap();
        assert!((p.angular_velocity() - Vector3::z() * OMEGA).norm() < 1e-12 * OMEGA);
        assert!(p.deeve_density() > 1750.0, "{}", p.deeve_density());
    }

    #[test]
    fn caller_can_stop_the_search() {
        let stopped = compact_ellipsoid(&asked(0.8, 0.7), OMEGA, &HardSphereParameters::default(), |done| done < 2);
        assert_eq!(stopped, Err(PkdError::Stopped));
    }
}
