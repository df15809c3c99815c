//! What a scene will run: which physics is on, with which method, and what is left out and why.
//!
//! Derived once, from the scene alone. What is left out costs neither time nor memory: the kernels are specialised for
//! it, so the plan is also a promise about them.

use serde::Serialize;

use pkd::soft_sphere::Friction;

use super::{
    Body, CYCLE_END_PERIOD_H, Contact, FrictionModel, GravityMethod, HardSphereContact, Interpolation, MovementRule,
    Packing, Question, Reflectance, Scene, SelfHeating, SettlingCost, SoftSphereContact, TangentialYorp, Track,
    oddities,
};

/// What a scene will run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Plan {
    /// Name of the scene.
    pub name: String,
    /// Every part of the physics, in the order in which a run meets it.
    pub parts: Vec<Part>,
    /// What is odd about the scene, a sentence each.
    pub warnings: Vec<String>,
}

/// One part of the physics.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Part {
    /// What it is.
    pub name: &'static str,
    /// Whether it is computed.
    pub on: bool,
    /// How it is computed; `None` if it is left out.
    pub method: Option<String>,
    /// Why so.
    pub reason: String,
}

fn on(name: &'static str, method: impl Into<String>, reason: impl Into<String>) -> Part {
    Part { name, on: true, method: Some(method.into()), reason: reason.into() }
}

fn off(name: &'static str, reason: impl Into<String>) -> Part {
    Part { name, on: false, method: None, reason: reason.into() }
}

fn gravity(scene: &Scene) -> Part {
    let error = scene.gravity.force_error;
    let tree = format!("tree with expansions, force error {error:e}");
    match (scene.gravity.method, &scene.body) {
        (GravityMethod::Direct, _) => on("gravity", "direct sum over pairs", "gravity.method"),
        (GravityMethod::Tree, _) => on("gravity", tree, "gravity.method"),
        (GravityMethod::Auto, Body::PackedEllipsoid(packed))
            if scene.gravity.to_pkd().is_direct(packed.spheres as usize) =>
        {
            on(
                "gravity",
                "direct sum over pairs",
                "exact to round-off and fast at these numbers of spheres; gravity.force_error is not needed",
            )
        }
        (GravityMethod::Auto, Body::PackedEllipsoid(_)) => {
            on("gravity", tree, "faster than the direct sum at these numbers of spheres")
        }
        (GravityMethod::Auto, _) => {
            on("gravity", format!("direct sum over pairs, or for large bodies {tree}"), "the faster one")
        }
    }
}

impl Plan {
    /// The plan of `scene`.
    pub fn of(scene: &Scene) -> Self {
        let mut parts = vec![body(&scene.body)];
        parts.push(gravity(scene));
        match &scene.contact {
            Contact::HardSphere(contact) => hard_spheres(contact, &mut parts),
            Contact::SoftSphere(contact) => soft_spheres(contact, &mut parts),
        }
        parts.push(on(
            "settling",
            format!("blocks of {} rotations, at most {}", scene.settling.rotations, scene.settling.max_rotations),
            match SettlingCost::of_scene(scene) {
                Some(cost) => cost.to_string(),
                None => "a body that still shifts has no torque of its own".to_owned(),
            },
        ));
        parts.push(match scene.settling.question {
            Question::Full => on("question", "whole blocks after each change of spin", "as the paper asks"),
            Question::Brief(brief) => on(
                "question",
                format!(
                    "looks of {} rotations a unit of load, {} to {}; blocks of {} after a movement",
                    brief.rotations_per_load, brief.glance_rotations, brief.block_rotations, brief.block_rotations
                ),
                format!(
                    "blocks follow if a sphere shifts by {} of its radius",
                    brief.rest_fraction * scene.evolution.movement_radius_fraction
                ),
            ),
        });
        parts.push(on(
            "tiling",
            format!("{} facets on {} vertices", scene.tiling.facets, scene.tiling.vertices()),
            format!("exponent {}, level {}", scene.tiling.exponent, scene.tiling.level),
        ));
        radiation(scene, &mut parts);
        evolution(scene, &mut parts);
        let cost = SettlingCost::of_scene(scene).and_then(|cost| cost.warning());
        let warnings = oddities(scene).into_iter().chain(cost).collect();
        Self { name: scene.name.clone(), parts, warnings }
    }
}

fn body(body: &Body) -> Part {
    match body {
        Body::PackedEllipsoid(packing) => on(
            "body",
            format!("random packing of {} spheres of {} m", packing.spheres, packing.radius_m),
            format!("ellipsoid, b/a = {}, c/a = {}", packing.b_over_a, packing.c_over_a),
        ),
        Body::File(file) => on("body", format!("the spheres in {}", file.path), "taken as they are"),
        Body::CarvedMesh(mesh) => {
            let arrangement = match mesh.packing {
                Packing::Random(_) => "random",
                Packing::Hcp(_) => "hexagonal close",
            };
            let radius = mesh.packing.spheres().radius_m;
            on("body", format!("{arrangement} packing of spheres of {radius} m"), format!("carved by {}", mesh.path))
        }
    }
}

