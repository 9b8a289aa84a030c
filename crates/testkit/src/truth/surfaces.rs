//! What people see of a run: console, first screen, Markdown, list of notes. Each number there is one of the summary.

use serde_json::Value;

use crate::numbers::Pool;
use crate::truth::found::Found;
use crate::truth::run::Made;

/// Where the first screen of a page ends: the figures and sections below it.
const BELOW: [&str; 5] =
    ["id=\"curves\"", "id=\"what-if\"", "id=\"candidates\"", "id=\"identification\"", "id=\"notes\""];
/// Elements that end a line of text.
const LINES: [&str; 14] =
    ["p", "li", "dt", "dd", "h1", "h2", "h3", "h4", "div", "tr", "figcaption", "caption", "summary", "section"];

/// The text of the first screen of a page: a line a block, cells of tables between bars; drawings, whose ticks and
/// scales are no numbers of the run, and the title of the record are left out.
pub fn first_screen(html: &str) -> String {
    let body = html.split_once("<header>").map_or(html, |(_, rest)| rest);
    let end = BELOW.iter().filter_map(|mark| body.find(mark)).min().unwrap_or(body.len());
    let mut out = String::new();
    let mut rest = &body[..end];
    while let Some((before, behind)) = rest.split_once('<') {
        out.push_str(before);
        let Some((tag, inside)) = behind.split_once('>') else { break };
        let name = tag.trim_start_matches('/').split([' ', '\n', '/']).next().unwrap_or_default();
        rest = match name {
            "svg" | "script" | "style" | "h1" if !tag.starts_with('/') => {
                inside.split_once(&format!("</{name}>")).map_or("", |(_, behind)| behind)
            }
            _ => inside,
        };
        out.push_str(match name {
            "td" | "th" if !tag.starts_with('/') => "|",
            name if LINES.contains(&name) => "\n",
            "span" | "b" | "sub" | "sup" | "small" | "strong" => "",
            _ => " ",
        });
    }
    let names = [("&nbsp;", " "), ("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\""), ("&#39;", "'"), ("&amp;", "&")];
    names.iter().fold(out, |out, (name, character)| out.replace(name, character))
}

/// The lines of a console as they were before they were broken at 100 characters: one that begins with a blank goes on,
/// and one whose first word did not fit.
fn unbroken(text: &str) -> String {
    let mut out = String::new();
    let mut width = 0;
    for line in text.lines() {
        let first = line.split(' ').next().map_or(0, |word| word.chars().count());
        out.push_str(if line.starts_with(' ') || width + first >= 100 { " " } else { "\n" });
        out.push_str(line.trim());
        width = line.chars().count();
    }
    out
}

/// Every number of every surface is one of the summary, or of the record itself.
pub fn check(made: &Made) -> Vec<(&'static str, Found)> {
    let mut pool = Pool::of(&made.summary);
    // How far the rebound of a candidate is from that of the test, and its score from that of the recommended one.
    let best = made.recommended().map_or(&Value::Null, |best| &best["difference_with_priors"]);
    for own in made.list("/candidates") {
        let e = own["simulation"]["coefficient_of_restitution"].as_f64();
        let apart = e.zip(made.number("/events/coefficient_of_restitution"));
        let scores = own["difference_with_priors"].as_f64().zip(best.as_f64());
        apart.into_iter().chain(scores).for_each(|(one, other)| pool.push(one - other));
    }
    made.raw.values().chain(made.waves.values()).for_each(|wave| pool.push(wave.len() as f64));
    let reasons = ["recommended", "simplest", "closest"].map(|name| made.text(&format!("/{name}_because"))).join("\n");
    let sentences = made.list("/verdict/sentences").iter().filter_map(|sentence| sentence.as_str());
    let verdict = [made.text("/verdict/status_sentence")].into_iter().chain(sentences).collect::<Vec<_>>().join("\n");
    let own = [("verdict", verdict), ("reasons of models", reasons)];
    let all = own.iter().chain(&made.surfaces);
    all.map(|(surface, text)| {
        let mut found = Found::default();
        let text = if *surface == "console" { unbroken(text) } else { text.replace('\\', "") };
        let unstated = pool.unstated(&text);
        found.holds(unstated.is_empty(), || format!("no number of the summary: {}", unstated.join("; ")));
        (*surface, found)
    })
    .collect()
}
