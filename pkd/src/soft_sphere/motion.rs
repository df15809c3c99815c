//! One leapfrog step of the spheres of a chunk, four at a time, and how far they got against the motion of the body.
//!
//! A sphere is kicked by the forces at its place, moved by the new velocity, and its velocity for the time of arrival is
//! predicted with the same forces (Schwartz et al. 2012, Granular Matter 14, 363, section 2.7). Its place in the frame
//! that turns with the body is compared with where it was when the neighbours were listed and when gravity was
//! evaluated; the torque of the frozen field is summed, so that it can be taken out at the next kick.

use super::lanes::{LANES, Lanes, Quad, Vector};
use super::pairs::Chunk;
use super::record::{self, FRICTIONLESS, PLACE, PREDICTED, PREDICTED_SPIN, SPIN, VELOCITY};

/// No accelerations but those of contacts.
pub(super) const NONE: u8 = 0;
/// Accelerations given for this instant.
pub(super) const GIVEN: u8 = 1;
/// Accelerations that turn with the body.
pub(super) const FROZEN: u8 = 2;

/// Quads that four spheres have besides their records: x, y, z of each and, where it has a fourth, another number.
/// Place in the body frame when the neighbours were listed, m, and the square of how far they may stray, m².
pub(super) const LISTED: usize = 0;
/// Acceleration, m/s²: in the body frame if frozen.
pub(super) const FIELD: usize = 4;
/// Present place in the body frame, m.
pub(super) const NOW: usize = 7;
/// As [`LISTED`], when gravity was evaluated.
pub(super) const ATTRACTED: usize = 10;

/// Quads of four spheres that go with this kind of field.
pub(super) const fn guide_quads(field: u8) -> usize {
    match field {
        NONE => 4,
        GIVEN => 7,
        _ => 14,
    }
}

/// The body frame at the start and end of a step.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Frames {
    /// From the body frame, at the start: columns.
    pub turn: [[f64; 3]; 3],
    /// Angular acceleration, in the body frame, that takes the torque out of the frozen field, rad/s².
    pub correction: [f64; 3],
    /// From the body frame, at the end: columns.
    pub next_turn: [[f64; 3]; 3],
    /// Origin of the body frame at the end, m.
    pub next_centre: [f64; 3],
}

/// What a step did to the spheres of a chunk.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Moved {
    /// Whether a sphere is out of the reach of the lists of neighbours, or nowhere.
    pub strayed: bool,
    /// Whether a sphere is too far from where its gravity was evaluated.
    pub stale: bool,
    /// Torque of the frozen field about the origin of the body frame, N m.
    pub torque: [f64; 3],
    /// Sums of m xx, yy, zz, xy, xz, yz in the body frame, kg m².
    pub moments: [f64; 6],
}

/// Adds what other chunks have computed for the spheres of `chunk` to its sums, in the order of the chunks.
pub(super) fn collect(model: u8, chunk: &mut Chunk, foreign: &[Vec<Quad>]) {
    let width = record::sums(model);
    for incoming in &chunk.incoming {
        let from = &foreign[incoming.chunk as usize][incoming.sum as usize * width..];
        let to = &mut chunk.sums[incoming.sphere as usize * width..];
        for (to, from) in to.iter_mut().zip(&from[..width]) {
            to.0.iter_mut().zip(from.0).for_each(|(to, from)| *to += from);
        }
    }
}

