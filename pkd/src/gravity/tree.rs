//! Spheres in a binary tree: cells are cut along their longest side until a few blocks of eight are left.
//!
//! Cuts leave equal halves of whole blocks, so that no arrangement, coincident centres included, makes the tree deep. Only
//! where an empty gap crosses a cell is it cut there instead: a leaf with spheres of two bodies, or of one body and a
//! fragment that left it, would reach so far that no expansion about its centre is any good.

use super::dispatch::Kernels;
use super::far::Expansion;
use super::field::{BLOCK, Sources};
use super::harmonic::NARROW;

/// Most spheres in a leaf: with fewer, expansions cost more than the pairs they save.
const LEAF: usize = 4 * BLOCK;
/// Cells with fewer spheres are built on one thread.
const PARALLEL: usize = 4096;
/// Cuts in gaps on any way down; nested gaps deeper than that are left to the halving.
const MAX_GAPS: u32 = 32;
/// Slices in which a gap is looked for.
const SLICES: usize = 16;
/// The index that marks an empty place in a block.
pub(super) const NOBODY: u32 = u32::MAX;

/// A cell; its first child follows it, its second child follows all that is below the first.
#[derive(Debug, Clone, Copy, Default)]
#[repr(C, align(64))]
pub(super) struct Cell {
    /// Centre of mass in scaled coordinates, about which the cell is expanded.
    pub centre: [f64; 3],
    /// Largest distance of one of its spheres from there.
    pub reach: f64,
    /// Sum of the strengths.
    pub strength: f64,
    /// First of its blocks.
    pub first: u32,
    /// One beyond the last of its blocks.
    pub end: u32,
    /// Cells of the tree below and including it; 1 for a leaf.
    pub cells: u32,
    /// Spheres in it, at least one.
    pub spheres: u32,
}

impl Cell {
    pub fn is_leaf(&self) -> bool {
        self.cells == 1
    }
}

/// A sphere on its way to its block.
#[derive(Debug, Clone, Copy)]
struct Item {
    at: [f64; 3],
    index: u32,
}

/// The tree with its scratch memory.
#[derive(Debug, Default)]
pub(super) struct Tree {
    /// Cells in depth-first order; the first holds everything.
    pub cells: Vec<Cell>,
    /// Moments of the cells, one after the other.
    pub moments: Vec<f64>,
    /// The spheres by eights, in the order of the leaves; the last block of each is filled up with massless points.
    pub blocks: Vec<Sources>,
    /// Index of each sphere in the caller's order, or [`NOBODY`].
    pub order: Vec<[u32; BLOCK]>,
    items: Vec<Item>,
}

impl Tree {
    /// Builds the tree over at least one sphere, with moments of `stride` components made by `kernels`.
    ///
    /// `length` and `strength` scale coordinates and masses.
    pub fn build(
        &mut self,
        coordinates: [&[f64]; 3],
        mass: &[f64],
        [length, strength]: [f64; 2],
        kernels: &Kernels,
        stride: usize,
    ) {
        self.items.clear();
        self.items.extend((0..mass.len()).map(|i| Item { at: coordinates.map(|c| c[i] * length), index: i as u32 }));
        self.cells.clear();
        divide(&mut self.items, MAX_GAPS, &mut self.cells);
        let blocks = number_blocks(&mut self.cells);
        self.blocks.clear();
        self.blocks.resize(blocks, Sources::MASSLESS);
        self.order.clear();
        self.order.resize(blocks, [NOBODY; BLOCK]);
        self.moments.clear();
        self.moments.resize(self.cells.len() * stride, 0.0);
        let expand = Expand { kernels, stride, mass, strength };
        expand.cell(Part {
            items: &self.items,
            blocks: &mut self.blocks,
            order: &mut self.order,
            cells: &mut self.cells,
            moments: &mut self.moments,
        });
    }
}

