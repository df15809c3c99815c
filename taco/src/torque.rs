//! The torque table: spin and obliquity torque of a mesh at every obliquity, with an estimate of its error.
//!
//! Sign conventions of Rubincam 2000 (Icarus 148, 2): `d omega/dt = T_omega / C`, `d epsilon/dt = T_epsilon / (C omega)`;
//! a positive `T_epsilon` raises the obliquity. Direct radiation pressure exerts no secular torque and is left out
//! (Rubincam & Paddack 2010, Icarus 209, 863; Nesvorny & Vokrouhlicky 2008, A&A 480, 1).

use crate::body::{Body, Memory, Shading};
use crate::declination::Declinations;
use crate::error::TacoError;
use crate::exchange::Scattering;
use crate::facets::{Facet, facets};
use crate::interpolant::{Interpolation, TorqueInterpolant};
use crate::orbit::Orbit;
use crate::pose::Pose;
use crate::recoil::{LambertRecoil, RecoilKernel, RecoilTable};
use crate::sampling::Sampling;
use crate::season::{Curve, Season};
use crate::surface::{Reflectance, Surface};
use std::f64::consts::PI;
use tiling::Mesh;

/// Torques over obliquity and spin rate.
#[derive(Debug, Clone, PartialEq)]
pub struct TorqueTable {
    /// Obliquities, rad, ascending.
    pub obliquity: Vec<f64>,
    /// Spin rates, rad/s, ascending; a single one means that the torques do not depend on it (no heat is stored).
    pub omega: Vec<f64>,
    /// Torque along the spin axis, `T_omega`, N m, `[omega][obliquity]`.
    pub spin_torque_n_m: Vec<Vec<f64>>,
    /// Torque that raises the obliquity, `T_epsilon`, N m, `[omega][obliquity]`.
    pub obliquity_torque_n_m: Vec<Vec<f64>>,
    /// How far the torques may be off.
    pub error: TorqueError,
    /// Facets above whose plane another part of the body rises; 0 for a convex body or where horizons were not asked for.
    pub shaded_facets: usize,
}

/// Estimated errors, the largest over all obliquities: the sum of the parts.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TorqueError {
    /// Error of the spin torque, N m.
    pub spin_torque_n_m: f64,
    /// Error of the obliquity torque, N m.
    pub obliquity_torque_n_m: f64,
    /// What each source contributes.
    pub parts: Vec<ErrorPart>,
}

/// One source of error.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorPart {
    /// What is sampled: `declination_nodes` (against every other node), `azimuth_bins` (against every other bin, view
    /// factors included; absent from convex bodies), `facet_sampling` (each of the facet's samples against three points; likewise) and
    /// `obliquity_interpolation` (cubic, half-way between the nodes; absent unless the table runs from 0 to 180 deg).
    /// The second and third are estimated from a sample of the shaded facets.
    pub name: String,
    /// Error of the spin torque, N m.
    pub spin_torque_n_m: f64,
    /// Error of the obliquity torque, N m.
    pub obliquity_torque_n_m: f64,
}

impl TorqueTable {
    /// The table ready for look-ups between its nodes.
    ///
    /// # Errors
    /// [`TacoError::BadTable`] if the obliquities do not run from 0 to 180 deg or the rows do not fit them.
    pub fn interpolant(&self, interpolation: Interpolation) -> Result<TorqueInterpolant, TacoError> {
        TorqueInterpolant::new(self, interpolation)
    }
}

/// Torques of a closed mesh whose origin is its centre of mass and which spins about +z.
///
/// # Errors
/// [`TacoError`] if a parameter is out of range, the mesh is empty or broken, or a torque overflows.
pub fn torque_table(
    mesh: &Mesh,
    surface: &Surface,
    orbit: &Orbit,
    sampling: &Sampling,
) -> Result<TorqueTable, TacoError> {
    surface.validate()?;
    orbit.validate()?;
    sampling.validate()?;
    let facets = facets(mesh)?;
    let shading = Shading::new(mesh, &facets, surface, sampling);
    let pressure_pa = orbit.mean_pressure_pa();
    let (facets, pose, shading) = (&facets, &Pose::default(), shading.as_ref());
    Task { mesh, surface, facets, pose, shading, pressure_pa, sampling }.run(None)
}

/// The arguments of [`torque_table`] once validated, waiting for the reflectance to choose the kernel.
pub(crate) struct Task<'a> {
    pub mesh: &'a Mesh,
    pub surface: &'a Surface,
    /// Facets in the frame of the body.
    pub facets: &'a [Facet],
    pub pose: &'a Pose,
    pub shading: Option<&'a Shading>,
    pub pressure_pa: f64,
    pub sampling: &'a Sampling,
}

