//! What it adds to the torque and to the transverse force that heat is emitted later than it was absorbed.
//!
//! Conduction takes from a facet's emission what flows into the ground. That has no mean, so the spin torque is the same as
//! without heat to the last bit; its first harmonic changes the obliquity torque and the force. Only this correction is
//! computed from cells of local time; all else stays with the exact arcs of [`crate::day`].
//!
//! Facets that nothing shades differ in latitude alone: their harmonics come from a table over latitude.

use crate::body::{Body, CHUNK};
use crate::day::{Day, emission_vector};
use crate::declination::Declinations;
use crate::exchange::{Azimuths, Coupled, Scattering};
use crate::facets::Facet;
use crate::heat::conduction::Conduction;
use crate::heat::cubic_weights;
use crate::heat::emission::Emission;
use crate::heat::insolation::{CellFlux, Cells};
use crate::horizon::Horizon;
use crate::recoil::RecoilKernel;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Root mean square of what is left of the energy balance, relative to the mean; the harmonic is good to a tenth of it.
pub(crate) const TOLERANCE: f64 = 1e-4;
/// Latitudes of the table for open facets, from pole to pole; it is made if that many of them are twice as many.
const LATITUDES: usize = 181;

/// Responses per unit pressure of the beam, for one thermal parameter.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Delayed {
    /// Torque along the Sun's equatorial direction at each declination, N m / Pa.
    pub along_sun: Vec<f64>,
    /// Force along the orbital motion at zero obliquity at each declination, N / Pa: all of it, reflected light included.
    pub transverse: Vec<f64>,
}

/// Averages a facet's heat over the rotation; one per thread.
struct Worker<'a, K> {
    day: Day<'a, K>,
    cells: Cells,
    flux: CellFlux,
    conduction: Conduction,
    /// One series a thermal parameter.
    temperature: Vec<f64>,
}

impl Delayed {
    /// The responses of the facets in `chosen` for each thermal parameter in `thetas`, with `cells` cells of local time;
    /// `coupled` has what facets conduct that light and warm one another, for the same parameters.
    pub fn responses<K: RecoilKernel>(
        body: &Body<'_, K>,
        chosen: &[usize],
        declinations: &Declinations,
        thetas: &[f64],
        cells: usize,
        coupled: Option<&Coupled>,
    ) -> Vec<Self> {
        let m = declinations.len();
        let is_open = |f: &&usize| body.shading.is_none_or(|s| s.map.horizon(**f).is_none());
        let open = chosen.iter().filter(is_open).count();
        let table = (open > 2 * LATITUDES).then(|| open_table(body.kernel, declinations, thetas, cells));
        let followed = Scattering(body.kernel);
        let state = || {
            let worker = Worker::new(body.kernel, declinations, thetas.len(), cells);
            (worker, Day::new(&followed, declinations))
        };
        let chunks: Vec<Vec<f64>> = chosen
            .par_chunks(CHUNK)
            .map_init(state, |(worker, followed_day), chunk| {
                let mut sum = vec![0.0; m * (2 * thetas.len() + 1)];
                let (base, rest) = sum.split_at_mut(m);
                for &f in chunk {
                    let wrench = body.wrench(f, Azimuths::All);
                    body.for_each_part(f, |part, horizon, share| {
                        let (shadows, sky) = body.view(horizon);
                        let emission = match &wrench {
                            None => {
                                let emitted = emission_vector(part, &sky);
                                worker.day.add_transverse(part, shadows, emitted, share, base);
                                Emission::new(part, &sky, share)
                            }
                            Some(wrench) => {
                                let emitted = part.local(wrench.momentum);
                                followed_day.add_transverse(part, shadows, emitted, share, base);
                                Emission::followed(part, wrench, share)
                            }
                        };
                        let mut add = |t: usize, j: usize, conducted: [f64; 2]| {
                            let less = conducted.map(|q| -q);
                            rest[2 * (t * m + j)] += emission.along_sun(less);
                            rest[2 * (t * m + j) + 1] += emission.transverse(less);
                        };
                        if let Some(conducted) = coupled.and_then(|c| c.of(f)) {
                            for (t, conducted) in conducted.enumerate() {
                                conducted.iter().enumerate().for_each(|(j, q)| add(t, j, q.map(f64::from)));
                            }
                            return;
                        }
                        match &table {
                            Some(table) if shadows.is_none() => interpolate(table, part, m * thetas.len(), m, add),
                            _ => worker.harmonics(part, shadows, thetas, add),
                        }
                    });
                }
                sum
            })
            .collect();
        let mut sum = vec![0.0; m * (2 * thetas.len() + 1)];
        for chunk in &chunks {
            sum.iter_mut().zip(chunk).for_each(|(s, c)| *s += c);
        }
        let (base, rest) = sum.split_at(m);
        rest.chunks(2 * m)
            .map(|pairs| Self {
                along_sun: pairs.chunks(2).map(|p| p[0]).collect(),
                transverse: pairs.chunks(2).zip(base).map(|(p, b)| b + p[1]).collect(),
            })
            .collect()
    }
}

