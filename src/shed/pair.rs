//! Two rigid aggregates of mascons after a fission: their orbit and spins until they meet, part or have stayed together.
//!
//! Leapfrog with the splitting of Dullweber, Leimkuhler & McLachlan 1997 (J. Chem. Phys. 107, 5840) for the rotations:
//! angular momentum kept to round-off. Every mascon of one body is pulled by all mascons of the other (or by its multipoles,
//! within the stated error). Steps are a share of the fastest motion at the place where the bodies are, so that a fall from afar
//! does not jump over its end, and the whole way is gone again in finer steps until the energy is kept.

use nalgebra::{Matrix3, Rotation3, Vector3};
use pkd::Spheres;
use pkd::mass_properties::mass_properties;

use super::forces::{AU_M, GM_SUN};
use super::mascons::Mascons;
use super::multipole::Multipole;
use super::orbit::{Elements, elements, leaves_for_good, specific_energy};
use super::{ShedError, TrackOptions};

/// Steps in the shortest of both spin periods, of the orbital period at the present distance, and of 2 pi times the time in
/// which the bodies would meet: at first, and how much finer each repetition is.
const STEPS_PER_PERIOD: f64 = 200.0;
const FINER: f64 = 4.0;
const MAX_TRIES: i32 = 4;
/// Largest change of the energy over the largest kinetic energy: that of the first steps on usual orbits is a tenth of it.
const ENERGY_KEPT: f64 = 1e-3;
/// Near contact a step brings the surfaces nearer by no more than this share of the smallest radius.
const NEAR_CONTACT: f64 = 0.1;
/// Halvings of the step in which the bodies come into contact, and looks for the nearest point of a pass.
const HALVINGS: usize = 40;
/// Separated bodies are beyond this many sums of radii, and beyond this share of the Hill radius.
const ESCAPE_RADII: f64 = 20.0;
const ESCAPE_HILL_RADII: f64 = 0.5;

/// How two aggregates ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairTrack {
    /// What became of them.
    pub fate: PairFate,
    /// When, s.
    pub t_s: f64,
    /// Spin rates at the end, rad/s: of the first, of the second.
    pub spin_rate: [f64; 2],
    /// Largest change of the total energy over the largest kinetic energy.
    pub energy_drift: f64,
    /// Change of the total angular momentum, relative.
    pub angular_momentum_drift: f64,
    /// Steps done.
    pub steps: u64,
    /// Mean length of a step, s.
    pub step_s: f64,
}

/// What became of two aggregates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PairFate {
    /// They touched again.
    Collided {
        /// Speed of one centre of mass relative to the other, m/s.
        speed_m_s: f64,
    },
    /// They parted for good.
    Separated {
        /// Speed at infinity, m/s.
        speed_m_s: f64,
    },
    /// They still orbit each other.
    Bound {
        /// Mean orbit over the time in which its two-body energy was negative; `None` if there was none.
        mean: Option<Elements>,
    },
}

impl PairFate {
    /// Name in the database and in JSON.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Collided { .. } => "collided",
            Self::Separated { .. } => "separated",
            Self::Bound { .. } => "bound",
        }
    }
}

/// A rigid aggregate: mascons in its principal axes.
struct Rigid {
    mascons: Mascons,
    multipole: Multipole,
    points: Vec<(Vector3<f64>, f64)>,
    radius: Vec<f64>,
    mass: f64,
    moments: Vector3<f64>,
    motion: Motion,
}

/// Where an aggregate is and how it moves.
#[derive(Debug, Clone, Copy)]
struct Motion {
    /// From the principal to inertial axes.
    attitude: Matrix3<f64>,
    /// Angular momentum in principal axes.
    momentum: Vector3<f64>,
    position: Vector3<f64>,
    velocity: Vector3<f64>,
}

