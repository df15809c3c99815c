//! Draws a [`Plot`]: panels with ticks on all sides, legend above them, colour scale beside them.
//!
//! Nothing is drawn over the data: the strips around the panels are as wide as their words need.

use plotters::coord::Shift;
use plotters::prelude::{BitMapBackend, DrawingArea, DrawingBackend, IntoDrawingArea, SVGBackend};

use super::canvas::{Anchor, Canvas, FigureError};
use super::palette::{BLACK, GRID, sequential};
use super::plot::{Axis, Kind, Layer, LegendEntry, Mark, Panel, Plot, Scale};
use super::ticks::{Tick, ticks};

/// Width of a figure with one column of panels, px; a second column adds four fifths of it.
const WIDTH: f64 = 700.0;
const TICK_TEXT: f64 = 14.0;
const LABEL_TEXT: f64 = 16.0;
/// White around everything.
const MARGIN: f64 = 12.0;
/// Between panels that stand above each other without words in between.
const GAP: f64 = 14.0;
/// A row of the legend.
const LEGEND_ROW: f64 = 24.0;
/// Room for the colour scale.
const BAR_WIDTH: f64 = 92.0;
/// Tick labels and axis label below a panel.
const BELOW: f64 = 56.0;

/// An SVG document is drawn on whole dots: so many for each of its pixels.
const SVG_DOTS: f64 = 8.0;
/// Dots of a PNG image for each pixel of the page.
const PNG_DOTS: usize = 2;
/// Each of these is the mean of so many dots squared, for smooth edges.
const PNG_FINER: usize = 3;
/// The drawing library centres the line, with its room for descenders, instead of the letters.
const PNG_LIFT: f64 = 0.2;

/// The figure as an SVG document.
///
/// # Errors
/// If the drawing library fails.
pub fn svg(plot: &Plot) -> Result<String, FigureError> {
    let [width, height] = size(plot);
    let dots = [width, height].map(|v| (v * SVG_DOTS) as u32);
    let mut text = String::new();
    draw(&SVGBackend::with_string(&mut text, dots.into()).into_drawing_area(), plot, SVG_DOTS, 0.0)?;
    let [wide, high] = dots;
    let large = format!("<svg width=\"{wide}\" height=\"{high}\"");
    // Whole dots in the drawing, but the size of a page outside; a page that gives it less room shrinks it.
    let small = format!("<svg width=\"{width}\" height=\"{height}\" style=\"max-width:100%;height:auto\"");
    Ok(text.replacen(&large, &small, 1))
}

/// The figure as an image: its width and height, and its rows of red, green and blue bytes.
///
/// # Errors
/// If the drawing library fails.
pub fn image(plot: &Plot) -> Result<(u32, u32, Vec<u8>), FigureError> {
    let finer = PNG_DOTS * PNG_FINER;
    let [width, height] = size(plot).map(|v| v as usize * PNG_DOTS);
    let wide = width * PNG_FINER;
    let mut dots = vec![0; 3 * wide * height * PNG_FINER];
    let area = BitMapBackend::with_buffer(&mut dots, (wide as u32, (height * PNG_FINER) as u32)).into_drawing_area();
    draw(&area, plot, finer as f64, PNG_LIFT)?;
    drop(area);
    let mean = |(y, x, k): (usize, usize, usize)| {
        let block =
            (0..PNG_FINER * PNG_FINER).map(|i| (y * PNG_FINER + i / PNG_FINER) * wide + x * PNG_FINER + i % PNG_FINER);
        let sum: usize = block.map(|dot| usize::from(dots[3 * dot + k])).sum();
        (sum / (PNG_FINER * PNG_FINER)) as u8
    };
    let pixels = (0..height).flat_map(|y| (0..width).flat_map(move |x| (0..3).map(move |k| (y, x, k)))).map(mean);
    Ok((width as u32, height as u32, pixels.collect()))
}

