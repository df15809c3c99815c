//! Text as it may stand in a page: everything from a file or a scene passes through here.

use std::fmt::Write as _;

/// A piece of HTML; the only way from outside text to it is [`Html::text`], which escapes.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Html(String);

impl Html {
    /// Text, escaped so that it stays text in elements and in quoted attributes.
    pub fn text(text: &str) -> Self {
        let mut escaped = String::with_capacity(text.len());
        for character in text.chars() {
            match character {
                '&' => escaped.push_str("&amp;"),
                '<' => escaped.push_str("&lt;"),
                '>' => escaped.push_str("&gt;"),
                '"' => escaped.push_str("&quot;"),
                '\'' => escaped.push_str("&#39;"),
                _ => escaped.push(character),
            }
        }
        Self(escaped)
    }

    /// Markup of this program's own making.
    pub fn markup(markup: impl Into<String>) -> Self {
        Self(markup.into())
    }

    /// Its source text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl std::fmt::Display for Html {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl From<String> for Html {
    fn from(text: String) -> Self {
        Self::text(&text)
    }
}

impl From<&str> for Html {
    fn from(text: &str) -> Self {
        Self::text(text)
    }
}

/// An SVG document as part of a page, `label` for those who do not see it.
///
/// Inside a page it needs no name space; its name, the page's only address, would look like a link to outside.
pub fn inline_svg(svg: &str, label: &str) -> Html {
    let start = svg.find("<svg ").unwrap_or(0);
    let named = format!("<svg role=\"img\" aria-label=\"{}\" ", Html::text(label));
    Html(svg[start..].replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1).replacen("<svg ", &named, 1))
}

/// `value` as JSON that may stand inside a `script` element: no `<` is left that could end it.
pub fn script_json(value: &impl serde::Serialize) -> String {
    serde_json::to_string(value).expect("plain data with string keys").replace('<', "\\u003c")
}

/// How the cells of a column are set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// Words.
    Text,
    /// Numbers, to the right.
    Number,
}

/// A table under `columns` in a frame that scrolls by itself, also with the keyboard; `label` says what it holds.
pub fn table(
    label: &str,
    columns: &[(&str, Align)],
    rows: impl IntoIterator<Item = (&'static str, Vec<Html>)>,
) -> Html {
    let class = |align: Align| if align == Align::Number { " class=\"number\"" } else { "" };
    let label = Html::text(label);
    let mut text =
        format!("<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{label}\"><table>\n<thead><tr>");
    for (title, align) in columns {
        let _ = write!(text, "<th scope=\"col\"{}>{}</th>", class(*align), Html::text(title));
    }
    text.push_str("</tr></thead>\n<tbody>\n");
    for (row_class, cells) in rows {
        text.push_str(if row_class.is_empty() { "<tr>" } else { "<tr class=\"" });
        if !row_class.is_empty() {
            let _ = write!(text, "{row_class}\">");
        }
        for (cell, (_, align)) in cells.iter().zip(columns) {
            let _ = write!(text, "<td{}>{cell}</td>", class(*align));
        }
        text.push_str("</tr>\n");
    }
    text.push_str("</tbody></table></div>\n");
    Html(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_stays_text() {
        assert_eq!(Html::text("<b a=\"'\">&").as_str(), "&lt;b a=&quot;&#39;&quot;&gt;&amp;");
    }

    #[test]
    fn json_cannot_end_its_script() {
        let json = script_json(&"</script><!--");
        assert!(!json.contains('<'));
        assert_eq!(serde_json::from_str::<String>(&json).unwrap(), "</script><!--");
    }

    #[test]
    fn figures_come_without_address_and_with_a_label() {
        let svg = "<?xml version=\"1.0\"?><svg width=\"9\" xmlns=\"http://www.w3.org/2000/svg\"><g/></svg>";
        let inline = inline_svg(svg, "a\"<b>").to_string();
        assert_eq!(inline, "<svg role=\"img\" aria-label=\"a&quot;&lt;b&gt;\" width=\"9\"><g/></svg>");
    }

    #[test]
    fn tables_escape_what_they_are_given() {
        let rows = [("", vec!["<x>".into(), Html::markup("<i>1</i>")]), ("quiet", vec!["a".into(), "b".into()])];
        let table = table("t", &[("a", Align::Text), ("b", Align::Number)], rows).to_string();
        assert!(table.contains("<td>&lt;x&gt;</td><td class=\"number\"><i>1</i></td>"), "{table}");
        assert!(table.contains("<tr class=\"quiet\"><td>a</td>"), "{table}");
    }
}
