//! Bidirectional reflectance of a particulate surface without opposition effect, `r(i, e, psi)` in 1/sr.
//!
//! Sources: phase function, multiple scattering and the approximation of `H` from Hapke 2002 (Icarus 157, 523);
//! macroscopic roughness from Hapke 1984 (Icarus 59, 41), with the roughness angle as given (not reduced by `1 - r0`).
//! `i` is the angle of incidence, `e` of emission, `psi` the azimuth between them: at `psi = 0` light leaves back over
//! the Sun's side. Light that roughness loses is absorbed.

use crate::quadrature::CubicTable;
use crate::surface::{Hapke, MultipleScattering};
use std::f64::consts::PI;

/// Below this, a term of the Legendre series of the phase function no longer matters.
const SERIES_END: f64 = 1e-12;

/// A Hapke surface with everything worked out that does not depend on the angles.
#[derive(Debug, Clone)]
pub struct Photometry {
    w: f64,
    r0: f64,
    xi: f64,
    tan_roughness: f64,
    chi: f64,
    /// `P(x)` and `Pbar` of the anisotropic model; `None` in the isotropic approximation.
    anisotropic: Option<(CubicTable<1>, f64)>,
}

/// What roughness needs to know about one zenith angle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Slope {
    pub cos: f64,
    pub sin: f64,
    e1: f64,
    e2: f64,
    eta: f64,
}

/// What roughness needs to know about the azimuth between Sun and observer.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Azimuth {
    pub cos: f64,
    over_pi: f64,
    sin2_half: f64,
    f: f64,
}

impl Azimuth {
    /// `psi` in [0, pi].
    pub fn new(psi: f64) -> Self {
        let sin2_half = (0.5 * psi).sin().powi(2);
        Self { cos: psi.cos(), over_pi: psi / PI, sin2_half, f: (-2.0 * (0.5 * psi).tan().max(0.0)).exp() }
    }
}

impl Photometry {
    /// Prepares the surface; the parameters are taken as valid ([`Hapke::validate`]).
    pub fn new(hapke: &Hapke) -> Self {
        let w = hapke.single_scattering_albedo;
        let gamma = (1.0 - w).sqrt();
        let tan_roughness = hapke.roughness_deg.to_radians().tan();
        let anisotropic = match hapke.multiple_scattering {
            MultipleScattering::Imsa => None,
            MultipleScattering::H2002 => Some(hemispheric_means(hapke.asymmetry)),
        };
        Self {
            w,
            r0: (1.0 - gamma) / (1.0 + gamma),
            xi: hapke.asymmetry,
            tan_roughness,
            chi: 1.0 / (1.0 + PI * tan_roughness * tan_roughness).sqrt(),
            anisotropic,
        }
    }

    /// Reflectance, 1/sr, for incidence and emission in [0, pi/2] and any azimuth, rad: radiance over beam-normal flux.
    pub fn reflectance(&self, incidence: f64, emission: f64, azimuth: f64) -> f64 {
        let folded = azimuth.rem_euclid(2.0 * PI);
        let azimuth = Azimuth::new(folded.min(2.0 * PI - folded));
        let (i, e) = (self.slope(incidence.cos()), self.slope(emission.cos()));
        i.cos * self.reflectance_over_mu0(&i, &e, &azimuth)
    }

    /// The zenith angle with cosine `cos` (clamped to [0, 1]).
    pub(crate) fn slope(&self, cos: f64) -> Slope {
        let cos = cos.clamp(0.0, 1.0);
        let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
        if self.tan_roughness == 0.0 {
            return Slope { cos, sin, e1: 0.0, e2: 0.0, eta: cos };
        }
        // cot is infinite at the zenith, where both exponentials vanish.
        let cots = cos / (sin * self.tan_roughness);
        let e1 = (-2.0 / PI * cots).exp();
        let e2 = (-cots * cots / PI).exp();
        Slope { cos, sin, e1, e2, eta: self.chi * (cos + sin * self.tan_roughness * e2 / (2.0 - e1)) }
    }

