//! What people see of a run: console, first screen, Markdown, list of notes. Each number there is one of the summary.

use serde_json::Value;

use crate::numbers::Pool;
use crate::truth::found::Found;
use crate::truth::run::Made;

/// The lines of a console as they were before they were broken at 100 characters: one that begins with a blank goes on,
/// and one whose first word did not fit.
fn unbroken(text: &str) -> String {
    let mut out = String::new();
    let mut width = 0;
    // A filter that stands for the product's says what it likes.
    for line in text.lines().filter(|line| !line.starts_with("filter ")) {
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
