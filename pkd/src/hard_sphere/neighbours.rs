//! Which spheres can meet before the end of a step, and how far each may stray before that has to be asked again.
//!
//! Every sphere gets a *guide*, a point that starts at its centre and moves at a constant velocity, and a *leash*, how far
//! its centre may get from the guide. A pair whose guides do not come closer than the sum of radii and leashes cannot meet
//! while both spheres are on their leashes, however often they collide with others. Guides of most spheres turn with the
//! body as a whole, where two guides never approach: `|r0 + (Omega x r0) t| >= |r0|`. Spheres too fast for that, in a
//! collapse or far out, are guided along their own present course.

use super::ball::Ball;
use super::predict::LANES;
use nalgebra::{Matrix3, Vector3};

/// Longest leash, as a fraction of the sphere's radius; also how far a sphere may move against the body before it is
/// guided on its own course. Longer: more neighbours to look at in each prediction. Shorter: more lists.
const LONGEST_LEASH: f64 = 0.1;
/// Leash as a multiple of the way the sphere would go against the body until the end of the step: collisions make some
/// spheres faster than they start.
const LEASH_PER_WAY: f64 = 1.5;
/// Shortest leash as a multiple of the root mean square of that way, and of the radius when nothing moves.
const SHORTEST_LEASH: (f64, f64) = (1.0, 1e-6);

/// The guide and leash of a sphere: one cache line, read with its [`Ball`].
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
struct Leash {
    /// Guide at the start of the step, m.
    guide: [f64; 3],
    /// Square of the leash, m².
    length2: f64,
    /// Velocity of the guide, m/s.
    velocity: [f64; 3],
}

/// A sphere as the pair search sees it.
#[derive(Debug, Clone, Copy)]
struct Reach {
    /// Present centre, m.
    centre: [f64; 3],
    /// Two spheres further apart than the sum of these cannot meet, m.
    reach: f64,
    /// Part of the reach that is its own course, m; zero if the guide turns with the body.
    course: f64,
}

/// Neighbours of every sphere that it could meet.
#[derive(Debug, Default)]
pub(super) struct Neighbours {
    /// Row `i` is `rows[starts[i]..starts[i + 1]]`, a multiple of [`LANES`] long.
    starts: Vec<u32>,
    /// Neighbours; filled up with the index one past the last sphere.
    rows: Vec<u32>,
    leashes: Vec<Leash>,
    reaches: Vec<Reach>,
    /// Lower end and index of every sphere's extent along the axis of the search, ascending.
    order: Vec<(f64, u32)>,
    pairs: Vec<(u32, u32)>,
}

/// Rigid motion that takes the body along: a velocity field.
#[derive(Debug, Clone, Copy)]
pub(super) struct RigidMotion {
    centre: Vector3<f64>,
    velocity: Vector3<f64>,
    omega: Vector3<f64>,
}

impl RigidMotion {
    /// The motion of the bulk of the spheres at the start of the step. Any would do, a better one saves work: spheres far
    /// out are left out, because one of them would weigh more than the whole body.
    pub fn of(balls: &[Ball]) -> Self {
        let median = |values: &mut Vec<f64>| {
            let middle = values.len() / 2;
            *values.select_nth_unstable_by(middle, f64::total_cmp).1
        };
        let mut values = Vec::with_capacity(balls.len());
        let middle = Vector3::from_fn(|k, _| {
            values.clear();
            values.extend(balls.iter().map(|b| b.position[k]));
            median(&mut values)
        });
        values.clear();
        values.extend(balls.iter().map(|b| (b.origin() - middle).norm_squared()));
        // Half of a homogeneous ball lies within 0.79 of its radius, half of a 3:1 ellipsoid within a third of its length.
        let far = 10.0 * median(&mut values);
        let bulk = || balls.iter().filter(|b| (b.origin() - middle).norm_squared() <= far);
        let mass: f64 = bulk().map(|b| b.mass).sum();
        let centre = bulk().map(|b| b.origin() * b.mass).sum::<Vector3<f64>>() / mass;
        let velocity = bulk().map(|b| b.velocity() * b.mass).sum::<Vector3<f64>>() / mass;
        let mut spin = Vector3::zeros();
        let mut inertia = Matrix3::zeros();
        for b in bulk() {
            let d = b.origin() - centre;
            spin += d.cross(&(b.velocity() - velocity)) * b.mass;
            let own = 0.4 * b.radius * b.radius;
            inertia += (Matrix3::identity() * (own + d.norm_squared()) - d * d.transpose()) * b.mass;
        }
        let omega = inertia.try_inverse().map_or(Vector3::zeros(), |inverse| inverse * spin);
        Self { centre, velocity, omega }
    }

