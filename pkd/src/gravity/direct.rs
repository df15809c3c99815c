//! Gravity by direct summation over pairs, exact to round-off.
//!
//! Every pair is visited once and acts on both of its members with opposite forces: momentum is conserved to round-off.

use std::ops::Range;

use rayon::prelude::*;

use super::Accelerations;
use super::field::{BLOCK, Field, Pull};
use super::kernel::{self, Kernel};
use crate::constants::G;

/// Direct summation with its scratch memory; holds no state, a new one gives the same bytes.
#[derive(Debug)]
pub struct DirectGravity {
    kernel: Kernel,
    field: Field,
    strips: Vec<Strip>,
}

/// Rows of the triangle of pairs that are summed on one thread, with the accelerations they give.
#[derive(Debug)]
struct Strip {
    rows: Range<usize>,
    acc: Vec<Pull>,
}

impl Default for DirectGravity {
    fn default() -> Self {
        Self { kernel: kernel::fastest(), field: Field::default(), strips: Vec::new() }
    }
}

impl DirectGravity {
    /// Accelerations (m/s²) of spheres at `x`, `y`, `z` (m) with `mass` (kg), written to `out`.
    ///
    /// Runs on the threads of the current `rayon` pool; the bytes do not depend on their number.
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn accelerations(&mut self, x: &[f64], y: &[f64], z: &[f64], mass: &[f64], out: &mut Accelerations) {
        let n = mass.len();
        assert!(x.len() == n && y.len() == n && z.len() == n, "one entry per sphere in every array");
        self.field.fill([x, y, z], mass);
        self.cut_strips();
        let (kernel, field) = (self.kernel, &self.field);
        let sum = |strip: &mut Strip| {
            strip.acc.clear();
            strip.acc.resize(field.blocks.len() - strip.rows.start, Pull::default());
            kernel(field, strip.rows.clone(), &mut strip.acc);
        };
        if self.strips.len() > 1 && rayon::current_num_threads() > 1 {
            self.strips.par_iter_mut().for_each(sum);
        } else {
            self.strips.iter_mut().for_each(sum);
        }
        // Strip by strip, so that the order of the additions is always the same.
        for (out, component) in [&mut out.x, &mut out.y, &mut out.z].into_iter().zip(0..) {
            out.clear();
            out.resize(n, 0.0);
            for strip in &self.strips {
                let acc = strip.acc.iter().flat_map(|pull| &pull.0[component]);
                out[strip.rows.start * BLOCK..].iter_mut().zip(acc).for_each(|(out, a)| *out += a);
            }
        }
    }

    /// Divides the rows of blocks into strips of about equal numbers of pairs: a function of the size alone.
    fn cut_strips(&mut self) {
        let blocks = self.field.blocks.len();
        let count = (blocks / BLOCKS_PER_STRIP).clamp(1, MAX_STRIPS);
        // Of the triangle of pairs, the first k rows hold the share 1 - (1 - k / blocks)².
        let cut = |s: usize| (blocks as f64 * (1.0 - (1.0 - s as f64 / count as f64).sqrt())).round() as usize;
        self.strips.resize_with(count, || Strip { rows: 0..0, acc: Vec::new() });
        self.strips.iter_mut().enumerate().for_each(|(s, strip)| strip.rows = cut(s)..cut(s + 1));
    }

    /// Potential at each centre due to all other spheres, m²/s², negative, written to `out`.
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn potentials(&mut self, x: &[f64], y: &[f64], z: &[f64], mass: &[f64], out: &mut Vec<f64>) {
        let n = mass.len();
        assert!(x.len() == n && y.len() == n && z.len() == n, "one entry per sphere in every array");
        out.clear();
        out.resize(n, 0.0);
        for i in 0..n {
            for j in i + 1..n {
                let (dx, dy, dz) = (x[j] - x[i], y[j] - y[i], z[j] - z[i]);
                let g = G / (dx * dx + dy * dy + dz * dz).sqrt();
                out[i] -= g * mass[j];
                out[j] -= g * mass[i];
            }
        }
    }
}

/// Fewer rows of blocks than this are not worth a strip: a thousand spheres make seven.
const BLOCKS_PER_STRIP: usize = 16;
/// More strips than this would cost more memory than the threads of a usual machine repay.
const MAX_STRIPS: usize = 32;

#[cfg(test)]
mod tests {
    use super::super::potential_energy;
    use super::*;
    use crate::Spheres;
    use crate::simd::Level;
    use nalgebra::Vector3;

