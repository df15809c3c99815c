//! What `--help`, completions and man pages say besides the arguments: allowed ranges, an example and the next step.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{Command, CommandFactory};
use clap_complete::Shell;

use super::{Cli, CliError, output};
use crate::accuracy;
use crate::exchange::WriteError;

/// Arguments of `yorp completions`.
#[derive(Debug, clap::Args)]
pub(super) struct Completions {
    /// The shell
    shell: Shell,
}

/// Arguments of `yorp man`.
#[derive(Debug, clap::Args)]
pub(super) struct Man {
    /// An existing folder
    folder: PathBuf,
}

/// Prints the completions of a shell.
pub(super) fn completions(arguments: &Completions) -> Result<(), CliError> {
    let mut text = Vec::new();
    clap_complete::generate(arguments.shell, &mut Cli::command(), "yorp", &mut text);
    output::text(&String::from_utf8_lossy(&text))
}

/// Writes a man page for each verb into a folder.
pub(super) fn man(arguments: &Man) -> Result<(), CliError> {
    let failed = |source| CliError::write(WriteError { file: arguments.folder.clone(), source });
    clap_mangen::generate_to(command(), &arguments.folder).map_err(failed)
}

/// Verb, an example, and what follows.
const EXAMPLES: [(&str, &str, &str); 15] = [
    ("run", "yorp run scenarios/quickstart.json --out out/quickstart", "yorp report out/quickstart"),
    (
        "rigid",
        "yorp rigid bennu.obj --density-kg-m3 1190 --period-h 4.3 --obliquity-deg 178",
        "yorp run SCENE --out DIR, where it may move",
    ),
    (
        "build",
        "yorp build scenarios/quickstart.json --out body.csv",
        "yorp relax body.csv --rotations 5, yorp tile body.csv --out body.obj",
    ),
    (
        "relax",
        "yorp relax body.csv --contact soft --preset gravel --period-h 5 --rotations 10 --out later.csv",
        "yorp tile later.csv --out later.obj",
    ),
    ("plan", "yorp plan scenarios/quickstart.json", "yorp run scenarios/quickstart.json --out out/quickstart"),
    (
        "schema",
        "yorp schema > scene.schema.json",
        "\"$schema\": \"scene.schema.json\" in a scene, for an editor that knows JSON Schema",
    ),
    ("tile", "yorp tile body.csv --out body.obj", "yorp torque body.obj --density-kg-m3 1700"),
    (
        "torque",
        "yorp torque bennu.obj --density-kg-m3 1190 --orbit-au 1.126 --period-h 4.296 --out curve.csv",
        "yorp rigid bennu.obj --density-kg-m3 1190",
    ),
    (
        "track",
        "yorp track body.csv --shed shed.csv --t-max-days 30",
        "\"shed\": {\"track\": {\"rebound\": {}}} in a scene, to follow what a run sheds",
    ),
    ("report", "yorp report out/quickstart", "open out/quickstart/report/index.html"),
    ("classify", "yorp classify out/quickstart", "yorp report out/quickstart"),
    ("export", "yorp export out/quickstart --format npz --out quickstart.npz", "numpy.load(\"quickstart.npz\")"),
    ("accuracy", "yorp accuracy taco --quick --out accuracy", "open accuracy/accuracy.html"),
    ("completions", "yorp completions bash > ~/.local/share/bash-completion/completions/yorp", "a new shell"),
    ("man", "yorp man ~/.local/share/man/man1", "man yorp-run"),
];

/// The command line with ranges and examples in its help.
///
/// Ranges are asked from the parsers of the values themselves, by giving them a word that is no number, so that help and
/// refusals cannot differ. That costs some milliseconds, so it is done where somebody asks for help only.
pub(super) fn command() -> Command {
    let mut command = Cli::command().after_help(after_help(
        "yorp run scenarios/quickstart.json --out out/quickstart",
        "yorp report out/quickstart, and yorp VERB --help for what each verb takes",
    ));
    for (verb, example, next) in EXAMPLES {
        command = command.mut_subcommand(verb, |verb| verb.after_help(after_help(example, next)));
    }
    let parts: Vec<&str> = accuracy::names();
    let parts = format!("Only this knob, or the knobs of this module [parts: {}]", parts.join(", "));
    command = command.mut_subcommand("accuracy", |verb| verb.mut_arg("part", |part| part.help(parts)));
    let verbs: Vec<String> = command.get_subcommands().map(|verb| verb.get_name().to_owned()).collect();
    for verb in verbs {
        command = command.mut_subcommand(&verb, |of| {
            of.mut_args(|argument| match argument.get_long().and_then(|flag| allowed(&verb, flag)) {
                Some(range) => {
                    let help = argument.get_help().map(ToString::to_string).unwrap_or_default();
                    argument.help(format!("{help} [allowed: {range}]"))
                }
                None => argument,
            })
        });
    }
    command
}

fn after_help(example: &str, next: &str) -> String {
    format!("Example:\n  {example}\nNext:\n  {next}")
}

/// What the refusal of a word says is allowed as the value of a flag; `None` where it names no range.
fn allowed(verb: &str, flag: &str) -> Option<String> {
    let words = ["yorp", verb, &format!("--{flag}=?")].map(OsString::from);
    let refusal = Cli::command().try_get_matches_from(words).err()?.to_string();
    let first = refusal.lines().next()?;
    first.contains(flag).then(|| first.split_once("allowed: ").map(|(_, range)| range.to_owned()))?
}
