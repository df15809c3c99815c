//! What the recoil of a facet needs to know of its reflectance: three functions of the angle of incidence.
//!
//! With `mu0 = cos i` and the reflectance `r` of [`crate::hapke`], integrated over the hemisphere of emission,
//! `A_dh = 1/mu0 int r mu dOmega` (the light scattered), `f_n = 1/mu0 int r mu^2 dOmega` (its recoil along the normal)
//! and `f_t = 1/mu0 int r mu sin e cos psi dOmega` (light that leaves towards the Sun's side). Because `r` depends on azimuth
//! through `psi` alone, nothing more is lost by tabulating them.

use crate::hapke::{Azimuth, Photometry};
use crate::quadrature::{CubicTable, gauss_legendre};
use crate::surface::Hapke;
use rayon::prelude::*;
use std::f64::consts::PI;
use std::sync::{Arc, Mutex};

/// Nodes of the table, evenly spaced in the cosine of incidence.
const NODES: usize = 193;
/// Gauss points over emission on either side of `e = i`, where the roughness formulas change.
const EMISSION_POINTS: usize = 16;
/// Gauss points over azimuth from 0 to pi.
const AZIMUTH_POINTS: usize = 24;
/// How many parameter sets are remembered; more than any run uses.
const REMEMBERED: usize = 16;

/// `A_dh`, `f_n` and `f_t` of a Hapke surface, tabulated in `cos i` and interpolated by cubics.
#[derive(Debug, Clone, PartialEq)]
pub struct RecoilTable {
    /// `A_dh`, `f_n` and `f_t / sin i`, all three smooth in `cos i`, and an idle fourth that makes two pairs of them.
    table: CubicTable<4>,
}

/// Recoil of a facet in a form that is a sum over the lit part of a day: the force on a facet of unit area in sunlight
/// of unit pressure is `-(emitted p + normal n + solar s)`, `p` the emission recoil of unit exitance, `n` the facet's
/// normal and `s` the direction of the Sun.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Recoil {
    /// What leaves as Lambert's light under the facet's sky: `mu0 (1 - A_dh)`, absorbed and emitted again.
    pub emitted: f64,
    /// `mu0 (f_n - mu0 f_t / sin i)`.
    pub normal: f64,
    /// `mu0 f_t / sin i`.
    pub solar: f64,
}

impl Recoil {
    #[inline(always)]
    pub fn plus(&self, o: &Self) -> Self {
        Self { emitted: self.emitted + o.emitted, normal: self.normal + o.normal, solar: self.solar + o.solar }
    }

    #[inline(always)]
    pub fn minus(&self, o: &Self) -> Self {
        Self { emitted: self.emitted - o.emitted, normal: self.normal - o.normal, solar: self.solar - o.solar }
    }
}

/// Recoil as a function of the cosine of incidence; kernels are compiled for each implementation.
pub(crate) trait RecoilKernel: Sync {
    /// Recoil for `mu0` in [0, 1]; slightly negative values by round-off are as good as 0.
    fn at(&self, mu0: f64) -> Recoil;

    /// Light absorbed, `mu0 (1 - A_dh)`.
    #[inline(always)]
    fn absorbed(&self, mu0: f64) -> f64 {
        self.at(mu0).emitted
    }
}

/// A surface that scatters the fraction `albedo` isotropically: `A_dh = albedo`, `f_n = 2/3 albedo`, `f_t = 0`.
pub(crate) struct LambertRecoil {
    pub albedo: f64,
}

impl RecoilKernel for LambertRecoil {
    #[inline(always)]
    fn at(&self, mu0: f64) -> Recoil {
        let mu0 = mu0.max(0.0);
        Recoil { emitted: (1.0 - self.albedo) * mu0, normal: 2.0 / 3.0 * self.albedo * mu0, solar: 0.0 }
    }
}

impl RecoilKernel for RecoilTable {
    #[inline(always)]
    fn at(&self, mu0: f64) -> Recoil {
        let mu0 = mu0.max(0.0);
        let [scattered, normal, tangential, _] = self.table.at(mu0);
        Recoil { emitted: mu0 * (1.0 - scattered), normal: mu0 * (normal - mu0 * tangential), solar: mu0 * tangential }
    }
}

