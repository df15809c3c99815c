//! Tests of the run directory: who may open it, and whether what goes in comes out bit for bit.

use super::*;
use crate::scene::{Body, FileBody, Scene};

fn scene() -> Scene {
    Scene::from_body(Body::File(FileBody { path: "a.csv".into() }))
}

fn state(n: usize) -> State {
    let mut spheres = pkd::Spheres::default();
    for i in 0..n {
        let v = 0.1 + i as f64;
        spheres.push([v, -v, 1e-300], [v.sqrt(), 0.0, -0.0], [1e-4, v, 3.0], 1e9, 50.2);
    }
    State {
        stage: Stage::Built,
        outcome: None,
        blocks: 0,
        leg: 0,
        configuration: None,
        refinement: 0,
        t_s: 0.0,
        omega: 3e-4,
        obliquity: 0.1,
        spheres,
        sphere_ids: (0..n as u32).collect(),
    }
}

fn configuration() -> ConfigurationRecord {
    ConfigurationRecord {
        configuration: 0,
        after_leg: None,
        t_s: 0.0,
        mass_kg: 3e9,
        sphere_ids: vec![0, 1, 2],
        positions: vec![[0.1; 3], [0.2; 3], [0.3; 3]],
        body_axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        centre_of_mass: [0.1, 0.2, 0.3],
        moments_kg_m2: [1.0, 2.0, 3.0],
        b1_axes_m: [3.0, 2.0, 1.0],
        b2_axes_m: [3.1, 2.1, 1.1],
        densities_kg_m3: [1.0, 2.0, 3.0, 4.0],
        vertices: vec![[1.0, 2.0, 3.0]; 4],
        vertices_kept: 0,
        vertices_flagged: 1,
        facets_folded: 2,
        torque: TorqueRecord {
            obliquity: vec![0.0, 1.0],
            spin_rate: vec![3e-4],
            spin_torque: vec![0.5, 0.6],
            obliquity_torque: vec![0.0, 0.7],
            spin_torque_error: 1e-3,
            obliquity_torque_error: 2e-3,
        },
    }
}

#[test]
fn what_is_stored_comes_back_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let ledger = Ledger::default();
    let mut written = state(3);
    let object_0 = configuration();
    let tiling = TilingRecord {
        facets: vec![[0, 1, 2], [0, 2, 3]],
        ellipsoid_axes_m: [3.0, 2.0, 1.0],
        frame_rotation: object_0.body_axes,
    };
    {
        let (mut store, existing) = RunStore::open(folder.path(), &scene(), false).unwrap();
        assert!(!existing && store.state().unwrap().is_none());
        store.save_built(&written, &ledger).unwrap();
        written.stage = Stage::Evolving;
        written.configuration = Some(0);
        store.save_object_0(&tiling, &object_0, &[], &written, &ledger).unwrap();
    }
    let (store, existing) = RunStore::open(folder.path(), &scene(), true).unwrap();
    assert!(existing);
    let read = store.state().unwrap().unwrap();
    assert_eq!(read, written);
    assert_eq!(read.spheres.vz[0].to_bits(), (-0.0_f64).to_bits());
    assert_eq!(store.latest_configuration().unwrap(), Some(object_0));
    assert_eq!(store.tiling().unwrap(), Some(tiling));
}

#[test]
fn a_directory_that_holds_a_run_is_refused_without_resume() {
    let folder = tempfile::tempdir().unwrap();
    drop(RunStore::open(folder.path(), &scene(), false).unwrap());
    assert!(matches!(RunStore::open(folder.path(), &scene(), false), Err(StoreError::HoldsRun(_))));
    assert!(RunStore::open(folder.path(), &scene(), true).is_ok());
}

#[test]
fn two_runs_cannot_share_a_directory() {
    let folder = tempfile::tempdir().unwrap();
    let held = RunStore::open(folder.path(), &scene(), false).unwrap();
    assert!(matches!(RunStore::open(folder.path(), &scene(), true), Err(StoreError::Locked(_))));
    drop(held);
    assert!(RunStore::open(folder.path(), &scene(), true).is_ok());
}

#[test]
fn another_scene_is_refused_by_its_first_differing_path_but_a_longer_one_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    drop(RunStore::open(folder.path(), &scene(), false).unwrap());
    let mut other = scene();
    other.spin.period_h = 7.0;
    let Err(error) = RunStore::open(folder.path(), &other, true) else { panic!("accepted another scene") };
    assert!(error.to_string().contains("spin.period_h"), "{error}");
    let mut longer = scene();
    longer.evolution.duration_myr = 30.0;
    drop(RunStore::open(folder.path(), &longer, true).unwrap());
    // From now on it is the longer run.
    assert!(matches!(RunStore::open(folder.path(), &scene(), true), Err(StoreError::SceneDiffers { .. })));
}

#[test]
fn foreign_newer_and_broken_databases_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.sqlite");
    let open = || RunStore::open(folder.path(), &scene(), true).err();
    std::fs::write(&path, "this is no database, whatever its name says").unwrap();
    assert!(matches!(open(), Some(StoreError::Foreign { .. })));
    std::fs::remove_file(&path).unwrap();
    Connection::open(&path).unwrap().execute_batch("PRAGMA application_id = 5; CREATE TABLE t (x);").unwrap();
    assert!(matches!(open(), Some(StoreError::Foreign { .. })));
    std::fs::remove_file(&path).unwrap();
    drop(RunStore::open(folder.path(), &scene(), false).unwrap());
    Connection::open(&path).unwrap().execute_batch("PRAGMA user_version = 99;").unwrap();
    assert!(matches!(open(), Some(StoreError::Version { found: 99, .. })));
}

#[test]
fn a_directory_left_by_a_kill_during_creation_starts_anew() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.json"), "").unwrap();
    std::fs::write(folder.path().join("run.sqlite"), "").unwrap();
    let (_, existing) = RunStore::open(folder.path(), &scene(), false).unwrap();
    assert!(!existing);
}

#[test]
fn a_file_in_the_place_of_the_directory_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file");
    std::fs::write(&path, "x").unwrap();
    assert!(matches!(RunStore::open(&path, &scene(), false), Err(StoreError::NotADirectory(_))));
}
