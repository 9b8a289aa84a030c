//! Parts of the page that a plain run with one sensor does not show.

use std::collections::BTreeMap;

use crumple_artifact::records::{
    CandidateV1, EventIntervalV1, EventsV1, FitV1, MetricV1, RatedCandidateV1, RecommendationV1, ResponseV1,
    SensorFitV1, SimulationV1, UncertaintyV1,
};
use crumple_report::drawing::Figure;
use crumple_report::{CandidateResult, Model, Page, Ranking, Run, SensorMotion, all_figures, summary};
use crumple_signal::{Channel, QuantityKind, Sampled};

fn record<T: serde::de::DeserializeOwned>(json: serde_json::Value) -> T {
    serde_json::from_value(json).unwrap()
}

/// A ramp of 1 m over 0.1 s and on to 0.2 s, 1 kHz.
fn ramp(slope_m_per_s: f64) -> Sampled {
    Sampled::new(0.0, 1e-3, (0..200).map(|k| slope_m_per_s * 1e-3 * f64::from(k)).collect()).unwrap()
}

fn simulation(fit_percent: f64) -> SimulationV1 {
    record(serde_json::json!({
        "dynamic_crush_m": 0.5, "time_of_dynamic_crush_s": 0.1, "rmse_displacement_m": 1e-3, "fit_percent": fit_percent,
        "iso18571_score": null, "dynamic_crush_error_m": 0.0, "time_of_dynamic_crush_error_s": 0.0,
        "max_displacement_error_m": 0.0, "fit_velocity_percent": null, "fit_acceleration_percent": null,
        "from_s": 0.0, "to_s": 0.1, "aicc": null, "effective_samples": null, "fitted_parameters": null
    }))
}

fn candidate(id: &str, parameters: &[(&str, f64)], fit_percent: f64) -> CandidateResult {
    let mut parts = id.split('/');
    CandidateResult {
        id: id.to_owned(),
        record: CandidateV1 {
            model: parts.next().unwrap().to_owned(),
            method: parts.next().unwrap().to_owned(),
            parameters: parameters.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect(),
            physical: true,
            ..CandidateV1::default()
        },
        simulation: Some(simulation(fit_percent)),
        displacement: Some(ramp(9.0)),
        ..CandidateResult::default()
    }
}

fn fit(active_bounds: &[&str], sensors: Vec<SensorFitV1>) -> FitV1 {
    FitV1 {
        channel: "93".into(),
        quantity: "displacement".into(),
        from_s: 0.0,
        to_s: 0.1,
        samples: 100,
        rmse: 1e-3,
        iterations: 3,
        evaluations: 9,
        stop_reason: "cost-converged".into(),
        active_bounds: active_bounds.iter().map(|name| (*name).to_owned()).collect(),
        sensors,
    }
}

#[test]
fn none_is_recommended_where_the_choice_names_none() {
    let mut run = crash();
    run.candidates = vec![candidate("kelvin/closed-form/1", &[("stiffness_n_per_m", 3e5)], 99.0)];
    let because = "channel 93 is along y, and the models are of a crush along x";
    for (choice, reason) in [(None, "no choice"), (Some(choice(None, because, &[])), because)] {
        run.recommendation = choice;
        let ranking = Ranking::of_run(&run);
        assert_eq!((&ranking.best, ranking.order.len()), (&None, 1));
        let json = serde_json::from_str::<serde_json::Value>(&summary(&run, &ranking).to_json().unwrap()).unwrap();
        assert!(json["best"].is_null() && json["no_best"].as_str().unwrap().contains(reason), "{json}");
    }
    run.recommendation = Some(choice(Some("kelvin/closed-form/1"), "", &["kelvin/closed-form/1"]));
    assert_eq!(Ranking::of_run(&run).best.as_deref(), Some("kelvin/closed-form/1"));
}

