//! Shape files as people have them, through the program: the same body in every spelling, and refusals that say what is
//! wrong.

use std::path::{Path, PathBuf};

use assert_cmd::Command;
use serde_json::Value;

/// A wedge of 8 vertices and 12 facets, m.
const VERTICES: [[f64; 3]; 8] = [
    [-20.0, -15.0, -10.0],
    [20.0, -15.0, -10.0],
    [20.0, 15.0, -10.0],
    [-20.0, 15.0, -10.0],
    [-20.0, -15.0, 10.0],
    [20.0, -15.0, 10.0],
    [26.0, 19.0, 14.0],
    [-20.0, 15.0, 10.0],
];
const FACETS: [[usize; 3]; 12] = [
    [1, 4, 3],
    [1, 3, 2],
    [5, 6, 7],
    [5, 7, 8],
    [1, 2, 6],
    [1, 6, 5],
    [2, 3, 7],
    [2, 7, 6],
    [3, 4, 8],
    [3, 8, 7],
    [4, 1, 5],
    [4, 5, 8],
];
/// Its volume, m^3, and its moment of inertia about z at 2000 kg/m^3, kg m^2.
const VOLUME: f64 = 27333.333333333332;
const INERTIA: f64 = 1.2359723170731709e10;

fn vertices() -> String {
    VERTICES.iter().map(|[x, y, z]| format!("v {x:.6} {y:.6} {z:.6}\n")).collect()
}

fn facets() -> String {
    FACETS.iter().map(|[a, b, c]| format!("f {a} {b} {c}\n")).collect()
}

fn base() -> String {
    vertices() + &facets()
}

/// The wedge scaled and shifted, its vertices counted from `first`, inside out or not.
fn shell(first: usize, scale: f64, shift: [f64; 3], outward: bool) -> String {
    let vertex = |v: &[f64; 3]| {
        let [x, y, z] = [0, 1, 2].map(|k| scale * v[k] + shift[k]);
        format!("v {x} {y} {z}\n")
    };
    let facet = |[a, b, c]: &[usize; 3]| {
        let [b, c] = if outward { [b, c] } else { [c, b] };
        format!("f {} {} {}\n", a + first - 1, b + first - 1, c + first - 1)
    };
    VERTICES.iter().map(vertex).chain(FACETS.iter().map(facet)).collect()
}

fn write(folder: &tempfile::TempDir, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let file = folder.path().join(name);
    std::fs::write(&file, bytes).unwrap();
    file
}

/// Exit code, what `torque --json` prints, and what it says on stderr.
fn torque(file: &Path, arguments: &[&str]) -> (i32, Value, String) {
    let mut command = Command::cargo_bin("yorp").unwrap();
    let output =
        command.arg("torque").arg(file).args(["--obliquity-deg", "45", "--json"]).args(arguments).output().unwrap();
    let value = serde_json::from_slice(&output.stdout).unwrap_or(Value::Null);
    (output.status.code().unwrap(), value, String::from_utf8(output.stderr).unwrap())
}

fn assert_is_the_wedge(name: &str, bytes: impl AsRef<[u8]>) -> String {
    let folder = tempfile::tempdir().unwrap();
    let (code, value, message) = torque(&write(&folder, name, bytes), &[]);
    assert_eq!(code, 0, "{name}: {message}");
    let near = |key: &str, want: f64| {
        let got = value[key].as_f64().unwrap();
        assert!((got / want - 1.0).abs() < 1e-6, "{name}: {key} is {got} instead of {want}");
    };
    near("volume_m3", VOLUME);
    near("inertia_kg_m2", INERTIA);
    message
}

fn assert_is_refused(name: &str, bytes: impl AsRef<[u8]>, says: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let (code, value, message) = torque(&write(&folder, name, bytes), &[]);
    assert_eq!((code, value), (2, Value::Null), "{name}: {message}");
    let flat = message.split_whitespace().collect::<Vec<_>>().join(" ").replace("│ ", "");
    for text in says.iter().chain(&[name]) {
        assert!(flat.contains(text), "{name}: `{text}` is missing in:\n{message}");
    }
}

