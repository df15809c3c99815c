//! `yorp schema`: the JSON Schema of a scene.

use super::{CliError, output};
use crate::scene::json_schema;

/// Prints the schema, indented, for people and programs alike.
pub fn run() -> Result<(), CliError> {
    output::text(&format!("{:#}\n", json_schema()))
}
