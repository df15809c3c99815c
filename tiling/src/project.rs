//! The tiling of an aggregate: the equivalent ellipsoid's tiling, its vertices moved along the ellipsoid's normals onto
//! the implicit surface.
//!
//! Source: Cotto-Figueroa et al. (2015), section 2.4.1. Frame: that of the ellipsoid, centre of mass at the origin.
//!
//! On a normal the outermost root counts: overhangs and loose spheres make several. It is bracketed on the way in by
//! steps that cannot jump over one ([`ImplicitSurface::sample`]), but never shorter than a tenth of the smallest
//! radius, and refined to a millionth of it. The way in ends at the ellipsoid's smallest radius of curvature, `c^2/a`,
//! beyond which normals cross and the mapping folds; a vertex without a root until there is looked for on the straight
//! line to the centre of mass and flagged. Where facets cross for all that, the tiling is mended (the module `mend`): every
//! tiling passes [`Mesh::check_body`].

use crate::fibonacci::unit_sphere;
use crate::implicit::ImplicitSurface;
use crate::{Mesh, TilingError};
use nalgebra::Vector3;
use rayon::prelude::*;

/// Shortest step of the way in, over the smallest radius. A root pair nearer together than this may be missed.
const SHORTEST_STEP: f64 = 0.1;

/// Accuracy of a root, over the smallest radius.
const ACCURACY: f64 = 1e-6;

/// An ellipsoid's tiling: what every tiling of an aggregate starts from.
#[derive(Debug, Clone, PartialEq)]
pub struct EllipsoidTiling {
    /// The mesh on the ellipsoid.
    pub mesh: Mesh,
    /// Outward unit normals of the ellipsoid at the vertices.
    pub normals: Vec<[f64; 3]>,
    /// Semi-axes along x, y, z, m.
    pub semi_axes: [f64; 3],
}

/// An aggregate's tiling.
#[derive(Debug, Clone, PartialEq)]
pub struct Tiling {
    /// The mesh; same facets and vertex numbers as the ellipsoid's. Its volume is the denominator of the "tiling" density.
    pub mesh: Mesh,
    /// Vertices, ascending, that are not on the outermost root of their normal.
    pub flagged: Vec<FlaggedVertex>,
    /// Vertices that are where the previous tiling had them; 0 for a first tiling.
    pub kept: usize,
    /// Vertices that moved from where the previous tiling had them; all for a first tiling.
    pub moved: usize,
}

/// A vertex without a root on its normal, or moved off it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FlaggedVertex {
    /// The vertex.
    pub vertex: usize,
    /// Where it was put.
    pub placement: Placement,
}

/// Where a vertex stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Placement {
    /// On the outermost root along the ellipsoid's normal.
    Normal,
    /// On the outermost root along the line from the centre of mass.
    Radial,
    /// Where that line comes nearest to the surface, which it does not meet.
    Nearest,
    /// On the normal, but off the surface: facets would cross otherwise.
    Mended,
}

/// A vertex's position (m) and how it was found.
pub(crate) type Placed = ([f64; 3], Placement);

impl EllipsoidTiling {
    /// The ellipsoid with `semi_axes` (m, each > 0) along x, y, z and `vertices` vertices, hence `2 vertices - 4` facets.
    ///
    /// # Errors
    /// [`TilingError::VertexCount`], and [`TilingError::BadEllipsoid`] for an axis that is not finite and positive.
    pub fn new(semi_axes: [f64; 3], vertices: usize) -> Result<Self, TilingError> {
        Self::turned(semi_axes, vertices, 0.0)
    }

