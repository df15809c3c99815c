//! The numerical knobs of a torque table.

use crate::error::{TacoError, require};
use crate::heat::spin_rates::graded;
use std::f64::consts::TAU;

/// Which obliquities to compute and how finely to sample; the defaults were chosen from measured error curves.
///
/// The rotation itself has no step: the times of sunrise and sunset come from the horizon in closed form, and the arc
/// between them is integrated by Gauss quadrature to 2e-5 or better.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampling {
    /// Obliquities of the table (default: every 5 deg, as Cotto-Figueroa et al. 2015).
    pub obliquities: Obliquities,
    /// Azimuths at which a facet's horizon is known, evenly spaced; a multiple of 8 in [16, 2880] (default: 120). Between
    /// them the horizon is a great circle. On asteroid shapes of 800 to 3200 facets 24, 72, 120 and 240 bins are off by up
    /// to 3, 0.7, 0.4 and 0.3 % of the peak torque. Time and memory of bodies with shadows grow with it.
    pub azimuth_bins: usize,
    /// Solar declinations from the equator to the pole, both included, at which the rotation is averaged; odd, in
    /// [5, 1441] (default: 37), denser near the equator. The southern half is computed as well. On the same shapes 13, 19,
    /// 37 and 73 nodes are off by up to 2.8, 1.2, 0.5 and 0.4 % of the peak torque. Time grows with it.
    pub declination_nodes: usize,
    /// From how many points of a facet shadows and sky are seen: a square number up to 256 (default: 1, the centroid).
    /// The facet is cut into as many congruent triangles, each seen from its centroid. Facets above whose plane nothing
    /// rises take no more time.
    pub facet_samples: usize,
    /// Cells of a rotation in which heat is followed; even, in [16, 1024] (default: 64). Only for surfaces that store heat.
    pub rotation_cells: usize,
    /// Spin rates of the table (default: up to a period of 2 h). A surface that stores no heat ignores them.
    pub spin_rates: SpinRates,
}

/// The spin rates of a table.
#[derive(Debug, Clone, PartialEq)]
pub enum SpinRates {
    /// So many, from 0 (where heat makes no difference) to the largest, spread so that cubics between them serve.
    UpTo {
        /// Largest spin rate, rad/s, in (0, 1].
        max_rad_s: f64,
        /// Number of spin rates, in [2, 100].
        nodes: usize,
    },
    /// These, rad/s, in [0, 1] and ascending.
    ListRadS(Vec<f64>),
}

/// The obliquities of a table.
#[derive(Debug, Clone, PartialEq)]
pub enum Obliquities {
    /// From 0 to 180 deg in steps of this many degrees, which divides 180.
    StepDeg(f64),
    /// These, deg, in [0, 180] and ascending.
    ListDeg(Vec<f64>),
}

impl Default for Sampling {
    fn default() -> Self {
        Self {
            obliquities: Obliquities::StepDeg(5.0),
            azimuth_bins: 120,
            declination_nodes: 37,
            facet_samples: 1,
            rotation_cells: 64,
            spin_rates: SpinRates::default(),
        }
    }
}

impl Default for SpinRates {
    fn default() -> Self {
        Self::UpTo { max_rad_s: TAU / 7200.0, nodes: 11 }
    }
}

impl SpinRates {
    fn validate(&self) -> Result<(), TacoError> {
        match self {
            &Self::UpTo { max_rad_s, nodes } => {
                let ok = max_rad_s > 0.0 && max_rad_s <= 1.0;
                require(ok, "sampling.spin_rates.up_to.max_rad_s", max_rad_s, "(0, 1] rad/s")?;
                require((2..=100).contains(&nodes), "sampling.spin_rates.up_to.nodes", nodes as f64, "[2, 100]")
            }
            Self::ListRadS(list) => {
                let bad = |index, problem| Err(TacoError::BadSpinRates { index, problem });
                if list.is_empty() {
                    return bad(0, "at least one is needed");
                }
                if let Some(index) = list.iter().position(|o| !(0.0..=1.0).contains(o)) {
                    return bad(index, "must be in [0, 1] rad/s");
                }
                if let Some(index) = list.windows(2).position(|w| w[0] >= w[1]) {
                    return bad(index + 1, "must be larger than the one before");
                }
                Ok(())
            }
        }
    }

    /// The spin rates, rad/s, given the thermal parameter at the spin rate of 1 rad/s.
    pub(crate) fn rad_s(&self, unit_theta: f64) -> Vec<f64> {
        match self {
            &Self::UpTo { max_rad_s, nodes } => graded(max_rad_s, unit_theta * max_rad_s.sqrt(), nodes),
            Self::ListRadS(list) => list.clone(),
        }
    }
}

