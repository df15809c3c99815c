//! Torques and Yarkovsky force of bodies that store heat.

mod common;

use common::{at_obliquities, bumpy, centred, lambert, peak, rings};
use std::f64::consts::{PI, TAU};
use taco::constants::{SPEED_OF_LIGHT_M_S, STEFAN_BOLTZMANN_W_M2_K4};
use taco::{AU_PER_MYR, Interpolation, Orbit, Sampling, SpinRates, Surface, TorqueTable, Wall, torque_table_of_facets};
use tiling::Mesh;

const SIX_HOURS: f64 = TAU / 21_600.0;

fn dusty(thermal_inertia: f64) -> Surface {
    Surface { thermal_inertia, ..Surface::default() }
}

fn at_rates(rates: &[f64]) -> Sampling {
    Sampling { spin_rates: SpinRates::ListRadS(rates.to_vec()), ..Sampling::default() }
}

fn at(mesh: &Mesh, surface: &Surface, rates: &[f64]) -> TorqueTable {
    torque_table_of_facets(mesh, surface, &Orbit::default(), &at_rates(rates)).unwrap()
}

#[test]
fn heat_leaves_the_spin_torque_and_moves_the_obliquity_torque() {
    let mesh = bumpy(200);
    let cold = at(&mesh, &dusty(0.0), &[SIX_HOURS]);
    assert_eq!((cold.omega.as_slice(), cold.transverse_force_n.len()), ([0.0].as_slice(), 0));
    let warm = at(&mesh, &dusty(200.0), &[0.0, SIX_HOURS]);
    for w in 0..2 {
        assert_eq!(warm.spin_torque_n_m[w], cold.spin_torque_n_m[0]);
    }
    assert_eq!(warm.obliquity_torque_n_m[0], cold.obliquity_torque_n_m[0]);
    let moved = common::distance(&warm.obliquity_torque_n_m[1], &cold.obliquity_torque_n_m[0]);
    assert!(moved > 0.1 * peak(&cold.obliquity_torque_n_m[0]), "{moved:e}");
    // Next to no inertia is next to no change.
    let least = at(&mesh, &dusty(1e-3), &[SIX_HOURS]);
    let moved = common::distance(&least.obliquity_torque_n_m[0], &cold.obliquity_torque_n_m[0]);
    assert!(moved < 1e-4 * peak(&cold.obliquity_torque_n_m[0]), "{moved:e}");
    for part in ["rotation_cells", "declination_nodes"] {
        assert!(warm.error.parts.iter().any(|p| p.name == part && p.obliquity_torque_n_m > 0.0), "{part}");
    }
}

/// Diurnal heat alone leaves both symmetries; see the brute-force average below.
#[test]
fn symmetries_about_90_deg_outlast_diurnal_heat() {
    let table = at(&bumpy(200), &dusty(200.0), &[SIX_HOURS]);
    let (spin, tilt, force) = (&table.spin_torque_n_m[0], &table.obliquity_torque_n_m[0], &table.transverse_force_n[0]);
    for k in 0..37 {
        assert_eq!((spin[k], tilt[k], force[k]), (spin[36 - k], -tilt[36 - k], -force[36 - k]));
    }
}

#[test]
fn results_with_heat_do_not_depend_on_the_number_of_threads() {
    let mesh = bumpy(200);
    let surface = Surface { tangential_yorp: Some(stones()), ..dusty(200.0) };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| at(&mesh, &surface, &[1e-4, SIX_HOURS]))
    };
    assert_eq!(on(1), on(3));
}

