//! Light between facets that store heat: what each of them absorbs when all temperatures are coupled.
//!
//! With `V` the view factors, `A_d` the albedo for diffuse light and `a`, `b` the sunlight that a facet absorbs and
//! scatters: visible light leaves as `B = b + A_d V B`, so `S = a + (1 - A_d) V B` is absorbed of it. With `e` the
//! emissivity, `q` the flux into the ground and `f = S + e V J` all that is absorbed, infrared leaves as
//! `J = f - q + (1 - e) V J = S - q + V J`. `q` is a nonlinear function of `f` that the caller evaluates facet by facet;
//! between evaluations it is followed by its linear part about the mean temperature,
//! `q_n = theta sqrt(i n) / (4 T0^3 + theta sqrt(i n)) f_n` (Spencer, Lebofsky & Sykes 1989, Icarus 78, 337), so that a few
//! evaluations are enough. Light is followed to the first facet only where single exchange is asked for: `V b` and
//! `V (a - q)` stand for `V B` and `V J`.
//!
//! Fluxes are per unit flux of the beam, as harmonics of the body's clock ([`super::harmonics`]), for all declinations.

use super::Views;
use super::harmonics::TERMS;
use crate::surface::SelfHeating;
use rayon::prelude::*;

/// Rounds end when no flux changes by more than this fraction of the beam's.
const TOLERANCE: f32 = 1e-5;
/// Rounds at most: enough wherever 5 % of the sky are open.
const ROUNDS: usize = 200;

/// One flux of every facet that takes part, at every declination: `[member][declination][term]`.
type Fluxes = Vec<f32>;

/// The coupled surface.
#[derive(Debug)]
pub(crate) struct Coupling<'a> {
    views: &'a Views,
    members: &'a Members,
    /// Numbers a facet takes: declinations times [`TERMS`].
    stride: usize,
    emissivity: f32,
    multiple: bool,
    /// Visible light absorbed, `S`.
    visible: Fluxes,
    /// The same without what came from other facets, `a`.
    direct: Fluxes,
    /// What the linear part of `q` leaves of it.
    rest: Fluxes,
    /// Infrared that leaves, `J` (`a - q` for single exchange).
    leaving: Fluxes,
    scratch: Fluxes,
}

/// Facets that see others or are seen by them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Members {
    /// Facets, ascending.
    pub facets: Vec<u32>,
    /// By facet: its place in the list, or `u32::MAX`.
    place: Vec<u32>,
}

impl Members {
    pub fn new(views: &Views) -> Self {
        let mut place = vec![u32::MAX; views.rows.len()];
        for (row, facet) in views.rows.iter().zip(0..) {
            for member in row.iter().map(|seen| seen.facet).chain((!row.is_empty()).then_some(facet)) {
                place[member as usize] = 0;
            }
        }
        let facets: Vec<u32> = (0..).zip(&place).filter(|(_, p)| **p == 0).map(|(f, _)| f).collect();
        facets.iter().zip(0..).for_each(|(f, k)| place[*f as usize] = k);
        Self { facets, place }
    }

    /// Place of a facet in the list.
    pub fn place(&self, facet: usize) -> Option<usize> {
        Some(self.place[facet]).filter(|p| *p != u32::MAX).map(|p| p as usize)
    }
}

/// Surface properties of the exchange.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Optics {
    /// Fraction of diffuse visible light that is scattered.
    pub diffuse_albedo: f64,
    pub emissivity: f64,
    pub mode: SelfHeating,
}

impl<'a> Coupling<'a> {
    /// From the sunlight that the members absorb and scatter, `[member][declination][term]`.
    pub fn new(views: &'a Views, members: &'a Members, optics: Optics, absorbed: Fluxes, scattered: Fluxes) -> Self {
        let stride = absorbed.len() / members.facets.len().max(1);
        let multiple = optics.mode == SelfHeating::Multiple;
        let albedo = optics.diffuse_albedo as f32;
        let mut coupling = Self {
            views,
            members,
            stride,
            emissivity: optics.emissivity as f32,
            multiple,
            visible: Vec::new(),
            direct: absorbed,
            rest: vec![0.0; scattered.len()],
            leaving: scattered.clone(),
            scratch: vec![0.0; scattered.len()],
        };
        if multiple {
            coupling.rounds(|member, arriving, leaving| {
                let own = &scattered[member * stride..(member + 1) * stride];
                leaving.iter_mut().zip(own).zip(arriving).for_each(|((l, o), a)| *l = o + albedo * a);
            });
        }
        let Self { direct, leaving, .. } = &coupling;
        let visible: Vec<Vec<f32>> = (0..members.facets.len())
            .into_par_iter()
            .map(|member| {
                let mut flux = vec![0.0; stride];
                coupling.arriving(member, leaving, &mut flux);
                let own = &direct[member * stride..(member + 1) * stride];
                flux.iter_mut().zip(own).for_each(|(f, o)| *f = o + (1.0 - albedo) * *f);
                flux
            })
            .collect();
        coupling.visible = visible.concat();
        let start = if multiple { &coupling.visible } else { &coupling.direct };
        coupling.leaving.copy_from_slice(start);
        coupling
    }

