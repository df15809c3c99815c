//! Boxes full of equal spheres, random or hexagonally close packed, and what a shape carves out of them.
//!
//! Carving keeps a sphere when its centre is inside the shape, whatever its radius (Zhang et al. 2017, Icarus 294, 98).

use nalgebra::Vector3;

use super::relax::{Outcome, push_apart};
use super::{Grain, MAX_COUNT, Seed, Uniform, in_range, positive};
use crate::{PkdError, Spheres};

/// Packing fraction of a random fill, walls included; well inside it is 0.60 to 0.61, short of jamming at 0.64.
pub const FILL_FRACTION: f64 = 0.58;

/// Width beyond each side of the box that is filled too, in diameters: spheres line up along flat walls.
const MARGIN: f64 = 3.0;

/// Random packing whose centres fill at least the box |x| <= hx, |y| <= hy, |z| <= hz (`half_widths`, m).
///
/// # Errors
/// [`PkdError::BadParameter`] for a value that is not finite and positive, or for more spheres than [`MAX_COUNT`].
pub fn random_fill(half_widths: [f64; 3], grain: Grain, seed: Seed) -> Result<Spheres, PkdError> {
    let room = half_widths_in_diameters(half_widths, grain)?.add_scalar(MARGIN);
    // A layer at a wall takes the room of a layer inside, where they are about sqrt(2/3) apart: half of it lies outside
    // the box of the centres.
    let volume = 8.0 * room.add_scalar(0.5 * (2.0_f64 / 3.0).sqrt()).product();
    let count = sphere_count(volume * FILL_FRACTION * 6.0 / std::f64::consts::PI, grain)?;
    let mut uniform = Uniform::new(seed);
    let mut centres: Vec<Vector3<f64>> = (0..count).map(|_| uniform.in_cube().component_mul(&room)).collect();
    match push_apart(&mut centres, |centre| centre.zip_map(&room, |c, r| c.clamp(-r, r))) {
        Outcome::Separated => Ok(grain.at(centres)),
        Outcome::Jammed => Err(PkdError::PackingTooDense { spheres: count }),
    }
}

/// Hexagonal close packing (layers ABAB normal to z) whose centres fill the box |x| <= hx, |y| <= hy, |z| <= hz
/// (`half_widths`, m), with a sphere in the origin.
///
/// # Errors
/// As [`random_fill`].
pub fn hcp_lattice(half_widths: [f64; 3], grain: Grain) -> Result<Spheres, PkdError> {
    let room = half_widths_in_diameters(half_widths, grain)?;
    sphere_count(8.0 * room.add_scalar(0.5).product() * 2.0_f64.sqrt(), grain)?;
    // A hair apart, so that rounding cannot make touching spheres overlap.
    let spacing = 1.0 + 1e-12;
    let row = spacing * 0.75_f64.sqrt();
    let layer = spacing * (2.0_f64 / 3.0).sqrt();
    let mut centres = Vec::new();
    for k in steps(room.z, layer) {
        let odd_layer = if k % 2 == 0 { 0.0 } else { 1.0 };
        for j in steps(room.y + row, row) {
            let odd_row = if j % 2 == 0 { 0.0 } else { 0.5 };
            for i in steps(room.x + spacing, spacing) {
                let x = (f64::from(i) + odd_row + 0.5 * odd_layer) * spacing;
                let y = (f64::from(j) + odd_layer / 3.0) * row;
                if x.abs() <= room.x && y.abs() <= room.y {
                    centres.push(Vector3::new(x, y, f64::from(k) * layer));
                }
            }
        }
    }
    Ok(grain.at(centres))
}

/// The spheres of `packing` whose centre (m) is `inside` a shape.
///
/// # Errors
/// [`PkdError::Empty`] if none is.
pub fn carve(packing: &Spheres, inside: impl Fn([f64; 3]) -> bool) -> Result<Spheres, PkdError> {
    let keep: Vec<bool> = (0..packing.len()).map(|i| inside(packing.position(i))).collect();
    let carved = packing.filtered(&keep);
    if carved.is_empty() { Err(PkdError::Empty) } else { Ok(carved) }
}

fn half_widths_in_diameters(half_widths: [f64; 3], grain: Grain) -> Result<Vector3<f64>, PkdError> {
    grain.validate()?;
    half_widths.iter().try_for_each(|h| positive("half width of the box", *h))?;
    Ok(Vector3::from(half_widths) / (2.0 * grain.radius))
}

fn sphere_count(expected: f64, grain: Grain) -> Result<usize, PkdError> {
    let allowed = "large enough for at most 10 million spheres in the box";
    in_range("radius", grain.radius, expected <= MAX_COUNT as f64, allowed)?;
    Ok(expected.round().max(1.0) as usize)
}

/// The whole numbers whose multiples of `spacing` lie within `reach` of 0.
fn steps(reach: f64, spacing: f64) -> std::ops::RangeInclusive<i32> {
    let most = (reach / spacing).floor() as i32;
    -most..=most
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const GRAIN: Grain = Grain { radius: 10.0, density: 3000.0 };

    fn ball(radius: f64) -> impl Fn([f64; 3]) -> bool {
        move |p| Vector3::from(p).norm() <= radius
    }

    fn packing_fraction_of_ball(spheres: &Spheres, radius: f64) -> f64 {
        spheres.len() as f64 * (GRAIN.radius / radius).powi(3)
    }

    #[test]
    fn lattice_has_twelve_touching_neighbours_and_the_density_of_close_packing() {
        let fill = hcp_lattice([200.0; 3], GRAIN).unwrap();
        let origin = (0..fill.len()).find(|i| fill.position(*i) == [0.0; 3]).unwrap();
        let distance = |i: usize| Vector3::from(fill.position(i)).norm();
        let others = || (0..fill.len()).filter(|i| *i != origin);
        assert_eq!(others().filter(|i| (distance(*i) / 20.0 - 1.0).abs() < 1e-9).count(), 12);
        assert!(others().all(|i| distance(i) >= 20.0));
        // A carved ball: its surface counts centres only, so the fraction fluctuates by a percent.
        let carved = carve(&fill, ball(190.0)).unwrap();
        assert!((packing_fraction_of_ball(&carved, 190.0) - PI / 18.0_f64.sqrt()).abs() < 0.01);
    }

    #[test]
    fn random_fill_reaches_its_fraction_inside_the_box_without_overlaps() {
        let fill = random_fill([100.0, 80.0, 90.0], GRAIN, Seed::default()).unwrap();
        for i in 0..fill.len() {
            for j in 0..i {
                let d = (Vector3::from(fill.position(i)) - Vector3::from(fill.position(j))).norm();
                assert!(d >= 20.0, "{i} {j} {d}");
            }
        }
        let carved = carve(&fill, ball(80.0)).unwrap();
        let fraction = packing_fraction_of_ball(&carved, 80.0);
        // 300 spheres counted by their centres: the fraction fluctuates by about 0.02.
        assert!((fraction - 0.605).abs() < 0.04, "{fraction}");
    }

    #[test]
    fn empty_shapes_and_boundless_fills_are_refused() {
        let fill = hcp_lattice([50.0; 3], GRAIN).unwrap();
        assert_eq!(carve(&fill, |_| false), Err(PkdError::Empty));
        for bad in [[1e9; 3], [f64::NAN, 1.0, 1.0], [-1.0; 3]] {
            assert!(matches!(hcp_lattice(bad, GRAIN), Err(PkdError::BadParameter { .. })));
            assert!(matches!(random_fill(bad, GRAIN, Seed::default()), Err(PkdError::BadParameter { .. })));
        }
    }
}
