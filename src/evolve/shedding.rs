//! Which spheres have left the body at the end of a block.
//!
//! Spheres form clusters by contact; the heaviest is the body. Another cluster has left when its two-body energy
//! relative to the body is positive, when it is beyond two long semi-axes, or when it was already off the body at the
//! block's start, that is airborne for a whole block (section 3.3 and the appendix of Cotto-Figueroa et al. 2015; the
//! numbers are ours). What is lofted for a shorter time and lands is a movement, not a loss.
//!
//! A heavy piece that parts just above the spin at which its contact carries nothing any more stays in a bound orbit that
//! grazes the body once a rotation: two spheres 0.6 % beyond that spin get no farther than 0.05 radii apart. So heavy pieces are
//! looked at every half rotation and by a finer gap, and one that was off the body in half of the samples of a block has left.

use nalgebra::Vector3;
use pkd::Spheres;
use pkd::clusters::{CONTACT_GAP_OVER_RADIUS, Cluster, clusters, two_body_state};
use pkd::frame::recentre;
use pkd::mass_properties::mass_properties;

use super::EvolveError;
use super::block::Aggregate;

/// A cluster farther from the body than this many of its long semi-axes has left.
const FAR_SEMIAXES: f64 = 2.0;
/// A departing cluster with at least this share of the mass is the other half of a fission.
const FISSION_MASS_FRACTION: f64 = 0.1;
/// A heavy piece has no contact when it is off by more than this, radii: bounces of resting hard spheres stay ten times
/// below. Loose single spheres rattle that far in their cages, so for them the wider gap decides.
const PARTED_GAP_OVER_RADIUS: f64 = 0.01;
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
    /// What they take out of the body's angular momentum about its centre of mass, kg m^2/s.
    pub angular_momentum: Vector3<f64>,
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

/// Whether and how often a heavy piece was off the body, in samples of a stretch of dynamics.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Parting {
    samples: u32,
    off: u32,
    /// Rows of the piece when it was last off.
    piece: Vec<u32>,
}

impl Parting {
    /// Looks at the body once more.
    pub fn sample(&mut self, spheres: &Spheres) {
        self.samples += 1;
        if let Some(piece) = heavy_piece(spheres) {
            self.off += 1;
            self.piece = piece;
        }
    }

    /// Whether a heavy piece was seen off the body.
    pub fn was_off(&self) -> bool {
        self.off > 0
    }

    /// The piece that has left: off in at least half of the samples, of which there are two or more.
    fn left(&self) -> Option<&[u32]> {
        (self.samples >= 2 && 2 * self.off >= self.samples).then_some(&self.piece[..])
    }
}

/// Rows of the heaviest piece that touches the body nowhere, if it is heavy enough for a fission.
fn heavy_piece(spheres: &Spheres) -> Option<Vec<u32>> {
    let pieces = clusters(spheres, PARTED_GAP_OVER_RADIUS);
    let second = pieces.into_iter().nth(1)?;
    (second.mass >= FISSION_MASS_FRACTION * spheres.total_mass()).then_some(second.members)
}

/// The pieces of `spheres`, heaviest first, with a `piece` of its own even where it touches the rest.
fn pieces(spheres: &Spheres, piece: Option<&[u32]>) -> Vec<Cluster> {
    let mut found = clusters(spheres, CONTACT_GAP_OVER_RADIUS);
    let Some(piece) = piece else { return found };
    let mass_of = |members: &[u32]| members.iter().map(|i| spheres.mass[*i as usize]).sum();
    for cluster in &mut found {
        cluster.members.retain(|i| piece.binary_search(i).is_err());
        cluster.mass = mass_of(&cluster.members);
    }
    found.retain(|cluster| !cluster.members.is_empty());
    found.push(Cluster { members: piece.to_vec(), mass: mass_of(piece) });
    found.sort_by(|a, b| b.mass.total_cmp(&a.mass));
    found
}

