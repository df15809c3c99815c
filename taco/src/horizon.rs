//! Horizons: which part of the sky the rest of the body hides from each facet, azimuth by azimuth.
//!
//! Concept of Statler 2009 (Icarus 202, 502), without rays. The half-plane of an azimuth cuts every facet that faces the
//! observer in an interval of elevations; their union is what is hidden, exactly, at that azimuth. The interval that
//! begins at the ground is the horizon; what hides the sky above a gap (a boulder that leans over) is kept as well.
//!
//! The facets lie in a tree of flat bounding discs, walked from near to far; a disc is left out when it lies below the
//! observer's plane, between two azimuths of the map, or behind a horizon that already stands higher. So the result is
//! that of all facets, however they were ordered.

use crate::error::{TacoError, require};
use crate::facets::{Facet, facets};
use rayon::prelude::*;
use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};
use tiling::Mesh;

/// Facets in a leaf of the tree.
const LEAF: usize = 4;
/// What rises by less than this fraction of the body's size is in the plane: coplanar neighbours do not shade one
/// another by round-off.
const PLANE_TOLERANCE: f64 = 1e-9;
/// Intervals of elevation (tangents) closer than this times 1 + tangent touch.
const TOUCHING: f64 = 1e-9;
/// What [`rough_azimuth`] may be off by, rad, with room to spare.
const AZIMUTH_PAD: f64 = 1e-4;
/// A disc that spans more azimuths of the map than this is not compared as a whole; its parts will be.
const WIDEST_SPAN: i64 = 24;
/// A facet in a leaf that spans fewer azimuths than this is tried at all of them.
const NARROW_SPAN: i64 = 4;
/// Steepest tangent that is kept (90 deg less 0.2 arc seconds); stands for the zenith.
pub(crate) const STEEPEST: f64 = 1e6;

/// Horizons of all facets of a mesh, seen from their centroids.
#[derive(Debug, Clone, PartialEq)]
pub struct HorizonMap {
    azimuth_bins: usize,
    /// `None` for a facet above whose plane nothing rises.
    horizons: Vec<Option<Horizon>>,
}

/// What hides the sky from one place.
#[derive(Debug, Clone, PartialEq)]
pub struct Horizon {
    /// Tangent of the elevation up to which the sky is hidden, >= 0, at azimuths `2 pi k / n`.
    pub tan_elevation: Box<[f32]>,
    /// What hides the sky above a gap, by azimuth and from below; empty for nearly all facets of real bodies.
    pub overhangs: Box<[Overhang]>,
}

/// Part of the sky hidden by something that leans over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overhang {
    /// Index of the azimuth.
    pub azimuth: u32,
    /// Tangents of the lowest and highest hidden elevation.
    pub tan_elevation: [f32; 2],
}

impl Horizon {
    /// The same horizon at half as many azimuths.
    pub(crate) fn every_other(&self) -> Self {
        let even = self.overhangs.iter().filter(|o| o.azimuth % 2 == 0);
        Self {
            tan_elevation: self.tan_elevation.iter().copied().step_by(2).collect(),
            overhangs: even.map(|o| Overhang { azimuth: o.azimuth / 2, ..*o }).collect(),
        }
    }
}

impl HorizonMap {
    /// The map at `azimuth_bins` evenly spaced azimuths, from north (the spin axis, +z) over west.
    ///
    /// # Errors
    /// [`TacoError`] if the mesh is empty or broken, or `azimuth_bins` is not a multiple of 8 in [16, 2880].
    pub fn new(mesh: &Mesh, azimuth_bins: usize) -> Result<Self, TacoError> {
        let ok = azimuth_bins.is_multiple_of(8) && (16..=2880).contains(&azimuth_bins);
        require(ok, "azimuth_bins", azimuth_bins as f64, "a multiple of 8 in [16, 2880]")?;
        let facets = facets(mesh)?;
        Ok(Self::of(&facets, &Scanner::new(mesh, azimuth_bins)))
    }

    pub(crate) fn of(facets: &[Facet], scanner: &Scanner) -> Self {
        let look = |scratch: &mut ScanScratch, facet| scanner.horizon(facet, scratch);
        let horizons = facets.par_iter().map_init(ScanScratch::default, look).collect();
        Self { azimuth_bins: scanner.azimuths.len(), horizons }
    }

