//! The body of a scene, made and settled, without sunlight.

use pkd::Spheres;
use tiling::hull::sphere_hull_volume;

use super::aggregate::{aggregate, refuse_early};
use super::engine::ContactLaw;
use super::reshaping::{compare_with_asked, measure};
use super::settling::{begin, settle_block};
use super::{EvolveError, Observer};
use crate::scene::SceneFile;
use crate::store::Stage;

/// A body that has been made.
#[derive(Debug, Clone, PartialEq)]
pub struct Built {
    /// Its spheres, inertial frame.
    pub spheres: Spheres,
    /// Rotations of settling.
    pub rotations: f64,
    /// Whether the last block was without movement; `None` if it was not asked to settle.
    pub settled: Option<bool>,
    /// Volume of the convex hull of the spheres (B3), m^3.
    pub hull_volume_m3: f64,
}

/// Makes the body of `scene` and, if `settle` is set, lets it settle as a run would.
///
/// # Errors
/// As a run: a wrong input, a numerical failure, a body that falls apart, or an interruption.
pub fn build(scene: &SceneFile, settle: bool, observer: &mut dyn Observer) -> Result<Built, EvolveError> {
    refuse_early(&scene.scene)?;
    let mut state = begin(&scene.scene, aggregate(scene, observer)?)?;
    let built = measure(&state.spheres)?;
    let mut engine = ContactLaw::of(&scene.scene).engine(state.normal_stiffness_n_m);
    let (mut rotations, mut settled) = (0.0, None);
    while settle && state.stage == Stage::Built {
        let (next, block, _) = settle_block(&scene.scene, &mut engine, state, observer)?;
        rotations += block.dynamics.rotations;
        settled = Some(block.moved == 0 && block.shed == 0);
        state = next;
    }
    if settle {
        compare_with_asked(&scene.scene, &built, &state.spheres, observer)?;
    }
    let s = state.spheres;
    let hull_volume_m3 = sphere_hull_volume(&s.x, &s.y, &s.z, &s.radius)?;
    Ok(Built { spheres: s, rotations, settled, hull_volume_m3 })
}
