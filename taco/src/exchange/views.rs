//! View factors: how the light that leaves a facet is divided among the facets that it sees.
//!
//! Rays are not needed. The half-plane of an azimuth cuts the facets before the observer in segments; going up in
//! elevation, the nearest segment is what is seen, and between two elevations a Lambert emitter sends the fraction
//! `daz / 2 pi (sin^2 h_2 - sin^2 h_1)` of its light there. So the fractions of a facet and the open sky add up to 1 to
//! round-off, near facets need no subdivision, and what stands in front of what is exact. The sampling in azimuth is that of
//! the horizon map: a facet narrower than its step is seen now by one azimuth, now by none, which averages out over its
//! neighbours.

use crate::facets::Facet;
use crate::hidden::Hidden;
use crate::horizon::{Horizon, HorizonMap};
use crate::scanner::{Scanner, cut};
use crate::sky::sky_view;
use crate::tree::dot;
use rayon::prelude::*;

/// A facet as seen by another one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Seen {
    pub facet: u32,
    /// Fraction of the observer's light that goes there: by all azimuths of the map, and by every other one.
    pub fractions: [f32; 2],
}

/// What each facet of a body sees of the others, in ascending order of facets; nothing where nothing rises above its plane.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Views {
    pub rows: Vec<Box<[Seen]>>,
}

impl Views {
    pub fn new(facets: &[Facet], scanner: &Scanner, map: &HorizonMap) -> Self {
        let look = |eye: &mut Eye, f: usize| {
            map.horizon(f).map_or_else(Box::default, |horizon| eye.look(scanner, &facets[f], horizon))
        };
        let rows = (0..facets.len()).into_par_iter().map_init(|| Eye::new(scanner, facets.len()), look).collect();
        Self { rows }
    }
}

/// Part of a facet in the half-plane of an azimuth.
#[derive(Debug, Clone, Copy)]
struct Segment {
    facet: u32,
    /// Tangents of the lowest and highest elevation above the observer's plane.
    low: f64,
    high: f64,
    /// Distance along the azimuth and height of its ends, m.
    ends: [[f64; 2]; 2],
}

impl Segment {
    fn new(facet: u32, [near, far]: [[f64; 2]; 2]) -> Option<Self> {
        let t = far[1] / far[0];
        if near[0] > 0.0 {
            let u = near[1] / near[0];
            return Some(Self { facet, low: t.min(u).max(0.0), high: t.max(u), ends: [near, far] });
        }
        // It goes on to the vertical through the observer: overhead, or underfoot.
        let at_axis = (near[1] * far[0] - far[1] * near[0]) / (far[0] - near[0]);
        let ends = [[0.0, at_axis], far];
        let (low, high) = if at_axis > 0.0 { (t.max(0.0), f64::INFINITY) } else { (0.0, t) };
        Some(Self { facet, low, high, ends })
    }

    /// Distance along the azimuth at which a line of this elevation meets it.
    fn distance(&self, tan_elevation: f64) -> f64 {
        let [[a, u], [b, v]] = self.ends;
        let along = (tan_elevation * a - u) / ((v - u) - tan_elevation * (b - a));
        a + along * (b - a)
    }
}

/// Buffers of one thread.
struct Eye {
    hidden: Hidden,
    /// Horizontal distance of the farthest that hides something, by azimuth, m.
    reach: Vec<f64>,
    stack: Vec<u32>,
    segments: Vec<Vec<Segment>>,
    edges: Vec<f64>,
    active: Vec<Segment>,
    /// Fractions by facet, zero between looks, and which of them are not.
    shares: Vec<[f64; 2]>,
    touched: Vec<u32>,
}

impl Eye {
    fn new(scanner: &Scanner, facets: usize) -> Self {
        let azimuths = scanner.azimuths.len();
        Self {
            hidden: Hidden::default(),
            reach: vec![0.0; azimuths],
            stack: Vec::new(),
            segments: vec![Vec::new(); azimuths],
            edges: Vec::new(),
            active: Vec::new(),
            shares: vec![[0.0; 2]; facets],
            touched: Vec::new(),
        }
    }

    /// What the facet sees; its fractions add up to what the horizon hides of the sky.
    fn look(&mut self, scanner: &Scanner, facet: &Facet, horizon: &Horizon) -> Box<[Seen]> {
        self.collect(scanner, facet);
        let n = scanner.azimuths.len();
        for k in 0..n {
            self.divide(k, 1.0 / n as f64);
        }
        self.touched.sort_unstable();
        let sum = |c: usize| self.touched.iter().map(|f| self.shares[*f as usize][c]).sum::<f64>();
        let hidden = [1.0 - sky_view(horizon).escaping, 1.0 - sky_view(&horizon.every_other()).escaping];
        let scale: [f64; 2] = std::array::from_fn(|c| {
            let sum = sum(c);
            if sum > 0.0 { hidden[c] / sum } else { 0.0 }
        });
        let seen = |&facet: &u32| {
            let shares = &self.shares[facet as usize];
            Seen { facet, fractions: std::array::from_fn(|c| (scale[c] * shares[c]) as f32) }
        };
        let row = self.touched.iter().map(seen).collect();
        self.touched.drain(..).for_each(|f| self.shares[f as usize] = [0.0; 2]);
        row
    }

