//! The page of a run: one HTML file that needs nothing else, neither network nor scripts for its text and figures.
//!
//! Layout, style and scripts are files of `assets/report/`; this folder fills them with a run.

mod classification;
mod costs;
mod html;
mod path;
mod points;
mod scene;
mod several;
mod summary;
mod tables;
mod view;

use std::fmt::Write as _;

pub use costs::part_error;
pub use html::{Align, Html, inline_svg, table};

use super::RunData;
use view::View;

/// The style sheet of all pages of this program.
pub const STYLE: &str = include_str!("../../../assets/report/style.css");
const TEMPLATE: &str = include_str!("../../../assets/report/page.html");
const VIEW3D: &str = include_str!("../../../assets/report/view3d.js");
const TIMELINE: &str = include_str!("../../../assets/report/timeline.js");
const VIEWER: &str = include_str!("../../../assets/report/viewer.js");

/// A figure as the page shows it.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Name of its files in the folder `figures`, without ending.
    pub name: &'static str,
    /// What it shows, as a headline.
    pub title: String,
    /// What to see in it.
    pub caption: String,
    /// Whether it needs the whole width of the page.
    pub wide: bool,
    /// SVG document.
    pub svg: String,
}

/// What stands in the page besides the run itself.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Extras {
    /// Figures, in this order.
    pub pictures: Vec<Picture>,
    /// Figures that the run has no data for, and why.
    pub left_out: Vec<(String, String)>,
    /// For a run that goes on: after how many seconds the page is loaded again.
    pub fresh_every_s: Option<u32>,
}

/// The page of `run`.
pub fn page(run: &RunData, extras: &Extras) -> String {
    let view = View::of(run);
    let title = Html::text(if run.scene.name.is_empty() { "a run without a name" } else { &run.scene.name });
    fill_page(&title, body(run, extras, view.as_ref(), &title), extras, true)
}

/// The page that puts several runs together.
pub fn page_of_several(runs: &[RunData], extras: &Extras) -> String {
    let title = Html::text(&format!("{} runs", runs.len()));
    let sections = [
        section("figures", "Figures", pictures(extras)),
        section("runs", "The runs", Some(several::runs(runs).to_string())),
    ];
    let body = framed(&title, "", &sections.into_iter().flatten().collect::<Vec<_>>(), &foot(crate::VERSION, None));
    fill_page(&title, body, extras, false)
}

/// The template with this body; without a view it has no scripts.
fn fill_page(title: &Html, body: String, extras: &Extras, with_view: bool) -> String {
    let script = |text: &str| if with_view { text.to_owned() } else { String::new() };
    let fill = |slot: &str| match slot {
        "title" => title.to_string(),
        "version" => Html::text(env!("CARGO_PKG_VERSION")).to_string(),
        "live" => extras.fresh_every_s.map_or(String::new(), |s| format!(" data-fresh-every=\"{s}\"")),
        "refresh" => extras
            .fresh_every_s
            .map_or(String::new(), |s| format!("<noscript><meta http-equiv=\"refresh\" content=\"{s}\"></noscript>\n")),
        "style" => STYLE.to_owned(),
        "body" => body.clone(),
        "view3d" => script(VIEW3D),
        "timeline" => script(TIMELINE),
        "viewer" => script(VIEWER),
        _ => unreachable!("the template has no other slot"),
    };
    filled(TEMPLATE, fill)
}

/// `template` with each `{{slot}}` replaced once; what is put in is not looked at again.
fn filled(template: &str, fill: impl Fn(&str) -> String) -> String {
    let mut pieces = template.split("{{");
    let mut text = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let (slot, rest) = piece.split_once("}}").expect("slots of the template are closed");
        text.push_str(&fill(slot));
        text.push_str(rest);
    }
    text
}

/// A part of the page with its headline.
struct Section {
    id: &'static str,
    title: &'static str,
    content: String,
}

fn section(id: &'static str, title: &'static str, content: Option<String>) -> Option<Section> {
    content.map(|content| Section { id, title, content })
}

fn body(run: &RunData, extras: &Extras, view: Option<&View>, title: &Html) -> String {
    let sections: Vec<Section> = [
        section("type", "Type of evolution", classification::classification(run).map(|t| t.to_string())),
        section("scene", "Scene and plan", Some(scene_and_plan(run))),
        section(
            "body",
            "The body through time",
            view.map(|view| viewer(view, run.scene.evolution.movement_radius_fraction)),
        ),
        section("figures", "Figures", pictures(extras)),
        section("intervals", "Intervals between movements", tables::intervals(run).map(|t| t.to_string())),
        section("shed", "Shed mass", shed(run)),
        section("settling", "Settling", tables::settling(run).map(|t| t.to_string())),
        section("costs", "Where the time went, and which errors came in", Some(costs_and_sessions(run))),
    ]
    .into_iter()
    .flatten()
    .collect();
    let mut text = framed(
        title,
        summary::summary(run).as_str(),
        &sections,
        &foot(run.sessions.last().map_or(&run.version, |session| &session.version), Some(run)),
    );
    if let Some(view) = view {
        let _ =
            write!(text, "\n<script type=\"application/json\" id=\"run-data\">{}</script>", html::script_json(view));
    }
    text
}

