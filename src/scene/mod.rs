//! What the user asked for: one JSON file, typed, validated and documented, from which a plan is derived once.
//!
//! Every key has a default from Cotto-Figueroa et al. (2015, ApJ 803, 25), except the body. Keys that are not SI carry
//! their unit. Enumerations are externally tagged (`{"hard_sphere": {...}}`, a variant without fields is a string),
//! because only then do the parser's errors keep their line and path.

mod body;
mod convert;
mod cost;
mod difference;
mod dynamics;
mod error;
mod evolution;
mod limits;
mod oddities;
mod plan;
mod position;
mod radiation;
mod read;
mod schema;
mod soft_sphere;
mod structure;

use serde::{Deserialize, Serialize};

pub use body::{Body, CarvedMesh, FileBody, FillingSpheres, Grain, LengthUnit, PackedEllipsoid, Packing};
pub use cost::{SettlingCost, touching_pair};
pub use difference::{Difference, first_difference};
pub use dynamics::{
    BriefQuestion, Contact, GravityMethod, GravityOptions, HardSphereContact, Question, Rebound, ResidualRotation,
    Settling, Shed, SlideVelocity, Spin, Track,
};
pub use error::{Location, SceneError};
pub use evolution::{CYCLE_END_PERIOD_H, Evolution, MovementRule, TilingOptions};
pub use oddities::{USUAL_DENSITIES, about_density, oddities, shortest_period_h};
pub use plan::{Part, Plan};
pub use radiation::{
    HapkeReflectance, Interpolation, LambertReflectance, MultipleScattering, Orbit, Reflectance, SelfHeating, Surface,
    TangentialYorp, TorqueOptions, Wall,
};
pub use read::{MAX_SCENE_BYTES, SceneFile};
pub use schema::json_schema;
pub use soft_sphere::{FrictionModel, SlidingCap, SoftSphereContact, SoftSpherePreset, TangentialDamping};

/// The version of the scene format that this build reads.
pub const FORMAT: u32 = 1;

/// A complete scene: the body, its spin and the physics it meets.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// The schema that an editor checks this file against; says nothing about the scene.
    #[serde(rename = "$schema", default, skip_serializing)]
    #[schemars(with = "String")]
    schema: SchemaReference,
    /// Version of this format; 1.
    #[serde(default = "current_format")]
    pub format: u32,
    /// What the user calls this scene, at most 200 characters.
    #[serde(default)]
    pub name: String,
    /// Seed of every random choice: the same seed on the same build gives the same bytes (default 0).
    #[serde(default)]
    pub seed: u64,
    /// The body; the one key without a default.
    pub body: Body,
    /// Initial spin state.
    #[serde(default)]
    pub spin: Spin,
    /// How spheres touch.
    #[serde(default)]
    pub contact: Contact,
    /// How their gravity is summed.
    #[serde(default)]
    pub gravity: GravityOptions,
    /// When a body counts as settled.
    #[serde(default)]
    pub settling: Settling,
    /// The surface that sunlight meets.
    #[serde(default)]
    pub tiling: TilingOptions,
    /// Heliocentric orbit.
    #[serde(default)]
    pub orbit: Orbit,
    /// Optical and thermal properties of the surface.
    #[serde(default)]
    pub surface: Surface,
    /// Sampling of the torque table.
    #[serde(default)]
    pub torque: TorqueOptions,
    /// Spin evolution and its coupling to the shape.
    #[serde(default)]
    pub evolution: Evolution,
    /// What becomes of shed spheres.
    #[serde(default)]
    pub shed: Shed,
}

impl Scene {
    /// The scene of `body` with every other key at its default.
    pub fn from_body(body: Body) -> Self {
        Self {
            schema: SchemaReference,
            format: FORMAT,
            name: String::new(),
            seed: 0,
            body,
            spin: Spin::default(),
            contact: Contact::default(),
            gravity: GravityOptions::default(),
            settling: Settling::default(),
            tiling: TilingOptions::default(),
            orbit: Orbit::default(),
            surface: Surface::default(),
            torque: TorqueOptions::default(),
            evolution: Evolution::default(),
            shed: Shed::default(),
        }
    }

    /// The scene as pretty JSON with every default written out; parsing it gives the same scene.
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("a scene is plain data with string keys");
        text.push('\n');
        text
    }
}

/// Whatever a scene names as its schema: read and forgotten, so that it makes no difference between two scenes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct SchemaReference;

impl<'de> Deserialize<'de> for SchemaReference {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer).map(|_| Self)
    }
}

fn current_format() -> u32 {
    FORMAT
}
