//! Title, status and what was tested.

use crate::drawing::escape::html;
use crate::drawing::numbers::{KM_PER_H_PER_M_PER_S, NBSP};
use crate::findings::{Conclusion, Run};
use crate::phrases::PHRASES;
use crate::phrases::words;
use crate::phrases::words::fill;

use super::conclusion;

pub(super) fn write(out: &mut String, run: &Run, verdict: &Conclusion) {
    let test = &run.test;
    let texts = &PHRASES.page;
    let brand = match (&run.joint, run.is_generic()) {
        (Some(_), _) => PHRASES.joint.brand,
        (None, true) => texts.brand_generic,
        (None, false) => texts.brand,
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
        let value = value.map_or_else(|| format!("<span class=\"unknown\">{}</span>", texts.not_known), |v| html(&v));
        out.push_str(&format!("<div><dt>{name}</dt><dd>{value}</dd></div>\n"));
    };
    let with_unit = |number: String, unit: &str| format!("{number}{NBSP}{unit}");
    // A title may say it already.
    if test.vehicle.as_ref().is_none_or(|vehicle| !test.title.contains(vehicle.as_str())) {
        fact(texts.vehicle, test.vehicle.clone());
    }
    fact(texts.test_mass, test.mass_kg.map(|mass| with_unit(words::at_most(mass, 1), "kg")));
    let speed = |v: f64| {
        let km_per_h = words::quantity(KM_PER_H_PER_M_PER_S * v, 2, "km/h");
        format!("{km_per_h} ({})", words::quantity(v, 3, "m/s"))
    };
    fact(texts.impact_speed, test.impact_speed_m_per_s.map(speed));
    fact(texts.barrier, test.barrier.clone());
    fact(texts.channel_taken, run.channel_id().map(|id| channel_words(run, id)));
    let sampling = run.acceleration().map(|a| {
        let rate = with_unit(words::at_most(a.rate_hz(), 2), "Hz");
        fill(texts.samples, &[("rate", rate), ("count", a.len().to_string())])
    });
    fact(texts.sampling, sampling);
    out.push_str("</dl>\n</header>\n");
}

/// What the page is called.
pub(super) fn title(run: &Run) -> String {
    match &run.joint {
        Some(joint) => joint.names(),
        None if run.test.title.is_empty() => PHRASES.page.untitled.to_owned(),
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
            words.push_str(&fill(PHRASES.page.axis, &[("axis", axis.to_string())]));
        }
        if let Some(cfc) = channel.cfc {
            words.push_str(&format!(", CFC{NBSP}{cfc}"));
        }
    }
    words
}
