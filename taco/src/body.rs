//! The whole body's torque averaged over the rotation, declination by declination, and how far sampling puts it off.

use crate::day::Day;
use crate::declination::Declinations;
use crate::exchange::{Azimuths, Exchange, Scattering, Wrench};
use crate::facets::Facet;
use crate::horizon::{Horizon, HorizonMap};
use crate::pose::Pose;
use crate::recoil::RecoilKernel;
use crate::samples::{SampledHorizons, Subdivision};
use crate::sampling::Sampling;
use crate::scanner::{ScanScratch, Scanner};
use crate::season::{Curve, Season};
use crate::sky::{SkyView, sky_view};
use crate::surface::{SelfHeating, Surface};
use rayon::prelude::*;
use tiling::Mesh;

/// Facets summed by one thread before the sums are added up in order; fixed, so that the thread count changes no byte.
pub(crate) const CHUNK: usize = 64;
/// What sampling costs is estimated from one in at most this many shaded facets; a power of two.
const ESTIMATED_ONE_IN: usize = 16;
/// At least this many facets are looked at for that.
const ESTIMATED_AT_LEAST: usize = 48;

/// A mesh with its horizons, all in the frame of the mesh.
#[derive(Debug)]
pub(crate) struct Shading {
    pub scanner: Scanner,
    /// Facets as the horizons see them.
    pub facets: Vec<Facet>,
    /// Horizons of the centroids.
    pub map: HorizonMap,
    pub subdivision: Subdivision,
    /// Horizons of the parts of the facets; `None` if the centroid stands for the facet.
    pub samples: Option<SampledHorizons>,
    /// Light between facets; `None` if the surface does not ask for it or no facet sees another.
    pub exchange: Option<Exchange>,
    heating: SelfHeating,
}

impl Shading {
    /// `None` if the surface asks for nothing that depends on what a facet sees.
    pub fn new(mesh: &Mesh, facets: &[Facet], surface: &Surface, sampling: &Sampling) -> Option<Self> {
        let heating = surface.self_heating;
        if !(surface.shadows || surface.sky_blockage || heating != SelfHeating::None) {
            return None;
        }
        let scanner = Scanner::new(mesh, sampling.azimuth_bins);
        let map = HorizonMap::of(facets, &scanner);
        let subdivision = Subdivision::new(sampling.facet_samples);
        let sampled = || SampledHorizons::new(mesh, facets, &scanner, &map, &subdivision);
        let samples = (sampling.facet_samples > 1).then(sampled);
        let exchange = Exchange::new(facets, &scanner, &map, heating);
        Some(Self { facets: facets.to_vec(), scanner, map, subdivision, samples, exchange, heating })
    }

    /// Moves to another shape, on which all horizons but those of the facets `touched` are the same; says of these which
    /// differ.
    pub fn look_again(&mut self, mesh: &Mesh, facets: Vec<Facet>, scanner: Scanner, touched: &[usize]) -> Vec<bool> {
        (self.facets, self.scanner) = (facets, scanner);
        let mut differ = self.map.look_again(&self.facets, &self.scanner, touched);
        if let Some(samples) = &mut self.samples {
            let too = samples.look_again(mesh, &self.facets, &self.scanner, &self.map, &self.subdivision, touched);
            differ.iter_mut().zip(too).for_each(|(d, too)| *d |= too);
        }
        self.exchange = Exchange::new(&self.facets, &self.scanner, &self.map, self.heating);
        differ
    }

    /// The shaded facets from which sampling errors are estimated. Which of them does not depend on the others, so that most
    /// stay the same when the shape changes a little.
    fn estimated(&self) -> Vec<usize> {
        let shaded: Vec<usize> = (0..self.facets.len()).filter(|f| self.map.horizon(*f).is_some()).collect();
        let most = (shaded.len() / ESTIMATED_AT_LEAST).clamp(1, ESTIMATED_ONE_IN);
        let one_in = 1 << most.ilog2();
        // Multiples of the golden section are spread evenly, and do not keep step with the order of the facets.
        let spread = |f: usize| (f as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32;
        shaded.into_iter().filter(|f| spread(*f) % one_in == 0).collect()
    }
}

/// Responses of the facets, kept as long as neither they nor their horizons change.
#[derive(Debug, Default)]
pub(crate) struct Memory {
    /// Responses, facet by facet.
    responses: Vec<f64>,
    /// Whether a facet's response is there.
    known: Vec<bool>,
    /// What finer sampling changes, of the facets that were looked at for it.
    differences: Vec<Option<Box<[f64]>>>,
}

impl Memory {
    /// Forgets the response of one facet.
    pub fn forget_response(&mut self, facet: usize) {
        self.known.get_mut(facet).into_iter().for_each(|k| *k = false);
    }

