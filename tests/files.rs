//! Files of the user are never lost: what a command writes replaces its own files only, and a run directory survives a kill
//! at any moment of its first transaction.

use std::collections::BTreeMap;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use common::{ask, file, json, open, refused, yorp};

mod common;

/// A body that is made and settled within a tenth of a second.
const SCENE: &str = r#"{
  "seed": 4,
  "body": {"packed_ellipsoid": {"spheres": 20, "radius_m": 50, "grain_density_kg_m3": 2960, "b_over_a": 0.9, "c_over_a": 0.8}},
  "spin": {"period_h": 8, "obliquity_deg": 40},
  "contact": {"hard_sphere": {"collapse_limit": 1e-3, "step_s": 60}},
  "settling": {"rotations": 1, "max_rotations": 1, "allow_reshaping": true},
  "tiling": {"facets": 100},
  "torque": {"obliquity_step_deg": 45, "declination_nodes": 5, "azimuth_bins": 16},
  "evolution": {"duration_myr": 0.01}
}"#;

/// Two spheres in contact.
const PAIR: &str = "x_m,y_m,z_m,mass_kg,radius_m\n-50,0,0,1e9,50\n50,0,0,1e9,50\n";

fn run(scene: &Path, out: &Path, more: &[&str]) -> Output {
    yorp().args(["run", "--until-myr", "0"]).arg(scene).arg("--out").arg(out).args(more).output().unwrap()
}

fn succeeded(output: &Output) {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Everything below a folder: names, kinds and contents.
fn inventory(folder: &Path) -> BTreeMap<PathBuf, String> {
    let mut all = BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
        let (path, kind) = (entry.path(), entry.file_type().unwrap());
        if kind.is_dir() {
            all.extend(inventory(&path));
        }
        let content = std::fs::read_to_string(&path).unwrap_or_default();
        all.insert(path, format!("{kind:?} {content}"));
    }
    all
}

/// A run of [`SCENE`] in `folder/run`, made and settled.
fn made(folder: &Path) -> (PathBuf, PathBuf) {
    let (scene, out) = (file(folder, "original.json", SCENE), folder.join("run"));
    succeeded(&run(&scene, &out, &[]));
    (scene, out)
}

#[test]
fn a_scene_of_somebody_else_in_the_run_directory_is_refused_and_nothing_changes() {
    let folder = tempfile::tempdir().unwrap();
    let scene = file(folder.path(), "original.json", SCENE);
    let other = SCENE.replace("\"seed\": 4", "\"seed\": 5");
    for (name, text) in [("words", "what I thought of"), ("scene", &*other), ("scene with a fault", "{\"seed\": 4,}")] {
        let out = folder.path().join(name);
        std::fs::create_dir(&out).unwrap();
        file(&out, "scene.json", text);
        for more in [&[][..], &["--resume"]] {
            let before = inventory(folder.path());
            refused(&run(&scene, &out, more), 2, "scene.json is not a file of this run");
            assert_eq!(inventory(folder.path()), before, "{name}");
        }
    }
    let out = folder.path().join("folder");
    std::fs::create_dir_all(out.join("scene.json")).unwrap();
    refused(&run(&scene, &out, &[]), 2, "scene.json is not a file of this run");
    assert!(!out.join(".lock").exists());
}

#[cfg(unix)]
#[test]
fn a_scene_behind_a_link_in_the_run_directory_stays() {
    let folder = tempfile::tempdir().unwrap();
    let scene = file(folder.path(), "original.json", SCENE);
    let mine = file(folder.path(), "mine.json", &SCENE.replace("\"seed\": 4", "\"seed\": 5"));
    for (name, target) in [("link", mine.as_path()), ("dangling", Path::new("nowhere.json"))] {
        let out = folder.path().join(name);
        std::fs::create_dir(&out).unwrap();
        std::os::unix::fs::symlink(target, out.join("scene.json")).unwrap();
        let before = inventory(folder.path());
        refused(&run(&scene, &out, &[]), 2, "scene.json is not a file of this run");
        assert_eq!(inventory(folder.path()), before);
    }
    // A longer run writes its own copy in the place of the link, not through it.
    let (scene, out) = made(folder.path());
    let kept = out.join("scene.json");
    std::fs::remove_file(&kept).unwrap();
    std::os::unix::fs::symlink(&scene, &kept).unwrap();
    let longer = file(folder.path(), "longer.json", &SCENE.replace("0.01}", "0.02}"));
    succeeded(&run(&longer, &out, &["--resume"]));
    assert_eq!(std::fs::read_to_string(&scene).unwrap(), SCENE);
    assert!(!kept.is_symlink() && std::fs::read_to_string(&kept).unwrap().contains("\"duration_myr\": 0.02"));
}

