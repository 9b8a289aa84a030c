//! Title and what was tested.

use crumple_drawing::escape::html;
use crumple_drawing::numbers::{KM_PER_H_PER_M_PER_S, NBSP, at_most, decimals};

use crate::Run;

pub(super) fn write(out: &mut String, run: &Run, verdict: impl FnOnce(&mut String)) {
    let test = &run.test;
    let title = if test.title.is_empty() { "Untitled record" } else { &test.title };
    out.push_str(&format!(
        "<header>\n<p class=\"brand\">Crumple · {} report</p>\n<h1>{}</h1>\n",
        if run.is_generic() { "identification" } else { "crash pulse" },
        html(title)
    ));
    verdict(out);
    out.push_str("<dl>\n");
    let mut fact = |name: &str, value: Option<String>| {
        // Of a record that is no crash nobody asks for a barrier.
        if value.is_none() && run.is_generic() {
            return;
        }
        let value = value.map_or_else(|| "<span class=\"unknown\">not known</span>".to_owned(), |v| html(&v));
        out.push_str(&format!("<div><dt>{name}</dt><dd>{value}</dd></div>\n"));
    };
    fact("Vehicle", test.vehicle.clone());
    fact("Test mass", test.mass_kg.map(|m| format!("{}{NBSP}kg", at_most(m, 1))));
    fact(
        "Impact speed",
        test.impact_speed_m_per_s
            .map(|v| format!("{}{NBSP}km/h ({}{NBSP}m/s)", decimals(KM_PER_H_PER_M_PER_S * v, 2), decimals(v, 3))),
    );
    fact("Barrier", test.barrier.clone());
    fact("Channel taken", run.channel_id().map(|id| channel_words(run, id)));
    fact("Sampling", run.acceleration().map(|a| format!("{}{NBSP}Hz, {} samples", at_most(a.rate_hz(), 2), a.len())));
    out.push_str("</dl>\n</header>\n");
}

fn channel_words(run: &Run, id: &str) -> String {
    let mut words = id.to_owned();
    if let Some(channel) = run.test.channel(id) {
        if !channel.location.is_empty() {
            words.push_str(&format!(", {}", channel.location));
        }
        if let Some(axis) = channel.axis {
            words.push_str(&format!(", {axis} axis"));
        }
        if let Some(cfc) = channel.cfc {
            words.push_str(&format!(", CFC{NBSP}{cfc}"));
        }
    }
    words
}
