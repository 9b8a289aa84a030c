//! The first numbers of a run, with interval and spread of sensors.

use crate::drawing::escape::html;
use crate::drawing::numbers::{ABSENT, MILLI, NBSP};
use crate::findings::{KeyNumber, Run};
use crate::phrases::PHRASES;
use crate::phrases::words;
use crate::phrases::words::fill;
use crumple_artifact::records::IntervalSourceV1;
use crumple_signal::ANOTHER_VEHICLE;
use crumple_signal::key_quantities::{
    CRUSH, DELTA_V, HIC15, HIC36, KM_PER_H_PER_M_PER_S, KeyQuantity, MAXIMUM_DELTA_V, OLC, PEAK, RESTITUTION,
    TIME_OF_CRUSH,
};

pub(super) fn write(out: &mut String, run: &Run, numbers: &[KeyNumber]) {
    if numbers.is_empty() {
        return;
    }
    out.push_str(&format!(
        "<section id=\"numbers\" aria-labelledby=\"numbers-title\">\n\
         <h2 id=\"numbers-title\">{}</h2>\n<dl class=\"cards\">\n",
        PHRASES.numbers.key_numbers
    ));
    for number in numbers {
        out.push_str(&card(run, number));
    }
    out.push_str("</dl>\n</section>\n");
}

/// `<div>` of a number: its trade name, the value, what is known of it.
fn card(run: &Run, number: &KeyNumber) -> String {
    let texts = &PHRASES.numbers;
    let (factor, places, unit) = number.quantity().shown();
    let range = |low, high| html(&number.range(low, high));
    let shown = match number.value {
        Some(value) => {
            let unit = if unit.is_empty() { String::new() } else { format!("{NBSP}<small>{unit}</small>") };
            let value = words::decimals(factor * value, places);
            format!("<dd class=\"number\">{}{value}{unit}</dd>", number.sign())
        }
        None => format!("<dd class=\"number\">{ABSENT}</dd>"),
    };
    let mut lines: Vec<String> = Vec::new();
    if let Some(reason) = &number.absent_because {
        lines.push(html(reason));
    }
    if let (Some(low), Some(high)) = (number.low, number.high) {
        lines.push(format!("{}: {}", interval_name(number), range(low, high)));
    } else if let (Some(_), Some(reason)) = (number.value, &number.interval_by) {
        lines.push(html(reason));
    } else if number.value.is_some() {
        lines.push(texts.no_interval.to_owned());
    }
    if let Some(spread) = &number.spread {
        let class = if number.interval_misses_a_sensor() { " class=\"beyond\"" } else { "" };
        let texts_of_it = [("count", spread.sensors().to_string()), ("interval", range(spread.low, spread.high))];
        let words = fill(texts.sensors, &texts_of_it);
        lines.push(format!("<span{class}>{words}</span>"));
    }
    lines.extend(remark(run, number));
    let lines: String = lines.into_iter().map(|line| format!("<dd>{line}</dd>")).collect();
    format!(
        "<div class=\"card\" data-key=\"{}\"><dt>{}</dt>{shown}{lines}</div>\n",
        html(&number.name),
        html(&title(run, &number.name))
    )
}

/// The word of the trade.
pub(crate) fn title(run: &Run, name: &str) -> String {
    let texts = &PHRASES.numbers;
    if name == CRUSH.key && run.test.barrier.as_deref() == Some(ANOTHER_VEHICLE) {
        return texts.motion_over_ground.to_owned();
    }
    let filter = run.filter.as_ref().filter(|_| name == PEAK.key);
    match (filter.and_then(|filter| filter.cfc), filter.and_then(|filter| filter.cutoff_hz.first())) {
        (Some(cfc), _) => fill(texts.peak_cfc, &[("cfc", cfc.to_string())]),
        (None, Some(hz)) => fill(texts.peak_filtered, &[("frequency", words::quantity(*hz, 0, "Hz"))]),
        (None, None) => KeyQuantity::of(name).map_or_else(|| words::metric(name), |known| known.title.to_owned()),
    }
}

fn interval_name(number: &KeyNumber) -> String {
    let texts = &PHRASES.numbers;
    match (number.interval_source, &number.interval_by) {
        (Some(IntervalSourceV1::Replicates), _) => texts.inputs.to_owned(),
        (Some(IntervalSourceV1::Resolution), _) => texts.resolution.to_owned(),
        (_, Some(by)) => html(by),
        (_, None) => texts.interval.to_owned(),
    }
}

fn remark(run: &Run, number: &KeyNumber) -> Option<String> {
    let texts = &PHRASES.numbers;
    let events = run.events.as_ref();
    let at = || number.at_s.map(|t| fill(texts.at, &[("time", words::quantity(MILLI * t, 1, "ms"))]));
    let is = |quantities: &[KeyQuantity]| quantities.contains(number.quantity());
    if is(&[PEAK, MAXIMUM_DELTA_V]) {
        at()
    } else if is(&[DELTA_V]) {
        let not_zero = events.is_some_and(|events| events.end_of_event_s.is_some());
        at().filter(|_| not_zero).map(|at| format!("{at}{}", texts.does_not_reach_zero))
    } else if is(&[RESTITUTION]) {
        let rebound = events.and_then(|events| events.rebound_velocity_m_per_s)?.abs();
        let speed = words::quantity(KM_PER_H_PER_M_PER_S * rebound, 1, "km/h");
        Some(fill(texts.rebound, &[("speed", speed)]))
    } else if is(&[TIME_OF_CRUSH]) {
        let ratio = events.and_then(|e| Some(e.centroid_time_s? / e.time_of_dynamic_crush_s?))?;
        Some(format!("t<sub>c</sub>/t<sub>m</sub> = {}", words::decimals(ratio, 3)))
    } else if is(&[OLC]) {
        Some(texts.olc.to_owned())
    } else if is(&[HIC15, HIC36]) {
        Some(texts.hic.to_owned())
    } else {
        number.side(run).map(str::to_owned)
    }
}

/// What the intervals of the cards are, below the first screen.
pub(super) fn write_caption(out: &mut String, numbers: &[KeyNumber]) {
    let texts = &PHRASES.numbers;
    let mut sentences: Vec<String> = Vec::new();
    for (source, template) in
        [(IntervalSourceV1::Replicates, texts.inputs_caption), (IntervalSourceV1::Resolution, texts.resolution_caption)]
    {
        let by = numbers.iter().filter(|number| number.interval_source == Some(source));
        let by = by.filter_map(|number| number.interval_by.as_deref()).next();
        sentences.extend(by.map(|by| fill(template, &[("by", html(by))])));
    }
    if let Some(spread) = numbers.iter().find_map(|number| number.spread.as_ref()) {
        let channels = html(&spread.channels.join(", "));
        sentences.push(fill(texts.sensors_caption, &[("channels", channels)]));
    }
    if numbers.iter().any(KeyNumber::interval_misses_a_sensor) {
        sentences.push(texts.marked_caption.to_owned());
    }
    if !sentences.is_empty() {
        out.push_str(&format!("<p class=\"caption\">{}</p>\n", sentences.join(" ")));
    }
}