    /// `r / cos i`, which stays finite at grazing incidence.
    #[inline]
    pub(crate) fn reflectance_over_mu0(&self, i: &Slope, e: &Slope, azimuth: &Azimuth) -> f64 {
        let cos_phase = i.cos * e.cos + i.sin * e.sin * azimuth.cos;
        let (mu0, mu, geometry) = self.effective_cosines(i, e, azimuth);
        let multiple = match &self.anisotropic {
            None => self.h(mu0) * self.h(mu) - 1.0,
            Some((mean, mean_of_mean)) => {
                let (h0, h) = (self.h(mu0) - 1.0, self.h(mu) - 1.0);
                mean.at(mu0)[0] * h + mean.at(mu)[0] * h0 + mean_of_mean * h0 * h
            }
        };
        self.w / (4.0 * PI) * geometry * (self.phase_function(cos_phase) + multiple)
    }

    /// One-term Henyey-Greenstein function of the phase angle, mean 1 over the sphere.
    fn phase_function(&self, cos_phase: f64) -> f64 {
        let base = 1.0 + 2.0 * self.xi * cos_phase + self.xi * self.xi;
        (1.0 - self.xi * self.xi) / (base * base.sqrt())
    }

    /// Hapke's 2002 approximation of the Ambartsumian-Chandrasekhar function.
    #[inline]
    fn h(&self, x: f64) -> f64 {
        if x <= 0.0 {
            return 1.0;
        }
        1.0 / (1.0 - self.w * x * (self.r0 + (0.5 - self.r0 * x) * (1.0 / x).ln_1p()))
    }

    /// Effective cosines of incidence and emission on a rough surface and `mu0e / (mu0e + mue) S / cos i`.
    #[inline]
    fn effective_cosines(&self, i: &Slope, e: &Slope, azimuth: &Azimuth) -> (f64, f64, f64) {
        if self.tan_roughness == 0.0 {
            return (i.cos, e.cos, 1.0 / (i.cos + e.cos));
        }
        let (t, chi) = (self.tan_roughness, self.chi);
        // `low` is the smaller zenith angle: Hapke's two cases are mirror images of each other.
        let incidence_low = i.cos >= e.cos;
        let (low, high) = if incidence_low { (i, e) } else { (e, i) };
        let d = 2.0 - high.e1 - azimuth.over_pi * low.e1;
        let mu_low = chi * (low.cos + low.sin * t * (azimuth.cos * high.e2 + azimuth.sin2_half * low.e2) / d);
        let mu_high = chi * (high.cos + high.sin * t * (high.e2 - azimuth.sin2_half * low.e2) / d);
        let (mu0, mu) = if incidence_low { (mu_low, mu_high) } else { (mu_high, mu_low) };
        let (mu0, mu) = (mu0.clamp(0.0, 1.0), mu.clamp(0.0, 1.0));
        let shadowing = 1.0 - azimuth.f + azimuth.f * chi * low.cos / low.eta;
        (mu0, mu, mu0 / (mu0 + mu) * mu / (e.eta * i.eta) * chi / shadowing)
    }
}

