//! The figure of `yorp accuracy`: one panel per knob, error against CPU seconds, the default marked.

use std::ops::Range;
use std::path::Path;
use std::sync::Once;

use plotters::coord::Shift;
use plotters::coord::ranged1d::{KeyPointHint, Ranged, ValueFormatter};
use plotters::prelude::*;
use plotters::style::FontStyle;

use super::{Curve, Point, number};

/// Width of the figure and height of one panel, pixels.
const PANEL: (u32, u32) = (900, 480);
const FONT: &str = "sans-serif";
const BLUE: RGBColor = RGBColor(31, 95, 160);
const RED: RGBColor = RGBColor(190, 50, 40);

/// A figure that could not be drawn or saved.
#[derive(Debug, thiserror::Error)]
#[error("the figure cannot be drawn: {message}")]
pub struct FigureError {
    /// What the drawing library said.
    message: String,
}

impl FigureError {
    fn new(error: impl std::fmt::Display) -> Self {
        Self { message: error.to_string() }
    }
}

/// The figure as an SVG document.
///
/// # Errors
/// If the drawing library fails.
pub fn svg(curves: &[Curve]) -> Result<String, FigureError> {
    let mut text = String::new();
    draw(&SVGBackend::with_string(&mut text, size(curves)).into_drawing_area(), curves)?;
    Ok(text)
}

/// Saves the figure as a PNG file.
///
/// # Errors
/// If the file cannot be written.
pub fn save_png(curves: &[Curve], path: &Path) -> Result<(), FigureError> {
    draw(&BitMapBackend::new(path, size(curves)).into_drawing_area(), curves)
}

fn size(curves: &[Curve]) -> (u32, u32) {
    (PANEL.0, PANEL.1 * curves.len().max(1) as u32)
}

fn draw<B: DrawingBackend>(area: &DrawingArea<B, Shift>, curves: &[Curve]) -> Result<(), FigureError> {
    static REGISTERED: Once = Once::new();
    // The library looks for no fonts on the system; it draws with what it is given.
    REGISTERED.call_once(|| {
        let font = include_bytes!("../../assets/fonts/DejaVuSans.ttf");
        assert!(plotters::style::register_font(FONT, FontStyle::Normal, font).is_ok(), "the font is a valid one");
    });
    area.fill(&WHITE).map_err(FigureError::new)?;
    for (panel, curve) in area.split_evenly((curves.len().max(1), 1)).iter().zip(curves) {
        draw_panel(panel, curve)?;
    }
    area.present().map_err(FigureError::new)
}

fn draw_panel<B: DrawingBackend>(area: &DrawingArea<B, Shift>, curve: &Curve) -> Result<(), FigureError> {
    // A logarithmic axis has no place for zero: a point that costs or errs nothing measurable stands at its edge.
    let place = |p: &Point| (p.seconds.max(1e-6), p.error.max(1e-16));
    let places: Vec<(f64, f64)> = curve.points.iter().map(place).collect();
    let about = &curve.about;
    let (across, up) =
        (Logarithmic::around(places.iter().map(|p| p.0)), Logarithmic::around(places.iter().map(|p| p.1)));
    let mut chart = ChartBuilder::on(area)
        .caption(format!("{} ({})", about.name, about.scene_key), (FONT, 20))
        .margin(16)
        .margin_right(40)
        .x_label_area_size(48)
        .y_label_area_size(88)
        .build_cartesian_2d(across, up)
        .map_err(FigureError::new)?;
    chart
        .configure_mesh()
        .x_desc("CPU seconds")
        .y_desc("error")
        .label_style((FONT, 15))
        .axis_desc_style((FONT, 16))
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.15))
        .draw()
        .map_err(FigureError::new)?;
    chart.draw_series(LineSeries::new(places.iter().copied(), BLUE.stroke_width(2))).map_err(FigureError::new)?;
    for (point, place) in curve.points.iter().zip(&places) {
        let default = point.value == about.default;
        let (radius, colour) = if default { (7, RED) } else { (4, BLUE) };
        let unit = if default { format!(" {}, default", about.unit) } else { String::new() };
        let label = format!("{}{unit}", number(point.value));
        let element = EmptyElement::at(*place)
            + Circle::new((0, 0), radius, colour.filled())
            + Text::new(label, (10, -18), (FONT, 15).into_font().color(&colour));
        chart.draw_series(std::iter::once(element)).map_err(FigureError::new)?;
    }
    Ok(())
}

