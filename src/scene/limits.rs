//! Which values a scene may hold: one table that validation, error messages and the JSON Schema share.
//!
//! A limit is where a value stops making sense (a restitution above 1) or where a run would no longer end or fit into
//! memory (a step of a microsecond, 10^9 spheres). Paths are those of the scene file.

use serde_json::Value;

use super::{Body, Contact, Grain, Question, Scene, about_density, shortest_period_h};

/// A value that a scene may not hold.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Violation {
    /// Path of the key.
    pub path: String,
    /// The value, as JSON.
    pub found: String,
    /// What would be allowed.
    pub allowed: String,
}

/// The allowed values of one number of the scene.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limit {
    /// Path of the key.
    pub path: &'static str,
    /// Smallest value; excluded if `above`.
    pub low: f64,
    /// Whether `low` itself is refused.
    pub above: bool,
    /// Largest value; excluded if `below`.
    pub high: f64,
    /// Whether `high` itself is refused.
    pub below: bool,
    /// What else there is to say, or empty.
    pub note: &'static str,
    /// Whether it may be null.
    pub optional: bool,
}

/// `low` to `high`, both allowed.
const fn closed(path: &'static str, low: f64, high: f64) -> Limit {
    Limit { path, low, above: false, high, below: false, note: "", optional: false }
}

/// Above `low`, at most `high`.
const fn above(path: &'static str, low: f64, high: f64) -> Limit {
    Limit { path, low, above: true, high, below: false, note: "", optional: false }
}

/// At least `low`, below `high`.
const fn below(path: &'static str, low: f64, high: f64) -> Limit {
    Limit { path, low, above: false, high, below: true, note: "", optional: false }
}

impl Limit {
    const fn note(mut self, note: &'static str) -> Self {
        self.note = note;
        self
    }

    const fn or_null(mut self) -> Self {
        self.optional = true;
        self
    }

    fn admits(&self, value: f64) -> bool {
        let low = if self.above { value > self.low } else { value >= self.low };
        let high = if self.below { value < self.high } else { value <= self.high };
        low && high
    }
}

impl std::fmt::Display for Limit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.low == self.high {
            write!(f, "only {}", self.low)?;
        } else {
            let low = if self.above { "above" } else { "at least" };
            let high = if self.below { "below" } else { "at most" };
            write!(f, "{low} {}, {high} {}", self.low, self.high)?;
        }
        if !self.note.is_empty() {
            write!(f, " ({})", self.note)?;
        }
        if self.optional { write!(f, ", or null") } else { Ok(()) }
    }
}

