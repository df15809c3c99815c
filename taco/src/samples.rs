//! From how many points of a facet shadows are seen: centroids of the equal triangles that the facet is cut into.
//!
//! Lines parallel to its sides cut a triangle into `k^2` congruent ones. Each is then lit or dark as its centroid is, so
//! that a shadow's edge crosses a facet in `k^2` steps instead of one.

use crate::facets::Facet;
use crate::horizon::{Horizon, HorizonMap};
use crate::scanner::{ScanScratch, Scanner};
use rayon::prelude::*;
use tiling::Mesh;

/// Weights of a facet's three corners.
type Barycentric = [f64; 3];

/// The equal triangles of a facet.
#[derive(Debug, Clone)]
pub(crate) struct Subdivision {
    /// Centroids of the triangles.
    centroids: Vec<Barycentric>,
    /// Three points of each triangle, `(2/3, 1/6, 1/6)` of its corners: the rule of second order.
    finer: Vec<Barycentric>,
}

impl Subdivision {
    /// Into `samples` triangles, a square number.
    pub fn new(samples: usize) -> Self {
        let k = samples.isqrt();
        let corner = |i: usize, j: usize| [(k - i - j) as f64, i as f64, j as f64].map(|w| w / k as f64);
        let upright = (0..k).flat_map(|i| (0..k - i).map(move |j| [[i, j], [i + 1, j], [i, j + 1]]));
        let inverted = (1..k).flat_map(|i| (1..=k - i).map(move |j| [[i, j], [i - 1, j], [i, j - 1]]));
        let (mut centroids, mut finer) = (Vec::new(), Vec::new());
        for triangle in upright.chain(inverted) {
            let corners = triangle.map(|[i, j]| corner(i, j));
            let centroid: Barycentric = std::array::from_fn(|c| corners.iter().map(|p| p[c]).sum::<f64>() / 3.0);
            finer.extend(corners.map(|p| std::array::from_fn(|c| 0.5 * (centroid[c] + p[c]))));
            centroids.push(centroid);
        }
        Self { centroids, finer }
    }

    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.centroids.len()
    }

    /// Centroids of the triangles of facet `f`, m.
    pub fn points(&self, mesh: &Mesh, f: usize) -> impl Iterator<Item = [f64; 3]> {
        at(&self.centroids, mesh, f)
    }

    /// Three points in each triangle of facet `f`, m: what [`Self::points`] is compared with.
    pub fn finer_points(&self, mesh: &Mesh, f: usize) -> impl Iterator<Item = [f64; 3]> {
        at(&self.finer, mesh, f)
    }
}

fn at(weights: &[Barycentric], mesh: &Mesh, f: usize) -> impl Iterator<Item = [f64; 3]> {
    let [a, b, c] = mesh.corners(f);
    weights.iter().map(move |w| (a * w[0] + b * w[1] + c * w[2]).into())
}

/// Horizons of the triangles of all shaded facets.
#[derive(Debug, Clone)]
pub(crate) struct SampledHorizons {
    /// One a triangle, facet by facet; none at all for a facet above whose plane nothing rises.
    horizons: Vec<Box<[Option<Horizon>]>>,
}

impl SampledHorizons {
    /// Of the facets that have a horizon in `map`.
    pub fn new(mesh: &Mesh, facets: &[Facet], scanner: &Scanner, map: &HorizonMap, subdivision: &Subdivision) -> Self {
        let mut all = Self { horizons: Vec::new() };
        let touched: Vec<usize> = (0..facets.len()).collect();
        all.look_again(mesh, facets, scanner, map, subdivision, &touched);
        all
    }

    /// Moves to a mesh on which all horizons but those of the facets `touched` are the same; says of these which differ.
    pub fn look_again(
        &mut self,
        mesh: &Mesh,
        facets: &[Facet],
        scanner: &Scanner,
        map: &HorizonMap,
        subdivision: &Subdivision,
        touched: &[usize],
    ) -> Vec<bool> {
        self.horizons.resize(facets.len(), Box::default());
        let look = |scratch: &mut ScanScratch, f: &usize| -> Box<[Option<Horizon>]> {
            let points = map.horizon(*f).map(|_| subdivision.points(mesh, *f));
            points.into_iter().flatten().map(|p| scanner.horizon(&facets[*f].at(p), scratch)).collect()
        };
        let found: Vec<_> = touched.par_iter().map_init(ScanScratch::default, look).collect();
        let replace = |(f, horizons): (&usize, Box<[Option<Horizon>]>)| {
            let differs = self.horizons[*f] != horizons;
            self.horizons[*f] = horizons;
            differs
        };
        touched.iter().zip(found).map(replace).collect()
    }

    /// The horizons of the triangles of a facet.
    pub fn of(&self, facet: usize) -> &[Option<Horizon>] {
        &self.horizons[facet]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_are_spread_evenly_over_the_facet() {
        let mesh = Mesh { vertices: vec![[0.0; 3], [3.0, 0.0, 0.0], [0.0, 6.0, 0.0]], facets: vec![[0, 1, 2]] };
        for samples in [1, 4, 9, 16, 25] {
            let subdivision = Subdivision::new(samples);
            assert_eq!((subdivision.len(), subdivision.finer_points(&mesh, 0).count()), (samples, 3 * samples));
            // Their mean is the facet's centroid; no two are the same; the least distance from a side is that of an
            // upright triangle's centroid.
            let points: Vec<_> = subdivision.points(&mesh, 0).collect();
            let mean = |k: usize| points.iter().map(|p| p[k]).sum::<f64>() / samples as f64;
            assert!((mean(0) - 1.0).abs() < 1e-14 && (mean(1) - 2.0).abs() < 1e-14);
            let k = (samples as f64).sqrt();
            let least = points.iter().map(|p| p[0]).fold(f64::INFINITY, f64::min);
            assert!((least - 1.0 / k).abs() < 1e-14);
            for (i, p) in points.iter().enumerate() {
                assert!(points[..i].iter().all(|q| (p[0] - q[0]).hypot(p[1] - q[1]) > 0.9 / k));
            }
            // Exact for quadratic functions: the mean of x^2 over the triangle is 3^2 / 6.
            let square: f64 = subdivision.finer_points(&mesh, 0).map(|p| p[0] * p[0]).sum();
            assert!((square / (3 * samples) as f64 - 1.5).abs() < 1e-14);
        }
    }
}
