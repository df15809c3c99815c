//! The page of `yorp accuracy`: one self-contained HTML file with the figure and the numbers.

use std::fmt::Write as _;

use super::{Accuracy, Curve, number, seconds};
use crate::report::page::{Align, Html, STYLE, inline_svg, table};

/// The page; `figure` is the SVG document of the same curves.
pub fn page(accuracy: &Accuracy, figure: &str) -> String {
    let mut text = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"generator\" content=\"yorp\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>yorp accuracy</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<h1>Error against run time</h1>\n\
         <p>Each knob is varied with everything else at its default, on bodies of {} spheres. Seconds are CPU seconds, \
         summed over threads.</p>\n<figure class=\"figure\">{}</figure>\n",
        accuracy.effort.spheres(),
        inline_svg(figure, "error against CPU seconds of each knob")
    );
    accuracy.knobs.iter().for_each(|curve| section(&mut text, curve));
    text.push_str("</body>\n</html>\n");
    text
}

fn section(text: &mut String, curve: &Curve) {
    let about = &curve.about;
    let [name, key, error_is] = [about.name, about.scene_key, about.error_is].map(Html::text);
    let columns = [about.unit, "error", "spread", "CPU s"].map(|title| (title, Align::Number));
    let rows = curve.points.iter().map(|point| {
        let spread = point.spread.map_or_else(String::new, |s| format!("± {s:.1e}"));
        let cells = vec![number(point.value), format!("{:.2e}", point.error), spread, seconds(point.seconds)];
        let class = if point.value == about.default { "default" } else { "" };
        (class, cells.into_iter().map(Html::from).collect())
    });
    let table = table(about.name, &columns, rows);
    let _ = write!(text, "<h2>{name}</h2>\n<p>Set by <code>{key}</code>. Error: {error_is}.</p>\n{table}");
}

#[cfg(test)]
mod tests {
    use super::super::{About, Effort, Point};
    use super::*;

    #[test]
    fn page_is_whole_escapes_names_and_marks_the_default() {
        let about = About {
            name: "</script><b>",
            part: "part",
            unit: "s",
            scene_key: "a.b",
            default: 50.0,
            error_is: "made up",
        };
        let point = |value| Point { value, error: 1e-3, spread: Some(1e-4), seconds: 0.5 };
        let knobs = vec![Curve { about, points: vec![point(100.0), point(50.0)] }];
        let text = page(&Accuracy { knobs, effort: Effort::Quick }, "<svg></svg>");
        assert!(text.starts_with("<!DOCTYPE html>") && text.ends_with("</html>\n"));
        assert!(text.contains("&lt;/script&gt;") && !text.contains("</script>"));
        assert_eq!(text.matches("class=\"default\"").count(), 1);
    }
}
