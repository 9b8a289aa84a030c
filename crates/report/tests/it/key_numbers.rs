//! The first numbers of the page are those of `summary.json`, for every kind of record.

use std::path::Path;
use std::process::Command;

use crumple_artifact::records::{ChannelFilterV1, EventsV1, MetricV1};
use crumple_report::{Page, Ranking, Run, summary};
use crumple_signal::{Channel, QuantityKind, Sampled};
use serde_json::{Value, json};

fn record<T: serde::de::DeserializeOwned>(json: Value) -> T {
    serde_json::from_value(json).unwrap()
}

/// Page and summary of a run.
fn pages(run: &Run) -> (String, Value) {
    let ranking = Ranking::of_run(run);
    let mut bytes = Vec::new();
    Page::new(run, &ranking).write_to(&mut bytes).unwrap();
    let summary = serde_json::from_str(&summary(run, &ranking).to_json().unwrap()).unwrap();
    (String::from_utf8(bytes).unwrap(), summary)
}

/// Name and text of each card: `("dynamic_crush", "750 mm")`, `–` without a value.
fn cards(page: &str) -> Vec<(String, String)> {
    let cards = page.split("<div class=\"card\" data-key=\"").skip(1);
    cards
        .map(|card| {
            let (name, rest) = card.split_once('"').unwrap();
            let number = rest.split("<dd class=\"number\">").nth(1).unwrap().split("</dd>").next().unwrap();
            (name.to_owned(), number.replace("<small>", "").replace("</small>", "").replace('\u{a0}', " "))
        })
        .collect()
}

/// What a value in SI reads like, by a table of this test's own.
fn expected(number: &Value) -> String {
    let Some(value) = number["value"].as_f64() else { return "–".to_owned() };
    let name = number["name"].as_str().unwrap();
    let (factor, unit) = match number["unit"].as_str().unwrap() {
        "m" => (1000.0, " mm"),
        "s" => (1000.0, " ms"),
        "m/s" => (3.6, " km/h"),
        "m/s^2" => (1.0 / 9.80665, " g"),
        "deg" => (1.0, " °"),
        "1" => (1.0, ""),
        other => panic!("{other} of {name}"),
    };
    let digits = match name {
        "dynamic_crush" => 0,
        "coefficient_of_restitution" => 2,
        "hic15" | "hic36" | "time_of_maximum_delta_v" | "recorded_crush" | "principal_direction_of_force" => 0,
        _ => 1,
    };
    format!("{:.digits$}{unit}", factor * value).replace('-', "−")
}

fn assert_same(page: &str, summary: &Value) -> Vec<(String, String)> {
    let numbers = summary["key_numbers"].as_array().unwrap();
    let of_summary: Vec<(String, String)> =
        numbers.iter().map(|number| (number["name"].as_str().unwrap().to_owned(), expected(number))).collect();
    assert_eq!(cards(page), of_summary);
    for number in numbers {
        assert_eq!(number["value"].is_null(), number["absent_because"].is_string(), "{number}");
    }
    of_summary
}

#[test]
fn the_first_numbers_of_every_fixture_are_those_of_its_summary() {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures");
    for name in ["double", "elastoplastic", "kelvin", "noisy"] {
        let golden = fixtures.join(name).join("golden");
        let folder = tempfile::tempdir().unwrap();
        let mut artifacts: Vec<_> = std::fs::read_dir(&golden).unwrap().map(|entry| entry.unwrap().path()).collect();
        artifacts.retain(|path| path.extension().is_some_and(|ending| ending == "mcap"));
        artifacts.sort();
        let output = Command::new(env!("CARGO_BIN_EXE_crumple-report"))
            .args(&artifacts)
            .arg("-q")
            .arg("-o")
            .arg(folder.path().join("report.html"))
            .output()
            .unwrap();
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
        let summary: Value =
            serde_json::from_str(&std::fs::read_to_string(folder.path().join("summary.json")).unwrap()).unwrap();
        let numbers = assert_same(&page, &summary);
        assert_eq!(numbers.len(), 6, "{name}: C, t_m, change of velocity, peak, OLC, restitution");
        // They are those of the events too, which the golden summary of the whole run holds.
        let golden: Value =
            serde_json::from_str(&std::fs::read_to_string(golden.join("summary.json")).unwrap()).unwrap();
        let crush = golden["events"]["dynamic_crush_m"].as_f64().unwrap();
        assert_eq!(numbers[0].1, format!("{:.0} mm", 1e3 * crush), "{name}");
    }
}

