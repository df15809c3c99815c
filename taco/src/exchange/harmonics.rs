//! Fluxes over a rotation as a few harmonics of one clock for the whole body.
//!
//! What other facets send is a sum over many of them, so it is smooth in time, and what it does to the conducted heat is its
//! mean and its first harmonic but for the nonlinearity of emission: [`ORDER`] harmonics carry it. On the body's clock all
//! facets' harmonics add up as they are.

use crate::facets::Facet;
use std::f64::consts::TAU;

/// Highest harmonic kept. Against an exchange of all cells of local time, 3, 5, 8 and 16 are off by the same amount.
pub(crate) const ORDER: usize = 4;
/// Numbers a flux takes: its mean, then real and imaginary part of `<f exp(-i n t)>` for each harmonic.
pub(crate) const TERMS: usize = 2 * ORDER + 1;

/// Turns means over equal cells of a facet's local time, from midnight on, into harmonics of the body's clock and back.
#[derive(Debug)]
pub(crate) struct Harmonics {
    /// `[cell][term]`: `cos n t` and `-sin n t` half-way through the cell, over what the mean over a cell takes off them
    /// and over the number of cells.
    forward: Vec<[f64; TERMS]>,
    /// `[cell][term]`: what a term adds to the mean over the cell.
    inverse: Vec<[f64; TERMS]>,
}

/// How far local time is ahead of the body's clock: `exp(i n longitude)` by harmonic, the longitude that of the normal.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Phases([[f64; 2]; ORDER]);

impl Phases {
    pub fn new(facet: &Facet) -> Self {
        let [c, s] = facet.meridian;
        let mut phases = [[c, s]; ORDER];
        for n in 1..ORDER {
            let [p, q] = phases[n - 1];
            phases[n] = [p * c - q * s, p * s + q * c];
        }
        Self(phases)
    }

    /// Terms of local time on the body's clock.
    pub fn on_body_clock(self, terms: &mut [f64; TERMS]) {
        for ([c, s], pair) in self.0.iter().zip(terms[1..].chunks_exact_mut(2)) {
            let (re, im) = (pair[0], pair[1]);
            (pair[0], pair[1]) = (re * c - im * s, re * s + im * c);
        }
    }

    /// Terms of the body's clock in local time.
    pub fn on_local_clock(self, terms: &mut [f64; TERMS]) {
        for ([c, s], pair) in self.0.iter().zip(terms[1..].chunks_exact_mut(2)) {
            let (re, im) = (pair[0], pair[1]);
            (pair[0], pair[1]) = (re * c + im * s, im * c - re * s);
        }
    }
}

impl Harmonics {
    /// For `cells` cells a rotation, more than twice [`ORDER`].
    pub fn new(cells: usize) -> Self {
        let row = |k: usize, forward: bool| {
            let mut row = [if forward { 1.0 / cells as f64 } else { 1.0 }; TERMS];
            for n in 1..=ORDER {
                let (sin, cos) = (n as f64 * TAU * (k as f64 + 0.5) / cells as f64).sin_cos();
                let half = n as f64 * 0.5 * TAU / cells as f64;
                let smoothing = half.sin() / half;
                let factor = if forward { 1.0 / (smoothing * cells as f64) } else { 2.0 * smoothing };
                (row[2 * n - 1], row[2 * n]) = (factor * cos, -factor * sin);
            }
            row
        };
        let table = |forward| (0..cells).map(|k| row(k, forward)).collect();
        Self { forward: table(true), inverse: table(false) }
    }

    /// Harmonics on the body's clock of these means over cells of local time.
    pub fn of(&self, cells: &[f64], phases: &Phases) -> [f64; TERMS] {
        let mut terms = [0.0; TERMS];
        for (flux, row) in cells.iter().zip(&self.forward) {
            for (term, factor) in terms.iter_mut().zip(row) {
                *term += flux * factor;
            }
        }
        phases.on_body_clock(&mut terms);
        terms
    }

    /// Adds a flux on the body's clock to means over cells of local time.
    pub fn add_to(&self, mut terms: [f64; TERMS], phases: &Phases, cells: &mut [f64]) {
        phases.on_local_clock(&mut terms);
        for (flux, row) in cells.iter_mut().zip(&self.inverse) {
            *flux += terms.iter().zip(row).map(|(term, factor)| term * factor).sum::<f64>();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::facets::facets;
    use crate::test_bodies::rugged;

    #[test]
    fn smooth_fluxes_survive_the_way_to_the_body_and_back() {
        let harmonics = Harmonics::new(48);
        let facets = facets(&rugged(20)).unwrap();
        let cells: Vec<f64> = (0..48)
            .map(|k| TAU * (f64::from(k) + 0.5) / 48.0)
            .map(|t| 1.0 + (t - 0.3).cos() + 0.2 * (3.0 * t).sin())
            .collect();
        for facet in &facets {
            let phases = Phases::new(facet);
            let mut back = vec![0.0; 48];
            harmonics.add_to(harmonics.of(&cells, &phases), &phases, &mut back);
            assert!(cells.iter().zip(&back).all(|(a, b)| (a - b).abs() < 1e-13));
        }
    }

    /// Noon comes later further west: a facet whose normal points to longitude 90 deg has it a quarter turn before one at 0.
    #[test]
    fn facets_in_the_east_are_ahead() {
        let noon: Vec<f64> = (0..64).map(|k| -(TAU * (f64::from(k) + 0.5) / 64.0).cos()).collect();
        let harmonics = Harmonics::new(64);
        let phases = |meridian| Phases::new(&Facet { meridian, ..facets(&rugged(20)).unwrap()[0] });
        let at = |meridian| harmonics.of(&noon, &phases(meridian));
        let (zero, east) = (at([1.0, 0.0]), at([0.0, 1.0]));
        // f(t) = -cos t has the term -1/2; ahead by a quarter turn, f(t + pi/2) = sin t has -i/2.
        assert!((zero[1] + 0.5).abs() < 1e-3 && zero[2].abs() < 1e-12, "{zero:?}");
        assert!(east[1].abs() < 1e-12 && (east[2] + 0.5).abs() < 1e-3, "{east:?}");
    }
}
