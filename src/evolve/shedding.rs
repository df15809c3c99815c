//! Which spheres have left the body at the end of a block.
//!
//! Spheres form clusters by contact; the heaviest is the body. Another cluster has left when its two-body energy
//! relative to the body is positive, when it is beyond two long semi-axes, or when it was already off the body at the
//! block's start, that is airborne for a whole block (section 3.3 and the appendix of Cotto-Figueroa et al. 2015; the
//! numbers are ours). What is lofted for a shorter time and lands is a movement, not a loss.

use nalgebra::Vector3;
use pkd::Spheres;
use pkd::clusters::{CONTACT_GAP_OVER_RADIUS, clusters, two_body_state};
use pkd::frame::recentre;
use pkd::mass_properties::mass_properties;

use super::EvolveError;
use super::block::Aggregate;

/// A cluster farther from the body than this many of its long semi-axes has left.
const FAR_SEMIAXES: f64 = 2.0;
/// A departing cluster with at least this share of the mass is the other half of a fission.
const FISSION_MASS_FRACTION: f64 = 0.1;
/// A body with less than this share of the mass is what is left of a disruption.
const DISRUPTED_MASS_FRACTION: f64 = 0.5;

/// One sphere that leaves; position and velocity relative to the body's centre of mass, inertial axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Departure {
    /// Row in the run's list of spheres.
    pub sphere: u32,
    /// Position, m.
    pub position: [f64; 3],
    /// Velocity, m/s.
    pub velocity: [f64; 3],
    /// Spin, rad/s.
    pub spin: [f64; 3],
    /// Two-body energy of its cluster relative to the body, J.
    pub energy_j: f64,
    /// Mass, kg.
    pub mass: f64,
    /// Radius, m.
    pub radius: f64,
    /// The cluster it leaves with, heaviest first, from 1.
    pub cluster: u32,
}

/// How a body broke up for good.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Breakup {
    /// A cluster of at least a tenth of the mass left.
    Fission,
    /// The body holds less than half of the mass.
    Disrupted,
}

/// What leaves at the end of a block.
#[derive(Debug, Clone, PartialEq)]
pub struct Departures {
    stays: Vec<bool>,
    /// The spheres that leave, in index order.
    pub spheres: Vec<Departure>,
    /// Set if what leaves is so heavy that the run ends.
    pub breakup: Option<Breakup>,
}

impl Departures {
    /// For each sphere of the block whether it stays.
    pub fn stays(&self) -> &[bool] {
        &self.stays
    }

    /// Takes the departed spheres out of `aggregate` and puts the rest to its centre of mass.
    ///
    /// # Errors
    /// None in practice: the body is never empty.
    pub fn remove_from(&self, aggregate: &mut Aggregate) -> Result<(), EvolveError> {
        if self.spheres.is_empty() {
            return Ok(());
        }
        aggregate.spheres = aggregate.spheres.filtered(&self.stays);
        aggregate.contacts = aggregate.contacts.filtered(&self.stays);
        let mut stays = self.stays.iter();
        aggregate.ids.retain(|_| stays.next().copied().unwrap_or(false));
        recentre(&mut aggregate.spheres)?;
        Ok(())
    }
}

/// Finds what leaves `aggregate`, which was `start` at the beginning of the block.
///
/// # Errors
/// A sphere that is not finite.
pub fn departures(start: &Spheres, aggregate: &Aggregate) -> Result<Departures, EvolveError> {
    let spheres = &aggregate.spheres;
    let clusters = clusters(spheres, CONTACT_GAP_OVER_RADIUS);
    let mut found = Departures { stays: vec![true; spheres.len()], spheres: Vec::new(), breakup: None };
    let [main, others @ ..] = clusters.as_slice() else { return Ok(found) };
    if others.is_empty() {
        return Ok(found);
    }
    let body = mass_properties(&spheres.filtered(&flags(spheres.len(), &main.members)))?;
    let total_mass = spheres.total_mass();
    let off_at_start = off_the_body(start);
    for (other, cluster) in others.iter().zip(1..) {
        let relative = two_body_state(spheres, &main.members, &other.members);
        let leaves = relative.energy > 0.0
            || relative.position.norm() > FAR_SEMIAXES * body.half_extents.x
            || other.members.iter().all(|i| off_at_start[*i as usize]);
        if !leaves {
            continue;
        }
        if other.mass >= FISSION_MASS_FRACTION * total_mass {
            found.breakup = Some(Breakup::Fission);
        }
        for i in other.members.iter().map(|i| *i as usize) {
            found.stays[i] = false;
            found.spheres.push(Departure {
                sphere: aggregate.ids[i],
                position: (Vector3::from(spheres.position(i)) - body.centre).into(),
                velocity: (Vector3::from(spheres.velocity(i)) - body.velocity).into(),
                spin: spheres.spin(i),
                energy_j: relative.energy,
                mass: spheres.mass[i],
                radius: spheres.radius[i],
                cluster,
            });
        }
    }
    if body.mass < DISRUPTED_MASS_FRACTION * total_mass {
        found.breakup = Some(Breakup::Disrupted);
    }
    found.spheres.sort_by_key(|d| d.sphere);
    Ok(found)
}