/// Headline, contents, the `summary` and the sections, and the `foot` of a page.
fn framed(title: &Html, summary: &str, sections: &[Section], foot: &str) -> String {
    let mut text = format!("<header>\n<h1>{title}</h1>\n</header>\n<nav aria-label=\"contents\"><ul>\n");
    for Section { id, title, .. } in sections {
        let _ = writeln!(text, "<li><a href=\"#{id}\">{title}</a></li>");
    }
    let _ = writeln!(text, "</ul></nav>\n<main>\n{summary}");
    for Section { id, title, content } in sections {
        let _ = write!(text, "<section id=\"{id}\">\n<h2>{title}</h2>\n{content}</section>\n");
    }
    let _ = write!(text, "</main>\n<footer>\n{foot}</footer>");
    text
}

/// What a reader needs to tell, to have and to cite what the page shows.
fn foot(version: &str, run: Option<&RunData>) -> String {
    let [version, drawn_by] = [version, crate::VERSION].map(Html::text);
    let mut text = format!("<p>Run by yorp {version}, page drawn by yorp {drawn_by}.");
    if let Some(run) = run {
        let directory = Html::text(&run.directory.display().to_string());
        let _ = write!(
            text,
            " Recorded in <code>{directory}/run.sqlite</code>; the scene file as it ran is \
             <a href=\"../scene.json\"><code>scene.json</code></a> beside it."
        );
    }
    text.push_str(
        "</p>\n<p>To cite: the yorp developers, yorp: coupled spin and shape of rubble-pile asteroids under the YORP effect, \
         with the version above; the method is that of Cotto-Figueroa, Statler, Richardson and Tanga (2015), ApJ 803, 25; \
         shed mass is followed with REBOUND, Rein and Liu (2012), A&amp;A 537, A128.</p>\n",
    );
    text
}

fn scene_and_plan(run: &RunData) -> String {
    format!(
        "<details><summary>What is computed, how, and what is left out</summary>\n{}</details>\n\
         <details><summary>The scene with every default</summary>\n{}</details>\n",
        scene::plan(run),
        scene::scene(run)
    )
}

fn pictures(extras: &Extras) -> Option<String> {
    if extras.pictures.is_empty() && extras.left_out.is_empty() {
        return None;
    }
    let mut text = String::from("<div class=\"figures\">\n");
    for picture in &extras.pictures {
        let [title, caption] = [&picture.title, &picture.caption].map(|words| Html::text(words));
        let svg = inline_svg(&picture.svg, &picture.title);
        let files = links(picture.name, extras);
        let _ = write!(
            text,
            "<figure class=\"figure{}\" id=\"figure-{}\">\n<h3>{title}</h3>\n<div class=\"drawing\" tabindex=\"0\">{svg}</div>\n\
             <figcaption>{caption}{files}</figcaption>\n</figure>\n",
            if picture.wide { " wide" } else { "" },
            picture.name
        );
    }
    text.push_str("</div>\n");
    if !extras.left_out.is_empty() {
        text.push_str("<h3>Figures that this run has no data for</h3>\n<ul class=\"quiet\">\n");
        for (name, reason) in &extras.left_out {
            let _ = writeln!(text, "<li>{}: {}</li>", Html::text(name), Html::text(reason));
        }
        text.push_str("</ul>\n");
    }
    Some(text)
}

/// Links to the files of a figure; while a run goes on they are not there yet.
fn links(name: &str, extras: &Extras) -> String {
    if extras.fresh_every_s.is_some() {
        return String::new();
    }
    let link = |ending: &&str| format!("<a href=\"figures/{name}.{ending}\">{}</a>", ending.to_uppercase());
    let links: Vec<String> = super::figures::ENDINGS.iter().map(link).collect();
    format!(" <span class=\"files\">{}</span>", links.join(" "))
}

fn shed(run: &RunData) -> Option<String> {
    let parts: Vec<String> =
        [tables::fission(run), tables::losses(run)].into_iter().flatten().map(|p| p.to_string()).collect();
    (!parts.is_empty()).then(|| parts.concat())
}

fn costs_and_sessions(run: &RunData) -> String {
    let mut text = costs::costs(run).to_string();
    if let Some(sessions) = costs::sessions(run) {
        let _ = write!(text, "<h3>Starts of the program</h3>\n{sessions}");
    }
    text
}

