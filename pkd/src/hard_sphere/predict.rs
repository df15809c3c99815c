//! When a sphere meets the first of its neighbours, if all fly straight on.
//!
//! Source: Richardson 1994 (MNRAS 269, 493): the first root of `|r + v t| = R1 + R2` for approaching spheres, here in the form
//! `(r² - s²) / (sqrt(disc) - r.v)`, which does not cancel when the spheres nearly touch. Spheres that touch or overlap and
//! approach meet now. Four neighbours are looked at together with AVX2 where the processor has it; the same
//! operations in the same order without fused multiply-add, so that both give the same bytes.

use super::ball::Ball;
use nalgebra::Vector3;

/// No sphere.
pub(super) const NONE: u32 = u32::MAX;

/// Neighbours looked at together.
pub(super) const LANES: usize = 4;

/// The first meeting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Meeting {
    /// Time from now, s; infinite when there is none.
    pub delay: f64,
    /// The other sphere; meaningless when there is none.
    pub partner: u32,
}

/// A way to look for the first meeting of a sphere.
pub(super) trait Predict {
    /// The earliest meeting from `now` (s of the step) on of sphere `i` with a neighbour of `row`.
    ///
    /// # Safety
    /// `i` and every entry of `row` must be indices of `balls`, and the processor must have what the implementation needs.
    unsafe fn first_meeting(balls: &[Ball], i: usize, row: &[[u32; LANES]], now: f64) -> Meeting;

    /// [`Ball::deflect`], leaving the ball as [`Self::first_meeting`] is going to read it.
    ///
    /// # Safety
    /// The processor must have what the implementation needs.
    unsafe fn deflect(ball: &mut Ball, change: Vector3<f64>, t: f64);
}

/// [`Predict`] for any processor, and the oracle of the others.
pub(super) struct Scalar;

/// [`Predict`] with AVX2, four neighbours at a time.
#[cfg(target_arch = "x86_64")]
pub(super) struct Avx2;

/// Time from now, s, until two spheres meet that are `r` apart (m), move at `v` relative to each other (m/s) and have radii that
/// add up to `s` (m). Negative if they overlap and approach; infinite if they recede, and not a number if they miss each
/// other, so that it compares as later than any time.
#[inline(always)]
fn delay(r: [f64; 3], v: [f64; 3], s: f64) -> f64 {
    let b = r[0] * v[0] + r[1] * v[1] + r[2] * v[2];
    let v2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    let c = r[0] * r[0] + r[1] * r[1] + r[2] * r[2] - s * s;
    if b < 0.0 { c / ((b * b - v2 * c).sqrt() - b) } else { f64::INFINITY }
}

/// [`delay`] from `now` (s of the step) on.
#[inline(always)]
fn delay_between(one: &Ball, two: &Ball, now: f64) -> f64 {
    let v: [f64; 3] = std::array::from_fn(|a| one.course[a] - two.course[a]);
    let r = std::array::from_fn(|a| (one.place[a] - two.place[a]) + v[a] * now);
    delay(r, v, one.radius() + two.radius())
}

/// The same leaving out one neighbour: seldom needed, so without vectors.
#[cold]
pub(super) fn first_meeting_but(skipped: u32, balls: &[Ball], i: usize, row: &[[u32; LANES]], now: f64) -> Meeting {
    let mut first = Meeting { delay: f64::INFINITY, partner: NONE };
    for &j in row.as_flattened() {
        let delay = delay_between(&balls[i], &balls[j as usize], now);
        if j != skipped && delay < first.delay {
            first = Meeting { delay, partner: j };
        }
    }
    Meeting { delay: first.delay.max(0.0), ..first }
}

impl Predict for Scalar {
    #[inline(always)]
    unsafe fn first_meeting(balls: &[Ball], i: usize, row: &[[u32; LANES]], now: f64) -> Meeting {
        // One earliest meeting a lane and a choice among lanes at the end, as the vectors have it: ties fall the same way.
        let mut lanes = [Meeting { delay: f64::INFINITY, partner: NONE }; LANES];
        for four in row {
            for (lane, &j) in lanes.iter_mut().zip(four) {
                let delay = delay_between(&balls[i], &balls[j as usize], now);
                if delay < lane.delay {
                    *lane = Meeting { delay, partner: j };
                }
            }
        }
        let [first, others @ ..] = lanes;
        let first = others.into_iter().fold(first, |best, lane| if lane.delay < best.delay { lane } else { best });
        Meeting { delay: first.delay.max(0.0), ..first }
    }

    #[inline(always)]
    unsafe fn deflect(ball: &mut Ball, change: Vector3<f64>, t: f64) {
        ball.deflect(change, t);
    }
}

