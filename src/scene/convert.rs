//! What a scene means to the crates that compute: parameters in their types.

use std::f64::consts::TAU;

use super::{
    FrictionModel, GravityMethod, GravityOptions, HardSphereContact, Interpolation, MultipleScattering, Orbit, Rebound,
    Reflectance, SelfHeating, SlideVelocity, SlidingCap, SoftSphereContact, Surface, TangentialDamping, TangentialYorp,
    TorqueOptions,
};

impl HardSphereContact {
    /// Parameters of the hard-sphere engine, with `gravity`.
    pub fn to_pkd(&self, gravity: &GravityOptions) -> pkd::hard_sphere::HardSphereParameters {
        pkd::hard_sphere::HardSphereParameters {
            restitution_normal: self.restitution_normal,
            restitution_tangential: self.restitution_tangential,
            slide_limit: self.slide_limit,
            slide_velocity: match self.slide_velocity {
                SlideVelocity::Centre => pkd::hard_sphere::SlideVelocity::Centre,
                SlideVelocity::Surface => pkd::hard_sphere::SlideVelocity::Surface,
            },
            collapse_limit: self.collapse_limit,
            step_s: self.step_s,
            max_collisions_per_sphere: self.max_collisions_per_sphere,
            gravity: Some(gravity.to_pkd()),
        }
    }
}

impl SoftSphereContact {
    /// Parameters of the soft-sphere engine, with `gravity`.
    pub fn to_pkd(&self, gravity: &GravityOptions) -> pkd::soft_sphere::SoftSphereParameters {
        let preset = self.preset_parameters();
        pkd::soft_sphere::SoftSphereParameters {
            restitution: self.restitution_normal.unwrap_or(preset.restitution),
            friction: self.friction_to_pkd(&preset.friction),
            shape: self.shape_parameter,
            cohesion_pa: self.cohesion_pa,
            normal_stiffness_n_m: self.normal_stiffness_n_m,
            expected_speed_m_s: self.expected_speed_m_s,
            steps_per_contact: self.steps_per_contact,
            step_s: self.step_s,
            max_overlap: self.max_overlap_over_radius,
            gravity: if self.field_tolerance > 0.0 {
                pkd::soft_sphere::Gravity::BodyFrame { tolerance: self.field_tolerance }
            } else {
                pkd::soft_sphere::Gravity::EveryStep
            },
            gravity_options: gravity.to_pkd(),
            skin: self.skin,
            ledger: false,
        }
    }

    fn friction_to_pkd(&self, preset: &pkd::soft_sphere::Friction) -> pkd::soft_sphere::Friction {
        use pkd::soft_sphere::Friction;
        let (mut sliding, [mut rolling, mut twisting]) = match preset {
            Friction::None => (pkd::soft_sphere::Sliding::default(), [0.0; 2]),
            Friction::Sliding(sliding) => (*sliding, [0.0; 2]),
            Friction::RollingAndTwisting { sliding, rolling, twisting }
            | Friction::Directional { sliding, rolling, twisting } => (*sliding, [*rolling, *twisting]),
        };
        for (value, given) in [
            (&mut sliding.coefficient, self.sliding_friction),
            (&mut sliding.restitution, self.restitution_tangential),
            (&mut rolling, self.rolling_friction),
            (&mut twisting, self.twisting_friction),
        ] {
            *value = given.unwrap_or(*value);
        }
        sliding.damping = match self.tangential_damping {
            TangentialDamping::Pkdgrav => pkd::soft_sphere::TangentialDamping::Pkdgrav,
            TangentialDamping::Exact => pkd::soft_sphere::TangentialDamping::Exact,
        };
        sliding.cap = match self.sliding_cap {
            SlidingCap::Smaller => pkd::soft_sphere::SlidingCap::Smaller,
            SlidingCap::Drop => pkd::soft_sphere::SlidingCap::Drop,
            SlidingCap::Rescale => pkd::soft_sphere::SlidingCap::Rescale,
        };
        match self.friction() {
            FrictionModel::None => Friction::None,
            FrictionModel::Sliding => Friction::Sliding(sliding),
            FrictionModel::RollingAndTwisting => Friction::RollingAndTwisting { sliding, rolling, twisting },
            FrictionModel::Directional => Friction::Directional { sliding, rolling, twisting },
        }
    }
}

impl GravityOptions {
    /// The options as the particle crate knows them.
    pub fn to_pkd(&self) -> pkd::gravity::GravityOptions {
        pkd::gravity::GravityOptions {
            method: match self.method {
                GravityMethod::Auto => pkd::gravity::GravityMethod::Auto,
                GravityMethod::Direct => pkd::gravity::GravityMethod::Direct,
                GravityMethod::Tree => pkd::gravity::GravityMethod::Tree,
            },
            force_error: self.force_error,
        }
    }
}

