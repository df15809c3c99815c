//! Aggregates and meshes into files, in the format that the file's name ends in.

use std::path::{Path, PathBuf};

use pkd::Spheres;
use tiling::Mesh;

use super::csv::aggregate_csv;
use super::vtk::{mesh_vtp, spheres_vtp};

/// A name that ends in no known format.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}: the name must end in one of {}", file.display(), allowed.join(", "))]
pub struct UnknownFormat {
    /// The file.
    pub file: PathBuf,
    /// The endings there are.
    pub allowed: &'static [&'static str],
}

/// A file that could not be written.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot write", file.display())]
pub struct WriteError {
    /// The file.
    pub file: PathBuf,
    /// What the operating system said.
    pub source: std::io::Error,
}

/// How an aggregate is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AggregateFormat {
    /// Comma-separated values, `.csv`; can be read again.
    Csv,
    /// VTK PolyData, `.vtp`.
    Vtp,
}

/// How a mesh is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshFormat {
    /// Wavefront, `.obj`; can be read again.
    Obj,
    /// VTK PolyData, `.vtp`.
    Vtp,
}

impl AggregateFormat {
    /// The format of a file's name, upper or lower case.
    ///
    /// # Errors
    /// If the name ends in neither `.csv` nor `.vtp`.
    pub fn of(file: &Path) -> Result<Self, UnknownFormat> {
        match ending(file).as_str() {
            "csv" => Ok(Self::Csv),
            "vtp" => Ok(Self::Vtp),
            _ => Err(UnknownFormat { file: file.to_owned(), allowed: &[".csv", ".vtp"] }),
        }
    }
}

impl MeshFormat {
    /// The format of a file's name, upper or lower case.
    ///
    /// # Errors
    /// If the name ends in neither `.obj` nor `.vtp`.
    pub fn of(file: &Path) -> Result<Self, UnknownFormat> {
        match ending(file).as_str() {
            "obj" => Ok(Self::Obj),
            "vtp" => Ok(Self::Vtp),
            _ => Err(UnknownFormat { file: file.to_owned(), allowed: &[".obj", ".vtp"] }),
        }
    }
}

/// Writes an aggregate.
///
/// # Errors
/// [`WriteError`]; a file that was there before is unchanged then.
pub fn write_aggregate(spheres: &Spheres, file: &Path, format: AggregateFormat) -> Result<(), WriteError> {
    let bytes = match format {
        AggregateFormat::Csv => aggregate_csv(spheres).into_bytes(),
        AggregateFormat::Vtp => spheres_vtp(spheres),
    };
    write_whole(file, &bytes)
}

/// Writes a mesh, its coordinates in metres.
///
/// # Errors
/// [`WriteError`]; a file that was there before is unchanged then.
pub fn write_mesh(mesh: &Mesh, file: &Path, format: MeshFormat) -> Result<(), WriteError> {
    let bytes = match format {
        MeshFormat::Obj => tiling::obj::write(mesh, "unit: m").into_bytes(),
        MeshFormat::Vtp => mesh_vtp(mesh),
    };
    write_whole(file, &bytes)
}

pub(super) fn ending(file: &Path) -> String {
    file.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

/// Writes beside the file and renames, so that a full disk leaves no half file and no lost one.
pub(crate) fn write_whole(file: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let mut name = file.file_name().unwrap_or_default().to_owned();
    name.push(".partial");
    let partial = file.with_file_name(name);
    let written = std::fs::write(&partial, bytes).and_then(|()| std::fs::rename(&partial, file));
    written.map_err(|source| {
        // The first failure is the one to report.
        let _ = std::fs::remove_file(&partial);
        WriteError { file: file.to_owned(), source }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::{read_aggregate, read_mesh};

    #[test]
    fn formats_follow_the_ending() {
        assert_eq!(MeshFormat::of(Path::new("a/b.OBJ")), Ok(MeshFormat::Obj));
        assert_eq!(AggregateFormat::of(Path::new("b.vtp")), Ok(AggregateFormat::Vtp));
        let refused = MeshFormat::of(Path::new("b.stl")).unwrap_err();
        assert_eq!(refused.to_string(), "b.stl: the name must end in one of .obj, .vtp");
        assert!(AggregateFormat::of(Path::new("csv")).is_err());
    }

    #[test]
    fn written_files_read_back_and_nothing_else_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let mesh = tiling::fibonacci::unit_sphere(20).unwrap();
        let mut spheres = Spheres::default();
        spheres.push([1.0, 2.0, 3.0], [0.1; 3], [0.2; 3], 4.0, 5.0);
        let (csv, obj) = (folder.path().join("a.csv"), folder.path().join("a.obj"));
        // Twice: a second one replaces the first.
        for _ in 0..2 {
            write_aggregate(&spheres, &csv, AggregateFormat::Csv).unwrap();
            write_mesh(&mesh, &obj, MeshFormat::Obj).unwrap();
        }
        assert_eq!(read_aggregate(&csv).unwrap(), spheres);
        assert_eq!(read_mesh(&obj, 1.0).unwrap().mesh, mesh);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[test]
    fn unwritable_places_and_unreadable_files_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let nowhere = folder.path().join("missing/a.csv");
        let fault = write_aggregate(&Spheres::default(), &nowhere, AggregateFormat::Csv).unwrap_err();
        assert_eq!(fault.file, nowhere);
        assert!(read_aggregate(&nowhere).unwrap_err().to_string().contains("missing"));
        // A folder of that name can be neither written nor read, and stays.
        let taken = folder.path().join("taken.csv");
        std::fs::create_dir(&taken).unwrap();
        assert!(write_aggregate(&Spheres::default(), &taken, AggregateFormat::Csv).is_err());
        assert!(read_aggregate(&taken).is_err());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