/// A choice with this candidate recommended and these rated, in their order.
fn choice(recommended: Option<&str>, because: &str, rated: &[&str]) -> RecommendationV1 {
    let of_id = |id: &&str| RatedCandidateV1 { id: (*id).to_owned(), adequate: true, ..RatedCandidateV1::default() };
    RecommendationV1 {
        recommended: recommended.map(str::to_owned),
        recommended_because: because.to_owned(),
        candidates: rated.iter().map(of_id).collect(),
        ..RecommendationV1::default()
    }
}

/// The first candidate recommended where nobody chose.
fn ranking(run: &Run) -> Ranking {
    let ranking = Ranking::of_run(run);
    Ranking { best: ranking.best.clone().or_else(|| ranking.order.first().cloned()), ..ranking }
}

/// A run of one pulse, channel 93, with a displacement and a force.
fn crash() -> Run {
    let events: EventsV1 = record(serde_json::json!({
        "channel": "93", "time_zero_s": 0.0, "time_zero_rule": "given", "dynamic_crush_m": 1.0,
        "time_of_dynamic_crush_s": 0.1,
        "centroid_time_s": 0.06, "rebound_velocity_m_per_s": null, "coefficient_of_restitution": null,
        "delta_v_m_per_s": null
    }));
    let mut run = Run { events: Some(events), ..Run::default() };
    run.test.mass_kg = Some(1000.0);
    run.measured.displacement = Some(ramp(10.0));
    run.measured.force = Some(ramp(1e6));
    run
}

/// The page.
fn page(run: &Run) -> String {
    let mut bytes = Vec::new();
    Page::new(run, &ranking(run)).write_to(&mut bytes).unwrap();
    String::from_utf8(bytes).unwrap()
}

/// The figures of the run by id.
fn figures(run: &Run) -> BTreeMap<&'static str, Figure> {
    let figures = all_figures(run, &ranking(run));
    figures.into_iter().map(|figure| (figure.id, figure)).collect()
}

/// The names of a figure's legend, and whether their curves are shown at first.
fn legend(run: &Run, figure: &str) -> BTreeMap<String, bool> {
    let figure = &figures(run)[figure];
    figure.legend.iter().map(|entry| (entry.name.clone(), entry.shown)).collect()
}

#[test]
fn the_card_of_the_best_says_what_the_record_does_not_determine() {
    let mut run = crash();
    let mut best =
        candidate("kelvin/direct-fit/1", &[("c_n", 0.0), ("k_n_per_m", 3e5), ("mass_kg", 1e3), ("x_m", 0.1)], 99.0);
    best.record.fit = Some(fit(&["c_n"], vec![]));
    let deviations = [("k_n_per_m", 1e3), ("x_m", 0.2)].map(|(name, value)| (name.to_owned(), value));
    best.record.uncertainty = Some(UncertaintyV1 { standard_deviation: deviations.into(), ..UncertaintyV1::default() });
    // Open at both ends is not determined either, whatever its deviation.
    let mut open = best.clone();
    let known = open.record.uncertainty.as_mut().unwrap();
    known.interval_low = BTreeMap::from([("k_n_per_m".to_owned(), None)]);
    known.interval_high = known.interval_low.clone();
    let open_of =
        |candidate: &CandidateResult| (candidate.certainties().open.len(), candidate.certainties().parameters);
    assert_eq!((open_of(&best), open_of(&open)), ((1, 3), (2, 3)));
    // Also where nothing bounds it, so that it has no deviation.
    open.record.uncertainty.as_mut().unwrap().standard_deviation.remove("k_n_per_m");
    assert_eq!((open_of(&open), open.certainties().open.join(" ")), ((2, 3), "k_n_per_m x_m".to_owned()));
    run.candidates.push(best);
    let json: serde_json::Value = serde_json::from_str(&summary(&run, &ranking(&run)).to_json().unwrap()).unwrap();
    assert_eq!(
        (&json["best"], &json["best_undetermined"]),
        (&"kelvin/direct-fit/1".into(), &serde_json::json!(["x_m"]))
    );
    let page = page(&run);
    // Zero on a bound is an answer, a mass that is stated was not asked of the record.
    assert!(page.contains("2 of 3 parameters determined, 1 open."), "{page}");
    assert!(page.contains("(physical limit)") && !page.contains(">on a bound<"));
    assert!(page.contains("In the order of the choice"));
    assert!(page.contains("± is one standard deviation"));
}