#[test]
fn a_backslash_at_the_end_of_a_comment_or_a_name_swallows_no_line() {
    assert_is_the_wedge("comment.obj", format!("# unit m, exported to C:\\tmp\\\n{}", base()));
    assert_is_the_wedge("library.obj", format!("mtllib C:\\tmp\\\n{}", base()));
    assert_is_the_wedge("group.obj", vertices() + "g side\\\n" + &facets());
    assert_is_the_wedge("after.obj", base().replace("-15.000000 -10.000000\n", "-15.000000 -10.000000 # C:\\\n"));
    assert_is_the_wedge("continued.obj", base().replace(" 15.000000", " \\\n 15.000000"));
}

#[test]
fn line_ends_of_all_systems_and_a_byte_order_mark_are_read() {
    for end in ["\r\n", "\r"] {
        assert_is_the_wedge("ends.obj", base().replace('\n', end));
        assert_is_the_wedge("ends.obj", format!("\u{feff}# comment\\{end}{}", base().replace('\n', end)));
    }
    let utf16: Vec<u8> = format!("\u{feff}{}", base()).encode_utf16().flat_map(u16::to_le_bytes).collect();
    assert_is_refused("utf16.obj", utf16, &["UTF-16"]);
}

#[test]
fn statements_about_display_say_nothing_about_the_shape() {
    let display = "c_interp off\nd_interp off\nbevel on\nlod 3\nctech cparm 1\nstech cparma 1 1\nshadow_obj a.obj\n\
                   trace_obj a.obj\nusemap off\nmaplib a.map\nmg 1 0.5\ns 1\nusemtl stone\n";
    assert_is_the_wedge("display.obj", format!("{display}{}", base()));
    assert_is_refused("free.obj", format!("{}cstype bspline\n", base()), &["line 21", "free-form"]);
}