#[cfg(target_arch = "x86_64")]
impl Predict for Avx2 {
    #[inline(always)]
    unsafe fn first_meeting(balls: &[Ball], i: usize, row: &[[u32; LANES]], now: f64) -> Meeting {
        // SAFETY: the caller vouches for the same.
        unsafe { first_meeting_avx2(balls, i, row, now) }
    }

    #[inline(always)]
    unsafe fn deflect(ball: &mut Ball, change: Vector3<f64>, t: f64) {
        // SAFETY: the caller vouches for the same.
        unsafe { deflect_avx2(ball, change, t) }
    }
}

/// [`Predict::first_meeting`] of [`Avx2`]: a function of its own, because only such can ask for vectors.
///
/// # Safety
/// As there; the processor must have AVX2.
#[cfg(target_arch = "x86_64")]
#[inline]
#[target_feature(enable = "avx2")]
unsafe fn first_meeting_avx2(balls: &[Ball], i: usize, row: &[[u32; LANES]], now: f64) -> Meeting {
    use std::arch::x86_64::*;
    debug_assert!(i < balls.len() && row.as_flattened().iter().all(|&j| (j as usize) < balls.len()));
    // SAFETY: the caller vouches for the indices; a ball is eight f64 in a row without padding.
    unsafe {
        let first = balls.as_ptr();
        let one = &*first.add(i);
        let spread = |value: f64| _mm256_set1_pd(value);
        let zero = _mm256_setzero_pd();
        let now = spread(now);
        let [x, y, z, radius] = one.place.map(spread);
        let [vx, vy, vz, _] = one.course.map(spread);
        let mut best = spread(f64::INFINITY);
        let mut partner = _mm256_set1_epi64x(i64::from(NONE));
        for four in row {
            let ball = [0, 1, 2, 3].map(|k| first.add(four[k] as usize).cast::<f64>());
            // Places `at` and `at + 1` of the four records, one vector for each.
            let columns = |at: usize| {
                let two =
                    |a: *const f64, b: *const f64| _mm256_set_m128d(_mm_loadu_pd(b.add(at)), _mm_loadu_pd(a.add(at)));
                let (even, odd) = (two(ball[0], ball[2]), two(ball[1], ball[3]));
                (_mm256_unpacklo_pd(even, odd), _mm256_unpackhi_pd(even, odd))
            };
            let ((jx, jy), (jz, jr)) = (columns(0), columns(2));
            let ((jvx, jvy), (jvz, _)) = (columns(4), columns(6));
            let (ux, uy, uz) = (_mm256_sub_pd(vx, jvx), _mm256_sub_pd(vy, jvy), _mm256_sub_pd(vz, jvz));
            let place = |a, ja, u| _mm256_add_pd(_mm256_sub_pd(a, ja), _mm256_mul_pd(u, now));
            let (rx, ry, rz) = (place(x, jx, ux), place(y, jy, uy), place(z, jz, uz));
            let dot = |ax, ay, az, bx, by, bz| {
                _mm256_add_pd(_mm256_add_pd(_mm256_mul_pd(ax, bx), _mm256_mul_pd(ay, by)), _mm256_mul_pd(az, bz))
            };
            let b = dot(rx, ry, rz, ux, uy, uz);
            let v2 = dot(ux, uy, uz, ux, uy, uz);
            let s = _mm256_add_pd(radius, jr);
            let c = _mm256_sub_pd(dot(rx, ry, rz, rx, ry, rz), _mm256_mul_pd(s, s));
            let disc = _mm256_sub_pd(_mm256_mul_pd(b, b), _mm256_mul_pd(v2, c));
            let delay = _mm256_div_pd(c, _mm256_sub_pd(_mm256_sqrt_pd(disc), b));
            let approach = _mm256_cmp_pd::<_CMP_LT_OQ>(b, zero);
            let earlier = _mm256_and_pd(approach, _mm256_cmp_pd::<_CMP_LT_OQ>(delay, best));
            best = _mm256_blendv_pd(best, delay, earlier);
            let j = _mm256_cvtepu32_epi64(_mm_loadu_si128(four.as_ptr().cast()));
            partner = _mm256_blendv_epi8(partner, j, _mm256_castpd_si256(earlier));
        }
        let halves = _mm256_min_pd(best, _mm256_permute4x64_pd::<0b01_00_11_10>(best));
        let least = _mm256_min_pd(halves, _mm256_permute_pd::<0b0101>(halves));
        let lane = _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_EQ_OQ>(best, least)).trailing_zeros() as usize;
        let mut partners = [0_u64; LANES];
        _mm256_storeu_si256(partners.as_mut_ptr().cast(), partner);
        Meeting { delay: _mm256_cvtsd_f64(least).max(0.0), partner: partners[lane % LANES] as u32 }
    }
}