impl Task<'_> {
    /// The table; `memory` holds what is known of the same facets in the same pose.
    pub fn run(&self, memory: Option<&mut Memory>) -> Result<TorqueTable, TacoError> {
        match self.surface.reflectance {
            Reflectance::None => self.reflecting(&LambertRecoil { albedo: 0.0 }, memory),
            Reflectance::Lambert { bond_albedo } => self.reflecting(&LambertRecoil { albedo: bond_albedo }, memory),
            Reflectance::Hapke(hapke) => self.reflecting(&*RecoilTable::cached(&hapke), memory),
        }
    }

    fn reflecting(&self, kernel: &impl RecoilKernel, memory: Option<&mut Memory>) -> Result<TorqueTable, TacoError> {
        if self.surface.sky_blockage_reflected {
            self.table(&Scattering(kernel), memory)
        } else {
            self.table(kernel, memory)
        }
    }

    fn table(&self, kernel: &impl RecoilKernel, mut memory: Option<&mut Memory>) -> Result<TorqueTable, TacoError> {
        let Self { mesh, surface, facets, pose, shading, .. } = *self;
        let nodes = self.sampling.declination_nodes;
        // Errors that need passes of their own are estimated at every fourth declination where that is possible.
        let stride = if nodes % 4 == 1 { 4 } else { 2 };
        let coarse_nodes = (nodes - 1) / stride + 1;
        let obliquities_deg = self.sampling.obliquities_deg()?;
        let (fine, coarse) = (Declinations::new(nodes), Declinations::new(coarse_nodes));
        let season = Season::new(nodes, &obliquities_deg);
        let half_season = Season::new(nodes.div_ceil(2), &obliquities_deg);
        let coarse_season = Season::new(coarse_nodes, &obliquities_deg);

        let body = Body { mesh, facets, pose, surface, kernel, shading };
        let response = body.response(&fine, memory.as_deref_mut());
        let curve = season.curve(&response, 1).scaled(self.pressure_pa);
        self.check_finite(&curve, &obliquities_deg)?;

        let shaded_facets = shading.map_or(0, |s| s.map.shaded_facets());
        let coarser = half_season.curve(&response, 2).scaled(self.pressure_pa);
        let mut parts = vec![part("declination_nodes", curve.distance(&coarser))];
        if let Some(errors) = body.sampling_errors(&coarse, &coarse_season, memory) {
            let zero = Curve { spin: vec![0.0; curve.spin.len()], obliquity: vec![0.0; curve.spin.len()] };
            for (name, error) in [("azimuth_bins", errors.azimuth_bins), ("facet_sampling", errors.facet_samples)] {
                parts.push(part(name, error.scaled(self.pressure_pa).distance(&zero)));
            }
        }
        let mut table = TorqueTable {
            obliquity: obliquities_deg.iter().map(|o| if *o == 180.0 { PI } else { o.to_radians() }).collect(),
            omega: vec![0.0],
            spin_torque_n_m: vec![curve.spin],
            obliquity_torque_n_m: vec![curve.obliquity],
            error: TorqueError::default(),
            shaded_facets,
        };
        if let Ok(interpolant) = table.interpolant(Interpolation::Cubic) {
            let between: Vec<f64> = obliquities_deg.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect();
            let exact = Season::new(nodes, &between).curve(&response, 1).scaled(self.pressure_pa);
            let (spin, obliquity) = between.iter().map(|o| interpolant.at(o.to_radians(), 0.0)).unzip();
            parts.push(part("obliquity_interpolation", exact.distance(&Curve { spin, obliquity })));
        }
        table.error = TorqueError {
            spin_torque_n_m: parts.iter().map(|p| p.spin_torque_n_m).sum(),
            obliquity_torque_n_m: parts.iter().map(|p| p.obliquity_torque_n_m).sum(),
            parts,
        };
        Ok(table)
    }

    fn check_finite(&self, curve: &Curve, obliquities_deg: &[f64]) -> Result<(), TacoError> {
        let finite = |k: usize| curve.spin[k].is_finite() && curve.obliquity[k].is_finite();
        match (0..obliquities_deg.len()).find(|k| !finite(*k)) {
            None => Ok(()),
            Some(k) => Err(TacoError::NotFinite { obliquity_deg: obliquities_deg[k] }),
        }
    }
}

fn part(name: &str, [spin_torque_n_m, obliquity_torque_n_m]: [f64; 2]) -> ErrorPart {
    ErrorPart { name: name.to_owned(), spin_torque_n_m, obliquity_torque_n_m }
}
