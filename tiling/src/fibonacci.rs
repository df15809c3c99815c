//! A nearly uniform triangulation of the unit sphere with any number of vertices.
//!
//! Vertices: the Fibonacci lattice with offset 1/2, `z_i = 1 - (2 i + 1)/V`, longitude `i` times the golden angle
//! (Swinbank & Purser 2006, Q. J. R. Meteorol. Soc. 132, 1769). Facets: their convex hull, exactly `2 V - 4` triangles,
//! so that 394, 1594 and 9982 vertices give the 784, 3184 and 19 960 facets of Cotto-Figueroa et al. (2015).

use crate::quickhull::convex_hull;
use crate::{Mesh, TilingError};
use std::f64::consts::PI;

/// `count` points of the Fibonacci lattice on the unit sphere, from the north pole to the south.
pub fn fibonacci_points(count: usize) -> Vec<[f64; 3]> {
    let golden_angle = PI * (3.0 - 5f64.sqrt());
    let point = |i: usize| {
        let z = 1.0 - (2 * i + 1) as f64 / count as f64;
        let (sin, cos) = (golden_angle * i as f64).sin_cos();
        let equatorial = ((1.0 - z) * (1.0 + z)).sqrt();
        [equatorial * cos, equatorial * sin, z]
    };
    (0..count).map(point).collect()
}

/// The unit sphere as a mesh of `vertices` (>= 4) vertices, those of [`fibonacci_points`] in their order, and
/// `2 vertices - 4` facets.
///
/// # Errors
/// [`TilingError::VertexCount`] for fewer than 4 vertices or more than `u32` can count.
pub fn unit_sphere(vertices: usize) -> Result<Mesh, TilingError> {
    if !(4..=u32::MAX as usize / 2).contains(&vertices) {
        return Err(TilingError::VertexCount { vertices });
    }
    let points = fibonacci_points(vertices);
    let mesh = convex_hull(&points)?;
    // A hull that lost a point would have renumbered the others.
    if mesh.vertices != points {
        return Err(TilingError::Hull { points: vertices });
    }
    Ok(mesh)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sphere_has_the_counts_and_quality_of_the_reference_triangulation() {
        let table = [
            (394, 784, 0.807, 0.944, 0.99211, 0.98539),
            (1594, 3184, 0.805, 0.921, 0.99804, 0.99630),
            (9982, 19960, 0.805, 0.916, 0.99969, 0.99940),
        ];
        for (vertices, facets, least, mean, area, volume) in table {
            let mesh = unit_sphere(vertices).unwrap();
            assert_eq!(mesh.check(), Ok(()));
            assert_eq!(mesh.facets.len(), facets);
            assert_eq!(mesh.euler_characteristic(), 2);
            let quality: Vec<f64> = (0..facets).map(|f| mesh.quality(f)).collect();
            let rounded =
                |value: f64, want: f64, half_digit: f64| assert!((value - want).abs() <= half_digit, "{value} {want}");
            rounded(quality.iter().copied().fold(1.0, f64::min), least, 0.0005);
            rounded(quality.iter().sum::<f64>() / facets as f64, mean, 0.0005);
            rounded(mesh.surface_area() / (4.0 * PI), area, 0.000005);
            rounded(mesh.volume() / (4.0 * PI / 3.0), volume, 0.000011);
            assert!(mesh.area_vector_sum().iter().all(|c| c.abs() < 1e-12));
            assert!((0..facets).all(|f| mesh.normal(f).dot(&mesh.centroid(f)) > 0.0));
        }
    }

    #[test]
    fn any_count_from_four_gives_a_closed_sphere() {
        for vertices in (4..300).chain([1000, 1001]) {
            let mesh = unit_sphere(vertices).unwrap();
            assert_eq!((mesh.check(), mesh.facets.len()), (Ok(()), 2 * vertices - 4), "{vertices}");
        }
        for vertices in [0, 3, usize::MAX] {
            assert_eq!(unit_sphere(vertices), Err(TilingError::VertexCount { vertices }));
        }
    }
}
