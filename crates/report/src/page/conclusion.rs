//! Status and verdict on top of the page, and the gravest warnings below them.

use crate::drawing::escape::html;
use crate::findings::{Concern, Conclusion, Ranking, ResultStatus, Run, Status, first_warnings};
use crate::phrases::PHRASES;
use crate::phrases::words::fill;
use crumple_signal::About;

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
    let phrases = &PHRASES.conclusion;
    let (class, role) = match (verdict.standing, verdict.status) {
        (ResultStatus::NoResult, _) => ("verdict bad", " role=\"alert\""),
        (_, Some(Status::DoNotUse)) => ("verdict none", ""),
        _ => ("verdict", ""),
    };
    let sentences: String = verdict.sentences.iter().map(|text| format!("<p>{}</p>\n", html(text))).collect();
    out.push_str(&format!(
        "<section class=\"{class}\"{role} aria-label=\"{}\">\n{sentences}</section>\n",
        phrases.verdict
    ));
}

/// At most three warnings; the others are counted and linked.
pub(super) fn write_before_use(
    out: &mut String,
    run: &Run,
    ranking: &Ranking,
    verdict: &Conclusion,
    concerns: &[Concern],
) {
    let phrases = &PHRASES.conclusion;
    let (first, others) = first_warnings(concerns, |_| false, run, ranking);
    let items: String = first.iter().map(|concern| item(concern)).collect();
    let list = if items.is_empty() { items } else { format!("<ol>\n{items}</ol>\n") };
    let is_of_the_record = |concern: &Concern| about(concern) == phrases.about_record;
    let has_result = verdict.status != Some(Status::DoNotUse) && run.channel().is_some();
    let is_sound = has_result && !concerns.iter().any(is_of_the_record);
    let no_fault = if is_sound { format!("<p>{}</p>\n", phrases.no_fault) } else { String::new() };
    if first.is_empty() && !is_sound {
        return;
    }
    let more = match others {
        0 => String::new(),
        1 => format!("<p><a href=\"#notes\">{}</a></p>\n", phrases.one_more),
        n => format!("<p><a href=\"#notes\">{}</a></p>\n", fill(phrases.more, &[("count", &n.to_string())])),
    };
    out.push_str(&format!(
        "<section class=\"before-use\" aria-labelledby=\"before-use-title\">\n<h2 id=\"before-use-title\">{}</h2>\n\
         {list}{no_fault}{more}</section>\n",
        phrases.before_use
    ));
}

/// An item of a list: what a concern is about, its text and what to do about it.
pub(super) fn item(concern: &Concern) -> String {
    let template = PHRASES.conclusion.what_to_do;
    let remedy = concern.remedy.as_deref().map(|remedy| fill(template, &[("remedy", html(remedy))]));
    let stop = if concern.text.ends_with(['.', '?', '!']) { "" } else { "." };
    let remedy = remedy.map_or_else(String::new, |remedy| format!("{stop} {remedy}"));
    let (about, stage) = (about(concern), html(&concern.stage));
    let code = match concern.code.as_str() {
        "" => String::new(),
        code => format!(" <span class=\"code\">[{}]</span>", html(code)),
    };
    format!("<li data-stage=\"{stage}\"><b>{about}:</b> {}{code}{remedy}</li>\n", html(&concern.text))
}

/// What a concern is about, in a word.
fn about(concern: &Concern) -> &'static str {
    let phrases = &PHRASES.conclusion;
    match concern.about.parse() {
        Ok(About::Model(_)) => phrases.about_model,
        Ok(About::Predictions) => phrases.about_predictions,
        Ok(About::Occupants) => phrases.about_occupants,
        Ok(About::WallForce) => phrases.about_wall_force,
        Ok(About::IdentifiedModels | About::Method(_)) => phrases.about_identified_models,
        _ => phrases.about_record,
    }
}
