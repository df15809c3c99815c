//! Degenerate and extreme input: refused with its name, or a finite result.

mod common;

use common::{bumpy, peak, rings};
use proptest::prelude::*;
use taco::{
    Hapke, MultipleScattering, Orbit, Reflectance, Sampling, Surface, TacoError, TorqueTable, torque_table_of_facets,
};
use tiling::Mesh;

fn quick() -> Sampling {
    Sampling { azimuth_bins: 32, declination_nodes: 9, ..Sampling::default() }
}

fn run(mesh: &Mesh, surface: &Surface) -> TorqueTable {
    torque_table_of_facets(mesh, surface, &Orbit::default(), &quick()).expect("a finite torque")
}

fn assert_finite(table: &TorqueTable) {
    for row in table.spin_torque_n_m.iter().chain(&table.obliquity_torque_n_m) {
        assert!(row.iter().all(|t| t.is_finite()));
    }
    assert!(table.error.parts.iter().all(|p| p.spin_torque_n_m.is_finite() && p.obliquity_torque_n_m.is_finite()));
}

#[test]
fn plates_slivers_and_facets_without_area_stay_finite() {
    let plate = rings(8, 16, [1.0, 0.7, 1e-9], |_, _| 1.0);
    let needle = rings(8, 16, [1.0, 1e-9, 1e-9], |lon, _| 1.0 + 0.3 * lon.sin());
    let mut collapsed = bumpy(60);
    let facet = collapsed.facets[7];
    collapsed.vertices[facet[0] as usize] = collapsed.vertices[facet[1] as usize];
    let flat = Mesh { vertices: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], facets: vec![[0, 1, 2], [0, 2, 1]] };
    for mesh in [plate, needle, collapsed, flat] {
        assert_finite(&run(&mesh, &Surface::default()));
    }
}

#[test]
fn every_kind_of_surface_stays_finite() {
    let mesh = bumpy(60);
    let hapke = |single_scattering_albedo, roughness_deg, asymmetry, multiple_scattering| {
        Reflectance::Hapke(Hapke { single_scattering_albedo, roughness_deg, asymmetry, multiple_scattering })
    };
    for reflectance in [
        Reflectance::None,
        Reflectance::Lambert { bond_albedo: 0.0 },
        Reflectance::Lambert { bond_albedo: 1.0 },
        hapke(0.0, 0.0, 0.0, MultipleScattering::Imsa),
        hapke(0.999, 59.0, -0.9, MultipleScattering::H2002),
        hapke(0.5, 1e-6, 0.99, MultipleScattering::H2002),
    ] {
        for (shadows, sky_blockage) in [(false, false), (true, false), (false, true), (true, true)] {
            let surface = Surface { reflectance, shadows, sky_blockage, ..Surface::default() };
            assert_finite(&run(&mesh, &surface));
        }
    }
}

#[test]
fn size_does_not_matter_until_it_overflows() {
    let mesh = bumpy(60);
    let unit = run(&mesh, &Surface::default());
    for scale in [1e-3, 1e6, 1e12] {
        let table = run(&mesh.scaled(scale), &Surface::default());
        let ratio = table.spin_torque_n_m[0][5] / (scale * scale * scale) / unit.spin_torque_n_m[0][5];
        assert!((ratio - 1.0).abs() < 1e-6, "{scale}: {ratio}");
    }
    let huge = torque_table_of_facets(&mesh.scaled(1e150), &Surface::default(), &Orbit::default(), &quick());
    assert!(matches!(huge, Err(TacoError::NotFinite { .. })), "{huge:?}");
}

#[test]
fn bad_input_is_refused_with_its_name() {
    let mesh = bumpy(60);
    let error = |mesh: &Mesh, surface: &Surface, orbit: &Orbit, sampling: &Sampling| {
        torque_table_of_facets(mesh, surface, orbit, sampling).expect_err("refused").to_string()
    };
    let (surface, orbit, sampling) = (Surface::default(), Orbit::default(), quick());
    let bright = Surface { reflectance: Reflectance::Lambert { bond_albedo: 2.0 }, ..Surface::default() };
    assert_eq!(
        error(&mesh, &bright, &orbit, &sampling),
        "surface.reflectance.lambert.bond_albedo is 2; allowed: [0, 1]"
    );
    let hyperbolic = Orbit { eccentricity: 1.0, ..orbit };
    assert_eq!(error(&mesh, &surface, &hyperbolic, &sampling), "orbit.eccentricity is 1; allowed: [0, 1)");
    let coarse = Sampling { azimuth_bins: 10, ..quick() };
    assert!(error(&mesh, &surface, &orbit, &coarse).starts_with("sampling.azimuth_bins is 10"));
    let mut broken = mesh.clone();
    broken.vertices[3][1] = f64::INFINITY;
    assert_eq!(error(&broken, &surface, &orbit, &sampling), "vertex 3 of the mesh has a coordinate that is not finite");
    assert_eq!(error(&Mesh::default(), &surface, &orbit, &sampling), "the mesh has no facets");
}

