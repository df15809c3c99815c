//! Where a run stands, in a dozen numbers.

use std::fmt::Write as _;

use super::html::Html;
use crate::evolve::driver::MYR_S;
use crate::report::RunData;
use crate::store::{Outcome, Stage};

/// The list of facts at the head of the page.
pub fn summary(run: &RunData) -> Html {
    let mut text = String::from("<dl class=\"facts\">\n");
    for (name, value, more) in facts(run) {
        let [name, value, more] = [name, &value, &more].map(Html::text);
        let _ = writeln!(text, "<div><dt>{name}</dt><dd>{value}<small>{more}</small></dd></div>");
    }
    text.push_str("</dl>\n");
    Html::markup(text)
}

/// Name, value, and what to compare it with.
fn facts(run: &RunData) -> Vec<(&'static str, String, String)> {
    let scene = &run.scene;
    let mut facts = vec![("state", stage(run).to_owned(), next(run).to_owned())];
    if let Some(now) = Now::of(run) {
        let asked = format!("of {} Myr asked for", scene.evolution.duration_myr);
        facts.push(("time", format!("{:.4} Myr", now.t_s / MYR_S), asked));
        let period = RunData::period_h(now.omega).map_or("none".to_owned(), |p| format!("{p:.3} h"));
        facts.push(("period", period, format!("{} h at the start", scene.spin.period_h)));
        let obliquity = format!("{:.2}°", now.obliquity.to_degrees());
        facts.push(("obliquity", obliquity, format!("{}° at the start", scene.spin.obliquity_deg)));
    }
    if let (Some(first), Some(last)) = (run.configurations.first(), run.configurations.last()) {
        let ratios = |[a, b, c]: [f64; 3]| format!("{:.3}, {:.3}", b / a, c / a);
        let from = format!("{} at first", ratios(first.b1_axes_m));
        facts.push(("axis ratios b/a, c/a", ratios(last.b1_axes_m), from));
        let legs = format!("in {}", count(run.legs.len(), "leg"));
        facts.push(("movements", run.totals.movements.to_string(), legs));
        let shed = format!("{:.3} %", 100.0 * run.totals.shed_mass_fraction);
        facts.push(("mass shed", shed, count(run.losses.len(), "sphere")));
        let density = format!("{:.0} kg/m³", last.densities_kg_m3[0]);
        facts.push(("density", density, format!("{:.0} at first", first.densities_kg_m3[0])));
    }
    if !run.sphere_radius_m.is_empty() {
        let now = run.state.as_ref().map_or(0, |s| s.sphere_ids.len());
        facts.push(("spheres", now.to_string(), format!("{} as constructed", run.sphere_radius_m.len())));
    }
    let cpu = format!("{} of CPU", duration(run.totals.cpu_seconds));
    facts.push(("computed in", duration(run.totals.seconds), cpu));
    facts
}

/// `1 leg`, `2 legs`.
fn count(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

/// Time, spin rate and obliquity that a run has come to.
struct Now {
    t_s: f64,
    omega: f64,
    obliquity: f64,
}

impl Now {
    fn of(run: &RunData) -> Option<Self> {
        let state = run.state.as_ref()?;
        Some(match run.ending {
            Some(ending) => Self { t_s: ending.t_s, omega: ending.omega, obliquity: ending.obliquity },
            None => Self { t_s: state.t_s, omega: state.omega, obliquity: state.obliquity },
        })
    }
}

fn stage(run: &RunData) -> &'static str {
    match (run.state.as_ref().map(|s| s.stage), run.ending.map(|e| e.outcome)) {
        (None, _) => "not built yet",
        (Some(Stage::Built), _) => "settling",
        (Some(Stage::Settled), _) => "settled",
        (_, Some(Outcome::EndTime)) => "at its end",
        (_, Some(Outcome::Until)) => "stopped as asked",
        (_, Some(Outcome::SpunDown)) => "spun down",
        (_, Some(Outcome::Fission)) => "fission",
        (_, Some(Outcome::Disrupted)) => "disrupted",
        (Some(Stage::Evolving | Stage::Finished), None) => "evolving",
    }
}

fn next(run: &RunData) -> &'static str {
    match (run.state.as_ref().map(|s| s.stage), run.ending.map(|e| e.outcome)) {
        (None, _) => "the aggregate is constructed first",
        (Some(Stage::Built), _) => "the aggregate exists and comes to rest next",
        (Some(Stage::Settled), _) => "surface and torques follow",
        (_, Some(Outcome::EndTime)) => "the whole duration",
        (_, Some(Outcome::Until)) => "goes on with --resume",
        (_, Some(Outcome::SpunDown)) => "beyond the longest period",
        (_, Some(Outcome::Fission)) => "a tenth of the mass or more separated",
        (_, Some(Outcome::Disrupted)) => "no piece has half of the mass",
        (Some(Stage::Evolving | Stage::Finished), None) => "running, or goes on with --resume",
    }
}

/// `2 d 3 h`, `3 h 12 min`, `41 s`.
pub fn duration(seconds: f64) -> String {
    let s = seconds.round() as u64;
    match s {
        0..10 => format!("{seconds:.2} s"),
        10..60 => format!("{s} s"),
        60..3600 => format!("{} min {} s", s / 60, s % 60),
        3600..86400 => format!("{} h {} min", s / 3600, s / 60 % 60),
        _ => format!("{} d {} h", s / 86400, s / 3600 % 24),
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn durations_have_two_units() {
        let cases = [(0.5, "0.50 s"), (41.2, "41 s"), (125.0, "2 min 5 s"), (11_520.0, "3 h 12 min"), (2e5, "2 d 7 h")];
        for (seconds, text) in cases {
            assert_eq!(super::duration(seconds), text);
        }
    }
}