/// Width and height of the figure, px, whole numbers.
fn size(plot: &Plot) -> [f64; 2] {
    let columns = plot.rows.iter().map(Vec::len).max().unwrap_or(1).max(1);
    let width = WIDTH * (0.2 + 0.8 * columns as f64) + if plot.colour_bar.is_some() { BAR_WIDTH } else { 0.0 };
    let panels: f64 =
        (0..plot.rows.len()).map(|row| plot.panel_height + if labelled(plot, row) { BELOW } else { GAP }).sum();
    [width.round(), (2.0 * MARGIN + panels + LEGEND_ROW * legend_rows(plot, width).len() as f64).round()]
}

/// Whether words stand below a row of panels: not where the row below has the same horizontal axes.
fn labelled(plot: &Plot, row: usize) -> bool {
    let axes = |row: usize| plot.rows.get(row).map(|panels| panels.iter().map(|p| &p.x).collect::<Vec<_>>());
    axes(row) != axes(row + 1)
}

/// The legend in rows that are no wider than the figure; widths of words are estimated from above.
fn legend_rows(plot: &Plot, width: f64) -> Vec<Vec<&LegendEntry>> {
    let mut rows: Vec<Vec<&LegendEntry>> = Vec::new();
    let mut used = f64::INFINITY;
    for entry in &plot.legend {
        let needed = legend_width(entry);
        if used + needed > width - 2.0 * MARGIN {
            rows.push(Vec::new());
            used = 0.0;
        }
        used += needed;
        rows.last_mut().expect("the first entry makes a row").push(entry);
    }
    rows
}

/// Room for an entry: its sample and its words, by how wide letters are at most.
fn legend_width(entry: &LegendEntry) -> f64 {
    let letter = |c: char| match c {
        'i' | 'j' | 'l' | 't' | 'f' | 'r' | ' ' | '.' | ',' | '(' | ')' | '/' | '-' => 0.42,
        'm' | 'w' | 'M' | 'W' => 1.0,
        _ => 0.64,
    };
    56.0 + TICK_TEXT * entry.label.chars().map(letter).sum::<f64>()
}

