//! The evolution as a random walk: how fast each interval changes spin and obliquity, and whether it goes on as before.
//!
//! Source: Cotto-Figueroa et al. (2015), ApJ 803, 25, equations 5 and 6: alpha_s = ±|d omega/d t|, zeta_s = ±|d epsilon/d t|,
//! positive where an interval between two movements has the sign of the one before; Figure 17.

use super::distribution::Distribution;
use super::series::{Quantity, Segment};
use crate::evolve::driver::MYR_S;

/// An interval between two movements.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Interval {
    /// Number of the shape.
    pub configuration: u32,
    /// Start, Myr.
    pub from_myr: f64,
    /// Length, Myr.
    pub length_myr: f64,
    /// Spin rate at start and end, revolutions a day.
    pub spin_rev_day: [f64; 2],
    /// Obliquity at start and end, deg.
    pub obliquity_deg: [f64; 2],
    /// alpha_s, revolutions a day and Myr; `None` where there is no sign to compare with.
    pub alpha_s: Option<f64>,
    /// zeta_s, degrees a Myr; likewise.
    pub zeta_s: Option<f64>,
}

/// The random walk of a run.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Walk {
    /// The intervals that a movement has closed.
    pub intervals: Vec<Interval>,
    /// Their lengths, Myr.
    pub length_myr: Distribution,
    /// Share of the intervals whose spin goes on as in the one before; `None` before the second.
    pub spin_persistence: Option<f64>,
    /// Likewise of the obliquity.
    pub obliquity_persistence: Option<f64>,
}

impl Walk {
    /// Of closed intervals in order of time.
    pub fn of(intervals: &[Segment]) -> Self {
        let lengths: Vec<f64> = intervals.iter().map(|i| i.duration_s() / MYR_S).collect();
        let signed = |quantity: Quantity| {
            let changes = intervals.iter().map(|i| quantity.of(i)).map(|[before, after]| after - before);
            signed_rates(&changes.collect::<Vec<_>>(), &lengths)
        };
        let (alpha, zeta) = (signed(Quantity::Spin), signed(Quantity::Obliquity));
        let rows = intervals.iter().enumerate().map(|(k, i)| Interval {
            configuration: i.configuration,
            from_myr: i.t_s[0] / MYR_S,
            length_myr: lengths[k],
            spin_rev_day: Quantity::Spin.of(i),
            obliquity_deg: Quantity::Obliquity.of(i),
            alpha_s: alpha[k],
            zeta_s: zeta[k],
        });
        Self {
            intervals: rows.collect(),
            length_myr: Distribution::of(lengths.iter().copied()),
            spin_persistence: persistence(&alpha),
            obliquity_persistence: persistence(&zeta),
        }
    }
}

/// |change| / duration of each interval, positive where its change has the sign of the last change before it that was
/// not zero, negative where it has the other one. An interval without change goes on as before (+0). `None` where
/// nothing has changed before, and of an interval without length.
///
/// # Panics
/// If the arrays differ in length.
///
/// # Examples
/// ```
/// use yorp::classify::signed_rates;
/// assert_eq!(signed_rates(&[1.0, 2.0, -3.0], &[1.0, 2.0, 1.0]), [None, Some(1.0), Some(-3.0)]);
/// ```
pub fn signed_rates(changes: &[f64], durations: &[f64]) -> Vec<Option<f64>> {
    assert_eq!(changes.len(), durations.len(), "one duration for each change");
    let mut before = 0.0;
    let rate = |(&change, &duration): (&f64, &f64)| {
        let sign = if change == 0.0 { before } else { change.signum() };
        let comparable = before != 0.0 && duration > 0.0;
        let rate = comparable.then(|| sign * before * change.abs() / duration);
        before = sign;
        rate
    };
    changes.iter().zip(durations).map(rate).collect()
}

/// Share of the rates that are not negative; `None` without any.
pub fn persistence(rates: &[Option<f64>]) -> Option<f64> {
    let signed = || rates.iter().flatten();
    let all = signed().count();
    (all > 0).then(|| signed().filter(|rate| rate.is_sign_positive()).count() as f64 / all as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_alternating_series_has_only_negative_rates_and_a_monotone_one_only_positive() {
        let alternating: Vec<f64> = (0..20).map(|k| if k % 2 == 0 { 0.3 } else { -0.2 }).collect();
        let rates = signed_rates(&alternating, &[0.01; 20]);
        assert_eq!(rates[0], None);
        assert!(rates[1..].iter().all(|r| r.is_some_and(|r| r < 0.0)), "{rates:?}");
        assert_eq!(persistence(&rates), Some(0.0));
        for sign in [1.0, -1.0] {
            let rates = signed_rates(&[sign; 20], &[0.01; 20]);
            assert!(rates[1..].iter().all(|r| r.is_some_and(|r| r > 0.0)), "{rates:?}");
            assert_eq!(persistence(&rates), Some(1.0));
        }
    }

    #[test]
    fn no_change_carries_the_sign_on() {
        let rates = signed_rates(&[0.0, 1.0, 0.0, 2.0, 0.0, -4.0], &[2.0; 6]);
        assert_eq!(rates, [None, None, Some(0.0), Some(1.0), Some(0.0), Some(-2.0)]);
        assert_eq!(persistence(&rates), Some(0.75));
    }

    #[test]
    fn nothing_has_no_persistence() {
        assert_eq!((persistence(&[]), persistence(&[None])), (None, None));
        assert!(signed_rates(&[], &[]).is_empty());
    }

    #[test]
    fn rates_are_in_revolutions_a_day_and_degrees_a_myr() {
        let day = crate::evolve::rigid::REV_PER_DAY;
        let interval = |k: f64, configuration| Segment {
            t_s: [k * MYR_S, (k + 1.0) * MYR_S],
            omega: [(4.0 + k) * day, (5.0 + k) * day],
            obliquity: [k * 0.1, (k + 1.0) * 0.1],
            configuration,
        };
        let walk = Walk::of(&[interval(0.0, 0), interval(1.0, 1)]);
        let last = walk.intervals[1];
        assert!(
            (last.alpha_s.unwrap() - 1.0).abs() < 1e-12 && (last.zeta_s.unwrap() - 0.1_f64.to_degrees()).abs() < 1e-12
        );
        assert_eq!((walk.length_myr.count, last.length_myr), (2, 1.0));
    }
}
