//! A shape model in sunlight, as `yorp torque` and `yorp rigid` take it from the command line.

use clap::ValueEnum;
use tiling::Mesh;

use super::CliError;
use super::arguments::{self, Switch};
use crate::exchange::read_mesh;

/// What the mesh is made of, how its surface scatters and where the Sun is.
#[derive(Debug, clap::Args)]
pub(super) struct SunlitMesh {
    /// Unit of the mesh's coordinates
    #[arg(long, value_enum, default_value = "m")]
    unit: Unit,
    /// Density of the uniform body
    #[arg(long, value_name = "RHO", default_value_t = 2000.0, value_parser = arguments::positive)]
    pub density_kg_m3: f64,
    /// Spin about the file's z axis, or about the axis of largest moment
    #[arg(long, value_enum, default_value = "file")]
    axes: Axes,
    /// Semimajor axis of the orbit
    #[arg(long, value_name = "A", default_value_t = 1.0, value_parser = arguments::semimajor_axis_au)]
    orbit_au: f64,
    /// Eccentricity of the orbit
    #[arg(long, value_name = "E", default_value_t = 0.0, value_parser = arguments::eccentricity)]
    eccentricity: f64,
    /// How the surface scatters; Hapke's is an average S-type
    #[arg(long, value_enum, default_value = "hapke")]
    reflectance: Scattering,
    /// Bond albedo of a Lambert surface [default: 0.1]
    #[arg(long, value_name = "ALBEDO", value_parser = arguments::fraction)]
    bond_albedo: Option<f64>,
    /// Whether one part of the body shades another
    #[arg(long, value_enum, default_value = "on")]
    shadows: Switch,
    /// Whether emitted light that meets another part of the body is taken off the recoil
    #[arg(long, value_enum, default_value = "on")]
    sky_blockage: Switch,
    /// Thermal inertia, J m^-2 K^-1 s^-1/2
    #[arg(long, value_name = "GAMMA", default_value_t = 0.0, value_parser = arguments::thermal_inertia)]
    thermal_inertia: f64,
    /// Thermal emissivity; cancels without thermal inertia
    #[arg(long, value_name = "EPSILON", default_value_t = 0.9, value_parser = arguments::emissivity)]
    emissivity: f64,
    /// Whether light from one part of the body heats another
    #[arg(long, value_enum, default_value = "none")]
    self_heating: SelfHeating,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Unit {
    M,
    Km,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Axes {
    File,
    Principal,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Scattering {
    Lambert,
    Hapke,
    None,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum SelfHeating {
    None,
}

/// A mesh ready for its torques: origin at the centre of mass, spin about +z.
pub(super) struct MeshBody {
    pub mesh: Mesh,
    pub volume_m3: f64,
    pub inertia_kg_m2: f64,
    pub radius_m: f64,
}

impl SunlitMesh {
    /// The surface, once the flags fit together.
    pub fn surface(&self) -> Result<taco::Surface, CliError> {
        // Both have one value so far, which the parser has made sure of.
        let (SelfHeating::None, 0.0) = (self.self_heating, self.thermal_inertia) else {
            return Err(CliError::refused("heat conduction is not part of this version"));
        };
        let reflectance = match (self.reflectance, self.bond_albedo) {
            (Scattering::Lambert, albedo) => taco::Reflectance::Lambert { bond_albedo: albedo.unwrap_or(0.1) },
            (_, Some(albedo)) => {
                let message = format!("--bond-albedo {albedo} has a meaning with --reflectance lambert only");
                return Err(CliError::refused(message));
            }
            (Scattering::Hapke, None) => taco::Reflectance::default(),
            (Scattering::None, None) => taco::Reflectance::None,
        };
        Ok(taco::Surface {
            reflectance,
            emissivity: self.emissivity,
            shadows: self.shadows.is_on(),
            sky_blockage: self.sky_blockage.is_on(),
            ..taco::Surface::default()
        })
    }

    /// The orbit.
    pub fn orbit(&self) -> taco::Orbit {
        taco::Orbit { semimajor_axis_au: self.orbit_au, eccentricity: self.eccentricity }
    }

    /// The body in `file`; a size that looks like a wrong unit is warned about.
    pub fn body(&self, file: &std::path::Path) -> Result<MeshBody, CliError> {
        let metres = match self.unit {
            Unit::M => 1.0,
            Unit::Km => 1000.0,
        };
        let mesh = read_mesh(file, metres)?;
        let solid = mesh.solid();
        let centred = mesh.translated(solid.centre_of_mass.map(|c| -c));
        let (mesh, moment) = match self.axes {
            Axes::File => (centred, solid.inertia[(2, 2)]),
            Axes::Principal => {
                let axes = solid.principal_axes();
                (centred.rotated(&axes.rotation), axes.moments[2])
            }
        };
        let radius_m = solid.equal_volume_radius();
        if !(1.0..=1e6).contains(&radius_m) {
            eprintln!("warning: the sphere of equal volume has a radius of {radius_m:.3e} m; is --unit right?");
        }
        Ok(MeshBody { mesh, volume_m3: solid.volume, inertia_kg_m2: moment * self.density_kg_m3, radius_m })
    }
}

/// Inputs are the user's; a torque that is not finite is ours.
pub(super) fn torque_failed(error: taco::TacoError) -> CliError {
    match error {
        taco::TacoError::NotFinite { .. } => CliError::numerical(error),
        other => CliError::input(other),
    }
}