fn hard_spheres(contact: &HardSphereContact, parts: &mut Vec<Part>) {
    parts.push(on(
        "contacts",
        format!("hard spheres, events within steps of {} s", contact.step_s),
        "contact.hard_sphere",
    ));
    parts.push(if contact.restitution_tangential == 1.0 {
        off("sphere spins", "restitution_tangential = 1: without friction nothing changes them")
    } else {
        on("sphere spins", "carried through every impact", "restitution_tangential is not 1")
    });
    parts.push(if contact.slide_limit == 0.0 {
        off("slide limit", "slide_limit = 0")
    } else {
        on("slide limit", format!("below {} of the escape speed", contact.slide_limit), "lets slow contacts slide")
    });
    parts.push(if contact.collapse_limit == 0.0 {
        off("collapse limit", "collapse_limit = 0; max_collisions_per_sphere still ends bouncing")
    } else {
        on(
            "collapse limit",
            format!("below {} of the radius", contact.collapse_limit),
            "ends bouncing that would never end",
        )
    });
}

fn soft_spheres(contact: &SoftSphereContact, parts: &mut Vec<Part>) {
    let model = contact.friction();
    let key = "contact.soft_sphere.friction_model";
    let without = format!("friction_model is {}", model.name());
    parts.push(if contact.field_tolerance > 0.0 {
        on(
            "gravity between steps",
            format!("turns with the body until a sphere has moved by {} of its radius", contact.field_tolerance),
            "contact.soft_sphere.field_tolerance",
        )
    } else {
        off("gravity between steps", "field_tolerance = 0: gravity is evaluated in every step")
    });
    let steps = match contact.step_s {
        Some(step) => format!("steps of {step} s"),
        None => format!("{} steps in the quickest contact", contact.steps_per_contact),
    };
    parts.push(on("contacts", format!("soft spheres, {steps}"), format!("preset {}", contact.preset.name())));
    parts.push(match contact.normal_stiffness_n_m {
        Some(stiffness) => on("stiffness", format!("{stiffness} N/m"), "contact.soft_sphere.normal_stiffness_n_m"),
        None => on("stiffness", "from the body, once", "overlaps of at most 1 % in impacts, under weight and cohesion"),
    });
    let contacts = contact.to_pkd(&Default::default());
    if let Some(sliding) = contacts.friction.sliding() {
        parts.push(on("sphere spins", "carried through every contact", key));
        parts.push(on("sliding friction", format!("spring, dashpot, slider, mu_S = {}", sliding.coefficient), key));
    } else {
        parts.push(off("sphere spins", "without friction nothing changes them"));
        parts.push(off("sliding friction", without.clone()));
    }
    parts.push(match contacts.friction {
        Friction::RollingAndTwisting { rolling, twisting, .. } => on(
            "rolling and twisting friction",
            format!("springs, dashpots, sliders, mu_R = {rolling}, mu_T = {twisting}"),
            key,
        ),
        Friction::Directional { rolling, twisting, .. } => on(
            "rolling and twisting friction",
            format!("torques of constant size, mu_R = {rolling}, mu_T = {twisting}"),
            key,
        ),
        Friction::None | Friction::Sliding(_) => off("rolling and twisting friction", without.clone()),
    });
    parts.push(if model == FrictionModel::None {
        off("contact history", without)
    } else {
        on("contact history", "springs of every contact, stored with the spheres", "friction remembers")
    });
    parts.push(if contact.cohesion_pa > 0.0 {
        on("cohesion", format!("{} Pa between spheres", contact.cohesion_pa), "contact.soft_sphere.cohesion_pa")
    } else {
        off("cohesion", "cohesion_pa = 0")
    });
}