/// One facet's temperature over a day by finite differences in depth: implicit, second order in time, the surface's fourth power
/// by Newton's method; T in kelvin, `f` absorbed in W/m^2. The oracle of the frequency domain.
fn depth_grid(f: &[f64], omega: f64, inertia: f64, emissivity: f64) -> Vec<f64> {
    const LAYERS: usize = 48;
    let n = f.len();
    // Depth in units of the skin depth: dT/dt = omega / 2 d2T/dx2, flux = Gamma sqrt(omega / 2) dT/dx. Layers grow downwards.
    let x: Vec<f64> =
        (0..=LAYERS).map(|k| 10.0 * ((0.08 * k as f64).exp_m1()) / (0.08 * LAYERS as f64).exp_m1()).collect();
    let conductance = inertia * (0.5 * omega).sqrt();
    let step = TAU / n as f64; // omega dt
    let mean = f.iter().sum::<f64>() / n as f64;
    let sigma = emissivity * STEFAN_BOLTZMANN_W_M2_K4;
    let start = (mean / sigma).powf(0.25) * 0.97;
    let (mut now, mut before) = (vec![start; LAYERS + 1], vec![start; LAYERS + 1]);
    let mut surface = vec![0.0; n];
    for day in 0..60 {
        for k in 0..n {
            // (3 T - 4 now + before) / (2 step) = 1/2 T'', eliminated from the insulated bottom up: T[i] = a[i] + b[i] T[i - 1].
            let (mut a, mut b) = (vec![0.0; LAYERS + 1], vec![0.0; LAYERS + 1]);
            for i in (1..=LAYERS).rev() {
                let up = 1.0 / (x[i] - x[i - 1]);
                let down = if i < LAYERS { 1.0 / (x[i + 1] - x[i]) } else { 0.0 };
                let width = if i < LAYERS { 0.5 * (x[i + 1] - x[i - 1]) } else { 0.5 * (x[i] - x[i - 1]) };
                let rate = width / step;
                let (below_a, below_b) = if i < LAYERS { (a[i + 1], b[i + 1]) } else { (0.0, 0.0) };
                let diagonal = 3.0 * rate + up + down * (1.0 - below_b);
                a[i] = (rate * (4.0 * now[i] - before[i]) + down * below_a) / diagonal;
                b[i] = up / diagonal;
            }
            // The surface's half layer: width (3 T - ..) / (2 step) = [T1 - T0] / 2 dx + (f - sigma T^4) / (2 conductance) in these
            // units, with the sunlight of the moment.
            let (up, rate) = (1.0 / x[1], 0.5 * x[1] / step);
            let mut t = now[0];
            for _ in 0..30 {
                let balance = rate * (3.0 * t - 4.0 * now[0] + before[0])
                    - up * (a[1] + b[1] * t - t)
                    - (f[k] - sigma * t.powi(4)) / conductance;
                let slope = 3.0 * rate + up * (1.0 - b[1]) + 4.0 * sigma * t.powi(3) / conductance;
                let change = balance / slope;
                t -= change;
                if change.abs() < 1e-10 * t {
                    break;
                }
            }
            let mut next = vec![t; LAYERS + 1];
            for i in 1..=LAYERS {
                next[i] = a[i] + b[i] * next[i - 1];
            }
            before = std::mem::replace(&mut now, next);
            surface[k] = t;
        }
        // Heat that is too much or too little leaves slowly: the whole column is shifted.
        if day < 50 {
            let emitted = surface.iter().map(|t| sigma * t.powi(4)).sum::<f64>() / n as f64;
            let average = (mean / sigma).powf(0.25);
            let shift = (mean - emitted) / (4.0 * sigma * average.powi(3));
            now.iter_mut().chain(&mut before).for_each(|t| *t += shift);
        }
    }
    surface
}