impl Surface {
    /// The surface as the radiation crate knows it; without albedo it becomes black, so that nothing is tabulated.
    pub fn to_taco(&self) -> taco::Surface {
        let reflectance = match &self.reflectance {
            Reflectance::Hapke(hapke) if hapke.single_scattering_albedo > 0.0 => {
                taco::Reflectance::Hapke(taco::Hapke {
                    single_scattering_albedo: hapke.single_scattering_albedo,
                    roughness_deg: hapke.roughness_deg,
                    asymmetry: hapke.asymmetry,
                    multiple_scattering: match hapke.multiple_scattering {
                        MultipleScattering::H2002 => taco::MultipleScattering::H2002,
                        MultipleScattering::Imsa => taco::MultipleScattering::Imsa,
                    },
                })
            }
            Reflectance::Lambert(lambert) => taco::Reflectance::Lambert { bond_albedo: lambert.bond_albedo },
            Reflectance::Hapke(_) | Reflectance::None => taco::Reflectance::None,
        };
        taco::Surface {
            reflectance,
            thermal_inertia: self.thermal_inertia,
            emissivity: self.emissivity,
            shadows: self.shadows,
            sky_blockage: self.sky_blockage,
            sky_blockage_reflected: self.sky_blockage_reflected,
            self_heating: match self.self_heating {
                SelfHeating::None => taco::SelfHeating::None,
                SelfHeating::Single => taco::SelfHeating::Single,
                SelfHeating::Multiple => taco::SelfHeating::Multiple,
            },
            tangential_yorp: match self.tangential_yorp {
                TangentialYorp::None => None,
                TangentialYorp::Wall(wall) => Some(taco::Wall {
                    coverage: wall.coverage,
                    thickness_m: wall.thickness_m,
                    conductivity_w_m_k: wall.conductivity_w_m_k,
                    thermal_inertia: wall.thermal_inertia,
                }),
            },
        }
    }
}

impl Orbit {
    /// The orbit as the radiation crate knows it.
    pub fn to_taco(&self) -> taco::Orbit {
        taco::Orbit { semimajor_axis_au: self.semimajor_axis_au, eccentricity: self.eccentricity }
    }
}

impl Rebound {
    /// How shed bodies are followed by a body on `orbit` whose equator is inclined to it by `obliquity` (rad).
    pub fn to_shed(&self, orbit: &Orbit, obliquity: f64) -> crate::shed::TrackOptions {
        let acts = self.solar_tide || self.radiation_pressure > 0.0;
        let pressure = (self.radiation_pressure > 0.0).then_some(self.radiation_pressure);
        crate::shed::TrackOptions {
            t_max_s: self.t_max_days * 86_400.0,
            semimajor_axis_au: orbit.semimajor_axis_au,
            ias15_tolerance: self.ias15_tolerance,
            multipole_error: self.multipole_error,
            sun: acts.then_some(crate::shed::Sun {
                obliquity,
                tide: self.solar_tide,
                radiation_pressure_coefficient: pressure,
            }),
        }
    }
}

impl TorqueOptions {
    /// The sampling of a torque table.
    pub fn to_taco(&self) -> taco::Sampling {
        taco::Sampling {
            obliquities: taco::Obliquities::StepDeg(self.obliquity_step_deg),
            azimuth_bins: self.azimuth_bins as usize,
            declination_nodes: self.declination_nodes as usize,
            facet_samples: self.facet_samples as usize,
            rotation_cells: self.rotation_cells as usize,
            spin_rates: taco::SpinRates::UpTo {
                max_rad_s: TAU / (self.shortest_period_h * 3600.0),
                nodes: self.spin_rates as usize,
            },
        }
    }
}

impl Interpolation {
    /// The interpolation as the radiation crate knows it.
    pub fn to_taco(self) -> taco::Interpolation {
        match self {
            Self::Cubic => taco::Interpolation::Cubic,
            Self::Linear => taco::Interpolation::Linear,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{HapkeReflectance, LambertReflectance, SoftSpherePreset};

    #[test]
    fn defaults_of_a_scene_are_the_defaults_of_the_crates() {
        let gravity = GravityOptions::default();
        assert_eq!(HardSphereContact::default().to_pkd(&gravity), pkd::hard_sphere::HardSphereParameters::default());
        use SoftSpherePreset::{Frictionless, GlassBeads, Gravel, Zhang2017};
        use pkd::soft_sphere::SoftSphereParameters as Soft;
        for (preset, expected) in [
            (Zhang2017, Soft::zhang_2017()),
            (Gravel, Soft::gravel()),
            (GlassBeads, Soft::glass_beads()),
            (Frictionless, Soft::frictionless()),
        ] {
            let contact = SoftSphereContact { preset, ..SoftSphereContact::default() };
            assert_eq!(contact.to_pkd(&gravity), expected);
        }
        assert_eq!(Surface::default().to_taco(), taco::Surface::default());
        assert_eq!(Orbit::default().to_taco(), taco::Orbit::default());
        assert_eq!(TorqueOptions::default().to_taco(), taco::Sampling::default());
        assert_eq!(Interpolation::default().to_taco(), taco::Interpolation::default());
        assert_eq!(Rebound::default().to_shed(&Orbit::default(), 0.1), crate::shed::TrackOptions::default());
    }

    #[test]
    fn values_given_replace_those_of_the_preset() {
        use pkd::soft_sphere::{Friction, Gravity};
        let contact = SoftSphereContact {
            preset: SoftSpherePreset::Gravel,
            friction_model: Some(FrictionModel::Sliding),
            sliding_friction: Some(0.3),
            field_tolerance: 0.0,
            ..SoftSphereContact::default()
        };
        let parameters = contact.to_pkd(&GravityOptions::default());
        let Friction::Sliding(sliding) = parameters.friction else { panic!("{parameters:?}") };
        assert_eq!((sliding.coefficient, sliding.restitution, parameters.gravity), (0.3, 0.55, Gravity::EveryStep));
    }

    #[test]
    fn a_surface_without_albedo_is_black() {
        let hapke = HapkeReflectance { single_scattering_albedo: 0.0, ..HapkeReflectance::default() };
        let black = Surface { reflectance: Reflectance::Hapke(hapke), ..Surface::default() };
        assert_eq!(black.to_taco().reflectance, taco::Reflectance::None);
        let lambert = Reflectance::Lambert(LambertReflectance { bond_albedo: 0.2 });
        let grey = Surface { reflectance: lambert, ..Surface::default() };
        assert_eq!(grey.to_taco().reflectance, taco::Reflectance::Lambert { bond_albedo: 0.2 });
    }
}