#[test]
fn a_best_that_has_a_dual_is_named_with_it() {
    let mut run = crash();
    let ids = ["double-spring-mass-damper/direct-fit/1", "double-spring-mass-damper/direct-fit/2"];
    for (own, other) in [(0, 1), (1, 0)] {
        let mut candidate = candidate(ids[own], &[("k1_n_per_m", 3e5)], 99.0);
        candidate.record.equivalent_to = Some(ids[other].to_owned());
        run.candidates.push(candidate);
    }
    let names = ids.map(|id| run.name_of(id));
    assert_eq!(names, ["double spring-mass-damper (fitted)", "double spring-mass-damper (fitted, solution 2)"]);
    let dual = "Double spring-mass-damper (fitted, solution 2) gives the same record on this sensor.";
    assert!(page(&run).contains(dual));
    run.candidates[0].record.equivalent_to = None;
    assert!(!page(&run).contains(dual));
}

#[test]
fn ratings_stand_in_one_table_with_their_marks_and_what_is_missing_says_why() {
    let mut run = crash();
    let mut rated = candidate("kelvin/direct-fit/1", &[("k_n_per_m", 3e5)], 99.0);
    rated.simulation.as_mut().unwrap().ratings = record(serde_json::json!([
        {"name": "iso18571", "quantity": "acceleration", "value": null, "definition_id": "iso18571", "mark": "C",
         "from_s": null, "to_s": null, "note": "absent: sampled at 1000 Hz, the standard wants 10 kHz"},
        {"name": "cora", "quantity": "acceleration", "value": 0.8125, "definition_id": "cora", "mark": "M",
         "from_s": 0.0, "to_s": 0.1, "note": "interval: the compared window"},
        {"name": "sprague_geers_magnitude", "quantity": "acceleration", "value": -0.0625,
            "definition_id": "sprague-geers-m",
         "mark": "C", "from_s": 0.0, "to_s": 0.1, "note": null}
    ]));
    run.candidates.push(rated);
    let with = page(&run);
    assert!(with.contains("<h2>Ratings: model against test</h2>") && with.contains("[cora, mark M]"), "{with}");
    assert!(
        with.contains(">0.812<")
            && with.contains(">−0.062<")
            && with.contains("CORA (mark M) has interval: the compared window.")
    );
    assert!(
        with.contains("<abbr tabindex=\"0\" title=\"absent: sampled at 1000 Hz, the standard wants 10 kHz\">–</abbr>")
    );
    assert!(with.contains("Over 0.0 to 100.0 ms after time zero."));
    run.candidates[0].simulation.as_mut().unwrap().ratings.clear();
    assert!(!page(&run).contains("Ratings: model against test"));
}

