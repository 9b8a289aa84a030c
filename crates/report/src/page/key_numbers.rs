//! The first numbers of a run, with interval and spread of sensors.

use crumple_drawing::escape::html;
use crumple_drawing::numbers::{ABSENT, MILLI, NBSP, decimals, range, unit};

use crate::Run;
use crate::conclusions::key_numbers::{KeyNumber, key_numbers};

pub(super) fn write(out: &mut String, run: &Run) {
    let numbers = key_numbers(run);
    if numbers.is_empty() {
        return;
    }
    out.push_str(
        "<section id=\"numbers\" aria-labelledby=\"numbers-title\">\n\
         <h2 id=\"numbers-title\">Key numbers</h2>\n<dl class=\"cards\">\n",
    );
    for number in &numbers {
        out.push_str(&card(run, number));
    }
    out.push_str("</dl>\n");
    caption(out, &numbers);
    out.push_str("</section>\n");
}

/// `<div>` of a number: its trade name, the value, what is known of it.
fn card(run: &Run, number: &KeyNumber) -> String {
    let (factor, unit) = unit(number.unit);
    let shown = match number.value {
        Some(value) => {
            let unit = if unit.is_empty() { String::new() } else { format!("{NBSP}<small>{unit}</small>") };
            format!("<dd class=\"number\">{}{unit}</dd>", decimals(factor * value, places(number.name)))
        }
        None => format!("<dd class=\"number\">{ABSENT}</dd>"),
    };
    let mut lines: Vec<String> = Vec::new();
    if let Some(reason) = &number.absent_because {
        lines.push(html(reason));
    }
    if let (Some(low), Some(high)) = (number.low, number.high) {
        let words = interval_name(number);
        lines.push(format!("{words}: {}", html(&range(low, high, number.unit))));
    } else if let (Some(_), Some(reason)) = (number.value, &number.interval_by) {
        lines.push(html(reason));
    } else if number.value.is_some() {
        lines.push("no interval: the uncertainty of the inputs is not stated".to_owned());
    }
    if let Some(spread) = &number.spread {
        let class = if number.interval_misses_a_sensor() { " class=\"beyond\"" } else { "" };
        let count = spread.channels.split('+').count();
        let words = html(&range(spread.low, spread.high, number.unit));
        lines.push(format!("<span{class}>{count} sensors: {words}</span>"));
    }
    lines.extend(remark(run, number));
    let lines: String = lines.into_iter().map(|line| format!("<dd>{line}</dd>")).collect();
    format!(
        "<div class=\"card\" data-key=\"{}\"><dt>{}</dt>{shown}{lines}</div>\n",
        number.name,
        title(run, number.name)
    )
}

/// The word of the trade.
pub(crate) fn title(run: &Run, name: &str) -> String {
    let title = match name {
        "dynamic_crush" => "Dynamic crush C",
        "time_of_dynamic_crush" => "Time of crush t<sub>m</sub>",
        "delta_v" => "Velocity change Δv",
        "maximum_delta_v" => "Maximum Δv as recorded",
        "time_of_maximum_delta_v" => "Time of maximum Δv",
        "coefficient_of_restitution" => "Restitution e",
        "olc" => "OLC",
        "hic15" => "HIC15",
        "hic36" => "HIC36",
        "clip_3ms_contiguous" => "3 ms clip",
        "peak_acceleration" => {
            let filter = run.filter.as_ref();
            return match (filter.and_then(|filter| filter.cfc), filter.and_then(|f| f.cutoff_hz.first())) {
                (Some(cfc), _) => format!("Peak, CFC{NBSP}{cfc}"),
                (None, Some(hz)) => format!("Peak, filtered at {}{NBSP}Hz", decimals(*hz, 0)),
                (None, None) => "Peak".to_owned(),
            };
        }
        other => return html(&other.replace('_', " ")),
    };
    title.to_owned()
}

/// Digits after the point in the unit of the page.
pub(crate) fn places(name: &str) -> usize {
    match name {
        "coefficient_of_restitution" => 3,
        "hic15" | "hic36" | "time_of_maximum_delta_v" => 0,
        _ => 1,
    }
}

/// `90 %` of `5-95 % of 400 replicates`, `resolution` of a recorder.
fn interval_name(number: &KeyNumber) -> String {
    match number.interval_by.as_deref() {
        Some(by) if by.starts_with("5-95 %") => format!("inputs, 90{NBSP}%"),
        Some(by) if by.starts_with("resolution") => "resolution".to_owned(),
        Some(by) => html(by),
        None => "interval".to_owned(),
    }
}

fn remark(run: &Run, number: &KeyNumber) -> Option<String> {
    let events = run.events.as_ref();
    let at = || number.at_s.map(|t| format!("at {}{NBSP}ms", decimals(MILLI * t, 1)));
    match number.name {
        "peak_acceleration" | "maximum_delta_v" => at(),
        "delta_v" if events.is_some_and(|e| e.end_of_event_s.is_some()) => {
            at().map(|at| format!("{at}; the velocity does not reach zero"))
        }
        "coefficient_of_restitution" => events
            .and_then(|events| events.rebound_velocity_m_per_s)
            .map(|v| format!("rebound {}{NBSP}km/h", decimals(3.6 * v.abs(), 1))),
        "time_of_dynamic_crush" => {
            let ratio = events.and_then(|e| Some(e.centroid_time_s? / e.time_of_dynamic_crush_s?))?;
            Some(format!("t<sub>c</sub>/t<sub>m</sub> = {}", decimals(ratio, 3)))
        }
        "olc" => Some("occupant load criterion".to_owned()),
        "hic15" | "hic36" => Some("head injury criterion".to_owned()),
        _ => None,
    }
}

fn caption(out: &mut String, numbers: &[KeyNumber]) {
    let mut sentences: Vec<String> = Vec::new();
    let by = |start: &str| numbers.iter().filter_map(|n| n.interval_by.as_deref()).find(|by| by.starts_with(start));
    if let Some(by) = by("5-95 %") {
        sentences.push(format!(
            "“Inputs”: {} with mass, speed, gain, zero level and time zero within their stated uncertainty, one \
             sensor.",
            html(by)
        ));
    }
    if let Some(by) = by("resolution") {
        sentences.push(format!("“Resolution”: {}.", html(by)));
    }
    if let Some(spread) = numbers.iter().find_map(|number| number.spread.as_ref()) {
        sentences.push(format!(
            "“Sensors”: lowest to highest of channels {}, which measured the same motion.",
            html(&spread.channels.replace('+', ", "))
        ));
    }
    if numbers.iter().any(KeyNumber::interval_misses_a_sensor) {
        sentences.push(
            "A marked range goes beyond the interval: there the sensors differ by more than the stated uncertainty \
             explains, and the range is the honest one."
                .to_owned(),
        );
    }
    if !sentences.is_empty() {
        out.push_str(&format!("<p class=\"caption\">{}</p>\n", sentences.join(" ")));
    }
}