/// The canvas with its controls; without scripts a sentence stands in its place.
fn viewer(view: &View, movement_radius_fraction: f64) -> String {
    let limit = movement_radius_fraction;
    let option = |present: bool, html: &'static str| if present { html } else { "" };
    let thinned = match view.stride {
        0 | 1 => String::new(),
        n => format!(
            "<p class=\"quiet\">To keep this page small, the view shows {} shapes: one configuration in {n}, and the last \
             one. What moved is what moved since the shape shown before. The figures and tables are of all.</p>\n",
            view.frames()
        ),
    };
    let losses = option(
        view.has_losses(),
        "<p class=\"quiet\">Spheres that left are drawn where they were when they were found to have left, with their \
         two-body path: <span class=\"swatch\" style=\"background:#d6336c\"></span> escaped, \
         <span class=\"swatch\" style=\"background:#9c36b5\"></span> fell back, \
         <span class=\"swatch\" style=\"background:#1c7ed6\"></span> in orbit, \
         <span class=\"swatch\" style=\"background:#2b8a3e\"></span> merged, \
         <span class=\"swatch\" style=\"background:#868e96\"></span> not followed. Their latitude is that of the record; \
         their longitude is counted in axes that do not turn, so it says nothing about the place that they left.</p>\n",
    );
    format!(
        "<noscript><p>The 3-D view needs JavaScript; everything else on this page does not.</p></noscript>\n\
         <p id=\"view-problem\" hidden></p>\n\
         <div id=\"viewer\" hidden>\n\
         <div id=\"stage\">\n\
         <canvas id=\"view3d\" tabindex=\"0\" role=\"img\" aria-label=\"The body in its principal axes\" \
         aria-describedby=\"view-keys\"></canvas>\n\
         <div id=\"overlay\" aria-hidden=\"true\"><b>x</b><b>y</b><b>z, spin</b><b>Sun</b><div id=\"legend\" hidden><span id=\"low\"></span>\
         <i></i><span id=\"high\"></span></div><div id=\"scalebar\"></div></div>\n\
         </div>\n\
         <div id=\"desk\">\n\
         <div class=\"controls\">\n\
         <button type=\"button\" id=\"play\">Play</button>\n\
         <button type=\"button\" id=\"back\" aria-label=\"previous configuration\">◀</button>\n\
         <input type=\"range\" id=\"time\" min=\"0\" max=\"{}\" step=\"1\" value=\"0\" aria-label=\"configuration\" \
         autocomplete=\"off\">\n\
         <button type=\"button\" id=\"forward\" aria-label=\"next configuration\">▶</button>\n\
         </div>\n\
         <output id=\"when\" for=\"time\"></output>\n\
         <p class=\"quiet\" id=\"losses\"></p>\n\
         <div class=\"controls\">\n\
         <label>colour <select id=\"colour\" autocomplete=\"off\"><option value=\"plain\">none</option>\
         <option value=\"step\">displacement in this movement</option>\
         <option value=\"since\">displacement since the first shape</option>\
         <option value=\"potential\">effective potential</option></select></label>\n\
         <label><input type=\"checkbox\" id=\"spheres\" checked autocomplete=\"off\"> spheres</label>\n\
         <label{}><input type=\"checkbox\" id=\"tiling\" autocomplete=\"off\"> tiling</label>\n\
         <label><input type=\"checkbox\" id=\"axes\" checked autocomplete=\"off\"> principal axes</label>\n\
         <label{}><input type=\"checkbox\" id=\"shed\" checked autocomplete=\"off\"> spheres that left</label>\n\
         </div>\n\
         <p class=\"quiet\" id=\"view-keys\">Drag to turn, pinch or roll the wheel (after a click) to scale. Keys in the view: \
         arrows turn, + and − scale, x, y, z look along an axis, 0 resets. Spheres that moved since the shape before, by \
         more than {limit} of their radius, have an orange rim; without spheres, facets that were fitted anew are orange. \
         The arrow along z is the spin; the yellow one comes from the Sun at the solstice of the northern side, the farthest \
         that it gets from the equator at this obliquity (the body turns below it, so its longitude means nothing).</p>\n\
         {losses}{thinned}</div>\n</div>\n",
        view.frames() - 1,
        option(!view.is_tiled(), " hidden"),
        option(!view.has_losses(), " hidden"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_filled_in_is_not_looked_at_again() {
        let fill = |slot: &str| if slot == "a" { "{{b}}".to_owned() } else { "B".to_owned() };
        assert_eq!(filled("<{{a}}|{{b}}>", fill), "<{{b}}|B>");
    }

    #[test]
    fn scripts_and_style_need_nothing_from_outside() {
        for part in [TEMPLATE, STYLE, VIEW3D, TIMELINE, VIEWER] {
            assert!(!part.contains("http:") && !part.contains("https:") && !part.contains("import "));
        }
        for script in [VIEW3D, TIMELINE, VIEWER] {
            assert!(!script.contains("</script") && !script.contains("innerHTML"));
        }
    }
}