/// Moves the spheres of a chunk by `step` (s).
///
/// # Safety
/// The processor must have the instructions of `V`, and the function must be inlined into one compiled for them. `records`
/// and `sums` must be laid out for `MODEL` and `guides` for `KIND`, with room for all spheres of the last four.
#[inline(always)]
pub(super) unsafe fn advance<V: Lanes, const MODEL: u8, const KIND: u8>(
    step: f64,
    frames: &Frames,
    records: &mut [Quad],
    guides: &mut [Quad],
    sums: &[Quad],
) -> Moved {
    let (stride, width, guide) = (record::quads(MODEL), record::sums(MODEL), guide_quads(KIND));
    let fours = guides.len() / guide;
    assert!(records.len() >= fours * LANES * stride && sums.len() >= fours * LANES * width, "room for all fours");
    // SAFETY: the caller vouches for the processor, the assertion for the lengths.
    unsafe {
        let zero = V::splat(0.0);
        let (h, half) = (V::splat(step), V::splat(0.5 * step));
        // Lanes of a quad that are a vector.
        let all = zero.less(V::splat(1.0));
        let vector = V::load(VECTOR.0.as_ptr()).less(V::splat(0.5));
        let splat3 = |v: [f64; 3]| Vector([V::splat(v[0]), V::splat(v[1]), V::splat(v[2])]);
        let turn = [splat3(frames.turn[0]), splat3(frames.turn[1]), splat3(frames.turn[2])];
        let next = [splat3(frames.next_turn[0]), splat3(frames.next_turn[1]), splat3(frames.next_turn[2])];
        let centre = splat3(frames.next_centre);
        let correction = splat3(frames.correction);
        let (mut strayed, mut stale) = (zero, zero);
        let mut torque = Vector([zero; 3]);
        let mut moments = [zero; 6];

        for four in 0..fours {
            let guide = guides.as_mut_ptr().add(four * guide).cast::<f64>();
            let at = |k: usize| guide.add(k * LANES);
            let pull = if KIND == NONE {
                [zero; LANES]
            } else {
                let mut g = Vector([V::load(at(FIELD)), V::load(at(FIELD + 1)), V::load(at(FIELD + 2))]);
                if KIND == FROZEN {
                    let y = Vector([V::load(at(NOW)), V::load(at(NOW + 1)), V::load(at(NOW + 2))]);
                    let [x, y, z] = (g - correction.cross(y)).0;
                    g = turn[0].times(x) + turn[1].times(y) + turn[2].times(z);
                }
                V::transpose([g.0[0], g.0[1], g.0[2], zero])
            };
            let mut places = [zero; LANES];
            for k in 0..LANES {
                let sphere = four * LANES + k;
                let record = records.as_mut_ptr().add(sphere * stride).cast::<f64>();
                let quad = |k: usize| record.add(k * LANES);
                let sum = sums.as_ptr().add(sphere * width).cast::<f64>();

                let velocity = V::load(quad(VELOCITY));
                let inverse_mass = V::splat(*quad(VELOCITY).add(3));
                let kick = V::load(sum) * inverse_mass + pull[k];
                let velocity = velocity + kick * h;
                velocity.store(quad(VELOCITY));
                let place = V::load(quad(PLACE)) + vector.keep(velocity * h);
                place.store(quad(PLACE));
                vector.choose(velocity + kick * half, V::load(quad(PREDICTED))).store(quad(PREDICTED));
                places[k] = place;
                if MODEL != FRICTIONLESS {
                    let spin = V::load(quad(SPIN));
                    let kick = V::load(sum.add(LANES)) * V::splat(*quad(SPIN).add(3));
                    let spin = spin + kick * h;
                    spin.store(quad(SPIN));
                    vector.choose(spin + kick * half, V::load(quad(PREDICTED_SPIN))).store(quad(PREDICTED_SPIN));
                }
            }

            let [x, y, z, _] = V::transpose(places);
            let r = Vector([x, y, z]) - centre;
            let y = Vector([next[0].dot(r), next[1].dot(r), next[2].dot(r)]);
            strayed = strayed.choose(all, all.without(within(y, at(LISTED))));
            if KIND == FROZEN {
                stale = stale.choose(all, all.without(within(y, at(ATTRACTED))));
                for (k, v) in y.0.into_iter().enumerate() {
                    v.store(at(NOW + k));
                }
                let masses = records.as_ptr().add(four * LANES * stride + PREDICTED).cast::<f64>();
                let quad = |k: usize| masses.add(k * stride * LANES);
                let mass = V::transpose([V::load(quad(0)), V::load(quad(1)), V::load(quad(2)), V::load(quad(3))])[3];
                let g = Vector([V::load(at(FIELD)), V::load(at(FIELD + 1)), V::load(at(FIELD + 2))]);
                let weighted = y.times(mass);
                torque = torque + weighted.cross(g);
                let [a, b, c] = y.0;
                let [ma, mb, mc] = weighted.0;
                let products = [ma * a, mb * b, mc * c, ma * b, ma * c, mb * c];
                for k in 0..6 {
                    moments[k] = moments[k] + products[k];
                }
            }
        }
        Moved {
            strayed: strayed.any(),
            stale: stale.any(),
            torque: [torque.0[0].total(), torque.0[1].total(), torque.0[2].total()],
            moments: std::array::from_fn(|k| moments[k].total()),
        }
    }
}

/// Less than a half where a quad is a vector.
static VECTOR: Quad = Quad([0.0, 0.0, 0.0, 1.0]);

/// Mask of the places that are closer to those at `reference` than what follows them there; not of what is nowhere.
#[inline(always)]
unsafe fn within<V: Lanes>(place: Vector<V>, reference: *const f64) -> V {
    unsafe {
        let from = [V::load(reference), V::load(reference.add(LANES)), V::load(reference.add(2 * LANES))];
        let away = place - Vector(from);
        away.dot(away).less(V::load(reference.add(3 * LANES)))
    }
}
