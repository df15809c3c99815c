//! The type of a body's evolution in spin or in obliquity, from its series of intervals.
//!
//! Source: Cotto-Figueroa et al. (2015), ApJ 803, 25, section 3.1 and the last columns of Tables 2 and 3. The paper's
//! definitions are words; the numbers are [`Criteria`]. Every run with any evolution gets a base type, modified cycle or
//! stochastic, unless it is self-governed throughout; stagnation comes on top of either, as in the paper's "MYC/Stg".

use super::criteria::Criteria;
use super::series::{Quantity, Segment, intervals};
use crate::evolve::driver::MYR_S;

/// A type of evolution.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
pub enum Kind {
    /// Modified YORP cycle: movements change how fast, not where to. The spin may turn once, from up to down.
    #[serde(rename = "MYC")]
    ModifiedCycle,
    /// Stochastic: movements turn the evolution round time and again.
    #[serde(rename = "Sto")]
    Stochastic,
    /// Self-governed: the body toggles between shapes that drive it up and down within a narrow range.
    #[serde(rename = "SG")]
    SelfGoverned,
    /// Stagnating: a long stretch of hardly any torque, short of the end of a YORP cycle.
    #[serde(rename = "Stg")]
    Stagnating,
    /// The body broke up.
    #[serde(rename = "F")]
    Fission,
    /// It has turned, but not often enough in enough intervals to be called stochastic, nor as a cycle does.
    #[serde(rename = "too short to say")]
    TooShort,
}

impl Kind {
    /// The paper's abbreviation.
    pub fn name(self) -> &'static str {
        match self {
            Self::ModifiedCycle => "MYC",
            Self::Stochastic => "Sto",
            Self::SelfGoverned => "SG",
            Self::Stagnating => "Stg",
            Self::Fission => "F",
            Self::TooShort => "too short to say",
        }
    }
}

/// Where a type shows, and why it was given.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Stretch {
    /// The type.
    pub kind: Kind,
    /// Start, Myr.
    pub from_myr: f64,
    /// End, Myr.
    pub to_myr: f64,
    /// What fulfils its criterion, for a reader.
    pub why: String,
}

/// Where the quantity was going at the end of the run; the marks are those of Tables 2 and 3.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Trend {
    /// Up.
    Increasing,
    /// Down.
    Decreasing,
    /// Up and down.
    Varying,
    /// Neither.
    Constant,
}

impl Trend {
    /// The mark of Tables 2 and 3; nothing for a constant value.
    pub fn mark(self) -> &'static str {
        match self {
            Self::Increasing => "↗",
            Self::Decreasing => "↘",
            Self::Varying => "↔",
            Self::Constant => "",
        }
    }
}

/// How one quantity evolved.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Verdict {
    /// The types in the order in which they appear, "Sto/SG"; empty before anything has evolved.
    #[serde(rename = "type")]
    pub label: String,
    /// Changes of direction from one interval to the next, over the whole run.
    pub reversals: usize,
    /// Where each type shows; one type may show in several stretches.
    pub stretches: Vec<Stretch>,
    /// The tendency at the end; `None` before anything has evolved.
    pub trend: Option<Trend>,
}

impl Verdict {
    /// Whether the type is among those found.
    pub fn has(&self, kind: Kind) -> bool {
        self.stretches.iter().any(|s| s.kind == kind)
    }
}

/// What a run is judged by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Course<'a> {
    /// Its evolution in order of time, backtracked legs left out.
    pub segments: &'a [Segment],
    /// The obliquity to which the body would tend were it rigid, deg; `None` if not determined.
    pub rigid_end_obliquity_deg: Option<f64>,
    /// Whether it ended in a fission or worse.
    pub broke_up: bool,
}

/// Classifies one quantity of a run. `alike(a, b)` is the share of the spheres that the shapes `a` and `b` have in the same
/// places; it is asked only where the evolution alternates.
pub fn classify_quantity(
    quantity: Quantity,
    course: &Course,
    mut alike: impl FnMut(u32, u32) -> f64,
    criteria: &Criteria,
) -> Verdict {
    let steps: Vec<Step> = intervals(course.segments).iter().filter_map(|s| Step::new(quantity, s, criteria)).collect();
    let (Some(first), Some(last)) = (course.segments.first(), course.segments.last()) else {
        return Verdict { label: String::new(), reversals: 0, stretches: Vec::new(), trend: None };
    };
    let run_myr = [first.t_s[0] / MYR_S, last.t_s[1] / MYR_S];
    let governed = self_governed(quantity, &steps, &mut alike, criteria);
    let mut stretches: Vec<Stretch> = governed.iter().map(|g| g.stretch.clone()).collect();
    stretches.extend(base(quantity, &steps, &governed, criteria));
    stretches.extend(stagnating(quantity, course, criteria, run_myr));
    if course.broke_up {
        let why = "a piece of at least a tenth of the mass left the body".to_owned();
        stretches.push(Stretch { kind: Kind::Fission, from_myr: run_myr[1], to_myr: run_myr[1], why });
    }
    stretches.sort_by(|a, b| a.from_myr.total_cmp(&b.from_myr).then(a.kind.cmp(&b.kind)));
    let mut kinds: Vec<Kind> = Vec::new();
    for stretch in &stretches {
        if !kinds.contains(&stretch.kind) {
            kinds.push(stretch.kind);
        }
    }
    if kinds.len() > 1 {
        kinds.retain(|kind| *kind != Kind::TooShort);
    }
    // A break-up ends the run, whatever begins at the same moment.
    kinds.sort_by_key(|kind| *kind == Kind::Fission);
    Verdict {
        label: kinds.iter().map(|kind| kind.name()).collect::<Vec<_>>().join("/"),
        reversals: reversals(&steps),
        stretches,
        trend: Some(trend(quantity, course.segments, run_myr, criteria)),
    }
}

