//! Horizons: which part of the sky the rest of the body hides from each facet, azimuth by azimuth.
//!
//! Concept of Statler 2009 (Icarus 202, 502), without rays. The half-plane of an azimuth cuts every facet that faces the
//! observer in an interval of elevations; their union is what is hidden, exactly, at that azimuth. The interval that
//! begins at the ground is the horizon; what hides the sky above a gap (a boulder that leans over) is kept as well.

use crate::error::{TacoError, require};
use crate::facets::{Facet, facets};
use crate::scanner::{ScanScratch, Scanner};
use rayon::prelude::*;
use tiling::Mesh;

/// Horizons of all facets of a mesh, seen from their centroids.
#[derive(Debug, Clone, PartialEq)]
pub struct HorizonMap {
    azimuth_bins: usize,
    /// `None` for a facet above whose plane nothing rises.
    horizons: Vec<Option<Horizon>>,
}

/// What hides the sky from one place.
#[derive(Debug, Clone, PartialEq)]
pub struct Horizon {
    /// Tangent of the elevation up to which the sky is hidden, >= 0, at azimuths `2 pi k / n`.
    pub tan_elevation: Box<[f32]>,
    /// What hides the sky above a gap, by azimuth and from below; empty for nearly all facets of real bodies.
    pub overhangs: Box<[Overhang]>,
}

/// Part of the sky hidden by something that leans over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overhang {
    /// Index of the azimuth.
    pub azimuth: u32,
    /// Tangents of the lowest and highest hidden elevation.
    pub tan_elevation: [f32; 2],
}

impl Horizon {
    /// The same horizon at half as many azimuths.
    pub(crate) fn every_other(&self) -> Self {
        let even = self.overhangs.iter().filter(|o| o.azimuth % 2 == 0);
        Self {
            tan_elevation: self.tan_elevation.iter().copied().step_by(2).collect(),
            overhangs: even.map(|o| Overhang { azimuth: o.azimuth / 2, ..*o }).collect(),
        }
    }
}

impl HorizonMap {
    /// The map at `azimuth_bins` evenly spaced azimuths, from north (the spin axis, +z) over west.
    ///
    /// # Errors
    /// [`TacoError`] if the mesh is empty or broken, or `azimuth_bins` is not a multiple of 8 in [16, 2880].
    pub fn new(mesh: &Mesh, azimuth_bins: usize) -> Result<Self, TacoError> {
        let ok = azimuth_bins.is_multiple_of(8) && (16..=2880).contains(&azimuth_bins);
        require(ok, "azimuth_bins", azimuth_bins as f64, "a multiple of 8 in [16, 2880]")?;
        let facets = facets(mesh)?;
        Ok(Self::of(&facets, &Scanner::new(mesh, azimuth_bins)))
    }

    pub(crate) fn of(facets: &[Facet], scanner: &Scanner) -> Self {
        let look = |scratch: &mut ScanScratch, facet| scanner.horizon(facet, scratch);
        let horizons = facets.par_iter().map_init(ScanScratch::default, look).collect();
        Self { azimuth_bins: scanner.azimuths.len(), horizons }
    }

    /// Moves to a mesh on which all horizons but those of the facets `touched` are the same; says of these which differ.
    pub(crate) fn look_again(&mut self, facets: &[Facet], scanner: &Scanner, touched: &[usize]) -> Vec<bool> {
        self.horizons.resize(facets.len(), None);
        let look = |scratch: &mut ScanScratch, f: &usize| scanner.horizon(&facets[*f], scratch);
        let found: Vec<_> = touched.par_iter().map_init(ScanScratch::default, look).collect();
        let replace = |(f, horizon): (&usize, Option<Horizon>)| {
            let differs = self.horizons[*f] != horizon;
            self.horizons[*f] = horizon;
            differs
        };
        touched.iter().zip(found).map(replace).collect()
    }

