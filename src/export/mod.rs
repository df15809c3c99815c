//! A run for other programs: CSV and NPZ tables, OBJ surfaces, VTK time series.
//!
//! An export is a folder of its own with a manifest, by which a later export of the same run knows that it may replace it;
//! any other folder with something in it is left alone.

mod npz;
mod paraview;
mod table;
mod tables;

use std::path::{Path, PathBuf};

pub use npz::TooLarge;
pub use table::{Column, Table};
pub use tables::tables;

use crate::exchange::{WriteError, csv::aggregate_csv, write_whole};
use crate::report::RunData;
use crate::store::ConfigurationRecord;
use tiling::Mesh;

/// Name of the file that makes a folder an export.
const MANIFEST: &str = "yorp-export.json";

/// What files an export is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// A file for each table, and `spheres/NNNN.csv` for each configuration: an aggregate that `yorp relax` and `yorp tile`
    /// read, at rest in its body frame.
    Csv,
    /// `tiling_NNNN.vtp` and `spheres_NNNN.vtp` for each configuration, original frame, with `tiling.pvd` and `spheres.pvd`.
    Vtk,
    /// `NNNN.obj`: the tiling of each configuration in its body frame, z the spin axis, as `yorp torque` reads it.
    Obj,
    /// `run.npz`: all tables and shapes as arrays.
    Npz,
}

impl Format {
    /// Name in a manifest.
    pub fn name(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Vtk => "vtk",
            Self::Obj => "obj",
            Self::Npz => "npz",
        }
    }
}

/// Why a run was not exported.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The folder holds something else.
    #[error("{} holds something else than an export of this run as {format}; choose another folder", folder.display())]
    Foreign {
        /// The folder.
        folder: PathBuf,
        /// The format that was asked for.
        format: &'static str,
    },
    /// The run has no shape yet, and this format is for shapes.
    #[error("{} has no tiled body yet; --format csv or npz gives what is there", .0.display())]
    NoShape(PathBuf),
    /// Too much for the format.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// Writes the run into `folder`, which is made if it is not there; names of the files, without the manifest.
///
/// # Errors
/// The folder holds something foreign, the run has nothing for the format, or a file cannot be written.
pub fn export(run: &RunData, folder: &Path, format: Format) -> Result<Vec<String>, ExportError> {
    if run.configurations.is_empty() && matches!(format, Format::Obj | Format::Vtk) {
        return Err(ExportError::NoShape(run.directory.clone()));
    }
    claim(run, folder, format)?;
    let mut writer = Writer { folder, files: Vec::new() };
    match format {
        Format::Csv => write_csv(run, &mut writer)?,
        Format::Npz => writer.write("run.npz".into(), &npz::npz(run, &tables(run))?)?,
        Format::Obj => {
            for c in &run.configurations {
                writer.write(format!("{:04}.obj", c.configuration), body_obj(run, c).as_bytes())?;
            }
        }
        Format::Vtk => write_vtk(run, &mut writer)?,
    }
    Ok(writer.files)
}

/// Makes the folder ours, or finds that it is.
fn claim(run: &RunData, folder: &Path, format: Format) -> Result<(), ExportError> {
    let cannot = |source| WriteError { file: folder.to_owned(), source };
    let manifest = folder.join(MANIFEST);
    let ours = manifest_text(run, format);
    let occupied = match folder.metadata() {
        Ok(found) if found.is_dir() => std::fs::read_dir(folder).map_err(cannot)?.next().is_some(),
        Ok(_) => true,
        Err(_) => false,
    };
    if occupied && std::fs::read_to_string(&manifest).ok().as_deref() != Some(&ours) {
        return Err(ExportError::Foreign { folder: folder.to_owned(), format: format.name() });
    }
    std::fs::create_dir_all(folder).map_err(cannot)?;
    Ok(write_whole(&manifest, ours.as_bytes())?)
}

/// The same for the same run, however far it has come. A run is known by what began it, not by its path, which may move.
fn manifest_text(run: &RunData, format: Format) -> String {
    let manifest = serde_json::json!({
        "format": format.name(),
        "scene": run.scene.name,
        "seed": run.scene.seed,
        "first_started_unix_s": run.sessions.first().map(|s| s.started_unix_s),
        "units": "SI, radians; times in .pvd files in Myr",
    });
    format!("{manifest:#}\n")
}

/// Writes files into the folder and remembers their names.
struct Writer<'a> {
    folder: &'a Path,
    files: Vec<String>,
}

impl Writer<'_> {
    fn write(&mut self, name: String, bytes: &[u8]) -> Result<(), WriteError> {
        write_whole(&self.folder.join(&name), bytes)?;
        self.files.push(name);
        Ok(())
    }
}

fn write_csv(run: &RunData, writer: &mut Writer) -> Result<(), ExportError> {
    for table in tables(run) {
        writer.write(format!("{}.csv", table.name), table.csv().as_bytes())?;
    }
    let spheres = writer.folder.join("spheres");
    std::fs::create_dir_all(&spheres).map_err(|source| WriteError { file: spheres, source })?;
    for c in &run.configurations {
        let mut aggregate = pkd::Spheres::default();
        for (position, sphere) in RunData::body_positions(c).into_iter().zip(&c.sphere_ids) {
            let row = *sphere as usize;
            aggregate.push(position, [0.0; 3], [0.0; 3], run.sphere_mass_kg[row], run.sphere_radius_m[row]);
        }
        writer.write(format!("spheres/{:04}.csv", c.configuration), aggregate_csv(&aggregate).as_bytes())?;
    }
    Ok(())
}

fn write_vtk(run: &RunData, writer: &mut Writer) -> Result<(), ExportError> {
    let names = ["spheres", "tiling"].map(|kind| move |number: u32| format!("{kind}_{number:04}.vtp"));
    for c in &run.configurations {
        writer.write(names[0](c.configuration), &paraview::spheres(run, c))?;
        writer.write(names[1](c.configuration), &paraview::tiling(run, c))?;
    }
    writer.write("spheres.pvd".into(), paraview::collection(run, names[0]).as_bytes())?;
    writer.write("tiling.pvd".into(), paraview::collection(run, names[1]).as_bytes())?;
    Ok(())
}

fn body_obj(run: &RunData, c: &ConfigurationRecord) -> String {
    let facets = run.tiling.as_ref().map_or(Vec::new(), |t| t.facets.clone());
    tiling::obj::write(&Mesh { vertices: RunData::body_vertices(c), facets }, "unit: m")
}
