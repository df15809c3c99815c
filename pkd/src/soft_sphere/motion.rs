//! One leapfrog step of the spheres of a chunk, four at a time, and how far they got against the motion of the body.
//!
//! A sphere is kicked by the forces at its place, moved by the new velocity, and its velocity for the time of arrival is
//! predicted with the same forces (Schwartz et al. 2012, Granular Matter 14, 363, section 2.7). Its place in the frame
//! that turns with the body is compared with where it was when neighbours and gravity were last looked at; the torque
//! of the frozen field is summed, so that it can be taken out at the next kick.

use super::lanes::{LANES, Lanes, Quad, Vector};
use super::pairs::Chunk;
use super::record::{self, FRICTIONLESS, PLACE, PREDICTED, SPINS, VELOCITY};

/// No accelerations but those of contacts.
pub(super) const NONE: u8 = 0;
/// Accelerations given for this instant.
pub(super) const GIVEN: u8 = 1;
/// Accelerations that turn with the body.
pub(super) const FROZEN: u8 = 2;

/// Quads that four spheres have besides their records, a number of each sphere in a quad.
/// x, y, z in the body frame when the sphere was last looked at, m, and the square of how far it may be from there, m².
pub(super) const SEEN: usize = 0;
/// x, y, z of the acceleration, m/s²: in the body frame if frozen.
pub(super) const FIELD: usize = 4;
/// Mass, kg, where the field is frozen.
pub(super) const MASS: usize = 7;

/// Quads of four spheres that go with this kind of field.
pub(super) const fn guide_quads(field: u8) -> usize {
    match field {
        NONE => 4,
        GIVEN => 7,
        _ => 8,
    }
}

/// The body frame at the start and end of a step.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Frames {
    /// From the body frame, at the start: columns.
    pub turn: [[f64; 3]; 3],
    /// Origin of the body frame at the start, m.
    pub centre: [f64; 3],
    /// Angular acceleration that takes the torque out of the frozen field, rad/s².
    pub correction: [f64; 3],
    /// From the body frame, at the end: columns.
    pub next_turn: [[f64; 3]; 3],
    /// Origin of the body frame at the end, m.
    pub next_centre: [f64; 3],
}

