//! How deep in the body spheres move.
//!
//! Source: Cotto-Figueroa et al. (2015), ApJ 803, 25, section 3.2 and Figure 11: spheres are ranked by their effective
//! potential before a movement; the rank over their number is the mass fraction enclosed with them.

use super::distribution::Distribution;
use crate::store::{LegRecord, MovementRecord};

/// Bins of the histogram over the enclosed mass fraction.
const BINS: usize = 20;
/// Enclosed mass fraction up to which a sphere is in the inner half.
const INNER: f64 = 0.5;
/// Enclosed mass fraction above which it is in the outer tenth.
const OUTER: f64 = 0.9;
/// Ranks are whole numbers over N; this is far less than one of them.
const SLACK: f64 = 1e-9;

/// The movements of a run.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Movements {
    /// Movements: changes of shape.
    pub count: usize,
    /// Spheres moved, summed over all movements.
    pub spheres_moved: usize,
    /// Spheres in a movement.
    pub spheres: Distribution,
    /// How far spheres moved, over their radius.
    pub displacement_radii: Distribution,
    /// Share of the moved spheres in the inner half of the mass; half if depth did not matter.
    pub inner_half: Option<f64>,
    /// Share of the moved spheres in the outer tenth of the mass; a tenth if depth did not matter.
    pub outer_tenth: Option<f64>,
    /// Moved spheres in equal bins of the enclosed mass fraction, centre to surface.
    pub by_enclosed_mass: Vec<usize>,
    /// Hand-offs that were taken back because more than the scene's limit moved.
    pub taken_back: usize,
    /// Hand-offs with movement in which the paper's literal rule flags another number of spheres than the robust one.
    pub rules_differ: usize,
}

impl Movements {
    /// Of each movement's spheres and all legs; `radius_m` of a sphere by its number.
    pub fn of(movements: &[Vec<MovementRecord>], radius_m: &[f64], legs: &[LegRecord]) -> Self {
        let moved = || movements.iter().flatten();
        let mut by_enclosed_mass = vec![0; BINS];
        for movement in moved() {
            let bin = ((movement.enclosed_mass_fraction - SLACK) * BINS as f64).max(0.0) as usize;
            by_enclosed_mass[bin.min(BINS - 1)] += 1;
        }
        let spheres_moved = moved().count();
        let share = |inside: &dyn Fn(f64) -> bool| {
            let count = moved().filter(|m| inside(m.enclosed_mass_fraction)).count();
            (spheres_moved > 0).then(|| count as f64 / spheres_moved as f64)
        };
        Self {
            count: movements.len(),
            spheres_moved,
            spheres: Distribution::of(movements.iter().map(|m| m.len() as f64)),
            displacement_radii: Distribution::of(moved().map(|m| m.displacement_m / radius_m[m.sphere as usize])),
            inner_half: share(&|depth| depth <= INNER + SLACK),
            outer_tenth: share(&|depth| depth > OUTER + SLACK),
            by_enclosed_mass,
            taken_back: legs.iter().filter(|leg| leg.result == "backtracked").count(),
            rules_differ: legs.iter().filter(|leg| leg.moved[1] != leg.moved[2]).count(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten spheres that all move once: half of them inside, one of them in the outer tenth.
    #[test]
    fn movement_everywhere_has_half_inside_and_a_tenth_outside() {
        let all = (1..=10).map(|rank| MovementRecord {
            sphere: rank - 1,
            displacement_m: 20.0,
            enclosed_mass_fraction: f64::from(rank) / 10.0,
        });
        let found = Movements::of(&[all.collect()], &[40.0; 10], &[]);
        assert_eq!((found.count, found.spheres_moved), (1, 10));
        assert_eq!((found.inner_half, found.outer_tenth), (Some(0.5), Some(0.1)));
        assert_eq!(found.displacement_radii.median, Some(0.5));
        let expected: Vec<usize> = (0..20).map(|bin| bin % 2).collect();
        assert_eq!(found.by_enclosed_mass, expected);
    }

    #[test]
    fn without_movements_there_are_no_shares() {
        let found = Movements::of(&[], &[], &[]);
        assert_eq!((found.count, found.inner_half, found.outer_tenth), (0, None, None));
    }
}
