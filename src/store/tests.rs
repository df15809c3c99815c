//! Tests of the run directory: who may open it, and whether what goes in comes out bit for bit.

use super::*;
use crate::scene::{Body, FileBody, Scene};
use pkd::soft_sphere::{Contact, ContactHistory};

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
        normal_stiffness_n_m: None,
        contacts: ContactHistory::default(),
        rest: Some([0.0, 1.0, 2.0].map(|v| vec![v; n])),
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
        store.save_built(&BUILT, &written, &ledger).unwrap();
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
fn memory_of_soft_contacts_comes_back_bit_for_bit_and_only_where_it_fits() {
    let folder = tempfile::tempdir().unwrap();
    let contact = |first, second| Contact::from_memory([first, second], [0.1, -0.0, 1e-300, 4.0, 5.0, 6.0, 7.0, 8.0]);
    let contacts = ContactHistory::new(vec![contact(0, 2), contact(1, 2)]).unwrap();
    let written = State { normal_stiffness_n_m: Some(2.6e7), contacts, ..state(3) };
    let (mut store, _) = RunStore::open(folder.path(), &scene(), false).unwrap();
    store.save_built(&BUILT, &written, &Ledger::default()).unwrap();
    let read = store.state().unwrap().unwrap();
    assert_eq!(read, written);
    assert_eq!(read.contacts.contacts()[1].sliding_m[1].to_bits(), (-0.0_f64).to_bits());
    for damage in ["contacts = zeroblob(64)", "contact_rows = X'0000000003000000', contacts = zeroblob(64)"] {
        store.connection.execute(&format!("UPDATE state SET {damage}"), []).unwrap();
        assert!(matches!(store.state(), Err(StoreError::Damaged { .. })), "{damage}");
    }
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

/// The files of a run that has just been made.
fn fresh_database() -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    files::create(&database_path(folder.path()), &scene()).unwrap();
    std::fs::read(database_path(folder.path())).unwrap()
}

/// Where a kill may have cut off the first `length` bytes that were written.
fn cuts(length: usize) -> Vec<usize> {
    let pages = (1..length / 4096).flat_map(|page| [4096 * page, 4096 * page + 700]);
    [0, 1, 15, 16, 50, 99, 100, 1000, length - 1].into_iter().chain(pages).collect()
}

#[test]
fn a_kill_during_the_first_transaction_leaves_a_directory_without_a_run() {
    let whole = fresh_database();
    for (name, more) in [("run.sqlite", 0), ("run.sqlite.partial", 1)] {
        for cut in cuts(whole.len() + more) {
            let folder = tempfile::tempdir().unwrap();
            std::fs::write(folder.path().join(name), &whole[..cut]).unwrap();
            assert!(matches!(RunReader::open(folder.path()), Err(StoreError::NoRun(_))), "{name} of {cut} bytes");
            let (store, existing) = RunStore::open(folder.path(), &scene(), cut % 2 == 0).unwrap();
            assert!(!existing && store.scene().unwrap() == scene(), "{name} of {cut} bytes");
            drop(store);
            assert!(!folder.path().join("run.sqlite.partial").exists());
            assert!(RunStore::open(folder.path(), &scene(), true).unwrap().1);
        }
    }
}

