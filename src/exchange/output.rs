//! Files that commands write: in the format that their name ends in, whole or not at all, and never over what is not
//! theirs.

use std::fs::{File, OpenOptions};
use std::io::{Read as _, Write as _};
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

/// Why a file named by the user is not written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RefusedOutput {
    /// The command reads it.
    #[error("{}: is an input of this command and would be lost; choose another name", .0.display())]
    Input(PathBuf),
    /// A folder has this name.
    #[error("{}: is a folder; the name of a file is needed", .0.display())]
    Folder(PathBuf),
    /// There is no folder for it.
    #[error("{}: the folder that it would go into does not exist", .0.display())]
    NoFolder(PathBuf),
    /// A file of somebody else has its place.
    #[error("{}: was not written by yorp and would be lost; choose another folder", .0.display())]
    Foreign(PathBuf),
}

/// Refuses to write `file` over one of `inputs`, over a folder, or into a folder that is not there.
///
/// To be asked before the work whose result goes there. Any other file of that name is meant to be replaced.
///
/// # Errors
/// [`RefusedOutput`] with the name.
pub fn check_output(file: &Path, inputs: &[&Path]) -> Result<(), RefusedOutput> {
    if file.is_dir() {
        return Err(RefusedOutput::Folder(file.to_owned()));
    }
    if !folder_of(file).is_dir() {
        return Err(RefusedOutput::NoFolder(file.to_owned()));
    }
    // Links, `..` and other spellings of one file have one canonical path.
    let place = |path: &Path| path.canonicalize().ok();
    let here = place(file);
    match here.is_some() && inputs.iter().any(|input| place(input) == here) {
        true => Err(RefusedOutput::Input(file.to_owned())),
        false => Ok(()),
    }
}

/// What stands in the head of every page that this program writes.
pub const GENERATOR: &str = "<meta name=\"generator\" content=\"yorp";

/// Refuses to write `page` and the `others` beside it over files of somebody else.
///
/// A page is known by [`GENERATOR`] in its first 4 KiB. Where it is, the files and folders beside it came with it; where
/// there is none, none of them may be there either.
///
/// # Errors
/// [`RefusedOutput::Foreign`] with the first file in the way.
pub fn check_page(page: &Path, others: impl IntoIterator<Item = PathBuf>) -> Result<(), RefusedOutput> {
    // An empty folder holds nothing of anybody.
    let is_empty = |file: &Path| std::fs::read_dir(file).is_ok_and(|mut inside| inside.next().is_none());
    let is_there = |file: &Path| file.symlink_metadata().is_ok() && !is_empty(file);
    let in_the_way = if is_there(page) {
        (!is_own_page(page)).then(|| page.to_owned())
    } else {
        others.into_iter().find(|file| is_there(file))
    };
    in_the_way.map_or(Ok(()), |file| Err(RefusedOutput::Foreign(file)))
}

fn is_own_page(page: &Path) -> bool {
    let mut head = Vec::new();
    // What cannot be read is not known to be ours; a pipe would keep us waiting.
    page.is_file()
        && File::open(page).and_then(|file| file.take(4096).read_to_end(&mut head)).is_ok()
        && String::from_utf8_lossy(&head).contains(GENERATOR)
}

/// The folder that `file` is in.
pub(crate) fn folder_of(file: &Path) -> &Path {
    match file.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// Writes a whole file or nothing: beside it first, so that a full disk leaves no half file and no lost one.
///
/// A link of that name is replaced, what it points to stays. Into a pipe or a device the bytes go as they are. A file that
/// is protected against writing stays as it is.
pub(crate) fn write_whole(file: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    write_aside(file, bytes, false)
}

/// The same, and on disk when it returns.
pub(crate) fn write_durably(file: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    write_aside(file, bytes, true)
}

fn write_aside(file: &Path, bytes: &[u8], durable: bool) -> Result<(), WriteError> {
    let write = || {
        match file.metadata() {
            Ok(found) if found.is_file() && found.permissions().readonly() => {
                return Err(std::io::ErrorKind::PermissionDenied.into());
            }
            Ok(found) if !found.is_file() && !found.is_dir() => {
                return OpenOptions::new().write(true).open(file)?.write_all(bytes);
            }
            _ => {}
        }
        // A name of its own: one that is already there may be somebody's.
        let mut builder = tempfile::Builder::new();
        builder.prefix(".yorp-").suffix(".partial");
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let mut aside = builder.tempfile_in(folder_of(file))?;
        aside.write_all(bytes)?;
        if durable {
            aside.as_file().sync_all()?;
        }
        aside.persist(file).map_err(|refused| refused.error)?;
        if durable {
            sync_folder(folder_of(file));
        }
        Ok(())
    };
    write().map_err(|source| WriteError { file: file.to_owned(), source })
}

/// Brings the names in a folder to disk, where the system has a way to.
pub(crate) fn sync_folder(folder: &Path) {
    // The file is there already; only a power failure within seconds could undo that.
    if cfg!(unix) {
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
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