#[test]
fn a_scene_run_in_its_own_folder_keeps_the_words_of_its_user() {
    let folder = tempfile::tempdir().unwrap();
    let scene = file(folder.path(), "scene.json", SCENE);
    succeeded(&run(&scene, folder.path(), &[]));
    succeeded(&run(&scene, folder.path(), &["--resume"]));
    assert_eq!(std::fs::read_to_string(&scene).unwrap(), SCENE);
}

#[test]
fn the_copy_of_the_scene_is_written_once() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, out) = made(folder.path());
    let copy = out.join("scene.json");
    let (text, stamp) = (std::fs::read(&copy).unwrap(), copy.metadata().unwrap().modified().unwrap());
    std::thread::sleep(std::time::Duration::from_millis(20));
    succeeded(&run(&scene, &out, &["--resume"]));
    assert_eq!((std::fs::read(&copy).unwrap(), copy.metadata().unwrap().modified().unwrap()), (text, stamp));
}

#[test]
fn a_run_goes_on_from_its_own_copy_of_the_scene_though_that_was_torn_or_lost() {
    let folder = tempfile::tempdir().unwrap();
    let (_, out) = made(folder.path());
    let copy = out.join("scene.json");
    let whole = std::fs::read(&copy).unwrap();
    let zeros = [&whole[..300], &[0; 200]].concat();
    for torn in [&whole[..0], &whole[..1], &whole[..whole.len() / 2], &whole[..whole.len() - 3], &zeros] {
        std::fs::write(&copy, torn).unwrap();
        succeeded(&run(&copy, &out, &["--resume"]));
        assert!(std::fs::read(&copy).unwrap() == whole, "torn after {} bytes", torn.len());
    }
    std::fs::remove_file(&copy).unwrap();
    succeeded(&run(&copy, &out, &["--resume"]));
    assert!(std::fs::read(&copy).unwrap() == whole);
    // Broken by its user it is a file of its user.
    let broken = String::from_utf8(whole).unwrap().replacen("\"seed\": 4", "\"seed\": four", 1);
    std::fs::write(&copy, &broken).unwrap();
    refused(&run(&copy, &out, &["--resume"]), 2, "broken JSON");
    refused(&run(&folder.path().join("original.json"), &out, &["--resume"]), 2, "scene.json is not a file of this run");
    assert_eq!(std::fs::read_to_string(&copy).unwrap(), broken);
}

#[test]
fn a_run_whose_body_is_made_goes_on_without_the_file_that_it_was_made_of() {
    let folder = tempfile::tempdir().unwrap();
    file(folder.path(), "pair.csv", PAIR);
    let text = SCENE.replace(SCENE.lines().nth(2).unwrap(), r#""body": {"file": {"path": "pair.csv"}},"#);
    let (scene, out) = (file(folder.path(), "original.json", &text), folder.path().join("run"));
    succeeded(&run(&scene, &out, &[]));
    succeeded(&run(&out.join("scene.json"), &out, &["--resume"]));
    std::fs::remove_file(folder.path().join("pair.csv")).unwrap();
    succeeded(&run(&scene, &out, &["--resume"]));
    refused(&run(&scene, &folder.path().join("another"), &["--resume"]), 2, "pair.csv");
}

#[test]
fn two_processes_cannot_work_in_one_directory() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, out) = made(folder.path());
    let held = std::fs::File::open(out.join(".lock")).unwrap();
    held.lock().unwrap();
    refused(&run(&scene, &out, &["--resume"]), 2, "in use");
    drop(held);
    succeeded(&run(&scene, &out, &["--resume"]));
}

