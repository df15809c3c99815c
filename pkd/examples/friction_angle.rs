//! Angle of friction of a set of soft-sphere parameters: `cargo run --release -p yorp-pkd --example friction_angle -- PRESET`.
//!
//! A triaxial test without walls. A ball of equal spheres that holds together by its own gravity is spun up slowly. Gravity and
//! the centrifugal force press with sigma_z along the spin and with less, sigma_x = sigma_y, across it, in the same ratio
//! everywhere (Holsapple 2001, Icarus 154, 432); where the ratio reaches what friction can bear the ball flattens, and goes
//! on flattening at that ratio as it is given more angular momentum. A cohesionless Mohr-Coulomb material has
//! sin phi = (sigma_z - sigma_x) / (sigma_z + sigma_x) then. Stresses are those of the contacts, summed over the ball: no
//! density or boundary enters. Prints the mean over axial strains of 3 to 20 %, or to where it falls apart, and the course of it.

use std::f64::consts::PI;

use nalgebra::Vector3;
use pkd::constants::G;
use pkd::frame::{add_spin, set_rigid_rotation};
use pkd::mass_properties::mass_properties;
use pkd::packing::{EllipsoidPacking, Grain, PACKING_FRACTION, Seed, ellipsoid_packing};
use pkd::soft_sphere::{Friction, SoftSphere, SoftSphereParameters};
use pkd::{PkdError, Spheres};

/// Spheres in the ball.
const COUNT: usize = 1000;
/// Angular momentum is added so fast that a rigid ball would gain this share of the limiting spin rate per limiting period.
const SPIN_UP: f64 = 0.03;
/// Stretches in a limiting period.
const STRETCHES: u32 = 10;
/// Most limiting periods.
const PERIODS: u32 = 40;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |k: usize| arguments.get(k).map(|a| a.parse::<f64>()).transpose();
    let mut parameters = match arguments.first().map(String::as_str) {
        Some("gravel") => SoftSphereParameters::gravel(),
        Some("glass_beads") => SoftSphereParameters::glass_beads(),
        Some("zhang_2017") => SoftSphereParameters::zhang_2017(),
        Some("frictionless") => SoftSphereParameters::frictionless(),
        _ => return Err("usage: friction_angle gravel|glass_beads|zhang_2017|frictionless [MU_S [MU_R [MU_T]]]".into()),
    };
    if let Friction::Directional { sliding, rolling, twisting }
    | Friction::RollingAndTwisting { sliding, rolling, twisting } = &mut parameters.friction
    {
        sliding.coefficient = number(1)?.unwrap_or(sliding.coefficient);
        *rolling = number(2)?.unwrap_or(*rolling);
        *twisting = number(3)?.unwrap_or(*twisting);
    }
    println!("{:?}", parameters.friction);

    let mut body = ellipsoid_packing(&EllipsoidPacking {
        count: COUNT,
        grain: Grain { radius: 50.2, density: 2960.0 },
        b_over_a: 1.0,
        c_over_a: 1.0,
        packing_fraction: PACKING_FRACTION,
        seed: Seed::default(),
    })?;
    parameters.expected_speed_m_s = Some(0.1);
    let stiffness = SoftSphere::new(parameters.clone()).stiffness(&body)?.normal_n_m;
    let mut soft = SoftSphere::new(SoftSphereParameters { normal_stiffness_n_m: Some(stiffness), ..parameters });
    // It falls together; now and then the motion is taken away.
    for _ in 0..8 {
        soft.evolve(&mut body, 1000.0)?;
        set_rigid_rotation(&mut body, Vector3::zeros())?;
    }
    let start = mass_properties(&body)?;
    let limit = (4.0 / 3.0 * PI * G * start.extents_density()).sqrt();
    let period = 2.0 * PI / limit;
    add_spin(&mut body, Vector3::z() * (0.4 * limit))?;
    soft.evolve(&mut body, period)?;

    println!("    time   spin   strain   ratio    phi  contacts");
    println!("  limits  limit        %               deg");
    let (mut sum, mut samples, height) = (0.0, 0, mass_properties(&body)?.deeve_axes().z);
    for step in 0..PERIODS * STRETCHES {
        let rigid = 0.4 * body.total_mass() * start.mean_radius().powi(2) * limit * SPIN_UP / f64::from(STRETCHES);
        let moment = mass_properties(&body)?.moments.z;
        add_spin(&mut body, Vector3::z() * (rigid / moment))?;
        let report = match soft.evolve(&mut body, period / f64::from(STRETCHES)) {
            Err(PkdError::TooSoft { .. }) if samples > 0 => {
                println!("it falls apart: what fell back struck too hard");
                break;
            }
            answer => answer?,
        };
        let properties = mass_properties(&body)?;
        let strain = (height / properties.deeve_axes().z).ln();
        let ratio = stress_ratio(&mut soft, &body)?;
        let sine = (ratio - 1.0) / (ratio + 1.0);
        if (0.03..0.20).contains(&strain) {
            (sum, samples) = (sum + sine, samples + 1);
        }
        if step % STRETCHES == 0 {
            let (time, spin) = (f64::from(step / STRETCHES), properties.spin_rate() / limit);
            let (percent, phi, contacts) = (100.0 * strain, sine.asin().to_degrees(), report.contacts_per_sphere);
            println!("{time:8.0} {spin:6.3} {percent:8.2} {ratio:7.3} {phi:6.2}  {contacts:8.2}");
        }
        if strain > 0.20 {
            break;
        }
    }
    println!("angle of friction {:.1} deg, mean of {samples} samples", (sum / f64::from(samples)).asin().to_degrees());
    Ok(())
}

/// Stress along the spin over the mean of those across it.
fn stress_ratio(soft: &mut SoftSphere, body: &Spheres) -> Result<f64, PkdError> {
    let forces = soft.contact_forces(body)?.force_n;
    let mut stress = [0.0; 3];
    for (i, force) in forces.iter().enumerate() {
        for (k, sum) in stress.iter_mut().enumerate() {
            *sum += body.position(i)[k] * force[k];
        }
    }
    Ok(2.0 * stress[2] / (stress[0] + stress[1]))
}
