//! Torque responses with heat at each spin rate.

use crate::body::Body;
use crate::declination::Declinations;
use crate::exchange::Coupled;
use crate::heat::delayed::{Delayed, TOLERANCE};
use crate::heat::flux::{FluxNode, flux_nodes, unit_thermal_parameter};
use crate::heat::wall::{Walls, parameters};
use crate::orbit::Orbit;
use crate::recoil::RecoilKernel;
use crate::sampling::Sampling;
use crate::surface::{Surface, Wall};

/// One in this many facets is computed with half the cells, to estimate what they cost.
const SAMPLED_ONE_IN: usize = 16;
/// At least this many facets are.
const SAMPLED_AT_LEAST: usize = 48;

/// What is to be computed beyond a body that stores no heat.
pub(crate) struct Heat<'a> {
    /// Spin rates, rad/s.
    pub spin_rates: Vec<f64>,
    thermal_inertia: f64,
    emissivity: f64,
    wall: Option<&'a Wall>,
    fluxes: Vec<FluxNode>,
    cells: usize,
}

/// Responses per unit of the mean pressure of sunlight.
pub(crate) struct Heated {
    /// `[tau_z, tau_u]` at each declination, one response a spin rate.
    pub responses: Vec<Vec<f64>>,
    /// `F_w` at each declination, one response a spin rate; none unless the ground stores heat.
    pub transverse: Vec<Vec<f64>>,
}

impl<'a> Heat<'a> {
    /// `None` for a surface that stores no heat.
    pub fn new(surface: &'a Surface, orbit: &Orbit, sampling: &Sampling) -> Option<Self> {
        let Surface { thermal_inertia, emissivity, .. } = *surface;
        let wall = surface.tangential_yorp.as_ref().filter(|wall| wall.coverage > 0.0);
        let largest = wall.map_or(thermal_inertia, |wall| thermal_inertia.max(wall.thermal_inertia));
        let unit_theta = largest * unit_thermal_parameter(orbit.mean_flux_w_m2(), emissivity);
        let spin_rates = sampling.spin_rates.rad_s(unit_theta);
        let (fluxes, cells) = (flux_nodes(orbit), sampling.rotation_cells);
        (largest > 0.0).then_some(Self { spin_rates, thermal_inertia, emissivity, wall, fluxes, cells })
    }

    /// Thermal parameters of the ground at a spin rate, one for each flux.
    fn thetas(&self, omega: f64) -> impl Iterator<Item = f64> {
        let unit = |node: &FluxNode| unit_thermal_parameter(node.flux_w_m2, self.emissivity);
        self.fluxes.iter().map(move |node| self.thermal_inertia * omega.sqrt() * unit(node))
    }

    /// The responses of `body` at each spin rate, given that without heat.
    pub fn add<K: RecoilKernel>(&self, body: &Body<'_, K>, declinations: &Declinations, base: &[f64]) -> Heated {
        let mut responses = vec![base.to_vec(); self.spin_rates.len()];
        let mut transverse = Vec::new();
        if self.thermal_inertia > 0.0 {
            let thetas: Vec<f64> = self.spin_rates.iter().flat_map(|omega| self.thetas(*omega)).collect();
            let all: Vec<usize> = (0..body.facets.len()).collect();
            let coupled = Coupled::new(body, declinations, &thetas, self.cells, TOLERANCE);
            let delayed = Delayed::responses(body, &all, declinations, &thetas, self.cells, coupled.as_ref());
            for (rate, response) in delayed.chunks(self.fluxes.len()).zip(&mut responses) {
                let mut force = vec![0.0; declinations.len()];
                for (delayed, node) in rate.iter().zip(&self.fluxes) {
                    for j in 0..declinations.len() {
                        response[2 * j + 1] += node.torque * delayed.along_sun[j];
                        force[j] += node.force * delayed.transverse[j];
                    }
                }
                transverse.push(force);
            }
        }
        if let Some(wall) = self.wall {
            for (omega, response) in self.spin_rates.iter().zip(&mut responses) {
                self.add_walls(wall, *omega, body, declinations, response);
            }
        }
        Heated { responses, transverse }
    }

    fn add_walls<K: RecoilKernel>(
        &self,
        wall: &Wall,
        omega: f64,
        body: &Body<'_, K>,
        declinations: &Declinations,
        response: &mut [f64],
    ) {
        if omega == 0.0 {
            return;
        }
        for node in &self.fluxes {
            let unit = unit_thermal_parameter(node.flux_w_m2, self.emissivity);
            let [theta, lengths] = parameters(wall, omega, unit);
            let walls = Walls::new(body.kernel, declinations, theta, lengths, self.cells);
            let mut torque = vec![0.0; declinations.len()];
            for facet in body.facets {
                walls.add(facet, wall.coverage, &mut torque);
            }
            for (along, torque) in response.chunks_mut(2).zip(torque) {
                along[0] += node.torque * torque;
            }
        }
    }

    /// What halving the number of cells adds to the response, at the middle spin rate: from a sample of the facets,
    /// without light from one to another.
    pub fn coarser_cells<K: RecoilKernel>(&self, body: &Body<'_, K>, declinations: &Declinations) -> Vec<f64> {
        let mut response = vec![0.0; 2 * declinations.len()];
        if self.thermal_inertia == 0.0 {
            return response;
        }
        let stride = (body.facets.len() / SAMPLED_AT_LEAST).clamp(1, SAMPLED_ONE_IN);
        let sample: Vec<usize> = (0..body.facets.len()).step_by(stride).collect();
        let scale = body.facets.len() as f64 / sample.len() as f64;
        let thetas: Vec<f64> = self.thetas(self.spin_rates[self.spin_rates.len() / 2]).collect();
        let at = |cells| Delayed::responses(body, &sample, declinations, &thetas, cells, None);
        // An even number, as close to half as there is.
        for ((fine, coarse), node) in at(self.cells).iter().zip(&at(self.cells / 4 * 2)).zip(&self.fluxes) {
            for j in 0..declinations.len() {
                response[2 * j + 1] += scale * node.torque * (coarse.along_sun[j] - fine.along_sun[j]);
            }
        }
        response
    }
}
