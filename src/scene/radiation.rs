//! How sunlight acts on the body of a scene: orbit, surface, sampling of the torque table.
//!
//! Defaults are those of Cotto-Figueroa et al. (2015), section 2.6.

use serde::{Deserialize, Serialize};

/// Heliocentric orbit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Orbit {
    /// Semimajor axis, au (default 1).
    pub semimajor_axis_au: f64,
    /// Eccentricity, 0 to below 1 (default 0).
    pub eccentricity: f64,
}

impl Default for Orbit {
    fn default() -> Self {
        Self { semimajor_axis_au: 1.0, eccentricity: 0.0 }
    }
}

/// Optical and thermal properties of the surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Surface {
    /// How sunlight is scattered (default Hapke, average S-type).
    pub reflectance: Reflectance,
    /// Thermal inertia, J m^-2 K^-1 s^-1/2 (default 0, absorbed light leaves where and when it arrived). Otherwise the
    /// torques depend on the spin rate and are tabulated over it, see `torque.spin_rates`.
    pub thermal_inertia: f64,
    /// Thermal emissivity (default 0.9); without thermal inertia it cancels.
    pub emissivity: f64,
    /// Whether one part of the body may shade another (default true).
    pub shadows: bool,
    /// Whether emitted light that meets another part of the body is taken off the recoil (default true).
    pub sky_blockage: bool,
    /// Whether reflected light that meets another part of the body is taken off the recoil as well (default false); only
    /// together with `sky_blockage`.
    pub sky_blockage_reflected: bool,
    /// Whether light from one part of the body heats another (default none).
    pub self_heating: SelfHeating,
    /// Recoil of boulders that conduct heat through (Golubov & Krugly 2012) (default none).
    pub tangential_yorp: TangentialYorp,
}

impl Default for Surface {
    fn default() -> Self {
        Self {
            reflectance: Reflectance::default(),
            thermal_inertia: 0.0,
            emissivity: 0.9,
            shadows: true,
            sky_blockage: true,
            sky_blockage_reflected: false,
            self_heating: SelfHeating::None,
            tangential_yorp: TangentialYorp::None,
        }
    }
}

/// How sunlight is scattered.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Reflectance {
    /// Hapke (2002, Icarus 157, 523) without opposition effect, with macroscopic roughness (Hapke 1984).
    Hapke(HapkeReflectance),
    /// Equal radiance in all directions.
    Lambert(LambertReflectance),
    /// Black: everything is absorbed.
    None,
}

impl Default for Reflectance {
    fn default() -> Self {
        Self::Hapke(HapkeReflectance::default())
    }
}

/// Hapke parameters; defaults for an average S-type (Helfenstein & Veverka 1989).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct HapkeReflectance {
    /// Single-scattering albedo w (default 0.23).
    pub single_scattering_albedo: f64,
    /// Mean slope angle of the roughness below facet size, deg (default 20).
    pub roughness_deg: f64,
    /// Asymmetry of the one-term Henyey-Greenstein function in the phase angle; negative scatters back (default -0.35).
    pub asymmetry: f64,
    /// Multiple-scattering term (default h2002).
    pub multiple_scattering: MultipleScattering,
}

impl Default for HapkeReflectance {
    fn default() -> Self {
        Self {
            single_scattering_albedo: 0.23,
            roughness_deg: 20.0,
            asymmetry: -0.35,
            multiple_scattering: MultipleScattering::H2002,
        }
    }
}

/// Multiple-scattering term of the Hapke reflectance.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MultipleScattering {
    /// Anisotropic (Hapke 2002).
    #[default]
    H2002,
    /// Isotropic (Hapke 1981): `H(mu0) H(mu) - 1`.
    Imsa,
}

/// A Lambert surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct LambertReflectance {
    /// Bond albedo (default 0.1).
    pub bond_albedo: f64,
}

impl Default for LambertReflectance {
    fn default() -> Self {
        Self { bond_albedo: 0.1 }
    }
}

/// Heating of one part of the body by light from another, scattered sunlight and infrared alike.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SelfHeating {
    /// Left out: the energy of light that meets the body again is lost.
    #[default]
    None,
    /// Light is followed to the first facet that it meets.
    Single,
    /// Light is followed until it leaves the body.
    Multiple,
}

/// Tangential YORP.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TangentialYorp {
    /// Left out.
    #[default]
    None,
    /// Stones as north-south walls on level ground.
    Wall(Wall),
}

/// Walls that conduct heat from one side to the other; nothing is known well enough for a default.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wall {
    /// Area of walls (one side) per area of ground: the amplitude of the effect.
    pub coverage: f64,
    /// Thickness from the east to the west face, m.
    pub thickness_m: f64,
    /// Thermal conductivity of the stone, W m^-1 K^-1.
    pub conductivity_w_m_k: f64,
    /// Thermal inertia of the stone, J m^-2 K^-1 s^-1/2.
    pub thermal_inertia: f64,
}

/// Sampling of the torque table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct TorqueOptions {
    /// Spacing of the obliquity nodes, deg; divides 180 (default 5).
    pub obliquity_step_deg: f64,
    /// Interpolation between the nodes (default cubic).
    pub interpolation: Interpolation,
    /// Azimuths at which the horizon of a facet is known, a multiple of 8 (default 120); time and memory grow in
    /// proportion.
    pub azimuth_bins: u32,
    /// Solar declinations from equator to pole at which the rotation is averaged, odd (default 37); time grows in
    /// proportion.
    pub declination_nodes: u32,
    /// Points of a facet from which shadows and sky are seen, a square number (default 1, the centroid); the time of
    /// facets that see others grows in proportion.
    pub facet_samples: u32,
    /// Cells of a rotation in which heat is followed, even (default 64); of no matter without stored heat.
    pub rotation_cells: u32,
    /// Spin rates of the table, from zero on (default 11); of no matter without stored heat. Time grows in proportion.
    pub spin_rates: u32,
    /// Period at the largest spin rate of the table, h (default 2); for faster spin the torques there are taken.
    pub shortest_period_h: f64,
}

impl Default for TorqueOptions {
    fn default() -> Self {
        Self {
            obliquity_step_deg: 5.0,
            interpolation: Interpolation::Cubic,
            azimuth_bins: 120,
            declination_nodes: 37,
            facet_samples: 1,
            rotation_cells: 64,
            spin_rates: 11,
            shortest_period_h: 2.0,
        }
    }
}

/// Interpolation of the torque table in obliquity.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Interpolation {
    /// Cubic spline that keeps the symmetry at the poles.
    #[default]
    Cubic,
    /// Straight lines, as in the paper.
    Linear,
}
