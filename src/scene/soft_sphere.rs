//! Soft spheres as a scene asks for them: a published set of parameters, and what replaces single values of it.

use serde::{Deserialize, Serialize};

/// Soft spheres: springs, dashpots and sliders in every contact (Schwartz et al. 2012, Granular Matter 14, 363; Zhang et al.
/// 2017, Icarus 294, 98). A key that is null has the preset's value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SoftSphereContact {
    /// The set of parameters to start from (default zhang_2017).
    pub preset: SoftSpherePreset,
    /// Normal restitution eps_n: 1 is elastic, 0 takes all normal speed.
    pub restitution_normal: Option<f64>,
    /// What resists sliding, rolling and twisting. A model that the preset does not have needs its coefficients.
    pub friction_model: Option<FrictionModel>,
    /// Coefficient of sliding friction mu_S.
    pub sliding_friction: Option<f64>,
    /// Coefficient of rolling friction mu_R.
    pub rolling_friction: Option<f64>,
    /// Coefficient of twisting friction mu_T.
    pub twisting_friction: Option<f64>,
    /// Tangential restitution eps_t, which sets the dashpot against sliding (0.55 unless the preset has another).
    pub restitution_tangential: Option<f64>,
    /// What the tangential restitution means (default pkdgrav).
    pub tangential_damping: TangentialDamping,
    /// What a contact does that slips (default rescale).
    pub sliding_cap: SlidingCap,
    /// Shape parameter beta: width of a contact over the effective radius (default 0.5). Of use to rolling, twisting and
    /// cohesion.
    pub shape_parameter: f64,
    /// Cohesion between two spheres c, Pa: a contact attracts with 4 c (beta R_eff)^2 (default 0). That of the bulk is another,
    /// much smaller number.
    pub cohesion_pa: f64,
    /// Normal stiffness k_n, N/m (default null: from the body, so that spheres overlap by at most 1 % of their radius).
    pub normal_stiffness_n_m: Option<f64>,
    /// Fastest impact that the stiffness is made for, m/s (default null: from the body).
    pub expected_speed_m_s: Option<f64>,
    /// Steps in the duration of the quickest contact (default 30, which gives restitutions 0.4 % too low).
    pub steps_per_contact: f64,
    /// Time step, s (default null: from the stiffness and steps_per_contact). A step is refused that leaves fewer than ten in
    /// a contact.
    pub step_s: Option<f64>,
    /// Overlap over the smaller radius at which a run stops (default 0.01).
    pub max_overlap_over_radius: f64,
    /// How far a sphere may move against the rigid motion of the body, over its radius, before gravity is evaluated anew;
    /// until then the field turns with the body (default 0.01: an error of 1.5e-3 while a thousand spheres fall together, less
    /// in a body at rest). 0 evaluates it in every step.
    pub field_tolerance: f64,
    /// How far a sphere may move before neighbours are searched anew, over its radius (default 0.02). Changes the cost only.
    pub skin: f64,
}

impl Default for SoftSphereContact {
    fn default() -> Self {
        Self {
            preset: SoftSpherePreset::Zhang2017,
            restitution_normal: None,
            friction_model: None,
            sliding_friction: None,
            rolling_friction: None,
            twisting_friction: None,
            restitution_tangential: None,
            tangential_damping: TangentialDamping::Pkdgrav,
            sliding_cap: SlidingCap::Rescale,
            shape_parameter: 0.5,
            cohesion_pa: 0.0,
            normal_stiffness_n_m: None,
            expected_speed_m_s: None,
            steps_per_contact: 30.0,
            step_s: None,
            max_overlap_over_radius: 0.01,
            field_tolerance: 0.01,
            skin: 0.02,
        }
    }
}

/// Published sets of contact parameters.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SoftSpherePreset {
    /// Nominal set of Zhang et al. 2017: eps 0.55, mu_S 1, mu_R 1.05, mu_T 1.3, springs against rolling and twisting.
    #[default]
    #[serde(rename = "zhang_2017")]
    Zhang2017,
    /// Gravel, attributed to Yu et al. 2014: eps 0.55, mu_S 1.31, mu_R 3, directional.
    Gravel,
    /// Glass beads, attributed to Yu et al. 2014: eps 0.95, mu_S 0.43, mu_R 0.1, directional.
    GlassBeads,
    /// Perfectly smooth spheres: eps 0.55.
    Frictionless,
}

