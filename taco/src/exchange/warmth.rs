//! The heat that facets conduct into the ground while they light and warm one another.
//!
//! Each pass solves the balance of every facet that takes part, with the sunlight of its cells of local time and the
//! harmonics of what comes from other facets; [`Coupling`] then finds what that changes. Passes end when what a facet
//! absorbs no longer changes; the next change is of second order and is taken into account without a pass.

use super::Exchange;
use super::coupling::{Coupling, Optics};
use super::harmonics::{Harmonics, Phases, TERMS};
use crate::facets::Facet;
use crate::heat::conduction::Conduction;
use crate::heat::insolation::CellFlux;
use rayon::prelude::*;

/// Passes end when no facet's absorbed flux changes by more than this fraction of the beam's.
const SETTLED: f32 = 5e-4;
/// Passes at most.
const PASSES: usize = 8;

/// Sunlight on facets: a state for each thread, and the fluxes of a facet at all declinations, cells from local midnight on.
pub(crate) trait Sunlight: Sync {
    type State;
    fn state(&self) -> Self::State;
    fn look(&self, state: &mut Self::State, facet: usize, out: &mut CellFlux);
}

/// The members of an exchange under a Sun at any of some declinations.
pub(crate) struct Warmth<'a, S> {
    exchange: &'a Exchange,
    facets: &'a [Facet],
    sunlight: &'a S,
    cells: usize,
    declinations: usize,
    coupling: Coupling<'a>,
}

/// First harmonics of the flux into the ground, per unit flux of the beam.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Conducted {
    declinations: usize,
    /// `[member][declination]`: means of it times the cosine and times the sine of the hour angle of the Sun.
    harmonics: Vec<[f32; 2]>,
}

impl Conducted {
    /// At all declinations, for a facet's place among the members.
    pub fn of(&self, member: usize) -> &[[f32; 2]] {
        &self.harmonics[member * self.declinations..(member + 1) * self.declinations]
    }
}

impl<'a, S: Sunlight> Warmth<'a, S> {
    /// For `declinations` declinations and `cells` cells of local time.
    pub fn new(
        exchange: &'a Exchange,
        facets: &'a [Facet],
        sunlight: &'a S,
        [declinations, cells]: [usize; 2],
        optics: Optics,
    ) -> Self {
        let harmonics = Harmonics::new(cells);
        let analyse = |(state, flux): &mut (S::State, CellFlux), facet: &u32| {
            let facet = *facet as usize;
            sunlight.look(state, facet, flux);
            let phases = Phases::new(&facets[facet]);
            let terms = |cells_of: &[f64]| -> Vec<f32> {
                cells_of.chunks_exact(cells).flat_map(|day| harmonics.of(day, &phases).map(|t| t as f32)).collect()
            };
            [terms(&flux.absorbed), terms(&flux.reflected)]
        };
        let state = || (sunlight.state(), CellFlux::default());
        let terms: Vec<[Vec<f32>; 2]> = exchange.members.facets.par_iter().map_init(state, analyse).collect();
        let all = |c: usize| terms.iter().flat_map(|t| &t[c]).copied().collect();
        let coupling = Coupling::new(&exchange.views, &exchange.members, optics, all(0), all(1));
        Self { exchange, facets, sunlight, cells, declinations, coupling }
    }

    /// What the members conduct at a thermal parameter, each balance solved to `tolerance` of its mean flux. What was
    /// found for another parameter is where it starts from.
    pub fn conducted(&mut self, theta: f64, tolerance: f64) -> Conducted {
        if theta == 0.0 {
            let harmonics = vec![[0.0; 2]; self.exchange.members.facets.len() * self.declinations];
            return Conducted { declinations: self.declinations, harmonics };
        }
        self.coupling.settle(theta);
        for _ in 0..PASSES {
            let off = self.pass(theta, tolerance);
            let change = self.coupling.correct(&off);
            self.coupling.settle(theta);
            if change <= SETTLED {
                break;
            }
        }
        let Self { exchange, facets, declinations, coupling, .. } = self;
        let members = &exchange.members.facets;
        let harmonics: Vec<Vec<[f32; 2]>> = (0..members.len())
            .into_par_iter()
            .map_init(
                || vec![0.0; *declinations * TERMS],
                |absorbed, member| {
                    coupling.absorbed(member, absorbed);
                    let phases = Phases::new(&facets[members[member] as usize]);
                    let first = |(declination, absorbed): (usize, &[f32])| {
                        let mut terms = coupling.conducted(theta, member, declination, absorbed);
                        phases.on_local_clock(&mut terms);
                        // The hour angle is half a turn less the local time from midnight.
                        [-terms[1] as f32, -terms[2] as f32]
                    };
                    absorbed.chunks_exact(TERMS).enumerate().map(first).collect()
                },
            )
            .collect();
        Conducted { declinations: *declinations, harmonics: harmonics.concat() }
    }