/// [`Predict::deflect`] of [`Avx2`]. Two whole vectors are written, because the next prediction reads parts of them: a load that
/// needs the results of several stores waits until they have reached the cache.
#[cfg(target_arch = "x86_64")]
#[inline]
#[target_feature(enable = "avx2")]
fn deflect_avx2(ball: &mut Ball, change: Vector3<f64>, t: f64) {
    use std::arch::x86_64::*;
    let change = _mm256_setr_pd(change.x, change.y, change.z, 0.0);
    // SAFETY: both arrays are one vector long.
    unsafe {
        let shift = _mm256_mul_pd(change, _mm256_set1_pd(t));
        let place = _mm256_sub_pd(_mm256_loadu_pd(ball.place.as_ptr()), shift);
        let course = _mm256_add_pd(_mm256_loadu_pd(ball.course.as_ptr()), change);
        _mm256_storeu_pd(ball.place.as_mut_ptr(), place);
        _mm256_storeu_pd(ball.course.as_mut_ptr(), course);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// When ball 0 meets ball 1, in seconds from now.
    fn meeting(r: [f64; 3], v: [f64; 3]) -> f64 {
        let balls = [Ball::new(r, 1.0, v, 1.0), Ball::new([0.0; 3], 1.0, [0.0; 3], 1.0), Ball::NOWHERE];
        // SAFETY: all indices are within the balls; nothing else is needed.
        unsafe { Scalar::first_meeting(&balls, 0, &[[1, 2, 2, 2]], 0.0).delay }
    }

    #[test]
    fn unit_spheres_ten_apart_closing_at_two_meet_after_four_seconds() {
        assert_eq!(meeting([10.0, 0.0, 0.0], [-2.0, 0.0, 0.0]), 4.0);
    }

    #[test]
    fn grazing_is_the_last_meeting_and_beyond_it_there_is_none() {
        // impact parameter 2 = R1 + R2: the discriminant is exactly zero, contact at closest approach
        assert_eq!(meeting([10.0, 2.0, 0.0], [-2.0, 0.0, 0.0]), 5.0);
        assert_eq!(meeting([10.0, 2.0 + 1e-12, 0.0], [-2.0, 0.0, 0.0]), f64::INFINITY);
        assert!(meeting([10.0, 2.0 - 1e-12, 0.0], [-2.0, 0.0, 0.0]) < 5.0);
    }

    #[test]
    fn overlapping_spheres_meet_now_if_they_approach_and_never_if_they_recede() {
        assert_eq!(meeting([1.9, 0.0, 0.0], [-2.0, 0.0, 0.0]), 0.0);
        assert_eq!(meeting([1.9, 0.0, 0.0], [2.0, 0.0, 0.0]), f64::INFINITY);
    }

    /// The textbook form of the root would lose all digits here: both of its terms are 2 and differ by 1e-9.
    #[test]
    fn a_gap_of_a_billionth_of_the_radius_keeps_its_digits() {
        let gap = 2.0_f64.powi(-30);
        let found = meeting([2.0 + gap, 0.0, 0.0], [-1.0, 0.0, 0.0]);
        // round-off of r² and s²: 4 eps of a difference of 4 gap
        assert!((found / gap - 1.0).abs() < 2.0 * f64::EPSILON / gap, "{found} {gap}");
    }

    #[cfg(target_arch = "x86_64")]
    proptest! {
        #[test]
        fn prop_vectors_and_scalars_agree_to_the_last_bit(
            places in prop::collection::vec(((-4.0..4.0, -4.0..4.0, -4.0..4.0), (-1.0..1.0, -1.0..1.0, -1.0..1.0)), 13),
            now in 0.0f64..2.0, equal in any::<bool>(),
        ) {
            let mut balls: Vec<Ball> = places
                .into_iter()
                .map(|((x, y, z), (u, v, w)): ((f64, f64, f64), (f64, f64, f64))| {
                    // Half of the cases on a coarse grid, where times tie.
                    let place = |a: f64| if equal { a.round() } else { a };
                    Ball::new([x, y, z].map(place), 0.7, [u, v, w].map(place), 1.0)
                })
                .collect();
            balls.push(Ball::NOWHERE);
            let rows = [[1, 2, 3, 4], [5, 6, 7, 8], [9, 10, 11, 12], [13; 4]];
            for row in [&rows[..], &rows[..2], &[]] {
                prop_assume!(is_x86_feature_detected!("avx2"));
                // SAFETY: rows are within the balls, and the processor was asked.
                let (found, expected) =
                    unsafe { (Avx2::first_meeting(&balls, 0, row, now), Scalar::first_meeting(&balls, 0, row, now)) };
                prop_assert_eq!(found, expected);
            }
        }
    }
}
