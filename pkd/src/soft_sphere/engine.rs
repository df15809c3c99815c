//! One run of soft spheres from state to state: records, lists and field are made, steps are taken, and all is taken down.
//!
//! Everything here is made anew from spheres and contact history at the start of a call, in a canonical way, and
//! nothing of it is left at the end: so a run that goes on from stored spheres and history has the same bytes.

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use super::body_frame::{BodyFrame, columns};
use super::coefficients::Coefficients;
use super::dispatch::Kernels;
use super::history::{Contact, ContactHistory};
use super::kernel::Heat;
use super::lanes::{LANES, Quad};
use super::layout::{guides, inverses, records};
use super::motion::{FIELD, FROZEN, Frames, GIVEN, Moved, NONE, SEEN, collect, guide_quads};
use super::pairs::{self, CHUNK, Pairs};
use super::parameters::{Gravity, SoftSphereParameters};
use super::record::{self, FRICTIONLESS, Lines, PLACE, PREDICTED, VELOCITY};
use super::report::Energy;
use super::search::{near_pairs, order_in_space};
use crate::gravity::{Accelerations, angular_acceleration, balance};
use crate::rigid_fit::{FitRank, rigid_fit};
use crate::simd::Level;
use crate::{PkdError, Spheres};

/// Fewer spheres than this are not worth handing to several threads.
const PARALLEL_FROM: usize = 4000;

/// Up to this many spheres the sum over all pairs in every step costs no more than the look-up of a frozen field, which a
/// pair on an eccentric orbit would have to renew in every step anyway.
const FREEZE_FROM: usize = 16;

/// Counts of work.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Work {
    pub gravity_evaluations: u64,
    pub frozen_field_error: f64,
    pub list_rebuilds: u64,
}

/// What has to be made anew.
struct Outdated {
    lists: bool,
    field: bool,
}

/// The run.
pub(super) struct Engine<'a> {
    gravity: &'a mut crate::gravity::Gravity,
    parameters: &'a SoftSphereParameters,
    kernels: Kernels,
    law: Coefficients,
    model: u8,
    field: u8,
    /// Spheres.
    n: usize,
    /// Row of the caller's spheres for each of ours.
    rows: Vec<u32>,
    masses: Vec<f64>,
    records: Lines,
    /// 1 / mass and 1 / moment of inertia, in fours.
    inverses: Vec<[f64; 2]>,
    guides: Vec<Quad>,
    pairs: Pairs,
    near: Vec<(u32, u32)>,
    /// Places in the body frame when the neighbours were listed.
    listed: Vec<Vector3<f64>>,
    /// The same when a frozen field was evaluated.
    attracted: Vec<Vector3<f64>>,
    frame: BodyFrame,
    correction: [f64; 3],
    moved: Vec<Moved>,
    accelerations: Accelerations,
    /// Time since the start of the call, s.
    time: f64,
    pub work: Work,
}

impl<'a> Engine<'a> {
    /// Lays everything out and finds the forces of the start. The spheres must be valid and the history fit them.
    ///
    /// # Errors
    /// [`PkdError::Coincident`], [`PkdError::TooSoft`] and [`PkdError::BecameNonFinite`].
    pub fn new(
        level: Level,
        gravity: &'a mut crate::gravity::Gravity,
        parameters: &'a SoftSphereParameters,
        law: Coefficients,
        spheres: &Spheres,
        history: &ContactHistory,
    ) -> Result<Self, PkdError> {
        let model = record::model(&parameters.friction);
        let n = spheres.len();
        let field = match parameters.gravity {
            Gravity::Off => NONE,
            Gravity::BodyFrame { .. } if n > FREEZE_FROM => FROZEN,
            Gravity::EveryStep | Gravity::BodyFrame { .. } => GIVEN,
        };
        let rows = order_in_space(spheres.coordinates());
        let records = records(model, spheres, &rows);
        let masses: Vec<f64> = rows.iter().map(|row| spheres.mass[*row as usize]).collect();
        let frame = BodyFrame::of(model, &records, &masses, Matrix3::identity());
        let mut engine = Self {
            gravity,
            parameters,
            kernels: Kernels::new(level, parameters, field),
            law,
            model,
            field,
            n,
            inverses: inverses(model, &masses, spheres, &rows),
            guides: guides(field, &masses),
            rows,
            masses,
            records,
            pairs: Pairs::new(model, parameters.cohesion_pa > 0.0),
            near: Vec::new(),
            listed: Vec::new(),
            attracted: Vec::new(),
            frame,
            correction: [0.0; 3],
            moved: vec![Moved::default(); n.div_ceil(CHUNK)],
            accelerations: Accelerations::default(),
            time: 0.0,
            work: Work::default(),
        };
        engine.list(&engine.internal(history));
        engine.refuse_coincident()?;
        engine.attract()?;
        engine.note();
        engine.push(0.0)?;
        Ok(engine)
    }

