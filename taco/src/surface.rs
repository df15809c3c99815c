//! What the surface does with light: scattering, emission, shadows.

use crate::error::{TacoError, require};

/// Optical and thermal properties, the same everywhere on the body.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// How sunlight is scattered (default: Hapke).
    pub reflectance: Reflectance,
    /// Thermal inertia, J m^-2 K^-1 s^-1/2, in [0, 10 000] (default: 0, no heat is stored). Dust has 20 to 50, gravel 200,
    /// solid rock 2000.
    pub thermal_inertia: f64,
    /// Infrared emissivity, in (0, 1] (default: 0.9). Cancels out of the torque as long as no heat is stored: what is absorbed
    /// is emitted at once, at whatever temperature that takes.
    pub emissivity: f64,
    /// Whether one part of the body shades another (default: true), seen from [`crate::Sampling::facet_samples`].
    pub shadows: bool,
    /// Whether emitted light that meets another part of the body is taken off the recoil (default: true).
    pub sky_blockage: bool,
    /// Whether reflected light that meets another part of the body is taken off the recoil as well (default: false; only
    /// together with `sky_blockage`). The directions of that part count as Lambert's, with the directional-hemispherical
    /// albedo; what escapes keeps its Hapke recoil.
    pub sky_blockage_reflected: bool,
    /// Whether light that one part of the body sends to another is followed (default: not). If so, all light that meets the
    /// body, scattered or emitted, exerts no recoil until it leaves, whatever the flags for the sky.
    pub self_heating: SelfHeating,
    /// Stones that conduct heat from one side to the other (default: none).
    pub tangential_yorp: Option<Wall>,
}

/// How far light that one part of the body sends to another is followed: scattered sunlight and infrared alike.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum SelfHeating {
    /// Not at all: its energy is lost.
    #[default]
    None,
    /// To the first facet that it meets; what leaves that one and meets another is lost.
    Single,
    /// Until it leaves the body.
    Multiple,
}

/// Stones as north-south walls on level ground, for tangential YORP. There are no standard values: each is the caller's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wall {
    /// Area of walls (one side) per area of ground, in [0, 1]: the amplitude of the effect.
    pub coverage: f64,
    /// Thickness from the east to the west face, m, in [1e-5, 100].
    pub thickness_m: f64,
    /// Thermal conductivity of the stone, W m^-1 K^-1, in [1e-4, 100].
    pub conductivity_w_m_k: f64,
    /// Thermal inertia of the stone, J m^-2 K^-1 s^-1/2, in [1, 10 000].
    pub thermal_inertia: f64,
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
            tangential_yorp: None,
        }
    }
}

/// How sunlight is scattered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reflectance {
    /// Black: everything is absorbed.
    None,
    /// The same radiance in all directions.
    Lambert {
        /// Fraction of the sunlight that is scattered, in [0, 1].
        bond_albedo: f64,
    },
    /// Hapke's photometric model.
    Hapke(Hapke),
}

impl Default for Reflectance {
    fn default() -> Self {
        Self::Hapke(Hapke::default())
    }
}

/// Parameters of Hapke's model without opposition effect (Hapke 2002, Icarus 157, 523; roughness of Hapke 1984,
/// Icarus 59, 41). The defaults are the average S-type of Cotto-Figueroa et al. 2015 (ApJ 803, 25).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hapke {
    /// Single-scattering albedo w, in [0, 1) (default: 0.23).
    pub single_scattering_albedo: f64,
    /// Mean slope angle of the macroscopic roughness, deg, in [0, 60) (default: 20).
    pub roughness_deg: f64,
    /// Asymmetry of the one-term Henyey-Greenstein phase function of the phase angle, in (-1, 1); negative scatters
    /// back towards the Sun (default: -0.35).
    pub asymmetry: f64,
    /// Treatment of multiply scattered light (default: H2002).
    pub multiple_scattering: MultipleScattering,
}

impl Default for Hapke {
    fn default() -> Self {
        Self {
            single_scattering_albedo: 0.23,
            roughness_deg: 20.0,
            asymmetry: -0.35,
            multiple_scattering: MultipleScattering::H2002,
        }
    }
}

/// Multiple scattering between grains.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum MultipleScattering {
    /// Anisotropic (Hapke 2002).
    #[default]
    H2002,
    /// Isotropic multiple-scattering approximation (Hapke 1981).
    Imsa,
}

impl Surface {
    /// Refuses impossible values.
    ///
    /// # Errors
    /// [`TacoError::OutOfRange`] with the path of the value.
    pub fn validate(&self) -> Result<(), TacoError> {
        let (inertia, emissivity) = (self.thermal_inertia, self.emissivity);
        require((0.0..=1e4).contains(&inertia), "surface.thermal_inertia", inertia, "[0, 10000] J m^-2 K^-1 s^-1/2")?;
        if let Some(wall) = &self.tangential_yorp {
            wall.validate()?;
        }
        require(emissivity > 0.0 && emissivity <= 1.0, "surface.emissivity", emissivity, "(0, 1]")?;
        let together = self.sky_blockage || !self.sky_blockage_reflected;
        require(together, "surface.sky_blockage_reflected", 1.0, "off without sky_blockage")?;
        match self.reflectance {
            Reflectance::None => Ok(()),
            Reflectance::Lambert { bond_albedo: albedo } => {
                require((0.0..=1.0).contains(&albedo), "surface.reflectance.lambert.bond_albedo", albedo, "[0, 1]")
            }
            Reflectance::Hapke(hapke) => hapke.validate(),
        }
    }
}

