//! Where the time of a run went, and which error each part contributed.

use super::html::{Align, Html, table};
use crate::report::RunData;
use crate::store::{Part, Totals};

/// The error that a part contributed, in words; empty for a part without one.
pub fn part_error(part: Part, totals: &Totals) -> String {
    match part {
        Part::Check | Part::Movement => format!(
            "angular momentum {:.1e}, momentum {:.1e}, overlap {:.1e} R",
            totals.angular_momentum_drift, totals.momentum_drift, totals.max_overlap_radii
        ),
        Part::Torque => totals
            .torque_error
            .map_or(String::new(), |(s, o)| format!("spin {s:.1e} N m, obliquity {o:.1e} N m (latest shape)")),
        Part::Spin => format!("spin rate {:.1e} relative per leg", totals.spin_error),
        Part::Tiling => totals.vertices_flagged.map_or(String::new(), |n| format!("{n} vertices off the normal")),
        Part::Build | Part::Settle | Part::Store => String::new(),
    }
}

/// What a part does.
fn meaning(part: Part) -> &'static str {
    match part {
        Part::Build => "construction of the aggregate",
        Part::Settle => "settling of object 0",
        Part::Check => "dynamics after a change of spin, nothing moved",
        Part::Movement => "dynamics after a change of spin, spheres moved",
        Part::Torque => "sunlight: torque tables",
        Part::Tiling => "surface: fitting and re-tiling",
        Part::Spin => "spin and obliquity",
        Part::Store => "transactions on disk",
    }
}

/// Seconds and errors of all parts, over all sessions.
pub fn costs(run: &RunData) -> Html {
    let totals = &run.totals;
    let all: f64 = totals.parts.iter().map(|(_, t)| t.cpu_seconds).sum();
    let columns = [
        ("part", Align::Text),
        ("what it is", Align::Text),
        ("times", Align::Number),
        ("seconds", Align::Number),
        ("CPU s", Align::Number),
        ("share of CPU", Align::Text),
        ("error", Align::Text),
    ];
    let rows = totals.parts.iter().map(|(part, total)| {
        let share = if all > 0.0 { 100.0 * total.cpu_seconds / all } else { 0.0 };
        let bar = format!("<span class=\"share\" style=\"width:{:.2}rem\"></span> {share:.1} %", 0.06 * share);
        let cells = vec![
            part.name().into(),
            meaning(*part).into(),
            total.count.to_string().into(),
            format!("{:.3}", total.seconds).into(),
            format!("{:.3}", total.cpu_seconds).into(),
            Html::markup(bar),
            part_error(*part, totals).into(),
        ];
        (if total.count == 0 { "left-out" } else { "" }, cells)
    });
    table("cost and error of each part", &columns, rows)
}

/// Every start of the program.
pub fn sessions(run: &RunData) -> Option<Html> {
    if run.sessions.is_empty() {
        return None;
    }
    let columns = [
        ("started (UTC)", Align::Text),
        ("machine", Align::Text),
        ("processor", Align::Text),
        ("version", Align::Text),
        ("threads", Align::Number),
        ("seconds", Align::Number),
        ("CPU s", Align::Number),
    ];
    let rows = run.sessions.iter().map(|s| {
        let cells = vec![
            date(s.started_unix_s),
            s.host.clone(),
            s.processor.clone(),
            s.version.clone(),
            s.threads.to_string(),
            format!("{:.1}", s.seconds),
            format!("{:.1}", s.cpu_seconds),
        ];
        ("", cells.into_iter().map(Html::from).collect())
    });
    Some(table("starts of the program", &columns, rows))
}

/// `2026-11-22 19:53` of seconds since 1970; civil calendar by the algorithm of H. Hinnant, days_from_civil inverted.
fn date(unix_s: i64) -> String {
    let (days, second) = (unix_s.div_euclid(86_400), unix_s.rem_euclid(86_400));
    // Years begin in March, so that the leap day is their last.
    let shifted = days + 719_468;
    let (era, day_of_era) = (shifted.div_euclid(146_097), shifted.rem_euclid(146_097));
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let march_month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * march_month + 2) / 5 + 1;
    let month = if march_month < 10 { march_month + 3 } else { march_month - 9 };
    let year = year_of_era + era * 400 + i64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02} {:02}:{:02}", second / 3600, second / 60 % 60)
}

#[cfg(test)]
mod tests {
    use super::date;

    #[test]
    fn dates_are_those_of_the_calendar() {
        assert_eq!(date(0), "1970-01-01 00:00");
        assert_eq!(date(951_782_399), "2000-02-28 23:59");
        assert_eq!(date(951_782_400), "2000-02-29 00:00");
        assert_eq!(date(1_795_377_191), "2026-11-22 19:53");
        assert_eq!(date(-1), "1969-12-31 23:59");
    }
}
