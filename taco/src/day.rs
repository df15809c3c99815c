//! Torque of one facet averaged over a rotation, for a Sun that stands at a fixed declination.
//!
//! In the facet's (meridian, east, spin axis) frame the Sun is at `(cos dec cos H, cos dec sin H, sin dec)`, `H` its hour
//! angle, and `mu0 = sin lat sin dec + cos lat cos dec cos H`. The horizon is a closed polygon of great-circle arcs on the
//! sky, and a day is a circle of constant declination: it is dark where the circle is outside the polygon. So the times
//! of sunrise and sunset of all declinations come from one walk round the polygon, without any step in time, and the
//! lit arcs between them are integrated by Gauss quadrature. No grid of hour angles, hence no aliasing. Only the few arcs
//! that may pass behind something that leans over are searched in steps of one azimuth of the map.
//!
//! Averages: `tau_z`, the torque along the spin axis, and `tau_u`, that along the Sun's equatorial direction. The third
//! component precesses the spin axis and is left out.

use crate::arc::{Arcs, Lit, half_day};
use crate::azimuth::{direction, rough_azimuth};
use crate::declination::Declinations;
use crate::exchange::Wrench;
use crate::facets::Facet;
use crate::heat::insolation::{CellFlux, Cells};
use crate::hidden::STEEPEST;
use crate::horizon::Horizon;
use crate::recoil::RecoilKernel;
use crate::sky::SkyView;
use std::f64::consts::{PI, TAU};

/// The torque of a facet in sunlight of unit pressure, N m, one pair `[tau_z, tau_u]` a declination.
pub(crate) type Response = [f64];

/// Averages a facet over the rotation; one per thread.
pub(crate) struct Day<'a, K> {
    kernel: &'a K,
    arcs: Arcs<'a, K>,
    declinations: &'a Declinations,
    azimuths: Vec<[f64; 2]>,
    polygon: Vec<[f64; 3]>,
    crossings: Vec<Vec<Crossing>>,
}

/// Where the horizon meets a circle of constant declination.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    hour_angle: f64,
    /// +1 where the Sun rises as the hour angle grows, -1 where it sets.
    step: i32,
}

/// Longest piece of the horizon, rad, where it rises or falls steeply: a circle of declination may meet a longer one twice.
const PIECE: f64 = 0.1;

/// Crossings closer to each other than this may be in the wrong order, rad.
const SAME_TIME: f64 = 1e-5;

/// Halvings of a step in search of the edge of what leans over: to 1e-8 rad.
const HALVINGS: usize = 22;

impl<'a, K: RecoilKernel> Day<'a, K> {
    pub fn new(kernel: &'a K, declinations: &'a Declinations) -> Self {
        let crossings = vec![Vec::new(); declinations.len()];
        Self { kernel, arcs: Arcs::new(kernel), declinations, azimuths: Vec::new(), polygon: Vec::new(), crossings }
    }

    /// Number of declinations.
    pub fn declinations(&self) -> usize {
        self.declinations.len()
    }

    /// Adds the facet's response times `weight` to `out`, which holds two numbers a declination. `shadows` is the
    /// horizon (with an even number of azimuths), or `None` if nothing shades the facet.
    pub fn add(&mut self, facet: &Facet, shadows: Option<&Horizon>, sky: &SkyView, weight: f64, out: &mut Response) {
        self.add_with(facet, shadows, &Arms::new(facet, sky), weight, out);
    }

    /// As [`Self::add`], for a facet part of whose light leaves from other facets. The kernel must be a
    /// [`crate::exchange::Scattering`].
    pub fn add_followed(
        &mut self,
        facet: &Facet,
        shadows: Option<&Horizon>,
        wrench: &Wrench,
        weight: f64,
        out: &mut Response,
    ) {
        self.add_with(facet, shadows, &Arms::followed(facet, wrench), weight, out);
    }