    /// Takes `steps` steps of `step` (s), and asks before each whether to `go_on`.
    pub fn run(&mut self, steps: u64, step: f64, go_on: &mut dyn FnMut() -> bool) -> Result<(), PkdError> {
        // Velocities live in the middle of steps.
        self.kick(-0.5 * step);
        for taken in 1..=steps {
            if !go_on() {
                return Err(PkdError::Stopped);
            }
            let frames = self.frames(step);
            self.time = taken as f64 * step;
            let moved = self.advance(step, &frames);
            self.correction = angular_acceleration(moved.torque, moved.moments);
            if moved.away {
                self.renew()?;
            }
            if self.field == GIVEN {
                self.attract()?;
            }
            self.push(step)?;
        }
        self.kick(0.5 * step);
        Ok(())
    }

    /// Writes places, velocities and spins back, and gives the history of the contacts.
    pub fn finish(&self, spheres: &mut Spheres) -> ContactHistory {
        for (s, &row) in self.records.chunks_exact(record::quads(self.model)).zip(&self.rows) {
            let row = row as usize;
            let spin = if self.model == FRICTIONLESS { spheres.spin(row) } else { record::spin(s).into() };
            spheres.set(row, s[PLACE].xyz().into(), s[VELOCITY].xyz().into(), spin);
        }
        let external = |c: Contact| {
            let named = Contact { first: self.rows[c.first as usize], second: self.rows[c.second as usize], ..c };
            if named.first < named.second { named } else { named.reversed() }
        };
        ContactHistory::sorted(self.pairs.memories().into_iter().map(external).collect())
    }