fn metric(channel: &str, name: &str, value: Option<f64>, unit: &str, interval: Option<(f64, f64)>) -> MetricV1 {
    MetricV1 {
        name: name.into(),
        value,
        unit: unit.into(),
        channel: channel.into(),
        definition: "as defined".into(),
        low: interval.map(|ends| ends.0),
        high: interval.map(|ends| ends.1),
        interval_by: interval.map(|_| "5-95 % of 400 replicates".into()),
        ..MetricV1::default()
    }
}

/// Channel 93 with a positive pulse of 10 g at 20 ms, filtered to CFC 60 or not.
fn pulse(filtered: bool) -> Run {
    let mut run = Run::default();
    run.test.pulse = Some("93".into());
    run.test.channels = vec![Channel::new("93", QuantityKind::Acceleration)];
    let samples = (0..50).map(|k| if k == 20 { 98.0665 } else { -1.0 }).collect();
    let wave = Sampled::new(0.0, 1e-3, samples).unwrap();
    let mode = if filtered { "iso6487" } else { "none" };
    let filter: ChannelFilterV1 = record(json!({
        "cfc": filtered.then_some(60), "mode": mode, "frequency_factor": null, "samples_added": 0, "coefficients": [],
        "gain_at_class_db": null, "zero_level_removed": 0.0, "notes": [], "corridor_ok": null, "phase": null,
        "width_s": null, "resampled_to_hz": null, "shift_s": null
    }));
    run.measured.raw = Some(wave.clone());
    run.measured.filtered = Some(wave);
    run.filter = Some(filter);
    run
}

fn events(crush: Option<f64>) -> EventsV1 {
    EventsV1 {
        channel: "93".into(),
        dynamic_crush_m: crush,
        time_of_dynamic_crush_s: crush.map(|_| 0.074),
        delta_v_m_per_s: Some(18.0),
        impact_speed_m_per_s: Some(15.0),
        ..EventsV1::default()
    }
}

#[test]
fn a_peak_is_that_of_the_curve_and_an_unfiltered_pulse_has_none() {
    let (page, summary) = pages(&pulse(true));
    assert_eq!(assert_same(&page, &summary), [("peak_acceleration".to_owned(), "10.0 g".to_owned())]);
    assert!(page.contains("<dt>Peak, CFC\u{a0}60</dt>") && page.contains("at 20.0\u{a0}ms"));
    let (page, summary) = pages(&pulse(false));
    assert_eq!(assert_same(&page, &summary)[0].1, "–");
    assert!(page.contains("not filtered: the peak of a raw acceleration is mostly ringing"));
}

#[test]
fn a_spread_that_the_interval_misses_stands_beside_it_marked() {
    let mut run = pulse(true);
    let mut with_interval = events(Some(0.7499));
    with_interval.intervals = vec![record(json!({
        "name": "dynamic_crush_m", "low": 0.7398, "high": 0.7591, "interval_by": "5-95 % of 400 replicates"
    }))];
    run.events = Some(with_interval);
    run.metrics = vec![
        metric("93", "dynamic_crush", Some(0.7499), "m", Some((0.7398, 0.7591))),
        metric("93+94", "dynamic_crush", Some(0.7499), "m", Some((0.7321, 0.7499))),
    ];
    let (page, summary) = pages(&run);
    assert_same(&page, &summary);
    let crush = &summary["key_numbers"][0];
    assert_eq!(crush["spread"], json!({"low": 0.7321, "high": 0.7499, "channels": ["93", "94"]}));
    assert!(page.contains("<span class=\"beyond\">2 sensors: 732 to 750\u{a0}mm</span>"));
    assert!(page.contains("take both together"));
    run.metrics[1] = metric("93+94", "dynamic_crush", Some(0.7499), "m", Some((0.742, 0.7499)));
    let (page, _) = pages(&run);
    assert!(
        page.contains("; 2 sensors: 742 to 750\u{a0}mm</title>")
            && page.contains("<path class=\"sensors\"")
            && !page.contains("take both together")
    );
}

#[test]
fn a_vehicle_that_does_not_stop_says_so_instead_of_numbers() {
    let mut run = pulse(true);
    run.events = Some(events(None));
    let (page, summary) = pages(&run);
    let numbers = assert_same(&page, &summary);
    let shown: Vec<&str> = numbers.iter().map(|(_, text)| text.as_str()).collect();
    assert_eq!(shown, ["–", "–", "64.8 km/h", "10.0 g", "–"]);
    assert!(page.contains("the velocity does not reach zero"));
}

