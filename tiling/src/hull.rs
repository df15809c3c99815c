//! Volume of the convex hull of spheres (the "hull" density divides by it).
//!
//! The hull of spheres of one radius `R` is the hull `K` of their centres grown by `R`, whose volume is exactly
//! `V(K) + S(K) R + M(K) R^2 + 4/3 pi R^3` (Steiner), `M = 1/2 sum over edges (length x exterior angle)`. Unequal spheres
//! share their smallest radius in that formula; what the radii exceed it by is sampled with Fibonacci points, so the
//! volume comes out too small, by at most about `4 (R_max - R_min) S(K) / points`.

use crate::fibonacci::fibonacci_points;
use crate::quickhull::convex_hull;
use crate::{Mesh, TilingError};
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Sample points on a sphere larger than the smallest one.
const POINTS_PER_SPHERE: usize = 200;

/// Directions in which the outermost sphere is looked for before the hull is built.
const PRUNING_DIRECTIONS: usize = 256;

/// Volume of the convex hull of spheres, m^3: centres `x`, `y`, `z` (m) and radii (m, > 0), all of one length.
///
/// # Errors
/// [`TilingError::Hull`] if there is no sphere or a value is not finite.
pub fn sphere_hull_volume(x: &[f64], y: &[f64], z: &[f64], radius: &[f64]) -> Result<f64, TilingError> {
    let spheres: Vec<Sphere> = (0..radius.len()).map(|i| (Vector3::new(x[i], y[i], z[i]), radius[i])).collect();
    let spheres = without_inner(&spheres);
    let smallest = spheres.iter().fold(f64::INFINITY, |least, s| least.min(s.1));
    // Centres in a plane, on a line or in a point get a little body of their own in the second attempt.
    let attempt = |shared: f64, at_least: usize| {
        let points: Vec<[f64; 3]> = spheres.iter().flat_map(|s| sampled(*s, shared, at_least)).collect();
        convex_hull(&points).map(|core| grown_volume(&core, shared))
    };
    attempt(smallest, 1).or_else(|_| attempt(0.99 * smallest, 60))
}

/// Centre and radius, m.
type Sphere = (Vector3<f64>, f64);

/// Points of which `sphere` is, nearly, the hull grown by `shared`.
fn sampled((centre, radius): Sphere, shared: f64, at_least: usize) -> Vec<[f64; 3]> {
    let excess = radius - shared;
    let points = if excess > 1e-3 * shared { POINTS_PER_SPHERE.max(at_least) } else { at_least };
    if points == 1 {
        return vec![centre.into()];
    }
    fibonacci_points(points).into_iter().map(|d| (centre + Vector3::from(d) * excess).into()).collect()
}

/// Steiner's formula.
fn grown_volume(core: &Mesh, radius: f64) -> f64 {
    let bend = |(ends, left, right): ((u32, u32), usize, usize)| {
        let [from, to] = [ends.0, ends.1].map(|v| Vector3::from(core.vertices[v as usize]));
        let (n1, n2) = (core.area_vector(left), core.area_vector(right));
        let along = to - from;
        // Signed, so that the senseless normals of slivers cancel over their sides.
        along.norm() * (n1.cross(&n2).dot(&along) / along.norm()).atan2(n1.dot(&n2))
    };
    let mean_curvature = 0.5 * core.edge_neighbours().map(bend).sum::<f64>();
    core.volume() + radius * (core.surface_area() + radius * (mean_curvature + radius * (4.0 / 3.0 * PI)))
}