    /// Forgets what finer sampling changes in one facet.
    pub fn forget_differences(&mut self, facet: usize) {
        self.differences.get_mut(facet).into_iter().for_each(|d| *d = None);
    }
}

/// A body with all that its torque needs.
pub(crate) struct Body<'a, K> {
    pub mesh: &'a Mesh,
    /// Facets in the frame of the body.
    pub facets: &'a [Facet],
    pub pose: &'a Pose,
    pub surface: &'a Surface,
    pub kernel: &'a K,
    /// Horizons; `None` if the surface asks for neither shadows nor sky blockage.
    pub shading: Option<&'a Shading>,
}

/// What finer sampling would change, one curve of non-negative numbers each.
pub(crate) struct SamplingErrors {
    /// Twice the distance between azimuths.
    pub azimuth_bins: Curve,
    /// Three points for each of a facet's triangles.
    pub facet_samples: Curve,
}

impl<K: RecoilKernel> Body<'_, K> {
    /// Horizon for shadows and sky for emission that the surface asks for.
    pub fn view<'h>(&self, horizon: Option<&'h Horizon>) -> (Option<&'h Horizon>, SkyView) {
        let sky = horizon.filter(|_| self.surface.sky_blockage).map_or(SkyView::OPEN, sky_view);
        (horizon.filter(|_| self.surface.shadows), sky)
    }

    /// What the light of a facet does to the body in its frame, if part of it is followed to other facets.
    pub fn wrench(&self, f: usize, azimuths: Azimuths) -> Option<Wrench> {
        let exchange = self.shading?.exchange.as_ref()?;
        Some(self.pose.wrench(exchange.wrench(f, azimuths)?))
    }

    /// Adds the response of a facet or a part of it, times `weight`, to `out`.
    fn add(
        &self,
        days: &mut Days<K>,
        facet: &Facet,
        horizon: Option<&Horizon>,
        wrench: Option<&Wrench>,
        weight: f64,
        out: &mut [f64],
    ) {
        let (shadows, sky) = self.view(horizon);
        match wrench {
            None => days.plain.add(facet, shadows, &sky, weight, out),
            Some(wrench) => days.followed.add_followed(facet, shadows, wrench, weight, out),
        }
    }

    /// Calls `visit` for each part from which a facet's shadows are seen, with its horizon and its share of the area.
    pub fn for_each_part(&self, f: usize, mut visit: impl FnMut(&Facet, Option<&Horizon>, f64)) {
        let facet = &self.facets[f];
        let Some((shading, horizon)) = self.shading.and_then(|s| Some((s, s.map.horizon(f)?))) else {
            return visit(facet, None, 1.0);
        };
        let Some(samples) = &shading.samples else {
            return visit(facet, Some(horizon), 1.0);
        };
        let share = 1.0 / shading.subdivision.len() as f64;
        for (point, horizon) in shading.subdivision.points(self.mesh, f).zip(samples.of(f)) {
            visit(&facet.at(self.pose.point(point)), horizon.as_ref(), share);
        }
    }

    /// Adds the response of a facet, times `weight`, to `out`; with horizons at every other azimuth if `HALVED`.
    fn respond<const HALVED: bool>(&self, days: &mut Days<K>, f: usize, weight: f64, out: &mut [f64]) {
        let wrench = self.wrench(f, if HALVED { Azimuths::EveryOther } else { Azimuths::All });
        self.for_each_part(f, |part, horizon, share| {
            let halved = horizon.filter(|_| HALVED).map(Horizon::every_other);
            self.add(days, part, halved.as_ref().or(horizon), wrench.as_ref(), weight * share, out);
        });
    }

    /// Torque per unit pressure, N m / Pa: `[tau_z, tau_u]` at each declination, summed over all facets. What `memory` knows
    /// is not computed again; the sum is the same to the last bit.
    pub fn response(&self, declinations: &Declinations, memory: Option<&mut Memory>) -> Vec<f64> {
        let (facets, m) = (self.facets.len(), 2 * declinations.len());
        let followed = Scattering(self.kernel);
        let days = || Days::new(self.kernel, &followed, declinations);
        let chunks: Vec<Vec<f64>> = match memory {
            None => (0..facets.div_ceil(CHUNK))
                .into_par_iter()
                .map_init(
                    || (days(), vec![0.0; m]),
                    |(days, own), c| {
                        let mut sum = vec![0.0; m];
                        for f in c * CHUNK..facets.min((c + 1) * CHUNK) {
                            own.fill(0.0);
                            self.respond::<false>(days, f, 1.0, own);
                            add_to(&mut sum, own);
                        }
                        sum
                    },
                )
                .collect(),
            Some(Memory { responses, known, .. }) => {
                responses.resize(facets * m, 0.0);
                known.resize(facets, false);
                let chunks = responses.par_chunks_mut(CHUNK * m).zip(known.par_chunks_mut(CHUNK)).enumerate();
                chunks
                    .map_init(days, |days, (c, (responses, known))| {
                        let mut sum = vec![0.0; m];
                        for (i, (own, known)) in responses.chunks_mut(m).zip(known).enumerate() {
                            if !*known {
                                own.fill(0.0);
                                self.respond::<false>(days, c * CHUNK + i, 1.0, own);
                                *known = true;
                            }
                            add_to(&mut sum, own);
                        }
                        sum
                    })
                    .collect()
            }
        };
        let mut sum = vec![0.0; m];
        chunks.iter().for_each(|chunk| add_to(&mut sum, chunk));
        sum
    }

    /// Expected distance between the torques and those with half the azimuths, or with three points for each triangle of a
    /// facet: from a sample of the shaded facets, taking their differences as independent of each other apart from a common
    /// mean. `None` for a convex body.
    pub fn sampling_errors(
        &self,
        coarse: &Declinations,
        season: &Season,
        memory: Option<&mut Memory>,
    ) -> Option<SamplingErrors> {
        let shading = self.shading.filter(|s| s.map.shaded_facets() > 0)?;
        let sample = shading.estimated();
        let mut own = Memory::default();
        let Memory { differences, .. } = memory.unwrap_or(&mut own);
        differences.resize(self.facets.len(), None);
        let missing: Vec<usize> = sample.iter().copied().filter(|f| differences[*f].is_none()).collect();
        let followed = Scattering(self.kernel);
        let state = || (Days::new(self.kernel, &followed, coarse), ScanScratch::default());
        let compute =
            |(days, scratch): &mut (Days<K>, ScanScratch), f: &usize| self.differences(shading, days, scratch, *f);
        let found: Vec<Box<[f64]>> = missing.par_iter().map_init(state, compute).collect();
        missing.iter().zip(found).for_each(|(f, found)| differences[*f] = Some(found));
        let curves = |part: usize| -> Vec<Curve> {
            let known = sample.iter().filter_map(|f| differences[*f].as_deref());
            known.map(|d| season.curve(&d[part * d.len() / 2..(part + 1) * d.len() / 2], 1)).collect()
        };
        let shaded = shading.map.shaded_facets() as f64;
        let estimate = |curves: Vec<Curve>| Curve {
            spin: extrapolated(&curves.iter().map(|c| &*c.spin).collect::<Vec<_>>(), shaded),
            obliquity: extrapolated(&curves.iter().map(|c| &*c.obliquity).collect::<Vec<_>>(), shaded),
        };
        Some(SamplingErrors { azimuth_bins: estimate(curves(0)), facet_samples: estimate(curves(1)) })
    }

    /// What half the azimuths and what three points for each triangle change in the response of a facet.
    fn differences(&self, shading: &Shading, days: &mut Days<K>, scratch: &mut ScanScratch, f: usize) -> Box<[f64]> {
        let n = 2 * days.plain.declinations();
        let mut both = vec![0.0; 2 * n].into_boxed_slice();
        let (azimuths, finer) = both.split_at_mut(n);
        self.respond::<false>(days, f, -1.0, finer);
        azimuths.copy_from_slice(finer);
        self.respond::<true>(days, f, 1.0, azimuths);
        let wrench = self.wrench(f, Azimuths::All);
        let weight = 1.0 / (3 * shading.subdivision.len()) as f64;
        for point in shading.subdivision.finer_points(self.mesh, f) {
            let horizon = shading.scanner.horizon(&shading.facets[f].at(point), scratch);
            let part = self.facets[f].at(self.pose.point(point));
            self.add(days, &part, horizon.as_ref(), wrench.as_ref(), weight, finer);
        }
        both
    }
}

