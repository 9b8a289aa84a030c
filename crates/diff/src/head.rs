//! The head of a comparison of two runs: what the crash and the best model were on either side, for people.

use serde_json::Value;

/// Events of a summary that the head tells: key, name, factor to people's unit, decimals, unit.
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

fn line(name: &str, a: &str, b: &str) -> String {
    if a == b { format!("{name}: {a}") } else { format!("{name}: {a} -> {b}") }
}

/// `kelvin/closed-form/1 (fit 99.98 %)`, or `none`.
fn best(summary: &Value) -> String {
    let Some(id) = summary["best"].as_str() else { return "none".to_owned() };
    let candidates = summary["candidates"].as_array().map(Vec::as_slice).unwrap_or_default();
    let fit =
        candidates.iter().find(|candidate| candidate["id"] == id).and_then(|c| c["simulation"]["fit_percent"].as_f64());
    fit.map_or_else(|| id.to_owned(), |fit| format!("{id} (fit {fit:.2} %)"))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn both_sides_stand_in_people_s_units() {
        let candidate = |id: &str, fit: f64| json!([{"id": id, "simulation": {"fit_percent": fit}}]);
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
