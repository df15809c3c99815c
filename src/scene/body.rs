//! The body of a scene: which spheres there are at the beginning.

use serde::{Deserialize, Serialize};

/// Where the spheres come from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Body {
    /// A random packing of equal spheres in an ellipsoid, settled in rotation (Cotto-Figueroa et al. 2015,
    /// section 2.5).
    PackedEllipsoid(PackedEllipsoid),
    /// An aggregate of the user's own.
    File(FileBody),
    /// A shape model filled with spheres.
    CarvedMesh(CarvedMesh),
}

/// A random packing of equal spheres in an ellipsoid; the paper's bodies have 1000 spheres of 50.2 m and 2960 kg/m^3.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PackedEllipsoid {
    /// Number of spheres.
    pub spheres: u32,
    /// Radius of each sphere, m.
    pub radius_m: f64,
    /// Density of each sphere, kg/m^3; the body's own is lower by the voids.
    pub grain_density_kg_m3: f64,
    /// Middle over long semi-axis of the settled body.
    pub b_over_a: f64,
    /// Short over long semi-axis of the settled body, at most `b_over_a`.
    pub c_over_a: f64,
}

/// An aggregate in a CSV file with the columns `x_m, y_m, z_m, mass_kg, radius_m` and optionally velocities and spins.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FileBody {
    /// The file, relative to the folder of the scene.
    pub path: String,
}

/// A closed triangle mesh (OBJ, PLY, STL, OFF or plate table) filled with equal spheres: those whose centre lies inside are kept.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CarvedMesh {
    /// The mesh, relative to the folder of the scene.
    pub path: String,
    /// Unit of the mesh's coordinates (default m).
    #[serde(default)]
    pub unit: LengthUnit,
    /// The packing that is carved.
    pub packing: Packing,
}

/// Unit of the coordinates in a mesh file.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
pub enum LengthUnit {
    /// Metres.
    #[default]
    #[serde(rename = "m")]
    Metre,
    /// Kilometres.
    #[serde(rename = "km")]
    Kilometre,
    /// Centimetres.
    #[serde(rename = "cm")]
    Centimetre,
}

impl LengthUnit {
    /// Length of one unit, m.
    pub fn metres(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Kilometre => 1000.0,
            Self::Centimetre => 0.01,
        }
    }
}

/// How the spheres that fill a mesh are arranged.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Packing {
    /// Random close packing.
    Random(FillingSpheres),
    /// Hexagonal close packing.
    Hcp(FillingSpheres),
}

impl Packing {
    /// The spheres, whatever their arrangement.
    pub fn spheres(&self) -> &FillingSpheres {
        match self {
            Self::Random(spheres) | Self::Hcp(spheres) => spheres,
        }
    }
}

/// The spheres that fill a mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FillingSpheres {
    /// Radius of each sphere, m.
    pub radius_m: f64,
    /// Density of each sphere, kg/m^3.
    pub grain_density_kg_m3: f64,
}