impl Rigid {
    fn new(spheres: &Spheres, multipole_error: f64) -> Result<Self, ShedError> {
        let properties = mass_properties(spheres)?;
        let to_body = properties.axes.transpose();
        let mut own = Spheres::default();
        for i in 0..spheres.len() {
            let at = to_body * (Vector3::from(spheres.position(i)) - properties.centre);
            own.push(at.into(), [0.0; 3], [0.0; 3], spheres.mass[i], spheres.radius[i]);
        }
        let mascons = Mascons::new(&own)?;
        let points = (0..own.len()).map(|i| (Vector3::from(own.position(i)), own.mass[i])).collect();
        Ok(Self {
            multipole: Multipole::new(&mascons, multipole_error),
            mascons,
            points,
            radius: own.radius,
            mass: properties.mass,
            moments: properties.moments,
            motion: Motion {
                attitude: properties.axes,
                momentum: to_body * properties.angular_momentum,
                position: properties.centre,
                velocity: properties.velocity,
            },
        })
    }

    fn spin(&self) -> Vector3<f64> {
        self.motion.momentum.component_div(&self.moments)
    }

    fn kinetic(&self) -> f64 {
        0.5 * self.mass * self.motion.velocity.norm_squared() + 0.5 * self.motion.momentum.dot(&self.spin())
    }

    fn angular_momentum(&self) -> Vector3<f64> {
        let Motion { attitude, momentum, position, velocity } = self.motion;
        self.mass * position.cross(&velocity) + attitude * momentum
    }

    /// Free motion for `h` seconds.
    fn drift(&mut self, h: f64) {
        let motion = &mut self.motion;
        motion.position += h * motion.velocity;
        for (axis, share) in [(0, 0.5), (1, 0.5), (2, 1.0), (1, 0.5), (0, 0.5)] {
            let angle = share * h * motion.momentum[axis] / self.moments[axis];
            let turn = Rotation3::from_axis_angle(&Vector3::ith_axis(axis), angle);
            motion.momentum = turn.inverse() * motion.momentum;
            motion.attitude *= turn.matrix();
        }
    }

    fn kick(&mut self, force: Vector3<f64>, torque: Vector3<f64>, h: f64) {
        self.motion.velocity += h / self.mass * force;
        self.motion.momentum += h * (self.motion.attitude.transpose() * torque);
    }
}

/// Follows two aggregates, given in one inertial frame, as rigid bodies.
///
/// # Errors
/// [`ShedError`]: options out of range, aggregates that overlap at the start or become non-finite, or energy that is not kept.
pub fn follow_pair(first: &Spheres, second: &Spheres, options: &TrackOptions) -> Result<PairTrack, ShedError> {
    options.validate()?;
    // The larger sums over mascons are done by the body that has more of them.
    let swap = second.len() > first.len();
    let (large, small) = if swap { (second, first) } else { (first, second) };
    let mut pair =
        Pair { a: Rigid::new(large, options.multipole_error)?, b: Rigid::new(small, options.multipole_error)? };
    pair.recentre();
    let gap = pair.gap();
    if gap < 0.0 {
        return Err(ShedError::AggregatesOverlap { overlap_m: -gap });
    }
    let start = [pair.a.motion, pair.b.motion];
    let mut tries = (0..MAX_TRIES).map(|finer| STEPS_PER_PERIOD * FINER.powi(finer));
    let mut track = loop {
        let Some(steps) = tries.next() else { unreachable!("the last try returns") };
        [pair.a.motion, pair.b.motion] = start;
        let track = pair.follow(options, gap, steps)?;
        if track.energy_drift <= ENERGY_KEPT {
            break track;
        }
        if tries.len() == 0 {
            let (drift, step_s) = (track.energy_drift, track.step_s);
            return Err(ShedError::EnergyNotKept { drift, allowed: ENERGY_KEPT, step_s });
        }
    };
    if swap {
        track.spin_rate.reverse();
    }
    Ok(track)
}

struct Pair {
    a: Rigid,
    b: Rigid,
}

