//! Error against run time of the numerical knobs: what `yorp accuracy` measures.
//!
//! Each knob is varied with everything else at its default, against a reference that is exact or the same thing at the
//! highest resolution. Errors are functions of the build alone; the seconds are CPU seconds of this machine, summed
//! over threads, because they are what a busy machine does not change.

mod body;
mod facets;
mod figure;
mod hard_sphere_step;
mod page;
mod sampling;
mod shed_orbit;
mod soft_sphere;
mod spin;

use serde::Serialize;

use body::Bench;

pub use figure::{FigureError, save_png, svg};
pub use page::page;

/// How much time a measurement may take.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Effort {
    /// Small bodies and few points: seconds.
    Quick,
    /// Bodies of a thousand spheres as in the papers: minutes.
    Full,
}

impl Effort {
    /// Number of spheres of the bodies.
    pub fn spheres(self) -> usize {
        match self {
            Self::Quick => 150,
            Self::Full => 1000,
        }
    }
}

/// A numerical knob that can be measured.
pub trait Knob: Sync {
    /// What it is called and what its error means.
    fn about(&self) -> About;
    /// Measures it, from coarse to fine.
    ///
    /// # Errors
    /// Whatever the module behind it reports.
    fn points(&self, bench: &mut Bench) -> Result<Vec<Point>, AccuracyError>;
}

/// The words and the default that go with a knob.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct About {
    /// Name of the knob, unique.
    pub name: &'static str,
    /// Module it belongs to.
    pub part: &'static str,
    /// Unit of its values.
    pub unit: &'static str,
    /// Key of the scene, or flag, that sets it.
    pub scene_key: &'static str,
    /// Value that a scene has unless it says otherwise.
    pub default: f64,
    /// What the error is, and against what.
    pub error_is: &'static str,
}

/// One setting of a knob.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Point {
    /// The setting.
    pub value: f64,
    /// Its error as [`About::error_is`] defines it, dimensionless.
    pub error: f64,
    /// Half the range of the error over copies that differ by nothing that should matter; `None` if there are none.
    pub spread: Option<f64>,
    /// CPU seconds.
    pub seconds: f64,
}

/// A measured knob.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curve {
    /// The knob.
    #[serde(flatten)]
    pub about: About,
    /// Its settings from coarse to fine.
    pub points: Vec<Point>,
}

/// All measured knobs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Accuracy {
    /// One curve per knob.
    pub knobs: Vec<Curve>,
    /// How it was measured.
    pub effort: Effort,
}

/// Why a measurement failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AccuracyError {
    /// No knob or module of that name.
    #[error("there is no knob or part `{name}`; there are: {known}")]
    UnknownPart {
        /// What was asked for.
        name: String,
        /// Names of the parts and knobs.
        known: String,
    },
    /// The dynamics of the spheres failed.
    #[error("the dynamics of the spheres failed: {0}")]
    Dynamics(#[from] pkd::PkdError),
    /// The body cannot be tiled.
    #[error("the body cannot be tiled: {0}")]
    Tiling(#[from] tiling::TilingError),
    /// Shed bodies cannot be followed.
    #[error("shed bodies cannot be followed: {0}")]
    Shed(#[from] crate::shed::ShedError),
    /// The torques cannot be computed.
    #[error("the torques cannot be computed: {0}")]
    Torque(#[from] taco::TacoError),
    /// The spin cannot be integrated.
    #[error("the spin cannot be integrated: {0}")]
    Spin(#[from] crate::evolve::spin::SpinError),
}

/// Every knob there is, in the order of the hand-off loop.
pub fn knobs() -> [&'static dyn Knob; 16] {
    [
        &hard_sphere_step::HardSphereStep,
        &soft_sphere::StepsPerContact,
        &soft_sphere::FieldTolerance,
        &soft_sphere::Skin,
        &soft_sphere::ForceError,
        &facets::Facets,
        &sampling::AZIMUTH_BINS,
        &sampling::DECLINATION_NODES,
        &sampling::OBLIQUITY_STEP,
        &sampling::FACET_SAMPLES,
        &sampling::ROTATION_CELLS,
        &sampling::SPIN_RATES,
        &spin::RK4_STEP,
        &spin::SPIN_TOLERANCE,
        &shed_orbit::Ias15Tolerance,
        &shed_orbit::MultipoleError,
    ]
}

/// All knobs, or those whose name or module is `part`.
///
/// # Errors
/// [`AccuracyError::UnknownPart`] if there is none.
pub fn select(part: Option<&str>) -> Result<Vec<&'static dyn Knob>, AccuracyError> {
    let Some(name) = part else { return Ok(knobs().into()) };
    let chosen: Vec<_> = knobs().into_iter().filter(|k| [k.about().name, k.about().part].contains(&name)).collect();
    if chosen.is_empty() {
        return Err(AccuracyError::UnknownPart { name: name.to_owned(), known: names().join(", ") });
    }
    Ok(chosen)
}

/// Names of all parts and knobs, sorted.
pub fn names() -> Vec<&'static str> {
    let mut known: Vec<_> = knobs().iter().flat_map(|k| [k.about().part, k.about().name]).collect();
    known.sort_unstable();
    known.dedup();
    known
}

/// Measures knobs; `progress` gets a line of text per point.
///
/// # Errors
/// What the measured module reports.
pub fn measure(knobs: &[&dyn Knob], effort: Effort, progress: &mut dyn FnMut(&str)) -> Result<Accuracy, AccuracyError> {
    let mut bench = Bench::new(effort, progress);
    let mut curves = Vec::new();
    for knob in knobs {
        curves.push(Curve { about: knob.about(), points: knob.points(&mut bench)? });
    }
    Ok(Accuracy { knobs: curves, effort })
}

/// A number as it is read best: short, and in powers of ten where it would be all zeros.
pub fn number(value: f64) -> String {
    if value == 0.0 || (1e-3..1e6).contains(&value.abs()) { format!("{value}") } else { format!("{value:e}") }
}

/// CPU seconds to the digits that mean something.
pub fn seconds(value: f64) -> String {
    if value < 0.01 { format!("{value:.1e}") } else { format!("{value:.3}") }
}

/// Half the difference between the largest and the smallest value.
fn half_range(values: &[f64]) -> f64 {
    let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    0.5 * (high - low)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!([19_960.0, 2.5, 1e-9, 0.0].map(number), ["19960", "2.5", "1e-9", "0"]);
        assert_eq!([12.3456, 0.05, 1.234e-5].map(seconds), ["12.346", "0.050", "1.2e-5"]);
    }

    #[test]
    fn names_are_unique_and_a_wrong_one_is_answered_with_the_right_ones() {
        let names: Vec<_> = knobs().iter().map(|k| k.about().name).collect();
        assert!(names.iter().all(|n| names.iter().filter(|m| m == &n).count() == 1));
        let chosen = |part| select(part).map(|knobs| knobs.iter().map(|k| k.about().name).collect::<Vec<_>>());
        assert_eq!(chosen(None).unwrap(), names);
        assert_eq!(chosen(Some("facets")).unwrap(), ["facets"]);
        let dynamics = ["hard_sphere_step", "steps_per_contact", "field_tolerance", "skin", "force_error"];
        assert_eq!(chosen(Some("pkd")).unwrap(), dynamics);
        let error = chosen(Some("warp")).unwrap_err().to_string();
        assert!(error.contains("warp") && names.iter().all(|n| error.contains(n)), "{error}");
    }
}