    /// Finds the segments in each half-plane, leaving out most of what is behind something else.
    fn collect(&mut self, scanner: &Scanner, facet: &Facet) {
        let Self { hidden, reach, stack, segments, .. } = self;
        let axes = facet.horizon_axes();
        let local = |p: &[f64; 3]| {
            let d = [p[0] - facet.point[0], p[1] - facet.point[1], p[2] - facet.point[2]];
            axes.map(|a| dot(&a, &d))
        };
        hidden.reset(scanner.azimuths.len());
        reach.fill(0.0);
        segments.iter_mut().for_each(Vec::clear);
        stack.clear();
        stack.push(0);
        while let Some(index) = stack.pop() {
            let node = &scanner.nodes[index as usize];
            let matters = |k: usize, bound, nearest| hidden.ground[k] < bound || nearest < reach[k];
            let Some(azimuths) = scanner.visible(node, &axes, &facet.point, matters) else {
                continue;
            };
            if node.facets == 0 {
                let (left, right) = (index + 1, node.at);
                // What is popped first is near and hides the rest.
                let near_left = facet.point[node.axis] <= node.centre[node.axis];
                stack.extend(if near_left { [right, left] } else { [left, right] });
                continue;
            }
            for occluder in &scanner.occluders[node.at as usize..(node.at + node.facets) as usize] {
                if dot(&occluder.normal, &facet.point) <= occluder.offset {
                    continue;
                }
                let corners = occluder.corners.each_ref().map(local);
                if corners.iter().all(|c| c[2] <= scanner.tolerance) {
                    continue;
                }
                let (first, last) = scanner.tried(&corners, azimuths);
                for k in (first..=last).map(|k| scanner.wrap(k)) {
                    let cut = cut(&corners, scanner.azimuths[k]);
                    let Some(segment) = cut.and_then(|ends| Segment::new(occluder.facet, ends)) else {
                        continue;
                    };
                    let behind = hidden.ground[k] >= segment.high && segment.ends[0][0] >= reach[k];
                    if segment.high > segment.low && !behind {
                        hidden.add(k, segment.low, segment.high);
                        reach[k] = reach[k].max(segment.ends[1][0]);
                        segments[k].push(segment);
                    }
                }
            }
        }
    }

    /// Divides the elevations of one azimuth among the nearest segments.
    fn divide(&mut self, azimuth: usize, weight: f64) {
        let Self { segments, edges, active, shares, touched, .. } = self;
        let segments = &mut segments[azimuth];
        segments.sort_unstable_by(|a, b| a.low.total_cmp(&b.low).then(a.facet.cmp(&b.facet)));
        edges.clear();
        edges.extend(segments.iter().flat_map(|s| [s.low, s.high]));
        edges.sort_unstable_by(f64::total_cmp);
        active.clear();
        let mut next = 0;
        for pair in edges.windows(2) {
            let &[from, to] = pair else { continue };
            if to <= from {
                continue;
            }
            while next < segments.len() && segments[next].low <= from {
                active.push(segments[next]);
                next += 1;
            }
            active.retain(|s| s.high > from);
            // Segments of a proper mesh do not cross, so one elevation between the edges tells which is in front.
            let middle = if to < f64::INFINITY { 0.5 * (from + to) } else { 1.0 + 2.0 * from };
            let by_distance = |a: &&Segment, b: &&Segment| a.distance(middle).total_cmp(&b.distance(middle));
            if let Some(nearest) = active.iter().min_by(by_distance) {
                let share = &mut shares[nearest.facet as usize];
                if share[0] == 0.0 {
                    touched.push(nearest.facet);
                }
                let fraction = weight * (sin2(to) - sin2(from));
                share[0] += fraction;
                if azimuth.is_multiple_of(2) {
                    share[1] += 2.0 * fraction;
                }
            }
        }
    }
}

