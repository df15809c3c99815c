//! What light that facets send to one another does to the torque of a body.

mod common;

use common::{bumpy, centred, distance, lambert, off, peak, rings, table};
use nalgebra::Rotation3;
use std::f64::consts::TAU;
use taco::{Orbit, Reflectance, Sampling, SelfHeating, SpinRates, Surface, TorqueTable, torque_table_of_facets};
use tiling::Mesh;

fn heated(self_heating: SelfHeating) -> Surface {
    Surface { self_heating, ..Surface::default() }
}

/// A sphere with a deep bowl off its poles and axes.
fn bowl(vertices: usize) -> Mesh {
    let mut mesh = tiling::fibonacci::unit_sphere(vertices).expect("enough vertices");
    let towards = nalgebra::Vector3::new(0.6, 0.3, 0.5).normalize();
    for v in &mut mesh.vertices {
        let cos = nalgebra::Vector3::from(*v).dot(&towards);
        let depth = 0.55 * (-((1.0 - cos) / 0.12).powi(2)).exp();
        *v = v.map(|c| c * (1.0 - depth));
    }
    centred(mesh)
}

#[test]
fn convex_bodies_do_not_notice() {
    let mesh = centred(tiling::fibonacci::unit_sphere(300).expect("enough vertices"));
    let none = table(&mesh, &heated(SelfHeating::None));
    for mode in [SelfHeating::Single, SelfHeating::Multiple] {
        assert_eq!(none, table(&mesh, &heated(mode)));
    }
}

#[test]
fn bowl_changes_the_torque_and_the_second_flight_adds_less_than_the_first() {
    let mesh = bowl(400);
    let [none, single, multiple] =
        [SelfHeating::None, SelfHeating::Single, SelfHeating::Multiple].map(|mode| table(&mesh, &heated(mode)));
    let (first, rest) = (off(&none, &single), off(&single, &multiple));
    println!("first flight {first}, later ones {rest}");
    assert!(first > 0.01 && rest > 1e-4 && rest < 0.5 * first, "{first} {rest}");
    assert!(single.error.parts.iter().any(|part| part.name == "azimuth_bins"));
}

#[test]
fn mirror_symmetric_body_with_self_heating_has_no_torque() {
    let waist = |_: f64, latitude: f64| 1.0 + 0.5 * (2.0 * latitude).sin().powi(2);
    let table = table(&rings(20, 40, [1.0, 0.8, 1.2], waist), &heated(SelfHeating::Multiple));
    assert!(table.shaded_facets > 100);
    let worst = peak(&table.spin_torque_n_m[0]).max(peak(&table.obliquity_torque_n_m[0]));
    let torque = worst / Orbit::default().mean_pressure_pa();
    // Fractions are kept to 6e-8, and mirror images need not round alike.
    assert!(torque < 1e-6, "{torque:e}");
}

#[test]
fn turning_about_the_spin_axis_changes_nothing() {
    let mesh = bumpy(394);
    let reference = table(&mesh, &heated(SelfHeating::Multiple));
    let turned = mesh.rotated(Rotation3::from_axis_angle(&nalgebra::Vector3::z_axis(), 1.0).matrix());
    let change = off(&reference, &table(&turned, &heated(SelfHeating::Multiple)));
    assert!(change < 1e-6, "{change:e}");
}

#[test]
fn mirroring_in_a_meridian_plane_flips_both_torques() {
    let mesh = bumpy(394);
    let mirrored = Mesh {
        vertices: mesh.vertices.iter().map(|[x, y, z]| [*x, -y, *z]).collect(),
        facets: mesh.facets.iter().map(|[a, b, c]| [*a, *c, *b]).collect(),
    };
    let surface = heated(SelfHeating::Multiple);
    let mut image: TorqueTable = table(&mirrored, &surface);
    for row in image.spin_torque_n_m.iter_mut().chain(&mut image.obliquity_torque_n_m) {
        row.iter_mut().for_each(|t| *t = -*t);
    }
    let change = off(&table(&mesh, &surface), &image);
    assert!(change < 1e-6, "{change:e}");
}

/// All light is followed until it escapes, whether scattered or emitted, so it does not matter which.
#[test]
fn lambert_torque_does_not_depend_on_albedo_or_emissivity() {
    let mesh = bowl(200);
    let surface = |bond_albedo, emissivity| Surface {
        reflectance: Reflectance::Lambert { bond_albedo },
        emissivity,
        ..heated(SelfHeating::Multiple)
    };
    let black = table(&mesh, &surface(0.0, 0.9));
    assert!(off(&black, &table(&mesh, &surface(0.8, 0.5))) < 1e-12);
    assert!(off(&black, &table(&mesh, &lambert(0.0))) > 0.01);
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let mesh = bumpy(394);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| table(&mesh, &heated(SelfHeating::Multiple)))
    };
    let one = on(1);
    for threads in [2, 3] {
        assert_eq!(one, on(threads));
    }
}

