//! How much of what a facet emits escapes, and what recoil that leaves.
//!
//! A Lambert emitter of unit exitance below a horizon of elevation `h(az)`; light that meets another part of the body
//! carries its momentum there, so the pair exerts no net force and only what escapes counts. Closed integrals over
//! elevation, equal-step rule over azimuth.

use crate::horizon::Horizon;
use std::f64::consts::{FRAC_1_PI, TAU};

/// The sky above a facet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SkyView {
    /// Momentum of the escaping light along the normal, per emitted energy over the speed of light; 2/3 for an open sky.
    pub normal: f64,
    /// Its component towards azimuth 0 and towards a quarter turn further.
    pub tangential: [f64; 2],
    /// Fraction of the emitted energy that escapes.
    pub escaping: f64,
}

impl SkyView {
    /// A sky without obstacle.
    pub const OPEN: Self = Self { normal: 2.0 / 3.0, tangential: [0.0, 0.0], escaping: 1.0 };
}

/// The sky that a horizon leaves open.
pub fn sky_view(horizon: &Horizon) -> SkyView {
    let n = horizon.tan_elevation.len();
    let step = TAU / n as f64;
    let mut view = SkyView { normal: 0.0, tangential: [0.0, 0.0], escaping: 0.0 };
    // The sky above an elevation, added or taken away.
    let mut add = |k: usize, tan_elevation: f32, sign: f64| {
        let t = f64::from(tan_elevation);
        let cos2 = 1.0 / (1.0 + t * t);
        let cos = cos2.sqrt();
        let (sin_az, cos_az) = (step * k as f64).sin_cos();
        view.normal += sign * (1.0 - (t * cos).powi(3));
        view.tangential[0] += sign * cos2 * cos * cos_az;
        view.tangential[1] += sign * cos2 * cos * sin_az;
        view.escaping += sign * cos2;
    };
    for (k, &t) in horizon.tan_elevation.iter().enumerate() {
        add(k, t, 1.0);
    }
    for overhang in &horizon.overhangs {
        let [low, high] = overhang.tan_elevation;
        add(overhang.azimuth as usize, low, -1.0);
        add(overhang.azimuth as usize, high, 1.0);
    }
    let third = step * FRAC_1_PI / 3.0;
    SkyView {
        normal: view.normal * third,
        tangential: view.tangential.map(|t| t * third),
        escaping: view.escaping / n as f64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::horizon::Overhang;
    use std::f64::consts::PI;

    /// Sky over `h(az)` with the mean of both sides at a jump, which the equal-step rule wants.
    fn view(h: impl Fn(f64) -> f64) -> SkyView {
        let n = 7200;
        let tan_elevation =
            (0..n).map(|k| h(TAU * (f64::from(k) + 0.5) / f64::from(n)).tan().min(1e9) as f32).collect();
        let mut v = sky_view(&Horizon { tan_elevation, overhangs: Box::new([]) });
        // The samples sit half a step further round than `sky_view` takes them to be.
        let (s, c) = (PI / f64::from(n)).sin_cos();
        let [x, y] = v.tangential;
        v.tangential = [x * c - y * s, x * s + y * c];
        v
    }

    /// Normal, component towards azimuth 0, escaping fraction; from closed forms and a Monte Carlo check.
    #[test]
    fn blocked_skies_match_independent_values() {
        let deg30 = PI / 6.0;
        let towards = |az: f64| az.cos() > 0.0;
        let half = view(|az| if towards(az) { deg30 } else { 0.0 });
        let wall = view(|az| if towards(az) { 0.5 * PI } else { 0.0 });
        let slope = view(|az| (deg30.tan() * az.cos()).max(0.0).atan());
        let cases = [
            (view(|_| 0.0), [2.0 / 3.0, 0.0, 1.0]),
            (view(|_| deg30), [0.583333, 0.0, 0.75]),
            (half, [0.625, -0.0743744, 0.875]),
            (wall, [1.0 / 3.0, -0.2122066, 0.5]),
            (slope, [0.647444, -0.0530516, 0.9330127]),
        ];
        for (v, [normal, towards, escaping]) in cases {
            assert!((v.normal - normal).abs() < 1e-6, "{v:?}");
            assert!((v.tangential[0] - towards).abs() < 1e-6 && v.tangential[1].abs() < 1e-6, "{v:?}");
            assert!((v.escaping - escaping).abs() < 1e-6, "{v:?}");
        }
        // The sky below an overhang and the sky above it add up to what is not hidden.
        let overhang = |k| Overhang { azimuth: k, tan_elevation: [0.5f32, 2.0] };
        let leaning = Horizon { tan_elevation: vec![0.0; 16].into(), overhangs: (0..16).map(overhang).collect() };
        let uniform = |t| sky_view(&Horizon { tan_elevation: vec![t; 16].into(), overhangs: Box::new([]) });
        let expected = uniform(0.0).escaping - uniform(0.5).escaping + uniform(2.0).escaping;
        assert!((sky_view(&leaning).escaping - expected).abs() < 1e-15);
        let open = view(|_| 0.0);
        assert!((open.normal - SkyView::OPEN.normal).abs() < 1e-12 && open.escaping == SkyView::OPEN.escaping);
    }
}
