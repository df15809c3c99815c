//! Pushes overlapping spheres apart, so that a start with overlaps can be integrated.
//!
//! The pair that overlaps most, as a fraction of its smaller radius, is moved apart along its line of centres until it
//! touches, each sphere by the other's share of the mass, and bounces if it approaches; then the next one. Momentum and
//! centre of mass stay, angular momentum and energy do not: the report says by how much the former changed.

use super::HardSphereParameters;
use super::ball::Ball;
use super::impact::{Restitution, impact};
use super::neighbours::Neighbours;
use super::tournament::Tournament;
use crate::{PkdError, Spheres};
use nalgebra::Vector3;

/// Overlaps below this fraction of the smaller radius are left alone: they are near round-off and disappear by themselves.
const MINIMUM: f64 = 1e-10;

/// Spheres may move by this fraction of their radius before the neighbours are looked up again.
const LEASH: f64 = 0.05;

/// Pushes per sphere after which the spheres are taken to be squeezed together too hard to be separated like this.
const MOST_PUSHES: usize = 20_000;

/// What [`repair_overlaps`] did.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct RepairReport {
    /// Pairs pushed apart, counted as often as it took.
    pub overlap_repairs: u64,
    /// Deepest overlap before, as a fraction of the smaller radius.
    pub max_overlap_over_radius: f64,
    /// Change of the angular momentum, kg m²/s.
    pub angular_momentum_change: [f64; 3],
}

/// Removes all overlaps deeper than 1e-10 of the smaller radius.
///
/// # Errors
/// Bad parameters or spheres; [`PkdError::Overlap`] if the spheres are still pressed into each other after 20 000 pushes a sphere.
pub fn repair_overlaps(spheres: &mut Spheres, parameters: &HardSphereParameters) -> Result<RepairReport, PkdError> {
    parameters.validate()?;
    spheres.validate()?;
    let mut work = Repair::new(spheres);
    let restitution =
        Restitution { normal: parameters.restitution_normal, tangential: parameters.restitution_tangential };
    let mut report = RepairReport::default();
    let mut momentum = Vector3::zeros();
    while let Some((i, j, fraction)) = work.worst() {
        report.max_overlap_over_radius = report.max_overlap_over_radius.max(fraction);
        if report.overlap_repairs >= (MOST_PUSHES * spheres.len()) as u64 {
            return Err(PkdError::Overlap { first: i.min(j), second: i.max(j), fraction, time_s: 0.0 });
        }
        report.overlap_repairs += 1;
        momentum += work.push(i, j, restitution);
    }
    report.angular_momentum_change = momentum.into();
    for (i, (ball, spin)) in work.balls.iter().zip(&work.spins).enumerate() {
        [spheres.x[i], spheres.y[i], spheres.z[i], _] = ball.place;
        [spheres.vx[i], spheres.vy[i], spheres.vz[i], _] = ball.course;
        [spheres.wx[i], spheres.wy[i], spheres.wz[i]] = (*spin).into();
    }
    Ok(report)
}

/// Spheres on their way to a state without overlaps.
struct Repair {
    /// The spheres and [`Ball::NOWHERE`].
    balls: Vec<Ball>,
    spins: Vec<Vector3<f64>>,
    neighbours: Neighbours,
    /// One over each sphere's deepest overlap, so that the deepest comes first; infinite when there is none.
    deepest: Tournament,
}

impl Repair {
    fn new(spheres: &Spheres) -> Self {
        let mut balls: Vec<Ball> = (0..spheres.len()).map(|i| Ball::of(spheres, i)).collect();
        balls.push(Ball::NOWHERE);
        let spins = (0..spheres.len()).map(|i| spheres.spin(i).into()).collect();
        let mut work = Self { balls, spins, neighbours: Neighbours::default(), deepest: Tournament::default() };
        work.look_around();
        work
    }

    fn look_around(&mut self) {
        self.neighbours.rebuild_at_rest(&self.balls, LEASH);
        let keys: Vec<f64> = (0..self.spins.len()).map(|i| self.overlap(i).0.recip()).collect();
        self.deepest.reset(keys.into_iter());
    }

    /// Deepest overlap of sphere `i` as a fraction, with its partner; zero when there is none to repair.
    fn overlap(&self, i: usize) -> (f64, usize) {
        let one = &self.balls[i];
        let mut deepest = (0.0_f64, i);
        for &j in self.neighbours.of(i).as_flattened() {
            let two = &self.balls[j as usize];
            let touch = one.radius() + two.radius();
            let r2 = (two.origin() - one.origin()).norm_squared();
            if r2 < touch * touch {
                let fraction = (touch - r2.sqrt()) / one.radius().min(two.radius());
                if fraction > deepest.0.max(MINIMUM) {
                    deepest = (fraction, j as usize);
                }
            }
        }
        deepest
    }

    /// The pair that overlaps most, with its fraction.
    fn worst(&self) -> Option<(usize, usize, f64)> {
        let (i, key) = self.deepest.first();
        let (fraction, j) = self.overlap(i);
        (key < f64::INFINITY).then_some((i, j, fraction))
    }