/// Squared sine of an elevation, from its tangent.
fn sin2(tan: f64) -> f64 {
    if tan < 1.0 { tan * tan / (1.0 + tan * tan) } else { 1.0 / (1.0 + 1.0 / (tan * tan)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::facets::facets;
    use crate::test_bodies::{cuboid, first_hit, rugged};
    use std::f64::consts::TAU;
    use tiling::Mesh;

    fn views(mesh: &Mesh, azimuths: usize) -> (Vec<Facet>, HorizonMap, Views) {
        let facets = facets(mesh).unwrap();
        let scanner = Scanner::new(mesh, azimuths);
        let map = HorizonMap::of(&facets, &scanner);
        let views = Views::new(&facets, &scanner, &map);
        (facets, map, views)
    }

    #[test]
    fn fractions_and_open_sky_add_up_to_one() {
        let (facets, map, views) = views(&rugged(300), 64);
        let mut looking = 0;
        for f in 0..facets.len() {
            let row = &views.rows[f];
            let hidden = |horizon: Option<&Horizon>| horizon.map_or(0.0, |h| 1.0 - sky_view(h).escaping);
            let every_other = map.horizon(f).map(Horizon::every_other);
            for (c, hidden) in [hidden(map.horizon(f)), hidden(every_other.as_ref())].into_iter().enumerate() {
                let sum: f64 = row.iter().map(|seen| f64::from(seen.fractions[c])).sum();
                assert!((sum - hidden).abs() < 1e-6, "facet {f}: {sum} {hidden}");
            }
            assert!(row.iter().all(|seen| seen.facet as usize != f) && row.is_sorted_by_key(|seen| seen.facet));
            looking += usize::from(!row.is_empty());
        }
        assert!(looking > 300);
    }

    /// The scale to the sky's fraction must be round-off only: nothing seen is missing or counted twice.
    #[test]
    fn what_is_seen_fills_what_the_horizon_hides() {
        let mesh = rugged(300);
        let facets = facets(&mesh).unwrap();
        let scanner = Scanner::new(&mesh, 64);
        let map = HorizonMap::of(&facets, &scanner);
        let mut eye = Eye::new(&scanner, facets.len());
        for (f, facet) in facets.iter().enumerate() {
            let Some(horizon) = map.horizon(f) else { continue };
            eye.collect(&scanner, facet);
            (0..64).for_each(|k| eye.divide(k, 1.0 / 64.0));
            let sum: f64 = eye.touched.iter().map(|f| eye.shares[*f as usize][0]).sum();
            assert!((sum - (1.0 - sky_view(horizon).escaping)).abs() < 1e-6, "facet {f}: {sum}");
            eye.touched.drain(..).for_each(|f| eye.shares[f as usize] = [0.0; 2]);
        }
    }

    /// Rays from the centroid, even over the hemisphere as a Lambert emitter sends them.
    #[test]
    fn fractions_are_those_of_rays() {
        let mesh = rugged(60);
        let (facets, map, views) = views(&mesh, 480);
        let rays = 10_000;
        let mut compared = 0;
        for f in (0..facets.len()).filter(|f| map.horizon(*f).is_some()).step_by(5) {
            let [north, west, up] = facets[f].horizon_axes();
            let mut hits = vec![0; facets.len()];
            for k in 0..rays {
                let s2 = (f64::from(k) + 0.5) / f64::from(rays);
                let (sin_az, cos_az) = (TAU * (f64::from(k) * 0.618_033_988_749_894_9).fract()).sin_cos();
                let (s, c) = (s2.sqrt(), (1.0 - s2).sqrt());
                let towards = std::array::from_fn(|i| s * (cos_az * north[i] + sin_az * west[i]) + c * up[i]);
                if let Some(hit) = first_hit(&mesh, facets[f].point, towards, f) {
                    hits[hit] += 1;
                }
            }
            for seen in &views.rows[f] {
                let by_rays = f64::from(std::mem::take(&mut hits[seen.facet as usize])) / f64::from(rays);
                let off = (f64::from(seen.fractions[0]) - by_rays).abs();
                assert!(off < 2e-3, "{f} sees {}: {:?} {by_rays}", seen.facet, seen.fractions);
                compared += usize::from(by_rays > 0.01);
            }
            assert!(hits.iter().all(|left| *left < 8), "facet {f}: rays find what it does not see");
        }
        assert!(compared > 10, "{compared}");
    }

    /// A_i V_ij = A_j V_ji between a floor and a wall, cut finely; the closed form for two unit squares with a common edge
    /// is 0.200044 (Howell, catalogue of radiation configuration factors, C-14).
    #[test]
    fn wall_and_floor_see_one_another_as_the_closed_form_says() {
        let mut mesh = Mesh::default();
        let cells = 8;
        let mut square = |corner: &dyn Fn(f64, f64) -> [f64; 3]| {
            let step = 1.0 / f64::from(cells);
            for i in 0..cells {
                for j in 0..cells {
                    let (x, y) = (f64::from(i) * step, f64::from(j) * step);
                    let first = mesh.vertices.len() as u32;
                    mesh.vertices.extend([
                        corner(x, y),
                        corner(x + step, y),
                        corner(x + step, y + step),
                        corner(x, y + step),
                    ]);
                    mesh.facets.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
                }
            }
        };
        square(&|x, y| [x, y, 0.0]);
        square(&|x, y| [0.0, x, y]);
        let (facets, _, views) = views(&mesh, 240);
        let floor = facets.len() / 2;
        let exchanged = |from: std::ops::Range<usize>| -> f64 {
            let row = |f: usize| views.rows[f].iter().map(|seen| f64::from(seen.fractions[0])).sum::<f64>();
            from.map(|f| facets[f].area * row(f)).sum()
        };
        let (up, down) = (exchanged(0..floor), exchanged(floor..facets.len()));
        assert!((up - down).abs() < 3e-4 && (up - 0.200_044).abs() < 3e-4, "{up} {down}");
    }

    #[test]
    fn convex_bodies_see_nothing_of_themselves() {
        let mut cube = Mesh::default();
        cuboid(&mut cube, [-1.0, -2.0, -3.0], [1.0, 2.0, 3.0]);
        assert!(views(&cube, 32).2.rows.iter().all(|row| row.is_empty()));
    }
}
