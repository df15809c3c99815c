//! The field of the primary near by: its spheres as point masses, which is exact outside all of them.

use pkd::Spheres;
use pkd::constants::G;
use pkd::mass_properties::mass_properties;

use super::ShedError;

/// Mascons that are summed side by side.
const LANES: usize = 8;

/// The primary's spheres in its own frame: centre of mass at the origin, spin along +z.
#[derive(Debug, Clone)]
pub(super) struct Mascons {
    points: Points,
    radius: Vec<f64>,
    /// G times the total mass, m^3/s^2.
    pub gm: f64,
    /// Distance of the farthest centre, m.
    pub farthest_m: f64,
    /// Distance within which all spheres lie whole, m.
    pub bounding_radius_m: f64,
    pull: Pull,
}

/// x, y, z, m, and G m, m^3/s^2, in lanes; the last lanes are filled up with massless copies of a real mascon.
type Points = [Vec<[f64; LANES]>; 4];

type Pull = fn(&Points, [f64; 3]) -> [f64; 3];

impl Mascons {
    /// The spheres of the primary, moved to their centre of mass.
    pub fn new(spheres: &Spheres) -> Result<Self, ShedError> {
        let centre = mass_properties(spheres)?.centre;
        let at = |i: usize| [spheres.x[i] - centre.x, spheres.y[i] - centre.y, spheres.z[i] - centre.z];
        let n = spheres.len();
        let lanes = |value: &dyn Fn(usize) -> f64| {
            let block = |block: usize| std::array::from_fn(|k| value(block * LANES + k));
            (0..n.div_ceil(LANES)).map(block).collect()
        };
        let coordinate = |c: usize| lanes(&|i| at(i.min(n - 1))[c]);
        let gm = lanes(&|i| if i < n { G * spheres.mass[i] } else { 0.0 });
        let distance = |i: usize| norm(at(i));
        Ok(Self {
            points: [coordinate(0), coordinate(1), coordinate(2), gm],
            radius: spheres.radius.clone(),
            gm: G * spheres.total_mass(),
            farthest_m: (0..n).map(distance).fold(0.0, f64::max),
            bounding_radius_m: (0..n).map(|i| distance(i) + spheres.radius[i]).fold(0.0, f64::max),
            pull: fastest(),
        })
    }

    /// Acceleration at a point of the body frame, m/s^2.
    #[inline]
    pub fn acceleration(&self, at: [f64; 3]) -> [f64; 3] {
        (self.pull)(&self.points, at)
    }

    /// Potential at a point of the body frame, m^2/s^2, negative.
    pub fn potential(&self, at: [f64; 3]) -> f64 {
        self.points().map(|(point, gm)| -gm / norm(minus(point, at))).sum()
    }

    /// Gap between the surfaces of the primary and of a sphere at a point of the body frame, m, negative where they
    /// overlap, and the primary's sphere that is nearest.
    pub fn clearance(&self, at: [f64; 3], radius: f64) -> (f64, usize) {
        let gap = |(i, (point, _)): (usize, ([f64; 3], f64))| (norm(minus(point, at)) - self.radius[i] - radius, i);
        let mut gaps = self.points().enumerate().map(gap);
        let first = gaps.next().unwrap_or((f64::INFINITY, 0));
        gaps.fold(first, |nearest, gap| if gap.0 < nearest.0 { gap } else { nearest })
    }

    /// Radius of the smallest sphere, m.
    pub fn smallest_radius_m(&self) -> f64 {
        self.radius.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Centres (m) with their G m (m^3/s^2), in the order of the spheres.
    pub fn points(&self) -> impl Iterator<Item = ([f64; 3], f64)> {
        let [x, y, z, gm] = self.points.each_ref().map(|column| column.as_flattened());
        (0..self.radius.len()).map(move |i| ([x[i], y[i], z[i]], gm[i]))
    }
}

/// The pull compiled for the widest registers of this processor.
fn fastest() -> Pull {
    #[cfg(target_arch = "x86_64")]
    {
        if std::arch::is_x86_feature_detected!("avx512f") && std::arch::is_x86_feature_detected!("fma") {
            return x86::avx512;
        }
        if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
            return x86::avx2;
        }
    }
    pull
}

