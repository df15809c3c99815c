//! Sunlight on a facet as means over equal cells of local time.
//!
//! The lit arcs are cut at the cells' borders and each piece is integrated by two Gauss points, so that no sunrise is
//! rounded to a cell and the mean over the rotation is that of the arcs. Local time runs against the hour angle of
//! [`crate::day`], which is counted towards the east: the Sun rises at positive hour angles.

use crate::recoil::RecoilKernel;
use std::f64::consts::{PI, TAU};

/// Half the distance of the two Gauss points of an interval of length 1.
const GAUSS: f64 = 0.288_675_134_594_812_9;

/// Equal cells of one rotation, in order of time.
#[derive(Debug, Clone)]
pub(crate) struct Cells {
    /// Hour angle of the Sun when cell 0 begins, rad.
    start: f64,
    /// Length of a cell, rad.
    step: f64,
    /// Cosine of the hour angle at the two Gauss points of each cell.
    cosines: Vec<[f64; 2]>,
}

/// Mean fluxes per unit flux of the beam, `[declination][cell]`.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct CellFlux {
    /// `(1 - A_dh) mu0`.
    pub absorbed: Vec<f64>,
    /// `A_dh mu0`.
    pub reflected: Vec<f64>,
}

impl CellFlux {
    /// All dark, for `declinations` times `cells`.
    pub fn reset(&mut self, declinations: usize, cells: usize) {
        for flux in [&mut self.absorbed, &mut self.reflected] {
            flux.clear();
            flux.resize(declinations * cells, 0.0);
        }
    }
}

impl Cells {
    /// `count` cells from local midnight on.
    pub fn new(count: usize) -> Self {
        Self::starting_at(count, PI)
    }

    /// `count` cells, the first of which begins when the Sun is at the hour angle `start` (rad, any): facets that share a
    /// clock have different ones.
    pub fn starting_at(count: usize, start: f64) -> Self {
        let step = TAU / count as f64;
        let at = |x: f64| (start - step * x).cos();
        let cosines = (0..count).map(|k| k as f64 + 0.5).map(|x| [at(x - GAUSS), at(x + GAUSS)]).collect();
        Self { start, step, cosines }
    }

    /// Number of cells in a rotation.
    pub fn count(&self) -> usize {
        self.cosines.len()
    }

    /// Hour angle of the Sun half-way through cell 0, rad.
    pub fn first_middle(&self) -> f64 {
        self.start - 0.5 * self.step
    }

    /// Adds the arc between two hour angles, at most a turn apart, along which `mu0 = a + b cos H`.
    pub fn add<K: RecoilKernel>(
        &self,
        kernel: &K,
        [a, b]: [f64; 2],
        [from, to]: [f64; 2],
        absorbed: &mut [f64],
        reflected: &mut [f64],
    ) {
        let count = self.count();
        let mut add = |cell: usize, weight: f64, cosine: f64| {
            let mu0 = (a + b * cosine).max(0.0);
            let taken = kernel.absorbed(mu0);
            absorbed[cell] += weight * taken;
            reflected[cell] += weight * (mu0 - taken);
        };
        let [begin, end] = [to, from].map(|hour_angle| (self.start - hour_angle) / self.step);
        let first = begin.floor();
        let cells = (end.ceil() - first).max(0.0) as usize;
        let mut cell = first.rem_euclid(count as f64) as usize % count;
        for k in 0..cells {
            let (low, high) = ((first + k as f64).max(begin), (first + (k + 1) as f64).min(end));
            let length = high - low;
            if length == 1.0 {
                let [c0, c1] = self.cosines[cell];
                add(cell, 0.5, c0);
                add(cell, 0.5, c1);
            } else if length > 0.0 {
                for x in [0.5 * (low + high) - GAUSS * length, 0.5 * (low + high) + GAUSS * length] {
                    add(cell, 0.5 * length, (self.start - self.step * x).cos());
                }
            }
            cell = if cell + 1 == count { 0 } else { cell + 1 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recoil::{LambertRecoil, RecoilTable};
    use crate::surface::Hapke;

    /// Mean over the rotation and first harmonic of the cells against the integral over the arc.
    #[test]
    fn cells_hold_the_energy_of_the_arc_wherever_they_begin() {
        let kernel = LambertRecoil { albedo: 0.2 };
        for start in [PI, 0.3, -2.0, 7.0] {
            for [from, to] in [[-1.2, 1.0], [-PI, PI], [-4.0, -1.9], [0.1, 0.1001], [2.0, 2.0]] {
                let cells = Cells::starting_at(96, start);
                let (mut absorbed, mut reflected) = (vec![0.0; 96], vec![0.0; 96]);
                let (a, b) = (0.9, 0.1);
                cells.add(&kernel, [a, b], [from, to], &mut absorbed, &mut reflected);
                let exact = (a * (to - from) + b * (to.sin() - from.sin())) / TAU;
                let mean = |f: &[f64]| f.iter().sum::<f64>() / 96.0;
                assert!((mean(&absorbed) - 0.8 * exact).abs() < 1e-10, "{start} {from} {to}");
                assert!((mean(&reflected) - 0.2 * exact).abs() < 1e-10);
                let middle = |k: usize| cells.first_middle() - TAU * k as f64 / 96.0;
                let sine: f64 = (0..96).map(|k| absorbed[k] * middle(k).sin()).sum::<f64>() / 96.0;
                // int (a + b cos H) sin H
                let exact =
                    0.8 * (a * (from.cos() - to.cos()) + 0.5 * b * (to.sin().powi(2) - from.sin().powi(2))) / TAU;
                assert!((sine - exact).abs() < 2e-4, "{start} {from} {to}: {sine} {exact}");
            }
        }
    }

    #[test]
    fn night_is_dark_and_noon_is_bright() {
        let table = RecoilTable::cached(&Hapke::default());
        let cells = Cells::new(64);
        let (mut absorbed, mut reflected) = (vec![0.0; 64], vec![0.0; 64]);
        cells.add(&*table, [0.0, 1.0], [-0.5 * PI, 0.5 * PI], &mut absorbed, &mut reflected);
        for k in (0..16).chain(48..64) {
            assert!(absorbed[k].abs() < 1e-12 && reflected[k].abs() < 1e-12);
        }
        let noon = table.at(1.0).emitted;
        assert!((absorbed[31] - noon).abs() < 3e-3 && (absorbed[32] - noon).abs() < 3e-3);
        assert!((reflected[32] - (1.0 - noon)).abs() < 3e-3);
    }
}