#[test]
fn vertices_that_no_facet_uses_are_left_out_and_counted() {
    let shifted: String = FACETS.iter().map(|f| format!("f {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1)).collect();
    let message = assert_is_the_wedge("unused.obj", format!("v 1e6 1e6 -1e6\n{}{shifted}", vertices()));
    assert!(message.contains("1 vertex that no facet uses"), "{message}");
    let message = assert_is_the_wedge("unused.obj", format!("{}{}v 0 0 0\nv -1e9 2 3\n", vertices(), facets()));
    assert!(message.contains("2 vertices that no facet uses"), "{message}");
    assert!(assert_is_the_wedge("used.obj", base()).is_empty());
}

#[test]
fn each_shell_is_judged_by_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let far = [70.0, 3.0, -2.0];
    let of = |rest: &str| torque(&write(&folder, "shells.obj", base() + rest), &[]);
    let wrong = |rest: &str, says: &str| {
        let (code, _, message) = of(rest);
        assert!(code == 2 && message.contains("facets 13, 14") && message.contains(says), "{message}");
    };
    wrong(&shell(9, 0.5, far, false), "oriented inward");
    wrong(&shell(9, 2.0, [170.0, 3.0, 0.0], false), "oriented inward");
    wrong(&shell(9, 0.5, [0.0; 3], true), "oriented outward");
    let (code, value, message) = of(&shell(9, 0.5, [0.0; 3], false));
    assert_eq!(code, 0, "{message}");
    assert!((value["volume_m3"].as_f64().unwrap() / (0.875 * VOLUME) - 1.0).abs() < 1e-12 && message.contains("void"));
    let (code, value, message) = of(&shell(9, 0.5, far, true));
    assert_eq!(code, 0, "{message}");
    assert!((value["volume_m3"].as_f64().unwrap() / (1.125 * VOLUME) - 1.0).abs() < 1e-12);
    assert!(message.contains("2 bodies apart") && message.contains("one rigid body"), "{message}");
    let (code, _, message) = of(&shell(9, 1.0, [5.0, 4.0, 3.0], true));
    assert!(code == 2 && message.contains("self-touching"), "{message}");
}

#[test]
fn moments_of_inertia_that_are_no_numbers_are_refused_in_every_verb_that_takes_a_mesh() {
    let folder = tempfile::tempdir().unwrap();
    for scale in [1e60, 1e61, 1e-63, 1e-70] {
        let text = shell(1, scale, [0.0; 3], true);
        let file = write(&folder, "size.obj", &text);
        for verb in ["torque", "rigid"] {
            let mut command = Command::cargo_bin("yorp").unwrap();
            let output = command.arg(verb).arg(&file).args(["--density-kg-m3", "7000", "--json"]).output().unwrap();
            let message = String::from_utf8(output.stderr).unwrap();
            assert!(matches!(output.status.code(), Some(2 | 3)), "{verb} {scale}: {message}");
            assert!(output.stdout.is_empty() && message.contains("size.obj"), "{verb} {scale}: {message}");
        }
    }
    let scene = r#"{"body": {"carved_mesh": {"path": "size.obj", "packing": {"hcp": {"radius_m": 50, "grain_density_kg_m3": 3000}}}}}"#;
    let scene = write(&folder, "scene.json", scene);
    let mut command = Command::cargo_bin("yorp").unwrap();
    let output = command.arg("build").arg(&scene).arg("--out").arg(folder.path().join("a.csv")).output().unwrap();
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn concave_polygons_keep_their_area_whatever_corner_comes_first() {
    let outline = [[0, 0], [30, 0], [30, 10], [10, 10], [10, 30], [0, 30]];
    let folder = tempfile::tempdir().unwrap();
    for first in 0..6 {
        let mut text = String::new();
        for z in [0, 20] {
            outline.iter().for_each(|[x, y]| text += &format!("v {x} {y} {z}\n"));
        }
        let ring = |order: &dyn Fn(usize) -> usize, above: usize| {
            (0..6).map(|k| (1 + above + (first + order(k)) % 6).to_string()).collect::<Vec<_>>().join(" ")
        };
        text += &format!("f {}\nf {}\n", ring(&|k| k, 6), ring(&|k| 5 - k, 0));
        for k in 0..6 {
            let (a, b) = (k + 1, (k + 1) % 6 + 1);
            text += &format!("f {a} {b} {} {}\n", b + 6, a + 6);
        }
        let (code, value, message) = torque(&write(&folder, "L.obj", text), &[]);
        assert_eq!(code, 0, "{first}: {message}");
        assert!((value["volume_m3"].as_f64().unwrap() / 10_000.0 - 1.0).abs() < 1e-12 && value["facets"] == 20);
    }
    assert_is_refused("bow.obj", base() + "f 1 3 2 4\n", &["line 21", "crosses itself"]);
}

#[test]
fn other_formats_give_the_same_body() {
    let mut ply = String::from(
        "ply\nformat ascii 1.0\ncomment x\nelement vertex 8\nproperty float x\nproperty double y\n\
                                property float z\nproperty uchar red\nelement face 12\nproperty list uchar int vertex_indices\nend_header\n",
    );
    VERTICES.iter().for_each(|[x, y, z]| ply += &format!("{x} {y} {z} 7\n"));
    FACETS.iter().for_each(|[a, b, c]| ply += &format!("3 {} {} {}\n", a - 1, b - 1, c - 1));
    assert_is_the_wedge("wedge.ply", &ply);
    // The content counts, not the name.
    assert_is_the_wedge("wedge.obj", &ply);

    let mut binary =
        b"ply\nformat binary_big_endian 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n\
                       element face 12\nproperty list uchar uint vertex_index\nend_header\n"
            .to_vec();
    VERTICES.iter().flatten().for_each(|c| binary.extend((*c as f32).to_be_bytes()));
    for facet in FACETS {
        binary.push(3);
        facet.iter().for_each(|v| binary.extend((*v as u32 - 1).to_be_bytes()));
    }
    assert_is_the_wedge("binary.ply", binary);

    let corners = || FACETS.iter().map(|f| f.map(|v| VERTICES[v - 1]));
    let mut stl = String::from("solid wedge\n");
    for corners in corners() {
        stl += " facet normal 0 0 0\n  outer loop\n";
        corners.iter().for_each(|[x, y, z]| stl += &format!("   vertex {x:e} {y:e} {z:e}\n"));
        stl += "  endloop\n endfacet\n";
    }
    assert_is_the_wedge("wedge.stl", stl + "endsolid wedge\n");
    let mut binary = vec![b' '; 80];
    binary[..5].copy_from_slice(b"solid");
    binary.extend(12_u32.to_le_bytes());
    for corners in corners() {
        binary.extend([0; 12]);
        corners.iter().flatten().for_each(|c| binary.extend((*c as f32).to_le_bytes()));
        binary.extend([0; 2]);
    }
    assert_is_the_wedge("binary.stl", &binary);
    assert_is_the_wedge("noending", binary);

    let numbers: String = VERTICES.iter().map(|[x, y, z]| format!("{x} {y} {z}\n")).collect();
    let plates: String = FACETS.iter().map(|[a, b, c]| format!("{a} {b} {c}\n")).collect();
    let from_zero: String = FACETS.iter().map(|[a, b, c]| format!("3 {} {} {}\n", a - 1, b - 1, c - 1)).collect();
    assert_is_the_wedge("wedge.off", format!("OFF\n# comment\n8 12 0\n{numbers}{from_zero}"));
    assert_is_the_wedge("wedge.tab", format!("8 12\n{numbers}{plates}"));
    let numbered =
        |rows: &str| rows.lines().enumerate().map(|(i, r)| format!("{:6} {r}\r\n", i + 1)).collect::<String>();
    assert_is_the_wedge("gaskell.tab", format!("8\r\n{}12\r\n{}", numbered(&numbers), numbered(&plates)));
    assert_is_the_wedge("statements.tab", base());
}

/// Implicitly connected quadrilaterals: a box of six faces with 3 x 3 vertices each.
#[test]
fn a_cube_of_implicit_quadrilaterals_closes_at_its_edges() {
    let folder = tempfile::tempdir().unwrap();
    // Of each face the origin and the two sides, right-handed outward.
    let faces = [
        ([0, 0, 1], [1, 0, 0], [0, 1, 0]),
        ([0, 0, 0], [0, 1, 0], [1, 0, 0]),
        ([0, 0, 0], [1, 0, 0], [0, 0, 1]),
        ([0, 1, 0], [0, 0, 1], [1, 0, 0]),
        ([0, 0, 0], [0, 0, 1], [0, 1, 0]),
        ([1, 0, 0], [0, 1, 0], [0, 0, 1]),
    ];
    for mirrored in [false, true] {
        let mut text = String::from("2\n");
        for (origin, u, v) in faces {
            for (j, i) in (0..9).map(|k| if mirrored { (k % 3, k / 3) } else { (k / 3, k % 3) }) {
                let at = |k: usize| 100 * origin[k] + 50 * (i * u[k] + j * v[k]);
                text += &format!(" {}.0 {}.0 {}.0\n", at(0), at(1), at(2));
            }
        }
        let (code, value, message) = torque(&write(&folder, "shape.txt", text), &[]);
        assert_eq!(code, 0, "{message}");
        assert!((value["volume_m3"].as_f64().unwrap() / 1e6 - 1.0).abs() < 1e-12 && value["facets"] == 48);
    }
}

#[test]
fn broken_files_of_other_formats_are_refused_with_what_is_wrong() {
    assert_is_refused("short.ply", "ply\nformat ascii 1.0\nelement vertex 4000000000\nend_header\n", &["announces"]);
    assert_is_refused(
        "bad.ply",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n",
        &["vertex 1"],
    );
    assert_is_refused("bad.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", &["facet 1", "vertex 7"]);
    assert_is_refused("cut.off", "OFF\n3 1 0\n0 0 0\n", &["the file ends"]);
    assert_is_refused("bad.tab", "2 1\n0 0 0\n1 0 nonsense\n1 2 1\n", &["line 3", "1 0 nonsense"]);
    assert_is_refused("bad.stl", "solid a\n facet normal 0 0 1\n outer loop\n vertex 0 0 0\n endfacet\n", &["line 5"]);
    assert_is_refused("shape.glb", "glTF", &["glTF (.glb) is not read", "MeshLab"]);
    assert_is_refused("shape.bds", "DAF/DSK ", &["SPICE", "OBJ, PLY, STL, OFF"]);
    assert_is_refused("shape.xyz", "nonsense", &["the ending .xyz is unknown"]);
}

#[test]
fn facets_with_corners_of_their_own_are_told_to_be_welded() {
    let mut soup = String::new();
    for (i, facet) in FACETS.iter().enumerate() {
        facet.map(|v| VERTICES[v - 1]).iter().for_each(|[x, y, z]| soup += &format!("v {x} {y} {z}\n"));
        soup += &format!("f {} {} {}\n", 3 * i + 1, 3 * i + 2, 3 * i + 3);
    }
    assert_is_refused("soup.obj", soup, &["weld the vertices"]);
}

/// Two lobes of hexagonally close-packed spheres of 30 m that touch in single spheres.
fn contact_binary() -> String {
    let mut lobe = Vec::new();
    for (layer, row, place) in (-4..=4).flat_map(|l| (-4..=4).flat_map(move |r| (-5..=5).map(move |p| (l, r, p)))) {
        let odd = f64::from(i32::rem_euclid(layer, 2));
        let x = 2.0 * f64::from(place) + f64::from(i32::rem_euclid(row, 2)) + odd;
        let y = 3f64.sqrt() * f64::from(row) + odd / 3f64.sqrt();
        let z = (8f64 / 3.0).sqrt() * f64::from(layer);
        if x * x + y * y + z * z < 5.8 * 5.8 {
            lobe.push([x, y, z]);
        }
    }
    // Nearest pair of spheres at this distance of the lobes.
    let gap = |apart: f64| {
        let pairs = lobe
            .iter()
            .flat_map(|p| lobe.iter().map(move |q| [q[0] + apart - p[0], q[1] + 0.3 - p[1], q[2] + 0.2 - p[2]]));
        pairs.map(|d| d.iter().map(|c| c * c).sum::<f64>()).fold(f64::INFINITY, f64::min).sqrt()
    };
    let (mut near, mut far) = (8.0, 14.0);
    for _ in 0..50 {
        let middle = 0.5 * (near + far);
        if gap(middle) < 2.0 { near = middle } else { far = middle }
    }
    let mut text = String::from("x_m,y_m,z_m,mass_kg,radius_m\n");
    let mass = 2960.0 * 4.0 / 3.0 * std::f64::consts::PI * 30_f64.powi(3);
    for shift in [[0.0; 3], [far, 0.3, 0.2]] {
        for p in &lobe {
            // A hair apart, so that no pair overlaps.
            let [x, y, z] = [0, 1, 2].map(|k| 30.003 * (p[k] + shift[k]));
            text += &format!("{x},{y},{z},{mass},30\n");
        }
    }
    text
}

fn yorp(arguments: &[&str]) -> std::process::Output {
    Command::cargo_bin("yorp").unwrap().args(arguments).output().unwrap()
}

#[test]
fn tile_writes_meshes_that_torque_accepts() {
    let folder = tempfile::tempdir().unwrap();
    let aggregate = write(&folder, "binary.csv", contact_binary());
    let mesh = folder.path().join("mesh.obj");
    for facets in ["100", "784", "3184"] {
        let tiled =
            yorp(&["tile", aggregate.to_str().unwrap(), "--out", mesh.to_str().unwrap(), "--facets", facets, "--json"]);
        assert!(tiled.status.success(), "{}", String::from_utf8_lossy(&tiled.stderr));
        let report: Value = serde_json::from_slice(&tiled.stdout).unwrap();
        assert_eq!(report["facets"].to_string(), facets);
        assert!(!String::from_utf8_lossy(&tiled.stderr).contains(" 0 "), "{}", String::from_utf8_lossy(&tiled.stderr));
        let (code, _, message) = torque(&mesh, &[]);
        assert_eq!(code, 0, "{facets}: {message}");
    }
}

/// A body that necks, near fission, over 0.1 Myr: at every configuration its surface is one that `torque` accepts.
#[test]
fn a_contact_binary_has_a_legal_surface_at_every_configuration() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder, "binary.csv", contact_binary());
    let scene = r#"{"body": {"file": {"path": "binary.csv"}}, "spin": {"period_h": 5.2, "obliquity_deg": 30},
                    "evolution": {"duration_myr": 0.1, "movement_radius_fraction": 0.1}}"#;
    let (scene, run) = (write(&folder, "scene.json", scene), folder.path().join("run"));
    let (scene, run) = (scene.to_str().unwrap(), run.to_str().unwrap());
    let output = yorp(&["run", scene, "--out", run, "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let out = folder.path().join("meshes");
    let exported = yorp(&["export", run, "--format", "obj", "--out", out.to_str().unwrap(), "--json"]);
    let exported: Value = serde_json::from_slice(&exported.stdout).unwrap();
    let files = exported["files"].as_array().unwrap();
    println!("{} configurations", files.len());
    assert!(!files.is_empty());
    for file in files {
        let (code, _, message) = torque(&out.join(file.as_str().unwrap()), &[]);
        assert_eq!(code, 0, "{file}: {message}");
    }
}

/// Twenty equilateral facets: no torque by symmetry, whatever round-off leaves.
#[test]
fn a_body_without_torque_has_no_trend() {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut text = String::new();
    let mut points = Vec::new();
    for k in 0..3 {
        for (a, b) in [(1.0, golden), (1.0, -golden), (-1.0, golden), (-1.0, -golden)] {
            let mut p = [0.0; 3];
            (p[k], p[(k + 1) % 3]) = (263.0 * a, 263.0 * b);
            text += &format!("v {:?} {:?} {:?}\n", p[0], p[1], p[2]);
            points.push(p);
        }
    }
    let square = |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>();
    let near = |a: usize, b: usize| square(&points[a], &points[b]) < 1.1 * (2.0 * 263.0_f64).powi(2);
    for a in 0..12 {
        for b in a + 1..12 {
            for c in (b + 1..12).filter(|c| near(a, b) && near(b, *c) && near(a, *c)) {
                let [p, q, r] = [a, b, c].map(|v| points[v]);
                let det = p[0] * (q[1] * r[2] - q[2] * r[1]) - p[1] * (q[0] * r[2] - q[2] * r[0])
                    + p[2] * (q[0] * r[1] - q[1] * r[0]);
                let (b, c) = if det > 0.0 { (b, c) } else { (c, b) };
                text += &format!("f {} {} {}\n", a + 1, b + 1, c + 1);
            }
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let file = write(&folder, "icosahedron.obj", text);
    let rigid = |json: bool| {
        let mut command = Command::cargo_bin("yorp").unwrap();
        command.arg("rigid").arg(&file).args(["--obliquity-deg", "30"]).args(json.then_some("--json"));
        let output = command.output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let text = rigid(false);
    assert!(text.contains("no YORP torque above its error") && text.contains("obliquity: 30.00 deg"), "{text}");
    assert!(!text.contains("for ever") && !text.contains("tends to"), "{text}");
    let cycle: Value = serde_json::from_str(&rigid(true)).unwrap();
    assert_eq!((&cycle["end"], &cycle["attractor_obliquity_deg"]), (&Value::from("no_torque"), &Value::Null));
    assert!((cycle["end_obliquity_deg"].as_f64().unwrap() - 30.0).abs() < 1e-9);
    assert_eq!(cycle["max_spin_rev_day"], cycle["end_spin_rev_day"]);
}

/// What is printed as the end is the last state that was followed, not where it tends.
#[test]
fn a_time_limit_reports_the_last_state_and_the_attractor_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(&folder, "wedge.obj", base());
    let arguments = ["--axes", "principal", "--obliquity-deg", "30", "--duration-myr", "1e-6", "--json"];
    let output = Command::cargo_bin("yorp").unwrap().arg("rigid").arg(&file).args(arguments).output().unwrap();
    let cycle: Value = serde_json::from_slice(&output.stdout).unwrap();
    let last = |key: &str| cycle[key].as_array().unwrap().last().unwrap().as_f64().unwrap();
    assert_eq!(cycle["end_obliquity_deg"].as_f64().unwrap(), last("obliquity_deg"));
    assert!((last("obliquity_deg") - 30.0).abs() < 1.0, "{}", last("obliquity_deg"));
    assert!((cycle["attractor_obliquity_deg"].as_f64().unwrap() - 30.0).abs() > 5.0, "{cycle}");
}
