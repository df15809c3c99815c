//! What acts on shed bodies besides their mutual gravity: the turning primary, its recoil, and the Sun.

use librebound_sys::ffi::reb_particle;

use super::mascons::{Mascons, cross, dot};
use super::multipole::Multipole;
use super::rebound::Force;
use super::{Primary, ShedError, Sun, TrackOptions};

/// Gravitational parameter of the Sun, m^3/s^2 (IAU 2015 nominal value).
pub(super) const GM_SUN: f64 = 1.327_124_400_18e20;
/// Astronomical unit, m (IAU 2012).
pub(super) const AU_M: f64 = 1.495_978_707e11;
/// Solar constant over the speed of light, Pa.
const SOLAR_PRESSURE_PA: f64 = 1361.0 / 299_792_458.0;

/// The field of the primary in inertial axes.
pub(super) struct Field {
    pub mascons: Mascons,
    multipole: Multipole,
    pub spin_rate: f64,
    sun: Option<Sunlight>,
    pub evaluations: Evaluations,
}

/// How often the field was evaluated each way.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Evaluations {
    /// As a sum over mascons.
    pub mascons: u64,
    /// From the multipoles.
    pub multipoles: u64,
}

/// The Sun on a circular orbit as seen from the primary.
#[derive(Debug, Clone, Copy)]
struct Sunlight {
    mean_motion: f64,
    obliquity: f64,
    /// GM of the Sun over the cube of its distance, 1/s^2; 0 without tide.
    tide: f64,
    /// Radiation pressure times C_R, Pa; 0 without it.
    pressure_pa: f64,
}

impl Field {
    pub fn new(primary: &Primary, options: &TrackOptions) -> Result<Self, ShedError> {
        let mascons = Mascons::new(&primary.spheres)?;
        let multipole = Multipole::new(&mascons, options.multipole_error);
        let sunlight = |sun: &Sun| {
            let distance_m = options.semimajor_axis_au * AU_M;
            let tide = GM_SUN / distance_m.powi(3);
            let pressure = SOLAR_PRESSURE_PA / options.semimajor_axis_au.powi(2);
            Sunlight {
                mean_motion: tide.sqrt(),
                obliquity: sun.obliquity,
                tide: if sun.tide { tide } else { 0.0 },
                pressure_pa: sun.radiation_pressure_coefficient.unwrap_or(0.0) * pressure,
            }
        };
        let sun = options.sun.as_ref().map(sunlight);
        Ok(Self { mascons, multipole, spin_rate: primary.spin_rate, sun, evaluations: Evaluations::default() })
    }

    /// Distance beyond which multipoles stand for the mascons, m.
    pub fn switch_radius_m(&self) -> f64 {
        self.multipole.switch_radius_m()
    }

    /// A point of inertial axes in those of the body at `t_s`.
    pub fn to_body(&self, t_s: f64, point: [f64; 3]) -> [f64; 3] {
        turned(point, (self.spin_rate * t_s).sin_cos(), -1.0)
    }

    /// Jacobi constant of a position (m) and velocity (m/s) in inertial axes, m^2/s^2.
    pub fn jacobi_constant(&self, t_s: f64, position: [f64; 3], velocity: [f64; 3]) -> f64 {
        let potential = self.mascons.potential(self.to_body(t_s, position));
        0.5 * dot(velocity, velocity) + potential - self.spin_rate * cross(position, velocity)[2]
    }

    /// Attraction of the primary at a point of inertial axes, m/s^2.
    pub fn attraction(&mut self, t_s: f64, point: [f64; 3]) -> [f64; 3] {
        let turn = (self.spin_rate * t_s).sin_cos();
        let at = turned(point, turn, -1.0);
        let pull = match self.multipole.acceleration(at) {
            Some(pull) => {
                self.evaluations.multipoles += 1;
                pull
            }
            None => {
                self.evaluations.mascons += 1;
                self.mascons.acceleration(at)
            }
        };
        turned(pull, turn, 1.0)
    }
}

impl Force for Field {
    fn add(&mut self, t_s: f64, particles: &mut [reb_particle]) {
        // The primary stays at the origin: what it feels is taken off every body.
        let mut recoil = [0.0; 3];
        for particle in particles.iter_mut() {
            let pull = self.attraction(t_s, [particle.x, particle.y, particle.z]);
            push(particle, pull);
            for (recoil, pull) in recoil.iter_mut().zip(pull) {
                *recoil += particle.m * pull * pkd::constants::G / self.mascons.gm;
            }
        }
        let sun = self.sun.map(|sun| (sun, sun.direction(t_s)));
        for particle in particles {
            push(particle, recoil);
            if let Some((sun, direction)) = &sun {
                push(particle, sun.acceleration(*direction, particle));
            }
        }
    }
}

impl Sunlight {
    /// Direction to the Sun in the axes of the equator and equinox: at the equinox when t = 0.
    fn direction(&self, t_s: f64) -> [f64; 3] {
        let (sin, cos) = (self.mean_motion * t_s).sin_cos();
        [cos, self.obliquity.cos() * sin, self.obliquity.sin() * sin]
    }

    fn acceleration(&self, direction: [f64; 3], particle: &reb_particle) -> [f64; 3] {
        let point = [particle.x, particle.y, particle.z];
        let along = 3.0 * dot(point, direction);
        let pressure = self.pressure_pa * std::f64::consts::PI * particle.r * particle.r / particle.m;
        std::array::from_fn(|k| self.tide * (along * direction[k] - point[k]) - pressure * direction[k])
    }
}

fn push(particle: &mut reb_particle, a: [f64; 3]) {
    particle.ax += a[0];
    particle.ay += a[1];
    particle.az += a[2];
}

/// A vector turned about z by an angle (sine, cosine), forwards or backwards.
fn turned([x, y, z]: [f64; 3], (sin, cos): (f64, f64), direction: f64) -> [f64; 3] {
    let sin = direction * sin;
    [cos * x - sin * y, sin * x + cos * y, z]
}
