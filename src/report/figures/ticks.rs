//! Where an axis has ticks and what stands beside them.

use super::plot::{Axis, Scale};

/// A tick; minor ones have no label.
#[derive(Debug, Clone, PartialEq)]
pub struct Tick {
    /// Value.
    pub value: f64,
    /// Words beside it.
    pub label: Option<String>,
}

/// The ticks of an axis that has room for about `room` labels.
pub fn ticks(axis: &Axis, room: usize) -> Vec<Tick> {
    match &axis.scale {
        Scale::Linear => linear(axis.range, room, &[1.0, 2.0, 5.0, 10.0]),
        Scale::Degrees => linear(axis.range, room, &[1.5, 3.0, 4.5, 9.0, 15.0]),
        Scale::Logarithmic => logarithmic(axis.range, room),
        Scale::Rows(names) => {
            let tick = |(row, name): (usize, &String)| Tick { value: row as f64, label: Some(name.clone()) };
            names.iter().enumerate().map(tick).collect()
        }
    }
}

/// Multiples of one of `steps` times a power of ten.
fn linear([low, high]: [f64; 2], room: usize, steps: &[f64]) -> Vec<Tick> {
    let span = high - low;
    if !(span.is_finite() && span > 0.0) {
        return Vec::new();
    }
    let raw = span / room.max(2) as f64;
    let power = 10_f64.powf(raw.log10().floor());
    let step = steps.iter().map(|m| m * power).find(|s| *s >= raw).unwrap_or(raw);
    let decimals = (-(step * 1.0001).log10().floor()).max(0.0) as usize;
    // An end that is a multiple keeps its tick, whatever its rounding.
    let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
    // A range far from zero and narrow beyond the numbers' resolution has no ticks rather than endless ones.
    if !(first.is_finite() && last - first <= 100.0 && first.abs() < 1e15) {
        return Vec::new();
    }
    let largest = low.abs().max(high.abs());
    let label = |value: f64| {
        if largest >= 1e6 || decimals > 6 { scientific(value) } else { plain(value, decimals) }
    };
    (first as i64..=last as i64)
        .map(|k| k as f64 * step)
        .map(|value| Tick { value, label: Some(label(value)) })
        .collect()
}

/// Powers of ten; their multiples are minor ticks, or labelled ones where there are few powers.
fn logarithmic([low, high]: [f64; 2], room: usize) -> Vec<Tick> {
    let decades = (low.log10().floor() as i32, high.log10().ceil() as i32);
    let shown = (high / low).log10();
    let every = ((shown / room.max(1) as f64).ceil() as i32).max(1);
    let digits: &[u32] = match shown {
        s if s <= 1.0 => &[1, 2, 3, 5],
        s if s <= 2.2 => &[1, 3],
        _ => &[1],
    };
    let minor: &[u32] = if shown <= 8.0 { &[1, 2, 3, 4, 5, 6, 7, 8, 9] } else { &[1] };
    let all = (decades.0..=decades.1).flat_map(|decade| minor.iter().map(move |digit| (*digit, decade)));
    // Parsing gives the number nearest to its decimal form, which is then printed as such.
    all.filter_map(|(digit, decade)| {
        let value = format!("{digit}e{decade}").parse::<f64>().ok()?;
        let labelled = digits.contains(&digit) && decade.rem_euclid(every) == 0;
        let label = labelled.then(|| match (digit, decade) {
            (_, -2..=3) => plain(value, (-decade).max(0) as usize),
            (1, _) => format!("10{}", superscript(decade)),
            _ => format!("{digit}×10{}", superscript(decade)),
        });
        (low..=high).contains(&value).then_some(Tick { value, label })
    })
    .collect()
}

fn plain(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    // Rounding leaves no "-0.0".
    let text = if text.parse() == Ok(0.0) { text.replace('-', "") } else { text };
    text.replace('-', "−")
}

fn scientific(value: f64) -> String {
    let text = format!("{value:.2e}");
    match text.split_once('e') {
        Some((digits, power)) => {
            let digits = digits.trim_end_matches('0').trim_end_matches('.').replace('-', "−");
            if digits == "0" { digits } else { format!("{digits}×10{}", superscript(power.parse().unwrap_or(0))) }
        }
        None => text,
    }
}

/// A whole number as an exponent.
pub fn superscript(power: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    power.to_string().chars().map(|c| c.to_digit(10).map_or('⁻', |d| DIGITS[d as usize])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis, room: usize) -> Vec<String> {
        ticks(axis, room).into_iter().filter_map(|t| t.label).collect()
    }

    #[test]
    fn even_axes_have_round_labels() {
        assert_eq!(labels(&Axis::between("", -0.31, 0.72), 6), ["−0.2", "0.0", "0.2", "0.4", "0.6"]);
        assert_eq!(
            labels(&Axis::between("", 0.0, 180.0), 9),
            ["0", "20", "40", "60", "80", "100", "120", "140", "160", "180"]
        );
        assert_eq!(labels(&Axis::obliquity(), 7), ["0", "30", "60", "90", "120", "150", "180"]);
        assert_eq!(labels(&Axis::between("", 0.0, 0.03), 3), ["0.00", "0.01", "0.02", "0.03"]);
        assert_eq!(labels(&Axis::between("", 0.0, 3e7), 3), ["0", "1×10⁷", "2×10⁷", "3×10⁷"]);
    }

    #[test]
    fn logarithmic_axes_label_powers_and_on_short_ones_multiples() {
        assert_eq!(
            labels(&Axis { label: String::new(), scale: Scale::Logarithmic, range: [0.5e-9, 2e-3] }, 4).len(),
            3
        );
        let short = Axis { label: String::new(), scale: Scale::Logarithmic, range: [0.8, 40.0] };
        assert_eq!(labels(&short, 5), ["1", "3", "10", "30"]);
        let tiny = Axis { label: String::new(), scale: Scale::Logarithmic, range: [1.5e-7, 8e-7] };
        assert_eq!(labels(&tiny, 5), ["2×10⁻⁷", "3×10⁻⁷", "5×10⁻⁷"]);
    }

    #[test]
    fn axes_without_extent_or_far_from_zero_have_no_endless_ticks() {
        for (low, high) in [(1.0, 1.0), (f64::NAN, 1.0), (1e17, 1e17 + 64.0), (0.0, f64::INFINITY), (-1e308, 1e308)] {
            assert!(ticks(&Axis::between("", low, high), 5).len() < 50, "{low} to {high}");
        }
        let constant = Axis::around("", [4.0, 4.0, f64::NAN]);
        assert!(constant.range[0] < 4.0 && constant.range[1] > 4.0 && !labels(&constant, 5).is_empty());
        assert!(!labels(&Axis::around("", [0.0]), 5).is_empty());
    }
}
