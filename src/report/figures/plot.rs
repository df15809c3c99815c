//! A figure as plain data: panels, axes, curves, marks and bars, before anything is drawn.

use super::palette::Colour;

/// A figure of one or several panels.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// Name of its files, without ending.
    pub name: &'static str,
    /// What it shows, in a few words.
    pub title: String,
    /// What a reader needs to know to read it.
    pub caption: String,
    /// Rows of panels from top to bottom; the panels of a row stand side by side.
    pub rows: Vec<Vec<Panel>>,
    /// Height of a panel over its row's height of reference.
    pub panel_height: f64,
    /// What colours and marks stand for, in a strip above the panels.
    pub legend: Vec<LegendEntry>,
    /// A scale of colours to the right of the panels.
    pub colour_bar: Option<ColourBar>,
}

/// Why a figure is left out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Missing {
    /// Name that the figure's files would have.
    pub name: &'static str,
    /// What it would show.
    pub title: &'static str,
    /// Why there is none.
    pub reason: String,
}

/// Two axes and what lies between them.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// What is drawn, later ones on top.
    pub layers: Vec<Layer>,
}

/// One axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Quantity with its unit.
    pub label: String,
    /// How numbers are laid along it.
    pub scale: Scale,
    /// Its ends: at least as far apart as these.
    pub range: [f64; 2],
}

/// How numbers are laid along an axis.
#[derive(Debug, Clone, PartialEq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// Evenly, with the ticks of an angle in degrees.
    Degrees,
    /// By their decimal logarithm; what is not positive has no place.
    Logarithmic,
    /// Evenly, one row for each name, from 0 at the top.
    Rows(Vec<String>),
}

/// One thing to draw.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// Where, in the units of the axes; a point that is not finite interrupts a line.
    pub points: Vec<[f64; 2]>,
    /// How.
    pub kind: Kind,
    /// In which colour.
    pub colour: Colour,
}

/// How points are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// Joined by a line of this width, px.
    Line(f64),
    /// Likewise, dashed.
    Dashed(f64),
    /// As marks of this radius, px.
    Marks(Mark, f64),
    /// As the area that they run around, in a light tint.
    Band,
    /// As horizontal bars from the left end of the axis.
    Bars,
}

/// Shape of a mark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// A filled disc.
    Disc,
    /// A filled square.
    Square,
    /// A filled diamond.
    Diamond,
    /// A filled triangle.
    Triangle,
    /// An open square.
    OpenSquare,
    /// A cross of two diagonal strokes.
    Cross,
}

/// What a colour or a mark stands for.
#[derive(Debug, Clone, PartialEq)]
pub struct LegendEntry {
    /// Words.
    pub label: String,
    /// As it is drawn.
    pub kind: Kind,
    /// Its colour.
    pub colour: Colour,
}

/// A scale of colours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColourBar {
    /// What it counts.
    pub label: &'static str,
    /// The number at its upper end; 0 is at the lower.
    pub last: u32,
}

impl Axis {
    /// An even axis around `values`, with some air.
    pub fn around(label: impl Into<String>, values: impl IntoIterator<Item = f64>) -> Self {
        let [low, high] = extent(values);
        // A constant has air of its own size, zero of one.
        let air = if high > low { 0.04 * (high - low) } else { 0.1 * low.abs() };
        let air = if air > 0.0 { air } else { 1.0 };
        Self { label: label.into(), scale: Scale::Linear, range: [low - air, high + air] }
    }

    /// An even axis from `low` to `high`.
    pub fn between(label: impl Into<String>, low: f64, high: f64) -> Self {
        Self { label: label.into(), scale: Scale::Linear, range: [low, high] }
    }

    /// All obliquities.
    pub fn obliquity() -> Self {
        Self { label: "Obliquity (deg)".into(), scale: Scale::Degrees, range: [0.0, 180.0] }
    }

    /// A logarithmic axis around the positive ones of `values`, with some air.
    pub fn logarithmic(label: impl Into<String>, values: impl IntoIterator<Item = f64>) -> Self {
        let positive = values.into_iter().filter(|v| v.is_finite() && *v > 0.0).map(f64::log10);
        let [low, high] = extent(positive);
        let air = (0.04 * (high - low)).max(0.15);
        // Halves keep the ends of the axis within what a double holds.
        let range = [low - air, high + air].map(|decade| 10_f64.powf(decade.clamp(-300.0, 300.0)));
        Self { label: label.into(), scale: Scale::Logarithmic, range }
    }

    /// One row for each name.
    pub fn rows(names: Vec<String>) -> Self {
        let range = [names.len() as f64 - 0.5, -0.5];
        Self { label: String::new(), scale: Scale::Rows(names), range }
    }

    /// Place of `value` along the axis: 0 at its first end, 1 at its second; `None` if it has none.
    pub fn place(&self, value: f64) -> Option<f64> {
        let [low, high] = self.range;
        let place = match self.scale {
            Scale::Linear | Scale::Degrees | Scale::Rows(_) => (value - low) / (high - low),
            Scale::Logarithmic => (value / low).log10() / (high / low).log10(),
        };
        place.is_finite().then_some(place)
    }
}

/// Smallest and largest of the finite values; 0 and 0 if there are none.
pub fn extent(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let finite = values.into_iter().filter(|v| v.is_finite());
    let [low, high] = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(v), h.max(v)]);
    if low <= high { [low, high] } else { [0.0, 0.0] }
}

impl Layer {
    /// A line through `points`.
    pub fn line(points: Vec<[f64; 2]>, width: f64, colour: Colour) -> Self {
        Self { points, kind: Kind::Line(width), colour }
    }

    /// Marks at `points`.
    pub fn marks(points: Vec<[f64; 2]>, mark: Mark, radius: f64, colour: Colour) -> Self {
        Self { points, kind: Kind::Marks(mark, radius), colour }
    }
}

impl Missing {
    /// Why `name` is left out.
    pub fn new(name: &'static str, title: &'static str, reason: impl Into<String>) -> Self {
        Self { name, title, reason: reason.into() }
    }
}