    /// Velocity at a point, m/s.
    fn at(&self, point: Vector3<f64>) -> Vector3<f64> {
        self.velocity + self.omega.cross(&(point - self.centre))
    }
}

impl Neighbours {
    /// The neighbours that sphere `i` could meet.
    #[inline]
    pub fn of(&self, i: usize) -> &[u32] {
        &self.rows[self.starts[i] as usize..self.starts[i + 1] as usize]
    }

    /// The pairs that could meet, each once.
    pub fn pairs(&self) -> &[(u32, u32)] {
        &self.pairs
    }

    /// When sphere `i`, flying straight on from `now`, leaves its leash if that is before `until`; times are s of the step.
    #[inline]
    pub fn leaves(&self, i: usize, ball: &Ball, now: f64, until: f64) -> Option<f64> {
        let leash = &self.leashes[i];
        let u = ball.velocity() - Vector3::from(leash.velocity);
        let offset = ball.origin() - Vector3::from(leash.guide);
        // It is on the leash now and flies straight: it stays if it is on the leash at the end.
        if (offset + u * until).norm_squared() <= leash.length2 {
            return None;
        }
        let d = offset + u * now;
        let (b, u2, c) = (d.dot(&u), u.norm_squared(), d.norm_squared() - leash.length2);
        let delay = if c < 0.0 { -c / (b + (b * b - u2 * c).sqrt()) } else { 0.0 };
        Some(now + delay)
    }

    /// Makes the lists anew at time `now` of a step that ends at `end` (s); `balls` ends with [`Ball::NOWHERE`].
    pub fn rebuild(&mut self, balls: &[Ball], motion: &RigidMotion, now: f64, end: f64) {
        let count = balls.len() - 1;
        self.set_leashes(&balls[..count], motion, now, end);
        self.find_pairs(end - now);
        self.fill_rows(count);
    }

    /// Makes lists for spheres that are moved by hand, by up to `leash` of their radius.
    pub fn rebuild_at_rest(&mut self, balls: &[Ball], leash: f64) {
        let count = balls.len() - 1;
        self.leashes.clear();
        self.reaches.clear();
        for ball in &balls[..count] {
            let length = leash * ball.radius;
            self.leashes.push(Leash { guide: ball.position, length2: length * length, velocity: [0.0; 3] });
            self.reaches.push(Reach { centre: ball.position, reach: ball.radius + length, course: 0.0 });
        }
        self.find_pairs(0.0);
        self.fill_rows(count);
    }

    /// Whether sphere `i`, moved by hand, is too far from where it was.
    pub fn is_off_leash(&self, i: usize, ball: &Ball) -> bool {
        let leash = &self.leashes[i];
        (ball.origin() - Vector3::from(leash.guide)).norm_squared() > leash.length2
    }