#[test]
fn a_second_sensor_is_drawn_with_the_mass_that_sits_on_it() {
    let mut run = crash();
    run.other_sensors = vec![
        SensorMotion { channel: "95".into(), velocity: Some(ramp(5.0)), displacement: ramp(5.0) },
        SensorMotion { channel: "94".into(), velocity: None, displacement: ramp(10.0) },
    ];
    let sensor = |channel: &str, mass| SensorFitV1 {
        channel: channel.into(),
        mass,
        quantity: "displacement".into(),
        rmse: 1e-3,
        noise: 1e-3,
    };
    let mut double = candidate("double-spring-mass-damper/direct-fit/1", &[("m1_kg", 250.0)], 99.0);
    double.record.fit = Some(fit(&[], vec![sensor("93", 2), sensor("95", 1)]));
    double.masses = vec![(ramp(4.9), None)];
    run.candidates.push(double);
    for (channel, value) in [("93", 400.0), ("94", 390.0), ("95", 1000.0)] {
        run.metrics.push(MetricV1 {
            name: "peak_acceleration".into(),
            value: Some(value),
            unit: "m/s^2".into(),
            channel: channel.into(),
            ..MetricV1::default()
        });
    }
    run.metrics.push(MetricV1 {
        name: "peak_acceleration".into(),
        value: Some(400.0),
        unit: "m/s^2".into(),
        channel: "93+94".into(),
        low: Some(390.0),
        high: Some(400.0),
        interval_by: Some("range over 2 channels".into()),
        ..MetricV1::default()
    });
    let page = page(&run);
    let names = legend(&run, "sensors");
    assert!(names["sensor 95"] && !names["sensor 94"]);
    assert!(names["mass 1 of double spring-mass-damper (fitted)"], "{:?}", names.keys());
    // The range over 93 and 94 makes them sensors of one place.
    let curves = &figures(&run)["curves"];
    let place = curves.legend.iter().position(|entry| entry.name == "sensors at the same place: 93, 94").unwrap();
    let displacement = curves.panels.iter().find(|panel| panel.y.title == "displacement, mm").unwrap();
    assert!(displacement.bands.iter().any(|band| band.entry == place && band.points.len() == 400));
    assert!(page.contains("models of several masses were fitted to channel 95 too"));
    assert!(
        !page.contains("Everything here is read from one sensor") && !page.contains("One compartment accelerometer")
    );
    assert!(page.contains("<summary>Metrics of 2 other channels, beside the pulse's</summary>"));
    assert!(!page.contains("peak acceleration (94)"));
    // The range is no channel, and has its two ends.
    assert!(page.contains("title=\"over 93+94\">range</abbr>") && page.contains("39.77 to 40.79\u{a0}g"), "{page}");
}

#[test]
fn the_force_of_the_load_cells_stands_beside_that_of_the_sensor() {
    let mut run = crash();
    let cells = "barrier load cells (force over crush)";
    assert!(!legend(&run, "curves").contains_key(cells));
    run.measured.barrier_force = Some(ramp(1.1e6));
    let page = page(&run);
    assert!(legend(&run, "curves")[cells]);
    assert!(page.contains("The load cells measured it at the barrier"));
}

#[test]
fn a_chain_of_the_users_own_is_shown_at_first() {
    let mut run = crash();
    for k in 0..5 {
        run.candidates.push(candidate(&format!("kelvin/direct-fit/{k}"), &[("k_n_per_m", 1.0)], 99.0 - f64::from(k)));
    }
    run.candidates.push(candidate("chain/mine/1", &[("k1_n_per_m", 1.0)], 60.0));
    let names = legend(&run, "curves");
    assert!(!names["Kelvin model (fitted, solution 4), 95.00 %"] && names["Stated chain (mine), 60.00 %"]);
}

#[test]
fn of_sets_with_one_curve_the_first_is_shown_beside_the_recommended() {
    let mut run = crash();
    let ids = [
        "triple-spring-mass-damper/direct-fit/1",
        "triple-spring-mass-damper/direct-fit/2",
        "maxwell/direct-fit/1",
        "nonlinear-1/direct-fit/1",
        "kelvin/closed-form/1",
    ];
    for (id, (fit_percent, slope)) in
        ids.iter().zip([(99.0704, 9.0), (99.0697, 9.0), (98.6, 9.2), (99.5, 9.5), (97.4, 9.7)])
    {
        let mut candidate = candidate(id, &[("k_n_per_m", 1e9)], fit_percent);
        candidate.displacement = Some(ramp(slope));
        run.candidates.push(candidate);
    }
    run.recommendation = Some(choice(Some(ids[0]), "", &ids));
    let models = |shown: bool| -> Vec<String> {
        let names = legend(&run, "residual");
        names.into_iter().filter(|(_, is_shown)| *is_shown == shown).map(|(name, _)| name).collect()
    };
    assert_eq!(
        models(true),
        ["Maxwell model (fitted), 98.60 %", "recommended: triple spring-mass-damper (fitted), 99.070 %"]
    );
    for hidden in ["Triple spring-mass-damper (fitted, solution 2), 99.070 %", "Nonlinear model I (fitted), 99.50 %"] {
        assert!(models(false).iter().any(|name| name == hidden), "{hidden}");
    }
    // The closest is shown beside the recommended.
    run.recommendation.as_mut().unwrap().closest = Some(ids[3].to_owned());
    let names = legend(&run, "curves");
    assert!(names["closest: nonlinear model I (fitted), 99.50 %"] && !names["Maxwell model (fitted), 98.60 %"]);
    let looks: Vec<_> = figures(&run)["residual"].legend.iter().map(|e| format!("{:?}", e.look)).collect();
    assert_eq!(looks.iter().collect::<std::collections::BTreeSet<_>>().len(), looks.len());
}