/// About when within a step of `h` (s) a `gap` is smallest that is `ends` at its ends. A gap that falls or rises all along is
/// asked for four times only.
fn nearest(gap: &mut impl FnMut(f64) -> f64, h: f64, ends: [f64; 2]) -> f64 {
    const INWARDS: f64 = 0.01;
    let times = [0.0, 0.25 * h, 0.5 * h, 0.75 * h, h];
    let gaps = [ends[0], gap(times[1]), gap(times[2]), gap(times[3]), ends[1]];
    let k = (0..5).fold(0, |best, k| if gaps[k] < gaps[best] { k } else { best });
    let inwards = if k == 0 { INWARDS * h } else { (1.0 - INWARDS) * h };
    if (k == 0 || k == 4) && gap(inwards) >= gaps[k] {
        return times[k];
    }
    let (mut low, mut high) = (times[k.max(1) - 1], times[k.min(3) + 1]);
    for _ in 0..HALVINGS {
        let [left, right] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
        if gap(left) < gap(right) { high = right } else { low = left }
    }
    0.5 * (low + high)
}

/// Force on `b` and torques on both about their own centres, inertial axes.
struct Action {
    force: Vector3<f64>,
    torque_a: Vector3<f64>,
    torque_b: Vector3<f64>,
}

impl Pair {
    fn recentre(&mut self) {
        let mass = self.a.mass + self.b.mass;
        let (a, b) = (self.a.motion, self.b.motion);
        let position = (self.a.mass * a.position + self.b.mass * b.position) / mass;
        let velocity = (self.a.mass * a.velocity + self.b.mass * b.velocity) / mass;
        for body in [&mut self.a, &mut self.b] {
            body.motion.position -= position;
            body.motion.velocity -= velocity;
        }
    }

    /// Follows the pair in steps of a share 1 / `steps_per_period` of the fastest motion.
    fn follow(
        &mut self,
        options: &TrackOptions,
        first_gap: f64,
        steps_per_period: f64,
    ) -> Result<PairTrack, ShedError> {
        let gm = self.a.mascons.gm + self.b.mascons.gm;
        let hill = options.semimajor_axis_au * AU_M * (gm / (3.0 * GM_SUN)).cbrt();
        let far = (ESCAPE_RADII * self.reach()).max(ESCAPE_HILL_RADII * hill);
        let (energy, momentum) = (self.energy(), self.angular_momentum());
        let mut track = PairTrack {
            fate: PairFate::Bound { mean: None },
            t_s: 0.0,
            spin_rate: [0.0; 2],
            energy_drift: 0.0,
            angular_momentum_drift: 0.0,
            steps: 0,
            step_s: 0.0,
        };
        let (mut bound_s, mut sums, mut kinetic) = (0.0, [0.0; 3], self.a.kinetic() + self.b.kinetic());
        let (mut action, mut gap) = (self.action(), first_gap);
        while track.t_s < options.t_max_s {
            let h = self.step_s(gm, gap, steps_per_period).min(options.t_max_s - track.t_s);
            let before = ([self.a.motion, self.b.motion], gap);
            let closing_speed = self.surface_speed();
            let next_action = self.step(&action, h);
            gap = self.gap_or_less();
            let (r, v) = self.relative();
            if !(r.norm_squared() + v.norm_squared()).is_finite() {
                return Err(ShedError::BecameNonFinite { body: 0, t_s: track.t_s });
            }
            let closing_speed = closing_speed.max(self.surface_speed());
            let contact = self.contact(before, &action, [h, closing_speed]);
            let h = contact.unwrap_or(h);
            (track.t_s, track.steps, action) = (track.t_s + h, track.steps + 1, next_action);
            kinetic = kinetic.max(self.a.kinetic() + self.b.kinetic());
            let (r, v) = self.relative();
            if contact.is_some() {
                track.fate = PairFate::Collided { speed_m_s: v.norm() };
                break;
            }
            let orbit = elements(gm, r.into(), v.into());
            if orbit.semimajor_axis_m > 0.0 {
                bound_s += h;
                let parts = [orbit.semimajor_axis_m, orbit.eccentricity, orbit.inclination];
                sums.iter_mut().zip(parts).for_each(|(sum, x)| *sum += h * x);
            }
            if leaves_for_good(gm, far, r.into(), v.into()) {
                let speed_m_s = (2.0 * specific_energy(gm, r.into(), v.into())).sqrt();
                track.fate = PairFate::Separated { speed_m_s };
                break;
            }
        }
        if let PairFate::Bound { mean } = &mut track.fate
            && bound_s > 0.0
        {
            let [semimajor_axis_m, eccentricity, inclination] = sums.map(|sum| sum / bound_s);
            *mean = Some(Elements { semimajor_axis_m, eccentricity, inclination });
        }
        track.step_s = if track.steps > 0 { track.t_s / track.steps as f64 } else { 0.0 };
        track.spin_rate = [self.a.spin().norm(), self.b.spin().norm()];
        track.energy_drift = if kinetic > 0.0 { (self.energy() - energy).abs() / kinetic } else { 0.0 };
        track.angular_momentum_drift =
            (self.angular_momentum() - momentum).norm() / momentum.norm().max(f64::MIN_POSITIVE);
        Ok(track)
    }

