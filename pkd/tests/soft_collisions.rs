//! Two soft spheres against closed forms: restitution, duration, sticking, slipping, rolling, cohesion and the books of energy.

use std::f64::consts::PI;

use nalgebra::Vector3;
use pkd::Spheres;
use pkd::soft_sphere::{
    Friction, Gravity, Report, Sliding, SlidingCap, SoftSphere, SoftSphereParameters, TangentialDamping,
};

const STIFFNESS: f64 = 1e6;

/// Two equal spheres of 1 m and 1000 kg that just do not touch, the first at rest.
fn pair(velocity: [f64; 3]) -> Spheres {
    let mut pair = Spheres::default();
    pair.push([0.0; 3], [0.0; 3], [0.0; 3], 1000.0, 1.0);
    pair.push([2.0 + 1e-9, 0.0, 0.0], velocity, [0.0; 3], 1000.0, 1.0);
    pair
}

fn parameters(restitution: f64, friction: Friction, steps_per_contact: f64) -> SoftSphereParameters {
    SoftSphereParameters {
        restitution,
        friction,
        normal_stiffness_n_m: Some(STIFFNESS),
        steps_per_contact,
        gravity: Gravity::Off,
        ..SoftSphereParameters::default()
    }
}

/// Duration of a contact without damping, s.
fn contact_time() -> f64 {
    PI * (500.0 / STIFFNESS).sqrt()
}

fn collide(parameters: SoftSphereParameters, spheres: &mut Spheres) -> Report {
    SoftSphere::new(parameters).evolve(spheres, 2.0 * contact_time()).unwrap()
}

/// Velocity of the second surface relative to the first at the point of contact.
fn sliding(pair: &Spheres) -> Vector3<f64> {
    let [r, v, w] =
        [Spheres::position, Spheres::velocity, Spheres::spin].map(|of| [0, 1].map(|i| Vector3::from(of(pair, i))));
    let n = (r[1] - r[0]).normalize();
    let u = v[1] - v[0] - (w[0] + w[1]).cross(&n);
    u - n * n.dot(&u)
}

/// Restitution of a head-on collision with a number of steps in the contact, averaged over where in a step it begins.
fn measured_restitution(nominal: f64, steps_per_contact: f64) -> f64 {
    let phases = 16;
    let step = contact_time() / steps_per_contact;
    let mut sum = 0.0;
    for phase in 0..phases {
        let mut spheres = pair([-0.01, 0.0, 0.0]);
        spheres.x[1] += 0.01 * step * f64::from(phase) / f64::from(phases);
        collide(parameters(nominal, Friction::None, steps_per_contact), &mut spheres);
        sum += (spheres.vx[1] - spheres.vx[0]) / 0.01;
    }
    sum / f64::from(phases)
}

/// Schwartz et al. 2012, eq. 15. A hundred steps are as good as exact; few are off by what the prediction of velocities
/// is known to give.
#[test]
fn head_on_collisions_have_the_restitution_asked_for() {
    for nominal in [0.2, 0.5, 0.55, 0.95] {
        let (coarse, fine) = (measured_restitution(nominal, 50.0), measured_restitution(nominal, 400.0));
        assert!((coarse - nominal).abs() < 0.001, "{nominal}: {coarse}");
        assert!((fine - nominal).abs() < 1e-4, "{nominal}: {fine}");
    }
    for (nominal, steps, expected) in [
        (0.55, 10.0, 0.53200),
        (0.55, 20.0, 0.54486),
        (0.55, 30.0, 0.54765),
        (0.55, 50.0, 0.54932),
        (0.2, 10.0, 0.18450),
        (0.2, 30.0, 0.19845),
    ] {
        let got = measured_restitution(nominal, steps);
        assert!((got - nominal).abs() < (nominal - expected) * 1.1, "{nominal}, {steps} steps: {got}");
    }
}

/// Contact time pi / (w0 sqrt(1 - xi²)).
#[test]
fn contacts_last_as_long_as_the_damped_oscillation() {
    for (nominal, time) in [(0.2, 3.52986), (0.5, 3.21715), (0.55, 3.19797), (0.95, 3.14201)] {
        let time = time * (500.0 / STIFFNESS).sqrt();
        for (fraction, contacts) in [(0.995, 1), (1.005, 0)] {
            let mut spheres = pair([-0.01, 0.0, 0.0]);
            let report = SoftSphere::new(parameters(nominal, Friction::None, 1000.0))
                .evolve(&mut spheres, time * fraction)
                .unwrap();
            assert_eq!(report.contacts, contacts, "{nominal} {fraction}");
        }
    }
}

