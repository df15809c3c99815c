//! A shape model in sunlight, as `yorp torque` and `yorp rigid` take it from the command line.

use clap::ValueEnum;
use taco::{BodyMesh, SpinAxis};

use super::CliError;
use super::arguments::{self, Switch};
use super::guard;
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
    /// Whether reflected light that meets another part of the body is taken off the recoil as well
    #[arg(long, value_enum, default_value = "off")]
    sky_blockage_reflected: Switch,
    /// Thermal inertia, J m^-2 K^-1 s^-1/2; without it torques do not depend on the spin rate
    #[arg(long, value_name = "GAMMA", default_value_t = 0.0, value_parser = arguments::thermal_inertia)]
    thermal_inertia: f64,
    /// Thermal emissivity; cancels without thermal inertia
    #[arg(long, value_name = "EPSILON", default_value_t = 0.9, value_parser = arguments::emissivity)]
    emissivity: f64,
    /// How far light that one part of the body sends to another is followed
    #[arg(long, value_enum, default_value = "none")]
    self_heating: SelfHeating,
    #[command(flatten)]
    hapke: Hapke,
    #[command(flatten)]
    wall: Wall,
    #[command(flatten)]
    knobs: Knobs,
}

/// Parameters of Hapke's reflectance; what is not given is that of an average S-type.
#[derive(Debug, clap::Args)]
struct Hapke {
    /// Hapke: single-scattering albedo w [default: 0.23]
    #[arg(long, value_name = "W", value_parser = arguments::single_scattering_albedo)]
    hapke_single_scattering_albedo: Option<f64>,
    /// Hapke: mean slope angle of the roughness below facet size [default: 20]
    #[arg(long, value_name = "THETA", value_parser = arguments::roughness_deg)]
    hapke_roughness_deg: Option<f64>,
    /// Hapke: asymmetry of the Henyey-Greenstein function; negative scatters back [default: -0.35]
    #[arg(long, value_name = "G", value_parser = arguments::asymmetry)]
    hapke_asymmetry: Option<f64>,
    /// Hapke: multiple-scattering term [default: h2002]
    #[arg(long, value_enum)]
    hapke_multiple_scattering: Option<MultipleScattering>,
}

/// Multiple-scattering term of the Hapke reflectance.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum MultipleScattering {
    /// Anisotropic (Hapke 2002)
    H2002,
    /// Isotropic (Hapke 1981)
    Imsa,
}

/// Stones as walls, for tangential YORP: all four or none.
#[derive(Debug, clap::Args)]
struct Wall {
    /// Tangential YORP: area of walls (one side) per area of ground
    #[arg(long, value_name = "C", value_parser = arguments::fraction,
          requires_all = ["wall_thickness_m", "wall_conductivity_w_m_k", "wall_thermal_inertia"])]
    wall_coverage: Option<f64>,
    /// Tangential YORP: thickness of the walls from east to west
    #[arg(long, value_name = "L", requires = "wall_coverage", value_parser = arguments::wall_thickness_m)]
    wall_thickness_m: Option<f64>,
    /// Tangential YORP: thermal conductivity of the walls
    #[arg(long, value_name = "KAPPA", requires = "wall_coverage", value_parser = arguments::wall_conductivity_w_m_k)]
    wall_conductivity_w_m_k: Option<f64>,
    /// Tangential YORP: thermal inertia of the walls, J m^-2 K^-1 s^-1/2
    #[arg(long, value_name = "GAMMA", requires = "wall_coverage", value_parser = arguments::wall_thermal_inertia)]
    wall_thermal_inertia: Option<f64>,
}

/// How finely the torques are sampled; more is slower and better.
#[derive(Debug, clap::Args)]
struct Knobs {
    /// Points of a facet from which shadows and sky are seen, a square number
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = arguments::facet_samples)]
    facet_samples: usize,
    /// Azimuths at which the horizon of a facet is known, a multiple of 8
    #[arg(long, value_name = "N", default_value_t = 120, value_parser = arguments::azimuth_bins)]
    azimuth_bins: usize,
    /// Declinations of the Sun from equator to pole, odd
    #[arg(long, value_name = "N", default_value_t = 37, value_parser = arguments::declination_nodes)]
    declination_nodes: usize,
    /// Cells of a rotation in which heat is followed, even
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = arguments::rotation_cells)]
    rotation_cells: usize,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Unit {
    M,
    Km,
    Cm,
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
    /// Its energy is lost
    None,
    /// To the first facet that it meets
    Single,
    /// Until it leaves the body
    Multiple,
}

/// A mesh ready for its torques: origin at the centre of mass, spin about +z.
pub(super) struct MeshBody {
    pub mesh: BodyMesh,
    pub volume_m3: f64,
    pub inertia_kg_m2: f64,
    pub radius_m: f64,
    density_kg_m3: f64,
}

impl MeshBody {
    /// Tells on stderr of a period that looks like one of another unit.
    pub fn warn_of_period(&self, period_h: f64) {
        guard::warn(guard::period(period_h, self.radius_m, self.density_kg_m3));
    }
}