/// The torque of a small lopsided convex body, with everything done the long way: finite differences in depth, vectors in
/// the space frame, every rotation and orbit phase. It agrees with the table, and is odd about 90 deg as the table is.
#[test]
fn brute_force_average_in_the_space_frame_agrees_and_is_odd_about_90_deg() {
    // An octahedron pulled out of shape, so that no symmetry makes any term vanish.
    let mesh = centred(Mesh {
        vertices: vec![
            [1.3, 0.1, 0.2],
            [-0.9, 0.3, -0.1],
            [0.2, 1.1, 0.3],
            [-0.1, -0.8, 0.1],
            [0.1, 0.2, 0.9],
            [0.3, -0.2, -0.7],
        ],
        facets: vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]],
    });
    mesh.check().expect("closed");
    let (inertia, emissivity, omega) = (150.0, 0.9, SIX_HOURS);
    let flux = Orbit::default().mean_flux_w_m2();
    let (phases, longitudes) = (240, 24);
    let cross = |a: [f64; 3], b: [f64; 3]| -> [f64; 3] {
        std::array::from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
    };
    let brute_force = |obliquity: f64| {
        // Spin along z, orbit normal (-sin, 0, cos): the direction that raises the obliquity is x.
        let normal = [-obliquity.sin(), 0.0, obliquity.cos()];
        let node = [0.0, -1.0, 0.0];
        let ahead = cross(normal, node);
        let mut torque = [0.0; 3];
        for l in 0..longitudes {
            let (sin_l, cos_l) = (TAU * (l as f64 + 0.5) / longitudes as f64).sin_cos();
            let sun: [f64; 3] = std::array::from_fn(|k| cos_l * node[k] + sin_l * ahead[k]);
            for f in 0..mesh.facets.len() {
                let (area, point): ([f64; 3], [f64; 3]) = (mesh.area_vector(f).into(), mesh.centroid(f).into());
                let size = (0..3).map(|k| area[k] * area[k]).sum::<f64>().sqrt();
                let turned = |v: [f64; 3], k: usize| {
                    let (s, c) = (TAU * (k as f64 + 0.5) / phases as f64).sin_cos();
                    [c * v[0] - s * v[1], s * v[0] + c * v[1], v[2]]
                };
                let sunlight: Vec<f64> = (0..phases)
                    .map(|k| (0..3).map(|i| turned(area, k)[i] * sun[i]).sum::<f64>().max(0.0) * flux / size)
                    .collect();
                if sunlight.iter().all(|s| *s == 0.0) {
                    continue;
                }
                let temperature = depth_grid(&sunlight, omega, inertia, emissivity);
                for (k, t) in temperature.iter().enumerate() {
                    let pressure = -2.0 / 3.0 * emissivity * STEFAN_BOLTZMANN_W_M2_K4 * t.powi(4) / SPEED_OF_LIGHT_M_S;
                    let force = turned(area, k).map(|n| pressure * n / (phases * longitudes) as f64);
                    let arm = cross(turned(point, k), force);
                    (0..3).for_each(|i| torque[i] += arm[i]);
                }
            }
        }
        torque
    };
    let surface = Surface { thermal_inertia: inertia, emissivity, ..lambert(0.0) };
    let sampling = Sampling { spin_rates: SpinRates::ListRadS(vec![omega]), ..at_obliquities(&[35.0, 145.0]) };
    let table = torque_table_of_facets(&mesh, &surface, &Orbit::default(), &sampling).unwrap();
    let cold = torque_table_of_facets(&mesh, &lambert(0.0), &Orbit::default(), &sampling).unwrap();
    let (spin, tilt) = (&table.spin_torque_n_m[0], &table.obliquity_torque_n_m[0]);
    let torques = [brute_force(35f64.to_radians()), brute_force(145f64.to_radians())];
    println!("{torques:?}\n{spin:?} {tilt:?} {:?}", cold.obliquity_torque_n_m[0]);
    let scale = peak(spin).max(peak(tilt));
    assert!((cold.obliquity_torque_n_m[0][0] - tilt[0]).abs() > 0.05 * scale);
    for k in 0..2 {
        assert!((torques[k][0] - tilt[k]).abs() < 0.004 * scale, "{k}: {} {}", torques[k][0], tilt[k]);
        assert!((torques[k][2] - spin[k]).abs() < 0.004 * scale, "{k}: {} {}", torques[k][2], spin[k]);
    }
    assert!((torques[0][0] + torques[1][0]).abs() < 0.004 * scale);
}

/// Vokrouhlicky 1998 (A&A 335, 1093), large body: the drift of the orbit in au/Myr at obliquity 0.
fn linear_theory(theta: f64, absorptivity: f64, radius: f64, density: f64, orbit: &Orbit) -> f64 {
    let mass = 4.0 / 3.0 * PI * radius.powi(3) * density;
    let phi = PI * radius * radius * orbit.mean_pressure_pa() / mass;
    let f = 0.5 * theta / (1.0 + theta + 0.5 * theta * theta);
    8.0 / 9.0 * absorptivity * phi / orbit.mean_motion_rad_s() * f * AU_PER_MYR
}

