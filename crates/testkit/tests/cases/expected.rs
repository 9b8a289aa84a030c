//! What a case expects of an answer: words, numbers by name or by JSON pointer, predictions, modes, columns.

use crumple_signal::STANDARD_GRAVITY_M_PER_S2 as G;
use serde_json::Value;

use crate::records::{Answer, texts};

pub fn remarks(summary: &Value) -> String {
    format!("{}{}", summary["notes"], summary["concerns"])
}

/// What has to be said, and is not; what must not, and is.
pub fn said(expected: &Value, text: &str) -> Vec<String> {
    let is_said = |pattern: &String| regex::Regex::new(pattern).unwrap().is_match(text);
    let missing = texts(&expected["must_say"]).into_iter().filter(|pattern| !is_said(pattern));
    let missing: Vec<String> = missing.map(|pattern| format!("{pattern} is not said: {text}")).collect();
    let wrong = texts(&expected["must_not_say"]).into_iter().filter(is_said);
    [missing, wrong.map(|pattern| format!("{pattern} is said: {text}")).collect()].concat()
}

/// Numbers outside their ranges.
pub fn numbers(expected: &Value, answer: &Answer) -> Vec<String> {
    let summary = &answer.summary;
    let metric = |name: &str| summary["metrics"][name]["value"].as_f64();
    let event = |name: &str| summary["events"][name].as_f64();
    let delta_v = || event("delta_v_m_per_s").or_else(|| metric("delta_v")).map(f64::abs);
    let recommended =
        summary["candidates"].as_array().into_iter().flatten().find(|c| c["id"] == summary["recommended"]);
    let fit = recommended.and_then(|c| {
        let simulation = &c["simulation"];
        simulation["fit_as_measured_percent"].as_f64().or_else(|| simulation["fit_percent"].as_f64())
    });
    let fits_of_models = summary["models"].as_array().into_iter().flatten().filter_map(|m| m["fit_percent"].as_f64());
    let of_lines = answer.said.lines().filter(|line| line.contains("fit ")).filter_map(|line| {
        line.split("fit ").nth(1)?.split_whitespace().next()?.trim_end_matches('%').parse::<f64>().ok()
    });
    let best = fit.or_else(|| fits_of_models.chain(of_lines).reduce(f64::max));
    let found = [
        ("crush_mm", event("dynamic_crush_m").map(|m| 1e3 * m)),
        ("peak_g", metric("peak_acceleration").map(|a| a.abs() / G)),
        ("delta_v_m_s", delta_v()),
        ("delta_v_km_h", delta_v().or_else(|| metric("maximum_delta_v").map(f64::abs)).map(|v| 3.6 * v)),
        ("hic15", metric("hic15")),
    ];
    let of_metric = &summary["metrics"]["delta_v"];
    let spread = ["low", "high"].map(|end| ("spread_delta_v_km_h", of_metric[end].as_f64().map(|v| 3.6 * v.abs())));
    let spread = spread.into_iter().filter(|(_, end)| end.is_some());
    let found: Vec<(&str, Option<f64>)> = found.into_iter().chain(spread).collect();
    let ranges = found.iter().filter_map(|(name, value)| {
        let range = expected[*name].as_array()?;
        let is_inside = value.is_some_and(|x| range[0].as_f64() <= Some(x) && Some(x) <= range[1].as_f64());
        (!is_inside).then(|| format!("{name} is {value:?}, expected {range:?}"))
    });
    let least = expected["fit_at_least"].as_f64().filter(|least| best.is_none_or(|fit| fit < *least));
    let fits = least.map(|least| format!("fit {best:?}, expected {least} at least"));
    let rest = [of_pointers(expected, summary), of_predictions(expected, summary), of_models(expected, answer)];
    let tables = answer.tables.iter().filter(|_| expected["decimal_columns"] == true);
    let whole = tables.flat_map(|table| whole_columns(table));
    ranges.chain(fits).chain(rest.concat()).chain(whole).collect()
}

/// The number range `[low, high]` of a case.
fn is_in(range: &Value, value: Option<f64>) -> bool {
    let ends = range[0].as_f64().zip(range[1].as_f64());
    ends.zip(value).is_some_and(|((low, high), value)| low <= value && value <= high)
}

