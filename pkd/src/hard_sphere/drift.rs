//! The drift of a step: straight lines between collisions, which are resolved one by one in the order of their times.
//!
//! Every sphere has one event: its earliest meeting with a neighbour as things stood when it was last predicted. A
//! collision changes two spheres, so only their events are predicted anew. Other spheres that waited for one of the two
//! notice when their time comes (the partner has had more collisions since) and predict again. No meeting is lost by that: one
//! with the changed sphere is among that sphere's own new predictions, all others are later than the event that was kept.
//!
//! Sources: Richardson et al. 2000 (Icarus 143, 45) for positions referred to the start of the step, the slide limit and
//! the limit on inelastic collapse.

use super::ball::Ball;
use super::impact::{Restitution, impact, surface_velocity};
use super::neighbours::{Neighbours, RigidMotion};
use super::parameters::{HardSphereParameters, SlideVelocity};
#[cfg(target_arch = "x86_64")]
use super::predict::Avx2;
use super::predict::{Meeting, NONE, Predict, Scalar, first_meeting_but};
use super::report::CollisionCounts;
use super::tournament::Tournament;
use crate::constants::G;
#[cfg(target_arch = "x86_64")]
use crate::simd::Level;
use crate::{PkdError, Spheres};
use nalgebra::Vector3;

/// In place of a partner: the sphere comes to the end of its leash, and the neighbours must be looked up again.
const LEASH_END: u32 = NONE - 1;

/// A run stops when a sphere has collided this many times as often in a step as the cap allows.
const RUNAWAY: u32 = 100;

/// What a sphere is waiting for and what it did last; half a cache line.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
struct Mark {
    /// Time of its last collision in this step, s; zero before the first.
    collided_at: f64,
    /// Whom it meets next.
    partner: u32,
    /// How many collisions that sphere had when the meeting was predicted: the event is stale when it had more since.
    partner_collisions: u32,
    /// Collisions in this step.
    collisions: u32,
    /// With whom it collided last in this step.
    last: u32,
}

impl Mark {
    const FRESH: Self = Self { collided_at: 0.0, partner: NONE, partner_collisions: 0, collisions: 0, last: NONE };
}

/// Memory of the event loop; holds nothing from one step to the next.
#[derive(Debug, Default)]
pub(super) struct Drift {
    /// The spheres and [`Ball::NOWHERE`].
    balls: Vec<Ball>,
    spins: Vec<Vector3<f64>>,
    marks: Vec<Mark>,
    events: Tournament,
    neighbours: Neighbours,
}

/// The event loop, compiled for one kind of predictor and spheres with or without spins.
type EventLoop = fn(&mut Drift, &HardSphereParameters, &RigidMotion, f64, &mut CollisionCounts) -> Result<(), usize>;

/// The fastest event loop of this processor; `smooth` spheres do not need their spins.
fn event_loop(smooth: bool) -> EventLoop {
    #[cfg(target_arch = "x86_64")]
    if Level::in_use() >= Level::Avx2 {
        /// The whole loop, so that everything in it becomes vectors of four.
        #[target_feature(enable = "avx2")]
        fn with_avx2<const SPIN: bool>(
            drift: &mut Drift,
            parameters: &HardSphereParameters,
            motion: &RigidMotion,
            step: f64,
            counts: &mut CollisionCounts,
        ) -> Result<(), usize> {
            drift.run::<Avx2, SPIN>(parameters, motion, step, counts)
        }
        // SAFETY: the processor has AVX2.
        return if smooth {
            |d, p, m, s, c| unsafe { with_avx2::<false>(d, p, m, s, c) }
        } else {
            |d, p, m, s, c| unsafe { with_avx2::<true>(d, p, m, s, c) }
        };
    }
    if smooth { Drift::run::<Scalar, false> } else { Drift::run::<Scalar, true> }
}

