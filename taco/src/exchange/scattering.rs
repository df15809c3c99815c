//! Recoil of direct sunlight on a facet whose scattered light shares the fate of its emitted light: part of it is followed to
//! other facets, or blocked by them.

use crate::recoil::{Recoil, RecoilKernel};

/// A reflectance whose scattered light joins the emitted light: all light that arrives leaves isotropically and is followed
/// as such, and what remains of the recoil of the scattered light is how its directions differ from isotropic ones. Of the
/// light that other facets block this difference is not taken off.
pub(crate) struct Scattering<'a, K>(pub &'a K);

impl<K: RecoilKernel> RecoilKernel for Scattering<'_, K> {
    #[inline(always)]
    fn at(&self, mu0: f64) -> Recoil {
        let arriving = mu0.max(0.0);
        let recoil = self.0.at(arriving);
        let scattered = arriving - recoil.emitted;
        Recoil { emitted: arriving, normal: recoil.normal - 2.0 / 3.0 * scattered, solar: recoil.solar }
    }

    #[inline(always)]
    fn absorbed(&self, mu0: f64) -> f64 {
        self.0.absorbed(mu0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recoil::LambertRecoil;

    /// Under an open sky emission exerts 2/3 along the normal, so the sum must not change.
    #[test]
    fn recoil_under_an_open_sky_is_unchanged() {
        let inner = LambertRecoil { albedo: 0.3 };
        let (plain, followed) = (inner.at(0.4), Scattering(&inner).at(0.4));
        assert!((followed.emitted - 0.4).abs() < 1e-16 && followed.normal.abs() < 1e-16);
        let total = |r: Recoil| 2.0 / 3.0 * r.emitted + r.normal;
        assert!((total(plain) - total(followed)).abs() < 1e-16);
    }
}
