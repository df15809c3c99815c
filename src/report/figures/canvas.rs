//! Drawing in pixels of the page, whatever the number of dots per pixel: lines, marks, bars and text.

use std::sync::Once;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::FontStyle;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::palette::Colour;
use super::plot::Mark;

/// The shipped font, with names under which other programs know it or its like, for the text of an SVG file.
const FONT: &str = "DejaVu Sans, Verdana, sans-serif";

/// A figure that could not be drawn.
#[derive(Debug, thiserror::Error)]
#[error("the figure cannot be drawn: {message}")]
pub struct FigureError {
    /// What the drawing library said.
    message: String,
}

fn failed(error: impl std::fmt::Display) -> FigureError {
    FigureError { message: error.to_string() }
}

/// Where text stands with respect to its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    /// To the right of it.
    Left,
    /// To the left of it.
    Right,
    /// Below it.
    Top,
    /// Around it, read from below.
    Rotated,
}

/// An area to draw on.
pub(super) struct Canvas<'a, B: DrawingBackend> {
    area: &'a DrawingArea<B, Shift>,
    scale: f64,
    /// By how much of its size the backend sets words above where they should be.
    lift: f64,
}

type Point = [f64; 2];

impl<'a, B: DrawingBackend> Canvas<'a, B> {
    /// A white canvas with `scale` dots per pixel, whose backend sets words `lift` of their size too high.
    pub(super) fn new(area: &'a DrawingArea<B, Shift>, scale: f64, lift: f64) -> Result<Self, FigureError> {
        static REGISTERED: Once = Once::new();
        // The library looks for no fonts on the system; it draws with what it is given.
        REGISTERED.call_once(|| {
            let font = include_bytes!("../../../assets/fonts/DejaVuSans.ttf");
            assert!(plotters::style::register_font(FONT, FontStyle::Normal, font).is_ok(), "the font is a valid one");
        });
        area.fill(&WHITE).map_err(failed)?;
        Ok(Self { area, scale, lift })
    }

    /// Finishes the figure.
    pub(super) fn present(&self) -> Result<(), FigureError> {
        self.area.present().map_err(failed)
    }

    fn dot(&self, point: Point) -> (i32, i32) {
        let [x, y] = point.map(|v| (v * self.scale).round() as i32);
        (x, y)
    }

    fn style(colour: Colour) -> RGBColor {
        RGBColor(colour[0], colour[1], colour[2])
    }

    /// A line through `points`; one that does not advance by a fair part of a pixel is left out.
    pub(super) fn line(&self, points: &[Point], width: f64, colour: Colour) -> Result<(), FigureError> {
        let style = Self::style(colour).stroke_width((width * self.scale).round().max(1.0) as u32);
        let mut dots: Vec<(i32, i32)> = points.iter().map(|p| self.dot(*p)).collect();
        dots.dedup();
        if dots.len() < 2 {
            return Ok(());
        }
        if self.lift == 0.0 {
            return self.area.draw(&PathElement::new(dots, style)).map_err(failed);
        }
        // Bitmaps fill a line's outline, and where it crosses itself leave holes: each piece is drawn alone.
        dots.windows(2).try_for_each(|piece| self.area.draw(&PathElement::new(piece.to_vec(), style)).map_err(failed))
    }

    /// A line of dashes.
    pub(super) fn dashed(&self, points: &[Point], width: f64, colour: Colour) -> Result<(), FigureError> {
        for dash in dashes(points, 7.0, 4.0) {
            self.line(&dash, width, colour)?;
        }
        Ok(())
    }

    /// A filled rectangle between two corners.
    pub(super) fn bar(&self, corners: [Point; 2], colour: Colour) -> Result<(), FigureError> {
        let corners = corners.map(|corner| self.dot(corner));
        self.area.draw(&Rectangle::new(corners, Self::style(colour).filled())).map_err(failed)
    }

    /// The area within `corners`, in a light tint of `colour`.
    pub(super) fn area(&self, corners: &[Point], colour: Colour) -> Result<(), FigureError> {
        let tint = colour.map(|c| (0.3 * f64::from(c) + 0.7 * 255.0).round() as u8);
        let dots: Vec<_> = corners.iter().map(|c| self.dot(*c)).collect();
        self.area.draw(&Polygon::new(dots, Self::style(tint).filled())).map_err(failed)
    }

