//! The whole body's torque averaged over the rotation, declination by declination, and how far sampling puts it off.

use crate::day::Day;
use crate::declination::Declinations;
use crate::exchange::{Azimuths, Exchange, Scattering};
use crate::facets::Facet;
use crate::horizon::{Horizon, HorizonMap};
use crate::recoil::RecoilKernel;
use crate::scanner::{ScanScratch, Scanner};
use crate::season::{Curve, Season};
use crate::sky::{SkyView, sky_view};
use crate::surface::Surface;
use rayon::prelude::*;
use tiling::Mesh;

/// Facets summed by one thread before the sums are added up in order; fixed, so that the thread count changes no byte.
const CHUNK: usize = 64;
/// One in this many shaded facets is looked at from three points, to estimate what the centroid rule costs.
const SAMPLED_ONE_IN: usize = 16;
/// At least this many facets are looked at from three points.
const SAMPLED_AT_LEAST: usize = 48;

/// A body with all that its torque needs.
pub(crate) struct Body<'a, K> {
    pub mesh: &'a Mesh,
    pub facets: &'a [Facet],
    pub surface: &'a Surface,
    pub kernel: &'a K,
    /// Edges and horizons; `None` if the surface asks for neither shadows nor sky blockage.
    pub horizons: Option<(&'a Scanner, &'a HorizonMap)>,
    /// Light between facets; `None` if the surface does not ask for it or no facet sees another.
    pub exchange: Option<&'a Exchange>,
}

/// Torque per unit pressure, N m / Pa.
pub(crate) struct Rotation {
    /// `[tau_z, tau_u]` at each declination.
    pub response: Vec<f64>,
    /// What halving the number of azimuths adds, at the coarse declinations.
    pub coarser_azimuths: Vec<f64>,
}

impl<K: RecoilKernel> Body<'_, K> {
    /// Horizon for shadows and sky for emission that the surface asks for.
    fn view<'h>(&self, horizon: Option<&'h Horizon>) -> (Option<&'h Horizon>, SkyView) {
        let sky = horizon.filter(|_| self.surface.sky_blockage).map_or(SkyView::OPEN, sky_view);
        (horizon.filter(|_| self.surface.shadows), sky)
    }

    /// Sums over all facets, with `declinations` and with `coarse`, which has every `stride`-th of them.
    pub fn rotation(&self, declinations: &Declinations, coarse: &Declinations, stride: usize) -> Rotation {
        let (m, m_coarse) = (2 * declinations.len(), 2 * coarse.len());
        let followed = Scattering(self.kernel);
        let state = || {
            let days = (Day::new(self.kernel, declinations), Day::new(self.kernel, coarse));
            (days, (Day::new(&followed, declinations), Day::new(&followed, coarse)), vec![0.0; m])
        };
        let indices: Vec<usize> = (0..self.facets.len()).collect();
        let chunks: Vec<Vec<f64>> = indices
            .par_chunks(CHUNK)
            .map_init(state, |((day, coarse_day), (followed_day, coarse_followed_day), own), chunk| {
                let mut sum = vec![0.0; m + m_coarse];
                for &f in chunk {
                    let facet = &self.facets[f];
                    let horizon = self.horizons.and_then(|(_, map)| map.horizon(f));
                    let (shadows, sky) = self.view(horizon);
                    let Some(horizon) = horizon else {
                        day.add(facet, shadows, &sky, 1.0, &mut sum[..m]);
                        continue;
                    };
                    own.fill(0.0);
                    match self.exchange.and_then(|e| e.wrench(f, Azimuths::All)) {
                        None => day.add(facet, shadows, &sky, 1.0, own),
                        Some(wrench) => followed_day.add_followed(facet, shadows, wrench, 1.0, own),
                    }
                    sum.iter_mut().zip(&*own).for_each(|(s, o)| *s += o);
                    let every_other = horizon.every_other();
                    let (shadows, sky) = self.view(Some(&every_other));
                    let out = &mut sum[m..];
                    match self.exchange.and_then(|e| e.wrench(f, Azimuths::EveryOther)) {
                        None => coarse_day.add(facet, shadows, &sky, 1.0, out),
                        Some(wrench) => coarse_followed_day.add_followed(facet, shadows, wrench, 1.0, out),
                    }
                    for (s, o) in sum[m..].chunks_mut(2).zip(own.chunks(2).step_by(stride)) {
                        s[0] -= o[0];
                        s[1] -= o[1];
                    }
                }
                sum
            })
            .collect();
        let mut response = vec![0.0; m + m_coarse];
        for chunk in &chunks {
            response.iter_mut().zip(chunk).for_each(|(r, c)| *r += c);
        }
        let coarser_azimuths = response.split_off(m);
        Rotation { response, coarser_azimuths }
    }

    /// Expected distance between the torques of the centroid rule and those with three points a facet, as a curve of
    /// non-negative numbers: from a sample of the shaded facets, taking their differences as independent of each other
    /// apart from a common mean. Zero for a convex body.
    pub fn centroid_rule(&self, coarse: &Declinations, season: &Season) -> Option<Curve> {
        let (scanner, map) = self.horizons?;
        let shaded: Vec<usize> = (0..self.facets.len()).filter(|f| map.horizon(*f).is_some()).collect();
        let stride = (shaded.len() / SAMPLED_AT_LEAST).clamp(1, SAMPLED_ONE_IN);
        let sample: Vec<usize> = shaded.iter().copied().step_by(stride).collect();
        let state = || (Day::new(self.kernel, coarse), ScanScratch::default());
        let differences: Vec<Curve> = sample
            .par_iter()
            .map_init(state, |(day, scratch), &f| {
                let facet = &self.facets[f];
                let mut response = vec![0.0; 2 * coarse.len()];
                let (shadows, sky) = self.view(map.horizon(f));
                day.add(facet, shadows, &sky, -1.0, &mut response);
                for corner in self.mesh.corners(f) {
                    // (2/3, 1/6, 1/6) in barycentric coordinates: the three-point rule of second order.
                    let point = facet.at(std::array::from_fn(|k| 0.5 * (facet.point[k] + corner[k])));
                    let horizon = scanner.horizon(&point, scratch);
                    let (shadows, sky) = self.view(horizon.as_ref());
                    day.add(&point, shadows, &sky, 1.0 / 3.0, &mut response);
                }
                season.curve(&response, 1)
            })
            .collect();
        let estimate = |value: &dyn Fn(&Curve) -> &[f64]| -> Vec<f64> {
            let count = differences.len().max(1) as f64;
            let obliquities = differences.first().map_or(0, |c| value(c).len());
            (0..obliquities)
                .map(|e| {
                    let mean = differences.iter().map(|d| value(d)[e]).sum::<f64>() / count;
                    let square = differences.iter().map(|d| value(d)[e].powi(2)).sum::<f64>() / count;
                    let all = shaded.len() as f64;
                    // The sample's mean exceeds the true one by its own scatter.
                    (all * square + all * all * (mean * mean - square / count).max(0.0)).sqrt()
                })
                .collect()
        };
        Some(Curve { spin: estimate(&|c| &c.spin), obliquity: estimate(&|c| &c.obliquity) })
    }
}