impl RecoilTable {
    /// The table of a surface. Computed once per parameter set and process, about 10 ms; later calls only copy a handle.
    pub fn cached(hapke: &Hapke) -> Arc<Self> {
        static TABLES: Mutex<Vec<(Hapke, Arc<RecoilTable>)>> = Mutex::new(Vec::new());
        let find = |known: &[(Hapke, Arc<Self>)]| known.iter().find(|(h, _)| h == hapke).map(|(_, t)| t.clone());
        // A panic elsewhere cannot leave the list half-written, so a poisoned lock is as good as a clean one.
        let lock = || TABLES.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some(table) = find(&lock()) {
            return table;
        }
        // Computed outside the lock: two threads may do so at once and get the same bytes.
        let table = Arc::new(Self::with_points(hapke, EMISSION_POINTS, AZIMUTH_POINTS));
        let mut known = lock();
        if find(&known).is_none() {
            if known.len() == REMEMBERED {
                known.remove(0);
            }
            known.push((*hapke, table.clone()));
        }
        table
    }

    /// The table by quadrature with `emission_points` on either side of `e = i` and `azimuth_points` over half a turn.
    fn with_points(hapke: &Hapke, emission_points: usize, azimuth_points: usize) -> Self {
        let photometry = Photometry::new(hapke);
        let emission = gauss_legendre(emission_points);
        let azimuth: Vec<_> = gauss_legendre(azimuth_points)
            .into_iter()
            .map(|(x, weight)| (Azimuth::new(0.5 * PI * (x + 1.0)), PI * weight))
            .collect();
        let nodes: Vec<_> = (0..NODES)
            .into_par_iter()
            .map(|k| hemisphere(&photometry, k as f64 / (NODES - 1) as f64, &emission, &azimuth))
            .collect();
        Self { table: CubicTable::new(&nodes) }
    }

    /// `(A_dh, f_n, f_t)` at the cosine of incidence `mu0` in [0, 1].
    pub fn at_cosine(&self, mu0: f64) -> (f64, f64, f64) {
        let [scattered, normal, tangential, _] = self.table.at(mu0);
        (scattered, normal, tangential * ((1.0 - mu0) * (1.0 + mu0)).max(0.0).sqrt())
    }

    /// Bond albedo, `2 int A_dh mu0 dmu0`.
    pub fn bond_albedo(&self) -> f64 {
        gauss_legendre(64)
            .iter()
            .map(|(x, weight)| (0.5 * (x + 1.0), 0.5 * weight))
            .map(|(mu0, weight)| 2.0 * weight * mu0 * self.at_cosine(mu0).0)
            .sum()
    }
}

