//! `yorp export`: what a run has recorded, as files for other programs.

use std::path::PathBuf;

use serde_json::json;

use super::{CliError, output};
use crate::export::{Format, export};
use crate::report::RunData;
use crate::store::run_directory;

/// Arguments of `yorp export`.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The run directory
    #[arg(value_name = "DIR")]
    run: PathBuf,
    /// What to write
    #[arg(long, value_enum)]
    format: FormatName,
    /// Where to: a folder that is not there, empty, or an earlier export of this run [default: DIR/export/FORMAT]
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum FormatName {
    /// Tables, and the spheres of each configuration as an aggregate
    Csv,
    /// Spheres and tiling of each configuration as a time series for ParaView
    Vtk,
    /// The tiling of each configuration
    Obj,
    /// All tables and shapes as numpy arrays in one file
    Npz,
}

impl FormatName {
    fn format(self) -> Format {
        match self {
            Self::Csv => Format::Csv,
            Self::Vtk => Format::Vtk,
            Self::Obj => Format::Obj,
            Self::Npz => Format::Npz,
        }
    }
}

pub(super) fn run(arguments: &Arguments, as_json: bool) -> Result<(), CliError> {
    let format = arguments.format.format();
    let directory = run_directory(&arguments.run);
    let folder = arguments.out.clone().unwrap_or_else(|| directory.join("export").join(format.name()));
    let run = RunData::read(&directory)?;
    let files = export(&run, &folder, format)?;
    match as_json {
        true => output::json(&json!({"out": folder.display().to_string(), "format": format.name(), "files": files})),
        false => output::text(&format!("{} files in {}\n", files.len(), folder.display())),
    }
}