    /// Number of azimuths.
    pub fn azimuth_bins(&self) -> usize {
        self.azimuth_bins
    }

    /// The horizon of a facet; `None` where nothing rises above its plane (or there is no such facet).
    pub fn horizon(&self, facet: usize) -> Option<&Horizon> {
        self.horizons.get(facet)?.as_ref()
    }

    /// How many facets have something above their plane; 0 for a convex mesh.
    pub fn shaded_facets(&self) -> usize {
        self.horizons.iter().flatten().count()
    }
}

/// Disc around a run of facets.
#[derive(Debug, Clone, Copy)]
struct Node {
    centre: [f64; 3],
    radius: f64,
    /// Mean normal of the facets; zero if they cancel.
    normal: [f64; 3],
    /// Largest distance of a corner from the disc's plane, m.
    thickness: f64,
    /// Cosine and sine of the largest angle between `normal` and a facet's; 0 and 1 for any angle beyond 90 deg.
    spread: [f64; 2],
    /// Largest height of the centre above the plane of a facet, m.
    behind: f64,
    /// First facet of a leaf; the second child of an inner node, whose first child follows it in the array.
    at: u32,
    /// Facets of a leaf, 0 for an inner node.
    facets: u32,
    /// Coordinate that tells an inner node's children apart; the first child has the smaller ones.
    axis: usize,
}

impl Node {
    /// Whether no facet faces an observer from whom the centre is this far `away`, m.
    #[inline]
    fn faces_away(&self, away: &[f64; 3]) -> bool {
        let along = dot(&self.normal, away);
        if along <= 0.0 {
            return false;
        }
        // The highest that the observer can stand above a plane through the centre with a normal of the spread.
        let aside = (dot(away, away) - along * along).max(0.0).sqrt();
        aside * self.spread[1] - along * self.spread[0] + self.behind <= 0.0
    }
}

/// A facet with its plane: `normal . x > offset` on the side that it faces.
#[derive(Debug, Clone, Copy)]
struct Occluder {
    corners: [[f64; 3]; 3],
    normal: [f64; 3],
    offset: f64,
}

/// The facets of a mesh, ready to be looked at from anywhere.
#[derive(Debug)]
pub(crate) struct Scanner {
    nodes: Vec<Node>,
    occluders: Vec<Occluder>,
    /// Cosine and sine of each azimuth of the map.
    azimuths: Vec<[f64; 2]>,
    /// What counts as in the plane, m.
    tolerance: f64,
}

/// Buffers of one thread.
#[derive(Debug, Default)]
pub(crate) struct ScanScratch {
    hidden: Hidden,
    stack: Vec<u32>,
}

/// What is known to be hidden while facets are still coming in, as tangents of elevations.
#[derive(Debug, Default)]
struct Hidden {
    /// Hidden from the ground up to here, at each azimuth.
    ground: Vec<f64>,
    /// The lowest interval that did not touch the ground when it was found; empty (infinite, zero) if there is none.
    lowest: Vec<[f64; 2]>,
    /// Further such intervals, by azimuth.
    floating: Vec<(usize, f64, f64)>,
}

impl Hidden {
    fn reset(&mut self, azimuths: usize) {
        self.ground.clear();
        self.ground.resize(azimuths, 0.0);
        self.lowest.clear();
        self.lowest.resize(azimuths, NOTHING);
        self.floating.clear();
    }

    /// Adds an interval. Most float only until the facet below them comes in.
    #[inline]
    fn add(&mut self, k: usize, low: f64, high: f64) {
        let (ground, lowest) = (&mut self.ground[k], &mut self.lowest[k]);
        if high <= *ground {
            return;
        }
        if low <= touching(*ground) {
            *ground = high;
            if lowest[0] <= touching(high) {
                *ground = high.max(lowest[1]);
                *lowest = NOTHING;
            }
        } else if low <= touching(lowest[1]) && lowest[0] <= touching(high) {
            *lowest = [low.min(lowest[0]), high.max(lowest[1])];
        } else if lowest[1] == 0.0 {
            *lowest = [low, high];
        } else {
            let upper = if low < lowest[0] { std::mem::replace(lowest, [low, high]) } else { [low, high] };
            self.floating.push((k, upper[0], upper[1]));
        }
    }