fn drift(radius: f64, density: f64, orbit: &Orbit, inertia: f64) -> Vec<f64> {
    let mesh = rings(24, 48, [radius; 3], |_, _| 1.0);
    let surface = Surface { thermal_inertia: inertia, ..lambert(0.0672) };
    let sampling =
        Sampling { spin_rates: SpinRates::ListRadS(vec![SIX_HOURS]), ..at_obliquities(&[0.0, 60.0, 90.0, 180.0]) };
    let table = torque_table_of_facets(&mesh, &surface, orbit, &sampling).unwrap();
    let mass = 4.0 / 3.0 * PI * radius.powi(3) * density;
    table.transverse_force_n[0].iter().map(|f| orbit.semimajor_axis_drift_m_s(*f, mass) * AU_PER_MYR).collect()
}

#[test]
fn spheres_drift_as_linear_theory_has_it() {
    let near = Orbit::default();
    let far = Orbit { semimajor_axis_au: 1.81, eccentricity: 0.0 };
    for (radius, density, orbit, theta, expected) in [
        (630.0, 1630.0, near, 1.067, 5.895e-4),
        (500.0, 2500.0, near, 1.067, 4.843e-4),
        (370.0, 2000.0, far, 2.598, 5.597e-4),
    ] {
        let linear = linear_theory(theta, 1.0 - 0.0672, radius, density, &orbit);
        assert!((linear / expected - 1.0).abs() < 2e-3, "{linear:e} {expected:e}");
        let got = drift(radius, density, &orbit, 200.0);
        println!("{got:?} {linear:e}");
        // Outwards for prograde, inwards for retrograde rotation. Linear theory knows one mean temperature for all latitudes.
        assert!((got[0] / linear - 1.0).abs() < 0.15, "{} {linear}", got[0]);
        assert!((got[3] + got[0]).abs() < 1e-12 && got[2] == 0.0);
        // Nearly the cosine: cold poles and warm ones differ little in what they add.
        assert!((got[1] / got[0] - 0.5).abs() < 0.05, "{got:?}");
    }
}

/// Where conduction wins, temperatures are uniform along each circle of latitude and the drift falls as 1/Theta, with the third power
/// of each circle's own mean temperature: a closed form at obliquity 0.
#[test]
fn strong_conduction_has_its_closed_form() {
    let orbit = Orbit { semimajor_axis_au: 30.0, eccentricity: 0.0 };
    let (radius, density, inertia) = (500.0, 2000.0, 1e4);
    let absorptivity = 1.0 - 0.0672;
    let subsolar = (absorptivity * orbit.mean_flux_w_m2() / (0.9 * STEFAN_BOLTZMANN_W_M2_K4)).powf(0.25);
    let theta = inertia * SIX_HOURS.sqrt() / (0.9 * STEFAN_BOLTZMANN_W_M2_K4 * subsolar.powi(3));
    // T0^4 = cos lat / pi, |f_1| = cos lat / 4; emission lags by 45 deg: means of E sin H.
    let n = 20_000;
    let integral: f64 = (0..n)
        .map(|k| (PI * ((k as f64 + 0.5) / n as f64 - 0.5)).cos())
        .map(|c| 2.0 * PI * c * c * 2.0 / 3.0 * (c / PI).powf(0.75) * c * PI / n as f64)
        .sum();
    // 4 T0^3 |T_1| 2 / 2 with |T_1| = |f_1| / Theta and sin 45 deg.
    let force =
        integral * 4.0 * 0.25 * 0.5f64.sqrt() / theta * absorptivity * orbit.mean_pressure_pa() * radius * radius;
    let mass = 4.0 / 3.0 * PI * radius.powi(3) * density;
    let expected = orbit.semimajor_axis_drift_m_s(force, mass) * AU_PER_MYR;
    let got = drift(radius, density, &orbit, inertia)[0];
    assert!((got / expected - 1.0).abs() < 0.02, "{got:e} {expected:e}, theta {theta}");
}

