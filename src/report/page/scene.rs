//! The scene of a run and the plan made of it.

use super::html::{Align, Html, table};
use crate::report::RunData;
use crate::scene::Plan;

/// What was computed, how, and what was left out and why.
pub fn plan(run: &RunData) -> Html {
    let columns = [("part", Align::Text), ("how", Align::Text), ("why", Align::Text)];
    let rows = Plan::of(&run.scene).parts.into_iter().map(|part| {
        let how = part.method.unwrap_or_else(|| "left out".to_owned());
        (if part.on { "" } else { "left-out" }, vec![part.name.into(), how.into(), part.reason.into()])
    });
    table("plan of the scene", &columns, rows)
}

/// The scene with every default written out.
pub fn scene(run: &RunData) -> Html {
    Html::markup(format!("<pre tabindex=\"0\">{}</pre>\n", Html::text(&run.scene.to_json())))
}
