//! Azimuths: exactly symmetric ones for maps, rough ones to pick candidates.

use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

/// What [`rough_azimuth`] may be off by, rad, with room to spare.
pub(crate) const AZIMUTH_PAD: f64 = 1e-4;

/// Cosine and sine of azimuth `2 pi k / n`, mirror-symmetric to the last bit: a mirrored body has mirrored horizons.
pub(crate) fn direction(k: usize, n: usize) -> [f64; 2] {
    let octant = |k: usize| (TAU * k as f64 / n as f64).sin_cos();
    let quarter = n / 4;
    let (s, c) = match (k % quarter, quarter) {
        (0, _) => (0.0, 1.0),
        (j, q) if 2 * j == q => (FRAC_1_SQRT_2, FRAC_1_SQRT_2),
        (j, q) if 2 * j < q => octant(j),
        (j, q) => {
            let (s, c) = octant(q - j);
            (c, s)
        }
    };
    match k / quarter {
        0 => [c, s],
        1 => [-s, c],
        2 => [-c, -s],
        _ => [s, -c],
    }
}

/// Azimuth of `(x, y)` in [-pi, pi] to 2e-5 rad (Abramowitz & Stegun 4.4.49): enough to pick candidates.
#[inline]
pub(crate) fn rough_azimuth(x: f64, y: f64) -> f64 {
    let (ax, ay) = (x.abs(), y.abs());
    let (small, large) = if ax < ay { (ax, ay) } else { (ay, ax) };
    let r = if large > 0.0 { small / large } else { 0.0 };
    let q = r * r;
    let mut angle = r * (0.999_866 + q * (-0.330_299_5 + q * (0.180_141 + q * (-0.085_133 + q * 0.020_835_1))));
    if ax < ay {
        angle = 0.5 * PI - angle;
    }
    if x < 0.0 {
        angle = PI - angle;
    }
    if y < 0.0 { -angle } else { angle }
}

/// Largest integer not above `x`; faster than the library call of machines without a rounding instruction.
#[inline(always)]
pub(crate) fn floor(x: f64) -> i64 {
    let truncated = x as i64;
    truncated - i64::from((truncated as f64) > x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn azimuths_are_mirror_symmetric_to_the_last_bit() {
        for n in [16, 24, 72, 120, 360] {
            for k in 0..n {
                let [c, s] = direction(k, n);
                let [cm, sm] = direction((n - k) % n, n);
                assert_eq!((c, s.abs()), (cm, sm.abs()));
                assert!((c - (TAU * k as f64 / n as f64).cos()).abs() < 1e-15);
                assert!((s - (TAU * k as f64 / n as f64).sin()).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn rough_azimuth_is_rough_only() {
        for k in 0..10_000 {
            let angle = (f64::from(k) / 5000.0 - 1.0) * PI;
            assert!((rough_azimuth(angle.cos(), angle.sin()) - angle).abs() < AZIMUTH_PAD / 2.0);
        }
        assert_eq!(rough_azimuth(0.0, 0.0), 0.0);
    }
}