/// As builds before this one did it: in place, with a journal.
#[test]
fn a_first_transaction_that_only_its_journal_knows_is_taken_back_and_done_again() {
    let (whole, folder) = (fresh_database(), tempfile::tempdir().unwrap());
    let [database, journal] = ["run.sqlite", "run.sqlite-journal"].map(|name| folder.path().join(name));
    let writer = Connection::open(&database).unwrap();
    let tables = include_str!("schema.sql");
    let pragmas = format!("PRAGMA application_id = {APPLICATION_ID}; PRAGMA user_version = {FORMAT_VERSION};");
    writer.execute_batch(&format!("PRAGMA cache_size = 1; BEGIN; {pragmas} {tables}")).unwrap();
    writer.execute("INSERT INTO run VALUES ('filler', hex(zeroblob(100000)))", []).unwrap();
    let [half, kept] = [&database, &journal].map(|file| std::fs::read(file).unwrap());
    drop(writer);
    assert!(!half.is_empty() && !kept.is_empty());
    for (main, journal) in [(&half[..], &kept[..]), (&whole[..4096], &kept), (&[], &kept)] {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("run.sqlite"), main).unwrap();
        std::fs::write(folder.path().join("run.sqlite-journal"), journal).unwrap();
        let (store, existing) = RunStore::open(folder.path(), &scene(), true).unwrap();
        assert!(!existing && store.scene().unwrap() == scene());
    }
}

#[test]
fn a_run_that_has_gone_on_and_was_cut_off_is_never_taken_for_an_unfinished_one() {
    let folder = tempfile::tempdir().unwrap();
    drop(RunStore::open(folder.path(), &scene(), false).unwrap());
    let path = database_path(folder.path());
    let whole = std::fs::read(&path).unwrap();
    for cut in cuts(whole.len()).into_iter().filter(|cut| *cut >= 100) {
        std::fs::write(&path, &whole[..cut]).unwrap();
        assert!(RunStore::open(folder.path(), &scene(), true).is_err());
        assert_eq!(std::fs::read(&path).unwrap().len(), cut);
    }
}

#[test]
fn files_of_somebody_else_beside_the_database_stay() {
    for name in ["run.sqlite.partial", "run.sqlite-journal"] {
        let folder = tempfile::tempdir().unwrap();
        let mine = folder.path().join(name);
        std::fs::write(&mine, "my notes").unwrap();
        let refused = RunStore::open(folder.path(), &scene(), false).unwrap_err();
        assert!(matches!(refused, StoreError::ForeignFile(_)), "{refused}");
        assert_eq!(std::fs::read_to_string(&mine).unwrap(), "my notes");
    }
}

#[test]
fn a_file_in_the_place_of_the_directory_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file");
    std::fs::write(&path, "x").unwrap();
    assert!(matches!(RunStore::open(&path, &scene(), false), Err(StoreError::NotADirectory(_))));
}

const BUILT: BuiltRecord = BuiltRecord { b_over_a: 0.9, c_over_a: 0.7, density_kg_m3: 1700.0, period_s: 2e4 };

