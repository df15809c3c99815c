//! What an integration of soft spheres reports.

use super::kernel::Heat;
use super::stiffness::Stiffness;

/// Energy of the spheres and their contacts, J.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Energy {
    /// Kinetic energy of translation and rotation.
    pub kinetic_j: f64,
    /// Mutual gravitation.
    pub gravity_j: f64,
    /// Normal springs, less the work that cohesion does until contacts part.
    pub normal_j: f64,
    /// Sliding springs.
    pub sliding_j: f64,
    /// Rolling springs.
    pub rolling_j: f64,
    /// Twisting springs.
    pub twisting_j: f64,
}

impl Energy {
    pub(super) fn add_springs(&mut self, springs: &Self) {
        self.normal_j += springs.normal_j;
        self.sliding_j += springs.sliding_j;
        self.rolling_j += springs.rolling_j;
        self.twisting_j += springs.twisting_j;
    }

    /// All of it.
    pub fn total_j(&self) -> f64 {
        self.kinetic_j + self.gravity_j + self.normal_j + self.sliding_j + self.rolling_j + self.twisting_j
    }
}

/// The books of energy of a stretch of a run: what was there, what is, and the heat that was made.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Ledger {
    /// At the start.
    pub start: Energy,
    /// At the end.
    pub end: Energy,
    /// Heat of the normal dashpots, J.
    pub normal_dashpot_j: f64,
    /// Heat of the sliding dashpots of contacts that stick, J.
    pub sliding_dashpot_j: f64,
    /// Heat of slipping contacts, and what is left in a sliding spring when spheres part, J.
    pub sliding_slider_j: f64,
    /// As the sliding dashpots, for rolling, J.
    pub rolling_dashpot_j: f64,
    /// As the sliding sliders, for rolling, J; the torques of the directional model are counted here.
    pub rolling_slider_j: f64,
    /// As the sliding dashpots, for twisting, J.
    pub twisting_dashpot_j: f64,
    /// As the sliding sliders, for twisting, J.
    pub twisting_slider_j: f64,
}

impl Ledger {
    pub(super) fn new(start: Energy, end: Energy, heat: &Heat) -> Self {
        Self {
            start,
            end,
            normal_dashpot_j: heat.normal,
            sliding_dashpot_j: heat.sliding_dashpot,
            sliding_slider_j: heat.sliding_slider,
            rolling_dashpot_j: heat.rolling_dashpot,
            rolling_slider_j: heat.rolling_slider,
            twisting_dashpot_j: heat.twisting_dashpot,
            twisting_slider_j: heat.twisting_slider,
        }
    }

    /// All heat made, J.
    pub fn dissipated_j(&self) -> f64 {
        self.normal_dashpot_j
            + self.sliding_dashpot_j
            + self.sliding_slider_j
            + self.rolling_dashpot_j
            + self.rolling_slider_j
            + self.twisting_dashpot_j
            + self.twisting_slider_j
    }

    /// What the books are off by, J: energy at the end and heat, less energy at the start. The error of the integration.
    pub fn residual_j(&self) -> f64 {
        self.end.total_j() + self.dissipated_j() - self.start.total_j()
    }

    /// Adds the books of the stretch that follows.
    fn add(&mut self, later: &Self) {
        self.end = later.end;
        self.normal_dashpot_j += later.normal_dashpot_j;
        self.sliding_dashpot_j += later.sliding_dashpot_j;
        self.sliding_slider_j += later.sliding_slider_j;
        self.rolling_dashpot_j += later.rolling_dashpot_j;
        self.rolling_slider_j += later.rolling_slider_j;
        self.twisting_dashpot_j += later.twisting_dashpot_j;
        self.twisting_slider_j += later.twisting_slider_j;
    }
}

/// What happened in one or several calls.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Report {
    /// Steps taken.
    pub steps: u64,
    /// Simulated time, s.
    pub duration_s: f64,
    /// Time step used last, s.
    pub step_s: f64,
    /// Stiffness used last, and why.
    pub stiffness: Stiffness,
    /// Contacts at the end.
    pub contacts: u64,
    /// Contacts a sphere has at the end, on average: each counts for both of its spheres.
    pub contacts_per_sphere: f64,
    /// Deepest overlap seen, over the smaller radius of the pair.
    pub max_overlap_over_radius: f64,
    /// Change of momentum over the sum of m |v|; of several calls, the sum.
    pub momentum_drift: f64,
    /// Change of angular momentum about the centre of mass over the sum of its spheres' shares; of several calls, the sum.
    pub angular_momentum_drift: f64,
    /// Evaluations of gravity.
    pub gravity_evaluations: u64,
    /// Error of the frozen field, root mean square over that of the field, just before it was renewed and at the end: the largest
    /// seen.
    pub frozen_field_error: f64,
    /// Times the neighbours were listed.
    pub list_rebuilds: u64,
    /// Memory of the integration, in bytes, without the spheres themselves: the most in a call.
    pub bytes: u64,
    /// The books of energy, if they were kept.
    pub ledger: Option<Ledger>,
}

impl Report {
    /// Adds a later stretch of the same run.
    pub fn add(&mut self, later: &Self) {
        let ledger = match (self.ledger, later.ledger) {
            (Some(mut sum), Some(later)) => {
                sum.add(&later);
                Some(sum)
            }
            // The first stretch of all.
            (None, later) if self.steps == 0 => later,
            _ => None,
        };
        *self = Self {
            steps: self.steps + later.steps,
            duration_s: self.duration_s + later.duration_s,
            max_overlap_over_radius: self.max_overlap_over_radius.max(later.max_overlap_over_radius),
            momentum_drift: self.momentum_drift + later.momentum_drift,
            angular_momentum_drift: self.angular_momentum_drift + later.angular_momentum_drift,
            gravity_evaluations: self.gravity_evaluations + later.gravity_evaluations,
            frozen_field_error: self.frozen_field_error.max(later.frozen_field_error),
            list_rebuilds: self.list_rebuilds + later.list_rebuilds,
            bytes: self.bytes.max(later.bytes),
            ledger,
            ..*later
        };
    }

    /// What the books are off by, over the largest of the energies in them; none without books.
    pub fn energy_drift(&self) -> Option<f64> {
        let ledger = self.ledger.as_ref()?;
        let largest = [&ledger.start, &ledger.end]
            .into_iter()
            .flat_map(|e| [e.kinetic_j, e.gravity_j, e.normal_j, e.sliding_j, e.rolling_j, e.twisting_j])
            .fold(0.0_f64, |most, e| most.max(e.abs()));
        Some(if largest > 0.0 { ledger.residual_j() / largest } else { 0.0 })
    }
}
