//! Facets as the radiation sees them: place, area and a frame tied to the spin axis.

use crate::error::TacoError;
use tiling::Mesh;

/// One point of the surface with its frame. "Meridian" is the horizontal direction of the normal, "east" is 90 deg
/// further along the rotation, so that a body turned about its spin axis gives the same numbers facet by facet.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Facet {
    /// Where light arrives and recoil acts, m, body frame.
    pub point: [f64; 3],
    /// Area, m^2.
    pub area: f64,
    /// Sine of the latitude of the normal.
    pub sin_lat: f64,
    /// Cosine of the latitude of the normal.
    pub cos_lat: f64,
    /// Horizontal unit vector of the normal, body x and y; x for a normal along the spin axis.
    pub meridian: [f64; 2],
    /// Cosine and sine of the angle, from north over west, of the direction from which the horizon's azimuths are counted.
    pub azimuth_origin: [f64; 2],
}

impl Facet {
    pub fn new(point: [f64; 3], area_vector: [f64; 3]) -> Self {
        let [x, y, z] = area_vector;
        let horizontal = x.hypot(y);
        let area = horizontal.hypot(z);
        // A normal this close to the axis has no meridian worth its round-off.
        let polar = horizontal <= 1e-12 * area;
        let (meridian, cos_lat) =
            if polar { ([1.0, 0.0], 0.0) } else { ([x / horizontal, y / horizontal], horizontal / area) };
        let sin_lat = if polar { z.signum() } else { z / area };
        Self { point, area, sin_lat, cos_lat, meridian, azimuth_origin: [1.0, 0.0] }
    }

    /// The facet with a horizon whose azimuths are counted from a direction in its plane.
    pub fn with_azimuths_from(self, direction: [f64; 3]) -> Self {
        let [north, west, _] = self.horizon_axes();
        let along = |axis: [f64; 3]| (0..3).map(|k| axis[k] * direction[k]).sum::<f64>();
        let (c, s) = (along(north), along(west));
        let length = c.hypot(s);
        Self { azimuth_origin: [c / length, s / length], ..self }
    }

    /// A direction in the facet's plane, as components along the origin of the azimuths and a quarter turn further, turned
    /// to components along north and west.
    #[inline(always)]
    pub fn north_west(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [c, s] = self.azimuth_origin;
        [c * x - s * y, s * x + c * y]
    }

    /// The opposite of [`Self::north_west`].
    #[inline(always)]
    pub fn azimuth_axes(&self, [north, west]: [f64; 2]) -> [f64; 2] {
        let [c, s] = self.azimuth_origin;
        [c * north + s * west, c * west - s * north]
    }

    /// Unit area at the origin, its normal at this latitude (rad).
    pub fn at_latitude(latitude: f64) -> Self {
        let (sin, cos) = latitude.sin_cos();
        Self::new([0.0; 3], [cos, 0.0, sin])
    }

    /// Latitude of the normal, rad.
    pub fn latitude(&self) -> f64 {
        self.sin_lat.atan2(self.cos_lat)
    }

    /// Axes of the horizon: north, west and the normal, body frame. Azimuth runs from north over west.
    pub fn horizon_axes(&self) -> [[f64; 3]; 3] {
        let ([mx, my], s, c) = (self.meridian, self.sin_lat, self.cos_lat);
        [[-s * mx, -s * my, c], [my, -mx, 0.0], [c * mx, c * my, s]]
    }

    /// The point in (meridian, east, spin axis) components, m.
    pub fn local_point(&self) -> [f64; 3] {
        self.local(self.point)
    }

    /// A vector of the body frame in (meridian, east, spin axis) components.
    pub fn local(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [mx, my] = self.meridian;
        [x * mx + y * my, y * mx - x * my, z]
    }

    /// The same facet seen from another point of it.
    pub fn at(&self, point: [f64; 3]) -> Self {
        Self { point, ..*self }
    }
}

/// All facets, seen from their centroids.
///
/// # Errors
/// [`TacoError`] if there is none, a vertex is not finite or a facet refers to a vertex that does not exist.
pub(crate) fn facets(mesh: &Mesh) -> Result<Vec<Facet>, TacoError> {
    if mesh.facets.is_empty() {
        return Err(TacoError::EmptyMesh);
    }
    if let Some(vertex) = mesh.vertices.iter().position(|v| v.iter().any(|c| !c.is_finite())) {
        return Err(TacoError::BadVertex { vertex });
    }
    let vertices = mesh.vertices.len();
    for (facet, corners) in mesh.facets.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|v| **v as usize >= vertices) {
            return Err(TacoError::BadFacet { facet, vertex, vertices });
        }
    }
    Ok((0..mesh.facets.len()).map(|f| Facet::new(mesh.centroid(f).into(), mesh.area_vector(f).into())).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
        a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    }

    #[test]
    fn horizon_axes_are_a_right_handed_frame_towards_north() {
        for n in [[1.0, 2.0, 3.0], [-1.0, 0.5, -2.0], [0.0, 0.0, 2.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]] {
            let [north, west, up] = Facet::new([0.0; 3], n).horizon_axes();
            let norm = dot(n, n).sqrt();
            for k in 0..3 {
                let cross = north[(k + 1) % 3] * west[(k + 2) % 3] - north[(k + 2) % 3] * west[(k + 1) % 3];
                assert!((up[k] - n[k] / norm).abs() < 1e-15 && (cross - up[k]).abs() < 1e-15);
            }
            assert!(dot(north, up).abs() < 1e-15 && dot(west, up).abs() < 1e-15 && north[2] >= 0.0);
        }
    }

    #[test]
    fn broken_meshes_are_refused() {
        let mut mesh = Mesh { vertices: vec![[0.0; 3]; 3], facets: vec![] };
        assert_eq!(facets(&mesh).err(), Some(TacoError::EmptyMesh));
        mesh.facets.push([0, 1, 3]);
        assert_eq!(facets(&mesh).err(), Some(TacoError::BadFacet { facet: 0, vertex: 3, vertices: 3 }));
        mesh.vertices[1][2] = f64::NAN;
        assert_eq!(facets(&mesh).err(), Some(TacoError::BadVertex { vertex: 1 }));
    }
}
