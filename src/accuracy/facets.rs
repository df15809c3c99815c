//! Knob: the number of facets of the tiling.
//!
//! The same settled body is tiled with ever more facets and its torque curve compared with that of the finest tiling.
//! The error is the largest difference over all obliquities of either component, over the largest value of that
//! component: the part of the torque that the tiling decides. Where the vertices fall is luck, so each number of facets
//! stands for five that differ by a few, which puts all vertices elsewhere: rms and half range over them are given. The
//! shape between the spheres stays what the implicit surface makes it; another level or exponent is another body.

use cpu_time::ProcessTime;
use pkd::mass_properties::mass_properties;
use taco::{Orbit, Sampling, Surface, TorqueTable, torque_table};
use tiling::hull::sphere_hull_volume;
use tiling::{EllipsoidTiling, ImplicitSurface};

use super::body::Bench;
use super::{About, AccuracyError, Effort, Knob, Point, half_range};
use crate::scene::TilingOptions;

/// Facets more or less of the tilings that stand for one setting.
const NEIGHBOURS: [i32; 5] = [0, -16, -8, 8, 16];

/// The number of [`TilingOptions::facets`].
pub(super) struct Facets;

impl Knob for Facets {
    fn about(&self) -> About {
        About {
            name: "facets",
            part: "tiling",
            unit: "facets",
            scene_key: "tiling.facets",
            default: TilingOptions::default().facets.into(),
            error_is: "largest difference of a torque component over all obliquities, over its largest value; \
                       reference: the finest tiling of the same body",
        }
    }

    fn points(&self, bench: &mut Bench) -> Result<Vec<Point>, AccuracyError> {
        // The nine resolutions of Cotto-Figueroa et al. (2015) end at 19 960 facets.
        let (counts, finest): (&[u32], u32) = match bench.effort {
            Effort::Quick => (&[196, 392, 784, 1568], 6368),
            Effort::Full => (&[196, 392, 784, 1568, 3184, 6368, 9980], 19_960),
        };
        let body = BodyToTile::new(bench)?;
        bench.say(&format!("facets: reference of {finest}"));
        let reference = body.torques(finest)?;
        let mut points = Vec::new();
        for &facets in counts {
            let clock = ProcessTime::now();
            let tables = NEIGHBOURS.map(|more| body.torques(facets.saturating_add_signed(more)));
            let seconds = clock.elapsed().as_secs_f64() / NEIGHBOURS.len() as f64;
            let mut errors = [0.0; NEIGHBOURS.len()];
            for (error, table) in errors.iter_mut().zip(tables) {
                *error = difference(&table?, &reference);
            }
            let error = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
            bench.say(&format!("facets {facets}: error {error:.2e} in {seconds:.2} s"));
            points.push(Point { value: facets.into(), error, spread: Some(half_range(&errors)), seconds });
        }
        Ok(points)
    }
}

/// The settled body and the ellipsoid that its tilings start from.
struct BodyToTile {
    surface: ImplicitSurface,
    semi_axes: [f64; 3],
}

impl BodyToTile {
    fn new(bench: &mut Bench) -> Result<Self, AccuracyError> {
        let body = bench.settled_body()?;
        let TilingOptions { exponent, level, .. } = TilingOptions::default();
        let surface = ImplicitSurface::new(&body.x, &body.y, &body.z, &body.radius, exponent, level)?;
        // B1 axis ratios with the volume of the hull, as in a run.
        let axes = mass_properties(&body)?.deeve_axes();
        let hull = sphere_hull_volume(&body.x, &body.y, &body.z, &body.radius)?;
        let scale = (hull / (4.0 / 3.0 * std::f64::consts::PI * axes.product())).cbrt();
        Ok(Self { surface, semi_axes: (axes * scale).into() })
    }

    /// Tiles with so many facets and computes the torques of an average S-type surface at 1 au.
    fn torques(&self, facets: u32) -> Result<TorqueTable, AccuracyError> {
        let options = TilingOptions { facets, ..TilingOptions::default() };
        let tiling = EllipsoidTiling::new(self.semi_axes, options.vertices())?.projected(&self.surface);
        Ok(torque_table(&tiling.mesh, &Surface::default(), &Orbit::default(), &Sampling::default())?)
    }
}

/// Largest difference of either component over its largest reference value.
fn difference(table: &TorqueTable, reference: &TorqueTable) -> f64 {
    let component = |of: fn(&TorqueTable) -> &Vec<Vec<f64>>| {
        let values = of(table).iter().flatten().zip(of(reference).iter().flatten());
        let (worst, peak) = values.fold((0.0_f64, 0.0_f64), |(w, p), (t, r)| (w.max((t - r).abs()), p.max(r.abs())));
        worst / peak
    };
    component(|t| &t.spin_torque_n_m).max(component(|t| &t.obliquity_torque_n_m))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_falls_with_the_number_of_facets_from_the_default_on() {
        let mut silent = |_: &str| {};
        let points = Facets.points(&mut Bench::new(Effort::Quick, &mut silent)).unwrap();
        assert_eq!(points[points.len() - 2].value, Facets.about().default);
        let [.., default, finer] = points[..] else { panic!("{points:?}") };
        assert!(finer.error < 0.8 * default.error && finer.error > 0.0, "{points:?}");
    }
}
