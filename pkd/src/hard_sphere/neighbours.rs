//! Which spheres can meet before the end of a step, and how far each may stray before that has to be asked again.
//!
//! Every sphere gets a *guide*, a point that starts at its centre and moves at a constant velocity, and a *leash*, how far
//! its centre may get from the guide. A pair whose guides do not come closer than the sum of radii and leashes cannot meet
//! while both spheres are on their leashes, however often they collide with others. Guides of most spheres turn with the
//! body as a whole, where two guides never approach: `|r0 + (Omega x r0) t| >= |r0|`. Spheres too fast for that, in a
//! collapse or far out, are guided along their own present course.

use super::ball::Ball;
use super::predict::LANES;
use super::sweep::{Reach, Sweep};
use nalgebra::{Matrix3, Vector3};

/// Longest leash, as a fraction of the sphere's radius; also how far a sphere may move against the body before it is
/// guided on its own course. Longer: more neighbours to look at in each prediction. Shorter: more lists.
const LONGEST_LEASH: f64 = 0.1;
/// Leash as a multiple of the way the sphere would go against the body until the end of the step: collisions make some
/// spheres faster than they start.
const LEASH_PER_WAY: f64 = 1.5;
/// Shortest leash as a multiple of the root mean square of that way, of the radius when nothing moves, and of the
/// coordinates, whose round-off must not use it up.
const SHORTEST_LEASH: (f64, f64, f64) = (1.0, 1e-6, 1e-12);

/// The guide and leash of a sphere: one cache line, read with its [`Ball`] and laid out like it.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
struct Leash {
    /// Guide at the start of the step, m, and square of the leash, m².
    guide: [f64; 4],
    /// Velocity of the guide, m/s, and nothing.
    course: [f64; 4],
}

impl Leash {
    fn new(guide: Vector3<f64>, velocity: Vector3<f64>, length: f64) -> Self {
        Self { guide: [guide.x, guide.y, guide.z, length * length], course: [velocity.x, velocity.y, velocity.z, 0.0] }
    }

    fn length2(&self) -> f64 {
        self.guide[3]
    }

    /// Offset of a sphere from its guide at time `t` (s of the step), m, and their relative velocity, m/s.
    #[inline(always)]
    fn offset(&self, ball: &Ball, t: f64) -> (Vector3<f64>, Vector3<f64>) {
        // All four lanes although the last one means nothing: that is one vector.
        let u: [f64; 4] = std::array::from_fn(|k| ball.course[k] - self.course[k]);
        let d: [f64; 4] = std::array::from_fn(|k| (ball.place[k] - self.guide[k]) + u[k] * t);
        (Vector3::new(d[0], d[1], d[2]), Vector3::new(u[0], u[1], u[2]))
    }
}

