//! Files that other programs read and write: aggregates as CSV and VTK, meshes as OBJ and VTK and read from
//! other formats, curves as CSV.

mod aggregate_file;
pub mod csv;
mod mesh;
mod output;
mod table;
pub mod vtk;

pub use aggregate_file::{AggregateFileError, MAX_AGGREGATE_BYTES, read_aggregate};
pub use mesh::{AssemblyFault, MAX_MESH_BYTES, MeshFile, MeshFileError, MeshFileFormat, read_mesh};
pub(crate) use output::write_whole;
pub use output::{AggregateFormat, MeshFormat, UnknownFormat, WriteError, write_aggregate, write_mesh};
pub use table::{check_table_name, write_table};
