//! `yorp run`: the coupled evolution of a scene in a run directory.

use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};

use super::progress::{Leaves, Reporter};
use super::{CliError, output};
use crate::evolve::Observer as _;
use crate::evolve::driver::{MYR_S, Summary, run as evolve};
use crate::report::page::part_error;
use crate::scene::{CYCLE_END_PERIOD_H, Scene, SceneFile};
use crate::store::{Outcome, Part, RunReader, Totals, database_path, run_directory, scene_of_torn_copy};

/// Arguments of `yorp run`.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct Arguments {
    /// The scene file
    scene: PathBuf,
    /// The run directory: absent or without a run, unless --resume is given
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Continue the run in the directory; starts one if there is none
    #[arg(long)]
    resume: bool,
    /// Stop at this time, Myr; 0 builds and settles only [default: evolution.duration_myr]
    #[arg(long, value_name = "T", value_parser = super::arguments::until_myr)]
    until_myr: Option<f64>,
}

pub(super) fn run(arguments: &Arguments, as_json: bool) -> Result<(), CliError> {
    let directory = run_directory(&arguments.out);
    let scene = scene_of(arguments, &directory)?;
    let mut reporter = Reporter::start(Leaves::Run)?;
    let duration_myr = scene.scene.evolution.duration_myr;
    if let Some(until_myr) = arguments.until_myr.filter(|until| *until > duration_myr) {
        reporter.warn(&format!(
            "--until-myr {until_myr} is beyond evolution.duration_myr = {duration_myr}, at which the run ends"
        ));
    }
    let result = evolve(&scene, &directory, arguments.resume, arguments.until_myr, &mut reporter);
    drop(reporter);
    let summary = result?;
    if ended_its_cycle(&summary, &scene.scene) {
        let stop = scene.scene.evolution.stop_period_h.map_or("null".to_owned(), |period| format!("{period} h"));
        eprintln!(
            "warning: the body counts as spun down beyond a period of {CYCLE_END_PERIOD_H} h, the end of its YORP cycle, though \
             evolution.stop_period_h is {stop}"
        );
    }
    if as_json { output::json(&as_value(&summary)) } else { output::text(&as_text(&summary, &directory)) }
}

/// The scene to run. One that is resumed needs neither the files that its body was made of nor, where the scene given is
/// the run's own copy, that copy whole: the database holds both.
fn scene_of(arguments: &Arguments, directory: &Path) -> Result<SceneFile, CliError> {
    let file = &arguments.scene;
    if !arguments.resume {
        return Ok(SceneFile::read(file)?);
    }
    let is_built = || RunReader::open(directory).is_ok_and(|run| run.state().is_ok_and(|state| state.is_some()));
    match SceneFile::read_alone(file) {
        Ok((scene, _)) if is_built() => Ok(scene),
        Ok((scene, text)) => {
            scene.look_for_files(&text)?;
            Ok(scene)
        }
        Err(error) => match scene_of_torn_copy(file, directory) {
            Some(scene) => {
                eprintln!("warning: {}: cut off; going on with the scene that the database holds", file.display());
                Ok(SceneFile { scene, file: file.clone() })
            }
            None => Err(error.into()),
        },
    }
}

/// Whether the run ended as spun down by the limit of every run, not by that of its scene.
fn ended_its_cycle(summary: &Summary, scene: &Scene) -> bool {
    let own = scene.evolution.stop_period_h.is_some_and(|period| period <= CYCLE_END_PERIOD_H);
    summary.ending.outcome == Outcome::SpunDown && !own
}

fn period_h(summary: &Summary) -> Option<f64> {
    (summary.ending.omega > 0.0).then(|| std::f64::consts::TAU / summary.ending.omega / 3600.0)
}