    /// Joins floating intervals to the ground where something found later bridged the gap; what is left leans over.
    fn settle(&mut self) -> Box<[Overhang]> {
        let Self { ground, lowest, floating } = self;
        floating.extend((0..).zip(lowest).filter(|(_, l)| l[1] > 0.0).map(|(k, l)| (k, l[0], l[1])));
        floating.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.total_cmp(&b.2)));
        let mut overhangs: Vec<(usize, f64, f64)> = Vec::new();
        for &(k, low, high) in &*floating {
            if low <= touching(ground[k]) {
                ground[k] = ground[k].max(high);
                continue;
            }
            match overhangs.last_mut() {
                Some(last) if last.0 == k && low <= touching(last.2) => last.2 = last.2.max(high),
                _ => overhangs.push((k, low, high)),
            }
        }
        let overhang =
            |(k, low, high): (usize, f64, f64)| Overhang { azimuth: k as u32, tan_elevation: [kept(low), kept(high)] };
        overhangs.into_iter().map(overhang).collect()
    }
}

/// No interval.
const NOTHING: [f64; 2] = [f64::INFINITY, 0.0];

/// The end of an interval, a hair further: neighbouring facets meet to round-off.
fn touching(end: f64) -> f64 {
    end + TOUCHING * (1.0 + end)
}

/// A tangent as the map keeps it.
fn kept(tan_elevation: f64) -> f32 {
    tan_elevation.min(STEEPEST) as f32
}

impl Scanner {
    /// The mesh must have been checked by [`facets`].
    pub fn new(mesh: &Mesh, azimuth_bins: usize) -> Self {
        let mut occluders: Vec<_> = (0..mesh.facets.len())
            .map(|f| {
                let corners = mesh.corners(f);
                let normal = mesh.area_vector(f);
                let offset = normal.dot(&corners[0]);
                Occluder { corners: corners.map(Into::into), normal: normal.into(), offset }
            })
            .collect();
        let mut nodes = Vec::with_capacity(occluders.len());
        build(&mut occluders, 0, &mut nodes);
        let tolerance = PLANE_TOLERANCE * nodes[0].radius;
        let azimuths = (0..azimuth_bins).map(|k| direction(k, azimuth_bins)).collect();
        Self { nodes, occluders, azimuths, tolerance }
    }

    /// What hides the sky from a point of the surface, or `None` if nothing rises above its plane.
    pub fn horizon(&self, facet: &Facet, scratch: &mut ScanScratch) -> Option<Horizon> {
        let axes = facet.horizon_axes();
        let local = |p: &[f64; 3]| {
            let d = [p[0] - facet.point[0], p[1] - facet.point[1], p[2] - facet.point[2]];
            axes.map(|a| dot(&a, &d))
        };
        let ScanScratch { hidden, stack } = scratch;
        hidden.reset(self.azimuths.len());
        stack.clear();
        stack.push(0);
        let mut rises = false;
        while let Some(index) = stack.pop() {
            let node = &self.nodes[index as usize];
            let Some(azimuths) = self.visible(node, &axes, &facet.point, &hidden.ground) else {
                continue;
            };
            if node.facets == 0 {
                let (left, right) = (index + 1, node.at);
                // What is popped first is near and raises the horizon that hides the rest.
                let near_left = facet.point[node.axis] <= node.centre[node.axis];
                stack.extend(if near_left { [right, left] } else { [left, right] });
                continue;
            }
            for occluder in &self.occluders[node.at as usize..(node.at + node.facets) as usize] {
                if dot(&occluder.normal, &facet.point) > occluder.offset {
                    let corners = occluder.corners.each_ref().map(local);
                    if corners.iter().any(|c| c[2] > self.tolerance) {
                        rises = true;
                        self.hide(&corners, azimuths, hidden);
                    }
                }
            }
        }
        rises.then(|| Horizon {
            overhangs: hidden.settle(),
            tan_elevation: hidden.ground.iter().map(|t| kept(*t)).collect(),
        })
    }

