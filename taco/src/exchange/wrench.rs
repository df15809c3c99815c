//! What the light that leaves a facet does to the body in the end.
//!
//! Light of unit energy over the speed of light that leaves facet i carries off the momentum `p_i` through the open sky
//! ([`SkyView`]) and the angular momentum `r_i x p_i`; the fraction `V_ij` meets facet j and leaves from there anew. With
//! `q_i` the two together, `w_i = q_i + sum_j V_ij w_j`: a random walk that ends in the sky. As the fractions add up to what
//! the sky leaves, energy is conserved exactly.

use super::Azimuths;
use super::views::Views;
use crate::facets::Facet;
use crate::sky::SkyView;
use crate::surface::SelfHeating;
use rayon::prelude::*;

/// Momentum (-) and angular momentum (m) of the light that escapes, body frame, per unit energy over the speed of light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Wrench {
    pub momentum: [f64; 3],
    pub angular_momentum: [f64; 3],
}

/// The walk ends when a flight changes no component by more than this fraction of the largest one.
const TOLERANCE: f64 = 1e-10;
/// The walk ends after this many flights: all but 1e-10 of the light has escaped wherever 5 % of the sky are open.
const FLIGHTS: usize = 500;

impl Wrench {
    fn plus(&self, factor: f64, o: &Self) -> Self {
        let add = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|k| a[k] + factor * b[k]);
        Self {
            momentum: add(self.momentum, o.momentum),
            angular_momentum: add(self.angular_momentum, o.angular_momentum),
        }
    }

    /// Of light that leaves `facet` and escapes at once.
    fn direct(facet: &Facet, sky: &SkyView) -> Self {
        let [north, west, up] = facet.horizon_axes();
        let [to_north, to_west] = sky.tangential;
        let p: [f64; 3] = std::array::from_fn(|k| to_north * north[k] + to_west * west[k] + sky.normal * up[k]);
        let [x, y, z] = facet.point;
        let angular_momentum = [y * p[2] - z * p[1], z * p[0] - x * p[2], x * p[1] - y * p[0]];
        Self { momentum: p, angular_momentum }
    }

    /// Largest momentum and angular momentum components.
    fn size(&self) -> [f64; 2] {
        let largest = |v: [f64; 3]| v.iter().fold(0.0f64, |m, c| m.max(c.abs()));
        [largest(self.momentum), largest(self.angular_momentum)]
    }
}

/// The wrench of each facet's light; `sky` is `None` for an open one.
pub(crate) fn followed(
    facets: &[Facet],
    sky: impl Fn(usize) -> Option<SkyView> + Sync,
    views: &Views,
    azimuths: Azimuths,
    mode: SelfHeating,
) -> Vec<Wrench> {
    let direct = |f: usize| Wrench::direct(&facets[f], &sky(f).unwrap_or(SkyView::OPEN));
    let direct: Vec<Wrench> = (0..facets.len()).into_par_iter().map(direct).collect();
    let flights = match mode {
        SelfHeating::None => 0,
        SelfHeating::Single => 1,
        SelfHeating::Multiple => FLIGHTS,
    };
    let sizes = |wrenches: &[Wrench]| {
        wrenches.iter().map(Wrench::size).fold([0.0f64; 2], |[a, b], [c, d]| [a.max(c), b.max(d)])
    };
    let [momentum, angular_momentum] = sizes(&direct);
    let mut wrenches = direct.clone();
    for _ in 0..flights {
        let next: Vec<Wrench> = (views.rows.par_iter().zip(&direct))
            .map(|(row, direct)| {
                let fraction = |seen: &super::views::Seen| f64::from(seen.fractions[azimuths as usize]);
                row.iter().fold(*direct, |sum, seen| sum.plus(fraction(seen), &wrenches[seen.facet as usize]))
            })
            .collect();
        let changes: Vec<Wrench> = next.iter().zip(&wrenches).map(|(a, b)| a.plus(-1.0, b)).collect();
        let [of_momentum, of_angular_momentum] = sizes(&changes);
        wrenches = next;
        if of_momentum <= TOLERANCE * momentum && of_angular_momentum <= TOLERANCE * angular_momentum {
            break;
        }
    }
    wrenches
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::Exchange;
    use crate::facets::facets;
    use crate::horizon::HorizonMap;
    use crate::scanner::Scanner;
    use crate::test_bodies::{first_hit, rugged};
    use std::f64::consts::TAU;

    /// Uniform numbers in [0, 1): splitmix64.
    fn uniform(state: &mut u64) -> f64 {
        *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = *state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Photons followed by rays from centroid to centroid.
    #[test]
    fn wrenches_are_those_of_photons_that_walk() {
        let mesh = rugged(60);
        let facets = facets(&mesh).unwrap();
        let scanner = Scanner::new(&mesh, 480);
        let map = HorizonMap::of(&facets, &scanner);
        let photons = 15_000;
        let mut random = 1;
        for (mode, flights) in [(SelfHeating::Single, 1), (SelfHeating::Multiple, usize::MAX)] {
            let exchange = Exchange::new(&facets, &scanner, &map, mode).unwrap();
            let mut looking: Vec<usize> =
                (0..facets.len()).filter(|f| exchange.wrench(*f, Azimuths::All).is_some()).collect();
            let hidden = |f: &usize| exchange.views.rows[*f].iter().map(|s| s.fractions[0]).sum::<f32>();
            looking.sort_by(|a, b| hidden(b).total_cmp(&hidden(a)));
            assert!(hidden(&looking[0]) > 0.4);
            for &start in looking.iter().step_by(12) {
                let mut sum = Wrench { momentum: [0.0; 3], angular_momentum: [0.0; 3] };
                for _ in 0..photons {
                    let mut at = start;
                    for flight in 0.. {
                        let (s2, azimuth) = (uniform(&mut random), TAU * uniform(&mut random));
                        let (s, c) = (s2.sqrt(), (1.0 - s2).sqrt());
                        let [north, west, up] = facets[at].horizon_axes();
                        let (sin_az, cos_az) = azimuth.sin_cos();
                        let towards: [f64; 3] =
                            std::array::from_fn(|i| s * (cos_az * north[i] + sin_az * west[i]) + c * up[i]);
                        let Some(next) = first_hit(&mesh, facets[at].point, towards, at) else {
                            let [x, y, z] = facets[at].point;
                            let [p, q, r] = towards;
                            let angular_momentum = [y * r - z * q, z * p - x * r, x * q - y * p];
                            sum = sum.plus(1.0 / f64::from(photons), &Wrench { momentum: towards, angular_momentum });
                            break;
                        };
                        if flight == flights {
                            break;
                        }
                        at = next;
                    }
                }
                let wrench = exchange.wrench(start, Azimuths::All).unwrap();
                let [p, l] = wrench.plus(-1.0, &sum).size();
                // Four standard deviations of a mean of photons, and 0.002 for the azimuths.
                assert!(p < 4.0 / f64::from(photons).sqrt() + 0.002, "{mode:?}, facet {start}: {wrench:?} {sum:?}");
                assert!(l < 6.0 / f64::from(photons).sqrt() + 0.002, "{mode:?}, facet {start}: {wrench:?} {sum:?}");
            }
        }
    }
}
