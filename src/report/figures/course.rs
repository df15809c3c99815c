//! Spin and obliquity within a long leg and along the rigid curve, followed again with the torques on record: a database
//! holds the ends of a leg and samples of the curve only.

use crate::classify::Segment;
use crate::evolve::configuration::Shape;
use crate::evolve::spin::{Integrator, LegLimits, SpinState, TorqueFunction, YEAR_S, follow_leg};
use crate::report::RunData;
use crate::store::RigidRecord;

/// A leg that turns the spin axis by less is a straight line on paper, rad.
const STRAIGHT: f64 = 0.02;
/// Points drawn within a leg.
const POINTS: f64 = 24.0;
/// Points drawn along the rigid curve.
const RIGID_POINTS: f64 = 400.0;

/// States between the ends of a leg; none of a leg that is straight on paper.
pub(super) fn within(run: &RunData, leg: &Segment) -> Vec<SpinState> {
    let record = run.configurations.get(leg.configuration as usize);
    let (Some(record), true) = (record, (leg.obliquity[1] - leg.obliquity[0]).abs() > STRAIGHT) else {
        return Vec::new();
    };
    // A leg that was recorded can be followed; of one that cannot, the ends are drawn.
    let Ok(shape) = Shape::from_record(&run.scene, record.clone()) else { return Vec::new() };
    follow(&shape.torque, shape.inertia(), leg, run.scene.evolution.rk4_step_yr * YEAR_S, leg.duration_s() / POINTS)
}

/// The rigid curve until `end_s`: between two samples far apart it is followed with the torques of the first configuration,
/// so that it lies on the aggregate's own curve until the first movement.
pub(super) fn rigid(run: &RunData, end_s: f64) -> Vec<SpinState> {
    let state = |r: &RigidRecord| SpinState { t_s: r.t_s, omega: r.omega, obliquity: r.obliquity };
    let samples: Vec<SpinState> = run.rigid.iter().map(state).collect();
    let first = run.configurations.first().and_then(|c| Shape::from_record(&run.scene, c.clone()).ok());
    let Some(first) = first else { return samples };
    let spacing = end_s.min(samples.last().map_or(0.0, |s| s.t_s)) / RIGID_POINTS;
    let mut curve: Vec<SpinState> = samples.first().copied().into_iter().collect();
    for pair in samples.windows(2).take_while(|pair| pair[0].t_s < end_s) {
        let [from, to] = [pair[0], pair[1]];
        if to.t_s - from.t_s > spacing && spacing > 0.0 {
            let between = Segment {
                t_s: [from.t_s, to.t_s],
                omega: [from.omega, to.omega],
                obliquity: [from.obliquity, to.obliquity],
                configuration: 0,
            };
            let step_s = run.scene.evolution.rk4_step_yr * YEAR_S;
            curve.extend(follow(&first.torque, first.inertia(), &between, step_s, spacing));
        }
        curve.push(to);
    }
    curve
}

/// States within `leg`, `spacing` (s) apart or more.
fn follow<T: TorqueFunction>(torque: &T, inertia: f64, leg: &Segment, step_s: f64, spacing: f64) -> Vec<SpinState> {
    let limits = LegLimits {
        spin_change: f64::INFINITY,
        integrator: Integrator::Rk4 { step_s },
        stop_period_s: None,
        end_state_fraction: None,
        ..LegLimits::until(leg.t_s[1])
    };
    let start = SpinState { t_s: leg.t_s[0], omega: leg.omega[0], obliquity: leg.obliquity[0] };
    let (mut states, mut next) = (Vec::new(), leg.t_s[0] + spacing);
    let _ = follow_leg(torque, inertia, start, &limits, &mut |step| {
        let state = step.at(1.0);
        if state.t_s >= next && state.t_s < leg.t_s[1] {
            states.push(state);
            next = state.t_s + spacing;
        }
    });
    states
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Constant torques: the spin rate grows linearly, the obliquity with its logarithm.
    #[test]
    fn states_within_a_leg_lie_on_the_closed_form() {
        let (inertia, spin_up, turn) = (1e18, 1.0, 2.0);
        let end_s = 2e6 * YEAR_S;
        let omega = |t: f64| 1e-4 + spin_up / inertia * t;
        let obliquity = |t: f64| 0.5 + turn / spin_up * (omega(t) / 1e-4).ln();
        let leg = Segment {
            t_s: [0.0, end_s],
            omega: [0.0, end_s].map(omega),
            obliquity: [0.0, end_s].map(obliquity),
            configuration: 0,
        };
        let states = follow(&|_: f64, _: f64| (spin_up, turn), inertia, &leg, 1000.0 * YEAR_S, end_s / POINTS);
        assert!((20..=24).contains(&states.len()), "{}", states.len());
        for s in states {
            assert!(
                (s.omega / omega(s.t_s) - 1.0).abs() < 1e-12 && (s.obliquity - obliquity(s.t_s)).abs() < 1e-9,
                "{s:?}"
            );
        }
    }
}
