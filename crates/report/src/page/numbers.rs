//! Events and metrics with their definitions.

use crate::drawing::escape::html;
use crate::drawing::numbers::ABSENT;
use crate::findings::Run;
use crate::page::{UNFOLDED, folded};
use crate::words;
use crumple_artifact::records::{EventsV1, MetricV1};

use crate::frame::{self, Column};

/// Metrics that stand in the table of events already.
const AMONG_EVENTS: [&str; 5] =
    ["dynamic_crush", "time_of_dynamic_crush", "centroid_time", "delta_v", "coefficient_of_restitution"];

pub(super) fn write(out: &mut String, run: &Run) {
    if run.events.is_none() && run.metrics.is_empty() {
        return;
    }
    let title = "Events and metrics";
    // Where there are models the key numbers above are what is asked for first.
    let (heading, end) = match run.candidates.is_empty() {
        true => (format!("<h2>{title}</h2>\n"), "</section>\n"),
        false => (folded(title), UNFOLDED),
    };
    out.push_str(&format!("<section id=\"metrics\">\n{heading}<div class=\"pair\">\n"));
    if let Some(events) = &run.events {
        out.push_str("<div>\n<h3>Events</h3>\n");
        table(out, &event_rows(events));
        let rule = html(&events.time_zero_rule.replace('-', " "));
        out.push_str(&format!(
            "<p class=\"caption\">Times count from time zero, which was set by: {rule}.</p>\n</div>\n"
        ));
    }
    let channel = run.channel_id();
    let rest: Vec<&MetricV1> = run
        .metrics
        .iter()
        .filter(|m| {
            let of_pulse = channel.is_none() || Some(m.channel.as_str()) == channel || m.channel.is_empty();
            of_pulse
                && !m.name.starts_with(IN_A_REMARK)
                && (run.events.is_none() || !AMONG_EVENTS.contains(&m.name.as_str()))
        })
        .collect();
    if !rest.is_empty() {
        let rows: Vec<Row> = rest
            .into_iter()
            .map(|metric| Row {
                name: html(&words::metric(&metric.name)),
                value: metric.value,
                unit: &metric.unit,
                definition: definition(metric),
                interval: metric.low.zip(metric.high),
                interval_by: metric.interval_by.as_deref(),
            })
            .collect();
        out.push_str("<div>\n<h3>Metrics</h3>\n");
        table(out, &rows);
        out.push_str(
            "<p class=\"caption\">Point at a name for its definition, or the reason why a value is absent; point at an \
             interval for how it was found. How often intervals hold the truth: docs/calibration.md.</p>\n</div>\n",
        );
    }
    out.push_str("</div>\n");
    unlike_pulse(out, run);
    other_channels(out, run);
    out.push_str(end);
}

/// Metrics that are five answers to one question: a remark has the best.
const IN_A_REMARK: &str = "simple_pulse_";

/// Metrics that only other channels have, open to view: occupants, barrier, recorder.
fn unlike_pulse(out: &mut String, run: &Run) {
    let rows: Vec<&MetricV1> = run.metrics_of_others().collect();
    if rows.is_empty() {
        return;
    }
    let columns = [Column::text("Place"), Column::text("Metric"), Column::number("Value")];
    out.push_str(&format!("<h3>Occupants, barrier and recorder</h3>\n{}", frame::table("", &columns)));
    for metric in rows {
        let shown = match metric.value {
            Some(x) if metric.is_lower_bound => format!("{} (lower bound)", words::value(x, &metric.unit)),
            Some(x) => words::value(x, &metric.unit),
            None => format!("{ABSENT} ({})", metric.definition),
        };
        out.push_str(&format!(
            "<tr><th scope=\"row\">{}</th><td><abbr tabindex=\"0\" title=\"{}\">{}</abbr></td>\
             <td class=\"n\">{}</td></tr>\n",
            html(&place(run, metric)),
            html(&definition(metric)),
            html(&words::metric(&metric.name)),
            html(&shown)
        ));
    }
    out.push_str("</tbody>\n</table></div>\n");
}

