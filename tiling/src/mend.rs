//! Tilings whose facets cross are mended where they do: the vertices there are smoothed along the ellipsoid's normals.
//!
//! Beside a neck or a loose sphere one vertex finds a root far out and its neighbour one deep down, or none and is put on
//! the line to the centre instead: their facets then cross. On their normals vertices have an order that cannot be lost:
//! the normals of an ellipsoid with semi-axes `a >= b >= c` do not meet before the plane of `a` and `b`, which they reach at
//! the depth `c^2 |(x/a^2, y/b^2, z/c^2)|` (that plane holds the medial axis), so that heights over the ellipsoid which vary
//! little from vertex to vertex make a surface without contacts. Crossing facets therefore get, first, their flagged
//! vertices back onto the normals, then heights averaged with those of the neighbours, in the more rings around a
//! crossing the longer it lasts, until there is none. Vertices elsewhere stay where they are, to the last bit.

use crate::implicit::ImplicitSurface;
use crate::project::{EllipsoidTiling, Placed, Placement, Ray};
use crate::{Mesh, TilingError};
use nalgebra::Vector3;

/// Part of the depth at which normals meet that vertices may reach.
const DEEPEST: f64 = 0.9;
/// Rounds of smoothing before the tiling is given up.
const ROUNDS: usize = 90;
/// Rounds of crossing after which one more ring of neighbours is smoothed.
const ROUNDS_PER_RING: usize = 3;
/// Rounds that try to leave vertices alone that have not changed since the tiling before.
const CHANGED_ONLY: usize = 9;

impl EllipsoidTiling {
    /// Moves vertices of `placed` until the mesh is free of contacts; `changed` are those that are not where a legal tiling had
    /// them.
    pub(crate) fn mend(
        &self,
        surface: &ImplicitSurface,
        placed: &mut [Placed],
        changed: &[bool],
    ) -> Result<(), TilingError> {
        let mut mesh = Mesh { vertices: placed.iter().map(|p| p.0).collect(), facets: self.mesh.facets.clone() };
        let Err(mut fault) = mesh.check_body() else { return Ok(()) };
        let neighbours = self.neighbours();
        let mut heights: Vec<f64> = (0..placed.len()).map(|v| self.height(v, placed[v].0)).collect();
        // Rounds in which a vertex was found crossing: the more, the wider the smoothing around it.
        let mut crossed = vec![0; placed.len()];
        for round in 0..ROUNDS {
            let Some(facets) = crossing(&fault) else { return Err(fault) };
            let mut corners: Vec<usize> = facets.iter().flat_map(|f| mesh.facets[*f]).map(|v| v as usize).collect();
            corners.sort_unstable();
            corners.dedup();
            let mut rings = vec![None; placed.len()];
            for v in corners {
                rings[v] = Some(crossed[v] / ROUNDS_PER_RING);
                crossed[v] += 1;
            }
            let mut region = dilated(rings, &neighbours);
            if round < CHANGED_ONLY && region.iter().zip(changed).any(|(r, c)| *r && *c) {
                region.iter_mut().zip(changed).for_each(|(r, c)| *r &= *c);
            }
            if round == 0 {
                // Those that stand on their root stay there, to the last bit.
                region.iter_mut().zip(placed.iter()).for_each(|(r, p)| *r &= p.1 != Placement::Normal);
                self.back_onto_normals(surface, &region, &neighbours, &mut heights);
            } else {
                self.smooth(&region, &neighbours, &mut heights);
            }
            for v in (0..placed.len()).filter(|v| region[*v]) {
                mesh.vertices[v] = self.at_height(v, heights[v]);
            }
            match mesh.check_body() {
                Ok(_) => {
                    for (new, placed) in mesh.vertices.iter().zip(placed.iter_mut()).filter(|(new, p)| **new != p.0) {
                        *placed = (*new, Placement::Mended);
                    }
                    return Ok(());
                }
                Err(next) => fault = next,
            }
        }
        Err(fault)
    }