    /// The same with the pattern of vertices turned about z by an angle (rad): another sample of the same surface.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn turned(semi_axes: [f64; 3], vertices: usize, turn: f64) -> Result<Self, TilingError> {
        if semi_axes.iter().any(|axis| !(axis.is_finite() && *axis > 0.0)) {
            return Err(TilingError::BadEllipsoid { semi_axes });
        }
        let axes = Vector3::from(semi_axes);
        let mut mesh = unit_sphere(vertices)?;
        if turn != 0.0 {
            let (sin, cos) = turn.sin_cos();
            mesh.vertices.iter_mut().for_each(|[x, y, _]| (*x, *y) = (cos * *x - sin * *y, sin * *x + cos * *y));
        }
        let normals = mesh.vertices.iter().map(|u| Vector3::from(*u).component_div(&axes).normalize().into()).collect();
        for vertex in &mut mesh.vertices {
            *vertex = Vector3::from(*vertex).component_mul(&axes).into();
        }
        Ok(Self { mesh, normals, semi_axes })
    }

    /// Smallest radius of curvature, m: normals do not cross nearer than this below the surface.
    pub fn smallest_curvature_radius(&self) -> f64 {
        let longest = self.semi_axes.iter().copied().fold(0.0, f64::max);
        let shortest = self.semi_axes.iter().copied().fold(f64::INFINITY, f64::min);
        shortest * shortest / longest
    }

    /// Fits the tiling to a surface. The mesh bounds a body: it passes [`Mesh::check_body`].
    ///
    /// # Errors
    /// The fault of a tiling that cannot be mended.
    pub fn projected(&self, surface: &ImplicitSurface) -> Result<Tiling, TilingError> {
        let mut placed = self.placed(surface);
        self.mend(surface, &mut placed, &vec![true; self.normals.len()])?;
        let vertices = placed.iter().map(|p| p.0).collect();
        let mesh = Mesh { vertices, facets: self.mesh.facets.clone() };
        Ok(Tiling { moved: placed.len(), kept: 0, flagged: flagged(&placed), mesh })
    }

    /// All vertices on the surface, in order whatever the number of threads.
    pub(crate) fn placed(&self, surface: &ImplicitSurface) -> Vec<Placed> {
        (0..self.normals.len()).into_par_iter().map(|vertex| self.placed_vertex(vertex, surface)).collect()
    }

    pub(crate) fn placed_vertex(&self, vertex: usize, surface: &ImplicitSurface) -> Placed {
        let start = Vector3::from(self.mesh.vertices[vertex]);
        let normal = Ray { start, direction: Vector3::from(self.normals[vertex]), surface };
        if let Ok(s) = normal.outermost_root(-self.smallest_curvature_radius()) {
            return (normal.at(s), Placement::Normal);
        }
        let radial = Ray { start: Vector3::zeros(), direction: start.normalize(), surface };
        match radial.outermost_root(0.0) {
            Ok(s) => (radial.at(s), Placement::Radial),
            Err(nearest) => (radial.at(nearest), Placement::Nearest),
        }
    }
}

pub(crate) fn flagged(placed: &[Placed]) -> Vec<FlaggedVertex> {
    let flag = |(vertex, placed): (usize, &Placed)| FlaggedVertex { vertex, placement: placed.1 };
    placed.iter().enumerate().map(flag).filter(|f| f.placement != Placement::Normal).collect()
}

/// A line through the body.
pub(crate) struct Ray<'a> {
    pub start: Vector3<f64>,
    pub direction: Vector3<f64>,
    pub surface: &'a ImplicitSurface,
}

