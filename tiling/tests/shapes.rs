//! Real asteroid shapes, where a checkout has them beside it: closed, and with the volumes and moments of their table.

use std::path::{Path, PathBuf};
use tiling::top::TopShape;
use tiling::{Inside, Mesh, obj};

/// File, volume (m^3), moment of inertia about z over the density (m^5).
const TABLE: [(&str, f64, f64); 14] = [
    ("didymos_49152.obj", 2.033565e+08, 1.329055e+13),
    ("didymos_12000.obj", 2.033565e+08, 1.329020e+13),
    ("didymos_3200.obj", 2.033565e+08, 1.328937e+13),
    ("didymos_800.obj", 2.033565e+08, 1.328903e+13),
    ("itokawa_12000.obj", 1.778560e+07, 3.995587e+11),
    ("itokawa_3200.obj", 1.778560e+07, 3.994997e+11),
    ("kw4_alpha_9168.obj", 1.195308e+09, 2.339431e+14),
    ("kw4_alpha_3200.obj", 1.195308e+09, 2.339579e+14),
    ("bennu_12000.obj", 6.163329e+07, 1.656662e+12),
    ("bennu_3200.obj", 6.163329e+07, 1.656549e+12),
    ("ryugu_49152.obj", 3.772670e+08, 3.374475e+13),
    ("ryugu_3200.obj", 3.772670e+08, 3.373820e+13),
    ("eros_12000.obj", 2.506387e+12, 1.862701e+20),
    ("eros_3200.obj", 2.506387e+12, 1.862535e+20),
];

fn shapes() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/shapes");
    if !folder.is_dir() {
        println!("skipped: no folder of real shapes beside the checkout");
        return None;
    }
    Some(folder)
}

fn read(folder: &Path, name: &str) -> Mesh {
    obj::read(&std::fs::read(folder.join(name)).unwrap()).unwrap()
}

#[test]
fn real_shapes_are_closed_and_have_their_published_volume_and_moment() {
    let Some(folder) = shapes() else { return };
    for (name, volume, moment) in TABLE {
        let mesh = read(&folder, name);
        assert_eq!((mesh.check(), mesh.check_contact()), (Ok(()), Ok(())), "{name}");
        assert_eq!(mesh.euler_characteristic(), 2, "{name}");
        let solid = mesh.solid();
        let radius = solid.equal_volume_radius();
        assert!((solid.volume / volume - 1.0).abs() < 1e-6, "{name}: {}", solid.volume);
        assert!((solid.inertia[(2, 2)] / moment - 1.0).abs() < 1e-6, "{name}: {}", solid.inertia[(2, 2)]);
        assert!(solid.centre_of_mass.iter().all(|c| c.abs() < 1e-5 * radius), "{name}: {:?}", solid.centre_of_mass);
        // Sum of 50 000 area vectors.
        let closure = mesh.area_vector_sum().iter().fold(0f64, |most, c| most.max(c.abs())) / mesh.surface_area();
        assert!(closure < 1e-12, "{name}: {closure}");
    }
}

#[test]
fn real_shapes_are_written_and_read_back_bit_for_bit() {
    let Some(folder) = shapes() else { return };
    let mesh = read(&folder, "ryugu_49152.obj");
    assert_eq!(obj::read(obj::write(&mesh, "copy").as_bytes()).unwrap(), mesh);
}

/// Itokawa is far from convex; its volume measured with a lattice of test points agrees with the integral.
#[test]
fn inside_test_measures_the_volume_of_a_concave_shape() {
    let Some(folder) = shapes() else { return };
    let mesh = read(&folder, "itokawa_12000.obj");
    let volume = mesh.volume();
    let inside = Inside::new(mesh).unwrap();
    let step = 4.0;
    let mut count = 0;
    for i in -75..75 {
        for j in -45..45 {
            for k in -40..40 {
                let at = |n: i32| (f64::from(n) + 0.5) * step;
                count += usize::from(inside.contains([at(i), at(j), at(k)]));
            }
        }
    }
    let measured = f64::from(u32::try_from(count).unwrap()) * step.powi(3);
    assert!((measured / volume - 1.0).abs() < 2e-3, "{measured} {volume}");
}

/// The shape that ships with the scenes is the one its formula gives.
#[test]
fn shipped_top_shape_is_closed_and_follows_its_formula() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/shapes");
    let mesh = read(&folder, "top.obj");
    assert_eq!((mesh.check(), mesh.check_contact(), mesh.facets.len()), (Ok(()), Ok(()), 2000));
    let top = TopShape::new(300.0);
    for v in &mesh.vertices {
        let radius = v.iter().map(|c| c * c).sum::<f64>().sqrt();
        // The file's origin is the centre of mass, a few metres at most from the formula's.
        assert!((radius - top.radius_at((v[2] / radius).asin())).abs() < 1.0, "{v:?}");
    }
    assert!(mesh.solid().centre_of_mass.iter().all(|c| c.abs() < 1e-5));
}