/// Averages over the rotation of facets whose light is followed to others and of all other facets.
struct Days<'a, K> {
    plain: Day<'a, K>,
    followed: Day<'a, Scattering<'a, K>>,
}

impl<'a, K: RecoilKernel> Days<'a, K> {
    fn new(kernel: &'a K, followed: &'a Scattering<'a, K>, declinations: &'a Declinations) -> Self {
        Self { plain: Day::new(kernel, declinations), followed: Day::new(followed, declinations) }
    }
}

/// Root mean square of the sum of `all` differences, obliquity by obliquity, of which these are a sample.
fn extrapolated(sample: &[&[f64]], all: f64) -> Vec<f64> {
    let count = sample.len().max(1) as f64;
    let obliquities = sample.first().map_or(0, |values| values.len());
    let at = |e: usize| {
        let mean = sample.iter().map(|d| d[e]).sum::<f64>() / count;
        let square = sample.iter().map(|d| d[e] * d[e]).sum::<f64>() / count;
        // The sample's mean exceeds the true one by its own scatter.
        (all * square + all * all * (mean * mean - square / count).max(0.0)).sqrt()
    };
    (0..obliquities).map(at).collect()
}

fn add_to(sum: &mut [f64], more: &[f64]) {
    sum.iter_mut().zip(more).for_each(|(s, m)| *s += m);
}
