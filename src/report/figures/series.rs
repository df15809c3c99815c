//! How a run is told from others in a figure of several.

use super::palette::{BLUE, Colour, distinct};
use super::plot::{Kind, LegendEntry, Mark};
use crate::report::RunData;

/// Intervals that statistics take at least, closed by movements, over all runs drawn.
pub(super) const FEWEST_INTERVALS: usize = 5;

/// Why statistics of `runs` would say nothing yet; `None` where there are intervals enough.
pub(super) fn too_short(runs: &[RunData]) -> Option<String> {
    let closed: usize = runs.iter().map(|run| run.intervals.len()).sum();
    (closed < FEWEST_INTERVALS).then(|| {
        format!(
            "too short to say: {closed} of the {FEWEST_INTERVALS} intervals closed by movements that statistics take"
        )
    })
}

/// Longest name in a legend, characters.
const LONGEST_NAME: usize = 28;

/// Colour, line and mark of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RunStyle {
    pub(super) colour: Colour,
    pub(super) mark: Mark,
    /// As in the paper's figures: solid where the body has lost mass.
    solid: bool,
}

impl RunStyle {
    /// Of the `index`th run: colours come again after six runs, with another mark.
    pub(super) fn of(index: usize, run: &RunData) -> Self {
        const MARKS: [Mark; 4] = [Mark::Disc, Mark::Triangle, Mark::Diamond, Mark::Square];
        let shed = run.accepted_legs().any(|leg| leg.shed > 0);
        Self { colour: distinct(index), mark: MARKS[index / 6 % 4], solid: shed }
    }

    /// A run alone.
    pub(super) fn alone() -> Self {
        Self { colour: BLUE, mark: Mark::Disc, solid: true }
    }

    /// Its line.
    pub(super) fn line(&self, width: f64) -> Kind {
        if self.solid { Kind::Line(width) } else { Kind::Dashed(width) }
    }
}

/// The runs' names; none where there is only one run.
pub(super) fn legend(drawn: &[(&RunData, Kind, Colour)], runs: usize) -> Vec<LegendEntry> {
    let entry = |(run, kind, colour): &(&RunData, Kind, Colour)| LegendEntry {
        label: short_name(run),
        kind: *kind,
        colour: *colour,
    };
    if runs > 1 { drawn.iter().map(entry).collect() } else { Vec::new() }
}

fn short_name(run: &RunData) -> String {
    let name = match &run.scene.name[..] {
        "" => run.directory.file_name().map_or("without a name".into(), |name| name.to_string_lossy()),
        name => name.into(),
    };
    match name.char_indices().nth(LONGEST_NAME) {
        Some((end, _)) => format!("{}…", &name[..end]),
        None => name.into_owned(),
    }
}