    /// Separates one pair; returns the change of angular momentum.
    fn push(&mut self, i: usize, j: usize, restitution: Restitution) -> Vector3<f64> {
        let [one, two] = [self.balls[i], self.balls[j]];
        let r = two.origin() - one.origin();
        // Two centres in one place have no line: any direction will do, but always the same.
        let normal = r.try_normalize(0.0).unwrap_or_else(Vector3::x);
        let gap = one.radius() + two.radius() - r.norm();
        let share = gap / (one.mass() + two.mass());
        self.balls[i].shift(normal * -(share * two.mass()));
        self.balls[j].shift(normal * (share * one.mass()));
        let moved = (two.velocity() - one.velocity()) * (share * one.mass() * two.mass());
        let spins = [self.spins[i], self.spins[j]];
        if let Some(change) = impact::<true>([&one, &two], spins, normal, restitution) {
            self.balls[i].deflect(change.velocity[0], 0.0);
            self.balls[j].deflect(change.velocity[1], 0.0);
            self.spins[i] += change.spin[0];
            self.spins[j] += change.spin[1];
        }
        if [i, j].into_iter().any(|k| !self.neighbours.keeps(k, &self.balls[k], 0.0)) {
            self.look_around();
        } else {
            self.compare_again(i);
            self.compare_again(j);
        }
        normal.cross(&moved)
    }

    /// Looks at sphere `i`, which has moved, and at its neighbours again.
    fn compare_again(&mut self, i: usize) {
        self.deepest.set(i, self.overlap(i).0.recip());
        for at in 0..self.neighbours.of(i).as_flattened().len() {
            let j = self.neighbours.of(i).as_flattened()[at] as usize;
            if j < self.spins.len() {
                self.deepest.set(j, self.overlap(j).0.recip());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass_properties::mass_properties;

    fn pair(gap: f64) -> Spheres {
        let mut pair = Spheres::default();
        pair.push([1.0, 2.0, 3.0], [0.3, -0.1, 0.2], [0.1, 0.2, 0.3], 2.0, 1.0);
        let d = Vector3::new(1.0, 2.0, -2.0) / 3.0 * (1.5 + gap);
        pair.push([1.0 + d.x, 2.0 + d.y, 3.0 + d.z], [-0.2, 0.1, 0.4], [0.0, -0.2, 0.1], 3.0, 0.5);
        pair
    }

    fn distance(s: &Spheres) -> f64 {
        (Vector3::from(s.position(1)) - Vector3::from(s.position(0))).norm()
    }

    #[test]
    fn a_pushed_pair_touches_and_keeps_its_centre_of_mass() {
        let mut s = pair(-0.01);
        let before = mass_properties(&s).unwrap();
        let report = repair_overlaps(&mut s, &HardSphereParameters::default()).unwrap();
        let after = mass_properties(&s).unwrap();
        assert_eq!(report.overlap_repairs, 1);
        assert!((report.max_overlap_over_radius - 0.02).abs() < 1e-14);
        assert!((distance(&s) - 1.5).abs() < 1e-14 * 1.5, "{}", distance(&s) - 1.5);
        assert!((after.centre - before.centre).norm() < 1e-15);
        assert!((after.velocity - before.velocity).norm() < 1e-15);
        let change = after.angular_momentum - before.angular_momentum;
        assert!((change - Vector3::from(report.angular_momentum_change)).norm() < 1e-14, "{change}");
    }

    #[test]
    fn overlaps_below_the_minimum_and_separate_pairs_are_left_alone() {
        for gap in [-1e-11, 0.0, 0.1] {
            let mut s = pair(gap);
            let before = s.clone();
            assert_eq!(repair_overlaps(&mut s, &HardSphereParameters::default()).unwrap().overlap_repairs, 0);
            assert_eq!(s, before);
        }
    }

    #[test]
    fn coincident_centres_are_separated() {
        let mut s = Spheres::default();
        s.push([0.0; 3], [0.0; 3], [0.0; 3], 1.0, 1.0);
        s.push([0.0; 3], [0.0; 3], [0.0; 3], 1.0, 1.0);
        repair_overlaps(&mut s, &HardSphereParameters::default()).unwrap();
        assert_eq!(distance(&s), 2.0);
    }

    /// Eight spheres in the corners of a cube that is 2 % too small: pushing one pair presses others.
    #[test]
    fn a_crowd_ends_without_overlaps() {
        let mut s = Spheres::default();
        for k in 0..8 {
            let at = |bit: u32| if k >> bit & 1 == 1 { 1.96 } else { 0.0 };
            s.push([at(0), at(1), at(2)], [0.0; 3], [0.0; 3], 1.0 + 0.1 * f64::from(k), 1.0);
        }
        repair_overlaps(&mut s, &HardSphereParameters::default()).unwrap();
        for i in 0..8 {
            for j in 0..i {
                let d = Vector3::from(s.position(i)) - Vector3::from(s.position(j));
                assert!(d.norm() > 2.0 - 1e-10);
            }
        }
    }
}
