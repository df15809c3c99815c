//! Shape models in files of several formats: read, scaled to metres, and refused unless they bound a body.

mod assemble;
mod format;
mod off;
mod plates;
mod ply;
mod stl;

use std::io::Read as _;
use std::path::{Path, PathBuf};

use tiling::{Mesh, Shells, TilingError};

pub use assemble::AssemblyFault;
pub use format::MeshFileFormat;

/// Largest mesh file, bytes: about ten million facets.
pub const MAX_MESH_BYTES: u64 = 1 << 30;

/// Why a mesh file was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshFileError {
    /// The file cannot be read.
    #[error("{}: cannot read the mesh", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// The file is larger than any mesh that can be worked with.
    #[error("{}: larger than {limit} bytes", file.display())]
    TooLarge {
        /// The file.
        file: PathBuf,
        /// Largest size, bytes.
        limit: u64,
    },
    /// A format that is not read.
    #[error("{}: {problem}; {}", file.display(), format::READ)]
    Format {
        /// The file.
        file: PathBuf,
        /// Which, as far as it is known.
        problem: String,
    },
    /// Text that does not follow its format.
    #[error("{}: not a mesh in {format}", file.display())]
    Text {
        /// The file.
        file: PathBuf,
        /// The format that its name or content says it has.
        format: MeshFileFormat,
        /// What is wrong, with its line where it has lines.
        source: AssemblyFault,
    },
    /// The file is no mesh, or the mesh does not bound a body.
    #[error("{}: no mesh of a body", file.display())]
    Mesh {
        /// The file.
        file: PathBuf,
        /// What is wrong, with line or facets.
        source: TilingError,
    },
}

/// A mesh that bounds a body, as a file had it.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshFile {
    /// The mesh, m, without the vertices that no facet uses.
    pub mesh: Mesh,
    /// Its closed shells.
    pub shells: Shells,
    /// Vertices of the file that no facet uses.
    pub unused_vertices: usize,
}

impl MeshFile {
    /// What a user should know about the mesh, in sentences.
    pub fn remarks(&self) -> Vec<String> {
        let mut remarks = Vec::new();
        match self.unused_vertices {
            0 => {}
            1 => remarks.push("1 vertex that no facet uses is left out".to_owned()),
            n => remarks.push(format!("{n} vertices that no facet uses are left out")),
        }
        let bodies = self.shells.outermost();
        if bodies > 1 {
            remarks.push(format!("the mesh consists of {bodies} bodies apart; they are taken as one rigid body"));
        }
        match self.shells.voids() {
            0 => {}
            1 => remarks.push("1 inner shell is taken as a void".to_owned()),
            n => remarks.push(format!("{n} inner shells are taken as voids")),
        }
        remarks
    }
}

/// The closed, outward-oriented mesh in a file, its coordinates multiplied by `metres_per_unit`.
///
/// Wavefront OBJ, PLY, STL (vertices in the same place become one), OFF and plate tables (PDS `.tab`, ICQ) are read, told
/// apart by their content and, where that leaves a choice, by the ending of the name.
///
/// # Errors
/// [`MeshFileError`], naming the line that is not understood or the facets at a hole, a fold, a contact or without area.
pub fn read_mesh(file: &Path, metres_per_unit: f64) -> Result<MeshFile, MeshFileError> {
    let bytes = bytes_of(file)?;
    let refused = |source| MeshFileError::Mesh { file: file.to_owned(), source };
    let format =
        MeshFileFormat::of(file, &bytes).map_err(|problem| MeshFileError::Format { file: file.to_owned(), problem })?;
    let text = |source| MeshFileError::Text { file: file.to_owned(), format, source };
    let mesh = match format {
        MeshFileFormat::Obj => tiling::obj::read(&bytes).map_err(refused)?,
        MeshFileFormat::Ply => ply::read(&bytes).map_err(text)?,
        MeshFileFormat::Stl => stl::read(&bytes).map_err(text)?,
        MeshFileFormat::Off => off::read(&bytes).map_err(text)?,
        MeshFileFormat::Plates => plates::read(&bytes).map_err(text)?,
    };
    let (mesh, unused_vertices) = mesh.scaled(metres_per_unit).without_unused_vertices();
    let shells = mesh.check_body().map_err(refused)?;
    Ok(MeshFile { mesh, shells, unused_vertices })
}

fn bytes_of(file: &Path) -> Result<Vec<u8>, MeshFileError> {
    let unreadable = |source| MeshFileError::Read { file: file.to_owned(), source };
    let mut bytes = Vec::new();
    let open = std::fs::File::open(file).map_err(unreadable)?;
    open.take(MAX_MESH_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > MAX_MESH_BYTES {
        return Err(MeshFileError::TooLarge { file: file.to_owned(), limit: MAX_MESH_BYTES });
    }
    Ok(bytes)
}
