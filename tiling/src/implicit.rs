//! The implicit surface that a tiling is drawn on: `G(x) = sum_j (R_j / |x - x_j|)^(2n) - G0 = 0`.
//!
//! Source: Cotto-Figueroa et al. (2015), equation 1, with each sphere's own radius in the place of the common one. The
//! sum runs over all spheres: 1000 of them take under a microsecond, and no truncation moves the surface. It is taken
//! in eight interleaved lanes that are added at the end, with or without AVX2, so that both give the same bytes.

use crate::TilingError;

/// Lanes of the sum: two AVX2 registers.
const LANES: usize = 8;

/// Exponents beyond this only sharpen the creases between spheres, at the risk of overflow.
pub const MAX_EXPONENT: u32 = 16;

/// Spheres and the level that make up the surface.
#[derive(Debug, Clone, PartialEq)]
pub struct ImplicitSurface {
    /// Coordinates and squared radii, m and m^2, padded to full lanes with spheres of no influence.
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
    radius_squared: Vec<f64>,
    /// Half the power of the distance.
    exponent: u32,
    /// Value of the sum on the surface.
    level: f64,
    /// Smallest and largest radius, m.
    radii: (f64, f64),
}

/// What the sum says about a point and its surroundings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// `G`: negative outside, positive inside; large but finite at a sphere's centre.
    pub value: f64,
    /// No point nearer than this (m) has `G >= 0`; zero if `value >= 0`.
    pub clearance: f64,
}

impl ImplicitSurface {
    /// The surface of spheres with centres `x`, `y`, `z` (m) and radii `radius` (m), all `N` long, for the exponent `n`
    /// (2 in the paper) and the level `G0` (1.25).
    ///
    /// # Errors
    /// [`TilingError::BadSphere`] and [`TilingError::BadSurface`] for values that make no surface.
    /// # Panics
    /// If the slices differ in length.
    pub fn new(
        x: &[f64],
        y: &[f64],
        z: &[f64],
        radius: &[f64],
        exponent: u32,
        level: f64,
    ) -> Result<Self, TilingError> {
        assert!([x.len(), y.len(), z.len()] == [radius.len(); 3], "one coordinate and radius per sphere");
        let sound = (1..=MAX_EXPONENT).contains(&exponent) && level.is_finite() && level > 0.0;
        if radius.is_empty() || !sound {
            return Err(TilingError::BadSurface { spheres: radius.len(), exponent, level });
        }
        for i in 0..radius.len() {
            if !([x[i], y[i], z[i], radius[i]].iter().all(|v| v.is_finite()) && radius[i] > 0.0) {
                return Err(TilingError::BadSphere { sphere: i, centre: [x[i], y[i], z[i]], radius: radius[i] });
            }
        }
        let padded = radius.len().next_multiple_of(LANES);
        let column = |values: &[f64], fill: f64| {
            let mut column = values.to_vec();
            column.resize(padded, fill);
            column
        };
        let squares: Vec<f64> = radius.iter().map(|r| r * r).collect();
        let smallest = radius.iter().copied().fold(f64::INFINITY, f64::min);
        let largest = radius.iter().copied().fold(0.0, f64::max);
        // A padding sphere stands on the first one but has no radius: no influence, no effect on the nearest distance.
        Ok(Self {
            x: column(x, x[0]),
            y: column(y, y[0]),
            z: column(z, z[0]),
            radius_squared: column(&squares, 0.0),
            exponent,
            level,
            radii: (smallest, largest),
        })
    }

    /// Smallest and largest radius of the spheres, m.
    pub fn radii(&self) -> (f64, f64) {
        self.radii
    }