impl Drift {
    /// Moves the spheres on by `step` (s), whose start is at `time_s` of the run (for messages only).
    ///
    /// # Errors
    /// [`PkdError::Overlap`] if a pair overlaps too much at the start or end, [`PkdError::CollisionRunaway`].
    pub fn drift(
        &mut self,
        spheres: &mut Spheres,
        parameters: &HardSphereParameters,
        step: f64,
        time_s: f64,
    ) -> Result<(CollisionCounts, f64), PkdError> {
        self.load(spheres);
        let mut counts = CollisionCounts::default();
        let motion = RigidMotion::of(&self.balls[..spheres.len()]);
        self.look_around::<Scalar>(&motion, 0.0, step, &mut counts);
        let before = self.deepest_overlap(0.0, time_s)?;
        let smooth = parameters.restitution_tangential == 1.0 && parameters.slide_velocity == SlideVelocity::Centre;
        let run = event_loop(smooth);
        run(self, parameters, &motion, step, &mut counts).map_err(|sphere| PkdError::CollisionRunaway {
            sphere,
            collisions: self.marks[sphere].collisions,
            time_s: time_s + self.marks[sphere].collided_at,
        })?;
        counts.collisions = counts.nominal + counts.slide + counts.collapse + counts.capped;
        let after = self.deepest_overlap(step, time_s + step)?;
        self.store(spheres, step);
        Ok((counts, before.max(after)))
    }

    fn load(&mut self, spheres: &Spheres) {
        let count = spheres.len();
        self.balls.clear();
        self.balls.extend((0..count).map(|i| Ball::of(spheres, i)));
        self.balls.push(Ball::NOWHERE);
        self.spins.clear();
        self.spins.extend((0..count).map(|i| Vector3::from(spheres.spin(i))));
        self.marks.clear();
        self.marks.resize(count, Mark::FRESH);
    }

    fn store(&self, spheres: &mut Spheres, step: f64) {
        for i in 0..spheres.len() {
            let at = self.balls[i].position_at(step);
            (spheres.x[i], spheres.y[i], spheres.z[i]) = (at.x, at.y, at.z);
            let [vx, vy, vz, _] = self.balls[i].course;
            (spheres.vx[i], spheres.vy[i], spheres.vz[i]) = (vx, vy, vz);
            let w = self.spins[i];
            (spheres.wx[i], spheres.wy[i], spheres.wz[i]) = (w.x, w.y, w.z);
        }
    }

    /// The event loop. The error is the sphere that collides without end.
    #[inline(always)]
    fn run<P: Predict, const SPIN: bool>(
        &mut self,
        parameters: &HardSphereParameters,
        motion: &RigidMotion,
        step: f64,
        counts: &mut CollisionCounts,
    ) -> Result<(), usize> {
        loop {
            let (i, now) = self.events.first();
            // Not `now >= step`: a time that is not a number must end the loop as well.
            let before_the_end = now < step;
            if !before_the_end {
                return Ok(());
            }
            let mark = self.marks[i];
            if mark.partner == LEASH_END {
                self.look_around::<P>(motion, now, step, counts);
                continue;
            }
            let j = mark.partner as usize;
            if self.marks[j].collisions != mark.partner_collisions {
                counts.repredictions += 1;
                self.schedule::<P, 1>([i], now, step);
                continue;
            }
            self.collide::<P, SPIN>(i, j, now, parameters, counts);
            let most = self.marks[i].collisions.max(self.marks[j].collisions);
            if most > parameters.max_collisions_per_sphere.saturating_mul(RUNAWAY) {
                return Err(if self.marks[i].collisions == most { i } else { j });
            }
            self.schedule::<P, 2>([i, j], now, step);
        }
    }

    /// Resolves the meeting of `i` and `j` at time `now`.
    #[inline(always)]
    fn collide<P: Predict, const SPIN: bool>(
        &mut self,
        i: usize,
        j: usize,
        now: f64,
        parameters: &HardSphereParameters,
        counts: &mut CollisionCounts,
    ) {
        let [one, two] = [self.balls[i], self.balls[j]];
        let spins = if SPIN { [self.spins[i], self.spins[j]] } else { [Vector3::zeros(); 2] };
        let normal = (two.position_at(now) - one.position_at(now)).normalize();
        let change = match self.restitution::<SPIN>(i, j, now, normal, spins, parameters, counts) {
            Some(restitution) => impact::<SPIN>([&one, &two], spins, normal, restitution),
            // Most collisions are lossless, and then the spins have no part in it.
            None => impact::<false>([&one, &two], spins, normal, Restitution::ELASTIC),
        };
        match change {
            Some(change) => {
                // SAFETY: `event_loop` chose a predictor of this processor.
                unsafe {
                    P::deflect(&mut self.balls[i], change.velocity[0], now);
                    P::deflect(&mut self.balls[j], change.velocity[1], now);
                }
                if SPIN {
                    self.spins[i] += change.spin[0];
                    self.spins[j] += change.spin[1];
                }
            }
            None => counts.grazes += 1,
        }
        for (k, other) in [(i, j), (j, i)] {
            let mark = &mut self.marks[k];
            mark.collided_at = now;
            mark.collisions += 1;
            mark.last = other as u32;
        }
    }