#[test]
fn fits_that_are_equal_to_two_decimals_have_a_third_in_the_legend() {
    let mut run = crash();
    for (k, fit_percent) in [99.9942, 99.97, 91.08].into_iter().enumerate() {
        run.candidates.push(candidate(&format!("m{k}/fit/1"), &[("k_n_per_m", 1.0)], fit_percent));
    }
    let names = |run: &Run| legend(run, "curves").into_keys().collect::<Vec<_>>().join(", ");
    let two = names(&run);
    assert!(two.contains(", 99.99 %") && two.contains(", 91.08 %"), "{two}");
    run.candidates[0].simulation.as_mut().unwrap().fit_percent = Some(99.9738);
    let three = names(&run);
    assert!(three.contains(", 99.974 %") && three.contains(", 99.970 %") && three.contains(", 91.08 %"), "{three}");
}

#[test]
fn the_best_and_the_sensors_it_was_compared_with_are_shown_over_the_pulse() {
    let mut run = crash();
    run.other_sensors = ["94", "96"]
        .map(|channel| SensorMotion { channel: channel.into(), velocity: None, displacement: ramp(9.5) })
        .into();
    let mut best = candidate("kelvin/closed-form/1", &[("k_n_per_m", 3e5)], 99.0);
    best.simulation.as_mut().unwrap().other_sensors = record(serde_json::json!([
        {"channel": "94", "mass": 1, "rmse_displacement_m": 1e-3, "fit_percent": 97.0}
    ]));
    run.candidates.push(best);
    let with = legend(&run, "sensors");
    assert!(with["compartment of Kelvin model (closed form)"] && with["sensor 94"] && !with["sensor 96"]);
    let figures = all_figures(&run, &Ranking::of_run(&run));
    let sensors = figures.iter().find(|figure| figure.id == "sensors").unwrap();
    assert!(sensors.legend.iter().all(|entry| entry.name != "compartment of Kelvin model (closed form)"), "no best");
}

#[test]
fn an_interval_over_more_than_a_decade_is_wide_in_every_place_alike() {
    let mut run = crash();
    let mut best = candidate("maxwell/direct-fit/1", &[("c_n_s_per_m", 54e3), ("k_n_per_m", 3e5)], 99.0);
    let ends = |c: f64, k: f64| [("c_n_s_per_m".to_owned(), Some(c)), ("k_n_per_m".to_owned(), Some(k))].into();
    best.record.uncertainty = Some(UncertaintyV1 {
        standard_deviation: [("c_n_s_per_m".to_owned(), 34e3), ("k_n_per_m".to_owned(), 1e4)].into(),
        interval_low: ends(17.0, 1e5),
        interval_high: ends(1.8e8, 9e5),
        ..UncertaintyV1::default()
    });
    let certainties = best.certainties();
    assert_eq!((certainties.order_of_magnitude.join(" "), certainties.determined), ("c_n_s_per_m".to_owned(), 1));
    assert_eq!(certainties.open.len(), 0);
    let mut also_open = best.clone();
    also_open.record.uncertainty.as_mut().unwrap().standard_deviation.insert("k_n_per_m".to_owned(), 4e5);
    assert_eq!(
        also_open.certainties().words().unwrap(),
        "0 of 2 parameters determined, 1 with a wide interval, 1 open"
    );
    run.candidates.push(best);
    let page = page(&run);
    let words = "1 of 2 parameters determined, 1 with a wide interval";
    assert!(page.contains(&format!("<figcaption>{words};")), "the picture: {page}");
    assert!(
        page.contains(&format!("<span title=\"{words}\">1 of 2</span>").replace("<span ", "<span tabindex=\"0\" "))
    );
    assert!(page.contains("<span class=\"no\">wide interval</span>; 95\u{a0}%: 0.017 to 180000"), "{page}");
    let text = summary(&run, &ranking(&run)).to_json().unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["best_undetermined"], serde_json::json!([]));
    assert_eq!(json["best_hardly_determined"], serde_json::json!(["c_n_s_per_m"]));
    assert_eq!((&json["verdict"]["determined"], &json["verdict"]["order_of_magnitude"]), (&1.into(), &1.into()));
    assert_eq!(json["candidates"][0]["certainties"]["order_of_magnitude"], serde_json::json!(["c_n_s_per_m"]));
}

