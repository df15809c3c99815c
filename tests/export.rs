//! `yorp export` as a user meets it: every format read back by the programs it is for, and folders that are not ours.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

/// A body small and loose enough to move and be tiled again within seconds.
const SCENE: &str = r#"{
  "name": "export, \"quoted\"",
  "seed": 4,
  "body": {"packed_ellipsoid": {"spheres": 60, "radius_m": 50.2, "grain_density_kg_m3": 2960, "b_over_a": 0.8, "c_over_a": 0.7}},
  "spin": {"period_h": 4.5, "obliquity_deg": 40},
  "contact": {"hard_sphere": {"collapse_limit": 1e-3, "step_s": 100}},
  "settling": {"rotations": 1, "max_rotations": 10},
  "tiling": {"facets": 200},
  "torque": {"obliquity_step_deg": 15},
  "evolution": {"duration_myr": 0.03, "spin_change": 0.01, "movement_radius_fraction": 0.1}
}"#;

fn yorp(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_yorp")).args(arguments).output().unwrap()
}

/// A run with movements, made once.
fn run() -> &'static Path {
    static RUN: OnceLock<(tempfile::TempDir, PathBuf)> = OnceLock::new();
    let (_, run) = RUN.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let (scene, run) = (folder.path().join("scene.json"), folder.path().join("run"));
        std::fs::write(&scene, SCENE).unwrap();
        let output = yorp(&["run", scene.to_str().unwrap(), "--out", run.to_str().unwrap()]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        (folder, run)
    });
    run
}

fn export(format: &str, out: &Path) -> Output {
    yorp(&["export", run().to_str().unwrap(), "--format", format, "--out", out.to_str().unwrap(), "--json"])
}

fn exported(format: &str, out: &Path) -> Vec<String> {
    let output = export(format, out);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    value["files"].as_array().unwrap().iter().map(|file| file.as_str().unwrap().to_owned()).collect()
}

/// Reads all four exports beside the database itself.
const PYTHON: &str = r#"
import csv, json, os, sqlite3, sys
import xml.etree.ElementTree as xml
import numpy as np, trimesh
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
from vtkmodules.util.numpy_support import vtk_to_numpy
run, out = sys.argv[1], sys.argv[2]
db = sqlite3.connect("file:" + run + "/run.sqlite?mode=ro", uri=True)
one = lambda sql: db.execute(sql).fetchall()
legs = np.array(one("SELECT t1_s, omega1, obliquity1 FROM leg ORDER BY leg"))
shapes = one("SELECT configuration, positions, vertices, body_axes, centre_of_mass, t_s, sphere_ids FROM configuration ORDER BY configuration")
numbers = lambda blob, *shape: np.frombuffer(blob).reshape(*shape)
facets = np.frombuffer(one("SELECT facets FROM tiling")[0][0], "<u4").reshape(-1, 3)
radius = np.array(one("SELECT radius_m FROM sphere ORDER BY sphere"))[:, 0]
assert len(shapes) > 1, "the run has movements"

table = list(csv.DictReader(open(out + "/csv/legs.csv")))
assert np.array_equal(np.array([[float(r[k]) for k in ("t1_s", "omega1_rad_s", "obliquity1_rad")] for r in table]), legs)
assert [r["result"] for r in table] == [r for r, in one("SELECT result FROM leg ORDER BY leg")]
movements = list(csv.DictReader(open(out + "/csv/movements.csv")))
assert len(movements) == one("SELECT count(*) FROM movement")[0][0]

arrays = np.load(out + "/npz/run.npz")
assert np.array_equal(arrays["legs/omega1_rad_s"], legs[:, 1])
assert list(arrays["legs/result"]) == [r["result"] for r in table]
assert np.array_equal(arrays["tiling/facets"], facets)
nodes = np.concatenate([np.frombuffer(b) for b, in one("SELECT spin_torque FROM configuration ORDER BY configuration")])
assert np.array_equal(arrays["torques/spin_torque_n_m"], nodes)