#[test]
fn an_occupants_sensor_has_its_criteria() {
    let mut run = pulse(true);
    run.events = Some(events(Some(0.5)));
    run.metrics = vec![
        metric("93+95", "hic15", Some(246.19), "1", None),
        metric("93+95", "hic36", Some(373.32), "1", None),
        metric("93+95", "clip_3ms_contiguous", Some(497.19), "m/s^2", None),
        metric("7", "hic15", Some(900.0), "1", None),
    ];
    let (page, summary) = pages(&run);
    let numbers = assert_same(&page, &summary);
    let shown: Vec<&str> = numbers.iter().map(|(_, text)| text.as_str()).collect();
    assert_eq!(shown, ["246", "373", "50.7 g"]);
    assert!(page.contains("<dt>HIC15</dt>") && page.contains("<dt>3 ms clip</dt>"));
    assert!(!page.contains("data-key=\"dynamic_crush\""), "no crush of a head");
}

#[test]
fn two_axes_of_a_vehicle_add_total_and_side_to_its_numbers() {
    let mut run = pulse(true);
    run.events = Some(events(Some(0.5)));
    let alone = assert_same_numbers(&run);
    run.metrics.push(metric("93+94", "total_delta_v", Some(18.0), "m/s", None));
    run.metrics.push(metric("93+94", "principal_direction_of_force", Some(21.8), "deg", None));
    run.metrics.push(metric("93+94", "total_delta_v_lateral", Some(-5.0), "m/s", None));
    let both = assert_same_numbers(&run);
    assert_eq!(both, [&alone[..], &["64.8 km/h".to_owned(), "22 °".to_owned()]].concat());
    assert!(pages(&run).0.contains("<dd>from the right</dd>"));
}

/// The values of all cards, which are those of the summary.
fn assert_same_numbers(run: &Run) -> Vec<String> {
    let (page, summary) = pages(run);
    assert_same(&page, &summary).into_iter().map(|(_, text)| text).collect()
}

#[test]
fn a_recorder_has_the_interval_of_its_resolution_and_no_peak() {
    let mut run = pulse(true);
    let of_recorder = |name: &str, value: f64, unit: &str, half: f64| MetricV1 {
        interval_by: Some("resolution of the recorder: half of its step to either side".into()),
        ..metric("dv", name, Some(value), unit, Some((value - half, value + half)))
    };
    run.metrics = vec![
        of_recorder("maximum_delta_v", -41.0 / 3.6, "m/s", 0.5 / 3.6),
        of_recorder("time_of_maximum_delta_v", 0.1, "s", 0.005),
    ];
    let (page, summary) = pages(&run);
    let numbers = assert_same(&page, &summary);
    let shown: Vec<&str> = numbers.iter().map(|(_, text)| text.as_str()).collect();
    assert_eq!(shown, ["−41.0 km/h", "100 ms"]);
    assert!(page.contains("resolution: −41.5 to −40.5\u{a0}km/h"));
    run.events = Some(events(Some(0.5)));
    let (page, summary) = pages(&run);
    let numbers = assert_same(&page, &summary);
    // The crush of an earlier artifact stands among the events alone.
    let shown: Vec<&str> = numbers.iter().map(|(_, text)| text.as_str()).collect();
    assert_eq!(shown, ["−41.0 km/h", "100 ms", "500 mm"]);
    run.metrics.push(of_recorder("recorded_ees", 41.0 / 3.6, "m/s", 0.1 / 3.6));
    run.metrics.push(of_recorder("recorded_crush", 0.505, "m", 0.06));
    run.recorded_changes = vec![("dv".to_owned(), run.measured.filtered.clone().unwrap())];
    let (page, summary) = pages(&run);
    let shown: Vec<String> = assert_same(&page, &summary).into_iter().map(|(_, text)| text).collect();
    assert_eq!(shown, ["−41.0 km/h", "100 ms", "41.0 km/h", "505 mm"]);
    run.metrics.push(metric("dv", "principal_direction_of_force", Some(21.8), "deg", None));
    run.metrics.push(metric("dv", "total_delta_v_lateral", Some(5.0), "m/s", None));
    let (sided, _) = pages(&run);
    assert!(sided.contains("<dd>from the left</dd>") && !page.contains("from the left"));
    assert!(page.contains("What the recorder kept") && !page.contains("id=\"model\""));
    assert!(!page.contains("id=\"curves\""), "its derivative is no pulse");
}
