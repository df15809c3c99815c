//! Connected pieces of an aggregate, and whether two of them are bound to each other.
//!
//! Two spheres belong together when the gap between their surfaces is below a fraction of the smaller radius; a piece
//! is a connected component of that graph. SI units.

use nalgebra::Vector3;

use crate::Spheres;
use crate::cells::visit_near_pairs;
use crate::constants::G;

/// Widest gap, in units of the smaller radius, across which two spheres still count as touching.
///
/// Bouncing in a resting hard-sphere pile keeps gaps well below this; a sphere in flight soon exceeds it.
pub const CONTACT_GAP_OVER_RADIUS: f64 = 0.05;

/// One connected piece.
#[derive(Debug, Clone, PartialEq)]
pub struct Cluster {
    /// Its spheres' indices, rising.
    pub members: Vec<u32>,
    /// Its mass, kg.
    pub mass: f64,
}

/// The connected pieces, heaviest first, equal ones in the order of their lowest index; gaps below
/// `gap_over_radius` times the smaller radius connect.
pub fn clusters(spheres: &Spheres, gap_over_radius: f64) -> Vec<Cluster> {
    let n = spheres.len();
    let mut parent: Vec<u32> = (0..n as u32).collect();
    visit_contacts(spheres, gap_over_radius, |i, j| {
        let (root_i, root_j) = (root(&mut parent, i as u32), root(&mut parent, j as u32));
        // The lowest index becomes the root, so that the result does not depend on the order of the pairs.
        parent[root_i.max(root_j) as usize] = root_i.min(root_j);
    });
    let mut found: Vec<Cluster> = Vec::new();
    let mut place = vec![usize::MAX; n];
    for i in 0..n as u32 {
        let lowest = root(&mut parent, i) as usize;
        if place[lowest] == usize::MAX {
            place[lowest] = found.len();
            found.push(Cluster { members: Vec::new(), mass: 0.0 });
        }
        let cluster = &mut found[place[lowest]];
        cluster.members.push(i);
        cluster.mass += spheres.mass[i as usize];
    }
    // Stable, and the list is in the order of the lowest index.
    found.sort_by(|a, b| b.mass.total_cmp(&a.mass));
    found
}

/// Number of pairs with a gap below `gap_over_radius` times the smaller radius.
pub fn contact_count(spheres: &Spheres, gap_over_radius: f64) -> usize {
    let mut count = 0;
    visit_contacts(spheres, gap_over_radius, |_, _| count += 1);
    count
}

fn visit_contacts(spheres: &Spheres, gap_over_radius: f64, mut visit: impl FnMut(usize, usize)) {
    let largest = spheres.radius.iter().copied().fold(0.0, f64::max);
    visit_near_pairs(spheres.coordinates(), (2.0 + gap_over_radius.max(0.0)) * largest, |i, j| {
        let distance = (Vector3::from(spheres.position(i)) - Vector3::from(spheres.position(j))).norm();
        let (a, b) = (spheres.radius[i], spheres.radius[j]);
        if distance - (a + b) < gap_over_radius * a.min(b) {
            visit(i, j);
        }
    });
}

/// The root of `i`, halving the path on the way.
fn root(parent: &mut [u32], mut i: u32) -> u32 {
    while parent[i as usize] != i {
        let grandparent = parent[parent[i as usize] as usize];
        parent[i as usize] = grandparent;
        i = grandparent;
    }
    i
}

/// State of one piece relative to another, both taken as points in their centres of mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoBodyState {
    /// Relative position, m.
    pub position: Vector3<f64>,
    /// Relative velocity, m/s.
    pub velocity: Vector3<f64>,
    /// Energy of the relative motion, J; negative when the two are bound.
    pub energy: f64,
}

/// The state of `piece` relative to `main`; both are lists of sphere indices, neither empty.
pub fn two_body_state(spheres: &Spheres, main: &[u32], piece: &[u32]) -> TwoBodyState {
    let (m1, r1, v1) = centre_of(spheres, main);
    let (m2, r2, v2) = centre_of(spheres, piece);
    let (position, velocity) = (r2 - r1, v2 - v1);
    let reduced = m1 * m2 / (m1 + m2);
    TwoBodyState { position, velocity, energy: 0.5 * reduced * velocity.norm_squared() - G * m1 * m2 / position.norm() }
}

/// Mass, centre of mass and its velocity.
fn centre_of(spheres: &Spheres, members: &[u32]) -> (f64, Vector3<f64>, Vector3<f64>) {
    let mut sums = (0.0, Vector3::zeros(), Vector3::zeros());
    for i in members.iter().map(|i| *i as usize) {
        let m = spheres.mass[i];
        sums.0 += m;
        sums.1 += Vector3::from(spheres.position(i)) * m;
        sums.2 += Vector3::from(spheres.velocity(i)) * m;
    }
    (sums.0, sums.1 / sums.0, sums.2 / sums.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(x: &[f64]) -> Spheres {
        let mut s = Spheres::default();
        x.iter().for_each(|x| s.push([*x, 0.0, 0.0], [0.0; 3], [0.0; 3], 1.0, 1.0));
        s
    }

    #[test]
    fn pieces_come_heaviest_first_then_by_lowest_index() {
        // 0 1 | 2 alone | 3 4 5 in mixed order, and one very far away.
        let s = row(&[0.0, 2.04, 10.0, 24.08, 20.0, 22.04, 1e15]);
        let found = clusters(&s, CONTACT_GAP_OVER_RADIUS);
        let members: Vec<&[u32]> = found.iter().map(|c| &c.members[..]).collect();
        assert_eq!(members, [&[3, 4, 5][..], &[0, 1], &[2], &[6]]);
        assert_eq!(found[0].mass, 3.0);
    }

    #[test]
    fn gap_at_the_limit_separates() {
        assert_eq!(clusters(&row(&[0.0, 2.0499]), 0.05).len(), 1);
        assert_eq!(clusters(&row(&[0.0, 2.0501]), 0.05).len(), 2);
        assert!(clusters(&Spheres::default(), 0.05).is_empty());
    }

    #[test]
    fn energy_changes_sign_at_the_escape_speed() {
        let mut s = Spheres::default();
        for (x, m) in [(-1.0, 1e12), (1.0, 1e12), (1000.0, 3e9)] {
            s.push([x, 0.0, 0.0], [0.0; 3], [0.0; 3], m, 1.0);
        }
        let escape = (2.0 * G * (2e12 + 3e9) / 1000.0).sqrt();
        for (factor, sign) in [(0.999, -1.0), (1.001, 1.0)] {
            s.vy[2] = escape * factor;
            let state = two_body_state(&s, &[0, 1], &[2]);
            assert_eq!(state.energy.signum(), sign);
            assert!((state.position.x - 1000.0).abs() < 1e-9);
        }
    }
}