    fn add_with(&mut self, facet: &Facet, shadows: Option<&Horizon>, arms: &Arms, weight: f64, out: &mut Response) {
        if let Some(horizon) = shadows {
            self.walk_horizon(facet, horizon);
        }
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

    /// Adds the facet's force along `u x z`, `u` the Sun's equatorial direction, at each declination, N per pressure: what
    /// moves the body along its orbit at zero obliquity, were no heat stored.
    /// `emitted` is the momentum of what is emitted, as of [`emission_vector`].
    pub fn add_transverse(
        &mut self,
        facet: &Facet,
        shadows: Option<&Horizon>,
        emitted: [f64; 3],
        weight: f64,
        out: &mut [f64],
    ) {
        if let Some(horizon) = shadows {
            self.walk_horizon(facet, horizon);
        }
        let [meridian, east, _] = emitted;
        let weight = weight * facet.area / TAU;
        for (j, out) in out.iter_mut().enumerate() {
            let (a, b) = (facet.sin_lat * self.declinations.sin[j], facet.cos_lat * self.declinations.cos[j]);
            let mut lit = Lit::default();
            match shadows {
                None => self.arcs.add_open_day(a, b, &mut lit),
                Some(horizon) => self.add_lit_arcs(facet, horizon, j, &mut lit),
            }
            // What goes back towards the Sun pushes away from it, not along.
            let [_, cos, sin] = lit.emitted;
            *out += weight * (east * cos - meridian * sin - facet.cos_lat * lit.normal[2]);
        }
    }

    /// Mean fluxes that the facet absorbs and reflects in each cell of local time, per unit flux of the beam.
    pub fn cell_means(&mut self, facet: &Facet, shadows: Option<&Horizon>, cells: &Cells, out: &mut CellFlux) {
        let n = cells.count();
        out.reset(self.declinations.len(), n);
        if let Some(horizon) = shadows {
            self.walk_horizon(facet, horizon);
        }
        let kernel = self.kernel;
        for (j, (absorbed, reflected)) in
            out.absorbed.chunks_exact_mut(n).zip(out.reflected.chunks_exact_mut(n)).enumerate()
        {
            let ab = [facet.sin_lat * self.declinations.sin[j], facet.cos_lat * self.declinations.cos[j]];
            let mut add = |from: f64, to: f64| cells.add(kernel, ab, [from, to], absorbed, reflected);
            match shadows {
                None => {
                    let half = half_day(ab[0], ab[1]);
                    add(-half, half);
                }
                Some(horizon) => for_each_lit_arc(facet, horizon, self.declinations, j, &mut self.crossings[j], add),
            }
        }
    }

    /// Finds where the horizon crosses each declination.
    fn walk_horizon(&mut self, facet: &Facet, horizon: &Horizon) {
        let n = horizon.tan_elevation.len();
        if self.azimuths.len() != n {
            self.azimuths = (0..n).map(|k| direction(k, n)).collect();
        }
        self.crossings.iter_mut().for_each(Vec::clear);
        self.polygon.clear();
        let mut last: Option<[f64; 3]> = None;
        let corners = self.azimuths.iter().zip(&horizon.tan_elevation).map(|(az, &t)| on_sky(facet, *az, f64::from(t)));
        // The first corner comes again, to close the polygon with pieces as short as the others.
        let first = on_sky(facet, self.azimuths[0], f64::from(horizon.tan_elevation[0]));
        for to in corners.chain([first]) {
            if let Some(from) = last {
                add_pieces(&from, &to, &mut self.polygon);
            }
            last = Some(to);
        }
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
            // The polygon runs counter-clockwise seen from outside the sphere, its lit inside on the left: going north that is
            // to the west, at earlier hour angles, so the Sun sets.
            let (range, step) = if south > before { (before..south, -1) } else { (south..before, 1) };
            for j in range {
                self.crossings[j].push(Crossing { hour_angle: crossing(&from, &to, sin_dec[j]), step });
            }
            from = to;
        }
    }

    /// Adds the lit arcs of declination `j` after [`Self::walk_horizon`].
    fn add_lit_arcs(&mut self, facet: &Facet, horizon: &Horizon, j: usize, lit: &mut Lit) {
        let (a, b) = (facet.sin_lat * self.declinations.sin[j], facet.cos_lat * self.declinations.cos[j]);
        let Self { arcs, declinations, crossings, .. } = self;
        for_each_lit_arc(facet, horizon, declinations, j, &mut crossings[j], |from, to| {
            arcs.add(a, b, 0.5 * (from + to), 0.5 * (to - from), lit);
        });
    }
}

/// Calls `add` with the ends of each lit arc of declination `j`, given where the horizon crosses it.
fn for_each_lit_arc(
    facet: &Facet,
    horizon: &Horizon,
    declinations: &Declinations,
    j: usize,
    crossings: &mut [Crossing],
    mut add_lit: impl FnMut(f64, f64),
) {
    let (sin_dec, cos_dec) = (declinations.sin[j], declinations.cos[j]);
    crossings.sort_unstable_by(|x, y| x.hour_angle.total_cmp(&y.hour_angle).then(x.step.cmp(&y.step)));
    // The arc through midnight begins a turn earlier.
    let midnight = crossings.last().map_or(-PI, |c| c.hour_angle - TAU);
    let sun = |hour_angle: f64| [cos_dec * hour_angle.cos(), cos_dec * hour_angle.sin(), sin_dec];
    let mut up = up_before_first(crossings, midnight, |hour_angle| is_above(facet, horizon, sun(hour_angle)));
    let mut add = |from: f64, to: f64| {
        if horizon.overhangs.is_empty() {
            add_lit(from, to);
        } else {
            let covered = |hour_angle: f64| is_covered(facet, horizon, sun(hour_angle));
            let step = TAU / horizon.tan_elevation.len() as f64;
            for_each_free(from, to, step, covered, &mut add_lit);
        }
    };
    if crossings.is_empty() && up > 0 {
        add(-PI, PI);
    }
    let mut since = midnight;
    for crossing in crossings {
        if up > 0 {
            add(since, crossing.hour_angle);
        }
        up += crossing.step;
        since = crossing.hour_angle;
    }
}