/// What sunlight does.
fn radiation(scene: &Scene, parts: &mut Vec<Part>) {
    let surface = &scene.surface;
    parts.push(match &surface.reflectance {
        Reflectance::None => off("reflected light", "reflectance is none: the surface is black"),
        Reflectance::Hapke(hapke) if hapke.single_scattering_albedo == 0.0 => {
            off("reflected light", "single_scattering_albedo = 0: the surface is black")
        }
        Reflectance::Lambert(lambert) if lambert.bond_albedo == 0.0 => {
            off("reflected light", "bond_albedo = 0: the surface is black")
        }
        Reflectance::Hapke(_) => {
            on("reflected light", "Hapke, from tables in the incidence angle", "the recoil depends on that angle alone")
        }
        Reflectance::Lambert(_) => on("reflected light", "Lambert, in closed form", "surface.reflectance"),
    });
    let stores_heat = surface.thermal_inertia > 0.0;
    parts.push(if stores_heat {
        on("thermal recoil", "Lambertian emission by the temperature of the ground", "surface.thermal_inertia is not 0")
    } else {
        on("thermal recoil", "Lambertian emission where and when light is absorbed", "zero thermal inertia")
    });
    let seen_from = match scene.torque.facet_samples {
        1 => "every facet's centroid".to_owned(),
        samples => format!("{samples} points of every facet that sees others"),
    };
    parts.push(if surface.shadows {
        on("shadows", format!("horizon map of {seen_from}"), "skipped at run time while the surface is convex")
    } else {
        off("shadows", "surface.shadows is false")
    });
    parts.push(match (surface.self_heating, surface.sky_blockage) {
        (SelfHeating::None, false) => off("sky blockage", "surface.sky_blockage is false"),
        (SelfHeating::None, true) => on(
            "sky blockage",
            if surface.sky_blockage_reflected {
                "integrals over the same horizon map, for emitted and reflected light"
            } else {
                "integrals over the same horizon map, for emitted light"
            },
            "skipped at run time while the surface is convex",
        ),
        _ => off("sky blockage", "self-heating follows the light that meets the body, so nothing is lost"),
    });
    parts.push(match surface.self_heating {
        SelfHeating::None => off("self-heating", "surface.self_heating is none"),
        SelfHeating::Single => {
            on("self-heating", "light followed to the first facet that it meets", "view factors from the horizon map")
        }
        SelfHeating::Multiple => {
            on("self-heating", "light followed until it leaves the body", "view factors from the horizon map")
        }
    });
    heat(scene, parts);
}

/// What the ground and its stones do with the heat.
fn heat(scene: &Scene, parts: &mut Vec<Part>) {
    let (surface, torque) = (&scene.surface, &scene.torque);
    let stores_heat = surface.thermal_inertia > 0.0;
    let walls = matches!(surface.tangential_yorp, TangentialYorp::Wall(_));
    parts.push(if stores_heat {
        on(
            "heat conduction",
            format!("half-space of Gamma = {}, {} cells a rotation", surface.thermal_inertia, torque.rotation_cells),
            "surface.thermal_inertia is not 0",
        )
    } else {
        off("heat conduction", "thermal_inertia = 0: emissivity cancels")
    });
    parts.push(match &surface.tangential_yorp {
        TangentialYorp::None => off("tangential YORP", "surface.tangential_yorp is none"),
        TangentialYorp::Wall(wall) => on(
            "tangential YORP",
            format!("walls {} m thick, on {} of the ground", wall.thickness_m, wall.coverage),
            "surface.tangential_yorp",
        ),
    });
    parts.push(if stores_heat || walls {
        on(
            "torque over spin rates",
            format!("{} spin rates from 0 to a period of {} h", torque.spin_rates, torque.shortest_period_h),
            "stored heat makes torques depend on the spin rate; beyond the last one they are taken as constant",
        )
    } else {
        off("torque over spin rates", "without stored heat one table serves all spin rates")
    });
    parts.push(off(
        "seasonal heat",
        match taco::seasonal_heat(&surface.to_taco(), &scene.orbit.to_taco()) {
            Some(warning) => warning.to_string(),
            None if stores_heat => "what the ground stores over seasons is too little to matter".to_owned(),
            None => "thermal_inertia = 0".to_owned(),
        },
    ));
    parts.push(match (scene.orbit.eccentricity > 0.0, stores_heat || walls) {
        (false, _) => off("orbital anomaly", "the orbit is a circle"),
        (true, false) => {
            off("orbital anomaly", "without heat storage an eccentric orbit only scales the torques by 1/sqrt(1 - e^2)")
        }
        (true, true) => {
            on("orbital anomaly", "heat at several distances from the Sun", "temperatures do not scale with the flux")
        }
    });
}

