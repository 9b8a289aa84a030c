//! Status and verdict on top of the page, and the gravest warnings below them.

use crate::drawing::escape::html;
use crate::findings::{
    Concern, Conclusion, Ranking, ResultStatus, Run, Status, first_warnings, more_warnings, what_to_do,
};
use crumple_signal::About;

/// The subject of a concern about the record itself.
const ABOUT_RECORD: &str = "Record";

/// The word of the status with its reason, beside the title.
pub(super) fn write_status(out: &mut String, verdict: &Conclusion) {
    let class = match verdict.status {
        Some(Status::Usable) => "good",
        Some(Status::UsableWithCare) => "care",
        Some(Status::DoNotUse) | None => "bad",
    };
    let word = format!("<strong>{}</strong>", verdict.status.map_or("", Status::word));
    let reason = html(&verdict.because);
    out.push_str(&format!("<p class=\"status {class}\">{word}<span>: </span>{reason}.</p>\n"));
}

/// Whether the record is sound, and what the answer is good for.
pub(super) fn write_answers(out: &mut String, verdict: &Conclusion) {
    let answers: String = verdict.answers().map(|(label, text)| format!("<dt>{label}<dd>{}", html(&text))).collect();
    out.push_str(&format!("<dl class=\"answers\">{answers}</dl>\n"));
}

/// What happened and what to use; without a result a bar that says what to do.
pub(super) fn write(out: &mut String, verdict: &Conclusion) {
    let (class, role) = match (verdict.standing, verdict.status) {
        (ResultStatus::NoResult, _) => ("verdict bad", " role=\"alert\""),
        (_, Some(Status::DoNotUse)) => ("verdict none", ""),
        _ => ("verdict", ""),
    };
    let sentences: String = verdict.sentences.iter().map(|text| format!("<p>{}</p>\n", html(text))).collect();
    out.push_str(&format!("<section class=\"{class}\"{role} aria-label=\"Verdict\">\n{sentences}</section>\n"));
}

/// Heads the gravest warnings.
pub(crate) const BEFORE_USE: &str = "Before you use this";

/// At most three warnings; the others are counted and linked.
pub(super) fn write_before_use(out: &mut String, run: &Run, ranking: &Ranking, concerns: &[Concern]) {
    let (first, others) = first_warnings(concerns, |_| false, run, ranking);
    let items: String = first.iter().map(|concern| item(concern)).collect();
    let list = if items.is_empty() { items } else { format!("<ol>\n{items}</ol>\n") };
    if first.is_empty() && others == 0 {
        return;
    }
    let more = match others {
        0 => String::new(),
        n => format!("<p><a href=\"#notes\">{}</a></p>\n", more_warnings(n)),
    };
    out.push_str(&format!(
        "<section class=\"before-use\" aria-labelledby=\"before-use-title\">\n\
         <h2 id=\"before-use-title\">{BEFORE_USE}</h2>\n{list}{more}</section>\n"
    ));
}

/// An item of a list: what a concern is about, its text and what to do about it.
pub(super) fn item(concern: &Concern) -> String {
    let stop = if concern.text.ends_with(['.', '?', '!']) { "" } else { "." };
    let remedy = concern.remedy.as_deref().map(|remedy| format!("{stop} {}", html(&what_to_do(remedy))));
    let remedy = remedy.unwrap_or_default();
    let (about, stage) = (about(concern), html(&concern.stage));
    let code = match concern.code.as_str() {
        "" => String::new(),
        code => format!(" <span class=\"code\">[{}]</span>", html(code)),
    };
    format!("<li data-stage=\"{stage}\"><b>{about}:</b> {}{code}{remedy}</li>\n", html(&concern.text))
}

/// What a concern is about, in a word.
fn about(concern: &Concern) -> &'static str {
    match concern.about.parse() {
        Ok(About::Model(_)) => "Model",
        Ok(About::Predictions) => "Predictions",
        Ok(About::Occupants) => "Occupants",
        Ok(About::WallForce) => "Wall",
        Ok(About::IdentifiedModels | About::Method(_)) => "Identified models",
        _ => ABOUT_RECORD,
    }
}