impl<'a, K: RecoilKernel> Worker<'a, K> {
    fn new(kernel: &'a K, declinations: &'a Declinations, thetas: usize, cells: usize) -> Self {
        Self {
            day: Day::new(kernel, declinations),
            cells: Cells::new(cells),
            flux: CellFlux::default(),
            conduction: Conduction::new(cells),
            temperature: vec![0.0; thetas * cells],
        }
    }

    /// Calls `add(t, j, [cos, sin])` with the means of the conducted flux times cosine and sine of the hour angle.
    fn harmonics(
        &mut self,
        facet: &Facet,
        shadows: Option<&Horizon>,
        thetas: &[f64],
        mut add: impl FnMut(usize, usize, [f64; 2]),
    ) {
        let Self { day, cells, flux, conduction, temperature } = self;
        day.cell_means(facet, shadows, cells, flux);
        let n = cells.count();
        let (sin, cos) = cells.first_middle().sin_cos();
        // Neighbouring declinations are each other's guess; another facet's temperature is none.
        temperature.fill(0.0);
        for (j, absorbed) in flux.absorbed.chunks_exact(n).enumerate() {
            for (t, temperature) in temperature.chunks_exact_mut(n).enumerate() {
                conduction.solve(thetas[t], absorbed, TOLERANCE, temperature);
                let [c, s] = conduction.conducted_harmonic();
                add(t, j, [cos * c + sin * s, sin * c - cos * s]);
            }
        }
    }
}

/// Harmonics of open facets, `[latitude][theta][declination]`.
fn open_table<K: RecoilKernel>(
    kernel: &K,
    declinations: &Declinations,
    thetas: &[f64],
    cells: usize,
) -> Vec<Vec<[f64; 2]>> {
    let m = declinations.len();
    let state = || Worker::new(kernel, declinations, thetas.len(), cells);
    (0..LATITUDES)
        .into_par_iter()
        .map_init(state, |worker, k| {
            let latitude = PI * (k as f64 / (LATITUDES - 1) as f64 - 0.5);
            let mut row = vec![[0.0; 2]; m * thetas.len()];
            worker.harmonics(&Facet::at_latitude(latitude), None, thetas, |t, j, q| row[t * m + j] = q);
            row
        })
        .collect()
}

/// Cubic through the four nearest latitudes.
fn interpolate(
    table: &[Vec<[f64; 2]>],
    facet: &Facet,
    len: usize,
    m: usize,
    mut add: impl FnMut(usize, usize, [f64; 2]),
) {
    let (first, weights) = cubic_weights(facet.latitude(), LATITUDES);
    let rows = &table[first..first + 4];
    for i in 0..len {
        let value = |c: usize| weights.iter().zip(rows).map(|(w, row)| w * row[i][c]).sum();
        add(i / m, i % m, [value(0), value(1)]);
    }
}