/// An interval whose change has a sign.
#[derive(Debug, Clone, Copy)]
struct Step {
    t_myr: [f64; 2],
    values: [f64; 2],
    up: bool,
    configuration: u32,
}

impl Step {
    fn new(quantity: Quantity, interval: &Segment, criteria: &Criteria) -> Option<Self> {
        let values = quantity.of(interval);
        let change = values[1] - values[0];
        let negligible = match quantity {
            Quantity::Spin => criteria.no_spin_change * values[0],
            Quantity::Obliquity => criteria.no_obliquity_change_deg,
        };
        let t_myr = interval.t_s.map(|t| t / MYR_S);
        let step = Self { t_myr, values, up: change > 0.0, configuration: interval.configuration };
        (change.abs() >= negligible && change != 0.0).then_some(step)
    }
}

fn reversals(steps: &[Step]) -> usize {
    steps.windows(2).filter(|w| w[0].up != w[1].up).count()
}

/// A self-governed stretch and the steps it takes in.
struct Governed {
    steps: std::ops::Range<usize>,
    stretch: Stretch,
}

/// Stretches of alternating steps within a narrow range whose every second shape is the same.
fn self_governed(
    quantity: Quantity,
    steps: &[Step],
    alike: &mut impl FnMut(u32, u32) -> f64,
    criteria: &Criteria,
) -> Vec<Governed> {
    let mut found = Vec::new();
    let mut start = 0;
    while start + criteria.self_governed_intervals <= steps.len() {
        let alternates = |end: usize| steps[end].up != steps[end - 1].up;
        // The cheap questions first: shapes are compared only where the rest fits.
        let mut end = start + 1;
        while end < steps.len() && alternates(end) && is_narrow(quantity, &steps[start..=end], criteria) {
            end += 1;
        }
        let mut recurring = (start + 2).min(end);
        let (mut second, mut next) = (Vec::new(), Vec::new());
        while end - start >= criteria.self_governed_intervals && recurring < end {
            let [a, b, c] = [2, 1, 0].map(|back| steps[recurring - back].configuration);
            let share = alike(a, c);
            if share < criteria.recurrence {
                break;
            }
            second.push(share);
            next.push(alike(a, b));
            recurring += 1;
        }
        // Every second shape must be the more alike one: where a few spheres wander, neighbours are alike too.
        let toggles = second.iter().sum::<f64>() > next.iter().sum::<f64>();
        if recurring - start < criteria.self_governed_intervals || !toggles {
            start += 1;
            continue;
        }
        let inside = &steps[start..recurring];
        let why = format!(
            "{} intervals alternate, {}, and every second shape has {:.1} % of the spheres in place",
            inside.len(),
            match quantity {
                Quantity::Spin => format!("the spin stays within {:.2} %", 100.0 * range(inside) / mean(inside)),
                Quantity::Obliquity => format!("the obliquity stays within {:.2} deg", range(inside)),
            },
            100.0 * second.iter().copied().fold(1.0, f64::min)
        );
        let stretch = Stretch {
            kind: Kind::SelfGoverned,
            from_myr: inside[0].t_myr[0],
            to_myr: inside[inside.len() - 1].t_myr[1],
            why,
        };
        found.push(Governed { steps: start..recurring, stretch });
        start = recurring;
    }
    found
}

fn is_narrow(quantity: Quantity, steps: &[Step], criteria: &Criteria) -> bool {
    match quantity {
        Quantity::Spin => range(steps) < criteria.self_governed_spin_range * mean(steps),
        Quantity::Obliquity => range(steps) < criteria.self_governed_obliquity_range_deg,
    }
}

fn range(steps: &[Step]) -> f64 {
    let values = || steps.iter().flat_map(|s| s.values);
    values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
}

fn mean(steps: &[Step]) -> f64 {
    steps.iter().flat_map(|s| s.values).sum::<f64>() / (2 * steps.len()) as f64
}