/// A panel's place on the page.
struct Frame {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Frame {
    /// The point at `place`, each coordinate 0 to 1 from the lower left corner.
    fn at(&self, place: [f64; 2]) -> [f64; 2] {
        [self.left + place[0] * (self.right - self.left), self.bottom + place[1] * (self.top - self.bottom)]
    }
}

fn draw<B: DrawingBackend>(area: &DrawingArea<B, Shift>, plot: &Plot, dots: f64, lift: f64) -> Result<(), FigureError> {
    let canvas = Canvas::new(area, dots, lift)?;
    let [width, _] = size(plot);
    let right = width - MARGIN - if plot.colour_bar.is_some() { BAR_WIDTH } else { 0.0 };
    let columns = plot.rows.iter().map(Vec::len).max().unwrap_or(1).max(1);
    let column_width = (right - MARGIN) / columns as f64;
    let legend = legend_rows(plot, width);
    let top = MARGIN + LEGEND_ROW * legend.len() as f64;

    // Panels of a column have a common left end.
    let mut lefts = vec![0.0_f64; columns];
    let room =
        |panel: &Panel| (plot.panel_height / 42.0).max(2.0) as usize * usize::from(!panel.layers.is_empty()).max(1);
    for (column, panel) in plot.rows.iter().flat_map(|row| row.iter().enumerate()) {
        for tick in ticks(&panel.y, room(panel)) {
            let words = tick.label.map_or(Ok(0.0), |label| canvas.text_width(&label, TICK_TEXT))?;
            lefts[column] = lefts[column].max(words + 12.0);
        }
    }

    let mut y = top;
    for (row, panels) in plot.rows.iter().enumerate() {
        let with_words = labelled(plot, row);
        for (column, panel) in panels.iter().enumerate() {
            let from = MARGIN + column_width * column as f64;
            let label = if panel.y.label.is_empty() { 0.0 } else { LABEL_TEXT + 8.0 };
            // The last tick label needs room to its right.
            let frame = Frame {
                left: from + label + lefts[column],
                right: from + column_width - 18.0,
                top: y + 6.0,
                bottom: y + plot.panel_height,
            };
            draw_panel(&canvas, panel, &frame, from, with_words)?;
        }
        y += plot.panel_height + if with_words { BELOW } else { GAP };
    }
    let first_left = MARGIN + lefts.first().copied().unwrap_or_default() + LABEL_TEXT + 8.0;
    draw_legend(&canvas, &legend, first_left.min(0.2 * width))?;
    if let Some(bar) = plot.colour_bar {
        let last_words =
            plot.rows.len().checked_sub(1).map_or(0.0, |row| if labelled(plot, row) { BELOW } else { GAP });
        draw_colour_bar(&canvas, bar.label, bar.last, [right + 12.0, top + 6.0, y - last_words])?;
    }
    canvas.present()
}

fn draw_panel<B: DrawingBackend>(
    canvas: &Canvas<B>,
    panel: &Panel,
    frame: &Frame,
    left: f64,
    with_words: bool,
) -> Result<(), FigureError> {
    let (across, up) = ((frame.right - frame.left) / 80.0, (frame.bottom - frame.top) / 42.0);
    let x_ticks = ticks(&panel.x, across as usize);
    let y_ticks = ticks(&panel.y, (up as usize).max(2));
    let placed = |axis: &Axis, ticks: &[Tick]| -> Vec<(f64, Tick)> {
        let within = ticks.iter().filter_map(|t| axis.place(t.value).map(|place| (place, t.clone())));
        within.filter(|(place, _)| (-1e-9..=1.0 + 1e-9).contains(place)).collect()
    };
    let (x_ticks, y_ticks) = (placed(&panel.x, &x_ticks), placed(&panel.y, &y_ticks));
    for (place, _) in x_ticks.iter().filter(|(_, tick)| tick.label.is_some()) {
        canvas.line(&[frame.at([*place, 0.0]), frame.at([*place, 1.0])], 1.0, GRID)?;
    }
    for (place, _) in y_ticks.iter().filter(|(_, tick)| tick.label.is_some()) {
        canvas.line(&[frame.at([0.0, *place]), frame.at([1.0, *place])], 1.0, GRID)?;
    }
    for layer in &panel.layers {
        draw_layer(canvas, panel, layer, frame)?;
    }
    let border = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]].map(|corner| frame.at(corner));
    canvas.line(&border, 1.2, BLACK)?;
    for (place, tick) in &x_ticks {
        let long = if tick.label.is_some() { 6.0 } else { 3.0 };
        let [x, bottom] = frame.at([*place, 0.0]);
        canvas.line(&[[x, bottom], [x, bottom - long]], 1.0, BLACK)?;
        canvas.line(&[[x, frame.top], [x, frame.top + long]], 1.0, BLACK)?;
        if let Some(label) = tick.label.as_ref().filter(|_| with_words) {
            canvas.text(label, [x, bottom + 9.0], Anchor::Top, TICK_TEXT)?;
        }
    }
    let has_rows = matches!(panel.y.scale, Scale::Rows(_));
    for (place, tick) in &y_ticks {
        let long = if tick.label.is_some() { 6.0 } else { 3.0 };
        let [x, y] = frame.at([0.0, *place]);
        if !has_rows {
            canvas.line(&[[x, y], [x + long, y]], 1.0, BLACK)?;
            canvas.line(&[[frame.right, y], [frame.right - long, y]], 1.0, BLACK)?;
        }
        if let Some(label) = &tick.label {
            canvas.text(label, [x - 7.0, y], Anchor::Right, TICK_TEXT)?;
        }
    }
    if with_words {
        canvas.text(
            &panel.x.label,
            [(frame.left + frame.right) / 2.0, frame.bottom + 30.0],
            Anchor::Top,
            LABEL_TEXT,
        )?;
    }
    canvas.text(
        &panel.y.label,
        [left + LABEL_TEXT / 2.0 + 1.0, (frame.top + frame.bottom) / 2.0],
        Anchor::Rotated,
        LABEL_TEXT,
    )
}