impl SunlitMesh {
    /// The surface, once the flags fit together.
    pub fn surface(&self) -> Result<taco::Surface, CliError> {
        let reflectance = match (self.reflectance, self.bond_albedo) {
            (Scattering::Lambert, albedo) => taco::Reflectance::Lambert { bond_albedo: albedo.unwrap_or(0.1) },
            (_, Some(albedo)) => {
                let message = format!("--bond-albedo {albedo} has a meaning with --reflectance lambert only");
                return Err(CliError::refused(message));
            }
            (Scattering::Hapke, None) => taco::Reflectance::Hapke(self.hapke.to_taco()),
            (Scattering::None, None) => taco::Reflectance::None,
        };
        if let (Scattering::Lambert | Scattering::None, Some(flag)) = (self.reflectance, self.hapke.first_given()) {
            return Err(CliError::refused(format!("{flag} has a meaning with --reflectance hapke only")));
        }
        if self.sky_blockage_reflected.is_on() && !self.sky_blockage.is_on() {
            return Err(CliError::refused("--sky-blockage-reflected on goes with --sky-blockage on only"));
        }
        Ok(taco::Surface {
            reflectance,
            thermal_inertia: self.thermal_inertia,
            emissivity: self.emissivity,
            shadows: self.shadows.is_on(),
            sky_blockage: self.sky_blockage.is_on(),
            sky_blockage_reflected: self.sky_blockage_reflected.is_on(),
            self_heating: match self.self_heating {
                SelfHeating::None => taco::SelfHeating::None,
                SelfHeating::Single => taco::SelfHeating::Single,
                SelfHeating::Multiple => taco::SelfHeating::Multiple,
            },
            tangential_yorp: self.wall.to_taco(),
        })
    }

    /// The sampling, for the given spin rates; a surface without heat ignores them.
    pub fn sampling(&self, spin_rates: taco::SpinRates) -> taco::Sampling {
        taco::Sampling {
            facet_samples: self.knobs.facet_samples,
            azimuth_bins: self.knobs.azimuth_bins,
            declination_nodes: self.knobs.declination_nodes,
            rotation_cells: self.knobs.rotation_cells,
            spin_rates,
            ..taco::Sampling::default()
        }
    }

    /// Tells on stderr what a surface with heat leaves out.
    pub fn warn_of_seasons(&self, surface: &taco::Surface) {
        if let Some(seasonal) = taco::seasonal_heat(surface, &self.orbit()) {
            eprintln!("warning: {seasonal}");
        }
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
            Unit::Cm => 0.01,
        };
        let read = read_mesh(file, metres)?;
        for remark in read.remarks() {
            eprintln!("warning: {}: {remark}", file.display());
        }
        let axis = match self.axes {
            Axes::File => SpinAxis::Z,
            Axes::Principal => SpinAxis::Largest,
        };
        let mesh = BodyMesh::uniform(read.mesh, axis).map_err(torque_failed)?;
        let (volume_m3, radius_m) = (mesh.solid().volume, mesh.solid().equal_volume_radius());
        let inertia_kg_m2 = mesh.spin_moment() * self.density_kg_m3;
        if !(inertia_kg_m2.is_normal() && inertia_kg_m2 > 0.0) {
            return Err(CliError::refused(format!(
                "{}: the moment of inertia about the spin axis is {inertia_kg_m2:e} kg m^2 at {} kg/m^3; it must be finite and \
                 above 0 (is --unit right?)",
                file.display(),
                self.density_kg_m3
            )));
        }
        guard::warn(guard::size(radius_m, "is --unit right?"));
        guard::warn(guard::density(self.density_kg_m3, "--density-kg-m3"));
        guard::warn(guard::spin_axis(mesh.solid()).map(|tilt| format!("{tilt}; --axes principal turns it there")));
        Ok(MeshBody { mesh, volume_m3, inertia_kg_m2, radius_m, density_kg_m3: self.density_kg_m3 })
    }
}

impl Hapke {
    fn to_taco(&self) -> taco::Hapke {
        let usual = taco::Hapke::default();
        taco::Hapke {
            single_scattering_albedo: self.hapke_single_scattering_albedo.unwrap_or(usual.single_scattering_albedo),
            roughness_deg: self.hapke_roughness_deg.unwrap_or(usual.roughness_deg),
            asymmetry: self.hapke_asymmetry.unwrap_or(usual.asymmetry),
            multiple_scattering: match self.hapke_multiple_scattering {
                None => usual.multiple_scattering,
                Some(MultipleScattering::H2002) => taco::MultipleScattering::H2002,
                Some(MultipleScattering::Imsa) => taco::MultipleScattering::Imsa,
            },
        }
    }

    /// The first of the flags that was given.
    fn first_given(&self) -> Option<&'static str> {
        let given = [
            (self.hapke_single_scattering_albedo.is_some(), "--hapke-single-scattering-albedo"),
            (self.hapke_roughness_deg.is_some(), "--hapke-roughness-deg"),
            (self.hapke_asymmetry.is_some(), "--hapke-asymmetry"),
            (self.hapke_multiple_scattering.is_some(), "--hapke-multiple-scattering"),
        ];
        given.into_iter().find(|(given, _)| *given).map(|(_, flag)| flag)
    }
}

impl Wall {
    fn to_taco(&self) -> Option<taco::Wall> {
        Some(taco::Wall {
            coverage: self.wall_coverage?,
            thickness_m: self.wall_thickness_m?,
            conductivity_w_m_k: self.wall_conductivity_w_m_k?,
            thermal_inertia: self.wall_thermal_inertia?,
        })
    }
}

/// Inputs are the user's; a torque that is not finite is ours.
pub(super) fn torque_failed(error: taco::TacoError) -> CliError {
    match error {
        taco::TacoError::NotFinite { .. } => CliError::numerical(error),
        other => CliError::input(other),
    }
}