    /// How far the coupling is off what the members conduct, `[member][declination][term]`.
    fn pass(&self, theta: f64, tolerance: f64) -> Vec<f32> {
        let Self { exchange, facets, sunlight, cells, declinations, coupling } = self;
        let harmonics = Harmonics::new(*cells);
        let members = &exchange.members.facets;
        let state = || {
            let buffers = (vec![0.0f32; declinations * TERMS], vec![0.0; *cells], vec![0.0; *cells]);
            (sunlight.state(), CellFlux::default(), Conduction::new(*cells), buffers)
        };
        let solve = |(state, flux, conduction, buffers): &mut (S::State, CellFlux, Conduction, _), member: usize| {
            let (absorbed, day, temperature): &mut (Vec<f32>, Vec<f64>, Vec<f64>) = buffers;
            let facet = members[member] as usize;
            sunlight.look(state, facet, flux);
            coupling.absorbed(member, absorbed);
            let phases = Phases::new(&facets[facet]);
            let direct = coupling.direct(member).chunks_exact(TERMS);
            temperature.fill(0.0);
            let mut off = Vec::with_capacity(absorbed.len());
            for (j, (absorbed, direct)) in absorbed.chunks_exact(TERMS).zip(direct).enumerate() {
                day.copy_from_slice(&flux.absorbed[j * cells..(j + 1) * cells]);
                let from_others = std::array::from_fn(|n| f64::from(absorbed[n] - direct[n]));
                harmonics.add_to(from_others, &phases, day);
                // A truncated series may dip below zero in the dark.
                day.iter_mut().for_each(|f| *f = f.max(0.0));
                conduction.solve(theta, day, tolerance, temperature);
                let conducted = harmonics.of(conduction.conducted(), &phases);
                let expected = coupling.conducted(theta, member, j, absorbed);
                off.extend(conducted.iter().zip(expected).map(|(c, e)| (c - e) as f32));
            }
            off
        };
        (0..members.len()).into_par_iter().map_init(state, solve).collect::<Vec<_>>().concat()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::day::Day;
    use crate::declination::Declinations;
    use crate::facets::facets;
    use crate::heat::insolation::Cells;
    use crate::horizon::HorizonMap;
    use crate::recoil::LambertRecoil;
    use crate::scanner::Scanner;
    use crate::surface::SelfHeating;
    use crate::test_bodies::rugged;
    use std::f64::consts::PI;

    const CELLS: usize = 48;

    struct Shone<'a> {
        kernel: LambertRecoil,
        declinations: Declinations,
        facets: &'a [Facet],
        map: &'a HorizonMap,
    }

    impl<'a> Sunlight for &'a Shone<'a> {
        type State = Day<'a, LambertRecoil>;

        fn state(&self) -> Self::State {
            Day::new(&self.kernel, &self.declinations)
        }

