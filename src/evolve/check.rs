//! Whether an aggregate bears a new spin rate: it is given the spin, evolves at constant angular momentum, and is
//! compared with its present configuration.
//!
//! The full question of Cotto-Figueroa et al. (2015, section 2.4) evolves whole blocks of rotations, whatever they show:
//! thousands of times in a run, mostly to see nothing. The brief one looks for a time in proportion to the load that the
//! leg has added: spheres give way after some shaking, and slow spins load a body little. A look is enough while nothing
//! has left the place where it last lay at rest by more than rattling; shifts too slow for one look add up over those that
//! follow. Otherwise blocks of rotations follow until one is quiet, and where the spheres then lie is the new place of rest.

use pkd::Spheres;
use pkd::mass_properties::mass_properties;

use super::EvolveError;
use super::alignment::{TILT_LIMIT, align, give_along_spin};
use super::block::{Aggregate, Block, coordinates, evolve_block, evolve_stretch};
use super::engine::Engine;
use super::fate::shed;
use super::movement::{Movement, MovementRule, detect_movement};
use super::observer::{Observer, Progress};
use super::rigid::sphere_limit;
use super::shedding::{Breakup, Departures, on_one_body};
use crate::scene::{BriefQuestion, Question, Scene};
use crate::store::{AngularMomentumRecord, ConfigurationRecord, DynamicsRecord, Shedding, State};

/// How the aggregate answered.
#[derive(Debug, Clone, PartialEq)]
pub struct Check {
    /// The aggregate afterwards, without what left it.
    pub body: Aggregate,
    /// The rigid motion from the configuration to the aggregate and who departed from it; `None` if nothing moved.
    pub movement: Option<Movement>,
    /// Work and conservation.
    pub dynamics: DynamicsRecord,
    /// Whether the last block was without movement, or the movement need not end because the leg is repeated.
    pub settled: bool,
    /// Whether the leg is to be repeated with a fifth of its increment.
    pub discarded: bool,
    /// Where the aggregate was last seen at rest, for the next question.
    pub rest: Option<[Vec<f64>; 3]>,
    /// What left.
    pub shedding: Shedding,
    /// Set if what left is so heavy that the run ends.
    pub breakup: Option<Breakup>,
    /// Sine of the angle between the angular momentum and the axis of largest moment, before the body was aligned.
    pub non_axial: f64,
    /// Angular momentum at the start, what sunlight gave and what shed mass changed; its end is not entered yet.
    pub angular_momentum: AngularMomentumRecord,
}

/// How often the spin increment may be cut to a fifth before a movement of most spheres is accepted.
const MAX_REFINEMENT: u32 = 2;

/// Whether so much has moved that the leg is to be repeated with a smaller increment. A body that breaks has moved as a whole:
/// the spin at which it does so is worth the finer increment.
fn repeats(scene: &Scene, state: &State, moved: usize, breaks: bool) -> bool {
    let most = moved as f64 > scene.evolution.moved_fraction_limit * state.spheres.len() as f64;
    (most || breaks) && state.refinement < MAX_REFINEMENT
}