#[test]
fn a_path_into_a_run_is_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, out) = made(folder.path());
    let expected = json(&ask(&[&"classify", &"--json", &out]));
    let slash = PathBuf::from(format!("{}/", out.display()));
    for path in [out.join("run.sqlite"), out.join("scene.json"), slash] {
        assert_eq!(json(&ask(&[&"classify", &"--json", &path])), expected, "{}", path.display());
    }
    let page = json(&ask(&[&"report", &"--json", &out.join("scene.json")]));
    assert_eq!(page["page"], out.join("report/index.html").to_str().unwrap());
    succeeded(&ask(&[&"classify", &out.join("report/index.html")]));
    succeeded(&ask(&[&"export", &out.join("run.sqlite"), &"--format", &"csv"]));
    assert!(out.join("export/csv/legs.csv").is_file());
    succeeded(&run(&scene, &out.join("run.sqlite"), &["--resume"]));
    let inside = yorp().args(["classify", "run.sqlite"]).current_dir(&out).output().unwrap();
    succeeded(&inside);
    refused(&ask(&[&"classify", &scene]), 2, "original.json holds no run");
    refused(&ask(&[&"classify", &out.join("absent")]), 2, "absent holds no run");
}

#[test]
fn a_report_replaces_its_own_page_only() {
    let folder = tempfile::tempdir().unwrap();
    let (_, out) = made(folder.path());
    let report = |place: &Path| ask(&[&"report", &out, &"--out", &place]);
    let home = |name: &str| {
        let path = folder.path().join(name);
        std::fs::create_dir(&path).unwrap();
        path
    };
    let html = "<!DOCTYPE html>\n<html><head><meta name=\"generator\" content=\"Hugo\"></head></html>";
    for (name, text) in [("site", html), ("empty", ""), ("words", "<!-- yorp -->")] {
        let place = home(name);
        file(&place, "index.html", text);
        let before = inventory(&place);
        refused(&report(&place), 2, "index.html: was not written by yorp");
        refused(&ask(&[&"report", &out, &out, &"--out", &place]), 2, "index.html: was not written by yorp");
        assert_eq!(inventory(&place), before);
    }
    let place = home("paper");
    std::fs::create_dir(place.join("figures")).unwrap();
    succeeded(&report(&place));
    succeeded(&report(&place));
    let place = home("thesis");
    std::fs::create_dir(place.join("figures")).unwrap();
    file(&place.join("figures"), "spin.svg", "drawn by hand");
    let before = inventory(&place);
    refused(&report(&place), 2, "figures: was not written by yorp");
    assert_eq!(inventory(&place), before);
}

#[cfg(unix)]
#[test]
fn a_report_does_not_write_through_links() {
    let folder = tempfile::tempdir().unwrap();
    let (_, out) = made(folder.path());
    let mine = file(folder.path(), "mine.html", "mine");
    for target in [mine.as_path(), Path::new("nowhere.html")] {
        let place = tempfile::tempdir_in(&folder).unwrap();
        std::os::unix::fs::symlink(target, place.path().join("index.html")).unwrap();
        refused(&ask(&[&"report", &out, &"--out", &place.path()]), 2, "index.html: was not written by yorp");
    }
    assert_eq!(std::fs::read_to_string(mine).unwrap(), "mine");
    assert!(!folder.path().join("nowhere.html").exists());
}

#[test]
fn an_input_is_never_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let pair = file(folder.path(), "pair.csv", PAIR);
    let text = SCENE.replace(SCENE.lines().nth(2).unwrap(), r#""body": {"file": {"path": "pair.csv"}},"#);
    let scene = file(folder.path(), "scene.json", &text);
    let detour = folder.path().join("../").join(folder.path().file_name().unwrap()).join("pair.csv");
    let mut spellings = vec![pair.clone(), folder.path().join("./pair.csv"), detour];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(&pair, folder.path().join("link.csv")).unwrap();
        spellings.push(folder.path().join("link.csv"));
    }
    let before = inventory(folder.path());
    for out in &spellings {
        refused(&ask(&[&"relax", &pair, &"--duration-s", &"100", &"--out", out]), 2, "is an input of this command");
        refused(&ask(&[&"build", &scene, &"--out", out]), 2, "is an input of this command");
        refused(&ask(&[&"rigid", &scene, &"--out", out]), 2, "is an input of this command");
    }
    let mut relative = yorp();
    relative.args(["relax", "pair.csv", "--duration-s", "100", "--out", "./pair.csv"]).current_dir(&folder);
    refused(&relative.output().unwrap(), 2, "is an input of this command");
    assert_eq!(inventory(folder.path()), before);
    // Named otherwise it is what was asked for, and replaced when asked again.
    let out = folder.path().join("after.csv");
    for _ in 0..2 {
        succeeded(&ask(&[&"relax", &pair, &"--duration-s", &"100", &"--out", &out]));
    }
    assert_eq!(inventory(folder.path()).len(), before.len() + 1, "nothing else is left");
}