/// What is not self-governed follows a cycle or is stochastic.
fn base(quantity: Quantity, steps: &[Step], governed: &[Governed], criteria: &Criteria) -> Option<Stretch> {
    let mut free: Vec<&[Step]> = Vec::new();
    let mut start = 0;
    for g in governed {
        free.push(&steps[start..g.steps.start]);
        start = g.steps.end;
    }
    free.push(&steps[start..]);
    free.retain(|part| !part.is_empty());
    let (first, last) = (free.first()?.first()?, free.last()?.last()?);
    let turns: usize = free.iter().map(|part| reversals(part)).sum();
    let up_to_down = |w: &[Step]| w[0].up && !w[1].up;
    let one_turn = turns == 1 && free.iter().any(|part| part.windows(2).any(up_to_down));
    let (kind, why) = match quantity {
        // Where the body toggles too, what comes before or after it is an episode on the way.
        _ if !governed.is_empty() && turns < 2 => return None,
        _ if turns == 0 => (Kind::ModifiedCycle, "it never turns".to_owned()),
        Quantity::Spin if one_turn => (Kind::ModifiedCycle, "it turns once, from up to down".to_owned()),
        _ => {
            let intervals: usize = free.iter().map(|part| part.len()).sum();
            let times = if turns == 1 { "once".to_owned() } else { format!("{turns} times") };
            let turned = format!("it turns {times} in {intervals} intervals");
            let (reversals, fewest) = (criteria.stochastic_reversals, criteria.stochastic_intervals);
            if turns >= reversals && intervals >= fewest {
                (Kind::Stochastic, turned)
            } else {
                (Kind::TooShort, format!("{turned}; stochastic takes {reversals} reversals in {fewest} intervals"))
            }
        }
    };
    Some(Stretch { kind, from_myr: first.t_myr[0], to_myr: last.t_myr[1], why })
}

/// Long stretches of hardly any change, not at the end of a YORP cycle.
fn stagnating(quantity: Quantity, course: &Course, criteria: &Criteria, run_myr: [f64; 2]) -> Vec<Stretch> {
    // Legs rather than intervals: within one interval the evolution may come to rest.
    let rate = |s: &Segment| {
        let [before, after] = quantity.of(s);
        (after - before).abs() / s.duration_s()
    };
    let lasting = || course.segments.iter().filter(|s| s.duration_s() > 0.0);
    let moving = lasting().filter(|s| Step::new(quantity, s, criteria).is_some());
    let Some(usual) = super::distribution::median(moving.map(rate)) else { return Vec::new() };
    let limit = criteria.stagnating_rate * usual;
    let lasting: Vec<&Segment> = lasting().collect();
    let shortest = criteria.stagnating_myr.max(criteria.stagnating_share * (run_myr[1] - run_myr[0]));
    let parts = lasting.chunk_by(|a, b| (rate(a) < limit) == (rate(b) < limit));
    let slow = parts.filter(|part| rate(part[0]) < limit);
    let stuck = |part: &[&Segment]| {
        let (first, last) = (part[0], part[part.len() - 1]);
        let [from_myr, to_myr] = [first.t_s[0] / MYR_S, last.t_s[1] / MYR_S];
        let obliquity = last.obliquity[1].to_degrees();
        let at_rest = match quantity {
            Quantity::Spin => last.omega[1] <= criteria.slowest_spin,
            Quantity::Obliquity => {
                let near = |end: f64, within: f64| (obliquity - end).abs() <= within;
                course.rigid_end_obliquity_deg.is_some_and(|end| near(end, criteria.end_state_deg))
                    || near(0.0, criteria.pole_deg)
                    || near(180.0, criteria.pole_deg)
            }
        };
        let [before, after] = [quantity.of(first)[0], quantity.of(last)[1]];
        let unit = match quantity {
            Quantity::Spin => "rev/day",
            Quantity::Obliquity => "deg",
        };
        let why = format!(
            "for {:.2} Myr it goes from {before:.3} to {after:.3} {unit}, slower than {:.0} % of its usual rate",
            to_myr - from_myr,
            100.0 * criteria.stagnating_rate
        );
        let long = to_myr - from_myr >= shortest;
        (long && !at_rest).then_some(Stretch { kind: Kind::Stagnating, from_myr, to_myr, why })
    };
    slow.filter_map(stuck).collect()
}

/// The tendency over the last share of the run.
fn trend(quantity: Quantity, segments: &[Segment], run_myr: [f64; 2], criteria: &Criteria) -> Trend {
    let from = (run_myr[1] - criteria.trend_share * (run_myr[1] - run_myr[0])) * MYR_S;
    let late = || segments.iter().filter(|s| s.t_s[1] > from);
    let values = || late().flat_map(|s| quantity.of(s));
    let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
    let constant = match quantity {
        Quantity::Spin => high - low < criteria.constant_spin * high,
        Quantity::Obliquity => high - low < criteria.constant_obliquity_deg,
    };
    let late: Vec<Segment> = late().copied().collect();
    let steps: Vec<Step> = intervals(&late).iter().filter_map(|s| Step::new(quantity, s, criteria)).collect();
    match (constant, steps.last()) {
        (true, _) | (_, None) => Trend::Constant,
        // One turn is part of a cycle.
        _ if reversals(&steps) > 1 => Trend::Varying,
        (false, Some(last)) if last.up => Trend::Increasing,
        (false, Some(_)) => Trend::Decreasing,
    }
}