/// 1 if the Sun is up before the first crossing, else 0: `midnight` is the last one, a turn earlier.
///
/// Risings and settings alternate, so any of them tells; but where two are as close as round-off they may come in the
/// wrong order. Then, or where there is none, it is settled in the middle of the longest arc, and by counting from there.
fn up_before_first(crossings: &[Crossing], midnight: f64, is_up: impl Fn(f64) -> bool) -> i32 {
    let clear = |w: &[Crossing]| w[0].step != w[1].step && w[1].hour_angle - w[0].hour_angle > SAME_TIME;
    if let [first, .., last] = crossings
        && first.step != last.step
        && first.hour_angle - midnight > SAME_TIME
        && crossings.windows(2).all(clear)
    {
        return i32::from(first.step < 0);
    }
    let (mut longest, mut middle, mut before) = (0.0, 0.0, 0);
    let mut since = midnight;
    for (k, crossing) in crossings.iter().enumerate() {
        let length = crossing.hour_angle - since;
        if length > longest {
            (longest, middle, before) = (length, since + 0.5 * length, k);
        }
        since = crossing.hour_angle;
    }
    i32::from(is_up(middle)) - crossings[..before].iter().map(|c| c.step).sum::<i32>()
}

/// Calls `add` for each part of an interval that is not covered: looked for in steps, the edges by bisection.
fn for_each_free(from: f64, to: f64, step: f64, covered: impl Fn(f64) -> bool, mut add: impl FnMut(f64, f64)) {
    let steps = ((to - from) / step).ceil().max(1.0);
    let step = (to - from) / steps;
    let middle = |k: usize| from + (k as f64 + 0.5) * step;
    let mut was_covered = covered(middle(0));
    let mut since = from;
    for k in 1..steps as usize {
        let is_covered = covered(middle(k));
        if is_covered == was_covered {
            continue;
        }
        let (mut low, mut high) = (middle(k - 1), middle(k));
        for _ in 0..HALVINGS {
            let half = 0.5 * (low + high);
            if covered(half) == was_covered {
                low = half;
            } else {
                high = half;
            }
        }
        if is_covered {
            add(since, high);
        }
        since = high;
        was_covered = is_covered;
    }
    if !was_covered {
        add(since, to);
    }
}

/// Direction of an azimuth (cosine, sine) and elevation (tangent) in the facet's (meridian, east, spin axis) frame.
fn on_sky(facet: &Facet, azimuth: [f64; 2], tan_elevation: f64) -> [f64; 3] {
    let [cos_az, sin_az] = facet.north_west(azimuth);
    // north = (-s, 0, c), west = (0, -1, 0), up = (c, 0, s).
    let (s, c) = (facet.sin_lat, facet.cos_lat);
    let cos_h = 1.0 / (1.0 + tan_elevation * tan_elevation).sqrt();
    let (north, west, up) = (cos_h * cos_az, cos_h * sin_az, cos_h * tan_elevation);
    [c * up - s * north, -west, c * north + s * up]
}

/// Appends the great circle between two directions in pieces, without its first end.
fn add_pieces(from: &[f64; 3], to: &[f64; 3], polygon: &mut Vec<[f64; 3]>) {
    let chord2: f64 = (0..3).map(|k| (to[k] - from[k]).powi(2)).sum();
    if chord2 > PIECE * PIECE {
        let pieces = (chord2.sqrt() / PIECE).ceil();
        for j in 1..pieces as usize {
            let t = j as f64 / pieces;
            let p: [f64; 3] = std::array::from_fn(|k| from[k] + t * (to[k] - from[k]));
            let length = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt();
            polygon.push(p.map(|c| c / length));
        }
    }
    polygon.push(*to);
}

/// Azimuth in steps of the map, and horizontal and vertical component, of a direction in the facet's frame.
fn horizontal(facet: &Facet, horizon: &Horizon, [meridian, east, axis]: [f64; 3]) -> (f64, f64, f64) {
    let (s, c) = (facet.sin_lat, facet.cos_lat);
    let (north, west, up) = (c * axis - s * meridian, -east, c * meridian + s * axis);
    let [x, y] = facet.azimuth_axes([north, west]);
    let position = rough_azimuth(x, y).rem_euclid(TAU) / TAU * horizon.tan_elevation.len() as f64;
    (position, (north * north + west * west).sqrt(), up)
}

