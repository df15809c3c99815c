//! The pairs of spheres that may be in contact, in chunks that one thread works on, with what each pair remembers.
//!
//! A chunk is a fixed number of spheres that follow each other in space, and the pairs whose first sphere is among them. It has
//! its own sums of forces, for its own spheres and for the foreign ones that its pairs reach, so that threads never
//! write to the same place; the sums of a sphere are put together in the order of the chunks. Chunks depend on the
//! number of spheres alone: results do not depend on the number of threads.

use super::coefficients::Coefficients;
use super::history::Contact;
use super::kernel::Heat;
use super::lanes::{LANES, Octet, Quad, WIDE};
use super::record;

/// Spheres of a chunk: their records, sums and pairs fit the second-level cache of a core.
pub(super) const CHUNK: usize = 1024;

/// Eight pairs. Small, since all of them are read in every step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Eight {
    /// Rows of the second spheres.
    pub j: [u32; WIDE],
    /// Places of these in the chunk's sums.
    pub sum_j: [u32; WIDE],
    /// Places of the first spheres in the chunk and in its sums.
    pub i: [u16; WIDE],
    /// Whether one of the pairs touched when last looked at, and may remember something.
    pub touched: bool,
}

/// A contribution to the sums of an own sphere that another chunk has computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Incoming {
    /// Place of the sphere in its own chunk.
    pub sphere: u32,
    pub chunk: u32,
    /// Place among the foreign spheres of that chunk.
    pub sum: u32,
}

/// Consecutive spheres and the pairs that start with one of them.
#[derive(Debug, Clone, Default)]
pub(super) struct Chunk {
    pub index: Vec<Eight>,
    /// For each eight pairs: constants, then memory, as [`record`] says.
    pub fields: Vec<Octet>,
    /// Forces and torques: own spheres, then foreign ones, then some that nobody asks for.
    pub sums: Vec<Quad>,
    /// Spheres of its own.
    pub own: usize,
    /// What other chunks have for its spheres.
    pub incoming: Vec<Incoming>,
    /// Deepest overlap seen, over the smaller radius.
    pub deepest: f64,
    pub heat: Heat,
    /// Row of the first of its spheres.
    pub first: u32,
}

/// The spheres that pairs are made of.
pub(super) struct Spheres<'a> {
    pub records: &'a [Quad],
    /// 1 / mass and 1 / moment of inertia of each.
    pub inverses: &'a [[f64; 2]],
    pub law: &'a Coefficients,
}

/// All chunks of a body.
#[derive(Debug, Default)]
pub(super) struct Pairs {
    pub chunks: Vec<Chunk>,
    /// Sums of the foreign spheres of each chunk, taken out of it so that the others can read them.
    pub foreign: Vec<Vec<Quad>>,
    model: u8,
    cohesive: bool,
    /// Row of the sphere that fills up eights.
    nobody: u32,
}

impl Pairs {
    pub fn new(model: u8, cohesive: bool) -> Self {
        Self { model, cohesive, ..Self::default() }
    }

    /// Replaces the pairs by `near` (i < j, sorted) of the first `n` spheres that have records, giving each what
    /// `remembered` (sorted by rows, first < second) holds of it. Sphere `n` must be far from all others.
    pub fn fill(&mut self, n: usize, near: &[(u32, u32)], remembered: &[Contact], spheres: &Spheres) {
        self.nobody = n as u32;
        self.chunks.resize_with(n.div_ceil(CHUNK), Chunk::default);
        self.foreign.resize_with(n.div_ceil(CHUNK), Vec::new);
        let quads = record::quads(self.model);
        let width = record::sums(self.model);
        // Places of the foreign spheres in the sums of the chunk at hand.
        let mut place = vec![u32::MAX; n];
        let mut incoming: Vec<Vec<Incoming>> = vec![Vec::new(); self.chunks.len()];
        let (mut near, mut separate) = (near, Vec::new());
        for c in 0..self.chunks.len() {
            let own = c * CHUNK..n.min((c + 1) * CHUNK);
            let (here, rest) = near.split_at(near.partition_point(|(i, _)| (*i as usize) < own.end));
            near = rest;
            let mut foreign: Vec<u32> = Vec::new();
            let mut sum_of = |s: u32| {
                if (s as usize) < own.end {
                    return s - own.start as u32;
                }
                if place[s as usize] == u32::MAX {
                    place[s as usize] = (own.len() + foreign.len()) as u32;
                    foreign.push(s);
                }
                place[s as usize]
            };
            let mut chunk = std::mem::take(&mut self.chunks[c]);
            chunk.index.clear();
            chunk.fields.clear();
            (chunk.first, chunk.own) = (own.start as u32, own.len());
            separate.clear();
            let mut lane = 0;
            // Pairs that touch come first: eights that do not are passed over quickly.
            for &(i, j) in here {
                let [one, other] = [i, j].map(|s| &spheres.records[s as usize * quads + record::PLACE]);
                if (other.xyz() - one.xyz()).norm() < one.0[3] + other.0[3] {
                    self.push(&mut chunk, &mut lane, (i, j), sum_of(j), remembered, spheres);
                } else {
                    separate.push((i, j));
                }
            }
            lane = 0;
            for &(i, j) in &separate {
                self.push(&mut chunk, &mut lane, (i, j), sum_of(j), remembered, spheres);
            }
            let nobody = (own.len() + foreign.len()) as u32;
            for eight in &mut chunk.index {
                for lane in 0..WIDE {
                    if eight.j[lane] == self.nobody {
                        eight.sum_j[lane] = nobody;
                    }
                }
            }
            chunk.sums.clear();
            // Spheres move in fours, so the last may read beyond the own ones.
            chunk.sums.resize((nobody as usize + LANES) * width, Quad::default());
            for (sum, &j) in foreign.iter().enumerate() {
                let (home, sphere) = (j as usize / CHUNK, j % CHUNK as u32);
                incoming[home].push(Incoming { sphere, chunk: c as u32, sum: sum as u32 });
                place[j as usize] = u32::MAX;
            }
            self.foreign[c].clear();
            self.foreign[c].resize(foreign.len() * width, Quad::default());
            self.chunks[c] = chunk;
        }
        for (chunk, mut incoming) in self.chunks.iter_mut().zip(incoming) {
            incoming.sort_unstable();
            chunk.incoming = incoming;
        }
    }