/// The value at a JSON pointer; a step `name=value` picks the item of a list whose field has that value, a last `|`
/// takes its size.
fn at(summary: &Value, pointer: &str) -> Value {
    let found = pointer.trim_end_matches('|').split('/').skip(1).try_fold(summary, |value, step| {
        let picked = step.split_once('=').map(|(name, text)| {
            let number: Option<f64> = text.parse().ok();
            let has = |item: &&Value| item[name] == text || (number.is_some() && item[name].as_f64() == number);
            value.as_array().and_then(|items| items.iter().find(has))
        });
        picked.unwrap_or_else(|| value.get(step).or_else(|| value.get(step.parse::<usize>().ok()?)))
    });
    match found.and_then(Value::as_f64).filter(|_| pointer.ends_with('|')) {
        Some(number) => Value::from(number.abs()),
        None => found.cloned().unwrap_or_default(),
    }
}

/// `values`, `absent`, `is`, `is_not` and `some_value`.
fn of_pointers(expected: &Value, summary: &Value) -> Vec<String> {
    let rows = |key: &str| expected[key].as_object().cloned().unwrap_or_default();
    let mut faults = Vec::new();
    for (pointer, range) in rows("values") {
        let value = at(summary, &pointer);
        if !is_in(&range, value.as_f64()) {
            faults.push(format!("{pointer} is {value}, expected {range}"));
        }
    }
    for pointer in texts(&expected["absent"]) {
        if !at(summary, &pointer).is_null() {
            faults.push(format!("{pointer} is there"));
        }
    }
    for (key, right) in [("is", true), ("is_not", false)] {
        for (pointer, values) in rows(key) {
            let value = at(summary, &pointer);
            if values.as_array().is_some_and(|values| values.contains(&value)) != right {
                faults.push(format!("{pointer} is {value}, {key} {values}"));
            }
        }
    }
    for ways in expected["some_value"].as_array().into_iter().flatten() {
        let fits = |found: &(f64, String)| {
            ways.as_array().is_some_and(|ways| ways.iter().any(|way| way[2] == *found.1 && is_in(way, Some(found.0))))
        };
        if !quantities(summary).iter().any(fits) {
            faults.push(format!("no value is one of {ways}"));
        }
    }
    faults
}

/// Every number of a summary that has a unit beside it, by its size.
fn quantities(value: &Value) -> Vec<(f64, String)> {
    match value {
        Value::Object(fields) => {
            let own = value["value"].as_f64().zip(value["unit"].as_str());
            let own = own.map(|(number, unit)| (number.abs(), unit.to_owned()));
            own.into_iter().chain(fields.values().flat_map(quantities)).collect()
        }
        Value::Array(items) => items.iter().flat_map(quantities).collect(),
        _ => Vec::new(),
    }
}

/// `predicts`, `overlaps` and `candidate`.
fn of_predictions(expected: &Value, summary: &Value) -> Vec<String> {
    let crush = |km_h: f64| {
        let recommended = summary["predictions"].as_array()?.iter().find(|p| {
            p["recommended"] == true && p["impact_speed_m_per_s"].as_f64().is_some_and(|v| (3.6 * v - km_h).abs() < 0.5)
        })?;
        let interval = recommended["intervals"].as_array()?.iter().find(|i| i["name"] == "dynamic_crush_m")?;
        let mm = |value: &Value| value.as_f64().map(|m| 1e3 * m);
        Some((mm(&recommended["dynamic_crush_m"])?, mm(&interval["low"])?, mm(&interval["high"])?))
    };
    let mut faults = Vec::new();
    if let Some(asked) = expected["predicts"].as_object() {
        let (km_h, right) = (asked["km_h"].as_f64().unwrap(), asked["crush_mm"].as_f64().unwrap());
        let near = |(value, low, high): (f64, f64, f64)| {
            (value / right - 1.0).abs() <= asked["percent"].as_f64().unwrap() / 1e2 || low <= right && right <= high
        };
        match crush(km_h) {
            None if expected["predicts"]["none"] == true => {}
            found if found.is_some_and(near) => {}
            found => faults.push(format!("at {km_h} km/h {found:?} is predicted, expected {right} mm")),
        }
    }
    if let Some(asked) = expected["overlaps"].as_object() {
        let found = crush(asked["km_h"].as_f64().unwrap());
        let overlaps = |(_, low, high): (f64, f64, f64)| {
            low <= asked["mm"][1].as_f64().unwrap() && asked["mm"][0].as_f64().unwrap() <= high
        };
        if !found.is_some_and(overlaps) {
            faults.push(format!("{found:?} is predicted, expected {}", asked["mm"]));
        }
    }
    if let Some(asked) = expected["candidate"].as_object() {
        let has_all = |candidate: &Value| {
            asked.iter().all(|(name, range)| match name.as_str() {
                "model" => candidate["model"] == *range,
                name => is_in(range, candidate["parameters"][name].as_f64()),
            })
        };
        if !summary["candidates"].as_array().into_iter().flatten().any(has_all) {
            faults.push(format!("no candidate is {}", expected["candidate"]));
        }
    }
    faults
}