fn draw_layer<B: DrawingBackend>(
    canvas: &Canvas<B>,
    panel: &Panel,
    layer: &Layer,
    frame: &Frame,
) -> Result<(), FigureError> {
    let place = |p: &[f64; 2]| Some([panel.x.place(p[0])?, panel.y.place(p[1])?]);
    match layer.kind {
        Kind::Line(width) | Kind::Dashed(width) => {
            let places: Vec<_> = layer.points.iter().map(place).collect();
            for piece in clipped(&places) {
                let points: Vec<_> = thinned(piece.into_iter().map(|p| frame.at(p)));
                match layer.kind {
                    Kind::Dashed(_) => canvas.dashed(&points, width, layer.colour)?,
                    _ => canvas.line(&points, width, layer.colour)?,
                }
            }
        }
        Kind::Marks(mark, radius) => {
            for at in layer.points.iter().filter_map(place).filter(|p| p.iter().all(|v| (0.0..=1.0).contains(v))) {
                canvas.mark(frame.at(at), mark, radius, layer.colour)?;
            }
        }
        Kind::Band => {
            let corners: Vec<_> = layer.points.iter().filter_map(place).map(|p| p.map(|v| v.clamp(0.0, 1.0))).collect();
            let points: Vec<_> = corners.into_iter().map(|p| frame.at(p)).collect();
            canvas.area(&points, layer.colour)?;
        }
        Kind::Bars => {
            let rows = (panel.y.range[1] - panel.y.range[0]).abs();
            for [x, y] in layer.points.iter().filter_map(place) {
                let ends = [[0.0, y - 0.32 / rows], [x.clamp(0.0, 1.0), y + 0.32 / rows]];
                canvas.bar(ends.map(|end| frame.at(end)), layer.colour)?;
            }
        }
    }
    Ok(())
}

/// The parts of a line of places that lie in the unit square.
fn clipped(places: &[Option<[f64; 2]>]) -> Vec<Vec<[f64; 2]>> {
    let mut pieces: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut whole = false;
    for pair in places.windows(2) {
        let segment = match pair {
            [Some(from), Some(to)] => clipped_segment(*from, *to),
            _ => None,
        };
        let Some([from, to]) = segment else {
            whole = false;
            continue;
        };
        match pieces.last_mut().filter(|_| whole && pair[0] == Some(from)) {
            Some(piece) => piece.push(to),
            None => pieces.push(vec![from, to]),
        }
        whole = pair[1] == Some(to);
    }
    pieces
}

/// Liang and Barsky (1984).
fn clipped_segment(from: [f64; 2], to: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for k in 0..2 {
        let step = to[k] - from[k];
        for (towards, room) in [(-step, from[k]), (step, 1.0 - from[k])] {
            if towards == 0.0 {
                if room < 0.0 {
                    return None;
                }
            } else if towards < 0.0 {
                enter = enter.max(room / towards);
            } else {
                leave = leave.min(room / towards);
            }
        }
    }
    let at = |share: f64| match share {
        0.0 => from,
        1.0 => to,
        _ => std::array::from_fn(|k| from[k] + share * (to[k] - from[k])),
    };
    (enter <= leave).then(|| [at(enter), at(leave)])
}

/// A line without the points that nobody could see: those within a fifth of a pixel of the one before.
fn thinned(points: impl Iterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    let mut kept: Vec<[f64; 2]> = Vec::new();
    let mut skipped = None;
    for point in points {
        match kept.last() {
            Some(last) if (point[0] - last[0]).hypot(point[1] - last[1]) < 0.2 => skipped = Some(point),
            _ => {
                kept.push(point);
                skipped = None;
            }
        }
    }
    kept.extend(skipped);
    kept
}

