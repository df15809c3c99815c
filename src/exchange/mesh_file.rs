//! Shape models in OBJ files: read, scaled to metres, and refused unless they bound a body.

use std::io::Read as _;
use std::path::{Path, PathBuf};

use tiling::{Mesh, TilingError};

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
    /// The file is no mesh, or the mesh does not bound a body.
    #[error("{}: no mesh of a body", file.display())]
    Mesh {
        /// The file.
        file: PathBuf,
        /// What is wrong, with line or facets.
        source: TilingError,
    },
}

/// The closed, outward-oriented mesh in an OBJ file, its coordinates multiplied by `metres_per_unit`.
///
/// # Errors
/// [`MeshFileError`], naming the line that is not understood or the facets at a hole, a fold, a contact or without area.
pub fn read_mesh(file: &Path, metres_per_unit: f64) -> Result<Mesh, MeshFileError> {
    let unreadable = |source| MeshFileError::Read { file: file.to_owned(), source };
    let mut bytes = Vec::new();
    let open = std::fs::File::open(file).map_err(unreadable)?;
    open.take(MAX_MESH_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > MAX_MESH_BYTES {
        return Err(MeshFileError::TooLarge { file: file.to_owned(), limit: MAX_MESH_BYTES });
    }
    let refused = |source| MeshFileError::Mesh { file: file.to_owned(), source };
    let mesh = tiling::obj::read(&bytes).map_err(refused)?.scaled(metres_per_unit);
    mesh.check().map_err(refused)?;
    mesh.check_contact().map_err(refused)?;
    Ok(mesh)
}
