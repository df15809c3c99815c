//! Effective potential of the spheres in the frame that turns with the body, and the order it puts them in.
//!
//! Φ_eff = Φ - ½ |Ω × r|² (Cotto-Figueroa et al. 2015, ApJ 803, 25, section 3.2). Sorted by it, a sphere's rank over
//! the number of spheres is the fraction of the mass that it encloses (their Fig. 11), for spheres of equal mass.

use nalgebra::Vector3;

use crate::gravity::DirectGravity;
use crate::mass_properties::mass_properties;
use crate::{PkdError, Spheres};

/// Effective potential at each sphere's centre, m²/s², for a body turning with `omega` (rad/s) about its centre of mass.
///
/// # Errors
/// Whatever [`Spheres::validate`] finds.
pub fn effective_potentials(spheres: &Spheres, omega: Vector3<f64>) -> Result<Vec<f64>, PkdError> {
    let centre = mass_properties(spheres)?.centre;
    let mut potential = Vec::new();
    DirectGravity::default().potentials(&spheres.x, &spheres.y, &spheres.z, &spheres.mass, &mut potential);
    for (i, phi) in potential.iter_mut().enumerate() {
        *phi -= 0.5 * omega.cross(&(Vector3::from(spheres.position(i)) - centre)).norm_squared();
    }
    Ok(potential)
}

/// Enclosed-mass fraction of each sphere: its rank (from 1) in rising potential over the number of spheres, in (0, 1].
///
/// Spheres of equal potential rank in index order.
pub fn enclosed_mass_fractions(potentials: &[f64]) -> Vec<f64> {
    let n = potentials.len();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &j| potentials[i].total_cmp(&potentials[j]));
    let mut fraction = vec![0.0; n];
    for (rank, i) in order.into_iter().enumerate() {
        fraction[i] = (rank + 1) as f64 / n as f64;
    }
    fraction
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constants::G;

    #[test]
    fn turning_pair_has_the_potential_of_its_partner_less_the_centrifugal_term() {
        let mut pair = Spheres::default();
        pair.push([-100.0, 0.0, 5.0], [0.0; 3], [0.0; 3], 1e9, 50.0);
        pair.push([100.0, 0.0, 5.0], [0.0; 3], [0.0; 3], 1e9, 50.0);
        let phi = effective_potentials(&pair, Vector3::new(0.0, 0.0, 1e-4)).unwrap();
        let expected = -G * 1e9 / 200.0 - 0.5 * (1e-4 * 100.0_f64).powi(2);
        assert!(phi.iter().all(|p| (p / expected - 1.0).abs() < 1e-15));
    }

    #[test]
    fn fractions_rise_with_the_potential_and_break_ties_by_index() {
        assert_eq!(enclosed_mass_fractions(&[-1.0, -3.0, -2.0, -2.0]), [1.0, 0.25, 0.5, 0.75]);
    }
}
