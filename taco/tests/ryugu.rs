//! Real shapes against published torques.

mod common;

use common::{at_obliquities, centred, lambert};
use taco::{Orbit, Surface, torque_table};

/// Kanamaru et al. 2021 (JGR Planets 126, e2021JE006863), (162173) Ryugu, model with 49 152 facets: obliquity 171.64 deg,
/// C = 4.0395e16 kg m^2; d omega/dt = -3.531e-6 deg/d^2, obliquity component +1.667e-6 deg/d^2. Their obliquity
/// component has the sign of ours: torque over C along the direction that raises the obliquity. Shadows are all of it:
/// without them the spin component is -1.3e-7.
#[test]
fn paper_kanamaru_2021_ryugu_spin_and_obliquity_torque() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/shapes/ryugu_49152.obj");
    let Ok(text) = std::fs::read(path) else {
        println!("skipped: ../shared/shapes/ryugu_49152.obj is not there");
        return;
    };
    let mesh = centred(tiling::obj::read(&text).unwrap());
    let orbit = Orbit { semimajor_axis_au: 1.1896, eccentricity: 0.1902 };
    let to_deg_d2 = 86_400f64.powi(2).to_degrees() / 4.0395e16;
    let components = |surface: &Surface| {
        let table = torque_table(&mesh, surface, &orbit, &at_obliquities(&[171.64])).unwrap();
        (table.spin_torque_n_m[0][0] * to_deg_d2, table.obliquity_torque_n_m[0][0] * to_deg_d2)
    };
    let (spin, tilt) = components(&lambert(0.1));
    println!("spin {spin:e}, obliquity {tilt:e} deg/d^2");
    assert!((spin / -3.531e-6 - 1.0).abs() < 0.03, "{spin:e}");
    assert!((tilt / 1.667e-6 - 1.0).abs() < 0.03, "{tilt:e}");
    let (spin, _) = components(&Surface { shadows: false, ..lambert(0.1) });
    assert!((spin / -1.3e-7 - 1.0).abs() < 0.05, "{spin:e}");
}