/// Neighbours of every sphere that it could meet.
#[derive(Debug, Default)]
pub(super) struct Neighbours {
    /// Row `i` is `rows[starts[i]..starts[i + 1]]`.
    starts: Vec<u32>,
    /// Neighbours in groups that are looked at together; the last one of a row is filled up with the index one past the
    /// last sphere.
    rows: Vec<[u32; LANES]>,
    /// How many neighbours each sphere has; used while the rows are filled.
    degrees: Vec<u32>,
    leashes: Vec<Leash>,
    /// Radius, leash and own course together: two spheres further apart than the sum of these cannot meet.
    reaches: Vec<Reach>,
    /// How far the guide goes against the body in the time that is left, m; zero if it turns with the body.
    courses: Vec<f64>,
    sweep: Sweep,
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
            values.extend(balls.iter().map(|b| b.place[k]));
            median(&mut values)
        });
        values.clear();
        values.extend(balls.iter().map(|b| (b.origin() - middle).norm_squared()));
        // Half of a homogeneous ball lies within 0.79 of its radius, half of a 3:1 ellipsoid within a third of its length.
        let far = 10.0 * median(&mut values);
        let bulk = || balls.iter().filter(|b| (b.origin() - middle).norm_squared() <= far);
        let mass: f64 = bulk().map(|b| b.mass()).sum();
        let centre = bulk().map(|b| b.origin() * b.mass()).sum::<Vector3<f64>>() / mass;
        let velocity = bulk().map(|b| b.velocity() * b.mass()).sum::<Vector3<f64>>() / mass;
        let mut spin = Vector3::zeros();
        let mut inertia = Matrix3::zeros();
        for b in bulk() {
            let d = b.origin() - centre;
            spin += d.cross(&(b.velocity() - velocity)) * b.mass();
            let own = 0.4 * b.radius() * b.radius();
            inertia += (Matrix3::identity() * (own + d.norm_squared()) - d * d.transpose()) * b.mass();
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
    pub fn of(&self, i: usize) -> &[[u32; LANES]] {
        &self.rows[self.starts[i] as usize..self.starts[i + 1] as usize]
    }

    /// The pairs that could meet, each once.
    pub fn pairs(&self) -> &[(u32, u32)] {
        &self.pairs
    }

    /// Whether sphere `i`, flying straight on, is still on its leash at time `until` (s of the step). As it is on it now, it
    /// is all the while.
    #[inline(always)]
    pub fn keeps(&self, i: usize, ball: &Ball, until: f64) -> bool {
        let leash = &self.leashes[i];
        // What is not a number has no course to follow: it is found at the end of the step.
        let off = leash.offset(ball, until).0.norm_squared() > leash.length2();
        !off
    }

    /// When sphere `i`, flying straight on from `now`, comes to the end of its leash, s of the step.
    pub fn leash_end(&self, i: usize, ball: &Ball, now: f64) -> f64 {
        let leash = &self.leashes[i];
        let (d, u) = leash.offset(ball, now);
        let (b, u2, c) = (d.dot(&u), u.norm_squared(), d.norm_squared() - leash.length2());
        let delay = if c < 0.0 { -c / (b + (b * b - u2 * c).sqrt()) } else { 0.0 };
        now + delay
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
        self.courses.clear();
        self.courses.resize(count, 0.0);
        for ball in &balls[..count] {
            let length = leash * ball.radius();
            self.leashes.push(Leash::new(ball.origin(), Vector3::zeros(), length));
            self.reaches.push(Reach { centre: ball.origin().into(), reach: ball.radius() + length });
        }
        self.find_pairs(0.0);
        self.fill_rows(count);
    }

    fn set_leashes(&mut self, balls: &[Ball], motion: &RigidMotion, now: f64, end: f64) {
        let left = end - now;
        let against = |b: &Ball| (b.velocity() - motion.at(b.position_at(now))).norm() * left;
        let square: f64 = balls.iter().map(|b| against(b).powi(2)).sum();
        let usual = (square / balls.len() as f64).sqrt();
        self.leashes.clear();
        self.reaches.clear();
        self.courses.clear();
        for ball in balls {
            let centre = ball.position_at(now);
            let way = against(ball);
            let longest = LONGEST_LEASH * ball.radius();
            let own_course = way > longest;
            let roundoff = SHORTEST_LEASH.2 * (centre.norm() + ball.velocity().norm() * end);
            let shortest = (SHORTEST_LEASH.0 * usual).max(SHORTEST_LEASH.1 * ball.radius());
            let length = if own_course { longest } else { (LEASH_PER_WAY * way).max(shortest).min(longest) };
            let length = length.max(roundoff);
            let velocity = if own_course { ball.velocity() } else { motion.at(centre) };
            self.leashes.push(Leash::new(centre - velocity * now, velocity, length));
            let course = if own_course { way } else { 0.0 };
            // Round-off of the guide must not lose a pair: a margin of 1e-9 of the radius is far above it.
            let reach = ball.radius() * (1.0 + 1e-9) + length + course;
            self.reaches.push(Reach { centre: centre.into(), reach });
            self.courses.push(course);
        }
    }

    fn find_pairs(&mut self, left: f64) {
        let Self { leashes, reaches, courses, sweep, pairs, .. } = self;
        pairs.clear();
        sweep.visit_pairs(reaches, |i, j| {
            let [one, two] = [i as usize, j as usize];
            let courses = courses[one] + courses[two];
            if courses == 0.0 {
                pairs.push((i, j));
                return;
            }
            // How close the guides come, from where the spheres are now.
            let r: Vector3<f64> = Vector3::from(reaches[two].centre) - Vector3::from(reaches[one].centre);
            let v = Vector3::from_fn(|k, _| leashes[two].course[k] - leashes[one].course[k]);
            let closest = (-r.dot(&v) / v.norm_squared()).max(0.0).min(left);
            let limit = reaches[one].reach + reaches[two].reach - courses;
            if (r + v * closest).norm_squared() <= limit * limit {
                pairs.push((i, j));
            }
        });
    }

    fn fill_rows(&mut self, count: usize) {
        self.degrees.clear();
        self.degrees.resize(count, 0);
        for &(i, j) in &self.pairs {
            self.degrees[i as usize] += 1;
            self.degrees[j as usize] += 1;
        }
        let mut end = 0;
        self.starts.clear();
        self.starts.push(end);
        for degree in &mut self.degrees {
            end += std::mem::take(degree).div_ceil(LANES as u32);
            self.starts.push(end);
        }
        self.rows.clear();
        self.rows.resize(end as usize, [count as u32; LANES]);
        for &(i, j) in &self.pairs {
            for (from, to) in [(i as usize, j), (j as usize, i)] {
                let at = self.degrees[from] as usize;
                self.rows[self.starts[from] as usize + at / LANES][at % LANES] = to;
                self.degrees[from] += 1;
            }
        }
    }
}