#[test]
fn where_a_result_cannot_go_is_said_before_it_is_computed() {
    let folder = tempfile::tempdir().unwrap();
    let scene = file(folder.path(), "scene.json", &SCENE.replace("\"spheres\": 20", "\"spheres\": 100000"));
    std::fs::create_dir(folder.path().join("taken.csv")).unwrap();
    let build = |out: &Path| ask(&[&"build", &scene, &"--out", &out]);
    refused(&build(&folder.path().join("taken.csv")), 2, "is a folder");
    refused(&build(&folder.path().join("absent/body.csv")), 4, "does not exist");
    let pair = file(folder.path(), "pair.csv", PAIR);
    let taken = folder.path().join("taken.csv");
    refused(&ask(&[&"relax", &pair, &"--rotations", &"1e9", &"--out", &taken]), 2, "is a folder");
}

#[cfg(unix)]
#[test]
fn devices_pipes_links_and_protected_files_are_what_their_owner_takes_them_for() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let pair = file(folder.path(), "pair.csv", PAIR);
    let relax = |out: &Path| ask(&[&"relax", &pair, &"--duration-s", &"100", &"--out", &out]);
    let place = |name: &str| folder.path().join(name);

    std::os::unix::fs::symlink("/dev/null", place("null.csv")).unwrap();
    succeeded(&relax(&place("null.csv")));
    assert!(place("null.csv").is_symlink());

    assert!(Command::new("mkfifo").arg(place("pipe.csv")).status().unwrap().success());
    let reader = std::thread::spawn({
        let pipe = place("pipe.csv");
        move || std::fs::read_to_string(pipe).unwrap()
    });
    succeeded(&relax(&place("pipe.csv")));
    assert!(reader.join().unwrap().starts_with("x_m,"));

    let mine = file(folder.path(), "mine.csv", "mine");
    std::os::unix::fs::symlink(&mine, place("link.csv")).unwrap();
    succeeded(&relax(&place("link.csv")));
    assert_eq!(std::fs::read_to_string(&mine).unwrap(), "mine");
    assert!(!place("link.csv").is_symlink());

    std::fs::set_permissions(&mine, PermissionsExt::from_mode(0o444)).unwrap();
    refused(&relax(&mine), 4, "mine.csv");
    assert_eq!(std::fs::read_to_string(&mine).unwrap(), "mine");
    // A new file is readable by those whom the user lets read it.
    let modes = [place("link.csv"), pair.clone()].map(|file| file.metadata().unwrap().permissions().mode());
    assert_eq!(modes[0], modes[1]);
}

#[cfg(unix)]
#[test]
fn a_run_killed_while_its_files_are_made_goes_on_with_the_first_resume() {
    let folder = tempfile::tempdir().unwrap();
    let scene = file(folder.path(), "scene.json", SCENE);
    for blocks in [0, 1, 7, 8, 9, 20, 40, 60, 80, 100, 120, 140, 160, 180] {
        let out = folder.path().join(blocks.to_string());
        // In blocks of 512 bytes; what writes more is killed by the system.
        let command = format!("ulimit -f {blocks}; exec \"$0\" run --until-myr 0 \"$1\" --out \"$2\"");
        let program = env!("CARGO_BIN_EXE_yorp");
        Command::new("sh").arg("-c").arg(command).arg(program).arg(&scene).arg(&out).output().unwrap();
        succeeded(&run(&scene, &out, &["--resume"]));
        let names = std::fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.filter(|name| !name.starts_with(".yorp-")).collect();
        names.sort();
        assert_eq!(names, [".lock", "run.sqlite", "run.sqlite-journal", "scene.json"], "{blocks}");
    }
}

#[test]
fn whoever_waits_for_a_database_says_so_and_goes_on_when_it_is_free() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, out) = made(folder.path());
    let mut classify = yorp();
    classify.arg("classify").arg(&out);
    let mut resume = yorp();
    resume.args(["run", "--resume", "--until-myr", "0"]).arg(&scene).arg("--out").arg(&out);
    for mut command in [classify, resume] {
        let holder = rusqlite::Connection::open(out.join("run.sqlite")).unwrap();
        holder.execute_batch("BEGIN EXCLUSIVE").unwrap();
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let mut said = String::new();
        BufReader::new(child.stderr.take().unwrap()).read_line(&mut said).unwrap();
        assert!(said.contains("another process holds the database"), "{said}");
        holder.execute_batch("ROLLBACK").unwrap();
        assert!(child.wait().unwrap().success());
    }
    drop(open(&out));
}