    fn cloud(n: usize, scale: f64) -> Spheres {
        let mut s = Spheres::default();
        for i in 0..n {
            let t = i as f64;
            let r = [(1.3 * t).sin(), (0.7 * t + 0.4).cos() + 0.01 * t, (2.9 * t).sin() * 0.6];
            s.push(r.map(|c| c * 500.0 * scale), [0.0; 3], [0.0; 3], 1e9 * (1.0 + 0.3 * (5.0 * t).sin()), 1.0);
        }
        s
    }

    fn accelerations(kernel: Kernel, s: &Spheres) -> Accelerations {
        let mut out = Accelerations::default();
        let mut gravity = DirectGravity { kernel, ..DirectGravity::default() };
        gravity.accelerations(&s.x, &s.y, &s.z, &s.mass, &mut out);
        out
    }

    /// The oracle and the kernel of each level.
    fn kernels() -> Vec<Kernel> {
        let levels = Level::available().into_iter().map(kernel::at);
        std::iter::once(kernel::exact as Kernel).chain(levels).collect()
    }

    #[test]
    fn every_level_gives_the_same_bytes() {
        for n in [1, 7, 8, 9, 65, 300] {
            let s = cloud(n, 1.0);
            let plain = accelerations(kernel::at(Level::Scalar), &s);
            for level in Level::available() {
                assert_eq!(accelerations(kernel::at(level), &s), plain, "{n} spheres at {}", level.name());
            }
        }
    }

    /// Every pair twice, as in the textbook.
    fn textbook(s: &Spheres) -> Vec<Vector3<f64>> {
        let at = |i: usize| Vector3::from(s.position(i));
        (0..s.len())
            .map(|i| {
                (0..s.len())
                    .filter(|j| *j != i)
                    .map(|j| (at(j) - at(i)) * (G * s.mass[j] / (at(j) - at(i)).norm().powi(3)))
                    .sum()
            })
            .collect()
    }

    #[test]
    fn every_kernel_agrees_with_the_textbook_sum_at_round_off_for_any_number_and_scale() {
        for n in [1, 2, 3, 7, 8, 9, 17, 64, 129, 300, 1001] {
            for scale in [1.0, 1e-30, 1e25] {
                let s = cloud(n, scale);
                let exact = textbook(&s);
                for kernel in kernels() {
                    let got = accelerations(kernel, &s);
                    for (i, exact) in exact.iter().enumerate() {
                        let error = (Vector3::new(got.x[i], got.y[i], got.z[i]) - exact).norm();
                        // The sum's own round-off grows with the terms that cancel, not with their sum.
                        let terms: f64 = (0..n)
                            .filter(|j| *j != i)
                            .map(|j| {
                                let d = Vector3::from(s.position(j)) - Vector3::from(s.position(i));
                                G * s.mass[j] / d.norm_squared()
                            })
                            .sum();
                        assert!(error <= 4e-15 * terms, "n {n} scale {scale} sphere {i}: {error:e} of {terms:e}");
                    }
                }
            }
        }
    }

    /// Σ m g = 0, Σ m x × g = 0, Σ m x·g = W.
    #[test]
    fn forces_torques_and_virial_balance() {
        let s = cloud(1000, 1.0);
        for kernel in kernels() {
            let a = accelerations(kernel, &s);
            let (mut force, mut torque, mut virial) = (Vector3::zeros(), Vector3::zeros(), 0.0);
            let (mut forces, mut torques) = (0.0, 0.0);
            for i in 0..s.len() {
                let (x, f) = (Vector3::from(s.position(i)), Vector3::new(a.x[i], a.y[i], a.z[i]) * s.mass[i]);
                force += f;
                torque += x.cross(&f);
                virial += x.dot(&f);
                forces += f.norm();
                torques += x.norm() * f.norm();
            }
            assert!(force.norm() < 1e-14 * forces, "{:e}", force.norm() / forces);
            assert!(torque.norm() < 1e-14 * torques);
            assert!((virial / potential_energy(&s) - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn thread_count_does_not_change_a_byte() {
        let s = cloud(1500, 1.0);
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| accelerations(kernel::fastest(), &s))
        };
        let one = on(1);
        assert_eq!(one, on(2));
        assert_eq!(one, on(5));
    }

    #[test]
    fn scratch_of_another_size_leaves_no_trace() {
        let (large, small) = (cloud(500, 1.0), cloud(30, 1.0));
        let mut gravity = DirectGravity::default();
        let mut out = Accelerations::default();
        gravity.accelerations(&large.x, &large.y, &large.z, &large.mass, &mut out);
        gravity.accelerations(&small.x, &small.y, &small.z, &small.mass, &mut out);
        assert_eq!(out, accelerations(kernel::fastest(), &small));
    }
}
