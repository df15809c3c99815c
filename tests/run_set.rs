//! The script that runs, lists and digests the sets of docs/results: killed and resumed at random it gives the same
//! databases, and its page comes from its small tables alone. Skipped where there is no Python (set `PYTHON` to choose one).
#![cfg(target_os = "linux")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

/// A body that settles, takes legs and moves within seconds.
const SCENE: &str = r#"{
  "name": "NAME",
  "seed": SEED,
  "body": {"packed_ellipsoid": {"spheres": 60, "radius_m": 50.2, "grain_density_kg_m3": 2960, "b_over_a": 0.8, "c_over_a": 0.7}},
  "spin": {"period_h": 4.5, "obliquity_deg": 40},
  "contact": {"hard_sphere": {"collapse_limit": 1e-3, "step_s": 100}},
  "settling": {"rotations": 1, "max_rotations": 5},
  "tiling": {"facets": 200},
  "torque": {"obliquity_step_deg": 15},
  "evolution": {"duration_myr": 1, "spin_change": 0.01, "movement_radius_fraction": 0.1}
}"#;

fn python() -> Option<String> {
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".into());
    let works = Command::new(&python).args(["-c", "import sqlite3"]).output().is_ok_and(|o| o.status.success());
    if !works {
        println!("skipped: {python} cannot be run or has no sqlite3");
    }
    works.then_some(python)
}

/// The scenes 01 and 02 of a set in `folder`, and a command of the script on them.
struct Set {
    python: String,
    folder: PathBuf,
}

impl Set {
    fn new(python: String, folder: &Path) -> Self {
        std::fs::create_dir(folder.join("scenes")).unwrap();
        for (name, seed) in [("01", "4"), ("02", "5")] {
            let scene = SCENE.replace("NAME", name).replace("SEED", seed);
            std::fs::write(folder.join("scenes").join(name).with_extension("json"), scene).unwrap();
        }
        Self { python, folder: folder.to_owned() }
    }

    fn script(&self, out: &str, arguments: &[&str]) -> Command {
        let mut command = Command::new(&self.python);
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/cotto_figueroa_2015.py");
        command.arg(script).args(arguments).args(["--yorp", env!("CARGO_BIN_EXE_yorp")]);
        command.arg("--scenes").arg(self.folder.join("scenes")).arg("--out").arg(self.folder.join(out));
        command.arg("--tables").arg(self.folder.join("tables"));
        command
    }

    fn run(&self, out: &str, step: &str) -> Command {
        self.script(out, &["run", "--until-myr", "0.03", "--step-myr", step, "--jobs", "2"])
    }
}

fn succeeded(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Processes whose parent is `parent`.
fn children(parent: u32) -> Vec<String> {
    let stat = |pid: &str| std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
    let pids = std::fs::read_dir("/proc").unwrap().filter_map(|entry| entry.unwrap().file_name().into_string().ok());
    // "pid (name) state parent ..."
    let parent_of =
        |pid: &str| stat(pid).rsplit(')').next().and_then(|rest| rest.split_whitespace().nth(1)?.parse().ok());
    pids.filter(|pid| parent_of(pid) == Some(parent)).collect()
}

#[test]
fn a_set_killed_and_resumed_at_random_gives_the_same_databases_and_tables() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let set = Set::new(python, folder.path());
    succeeded(&set.run("whole", "1").output().unwrap());

    for milliseconds in [700, 1300, 2100, 400, 1700] {
        let mut script = set.run("killed", "0.01").stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(milliseconds));
        let runs = children(script.id());
        script.kill().unwrap();
        script.wait().unwrap();
        let _ = Command::new("kill").arg("-9").args(runs).stderr(Stdio::null()).status();
    }
    succeeded(&set.run("killed", "0.007").output().unwrap());
    let (whole, killed) = (folder.path().join("whole"), folder.path().join("killed"));
    let mut compare = set.script("whole", &["compare"]);
    let same = succeeded(&compare.arg(&whole).arg(&killed).output().unwrap());
    assert_eq!(same.trim(), "2 runs, all the same");

    let listed = succeeded(&set.script("killed", &["list"]).output().unwrap());
    assert!(listed.lines().any(|line| line.starts_with("02 ") && line.contains("0.0300")), "{listed}");

    // The page needs the small tables only, and the same runs give the same numbers but for their cost.
    let page = succeeded(&set.script("killed", &["digest"]).output().unwrap());
    assert!(page.contains("| *paper* | *2.4* | *9.1* |"), "{page}");
    // Counted from the paper's tables as typed in, and stated in its section 3.1.
    for stated in ["| 9 of 16 |", "| 11 of 16 |", "| 11, 5, 3, 4, 1 |", "| 11, 5, 2, 2, 1 |"] {
        assert!(page.contains(stated), "{stated} is not in {page}");
    }
    std::fs::remove_dir_all(&killed).unwrap();
    assert_eq!(succeeded(&set.script("killed", &["page"]).output().unwrap()), page);
}

#[test]
fn two_instances_of_a_set_do_not_disturb_each_other() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let set = Set::new(python, folder.path());
    let instance = || set.run("both", "0.01").stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let (first, second) = (instance(), instance());
    succeeded(&first.wait_with_output().unwrap());
    succeeded(&second.wait_with_output().unwrap());
    let listed = succeeded(&set.script("both", &["list"]).output().unwrap());
    assert_eq!(listed.matches("0.0300").count(), 2, "{listed}");
}
