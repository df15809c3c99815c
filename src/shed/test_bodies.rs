//! Bodies that several tests share.

use pkd::Spheres;

/// A prolate pile of `n` spheres of 45 m on a Fibonacci spiral of nested shells, long axis along x, 0.75 km.
pub(super) fn prolate(n: usize) -> Spheres {
    let mut spheres = Spheres::default();
    for k in 0..n {
        let u = (k as f64 + 0.5) / n as f64;
        let z = 1.0 - 2.0 * ((k as f64 * 0.754_877_666) % 1.0);
        let azimuth = std::f64::consts::TAU * ((k as f64 * 0.569_840_29) % 1.0);
        let (r, level) = (u.cbrt(), (1.0 - z * z).sqrt());
        let at = [750.0 * r * level * azimuth.cos(), 350.0 * r * level * azimuth.sin(), 350.0 * r * z];
        spheres.push(at, [0.0; 3], [0.0; 3], 1.5685e12 / n as f64, 45.0);
    }
    spheres
}