impl SoftSpherePreset {
    /// Name in a scene.
    pub fn name(self) -> &'static str {
        match self {
            Self::Zhang2017 => "zhang_2017",
            Self::Gravel => "gravel",
            Self::GlassBeads => "glass_beads",
            Self::Frictionless => "frictionless",
        }
    }
}

/// What resists sliding, rolling and twisting in a contact; what is off costs neither time nor memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FrictionModel {
    /// Nothing: spins never change, contacts have no memory.
    None,
    /// A spring, a dashpot and a slider against sliding.
    Sliding,
    /// The same against sliding, rolling and twisting (Zhang et al. 2017, eqs 4-12).
    RollingAndTwisting,
    /// Constant torques against rolling and twisting (Schwartz et al. 2012, eqs 20-21): they take rotation away but hold no
    /// load at rest.
    Directional,
}

impl FrictionModel {
    /// Name in a scene.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Sliding => "sliding",
            Self::RollingAndTwisting => "rolling_and_twisting",
            Self::Directional => "directional",
        }
    }
}

/// What the tangential restitution means.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TangentialDamping {
    /// The dashpot has the form of the normal one; sliding that sticks ends reversed and smaller than the nominal value.
    #[default]
    Pkdgrav,
    /// Sliding that sticks ends at minus the nominal value.
    Exact,
}

/// What a contact does that slips.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SlidingCap {
    /// The smaller of spring and dashpot and of the limit; the spring goes on stretching (Zhang et al. 2017, eq. 2).
    Smaller,
    /// The spring is lost, the dashpot stays (pkdgrav).
    Drop,
    /// The spring is shortened to the limit (Cundall & Strack 1979).
    #[default]
    Rescale,
}

impl SoftSphereContact {
    /// The preset's parameters as the particle crate knows them.
    pub(super) fn preset_parameters(&self) -> pkd::soft_sphere::SoftSphereParameters {
        use pkd::soft_sphere::SoftSphereParameters as Parameters;
        match self.preset {
            SoftSpherePreset::Zhang2017 => Parameters::zhang_2017(),
            SoftSpherePreset::Gravel => Parameters::gravel(),
            SoftSpherePreset::GlassBeads => Parameters::glass_beads(),
            SoftSpherePreset::Frictionless => Parameters::frictionless(),
        }
    }

    /// The model of friction in use.
    pub fn friction(&self) -> FrictionModel {
        self.friction_model.unwrap_or(match self.preset {
            SoftSpherePreset::Zhang2017 => FrictionModel::RollingAndTwisting,
            SoftSpherePreset::Gravel | SoftSpherePreset::GlassBeads => FrictionModel::Directional,
            SoftSpherePreset::Frictionless => FrictionModel::None,
        })
    }

    /// The first key that does not go with the model of friction: its name, and what would be allowed.
    pub(super) fn inconsistency(&self) -> Option<(&'static str, Option<f64>, String)> {
        let model = self.friction();
        let preset = Self { preset: self.preset, ..Self::default() }.friction();
        let slides = model != FrictionModel::None;
        let rolls = matches!(model, FrictionModel::RollingAndTwisting | FrictionModel::Directional);
        for (key, value, used, given_by_preset) in [
            ("sliding_friction", self.sliding_friction, slides, preset != FrictionModel::None),
            ("restitution_tangential", self.restitution_tangential, slides, true),
            ("rolling_friction", self.rolling_friction, rolls, preset == model),
            ("twisting_friction", self.twisting_friction, rolls, preset == model),
        ] {
            if value.is_some() && !used {
                return Some((key, value, format!("null, as friction_model is {}", model.name())));
            }
            if value.is_none() && used && !given_by_preset {
                let preset = self.preset.name();
                let allowed = format!("a number, as the preset {preset} has none for friction_model {}", model.name());
                return Some((key, value, allowed));
            }
        }
        None
    }
}
