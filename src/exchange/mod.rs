//! Files that other programs read and write: aggregates as CSV and VTK, meshes as OBJ and VTK and read from
//! other formats, curves as CSV.

mod aggregate_file;
pub mod csv;
mod home;
mod mesh;
mod output;
mod table;
pub mod vtk;

pub use aggregate_file::{AggregateFileError, MAX_AGGREGATE_BYTES, read_aggregate};
pub use home::{expand_argument, expand_home};
pub use mesh::{AssemblyFault, MAX_MESH_BYTES, MeshFile, MeshFileError, MeshFileFormat, read_mesh};
pub use output::{
    AggregateFormat, GENERATOR, MeshFormat, RefusedOutput, UnknownFormat, WriteError, check_output, check_page,
    write_aggregate, write_mesh,
};
pub(crate) use output::{folder_of, sync_folder, write_durably, write_whole};
pub use table::{check_table_name, write_table};
