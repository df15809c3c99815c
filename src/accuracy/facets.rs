//! Knob: the number of facets of the tiling.
//!
//! The same bodies are tiled with ever more facets and their torque curves compared with those of the finest tiling. The
//! torque of a pile of equal spheres is what is left when the bumps of all sides cancel, and a tiling that samples each
//! bump by a facet or two leaves a remainder of its own: how large the error of one body is, is luck. So the error is
//! taken over several: the root mean square of the largest difference over all obliquities, over that of the largest
//! torque, for the worse of the two components. The shape between the spheres stays what the implicit surface makes it;
//! another level or exponent is another body.

use cpu_time::ProcessTime;
use pkd::mass_properties::mass_properties;
use taco::{BodyMesh, Orbit, Pose, Sampling, Surface, TorqueTable, torque_table};
use tiling::hull::sphere_hull_volume;
use tiling::{EllipsoidTiling, ImplicitSurface};

use super::body::Bench;
use super::{About, AccuracyError, Effort, Knob, Point, half_range};
use crate::scene::TilingOptions;

/// Bodies over which the error is taken: seeds of their packings.
const SEEDS: std::ops::Range<u64> = 1..5;

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
            error_is: "largest difference of a torque component over all obliquities, over its largest value, rms of \
                       four bodies each; reference: the finest tiling of the same bodies",
        }
    }

    fn points(&self, bench: &mut Bench) -> Result<Vec<Point>, AccuracyError> {
        // The nine resolutions of Cotto-Figueroa et al. (2015) end at 19 960 facets.
        let (counts, finest): (&[u32], u32) = match bench.effort {
            Effort::Quick => (&[196, 392, 784, 1568], 6368),
            Effort::Full => (&[196, 392, 784, 1568, 3184, 6368, 9980], 19_960),
        };
        let bodies: Vec<_> = SEEDS.map(|seed| BodyToTile::new(bench, seed)).collect::<Result<_, _>>()?;
        let curves = |facets| bodies.iter().map(|body| body.torques(facets)).collect::<Result<Vec<_>, _>>();
        bench.say(&format!("facets: reference of {finest}"));
        let reference = curves(finest)?;
        let mut points = Vec::new();
        for &facets in counts {
            let clock = ProcessTime::now();
            let tables = curves(facets)?;
            let seconds = clock.elapsed().as_secs_f64() / bodies.len() as f64;
            let (error, spread) = difference(&tables, &reference);
            bench.say(&format!("facets {facets}: error {error:.2e} in {seconds:.2} s"));
            points.push(Point { value: facets.into(), error, spread: Some(spread), seconds });
        }
        Ok(points)
    }
}

/// A body's surface and the ellipsoid that its tilings start from.
pub(super) struct BodyToTile {
    surface: ImplicitSurface,
    semi_axes: [f64; 3],
}

impl BodyToTile {
    pub fn new(bench: &Bench, seed: u64) -> Result<Self, AccuracyError> {
        let body = bench.packed_body(seed)?;
        let TilingOptions { exponent, level, .. } = TilingOptions::default();
        let surface = ImplicitSurface::new(&body.x, &body.y, &body.z, &body.radius, exponent, level)?;
        // B1 axis ratios with the volume of the hull, as in a run.
        let axes = mass_properties(&body)?.deeve_axes();
        let hull = sphere_hull_volume(&body.x, &body.y, &body.z, &body.radius)?;
        let scale = (hull / (4.0 / 3.0 * std::f64::consts::PI * axes.product())).cbrt();
        Ok(Self { surface, semi_axes: (axes * scale).into() })
    }

    /// The body with a tiling of so many facets, about the spheres' centre of mass.
    pub fn tiled(&self, facets: u32) -> Result<BodyMesh, AccuracyError> {
        let options = TilingOptions { facets, ..TilingOptions::default() };
        let tiling = EllipsoidTiling::new(self.semi_axes, options.vertices())?.projected(&self.surface)?;
        Ok(BodyMesh::posed(&tiling.mesh, &Pose::default())?)
    }

    /// The torques of an average S-type surface at 1 au, tiled with so many facets.
    fn torques(&self, facets: u32) -> Result<TorqueTable, AccuracyError> {
        Ok(torque_table(&self.tiled(facets)?, &Surface::default(), &Orbit::default(), &Sampling::default())?)
    }
}

/// Error over all bodies for the worse component, and half the range over the bodies.
pub(super) fn difference(tables: &[TorqueTable], references: &[TorqueTable]) -> (f64, f64) {
    let component = |of: fn(&TorqueTable) -> &Vec<Vec<f64>>| {
        let worst = |t: &TorqueTable, r: &TorqueTable| {
            largest(of(t).iter().flatten().zip(of(r).iter().flatten()).map(|(t, r)| t - r))
        };
        let worst: Vec<f64> = tables.iter().zip(references).map(|(t, r)| worst(t, r)).collect();
        let peak: Vec<f64> = references.iter().map(|r| largest(of(r).iter().flatten().copied())).collect();
        (rms(&worst) / rms(&peak), half_range(&worst) / rms(&peak))
    };
    let (spin, obliquity) = (component(|t| &t.spin_torque_n_m), component(|t| &t.obliquity_torque_n_m));
    if spin.0 > obliquity.0 { spin } else { obliquity }
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |m, v| m.max(v.abs()))
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
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