impl Wall {
    /// Refuses impossible values.
    ///
    /// # Errors
    /// [`TacoError::OutOfRange`] with the path of the value.
    pub fn validate(&self) -> Result<(), TacoError> {
        let Self { coverage, thickness_m: thickness, conductivity_w_m_k: conductivity, thermal_inertia } = *self;
        require((0.0..=1.0).contains(&coverage), "surface.tangential_yorp.wall.coverage", coverage, "[0, 1]")?;
        let ok = (1e-5..=100.0).contains(&thickness);
        require(ok, "surface.tangential_yorp.wall.thickness_m", thickness, "[1e-5, 100] m")?;
        let ok = (1e-4..=100.0).contains(&conductivity);
        require(ok, "surface.tangential_yorp.wall.conductivity_w_m_k", conductivity, "[1e-4, 100] W m^-1 K^-1")?;
        let (ok, path) = ((1.0..=1e4).contains(&thermal_inertia), "surface.tangential_yorp.wall.thermal_inertia");
        require(ok, path, thermal_inertia, "[1, 10000] J m^-2 K^-1 s^-1/2")
    }
}

impl Hapke {
    /// Refuses impossible values.
    ///
    /// # Errors
    /// [`TacoError::OutOfRange`] with the path of the value.
    pub fn validate(&self) -> Result<(), TacoError> {
        let Self { single_scattering_albedo: w, roughness_deg, asymmetry, .. } = *self;
        require((0.0..1.0).contains(&w), "surface.reflectance.hapke.single_scattering_albedo", w, "[0, 1)")?;
        let rough = (0.0..60.0).contains(&roughness_deg);
        require(rough, "surface.reflectance.hapke.roughness_deg", roughness_deg, "[0, 60) deg")?;
        require(asymmetry.abs() < 1.0, "surface.reflectance.hapke.asymmetry", asymmetry, "(-1, 1)")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_values_are_refused_with_their_path() {
        assert_eq!(Surface::default().validate(), Ok(()));
        let hapke = |h: Hapke| Surface { reflectance: Reflectance::Hapke(h), ..Surface::default() };
        let stones = Wall { coverage: 0.1, thickness_m: 0.1, conductivity_w_m_k: 1.0, thermal_inertia: 2000.0 };
        let wall = |wall: Wall| Surface { tangential_yorp: Some(wall), ..Surface::default() };
        assert_eq!(wall(stones).validate(), Ok(()));
        let cases = [
            (Surface { thermal_inertia: -1.0, ..Surface::default() }, "surface.thermal_inertia"),
            (Surface { thermal_inertia: f64::NAN, ..Surface::default() }, "surface.thermal_inertia"),
            (wall(Wall { coverage: 1.1, ..stones }), "surface.tangential_yorp.wall.coverage"),
            (wall(Wall { thickness_m: 0.0, ..stones }), "surface.tangential_yorp.wall.thickness_m"),
            (wall(Wall { conductivity_w_m_k: f64::NAN, ..stones }), "surface.tangential_yorp.wall.conductivity_w_m_k"),
            (wall(Wall { thermal_inertia: 0.0, ..stones }), "surface.tangential_yorp.wall.thermal_inertia"),
            (Surface { emissivity: 0.0, ..Surface::default() }, "surface.emissivity"),
            (
                Surface { sky_blockage: false, sky_blockage_reflected: true, ..Surface::default() },
                "surface.sky_blockage_reflected",
            ),
            (Surface { emissivity: f64::NAN, ..Surface::default() }, "surface.emissivity"),
            (
                Surface { reflectance: Reflectance::Lambert { bond_albedo: 1.1 }, ..Surface::default() },
                "surface.reflectance.lambert.bond_albedo",
            ),
            (
                hapke(Hapke { single_scattering_albedo: 1.0, ..Hapke::default() }),
                "surface.reflectance.hapke.single_scattering_albedo",
            ),
            (hapke(Hapke { roughness_deg: 60.0, ..Hapke::default() }), "surface.reflectance.hapke.roughness_deg"),
            (hapke(Hapke { asymmetry: -1.0, ..Hapke::default() }), "surface.reflectance.hapke.asymmetry"),
        ];
        for (surface, expected) in cases {
            match surface.validate() {
                Err(TacoError::OutOfRange { path, .. }) => assert_eq!(path, expected),
                other => panic!("{expected}: {other:?}"),
            }
        }
    }
}