/// How spin and shape go on from there.
fn evolution(scene: &Scene, parts: &mut Vec<Part>) {
    let evolution = &scene.evolution;
    let interpolation = match scene.torque.interpolation {
        Interpolation::Cubic => "cubic",
        Interpolation::Linear => "linear",
    };
    parts.push(on(
        "spin evolution",
        format!("fourth-order Runge-Kutta, steps of {} yr, to {} Myr", evolution.rk4_step_yr, evolution.duration_myr),
        format!("{interpolation} in obliquity, nodes every {} deg", scene.torque.obliquity_step_deg),
    ));
    let rule = match evolution.movement_rule {
        MovementRule::Robust => "robust",
        MovementRule::Literal => "literal",
    };
    parts.push(on(
        "movement detection",
        format!("rigid fit with {rule} exclusion at {} of the radius", evolution.movement_radius_fraction),
        format!(
            "after every change of the spin rate by {}; the surface follows shifts beyond {} of the radius",
            evolution.spin_change, evolution.rattle_radius_fraction
        ),
    ));
    parts.push(match evolution.stop_period_h {
        Some(period) if period <= CYCLE_END_PERIOD_H => {
            on("stop when spun down", format!("beyond {period} h"), "evolution.stop_period_h")
        }
        _ => on(
            "stop when spun down",
            format!("beyond {CYCLE_END_PERIOD_H} h, whatever evolution.stop_period_h says"),
            "slower bodies tumble and meet resonances that are not computed",
        ),
    });
    parts.push(match &scene.shed.track {
        Track::None => {
            off("orbits of shed spheres", "shed.track is none: they are removed and recorded, REBOUND is never started")
        }
        Track::Rebound(rebound) => on(
            "orbits of shed spheres",
            format!("IAS15 of REBOUND around the body's spheres, for {} d at most", rebound.t_max_days),
            "shed.track.rebound; not started before something is shed",
        ),
    });
    if let Track::Rebound(rebound) = &scene.shed.track {
        let (tide, pressure) = (rebound.solar_tide, rebound.radiation_pressure > 0.0);
        parts.push(match (tide, pressure) {
            (false, false) => off("Sun on shed spheres", "solar_tide is false and radiation_pressure 0"),
            (true, false) => on("Sun on shed spheres", "tide", "shed.track.rebound.solar_tide"),
            (false, true) => on("Sun on shed spheres", "radiation pressure", "shed.track.rebound.radiation_pressure"),
            (true, true) => on("Sun on shed spheres", "tide and radiation pressure", "shed.track.rebound"),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{FileBody, HapkeReflectance, SoftSpherePreset};

    fn part(scene: &Scene, name: &str) -> Part {
        Plan::of(scene).parts.into_iter().find(|part| part.name == name).unwrap()
    }

    #[test]
    fn frictionless_spheres_carry_no_spin() {
        let mut scene = Scene::from_body(Body::File(FileBody { path: "a.csv".into() }));
        assert!(part(&scene, "sphere spins").on);
        scene.contact =
            Contact::HardSphere(HardSphereContact { restitution_tangential: 1.0, ..HardSphereContact::default() });
        assert!(!part(&scene, "sphere spins").on);
    }

    #[test]
    fn soft_spheres_leave_out_what_their_contacts_do_not_have() {
        let mut scene = Scene::from_body(Body::File(FileBody { path: "a.csv".into() }));
        let soft = |preset, cohesion_pa, field_tolerance| {
            let other = SoftSphereContact::default();
            Contact::SoftSphere(SoftSphereContact { preset, cohesion_pa, field_tolerance, ..other })
        };
        let names = [
            "sphere spins",
            "sliding friction",
            "rolling and twisting friction",
            "contact history",
            "cohesion",
            "gravity between steps",
        ];
        scene.contact = soft(SoftSpherePreset::Frictionless, 0.0, 0.0);
        assert!(names.iter().all(|name| !part(&scene, name).on));
        scene.contact = soft(SoftSpherePreset::Gravel, 100.0, 0.01);
        assert!(names.iter().all(|name| part(&scene, name).on));
        assert!(Plan::of(&scene).parts.iter().all(|part| part.name != "slide limit"));
    }

    #[test]
    fn a_black_surface_reflects_nothing() {
        let mut scene = Scene::from_body(Body::File(FileBody { path: "a.csv".into() }));
        assert!(part(&scene, "reflected light").on);
        let black = HapkeReflectance { single_scattering_albedo: 0.0, ..HapkeReflectance::default() };
        scene.surface.reflectance = Reflectance::Hapke(black);
        assert!(!part(&scene, "reflected light").on);
    }

    #[test]
    fn stored_heat_brings_its_parts_and_says_what_it_leaves_out() {
        let mut scene = Scene::from_body(Body::File(FileBody { path: "a.csv".into() }));
        for name in ["heat conduction", "torque over spin rates", "self-heating", "tangential YORP", "seasonal heat"] {
            assert!(!part(&scene, name).on, "{name}");
        }
        scene.surface.thermal_inertia = 2000.0;
        scene.orbit.eccentricity = 0.1;
        for name in ["heat conduction", "torque over spin rates", "orbital anomaly"] {
            assert!(part(&scene, name).on, "{name}");
        }
        scene.orbit.semimajor_axis_au = 3.0;
        assert!(part(&scene, "seasonal heat").reason.contains("seasonal thermal parameter"));
        scene.surface.self_heating = SelfHeating::Multiple;
        assert!(part(&scene, "self-heating").on && !part(&scene, "sky blockage").on);
    }
}