/// A contact that sticks turns the tangential motion round. With pkdgrav's dashpot the factor is
/// e^(-alpha t) (cos w t - alpha/w sin w t) at the end of the contact (Schwartz et al. 2012, section 2.6), with the exact one
/// it is minus the nominal value.
#[test]
fn sticking_contacts_reverse_tangential_motion_by_the_tangential_restitution() {
    let ratio = |restitution, damping| {
        let friction = Friction::Sliding(Sliding { coefficient: 1e3, restitution, damping, cap: SlidingCap::Rescale });
        let mut spheres = pair([-0.01, 1e-4, 2e-4]);
        let before = sliding(&spheres);
        collide(parameters(0.95, friction, 1000.0), &mut spheres);
        let after = sliding(&spheres);
        assert!(after.cross(&before).norm() < 2e-3 * after.norm() * before.norm());
        after.dot(&before) / before.norm_squared()
    };
    let dashpot = |restitution: f64| -2.0 * restitution.ln() / (PI * PI + restitution.ln().powi(2)).sqrt();
    for nominal in [0.5, 0.55, 0.95] {
        // In units of the frequency of both springs.
        let alpha = 0.5 * 3.5_f64.sqrt() * dashpot(nominal);
        let (w, time) = ((1.0 - alpha * alpha).sqrt(), PI / (1.0 - (0.5 * dashpot(0.95)).powi(2)).sqrt());
        let expected = (-alpha * time).exp() * ((w * time).cos() - alpha / w * (w * time).sin());
        let got = ratio(nominal, TangentialDamping::Pkdgrav);
        assert!((got - expected).abs() < 0.002, "{nominal}: {got} {expected}");
        let got = ratio(nominal, TangentialDamping::Exact);
        assert!((got + nominal).abs() < 0.002, "{nominal}: {got}");
    }
}

/// Gross sliding: the tangential impulse is mu times the normal one, whatever the rule for slipping springs.
#[test]
fn fast_oblique_impacts_slip_with_the_friction_coefficient() {
    for cap in [SlidingCap::Smaller, SlidingCap::Drop, SlidingCap::Rescale] {
        let friction = Friction::Sliding(Sliding { coefficient: 0.1, cap, ..Sliding::default() });
        let mut spheres = pair([-0.01, 0.02, 0.0]);
        collide(parameters(0.9, friction, 400.0), &mut spheres);
        let (normal, tangential) = (spheres.vx[1] + 0.01, 0.02 - spheres.vy[1]);
        assert!((tangential / normal - 0.1).abs() < 0.003, "{cap:?}: {}", tangential / normal);
        // The impulse acts on both surfaces alike.
        let w = spheres.wz[0];
        assert!((w - spheres.wz[1]).abs() < 1e-12 && (w - 2.5 * tangential).abs() < 0.01 * w.abs(), "{w} {tangential}");
    }
}

/// Counter-rotating spheres held together by cohesion: springs against rolling swing back, constant torques only brake.
#[test]
fn rolling_friction_stops_counter_rotation() {
    let spinning = |friction| {
        let mut spheres = pair([0.0; 3]);
        (spheres.wz[0], spheres.wz[1]) = (1e-3, -1e-3);
        spheres.x[1] = 2.0 - 1e-3;
        let cohesion_pa = 4e3;
        let mut soft = SoftSphere::new(SoftSphereParameters { cohesion_pa, ..parameters(0.1, friction, 50.0) });
        let mut lowest = f64::INFINITY;
        for _ in 0..100 {
            soft.evolve(&mut spheres, contact_time()).unwrap();
            lowest = lowest.min(spheres.wz[0]);
        }
        // Gears do not slide on each other, and stay where they are.
        assert!(sliding(&spheres).norm() < 1e-6 && spheres.y[1].abs() < 1e-6);
        (lowest, spheres.wz[0])
    };
    let sliding = Sliding::default();
    let (_, unhindered) = spinning(Friction::Sliding(sliding));
    assert!((unhindered - 1e-3).abs() < 1e-6, "{unhindered}");
    let (lowest, last) = spinning(Friction::RollingAndTwisting { sliding, rolling: 1.05, twisting: 1.3 });
    assert!(lowest < -1e-5 && last.abs() < 1e-6, "{lowest} {last}");
    let (lowest, last) = spinning(Friction::Directional { sliding, rolling: 0.5, twisting: 0.1 });
    assert!(lowest > -1e-9 && last.abs() < 1e-6, "{lowest} {last}");
}

