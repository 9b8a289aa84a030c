//! The first numbers of a run, with interval and spread of sensors.

use crate::drawing::escape::html;
use crate::drawing::numbers::{ABSENT, MILLI, NBSP};
use crate::findings::{Conclusion, KeyNumber, Run, class_of_record};
use crate::frame::caption;
use crate::words;
use crumple_artifact::records::IntervalSourceV1;
use crumple_signal::ANOTHER_VEHICLE;
use crumple_signal::key_quantities::{
    CRUSH, DELTA_V, HIC15, HIC36, KM_PER_H_PER_M_PER_S, KeyQuantity, MAXIMUM_DELTA_V, OLC, PEAK, RESTITUTION,
    TIME_OF_CRUSH,
};

/// Heads the key numbers, on every page and in Markdown.
pub(crate) const KEY_NUMBERS: &str = "Key numbers";

pub(super) fn write(out: &mut String, run: &Run, verdict: &Conclusion, numbers: &[KeyNumber]) {
    if numbers.is_empty() {
        return;
    }
    out.push_str(&format!(
        "<section id=\"numbers\" aria-labelledby=\"numbers-title\">\n\
         <h2 id=\"numbers-title\">{KEY_NUMBERS}</h2>\n<dl class=\"cards\">\n"
    ));
    for number in numbers {
        out.push_str(&card(run, number, verdict.is_speed_in_doubt()));
    }
    out.push_str("</dl>\n</section>\n");
}

/// `<div>` of a number: its trade name, the value, what is known of it.
fn card(run: &Run, number: &KeyNumber, is_speed_in_doubt: bool) -> String {
    let (factor, places, unit) = number.quantity().shown();
    let range = |low, high| html(&number.range(low, high));
    let shown = match number.value {
        Some(value) => {
            let unit = if unit.is_empty() { String::new() } else { format!("{NBSP}<small>{unit}</small>") };
            let value = words::rounded(value, number.interval(), (factor, places, ""));
            format!("<dd class=\"number\">{}{value}{unit}</dd>", number.sign())
        }
        None => format!("<dd class=\"number\">{ABSENT}</dd>"),
    };
    let mut lines: Vec<String> = Vec::new();
    if let Some(reason) = &number.absent_because {
        lines.push(html(reason));
    }
    if let Some((low, high)) = number.interval() {
        lines.push(bar(number, &format!("{}: {}", interval_name(number), range(low, high))));
        lines.push(range(low, high));
    } else if let (Some(_), Some(reason)) = (number.value, &number.interval_by) {
        lines.push(html(reason));
    } else if number.value.is_some() {
        lines.push("no interval was computed".to_owned());
    }
    // The bar shows the range of the sensors; in words it stands where it says something else.
    if let Some(spread) = number.spread.as_ref().filter(|_| number.interval().is_none() || misses_a_sensor(number)) {
        let class = if misses_a_sensor(number) { " class=\"beyond\"" } else { "" };
        let (count, range) = (spread.sensors(), range(spread.low, spread.high));
        lines.push(format!("<span{class}>{count} sensors: {range}</span>"));
    }
    lines.extend(remark(run, number));
    lines.extend(number.condition(is_speed_in_doubt).map(str::to_owned));
    let lines: String = lines.into_iter().map(|line| format!("<dd>{line}</dd>")).collect();
    format!(
        "<div class=\"card\" data-key=\"{}\"><dt>{}</dt>{shown}{lines}</div>\n",
        html(&number.name),
        html(&title(run, &number.name))
    )
}

/// The word of the trade.
pub(crate) fn title(run: &Run, name: &str) -> String {
    if name == CRUSH.key && run.test.barrier.as_deref() == Some(ANOTHER_VEHICLE) {
        return "Motion over ground".to_owned();
    }
    let filter = run.filter.as_ref().filter(|_| name == PEAK.key);
    let class = filter.and_then(|filter| filter.cfc.or_else(|| class_of_record(run)));
    match (class, filter.and_then(|filter| filter.cutoff_hz.first())) {
        (Some(cfc), _) => format!("Peak, CFC\u{a0}{cfc}"),
        (None, Some(hz)) => format!("Peak, filtered at {}", words::quantity(*hz, 0, "Hz")),
        (None, None) => KeyQuantity::of(name).map_or_else(|| words::metric(name), |known| known.title.to_owned()),
    }
}

fn misses_a_sensor(number: &KeyNumber) -> bool {
    number.interval_misses_a_sensor()
}