/// Where the channels of a metric sit, `001+002` for several, and their ids.
fn place(run: &Run, metric: &MetricV1) -> String {
    let channels = &metric.channel;
    let first = metric.channels().into_iter().find_map(|id| run.test.channel(id));
    match first.map(|channel| channel.location.as_str()).filter(|location| !location.is_empty()) {
        Some(location) => format!("{location} ({channels})"),
        None => channels.clone(),
    }
}

/// Metrics of the other channels, folded: a column a channel, the pulse first.
fn other_channels(out: &mut String, run: &Run) {
    let Some(pulse) = run.channel_id() else { return };
    let mut channels = vec![pulse];
    let mut names: Vec<(&str, &MetricV1)> = Vec::new();
    let unlike_pulse: Vec<&MetricV1> = run.metrics_of_others().collect();
    let listed = |metric: &&MetricV1| {
        let is_other = unlike_pulse.iter().any(|other| std::ptr::eq(*other, *metric));
        metric.channel != pulse && !metric.channel.is_empty() && !is_other
    };
    for metric in run.metrics.iter().filter(listed) {
        if !channels.contains(&metric.channel.as_str()) {
            channels.push(&metric.channel);
        }
        if !names.iter().any(|(name, _)| *name == metric.name) {
            names.push((&metric.name, metric));
        }
    }
    if names.is_empty() {
        return;
    }
    // The range over several channels is a column of its own at the end.
    let ranges: Vec<&str> =
        run.metrics.iter().filter(|metric| metric.is_of_several()).map(|metric| metric.channel.as_str()).collect();
    let is_range = |id: &str| ranges.contains(&id);
    channels.sort_by_key(|id| is_range(id));
    let others = channels.iter().filter(|id| !is_range(id)).count() - 1;
    let channels_word = if others == 1 { "channel" } else { "channels" };
    out.push_str(&format!(
        "<details><summary>Metrics of {others} other {channels_word}, beside the pulse's</summary>\n\
         <div class=\"scroll\"><table>\n<thead><tr><th scope=\"col\">Metric</th>"
    ));
    for id in &channels {
        let place = run.test.channel(id).map(|channel| channel.location.as_str()).unwrap_or_default();
        let (title, head) = if is_range(id) { (format!("over {id}"), "range") } else { (place.to_owned(), *id) };
        out.push_str(&format!(
            "<th scope=\"col\" class=\"n\"><abbr tabindex=\"0\" title=\"{}\">{}</abbr></th>",
            html(&title),
            html(head)
        ));
    }
    out.push_str("</tr></thead>\n<tbody>\n");
    for (name, first) in names {
        out.push_str(&format!(
            "<tr><th scope=\"row\"><abbr tabindex=\"0\" title=\"{}\">{}</abbr></th>",
            html(&first.definition),
            html(&words::metric(name))
        ));
        for id in &channels {
            let metric = run.metrics.iter().find(|m| m.name == name && m.channel == *id);
            let shown = metric.and_then(|m| match is_range(id) {
                true => Some(words::range(m.low?, m.high?, &m.unit)),
                false => Some(words::value(m.value?, &m.unit)),
            });
            let shown = shown.unwrap_or_else(|| ABSENT.to_owned());
            out.push_str(&format!("<td class=\"n\">{}</td>", html(&shown)));
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</tbody>\n</table></div>\n</details>\n");
}

struct Row<'a> {
    name: String,
    value: Option<f64>,
    unit: &'a str,
    definition: String,
    interval: Option<(f64, f64)>,
    interval_by: Option<&'a str>,
}

/// The definition, its key and the part of the record.
fn definition(metric: &MetricV1) -> String {
    let key = metric.definition_id.as_deref().filter(|_| metric.value.is_some());
    let mut text = metric.definition.clone();
    if let Some(id) = key {
        text.push_str(&format!(" [{id}]"));
    }
    match metric.from_s.zip(metric.to_s) {
        Some((from_s, to_s)) if from_s < to_s => {
            text.push_str(&format!(", from {}", words::range(from_s, to_s, "s")));
        }
        Some((from_s, _)) => text.push_str(&format!(", at {}", words::value(from_s, "s"))),
        None => {}
    }
    text
}

fn table(out: &mut String, rows: &[Row]) {
    out.push_str("<table class=\"numbers\"><tbody>\n");
    for row in rows {
        let known = row.value.zip(row.interval).map(|(x, ends)| words::value_and_range(x, ends, row.unit));
        let mut value = match row.value {
            Some(x) => html(&known.as_ref().map_or_else(|| words::value(x, row.unit), |[value, _]| value.clone())),
            // A value that is not there says why, in print too.
            None => format!("{ABSENT} <span class=\"why\">{}</span>", html(&row.definition)),
        };
        if let (Some(_), None, Some(reason)) = (row.value, row.interval, row.interval_by) {
            value.push_str(&format!("<br><span class=\"why\">{}</span>", html(reason)));
        }
        if let Some([_, range]) = &known {
            value.push_str(&format!(
                "<br><span class=\"interval\" tabindex=\"0\" title=\"{}\">{}</span>",
                html(row.interval_by.unwrap_or_default()),
                html(range)
            ));
        }
        out.push_str(&format!(
            "<tr><th scope=\"row\"><abbr tabindex=\"0\" title=\"{}\">{}</abbr></th><td class=\"n\">{value}</td></tr>\n",
            html(&row.definition),
            row.name
        ));
    }
    out.push_str("</tbody></table>\n");
}

fn event_rows(e: &EventsV1) -> Vec<Row<'_>> {
    let row = |field: &str, name: &str, value, unit, definition: &str| {
        let interval = e.intervals.iter().find(|interval| interval.name == field);
        Row {
            name: name.to_owned(),
            value,
            unit,
            definition: definition.to_owned(),
            interval: interval.map(|interval| (interval.low, interval.high)),
            interval_by: interval.map(|interval| interval.interval_by.as_str()).or_else(|| {
                let without = e.without_interval.iter().find(|without| without.name == field);
                without.map(|without| without.reason.as_str())
            }),
        }
    };
    let change = match (&e.end_of_event_rule, e.end_of_event_s) {
        (Some(rule), Some(end_s)) => format!(
            "Impact speed minus the lowest velocity up to the end of the event at {} ({rule}); the velocity does not \
             reach zero.",
            words::value(end_s, "s")
        ),
        _ => "Impact speed minus rebound velocity.".to_owned(),
    };
    let mut rows = vec![
        row(
            "dynamic_crush_m",
            "dynamic crush C",
            e.dynamic_crush_m,
            "m",
            "Displacement at the first zero of the velocity.",
        ),
        row(
            "time_of_dynamic_crush_s",
            "time of dynamic crush tₘ",
            e.time_of_dynamic_crush_s,
            "s",
            "Time of the first zero of the velocity.",
        ),
        row(
            "centroid_time_s",
            "centroid time t<sub>c</sub>",
            e.centroid_time_s,
            "s",
            "Centroid of the pulse from time zero to tₘ; C / v0.",
        ),
        row(
            "rebound_velocity_m_per_s",
            "rebound velocity",
            e.rebound_velocity_m_per_s,
            "m/s",
            "Lowest velocity after tₘ.",
        ),
        row("time_of_rebound_s", "time of rebound", e.time_of_rebound_s, "s", "Time of the rebound velocity."),
        row(
            "coefficient_of_restitution",
            "coefficient of restitution e",
            e.coefficient_of_restitution,
            "1",
            "−rebound velocity / impact speed.",
        ),
        row("delta_v_m_per_s", "change of velocity", e.delta_v_m_per_s, "m/s", &change),
        row(
            "impact_speed_m_per_s",
            "impact speed",
            e.impact_speed_m_per_s,
            "m/s",
            "Speed the integration started from.",
        ),
    ];
    if e.end_of_event_s.is_some() {
        let rule = e.end_of_event_rule.as_deref().unwrap_or("rule not stated");
        let time = e.time_of_delta_v_s;
        rows.push(row(
            "time_of_delta_v_s",
            "time of the change of velocity",
            time,
            "s",
            "Time of the lowest velocity.",
        ));
        rows.push(row("end_of_event_s", "end of the event", e.end_of_event_s, "s", rule));
    }
    rows
}
