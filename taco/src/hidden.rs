//! The union of hidden intervals of elevation at each azimuth, while facets are still coming in.

use crate::horizon::Overhang;

/// Intervals of elevation (tangents) closer than this times 1 + tangent touch.
const TOUCHING: f64 = 1e-9;
/// Steepest tangent that is kept (90 deg less 0.2 arc seconds); stands for the zenith.
pub(crate) const STEEPEST: f64 = 1e6;

/// What is known to be hidden while facets are still coming in, as tangents of elevations.
#[derive(Debug, Default)]
pub(crate) struct Hidden {
    /// Hidden from the ground up to here, at each azimuth.
    pub ground: Vec<f64>,
    /// The lowest interval that did not touch the ground when it was found; empty (infinite, zero) if there is none.
    lowest: Vec<[f64; 2]>,
    /// Further such intervals, by azimuth.
    floating: Vec<(usize, f64, f64)>,
}

impl Hidden {
    pub fn reset(&mut self, azimuths: usize) {
        self.ground.clear();
        self.ground.resize(azimuths, 0.0);
        self.lowest.clear();
        self.lowest.resize(azimuths, NOTHING);
        self.floating.clear();
    }

    /// Adds an interval. Most float only until the facet below them comes in.
    #[inline]
    pub fn add(&mut self, k: usize, low: f64, high: f64) {
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
    pub fn settle(&mut self) -> Box<[Overhang]> {
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
pub(crate) fn kept(tan_elevation: f64) -> f32 {
    tan_elevation.min(STEEPEST) as f32
}