    /// Number of azimuths.
    pub fn azimuth_bins(&self) -> usize {
        self.azimuth_bins
    }

    /// The horizon of a facet; `None` where nothing rises above its plane (or there is no such facet).
    pub fn horizon(&self, facet: usize) -> Option<&Horizon> {
        self.horizons.get(facet)?.as_ref()
    }

    /// How many facets have something above their plane; 0 for a convex mesh.
    pub fn shaded_facets(&self) -> usize {
        self.horizons.iter().flatten().count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::azimuth::direction;
    use crate::test_bodies::{blocked, cuboid, rugged};

    #[test]
    fn hidden_sky_is_where_rays_are_blocked() {
        let mesh = rugged(200);
        let bins = 40;
        let map = HorizonMap::new(&mesh, bins).unwrap();
        let (mut lit, mut dark, mut overhung) = (0, 0, 0);
        for (f, facet) in facets(&mesh).unwrap().iter().enumerate() {
            let horizon = map.horizon(f);
            overhung += usize::from(horizon.is_some_and(|h| !h.overhangs.is_empty()));
            let [north, west, up] = facet.horizon_axes();
            for k in 0..bins {
                let [c, s] = direction(k, bins);
                for elevation in [0.02f64, 0.11, 0.3, 0.62, 1.0, 1.4] {
                    let t = elevation.tan();
                    let towards = std::array::from_fn(|i| c * north[i] + s * west[i] + t * up[i]);
                    let hidden = horizon.is_some_and(|h| {
                        let over = |o: &Overhang| {
                            let [low, high] = o.tan_elevation.map(f64::from);
                            o.azimuth as usize == k && low < t && t < high
                        };
                        f64::from(h.tan_elevation[k]) > t || h.overhangs.iter().any(over)
                    });
                    assert_eq!(hidden, blocked(&mesh, facet.point, towards, f), "facet {f}, azimuth {k}, {elevation}");
                    if hidden { dark += 1 } else { lit += 1 }
                }
            }
        }
        assert!(lit > 10_000 && dark > 10_000 && overhung > 10, "{lit} {dark} {overhung}");
    }

    #[test]
    fn convex_bodies_have_no_horizon_not_even_by_round_off() {
        let mut cube = Mesh::default();
        cuboid(&mut cube, [-1.0, -2.0, -3.0], [1.0, 2.0, 3.0]);
        let turn = nalgebra::Rotation3::from_euler_angles(0.3, 1.1, -0.7);
        for mesh in [cube.rotated(turn.matrix()), tiling::fibonacci::unit_sphere(500).unwrap()] {
            assert_eq!(HorizonMap::new(&mesh, 32).unwrap().shaded_facets(), 0);
        }
    }

    /// From the floor at a distance d before a wall of height H, tan h = H cos az / d.
    #[test]
    fn wall_stands_as_high_as_its_distance_says() {
        let mut mesh = Mesh::default();
        cuboid(&mut mesh, [-50.0, -50.0, -1.0], [50.0, 50.0, 0.0]);
        cuboid(&mut mesh, [-50.0, 10.0, 0.0], [50.0, 11.0, 4.0]);
        let floor = (0..mesh.facets.len()).find(|f| mesh.normal(*f).z > 0.9 && mesh.centroid(*f).z == 0.0).unwrap();
        let point = mesh.centroid(floor);
        let map = HorizonMap::new(&mesh, 360).unwrap();
        let horizon = map.horizon(floor).unwrap();
        // A facet that looks along the spin axis has its azimuths from -x, over -y.
        let distance = 10.0 - point.y;
        for az_deg in [245usize, 270, 290] {
            let expected = 4.0 * (az_deg as f64).to_radians().sin().abs() / distance;
            assert!((f64::from(horizon.tan_elevation[az_deg]) - expected).abs() < 1e-6);
        }
        assert_eq!(horizon.tan_elevation[90], 0.0);
        assert!(horizon.overhangs.is_empty());
    }
}