    /// What the contacts do to each sphere now, in the caller's rows: forces, N, and torques, N m.
    pub fn contact_forces(&mut self) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
        let (mut forces, mut torques) = (vec![[0.0; 3]; self.n], vec![[0.0; 3]; self.n]);
        let width = record::sums(self.model);
        for (c, chunk) in self.pairs.chunks.iter_mut().enumerate() {
            // The sums may be asked for again.
            let sums = chunk.sums.clone();
            collect(self.model, chunk, &self.pairs.foreign);
            for own in 0..chunk.own {
                let row = self.rows[c * CHUNK + own] as usize;
                forces[row] = chunk.sums[own * width].xyz().into();
                if self.model != FRICTIONLESS {
                    torques[row] = record::torque(&chunk.sums[own * width..]).into();
                }
            }
            chunk.sums = sums;
        }
        (forces, torques)
    }

    /// Deepest overlap since the start, over the smaller radius.
    pub fn deepest(&self) -> f64 {
        self.pairs.chunks.iter().map(|c| c.deepest).fold(0.0, f64::max)
    }

    /// Heat since the start.
    pub fn heat(&self) -> Heat {
        self.pairs.chunks.iter().fold(Heat::default(), |sum, c| sum.plus(&c.heat))
    }

    /// Bytes in use.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.records)
            + size_of_val(&*self.inverses)
            + size_of_val(&*self.guides)
            + size_of_val(&*self.near)
            + size_of_val(&*self.rows)
            + self.pairs.bytes()
            + size_of_val(&*self.masses)
            + size_of_val(&*self.listed)
            + size_of_val(&*self.attracted)
            + 4 * size_of_val(&*self.accelerations.x)
    }

    /// Number of contacts and the energy of their springs.
    pub fn springs(&self) -> (u64, Energy) {
        let (law, quads) = (&self.law, record::quads(self.model));
        let (mut count, mut energy) = (0, Energy::default());
        self.pairs.visit(|contact| {
            let [i, j] = [contact.first, contact.second].map(|s| &self.records[s as usize * quads + PLACE]);
            let overlap = i.0[3] + j.0[3] - (j.xyz() - i.xyz()).norm();
            if overlap > 0.0 {
                count += 1;
                let q = law.shape * i.0[3] * (j.0[3] / (i.0[3] + j.0[3]));
                energy.normal_j += 0.5 * law.k_n * overlap * overlap - law.cohesion * q * q * overlap;
                energy.sliding_j += 0.5 * law.k_t * Vector3::from(contact.sliding_m).norm_squared();
                energy.rolling_j += 0.5 * law.k_r * q * q * Vector3::from(contact.rolling_rad).norm_squared();
                energy.twisting_j += 0.5 * law.k_w * q * q * contact.twisting_rad * contact.twisting_rad;
            }
        });
        (count, energy)
    }

    /// The history in our rows.
    fn internal(&self, history: &ContactHistory) -> Vec<Contact> {
        let mut ours = vec![0; self.n];
        self.rows.iter().zip(0..).for_each(|(&row, k)| ours[row as usize] = k);
        let internal = |c: &Contact| {
            let named = Contact { first: ours[c.first as usize], second: ours[c.second as usize], ..*c };
            if named.first < named.second { named } else { named.reversed() }
        };
        let mut contacts: Vec<Contact> = history.contacts().iter().map(internal).collect();
        contacts.sort_unstable_by_key(|c| (c.first, c.second));
        contacts
    }

    fn coordinates(&self) -> [Vec<f64>; 3] {
        let quads = record::quads(self.model);
        [0, 1, 2].map(|k| self.records.chunks_exact(quads).take(self.n).map(|s| s[PLACE].0[k]).collect())
    }

    /// The places in the body frame.
    fn places(&self) -> Vec<Vector3<f64>> {
        let (turn, centre) = (self.frame.turn(), self.frame.centre());
        let records = self.records.chunks_exact(record::quads(self.model)).take(self.n);
        records.map(|s| turn.tr_mul(&(s[PLACE].xyz() - centre))).collect()
    }

    /// How far a sphere may get from where it was last looked at, over its radius.
    fn watch(&self) -> f64 {
        self.field_tolerance().map_or(self.parameters.skin, |tolerance| tolerance.min(self.parameters.skin))
    }

    /// Lists the neighbours anew.
    fn list(&mut self, remembered: &[Contact]) {
        self.work.list_rebuilds += 1;
        let quads = record::quads(self.model);
        let [x, y, z] = self.coordinates();
        let skin = 1.0 + self.parameters.skin;
        let reach: Vec<f64> = self.records.chunks_exact(quads).take(self.n).map(|s| s[PLACE].0[3] * skin).collect();
        near_pairs([&x, &y, &z], &reach, &mut self.near);
        let of = pairs::Spheres { records: &self.records, inverses: &self.inverses, law: &self.law };
        self.pairs.fill(self.n, &self.near, remembered, &of);
        self.near = Vec::new();
        self.listed = self.places();
    }

    /// Notes the places in the body frame, and how far a sphere may get from them.
    fn note(&mut self) {
        let (watch, quads, guide) = (self.watch(), record::quads(self.model), guide_quads(self.field));
        for (i, y) in self.places().into_iter().enumerate() {
            let guide = &mut self.guides[i / LANES * guide + SEEN..];
            (0..3).for_each(|k| guide[k].0[i % LANES] = y[k]);
            guide[3].0[i % LANES] = (watch * self.records[i * quads + PLACE].0[3]).powi(2);
        }
    }

    /// Whether a sphere is too far from where it was seen, and then also whether one is from where the neighbours were listed
    /// or where gravity was evaluated: until it has been seen again it must not get beyond skin or tolerance.
    fn look(&self) -> Option<Outdated> {
        let (quads, places, watch) = (record::quads(self.model), self.places(), self.watch());
        let seen = |i: usize| Vector3::from_fn(|k, _| self.guide(i, SEEN + k));
        let beyond = |from: &dyn Fn(usize) -> Vector3<f64>, fraction: f64| {
            places.iter().enumerate().any(|(i, y)| {
                let limit = fraction * self.records[i * quads + PLACE].0[3];
                // Not a number is beyond any limit.
                (y - from(i)).norm_squared().partial_cmp(&(limit * limit)) != Some(std::cmp::Ordering::Less)
            })
        };
        beyond(&seen, watch).then(|| Outdated {
            lists: beyond(&|i| self.listed[i], self.parameters.skin - watch),
            field: self.field_tolerance().is_some_and(|tolerance| beyond(&|i| self.attracted[i], tolerance - watch)),
        })
    }

    /// How far a sphere may get from where a frozen field was evaluated, over its radius; `None` without one.
    fn field_tolerance(&self) -> Option<f64> {
        match self.parameters.gravity {
            Gravity::BodyFrame { tolerance } if self.field == FROZEN => Some(tolerance),
            _ => None,
        }
    }

    /// A number that a sphere has in the guides.
    fn guide(&self, i: usize, quad: usize) -> f64 {
        self.guides[i / LANES * guide_quads(self.field) + quad].0[i % LANES]
    }

    /// The acceleration that a sphere has in the guides.
    fn pull(&self, i: usize) -> Vector3<f64> {
        Vector3::from_fn(|k, _| self.guide(i, FIELD + k))
    }

    /// Something seems to have moved: fits the frame, and renews what is out of date nevertheless.
    fn renew(&mut self) -> Result<(), PkdError> {
        self.finite()?;
        let [from_x, from_y, from_z] = [0, 1, 2].map(|k| self.listed.iter().map(|y| y[k]).collect::<Vec<f64>>());
        let [x, y, z] = self.coordinates();
        let fit = rigid_fit([&from_x, &from_y, &from_z], [&x, &y, &z], &vec![true; self.n]);
        let turn = if fit.rank == FitRank::Full { fit.motion.rotation } else { self.frame.turn() };
        self.frame = BodyFrame::of(self.model, &self.records, &self.masses, turn);
        if let Some(outdated) = self.look() {
            if outdated.lists {
                let remembered = self.pairs.memories();
                self.list(&remembered);
            }
            if outdated.field {
                self.attract()?;
            }
            self.note();
        }
        self.correction = self.residual_torque();
        Ok(())
    }

    /// Evaluates gravity.
    fn attract(&mut self) -> Result<(), PkdError> {
        if self.field == NONE {
            return Ok(());
        }
        self.work.gravity_evaluations += 1;
        let [x, y, z] = self.coordinates();
        self.gravity.accelerations(&x, &y, &z, &self.masses, &mut self.accelerations);
        let a = &self.accelerations;
        for component in [&a.x, &a.y, &a.z] {
            if let Some(i) = component.iter().position(|value| !value.is_finite()) {
                let (sphere, time_s) = (self.rows[i] as usize, self.time);
                return Err(PkdError::BecameNonFinite { sphere, quantity: "acceleration", time_s });
            }
        }
        if self.field == FROZEN {
            self.freeze();
            return Ok(());
        }
        if self.gravity.last_error_estimate() > 0.0 {
            balance([&x, &y, &z], &self.masses, &mut self.accelerations);
        }
        let a = &self.accelerations;
        for (four, guide) in self.guides.chunks_exact_mut(guide_quads(self.field)).enumerate() {
            for (k, component) in [&a.x, &a.y, &a.z].into_iter().enumerate() {
                let from = component[four * LANES..].iter().take(LANES);
                guide[FIELD + k].0.iter_mut().zip(from).for_each(|(to, a)| *to = *a);
            }
        }
        Ok(())
    }

    /// Evaluates a frozen field once more, at the end: else a body at rest, whose field is never renewed, would show no error.
    pub fn judge_field(&mut self) -> Result<(), PkdError> {
        if self.field == FROZEN { self.attract() } else { Ok(()) }
    }

    /// Turns the field just evaluated into the body frame, takes its net force and torque out, and compares it with the one
    /// before.
    fn freeze(&mut self) {
        let (a, mass, turn) = (&self.accelerations, &self.masses, self.frame.turn());
        let field: Vec<Vector3<f64>> =
            (0..self.n).map(|i| turn.tr_mul(&Vector3::new(a.x[i], a.y[i], a.z[i]))).collect();
        let total: f64 = mass.iter().sum();
        let mean = field.iter().zip(mass).map(|(g, m)| g * *m).sum::<Vector3<f64>>() / total;

        let guide = guide_quads(FROZEN);
        let first = self.work.gravity_evaluations == 1;
        let correction = Vector3::from(self.correction);
        let (mut error, mut size) = (0.0, 0.0);
        for (i, (g, place)) in field.iter().zip(self.places()).enumerate() {
            let old = self.pull(i) - correction.cross(&place);
            error += (old - g).norm_squared();
            size += g.norm_squared();
        }
        for (i, g) in field.iter().enumerate() {
            let guide = &mut self.guides[i / LANES * guide + FIELD..];
            (0..3).for_each(|k| guide[k].0[i % LANES] = g[k] - mean[k]);
        }
        self.attracted = self.places();
        if !first && size > 0.0 {
            self.work.frozen_field_error = self.work.frozen_field_error.max((error / size).sqrt());
        }
        self.correction = self.residual_torque();
    }

    /// Angular acceleration that takes out the torque of the frozen field at the present places.
    fn residual_torque(&self) -> [f64; 3] {
        if self.field != FROZEN {
            return [0.0; 3];
        }
        let (mut torque, mut moments) = (Vector3::zeros(), [0.0; 6]);
        for (i, (y, &m)) in self.places().into_iter().zip(&self.masses).enumerate() {
            torque += y.cross(&self.pull(i)) * m;
            let products = [y.x * y.x, y.y * y.y, y.z * y.z, y.x * y.y, y.x * y.z, y.y * y.z];
            moments.iter_mut().zip(products).for_each(|(sum, p)| *sum += m * p);
        }
        angular_acceleration(torque.into(), moments)
    }

    /// The frame now and after a step, which passes.
    fn frames(&mut self, step: f64) -> Frames {
        let (turn, centre) = (self.frame.turn(), self.frame.centre());
        self.frame.pass(step);
        Frames {
            turn: columns(&turn),
            centre: centre.into(),
            correction: (turn * Vector3::from(self.correction)).into(),
            next_turn: columns(&self.frame.turn()),
            next_centre: self.frame.centre().into(),
        }
    }

    /// Moves all spheres by a step.
    fn advance(&mut self, step: f64, frames: &Frames) -> Moved {
        let (model, quads, guide) = (self.model, record::quads(self.model), guide_quads(self.field));
        let advance = self.kernels.advance;
        let foreign = &self.pairs.foreign;
        type Given<'g> = ((((&'g mut pairs::Chunk, &'g mut [Quad]), &'g [[f64; 2]]), &'g mut [Quad]), &'g mut Moved);
        let one = |((((chunk, records), inverses), guides), moved): Given| {
            collect(model, chunk, foreign);
            // SAFETY: laid out for the model and field the kernel was chosen for.
            *moved = unsafe { advance(step, frames, records, inverses, guides, &chunk.sums) };
        };
        let (records, guides) = (CHUNK * quads, CHUNK / LANES * guide);
        if self.n >= PARALLEL_FROM && rayon::current_num_threads() > 1 {
            let chunks = self.pairs.chunks.par_iter_mut();
            chunks
                .zip(self.records.par_chunks_mut(records))
                .zip(self.inverses.par_chunks(CHUNK))
                .zip(self.guides.par_chunks_mut(guides))
                .zip(&mut self.moved)
                .for_each(one);
        } else {
            let chunks = self.pairs.chunks.iter_mut();
            chunks
                .zip(self.records.chunks_mut(records))
                .zip(self.inverses.chunks(CHUNK))
                .zip(self.guides.chunks_mut(guides))
                .zip(&mut self.moved)
                .for_each(one);
        }
        // In the order of the chunks.
        self.moved.iter().fold(Moved::default(), |sum, m| Moved {
            away: sum.away | m.away,
            torque: std::array::from_fn(|k| sum.torque[k] + m.torque[k]),
            moments: std::array::from_fn(|k| sum.moments[k] + m.moments[k]),
        })
    }

    /// Finds the forces of all contacts, whose springs are `step` (s) older than before.
    fn push(&mut self, step: f64) -> Result<(), PkdError> {
        let (contacts, law, records) = (self.kernels.contacts, &self.law, &self.records[..]);
        let width = record::sums(self.model);
        let one = |(chunk, foreign): (&mut super::pairs::Chunk, &mut Vec<Quad>)| {
            // SAFETY: laid out for the model the kernel was chosen for, with rows of existing spheres and of the one that is
            // nowhere.
            unsafe { contacts(law, step, records, chunk) };
            let from = &chunk.sums[chunk.own * width..];
            let length = foreign.len();
            foreign.copy_from_slice(&from[..length]);
        };
        if self.n >= PARALLEL_FROM && rayon::current_num_threads() > 1 {
            self.pairs.chunks.par_iter_mut().zip(&mut self.pairs.foreign).for_each(one);
        } else {
            self.pairs.chunks.iter_mut().zip(&mut self.pairs.foreign).for_each(one);
        }
        let limit = self.parameters.max_overlap;
        if self.pairs.chunks.iter().any(|c| c.deepest > limit) { Err(self.too_deep()) } else { Ok(()) }
    }

    /// Lets the present forces act for `duration` (s) on the velocities, without moving anything.
    fn kick(&mut self, duration: f64) {
        let (turn, correction) = (self.frame.turn(), Vector3::from(self.correction));
        let pull = |(i, place): (usize, Vector3<f64>)| match self.field {
            NONE => Vector3::zeros(),
            GIVEN => self.pull(i),
            _ => turn * (self.pull(i) - correction.cross(&place)),
        };
        let pulls: Vec<Vector3<f64>> = self.places().into_iter().enumerate().map(pull).collect();
        let (quads, width) = (record::quads(self.model), record::sums(self.model));
        let (chunks, foreign) = (&mut self.pairs.chunks, &self.pairs.foreign);
        for (c, chunk) in chunks.iter_mut().enumerate() {
            // The sums may be asked for again.
            let sums = chunk.sums.clone();
            collect(self.model, chunk, foreign);
            for own in 0..chunk.own {
                let i = c * CHUNK + own;
                let (s, sums) = (&mut self.records[i * quads..(i + 1) * quads], &chunk.sums[own * width..]);
                let [inverse_mass, inverse_inertia] = self.inverses[i];
                let kick = (sums[0].xyz() * inverse_mass + pulls[i]) * duration;
                (0..3).for_each(|k| s[VELOCITY].0[k] += kick[k]);
                if self.model != FRICTIONLESS {
                    let spin = record::spin(s) + record::torque(sums) * inverse_inertia * duration;
                    record::set_spin(s, spin);
                }
            }
            chunk.sums = sums;
        }
    }

    /// Calls `visit` with the overlap over the smaller radius of each pair that overlaps, in our rows.
    fn overlaps(&self, mut visit: impl FnMut(u32, u32, f64)) {
        let quads = record::quads(self.model);
        self.pairs.visit(|c| {
            let [i, j] = [c.first, c.second].map(|s| &self.records[s as usize * quads + PLACE]);
            let (d, s) = ((j.xyz() - i.xyz()).norm(), i.0[3] + j.0[3]);
            if d < s {
                visit(c.first, c.second, (s - d) / i.0[3].min(j.0[3]));
            }
        });
    }

    /// The pair that overlaps most, as an error.
    #[cold]
    fn too_deep(&self) -> PkdError {
        let mut worst = (0, 0, 0.0);
        self.overlaps(|i, j, fraction| {
            if fraction > worst.2 {
                worst = (i, j, fraction);
            }
        });
        let [a, b] = [worst.0, worst.1].map(|i| self.rows[i as usize] as usize);
        let limit = self.parameters.max_overlap;
        PkdError::TooSoft { first: a.min(b), second: a.max(b), fraction: worst.2, limit, time_s: self.time }
    }

    fn refuse_coincident(&self) -> Result<(), PkdError> {
        let quads = record::quads(self.model);
        let mut found = None;
        self.pairs.visit(|c| {
            let [i, j] = [c.first, c.second].map(|s| self.records[s as usize * quads + PLACE].xyz());
            if i == j {
                let [a, b] = [c.first, c.second].map(|i| self.rows[i as usize] as usize);
                found.get_or_insert((a.min(b), a.max(b)));
            }
        });
        found.map_or(Ok(()), |(first, second)| Err(PkdError::Coincident { first, second }))
    }

    /// Refuses places, velocities and spins that are not finite.
    pub fn finite(&self) -> Result<(), PkdError> {
        for (s, &row) in self.records.chunks_exact(record::quads(self.model)).zip(&self.rows) {
            if let Some(k) = s.iter().flat_map(|quad| quad.0).position(|v| !v.is_finite()) {
                let quantity = match (k / LANES, k % LANES) {
                    (PLACE, _) => "place",
                    (PREDICTED | VELOCITY, 0..3) => "velocity",
                    _ => "spin",
                };
                return Err(PkdError::BecameNonFinite { sphere: row as usize, quantity, time_s: self.time });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