        fn look(&self, state: &mut Self::State, facet: usize, out: &mut CellFlux) {
            state.cell_means(&self.facets[facet], self.map.horizon(facet), &Cells::new(CELLS), out);
        }
    }

    /// All facets on one clock, exchange and balances in turns until nothing changes; first harmonics of the conducted flux, `[facet][declination]`.
    fn brute_force(shone: &Shone, exchange: &Exchange, optics: Optics, theta: f64) -> Vec<Vec<[f64; 2]>> {
        let Shone { kernel, declinations, facets, map } = shone;
        let n = facets.len();
        let mut out = vec![Vec::new(); n];
        let mut day = Day::new(kernel, declinations);
        let lit: Vec<CellFlux> = (0..n)
            .map(|f| {
                let [mx, my] = facets[f].meridian;
                let mut flux = CellFlux::default();
                let clock = Cells::starting_at(CELLS, PI - my.atan2(mx));
                day.cell_means(&facets[f], map.horizon(f), &clock, &mut flux);
                flux
            })
            .collect();
        let times = |flux: &[Vec<f64>]| -> Vec<Vec<f64>> {
            let sum = |f: usize, k: usize| {
                exchange.views.rows[f].iter().map(|s| f64::from(s.fractions[0]) * flux[s.facet as usize][k]).sum()
            };
            (0..n).map(|f| (0..CELLS).map(|k| sum(f, k)).collect()).collect()
        };
        let albedo = optics.diffuse_albedo;
        for j in 0..declinations.len() {
            let at = |flux: &[f64]| flux[j * CELLS..(j + 1) * CELLS].to_vec();
            let (a, b): (Vec<_>, Vec<_>) = lit.iter().map(|l| (at(&l.absorbed), at(&l.reflected))).unzip();
            let mix = |x: &[Vec<f64>], factor: f64, y: &[Vec<f64>]| -> Vec<Vec<f64>> {
                let row = |(x, y): (&Vec<f64>, &Vec<f64>)| x.iter().zip(y).map(|(x, y)| x + factor * y).collect();
                x.iter().zip(y).map(row).collect()
            };
            let mut visible = b.clone();
            for _ in 0..30 {
                visible = mix(&b, albedo, &times(&visible));
            }
            let absorbed = mix(&a, 1.0 - albedo, &times(&visible));
            let mut leaving = absorbed.clone();
            let mut temperature = vec![vec![0.0; CELLS]; n];
            let mut conducted = temperature.clone();
            let mut conduction = Conduction::new(CELLS);
            for _ in 0..40 {
                let arriving = times(&leaving);
                let all = mix(&absorbed, optics.emissivity, &arriving);
                for f in 0..n {
                    conduction.solve(theta, &all[f], 1e-6, &mut temperature[f]);
                    conducted[f].copy_from_slice(conduction.conducted());
                }
                leaving = mix(&mix(&absorbed, 1.0, &arriving), -1.0, &conducted);
            }
            for f in 0..n {
                // Cell k is at the angle 2 pi (k + 1/2) / CELLS of the body's clock.
                let mut terms =
                    Harmonics::new(CELLS).of(&conducted[f], &Phases::new(&Facet { meridian: [1.0, 0.0], ..facets[f] }));
                Phases::new(&facets[f]).on_local_clock(&mut terms);
                out[f].push([-terms[1], -terms[2]]);
            }
        }
        out
    }

    #[test]
    fn conducted_heat_is_that_of_exchange_and_balances_in_turns() {
        let mesh = rugged(30);
        let facets = facets(&mesh).unwrap();
        let scanner = Scanner::new(&mesh, 64);
        let map = HorizonMap::of(&facets, &scanner);
        let exchange = Exchange::new(&facets, &scanner, &map, SelfHeating::Multiple).unwrap();
        let kernel = LambertRecoil { albedo: 0.4 };
        let shone = Shone { kernel, declinations: Declinations::new(3), facets: &facets, map: &map };
        let optics = Optics { diffuse_albedo: 0.4, emissivity: 0.8, mode: SelfHeating::Multiple };
        let sunlight = &shone;
        let mut warmth = Warmth::new(&exchange, &facets, &sunlight, [shone.declinations.len(), CELLS], optics);
        // From one parameter to the next, as along a table.
        for theta in [0.1, 3.0, 0.5] {
            let conducted = warmth.conducted(theta, 1e-6);
            let expected = brute_force(&shone, &exchange, optics, theta);
            let (mut worst, mut largest, mut alone) = (0.0f64, 0.0f64, 0.0f64);
            let mut day = Day::new(&shone.kernel, &shone.declinations);
            let mut flux = CellFlux::default();
            for (member, f) in exchange.members.facets.iter().map(|f| *f as usize).enumerate() {
                day.cell_means(&facets[f], map.horizon(f), &Cells::new(CELLS), &mut flux);
                for (j, (got, want)) in conducted.of(member).iter().zip(&expected[f]).enumerate() {
                    let mut conduction = Conduction::new(CELLS);
                    conduction.solve(theta, &flux.absorbed[j * CELLS..(j + 1) * CELLS], 1e-6, &mut [0.0; CELLS]);
                    let without = conduction.conducted_harmonic();
                    // From the middle of cell 0 in direction of time to the hour angle.
                    let (s, c) = Cells::new(CELLS).first_middle().sin_cos();
                    let without = [without[0] * c + without[1] * s, without[0] * s - without[1] * c];
                    for k in 0..2 {
                        worst = worst.max((f64::from(got[k]) - want[k]).abs());
                        largest = largest.max(want[k].abs());
                        alone = alone.max((without[k] - want[k]).abs());
                    }
                }
            }
            println!("theta {theta}: off {worst:e}, of {largest}, exchange changes it by {alone}");
            assert!(worst < 0.03 * alone && alone > 0.05 * largest, "{theta}: {worst} {alone} {largest}");
        }
    }
}
