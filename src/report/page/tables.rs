//! The tables of a run: its intervals, its settling, and what left it.

use super::html::{Align, Html, table};
use crate::evolve::driver::MYR_S;
use crate::report::RunData;
use crate::store::{IntervalRecord, LegRecord};

use Align::{Number, Text};

/// Intervals between movements, the open one included; `None` before the first leg.
pub fn intervals(run: &RunData) -> Option<Html> {
    let open = run.open_interval();
    if run.intervals.is_empty() && open.is_none() {
        return None;
    }
    let columns = [
        ("interval", Number),
        ("configuration", Number),
        ("from (Myr)", Number),
        ("Δt (kyr)", Number),
        ("legs", Number),
        ("period (h)", Number),
        ("Δω/ω (%)", Number),
        ("obliquity (°)", Number),
        ("Δε (°)", Number),
        ("moved", Number),
        ("shed", Number),
        ("ends with", Text),
    ];
    // Configurations rise along the legs, so the leg that closes an interval is the last one with its configuration.
    let closing = |i: &IntervalRecord| {
        let after = run.legs.partition_point(|leg| leg.configuration <= i.configuration);
        after.checked_sub(1).map(|last| &run.legs[last])
    };
    let rows = run.intervals.iter().map(|i| row(i, closing(i), false)).chain(open.iter().map(|i| row(i, None, true)));
    Some(table("intervals between movements", &columns, rows))
}

fn row(i: &IntervalRecord, closing: Option<&LegRecord>, open: bool) -> (&'static str, Vec<Html>) {
    let c = i.configuration;
    let count = |n: Option<u32>| n.map_or("".to_owned(), |n| n.to_string());
    let cells = vec![
        i.interval.to_string().into(),
        Html::markup(format!("<a href=\"#configuration={c}\" title=\"show it\">{c}</a>")),
        format!("{:.5}", i.t_s[0] / MYR_S).into(),
        format!("{:.3}", (i.t_s[1] - i.t_s[0]) / MYR_S * 1000.0).into(),
        i.legs.to_string().into(),
        RunData::period_h(i.omega[0]).map_or("none".to_owned(), |p| format!("{p:.3}")).into(),
        format!("{:+.3}", 100.0 * (i.omega[1] / i.omega[0] - 1.0)).into(),
        format!("{:.2}", i.obliquity[0].to_degrees()).into(),
        format!("{:+.3}", (i.obliquity[1] - i.obliquity[0]).to_degrees()).into(),
        count(closing.map(|leg| leg.moved[0])).into(),
        count(closing.map(|leg| leg.shed)).into(),
        if open { "still open".into() } else { "movement".into() },
    ];
    (if open { "left-out" } else { "" }, cells)
}

/// Blocks of settling; `None` before the first.
pub fn settling(run: &RunData) -> Option<Html> {
    if run.settling.is_empty() {
        return None;
    }
    let columns = [
        ("block", Number),
        ("rotations", Number),
        ("period (h)", Number),
        ("moved", Number),
        ("largest displacement (radii)", Number),
        ("b/a", Number),
        ("c/a", Number),
        ("collisions", Number),
        ("left", Number),
    ];
    let rows = run.settling.iter().map(|b| {
        let cells = vec![
            b.block.to_string(),
            b.dynamics.rotations.to_string(),
            format!("{:.3}", b.period_s / 3600.0),
            b.moved.to_string(),
            format!("{:.3}", b.max_displacement_radii),
            format!("{:.3}", b.b_over_a),
            format!("{:.3}", b.c_over_a),
            b.dynamics.collisions.to_string(),
            b.shed.to_string(),
        ];
        ("", cells.into_iter().map(Html::from).collect())
    });
    Some(table("blocks of settling", &columns, rows))
}

/// How the two pieces of a fission went on; `None` without one that was followed.
pub fn fission(run: &RunData) -> Option<Html> {
    let (_, fission) = run.fission.as_ref()?;
    let [body, piece] = fission.mass_kg.map(|m| 100.0 * m / run.initial_mass_kg());
    let speed = fission.speed_m_s.map_or(String::new(), |v| format!(" at {v:.3} m/s"));
    let orbit = fission.orbit.map_or(String::new(), |[a, e, i]| {
        format!("; mean orbit a = {a:.0} m, e = {e:.3}, i = {:.1}°", i.to_degrees())
    });
    let periods = fission
        .spin_rate
        .map(|omega| RunData::period_h(omega).map_or("not turning".to_owned(), |p| format!("turning in {p:.2} h")));
    let text = format!(
        "The body parted into {body:.1} % and {piece:.1} % of its first mass. After {:.2} days: {}{speed}{orbit}. The body was \
         then {}, the piece {}.",
        fission.t_s / 86400.0,
        fission.fate,
        periods[0],
        periods[1]
    );
    Some(Html::markup(format!("<p>{}</p>\n", Html::text(&text))))
}

/// Spheres that left and what became of them; `None` if none did.
pub fn losses(run: &RunData) -> Option<Html> {
    if run.losses.is_empty() && run.fates.is_empty() {
        return None;
    }
    let columns = [
        ("leg", Text),
        ("sphere", Number),
        ("time (Myr)", Number),
        ("period (h)", Number),
        ("speed (m/s)", Number),
        ("distance (m)", Number),
        ("energy (J)", Number),
        ("fate", Text),
        ("after (d)", Number),
        ("speed then (m/s)", Number),
    ];
    let leg_name = |leg: Option<u32>| leg.map_or("settling".to_owned(), |leg| leg.to_string());
    let norm = |v: [f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
    let fate_cells = |fate: Option<&crate::store::FateRecord>| match fate {
        None => ["not followed".to_owned(), String::new(), String::new()],
        Some(f) => {
            let name = match (f.into, f.returned) {
                (Some(into), _) => format!("{} with {into}", f.fate),
                (None, true) => format!("{}, put back", f.fate),
                (None, false) => f.fate.to_string(),
            };
            let speed = f.speed_m_s.map_or(String::new(), |v| format!("{v:.4}"));
            [name, format!("{:.3}", f.t_s / 86400.0), speed]
        }
    };
    let lost = run.losses.iter().map(|(leg, l)| {
        let fate = run.fates.iter().find(|(of, f)| of == leg && f.sphere == l.sphere).map(|(_, f)| f);
        let mut cells = vec![
            leg_name(*leg),
            l.sphere.to_string(),
            format!("{:.5}", l.t_s / MYR_S),
            RunData::period_h(l.omega).map_or("none".to_owned(), |p| format!("{p:.3}")),
            format!("{:.4}", norm(l.velocity)),
            format!("{:.1}", norm(l.position)),
            format!("{:.2e}", l.energy_j),
        ];
        cells.extend(fate_cells(fate));
        ("", cells.into_iter().map(Html::from).collect())
    });
    // What fell back is no loss, but it left.
    let is_loss = |leg: Option<u32>, sphere: u32| run.losses.iter().any(|(of, l)| *of == leg && l.sphere == sphere);
    let back = run.fates.iter().filter(|(leg, f)| !is_loss(*leg, f.sphere)).map(|(leg, f)| {
        let mut cells = vec![leg_name(*leg), f.sphere.to_string()];
        cells.extend(std::iter::repeat_n(String::new(), 5));
        cells.extend(fate_cells(Some(f)));
        ("left-out", cells.into_iter().map(Html::from).collect())
    });
    Some(table("spheres that left", &columns, lost.chain(back)))
}