fn as_value(summary: &Summary) -> Value {
    let totals = &summary.totals;
    let parts: Map<_, _> = totals
        .parts
        .iter()
        .map(|(part, total)| {
            let mut entry = json!({"seconds": total.seconds, "cpu_seconds": total.cpu_seconds, "count": total.count});
            match part {
                Part::Check | Part::Movement => {
                    entry["error"] = json!({
                        "momentum_drift": totals.momentum_drift,
                        "angular_momentum_drift": totals.angular_momentum_drift,
                        "max_overlap_over_radius": totals.max_overlap_radii,
                    });
                }
                Part::Torque => {
                    entry["error"] = match totals.torque_error {
                        Some((spin, obliquity)) => {
                            json!({"spin_torque_n_m": spin, "obliquity_torque_n_m": obliquity})
                        }
                        None => Value::Null,
                    };
                }
                Part::Spin => entry["error"] = json!({"spin_rate_relative": totals.spin_error}),
                Part::Tiling => entry["error"] = json!({"vertices_flagged": totals.vertices_flagged}),
                Part::Build | Part::Settle | Part::Store => {}
            }
            (part.name().to_owned(), entry)
        })
        .collect();
    json!({
        "t_myr": summary.ending.t_s / MYR_S,
        "period_h": period_h(summary),
        "obliquity_deg": summary.ending.obliquity.to_degrees(),
        "legs": summary.legs,
        "intervals": totals.intervals,
        "movements": totals.movements,
        "shed_mass_fraction": totals.shed_mass_fraction,
        "outcome": summary.ending.outcome.name(),
        "normal_stiffness_n_m": summary.normal_stiffness_n_m,
        "angular_momentum": angular_momentum(totals),
        "seconds": totals.seconds,
        "cpu_seconds": totals.cpu_seconds,
        "parts": parts,
    })
}

/// The budget of the whole run from object 0 on, kg m^2/s, and what it and the worst leg are off by.
fn angular_momentum(totals: &Totals) -> Value {
    let books = totals.angular_momentum;
    json!({
        "start_kg_m2_s": books.start,
        "torque_kg_m2_s": books.torque,
        "shed_kg_m2_s": books.shed,
        "now_kg_m2_s": books.end,
        "error": books.error(),
        "largest_leg_error": totals.angular_momentum_error,
    })
}

fn as_text(summary: &Summary, directory: &Path) -> String {
    use std::fmt::Write as _;
    let (ending, totals) = (&summary.ending, &summary.totals);
    let mut text = String::new();
    let period = period_h(summary).map_or("none".to_owned(), |p| format!("{p:.4} h"));
    let _ = writeln!(
        text,
        "{:.4} Myr, outcome {}: period {period}, obliquity {:.2} deg",
        ending.t_s / MYR_S,
        ending.outcome.name(),
        ending.obliquity.to_degrees(),
    );
    let _ = writeln!(
        text,
        "{} legs, {} movements, {:.2} % of the mass shed, {:.1} s ({:.1} CPU s)",
        summary.legs,
        totals.movements,
        100.0 * totals.shed_mass_fraction,
        totals.seconds,
        totals.cpu_seconds,
    );
    if let Some(stiffness) = summary.normal_stiffness_n_m {
        let _ = writeln!(text, "soft contacts with a normal stiffness of {stiffness:.4e} N/m");
    }
    let books = totals.angular_momentum;
    if books.start > 0.0 {
        let percent = |l: f64| 100.0 * l / books.start;
        let _ = writeln!(
            text,
            "angular momentum: {:.6e} kg m^2/s at the start, {:+.3} % by sunlight, {:+.3} % by shed mass; off by {:.0e} in all, \
             {:.0e} in a leg at most",
            books.start,
            percent(books.torque),
            percent(books.shed),
            books.error(),
            totals.angular_momentum_error,
        );
    }
    let _ = writeln!(text, "\n{:<10}{:>12}{:>12}{:>8}  error", "part", "seconds", "CPU s", "count");
    for (part, total) in &totals.parts {
        let error = part_error(*part, totals);
        let _ = writeln!(
            text,
            "{:<10}{:>12.3}{:>12.3}{:>8}  {error}",
            part.name(),
            total.seconds,
            total.cpu_seconds,
            total.count
        );
    }
    let _ = writeln!(
        text,
        "\nrecorded in {}; next: yorp report {}",
        database_path(directory).display(),
        directory.display()
    );
    text
}
