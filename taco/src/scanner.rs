//! What hides the sky from one place: a walk through the facets of the mesh from near to far.
//!
//! A disc of the tree is left out when it lies below the observer's plane, faces away, lies between two azimuths of the
//! map, or behind a horizon that already stands higher. So the result is that of all facets, however they are ordered.

use crate::azimuth::{AZIMUTH_PAD, direction, floor, rough_azimuth};
use crate::facets::Facet;
use crate::hidden::{Hidden, kept};
use crate::horizon::Horizon;
use crate::tree::{Node, Occluder, dot, tree};
use std::f64::consts::{PI, TAU};
use tiling::Mesh;

/// What rises by less than this fraction of the body's size, rounded up to a power of two, is in the plane: coplanar
/// neighbours do not shade one another by round-off, and a re-tiling elsewhere does not shift the limit.
const PLANE_TOLERANCE: f64 = 1e-9;
/// A disc that spans more azimuths of the map than this is not compared as a whole; its parts will be.
const WIDEST_SPAN: i64 = 24;
/// A facet in a leaf that spans fewer azimuths than this is tried at all of them.
const NARROW_SPAN: i64 = 4;

/// The facets of a mesh, ready to be looked at from anywhere.
#[derive(Debug)]
pub(crate) struct Scanner {
    pub nodes: Vec<Node>,
    pub occluders: Vec<Occluder>,
    /// Cosine and sine of each azimuth of the map.
    pub azimuths: Vec<[f64; 2]>,
    /// What counts as in the plane, m.
    pub tolerance: f64,
}

/// Buffers of one thread.
#[derive(Debug, Default)]
pub(crate) struct ScanScratch {
    hidden: Hidden,
    stack: Vec<u32>,
}

impl Scanner {
    /// The mesh must have been checked by [`facets`].
    pub fn new(mesh: &Mesh, azimuth_bins: usize) -> Self {
        let (occluders, nodes) = tree(mesh);
        let tolerance = PLANE_TOLERANCE * nodes[0].radius.log2().ceil().exp2();
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
        while let Some(index) = stack.pop() {
            let node = &self.nodes[index as usize];
            let Some(azimuths) = self.visible(node, &axes, &facet.point, |k, bound, _| hidden.ground[k] < bound) else {
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
                        self.hide(&corners, azimuths, hidden);
                    }
                }
            }
        }
        let overhangs = hidden.settle();
        let rises = !overhangs.is_empty() || hidden.ground.iter().any(|t| *t > 0.0);
        rises.then(|| Horizon { overhangs, tan_elevation: hidden.ground.iter().map(|t| kept(*t)).collect() })
    }

    /// Whether any facet may hide sky from somewhere on the observer, a triangle with these corners, however little and
    /// wherever else that sky is hidden already.
    pub fn concerns(&self, facet: &Facet, corners: &[[f64; 3]; 3], scratch: &mut ScanScratch) -> bool {
        let up = facet.horizon_axes()[2];
        let above = |p: &[f64; 3]| (0..3).map(|k| up[k] * (p[k] - facet.point[k])).sum::<f64>();
        let ScanScratch { stack, .. } = scratch;
        stack.clear();
        stack.push(0);
        while let Some(index) = stack.pop() {
            let node = &self.nodes[index as usize];
            if above(&node.centre) + node.radius <= 0.0 {
                continue;
            }
            if node.facets == 0 {
                stack.extend([node.at, index + 1]);
                continue;
            }
            let occluders = &self.occluders[node.at as usize..(node.at + node.facets) as usize];
            // Whether it faces a place is linear in the place, so what faces no corner faces nothing between them.
            let faces = |o: &Occluder| {
                dot(&o.normal, &facet.point) > o.offset || corners.iter().any(|c| dot(&o.normal, c) > o.offset)
            };
            if occluders.iter().any(|o| o.corners.iter().any(|c| above(c) > 0.0) && faces(o)) {
                return true;
            }
        }
        false
    }

    /// The azimuths of the map that the node covers (all if it is wide) if it may matter at any of them, else `None`: seen
    /// from `point` with the axes north, west and up. `matters` is asked with an azimuth, the tangent of an elevation that
    /// the node does not exceed and a horizontal distance that it is not nearer than, m.
    #[inline]
    pub fn visible(
        &self,
        node: &Node,
        axes: &[[f64; 3]; 3],
        point: &[f64; 3],
        matters: impl Fn(usize, f64, f64) -> bool,
    ) -> Option<(i64, i64)> {
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
        let nearest = distance - node.radius;
        let bound = top / nearest;
        (first..=last).any(|k| matters(self.wrap(k), bound, nearest)).then_some((first, last))
    }

    /// The azimuths of the map, not yet wrapped into it, that may cut a facet with these corners (north, west, up from the
    /// observer) in a leaf that covers `azimuths`.
    #[inline]
    pub fn tried(&self, corners: &[[f64; 3]; 3], azimuths: (i64, i64)) -> (i64, i64) {
        if azimuths.1 - azimuths.0 < NARROW_SPAN { azimuths } else { self.azimuths_of(corners) }
    }

    /// Hides the sky behind a facet with these corners (north, west, up from the observer), which lies within `azimuths`.
    fn hide(&self, corners: &[[f64; 3]; 3], azimuths: (i64, i64), hidden: &mut Hidden) {
        let (first, last) = self.tried(corners, azimuths);
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
    pub fn wrap(&self, k: i64) -> usize {
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

/// Where the plane of an azimuth cuts a facet: distance along the azimuth and height of the nearer and the farther end, or
/// `None` if the half-plane misses it. The nearer end may lie on the other side of the observer.
#[inline]
pub(crate) fn cut(corners: &[[f64; 3]; 3], [c, s]: [f64; 2]) -> Option<[[f64; 2]; 2]> {
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
    (far[0] > 0.0).then_some([near, far])
}

/// Tangents of the elevations between which the half-plane of an azimuth cuts a facet, or `None` if it misses it.
#[inline]
fn interval(corners: &[[f64; 3]; 3], azimuth: [f64; 2]) -> Option<(f64, f64)> {
    let [near, far] = cut(corners, azimuth)?;
    let t = far[1] / far[0];
    if near[0] > 0.0 {
        let u = near[1] / near[0];
        return Some((t.min(u), t.max(u)));
    }
    // The cut goes on to the vertical through the observer: overhead or underfoot.
    let at_axis = near[1] * far[0] - far[1] * near[0];
    Some(if at_axis > 0.0 { (t, f64::INFINITY) } else { (f64::NEG_INFINITY, t) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::facets::facets;
    use crate::test_bodies::rugged;

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
}
