//! What a reader asks for first when two results differ: events of the crash, parameters of candidates, metrics.

use crate::differences::Difference;

/// The kinds of difference that are printed first, in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Headline {
    /// Crush, its time and the rest of the events.
    Events,
    /// Parameters of candidates, and candidates that one side lacks.
    Parameters,
    /// Values of metrics.
    Metrics,
}

impl Headline {
    pub(crate) const ALL: [Self; 3] = [Self::Events, Self::Parameters, Self::Metrics];

    /// The kind of a difference, and its name in a summary, by which its repetition in `summary.json` is recognised;
    /// `None` for all others.
    pub(crate) fn of_difference(topic: &str, place: &str) -> Option<(Self, String)> {
        if topic == "/events" {
            return Some((Self::Events, format!("events.{place}")));
        }
        if let Some(id) = topic.strip_prefix("/parameters/") {
            let key = if place.is_empty() { format!("candidates[{id}]") } else { format!("candidates[{id}].{place}") };
            return (place.is_empty() || place.starts_with("parameters.")).then_some((Self::Parameters, key));
        }
        if topic == "/metrics" {
            let name = place.strip_suffix("].value")?.strip_prefix('[')?;
            // Where several channels carry a name, metrics are paired by index; a summary names them.
            let named = name.parse::<usize>().is_err();
            return named.then(|| (Self::Metrics, format!("metrics.{name}.value")));
        }
        if topic.starts_with('/') {
            return None;
        }
        // A summary.
        let of_candidate = || place.strip_prefix("candidates[")?.split_once(']').map(|(_, within)| within);
        let kind = if place.starts_with("events.") {
            Self::Events
        } else if of_candidate().is_some_and(|within| within.is_empty() || within.starts_with(".parameters.")) {
            Self::Parameters
        } else if place.starts_with("metrics.") && place.ends_with(".value") {
            Self::Metrics
        } else {
            return None;
        };
        Some((kind, place.to_owned()))
    }
}

/// Sort key of the differences of a topic: results of the crash, then what they were made of, remarks last.
pub(crate) fn sort_key(difference: &Difference) -> usize {
    let place = difference.place.as_str();
    let last = place.rsplit_once('.').map_or(place, |(_, last)| last);
    match last {
        "dynamic_crush_m" => 0,
        "time_of_dynamic_crush_s" => 1,
        "fit_percent" => 2,
        _ if last.starts_with("notes") => 4,
        _ => 3,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_summary_repeats_what_records_say_by_the_same_name() {
        for (topic, place, name) in [
            ("/events", "dynamic_crush_m", "events.dynamic_crush_m"),
            ("/parameters/kelvin/fit/1", "parameters.k_n_per_m", "candidates[kelvin/fit/1].parameters.k_n_per_m"),
            ("/metrics", "[olc].value", "metrics.olc.value"),
        ] {
            let record = Headline::of_difference(topic, place);
            assert_eq!(record, Headline::of_difference("summary.json", name), "{topic}");
            assert_eq!(record.unwrap().1, name);
        }
        for (topic, place) in [
            ("/parameters/kelvin/fit/1", "fit.rmse"),
            ("summary.json", "candidates[a].fit.rmse"),
            ("/metrics", "[olc].unit"),
            ("/metrics", "[3].value"),
            ("/wave/93", "sample 3"),
        ] {
            assert_eq!(Headline::of_difference(topic, place), None, "{topic}, {place}");
        }
    }
}