/// Every number of the scene that has limits of its own.
pub(super) const LIMITS: &[Limit] = &[
    closed("format", super::FORMAT as f64, super::FORMAT as f64),
    closed("body.packed_ellipsoid.spheres", 10.0, 1e6),
    above("body.packed_ellipsoid.radius_m", 0.0, 1e6),
    above("body.packed_ellipsoid.grain_density_kg_m3", 0.0, 1e5),
    closed("body.packed_ellipsoid.b_over_a", 0.1, 1.0),
    closed("body.packed_ellipsoid.c_over_a", 0.1, 1.0).note("and not above b_over_a"),
    above("body.carved_mesh.packing.random.radius_m", 0.0, 1e6),
    above("body.carved_mesh.packing.random.grain_density_kg_m3", 0.0, 1e5),
    above("body.carved_mesh.packing.hcp.radius_m", 0.0, 1e6),
    above("body.carved_mesh.packing.hcp.grain_density_kg_m3", 0.0, 1e5),
    closed("spin.period_h", 0.1, 1e5),
    closed("spin.obliquity_deg", 0.0, 180.0),
    closed("contact.hard_sphere.restitution_normal", 0.0, 1.0),
    closed("contact.hard_sphere.restitution_tangential", -1.0, 1.0),
    closed("contact.hard_sphere.slide_limit", 0.0, 1.0),
    closed("contact.hard_sphere.collapse_limit", 0.0, 0.1),
    closed("contact.hard_sphere.step_s", 0.01, 1000.0),
    closed("contact.hard_sphere.max_collisions_per_sphere", 1.0, 1e6),
    closed("contact.soft_sphere.restitution_normal", 0.0, 1.0).or_null(),
    closed("contact.soft_sphere.sliding_friction", 0.0, 100.0).or_null(),
    closed("contact.soft_sphere.rolling_friction", 0.0, 100.0).or_null(),
    closed("contact.soft_sphere.twisting_friction", 0.0, 100.0).or_null(),
    closed("contact.soft_sphere.restitution_tangential", 0.0, 1.0).or_null(),
    above("contact.soft_sphere.shape_parameter", 0.0, 1.0),
    closed("contact.soft_sphere.cohesion_pa", 0.0, 1e9),
    above("contact.soft_sphere.normal_stiffness_n_m", 0.0, 1e15).or_null(),
    above("contact.soft_sphere.expected_speed_m_s", 0.0, 1000.0).or_null(),
    closed("contact.soft_sphere.steps_per_contact", pkd::soft_sphere::FEWEST_STEPS_PER_CONTACT, 10_000.0),
    above("contact.soft_sphere.step_s", 0.0, 1000.0).or_null(),
    above("contact.soft_sphere.max_overlap_over_radius", 0.0, 0.5),
    closed("contact.soft_sphere.field_tolerance", 0.0, 0.1),
    closed("contact.soft_sphere.skin", 1e-4, 1.0),
    above("gravity.force_error", 0.0, 0.1),
    closed("settling.rotations", 1.0, 1000.0),
    closed("settling.max_rotations", 1.0, 10_000.0).note("and not below settling.rotations"),
    closed("settling.question.brief.rotations_per_load", 0.0, 1e6),
    closed("settling.question.brief.glance_rotations", 0.01, 100.0).note("and not above block_rotations"),
    closed("settling.question.brief.block_rotations", 0.05, 100.0),
    above("settling.question.brief.rest_fraction", 0.0, 1.0),
    closed("tiling.facets", 4.0, 200_000.0).note("and even, as every closed surface of triangles"),
    closed("tiling.exponent", 1.0, 10.0),
    closed("tiling.level", 0.1, 10.0),
    closed("orbit.semimajor_axis_au", 0.01, 1000.0),
    below("orbit.eccentricity", 0.0, 1.0),
    below("surface.reflectance.hapke.single_scattering_albedo", 0.0, 1.0),
    below("surface.reflectance.hapke.roughness_deg", 0.0, 60.0),
    Limit { above: true, ..below("surface.reflectance.hapke.asymmetry", -1.0, 1.0) },
    closed("surface.reflectance.lambert.bond_albedo", 0.0, 1.0),
    closed("surface.thermal_inertia", 0.0, 1e4),
    above("surface.emissivity", 0.0, 1.0),
    closed("surface.tangential_yorp.wall.coverage", 0.0, 1.0),
    closed("surface.tangential_yorp.wall.thickness_m", 1e-5, 100.0),
    closed("surface.tangential_yorp.wall.conductivity_w_m_k", 1e-4, 100.0),
    closed("surface.tangential_yorp.wall.thermal_inertia", 1.0, 1e4),
    closed("torque.obliquity_step_deg", 0.1, 90.0).note("and a divisor of 180"),
    closed("torque.azimuth_bins", 16.0, 2880.0).note("and a multiple of 8"),
    closed("torque.declination_nodes", 5.0, 1441.0).note("and odd"),
    closed("torque.facet_samples", 1.0, 256.0).note("and a square number"),
    closed("torque.rotation_cells", 16.0, 1024.0).note("and even"),
    closed("torque.spin_rates", 2.0, 100.0),
    closed("torque.shortest_period_h", 0.1, 1000.0),
    closed("evolution.duration_myr", 0.0, 1e4),
    closed("evolution.spin_change", 1e-5, 0.5),
    closed("evolution.rk4_step_yr", 1.0, 1e6),
    closed("evolution.movement_radius_fraction", 1e-3, 10.0),
    closed("evolution.rattle_radius_fraction", 0.0, 10.0),
    above("evolution.moved_fraction_limit", 0.0, 1.0),
    above("evolution.stop_period_h", 0.0, 1e6).note("and above spin.period_h").or_null(),
    above("shed.track.rebound.t_max_days", 0.0, 1e5),
    closed("shed.track.rebound.ias15_tolerance", 1e-16, 1e-3),
    closed("shed.track.rebound.multipole_error", 1e-15, 0.1),
    closed("shed.track.rebound.radiation_pressure", 0.0, 3.0),
];

/// Longest name of a scene, characters.
const MAX_NAME: usize = 200;

/// The limit of the number at `path`, if it has one.
pub(super) fn limit(path: &str) -> Option<&'static Limit> {
    LIMITS.iter().find(|limit| limit.path == path)
}

/// The first value of `scene` that is not allowed.
pub(super) fn first_violation(scene: &Scene) -> Option<Violation> {
    let tree = serde_json::to_value(scene).expect("a scene is plain data with string keys");
    LIMITS.iter().find_map(|limit| outside(&tree, limit)).or_else(|| inconsistent(scene)).or_else(|| too_fast(scene))
}

/// The value at the limit's path, if there is one and it is outside.
fn outside(tree: &Value, limit: &Limit) -> Option<Violation> {
    let value = limit.path.split('.').try_fold(tree, |node, key| node.get(key))?;
    let refused = match value.as_f64() {
        Some(number) => !limit.admits(number),
        // A NaN or infinity in a scene made by a program is null in JSON.
        None => !(limit.optional && value.is_null()),
    };
    refused.then(|| Violation { path: limit.path.to_owned(), found: value.to_string(), allowed: limit.to_string() })
}

