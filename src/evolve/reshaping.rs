//! Whether the body that has settled is still the one that was asked for.

use pkd::Spheres;
use pkd::clusters::clusters;
use pkd::mass_properties::mass_properties;

use super::{EvolveError, Observer};
use crate::scene::{Body, Scene};
use crate::store::BuiltRecord;

/// Differences between asked and found above which the user is told: of an axis ratio, and relative of period and density.
const TOLD: f64 = 0.03;
/// Change of an axis ratio by settling above which the body is refused.
const LARGEST_RATIO_CHANGE: f64 = 0.15;
/// Relative change of the period by settling above which the body is refused.
const LARGEST_PERIOD_CHANGE: f64 = 0.25;
/// What is farther from the rest than this, radii, is about to leave and says nothing about the body's shape.
const BODY_GAP_OVER_RADIUS: f64 = 1.0;

/// Axis ratios (B1), density and period of `spheres`, without what is far from them.
///
/// # Errors
/// A sphere that is not finite.
pub fn measure(spheres: &Spheres) -> Result<BuiltRecord, EvolveError> {
    let pieces = clusters(spheres, BODY_GAP_OVER_RADIUS);
    let mut keep = vec![false; spheres.len()];
    pieces.first().into_iter().flat_map(|main| &main.members).for_each(|i| keep[*i as usize] = true);
    let properties = mass_properties(&spheres.filtered(&keep))?;
    let axes = properties.deeve_axes();
    Ok(BuiltRecord {
        b_over_a: axes.y / axes.x,
        c_over_a: axes.z / axes.x,
        density_kg_m3: properties.deeve_density(),
        period_s: std::f64::consts::TAU / properties.spin_rate(),
    })
}

/// Tells what differs between what was asked for and the `settled` spheres of a body that was `built` so.
///
/// # Errors
/// [`EvolveError::Reshaped`] if settling made another body of it, unless the scene means that.
pub fn compare_with_asked(
    scene: &Scene,
    built: &BuiltRecord,
    settled: &Spheres,
    observer: &mut dyn Observer,
) -> Result<(), EvolveError> {
    let found = measure(settled)?;
    let asked = asked(scene, built);
    let differences = differences(&asked, &found);
    if !differences.is_empty() {
        observer.warn(&format!("the settled body is not the one asked for: {}", differences.join(", ")));
    }
    let ratio = (found.b_over_a - built.b_over_a).abs().max((found.c_over_a - built.c_over_a).abs());
    let period = relative(found.period_s, built.period_s);
    if scene.settling.allow_reshaping || (ratio <= LARGEST_RATIO_CHANGE && period <= LARGEST_PERIOD_CHANGE) {
        return Ok(());
    }
    Err(EvolveError::Reshaped { built: Box::new(*built), settled: Box::new(found) })
}

/// What the scene asks for, where it says so: the ratios of a packed ellipsoid. Else the body as it was made, whose shape is
/// that of its mesh or file.
fn asked(scene: &Scene, built: &BuiltRecord) -> BuiltRecord {
    match &scene.body {
        Body::PackedEllipsoid(body) => BuiltRecord { b_over_a: body.b_over_a, c_over_a: body.c_over_a, ..*built },
        Body::File(_) | Body::CarvedMesh(_) => *built,
    }
}

fn differences(asked: &BuiltRecord, found: &BuiltRecord) -> Vec<String> {
    let mut told = Vec::new();
    for (name, asked, found) in [("b/a", asked.b_over_a, found.b_over_a), ("c/a", asked.c_over_a, found.c_over_a)] {
        if (found - asked).abs() > TOLD {
            told.push(format!("{name} {found:.3} (asked {asked:.3})"));
        }
    }
    if relative(found.period_s, asked.period_s) > TOLD {
        told.push(format!("period {:.3} h (asked {:.3})", found.period_s / 3600.0, asked.period_s / 3600.0));
    }
    if relative(found.density_kg_m3, asked.density_kg_m3) > TOLD {
        told.push(format!("density (B1) {:.0} kg/m3 (as made {:.0})", found.density_kg_m3, asked.density_kg_m3));
    }
    told
}

/// Not a number, as of two bodies at rest, is no difference.
fn relative(found: f64, asked: f64) -> f64 {
    let change = (found / asked - 1.0).abs();
    if change.is_nan() { 0.0 } else { change }
}
