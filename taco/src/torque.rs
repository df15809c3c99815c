//! The torque table: spin and obliquity torque of a mesh at every obliquity, with an estimate of its error.
//!
//! Sign conventions of Rubincam 2000 (Icarus 148, 2): `d omega/dt = T_omega / C`, `d epsilon/dt = T_epsilon / (C omega)`;
//! a positive `T_epsilon` raises the obliquity. Direct radiation pressure exerts no secular torque and is left out
//! (Rubincam & Paddack 2010, Icarus 209, 863; Nesvorny & Vokrouhlicky 2008, A&A 480, 1).

use crate::body::{Body, Memory, Shading};
use crate::body_mesh::BodyMesh;
use crate::declination::Declinations;
use crate::error::TacoError;
use crate::exchange::Scattering;
use crate::facets::{Facet, facets};
use crate::heat::Heat;
use crate::interpolant::{Interpolation, TorqueInterpolant};
use crate::orbit::Orbit;
use crate::pose::Pose;
use crate::recoil::{LambertRecoil, RecoilKernel, RecoilTable};
use crate::sampling::{Obliquities, Sampling};
use crate::season::{Curve, Season, TransverseSeason};
use crate::surface::{Reflectance, Surface};
use std::f64::consts::PI;
use tiling::Mesh;

/// Torques over obliquity and spin rate.
#[derive(Debug, Clone, PartialEq)]
pub struct TorqueTable {
    /// Obliquities, rad, ascending.
    pub obliquity: Vec<f64>,
    /// Spin rates, rad/s, ascending; a single one means that the torques do not depend on it (no heat is stored, or that is
    /// what was asked for).
    pub omega: Vec<f64>,
    /// Torque along the spin axis, `T_omega`, N m, `[omega][obliquity]`.
    pub spin_torque_n_m: Vec<Vec<f64>>,
    /// Torque that raises the obliquity, `T_epsilon`, N m, `[omega][obliquity]`.
    pub obliquity_torque_n_m: Vec<Vec<f64>>,
    /// Yarkovsky force: along the orbital motion, averaged over rotation and orbit, N, `[omega][obliquity]`; positive moves the
    /// orbit outwards. All recoil counts, that of reflected light included. Empty unless the ground stores heat.
    /// [`Orbit::semimajor_axis_drift_m_s`] turns it into a drift.
    pub transverse_force_n: Vec<Vec<f64>>,
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
    /// factors included; absent from convex bodies), `facet_sampling` (each of the facet's samples against three points;
    /// likewise), `obliquity_interpolation` (cubic, half-way between the nodes; absent if the obliquities were chosen one by
    /// one, [`Obliquities::ListDeg`]: such a table is read at its nodes), `round_off` (of the sum over the facets: what is left
    /// of the torque of a symmetric body); and if heat is stored `rotation_cells` (against half as many) and `spin_rate_interpolation` (an eighth of
    /// the error at every other spin rate when interpolated from the others; absent from tables of fewer than five).
    /// The second, third and fifth are estimated from a sample of the facets.
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

/// Torques of a body.
///
/// # Errors
/// [`TacoError`] if a parameter is out of range or a torque overflows.
pub fn torque_table(
    body: &BodyMesh,
    surface: &Surface,
    orbit: &Orbit,
    sampling: &Sampling,
) -> Result<TorqueTable, TacoError> {
    torque_table_of_facets(body.lit(), surface, orbit, sampling)
}

/// Torques about the origin, spin about +z, of facets that need not bound a body: of one facet, for example, to compare with
/// a closed form. Of anything else than parts of bodies the numbers mean nothing; bodies go to [`torque_table`].
///
/// # Errors
/// [`TacoError`] if a parameter is out of range, the mesh is empty or broken, or a torque overflows.
pub fn torque_table_of_facets(
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
    let (facets, pose, shading) = (&facets, &Pose::default(), shading.as_ref());
    let seasons = &Seasons::new(sampling)?;
    Task { mesh, surface, orbit, facets, pose, shading, sampling, seasons }.run(None)
}

/// The arguments of [`torque_table`] once validated, waiting for the reflectance to choose the kernel.
pub(crate) struct Task<'a> {
    pub mesh: &'a Mesh,
    pub surface: &'a Surface,
    pub orbit: &'a Orbit,
    /// Facets in the frame of the body.
    pub facets: &'a [Facet],
    pub pose: &'a Pose,
    pub shading: Option<&'a Shading>,
    pub sampling: &'a Sampling,
    pub seasons: &'a Seasons,
}