    /// A mark around a point.
    pub(super) fn mark(&self, at: Point, mark: Mark, radius: f64, colour: Colour) -> Result<(), FigureError> {
        let corner = |x: f64, y: f64| [at[0] + radius * x, at[1] + radius * y];
        let filled = |corners: &[Point]| {
            let dots: Vec<_> = corners.iter().map(|c| self.dot(*c)).collect();
            self.area.draw(&Polygon::new(dots, Self::style(colour).filled())).map_err(failed)
        };
        match mark {
            Mark::Disc => {
                let dots = (radius * self.scale).round() as i32;
                let disc = Circle::new(self.dot(at), dots, Self::style(colour).filled());
                self.area.draw(&disc).map_err(failed)
            }
            Mark::Square => self.bar([corner(-0.9, -0.9), corner(0.9, 0.9)], colour),
            Mark::Diamond => filled(&[corner(0.0, -1.2), corner(1.2, 0.0), corner(0.0, 1.2), corner(-1.2, 0.0)]),
            Mark::Triangle => filled(&[corner(0.0, -1.2), corner(1.1, 0.8), corner(-1.1, 0.8)]),
            Mark::OpenSquare => {
                let around = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)];
                self.line(&around.map(|(x, y)| corner(x, y)), 1.4, colour)
            }
            Mark::Cross => {
                self.line(&[corner(-1.0, -1.0), corner(1.0, 1.0)], 1.8, colour)?;
                self.line(&[corner(-1.0, 1.0), corner(1.0, -1.0)], 1.8, colour)
            }
        }
    }

    /// Words at a point.
    pub(super) fn text(&self, words: &str, at: Point, anchor: Anchor, size: f64) -> Result<(), FigureError> {
        let (across, along) = match anchor {
            Anchor::Left => (HPos::Left, VPos::Center),
            Anchor::Right => (HPos::Right, VPos::Center),
            Anchor::Top => (HPos::Center, VPos::Top),
            Anchor::Rotated => (HPos::Center, VPos::Center),
        };
        let style = self.text_style(size).pos(Pos::new(across, along));
        let (style, lift) = match anchor {
            Anchor::Rotated => (style.transform(FontTransform::Rotate270), [self.lift * size, 0.0]),
            Anchor::Top => (style, [0.0, 0.0]),
            Anchor::Left | Anchor::Right => (style, [0.0, self.lift * size]),
        };
        let at = self.dot([at[0] + lift[0], at[1] + lift[1]]);
        self.area.draw(&Text::new(words.to_owned(), at, style)).map_err(failed)
    }

    /// Width of words, px.
    pub(super) fn text_width(&self, words: &str, size: f64) -> Result<f64, FigureError> {
        let (width, _) = self.area.estimate_text_size(words, &self.text_style(size)).map_err(failed)?;
        Ok(f64::from(width) / self.scale)
    }

    /// The library's sizes are heights of a line; a font's size is smaller by this.
    fn text_style(&self, size: f64) -> TextStyle<'static> {
        const LINE: f64 = 1.24;
        TextStyle::from((FONT, size * LINE * self.scale)).color(&plotters::style::BLACK)
    }
}

/// Pieces of a line, `on` long and `off` apart.
fn dashes(points: &[Point], on: f64, off: f64) -> Vec<Vec<Point>> {
    let mut pieces = Vec::new();
    let mut piece: Vec<Point> = points.first().copied().into_iter().collect();
    let (mut drawing, mut left) = (true, on);
    for pair in points.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let mut done = 0.0;
        while length - done >= left {
            done += left;
            let at = std::array::from_fn(|k| from[k] + (to[k] - from[k]) * done / length);
            if drawing {
                piece.push(at);
                pieces.push(std::mem::take(&mut piece));
            } else {
                piece = vec![at];
            }
            drawing = !drawing;
            left = if drawing { on } else { off };
        }
        left -= length - done;
        if drawing {
            piece.push(to);
        }
    }
    pieces.push(piece);
    pieces.retain(|piece| piece.len() > 1);
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_follow_the_line_around_a_corner() {
        let pieces = dashes(&[[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]], 4.0, 2.0);
        assert_eq!(pieces.len(), 4);
        assert_eq!(pieces[0], [[0.0, 0.0], [4.0, 0.0]]);
        assert_eq!(pieces[1], [[6.0, 0.0], [10.0, 0.0]]);
        assert_eq!(pieces[3], [[10.0, 8.0], [10.0, 10.0]]);
        assert!(dashes(&[[0.0, 0.0]], 4.0, 2.0).is_empty());
    }
}