fn draw_legend<B: DrawingBackend>(
    canvas: &Canvas<B>,
    rows: &[Vec<&LegendEntry>],
    left: f64,
) -> Result<(), FigureError> {
    let needed = |entries: &Vec<&LegendEntry>| entries.iter().map(|e| legend_width(e)).sum::<f64>();
    // Full rows start at the margin, short ones above the panel.
    let start = if rows.iter().all(|entries| left + needed(entries) < WIDTH) { left } else { MARGIN };
    for (row, entries) in rows.iter().enumerate() {
        let mut x = start;
        let y = MARGIN + LEGEND_ROW * (row as f64 + 0.4);
        for entry in entries {
            match entry.kind {
                Kind::Line(width) => canvas.line(&[[x, y], [x + 28.0, y]], width, entry.colour)?,
                Kind::Dashed(width) => canvas.dashed(&[[x, y], [x + 28.0, y]], width, entry.colour)?,
                Kind::Marks(mark, radius) => canvas.mark([x + 18.0, y], mark, radius.max(3.5), entry.colour)?,
                Kind::Bars => canvas.mark([x + 18.0, y], Mark::Square, 6.0, entry.colour)?,
                Kind::Band => canvas
                    .area(&[[x, y - 5.0], [x + 28.0, y - 5.0], [x + 28.0, y + 5.0], [x, y + 5.0]], entry.colour)?,
            }
            canvas.text(&entry.label, [x + 34.0, y], Anchor::Left, TICK_TEXT)?;
            x += legend_width(entry);
        }
    }
    Ok(())
}

/// `place` is left end, top and bottom.
fn draw_colour_bar<B: DrawingBackend>(
    canvas: &Canvas<B>,
    label: &str,
    last: u32,
    [left, top, bottom]: [f64; 3],
) -> Result<(), FigureError> {
    const STEPS: u32 = 64;
    // Few colours are shown one by one.
    let steps = if last < STEPS { last + 1 } else { STEPS };
    let y = |fraction: f64| bottom + fraction * (top - bottom);
    for step in 0..steps {
        let [from, to] = [step, step + 1].map(|s| y(f64::from(s) / f64::from(steps)));
        let fraction = if steps > 1 { f64::from(step) / f64::from(steps - 1) } else { 0.0 };
        canvas.bar([[left, to], [left + 16.0, from]], sequential(fraction))?;
    }
    let border = [[left, top], [left + 16.0, top], [left + 16.0, bottom], [left, bottom], [left, top]];
    canvas.line(&border, 1.0, BLACK)?;
    let axis = Axis::between("", -0.5, f64::from(last) + 0.5);
    for tick in ticks(&axis, 6) {
        // Numbers of configurations are whole.
        let (Some(place), true) = (axis.place(tick.value), tick.value.fract() == 0.0) else { continue };
        let words = format!("{}", tick.value);
        canvas.text(&words, [left + 22.0, y(place)], Anchor::Left, TICK_TEXT)?;
    }
    canvas.text(label, [left + 70.0, (top + bottom) / 2.0], Anchor::Rotated, LABEL_TEXT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_cut_at_the_panel_and_interrupted_where_they_have_no_place() {
        let inside = clipped(&[Some([0.2, 0.2]), Some([0.8, 0.2]), Some([0.8, 1.7]), Some([0.4, 0.5])]);
        assert_eq!(inside.len(), 2);
        assert_eq!(inside[0], [[0.2, 0.2], [0.8, 0.2], [0.8, 1.0]]);
        assert_eq!(inside[1][1], [0.4, 0.5]);
        assert!(clipped(&[Some([-1.0, 0.5]), Some([-0.1, 3.0])]).is_empty());
        let broken = clipped(&[Some([0.1, 0.1]), Some([0.2, 0.1]), None, Some([0.3, 0.1]), Some([0.4, 0.1])]);
        assert_eq!(broken.iter().map(Vec::len).collect::<Vec<_>>(), [2, 2]);
    }

    #[test]
    fn points_that_nobody_could_see_are_left_out_but_not_the_end() {
        let fine = (0..1000).map(|i| [f64::from(i) * 0.01, 0.0]);
        let kept = thinned(fine);
        assert!(kept.len() < 60);
        assert_eq!(kept.last(), Some(&[9.99, 0.0]));
    }
}
