//! Torque of one facet averaged over a rotation, for a Sun that stands at a fixed declination.
//!
//! In the facet's (meridian, east, spin axis) frame the Sun is at `(cos dec cos H, cos dec sin H, sin dec)`, `H` its hour
//! angle, and `mu0 = sin lat sin dec + cos lat cos dec cos H`. The horizon is a closed polygon of great-circle arcs on the
//! sky, and a day is a circle of constant declination: it is dark where the circle is outside the polygon. So the times
//! of sunrise and sunset of all declinations come from one walk round the polygon, without any step in time, and the
//! lit arcs between them are integrated by Gauss quadrature. No grid of hour angles, hence no aliasing. What leans over
//! is a box on the sky, one azimuth of the map wide, with a walk of its own.
//!
//! Averages: `tau_z`, the torque along the spin axis, and `tau_u`, that along the Sun's equatorial direction. The third
//! component precesses the spin axis and is left out.

use crate::arc::{Arcs, Lit};
use crate::declination::Declinations;
use crate::facets::Facet;
use crate::horizon::{Horizon, Overhang, direction};
use crate::recoil::RecoilKernel;
use crate::sky::SkyView;
use std::f64::consts::{PI, TAU};

/// The torque of a facet in sunlight of unit pressure, N m, one pair `[tau_z, tau_u]` a declination.
pub(crate) type Response = [f64];

/// Averages a facet over the rotation; one per thread.
pub(crate) struct Day<'a, K> {
    arcs: Arcs<'a, K>,
    declinations: &'a Declinations,
    azimuths: Vec<[f64; 2]>,
    polygon: Vec<[f64; 3]>,
    crossings: Vec<Vec<Crossing>>,
}

/// Longest piece of the side of a box, rad: a circle of declination may cross a longer arc twice.
const PIECE: f64 = 0.05;

/// What a polygon on the sky encloses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Region {
    /// The sky above the horizon.
    AboveHorizon,
    /// The sky behind something that leans over.
    Covered,
}

/// Where the outline of a region meets a circle of constant declination.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    hour_angle: f64,
    region: Region,
    /// +1 where the Sun enters the region as the hour angle grows, -1 where it leaves.
    step: i32,
}

impl<'a, K: RecoilKernel> Day<'a, K> {
    pub fn new(kernel: &'a K, declinations: &'a Declinations) -> Self {
        let crossings = vec![Vec::new(); declinations.len()];
        Self { arcs: Arcs::new(kernel), declinations, azimuths: Vec::new(), polygon: Vec::new(), crossings }
    }

    /// Adds the facet's response times `weight` to `out`, which holds two numbers a declination. `shadows` is the
    /// horizon (with an even number of azimuths), or `None` if nothing shades the facet.
    pub fn add(&mut self, facet: &Facet, shadows: Option<&Horizon>, sky: &SkyView, weight: f64, out: &mut Response) {
        if let Some(horizon) = shadows {
            self.walk_horizon(facet, horizon);
        }
        let arms = Arms::new(facet, sky);
        let weight = -weight * facet.area / TAU;
        for j in 0..self.declinations.len() {
            let (sin_dec, cos_dec) = (self.declinations.sin[j], self.declinations.cos[j]);
            let (a, b) = (facet.sin_lat * sin_dec, facet.cos_lat * cos_dec);
            let mut lit = Lit::default();
            match shadows {
                None => self.arcs.add_open_day(a, b, &mut lit),
                Some(horizon) => self.add_lit_arcs(facet, horizon, j, &mut lit),
            }
            let [along_spin, along_sun] = arms.torque(&lit, sin_dec, cos_dec);
            out[2 * j] += weight * along_spin;
            out[2 * j + 1] += weight * along_sun;
        }
    }

    /// Finds where the horizon and what leans over cross each declination.
    fn walk_horizon(&mut self, facet: &Facet, horizon: &Horizon) {
        let n = horizon.tan_elevation.len();
        if self.azimuths.len() != n {
            self.azimuths = (0..n).map(|k| direction(k, n)).collect();
        }
        self.crossings.iter_mut().for_each(Vec::clear);
        self.polygon.clear();
        let corners = self.azimuths.iter().zip(&horizon.tan_elevation);
        self.polygon.extend(corners.map(|(azimuth, &t)| on_sky(facet, *azimuth, f64::from(t))));
        self.walk(Region::AboveHorizon);
        for overhang in &horizon.overhangs {
            self.polygon.clear();
            outline(facet, overhang, n, &mut self.polygon);
            self.walk(Region::Covered);
        }
    }