    /// One step of `h` seconds from a state in which `action` acts; what acts after it.
    fn step(&mut self, action: &Action, h: f64) -> Action {
        self.kick(action, 0.5 * h);
        self.a.drift(h);
        self.b.drift(h);
        let next = self.action();
        self.kick(&next, 0.5 * h);
        next
    }

    /// Whether the surfaces met within the step that has been taken from `before`, whose gap is its second part: then how long
    /// after its start, s, and the bodies are put there. Surfaces come nearer at `closing_speed` at most.
    ///
    /// Bodies that touch at the start count only where they come nearer.
    fn contact(
        &mut self,
        (before, gap_before): ([Motion; 2], f64),
        action: &Action,
        [h, closing_speed]: [f64; 2],
    ) -> Option<f64> {
        let after = [self.a.motion, self.b.motion];
        let gap_after = self.gap_or_less();
        let at = |pair: &mut Self, t: f64| {
            [pair.a.motion, pair.b.motion] = before;
            pair.step(action, t);
            pair.gap_or_less()
        };
        let mut closed = h;
        if gap_after >= 0.0 || gap_after >= gap_before {
            if gap_before < 0.0 || gap_after < 0.0 || gap_before + gap_after >= closing_speed * h {
                return None;
            }
            // It may have been nearer in between.
            closed = nearest(&mut |t| at(self, t), h, [gap_before, gap_after]);
            if at(self, closed) >= 0.0 {
                [self.a.motion, self.b.motion] = after;
                return None;
            }
        }
        let mut open = 0.0;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (open + closed);
            if at(self, middle) < 0.0 { closed = middle } else { open = middle }
        }
        at(self, closed);
        Some(closed)
    }

    /// A share of the fastest motion there is: the spins, an orbit at this distance, or the way to contact.
    fn step_s(&self, gm: f64, gap: f64, steps_per_period: f64) -> f64 {
        let (r, v) = self.relative();
        // One may lie in a hollow of the other, centre on centre.
        let radius = self.a.mascons.bounding_radius_m.max(self.b.mascons.bounding_radius_m);
        let distance = r.norm().max(radius);
        let orbit = (gm / distance.powi(3)).sqrt();
        let rate = orbit.max(self.a.spin().norm()).max(self.b.spin().norm()).max(v.norm() / distance);
        let near = NEAR_CONTACT * self.a.mascons.smallest_radius_m().min(self.b.mascons.smallest_radius_m());
        let to_contact = gap.max(near) / self.surface_speed().max(f64::MIN_POSITIVE);
        (std::f64::consts::TAU / rate / steps_per_period).min(to_contact)
    }

    /// How fast surfaces can come nearer now, m/s.
    fn surface_speed(&self) -> f64 {
        let turning = |body: &Rigid| body.spin().norm() * body.mascons.bounding_radius_m;
        self.relative().1.norm() + turning(&self.a) + turning(&self.b)
    }

    /// Sum of the radii around both, m.
    fn reach(&self) -> f64 {
        self.a.mascons.bounding_radius_m + self.b.mascons.bounding_radius_m
    }

    /// Position (m) and velocity (m/s) of the second body relative to the first.
    fn relative(&self) -> (Vector3<f64>, Vector3<f64>) {
        let (a, b) = (self.a.motion, self.b.motion);
        (b.position - a.position, b.velocity - a.velocity)
    }

    /// The gap between the surfaces, m; where the bodies are far apart, what it is at least.
    fn gap_or_less(&self) -> f64 {
        let at_least = self.relative().0.norm() - self.reach();
        if at_least > 0.0 { at_least } else { self.gap() }
    }

    fn kick(&mut self, action: &Action, h: f64) {
        self.a.kick(-action.force, action.torque_a, h);
        self.b.kick(action.force, action.torque_b, h);
    }

    /// What the bodies do to each other: the field of `a` at every mascon of `b`.
    fn action(&self) -> Action {
        let (mut force, mut about_a, mut about_b) = (Vector3::zeros(), Vector3::zeros(), Vector3::zeros());
        for (at, mass) in self.of_b_seen_from_a() {
            let pull =
                self.a.multipole.acceleration(at.into()).unwrap_or_else(|| self.a.mascons.acceleration(at.into()));
            let on_mascon = mass * Vector3::from(pull);
            force += on_mascon;
            about_a += at.cross(&on_mascon);
        }
        // In principal axes of `a`; the reaction on `a` acts where the mascons of `b` are.
        let inertial = self.a.motion.attitude;
        let to_b = inertial.transpose() * self.relative().0;
        about_b += about_a - to_b.cross(&force);
        Action { force: inertial * force, torque_a: inertial * -about_a, torque_b: inertial * about_b }
    }

    /// Mascons of `b` in the principal axes of `a`, with their masses.
    fn of_b_seen_from_a(&self) -> impl Iterator<Item = (Vector3<f64>, f64)> {
        let to_a = self.a.motion.attitude.transpose();
        let (turn, shift) = (to_a * self.b.motion.attitude, to_a * self.relative().0);
        self.b.points.iter().map(move |(point, mass)| (turn * point + shift, *mass))
    }

    /// Smallest gap between the surfaces, m.
    fn gap(&self) -> f64 {
        let gaps = self.of_b_seen_from_a().zip(&self.b.radius);
        gaps.map(|((at, _), radius)| self.a.mascons.clearance(at.into(), *radius).0).fold(f64::INFINITY, f64::min)
    }

    fn energy(&self) -> f64 {
        let potential: f64 = self.of_b_seen_from_a().map(|(at, mass)| mass * self.a.mascons.potential(at.into())).sum();
        self.a.kinetic() + self.b.kinetic() + potential
    }

    fn angular_momentum(&self) -> Vector3<f64> {
        self.a.angular_momentum() + self.b.angular_momentum()
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_bodies::prolate;
    use super::*;
    use pkd::constants::G;
    use pkd::frame::set_rigid_rotation;

    /// A copy of `spheres` that turns with `omega` at a place of its own.
    fn placed(mut spheres: Spheres, omega: [f64; 3], at: [f64; 3], velocity: [f64; 3]) -> Spheres {
        set_rigid_rotation(&mut spheres, Vector3::from(omega)).unwrap();
        for i in 0..spheres.len() {
            let (r, v) = (Vector3::from(spheres.position(i)), Vector3::from(spheres.velocity(i)));
            let (r, v) = (r + Vector3::from(at), v + Vector3::from(velocity));
            spheres.set(i, r.into(), v.into(), omega);
        }
        spheres
    }

    fn ball(mass: f64) -> Spheres {
        let mut spheres = Spheres::default();
        for at in [
            [50.0, 0.0, 0.0],
            [-50.0, 0.0, 0.0],
            [0.0, 50.0, 0.0],
            [0.0, -50.0, 0.0],
            [0.0, 0.0, 50.0],
            [0.0, 0.0, -50.0],
        ] {
            spheres.push(at, [0.0; 3], [0.0; 3], mass / 6.0, 40.0);
        }
        spheres
    }

    #[test]
    fn round_bodies_far_apart_keep_their_kepler_orbit_and_spins() {
        let (m, d) = (1e11, 3000.0);
        let v = (G * 2.0 * m / d).sqrt();
        let a = placed(ball(m), [0.0, 0.0, 2e-4], [0.0; 3], [0.0; 3]);
        let b = placed(ball(m), [0.0, 0.0, 3e-4], [d, 0.0, 0.0], [0.0, v, 0.0]);
        let options = TrackOptions { t_max_s: 20.0 * 86_400.0, ..TrackOptions::default() };
        let track = follow_pair(&a, &b, &options).unwrap();
        let PairFate::Bound { mean: Some(mean) } = track.fate else { panic!("{track:?}") };
        assert!((mean.semimajor_axis_m / d - 1.0).abs() < 1e-3 && mean.eccentricity < 2e-3, "{track:?}");
        assert!(
            (track.spin_rate[0] / 2e-4 - 1.0).abs() < 1e-5 && (track.spin_rate[1] / 3e-4 - 1.0).abs() < 1e-5,
            "{track:?}"
        );
        assert!(track.angular_momentum_drift < 1e-11 && track.energy_drift < 1e-6, "{track:?}");
    }

    #[test]
    fn elongated_bodies_exchange_angular_momentum_and_keep_their_sum() {
        let a = placed(prolate(60), [1e-6, 2e-6, 3e-4], [0.0; 3], [0.0; 3]);
        let mass = a.total_mass();
        let d = 2400.0;
        let v = (G * 2.0 * mass / d).sqrt();
        let b = placed(prolate(60), [0.0, 1e-5, 2e-4], [0.0, d, 100.0], [-v, 0.0, 0.02]);
        let options = TrackOptions { t_max_s: 4.0 * 86_400.0, ..TrackOptions::default() };
        let track = follow_pair(&a, &b, &options).unwrap();
        assert!(track.angular_momentum_drift < 1e-11 && track.energy_drift < 1e-3, "{track:?}");
        assert!((track.spin_rate[1] / 2e-4 - 1.0).abs() > 1e-3, "{track:?}");
    }

    #[test]
    fn slow_bodies_collide_and_fast_ones_part() {
        let (m, d) = (1e11, 400.0);
        let escape = (2.0 * G * 2.0 * m / d).sqrt();
        let fate = |speed: f64| {
            let b = placed(ball(m), [0.0, 0.0, 3e-4], [d, 0.0, 0.0], [speed, 0.0, 0.0]);
            follow_pair(&placed(ball(m), [0.0, 0.0, 3e-4], [0.0; 3], [0.0; 3]), &b, &TrackOptions::default()).unwrap()
        };
        assert!(matches!(fate(0.3 * escape).fate, PairFate::Collided { .. }));
        let PairFate::Separated { speed_m_s } = fate(1.5 * escape).fate else { panic!() };
        assert!((speed_m_s / (1.25f64.sqrt() * escape) - 1.0).abs() < 1e-2);
        let inside = placed(ball(m), [0.0; 3], [60.0, 0.0, 0.0], [0.0; 3]);
        let overlap = follow_pair(&ball(m), &inside, &TrackOptions::default());
        assert!(matches!(overlap, Err(ShedError::AggregatesOverlap { .. })));
    }
}