/// What a step did to the spheres of a chunk.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Moved {
    /// Whether a sphere is too far from where it was last looked at, or nowhere.
    pub away: bool,
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
/// and `sums` must be laid out for `MODEL` and `guides` for `KIND`, with room for all spheres of the last four. `inverses`
/// are 1 / mass and 1 / moment of inertia of each sphere.
#[inline(always)]
pub(super) unsafe fn advance<V: Lanes, const MODEL: u8, const KIND: u8>(
    step: f64,
    frames: &Frames,
    records: &mut [Quad],
    inverses: &[[f64; 2]],
    guides: &mut [Quad],
    sums: &[Quad],
) -> Moved {
    let (stride, width, guide) = (record::quads(MODEL), record::sums(MODEL), guide_quads(KIND));
    let fours = guides.len() / guide;
    let spheres = fours * LANES;
    let room = records.len() >= spheres * stride && inverses.len() >= spheres && sums.len() >= spheres * width;
    assert!(room, "room for all fours");
    // SAFETY: the caller vouches for the processor, the assertion for the lengths.
    unsafe {
        let zero = V::splat(0.0);
        let (h, half) = (V::splat(step), V::splat(0.5 * step));
        // Lanes of a quad: all, those of a vector, the first two.
        let all = zero.less(V::splat(1.0));
        let lane = V::load(LANE.0.as_ptr());
        let (vector, first_two) = (lane.less(V::splat(2.5)), lane.less(V::splat(1.5)));
        let splat3 = |v: [f64; 3]| Vector([V::splat(v[0]), V::splat(v[1]), V::splat(v[2])]);
        let turn = [splat3(frames.turn[0]), splat3(frames.turn[1]), splat3(frames.turn[2])];
        let next = [splat3(frames.next_turn[0]), splat3(frames.next_turn[1]), splat3(frames.next_turn[2])];
        let (centre, next_centre) = (splat3(frames.centre), splat3(frames.next_centre));
        let correction = splat3(frames.correction);
        let mut away = zero;
        let mut torque = Vector([zero; 3]);
        let mut moments = [zero; 6];

        for four in 0..fours {
            let guide = guides.as_mut_ptr().add(four * guide).cast::<f64>();
            let at = |k: usize| guide.add(k * LANES);
            let place = records.as_mut_ptr().add(four * LANES * stride + PLACE).cast::<f64>();
            let place = |k: usize| place.add(k * stride * LANES);
            let mut places = [V::load(place(0)), V::load(place(1)), V::load(place(2)), V::load(place(3))];
            let pull = if KIND == NONE {
                [zero; LANES]
            } else {
                let mut g = Vector([V::load(at(FIELD)), V::load(at(FIELD + 1)), V::load(at(FIELD + 2))]);
                if KIND == FROZEN {
                    let [x, y, z, _] = V::transpose(places);
                    let r = Vector([x, y, z]) - centre;
                    let [x, y, z] = g.0;
                    g = turn[0].times(x) + turn[1].times(y) + turn[2].times(z) - correction.cross(r);
                }
                V::transpose([g.0[0], g.0[1], g.0[2], zero])
            };
            let inverse = inverses.as_ptr().add(four * LANES).cast::<f64>();
            let [m, i] = V::unzip(V::pairs([inverse, inverse.add(2), inverse.add(4), inverse.add(6)]));
            let (inverses, inverse_inertias) = (V::transpose([m, m, m, i]), V::transpose([i; LANES]));
            for k in 0..LANES {
                let sphere = four * LANES + k;
                let record = records.as_mut_ptr().add(sphere * stride).cast::<f64>();
                let quad = |k: usize| record.add(k * LANES);
                let sum = sums.as_ptr().add(sphere * width).cast::<f64>();

                // With the velocity goes x of the spin, and with the force that of the torque.
                let kick = V::load(sum) * inverses[k] + pull[k];
                let velocity = V::load(quad(VELOCITY)) + kick * h;
                velocity.store(quad(VELOCITY));
                (velocity + kick * half).store(quad(PREDICTED));
                places[k] = places[k] + vector.keep(velocity * h);
                places[k].store(quad(PLACE));
                if MODEL != FRICTIONLESS {
                    let kick = V::twice(sum.add(LANES)) * inverse_inertias[k];
                    let spin = V::load(quad(SPINS)).last_twice() + kick * h;
                    first_two.choose(spin + kick * half, spin).store(quad(SPINS));
                }
            }

            let [x, y, z, _] = V::transpose(places);
            let r = Vector([x, y, z]) - next_centre;
            let y = Vector([next[0].dot(r), next[1].dot(r), next[2].dot(r)]);
            away = away.choose(all, all.without(within(y, at(SEEN))));
            if KIND == FROZEN {
                let g = Vector([V::load(at(FIELD)), V::load(at(FIELD + 1)), V::load(at(FIELD + 2))]);
                let weighted = y.times(V::load(at(MASS)));
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
            away: away.any(),
            torque: [torque.0[0].total(), torque.0[1].total(), torque.0[2].total()],
            moments: std::array::from_fn(|k| moments[k].total()),
        }
    }
}

/// The lanes counted.
static LANE: Quad = Quad([0.0, 1.0, 2.0, 3.0]);

/// Mask of the places that are closer to those at `reference` than what follows them there; not of what is nowhere.
#[inline(always)]
unsafe fn within<V: Lanes>(place: Vector<V>, reference: *const f64) -> V {
    unsafe {
        let from = [V::load(reference), V::load(reference.add(LANES)), V::load(reference.add(2 * LANES))];
        let away = place - Vector(from);
        away.dot(away).less(V::load(reference.add(3 * LANES)))
    }
}