    /// Chooses the restitution, none for a lossless collision: the limit on inelastic collapse goes before the slide limit,
    /// that before the nominal values.
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "one call, split off to be read alone")]
    fn restitution<const SPIN: bool>(
        &self,
        i: usize,
        j: usize,
        now: f64,
        normal: Vector3<f64>,
        spins: [Vector3<f64>; 2],
        parameters: &HardSphereParameters,
        counts: &mut CollisionCounts,
    ) -> Option<Restitution> {
        let [one, two] = [&self.balls[i], &self.balls[j]];
        let [mark_one, mark_two] = [&self.marks[i], &self.marks[j]];
        if mark_one.collisions.max(mark_two.collisions) >= parameters.max_collisions_per_sphere {
            counts.capped += 1;
            return None;
        }
        let v = two.velocity() - one.velocity();
        // Radial velocity as it was at the start of the step on the present lines, as in the published rule; squared, with
        // the denominators on the other side.
        let r = two.origin() - one.origin();
        let radial2 = r.dot(&v).powi(2);
        let limit2 = parameters.collapse_limit * parameters.collapse_limit * r.norm_squared();
        // A sphere that has not collided in this step counts from its start, so that contacts at rest lose nothing right after
        // a kick. Nothing faster than the pair's escape speed rests: without that clause an impact at the very start of a
        // step loses nothing either.
        let escape2 = 2.0 * G * (one.mass() + two.mass());
        let touch = one.radius() + two.radius();
        let slow = v.norm_squared() * touch <= escape2;
        let collapsed = |mark: &Mark, ball: &Ball| {
            (slow || mark.collisions > 0)
                && radial2 * (now - mark.collided_at).powi(2) < limit2 * (ball.radius() * ball.radius())
        };
        if collapsed(mark_one, one) | collapsed(mark_two, two) {
            counts.collapse += 1;
            return None;
        }
        let speed2 = match parameters.slide_velocity {
            SlideVelocity::Surface if SPIN => surface_velocity([one, two], spins, normal).norm_squared(),
            _ => v.norm_squared(),
        };
        if speed2 * touch < parameters.slide_limit * parameters.slide_limit * escape2 {
            counts.slide += 1;
            return None;
        }
        counts.nominal += 1;
        Some(Restitution { normal: parameters.restitution_normal, tangential: parameters.restitution_tangential })
    }

    /// Predicts the next events of one or two spheres from `now` on. Two are taken through each stage together, because each
    /// of them waits for the results of long divisions.
    #[inline(always)]
    fn schedule<P: Predict, const COUNT: usize>(&mut self, spheres: [usize; COUNT], now: f64, step: f64) {
        let mut meetings = [Meeting { delay: f64::INFINITY, partner: NONE }; COUNT];
        for k in 0..COUNT {
            let row = self.neighbours.of(spheres[k]);
            // SAFETY: the lists hold indices of balls, and `event_loop` chose a predictor of this processor.
            meetings[k] = unsafe { P::first_meeting(&self.balls, spheres[k], row, now) };
        }
        let mut times = [0.0; COUNT];
        for k in 0..COUNT {
            times[k] = self.expect_meeting(spheres[k], meetings[k], now, step);
        }
        for k in 0..COUNT {
            self.events.set(spheres[k], times[k]);
        }
    }

    /// Notes whom sphere `i` meets first, or that it comes to the end of its leash before, and returns when (s of the step).
    #[inline(always)]
    fn expect_meeting(&mut self, i: usize, meeting: Meeting, now: f64, step: f64) -> f64 {
        let Meeting { delay, mut partner } = meeting;
        let mut time = now + delay;
        let mut partner_collisions = 0;
        if let Some(mark) = self.marks.get(partner as usize) {
            partner_collisions = mark.collisions;
            // The pair that has just collided recedes. Should round-off see it otherwise, it would be resolved for ever.
            if mark.last == i as u32 && self.marks[i].last == partner {
                let other = first_meeting_but(partner, &self.balls, i, self.neighbours.of(i), now);
                (time, partner) = (now + other.delay, other.partner);
                partner_collisions = self.marks.get(partner as usize).map_or(0, |mark| mark.collisions);
            }
        }
        if !self.neighbours.keeps(i, &self.balls[i], time.min(step)) {
            (time, partner) = (self.neighbours.leash_end(i, &self.balls[i], now), LEASH_END);
        }
        let mark = &mut self.marks[i];
        mark.partner = partner;
        mark.partner_collisions = partner_collisions;
        time
    }

    /// Makes the neighbour lists at time `now` and predicts everything anew.
    #[inline(never)]
    fn look_around<P: Predict>(&mut self, motion: &RigidMotion, now: f64, step: f64, counts: &mut CollisionCounts) {
        counts.list_rebuilds += 1;
        self.neighbours.rebuild(&self.balls, motion, now, step);
        self.events.reset(self.marks.iter().map(|_| f64::INFINITY));
        for i in 0..self.marks.len() {
            self.schedule::<P, 1>([i], now, step);
        }
    }

    /// Deepest overlap at time `now` of the step as a fraction of the smaller radius.
    fn deepest_overlap(&self, now: f64, time_s: f64) -> Result<f64, PkdError> {
        let mut deepest = 0.0;
        for &(first, second) in self.neighbours.pairs() {
            let [one, two] = [first, second].map(|k| &self.balls[k as usize]);
            let r2 = (two.position_at(now) - one.position_at(now)).norm_squared();
            let touch = one.radius() + two.radius();
            if r2 < touch * touch {
                let fraction = (touch - r2.sqrt()) / one.radius().min(two.radius());
                if fraction > super::OVERLAP_LIMIT {
                    let (first, second) = (first.min(second) as usize, first.max(second) as usize);
                    return Err(PkdError::Overlap { first, second, fraction, time_s });
                }
                deepest = fraction.max(deepest);
            }
        }
        Ok(deepest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A lattice that falls in on itself, so that spheres meet in all directions and leave their leashes.
    fn imploding() -> Spheres {
        let mut s = Spheres::default();
        for k in 0..64_u32 {
            let at = |shift: u32| f64::from(k >> shift & 3) - 1.5;
            let r = [at(0) * 2.3 + 0.01 * f64::from(k % 7), at(2) * 2.2, at(4) * 2.1];
            s.push(r, [-0.2 * r[0], -0.15 * r[1] + 0.02, -0.1 * r[2]], [0.01, 0.0, -0.02], 1.0, 1.0);
        }
        s
    }

    #[test]
    #[cfg(target_arch = "x86_64")]
    fn vectors_and_scalars_take_a_crowd_through_the_same_collisions_to_the_last_bit() {
        let parameters = HardSphereParameters { slide_limit: 0.0, ..HardSphereParameters::default() };
        let finish = |run: EventLoop| {
            let mut drift = Drift::default();
            let mut counts = CollisionCounts::default();
            drift.load(&imploding());
            let motion = RigidMotion::of(&drift.balls[..64]);
            drift.look_around::<Scalar>(&motion, 0.0, 20.0, &mut counts);
            run(&mut drift, &parameters, &motion, 20.0, &mut counts).unwrap();
            (drift.balls, drift.spins, counts)
        };
        let (balls, spins, counts) = finish(event_loop(false));
        assert!(counts.nominal > 100 && counts.collapse > 100 && counts.list_rebuilds > 2, "{counts:?}");
        assert_eq!((balls, spins, counts), finish(Drift::run::<Scalar, true>));
    }
}