    fn set_leashes(&mut self, balls: &[Ball], motion: &RigidMotion, now: f64, end: f64) {
        let left = end - now;
        let against = |b: &Ball| (b.velocity() - motion.at(b.position_at(now))).norm() * left;
        let square: f64 = balls.iter().map(|b| against(b).powi(2)).sum();
        let usual = (square / balls.len() as f64).sqrt();
        self.leashes.clear();
        self.reaches.clear();
        for ball in balls {
            let centre = ball.position_at(now);
            let way = against(ball);
            let longest = LONGEST_LEASH * ball.radius;
            let own_course = way > longest;
            let shortest = (SHORTEST_LEASH.0 * usual).max(SHORTEST_LEASH.1 * ball.radius);
            let length = if own_course { longest } else { (LEASH_PER_WAY * way).max(shortest).min(longest) };
            let velocity = if own_course { ball.velocity() } else { motion.at(centre) };
            let guide = (centre - velocity * now).into();
            self.leashes.push(Leash { guide, length2: length * length, velocity: velocity.into() });
            let course = if own_course { way } else { 0.0 };
            // Round-off of the guide must not lose a pair: a margin of 1e-9 of the radius is far above it.
            let reach = ball.radius * (1.0 + 1e-9) + length + course;
            self.reaches.push(Reach { centre: centre.into(), reach, course });
        }
    }

    /// Sweeps along the axis on which the spheres spread most: needs no grid, so neither a sphere far away nor very
    /// different radii cost more than their share.
    fn find_pairs(&mut self, left: f64) {
        let extent = |k: usize| {
            let ends = self.reaches.iter().map(|r| r.centre[k]);
            ends.clone().fold(f64::NEG_INFINITY, f64::max) - ends.fold(f64::INFINITY, f64::min)
        };
        let axis = (1..3).fold(0, |best, k| if extent(k) > extent(best) { k } else { best });
        self.order.clear();
        self.order.extend(self.reaches.iter().zip(0..).map(|(r, i)| (r.centre[axis] - r.reach, i)));
        self.order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        self.pairs.clear();
        for (k, &(_, i)) in self.order.iter().enumerate() {
            let one = self.reaches[i as usize];
            let upper = one.centre[axis] + one.reach;
            for &(lower, j) in &self.order[k + 1..] {
                if lower > upper {
                    break;
                }
                let two = &self.reaches[j as usize];
                let r: [f64; 3] = std::array::from_fn(|k| two.centre[k] - one.centre[k]);
                let limit = one.reach + two.reach;
                if r[0] * r[0] + r[1] * r[1] + r[2] * r[2] > limit * limit {
                    continue;
                }
                let limit = limit - one.course - two.course;
                if one.course + two.course == 0.0 || self.guides_approach(i, j, r.into(), limit, left) {
                    self.pairs.push((i, j));
                }
            }
        }
    }

    /// Whether the guides of `i` and `j`, now `r` apart, come closer than `limit` in the time that is left.
    fn guides_approach(&self, i: u32, j: u32, r: Vector3<f64>, limit: f64, left: f64) -> bool {
        let velocity = |k: u32| Vector3::from(self.leashes[k as usize].velocity);
        let v = velocity(j) - velocity(i);
        let closest = (-r.dot(&v) / v.norm_squared()).max(0.0).min(left);
        (r + v * closest).norm_squared() <= limit * limit
    }

    fn fill_rows(&mut self, count: usize) {
        self.starts.clear();
        self.starts.resize(count + 1, 0);
        for &(i, j) in &self.pairs {
            self.starts[i as usize] += 1;
            self.starts[j as usize] += 1;
        }
        let mut next = 0;
        for start in &mut self.starts {
            let degree = std::mem::replace(start, next);
            next += degree.next_multiple_of(LANES as u32);
        }
        self.rows.clear();
        self.rows.resize(next as usize, count as u32);
        // Each start is moved to its row's end while the row is filled, and then put back.
        for &(i, j) in &self.pairs {
            for (from, to) in [(i, j), (j, i)] {
                let place = &mut self.starts[from as usize];
                self.rows[*place as usize] = to;
                *place += 1;
            }
        }
        let mut start = 0;
        for place in &mut self.starts {
            start = std::mem::replace(place, start).next_multiple_of(LANES as u32);
        }
    }
}