/// Gives the aggregate of `state`, at evolution time `t_s`, what sunlight gave `configuration` until its spin rate was `omega`
/// (rad/s), and evolves it until nothing differs from `configuration` or, if something does, until a block of rotations
/// shows no further movement. A movement so large that the leg is repeated is not followed to its end.
///
/// Angular momentum is handed over, C of the configuration times the change of its spin rate, not the spin rate itself:
/// while spheres creep below the movement limit C drifts by 1e-4 to 1e-3 a leg, and a body that is given C(now) omega gets
/// what its swelling would have cost on top of the torque.
///
/// # Errors
/// The integration failed, or the observer asked to stop.
pub fn check_spin(
    engine: &mut Engine,
    scene: &Scene,
    state: &State,
    [t_s, omega]: [f64; 2],
    configuration: &ConfigurationRecord,
    observer: &mut dyn Observer,
    progress: Progress,
) -> Result<Check, EvolveError> {
    let mut body = Aggregate::of(state);
    let angular_momentum = AngularMomentumRecord {
        start: mass_properties(&body.spheres)?.angular_momentum.norm(),
        torque: configuration.moments_kg_m2[2] * (omega - state.omega),
        ..AngularMomentumRecord::default()
    };
    give_along_spin(&mut body.spheres, angular_momentum.torque)?;
    let mut check = Check {
        body,
        movement: None,
        dynamics: DynamicsRecord::default(),
        settled: true,
        discarded: false,
        rest: state.rest.clone(),
        shedding: Shedding::default(),
        breakup: None,
        non_axial: 0.0,
        angular_momentum,
    };
    let mut after_rotation = |_, observer: &mut dyn Observer| observer.progress(progress);
    let mut parted = false;
    if let (Question::Brief(brief), Some(rest)) = (scene.settling.question, &state.rest) {
        let look = look_rotations(&brief, [state.omega, omega], configuration);
        let stretch = evolve_stretch(engine, &mut check.body, look, observer, &mut after_rotation)?;
        (check.dynamics, parted) = (stretch.dynamics, stretch.parting.was_off());
        let fraction = rest_radius_fraction(scene, &brief);
        if !parted
            && on_one_body(&check.body.spheres)
            && rests(rest, &check.body.spheres, fraction)
            && compare(scene, configuration, &check.body).count() == 0
        {
            check.non_axial = mass_properties(&check.body.spheres)?.across_axis();
            return Ok(check);
        }
    }
    let mut departed = 0;
    loop {
        let block = next_block(engine, scene, &mut check, parted, observer, &mut after_rotation)?;
        parted = block.parted;
        departed += block.departures.spheres.len();
        if !block.departures.spheres.is_empty() {
            book_departures(scene, &mut check, &block.departures, [t_s, omega, state.obliquity])?;
        }
        if comes_to_an_end(scene, state, configuration, &mut check, &block, departed)? {
            return Ok(check);
        }
    }
}

/// Rotations of a block in which a movement is followed, and by which fraction of its radius a sphere may shift within it.
fn block_rule(scene: &Scene) -> (f64, f64) {
    match scene.settling.question {
        Question::Full => (f64::from(scene.settling.rotations), scene.evolution.movement_radius_fraction),
        Question::Brief(brief) => (brief.block_rotations, rest_radius_fraction(scene, &brief)),
    }
}

/// The next block; what is off the body is given the time that the full question gives it to land.
fn next_block(
    engine: &mut Engine,
    scene: &Scene,
    check: &mut Check,
    parted: bool,
    observer: &mut dyn Observer,
    after_rotation: &mut impl FnMut(f64, &mut dyn Observer),
) -> Result<Block, EvolveError> {
    let (block_rotations, fraction) = block_rule(scene);
    let whole = !parted && on_one_body(&check.body.spheres);
    let rotations = if whole { block_rotations } else { f64::from(scene.settling.rotations) };
    let left = f64::from(scene.settling.max_rotations) - check.dynamics.rotations;
    let block = evolve_block(engine, &mut check.body, rotations.min(left), fraction, observer, after_rotation)?;
    check.dynamics.add(&block.dynamics);
    Ok(block)
}

/// Books what left in a block, and follows it where the scene asks for that.
fn book_departures(
    scene: &Scene,
    check: &mut Check,
    departures: &Departures,
    when: [f64; 3],
) -> Result<(), EvolveError> {
    let whole = mass_properties(&check.body.spheres)?.angular_momentum + departures.angular_momentum;
    let more = shed(scene, &mut check.body, departures, when)?;
    check.angular_momentum.shed += (whole + more.angular_momentum_change).norm() - whole.norm();
    check.shedding.losses.extend(more.losses);
    check.shedding.fates.extend(more.fates);
    check.shedding.fission = more.fission;
    check.breakup = departures.breakup;
    Ok(())
}