    /// Walks round the polygon, which runs counter-clockwise seen from outside the sphere.
    fn walk(&mut self, region: Region) {
        let sin_dec = &self.declinations.sin;
        let mut from = self.polygon[self.polygon.len() - 1];
        // How many declinations lie south of the corner; neighbours differ by little.
        let mut south = sin_dec.partition_point(|s| *s < from[2]);
        for &to in &self.polygon {
            let before = south;
            while south < sin_dec.len() && sin_dec[south] < to[2] {
                south += 1;
            }
            while south > 0 && sin_dec[south - 1] >= to[2] {
                south -= 1;
            }
            // The region is on the left: going north it is to the west, at earlier hour angles, so the Sun leaves it.
            let (range, step) = if south > before { (before..south, -1) } else { (south..before, 1) };
            for j in range {
                self.crossings[j].push(Crossing { hour_angle: crossing(&from, &to, sin_dec[j]), region, step });
            }
            from = to;
        }
    }

    /// Adds the lit arcs of declination `j` after [`Self::walk_horizon`].
    fn add_lit_arcs(&mut self, facet: &Facet, horizon: &Horizon, j: usize, lit: &mut Lit) {
        let (sin_dec, cos_dec) = (self.declinations.sin[j], self.declinations.cos[j]);
        let (a, b) = (facet.sin_lat * sin_dec, facet.cos_lat * cos_dec);
        let mut crossings = std::mem::take(&mut self.crossings[j]);
        let order = |c: &Crossing| (c.region, c.step);
        crossings.sort_unstable_by(|x, y| x.hour_angle.total_cmp(&y.hour_angle).then(order(x).cmp(&order(y))));
        // Entries and exits alternate up to round-off between neighbours; counting levels from the lowest forgives that.
        let start = |region: Region| {
            let mut level = 0;
            let steps = crossings.iter().filter(|c| c.region == region);
            let lowest = steps.fold(None, |lowest: Option<i32>, c| {
                level += c.step;
                Some(lowest.map_or(level, |l| l.min(level)).min(0))
            });
            lowest.map_or_else(|| i32::from(culminates_in(region, facet, horizon, sin_dec, cos_dec)), |l| -l)
        };
        let (mut above, mut covered) = (start(Region::AboveHorizon), start(Region::Covered));
        let mut since = match crossings.last() {
            // The arc through midnight begins a turn earlier.
            Some(last) => last.hour_angle - TAU,
            None => {
                if above > 0 && covered == 0 {
                    self.arcs.add(a, b, 0.0, PI, lit);
                }
                0.0
            }
        };
        for crossing in &crossings {
            if above > 0 && covered == 0 {
                let half = 0.5 * (crossing.hour_angle - since);
                self.arcs.add(a, b, since + half, half, lit);
            }
            match crossing.region {
                Region::AboveHorizon => above += crossing.step,
                Region::Covered => covered += crossing.step,
            }
            since = crossing.hour_angle;
        }
        self.crossings[j] = crossings;
    }
}

/// Direction of an azimuth (cosine, sine) and elevation (tangent) in the facet's (meridian, east, spin axis) frame.
fn on_sky(facet: &Facet, [cos_az, sin_az]: [f64; 2], tan_elevation: f64) -> [f64; 3] {
    // north = (-s, 0, c), west = (0, -1, 0), up = (c, 0, s).
    let (s, c) = (facet.sin_lat, facet.cos_lat);
    let cos_h = 1.0 / (1.0 + tan_elevation * tan_elevation).sqrt();
    let (north, west, up) = (cos_h * cos_az, cos_h * sin_az, cos_h * tan_elevation);
    [c * up - s * north, -west, c * north + s * up]
}

