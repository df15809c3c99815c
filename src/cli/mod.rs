//! The command line: parses arguments, calls the library, prints.
//!
//! Results go to stdout, at the end and only on success; everything else goes to stderr.

mod accuracy;
mod arguments;
mod build;
mod classify;
pub mod error;
mod export;
mod guard;
mod help;
mod output;
mod plan;
mod progress;
mod relax;
mod report;
mod rigid;
mod run;
mod schema;
mod sunlit_mesh;
mod tile;
mod torque;
mod track;

use clap::{Parser, Subcommand};

pub use error::{CliError, Failure};

use crate::exchange::expand_argument;

/// Coupled spin and shape evolution of rubble-pile asteroids under sunlight.
#[derive(Debug, Parser)]
#[command(name = "yorp", version = crate::VERSION, arg_required_else_help = true)]
struct Cli {
    /// Worker threads; results do not depend on it [default: RAYON_NUM_THREADS, else all cores]
    #[arg(long, global = true, help_heading = "Global options", value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    threads: Option<u16>,
    /// Print exactly one JSON object on stdout
    #[arg(long, global = true, help_heading = "Global options")]
    json: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Evolve spin and shape of a scene's body together
    Run(run::Arguments),
    /// Follow the YORP cycle of a body, were it rigid
    Rigid(rigid::Arguments),
    /// Construct and settle the aggregate of a scene, without sunlight
    Build(build::Arguments),
    /// Evolve an aggregate alone at constant angular momentum, without sunlight
    Relax(relax::Arguments),
    /// Show what a scene would run, what is left out, and why
    Plan(plan::Arguments),
    /// Print the JSON Schema of a scene
    Schema,
    /// Fit a triangle surface to an aggregate (CSV)
    Tile(tile::Arguments),
    /// Compute the YORP torques of a shape model at every obliquity
    Torque(torque::Arguments),
    /// Follow shed spheres, or the other half of a fission, around an aggregate
    Track(track::Arguments),
    /// Show what a run recorded as a page that opens from disk
    Report(report::Arguments),
    /// Name the types of spin and obliquity evolution in a run, with its statistics
    Classify(classify::Arguments),
    /// Write what a run has recorded for other programs
    Export(export::Arguments),
    /// Measure error against run time of the numerical knobs
    Accuracy(accuracy::Arguments),
    /// Print the completions of a shell
    Completions(help::Completions),
    /// Write man pages into a folder
    #[command(hide = true)]
    Man(help::Man),
}

const HELP_FOR_LACK_OF_ARGUMENTS: clap::error::ErrorKind =
    clap::error::ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand;

/// Runs the command line of this process; the result is its exit code.
pub fn main() -> u8 {
    let cli = match Cli::try_parse_from(std::env::args_os().map(expand_argument)) {
        Ok(cli) => cli,
        Err(error) => {
            // Help and version are no errors and go to stdout; a closed pipe is no failure.
            if error.kind() == clap::error::ErrorKind::DisplayHelp || error.kind() == HELP_FOR_LACK_OF_ARGUMENTS {
                // Asked again of the command that knows ranges and examples.
                let asked = help::command().try_get_matches();
                let _ = asked.err().unwrap_or(error).print();
                return if std::env::args_os().len() > 1 { 0 } else { Failure::Input as u8 };
            }
            let _ = error.print();
            return if error.use_stderr() { Failure::Input as u8 } else { 0 };
        }
    };
    install_report_style();
    match execute(&cli) {
        Ok(()) => 0,
        Err(error) => {
            eprintln!("{:?}", error.report);
            error.code as u8
        }
    }
}

fn execute(cli: &Cli) -> Result<(), CliError> {
    if let Some(threads) = cli.threads {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into());
        pool.build_global().map_err(CliError::input)?;
    }
    pkd::simd::Level::asked().map_err(CliError::input)?;
    match &cli.command {
        Command::Run(arguments) => run::run(arguments, cli.json),
        Command::Rigid(arguments) => rigid::run(arguments, cli.json),
        Command::Build(arguments) => build::run(arguments, cli.json),
        Command::Relax(arguments) => relax::run(arguments, cli.json),
        Command::Plan(arguments) => plan::run(arguments, cli.json),
        Command::Schema => schema::run(),
        Command::Tile(arguments) => tile::run(arguments, cli.json),
        Command::Torque(arguments) => torque::run(arguments, cli.json),
        Command::Track(arguments) => track::run(arguments, cli.json),
        Command::Report(arguments) => report::run(arguments, cli.json),
        Command::Classify(arguments) => classify::run(arguments, cli.json),
        Command::Export(arguments) => export::run(arguments, cli.json),
        Command::Accuracy(arguments) => accuracy::run(arguments, cli.json),
        Command::Completions(arguments) => help::completions(arguments),
        Command::Man(arguments) => help::man(arguments),
    }
}

/// Reports keep every message on one line, so that a path or a range in it can be searched for.
fn install_report_style() {
    let style = |_: &_| -> Box<dyn miette::ReportHandler> {
        Box::new(miette::MietteHandlerOpts::new().wrap_lines(false).break_words(false).build())
    };
    miette::set_hook(Box::new(style)).expect("installed once, before any report");
}
