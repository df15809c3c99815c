//! `yorp classify`: the types of spin and obliquity evolution in a run, and its statistics.

use std::fmt::Write as _;
use std::path::PathBuf;

use super::{CliError, output};
use crate::classify::{Fates, RunClassification, Verdict, classify_run};
use crate::store::run_directory;

/// Arguments of `yorp classify`.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The run directory; a run in it may go on
    directory: PathBuf,
}

pub(super) fn run(arguments: &Arguments, as_json: bool) -> Result<(), CliError> {
    let found = classify_run(&run_directory(&arguments.directory))?;
    if as_json { output::json(&found) } else { output::text(&as_text(&found)) }
}

fn as_text(found: &RunClassification) -> String {
    let mut text = String::new();
    let end = match (found.stage, found.outcome) {
        (_, Some(outcome)) => outcome.replace('_', " "),
        (Some("evolving"), None) => "goes on or was killed".to_owned(),
        (stage, None) => format!("no further than {}", stage.unwrap_or("started")),
    };
    let _ = writeln!(text, "{}: {:.4} Myr, {end}", found.name, found.t_myr);
    for (name, verdict) in [("spin", &found.spin), ("obliquity", &found.obliquity)] {
        show(&mut text, name, verdict);
    }
    if let Some(a) = found.aggregate {
        let rigid = found.rigid.map_or(String::new(), |r| match r.max_spin_rev_day {
            Some(max) => format!("; were it rigid: to {max:.2}, ends at {:.1} deg", r.end_obliquity_deg),
            None => format!("; were it rigid: for ever, at {:.1} deg", r.end_obliquity_deg),
        });
        let _ = writeln!(
            text,
            "\nspin       {:.2} rev/day, from {:.2} to {:.2}, now {:.2}{rigid}",
            a.initial_spin_rev_day, a.min_spin_rev_day, a.max_spin_rev_day, a.end_spin_rev_day
        );
        let _ = writeln!(text, "obliquity  {:.2} deg, now {:.2}", a.initial_obliquity_deg, a.end_obliquity_deg);
    }
    let walk = &found.walk;
    if let (Some(median), Some(smallest), Some(largest)) =
        (walk.length_myr.median, walk.length_myr.smallest, walk.length_myr.largest)
    {
        let [median, smallest, largest] = [median, smallest, largest].map(|myr| 1000.0 * myr);
        let count = walk.length_myr.count;
        let _ = writeln!(text, "intervals  {count}, median {median:.1} kyr, {smallest:.1} to {largest:.1} kyr");
    }
    let share = |share: Option<f64>| share.map_or("-".to_owned(), |s| format!("{:.0} %", 100.0 * s));
    if walk.spin_persistence.is_some() {
        let (spin, obliquity) = (share(walk.spin_persistence), share(walk.obliquity_persistence));
        let _ = writeln!(text, "go on      {spin} in spin, {obliquity} in obliquity, of the intervals");
    }
    let movements = &found.movements;
    if movements.count > 0 {
        let (inner, outer) = (share(movements.inner_half), share(movements.outer_tenth));
        let (count, spheres) = (movements.count, movements.spheres_moved);
        let _ = writeln!(
            text,
            "movements  {count} of {spheres} spheres, {inner} in the inner half, {outer} in the outer tenth"
        );
    }
    let losses = &found.losses;
    if !losses.events.is_empty() {
        let _ = writeln!(text, "mass loss  {:.2} % in {} events", losses.mass_percent, losses.event_mass_percent.count);
        for event in &losses.events {
            let below = if event.below_jacobi { "below" } else { "above" };
            let _ = writeln!(
                text,
                "  {:8.4} Myr  {:.2} %{} at {:.2} rev/day, {:.0} kg/m^3, b/a {:.2}, c/a {:.2}, {below} the Jacobi sequence",
                event.t_myr,
                event.mass_percent,
                if event.breakup { " (break-up)" } else { "" },
                event.spin_rev_day,
                event.density_kg_m3,
                event.b_over_a,
                event.c_over_a
            );
        }
    }
    let Fates { reimpact, escape, bound, merged } = losses.fates;
    if reimpact + escape + bound + merged > 0 {
        let _ = writeln!(text, "followed   {escape} escaped, {reimpact} fell back, {bound} in orbit, {merged} merged");
    }
    if let (Some(start), Some(end)) = (found.shape.start, found.shape.end) {
        let (from, to) = (start.half_extents, end.half_extents);
        let _ = writeln!(
            text,
            "shape      b/a {:.3} to {:.3}, c/a {:.3} to {:.3} (half extents)",
            from.b_over_a, to.b_over_a, from.c_over_a, to.c_over_a
        );
    }
    text
}

fn show(text: &mut String, name: &str, verdict: &Verdict) {
    let label = if verdict.label.is_empty() { "nothing to classify yet" } else { &verdict.label };
    let turns = match verdict.reversals {
        1 => "1 reversal".to_owned(),
        n => format!("{n} reversals"),
    };
    let _ = writeln!(text, "\n{name:<10} {label}  ({turns})");
    for stretch in &verdict.stretches {
        let kind = stretch.kind.name();
        let _ = writeln!(text, "  {:8.4} to {:8.4} Myr  {kind:<3}  {}", stretch.from_myr, stretch.to_myr, stretch.why);
    }
}
