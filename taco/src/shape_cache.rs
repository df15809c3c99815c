//! Torques of a body that is re-tiled again and again: what a local change does not touch is not computed again.
//!
//! A facet's horizon changes only with its own corners or with a facet that faces it from above its plane, before or after
//! the change; its response, in addition, with the axes of the body. Everything else is kept, and added up in the same
//! order: the table of a re-tiled shape is that of a fresh one to the last bit. With self-heating only horizons are kept.

use crate::body::{Memory, Shading};
use crate::error::TacoError;
use crate::facets::{Facet, facets};
use crate::orbit::Orbit;
use crate::pose::Pose;
use crate::sampling::Sampling;
use crate::scanner::{ScanScratch, Scanner};
use crate::surface::Surface;
use crate::torque::{Seasons, Task, TorqueTable};
use rayon::prelude::*;
use tiling::Mesh;

/// A shape with its horizons and responses, kept from one re-tiling to the next. It holds about 2 kB a facet.
#[derive(Debug)]
pub struct ShapeCache {
    mesh: Mesh,
    surface: Surface,
    sampling: Sampling,
    seasons: Seasons,
    orbit: Orbit,
    facets: Vec<Facet>,
    /// `None` if the surface asks for nothing that depends on what a facet sees.
    shading: Option<Shading>,
    /// Responses in the pose of the last table.
    memory: Memory,
    pose: Pose,
}

impl ShapeCache {
    /// For a closed mesh in any frame, with what a torque table needs. Whether it bounds a body is not checked
    /// ([`tiling::Mesh::check_body`] does).
    ///
    /// # Errors
    /// [`TacoError`] if a parameter is out of range or the mesh is empty or broken.
    pub fn new(mesh: Mesh, surface: &Surface, orbit: &Orbit, sampling: &Sampling) -> Result<Self, TacoError> {
        surface.validate()?;
        orbit.validate()?;
        sampling.validate()?;
        let facets = facets(&mesh)?;
        let shading = Shading::new(&mesh, &facets, surface, sampling);
        Ok(Self {
            mesh,
            surface: surface.clone(),
            sampling: sampling.clone(),
            seasons: Seasons::new(sampling)?,
            orbit: *orbit,
            facets,
            shading,
            memory: Memory::default(),
            pose: Pose::default(),
        })
    }

    /// Moves to another shape, best one with the same facets and most of the vertices; returns how many facets have to be
    /// looked at again.
    ///
    /// # Errors
    /// [`TacoError`] if the mesh is empty or broken; the cache then keeps the shape that it has.
    pub fn retile(&mut self, mesh: Mesh) -> Result<usize, TacoError> {
        let facets = facets(&mesh)?;
        let scanner = self.shading.as_ref().map(|_| Scanner::new(&mesh, self.sampling.azimuth_bins));
        let comparable = mesh.facets == self.mesh.facets
            && mesh.vertices.len() == self.mesh.vertices.len()
            && scanner.as_ref().map(|s| s.tolerance) == self.shading.as_ref().map(|s| s.scanner.tolerance);
        let touched = if comparable { self.touched(&mesh, &facets) } else { (0..facets.len()).collect() };
        let differ = match (&mut self.shading, scanner) {
            (Some(shading), Some(scanner)) => shading.look_again(&mesh, facets.clone(), scanner, &touched),
            _ => vec![true; touched.len()],
        };
        // Light that is followed makes every facet depend on every other.
        let local = self.shading.as_ref().is_none_or(|s| s.exchange.is_none());
        if comparable && local {
            for (&f, differs) in touched.iter().zip(differ) {
                self.memory.forget_differences(f);
                if differs || mesh.corners(f) != self.mesh.corners(f) {
                    self.memory.forget_response(f);
                }
            }
        } else {
            self.memory = Memory::default();
        }
        (self.mesh, self.facets) = (mesh, facets);
        Ok(touched.len())
    }

    /// The table of the shape for a body whose centre of mass and axes lie as `pose` says.
    ///
    /// # Errors
    /// [`TacoError`] if the axes are no rotation or a torque overflows.
    pub fn torque_table(&mut self, pose: &Pose) -> Result<TorqueTable, TacoError> {
        pose.validate()?;
        if *pose != self.pose {
            self.memory = Memory::default();
            self.pose = *pose;
        }
        let task = Task {
            mesh: &self.mesh,
            surface: &self.surface,
            facets: &pose.facets(&self.mesh, &self.facets),
            pose,
            shading: self.shading.as_ref(),
            orbit: &self.orbit,
            sampling: &self.sampling,
            seasons: &self.seasons,
        };
        task.run(Some(&mut self.memory))
    }

    /// The facets whose response or horizon may differ on `new`, which has the same facets on other vertices.
    fn touched(&self, new: &Mesh, new_facets: &[Facet]) -> Vec<usize> {
        let old = &self.mesh;
        let moved: Vec<bool> = old.vertices.iter().zip(&new.vertices).map(|(a, b)| a != b).collect();
        let changed: Vec<bool> = old.facets.iter().map(|f| f.iter().any(|v| moved[*v as usize])).collect();
        if !changed.contains(&true) {
            return Vec::new();
        }
        if self.shading.is_none() {
            return (0..changed.len()).filter(|f| changed[*f]).collect();
        }
        // The changed facets as they were and as they are.
        let offset = old.vertices.len() as u32;
        let as_was = old.facets.iter().zip(&changed).filter(|(_, c)| **c).map(|(f, _)| *f);
        let both = Mesh {
            vertices: old.vertices.iter().chain(&new.vertices).copied().collect(),
            facets: as_was.clone().chain(as_was.map(|f| f.map(|v| v + offset))).collect(),
        };
        let change = Scanner::new(&both, self.sampling.azimuth_bins);
        let look = |scratch: &mut ScanScratch, f: usize| {
            changed[f] || change.concerns(&new_facets[f], &new.corners(f).map(Into::into), scratch)
        };
        let touched: Vec<bool> = (0..changed.len()).into_par_iter().map_init(ScanScratch::default, look).collect();
        (0..touched.len()).filter(|f| touched[*f]).collect()
    }
}