/// Sorts `items` into cells and appends these in depth-first order.
fn divide(items: &mut [Item], gaps: u32, cells: &mut Vec<Cell>) {
    let at = cells.len();
    cells.push(Cell { spheres: items.len() as u32, ..Cell::default() });
    let (low, high) = bounds(items);
    let sides = [0, 1, 2].map(|k| high[k] - low[k]);
    let axis = (1..3).fold(0, |longest, k| if sides[k] > sides[longest] { k } else { longest });
    let gap = if gaps > 0 { gap(items, axis, low[axis], sides[axis]) } else { None };
    let cut = match gap {
        Some(gap) => partition(items, |item| item.at[axis] < gap),
        None if items.len() > LEAF => {
            let cut = (items.len() / 2).next_multiple_of(BLOCK);
            let along = |a: &Item, b: &Item| a.at[axis].total_cmp(&b.at[axis]).then(a.index.cmp(&b.index));
            items.select_nth_unstable_by(cut, along);
            cut
        }
        None => 0,
    };
    if cut > 0 && cut < items.len() {
        let gaps = gaps - u32::from(gap.is_some());
        let parallel = items.len() >= PARALLEL;
        let (left, right) = items.split_at_mut(cut);
        if parallel {
            let mut of_right = Vec::new();
            rayon::join(|| divide(left, gaps, cells), || divide(right, gaps, &mut of_right));
            cells.append(&mut of_right);
        } else {
            divide(left, gaps, cells);
            divide(right, gaps, cells);
        }
    }
    cells[at].cells = (cells.len() - at) as u32;
}

/// Moves the items for which `first` holds to the front and returns their number; keeps the order on both sides.
fn partition(items: &mut [Item], first: impl Fn(&Item) -> bool) -> usize {
    items.sort_by_key(|item| !first(item));
    items.partition_point(first)
}

/// The middle of a gap that crosses the box of `items` from `low` over `side`, if one is wide for their number.
///
/// Two spacings of as many spheres spread evenly over a cube are no gap: between the layers of a lattice lies one.
fn gap(items: &[Item], axis: usize, low: f64, side: f64) -> Option<f64> {
    let per_length = SLICES as f64 / side;
    if !(per_length > 0.0 && per_length.is_finite()) {
        return None;
    }
    let mut taken = 0_u32;
    for item in items {
        taken |= 1 << (((item.at[axis] - low) * per_length) as usize).min(SLICES - 1);
    }
    // The first and the last slice are never empty.
    let (mut widest, mut start, mut run) = (0, 0, 0);
    for slice in 0..SLICES {
        run = if taken >> slice & 1 == 0 { run + 1 } else { 0 };
        if run > widest {
            (widest, start) = (run, slice + 1 - run);
        }
    }
    let spacings = 2.0 * SLICES as f64 / (items.len() as f64).cbrt();
    (widest >= 2 && widest as f64 > spacings).then(|| low + (start as f64 + 0.5 * widest as f64) / per_length)
}

/// Gives each leaf its own blocks, and every cell those of its leaves; returns their number.
fn number_blocks(cells: &mut [Cell]) -> usize {
    let mut next = 0;
    for cell in cells.iter_mut() {
        cell.first = next;
        if cell.is_leaf() {
            next += cell.spheres.div_ceil(BLOCK as u32);
            cell.end = next;
        }
    }
    for at in (0..cells.len()).rev() {
        if !cells[at].is_leaf() {
            cells[at].end = cells[second_child(cells, at)].end;
        }
    }
    next as usize
}

/// The second child of a cell that is not a leaf.
pub(super) fn second_child(cells: &[Cell], at: usize) -> usize {
    at + 1 + cells[at + 1].cells as usize
}

/// What belongs to one cell and all below it.
struct Part<'a> {
    items: &'a [Item],
    blocks: &'a mut [Sources],
    order: &'a mut [[u32; BLOCK]],
    cells: &'a mut [Cell],
    moments: &'a mut [f64],
}