/// Appends the outline of an overhang, half-way to the neighbouring azimuths of the `n` of the map.
fn outline(facet: &Facet, overhang: &Overhang, n: usize, polygon: &mut Vec<[f64; 3]>) {
    let [low, high] = overhang.tan_elevation.map(f64::from);
    let k = 2 * overhang.azimuth as usize;
    let [right, left] = [k + 2 * n - 1, k + 1].map(|k| direction(k % (2 * n), 2 * n));
    let (from, to) = (low.atan(), high.atan());
    let pieces = ((to - from) / PIECE).ceil().max(1.0);
    let height = |j: usize| (from + (to - from) * j as f64 / pieces).tan().min(high);
    let pieces = pieces as usize;
    polygon.extend((0..=pieces).map(|j| on_sky(facet, left, height(j))));
    polygon.extend((0..=pieces).rev().map(|j| on_sky(facet, right, height(j))));
}

/// Whether the Sun is in the region when it culminates, due north or due south of the zenith: all day, if its circle does
/// not meet the region's outline.
fn culminates_in(region: Region, facet: &Facet, horizon: &Horizon, sin_dec: f64, cos_dec: f64) -> bool {
    let n = horizon.tan_elevation.len();
    let (s, c) = (facet.sin_lat, facet.cos_lat);
    let (up, north) = (s * sin_dec + c * cos_dec, c * sin_dec - s * cos_dec);
    let azimuth = if north >= 0.0 { 0 } else { n / 2 };
    let above = |tan_elevation: f32| up > f64::from(tan_elevation) * north.abs();
    match region {
        Region::AboveHorizon => above(horizon.tan_elevation[azimuth]),
        Region::Covered => horizon.overhangs.iter().any(|overhang| {
            let [low, high] = overhang.tan_elevation;
            overhang.azimuth as usize == azimuth && above(low) && !above(high)
        }),
    }
}

/// Hour angle at which the great-circle arc between two points on either side of a declination crosses it.
fn crossing(from: &[f64; 3], to: &[f64; 3], sin_dec: f64) -> f64 {
    let along = |t: f64| -> [f64; 3] { std::array::from_fn(|k| from[k] + t * (to[k] - from[k])) };
    // The chord is a little shorter than 1 inside; two turns of this correction leave less than round-off of it.
    let mut t = (sin_dec - from[2]) / (to[2] - from[2]);
    for _ in 0..2 {
        let [x, y, z] = along(t.clamp(0.0, 1.0));
        t = (sin_dec * (x * x + y * y + z * z).sqrt() - from[2]) / (to[2] - from[2]);
    }
    let [x, y, _] = along(t.clamp(0.0, 1.0));
    y.atan2(x)
}

/// Lever arms of the recoil terms: the point crossed with the emission vector, with the normal, and itself.
struct Arms {
    emitted: [f64; 3],
    normal: [f64; 3],
    point: [f64; 3],
}

impl Arms {
    fn new(facet: &Facet, sky: &SkyView) -> Self {
        let (s, c) = (facet.sin_lat, facet.cos_lat);
        let [north, west] = sky.tangential;
        let up = sky.normal;
        let point = facet.local_point();
        Self {
            emitted: cross(point, [c * up - s * north, -west, c * north + s * up]),
            normal: cross(point, [c, 0.0, s]),
            point,
        }
    }

    /// Minus the torque along the spin axis and along the Sun's equatorial direction `u = (cos H, sin H, 0)`:
    /// with `s` the Sun, `(r x s) . z = cos dec (r_m sin H - r_e cos H)`, `(r x s) . u = sin dec (r_e cos H - r_m sin H)`.
    fn torque(&self, lit: &Lit, sin_dec: f64, cos_dec: f64) -> [f64; 2] {
        let solar = self.point[0] * lit.solar[1] - self.point[1] * lit.solar[0];
        let along_spin = self.emitted[2] * lit.emitted[0] + self.normal[2] * lit.normal[0] + cos_dec * solar;
        let along_sun = self.emitted[0] * lit.emitted[1]
            + self.emitted[1] * lit.emitted[2]
            + self.normal[0] * lit.normal[1]
            + self.normal[1] * lit.normal[2]
            - sin_dec * solar;
        [along_spin, along_sun]
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