for number, positions, vertices, axes, centre, t_s, ids in shapes:
    positions, vertices, axes = numbers(positions, -1, 3), numbers(vertices, -1, 3), numbers(axes, 3, 3)
    centre, ids = numbers(centre, 3), np.frombuffer(ids, "<u4")
    here = arrays["positions/configuration"] == number
    assert np.array_equal(arrays["positions/position_m"][here], positions)
    assert np.array_equal(arrays["positions/sphere"][here], ids)
    assert np.array_equal(arrays["tiling/vertices_m"][number], vertices)
    body = (vertices - centre) @ axes.T
    mesh = trimesh.load(out + "/obj/%04d.obj" % number, process=False)
    assert mesh.is_watertight and mesh.volume > 0
    assert np.abs(mesh.vertices - body).max() < 1e-6 and np.array_equal(mesh.faces, facets)
    spheres = list(csv.DictReader(open(out + "/csv/spheres/%04d.csv" % number)))
    x = np.array([[float(r[k]) for k in ("x_m", "y_m", "z_m")] for r in spheres])
    assert np.abs(x - (positions - centre) @ axes.T).max() < 1e-9
    def polydata(name):
        reader = vtkXMLPolyDataReader(); reader.SetFileName(out + "/vtk/" + name); reader.Update()
        return reader.GetOutput()
    surface = polydata("tiling_%04d.vtp" % number)
    assert np.array_equal(vtk_to_numpy(surface.GetPoints().GetData()), vertices)
    assert np.array_equal(vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3), facets)
    points = polydata("spheres_%04d.vtp" % number)
    assert np.array_equal(vtk_to_numpy(points.GetPoints().GetData()), positions)
    data = lambda name: vtk_to_numpy(points.GetPointData().GetArray(name))
    assert np.array_equal(data("radius_m"), radius[ids]) and np.array_equal(data("sphere"), ids)
    moved = dict(one("SELECT sphere, displacement_m FROM movement WHERE configuration = %d" % number))
    assert np.array_equal(data("displacement_m"), [moved.get(i, 0.0) for i in ids.tolist()])
for kind in ("spheres", "tiling"):
    sets = xml.parse(out + "/vtk/" + kind + ".pvd").getroot().find("Collection").findall("DataSet")
    assert [os.path.exists(out + "/vtk/" + s.get("file")) for s in sets] == [True] * len(shapes)
    assert np.allclose([float(s.get("timestep")) for s in sets], [s[5] / 3.15576e13 for s in shapes], rtol=1e-12)
"#;

#[test]
fn numpy_trimesh_and_vtk_read_what_the_database_holds() {
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let has = Command::new(&python).args(["-c", "import numpy, trimesh, vtkmodules"]).output();
    if !has.is_ok_and(|output| output.status.success()) {
        println!("skipped: {python} has no packages numpy, trimesh and vtk (set PYTHON to one that has)");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for format in ["csv", "npz", "obj", "vtk"] {
        exported(format, &folder.path().join(format));
    }
    let output = Command::new(&python).args(["-c", PYTHON]).arg(run()).arg(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn exported_shapes_are_inputs_of_other_verbs() {
    let folder = tempfile::tempdir().unwrap();
    let (csv, obj) = (folder.path().join("csv"), folder.path().join("obj"));
    exported("csv", &csv);
    let meshes = exported("obj", &obj);
    let aggregate = csv.join("spheres/0000.csv");
    let tiled = folder.path().join("tiled.obj");
    for arguments in [
        vec!["tile", aggregate.to_str().unwrap(), "--out", tiled.to_str().unwrap()],
        vec!["torque", obj.join(&meshes[0]).to_str().unwrap(), "--obliquity-deg", "30"],
    ] {
        let output = yorp(&arguments);
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn an_export_is_replaced_by_one_of_the_same_run_with_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("new/npz");
    let files = exported("npz", &out);
    assert_eq!(files, ["run.npz"]);
    let first = std::fs::read(out.join("run.npz")).unwrap();
    exported("npz", &out);
    assert_eq!(std::fs::read(out.join("run.npz")).unwrap(), first);
}

#[test]
fn what_is_not_ours_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("thesis");
    std::fs::create_dir(&out).unwrap();
    std::fs::write(out.join("legs.csv"), "mine").unwrap();
    let refused = export("csv", &out);
    assert_eq!(refused.status.code(), Some(2), "{}", String::from_utf8_lossy(&refused.stderr));
    assert_eq!(std::fs::read_to_string(out.join("legs.csv")).unwrap(), "mine");
    assert_eq!(std::fs::read_dir(&out).unwrap().count(), 1);
    // Nor is an export in another format, or a file.
    let other = folder.path().join("npz");
    exported("npz", &other);
    assert_eq!(export("csv", &other).status.code(), Some(2));
    assert_eq!(export("csv", &out.join("legs.csv")).status.code(), Some(2));
}

#[test]
fn a_folder_that_cannot_be_made_is_a_failed_write() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    let output = export("obj", &file.join("below"));
    assert_eq!(output.status.code(), Some(4), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stdout.is_empty());
}

#[test]
fn a_directory_without_a_run_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let absent = folder.path().join("absent");
    let output = yorp(&["export", absent.to_str().unwrap(), "--format", "csv"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("holds no run"));
}
