//! The contact law: forces and torques of all pairs of a chunk, eight pairs at a time.
//!
//! Schwartz et al. 2012 (Granular Matter 14, 363) for normal and tangential forces and the transport of the springs,
//! Zhang et al. 2017 (Icarus 294, 98, eqs 2-12) for rolling and twisting, Zhang et al. 2018 (ApJ 857, 15) for cohesion.
//! `i` and `j` are the two spheres, `n` the unit vector from i to j, a force is that on i.
//!
//! Dashpots see the velocities predicted for the time of the positions; springs are stretched with those of the
//! half step before, by which the positions were moved too: so a spring is a position to the leapfrog, and neither
//! gains nor loses energy. The direction of the step before follows from the same velocities.

use super::coefficients::Coefficients;
use super::lanes::{Eights, LANES, Lanes, Numbers, Quad, Vector, WIDE};
use super::pairs::Chunk;
use super::parameters::SlidingCap;
use super::record::{self, DIRECTIONAL, FRICTIONLESS, FULL};

/// Share of the relative rotation that a torque of the directional model may take away in one step: a sphere with a
/// dozen contacts still comes to rest and is not turned round.
const TAKEN_IN_A_STEP: f64 = 0.0625;

/// How many eights ahead spheres and springs are fetched.
const AHEAD: usize = 3;

/// Numbers in a line of the cache.
const LINE: usize = 8;

/// Heat made in contacts since the books were opened, J.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Heat {
    pub normal: f64,
    pub sliding_dashpot: f64,
    pub sliding_slider: f64,
    pub rolling_dashpot: f64,
    pub rolling_slider: f64,
    pub twisting_dashpot: f64,
    pub twisting_slider: f64,
}

impl Heat {
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            normal: self.normal + other.normal,
            sliding_dashpot: self.sliding_dashpot + other.sliding_dashpot,
            sliding_slider: self.sliding_slider + other.sliding_slider,
            rolling_dashpot: self.rolling_dashpot + other.rolling_dashpot,
            rolling_slider: self.rolling_slider + other.rolling_slider,
            twisting_dashpot: self.twisting_dashpot + other.twisting_dashpot,
            twisting_slider: self.twisting_slider + other.twisting_slider,
        }
    }
}