/// Leaves out spheres that lie wholly inside a coarse hull of the outermost ones: they cannot touch the hull of all.
fn without_inner(spheres: &[Sphere]) -> Vec<Sphere> {
    let outermost = |direction: [f64; 3]| {
        let direction = Vector3::from(direction);
        let reach = |s: &Sphere| s.0.dot(&direction) + s.1;
        let furthest = spheres.iter().max_by(|a, b| reach(a).total_cmp(&reach(b)))?;
        Some((furthest.0 + direction * furthest.1).into())
    };
    let mut outer: Vec<[f64; 3]> = fibonacci_points(PRUNING_DIRECTIONS).into_iter().filter_map(outermost).collect();
    outer.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])).then(a[2].total_cmp(&b[2])));
    outer.dedup();
    let Ok(coarse) = convex_hull(&outer) else { return spheres.to_vec() };
    let planes: Vec<(Vector3<f64>, f64)> = (0..coarse.facets.len())
        .map(|f| {
            let normal = coarse.normal(f);
            (normal, normal.dot(&coarse.corners(f)[0]))
        })
        .collect();
    spheres.iter().filter(|s| planes.iter().any(|(normal, d)| normal.dot(&s.0) + s.1 >= *d)).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn volume_of(spheres: &[([f64; 3], f64)]) -> f64 {
        let column = |k: usize| spheres.iter().map(|s| s.0[k]).collect::<Vec<_>>();
        let radius: Vec<f64> = spheres.iter().map(|s| s.1).collect();
        sphere_hull_volume(&column(0), &column(1), &column(2), &radius).unwrap()
    }

    fn assert_near(got: f64, want: f64, tolerance: f64) {
        assert!((got / want - 1.0).abs() < tolerance, "{got} instead of {want}: {:e}", got / want - 1.0);
    }

    /// Steiner's formula for a cube of side a: V = a^3 + 6 a^2 R + 3 pi a R^2 + 4/3 pi R^3; a cube of 5 x 5 x 5 centres has
    /// 98 of them on its faces.
    #[test]
    fn cubic_lattice_is_a_rounded_cube() {
        let axis = [-2.0, -1.0, 0.0, 1.0, 2.0];
        let spheres: Vec<_> =
            axis.iter().flat_map(|x| axis.iter().flat_map(move |y| axis.map(|z| ([*x, *y, z], 0.5)))).collect();
        let (a, r) = (4f64, 0.5f64);
        let want = a.powi(3) + 6.0 * a * a * r + 3.0 * PI * a * r * r + 4.0 / 3.0 * PI * r.powi(3);
        assert_near(volume_of(&spheres), want, 1e-5);
    }

    #[test]
    fn close_packed_ball_is_hulled_although_many_centres_share_planes() {
        for stacking in [[0, 1, 0, 1, 0, 1, 0], [0, 1, 2, 0, 1, 2, 0]] {
            let mut spheres = Vec::new();
            for (layer, shift) in stacking.into_iter().enumerate() {
                for i in -8i32..8 {
                    for j in -8i32..8 {
                        let y = 3f64.sqrt() * (f64::from(j) + f64::from(shift) / 3.0);
                        let x = 2.0 * f64::from(i) + f64::from(j + shift);
                        let z = (8f64 / 3.0).sqrt() * (layer as f64 - 3.0);
                        if x * x + y * y + z * z < 36.0 {
                            spheres.push(([x, y, z], 1.0));
                        }
                    }
                }
            }
            let points: Vec<_> = (spheres.iter())
                .flat_map(|s| fibonacci_points(100).into_iter().map(|d| [0, 1, 2].map(|k| s.0[k] + d[k])))
                .collect();
            let sampled = convex_hull(&points).unwrap().volume();
            let volume = volume_of(&spheres);
            assert!(volume > sampled && volume < 1.02 * sampled, "{} {volume} {sampled}", spheres.len());
        }
    }

    /// Ball, capsule and stadium: no hull of the centres has a volume there.
    #[test]
    fn centres_in_a_point_on_a_line_or_in_a_plane_have_their_hull_within_a_thousandth() {
        let ball = 4.0 / 3.0 * PI;
        assert_near(volume_of(&[([5.0, 6.0, 7.0], 1.0)]), ball, 5e-4);
        let row: Vec<_> = (0..10).map(|i| ([f64::from(i), f64::from(2 * i), 0.0], 1.0)).collect();
        assert_near(volume_of(&row), ball + PI * 405f64.sqrt(), 5e-4);
        let sheet: Vec<_> = (0..100).map(|i| ([f64::from(i % 10), 3.0, f64::from(i / 10)], 1.0)).collect();
        assert_near(volume_of(&sheet), ball + 2.0 * 81.0 + PI * 18.0, 5e-4);
    }

    /// A ball of radius 2 that swallows a ball of radius 1, and a cone frustum with round ends.
    #[test]
    fn unequal_spheres_are_within_the_stated_bias() {
        let both = volume_of(&[([0.0; 3], 2.0), ([0.5, 0.0, 0.0], 1.0)]);
        assert_near(both, 32.0 / 3.0 * PI, 0.02);
        assert!(both < 32.0 / 3.0 * PI);
        // Two balls of radii 2 and 1, centres 4 apart: the tangent cone has sin(alpha) = 1/4.
        let (r1, r2, d) = (2f64, 1f64, 4f64);
        let sin = (r1 - r2) / d;
        let cap = |r: f64, h: f64| PI * h * h * (r - h / 3.0);
        let (big, small) = ((1.0 - sin * sin).sqrt() * r1, (1.0 - sin * sin).sqrt() * r2);
        let height = d - r1 * sin + r2 * sin;
        let want = cap(r1, r1 * (1.0 + sin))
            + cap(r2, r2 * (1.0 - sin))
            + PI / 3.0 * height * (big * big + big * small + small * small);
        let got = volume_of(&[([0.0; 3], 2.0), ([4.0, 0.0, 0.0], 1.0)]);
        assert_near(got, want, 0.015);
        assert!(got < want);
    }

    #[test]
    fn no_or_non_finite_spheres_are_refused() {
        assert_eq!(sphere_hull_volume(&[], &[], &[], &[]), Err(TilingError::Hull { points: 0 }));
        assert!(sphere_hull_volume(&[f64::NAN], &[0.0], &[0.0], &[1.0]).is_err());
    }
}
