//! A synthetic top-shaped asteroid: a flattened body with an equatorial ridge, by a closed formula.
//!
//! `r(latitude) = R (1 - f sin^2 latitude + h exp(-|latitude| / w))`, the shape class of 1999 KW4 Alpha, Bennu and Ryugu. It
//! is a figure of revolution; nothing in it is measured.

use crate::fibonacci::unit_sphere;
use crate::{Mesh, TilingError};

/// A top shape's parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TopShape {
    /// Equatorial radius without the ridge, `R`, m.
    pub radius_m: f64,
    /// Polar flattening `f`, 0 to below 1. Default 0.15.
    pub flattening: f64,
    /// Height of the ridge over `R`, `h`, >= 0. Default 0.08.
    pub ridge_height: f64,
    /// Angular width of the ridge, `w`, rad, > 0. Default 0.2.
    pub ridge_width_rad: f64,
}

impl TopShape {
    /// A top of this radius (m) with the default proportions.
    pub fn new(radius_m: f64) -> Self {
        Self { radius_m, flattening: 0.15, ridge_height: 0.08, ridge_width_rad: 0.2 }
    }

    /// Distance of the surface from the centre, m, at a latitude, rad.
    pub fn radius_at(&self, latitude: f64) -> f64 {
        let ridge = self.ridge_height * (-latitude.abs() / self.ridge_width_rad).exp();
        self.radius_m * (1.0 - self.flattening * latitude.sin().powi(2) + ridge)
    }

    /// The mesh with `vertices` vertices, hence `2 vertices - 4` facets.
    ///
    /// # Errors
    /// [`TilingError::VertexCount`], or the fault of the mesh if the parameters make no body.
    pub fn mesh(&self, vertices: usize) -> Result<Mesh, TilingError> {
        let mut mesh = unit_sphere(vertices)?;
        for vertex in &mut mesh.vertices {
            let radius = self.radius_at(vertex[2].clamp(-1.0, 1.0).asin());
            *vertex = vertex.map(|c| c * radius);
        }
        mesh.check()?;
        Ok(mesh)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn top_is_a_closed_flattened_body_with_its_ridge_at_the_equator() {
        let top = TopShape::new(500.0);
        assert!((top.radius_at(0.0) - 540.0).abs() < 1e-9);
        assert!((top.radius_at(PI / 2.0) - 425.0).abs() < 0.1);
        let mesh = top.mesh(1002).unwrap();
        assert_eq!((mesh.facets.len(), mesh.euler_characteristic()), (2000, 2));
        let axes = mesh.solid().principal_axes();
        // Figure of revolution: spins about z, the shortest axis.
        assert!(axes.rotation[(2, 2)] > 0.999 && axes.moments[2] > 1.05 * axes.moments[1]);
        let inside_out = TopShape { flattening: 3.0, ..top };
        assert!(inside_out.mesh(1002).is_err());
    }
}