/// `A_dh`, `f_n` and `f_t / sin i` at `mu0 = cos i`; the weights of `azimuth` cover the whole turn.
fn hemisphere(p: &Photometry, mu0: f64, emission: &[(f64, f64)], azimuth: &[(Azimuth, f64)]) -> [f64; 4] {
    // At the zenith f_t / sin i is a limit; 1e-3 rad away it is off by 1e-6 of itself.
    let incidence = mu0.acos().max(1e-3);
    let i = p.slope(incidence.cos());
    let mut sums = [0.0; 4];
    for (from, to) in [(0.0, incidence), (incidence, 0.5 * PI)] {
        for &(x, weight) in emission {
            let angle = 0.5 * (from + to) + 0.5 * (to - from) * x;
            let e = p.slope(angle.cos());
            let (mut all, mut towards_sun) = (0.0, 0.0);
            for (azimuth, weight) in azimuth {
                let r = weight * p.reflectance_over_mu0(&i, &e, azimuth);
                all += r;
                towards_sun += r * azimuth.cos;
            }
            let solid_angle = 0.5 * (to - from) * weight * e.sin;
            sums[0] += solid_angle * all * e.cos;
            sums[1] += solid_angle * all * e.cos * e.cos;
            sums[2] += solid_angle * towards_sun * e.cos * e.sin / i.sin;
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::Scattering;
    use crate::horizon::Horizon;
    use crate::sky::sky_view;
    use crate::surface::MultipleScattering;

    fn table(roughness_deg: f64, multiple_scattering: MultipleScattering) -> Arc<RecoilTable> {
        RecoilTable::cached(&Hapke { roughness_deg, multiple_scattering, ..Hapke::default() })
    }

    /// Rows: A_dh, f_n, f_t at incidence 0, 15, 30, 45, 60, 75, 85 deg; independent quadrature, given to 1e-5.
    #[test]
    fn recoil_functions_match_independent_values() {
        let imsa = [
            [0.06589, 0.06611, 0.06691, 0.06798, 0.06758, 0.06650, 0.06619],
            [0.04750, 0.04725, 0.04662, 0.04557, 0.04329, 0.04033, 0.03848],
            [0.0, 0.00523, 0.01018, 0.01478, 0.01891, 0.02228, 0.02407],
        ];
        let h2002 = [
            [0.06391, 0.06413, 0.06493, 0.06605, 0.06577, 0.06480, 0.06454],
            [0.04615, 0.04590, 0.04528, 0.04427, 0.04205, 0.03916, 0.03736],
            [0.0, 0.00522, 0.01015, 0.01472, 0.01878, 0.02207, 0.02379],
        ];
        for (model, expected) in [(MultipleScattering::Imsa, imsa), (MultipleScattering::H2002, h2002)] {
            let table = table(20.0, model);
            for (k, i_deg) in [0f64, 15.0, 30.0, 45.0, 60.0, 75.0, 85.0].into_iter().enumerate() {
                let (a, n, t) = table.at_cosine(i_deg.to_radians().cos());
                for (got, want) in [(a, expected[0][k]), (n, expected[1][k]), (t, expected[2][k])] {
                    assert!((got - want).abs() < 6e-6, "{model:?} {i_deg}: {got} {want}");
                }
            }
        }
    }

    #[test]
    fn bond_albedos_match_independent_values() {
        for (roughness, model, expected) in [
            (20.0, MultipleScattering::Imsa, 0.067164),
            (20.0, MultipleScattering::H2002, 0.065276),
            (0.0, MultipleScattering::Imsa, 0.074080),
            (0.0, MultipleScattering::H2002, 0.071884),
        ] {
            let got = table(roughness, model).bond_albedo();
            assert!((got - expected).abs() < 2e-6, "{roughness} {model:?}: {got}");
        }
    }

    #[test]
    fn geometric_albedo_matches_independent_value() {
        // A Lambert disk scatters 1/pi; the sphere seen from the Sun is 2 int r(i, i, 0) mu dmu / (1/pi).
        let p = Photometry::new(&Hapke { multiple_scattering: MultipleScattering::Imsa, ..Hapke::default() });
        let sum: f64 = gauss_legendre(64)
            .iter()
            .map(|(x, w)| (0.5 * (x + 1.0), 0.5 * w))
            .map(|(mu, w)| 2.0 * w * mu * p.reflectance(mu.acos(), mu.acos(), 0.0))
            .sum();
        assert!((PI * sum - 0.0964).abs() < 1e-4, "{}", PI * sum);
    }

    #[test]
    fn quadrature_has_converged() {
        for roughness_deg in [0.0, 5.0, 20.0, 45.0] {
            let hapke = Hapke { roughness_deg, ..Hapke::default() };
            let (fine, ours) = (RecoilTable::with_points(&hapke, 96, 96), RecoilTable::cached(&hapke));
            let mut worst = 0.0f64;
            for k in 0..=2000 {
                let mu0 = f64::from(k) / 2000.0;
                let (f, o) = (fine.at_cosine(mu0), ours.at_cosine(mu0));
                // What enters a torque is mu0 times these.
                let off = (f.0 - o.0).abs().max((f.1 - o.1).abs()).max((f.2 - o.2).abs());
                worst = worst.max(mu0 * off);
            }
            println!("roughness {roughness_deg} deg: {worst:e}");
            assert!(worst < 2e-6, "{roughness_deg}: {worst:e}");
        }
    }

    #[test]
    fn interpolation_matches_direct_quadrature_between_nodes() {
        let hapke = Hapke::default();
        let (p, table) = (Photometry::new(&hapke), RecoilTable::cached(&hapke));
        let emission = gauss_legendre(96);
        let azimuth: Vec<_> =
            gauss_legendre(96).into_iter().map(|(x, w)| (Azimuth::new(0.5 * PI * (x + 1.0)), PI * w)).collect();
        for mu0 in [0.003, 0.0123, 0.0391, 0.1, 0.4999, 0.777, 0.9991] {
            let direct = hemisphere(&p, mu0, &emission, &azimuth);
            let got = table.table.at(mu0);
            for c in 0..3 {
                assert!(mu0 * (direct[c] - got[c]).abs() < 2e-6, "{mu0} {c}: {} {}", direct[c], got[c]);
            }
        }
    }

    /// Isotropic grains that absorb nothing scatter everything; what is missing is the error of the approximate H
    /// function, which enters twice and is largest at w = 1.
    #[test]
    fn bright_smooth_surface_scatters_all_light() {
        let hapke = Hapke {
            single_scattering_albedo: 1.0 - 1e-9,
            roughness_deg: 0.0,
            asymmetry: 0.0,
            multiple_scattering: MultipleScattering::Imsa,
        };
        let table = RecoilTable::cached(&hapke);
        for mu0 in [0.1, 0.3, 0.5, 0.8, 1.0] {
            assert!((table.at_cosine(mu0).0 - 1.0).abs() < 0.015, "{mu0}: {:?}", table.at_cosine(mu0));
        }
        assert!((table.bond_albedo() - 1.0).abs() < 0.015, "{}", table.bond_albedo());
    }

    #[test]
    fn black_grains_scatter_nothing() {
        let table = RecoilTable::cached(&Hapke { single_scattering_albedo: 0.0, ..Hapke::default() });
        assert_eq!(table.at_cosine(0.3), (0.0, 0.0, 0.0));
    }

    /// 2/3 of the emitted light's momentum along the normal, over the lit hemisphere: (4/9) (1 - A) pi R^2 of the beam.
    #[test]
    fn lambert_sphere_recoils_by_four_ninths() {
        let kernel = LambertRecoil { albedo: 0.3 };
        let force: f64 = gauss_legendre(16)
            .into_iter()
            .map(|(x, weight)| (0.5 * (x + 1.0), 0.5 * weight))
            .map(|(mu0, weight)| 2.0 * PI * weight * mu0 * 2.0 / 3.0 * kernel.at(mu0).emitted)
            .sum();
        assert!((force - 4.0 / 9.0 * 0.7 * PI).abs() < 1e-14);
    }

    #[test]
    fn lambert_recoil_is_two_thirds_of_the_albedo() {
        let recoil = LambertRecoil { albedo: 0.3 }.at(0.5);
        assert!((recoil.emitted - 0.35).abs() < 1e-16 && (recoil.normal - 0.1).abs() < 1e-16 && recoil.solar == 0.0);
    }

    /// Momentum along and towards azimuth 0 of the normal, per unit beam, of a facet under a horizon.
    fn recoil_under(kernel: &impl RecoilKernel, tan_elevation: impl Fn(f64) -> f64, mu0: f64) -> [f64; 2] {
        let n = 2880;
        let tan_elevation = (0..n).map(|k| tan_elevation(2.0 * PI * f64::from(k) / f64::from(n)) as f32).collect();
        let sky = sky_view(&Horizon { tan_elevation, overhangs: Box::new([]) });
        let recoil = kernel.at(mu0);
        [recoil.emitted * sky.normal + recoil.normal, recoil.emitted * sky.tangential[0]]
    }

    /// Everything that leaves a Lambert surface leaves as Lambert's light, so how much of it was absorbed before does not
    /// matter. Momenta under a horizon of 30 deg, before a wall and in a hole are those of an emitter.
    #[test]
    fn blocked_reflection_of_a_lambert_surface_is_emission() {
        let wall = |az: f64| if az.cos() > 1e-9 { 1e9 } else { 0.0 };
        for albedo in [0.0, 0.3, 1.0] {
            let kernel = Scattering(&LambertRecoil { albedo });
            let [normal, towards] = recoil_under(&kernel, |_| (PI / 6.0).tan(), 0.8);
            assert!((normal - 0.8 * 0.583333).abs() < 1e-6 && towards.abs() < 1e-12, "{albedo}: {normal}");
            let [normal, towards] = recoil_under(&kernel, wall, 0.8);
            assert!(
                (normal - 0.8 / 3.0).abs() < 1e-3 && (towards + 0.8 * 0.2122066).abs() < 1e-3,
                "{normal} {towards}"
            );
            let [normal, towards] = recoil_under(&kernel, |_| 1e9, 0.8);
            assert!(normal.abs() < 1e-12 && towards.abs() < 1e-12, "{normal} {towards}");
            assert!((kernel.absorbed(0.8) - 0.8 * (1.0 - albedo)).abs() < 1e-15);
        }
    }

    /// What is taken off is the reflected energy times the momentum that a Lambert emitter of that energy loses.
    #[test]
    fn blocked_reflection_of_a_hapke_surface_loses_its_albedo_of_a_lambert_emitter() {
        let table = RecoilTable::cached(&Hapke::default());
        let blocked = Scattering(&*table);
        for mu0 in [0.05, 0.4, 1.0] {
            let albedo = table.at_cosine(mu0).0;
            for tan_elevation in [0.0, 0.2, 3.0] {
                let [plain, _] = recoil_under(&*table, |_| tan_elevation, mu0);
                let [less, _] = recoil_under(&blocked, |_| tan_elevation, mu0);
                let [lambert, _] = recoil_under(&LambertRecoil { albedo: 0.0 }, |_| tan_elevation, mu0);
                let lost = albedo * (2.0 / 3.0 * mu0 - lambert);
                assert!((plain - less - lost).abs() < 1e-14, "{mu0} {tan_elevation}: {plain} {less} {lost}");
            }
            assert_eq!(blocked.at(mu0).solar, table.at(mu0).solar);
        }
    }
}