/// c times 4 (beta R_eff)²: 100 Pa and R_eff = 0.5 m give 25 N, which the spring balances at 25 µm.
#[test]
fn cohesion_presses_spheres_together() {
    for friction in [Friction::None, SoftSphereParameters::default().friction] {
        let mut spheres = pair([0.0; 3]);
        spheres.x[1] = 2.0 - 1e-5;
        let parameters = SoftSphereParameters { cohesion_pa: 100.0, ..parameters(0.2, friction, 50.0) };
        SoftSphere::new(parameters).evolve(&mut spheres, 50.0 * contact_time()).unwrap();
        let overlap = 2.0 - (spheres.x[1] - spheres.x[0]);
        assert!((overlap / 25e-6 - 1.0).abs() < 1e-6, "{overlap}");
    }
}

/// Energy lost to dashpots and sliders adds up, in every model; and without them nothing is lost but O(h²).
#[test]
fn books_of_energy_close() {
    let sliding = Sliding { coefficient: 0.3, ..Sliding::default() };
    let frictions = [
        Friction::None,
        Friction::Sliding(sliding),
        Friction::RollingAndTwisting { sliding, rolling: 0.05, twisting: 0.1 },
        Friction::Directional { sliding, rolling: 0.05, twisting: 0.1 },
    ];
    for friction in frictions {
        for (speed, cohesion_pa) in [(0.001, 0.0), (0.005, 0.0), (0.05, 0.0), (0.005, 50.0)] {
            let mut spheres = pair([-0.01, speed, 0.0]);
            (spheres.wx[0], spheres.wz[1]) = (speed, 0.5 * speed);
            let parameters = SoftSphereParameters { ledger: true, cohesion_pa, ..parameters(0.55, friction, 50.0) };
            let report = collide(parameters, &mut spheres);
            let ledger = report.ledger.unwrap();
            let initial = ledger.start.kinetic_j;
            assert!(ledger.residual_j().abs() < 0.01 * initial, "{friction:?} {speed} {ledger:?}");
            assert!(ledger.dissipated_j() > 0.0 && report.energy_drift().unwrap().abs() < 0.01);
        }
    }
    let loss = |steps| {
        let mut spheres = pair([-0.01, 0.0, 0.0]);
        let parameters = SoftSphereParameters { ledger: true, ..parameters(1.0, Friction::None, steps) };
        SoftSphere::new(parameters).evolve(&mut spheres, 0.5 * contact_time()).unwrap().ledger.unwrap().residual_j()
    };
    let (coarse, fine) = (loss(50.0), loss(200.0));
    assert!(coarse.abs() < 1e-3 * 0.05 && (coarse / fine).abs() > 10.0, "{coarse} {fine}");
}

/// Random heaps of overlapping spheres of all sizes: forces and torques are opposite in pairs.
#[test]
fn momentum_and_angular_momentum_are_conserved_to_round_off() {
    let sliding = Sliding::default();
    for friction in [
        Friction::None,
        Friction::Sliding(sliding),
        Friction::RollingAndTwisting { sliding, rolling: 1.05, twisting: 1.3 },
        Friction::Directional { sliding, rolling: 1.0, twisting: 0.5 },
    ] {
        let mut heap = Spheres::default();
        for i in 0..40 {
            let t = f64::from(i);
            let r = [2.0 * (1.3 * t).sin(), 2.0 * (0.7 * t + 0.4).cos(), 2.0 * (2.9 * t).sin()];
            let v = [(3.1 * t).cos() * 0.1, (1.7 * t).sin() * 0.1, (0.3 * t).cos() * 0.1];
            let w = [(0.9 * t).sin() * 0.1, (2.3 * t).cos() * 0.1, (5.1 * t).sin() * 0.1];
            let radius = 0.6 + 0.4 * (4.3 * t).sin();
            heap.push(r, v, w, 1000.0 * radius.powi(3), radius);
        }
        let parameters =
            SoftSphereParameters { max_overlap: 0.5, cohesion_pa: 10.0, ..parameters(0.5, friction, 50.0) };
        // The depth of random overlaps is beyond any limit: drop the spheres that are inside others.
        let mut keep = vec![true; heap.len()];
        for j in 0..heap.len() {
            for i in 0..j {
                let d = (Vector3::from(heap.position(i)) - Vector3::from(heap.position(j))).norm();
                let depth = (heap.radius[i] + heap.radius[j] - d) / heap.radius[i].min(heap.radius[j]);
                keep[j] &= !keep[i] || depth < 0.4;
            }
        }
        let mut heap = heap.filtered(&keep);
        let mut soft = SoftSphere::new(parameters);
        let step = soft.stiffness(&heap).unwrap().step_s;
        let report = soft.evolve(&mut heap, 3.0 * step).unwrap();
        assert!(report.contacts > 5, "{report:?}");
        assert!(report.momentum_drift < 1e-14 && report.angular_momentum_drift < 1e-14, "{friction:?} {report:?}");
    }
}
