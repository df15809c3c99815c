//! `yorp plan SCENE`: what would run, what is left out and why.

use std::fmt::Write as _;
use std::path::PathBuf;

use super::{CliError, output};
use crate::scene::{Plan, SceneFile};

/// Arguments of `yorp plan`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The scene
    scene: PathBuf,
}

/// Prints the plan of a scene.
pub fn run(arguments: &Arguments, json: bool) -> Result<(), CliError> {
    let plan = Plan::of(&SceneFile::read(&arguments.scene)?.scene);
    plan.warnings.iter().for_each(|warning| eprintln!("warning: {warning}"));
    if json { output::json(&plan) } else { output::text(&table(&plan)) }
}

fn table(plan: &Plan) -> String {
    let mut text = format!("{}\n", plan.name);
    let width = plan.parts.iter().map(|part| part.name.len()).max().unwrap_or(0);
    for part in &plan.parts {
        let what = part.method.as_deref().unwrap_or("left out");
        let _ = writeln!(text, "  {:width$}  {what} ({})", part.name, part.reason);
    }
    text
}
