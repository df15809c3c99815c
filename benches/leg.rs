//! Cost of a leg on a settled body of 200 spheres: the check of a spin that the body bears, and the tiling, torques and
//! record that follow a movement. Figures for 1000 spheres stand in the ledger of any run (table `meta_part`).

use std::path::Path;
use std::sync::LazyLock;

use yorp::evolve::block::Aggregate;
use yorp::evolve::build::build;
use yorp::evolve::check::{check_spin, compare};
use yorp::evolve::configuration::{Original, Shape, next_object, object_0};
use yorp::evolve::engine::ContactLaw;
use yorp::evolve::settling::begin;
use yorp::evolve::{Progress, Silent};
use yorp::scene::{Scene, SceneFile};
use yorp::store::{Ledger, State};

const SCENE: &str = r#"{"seed": 1, "spin": {"period_h": 5}, "body": {"packed_ellipsoid":
    {"spheres": 200, "radius_m": 50.2, "grain_density_kg_m3": 2960, "b_over_a": 0.8, "c_over_a": 0.7}}}"#;

struct Body {
    scene: Scene,
    state: State,
    original: Original,
    shape: Shape,
}

static BODY: LazyLock<Body> = LazyLock::new(|| {
    let scene = Scene::parse(SCENE, Path::new("bench")).expect("a valid scene");
    let file = SceneFile { scene: scene.clone(), file: "bench".into() };
    let spheres = build(&file, true, &mut Silent).expect("the body settles").spheres;
    let original = Original::new(&scene, &spheres).expect("the body has a hull");
    let state = begin(&scene, spheres).expect("finite spheres");
    let shape = object_0(&scene, &original, &state, &mut Ledger::default()).expect("the body can be tiled");
    Body { scene, state, original, shape }
});

fn main() {
    LazyLock::force(&BODY);
    divan::main();
}

#[divan::bench(sample_count = 5, sample_size = 1)]
fn check_of_a_spin_that_the_body_bears() {
    let Body { scene, state, shape, .. } = &*BODY;
    let mut engine = ContactLaw::of(scene).engine(state.normal_stiffness_n_m);
    let check = check_spin(
        &mut engine,
        scene,
        state,
        [state.t_s, 0.999 * state.omega],
        &shape.record,
        &mut Silent,
        Progress::Building { stretches: 0 },
    );
    assert!(check.expect("the body bears it").movement.is_none());
}

#[divan::bench(sample_count = 20, sample_size = 1)]
fn tiling_and_torques_after_a_movement() -> Shape {
    let Body { scene, state, original, shape } = &*BODY;
    // Three spheres on the surface, farthest along three axes, shift by a third of a radius.
    let mut after = state.clone();
    for column in [&mut after.spheres.x, &mut after.spheres.y, &mut after.spheres.z] {
        let farthest = (0..column.len()).max_by(|i, j| column[*i].total_cmp(&column[*j])).expect("not empty");
        column[farthest] += 17.0;
    }
    let body = Aggregate::of(&after);
    let movement = compare(scene, &shape.record, &body);
    next_object(scene, original, shape, state, &after, &movement, &mut Ledger::default()).expect("can be tiled").0
}