impl Ray<'_> {
    fn at(&self, s: f64) -> [f64; 3] {
        (self.start + self.direction * s).into()
    }

    /// The largest root `s >= end` (m from the start); without one, where on the way `G` was largest.
    pub fn outermost_root(&self, end: f64) -> Result<f64, f64> {
        let (smallest, largest) = self.surface.radii();
        let mut s = self.surface.reach(self.direction.into()) - self.direction.dot(&self.start) + 2.0 * largest;
        // Low levels and exponents lift the surface off the spheres. Far away G tends to -G0 < 0.
        let mut stride = 2.0 * largest;
        while self.surface.value(self.at(s)) >= 0.0 {
            s += stride;
            stride *= 2.0;
        }
        let mut here = self.surface.sample(self.at(s));
        let (mut best, mut best_value) = (s.max(end), f64::NEG_INFINITY);
        while s > end {
            let next = (s - here.clearance.max(SHORTEST_STEP * smallest)).max(end);
            let there = self.surface.sample(self.at(next));
            if there.value >= 0.0 {
                return Ok(self.refined((next, there.value), (s, here.value), ACCURACY * smallest));
            }
            if there.value > best_value {
                (best, best_value) = (next, there.value);
            }
            (s, here) = (next, there);
        }
        Err(best)
    }

    /// The root between `inside` (`G >= 0`) and `outside` (`G < 0`), each `(s, G)`: the false position with halving of the
    /// stale end (Dowell & Jarratt 1971), which keeps the bracket.
    fn refined(&self, mut inside: (f64, f64), mut outside: (f64, f64), accuracy: f64) -> f64 {
        let mut last_was_inside = None;
        let mut step = 0;
        loop {
            step += 1;
            let width = outside.0 - inside.0;
            let secant = inside.0 + width * (inside.1 / (inside.1 - outside.1));
            // Every third step halves the bracket, which bounds their number.
            let s = if step % 3 == 0 { inside.0 + 0.5 * width } else { secant };
            if width <= accuracy || s <= inside.0 || s >= outside.0 {
                return s;
            }
            let value = self.surface.value(self.at(s));
            let is_inside = value >= 0.0;
            if is_inside {
                inside = (s, value);
                outside.1 *= if last_was_inside == Some(true) { 0.5 } else { 1.0 };
            } else {
                outside = (s, value);
                inside.1 *= if last_was_inside == Some(false) { 0.5 } else { 1.0 };
            }
            last_was_inside = Some(is_inside);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sphere_surface(spheres: &[[f64; 4]]) -> ImplicitSurface {
        let column = |k: usize| spheres.iter().map(|s| s[k]).collect::<Vec<_>>();
        ImplicitSurface::new(&column(0), &column(1), &column(2), &column(3), 2, 1.25).unwrap()
    }

    #[test]
    fn a_turned_pattern_lies_on_the_same_ellipsoid() {
        let axes = [3.0, 2.0, 1.0];
        let (plain, turned) =
            (EllipsoidTiling::new(axes, 100).unwrap(), EllipsoidTiling::turned(axes, 100, 0.3).unwrap());
        assert_eq!(plain.mesh.facets, turned.mesh.facets);
        for (a, b) in plain.mesh.vertices.iter().zip(&turned.mesh.vertices) {
            let level: f64 = (0..3).map(|k| (b[k] / axes[k]).powi(2)).sum();
            assert!((level - 1.0).abs() < 1e-14 && a[2] == b[2]);
        }
    }

    #[test]
    fn ellipsoid_tiling_lies_on_the_ellipsoid_with_its_normals() {
        let axes = [3.0, 2.0, 1.5];
        let tiling = EllipsoidTiling::new(axes, 100).unwrap();
        assert_eq!(tiling.mesh.check(), Ok(()));
        for (vertex, normal) in tiling.mesh.vertices.iter().zip(&tiling.normals) {
            let scaled: Vec<f64> = (0..3).map(|k| vertex[k] / axes[k]).collect();
            assert!((scaled.iter().map(|c| c * c).sum::<f64>() - 1.0).abs() < 1e-14);
            let gradient = Vector3::new(scaled[0] / axes[0], scaled[1] / axes[1], scaled[2] / axes[2]);
            assert!(
                gradient.cross(&Vector3::from(*normal)).norm() < 1e-14 && gradient.dot(&Vector3::from(*normal)) > 0.0
            );
        }
        assert_eq!(tiling.smallest_curvature_radius(), 0.75);
        assert!(matches!(EllipsoidTiling::new([1.0, 0.0, 1.0], 100), Err(TilingError::BadEllipsoid { .. })));
    }

    /// R G0^(-1/4), to the stated accuracy of 1e-6 R.
    #[test]
    fn one_sphere_is_tiled_at_its_level_radius() {
        let fitted =
            EllipsoidTiling::new([40.0; 3], 394).unwrap().projected(&sphere_surface(&[[0.0, 0.0, 0.0, 50.0]])).unwrap();
        let radius = 50.0 * 1.25f64.powf(-0.25);
        assert!(fitted.mesh.vertices.iter().all(|v| (Vector3::from(*v).norm() - radius).abs() < 5e-5));
        assert_eq!((fitted.flagged.len(), fitted.kept, fitted.moved), (0, 0, 394));
        assert_eq!(fitted.mesh.check(), Ok(()));
    }

    #[test]
    fn outermost_of_several_roots_counts() {
        let two = sphere_surface(&[[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 9.0, 1.0]]);
        let ray = Ray { start: Vector3::new(0.0, 0.0, 1.0), direction: Vector3::z(), surface: &two };
        let s = ray.outermost_root(-1.0).unwrap();
        assert!((s - (8.0 + 1.25f64.powf(-0.25))).abs() < 1e-3, "{s}");
        // The deepest point counts as a root too: the ray may end inside.
        let inside = Ray { start: Vector3::new(0.0, 0.0, 1.0), direction: Vector3::z(), surface: &two };
        assert!(inside.outermost_root(8.5).is_ok());
    }

    /// A wide ring around nothing: no root below the poles. The vertices there fall to the centre line, both sheets into one
    /// plane; mended, the hole is closed by two sheets apart.
    #[test]
    fn vertices_above_a_void_are_flagged_and_the_sheets_stay_apart() {
        let ring: Vec<[f64; 4]> = (0..40)
            .map(|i| f64::from(i) * std::f64::consts::PI / 20.0)
            .map(|a| [6.0 * a.cos(), 6.0 * a.sin(), 0.0, 0.5])
            .collect();
        let ellipsoid = EllipsoidTiling::new([6.0, 6.0, 3.0], 394).unwrap();
        let placed = ellipsoid.placed(&sphere_surface(&ring));
        assert!(flagged(&placed).iter().any(|f| f.placement == Placement::Nearest));
        assert!(placed.iter().flat_map(|p| p.0).all(|c| c.is_finite()));
        let fitted = ellipsoid.projected(&sphere_surface(&ring)).unwrap();
        assert!(fitted.mesh.check_body().is_ok());
        assert!(fitted.flagged.iter().any(|f| f.placement == Placement::Mended));
        assert!(fitted.flagged.windows(2).all(|pair| pair[0].vertex < pair[1].vertex));
    }
}