/// The interval as a bar, the value as a tick, the range of the sensors as a line below; the same in words.
fn bar(number: &KeyNumber, interval: &str) -> String {
    const WIDTH: f64 = 100.0;
    let Some(((low, high), value)) = number.interval().zip(number.value) else { return String::new() };
    let spread = number.spread.as_ref().map(|spread| (spread.low, spread.high));
    let ends = [Some((low, high)), spread, Some((value, value))].into_iter().flatten();
    let (left, right) = ends.fold((low, high), |(l, h), (a, b)| (l.min(a), h.max(b)));
    let x = |at: f64| if right > left { WIDTH * (0.1 + 0.8 * (at - left) / (right - left)) } else { 0.5 * WIDTH };
    let sensors = spread.map_or_else(String::new, |(from, to)| {
        format!("<path class=\"sensors\" d=\"M{:.1} 10H{:.1}\"/>", x(from), x(to))
    });
    let in_words = number.spread.as_ref().map_or_else(String::new, |spread| {
        format!("; {} sensors: {}", spread.sensors(), html(&number.range(spread.low, spread.high)))
    });
    format!(
        "<svg class=\"interval\" viewBox=\"0 0 {WIDTH} 12\" preserveAspectRatio=\"none\" role=\"img\">\
         <title>{interval}{in_words}</title><rect x=\"{:.1}\" y=\"2\" width=\"{:.1}\" height=\"5\"/>{sensors}\
         <path d=\"M{:.1} 0V9\"/></svg>",
        x(low),
        (x(high) - x(low)).max(0.5),
        x(value)
    )
}

fn interval_name(number: &KeyNumber) -> String {
    match (number.interval_source, &number.interval_by) {
        (Some(IntervalSourceV1::Replicates), _) => "inputs, 90\u{a0}%".to_owned(),
        (Some(IntervalSourceV1::Resolution), _) => "resolution".to_owned(),
        (_, Some(by)) => html(by),
        (_, None) => "interval".to_owned(),
    }
}

fn remark(run: &Run, number: &KeyNumber) -> Option<String> {
    let events = run.events.as_ref();
    let at = || number.at_s.map(|t| format!("at {}", words::quantity(MILLI * t, 1, "ms")));
    let is = |quantities: &[KeyQuantity]| quantities.contains(number.quantity());
    if is(&[PEAK, MAXIMUM_DELTA_V]) {
        at()
    } else if is(&[DELTA_V]) {
        let not_zero = events.is_some_and(|events| events.end_of_event_s.is_some());
        at().filter(|_| not_zero).map(|at| format!("{at}; the velocity does not reach zero"))
    } else if is(&[RESTITUTION]) {
        let rebound = events.and_then(|events| events.rebound_velocity_m_per_s)?.abs();
        let speed = words::quantity(KM_PER_H_PER_M_PER_S * rebound, 1, "km/h");
        Some(format!("rebound {speed}"))
    } else if is(&[TIME_OF_CRUSH]) {
        let ratio = events.and_then(|e| Some(e.centroid_time_s? / e.time_of_dynamic_crush_s?))?;
        Some(format!("t<sub>c</sub>/t<sub>m</sub> = {}", words::decimals(ratio, 3)))
    } else if is(&[OLC]) {
        Some("occupant load".to_owned())
    } else if is(&[HIC15, HIC36]) {
        Some("head injury criterion".to_owned())
    } else {
        number.side(run).map(str::to_owned)
    }
}

/// What the intervals of the cards are, below the first screen.
pub(super) fn write_caption(out: &mut String, numbers: &[KeyNumber]) {
    let interval_by = |source: IntervalSourceV1| {
        let of_source = numbers.iter().filter(|number| number.interval_source == Some(source));
        of_source.filter_map(|number| number.interval_by.as_deref()).next().map(html)
    };
    let mut sentences: Vec<String> = Vec::new();
    if let Some(by) = interval_by(IntervalSourceV1::Replicates) {
        sentences.push(format!(
            "Bars: 90\u{a0}% interval of {by} with mass, speed, gain, zero level and time zero within their stated \
             uncertainty, one sensor."
        ));
    }
    sentences.extend(interval_by(IntervalSourceV1::Resolution).map(|by| format!("Bars: {by}.")));
    if let Some(spread) = numbers.iter().find_map(|number| number.spread.as_ref()) {
        let channels = html(&spread.channels.join(", "));
        sentences.push(format!(
            "Lines below the bars: lowest to highest of channels {channels}, which measured the same motion."
        ));
    }
    if numbers.iter().any(KeyNumber::interval_misses_a_sensor) {
        sentences.push(
            "A marked range goes beyond the interval: the sensors differ by more than the stated uncertainty explains; \
             take both together."
                .to_owned(),
        );
    }
    if !sentences.is_empty() {
        out.push_str(&caption(&sentences.join(" ")));
    }
}
