//! The head of a comparison of two runs: what the crash and the best model were on either side, for people.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::Comparison;

/// Parameters that differ by less, relative to the larger, are not shown where they do not count.
const SHOWN_RELATIVE: f64 = 0.01;

/// Events of a summary that stand in the head: key, name, factor to the printed unit, decimals, unit.
const EVENTS: [(&str, &str, f64, usize, &str); 4] = [
    ("dynamic_crush_m", "dynamic crush", 1e3, 1, " mm"),
    ("time_of_dynamic_crush_s", "time of dynamic crush", 1e3, 2, " ms"),
    ("delta_v_m_per_s", "change of velocity", 3.6, 2, " km/h"),
    ("coefficient_of_restitution", "restitution", 1.0, 4, ""),
];

/// A line each for the events and the best model of two `summary.json`: `dynamic crush: 750.0 mm -> 751.0 mm`.
///
/// A line whose key neither side has is left out; what one side does not know is `none`. What prints alike stands once.
pub fn head(a: &Value, b: &Value) -> Vec<String> {
    let mut lines = Vec::new();
    for (key, name, factor, places, unit) in EVENTS {
        if [a, b].iter().all(|side| side["events"].get(key).is_none()) {
            continue;
        }
        let shown = |side: &Value| {
            side["events"][key].as_f64().map_or_else(|| "none".to_owned(), |x| format!("{:.places$}{unit}", factor * x))
        };
        lines.push(line(name, &shown(a), &shown(b)));
    }
    if [a, b].iter().any(|side| side.get("best").is_some()) {
        lines.push(line("best model", &best(a), &best(b)));
    }
    lines
}

/// Parameters of candidates of both summaries that differ by more than 1 % and are no difference of the report: the
/// record does not determine them, or the tolerance is wide.
/// `kelvin/closed-form/1, stiffness_n_per_m: 357000.0  768000.0  (for information)`.
pub fn tolerated_parameters(a: &Value, b: &Value, report: &Comparison) -> Vec<String> {
    let topics = report.files.iter().flat_map(|file| &file.topics).filter(|topic| !topic.topic.starts_with('/'));
    let reported: BTreeSet<&str> = topics.flat_map(|topic| &topic.differences).map(|d| d.place.as_str()).collect();
    let candidates = |side: &'_ Value| side["candidates"].as_array().cloned().unwrap_or_default();
    let others = candidates(b);
    let mut lines = Vec::new();
    for candidate in candidates(a) {
        let Some(id) = candidate["id"].as_str() else { continue };
        let Some(other) = others.iter().find(|other| other["id"] == id) else { continue };
        for (name, value) in candidate["parameters"].as_object().into_iter().flatten() {
            let Some((x, y)) = value.as_f64().zip(other["parameters"][name].as_f64()) else { continue };
            let apart = (x - y).abs() > SHOWN_RELATIVE * x.abs().max(y.abs());
            if apart && !reported.contains(format!("candidates[{id}].parameters.{name}").as_str()) {
                lines.push(format!("{id}, {name}: {value}  {}  (for information)", other["parameters"][name]));
            }
        }
    }
    lines
}

fn line(name: &str, a: &str, b: &str) -> String {
    if a == b { format!("{name}: {a}") } else { format!("{name}: {a} -> {b}") }
}

/// `kelvin/closed-form/1 (fit 99.98 %)`, or `none`.
fn best(summary: &Value) -> String {
    let Some(id) = summary["best"].as_str() else { return "none".to_owned() };
    let candidates = summary["candidates"].as_array().map(Vec::as_slice).unwrap_or_default();
    let simulation = candidates.iter().find(|candidate| candidate["id"] == id).map(|best| &best["simulation"]);
    // The fit that page and ranking show.
    let fit = |key: &str| simulation?[key].as_f64();
    let fit = fit("fit_as_measured_percent").or_else(|| fit("fit_percent"));
    fit.map_or_else(|| id.to_owned(), |fit| format!("{id} (fit {fit:.2} %)"))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn parameters_that_the_record_does_not_determine_are_told_though_they_are_no_difference() {
        let side = |k: f64, c: f64| {
            json!({"candidates": [{"id": "kelvin/fit/1", "parameters": {"c": c, "k": k, "m": 900.0},
                "uncertainty": {"standard_deviation": {"k": 1e6, "c": 1.0}, "interval_low": {}, "interval_high": {}}}]})
        };
        let (a, b) = (side(1000.0, 50.0), side(2000.0, 90.0));
        let topic = crate::compare_json("summary.json", &a, &b, &crate::CompareSettings::default());
        assert_eq!(topic.differences.len(), 1, "c alone: {topic:?}");
        let file = crate::FileReport { name: "summary.json".into(), topics: vec![topic], ..Default::default() };
        let report = Comparison::new("one".into(), "two".into(), false, vec![file]);
        assert_eq!(tolerated_parameters(&a, &b, &report), ["kelvin/fit/1, k: 1000.0  2000.0  (for information)"]);
        assert!(tolerated_parameters(&a, &side(1000.5, 90.0), &report).is_empty(), "a thousandth");
    }

    #[test]
    fn both_sides_stand_in_people_s_units() {
        let simulation = |fit: f64| json!({"fit_percent": 9.0, "fit_as_measured_percent": fit});
        let candidate = |id: &str, fit: f64| json!([{"id": id, "simulation": simulation(fit)}]);
        let a = json!({"events": {"dynamic_crush_m": 0.75, "delta_v_m_per_s": 18.0}, "best": "kelvin/closed-form/1",
                       "candidates": candidate("kelvin/closed-form/1", 99.0)});
        let b = json!({"events": {"dynamic_crush_m": null, "delta_v_m_per_s": 18.0}, "best": null, "candidates": []});
        assert_eq!(
            head(&a, &b),
            [
                "dynamic crush: 750.0 mm -> none",
                "change of velocity: 64.80 km/h",
                "best model: kelvin/closed-form/1 (fit 99.00 %) -> none"
            ]
        );
        assert_eq!(head(&json!({}), &json!(3)), Vec::<String>::new());
    }
}