/// The averages over the orbit that a table takes; the same for every shape.
#[derive(Debug)]
pub(crate) struct Seasons {
    obliquities_deg: Vec<f64>,
    /// From every declination, from every other one, and from those of the error passes.
    fine: Season,
    half: Season,
    coarse: Season,
    /// Half-way between the obliquities.
    between: Season,
    /// Every which declination the error passes take.
    stride: usize,
}

impl Seasons {
    pub fn new(sampling: &Sampling) -> Result<Self, TacoError> {
        let (nodes, obliquities_deg) = (sampling.declination_nodes, sampling.obliquities_deg()?);
        // Errors that need passes of their own are estimated at every fourth declination where that is possible.
        let stride = if nodes % 4 == 1 { 4 } else { 2 };
        Ok(Self {
            fine: Season::new(nodes, &obliquities_deg),
            half: Season::new(nodes.div_ceil(2), &obliquities_deg),
            coarse: Season::new((nodes - 1) / stride + 1, &obliquities_deg),
            between: Season::new(nodes, &between(&obliquities_deg)),
            obliquities_deg,
            stride,
        })
    }
}

/// The middles of the intervals.
fn between(obliquities_deg: &[f64]) -> Vec<f64> {
    obliquities_deg.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect()
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
        let Self { mesh, surface, orbit, facets, pose, shading, .. } = *self;
        let pressure_pa = orbit.mean_pressure_pa();
        let nodes = self.sampling.declination_nodes;
        let Seasons { obliquities_deg, fine: season, half: half_season, coarse: coarse_season, stride, .. } =
            self.seasons;
        let (fine, coarse) = (Declinations::new(nodes), Declinations::new((nodes - 1) / stride + 1));

        let body = Body { mesh, facets, pose, surface, kernel, shading };
        let response = body.response(&fine, memory.as_deref_mut());
        let heat = Heat::new(surface, orbit, self.sampling);
        let heated = heat.as_ref().map(|heat| heat.add(&body, &fine, &response));
        let responses = match &heated {
            None => std::slice::from_ref(&response),
            Some(heated) => &heated.responses,
        };
        let curve_of =
            |season: &Season, response: &[f64], stride: usize| season.curve(response, stride).scaled(pressure_pa);
        let curves: Vec<Curve> = responses.iter().map(|r| curve_of(season, r, 1)).collect();
        for curve in &curves {
            self.check_finite(curve, obliquities_deg)?;
        }

        let shaded_facets = shading.map_or(0, |s| s.map.shaded_facets());
        let coarser = responses.iter().map(|r| curve_of(half_season, r, 2));
        let off = curves.iter().zip(coarser).map(|(curve, coarser)| curve.distance(&coarser));
        let mut parts = vec![part("declination_nodes", largest(off))];
        let zero = Curve { spin: vec![0.0; obliquities_deg.len()], obliquity: vec![0.0; obliquities_deg.len()] };
        if let Some(errors) = body.sampling_errors(&coarse, coarse_season, memory) {
            for (name, error) in [("azimuth_bins", errors.azimuth_bins), ("facet_sampling", errors.facet_samples)] {
                parts.push(part(name, error.scaled(pressure_pa).distance(&zero)));
            }
        }
        let mut transverse_force_n = Vec::new();
        if let (Some(heat), Some(heated)) = (&heat, &heated) {
            let halved = heat.coarser_cells(&body, &coarse);
            parts.push(part("rotation_cells", curve_of(coarse_season, &halved, 1).distance(&zero)));
            let season = TransverseSeason::new(nodes, obliquities_deg);
            let force = |response: &Vec<f64>| season.curve(response).iter().map(|f| f * pressure_pa).collect();
            transverse_force_n = heated.transverse.iter().map(force).collect();
        }
        let (spin_torque_n_m, obliquity_torque_n_m) = curves.into_iter().map(|c| (c.spin, c.obliquity)).unzip();
        let mut table = TorqueTable {
            obliquity: obliquities_deg.iter().map(|o| if *o == 180.0 { PI } else { o.to_radians() }).collect(),
            omega: heat.map_or(vec![0.0], |heat| heat.spin_rates),
            spin_torque_n_m,
            obliquity_torque_n_m,
            transverse_force_n,
            error: TorqueError::default(),
            shaded_facets,
        };
        if let Some(off) = every_other_spin_rate(&table) {
            parts.push(part("spin_rate_interpolation", off));
        }
        parts.push(part("round_off", [round_off(facets) * pressure_pa; 2]));
        let is_curve = matches!(self.sampling.obliquities, Obliquities::StepDeg(_));
        if let (true, Ok(interpolant)) = (is_curve, table.interpolant(Interpolation::Cubic)) {
            let between = between(obliquities_deg);
            let off = responses.iter().zip(&table.omega).map(|(response, omega)| {
                let (spin, obliquity) = between.iter().map(|o| interpolant.at(o.to_radians(), *omega)).unzip();
                curve_of(&self.seasons.between, response, 1).distance(&Curve { spin, obliquity })
            });
            parts.push(part("obliquity_interpolation", largest(off)));
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

/// Round-off of the sum of all facets' torques, over the pressure, m^3: the sum is what is left when its terms cancel, each of
/// which is right to some ten units in the last place.
fn round_off(facets: &[Facet]) -> f64 {
    let arm = |f: &Facet| f.area * f.point.iter().map(|c| c * c).sum::<f64>().sqrt();
    16.0 * f64::EPSILON * facets.iter().map(arm).sum::<f64>()
}

/// The larger of each of two errors.
fn largest(off: impl Iterator<Item = [f64; 2]>) -> [f64; 2] {
    off.fold([0.0; 2], |worst: [f64; 2], off| [worst[0].max(off[0]), worst[1].max(off[1])])
}

/// How far a table of every other spin rate is off at those left out.
fn every_other_spin_rate(table: &TorqueTable) -> Option<[f64; 2]> {
    if table.omega.len() < 5 {
        return None;
    }
    let every_other = |rows: &[Vec<f64>]| rows.iter().step_by(2).cloned().collect();
    let sparse = TorqueTable {
        obliquity: table.obliquity.clone(),
        omega: table.omega.iter().step_by(2).copied().collect(),
        spin_torque_n_m: every_other(&table.spin_torque_n_m),
        obliquity_torque_n_m: every_other(&table.obliquity_torque_n_m),
        transverse_force_n: Vec::new(),
        error: TorqueError::default(),
        shaded_facets: 0,
    };
    let interpolant = sparse.interpolant(Interpolation::Linear).ok()?;
    // The cubics are of third order or better: half the distance, an eighth of the error.
    let left_out = (1..table.omega.len() - usize::from(table.omega.len().is_multiple_of(2))).step_by(2);
    Some(largest(left_out.map(|w| {
        let (spin, obliquity) = table.obliquity.iter().map(|o| interpolant.at(*o, table.omega[w])).unzip();
        let row = Curve { spin: table.spin_torque_n_m[w].clone(), obliquity: table.obliquity_torque_n_m[w].clone() };
        row.distance(&Curve { spin, obliquity }).map(|off| 0.125 * off)
    })))
}

fn part(name: &str, [spin_torque_n_m, obliquity_torque_n_m]: [f64; 2]) -> ErrorPart {
    ErrorPart { name: name.to_owned(), spin_torque_n_m, obliquity_torque_n_m }
}