#[test]
fn a_reader_gets_every_table_as_it_was_written_and_does_not_stop_the_run() {
    let folder = tempfile::tempdir().unwrap();
    assert!(matches!(RunReader::open(folder.path()), Err(StoreError::NoRun(_))));
    let (mut store, _) = RunStore::open(folder.path(), &scene(), false).unwrap();
    let (ledger, mut now) = (Ledger::default(), state(3));
    store.save_built(&BUILT, &now, &ledger).unwrap();
    let block = SettlingRecord {
        block: 0,
        period_s: 2e4,
        moved: 2,
        max_displacement_radii: 0.5,
        b_over_a: 0.9,
        c_over_a: 0.8,
        dynamics: DynamicsRecord { rotations: 5.0, collisions: 7, capped: 1, ..Default::default() },
        angular_momentum: 4e13,
        non_axial: 0.03,
        shed: 0,
    };
    store.save_settling(&block, &Shedding::default(), &now, &ledger).unwrap();
    let facets = TilingRecord { facets: vec![[0, 1, 2]], ellipsoid_axes_m: [1.0; 3], frame_rotation: [[0.0; 3]; 3] };
    let rigid = [RigidRecord { t_s: 0.0, omega: 3e-4, obliquity: 0.1 }];
    store.save_object_0(&facets, &configuration(), &rigid, &now, &ledger).unwrap();
    let leg = LegRecord {
        leg: 0,
        configuration: 0,
        t_s: [0.0, 1e11],
        omega: [3e-4, 3.1e-4],
        obliquity: [0.1, 0.2],
        reason: "spin_change".into(),
        refinement: 0,
        rk4_steps: 4,
        spin_error: 1e-9,
        obliquity_error: 1e-10,
        result: "movement".into(),
        omega_after: 3.05e-4,
        dynamics: DynamicsRecord { rotations: 2.0, max_overlap_radii: 0.1, momentum_drift: 0.2, ..Default::default() },
        moved: [1, 2, 3],
        settled: true,
        non_axial: 0.01,
        angular_momentum: AngularMomentumRecord { start: 4e13, torque: 2e12, shed: -1e12, end: 5e13, over_spin: 1.0 },
        shed: 1,
    };
    let movement = MovementRecord { sphere: 1, displacement_m: 20.0, enclosed_mass_fraction: 0.5 };
    let loss = LossRecord {
        sphere: 2,
        t_s: 1e11,
        omega: 3.1e-4,
        position: [1.0, 2.0, 3.0],
        velocity: [4.0, 5.0, 6.0],
        spin: [7.0, 8.0, 9.0],
        energy_j: -1.0,
    };
    let fate = FateRecord {
        sphere: 2,
        fate: "bound".into(),
        t_s: 5.0,
        speed_m_s: None,
        position: None,
        orbit: Some([1.0, 0.5, 0.1]),
        within_3_radii: Some(0.25),
        into: None,
        returned: false,
        angular_momentum: Some([0.0, 0.0, 1.0]),
    };
    let fission = FissionRecord {
        mass_kg: [2.0, 1.0],
        spheres: vec![2],
        fate: "separated".into(),
        t_s: 9.0,
        speed_m_s: Some(0.3),
        orbit: None,
        spin_rate: [1e-4, 2e-4],
    };
    let shedding = Shedding {
        losses: vec![loss],
        fates: vec![fate.clone()],
        fission: Some(fission.clone()),
        ..Shedding::default()
    };
    let second = ConfigurationRecord { configuration: 1, after_leg: Some(0), t_s: 1e11, ..configuration() };
    now.leg = 1;
    let commit = LegCommit { leg: &leg, state: &now, configuration: Some((&second, &[movement])), shedding: &shedding };
    let reader = RunReader::open(folder.path()).unwrap();
    let before = reader.snapshot(|reader| Ok((reader.legs()?, reader.rigid()?))).unwrap();
    assert_eq!(before, (vec![], rigid.to_vec()));
    store.save_leg(&commit, &ledger).unwrap();

    assert_eq!(reader.spheres().unwrap(), [[1e9, 50.2]; 3]);
    assert_eq!(reader.built().unwrap(), Some(BUILT));
    assert_eq!(reader.settling().unwrap(), [block]);
    assert_eq!(reader.configurations().unwrap(), [configuration(), second]);
    let leg_books = leg.angular_momentum;
    assert_eq!(leg_books.error(), 9e12 / 5e13);
    assert_eq!(reader.legs().unwrap(), [leg]);
    let totals = reader.totals().unwrap();
    assert_eq!((totals.angular_momentum, totals.angular_momentum_error), (leg_books, 9e12 / 5e13));
    assert_eq!(reader.movements().unwrap(), [(1, movement)]);
    assert_eq!(reader.losses().unwrap(), [(Some(0), loss)]);
    assert_eq!(reader.fates().unwrap(), [(Some(0), fate)]);
    assert_eq!(reader.fission().unwrap(), Some((Some(0), fission)));
    let interval = reader.intervals().unwrap()[0];
    assert_eq!((interval.configuration, interval.legs, interval.omega), (0, 1, [3e-4, 3.1e-4]));
    assert_eq!(reader.sessions().unwrap().len(), 1);
    assert_eq!(reader.version().unwrap(), env!("CARGO_PKG_VERSION"));
    assert!(reader.connection.execute("DELETE FROM leg", []).is_err(), "it cannot write");
}
