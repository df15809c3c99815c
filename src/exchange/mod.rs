//! Files that other programs read and write.

mod mesh_file;

pub use mesh_file::{MAX_MESH_BYTES, MeshFileError, read_mesh};
