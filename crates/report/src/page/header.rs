//! Title, what was tested, and the key figures.

use crate::text::escape::html;
use crate::text::numbers::{ABSENT, G_PER_M_PER_S2, KM_PER_H_PER_M_PER_S, MILLI, NBSP, at_most, decimals, range};
use crate::{CandidateResult, Ranking, Run};

pub(super) fn write(out: &mut String, run: &Run, ranking: &Ranking, verdict: impl FnOnce(&mut String)) {
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
    cards(out, run, ranking);
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

/// The change of velocity, m/s, with what it is: of the events, else the one a recorder kept.
fn change_of_velocity(run: &Run) -> (Option<f64>, Option<String>) {
    let in_m_per_s = |v: f64| format!("{}{NBSP}m/s", decimals(v, 2));
    let at = |t_s: f64| format!("at {}{NBSP}ms", decimals(MILLI * t_s, 1));
    if let Some(events) = &run.events
        && let Some(change) = events.delta_v_m_per_s
    {
        let remark = match (events.end_of_event_s, events.time_of_delta_v_s) {
            (Some(_), Some(t_s)) => format!("{}, {}, velocity does not reach zero", in_m_per_s(change), at(t_s)),
            _ => in_m_per_s(change),
        };
        return (Some(change), Some(remark));
    }
    let recorded = run.metric("maximum_delta_v").and_then(|metric| Some((metric, metric.value?)));
    match recorded {
        Some((metric, change)) => {
            let when = metric.from_s.map_or_else(String::new, |t_s| format!(", {}", at(t_s)));
            (Some(change), Some(format!("{}{when}, maximum as recorded", in_m_per_s(change))))
        }
        None => (None, None),
    }
}

fn cards(out: &mut String, run: &Run, ranking: &Ranking) {
    let events = run.events.as_ref();
    let mut cards = String::new();
    // The interval of an event, as its uncertain measurement gives it, stands under the figure.
    let interval = |field: &str, si: &str| {
        let interval = events?.intervals.iter().find(|interval| interval.name == field)?;
        let words = range(interval.low, interval.high, si);
        // `5-95 %` of `5-95 % of 400 replicates`; the rest on pointing at it.
        let kind = interval.interval_by.split(" of ").next().unwrap_or_default();
        Some(format!("<p title=\"{}\">{} ({})</p>", html(&interval.interval_by), html(&words), html(kind)))
    };
    let mut card = |name: &str,
                    value: Option<f64>,
                    factor: f64,
                    places: usize,
                    unit: &str,
                    interval: Option<String>,
                    remark: Option<String>| {
        if value.is_none() && remark.is_none() {
            return;
        }
        let number = value.map_or_else(|| ABSENT.to_owned(), |v| decimals(factor * v, places));
        let unit = if value.is_some() && !unit.is_empty() { format!(" <small>{unit}</small>") } else { String::new() };
        let remark = remark.map_or_else(String::new, |text| format!("<p>{text}</p>"));
        let interval = interval.filter(|_| value.is_some()).unwrap_or_default();
        cards.push_str(&format!(
            "<div class=\"card\"><h3>{name}</h3><p class=\"number\">{number}{unit}</p>{interval}{remark}</div>\n"
        ));
    };
    let absent = events.filter(|e| e.dynamic_crush_m.is_none()).map(|_| "velocity does not reach zero".to_owned());
    card(
        "Dynamic crush C",
        events.and_then(|e| e.dynamic_crush_m),
        MILLI,
        1,
        "mm",
        interval("dynamic_crush_m", "m"),
        absent,
    );
    let t_m = run.time_of_crush_s();
    let ratio = events
        .and_then(|e| Some(e.centroid_time_s? / t_m?))
        .map(|r| format!("t<sub>c</sub>/t<sub>m</sub> = {}", decimals(r, 3)));
    card("Time of crush t<sub>m</sub>", t_m, MILLI, 1, "ms", interval("time_of_dynamic_crush_s", "s"), ratio);
    let (change, remark) = change_of_velocity(run);
    // A change that a recorder kept is none of the events.
    let of_change = interval("delta_v_m_per_s", "m/s").filter(|_| events.is_some_and(|e| e.delta_v_m_per_s == change));
    card("Velocity change Δv", change, KM_PER_H_PER_M_PER_S, 1, "km/h", of_change, remark);
    card(
        "Restitution e",
        events.and_then(|e| e.coefficient_of_restitution),
        1.0,
        3,
        "",
        interval("coefficient_of_restitution", ""),
        events
            .and_then(|e| e.rebound_velocity_m_per_s)
            .map(|v| format!("rebound {}{NBSP}km/h", decimals(KM_PER_H_PER_M_PER_S * v.abs(), 1))),
    );
    let (peak, t_peak) = peak(run);
    card(
        "Peak deceleration",
        peak,
        G_PER_M_PER_S2,
        1,
        "g",
        None,
        t_peak.map(|t| format!("at {}{NBSP}ms", decimals(MILLI * t, 1))),
    );
    let best = ranking.best.as_deref().and_then(|id| run.candidate(id));
    let fit = best.and_then(CandidateResult::fit_percent);
    let remark = match (best, run.candidates.is_empty()) {
        (Some(best), _) => Some(match best.undetermined_in_words() {
            None => html(&best.name_with_dual()),
            Some(open) => format!("{}; <span class=\"no\">{open}</span>", html(&best.name_with_dual())),
        }),
        (None, false) => Some(ranking.no_best.as_deref().map_or_else(|| "no candidate qualifies".to_owned(), html)),
        (None, true) => None,
    };
    card("Recommended model, fit", fit, 1.0, 2, "%", None, remark);
    if !cards.is_empty() {
        out.push_str(&format!("<div class=\"cards\">\n{cards}</div>\n"));
    }
}

/// Largest deceleration, m/s², positive, and its time: the metric where there is one, else read off the record after
/// time zero.
fn peak(run: &Run) -> (Option<f64>, Option<f64>) {
    if let Some(value) = run.metric("peak_acceleration").and_then(|m| m.value) {
        return (Some(value.abs()), run.metric("time_of_peak_acceleration").and_then(|m| m.value));
    }
    let Some(a) = run.acceleration() else { return (None, None) };
    let lowest = (a.index_at_or_after(0.0)..a.len()).min_by(|&i, &k| a.samples()[i].total_cmp(&a.samples()[k]));
    (lowest.map(|k| -a.samples()[k]), lowest.map(|k| a.time_s(k)))
}