    /// The azimuths of the map at which the node may hide more sky (all if it is wide), or `None` if it cannot: seen from
    /// `point` with the axes north, west and up.
    #[inline]
    fn visible(&self, node: &Node, axes: &[[f64; 3]; 3], point: &[f64; 3], ground: &[f64]) -> Option<(i64, i64)> {
        let all = Some((0, self.azimuths.len() as i64 - 1));
        let away: [f64; 3] = std::array::from_fn(|k| node.centre[k] - point[k]);
        let z = dot(&axes[2], &away);
        if z + node.radius <= self.tolerance {
            return None;
        }
        let tilt = dot(&axes[2], &node.normal);
        let flat = node.radius * (1.0 - tilt * tilt).max(0.0).sqrt() + node.thickness * tilt.abs();
        let top = z + flat.min(node.radius);
        if top <= self.tolerance || node.faces_away(&away) {
            return None;
        }
        let (x, y) = (dot(&axes[0], &away), dot(&axes[1], &away));
        let distance = (x * x + y * y).sqrt();
        if distance <= node.radius * 1.001 {
            return all;
        }
        // asin s <= s + (pi/2 - 1) s^3 on [0, 1].
        let s = node.radius / distance;
        let half_width = s * (1.0 + (0.5 * PI - 1.0) * s * s) + AZIMUTH_PAD;
        let azimuth = rough_azimuth(x, y);
        let (first, last) = self.span(azimuth - half_width, azimuth + half_width);
        if last - first > WIDEST_SPAN {
            return all;
        }
        let bound = top / (distance - node.radius);
        (first..=last).any(|k| ground[self.wrap(k)] < bound).then_some((first, last))
    }

    /// Hides the sky behind a facet with these corners (north, west, up from the observer), which lies within `azimuths`.
    fn hide(&self, corners: &[[f64; 3]; 3], azimuths: (i64, i64), hidden: &mut Hidden) {
        let narrow = azimuths.1 - azimuths.0 < NARROW_SPAN;
        let (first, last) = if narrow { azimuths } else { self.azimuths_of(corners) };
        for k in first..=last {
            let k = self.wrap(k);
            if let Some((low, high)) = interval(corners, self.azimuths[k]) {
                hidden.add(k, low, high);
            }
        }
    }

    /// First and last azimuth of the map that a facet may meet.
    fn azimuths_of(&self, corners: &[[f64; 3]; 3]) -> (i64, i64) {
        let from = rough_azimuth(corners[0][0], corners[0][1]);
        let turn = |c: &[f64; 3]| {
            let d = rough_azimuth(c[0], c[1]) - from;
            if d > PI {
                d - TAU
            } else if d < -PI {
                d + TAU
            } else {
                d
            }
        };
        let (b, c) = (turn(&corners[1]), turn(&corners[2]));
        let (low, high) = (b.min(c).min(0.0), b.max(c).max(0.0));
        if high - low > PI - 2.0 * AZIMUTH_PAD {
            // Overhead, underfoot or nearly so: any azimuth may meet it.
            (0, self.azimuths.len() as i64 - 1)
        } else {
            self.span(from + low - AZIMUTH_PAD, from + high + AZIMUTH_PAD)
        }
    }

    /// First and last azimuth of the map within `from..=to`, rad, not yet wrapped into the map.
    #[inline]
    fn span(&self, from: f64, to: f64) -> (i64, i64) {
        let per_radian = self.azimuths.len() as f64 / TAU;
        (-floor(-from * per_radian), floor(to * per_radian))
    }

    /// Index into the map of an azimuth counted from north, less than two turns off.
    #[inline]
    fn wrap(&self, k: i64) -> usize {
        let n = self.azimuths.len() as i64;
        (if k < 0 {
            k + n
        } else if k >= n {
            k - n
        } else {
            k
        }) as usize
    }
}

