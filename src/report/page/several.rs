//! The table of a page on several runs: where each of them stands.

use super::html::{Align, Html, table};
use crate::classify::{Criteria, classify};
use crate::evolve::driver::MYR_S;
use crate::report::RunData;

/// One row for each run.
pub fn runs(runs: &[RunData]) -> Html {
    let columns = [
        ("run", Align::Text),
        ("directory", Align::Text),
        ("Myr", Align::Number),
        ("period, h", Align::Number),
        ("obliquity, deg", Align::Number),
        ("movements", Align::Number),
        ("mass shed, %", Align::Number),
        ("spin", Align::Text),
        ("obliquity", Align::Text),
        ("ended", Align::Text),
    ];
    table("the runs", &columns, runs.iter().map(|run| ("", row(run))))
}

fn row(run: &RunData) -> Vec<Html> {
    let now = run.ending.map(|e| [e.t_s, e.omega, e.obliquity]);
    let now = now.or(run.state.as_ref().map(|s| [s.t_s, s.omega, s.obliquity]));
    let number = |of: &dyn Fn([f64; 3]) -> Option<String>| now.and_then(of).unwrap_or("–".to_owned());
    let types = classify(run, &Criteria::default());
    let [spin, obliquity] = match &types {
        Ok(found) => [found.spin.label.clone(), found.obliquity.label.clone()],
        Err(_) => ["–".to_owned(), "–".to_owned()],
    };
    let cells = [
        run.scene.name.clone(),
        run.directory.display().to_string(),
        number(&|[t, ..]| Some(format!("{:.4}", t / MYR_S))),
        number(&|[_, omega, _]| RunData::period_h(omega).map(|p| format!("{p:.3}"))),
        number(&|[_, _, obliquity]| Some(format!("{:.2}", obliquity.to_degrees()))),
        run.totals.movements.to_string(),
        format!("{:.3}", 100.0 * run.totals.shed_mass_fraction),
        spin,
        obliquity,
        run.ending.map_or("goes on", |ending| ending.outcome.name()).to_owned(),
    ];
    cells.map(Html::from).to_vec()
}