#[test]
fn error_parts_are_those_that_apply() {
    let names = |table: &TorqueTable| table.error.parts.iter().map(|p| p.name.clone()).collect::<Vec<_>>();
    let shaded = run(&bumpy(60), &Surface::default());
    assert_eq!(
        names(&shaded),
        ["declination_nodes", "azimuth_bins", "facet_sampling", "round_off", "obliquity_interpolation"]
    );
    let sum: f64 = shaded.error.parts.iter().map(|p| p.spin_torque_n_m).sum();
    assert_eq!(shaded.error.spin_torque_n_m, sum);
    let convex = run(&rings(8, 16, [1.0, 0.8, 0.6], |_, _| 1.0), &Surface::default());
    assert_eq!(names(&convex), ["declination_nodes", "round_off", "obliquity_interpolation"]);
}

/// Chosen obliquities are answered at the nodes of their own table.
#[test]
fn chosen_obliquities_have_no_error_of_an_interpolation() {
    for degrees in [&[45.0][..], &[0.0, 90.0, 180.0]] {
        let sampling = Sampling { declination_nodes: 9, ..common::at_obliquities(degrees) };
        let table =
            torque_table_of_facets(&bumpy(60), &Surface::default(), &Orbit::default(), &sampling).expect("finite");
        assert!(table.error.parts.iter().all(|p| p.name != "obliquity_interpolation"), "{:?}", table.error);
    }
}

/// Whatever the orientation, the torque of a body that has none by symmetry is below its error.
#[test]
fn the_torque_of_symmetric_bodies_is_below_its_error() {
    let box_of = |a: f64, b: f64, c: f64| {
        let half = [a, b, c];
        let corner = |i: usize| std::array::from_fn(|k| if i >> k & 1 == 0 { -half[k] } else { half[k] });
        let vertices = (0..8).map(corner).collect();
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let facets = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
        Mesh { vertices, facets }
    };
    let octahedron = Mesh {
        vertices: [
            [1.0, 0.0, 0.0],
            [-1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, -1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.0, 0.0, -1.0],
        ]
        .to_vec(),
        facets: vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]],
    };
    for mesh in [box_of(1.0, 1.0, 1.0), box_of(3.0, 2.0, 1.0), octahedron, rings(12, 24, [1.0, 0.8, 0.6], |_, _| 1.0)] {
        for scale in [1.0, 500.0, 1e5] {
            let table = run(&mesh.scaled(scale), &Surface::default());
            let (spin, tilt) = (peak(&table.spin_torque_n_m[0]), peak(&table.obliquity_torque_n_m[0]));
            let error = &table.error;
            assert!(
                spin <= error.spin_torque_n_m && tilt <= error.obliquity_torque_n_m,
                "{scale}: {spin:e} {tilt:e} {error:?}"
            );
        }
    }
}

/// The estimates are to be of the size of the errors: against ten times finer sampling.
#[test]
fn sampling_errors_are_within_their_estimates() {
    let mesh = bumpy(394);
    let at = |azimuth_bins, declination_nodes| {
        let sampling = Sampling { azimuth_bins, declination_nodes, ..Sampling::default() };
        torque_table_of_facets(&mesh, &Surface::default(), &Orbit::default(), &sampling).unwrap()
    };
    let fine = at(720, 361);
    for (bins, nodes) in [(24, 13), (72, 19), (120, 37)] {
        let table = at(bins, nodes);
        let spin = common::distance(&table.spin_torque_n_m[0], &fine.spin_torque_n_m[0]);
        let tilt = common::distance(&table.obliquity_torque_n_m[0], &fine.obliquity_torque_n_m[0]);
        let sampled = |f: fn(&taco::ErrorPart) -> f64| table.error.parts[..2].iter().map(f).sum::<f64>();
        let estimates = (sampled(|p| p.spin_torque_n_m), sampled(|p| p.obliquity_torque_n_m));
        println!(
            "{bins} {nodes}: {spin:e} {tilt:e}, estimated {estimates:?}, peak {:e}",
            peak(&fine.spin_torque_n_m[0])
        );
        assert!(spin < 1.5 * estimates.0 && tilt < 1.5 * estimates.1);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn prop_any_triangles_give_finite_torques_or_a_named_error(
        coordinates in proptest::collection::vec(proptest::array::uniform3(-10i32..10), 3..12),
        indices in proptest::collection::vec(proptest::array::uniform3(0u32..13), 1..20),
    ) {
        let vertices = coordinates.iter().map(|v| v.map(f64::from)).collect();
        let mesh = Mesh { vertices, facets: indices };
        if let Ok(table) = torque_table_of_facets(&mesh, &Surface::default(), &Orbit::default(), &quick()) {
            assert_finite(&table);
        }
    }
}