/// Pull of all blocks at a point.
///
/// 1/r is guessed in `f32` and its cube sharpened by one third-order step, 1/r^3 = y^3 (1 - e)^(-3/2), e = 1 - r^2 y^2:
/// since |e| < 2^-21, what is left out is below round-off. Each lane has its own sums, added up in order at the end.
#[inline(always)]
fn pull([x, y, z, gm]: &Points, at: [f64; 3]) -> [f64; 3] {
    let mut sums = [[0.0; LANES]; 3];
    for (((x, y), z), gm) in x.iter().zip(y).zip(z).zip(gm) {
        // One simple loop an operation, which becomes one vector instruction.
        let (dx, dy, dz) = (each(|k| x[k] - at[0]), each(|k| y[k] - at[1]), each(|k| z[k] - at[2]));
        let r2 = each(|k| dx[k] * dx[k] + dy[k] * dy[k] + dz[k] * dz[k]);
        let guess = each(|k| f64::from(1.0 / (r2[k] as f32).sqrt()));
        let square = each(|k| guess[k] * guess[k]);
        let e = each(|k| 1.0 - r2[k] * square[k]);
        let strength = each(|k| gm[k] * guess[k] * square[k] * (1.0 + e[k] * (1.5 + 1.875 * e[k])));
        sums[0] = each(|k| sums[0][k] + strength[k] * dx[k]);
        sums[1] = each(|k| sums[1][k] + strength[k] * dy[k]);
        sums[2] = each(|k| sums[2][k] + strength[k] * dz[k]);
    }
    sums.map(|lanes| lanes.iter().sum())
}

#[inline(always)]
fn each(f: impl Fn(usize) -> f64) -> [f64; LANES] {
    let mut lanes = [0.0; LANES];
    for (k, lane) in lanes.iter_mut().enumerate() {
        *lane = f(k);
    }
    lanes
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::Points;

    pub fn avx512(points: &Points, at: [f64; 3]) -> [f64; 3] {
        #[target_feature(enable = "avx512f,avx512vl,avx512dq,avx2,fma")]
        unsafe fn compiled(points: &Points, at: [f64; 3]) -> [f64; 3] {
            super::pull(points, at)
        }
        // SAFETY: chosen only where the processor has them.
        unsafe { compiled(points, at) }
    }

    pub fn avx2(points: &Points, at: [f64; 3]) -> [f64; 3] {
        #[target_feature(enable = "avx2,fma")]
        unsafe fn compiled(points: &Points, at: [f64; 3]) -> [f64; 3] {
            super::pull(points, at)
        }
        // SAFETY: chosen only where the processor has them.
        unsafe { compiled(points, at) }
    }
}

pub(super) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(super) fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::test_bodies::prolate;
    use super::*;

    #[test]
    fn field_is_the_gradient_of_the_potential_and_every_compilation_agrees() {
        let mascons = Mascons::new(&prolate(203)).unwrap();
        let at = [900.0, -700.0, 400.0];
        let a = mascons.acceleration(at);
        let plain = pull(&mascons.points, at);
        for k in 0..3 {
            let shifted = |d: f64| {
                let mut p = at;
                p[k] += d;
                mascons.potential(p)
            };
            let gradient = (8.0 * (shifted(0.5) - shifted(-0.5)) - (shifted(1.0) - shifted(-1.0))) / 6.0;
            assert!((a[k] + gradient).abs() < 1e-9 * norm(a), "{} {gradient}", a[k]);
            assert!((a[k] - plain[k]).abs() < 1e-14 * norm(a));
        }
    }

    #[test]
    fn clearance_is_that_of_the_nearest_sphere() {
        let mascons = Mascons::new(&prolate(203)).unwrap();
        let (point, _) = mascons.points().nth(7).unwrap();
        let outside = point.map(|c| c * 1e3);
        let (gap, nearest) = mascons.clearance(outside, 3.0);
        let (centre, _) = mascons.points().nth(nearest).unwrap();
        assert!((gap - (norm(minus(outside, centre)) - mascons.radius[nearest] - 3.0)).abs() < 1e-6);
        assert_eq!(mascons.clearance(point, 0.0).1, 7);
    }
}
