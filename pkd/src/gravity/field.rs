//! The sources of gravity, laid out for vector units.
//!
//! Coordinates are scaled by a power of two, which changes no digit of them, so that squared distances stay far inside
//! the range of `f32`, where the vector kernels take their first guess of the inverse distance: for bodies of any size
//! whose closest centres are further apart than 10⁻²⁸ of the largest coordinate.

use crate::constants::G;

/// Spheres per block; the last block is filled up with massless points.
pub(super) const BLOCK: usize = 8;

/// One quantity of one block of spheres, aligned for the widest vector registers.
#[derive(Debug, Clone, Copy, Default)]
#[repr(C, align(64))]
pub(super) struct Block(pub [f64; BLOCK]);

/// One three-component quantity, or accelerations, by blocks.
#[derive(Debug, Default)]
pub(super) struct Blocks3 {
    pub x: Vec<Block>,
    pub y: Vec<Block>,
    pub z: Vec<Block>,
}

impl Blocks3 {
    /// `n` blocks of zeros.
    pub fn clear(&mut self, n: usize) {
        for component in [&mut self.x, &mut self.y, &mut self.z] {
            component.clear();
            component.resize(n, Block::default());
        }
    }
}

/// Scaled positions and strengths of all sources.
#[derive(Debug, Default)]
pub(super) struct Field {
    /// Number of spheres.
    pub len: usize,
    /// Coordinates times the scale; all massless points lie together outside the rest.
    pub at: Blocks3,
    /// G m times the square of the scale: over the square of a scaled distance this is an acceleration in m/s².
    pub strength: Vec<Block>,
}

impl Field {
    /// Copies positions (m) and masses (kg) in.
    pub fn fill(&mut self, coordinates: [&[f64]; 3], mass: &[f64]) {
        let largest = coordinates.iter().flat_map(|c| c.iter()).fold(0.0_f64, |m, c| m.max(c.abs()));
        let scale = scale(largest);
        let outside = [4.0 * RANGE, 0.0, 0.0];
        self.len = mass.len();
        for ((to, from), fill) in
            [&mut self.at.x, &mut self.at.y, &mut self.at.z].into_iter().zip(coordinates).zip(outside)
        {
            copy(to, from, scale, fill);
        }
        copy(&mut self.strength, mass, G * scale * scale, 0.0);
    }

    /// Number of blocks.
    pub fn blocks(&self) -> usize {
        self.strength.len()
    }
}

/// Scaled coordinates are smaller than this: their squared distances then lie below 2⁷⁰, and centres 2⁻⁹⁰ of the
/// largest coordinate apart still have a squared distance above the smallest normal `f32`.
const RANGE: f64 = (1_u64 << 32) as f64;

/// The power of two that takes `largest` into [1/4, 1) of [`RANGE`]; 1 where there is none.
fn scale(largest: f64) -> f64 {
    let exponent = 31 - largest.log2().floor() as i32;
    if largest > 0.0 && exponent.abs() < 1000 { 2.0_f64.powi(exponent) } else { 1.0 }
}

fn copy(to: &mut Vec<Block>, from: &[f64], factor: f64, fill: f64) {
    to.clear();
    to.extend(from.chunks(BLOCK).map(|chunk| {
        let mut block = Block([fill; BLOCK]);
        chunk.iter().zip(&mut block.0).for_each(|(from, to)| *to = from * factor);
        block
    }));
}