/// Finds what leaves `aggregate`, which was `start` at the beginning of the block and looked as `parting` says within it.
///
/// # Errors
/// A sphere that is not finite.
pub fn departures(start: &Spheres, aggregate: &Aggregate, parting: &Parting) -> Result<Departures, EvolveError> {
    let spheres = &aggregate.spheres;
    let clusters = pieces(spheres, parting.left());
    let mut found = Departures {
        stays: vec![true; spheres.len()],
        spheres: Vec::new(),
        angular_momentum: Vector3::zeros(),
        breakup: None,
    };
    let [main, others @ ..] = clusters.as_slice() else { return Ok(found) };
    if others.is_empty() {
        return Ok(found);
    }
    let body = mass_properties(&spheres.filtered(&flags(spheres.len(), &main.members)))?;
    let total_mass = spheres.total_mass();
    let off_at_start = off_the_body(start);
    let mut leaving: Vec<(u32, &Cluster, f64)> = Vec::new();
    for (other, number) in others.iter().zip(1..) {
        let relative = two_body_state(spheres, &main.members, &other.members);
        let leaves = parting.left().is_some_and(|piece| piece == other.members || piece == main.members)
            || relative.energy > 0.0
            || relative.position.norm() > FAR_SEMIAXES * body.half_extents.x
            || other.members.iter().all(|i| off_at_start[*i as usize]);
        if leaves {
            other.members.iter().for_each(|i| found.stays[*i as usize] = false);
            leaving.push((number, other, relative.energy));
            if other.mass >= FISSION_MASS_FRACTION * total_mass {
                found.breakup = Some(Breakup::Fission);
            }
        }
    }
    // Places and velocities are those relative to all that stays, which is what goes on as the body.
    let rest = mass_properties(&spheres.filtered(&found.stays))?;
    for (cluster, other, energy_j) in leaving {
        for i in other.members.iter().map(|i| *i as usize) {
            found.spheres.push(Departure {
                sphere: aggregate.ids[i],
                position: (Vector3::from(spheres.position(i)) - rest.centre).into(),
                velocity: (Vector3::from(spheres.velocity(i)) - rest.velocity).into(),
                spin: spheres.spin(i),
                energy_j,
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
    found.angular_momentum = taken(&found.spheres, total_mass);
    Ok(found)
}

/// What `departures` take out of the angular momentum of a body of `total_mass` (kg) before they left: their own about the
/// centre of what stays, less what the recoil of that centre had of it (one sphere: m r x v (1 - m/M) and its spin).
fn taken(departures: &[Departure], total_mass: f64) -> Vector3<f64> {
    let (mut own, mut first_moment, mut momentum) = (Vector3::zeros(), Vector3::zeros(), Vector3::zeros());
    for d in departures {
        let (r, v, w) = (Vector3::from(d.position), Vector3::from(d.velocity), Vector3::from(d.spin));
        own += r.cross(&v) * d.mass + w * (0.4 * d.mass * d.radius * d.radius);
        first_moment += r * d.mass;
        momentum += v * d.mass;
    }
    own - first_moment.cross(&momentum) / total_mass
}

/// Whether all spheres hang together, heavy pieces by contact and light ones nearly so.
pub(super) fn on_one_body(spheres: &Spheres) -> bool {
    clusters(spheres, CONTACT_GAP_OVER_RADIUS).len() == 1 && heavy_piece(spheres).is_none()
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
        assert!(departures(&aggregate.spheres, &aggregate, &Parting::default()).unwrap().spheres.is_empty());
    }

    #[test]
    fn an_unbound_sphere_leaves_and_is_taken_out() {
        let start = block_with([40.0, 0.0, 0.0], [0.0; 3]).spheres;
        let mut aggregate = block_with([45.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
        let found = departures(&start, &aggregate, &Parting::default()).unwrap();
        assert_eq!(found.spheres.len(), 1);
        assert_eq!((found.spheres[0].sphere, found.breakup), (27, None));
        assert!(found.spheres[0].energy_j > 0.0);
        found.remove_from(&mut aggregate).unwrap();
        assert_eq!((aggregate.spheres.len(), aggregate.ids.len()), (27, 27));
    }

    /// Two spheres leave in different directions, spinning; a third hovers and stays.
    #[test]
    fn what_leaves_takes_its_angular_momentum_out_of_the_body_to_round_off() {
        let mut start = block_with([40.0, 0.0, 0.0], [0.0; 3]).spheres;
        start.push([0.0, 40.0, 0.0], [0.0; 3], [0.0; 3], 3e7, 12.0);
        start.push([0.0, -40.0, 0.0], [0.0; 3], [0.0; 3], 2e7, 10.0);
        let mut aggregate = block_with([46.0, 3.0, 0.0], [1.0, 0.4, -0.2]);
        aggregate.spheres.push([0.0, 50.0, 5.0], [0.0, 2.0, 0.7], [0.02, 0.0, 0.01], 3e7, 12.0);
        aggregate.spheres.push([-3.0, -44.0, 1.0], [0.01, 0.0, 0.0], [0.0; 3], 2e7, 10.0);
        aggregate.spheres.wz[27] = 0.03;
        aggregate.ids.extend([28, 29]);
        let before = mass_properties(&aggregate.spheres).unwrap().angular_momentum;
        let found = departures(&start, &aggregate, &Parting::default()).unwrap();
        assert_eq!(found.spheres.iter().map(|d| d.sphere).collect::<Vec<_>>(), [27, 28]);
        found.remove_from(&mut aggregate).unwrap();
        let after = mass_properties(&aggregate.spheres).unwrap().angular_momentum;
        assert!((before - found.angular_momentum - after).norm() < 1e-14 * before.norm());
    }

    #[test]
    fn a_bound_sphere_leaves_only_after_a_whole_block_in_the_air() {
        let landed = block_with([40.0, 0.0, 0.0], [0.0; 3]).spheres;
        let aggregate = block_with([45.0, 0.0, 0.0], [0.0; 3]);
        assert!(departures(&landed, &aggregate, &Parting::default()).unwrap().spheres.is_empty());
        assert_eq!(departures(&aggregate.spheres, &aggregate, &Parting::default()).unwrap().spheres.len(), 1);
    }

    #[test]
    fn a_heavy_piece_means_fission_and_a_light_rest_disruption() {
        let mut aggregate = block_with([45.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
        aggregate.spheres.mass[27] = 5e7;
        assert_eq!(
            departures(&aggregate.spheres, &aggregate, &Parting::default()).unwrap().breakup,
            Some(Breakup::Fission)
        );
        let mut spheres = Spheres::default();
        for k in 0..3 {
            spheres.push([1e4 * f64::from(k), 0.0, 0.0], [f64::from(k), 0.0, 0.0], [0.0; 3], 1e7, 10.0);
        }
        let scattered = Aggregate { spheres, ids: (0..3).collect(), contacts: ContactHistory::default() };
        assert_eq!(
            departures(&scattered.spheres, &scattered, &Parting::default()).unwrap().breakup,
            Some(Breakup::Disrupted)
        );
    }
}