    /// Appends a pair to a chunk; `lane` is the place in the last eight, 0 for a new one.
    fn push(
        &self,
        chunk: &mut Chunk,
        lane: &mut usize,
        (i, j): (u32, u32),
        sum_j: u32,
        remembered: &[Contact],
        spheres: &Spheres,
    ) {
        let (constants, width) =
            (record::constants(self.model, self.cohesive), record::fields(self.model, self.cohesive));
        if *lane == 0 {
            // Nobody's forces are none, so they may be added to those of any sphere.
            let j = [self.nobody; WIDE];
            chunk.index.push(Eight { j, sum_j: [0; WIDE], i: [(i - chunk.first) as u16; WIDE], touched: true });
            chunk.fields.extend(std::iter::repeat_n(Octet::default(), width));
        }
        let eight = chunk.index.last_mut().expect("one was pushed for the first lane");
        (eight.i[*lane], eight.j[*lane], eight.sum_j[*lane]) = ((i - chunk.first) as u16, j, sum_j);
        let at = chunk.fields.len() - width;
        let mut fields = chunk.fields[at..].iter_mut().map(|octet| &mut octet.0[*lane]);
        self::constants(self.model, self.cohesive, spheres, [i, j])
            .into_iter()
            .zip(fields.by_ref().take(constants))
            .for_each(|(value, field)| *field = value);
        if let Ok(m) = remembered.binary_search_by_key(&(i, j), |m| (m.first, m.second)) {
            put_memory(self.model, &remembered[m], fields);
        }
        *lane = (*lane + 1) % WIDE;
    }

    /// Calls `visit` with the rows and the memory of every pair.
    pub fn visit(&self, mut visit: impl FnMut(Contact)) {
        let (constants, fields) =
            (record::constants(self.model, self.cohesive), record::fields(self.model, self.cohesive));
        for chunk in &self.chunks {
            for (eight, fields) in chunk.index.iter().zip(chunk.fields.chunks_exact(fields)) {
                for lane in 0..WIDE {
                    if eight.j[lane] != self.nobody {
                        let memory = |k: usize| fields[constants + k].0[lane];
                        let i = chunk.first + u32::from(eight.i[lane]);
                        visit(get_memory(self.model, i, eight.j[lane], memory));
                    }
                }
            }
        }
    }

    /// What the pairs remember, those that remember nothing left out, sorted by rows.
    pub fn memories(&self) -> Vec<Contact> {
        let mut contacts = Vec::new();
        if record::memory(self.model) > 0 {
            self.visit(|contact| {
                if !contact.is_blank() {
                    contacts.push(contact);
                }
            });
        }
        contacts.sort_unstable_by_key(|c| (c.first, c.second));
        contacts
    }

    /// Bytes in use.
    pub fn bytes(&self) -> usize {
        let of = |c: &Chunk| {
            size_of_val(&*c.index) + size_of_val(&*c.fields) + size_of_val(&*c.sums) + size_of_val(&*c.incoming)
        };
        self.chunks.iter().map(of).sum::<usize>() + self.foreign.iter().map(|f| size_of_val(&**f)).sum::<usize>()
    }
}

/// The constants of a pair, in the order of [`record::constants`].
fn constants(model: u8, cohesive: bool, of: &Spheres, pair: [u32; 2]) -> impl IntoIterator<Item = f64> {
    let [r_i, r_j] = pair.map(|s| of.records[s as usize * record::quads(model) + record::PLACE].0[3]);
    // By the inverse masses, so that one may be held in place.
    let [[m_i, a], [m_j, b]] = pair.map(|s| of.inverses[s as usize]);
    let sqrt_mu = (1.0 / (m_i + m_j)).sqrt();
    let width = record::has_width(model, cohesive).then(|| of.law.shape * r_i * (r_j / (r_i + r_j)));
    let inertias = (model == record::DIRECTIONAL).then(|| [1.0 / (r_i * a + r_j * b), 1.0 / (a + b)]);
    std::iter::once(sqrt_mu).chain(width).chain(inertias.into_iter().flatten())
}

/// Writes the memory of a contact in the order of [`record::memory`].
fn put_memory<'a>(model: u8, contact: &Contact, to: impl Iterator<Item = &'a mut f64>) {
    let ([a, b, c], [d, e, f]) = (contact.sliding_m, contact.rolling_rad);
    let values = match model {
        record::DIRECTIONAL => [a, b, c, contact.age_s, 0.0, 0.0, 0.0],
        _ => [a, b, c, d, e, f, contact.twisting_rad],
    };
    to.zip(values).for_each(|(to, value)| *to = value);
}

fn get_memory(model: u8, first: u32, second: u32, k: impl Fn(usize) -> f64) -> Contact {
    let mut contact = Contact { first, second, ..Contact::default() };
    if model != record::FRICTIONLESS {
        contact.sliding_m = [k(0), k(1), k(2)];
    }
    if model == record::FULL {
        contact.rolling_rad = [k(3), k(4), k(5)];
        contact.twisting_rad = k(6);
    }
    if model == record::DIRECTIONAL {
        contact.age_s = k(3);
    }
    contact
}
