//! What kind of evolution a run shows, and its statistics.

use std::fmt::Write as _;

use super::html::{Align, Html, table};
use crate::classify::{Criteria, Distribution, Kind, RunClassification, Verdict, classify};
use crate::report::RunData;

/// The types with what speaks for them, and the statistics; `None` before a body has evolved.
pub fn classification(run: &RunData) -> Option<Html> {
    let found = match classify(run, &Criteria::default()) {
        Ok(found) => found,
        // The rest of the page is worth having without it.
        Err(error) => {
            return Some(Html::markup(format!(
                "<p>It cannot be classified: {}.</p>\n",
                Html::text(&error.to_string())
            )));
        }
    };
    found.aggregate?;
    let mut text = String::from("<dl class=\"facts\">\n");
    for (name, verdict) in [("spin", &found.spin), ("obliquity", &found.obliquity)] {
        let [label, kinds] = [label(verdict), meaning(verdict)].map(Html::from);
        let _ = writeln!(text, "<div><dt>{name}</dt><dd>{label}<small>{kinds}</small></dd></div>");
    }
    text.push_str("</dl>\n");
    text.push_str(stretches(&found).as_str());
    let _ = write!(text, "<details><summary>Statistics of the run</summary>\n{}</details>\n", statistics(&found));
    Some(Html::markup(text))
}

fn label(verdict: &Verdict) -> String {
    if verdict.label.is_empty() { "nothing to classify yet".to_owned() } else { verdict.label.clone() }
}

/// The abbreviations of a label in words.
fn meaning(verdict: &Verdict) -> String {
    let all =
        [Kind::ModifiedCycle, Kind::Stochastic, Kind::SelfGoverned, Kind::Stagnating, Kind::Fission, Kind::TooShort];
    let words = all.into_iter().filter(|kind| verdict.has(*kind)).map(|kind| match kind {
        Kind::ModifiedCycle => "modified YORP cycle",
        Kind::Stochastic => "stochastic",
        Kind::SelfGoverned => "self-governed",
        Kind::Stagnating => "stagnating",
        Kind::Fission => "broke up",
        Kind::TooShort => "see why below",
    });
    let reversals = match verdict.reversals {
        0 => "never turns".to_owned(),
        1 => "turns once".to_owned(),
        n => format!("turns {n} times"),
    };
    words.map(str::to_owned).chain([reversals]).collect::<Vec<_>>().join(", ")
}

/// Where each type shows and why.
fn stretches(found: &RunClassification) -> Html {
    let columns = [
        ("of", Align::Text),
        ("type", Align::Text),
        ("from (Myr)", Align::Number),
        ("to (Myr)", Align::Number),
        ("because", Align::Text),
    ];
    let rows = [("spin", &found.spin), ("obliquity", &found.obliquity)].into_iter().flat_map(|(name, verdict)| {
        verdict.stretches.iter().map(move |s| {
            let times = [s.from_myr, s.to_myr].map(|t| format!("{t:.4}").into());
            let [from, to] = times;
            ("", vec![name.into(), s.kind.name().into(), from, to, s.why.as_str().into()])
        })
    });
    table("types of evolution", &columns, rows)
}

/// The numbers that the paper gives of its bodies.
fn statistics(found: &RunClassification) -> Html {
    let mut rows: Vec<(&str, String, String)> = Vec::new();
    let percent = |share: Option<f64>| share.map_or("–".to_owned(), |s| format!("{:.0} %", 100.0 * s));
    if let Some(a) = found.aggregate {
        let rigid = found.rigid.map_or(String::new(), |r| match r.max_spin_rev_day {
            Some(most) => format!("were it rigid: up to {most:.2}"),
            None => "were it rigid: without limit".to_owned(),
        });
        rows.push((
            "spin, smallest to largest",
            format!("{:.2} to {:.2} rev/day", a.min_spin_rev_day, a.max_spin_rev_day),
            rigid,
        ));
    }
    let walk = &found.walk;
    rows.push(("closed intervals", walk.intervals.len().to_string(), quartiles(&walk.length_myr, "Myr")));
    let persistence =
        format!("{} in spin, {} in obliquity", percent(walk.spin_persistence), percent(walk.obliquity_persistence));
    rows.push(("intervals that go on as the one before", persistence, String::new()));
    let movements = &found.movements;
    rows.push((
        "spheres in a movement",
        format!("{} movements", movements.count),
        quartiles(&movements.spheres, "spheres"),
    ));
    let depth = format!("{} inner half, {} outer tenth", percent(movements.inner_half), percent(movements.outer_tenth));
    rows.push(("depth of moved spheres, by enclosed mass", depth, "50 % and 10 % if depth did not matter".to_owned()));
    let losses = &found.losses;
    if losses.event_mass_percent.count > 0 {
        let events = format!("{:.2} % in {} events", losses.mass_percent, losses.event_mass_percent.count);
        rows.push(("mass loss", events, quartiles(&losses.spin_rev_day, "rev/day")));
    }
    if let (Some(start), Some(end)) = (found.shape.start, found.shape.end) {
        let triaxial = |t: Option<f64>| t.map_or("–".to_owned(), |t| format!("{t:.3}"));
        let [from, to] = [start.half_extents, end.half_extents];
        let ratios =
            format!("b/a {:.3} to {:.3}, c/a {:.3} to {:.3}", from.b_over_a, to.b_over_a, from.c_over_a, to.c_over_a);
        let triaxiality = format!("triaxiality {} to {}", triaxial(from.triaxiality), triaxial(to.triaxiality));
        rows.push(("half extents, start to now", ratios, triaxiality));
    }
    let columns = [("quantity", Align::Text), ("value", Align::Text), ("", Align::Text)];
    let rows = rows.into_iter().map(|(name, value, more)| ("", vec![name.into(), value.into(), more.into()]));
    table("statistics of the run", &columns, rows)
}

/// `median 5.2 kyr, quartiles ..` of a set of numbers; nothing of an empty one.
fn quartiles(of: &Distribution, unit: &str) -> String {
    let number = |x: Option<f64>| x.map_or("–".to_owned(), |x| format!("{}", Short(x)));
    if of.count == 0 {
        return String::new();
    }
    let [median, low, high] = [of.median, of.smallest, of.largest].map(number);
    format!("median {median}, {low} to {high} {unit}")
}

/// A number to three digits.
struct Short(f64);

impl std::fmt::Display for Short {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let digits = if self.0 == 0.0 { 0 } else { (2 - self.0.abs().log10().floor() as i32).clamp(0, 6) as usize };
        write!(f, "{:.digits$}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let shown = [0.0, 0.00123, 1.5, 16.44, 2345.6].map(|x| Short(x).to_string());
        assert_eq!(shown, ["0", "0.00123", "1.50", "16.4", "2346"]);
    }
}
