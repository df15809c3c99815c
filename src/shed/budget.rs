//! Who got the mass and the angular momentum of what was shed.

use super::mascons::cross;
use super::{Fate, ShedBody};

/// Mass and angular momentum about the primary's centre.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Share {
    /// Shed bodies, of those given (those that merged count where they merged into).
    pub bodies: usize,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Orbital and spin angular momentum, kg m^2/s.
    pub angular_momentum: [f64; 3],
}

/// Where the mass and the angular momentum that was shed went; the parts add up to `shed`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Budget {
    /// At the start.
    pub shed: Share,
    /// What fell back onto the primary.
    pub reimpact: Share,
    /// What escaped.
    pub escape: Share,
    /// What is still in orbit.
    pub bound: Share,
    /// What the primary took up through its gravity (the torque it felt over time, and the Sun's if it acts), kg m^2/s.
    pub torque_on_primary: [f64; 3],
}

/// Angular momentum of a body about the primary's centre, kg m^2/s.
fn angular_momentum(body: &ShedBody) -> [f64; 3] {
    let orbital = cross(body.position, body.velocity);
    let inertia = 0.4 * body.radius * body.radius;
    std::array::from_fn(|k| body.mass * (orbital[k] + inertia * body.spin[k]))
}

impl Share {
    pub(super) fn add(&mut self, body: &ShedBody, bodies: usize) {
        self.bodies += bodies;
        self.mass_kg += body.mass;
        for (sum, l) in self.angular_momentum.iter_mut().zip(angular_momentum(body)) {
            *sum += l;
        }
    }
}

impl Budget {
    /// Enters a body, made of `bodies` of those given, at its end.
    pub(super) fn enter(&mut self, fate: &Fate, body: &ShedBody, bodies: usize) {
        match fate {
            Fate::Reimpact { .. } => self.reimpact.add(body, bodies),
            Fate::Escape { .. } => self.escape.add(body, bodies),
            Fate::Bound { .. } => self.bound.add(body, bodies),
            Fate::Merged { .. } => {}
        }
    }

    /// The rest of the angular momentum went to the primary.
    pub(super) fn close(&mut self) {
        let ends = [&self.reimpact, &self.escape, &self.bound].map(|share| share.angular_momentum);
        self.torque_on_primary =
            std::array::from_fn(|k| self.shed.angular_momentum[k] - ends.iter().map(|l| l[k]).sum::<f64>());
    }
}