#[test]
fn a_record_that_is_no_crash_has_no_empty_cards_and_no_units_of_its_own() {
    let time_s: Vec<f64> = (0..400).map(|k| 0.2 * f64::from(k)).collect();
    let response: ResponseV1 = record(serde_json::json!({
        "input": "other p, 1", "output": "other y, \
         1", "model": "discrete", "frequency_hz": [0.1, 1.0], "magnitude": [1.0, 0.5],
        "phase_rad": [0.0, -1.0], "band": null, "magnitude_lower": [], "magnitude_upper": [], "phase_lower_rad": [],
        "phase_upper_rad": [], "impulse_of": "unit \
         sample", "impulse": time_s.iter().map(|t| (-t).exp()).collect::<Vec<_>>(),
        "step": time_s.iter().map(|t| 1.0 - (-t).exp()).collect::<Vec<_>>(), "time_s": time_s,
        "zeros_re_per_s": [], "zeros_im_rad_per_s": []
    }));
    let run = Run {
        models: vec![Model { id: "arx-2".into(), response: Some(response), ..Model::default() }],
        ..Run::default()
    };
    let page = page(&run);
    for word in
        ["class=\"card\"", "not known", "SI units", "crash pulse report", "other y", "read from one sensor", ", ms"]
    {
        assert!(!page.contains(word), "{word}");
    }
    assert!(page.contains("Response of y to a unit sample") && page.contains("time from the start of the window, s<"));
    // exp(-t) is below 1 % from 4.6 s on, the next sample stands at 4.8 s; the record has 80.
    let view = figures(&run)["responses"].panels[0].x.view.unwrap();
    assert!(view[0] == 0.0 && (view[1] - 7.2).abs() < 1e-9, "{view:?}");
}

fn metric(channel: &str, name: &str, value: f64, unit: &str, definition: &str) -> MetricV1 {
    MetricV1 {
        name: name.into(),
        value: Some(value),
        unit: unit.into(),
        channel: channel.into(),
        definition: definition.into(),
        ..MetricV1::default()
    }
}

#[test]
fn criteria_of_occupants_stand_open_with_their_place_and_in_the_summary() {
    let mut run = crash();
    let head = |id: &str| Channel { location: "driver, head".into(), ..Channel::new(id, QuantityKind::Acceleration) };
    run.test.channels = vec![head("1"), head("2")];
    run.metrics = vec![
        metric("93", "peak_acceleration", 400.0, "m/s^2", "largest |a|"),
        metric("94", "peak_acceleration", 390.0, "m/s^2", "largest |a|"),
        MetricV1 { is_lower_bound: true, ..metric("1+2", "hic15", 412.0, "1", "head injury criterion") },
    ];
    let page = page(&run);
    let (_, open) = page.split_once("<h3>Occupants, barrier and recorder</h3>").unwrap();
    let (open, folded) = open.split_once("<details><summary>Metrics of 1 other channel").unwrap();
    assert!(open.contains("driver, head (1+2)") && open.contains("(lower bound)") && !open.contains("390"), "{open}");
    assert!(!folded.split("</details>").next().unwrap().contains("hic15"));
    let json: serde_json::Value =
        serde_json::from_str(&summary(&run, &Ranking::of_run(&run)).to_json().unwrap()).unwrap();
    let other = &json["other_metrics"][0];
    assert_eq!((&other["name"], &other["channel"]), (&"hic15".into(), &"1+2".into()));
    assert_eq!((&other["location"], &other["value"]), (&"driver, head".into(), &412.0.into()));
    assert_eq!(json["other_metrics"].as_array().unwrap().len(), 1);
}