/// An eccentric orbit is the average of circular ones over the true anomaly.
#[test]
fn eccentric_orbits_average_over_the_flux() {
    let mesh = bumpy(60);
    let surface = dusty(300.0);
    let (a, e) = (1.2, 0.4);
    let orbit = Orbit { semimajor_axis_au: a, eccentricity: e };
    let sampling = Sampling { declination_nodes: 13, ..at_rates(&[SIX_HOURS]) };
    let table = torque_table_of_facets(&mesh, &surface, &orbit, &sampling).unwrap();
    let n = 24;
    let mut sums = [[0.0; 37]; 2];
    for k in 0..n {
        let over = 1.0 + e * (TAU * (k as f64 + 0.5) / n as f64).cos();
        let here = Orbit { semimajor_axis_au: a * (1.0 - e * e) / over, eccentricity: 0.0 };
        let circular = torque_table_of_facets(&mesh, &surface, &here, &sampling).unwrap();
        let weight = orbit.mean_flux_w_m2() / here.mean_flux_w_m2() / n as f64;
        let [tilt, force] = &mut sums;
        let add = |sum: &mut [f64; 37], weight: f64, row: &[f64]| {
            sum.iter_mut().zip(row).for_each(|(s, r)| *s += weight * r);
        };
        add(tilt, weight, &circular.obliquity_torque_n_m[0]);
        add(force, weight * over / (1.0 - e * e).sqrt(), &circular.transverse_force_n[0]);
    }
    for (sum, row) in sums.iter().zip([&table.obliquity_torque_n_m[0], &table.transverse_force_n[0]]) {
        let off = common::distance(sum, row);
        assert!(off < 3e-4 * peak(row), "{off:e} of {:e}", peak(row));
    }
}

/// The default spin rates serve between their nodes, for dust and for rock.
#[test]
fn default_spin_rates_interpolate_within_half_a_per_cent() {
    let mesh = bumpy(100);
    for inertia in [50.0, 200.0, 2000.0] {
        let surface = dusty(inertia);
        let coarse = Sampling { declination_nodes: 13, ..Sampling::default() };
        let table = torque_table_of_facets(&mesh, &surface, &Orbit::default(), &coarse).unwrap();
        let curve = table.interpolant(Interpolation::Cubic).unwrap();
        let between: Vec<f64> = table.omega.windows(2).map(|w| (0.5 * (w[0].sqrt() + w[1].sqrt())).powi(2)).collect();
        let sampling = Sampling { spin_rates: SpinRates::ListRadS(between.clone()), ..coarse };
        let exact = torque_table_of_facets(&mesh, &surface, &Orbit::default(), &sampling).unwrap();
        let mut worst = 0.0f64;
        for (w, omega) in between.iter().enumerate() {
            for (o, obliquity) in table.obliquity.iter().enumerate() {
                worst = worst.max((curve.at(*obliquity, *omega).1 - exact.obliquity_torque_n_m[w][o]).abs());
            }
        }
        let scale = table.obliquity_torque_n_m.iter().map(|row| peak(row)).fold(0.0, f64::max);
        let part = table.error.parts.iter().find(|p| p.name == "spin_rate_interpolation").unwrap();
        println!("{inertia}: {:e}, estimate {:e}", worst / scale, part.obliquity_torque_n_m / scale);
        assert!(worst < 0.005 * scale, "{inertia}: {:e}", worst / scale);
    }
}

fn stones() -> Wall {
    Wall { coverage: 0.1, thickness_m: 0.005, conductivity_w_m_k: 0.5, thermal_inertia: 800.0 }
}

/// Stones on a sphere spin it up, whatever the rest of the torque; the more of them the more.
#[test]
fn stones_spin_a_sphere_up_at_every_obliquity() {
    let mesh = rings(12, 24, [100.0; 3], |_, _| 1.0);
    let with = |coverage| {
        let surface = Surface { tangential_yorp: Some(Wall { coverage, ..stones() }), ..lambert(0.1) };
        at(&mesh, &surface, &[0.0, SIX_HOURS])
    };
    let (some, more) = (with(0.1), with(0.2));
    for k in 0..37 {
        assert!(some.spin_torque_n_m[1][k] > 0.0);
        assert!((more.spin_torque_n_m[1][k] / some.spin_torque_n_m[1][k] - 2.0).abs() < 1e-6);
        assert!(some.spin_torque_n_m[0][k].abs() < 1e-9 * some.spin_torque_n_m[1][k]);
        assert_eq!(some.spin_torque_n_m[1][k], some.spin_torque_n_m[1][36 - k]);
    }
    // Less by a factor of about two at 90 deg (Golubov, Kravets, Krugly & Scheeres 2016, MNRAS 458, 3977).
    let ratio = some.spin_torque_n_m[1][18] / some.spin_torque_n_m[1][0];
    println!("ratio {ratio}");
    assert!((0.3..0.8).contains(&ratio), "{ratio}");
    assert!(some.transverse_force_n.is_empty());
}