/// A logarithmic axis, labelled at round numbers. (The library's own leaves out the first decade's label.)
struct Logarithmic {
    /// Decimal logarithms of its ends.
    decades: Range<f64>,
}

impl Logarithmic {
    /// An axis around the values, with some air.
    fn around(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
        if high == 0.0 {
            return Self { decades: -1.0..1.0 };
        }
        Self { decades: low.log10() - 0.2..high.log10() + 0.2 }
    }

    /// 1, 2 and 5 times the powers of ten on the axis; on a long one, powers of ten only.
    fn ticks(&self) -> Vec<f64> {
        let digits: &[u32] = if self.decades.end - self.decades.start > 3.0 { &[1] } else { &[1, 2, 5] };
        let decades = self.decades.start.floor() as i32..=self.decades.end.ceil() as i32;
        // Parsing gives the number nearest to its decimal form, which is then printed as such.
        let number = |digit: &u32, decade: i32| format!("{digit}e{decade}").parse::<f64>().expect("a decimal number");
        let all = decades.flat_map(|decade| digits.iter().map(move |digit| number(digit, decade)));
        all.filter(|tick| self.decades.contains(&tick.log10())).collect()
    }
}

impl Ranged for Logarithmic {
    type FormatOption = plotters::coord::ranged1d::NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let Range { start, end } = self.decades;
        let fraction = (value.log10() - start) / (end - start);
        limit.0 + (fraction * f64::from(limit.1 - limit.0)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.ticks()
    }

    fn range(&self) -> Range<f64> {
        10_f64.powf(self.decades.start)..10_f64.powf(self.decades.end)
    }
}

impl ValueFormatter<f64> for Logarithmic {
    fn format(value: &f64) -> String {
        if (1e-2..1e4).contains(value) { format!("{value}") } else { format!("{value:e}") }
    }
}

#[cfg(test)]
mod tests {
    use super::super::About;
    use super::*;

    fn curve() -> Curve {
        let about =
            About { name: "step<&>", part: "part", unit: "s", scene_key: "a.b", default: 50.0, error_is: "made up" };
        let point = |value: f64| Point { value, error: value * 1e-4, spread: None, seconds: 10.0 / value };
        Curve { about, points: [200.0, 100.0, 50.0, 25.0].map(point).into() }
    }

    #[test]
    fn svg_shows_every_point_and_marks_the_default() {
        let text = svg(&[curve(), curve()]).unwrap();
        assert!(text.starts_with("<svg") && text.trim_end().ends_with("</svg>"));
        for word in ["200", "50 s, default", "CPU seconds", "error"] {
            assert!(text.contains(word), "{word} in {text}");
        }
        assert!(!text.contains("step<&>"), "names are escaped");
    }

    #[test]
    fn ticks_are_round_numbers() {
        let labels =
            |decades| -> Vec<String> { Logarithmic { decades }.ticks().iter().map(Logarithmic::format).collect() };
        assert_eq!(labels(-2.1..0.4), ["0.01", "0.02", "0.05", "0.1", "0.2", "0.5", "1", "2"]);
        assert_eq!(labels(-4.5..4.5), ["1e-4", "1e-3", "0.01", "0.1", "1", "10", "100", "1000", "1e4"]);
    }

    #[test]
    fn png_is_written_and_a_bad_path_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        save_png(&[curve()], &path).unwrap();
        assert_eq!(std::fs::read(&path).unwrap()[1..4], *b"PNG");
        assert!(save_png(&[curve()], &folder.path().join("no/such/a.png")).is_err());
    }

    #[test]
    fn points_without_cost_or_error_do_not_break_the_axes() {
        let mut flat = curve();
        flat.points.iter_mut().for_each(|p| (p.error, p.seconds) = (0.0, 0.0));
        svg(&[flat]).unwrap();
        svg(&[Curve { points: Vec::new(), ..curve() }]).unwrap();
        svg(&[]).unwrap();
    }
}