#[test]
fn a_vehicle_that_does_not_stop_has_its_change_of_velocity_with_the_end_of_its_event() {
    let mut run = crash();
    run.events = Some(record(serde_json::json!({
        "channel": "93", "time_zero_s": 0.0, "time_zero_rule": "file", "dynamic_crush_m": null,
        "time_of_dynamic_crush_s": null,
        "centroid_time_s": null, "rebound_velocity_m_per_s": null, "coefficient_of_restitution": null,
        "delta_v_m_per_s": 10.0,
        "time_of_delta_v_s": 0.144, "end_of_event_s": 0.1513, "end_of_event_rule": "20 ms with no more than 0.8 km/h \
         (49 CFR 563)",
        "without_interval": [{"name": "delta_v_m_per_s", "reason": "no interval: 3 of 400 replicates do not have it"}]
    })));
    let page = page(&run);
    assert!(page.contains("at 144.0\u{a0}ms; the velocity does not reach zero"), "{page}");
    assert!(page.contains("no interval: 3 of 400 replicates do not have it"));
    assert!(page.contains("up to the end of the event at 151.3 ms (20 ms with no more than 0.8 km/h (49 CFR 563))"));
}

#[test]
fn a_recorder_without_a_speed_has_its_change_of_velocity_on_the_card() {
    let mut run = crash();
    run.events = None;
    run.test.pulse = Some("dv_derivative".into());
    let acceleration = QuantityKind::Acceleration;
    run.test.channels = vec![Channel::new("dv_derivative", acceleration)];
    let change = metric("dv", "maximum_delta_v", -60.0 / 3.6, "m/s", "as recorded");
    run.metrics = vec![MetricV1 { from_s: Some(0.1), to_s: Some(0.1), ..change }];
    let page = page(&run);
    assert!(
        page.contains("<dt>Maximum Δv as recorded</dt><dd class=\"number\">−60.0\u{a0}<small>km/h</small></dd>")
            && page.contains("<dd>at 100.0\u{a0}ms</dd>"),
        "{page}"
    );
}

#[test]
fn the_intervals_of_events_stand_on_their_cards() {
    let mut run = crash();
    let events = run.events.as_mut().unwrap();
    events.dynamic_crush_m = Some(0.7499);
    events.intervals = vec![EventIntervalV1 {
        name: "dynamic_crush_m".into(),
        low: 0.7398,
        high: 0.7591,
        interval_by: "5-95 % of 400 replicates".into(),
        interval_source: None,
    }];
    let page = page(&run);
    // As a bar with words, and its ends below it.
    let (_, card) = page.split_once("750\u{a0}<small>mm</small></dd><dd><svg class=\"interval\"").unwrap();
    assert!(card.contains("<title>inputs, 90\u{a0}%: 740 to 759\u{a0}mm</title>"), "{card}");
    assert!(card.contains("</svg></dd><dd>740 to 759\u{a0}mm</dd>"), "{card}");
}