    /// `V` times a flux, for one member.
    fn arriving(&self, member: usize, leaving: &[f32], out: &mut [f32]) {
        out.fill(0.0);
        for seen in &*self.views.rows[self.members.facets[member] as usize] {
            // What is seen is a member.
            let at = self.members.place[seen.facet as usize] as usize * self.stride;
            let fraction = seen.fractions[0];
            for (o, l) in out.iter_mut().zip(&leaving[at..at + self.stride]) {
                *o += fraction * l;
            }
        }
    }

    /// Replaces what leaves by a function of what arrives, again and again until it settles.
    fn rounds(&mut self, update: impl Fn(usize, &[f32], &mut [f32]) + Sync) {
        let stride = self.stride;
        for _ in 0..ROUNDS {
            let (leaving, mut next) = (std::mem::take(&mut self.leaving), std::mem::take(&mut self.scratch));
            let changes: Vec<f32> = next
                .par_chunks_mut(stride.max(1))
                .enumerate()
                .map_init(
                    || vec![0.0; stride],
                    |arriving, (member, next)| {
                        self.arriving(member, &leaving, arriving);
                        update(member, arriving, next);
                        let before = &leaving[member * stride..];
                        next.iter().zip(before).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
                    },
                )
                .collect();
            (self.leaving, self.scratch) = (next, leaving);
            if changes.into_iter().fold(0.0, f32::max) <= TOLERANCE {
                break;
            }
        }
    }

    /// Settles the exchange with the flux into the ground as last told, and its linear part from there on.
    pub fn settle(&mut self, theta: f64) {
        let (stride, multiple, emissivity) = (self.stride, self.multiple, self.emissivity);
        let (visible, direct, rest) =
            (std::mem::take(&mut self.visible), std::mem::take(&mut self.direct), std::mem::take(&mut self.rest));
        self.rounds(|member, arriving, leaving| {
            let range = member * stride..(member + 1) * stride;
            for (k, leaving) in leaving.chunks_exact_mut(TERMS).enumerate() {
                let at = range.start + k * TERMS;
                let arriving = &arriving[k * TERMS..(k + 1) * TERMS];
                let absorbed: [f64; TERMS] =
                    std::array::from_fn(|n| f64::from(visible[at + n]) + f64::from(emissivity * arriving[n]));
                let linear = linear_conduction(theta, &absorbed);
                for n in 0..TERMS {
                    let conducted = rest[at + n] + linear[n] as f32;
                    leaving[n] =
                        if multiple { visible[at + n] - conducted + arriving[n] } else { direct[at + n] - conducted };
                }
            }
        });
        (self.visible, self.direct, self.rest) = (visible, direct, rest);
    }

    /// All that a member absorbs after [`Self::settle`], `[declination][term]`.
    pub fn absorbed(&self, member: usize, out: &mut [f32]) {
        self.arriving(member, &self.leaving, out);
        let visible = &self.visible[member * self.stride..(member + 1) * self.stride];
        out.iter_mut().zip(visible).for_each(|(o, v)| *o = v + self.emissivity * *o);
    }

    /// Sunlight that a member absorbs, `[declination][term]`.
    pub fn direct(&self, member: usize) -> &[f32] {
        &self.direct[member * self.stride..(member + 1) * self.stride]
    }

    /// What a member that absorbs `absorbed` at a declination is taken to conduct into the ground.
    pub fn conducted(&self, theta: f64, member: usize, declination: usize, absorbed: &[f32]) -> [f64; TERMS] {
        let mut conducted = linear_conduction(theta, &std::array::from_fn(|n| f64::from(absorbed[n])));
        let rest = &self.rest[member * self.stride + declination * TERMS..];
        conducted.iter_mut().zip(rest).for_each(|(c, r)| *c += f64::from(*r));
        conducted
    }

    /// Takes note of how far off [`Self::conducted`] is, `[member][declination][term]`. Returns by how much that changes what a
    /// facet absorbs, at most.
    pub fn correct(&mut self, by: &[f32]) -> f32 {
        self.rest.par_iter_mut().zip(by).for_each(|(rest, by)| *rest += by);
        let change = |arriving: &mut Vec<f32>, member| {
            self.arriving(member, by, arriving);
            arriving.iter().map(|a| a.abs()).fold(0.0, f32::max)
        };
        let changes: Vec<f32> =
            (0..self.members.facets.len()).into_par_iter().map_init(|| vec![0.0; self.stride], change).collect();
        self.emissivity * changes.into_iter().fold(0.0, f32::max)
    }
}