/// The way up: blocks, centres and moments.
struct Expand<'a> {
    kernels: &'a Kernels,
    stride: usize,
    mass: &'a [f64],
    strength: f64,
}

impl Expand<'_> {
    fn cell(&self, part: Part<'_>) {
        let Part { items, blocks, order, cells, moments } = part;
        let (own, below) = cells.split_first_mut().expect("every part has its cell");
        let (own_moments, moments) = moments.split_at_mut(self.stride);
        let (low, high) = bounds(items);
        let mut expansion: Expansion = [0.0; NARROW];
        if below.is_empty() {
            for ((block, order), items) in blocks.iter_mut().zip(order).zip(items.chunks(BLOCK)) {
                for (i, item) in items.iter().enumerate() {
                    (0..3).for_each(|k| block.at[k][i] = item.at[k]);
                    block.strength[i] = self.mass[item.index as usize] * self.strength;
                    order[i] = item.index;
                }
            }
            let spheres = items.iter().map(|item| (self.mass[item.index as usize] * self.strength, item.at));
            (own.strength, own.centre) = balance(spheres, low, high);
            self.kernels.moments(blocks, own.centre, &mut expansion);
        } else {
            let cut = below[0].cells as usize;
            let (left_items, right_items) = items.split_at(below[0].spheres as usize);
            let half = (below[0].end - below[0].first) as usize;
            let (left_blocks, right_blocks) = blocks.split_at_mut(half);
            let (left_order, right_order) = order.split_at_mut(half);
            let (left_cells, right_cells) = below.split_at_mut(cut);
            let (left_moments, right_moments) = moments.split_at_mut(cut * self.stride);
            let left = Part {
                items: left_items,
                blocks: left_blocks,
                order: left_order,
                cells: left_cells,
                moments: left_moments,
            };
            let right = Part {
                items: right_items,
                blocks: right_blocks,
                order: right_order,
                cells: right_cells,
                moments: right_moments,
            };
            if items.len() >= PARALLEL {
                rayon::join(|| self.cell(left), || self.cell(right));
            } else {
                self.cell(left);
                self.cell(right);
            }
            let children = [(&below[0], 0), (&below[cut], cut * self.stride)];
            (own.strength, own.centre) = balance(children.iter().map(|(c, _)| (c.strength, c.centre)), low, high);
            for (child, at) in children {
                let shift = [0, 1, 2].map(|k| child.centre[k] - own.centre[k]);
                self.kernels.shift_moments(&moments[at..at + self.stride], shift, &mut expansion);
            }
        }
        own_moments.copy_from_slice(&expansion[..self.stride]);
        let centre = own.centre;
        let farthest = items.iter().fold(0.0_f64, |farthest, item| {
            let d = [0, 1, 2].map(|k| item.at[k] - centre[k]);
            farthest.max(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
        });
        own.reach = farthest.sqrt();
    }
}

/// Corners of the box around the spheres.
fn bounds(items: &[Item]) -> ([f64; 3], [f64; 3]) {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for item in items {
        for k in 0..3 {
            low[k] = low[k].min(item.at[k]);
            high[k] = high[k].max(item.at[k]);
        }
    }
    (low, high)
}

/// Sum of the strengths and their centre, kept within the box; its middle where nothing has mass.
fn balance(parts: impl Iterator<Item = (f64, [f64; 3])>, low: [f64; 3], high: [f64; 3]) -> (f64, [f64; 3]) {
    let (mut total, mut sum) = (0.0, [0.0; 3]);
    for (strength, at) in parts {
        total += strength;
        (0..3).for_each(|k| sum[k] += strength * at[k]);
    }
    let centre = [0, 1, 2].map(|k| {
        let centre = if total > 0.0 { sum[k] / total } else { 0.5 * (low[k] + high[k]) };
        centre.max(low[k]).min(high[k])
    });
    (total, centre)
}