/// Rules that one number alone cannot break.
fn inconsistent(scene: &Scene) -> Option<Violation> {
    let violation =
        |path: &str, found: String, allowed: String| Some(Violation { path: path.to_owned(), found, allowed });
    if scene.name.chars().count() > MAX_NAME || scene.name.chars().any(char::is_control) {
        let allowed = format!("at most {MAX_NAME} characters, none of them a control character");
        return violation("name", format!("{:?}", scene.name.chars().take(40).collect::<String>()), allowed);
    }
    match &scene.body {
        Body::PackedEllipsoid(body) if body.c_over_a > body.b_over_a => {
            let allowed = format!("at least 0.1, at most b_over_a = {}", body.b_over_a);
            return violation("body.packed_ellipsoid.c_over_a", body.c_over_a.to_string(), allowed);
        }
        Body::File(file) if file.path.is_empty() => return violation("body.file.path", "\"\"".into(), FILE.into()),
        Body::CarvedMesh(mesh) if mesh.path.is_empty() => {
            return violation("body.carved_mesh.path", "\"\"".into(), FILE.into());
        }
        _ => {}
    }
    if let Contact::SoftSphere(contact) = &scene.contact
        && let Some((key, found, allowed)) = contact.inconsistency()
    {
        let found = found.map_or("null".to_owned(), |value| value.to_string());
        return violation(&format!("contact.soft_sphere.{key}"), found, allowed);
    }
    let settling = &scene.settling;
    if settling.max_rotations < settling.rotations {
        let allowed = format!("at least settling.rotations = {}, at most 10000", settling.rotations);
        return violation("settling.max_rotations", settling.max_rotations.to_string(), allowed);
    }
    if let Question::Brief(brief) = settling.question
        && brief.glance_rotations > brief.block_rotations
    {
        let allowed = format!("at most settling.question.brief.block_rotations = {}", brief.block_rotations);
        return violation("settling.question.brief.glance_rotations", brief.glance_rotations.to_string(), allowed);
    }
    if !scene.tiling.facets.is_multiple_of(2) {
        let allowed = limit("tiling.facets").expect("listed above").to_string();
        return violation("tiling.facets", scene.tiling.facets.to_string(), allowed);
    }
    if scene.surface.sky_blockage_reflected && !scene.surface.sky_blockage {
        let allowed = "false, unless surface.sky_blockage is true".into();
        return violation("surface.sky_blockage_reflected", "true".into(), allowed);
    }
    let step = scene.torque.obliquity_step_deg;
    let nodes = (180.0 / step).round();
    // 180/0.7 rounds to 257 but 257 steps of 0.7 miss the pole; 1.8 or 0.1 are not exact in binary and must pass.
    if (nodes * step - 180.0).abs() > 1e-9 {
        let allowed = limit("torque.obliquity_step_deg").expect("listed above").to_string();
        return violation("torque.obliquity_step_deg", step.to_string(), allowed);
    }
    let torque = &scene.torque;
    for (path, value, fits) in [
        ("torque.azimuth_bins", torque.azimuth_bins, torque.azimuth_bins.is_multiple_of(8)),
        ("torque.declination_nodes", torque.declination_nodes, !torque.declination_nodes.is_multiple_of(2)),
        ("torque.facet_samples", torque.facet_samples, torque.facet_samples.isqrt().pow(2) == torque.facet_samples),
        ("torque.rotation_cells", torque.rotation_cells, torque.rotation_cells.is_multiple_of(2)),
    ] {
        if !fits {
            return violation(path, value.to_string(), limit(path).expect("listed above").to_string());
        }
    }
    match scene.evolution.stop_period_h {
        Some(stop) if stop.is_nan() || stop <= scene.spin.period_h => {
            let allowed = format!("above spin.period_h = {}, at most 1e6, or null", scene.spin.period_h);
            violation("evolution.stop_period_h", stop.to_string(), allowed)
        }
        _ => None,
    }
}

/// A spin at which no body of these spheres can hold together by its gravity, whatever its shape: that of a sphere without
/// voids. Where something else holds it together there is no such limit.
fn too_fast(scene: &Scene) -> Option<Violation> {
    let Grain { density_kg_m3, density_key } = scene.body.grain()?;
    let limit_h = shortest_period_h(density_kg_m3);
    (scene.spin.period_h < limit_h && !scene.is_cohesive()).then(|| Violation {
        path: "spin.period_h".to_owned(),
        found: scene.spin.period_h.to_string(),
        allowed: format!(
            "at least {limit_h:.3}, below which a sphere of {density_key} = {density_kg_m3}{} flies apart",
            about_density(density_kg_m3)
        ),
    })
}

/// What a path in a scene has to name.
const FILE: &str = "the path of a file, relative to the folder of the scene";