/// Flux into the ground of a facet that absorbs `flux`, to first order about its mean temperature.
fn linear_conduction(theta: f64, flux: &[f64; TERMS]) -> [f64; TERMS] {
    let mut conducted = [0.0; TERMS];
    if theta == 0.0 || flux[0] <= 0.0 {
        return conducted;
    }
    let root = flux[0].sqrt();
    let slope = 4.0 * root * root.sqrt();
    for n in 1..=TERMS / 2 {
        // With y = theta sqrt(n / 2): y (1 + i) / (slope + y + i y).
        let y = theta * (0.5 * n as f64).sqrt();
        let squared = (slope + y) * (slope + y) + y * y;
        let (re, im) = (y * (slope + 2.0 * y) / squared, y * slope / squared);
        let (f, g) = (flux[2 * n - 1], flux[2 * n]);
        (conducted[2 * n - 1], conducted[2 * n]) = (re * f - im * g, re * g + im * f);
    }
    conducted
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::views::Seen;

    /// Facets of equal area that see each other by these fractions.
    fn views(fractions: &[&[f32]]) -> Views {
        let row = |row: &&[f32]| {
            let seen = (0..).zip(*row).filter(|(_, f)| **f > 0.0);
            seen.map(|(facet, f)| Seen { facet, fractions: [*f; 2] }).collect()
        };
        Views { rows: fractions.iter().map(row).collect() }
    }

    /// A steady flux of each facet, at a single declination.
    fn steady(means: &[f32]) -> Fluxes {
        means.iter().flat_map(|m| std::array::from_fn::<f32, TERMS, _>(|n| if n == 0 { *m } else { 0.0 })).collect()
    }

    fn multiple(diffuse_albedo: f64) -> Optics {
        Optics { diffuse_albedo, emissivity: 0.9, mode: SelfHeating::Multiple }
    }

    /// Light between two plates bounces until it is absorbed: what arrives adds up to 1/(1 - A) of what came in.
    #[test]
    fn parallel_plates_multiply_the_light_by_the_series() {
        let views = views(&[&[0.0, 1.0], &[1.0, 0.0]]);
        let members = Members::new(&views);
        for albedo in [0.1f32, 0.6, 0.9] {
            let (absorbed, scattered) = (steady(&[1.0 - albedo, 0.0]), steady(&[albedo, 0.0]));
            let coupling = Coupling::new(&views, &members, multiple(albedo.into()), absorbed, scattered);
            let arrived = [0, TERMS].map(|at| coupling.visible[at] / (1.0 - albedo));
            let tolerance = 2.0 * TOLERANCE / (1.0 - albedo);
            assert!((arrived[0] - 1.0 / (1.0 - albedo * albedo)).abs() < tolerance, "{albedo}: {arrived:?}");
            assert!((arrived[0] + arrived[1] - 1.0 / (1.0 - albedo)).abs() < tolerance, "{albedo}: {arrived:?}");
        }
    }

    /// Three facets with open sky; a varying flux that is conducted changes no mean.
    #[test]
    fn what_escapes_is_what_came_in() {
        let views = views(&[&[0.0, 0.5, 0.2], &[0.5, 0.0, 0.3], &[0.2, 0.3, 0.0]]);
        let sky = [0.3, 0.2, 0.5];
        let members = Members::new(&views);
        let (mut absorbed, mut scattered) = (steady(&[0.5, 0.0, 0.1]), steady(&[0.3, 0.0, 0.1]));
        (absorbed[1], scattered[2], absorbed[2 * TERMS + 4]) = (0.2, 0.1, -0.05);
        let visible_out = {
            // B from S: (1 - A) V B is what S has more than a.
            let coupling = Coupling::new(&views, &members, multiple(0.4), absorbed.clone(), scattered.clone());
            let from_others = |k: usize| (coupling.visible[k * TERMS] - absorbed[k * TERMS]) / 0.6;
            (0..3).map(|k| sky[k] * (scattered[k * TERMS] + 0.4 * from_others(k))).sum::<f32>()
        };
        for theta in [0.0, 0.7, 50.0] {
            let mut coupling = Coupling::new(&views, &members, multiple(0.4), absorbed.clone(), scattered.clone());
            coupling.settle(theta);
            let infrared_out: f32 = (0..3).map(|k| sky[k] * coupling.leaving[k * TERMS]).sum();
            assert!((visible_out + infrared_out - 1.0).abs() < 1e-3, "{theta}: {visible_out} {infrared_out}");
        }
    }

    #[test]
    fn one_flight_heats_less_than_all() {
        let views = views(&[&[0.0, 0.5, 0.2], &[0.5, 0.0, 0.3], &[0.2, 0.3, 0.0]]);
        let members = Members::new(&views);
        let absorbed = |mode| {
            let optics = Optics { mode, ..multiple(0.4) };
            let mut coupling =
                Coupling::new(&views, &members, optics, steady(&[0.5, 0.0, 0.1]), steady(&[0.3, 0.0, 0.1]));
            coupling.settle(1.0);
            let mut terms = vec![0.0; TERMS];
            [0, 1, 2].map(|member| {
                coupling.absorbed(member, &mut terms);
                terms[0]
            })
        };
        let (single, multiple) = (absorbed(SelfHeating::Single), absorbed(SelfHeating::Multiple));
        // 0.6 (0.5 x 0.3 + 0.3 x 0.1) + 0.9 (0.5 x 0.5 + 0.3 x 0.1)
        assert!((single[1] - 0.36).abs() < 1e-5, "{single:?}");
        assert!((0..3).all(|k| multiple[k] > single[k] + 0.01), "{single:?} {multiple:?}");
    }
}
