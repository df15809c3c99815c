//! The sources of gravity, laid out for vector registers.
//!
//! Coordinates are scaled by a power of two, which changes no digit of them, so that squared distances stay far inside
//! the range of `f32`, where the vector kernels take their first guess of the inverse distance: for bodies of any size
//! whose closest centres are further apart than 10⁻²⁸ of the largest coordinate.

use crate::constants::G;

/// Spheres per block: what the widest registers hold.
pub(super) const BLOCK: usize = 8;

/// Eight sources side by side, one register per quantity, so that a kernel walks through memory in one line.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Sources {
    /// Coordinates times the scale; all massless points lie together outside the rest.
    pub at: [[f64; BLOCK]; 3],
    /// G m times the square of the scale: over the square of a scaled distance this is an acceleration in m/s².
    pub strength: [f64; BLOCK],
}

impl Sources {
    /// What fills up the last block: it pulls nothing and lies outside everything.
    pub const MASSLESS: Self = Self { at: [[4.0 * RANGE; BLOCK], [0.0; BLOCK], [0.0; BLOCK]], strength: [0.0; BLOCK] };
}

/// Accelerations of the spheres of a block by component, m/s².
#[derive(Debug, Clone, Copy, Default)]
#[repr(C, align(64))]
pub(super) struct Pull(pub [[f64; BLOCK]; 3]);

/// All sources.
#[derive(Debug, Default)]
pub(super) struct Field {
    /// Number of spheres.
    pub len: usize,
    /// The spheres by eights; the last block is filled up with massless points.
    pub blocks: Vec<Sources>,
}

impl Field {
    /// Copies positions (m) and masses (kg) in.
    pub fn fill(&mut self, coordinates: [&[f64]; 3], mass: &[f64]) {
        let scale = scale(coordinates);
        self.len = mass.len();
        self.blocks.clear();
        self.blocks.resize(self.len.div_ceil(BLOCK), Sources::MASSLESS);
        for (b, block) in self.blocks.iter_mut().enumerate() {
            let range = b * BLOCK..self.len.min((b + 1) * BLOCK);
            for (to, from) in block.at.iter_mut().zip(coordinates) {
                copy(to, &from[range.clone()], scale);
            }
            copy(&mut block.strength, &mass[range], G * scale * scale);
        }
    }
}

fn copy(to: &mut [f64; BLOCK], from: &[f64], factor: f64) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to = from * factor);
}

/// Scaled coordinates are smaller than this: their squared distances then lie below 2⁷⁰, and centres 2⁻⁹⁰ of the
/// largest coordinate apart still have a squared distance above the smallest normal `f32`.
const RANGE: f64 = (1_u64 << 32) as f64;

/// The power of two that takes the largest coordinate into [1/4, 1) of [`RANGE`]; 1 where there is none.
pub(super) fn scale(coordinates: [&[f64]; 3]) -> f64 {
    let largest = coordinates.iter().flat_map(|c| c.iter()).fold(0.0_f64, |m, c| m.max(c.abs()));
    let exponent = 31 - largest.log2().floor() as i32;
    if largest > 0.0 && exponent.abs() < 1000 { 2.0_f64.powi(exponent) } else { 1.0 }
}