    /// The largest `x_j . direction + R_j`, m: how far the spheres reach along a unit vector.
    pub fn reach(&self, direction: [f64; 3]) -> f64 {
        let [u, v, w] = direction;
        (0..self.x.len())
            .map(|j| self.x[j] * u + self.y[j] * v + self.z[j] * w + self.radius_squared[j].sqrt())
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// `G` at `point` (m).
    pub fn value(&self, point: [f64; 3]) -> f64 {
        self.sum(point).0 - self.level
    }

    /// `G` at `point` (m), with the radius of a ball around it that is surely outside the surface.
    ///
    /// No distance shrinks by more than the factor `1 - t` within `t` times the nearest one, `d`, so the sum grows there
    /// to at most `sum / (1 - t)^(2n)`, which is below `G0` as long as `t < 1 - (sum / G0)^(1/2n)`.
    pub fn sample(&self, point: [f64; 3]) -> Sample {
        let (sum, nearest_squared) = self.sum(point);
        let value = sum - self.level;
        let clearance = if value >= 0.0 {
            0.0
        } else {
            // The last factor is for round-off.
            let fraction = 1.0 - (sum / self.level).powf(0.5 / f64::from(self.exponent));
            nearest_squared.sqrt() * fraction * (1.0 - 1e-12)
        };
        Sample { value, clearance }
    }

    fn sum(&self, point: [f64; 3]) -> (f64, f64) {
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") {
            // SAFETY: the line above.
            return unsafe { self.sum_avx2(point) };
        }
        self.sum_portable(point)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn sum_avx2(&self, point: [f64; 3]) -> (f64, f64) {
        self.sum_portable(point)
    }

    /// The sum and the smallest squared distance. Inlined, so that the caller's instruction set compiles it.
    #[inline(always)]
    fn sum_portable(&self, point: [f64; 3]) -> (f64, f64) {
        match self.exponent {
            1 => self.lanes(point, |q| q),
            2 => self.lanes(point, |q| q * q),
            n => self.lanes(point, |q| (1..n).fold(q, |power, _| power * q)),
        }
    }

    #[inline(always)]
    fn lanes(&self, [px, py, pz]: [f64; 3], power: impl Fn(f64) -> f64) -> (f64, f64) {
        /// Keeps the sum finite at a sphere's very centre; a surface is nowhere near such values.
        const LARGEST: f64 = 1e15;
        let mut sums = [0.0; LANES];
        let mut nearest = [f64::INFINITY; LANES];
        let columns = (self.x.chunks_exact(LANES).zip(self.y.chunks_exact(LANES)))
            .zip(self.z.chunks_exact(LANES).zip(self.radius_squared.chunks_exact(LANES)));
        for ((x, y), (z, r2)) in columns {
            for lane in 0..LANES {
                let (dx, dy, dz) = (px - x[lane], py - y[lane], pz - z[lane]);
                let d2 = (dx * dx + dy * dy + dz * dz).max(f64::MIN_POSITIVE);
                nearest[lane] = if d2 < nearest[lane] { d2 } else { nearest[lane] };
                let term = power(r2[lane] / d2);
                sums[lane] += if term < LARGEST { term } else { LARGEST };
            }
        }
        (sums.iter().sum(), nearest.iter().copied().fold(f64::INFINITY, f64::min))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surface(spheres: &[[f64; 4]], exponent: u32, level: f64) -> ImplicitSurface {
        let column = |k: usize| spheres.iter().map(|s| s[k]).collect::<Vec<_>>();
        ImplicitSurface::new(&column(0), &column(1), &column(2), &column(3), exponent, level).unwrap()
    }

    fn scattered(count: usize) -> Vec<[f64; 4]> {
        let wave = |i: usize, k: f64| (i as f64 * k).sin() * 10.0;
        (0..count).map(|i| [wave(i, 1.1), wave(i, 2.3), wave(i, 3.7), 1.0 + 0.5 * (i as f64).cos()]).collect()
    }

    /// Root at R G0^(-1/2n) = 0.945742 R.
    #[test]
    fn isolated_sphere_has_its_root_inside_its_own_surface() {
        let one = surface(&[[1.0, 2.0, 3.0, 50.0]], 2, 1.25);
        assert!(one.value([1.0 + 50.0 * 0.945742, 2.0, 3.0]).abs() < 1e-5);
        assert!(one.value([1.0, 2.0 + 50.0 * 0.94574, 3.0]) > 0.0);
        assert!(one.value([1.0, 2.0, 3.0 - 50.0 * 0.94575]) < 0.0);
        assert!((one.value([1e9, 0.0, 0.0]) + 1.25).abs() < 1e-15);
        assert!(one.value([1.0, 2.0, 3.0]) > 1e9);
    }

    /// Hole of a regular tetrahedron: 4 / 1.2247^4 = 1.78; of an octahedron: 6/4 = 1.5.
    #[test]
    fn voids_of_a_close_packing_are_inside() {
        let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
        let tetrahedron = corners.map(|[x, y, z]| [x, y, z, 2f64.sqrt()]);
        assert!((surface(&tetrahedron, 2, 1.25).value([0.0; 3]) - (16.0 / 9.0 - 1.25)).abs() < 1e-14);
        let sides = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let octahedron: Vec<_> =
            sides.iter().flat_map(|[x, y, z]| [[*x, *y, *z, 0.5f64.sqrt()], [-x, -y, -z, 0.5f64.sqrt()]]).collect();
        assert!((surface(&octahedron, 2, 1.25).value([0.0; 3]) - 0.25).abs() < 1e-14);
    }

    #[test]
    fn avx2_and_portable_sums_are_the_same_bytes_and_match_a_plain_loop() {
        for (count, exponent) in [(1, 1), (7, 2), (8, 2), (1000, 2), (1000, 3), (37, 1)] {
            let spheres = scattered(count);
            let field = surface(&spheres, exponent, 1.25);
            for i in 0..50 {
                let p = [(f64::from(i)).sin() * 15.0, f64::from(i) * 0.3, 1.0];
                assert_eq!(field.sum(p), field.sum_portable(p));
                let plain: f64 = spheres
                    .iter()
                    .map(|s| (s[3].powi(2) / (0..3).map(|k| (p[k] - s[k]).powi(2)).sum::<f64>()).powi(exponent as i32))
                    .sum();
                assert!((field.value(p) + 1.25 - plain).abs() < 1e-12 * (1.0 + plain));
            }
        }
    }

    #[test]
    fn nothing_within_the_clearance_is_on_the_surface() {
        for exponent in [1, 2, 3] {
            let field = surface(&scattered(40), exponent, 1.25);
            let mut outside = 0;
            for i in 0..200 {
                let p = [(f64::from(i) * 0.7).sin() * 15.0, (f64::from(i) * 1.3).cos() * 15.0, f64::from(i) * 0.15];
                let sample = field.sample(p);
                outside += usize::from(sample.value < 0.0);
                for d in crate::fibonacci::fibonacci_points(30) {
                    let q = [0, 1, 2].map(|k| p[k] + d[k] * sample.clearance * 0.999);
                    assert!(sample.value >= 0.0 || field.value(q) < 0.0);
                }
            }
            assert!(exponent == 1 || outside > 50);
        }
    }

    #[test]
    fn impossible_spheres_exponents_and_levels_are_refused() {
        let new = |x: f64, r: f64, n, level| ImplicitSurface::new(&[x], &[0.0], &[0.0], &[r], n, level);
        assert!(matches!(new(f64::NAN, 1.0, 2, 1.25), Err(TilingError::BadSphere { sphere: 0, .. })));
        assert!(matches!(new(0.0, -1.0, 2, 1.25), Err(TilingError::BadSphere { sphere: 0, .. })));
        assert!(matches!(new(0.0, 1.0, 0, 1.25), Err(TilingError::BadSurface { exponent: 0, .. })));
        assert!(matches!(new(0.0, 1.0, 2, 0.0), Err(TilingError::BadSurface { .. })));
        assert!(matches!(
            ImplicitSurface::new(&[], &[], &[], &[], 2, 1.25),
            Err(TilingError::BadSurface { spheres: 0, .. })
        ));
    }
}
