//! The page of `yorp accuracy`: one self-contained HTML file with the figure and the numbers.

use std::fmt::Write as _;

use super::{Accuracy, Curve, number, seconds};

/// The page; `figure` is the SVG document of the same curves.
pub fn page(accuracy: &Accuracy, figure: &str) -> String {
    let mut text = String::from(HEAD);
    let _ = write!(
        text,
        "<p>Each knob is varied with everything else at its default, on bodies of {} spheres. Seconds are CPU seconds, \
         summed over threads.</p>\n{figure}\n",
        accuracy.effort.spheres()
    );
    accuracy.knobs.iter().for_each(|curve| table(&mut text, curve));
    text.push_str("</body>\n</html>\n");
    text
}

fn table(text: &mut String, curve: &Curve) {
    let about = &curve.about;
    let _ = write!(
        text,
        "<h2>{}</h2>\n<p>Set by <code>{}</code>. Error: {}.</p>\n\
         <table>\n<tr><th>{}</th><th>error</th><th>spread</th><th>CPU s</th></tr>\n",
        escaped(about.name),
        escaped(about.scene_key),
        escaped(about.error_is),
        escaped(about.unit),
    );
    for point in &curve.points {
        let mark = if point.value == about.default { " class=\"default\"" } else { "" };
        let spread = point.spread.map_or_else(String::new, |s| format!("± {s:.1e}"));
        let _ = writeln!(
            text,
            "<tr{mark}><td>{}</td><td>{:.2e}</td><td>{spread}</td><td>{}</td></tr>",
            number(point.value),
            point.error,
            seconds(point.seconds)
        );
    }
    text.push_str("</table>\n");
}

/// Text as it may stand in a page.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

const HEAD: &str = "<!DOCTYPE html>
<html lang=\"en\">
<head>
<meta charset=\"utf-8\">
<title>yorp accuracy</title>
<style>
body { font-family: sans-serif; max-width: 60em; margin: 2em auto; padding: 0 1em; color: #222; }
svg { max-width: 100%; height: auto; }
table { border-collapse: collapse; }
th, td { padding: 0.2em 0.8em; text-align: right; border-bottom: 1px solid #ddd; }
tr.default { font-weight: bold; color: #be3228; }
</style>
</head>
<body>
<h1>Error against run time</h1>
";

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
