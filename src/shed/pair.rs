//! Two rigid aggregates of mascons after a fission: their orbit and spins until they meet, part or have stayed together.
//!
//! Leapfrog with the splitting of Dullweber, Leimkuhler & McLachlan 1997 (J. Chem. Phys. 107, 5840) for the rotations:
//! time-reversible, angular momentum kept to round-off. Every mascon of one body is pulled by all mascons of the other (or
//! by its multipoles, within the stated error).

use nalgebra::{Matrix3, Rotation3, Vector3};
use pkd::Spheres;
use pkd::mass_properties::mass_properties;

use super::forces::{AU_M, GM_SUN};
use super::mascons::Mascons;
use super::multipole::Multipole;
use super::orbit::{Elements, elements, specific_energy};
use super::{ShedError, TrackOptions};

/// Steps in the shorter of both spin periods and of the orbital period at contact.
const STEPS_PER_PERIOD: f64 = 200.0;
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
    /// Length of a step, s.
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
            attitude: properties.axes,
            momentum: to_body * properties.angular_momentum,
            position: properties.centre,
            velocity: properties.velocity,
        })
    }

    fn spin(&self) -> Vector3<f64> {
        self.momentum.component_div(&self.moments)
    }

    fn kinetic(&self) -> f64 {
        0.5 * self.mass * self.velocity.norm_squared() + 0.5 * self.momentum.dot(&self.spin())
    }

    fn angular_momentum(&self) -> Vector3<f64> {
        self.mass * self.position.cross(&self.velocity) + self.attitude * self.momentum
    }

    /// Free motion for `h` seconds.
    fn drift(&mut self, h: f64) {
        self.position += h * self.velocity;
        for (axis, share) in [(0, 0.5), (1, 0.5), (2, 1.0), (1, 0.5), (0, 0.5)] {
            let angle = share * h * self.momentum[axis] / self.moments[axis];
            let turn = Rotation3::from_axis_angle(&Vector3::ith_axis(axis), angle);
            self.momentum = turn.inverse() * self.momentum;
            self.attitude *= turn.matrix();
        }
    }

    fn kick(&mut self, force: Vector3<f64>, torque: Vector3<f64>, h: f64) {
        self.velocity += h / self.mass * force;
        self.momentum += h * (self.attitude.transpose() * torque);
    }
}

/// Follows two aggregates, given in one inertial frame, as rigid bodies.
///
/// # Errors
/// [`ShedError`]: options out of range, or aggregates that overlap at the start or become non-finite.
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
    let mut track = pair.follow(options, gap)?;
    if swap {
        track.spin_rate.reverse();
    }
    Ok(track)
}

struct Pair {
    a: Rigid,
    b: Rigid,
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
        let position = (self.a.mass * self.a.position + self.b.mass * self.b.position) / mass;
        let velocity = (self.a.mass * self.a.velocity + self.b.mass * self.b.velocity) / mass;
        for body in [&mut self.a, &mut self.b] {
            body.position -= position;
            body.velocity -= velocity;
        }
    }

    fn follow(&mut self, options: &TrackOptions, first_gap: f64) -> Result<PairTrack, ShedError> {
        let gm = self.a.mascons.gm + self.b.mascons.gm;
        let reach = self.a.mascons.bounding_radius_m + self.b.mascons.bounding_radius_m;
        let hill = options.semimajor_axis_au * AU_M * (gm / (3.0 * GM_SUN)).cbrt();
        let far = (ESCAPE_RADII * reach).max(ESCAPE_HILL_RADII * hill);
        let step_s = self.step_s(gm);
        let (energy, momentum) = (self.energy(), self.angular_momentum());
        let mut track = PairTrack {
            fate: PairFate::Bound { mean: None },
            t_s: 0.0,
            spin_rate: [0.0; 2],
            energy_drift: 0.0,
            angular_momentum_drift: 0.0,
            steps: 0,
            step_s,
        };
        let (mut bound_s, mut sums, mut last_gap, mut kinetic) = (0.0, [0.0; 3], first_gap, 0.0f64);
        let mut action = self.action();
        while track.t_s < options.t_max_s {
            let h = step_s.min(options.t_max_s - track.t_s);
            self.kick(&action, 0.5 * h);
            self.a.drift(h);
            self.b.drift(h);
            action = self.action();
            self.kick(&action, 0.5 * h);
            track.t_s += h;
            track.steps += 1;
            let (r, v) = (self.b.position - self.a.position, self.b.velocity - self.a.velocity);
            if !(r.norm_squared() + v.norm_squared()).is_finite() {
                return Err(ShedError::BecameNonFinite { body: 0, t_s: track.t_s });
            }
            kinetic = kinetic.max(self.a.kinetic() + self.b.kinetic());
            let orbit = elements(gm, r.into(), v.into());
            if orbit.semimajor_axis_m > 0.0 {
                bound_s += h;
                let parts = [orbit.semimajor_axis_m, orbit.eccentricity, orbit.inclination];
                sums.iter_mut().zip(parts).for_each(|(sum, x)| *sum += h * x);
            }
            if r.norm() < reach {
                let gap = self.gap();
                if gap < 0.0 && gap < last_gap {
                    track.fate = PairFate::Collided { speed_m_s: v.norm() };
                    break;
                }
                last_gap = gap;
            }
            let two_body = specific_energy(gm, r.into(), v.into());
            if r.norm() > far && two_body > 0.0 {
                track.fate = PairFate::Separated { speed_m_s: (2.0 * two_body).sqrt() };
                break;
            }
        }
        if let PairFate::Bound { mean } = &mut track.fate
            && bound_s > 0.0
        {
            let [semimajor_axis_m, eccentricity, inclination] = sums.map(|sum| sum / bound_s);
            *mean = Some(Elements { semimajor_axis_m, eccentricity, inclination });
        }
        track.spin_rate = [self.a.spin().norm(), self.b.spin().norm()];
        track.energy_drift = if kinetic > 0.0 { (self.energy() - energy).abs() / kinetic } else { 0.0 };
        track.angular_momentum_drift =
            (self.angular_momentum() - momentum).norm() / momentum.norm().max(f64::MIN_POSITIVE);
        Ok(track)
    }

    /// A share of the fastest motion there is: the spins, or an orbit at contact.
    fn step_s(&self, gm: f64) -> f64 {
        // One may lie in a hollow of the other, centre on centre.
        let radius = self.a.mascons.bounding_radius_m.max(self.b.mascons.bounding_radius_m);
        let nearest = (self.b.position - self.a.position).norm().max(radius);
        let orbit = (gm / nearest.powi(3)).sqrt();
        std::f64::consts::TAU / orbit.max(self.a.spin().norm()).max(self.b.spin().norm()) / STEPS_PER_PERIOD
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
        let to_b = self.a.attitude.transpose() * (self.b.position - self.a.position);
        about_b += about_a - to_b.cross(&force);
        let inertial = self.a.attitude;
        Action { force: inertial * force, torque_a: inertial * -about_a, torque_b: inertial * about_b }
    }

    /// Mascons of `b` in the principal axes of `a`, with their masses.
    fn of_b_seen_from_a(&self) -> impl Iterator<Item = (Vector3<f64>, f64)> {
        let to_a = self.a.attitude.transpose();
        let (turn, shift) = (to_a * self.b.attitude, to_a * (self.b.position - self.a.position));
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