#[test]
fn the_choice_and_the_predictions_stand_on_the_page_and_in_the_summary() {
    let mut run = crash();
    run.candidates = vec![
        candidate("kelvin/closed-form/1", &[("stiffness_n_per_m", 3e5)], 99.0),
        candidate("elastoplastic/closed-form/1", &[("loading_stiffness_n_per_m", 3e5)], 97.0),
    ];
    run.recommendation = Some(record(serde_json::json!({
        "recommended": "elastoplastic/closed-form/1", "recommended_because": "plastic",
        "simplest": null, "simplest_because": "each has an open number",
        "closest": "kelvin/closed-form/1", "closest_because": "99 %",
        "evidence": null,
        "priors": [{"name": "class", "statement": "plastic < damped", "source": "tests"}],
        "candidates": [{
            "id": "elastoplastic/closed-form/1", "class": "plastic", "adequate": true, "not_adequate_because": null,
            "parameters": 2, "determined": 1, "misfit": 3.0, "fit_as_measured_percent": 97.0,
            "coefficient_of_restitution": 0.15, "force_misfit_percent": null, "aicc": 7.0, "aicc_difference": 2.5,
            "priors": [{"name": "class", "term": 0.0}], "difference_with_priors": 0.0
        }]
    })));
    run.predictions = vec![record(serde_json::json!({
        "candidate": "elastoplastic/closed-form/1", "recommended": true, "names": ["recommended"],
        "impact_speed_m_per_s": 17.78, "mass_kg": 1500.0, "partner": "a <car>", "dynamic_crush_m": 0.8407,
        "time_of_dynamic_crush_s": 0.074, "delta_v_m_per_s": 20.0, "coefficient_of_restitution": 0.159,
        "peak_acceleration_m_per_s2": 377.0, "olc_m_per_s2": null, "energy": null, "extrapolates": true,
        "intervals": [
            {"name": "dynamic_crush_m", "level": 0.9, "low": 0.803, "high": 0.878, "interval_by": "rate effect"}
        ],
        "notes": ["extrapolates: element 1"],
        "collision": {
            "kind": "vehicle", "partner_candidate": "kelvin/closed-form/1", "closing_speed_m_per_s": 35.0,
            "partner_speed_m_per_s": 17.22, "partner_mass_kg": 1200.0, "common_velocity_m_per_s": 2.0,
            "mutual_crush_m": 1.5, "partner_crush_m": 0.6593, "partner_delta_v_m_per_s": null,
            "partner_peak_acceleration_m_per_s2": null, "partner_olc_m_per_s2": null, "absorbed_j": 2e5,
            "partner_absorbed_j": 1.5e5, "energy_equivalent_speed_m_per_s": null,
            "partner_energy_equivalent_speed_m_per_s": null, "velocity_after_m_per_s": null,
            "partner_velocity_after_m_per_s": null, "momentum_before_n_s": 1e4, "momentum_after_n_s": 1e4
        },
        "occupant": {
            "time_of_contact_s": 0.025, "relative_speed_at_contact_m_per_s": 3.0, "peak_acceleration_m_per_s2": 392.266,
            "time_of_peak_s": 0.07, "largest_excursion_m": 0.25, "time_of_largest_excursion_s": 0.08,
            "ride_down_share": 0.4, "restraint_share": 0.6
        }
    }))];
    let ranking = Ranking::of_run(&run);
    assert_eq!((ranking.best.as_deref(), ranking.order.len()), (Some("elastoplastic/closed-form/1"), 2));
    let html = page(&run).replace('\u{a0}', " ");
    for text in [
        "elastoplastic spring (closed form)</strong>, plastic.",
        "Simplest: <strong>none</strong>, each has an open number.",
        "plastic &lt; damped",
        "<td class=\"n\">64.0</td><td class=\"n\">1500</td>",
        "841<br><span tabindex=\"0\" title=\"rate effect\">[803 to 878]</span>",
        "against a &lt;car&gt;, 1200 kg, closing at 126.0 km/h: common velocity 7.2 km/h, mutual crush 1500 mm, of \
         it the partner’s 659 mm; energy 200.0 kJ and 150.0 kJ; partner’s Δv –",
        "occupant: peak 40.0 g, 250 mm ahead of the compartment, ride-down 40 %",
        "<summary>extrapolates</summary><ul><li>extrapolates: element 1</li></ul>",
    ] {
        assert!(html.contains(text), "{text}");
    }
    let json = serde_json::from_str::<serde_json::Value>(&summary(&run, &ranking).to_json().unwrap()).unwrap();
    assert_eq!((&json["best"], &json["recommended"]), (&json["recommended"], &"elastoplastic/closed-form/1".into()));
    assert_eq!((&json["closest"], &json["simplest"]), (&"kelvin/closed-form/1".into(), &serde_json::Value::Null));
    assert_eq!(json["predictions"][0]["dynamic_crush_m"], 0.8407);
}