    /// Height of a point over the ellipsoid along the normal of vertex `v`, m.
    fn height(&self, v: usize, point: [f64; 3]) -> f64 {
        let height = Vector3::from(self.normals[v]).dot(&(Vector3::from(point) - Vector3::from(self.mesh.vertices[v])));
        height.max(-DEEPEST * self.meeting_depth(v))
    }

    fn at_height(&self, v: usize, height: f64) -> [f64; 3] {
        (Vector3::from(self.mesh.vertices[v]) + Vector3::from(self.normals[v]) * height).into()
    }

    /// Depth at which the normal of vertex `v` meets others, m.
    fn meeting_depth(&self, v: usize) -> f64 {
        let shortest = self.semi_axes.iter().copied().fold(f64::INFINITY, f64::min);
        let gradient = Vector3::from(std::array::from_fn::<f64, 3, _>(|k| {
            self.mesh.vertices[v][k] / (self.semi_axes[k] * self.semi_axes[k])
        }));
        shortest * shortest * gradient.norm()
    }

    /// Puts the vertices of a region onto a root of their normal that lies deeper than others are looked for, or at
    /// the height of their neighbours.
    fn back_onto_normals(
        &self,
        surface: &ImplicitSurface,
        region: &[bool],
        neighbours: &[Vec<u32>],
        heights: &mut [f64],
    ) {
        let mut rootless = vec![false; region.len()];
        for v in (0..region.len()).filter(|v| region[*v]) {
            let (start, direction) = (Vector3::from(self.mesh.vertices[v]), Vector3::from(self.normals[v]));
            match (Ray { start, direction, surface }).outermost_root(-DEEPEST * self.meeting_depth(v)) {
                Ok(root) => heights[v] = root,
                Err(_) => rootless[v] = true,
            }
        }
        for v in (0..region.len()).filter(|v| rootless[*v]) {
            let known: Vec<f64> =
                neighbours[v].iter().filter(|n| !rootless[**n as usize]).map(|n| heights[*n as usize]).collect();
            if !known.is_empty() {
                let mean = known.iter().sum::<f64>() / known.len() as f64;
                heights[v] = mean.max(-DEEPEST * self.meeting_depth(v));
            }
        }
    }

    /// Takes half of each height in the region from the neighbours.
    fn smooth(&self, region: &[bool], neighbours: &[Vec<u32>], heights: &mut [f64]) {
        let before = heights.to_vec();
        for v in (0..heights.len()).filter(|v| region[*v]) {
            let around = neighbours[v].iter().map(|n| before[*n as usize]).sum::<f64>() / neighbours[v].len() as f64;
            heights[v] = (0.5 * (before[v] + around)).max(-DEEPEST * self.meeting_depth(v));
        }
    }

    /// Of every vertex those that share an edge with it, ascending.
    fn neighbours(&self) -> Vec<Vec<u32>> {
        let mut neighbours = vec![Vec::new(); self.mesh.vertices.len()];
        for &[a, b, c] in &self.mesh.facets {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                neighbours[from as usize].push(to);
            }
        }
        neighbours.iter_mut().for_each(|n: &mut Vec<u32>| n.sort_unstable());
        neighbours
    }
}

/// The facets of a fault that moving vertices may mend.
fn crossing(fault: &TilingError) -> Option<&[usize]> {
    match fault {
        TilingError::SelfContact { facets, .. } | TilingError::Degenerate { facets } => Some(facets),
        _ => None,
    }
}

/// The vertices within as many rings of neighbours around each one as it asks for.
fn dilated(mut rings: Vec<Option<usize>>, neighbours: &[Vec<u32>]) -> Vec<bool> {
    let widest = rings.iter().flatten().copied().max().unwrap_or(0);
    for ring in (1..=widest).rev() {
        for v in 0..rings.len() {
            if rings[v] != Some(ring) {
                continue;
            }
            for n in &neighbours[v] {
                let around = &mut rings[*n as usize];
                *around = (*around).max(Some(ring - 1));
            }
        }
    }
    rings.iter().map(Option::is_some).collect()
}