/// Whether the check ends with `block`, after which `departed` spheres have left in all; then its answer is entered.
fn comes_to_an_end(
    scene: &Scene,
    state: &State,
    configuration: &ConfigurationRecord,
    check: &mut Check,
    block: &Block,
    departed: usize,
) -> Result<bool, EvolveError> {
    let settling = &scene.settling;
    let moved_now = compare(scene, configuration, &check.body).count();
    let moved = moved_now > 0 || departed > 0;
    let unmoved = !moved && settling.question == Question::Full;
    let long = block.dynamics.rotations >= f64::from(settling.rotations);
    let at_rest = block.moved == 0 && block.departures.spheres.is_empty();
    let quiet = at_rest && (long || on_one_body(&check.body.spheres));
    let breaks = check.breakup.is_some();
    let discarded = repeats(scene, state, moved_now + departed, breaks);
    let too_long = check.dynamics.rotations >= f64::from(settling.max_rotations);
    if !(unmoved || quiet || breaks || discarded || too_long) {
        return Ok(false);
    }
    let tilt = mass_properties(&check.body.spheres)?.across_axis();
    check.non_axial = check.non_axial.max(tilt);
    let comes_to_rest = moved && !discarded && !breaks && on_one_body(&check.body.spheres);
    // What is left of a movement's wobble dissipates; a body that was turned much is seen at rest about its new axis first.
    if comes_to_rest && align(scene, &mut check.body)? && tilt > TILT_LIMIT && !too_long {
        return Ok(false);
    }
    check.movement = moved.then(|| compare(scene, configuration, &check.body));
    check.rest = rest_of(scene, &check.body.spheres);
    (check.settled, check.discarded) = (quiet || unmoved || discarded, discarded);
    Ok(true)
}

/// Where the spheres lie after a quiet block, for a scene whose questions are brief.
pub(super) fn rest_of(scene: &Scene, spheres: &Spheres) -> Option<[Vec<f64>; 3]> {
    match scene.settling.question {
        Question::Full => None,
        Question::Brief(_) => Some(coordinates(spheres).map(<[f64]>::to_vec)),
    }
}

/// How long to look at a body whose spin rate has changed from `before` to `after`, rad/s.
fn look_rotations(brief: &BriefQuestion, [before, after]: [f64; 2], configuration: &ConfigurationRecord) -> f64 {
    let limit = sphere_limit(configuration.densities_kg_m3[2]);
    let load = (after * after - before * before).abs() / (limit * limit);
    (brief.rotations_per_load * load).clamp(brief.glance_rotations, brief.block_rotations)
}

/// Whether no sphere has left its place of rest by more than it may.
fn rests([x, y, z]: &[Vec<f64>; 3], spheres: &Spheres, radius_fraction: f64) -> bool {
    let now = coordinates(spheres);
    detect_movement([x, y, z], now, &spheres.radius, radius_fraction, MovementRule::Robust).count() == 0
}

/// How far a sphere at rest may shift, radii.
fn rest_radius_fraction(scene: &Scene, brief: &BriefQuestion) -> f64 {
    brief.rest_fraction * scene.evolution.movement_radius_fraction
}

