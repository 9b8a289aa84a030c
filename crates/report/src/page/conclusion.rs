//! Status and verdict on top of the page, and the gravest warnings below them.

use crumple_artifact::records::ConcernV1;
use crumple_drawing::escape::html;
use crumple_findings::{Conclusion, Ranking, Run, Standing, Status, first_warnings};
use crumple_phrases::language::{Language, fill};
use crumple_signal::About;

use crate::frame::stage_words::{sentence_with_words_of_stages, words_of_stage};

/// The word of the status with its reason, beside the title.
pub(super) fn write_status(out: &mut String, run: &Run, verdict: &Conclusion) {
    let class = match verdict.status {
        Status::Usable => "good",
        Status::UsableWithCare => "care",
        Status::DoNotUse => "bad",
    };
    let word = format!("<strong>{}</strong>", verdict.status.word(run.language));
    let template = run.language.phrases().conclusion.status;
    let sentence = fill(template, &[("status", word), ("reason", html(&verdict.because))]);
    out.push_str(&format!("<p class=\"status {class}\">{sentence}</p>\n"));
}

/// What happened and what to use; without a result a bar that says what to do.
pub(super) fn write(out: &mut String, run: &Run, verdict: &Conclusion) {
    let phrases = &run.language.phrases().conclusion;
    let (class, role) = match (verdict.standing, verdict.status) {
        (Standing::NoResult, _) => ("verdict bad", " role=\"alert\""),
        (_, Status::DoNotUse) => ("verdict none", ""),
        _ => ("verdict", ""),
    };
    let because = run.recommendation.as_ref().map(|choice| choice.recommended_because.as_str());
    let words = [verdict.reason.as_deref(), verdict.remedy.as_deref(), because].map(Option::unwrap_or_default);
    let said = |text: &String| sentence_with_words_of_stages(run.language, text, &words);
    let sentences: String = verdict.sentences.iter().map(|text| format!("<p>{}</p>\n", said(text))).collect();
    out.push_str(&format!(
        "<section class=\"{class}\"{role} aria-label=\"{}\" lang=\"{}\">\n{sentences}</section>\n",
        phrases.verdict, verdict.language
    ));
}

/// At most three warnings; the others are counted and linked.
pub(super) fn write_before_use(
    out: &mut String,
    run: &Run,
    ranking: &Ranking,
    verdict: &Conclusion,
    concerns: &[ConcernV1],
) {
    let phrases = &run.language.phrases().conclusion;
    // The verdict has said why there is no result.
    let said = |concern: &&ConcernV1| verdict.standing != Standing::Model && concern.severity == ConcernV1::NO_RESULT;
    let warnings: Vec<&ConcernV1> = concerns.iter().filter(|concern| !said(concern)).collect();
    let (first, others) = first_warnings(&warnings, run, ranking);
    let items: String = first.iter().map(|concern| item(run.language, concern)).collect();
    let list = if items.is_empty() { items } else { format!("<ol>\n{items}</ol>\n") };
    let is_of_the_record = |concern: &ConcernV1| about(run.language, concern) == phrases.about_record;
    let has_result = verdict.status != Status::DoNotUse && run.channel().is_some();
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
pub(super) fn item(language: Language, concern: &ConcernV1) -> String {
    // The report's own speak the language of the page.
    let words = |text: &str| if concern.stage == "report" { html(text) } else { words_of_stage(language, text) };
    let template = language.phrases().conclusion.what_to_do;
    let remedy = concern.remedy.as_deref().map(|remedy| fill(template, &[("remedy", words(remedy))]));
    let stop = if concern.text.ends_with(['.', '?', '!']) { "" } else { "." };
    let remedy = remedy.map_or_else(String::new, |remedy| format!("{stop} {remedy}"));
    let (about, stage) = (about(language, concern), html(&concern.stage));
    format!("<li data-stage=\"{stage}\"><b>{about}:</b> {}{remedy}</li>\n", words(&concern.text))
}

/// What a concern is about, in a word.
fn about(language: Language, concern: &ConcernV1) -> &'static str {
    let phrases = &language.phrases().conclusion;
    match concern.about.parse() {
        Ok(About::Model(_)) => phrases.about_model,
        Ok(About::Predictions) => phrases.about_predictions,
        Ok(About::Occupants) => phrases.about_occupants,
        Ok(About::WallForce) => phrases.about_wall_force,
        Ok(About::IdentifiedModels | About::Method(_)) => phrases.about_identified_models,
        _ => phrases.about_record,
    }
}