/// Fewer azimuths cost accuracy, and the error estimate says how much.
#[test]
fn azimuth_error_covers_the_view_factors() {
    let mesh = bowl(400);
    let at = |azimuth_bins| {
        let sampling = Sampling { azimuth_bins, ..Sampling::default() };
        torque_table_of_facets(&mesh, &heated(SelfHeating::Multiple), &Orbit::default(), &sampling)
            .expect("a valid mesh")
    };
    let (coarse, fine) = (at(64), at(512));
    let estimate = coarse.error.parts.iter().find(|part| part.name == "azimuth_bins").expect("shaded").spin_torque_n_m;
    let actual = distance(&coarse.spin_torque_n_m[0], &fine.spin_torque_n_m[0]);
    println!("estimate {estimate:e}, actual {actual:e}");
    assert!(actual < 2.0 * estimate, "{actual:e} {estimate:e}");
}

const SIX_HOURS: f64 = TAU / 21_600.0;

/// With conducted heat, at these spin rates.
fn dusty(mesh: &Mesh, thermal_inertia: f64, self_heating: SelfHeating, rates: &[f64]) -> TorqueTable {
    let surface = Surface { thermal_inertia, ..heated(self_heating) };
    let sampling =
        Sampling { spin_rates: SpinRates::ListRadS(rates.to_vec()), declination_nodes: 13, ..Sampling::default() };
    torque_table_of_facets(mesh, &surface, &Orbit::default(), &sampling).expect("a valid mesh")
}

#[test]
fn convex_bodies_with_heat_do_not_notice() {
    let mesh = centred(tiling::fibonacci::unit_sphere(60).expect("enough vertices"));
    let none = dusty(&mesh, 200.0, SelfHeating::None, &[SIX_HOURS]);
    assert_eq!(none, dusty(&mesh, 200.0, SelfHeating::Multiple, &[SIX_HOURS]));
}

/// Whatever is conducted has no mean and walks like all other light, so the spin torque is that without inertia.
#[test]
fn conducted_heat_leaves_the_spin_torque_and_the_limit_of_no_inertia() {
    let mesh = bowl(200);
    let sampling = Sampling { declination_nodes: 13, ..Sampling::default() };
    let cold = torque_table_of_facets(&mesh, &heated(SelfHeating::Multiple), &Orbit::default(), &sampling)
        .expect("a valid mesh");
    let warm = dusty(&mesh, 200.0, SelfHeating::Multiple, &[0.0, 0.5 * SIX_HOURS, SIX_HOURS]);
    let alone = dusty(&mesh, 200.0, SelfHeating::None, &[SIX_HOURS]);
    for spin in &warm.spin_torque_n_m {
        assert_eq!(*spin, cold.spin_torque_n_m[0]);
    }
    assert_eq!(warm.obliquity_torque_n_m[0], cold.obliquity_torque_n_m[0]);
    let scale = peak(&warm.obliquity_torque_n_m[2]);
    assert!(distance(&warm.obliquity_torque_n_m[2], &cold.obliquity_torque_n_m[0]) > 0.05 * scale);
    assert!(distance(&warm.obliquity_torque_n_m[2], &alone.obliquity_torque_n_m[0]) > 0.02 * scale);
    let least = dusty(&mesh, 1e-3, SelfHeating::Multiple, &[SIX_HOURS]);
    assert!(distance(&least.obliquity_torque_n_m[0], &cold.obliquity_torque_n_m[0]) < 1e-4 * scale);
    assert!(peak(&warm.transverse_force_n[2]) > 0.0);
}

/// The coupling is settled to its tolerance from wherever it starts: one spin rate alone, or along a table.
#[test]
fn spin_rates_before_do_not_matter() {
    let mesh = bowl(200);
    let along = dusty(&mesh, 200.0, SelfHeating::Multiple, &[0.1 * SIX_HOURS, 0.4 * SIX_HOURS, SIX_HOURS]);
    let alone = dusty(&mesh, 200.0, SelfHeating::Multiple, &[SIX_HOURS]);
    let off = distance(&along.obliquity_torque_n_m[2], &alone.obliquity_torque_n_m[0]);
    println!("{:e}", off / peak(&alone.obliquity_torque_n_m[0]));
    assert!(off < 2e-3 * peak(&alone.obliquity_torque_n_m[0]), "{off:e}");
}

#[test]
fn results_with_heat_do_not_depend_on_the_number_of_threads() {
    let mesh = bumpy(100);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| dusty(&mesh, 200.0, SelfHeating::Multiple, &[SIX_HOURS]))
    };
    assert_eq!(on(1), on(3));
}