/// Tangents of the elevations between which the half-plane of an azimuth cuts a facet, or `None` if it misses it.
#[inline]
fn interval(corners: &[[f64; 3]; 3], [c, s]: [f64; 2]) -> Option<(f64, f64)> {
    // Distance from the half-plane's vertical plane, and distance along it.
    let aside = corners.map(|p| p[0] * s - p[1] * c);
    let along = corners.map(|p| p[0] * c + p[1] * s);
    let mut cuts = [[0.0; 2]; 2];
    let mut count = 0;
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        if (aside[i] >= 0.0) != (aside[j] >= 0.0) && count < 2 {
            let (wi, wj) = (aside[j].abs(), aside[i].abs());
            let whole = wi + wj;
            cuts[count] = [(along[i] * wi + along[j] * wj) / whole, (corners[i][2] * wi + corners[j][2] * wj) / whole];
            count += 1;
        }
    }
    if count < 2 {
        return None;
    }
    let [near, far] = if cuts[0][0] <= cuts[1][0] { cuts } else { [cuts[1], cuts[0]] };
    if far[0] <= 0.0 {
        return None;
    }
    let t = far[1] / far[0];
    if near[0] > 0.0 {
        let u = near[1] / near[0];
        return Some((t.min(u), t.max(u)));
    }
    // The cut goes on to the vertical through the observer: overhead or underfoot.
    let at_axis = near[1] * far[0] - far[1] * near[0];
    Some(if at_axis > 0.0 { (t, f64::INFINITY) } else { (f64::NEG_INFINITY, t) })
}

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
fn floor(x: f64) -> i64 {
    let truncated = x as i64;
    truncated - i64::from((truncated as f64) > x)
}

fn square_distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum()
}