/// Computes the forces and torques of the pairs of `chunk` into its sums, and advances its springs by `step` (s).
///
/// # Safety
/// The processor must have the instructions of `V`, and the function must be inlined into one compiled for them. `records`
/// and the fields and sums of the chunk must be laid out for `MODEL` and `COHESIVE`, and its indices be within them.
#[inline(always)]
pub(super) unsafe fn contacts<V: Eights, const MODEL: u8, const COHESIVE: bool, const LEDGER: bool>(
    law: &Coefficients,
    step: f64,
    records: &[Quad],
    chunk: &mut Chunk,
) {
    let stride = record::quads(MODEL) * LANES;
    let fields = record::fields(MODEL, COHESIVE);
    let memory = record::constants(MODEL, COHESIVE);
    let acc_stride = record::sums(MODEL) * LANES;
    chunk.sums.fill(Quad::default());
    let acc = chunk.sums.as_mut_ptr().cast::<f64>();
    let base = records.as_ptr().cast::<f64>();

    // SAFETY: the caller vouches for the processor and the layout.
    unsafe {
        let (zero, one, half) = (V::splat(0.0), V::splat(1.0), V::splat(0.5));
        let h = V::splat(step);
        let (k_n, c_n) = (V::splat(law.k_n), V::splat(law.c_n));
        let (k_t, c_t, mu_s) = (V::splat(law.k_t), V::splat(law.c_t), V::splat(law.mu_s));
        let mut deepest = V::splat(chunk.deepest);
        let mut heat = [zero; 7];

        let own = base.add(chunk.first as usize * stride);
        let last = chunk.index.len().saturating_sub(1);
        for k in 0..chunk.index.len() {
            // What follows is fetched while this is reckoned with: the second spheres are anywhere.
            let ahead = chunk.index.get_unchecked((k + AHEAD).min(last));
            // Of spheres that were apart only the place is looked at.
            let lines = if ahead.touched { stride.div_ceil(LINE) } else { 1 };
            for j in ahead.j {
                let record = base.add(j as usize * stride);
                for line in 0..lines {
                    V::fetch(record.add(line * LINE));
                }
            }
            let field: *mut f64 = chunk.fields.as_mut_ptr().add(k * fields).cast();
            if ahead.touched {
                let next: *const f64 = chunk.fields.as_ptr().add((k + AHEAD).min(last) * fields).cast();
                for k in 0..fields {
                    V::fetch(next.add(k * WIDE));
                }
            }
            let block = chunk.index.get_unchecked_mut(k);
            let pi = block.i.map(|i| own.add(i as usize * stride));
            let pj = block.j.map(|j| base.add(j as usize * stride));
            let (r, s, dr) = separation::<V>(&pi, &pj);
            let d2 = r.dot(r);
            let contact = d2.less(s * s);
            if !LEDGER && !contact.any() {
                // Most that part stay apart, and what is written costs more than what is not looked at.
                if block.touched {
                    for k in memory..fields {
                        zero.store(field.add(k * WIDE));
                    }
                    block.touched = false;
                }
                continue;
            }
            block.touched = true;

            let d = d2.sqrt();
            // Where the direction a step before is needed too, one division makes both: it is what takes longest.
            let (inverse, before) = if MODEL == FRICTIONLESS {
                (one / d, None)
            } else {
                let (dv, spin) = velocities::<V>(&pi, &pj, record::VELOCITY);
                let old = r - dv.times(h);
                let old2 = old.dot(old);
                let old_d = old2.sqrt();
                let both = one / (d * old_d);
                (old_d * both, Some((dv, spin, old.times(d * both), old2.less(s * s))))
            };
            let n = r.times(inverse);
            let x = s - d;
            // Seldom, once a body has settled: the deepest overlap over the smaller radius.
            let smaller = half * (s - dr.abs());
            let record = contact.keep((deepest * smaller).less(x));
            if record.any() {
                let depth = contact.keep(x / smaller).largest().max(deepest.largest());
                deepest = V::splat(depth);
            }

            let sqrt_mu = V::load(field);
            let (dv, [x_sum, x_dif]) = velocities::<V>(&pi, &pj, record::PREDICTED);
            let u_n = dv.dot(n);
            let push = c_n * sqrt_mu * u_n - k_n * x;
            let load = push.abs();
            let mut along = push;
            if COHESIVE {
                let q = V::load(field.add(WIDE));
                along = along + V::splat(law.cohesion) * q * q;
            }
            let mut force = n.times(along);
            if LEDGER {
                heat[0] = heat[0] + contact.keep(h * c_n * sqrt_mu * u_n * u_n);
            }

            if let Some((dv_mid, [x_sum_mid, x_dif_mid], old, was)) = before {
                // Lever arms: l_i = d/2 - e, l_j = d/2 + e. Between equal spheres, e = 0, some terms need no computing.
                let (arm, e) = (half * d, half * s * dr * inverse);
                let differ = zero.less(dr.abs()).any();
                let arms = (arm, e, differ);
                let ([y_dif, z_dif, y_dif_mid, z_dif_mid], [y_sum, z_sum, y_sum_mid, z_sum_mid]) =
                    V::columns(&pi, &pj, record::SPINS * LANES);
                let (w_sum, w_dif) = (Vector([x_sum, y_sum, z_sum]), Vector([x_dif, y_dif, z_dif]));
                let u = (dv - n.times(u_n)) - weighted(w_sum, w_dif, arms).cross(n);

                // The same in the middle of the step, and the direction at its start. The direction goes with the velocities:
                // that at the end would see contacts slip that only turn, by half a step of turning, always the same way.
                let w_sum_mid = Vector([x_sum_mid, y_sum_mid, z_sum_mid]);
                let w_dif_mid = Vector([x_dif_mid, y_dif_mid, z_dif_mid]);
                let mid = (old + n).times(half);
                let u_mid = (dv_mid - mid.times(dv_mid.dot(mid))) - weighted(w_sum_mid, w_dif_mid, arms).cross(mid);
                let u_mid = u_mid - n.times(u_mid.dot(n));
                let turn = Turn::new(old, n, V::splat(0.25 * step) * w_sum_mid.dot(n));

                let at = |k: usize| field.add((memory + k) * WIDE);
                let spring = turn.apply(Vector([V::load(at(0)), V::load(at(1)), V::load(at(2))]));
                let trial = (spring + u_mid.times(h)).kept(was);
                let dashpot = u.times(c_t * sqrt_mu);
                let limit = mu_s * load;
                let (mut spring, mut rub) = (trial, trial.times(k_t) + dashpot);
                let rub2 = rub.dot(rub);
                let slips = contact.keep((limit * limit).less(rub2));
                if slips.any() {
                    // Slips are few, so the rule is looked up here and not compiled into kernels of its own.
                    let (held, kept) = match law.cap {
                        SlidingCap::Smaller => {
                            let length = trial.dot(trial).sqrt();
                            (trial.times(nonzero(length, limit / length)), trial)
                        }
                        SlidingCap::Drop => {
                            let size = dashpot.dot(dashpot).sqrt();
                            let limited = size.less(limit).choose(one, nonzero(size, limit / size));
                            (dashpot.times(limited), Vector([zero; 3]))
                        }
                        SlidingCap::Rescale => {
                            let held = rub.times(limit / rub2.sqrt());
                            let kept = (held - dashpot).times(one / k_t);
                            // A dashpot beyond the limit must not wind the spring up the other way.
                            let (size2, most) = (kept.dot(kept), limit / k_t);
                            let beyond = (most * most).less(size2);
                            (held, kept.times(beyond.choose(most / size2.sqrt(), one)))
                        }
                    };
                    (rub, spring) = (held.or(slips, rub), kept.or(slips, spring));
                }
                let spring = spring.kept(contact);
                for (k, v) in spring.0.into_iter().enumerate() {
                    v.store(at(k));
                }
                force = force + rub;
                if LEDGER {
                    let lost = half * k_t * (trial.dot(trial) - spring.dot(spring) - h * (trial - spring).dot(u_mid));
                    let rubbed = contact.keep(h * (rub - spring.times(k_t)).dot(u));
                    heat[1] = heat[1] + rubbed - slips.keep(rubbed);
                    heat[2] = heat[2] + lost + slips.keep(rubbed);
                }

                let lever = n.cross(rub);
                let (mut on_i, mut on_j) = (lever.times(arm - e), lever.times(arm + e));
                if MODEL == FULL {
                    let q = V::load(field.add(WIDE));
                    let q2 = q * q;
                    let width = q * load;
                    let twist = w_dif.dot(n);
                    let twist_mid = w_dif_mid.dot(n);
                    let (mut roll, mut roll_mid) = (w_dif - n.times(twist), w_dif_mid - n.times(twist_mid));
                    if differ {
                        let unequal = e / (arm * arm - e * e);
                        roll = roll + n.cross(u).times(unequal);
                        roll_mid = roll_mid + n.cross(u_mid).times(unequal);
                    }

                    let (k_r, c_r) = (V::splat(law.k_r) * q2, V::splat(law.c_r) * q2 * sqrt_mu);
                    let limit = V::splat(law.m_r) * width;
                    let spring = turn.apply(Vector([V::load(at(3)), V::load(at(4)), V::load(at(5))]));
                    let trial = (spring + roll_mid.times(h)).kept(was);
                    let mut spring = trial;
                    let mut torque = trial.times(k_r) + roll.times(c_r);
                    let size2 = trial.dot(trial);
                    let slips = contact.without((k_r * k_r * size2).less(limit * limit));
                    if slips.any() {
                        // Shortened to what the load holds: a spring that only stopped growing would go on driving the
                        // spheres after the load has fallen, and make energy.
                        let length = size2.sqrt();
                        let held = trial.times(nonzero(length, limit / length));
                        (torque, spring) = (held.or(slips, torque), held.times(one / k_r).or(slips, spring));
                    }
                    let spring = spring.kept(contact);
                    for (k, v) in spring.0.into_iter().enumerate() {
                        v.store(at(3 + k));
                    }
                    if LEDGER {
                        let lost =
                            half * k_r * (trial.dot(trial) - spring.dot(spring) - h * (trial - spring).dot(roll_mid));
                        let rubbed = contact.keep(h * (torque - spring.times(k_r)).dot(roll));
                        // Between unequal spheres the rate of rolling holds some sliding, which the torque does not drive.
                        let beside = contact.keep(h * torque.dot(w_dif - roll));
                        heat[3] = heat[3] + rubbed - slips.keep(rubbed);
                        heat[4] = heat[4] + lost + slips.keep(rubbed) + beside;
                    }

                    let (k_w, c_w) = (V::splat(law.k_w) * q2, V::splat(law.c_w) * q2 * sqrt_mu);
                    let limit = V::splat(law.m_w) * width;
                    let trial = was.keep(V::load(at(6)) + h * twist_mid);
                    let slips = contact.without((k_w * trial.abs()).less(limit));
                    let held = zero.less(trial).choose(limit, trial.less(zero).choose(-limit, zero));
                    let about = slips.choose(held, k_w * trial + c_w * twist);
                    let spring = contact.keep(slips.choose(held / k_w, trial));
                    spring.store(at(6));
                    if LEDGER {
                        let lost = half * k_w * (trial * trial - spring * spring - h * (trial - spring) * twist_mid);
                        let rubbed = contact.keep(h * (about - k_w * spring) * twist);
                        heat[5] = heat[5] + rubbed - slips.keep(rubbed);
                        heat[6] = heat[6] + lost + slips.keep(rubbed);
                    }
                    let torque = torque + n.times(about);
                    (on_i, on_j) = (on_i + torque, on_j - torque);
                }
                if MODEL == DIRECTIONAL {
                    let constants = memory - 2;
                    let age = contact.keep(was.keep(V::load(at(3)) + h));
                    age.store(at(3));
                    let mature = contact.without(age.less(V::splat(law.contact_time) * sqrt_mu));
                    // v_rot = l_i w_i x n - l_j w_j x n; with n across it, |v_rot| = |l_i w_i - l_j w_j| across n.
                    let (w_i, w_j) = ((w_sum - w_dif).times(half), (w_sum + w_dif).times(half));
                    let rolling = w_i.times(arm - e) - w_j.times(arm + e);
                    let rolling = rolling - n.times(rolling.dot(n));
                    let speed = rolling.dot(rolling).sqrt();
                    let per_step = V::splat(TAKEN_IN_A_STEP / law.step_s);
                    let most = per_step * V::load(field.add(constants * WIDE)) * speed;
                    // The arm of the smaller sphere, so that the torques on the two are opposite.
                    let size = V::splat(law.m_r) * (arm - e.abs()) * load;
                    let size = most.less(size).choose(most, size);
                    let against_roll = rolling.times(-nonzero(speed, size / speed));
                    let twist = w_dif.dot(n);
                    let most = per_step * V::load(field.add((constants + 1) * WIDE)) * twist.abs();
                    // Contact-circle radius; the circle is inside the sphere, but round-off may say otherwise.
                    let radius = half * (s - dr);
                    let circle2 = radius * radius - (arm - e) * (arm - e);
                    let circle = zero.less(circle2).keep(circle2).sqrt();
                    let size = V::splat(law.m_w) * circle * load;
                    let size = most.less(size).choose(most, size);
                    let about = zero.less(twist).choose(size, twist.less(zero).choose(-size, zero));
                    let torque = (against_roll + n.times(about)).kept(mature);
                    if LEDGER {
                        heat[4] = heat[4] + h * mature.keep(against_roll.dot(w_dif));
                        heat[6] = heat[6] + h * mature.keep(about * twist);
                    }
                    (on_i, on_j) = (on_i + torque, on_j - torque);
                }

                let (force, on_i, on_j) = (force.kept(contact), on_i.kept(contact), on_j.kept(contact));
                let ([x, y, z], [x_i, y_i, z_i], [x_j, y_j, z_j]) = (force.0, on_i.0, on_j.0);
                let (plus, minus) = (V::rows([x, y, z, x_i]), V::rows([x, y, z, -x_j]));
                let rest = V::rows([y_i, z_i, y_j, z_j]);
                for lane in 0..WIDE {
                    let sum_i = acc.add(block.i[lane] as usize * acc_stride);
                    (V::Row::load(sum_i) + plus[lane]).store(sum_i);
                    let sum_j = acc.add(block.sum_j[lane] as usize * acc_stride);
                    (V::Row::load(sum_j) - minus[lane]).store(sum_j);
                    rest[lane].add_halves(sum_i.add(LANES), sum_j.add(LANES));
                }
            } else {
                let [x, y, z] = force.kept(contact).0;
                for (lane, force) in V::rows([x, y, z, zero]).into_iter().enumerate() {
                    let sum = acc.add(block.i[lane] as usize * acc_stride);
                    (V::Row::load(sum) + force).store(sum);
                    let sum = acc.add(block.sum_j[lane] as usize * acc_stride);
                    (V::Row::load(sum) - force).store(sum);
                }
            }
        }
        chunk.deepest = deepest.largest();
        if LEDGER {
            let Heat {
                normal,
                sliding_dashpot,
                sliding_slider,
                rolling_dashpot,
                rolling_slider,
                twisting_dashpot,
                twisting_slider,
            } = &mut chunk.heat;
            let books = [
                normal,
                sliding_dashpot,
                sliding_slider,
                rolling_dashpot,
                rolling_slider,
                twisting_dashpot,
                twisting_slider,
            ];
            for (book, sum) in books.into_iter().zip(heat) {
                *book += sum.total();
            }
        }
    }
}