/// `modes`, `no_mode`, `poles` and `transfer`, of one model each.
fn of_models(expected: &Value, answer: &Answer) -> Vec<String> {
    let data =
        |name: &'static str| answer.records.iter().filter(move |(topic, _)| topic.contains(name)).map(|(_, data)| data);
    let lists = |key: &str| expected[key].as_array().cloned().unwrap_or_default();
    let modes = |data: &Value| -> Vec<[f64; 2]> {
        let modes = data["modes"].as_array().into_iter().flatten().filter(|mode| mode["kind"] == "mode");
        let hz = |mode: &Value| mode["natural_frequency_rad_per_s"].as_f64().map(|w| w / std::f64::consts::TAU);
        modes.filter_map(|mode| Some([hz(mode)?, 1e2 * mode["damping_ratio"].as_f64()?])).collect()
    };
    let in_all = |modes: Vec<[f64; 2]>| {
        let has = |hz: &Value| modes.iter().any(|mode| is_in(hz, Some(mode[0])) && is_in_second(hz, mode[1]));
        lists("modes").iter().all(has) && !lists("no_mode").iter().any(|hz| modes.iter().any(|m| is_in(hz, Some(m[0]))))
    };
    let mut faults = Vec::new();
    if expected["modes"].is_array() && !data("/modes/").any(|data| in_all(modes(data))) {
        let found: Vec<_> = data("/modes/").map(modes).collect();
        faults.push(format!("modes {found:?}, expected {} without {}", expected["modes"], expected["no_mode"]));
    }
    let poles = |data: &Value| -> Vec<f64> {
        let modes = data["modes"].as_array().into_iter().flatten();
        modes.filter(|m| m["discrete_im"] == 0.0).filter_map(|m| m["discrete_re"].as_f64()).collect()
    };
    let has_poles =
        |data: &Value| lists("poles").iter().all(|range| poles(data).iter().any(|z| is_in(range, Some(*z))));
    if expected["poles"].is_array() && !data("/modes/").any(has_poles) {
        faults.push(format!(
            "poles {:?}, expected {}",
            data("/modes/").map(poles).collect::<Vec<_>>(),
            expected["poles"]
        ));
    }
    let transfer = |data: &Value| {
        let parts = expected["transfer"].as_object().unwrap();
        parts.iter().all(|(part, ranges)| {
            let ranges = ranges.as_array().unwrap();
            ranges.iter().enumerate().all(|(k, range)| is_in(range, data[part][k].as_f64()))
        })
    };
    if expected["transfer"].is_object() && !data("/transfer-function").any(transfer) {
        faults.push(format!("no model is {}", expected["transfer"]));
    }
    faults
}

/// The damping of a row of `modes`, where it states one.
fn is_in_second(row: &Value, percent: f64) -> bool {
    row.get(2).is_none_or(|low| low.as_f64() <= Some(percent) && Some(percent) <= row[3].as_f64())
}

/// Columns of measured numbers that begin with a hundred whole numbers: a reader that looks at these takes the column
/// for integers.
fn whole_columns(table: &str) -> Vec<String> {
    let mut rows = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let names = rows.next().unwrap_or_default();
    let rows: Vec<Vec<&str>> = rows.collect();
    let is_whole = |k: &usize| {
        let cells: Vec<&str> = rows.iter().filter_map(|row| row.get(*k).copied()).collect();
        let is_decimal = |cell: &&str| cell.contains('.') || cell.contains('e');
        cells.len() > 100 && !cells[..100].iter().any(is_decimal) && cells.iter().any(is_decimal)
    };
    (0..names.len()).filter(is_whole).map(|k| format!("column {} begins with whole numbers", names[k])).collect()
}