#[inline(always)]
fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Sorts `occluders`, the slice that starts at number `offset`, into a tree that is appended to `nodes`.
fn build(occluders: &mut [Occluder], offset: usize, nodes: &mut Vec<Node>) {
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    let mut normal = [0.0; 3];
    for occluder in &*occluders {
        for k in 0..3 {
            for corner in &occluder.corners {
                low[k] = low[k].min(corner[k]);
                high[k] = high[k].max(corner[k]);
            }
            normal[k] += occluder.normal[k];
        }
    }
    let centre: [f64; 3] = std::array::from_fn(|k| 0.5 * (low[k] + high[k]));
    let length = dot(&normal, &normal).sqrt();
    normal = if length > 0.0 { normal.map(|c| c / length) } else { [0.0; 3] };
    let corners = || occluders.iter().flat_map(|o| &o.corners);
    let off_plane = |p: &[f64; 3]| (0..3).map(|k| normal[k] * (p[k] - centre[k])).sum::<f64>().abs();
    // A hair larger than it is, so that round-off cannot put a corner outside.
    let radius = corners().map(|p| square_distance(p, &centre)).fold(0.0, f64::max).sqrt() * (1.0 + 1e-12);
    let thickness = corners().map(off_plane).fold(0.0, f64::max) + 1e-12 * radius;
    let mut cosine = 1.0f64;
    let mut behind = 0.0f64;
    for occluder in &*occluders {
        let length = dot(&occluder.normal, &occluder.normal).sqrt();
        // A facet without area faces nobody.
        if length > 0.0 {
            cosine = cosine.min(dot(&normal, &occluder.normal) / length);
            behind = behind.max((dot(&occluder.normal, &centre) - occluder.offset) / length);
        }
    }
    let spread = if cosine > 0.0 { [cosine, (1.0 - cosine * cosine).max(0.0).sqrt()] } else { [0.0, 1.0] };
    // The same hair as above.
    let behind = behind + 1e-12 * radius;
    let index = nodes.len();
    nodes.push(Node {
        centre,
        radius,
        normal,
        thickness,
        spread,
        behind,
        at: offset as u32,
        facets: occluders.len() as u32,
        axis: 0,
    });
    if occluders.len() <= LEAF {
        return;
    }
    let axis = (0..3).max_by(|&i, &j| (high[i] - low[i]).total_cmp(&(high[j] - low[j]))).expect("three axes");
    let middle = occluders.len() / 2;
    let place = |o: &Occluder| o.corners.iter().map(|c| c[axis]).sum::<f64>();
    occluders.select_nth_unstable_by(middle, |a, b| place(a).total_cmp(&place(b)));
    let (left, right) = occluders.split_at_mut(middle);
    build(left, offset, nodes);
    let second = nodes.len() as u32;
    build(right, offset + middle, nodes);
    nodes[index] = Node { at: second, facets: 0, axis, ..nodes[index] };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_bodies::{blocked, cuboid, rugged};

    #[test]
    fn hidden_sky_is_where_rays_are_blocked() {
        let mesh = rugged(200);
        let bins = 40;
        let map = HorizonMap::new(&mesh, bins).unwrap();
        let (mut lit, mut dark, mut overhung) = (0, 0, 0);
        for (f, facet) in facets(&mesh).unwrap().iter().enumerate() {
            let horizon = map.horizon(f);
            overhung += usize::from(horizon.is_some_and(|h| !h.overhangs.is_empty()));
            let [north, west, up] = facet.horizon_axes();
            for k in 0..bins {
                let [c, s] = direction(k, bins);
                for elevation in [0.02f64, 0.11, 0.3, 0.62, 1.0, 1.4] {
                    let t = elevation.tan();
                    let towards = std::array::from_fn(|i| c * north[i] + s * west[i] + t * up[i]);
                    let hidden = horizon.is_some_and(|h| {
                        let over = |o: &Overhang| {
                            let [low, high] = o.tan_elevation.map(f64::from);
                            o.azimuth as usize == k && low < t && t < high
                        };
                        f64::from(h.tan_elevation[k]) > t || h.overhangs.iter().any(over)
                    });
                    assert_eq!(hidden, blocked(&mesh, facet.point, towards, f), "facet {f}, azimuth {k}, {elevation}");
                    if hidden { dark += 1 } else { lit += 1 }
                }
            }
        }
        assert!(lit > 10_000 && dark > 10_000 && overhung > 10, "{lit} {dark} {overhung}");
    }

    #[test]
    fn what_the_tree_leaves_out_changes_nothing() {
        let mesh = rugged(300);
        let facets = facets(&mesh).unwrap();
        let scanner = Scanner::new(&mesh, 64);
        for facet in &facets {
            let axes = facet.horizon_axes();
            let mut all = Hidden::default();
            all.reset(64);
            for occluder in &scanner.occluders {
                let corners = occluder.corners.map(|p| {
                    let d = std::array::from_fn(|k| p[k] - facet.point[k]);
                    axes.map(|a| dot(&a, &d))
                });
                let faces = dot(&occluder.normal, &facet.point) > occluder.offset;
                if faces && corners.iter().any(|c| c[2] > scanner.tolerance) {
                    scanner.hide(&corners, (0, 63), &mut all);
                }
            }
            let overhangs = all.settle();
            match scanner.horizon(facet, &mut ScanScratch::default()) {
                None => assert!(all.ground.iter().all(|t| *t == 0.0) && overhangs.is_empty()),
                Some(horizon) => {
                    for (a, b) in all.ground.iter().zip(&horizon.tan_elevation) {
                        assert!((kept(*a) - b).abs() <= 1e-6 * (1.0 + b), "{a} {b}");
                    }
                    assert_eq!(overhangs.len(), horizon.overhangs.len());
                }
            }
        }
    }

    #[test]
    fn convex_bodies_have_no_horizon_not_even_by_round_off() {
        let mut cube = Mesh::default();
        cuboid(&mut cube, [-1.0, -2.0, -3.0], [1.0, 2.0, 3.0]);
        let turn = nalgebra::Rotation3::from_euler_angles(0.3, 1.1, -0.7);
        for mesh in [cube.rotated(turn.matrix()), tiling::fibonacci::unit_sphere(500).unwrap()] {
            assert_eq!(HorizonMap::new(&mesh, 32).unwrap().shaded_facets(), 0);
        }
    }

    /// From the floor at a distance d before a wall of height H, tan h = H cos az / d.
    #[test]
    fn wall_stands_as_high_as_its_distance_says() {
        let mut mesh = Mesh::default();
        cuboid(&mut mesh, [-50.0, -50.0, -1.0], [50.0, 50.0, 0.0]);
        cuboid(&mut mesh, [-50.0, 10.0, 0.0], [50.0, 11.0, 4.0]);
        let floor = (0..mesh.facets.len()).find(|f| mesh.normal(*f).z > 0.9 && mesh.centroid(*f).z == 0.0).unwrap();
        let point = mesh.centroid(floor);
        let map = HorizonMap::new(&mesh, 360).unwrap();
        let horizon = map.horizon(floor).unwrap();
        // A facet that looks along the spin axis has its azimuths from -x, over -y.
        let distance = 10.0 - point.y;
        for az_deg in [245usize, 270, 290] {
            let expected = 4.0 * (az_deg as f64).to_radians().sin().abs() / distance;
            assert!((f64::from(horizon.tan_elevation[az_deg]) - expected).abs() < 1e-6);
        }
        assert_eq!(horizon.tan_elevation[90], 0.0);
        assert!(horizon.overhangs.is_empty());
    }

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