/// l_i w_i + l_j w_j from the sum and difference of the spins, half the distance, half the difference of the lever arms and
/// whether that is anything but zero.
#[inline(always)]
fn weighted<V: Numbers>(sum: Vector<V>, difference: Vector<V>, (arm, e, differ): (V, V, bool)) -> Vector<V> {
    if differ { sum.times(arm) + difference.times(e) } else { sum.times(arm) }
}

/// `value` where `size` is more than nothing, 0 elsewhere: what a vector without a direction gives.
#[inline(always)]
fn nonzero<V: Numbers>(size: V, value: V) -> V {
    // SAFETY: there are values of the type, so the processor has it.
    let none = unsafe { V::splat(0.0) };
    none.less(size).keep(value)
}

/// Vectors from i to j, sums of the radii and differences R_j - R_i.
#[inline(always)]
unsafe fn separation<V: Eights>(pi: &[*const f64; WIDE], pj: &[*const f64; WIDE]) -> (Vector<V>, V, V) {
    let ([x, y, z, dr], [.., s]) = unsafe { V::columns(pi, pj, record::PLACE * LANES) };
    (Vector([x, y, z]), s, dr)
}

/// Differences, j minus i, of the velocities in one quad of the records, and sums and differences of what comes fourth.
#[inline(always)]
unsafe fn velocities<V: Eights>(pi: &[*const f64; WIDE], pj: &[*const f64; WIDE], quad: usize) -> (Vector<V>, [V; 2]) {
    let ([x, y, z, difference], [.., sum]) = unsafe { V::columns(pi, pj, quad * LANES) };
    (Vector([x, y, z]), [sum, difference])
}