/// `P(x)`, the phase function averaged over the upper hemisphere of the other direction, and its own average `Pbar`
/// (Hapke 2002), from the Legendre series of the phase function.
fn hemispheric_means(xi: f64) -> (CubicTable<1>, f64) {
    // Odd n only: term n of P(x) is A_n b_n P_n(x), of Pbar A_n^2 b_n.
    let mut terms = Vec::new();
    let mut mean_of_mean = 1.0;
    let (mut ratio, mut power, mut sign) = (0.5, -xi, -1.0);
    for n in (1..).step_by(2) {
        let a = sign * ratio / f64::from(n);
        let b = f64::from(2 * n + 1) * power;
        if b.abs() < SERIES_END || n > 20_000 {
            break;
        }
        terms.push(a * b);
        mean_of_mean += a * a * b;
        ratio *= f64::from(n + 2) / f64::from(n + 3);
        power *= xi * xi;
        sign = -sign;
    }
    let intervals = 512;
    let mean = |k: usize| {
        let x = k as f64 / f64::from(intervals);
        // Legendre polynomials of degree n - 1 and n by their recurrence.
        let (mut before, mut now, mut sum) = (1.0, x, 1.0);
        for (k, term) in terms.iter().enumerate() {
            sum += term * now;
            for n in [2 * k + 2, 2 * k + 3].map(|n| n as f64) {
                (before, now) = (now, ((2.0 * n - 1.0) * x * now - (n - 1.0) * before) / n);
            }
        }
        [sum]
    };
    let nodes: Vec<_> = (0..=intervals as usize).map(mean).collect();
    (CubicTable::new(&nodes), mean_of_mean)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::gauss_legendre;

    fn surface(roughness_deg: f64, multiple_scattering: MultipleScattering) -> Photometry {
        Photometry::new(&Hapke { roughness_deg, multiple_scattering, ..Hapke::default() })
    }

    fn geometry(p: &Photometry, i_deg: f64, e_deg: f64, psi_deg: f64) -> (f64, f64, f64) {
        let (i, e) = (p.slope(i_deg.to_radians().cos()), p.slope(e_deg.to_radians().cos()));
        let (mu0, mu, factor) = p.effective_cosines(&i, &e, &Azimuth::new(psi_deg.to_radians()));
        (mu0, mu, factor * i.cos * (mu0 + mu) / mu0)
    }

    #[test]
    fn constants_of_the_model_match_independent_values() {
        let p = surface(20.0, MultipleScattering::H2002);
        assert!((p.r0 - 0.06524836).abs() < 5e-9);
        assert!((p.h(1.0) - 1.0920809).abs() < 5e-8);
        assert!((p.h(0.5) - 1.0712970).abs() < 5e-8);
        assert_eq!(p.h(0.0), 1.0);
        let (mean, mean_of_mean) = p.anisotropic.as_ref().unwrap();
        assert!((mean.at(1.0)[0] - 0.509245).abs() < 5e-7);
        assert!((mean.at(0.5)[0] - 0.720858).abs() < 5e-7);
        assert!((mean_of_mean - 1.267431).abs() < 5e-7);
        assert!((p.phase_function(1.0) - 3.19527).abs() < 5e-6);
        assert!((p.phase_function(-1.0) - 0.35665).abs() < 5e-6);
        let n = 2000;
        let mean_phase: f64 =
            (0..n).map(|k| p.phase_function(-1.0 + (2.0 * f64::from(k) + 1.0) / f64::from(n))).sum::<f64>()
                / f64::from(n);
        assert!((mean_phase - 1.0).abs() < 1e-5);
    }

    /// Columns: i, e, psi (deg), mu0e, mue, S, r isotropic, r anisotropic; from an independent implementation.
    #[test]
    fn reflectance_matches_independent_values() {
        let table = [
            [0.0, 0.0, 0.0, 0.840312, 0.840312, 1.000000, 3.090330e-2, 3.023407e-2],
            [30.0, 60.0, 0.0, 0.769700, 0.492848, 1.000000, 2.819346e-2, 2.763301e-2],
            [30.0, 60.0, 180.0, 0.684556, 0.494938, 1.004161, 9.551702e-3, 9.051902e-3],
            [60.0, 30.0, 180.0, 0.494938, 0.684556, 0.801865, 5.514677e-3, 5.226118e-3],
            [60.0, 30.0, 90.0, 0.493877, 0.727767, 0.852489, 8.468854e-3, 8.162261e-3],
            [60.0, 60.0, 90.0, 0.461056, 0.461056, 0.813758, 8.145738e-3, 7.889299e-3],
        ];
        let (imsa, h2002) = (surface(20.0, MultipleScattering::Imsa), surface(20.0, MultipleScattering::H2002));
        for [i, e, psi, mu0, mu, s, r_imsa, r_h2002] in table {
            let got = geometry(&imsa, i, e, psi);
            assert!((got.0 - mu0).abs() < 1e-6 && (got.1 - mu).abs() < 1e-6 && (got.2 - s).abs() < 1e-6, "{got:?}");
            let [i, e, psi] = [i, e, psi].map(f64::to_radians);
            assert!((imsa.reflectance(i, e, psi) / r_imsa - 1.0).abs() < 1e-6);
            assert!((h2002.reflectance(i, e, psi) / r_h2002 - 1.0).abs() < 1e-6);
            assert_eq!(h2002.reflectance(i, e, psi), h2002.reflectance(i, e, -psi));
        }
        let smooth = surface(0.0, MultipleScattering::Imsa).reflectance(0.0, 0.0, 0.0);
        assert!((smooth / 3.100412e-2 - 1.0).abs() < 1e-6);
    }

    /// Ambartsumian's equation, 1/H = sqrt(1 - w) + w/2 int_0^1 t H(t) / (x + t) dt, solved by iteration.
    #[test]
    fn approximate_h_function_is_within_its_published_error() {
        let w = Hapke::default().single_scattering_albedo;
        let rule: Vec<_> = gauss_legendre(48).into_iter().map(|(x, weight)| (0.5 * (x + 1.0), 0.5 * weight)).collect();
        let next = |x: f64, h: &[f64]| {
            let sum: f64 = rule.iter().zip(h).map(|((t, weight), h)| weight * t * h / (x + t)).sum();
            1.0 / ((1.0 - w).sqrt() + 0.5 * w * sum)
        };
        let mut h = vec![1.0; rule.len()];
        for _ in 0..60 {
            h = rule.iter().map(|(x, _)| next(*x, &h)).collect();
        }
        assert!((next(1.0, &h) - 1.0924).abs() < 5e-5);
        let p = surface(20.0, MultipleScattering::Imsa);
        let worst =
            (0..=100).map(|k| f64::from(k) / 100.0).map(|x| (p.h(x) / next(x, &h) - 1.0).abs()).fold(0.0, f64::max);
        assert!((2.9e-4..3.1e-4).contains(&worst), "{worst:e}");
    }

    #[test]
    fn light_paths_are_reversible() {
        let p = surface(20.0, MultipleScattering::Imsa);
        let [i, e, psi] = [30f64, 60.0, 180.0].map(f64::to_radians);
        let there = p.reflectance(i, e, psi) / i.cos();
        let back = p.reflectance(e, i, psi) / e.cos();
        assert!((there / 1.10294e-2 - 1.0).abs() < 1e-5 && (there / back - 1.0).abs() < 1e-12);
    }

    #[test]
    fn extreme_parameters_and_angles_stay_finite() {
        for roughness_deg in [0.0, 1e-9, 0.1, 59.9] {
            for asymmetry in [-0.999, 0.0, 0.999] {
                for multiple_scattering in [MultipleScattering::Imsa, MultipleScattering::H2002] {
                    let hapke =
                        Hapke { single_scattering_albedo: 0.999_999, roughness_deg, asymmetry, multiple_scattering };
                    let p = Photometry::new(&hapke);
                    for i in [0.0, 1e-8, 0.7, PI / 2.0 - 1e-9] {
                        for e in [0.0, 1e-8, 0.7, PI / 2.0 - 1e-9] {
                            for psi in [0.0, 1e-8, 2.0, PI] {
                                let r = p.reflectance(i, e, psi);
                                assert!(r.is_finite(), "{hapke:?} {i} {e} {psi}: {r}");
                            }
                        }
                    }
                }
            }
        }
    }
}
