//! Mass-loss events: how much left, at which spin, from which shape, and what loose material would have borne.
//!
//! Source: Cotto-Figueroa et al. (2015), ApJ 803, 25, section 3.3, Table 4 and Figure 12. An event is one leg whose check
//! shed something. Limits of loose material: Harris (1996), Lunar Planet. Sci. 27, 493.

use super::distribution::Distribution;
use super::sequences::JacobiSequence;
use super::shape::Proportions;
use crate::evolve::driver::MYR_S;
use crate::evolve::rigid::{REV_PER_DAY, sphere_limit};
use crate::report::RunData;

/// Spin rate, rad/s, at which loose material floats off the ends of a prolate body with that ratio of the axes in its
/// equator: slower than off a sphere by the ratio's root, the approximation behind Table 4.
pub fn prolate_limit(density_kg_m3: f64, b_over_a: f64) -> f64 {
    sphere_limit(density_kg_m3) * b_over_a.sqrt()
}

/// One event of mass loss.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct LossEvent {
    /// When, Myr.
    pub t_myr: f64,
    /// Spheres that left.
    pub spheres: usize,
    /// Their mass, percent of the initial body.
    pub mass_percent: f64,
    /// Spin rate, revolutions a day.
    pub spin_rev_day: f64,
    /// Bulk density of the body before, by the hull of its spheres (B3), kg/m^3.
    pub density_kg_m3: f64,
    /// Axis ratios of the body before, by its half extents (B2).
    pub b_over_a: f64,
    /// See [`Self::b_over_a`].
    pub c_over_a: f64,
    /// Whether that is below the Jacobi sequence in the plane of triaxiality and c/a.
    pub below_jacobi: bool,
    /// Where loose material would leave a sphere of this density, revolutions a day.
    pub sphere_limit_rev_day: f64,
    /// Where it would leave a prolate body of these proportions, revolutions a day.
    pub prolate_limit_rev_day: f64,
    /// Whether the body broke up: its other half is no mass loss.
    pub breakup: bool,
}

/// What became of spheres that left, as far as the scene asked to follow them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
pub struct Fates {
    /// Fell back, whether or not they were put back on the body.
    pub reimpact: usize,
    /// Left for good.
    pub escape: usize,
    /// Still in orbit when the following ended.
    pub bound: usize,
    /// Fell on another shed sphere, and went on with it.
    pub merged: usize,
}

impl Fates {
    /// Of the spheres shed in the run, without those of the settling.
    fn of(run: &RunData) -> Self {
        let count = |name| run.fates.iter().filter(|(leg, f)| leg.is_some() && f.fate == name).count();
        Self { reimpact: count("reimpact"), escape: count("escape"), bound: count("bound"), merged: count("merged") }
    }
}

/// All mass loss of a run.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Losses {
    /// The events in order of time, a final break-up included.
    pub events: Vec<LossEvent>,
    /// Mass that left in all events but a break-up, percent of the initial body.
    pub mass_percent: f64,
    /// Mean time between two events, Myr; `None` below two.
    pub mean_time_between_myr: Option<f64>,
    /// Mass of an event, percent; a break-up left out here and below.
    pub event_mass_percent: Distribution,
    /// Spin rate at the events, revolutions a day.
    pub spin_rev_day: Distribution,
    /// Bulk density (B3) at the events, kg/m^3.
    pub density_kg_m3: Distribution,
    /// b/a (B2) at the events.
    pub b_over_a: Distribution,
    /// What became of the spheres that left.
    pub fates: Fates,
    /// Spheres that left while the body settled, before the run began.
    pub spheres_while_settling: usize,
}

impl Losses {
    /// Of a run so far.
    pub fn of(run: &RunData, jacobi: &JacobiSequence) -> Self {
        let initial: f64 = run.initial_mass_kg();
        let shed = run.losses.iter().filter(|(leg, _)| leg.is_some()).collect::<Vec<_>>();
        let last_leg = run.legs.last().map(|leg| leg.leg);
        let event = |of: &[&(Option<u32>, crate::store::LossRecord)]| {
            let (leg, first) = of[0];
            let leg = run.legs.iter().find(|l| Some(l.leg) == *leg)?;
            let before = run.configurations.get(leg.configuration as usize)?;
            let mass: f64 = of.iter().map(|(_, loss)| run.sphere_mass_kg[loss.sphere as usize]).sum();
            let shape = Proportions::of_half_extents(before);
            Some(LossEvent {
                t_myr: first.t_s / MYR_S,
                spheres: of.len(),
                mass_percent: 100.0 * mass / initial,
                spin_rev_day: first.omega / REV_PER_DAY,
                density_kg_m3: before.densities_kg_m3[2],
                b_over_a: shape.b_over_a,
                c_over_a: shape.c_over_a,
                below_jacobi: jacobi.has_below(shape.b_over_a, shape.c_over_a),
                sphere_limit_rev_day: sphere_limit(before.densities_kg_m3[2]) / REV_PER_DAY,
                prolate_limit_rev_day: prolate_limit(before.densities_kg_m3[2], shape.b_over_a) / REV_PER_DAY,
                breakup: super::broke_up(run) && last_leg == Some(leg.leg),
            })
        };
        let events: Vec<_> = shed.chunk_by(|a, b| a.0 == b.0).filter_map(event).collect();
        let small = || events.iter().filter(|e| !e.breakup);
        let times: Vec<f64> = small().map(|e| e.t_myr).collect();
        let mean_time_between_myr = match times[..] {
            [first, .., last] => Some((last - first) / (times.len() - 1) as f64),
            _ => None,
        };
        Self {
            mass_percent: small().map(|e| e.mass_percent).sum(),
            mean_time_between_myr,
            event_mass_percent: Distribution::of(small().map(|e| e.mass_percent)),
            spin_rev_day: Distribution::of(small().map(|e| e.spin_rev_day)),
            density_kg_m3: Distribution::of(small().map(|e| e.density_kg_m3)),
            b_over_a: Distribution::of(small().map(|e| e.b_over_a)),
            fates: Fates::of(run),
            spheres_while_settling: run.losses.len() - shed.len(),
            events,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Table 4: density (g/cm^3), b/a and the two limits, revolutions a day. Densities and ratios are printed to two digits;
    /// the limits were made from more.
    #[test]
    fn paper_limits_of_loose_material() {
        let rows = [
            (1.42, 8.66, 0.76, 7.55),
            (1.53, 8.99, 0.52, 6.45),
            (1.46, 8.79, 0.91, 8.39),
            (1.48, 8.86, 0.58, 6.72),
            (1.57, 9.13, 0.71, 7.69),
        ];
        for (density, sphere, b_over_a, prolate) in rows {
            let rev_day = |omega: f64| omega / REV_PER_DAY;
            assert!((rev_day(sphere_limit(1000.0 * density)) - sphere).abs() < 0.02, "{density}");
            assert!((rev_day(prolate_limit(1000.0 * density, b_over_a)) - prolate).abs() < 0.04, "{density}");
        }
    }
}