/// Compares `body` with the present configuration, sphere by sphere among those that are in both.
pub fn compare(scene: &Scene, configuration: &ConfigurationRecord, body: &Aggregate) -> Movement {
    let mut ids = body.ids.iter().peekable();
    let mut recorded: [Vec<f64>; 3] = Default::default();
    for (id, position) in configuration.sphere_ids.iter().zip(&configuration.positions) {
        if ids.next_if_eq(&id).is_some() {
            for (column, value) in recorded.iter_mut().zip(position) {
                column.push(*value);
            }
        }
    }
    let [x, y, z] = &recorded;
    let evolution = &scene.evolution;
    detect_movement(
        [x, y, z],
        coordinates(&body.spheres),
        &body.spheres.radius,
        evolution.movement_radius_fraction,
        evolution.movement_rule,
    )
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use nalgebra::Vector3;
    use pkd::frame::{set_rigid_rotation, to_principal_axes};
    use pkd::packing::{Grain, carve, hcp_lattice};

    use super::*;
    use crate::evolve::Silent;
    use crate::evolve::configuration::{Original, object_0};
    use crate::evolve::engine::ContactLaw;
    use crate::evolve::settling::begin;
    use crate::store::Ledger;

    /// A lattice turning once in ten hours, and its configuration.
    fn lattice(scene: &Scene) -> (State, ConfigurationRecord) {
        let grain = Grain { radius: 50.0, density: 2960.0 };
        let block = hcp_lattice([400.0; 3], grain).unwrap();
        let inside = |[x, y, z]: [f64; 3]| (x / 320.0).powi(2) + (y / 260.0).powi(2) + (z / 220.0).powi(2) < 1.0;
        let mut spheres = carve(&block, inside).unwrap();
        to_principal_axes(&mut spheres).unwrap();
        set_rigid_rotation(&mut spheres, Vector3::z() * 1.7e-4).unwrap();
        let mut state = begin(scene, spheres).unwrap();
        state.rest = rest_of(scene, &state.spheres);
        let original = Original::new(scene, &state.spheres).unwrap();
        let shape = object_0(scene, &original, &state, &mut Ledger::default()).unwrap();
        (state, shape.record)
    }

    fn ask(scene: &Scene, state: &State, configuration: &ConfigurationRecord, omega: f64) -> Check {
        let progress = Progress::Building { stretches: 0 };
        check_spin(
            &mut ContactLaw::of(scene).engine(None),
            scene,
            state,
            [0.0, omega],
            configuration,
            &mut Silent,
            progress,
        )
        .unwrap()
    }

    fn scene(settling: &str) -> Scene {
        let body = r#""body": {"packed_ellipsoid": {"spheres": 10, "radius_m": 50, "grain_density_kg_m3": 2960, "b_over_a": 1, "c_over_a": 1}}"#;
        let text = format!(r#"{{{body}, "tiling": {{"facets": 100}}, "settling": {settling}}}"#);
        Scene::parse(&text, Path::new("test")).unwrap()
    }

    /// The load is the change of the spin rate squared over 4 pi G rho / 3, rho by the hull.
    #[test]
    fn a_look_at_a_body_at_rest_is_as_long_as_the_load_asks_within_its_bounds() {
        let scene = scene("{}");
        let (state, configuration) = lattice(&scene);
        let limit_squared = 4.0 / 3.0 * std::f64::consts::PI * pkd::constants::G * configuration.densities_kg_m3[2];
        let look = |omega: f64| {
            let check = ask(&scene, &state, &configuration, omega);
            assert!(check.movement.is_none() && check.settled && check.rest == state.rest);
            check.dynamics.rotations
        };
        for change in [1.005_f64, 0.995] {
            let load = (change * change - 1.0).abs() * state.omega.powi(2) / limit_squared;
            let expected = 500.0 * load;
            assert!((0.1..1.0).contains(&expected), "{expected}");
            assert!((look(change * state.omega) / expected - 1.0).abs() < 1e-9);
        }
        assert_eq!([look(1.0001 * state.omega), look(1.05 * state.omega)], [0.1, 1.0]);
    }

    #[test]
    fn a_falling_stone_is_seen_by_a_glance_and_followed_until_it_lies() {
        let scene = scene("{}");
        let (mut state, configuration) = lattice(&scene);
        let top = (0..state.spheres.len()).max_by(|i, j| state.spheres.z[*i].total_cmp(&state.spheres.z[*j])).unwrap();
        state.spheres.z[top] += 60.0;
        state.spheres.vx[top] += 0.1;
        let check = ask(&scene, &state, &configuration, state.omega);
        assert!(check.dynamics.rotations > 1.0 && check.settled);
        assert!(check.movement.is_some_and(|movement| movement.moved[top]));
        assert_ne!(check.rest, state.rest);
    }

    #[test]
    fn the_full_question_takes_whole_blocks() {
        let scene = scene(r#"{"rotations": 2, "question": "full"}"#);
        let (state, configuration) = lattice(&scene);
        let check = ask(&scene, &state, &configuration, state.omega);
        assert_eq!((check.dynamics.rotations, check.rest), (2.0, None));
        assert!(check.movement.is_none());
    }
}