/// Whether a direction is above the horizon.
fn is_above(facet: &Facet, horizon: &Horizon, direction: [f64; 3]) -> bool {
    let (position, level, up) = horizontal(facet, horizon, direction);
    let n = horizon.tan_elevation.len();
    // The great circle between two azimuths a step apart: the tangents, weighted by sines.
    let k = position as usize;
    let step = TAU / n as f64;
    let phase = (position - k as f64) * step;
    let [t0, t1] = [k, k + 1].map(|k| f64::from(horizon.tan_elevation[k % n]));
    up * step.sin() > level * (t0 * (step - phase).sin() + t1 * phase.sin())
}

/// Whether a direction is behind something that leans over, which holds from half an azimuth of the map before to half an
/// azimuth after its own.
fn is_covered(facet: &Facet, horizon: &Horizon, direction: [f64; 3]) -> bool {
    let (position, level, up) = horizontal(facet, horizon, direction);
    let azimuth = (position + 0.5) as usize % horizon.tan_elevation.len();
    let first = horizon.overhangs.partition_point(|o| (o.azimuth as usize) < azimuth);
    horizon.overhangs[first..].iter().take_while(|o| o.azimuth as usize == azimuth).any(|overhang| {
        let [low, high] = overhang.tan_elevation.map(f64::from);
        up > low * level && (high >= STEEPEST || up < high * level)
    })
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
        Self::with_emitted(facet, cross(facet.local_point(), emission_vector(facet, sky)))
    }

    fn followed(facet: &Facet, wrench: &Wrench) -> Self {
        Self::with_emitted(facet, facet.local(wrench.angular_momentum))
    }

    fn with_emitted(facet: &Facet, emitted: [f64; 3]) -> Self {
        let point = facet.local_point();
        Self { emitted, normal: cross(point, [facet.cos_lat, 0.0, facet.sin_lat]), point }
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

/// Momentum of the light that a facet emits and that escapes, per emitted energy over the speed of light, in the facet's
/// (meridian, east, spin axis) frame.
pub(crate) fn emission_vector(facet: &Facet, sky: &SkyView) -> [f64; 3] {
    let (s, c) = (facet.sin_lat, facet.cos_lat);
    let ([north, west], up) = (facet.north_west(sky.tangential), sky.normal);
    [c * up - s * north, -west, c * north + s * up]
}

/// Vector product.
pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::facets::facets;
    use crate::horizon::HorizonMap;
    use crate::recoil::LambertRecoil;
    use crate::test_bodies::{blocked, rugged};

    /// Mean of `mu0` over the day from the arcs and from rays at many hour angles, facet by facet, with a slab that hovers.
    #[test]
    fn lit_arcs_are_where_rays_reach_the_sun() {
        let mesh = rugged(60);
        let facets = facets(&mesh).unwrap();
        let map = HorizonMap::new(&mesh, 360).unwrap();
        let declinations = Declinations::new(9);
        let kernel = LambertRecoil { albedo: 0.0 };
        let mut day = Day::new(&kernel, &declinations);
        let steps = 180;
        let (mut compared, mut total) = (0, 0.0);
        for (f, facet) in facets.iter().enumerate() {
            let Some(horizon) = map.horizon(f) else { continue };
            day.walk_horizon(facet, horizon);
            let [north, west, up] = facet.horizon_axes();
            // The meridian direction: north and up turned back by the latitude.
            let meridian: [f64; 3] = std::array::from_fn(|k| facet.cos_lat * up[k] - facet.sin_lat * north[k]);
            for j in 0..declinations.len() {
                let (sin_dec, cos_dec) = (declinations.sin[j], declinations.cos[j]);
                let mut lit = Lit::default();
                day.add_lit_arcs(facet, horizon, j, &mut lit);
                let mut sum = 0.0;
                for k in 0..steps {
                    let (s, c) = (TAU * (f64::from(k) + 0.5) / f64::from(steps)).sin_cos();
                    let mut sun: [f64; 3] = std::array::from_fn(|i| cos_dec * (c * meridian[i] - s * west[i]));
                    sun[2] += sin_dec;
                    let mu0: f64 = (0..3).map(|i| sun[i] * up[i]).sum();
                    if mu0 > 0.0 && !blocked(&mesh, facet.point, sun, f) {
                        sum += mu0 * TAU / f64::from(steps);
                    }
                }
                let off = (lit.emitted[0] - sum).abs();
                // A step of the sum is 0.035 rad, and each of a few edges may be off by half of one.
                assert!(off < 0.1, "facet {f}, declination {sin_dec}: {} {sum}", lit.emitted[0]);
                compared += 1;
                total += off;
            }
        }
        assert!(compared > 500 && total / f64::from(compared) < 0.005, "{compared} {total}");
    }
}