impl Sampling {
    /// The obliquities, deg.
    ///
    /// # Errors
    /// [`TacoError`] if the step does not divide 180, or the list is empty, out of range or not ascending.
    pub fn obliquities_deg(&self) -> Result<Vec<f64>, TacoError> {
        match &self.obliquities {
            Obliquities::StepDeg(step) => {
                let intervals = (180.0 / step).round();
                let divides = (1.0..=18_000.0).contains(&intervals) && (intervals * step - 180.0).abs() < 1e-9;
                require(divides, "sampling.obliquities.step_deg", *step, "a step from 0.01 to 180 that divides 180")?;
                Ok((0..=intervals as usize).map(|k| 180.0 * k as f64 / intervals).collect())
            }
            Obliquities::ListDeg(list) => {
                let bad = |index, problem| Err(TacoError::BadObliquities { index, problem });
                if list.is_empty() {
                    return bad(0, "at least one is needed");
                }
                if let Some(index) = list.iter().position(|o| !(0.0..=180.0).contains(o)) {
                    return bad(index, "must be in [0, 180] deg");
                }
                if let Some(index) = list.windows(2).position(|w| w[0] >= w[1]) {
                    return bad(index + 1, "must be larger than the one before");
                }
                Ok(list.clone())
            }
        }
    }

    /// Refuses impossible values.
    ///
    /// # Errors
    /// [`TacoError`] with the path of the value.
    pub fn validate(&self) -> Result<(), TacoError> {
        self.obliquities_deg()?;
        self.spin_rates.validate()?;
        let cells = self.rotation_cells;
        let ok = cells.is_multiple_of(2) && (16..=1024).contains(&cells);
        require(ok, "sampling.rotation_cells", cells as f64, "an even number in [16, 1024]")?;
        let (bins, nodes) = (self.azimuth_bins, self.declination_nodes);
        let ok = bins.is_multiple_of(8) && (16..=2880).contains(&bins);
        require(ok, "sampling.azimuth_bins", bins as f64, "a multiple of 8 in [16, 2880]")?;
        let ok = !nodes.is_multiple_of(2) && (5..=1441).contains(&nodes);
        require(ok, "sampling.declination_nodes", nodes as f64, "an odd number in [5, 1441]")?;
        let samples = self.facet_samples;
        let ok = (1..=256).contains(&samples) && samples.isqrt().pow(2) == samples;
        require(ok, "sampling.facet_samples", samples as f64, "a square number in [1, 256]")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn default_grid_is_that_of_the_paper() {
        let grid = Sampling::default().obliquities_deg().unwrap();
        assert_eq!((grid.len(), grid[0], grid[1], grid[36]), (37, 0.0, 5.0, 180.0));
    }

    #[test]
    fn impossible_values_are_refused() {
        let with = |obliquities| Sampling { obliquities, ..Sampling::default() };
        for step in [7.0, 0.0, -5.0, f64::NAN, 1e-9, f64::INFINITY] {
            assert!(with(Obliquities::StepDeg(step)).validate().is_err(), "{step}");
        }
        for list in [vec![], vec![181.0], vec![f64::NAN], vec![3.0, 3.0]] {
            assert!(with(Obliquities::ListDeg(list)).validate().is_err());
        }
        assert_eq!(with(Obliquities::ListDeg(vec![171.64])).validate(), Ok(()));
        assert!(Sampling { azimuth_bins: 36, ..Sampling::default() }.validate().is_err());
        assert!(Sampling { declination_nodes: 36, ..Sampling::default() }.validate().is_err());
        for facet_samples in [0, 2, 3, 8, 257, usize::MAX] {
            assert!(Sampling { facet_samples, ..Sampling::default() }.validate().is_err());
        }
        assert_eq!(Sampling { facet_samples: 9, ..Sampling::default() }.validate(), Ok(()));
        assert!(Sampling { rotation_cells: 65, ..Sampling::default() }.validate().is_err());
        let with = |spin_rates| Sampling { spin_rates, ..Sampling::default() };
        for list in [vec![], vec![-1.0], vec![f64::NAN], vec![1e-4, 1e-4]] {
            assert!(with(SpinRates::ListRadS(list)).validate().is_err());
        }
        for (max_rad_s, nodes) in [(0.0, 5), (f64::NAN, 5), (1e-3, 1), (1e-3, 1000)] {
            assert!(with(SpinRates::UpTo { max_rad_s, nodes }).validate().is_err());
        }
        assert_eq!(with(SpinRates::ListRadS(vec![0.0, 3e-4])).validate(), Ok(()));
    }
}
