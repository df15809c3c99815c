//! What a run is laid out as at its start: records, masses and guides of the spheres, filled up with spheres that are nowhere.

use super::lanes::{LANES, Quad};
use super::motion::{FROZEN, MASS, SEEN, guide_quads};
use super::record::{self, FRICTIONLESS, Lines, PLACE, PREDICTED, SPINS, VELOCITY};
use crate::Spheres;

/// Where spheres that do not exist are: too far for any contact, and their distances squared are still finite.
const NOWHERE: f64 = 1e100;

/// Records of the spheres in the order of `rows`, filled up with spheres that are nowhere: at least one, and whole fours.
pub(super) fn records(model: u8, spheres: &Spheres, rows: &[u32]) -> Lines {
    let quads = record::quads(model);
    let mut records = Lines::new((rows.len() / LANES + 1) * LANES * quads);
    for (k, s) in records.chunks_exact_mut(quads).enumerate() {
        let Some(&row) = rows.get(k) else {
            s[PLACE] = Quad([NOWHERE, NOWHERE, NOWHERE, 0.0]);
            continue;
        };
        let i = row as usize;
        let with = |[x, y, z]: [f64; 3], fourth: f64| Quad([x, y, z, fourth]);
        let [x, y, z] = if model == FRICTIONLESS { [0.0; 3] } else { spheres.spin(i) };
        s[PLACE] = with(spheres.position(i), spheres.radius[i]);
        s[PREDICTED] = with(spheres.velocity(i), x);
        s[VELOCITY] = s[PREDICTED];
        if model != FRICTIONLESS {
            s[SPINS] = Quad([y, z, y, z]);
        }
    }
    records
}

/// 1 / mass and 1 / moment of inertia of the spheres in the order of `rows`, and zeros for those that are nowhere.
pub(super) fn inverses(model: u8, masses: &[f64], spheres: &Spheres, rows: &[u32]) -> Vec<[f64; 2]> {
    let inertia = |m: f64, row: u32| 0.4 * m * spheres.radius[row as usize].powi(2);
    // Without spins a moment of inertia too small for f64 must not matter.
    let of = |(m, row): (&f64, &u32)| [1.0 / m, if model == FRICTIONLESS { 0.0 } else { 1.0 / inertia(*m, *row) }];
    let mut inverses: Vec<[f64; 2]> = masses.iter().zip(rows).map(of).collect();
    inverses.resize((rows.len() / LANES + 1) * LANES, [0.0; 2]);
    inverses
}

/// Guides of spheres that have not been seen: those that are nowhere may be anywhere.
pub(super) fn guides(field: u8, masses: &[f64]) -> Vec<Quad> {
    let mut guides = vec![Quad::default(); masses.len().div_ceil(LANES) * guide_quads(field)];
    for (guide, masses) in guides.chunks_exact_mut(guide_quads(field)).zip(masses.chunks(LANES)) {
        guide[SEEN + 3].0 = [f64::INFINITY; LANES];
        if field == FROZEN {
            guide[MASS].0[..masses.len()].copy_from_slice(masses);
        }
    }
    guides
}