/// Whether all spheres hang together.
pub(super) fn on_one_body(spheres: &Spheres) -> bool {
    clusters(spheres, CONTACT_GAP_OVER_RADIUS).len() == 1
}

/// For each sphere whether it is outside the heaviest cluster.
fn off_the_body(spheres: &Spheres) -> Vec<bool> {
    let clusters = clusters(spheres, CONTACT_GAP_OVER_RADIUS);
    let on = clusters.first().map_or(Vec::new(), |main| flags(spheres.len(), &main.members));
    on.iter().map(|on| !on).collect()
}

fn flags(n: usize, members: &[u32]) -> Vec<bool> {
    let mut flags = vec![false; n];
    for i in members {
        flags[*i as usize] = true;
    }
    flags
}

#[cfg(test)]
mod tests {
    use super::*;
    use pkd::soft_sphere::ContactHistory;

    /// A 3 x 3 x 3 block of touching unit-density spheres of radius 10 m, and one more sphere.
    fn block_with(position: [f64; 3], velocity: [f64; 3]) -> Aggregate {
        let mut spheres = Spheres::default();
        for k in 0..27 {
            let at = |n: i32| 20.0 * f64::from(n - 1);
            spheres.push([at(k % 3), at(k / 3 % 3), at(k / 9)], [0.0; 3], [0.0; 3], 1e7, 10.0);
        }
        spheres.push(position, velocity, [0.0; 3], 1e7, 10.0);
        Aggregate { spheres, ids: (0..28).collect(), contacts: ContactHistory::default() }
    }

    #[test]
    fn a_sphere_that_touches_stays() {
        let aggregate = block_with([40.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
        assert!(departures(&aggregate.spheres, &aggregate).unwrap().spheres.is_empty());
    }

    #[test]
    fn an_unbound_sphere_leaves_and_is_taken_out() {
        let start = block_with([40.0, 0.0, 0.0], [0.0; 3]).spheres;
        let mut aggregate = block_with([45.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
        let found = departures(&start, &aggregate).unwrap();
        assert_eq!(found.spheres.len(), 1);
        assert_eq!((found.spheres[0].sphere, found.breakup), (27, None));
        assert!(found.spheres[0].energy_j > 0.0);
        found.remove_from(&mut aggregate).unwrap();
        assert_eq!((aggregate.spheres.len(), aggregate.ids.len()), (27, 27));
    }

    #[test]
    fn a_bound_sphere_leaves_only_after_a_whole_block_in_the_air() {
        let landed = block_with([40.0, 0.0, 0.0], [0.0; 3]).spheres;
        let aggregate = block_with([45.0, 0.0, 0.0], [0.0; 3]);
        assert!(departures(&landed, &aggregate).unwrap().spheres.is_empty());
        assert_eq!(departures(&aggregate.spheres, &aggregate).unwrap().spheres.len(), 1);
    }

    #[test]
    fn a_heavy_piece_means_fission_and_a_light_rest_disruption() {
        let mut aggregate = block_with([45.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
        aggregate.spheres.mass[27] = 5e7;
        assert_eq!(departures(&aggregate.spheres, &aggregate).unwrap().breakup, Some(Breakup::Fission));
        let mut spheres = Spheres::default();
        for k in 0..3 {
            spheres.push([1e4 * f64::from(k), 0.0, 0.0], [f64::from(k), 0.0, 0.0], [0.0; 3], 1e7, 10.0);
        }
        let scattered = Aggregate { spheres, ids: (0..3).collect(), contacts: ContactHistory::default() };
        assert_eq!(departures(&scattered.spheres, &scattered).unwrap().breakup, Some(Breakup::Disrupted));
    }
}
