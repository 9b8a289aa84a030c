//! Title, status and what was tested.

use crate::drawing::escape::html;
use crate::drawing::numbers::{KM_PER_H_PER_M_PER_S, NBSP};
use crate::findings::{Conclusion, Run};
use crate::words;
use crumple_signal::Display;
use crumple_signal::display::{factor_shown, unit_shown};

use super::conclusion;

/// What a record without a title is called.
pub(crate) const UNTITLED: &str = "Untitled record";

pub(super) fn write(out: &mut String, run: &Run, verdict: &Conclusion) {
    let test = &run.test;
    let brand = match (&run.joint, run.is_generic()) {
        (Some(_), _) => "Crumple · one model for several tests",
        (None, true) => "Crumple · identification report",
        (None, false) => "Crumple · crash pulse report",
    };
    let title = html(&title(run));
    out.push_str(&format!("<header>\n<p class=\"brand\">{brand}</p>\n<div class=\"title\"><h1>{title}</h1>\n"));
    conclusion::write_status(out, verdict);
    out.push_str("</div>\n");
    conclusion::write_answers(out, verdict);
    conclusion::write(out, verdict);
    if run.joint.is_some() {
        // A table has what was tested.
        out.push_str("</header>\n");
        return;
    }
    out.push_str("<dl>\n");
    let mut fact = |name: &str, value: Option<String>| {
        // Of a record that is no crash nobody asks for a barrier.
        if value.is_none() && run.is_generic() {
            return;
        }
        let value = value.map_or_else(|| "<span class=\"unknown\">not known</span>".to_owned(), |v| html(&v));
        out.push_str(&format!("<div><dt>{name}</dt><dd>{value}</dd></div>\n"));
    };
    let with_unit = |number: String, unit: &str| format!("{number}{NBSP}{unit}");
    // A title may say it already.
    if test.vehicle.as_ref().is_none_or(|vehicle| !test.title.contains(vehicle.as_str())) {
        fact("Vehicle", test.vehicle.clone());
    }
    // A tenth of a pound is not known.
    let places = usize::from(Display::now() == Display::Si);
    fact(
        "Test mass",
        test.mass_kg.map(|mass| with_unit(words::at_most(factor_shown("kg") * mass, places), unit_shown("kg"))),
    );
    let speed = |v: f64| {
        let km_per_h = words::quantity(KM_PER_H_PER_M_PER_S * v, 2, "km/h");
        format!("{km_per_h} ({})", words::quantity(v, 3, "m/s"))
    };
    fact("Impact speed", test.impact_speed_m_per_s.map(speed));
    fact("Barrier", test.barrier.clone());
    fact("Channel taken", run.channel_id().map(|id| channel_words(run, id)));
    let sampling = run.acceleration().map(|a| {
        let rate = with_unit(words::at_most(a.rate_hz(), 2), "Hz");
        format!("{rate}, {} samples", a.len())
    });
    fact("Sampling", sampling);
    out.push_str("</dl>\n</header>\n");
}

/// What the page is called.
pub(super) fn title(run: &Run) -> String {
    match &run.joint {
        Some(joint) => joint.names(),
        None if run.test.title.is_empty() => UNTITLED.to_owned(),
        None => run.test.title.clone(),
    }
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