/// How a contact turned in a step: the smallest rotation that takes the old direction to the new, then a turn about that.
///
/// Schwartz et al. 2012, section 2.2. Both parts are exact rotations however long the step, so springs keep their length.
#[derive(Clone, Copy)]
struct Turn<V> {
    n: Vector<V>,
    /// (n_old + n) / (1 + n_old . n).
    halfway: Vector<V>,
    cos: V,
    sin: V,
}

impl<V: Numbers> Turn<V> {
    /// From `old` to `n`, then by the angle whose half has the tangent `t`.
    #[inline(always)]
    fn new(old: Vector<V>, n: Vector<V>, t: V) -> Self {
        // SAFETY: there are values of the type, so the processor has it.
        let one = unsafe { V::splat(1.0) };
        let (t2, c) = (t * t, one + old.dot(n));
        // One division for 1 / c and 1 / (1 + t²).
        let both = one / (c * (one + t2));
        let norm = c * both;
        let halfway = (old + n).times((one + t2) * both);
        Self { n, halfway, cos: (one - t2) * norm, sin: (t + t) * norm }
    }

    /// Turns a vector that is perpendicular to the old direction; what is not, by round-off, is lost.
    #[inline(always)]
    fn apply(&self, v: Vector<V>) -> Vector<V> {
        let v = v - self.halfway.times(v.dot(self.n));
        v.times(self.cos) + self.n.cross(v).times(self.sin)
    }
}
