//! The verdict by kind of record, its numbers beside `summary.json`, and the order of the warnings.

mod without_model;

use std::path::Path;

use crumple_artifact::records::{
    CandidateV1, EventIntervalV1, EventsV1, EvidenceV1, IdentificationV1, MetricV1, ModeV1, PredictedCollisionV1,
    PredictedIntervalV1, PredictionV1, RatedCandidateV1, RecommendationV1, RemarkV1, SimulationV1, StrengthV1,
    UncertaintyV1,
};
use crumple_report::{
    CandidateResult, Kind, Model, Page, Ranking, ResultStatus, Run, Status, conclusion, overview, summary,
};
use crumple_signal::{ANOTHER_VEHICLE, Axis, Channel, QuantityKind};
use serde_json::{Value, json};

const BEST: &str = "kelvin/direct-fit/1";

fn record<T: serde::de::DeserializeOwned>(json: Value) -> T {
    serde_json::from_value(json).unwrap()
}

fn channel(id: &str, location: &str) -> Channel {
    Channel { location: location.to_owned(), axis: Some(Axis::X), ..Channel::new(id, QuantityKind::Acceleration) }
}

/// A car of 873 kg against a wall, with its Kelvin model.
fn car() -> Run {
    let mut run = Run::default();
    run.test.title = "a car".to_owned();
    run.test.mass_kg = Some(873.0);
    run.test.impact_speed_m_per_s = Some(9.7222);
    run.test.channels = vec![channel("93", "vehicle, left rear seat crossmember")];
    run.events = Some(EventsV1 {
        channel: "93".to_owned(),
        dynamic_crush_m: Some(0.44764),
        time_of_dynamic_crush_s: Some(0.0772),
        coefficient_of_restitution: Some(0.1963),
        rebound_velocity_m_per_s: Some(-1.9085),
        delta_v_m_per_s: Some(17.517),
        impact_speed_m_per_s: Some(9.7222),
        intervals: vec![EventIntervalV1 {
            name: "dynamic_crush_m".to_owned(),
            low: 0.44012,
            high: 0.45531,
            interval_by: "5-95 % of 400 replicates".to_owned(),
            interval_source: None,
        }],
        ..EventsV1::default()
    });
    run.candidates = vec![candidate(BEST, 99.87)];
    run.responses = Some(1);
    run.recommendation = Some(RecommendationV1 {
        recommended: Some(BEST.to_owned()),
        recommended_because: "the only one".to_owned(),
        closest: Some(BEST.to_owned()),
        ..RecommendationV1::default()
    });
    run.predictions = vec![prediction(15.0, 0.690, true), prediction(8.0, 0.36831, false)];
    run
}

fn candidate(id: &str, fit_percent: f64) -> CandidateResult {
    let mut parts = id.split('/').map(str::to_owned);
    let interval = |low: f64, high: f64| -> Value { json!({"stiffness_n_per_m": low, "damping_n_s_per_m": high}) };
    CandidateResult {
        id: id.to_owned(),
        record: CandidateV1 {
            model: parts.next().unwrap(),
            method: parts.next().unwrap(),
            parameters: record(json!({"mass_kg": 873.0, "stiffness_n_per_m": 330e3, "damping_n_s_per_m": 2.5e3})),
            physical: true,
            equivalent_to: None,
            fit: None,
            uncertainty: Some(UncertaintyV1 {
                standard_deviation: record(interval(1e3, 20.0)),
                interval_low: record(interval(328e3, 2.46e3)),
                interval_high: record(interval(332e3, 2.54e3)),
                ..UncertaintyV1::default()
            }),
            notes: vec![],
            ..CandidateV1::default()
        },
        simulation: Some(SimulationV1 {
            fit_percent: Some(fit_percent),
            fit_as_measured_percent: Some(fit_percent),
            to_s: 0.0772,
            ..SimulationV1::default()
        }),
        ..CandidateResult::default()
    }
}

fn prediction(impact_speed_m_per_s: f64, crush_m: f64, extrapolates: bool) -> PredictionV1 {
    PredictionV1 {
        candidate: BEST.to_owned(),
        recommended: true,
        impact_speed_m_per_s,
        mass_kg: 873.0,
        dynamic_crush_m: Some(crush_m),
        extrapolates,
        intervals: vec![PredictedIntervalV1 {
            name: "dynamic_crush_m".to_owned(),
            level: 0.9,
            low: crush_m - 0.02,
            high: crush_m + 0.02,
            interval_by: String::new(),
        }],
        ..PredictionV1::default()
    }
}

fn concern(stage: &str, about: &str, weight: u8, text: &str) -> RemarkV1 {
    let [stage, about, text] = [stage, about, text].map(str::to_owned);
    RemarkV1 { stage, about, weight, text, ..RemarkV1::default() }
}

fn summary_of(run: &Run) -> Value {
    serde_json::from_str(&summary(run, &Ranking::of_run(run)).to_json().unwrap()).unwrap()
}

fn page_of(run: &Run) -> String {
    let mut bytes = Vec::new();
    Page::new(run, &Ranking::of_run(run)).write_to(&mut bytes).unwrap();
    String::from_utf8(bytes).unwrap()
}

/// The leading number of what is shown, and the factor of its unit.
fn shown_in_si(shown: &str) -> (f64, f64) {
    let (number, unit) = shown.split_once('\u{a0}').unwrap_or((shown, ""));
    let factor = match unit {
        "mm" | "ms" => 1e3,
        "km/h" => 3.6,
        "g" => 1.0 / 9.80665,
        "Hz" => 1.0 / std::f64::consts::TAU,
        _ => 1.0,
    };
    (number.replace('−', "-").replace(',', ".").parse().unwrap(), factor)
}

/// Half a unit of the last digit; of an integer that is rounded to tens or hundreds, that of its last digit but zeros.
fn half_of_the_last_place(shown: &str) -> f64 {
    let number = shown.split('\u{a0}').next().unwrap();
    let place = match number.split_once('.') {
        Some((_, decimals)) => -i32::try_from(decimals.len()).unwrap(),
        None => i32::try_from(number.len() - number.trim_end_matches('0').len()).unwrap(),
    };
    0.5 * 10_f64.powi(place)
}

/// Every number of the verdict is that of the summary, rounded as shown; no other number stands in its sentences.
/// `names`: words with digits that are no numbers.
fn assert_numbers_are_those_of_the_summary(run: &Run, names: &[&str]) -> Vec<String> {
    let summary = summary_of(run);
    let (said, _) = conclusion(run, &Ranking::of_run(run));
    let mut sentences = format!("{} {}", said.status_sentence, said.sentences.join(" "));
    for name in names {
        sentences = sentences.replace(name, "");
    }
    for number in &said.numbers {
        let there = summary.pointer(&number.at).unwrap_or_else(|| panic!("{} is not in the summary", number.at));
        assert_eq!(there.as_f64(), Some(number.value), "{}", number.at);
        // Ends of intervals have the unit of the value before them.
        let is_end = ["/low", "/high", "/low_m"].iter().any(|end| number.at.ends_with(end));
        let unit = is_end.then(|| format!("{}\u{a0}mm", number.shown));
        let (value, factor) = shown_in_si(unit.as_deref().unwrap_or(&number.shown));
        let half = half_of_the_last_place(&number.shown);
        // A rebound is a speed.
        let value_in_unit = if number.at.contains("rebound") { number.value.abs() } else { number.value };
        assert!((value - factor * value_in_unit).abs() <= 1.000_001 * half, "{number:?}");
        assert!(sentences.contains(&number.shown), "{} in {sentences}", number.shown);
        sentences = sentences.replacen(&number.shown, "", 1);
    }
    assert!(!sentences.chars().any(|c| c.is_ascii_digit()), "a number that no record backs: {sentences}");
    assert_eq!(summary["verdict"]["sentences"], json!(said.sentences));
    assert_eq!(summary["verdict"]["status"], json!(said.status_reason.as_ref().unwrap().status()));
    let page = page_of(run);
    let top = &page[..page.find("<dl>").unwrap()];
    let top = top.replace("<strong>", "").replace("</strong><span>: </span>", ": ");
    for sentence in said.sentences.iter().chain([&said.status_sentence]) {
        assert!(top.contains(&sentence.replace('\'', "&#39;")), "{sentence} stands on top of the page");
    }
    said.sentences
}

#[test]
fn weak_evidence_and_a_missed_event_of_the_own_test_are_said() {
    let mut run = car();
    run.candidates.push(candidate("maxwell/direct-fit/1", 99.0));
    let choice = run.recommendation.as_mut().unwrap();
    let rated = |id: &str| RatedCandidateV1 { id: id.to_owned(), adequate: true, ..RatedCandidateV1::default() };
    choice.candidates = vec![rated(BEST), rated("maxwell/direct-fit/1")];
    (choice.strength, choice.beside) = (Some(StrengthV1::Decisive), Some("maxwell/direct-fit/1".to_owned()));
    assert!(status_of(&run).starts_with("usable: "));
    run.recommendation.as_mut().unwrap().strength = Some(StrengthV1::Contrary);
    // Of a misfit that was not computed nothing is said.
    assert!(status_of(&run).starts_with("usable: "));
    let candidates = &mut run.recommendation.as_mut().unwrap().candidates;
    (candidates[0].misfit, candidates[1].misfit) = (Some(2.0), Some(1.5));
    let contrary = "chosen for its crush at lower speeds: Maxwell model (fitted) follows the pulse closer.";
    assert_eq!(status_of(&run), format!("usable with care: {contrary}"));
    run.recommendation.as_mut().unwrap().strength = Some(StrengthV1::Weak);
    let weak = "the evidence is weak: Maxwell model (fitted) fits nearly as well.";
    assert_eq!(status_of(&run), format!("usable with care: {weak}"));
    // What is asked and wide goes before it, and it is said still.
    run.predictions[0].asked = true;
    let said = conclusion(&run, &Ranking::of_run(&run)).0.sentences;
    assert_eq!(said[2].to_lowercase(), weak.to_lowercase());
    run.predictions[0].asked = false;
    let own = &mut run.recommendation.as_mut().unwrap().candidates[0];
    (own.adequate, own.missed_events) = (false, vec!["coefficient_of_restitution".to_owned()]);
    let because = "use its crush only: the model misses the coefficient of restitution of its own test";
    assert_eq!(status_of(&run), format!("usable with care: {because}."));
}

/// The status of a run as a person reads it.
fn status_of(run: &Run) -> String {
    conclusion(run, &Ranking::of_run(run)).0.status_sentence.replace('\u{a0}', " ")
}

#[test]
fn a_barrier_test_says_crush_model_and_prediction() {
    let sentences = assert_numbers_are_those_of_the_summary(&car(), &[]);
    let plain: Vec<String> = sentences.iter().map(|text| text.replace('\u{a0}', " ")).collect();
    assert_eq!(
        plain,
        [
            "The dynamic crush was 448 mm at 77 ms; the vehicle rebounded at 7 km/h.",
            "For other speeds use the Kelvin model: at 28.8 km/h it gives 368 mm (348 to 388).",
            "Beyond 448 mm, the crush of the test, it extrapolates.",
        ]
    );
    assert_eq!(status_of(&car()), "usable: the crush at 28.8 km/h is predicted to ±5 %.");
}

#[test]
fn a_prediction_known_to_more_than_a_tenth_is_said_with_its_width() {
    let mut run = car();
    // 36.831 mm is a tenth of the crush.
    (run.predictions[1].intervals[0].low, run.predictions[1].intervals[0].high) = (0.33148, 0.40514);
    assert_eq!(status_of(&run), "usable: the crush at 28.8 km/h is predicted to ±10 %.");
    run.predictions[1].intervals[0].high = 0.40515;
    assert_eq!(status_of(&run), "usable with care: the crush at 28.8 km/h is predicted to ±11 %.");
    // Known to a third it answers nothing; what was measured holds where nobody asked for it.
    run.predictions[1].intervals[0].high = 0.62;
    assert_eq!(status_of(&run), "usable with care: the crush at 28.8 km/h is predicted to ±39 %.");
    run.predictions[1].asked = true;
    let said = assert_numbers_are_those_of_the_summary(&run, &[]);
    assert_eq!(status_of(&run), "do not use: the crush at 28.8 km/h is predicted to ±39 %.");
    assert!(said.len() <= 2, "{said:?}");
    run.predictions[1].intervals.clear();
    assert_eq!(status_of(&run), "usable with care: the crush at other speeds has no interval.");
    run.predictions.clear();
    assert_eq!(status_of(&run), "usable with care: the crush at other speeds has no interval.");
}

#[test]
fn a_speed_beyond_the_test_is_answered_as_one_and_so_is_one_that_was_asked_for() {
    let mut run = car();
    run.predictions.remove(1);
    let said = assert_numbers_are_those_of_the_summary(&run, &[]);
    assert!(said[1].ends_with("at 54\u{a0}km/h, beyond the test, it gives 690\u{a0}mm (670 to 710)."), "{said:?}");
    let status = "usable with care: at 54 km/h, beyond the test, the crush is predicted to ±3 %.";
    assert_eq!(status_of(&run), status);
    // Asked for, it goes before one within what was tested.
    let mut run = car();
    run.predictions[0].asked = true;
    let said = assert_numbers_are_those_of_the_summary(&run, &[]);
    assert!(said[1].contains("at 54\u{a0}km/h, beyond the test"), "{said:?}");
    assert_eq!(status_of(&run), status);
    // Where all of it is doubtful nothing of it is to be used.
    run.remarks = vec![concern("integrate", "impact-speed", 3, "is the impact speed right?")];
    let said = assert_numbers_are_those_of_the_summary(&run, &[]);
    let answer = "Asked for: at 54 km/h the Kelvin model gives 690 mm (670 to 710).";
    assert_eq!(said[1].replace('\u{a0}', " "), answer);
    assert_eq!(status_of(&run), "do not use: the impact speed is in doubt, see warning 1.");
}

#[test]
fn a_mass_and_a_partner_that_were_asked_for_are_named() {
    let mut run = car();
    run.predictions.push(PredictionV1 { asked: true, mass_kg: 1000.0, ..prediction(8.0, 0.4, false) });
    let said = assert_numbers_are_those_of_the_summary(&run, &[]);
    assert!(said[1].contains(": at 28.8\u{a0}km/h with 1000\u{a0}kg it gives 400\u{a0}mm"), "{said:?}");
    assert!(page_of(&run).contains("<small>with 1000\u{a0}kg</small>"));
    assert_eq!(status_of(&run), "usable: the crush at 28.8 km/h with 1000 kg is predicted to ±5 %.");
    run.predictions[2].partner = Some("a van".to_owned());
    run.predictions[2].collision = Some(PredictedCollisionV1::default());
    let said = assert_numbers_are_those_of_the_summary(&run, &[]);
    assert!(said[1].contains(" with 1000\u{a0}kg against a van it gives 400\u{a0}mm"), "{said:?}");
}

#[test]
fn a_crush_that_other_sensors_dispute_is_good_to_what_they_are_apart() {
    let mut run = car();
    run.metrics = vec![MetricV1 { low: Some(0.43), high: Some(0.4477), ..metric("dynamic_crush", 0.44, "93+94+99") }];
    assert_numbers_are_those_of_the_summary(&run, &[]);
    let because = "3 sensors of the compartment read 430 to 448 mm of crush; a single one is good to ±8 mm";
    assert_eq!(status_of(&run), format!("usable with care: {because}."));
    let page = page_of(&run).replace('\u{a0}', " ");
    assert!(page.contains("3 sensors of the compartment give a crush of 430 mm to 448 mm: quote the range"), "{page}");
}

#[test]
fn a_knot_of_a_curve_is_named_by_its_deflection() {
    let mut run = car();
    let record = &mut run.candidates[0].record;
    record.model = "force-deflection".to_owned();
    record.parameters.extend([("knot1_m".to_owned(), 0.0966), ("knot1_n".to_owned(), 9.4e4)]);
    let uncertainty = record.uncertainty.as_mut().unwrap();
    uncertainty.standard_deviation.insert("knot1_n".to_owned(), 2e5);
    uncertainty.interval_low.insert("knot1_n".to_owned(), None);
    let said = assert_numbers_are_those_of_the_summary(&run, &[]);
    assert_eq!(said[1].split(':').next(), Some("For other speeds use the force-deflection curve"));
    assert_eq!(said[2], "Not identifiable from this record: the force at 97\u{a0}mm.");
    let because = "use its crush, not its parameters: 2 of 3 are determined";
    assert_eq!(status_of(&run), format!("usable with care: {because}."));
}

#[test]
fn open_numbers_and_mirror_images_are_said() {
    let mut run = car();
    let open = &mut run.candidates[0].record;
    open.uncertainty.as_mut().unwrap().standard_deviation.insert("damping_n_s_per_m".to_owned(), 5e3);
    let said = assert_numbers_are_those_of_the_summary(&run, &[]);
    assert_eq!(said[2], "Not identifiable from this record: c.");
    assert!(status_of(&run).ends_with("1 of 2 is determined."), "{}", status_of(&run));
    // Both at once: the status says the one, a sentence the other.
    run.candidates[0].record.equivalent_to = Some("kelvin/direct-fit/2".to_owned());
    assert_eq!(assert_numbers_are_those_of_the_summary(&run, &[])[2], said[2]);
    let mut run = car();
    run.candidates[0].record.equivalent_to = Some("kelvin/direct-fit/2".to_owned());
    assert!(status_of(&run).ends_with("use its crush, not its mass split: one sensor cannot identify the split."));
    run.metrics = vec![MetricV1 { low: Some(0.43), high: Some(0.4477), ..metric("dynamic_crush", 0.44, "93+94") }];
    let said = assert_numbers_are_those_of_the_summary(&run, &[]);
    assert!(said[2].ends_with("a mirrored (dual) model fits equally well."), "{said:?}");
}

#[test]
fn a_vehicle_that_does_not_stop_has_a_change_of_velocity_and_no_model() {
    let mut run = car();
    let events = run.events.as_mut().unwrap();
    (events.dynamic_crush_m, events.time_of_dynamic_crush_s) = (None, None);
    (events.coefficient_of_restitution, events.time_of_delta_v_s) = (None, Some(0.144));
    run.recommendation.as_mut().unwrap().recommended = None;
    let said = assert_numbers_are_those_of_the_summary(&run, &[]);
    assert!(said[0].contains("did not stop within the record: it lost 63.1\u{a0}km/h in 144.0\u{a0}ms"), "{said:?}");
    assert_eq!(said[1], "No model is recommended: the vehicle was not seen to stop.");
    let closest = "The closest, Kelvin model (fitted), has a displacement fit of 99.9\u{a0}% up to 77\u{a0}ms.";
    assert_eq!(said[2], closest);
    assert_eq!(status_of(&run), "usable with care: use its delta-v: the vehicle did not stop within the record.");
    assert_eq!(conclusion(&run, &Ranking::of_run(&run)).0.standing, ResultStatus::NoneRecommended);
}

#[test]
fn of_two_vehicles_the_way_over_ground_is_no_crush() {
    let mut run = car();
    run.test.barrier = Some(ANOTHER_VEHICLE.to_owned());
    let said = assert_numbers_are_those_of_the_summary(&run, &[]);
    assert!(said[0].starts_with("Two vehicles collided: this one lost 63.1\u{a0}km/h"), "{said:?}");
    assert_eq!(status_of(&run), "usable with care: use its delta-v: its motion over ground is not its crush.");
    let (_, concerns) = conclusion(&run, &Ranking::of_run(&run));
    assert!(concerns[0].about == "motion" && concerns[0].weight == 9, "{concerns:?}");
    assert!(concerns[0].text.contains("the other vehicle for a rigid wall"), "{concerns:?}");
    assert!(page_of(&run).contains("<dt>Motion over ground</dt>") && !page_of(&run).contains("<dt>Dynamic crush"));
}

fn metric(name: &str, value: f64, channel: &str) -> MetricV1 {
    MetricV1 {
        name: name.to_owned(),
        value: Some(value),
        channel: channel.to_owned(),
        from_s: Some(0.11),
        ..MetricV1::default()
    }
}

#[test]
fn a_sensor_in_an_occupant_has_criteria_and_no_model() {
    let mut run = car();
    run.test.channels = vec![channel("93", "driver, head")];
    run.metrics = vec![metric("hic15", 246.2, "93"), metric("clip_3ms_contiguous", 497.19, "93")];
    run.remarks = vec![concern("integrate", "occupants", 1, "another class")];
    let said = assert_numbers_are_those_of_the_summary(&run, &["HIC15", "3 ms clip"]);
    assert!(!said[1].contains("lower bounds"), "{said:?}");
    run.remarks = vec![concern("integrate", "occupants", 2, "criteria are lower bounds")];
    run.remarks[0].code = "CR352".to_owned();
    let said = assert_numbers_are_those_of_the_summary(&run, &["HIC15", "3 ms clip"]);
    assert!(said[0].contains("(driver, head), not in the vehicle: HIC15 246, 3 ms clip 50.7\u{a0}g."), "{said:?}");
    assert!(
        said[1].ends_with("for the vehicle; the criteria are lower bounds: not all axes are in this record."),
        "{said:?}"
    );
}

#[test]
fn criteria_of_a_sensor_that_may_be_clipped_are_lower_bounds() {
    let mut run = car();
    run.test.channels = vec![channel("93", "occupant front left, head, centre of gravity")];
    run.metrics = vec![metric("hic15", 246.4, "93+2")];
    let warned = |run: &Run| page_of(run).contains("may be clipped");
    assert!(!page_of(&run).contains('\u{2265}') && !warned(&run));
    // A sensor of nothing that stands here, though a metric is of it.
    run.clipped = vec!["3".to_owned()];
    run.metrics.push(metric("peak_acceleration", 310.0, "3"));
    assert!(!page_of(&run).contains('\u{2265}') && !warned(&run));
    run.clipped.push("2".to_owned());
    let page = page_of(&run);
    assert!(page.contains("HIC15 \u{2265}\u{a0}246") && page.contains("<dd class=\"number\">\u{2265}\u{a0}246"));
    assert!(warned(&run) && !page.contains("not all axes"));
    assert_eq!(summary_of(&run)["key_numbers"][0]["is_lower_bound"], true);
}

#[test]
fn a_recorders_table_has_its_change_of_velocity_and_no_peak() {
    let mut run = car();
    let of_table = [("maximum_delta_v", 6.9444), ("recorded_ees", 6.8), ("absorbed_energy_share", 0.97)];
    run.metrics = of_table.map(|(name, value)| metric(name, value, "93")).into();
    run.metrics.extend([metric("recorded_crush", 0.4, "93"), metric("peak_acceleration", 90.0, "93")]);
    let said = assert_numbers_are_those_of_the_summary(&run, &[]);
    assert!(said[0].contains("a delta-v of 25.0\u{a0}km/h, reached at 110\u{a0}ms"), "{said:?}");
    assert!(said[1].contains("the EES is 24.5\u{a0}km/h: 0.97 of the kinetic energy"), "{said:?}");
    assert!(said[2].starts_with("Its table is too coarse for peak and force; its crush of 400\u{a0}mm"), "{said:?}");
}

fn identified() -> Vec<Model> {
    let identification: IdentificationV1 = record(json!({
        "method": "n4sid", "order": 4, "channel": "y", "treated_as": "output", "from_s": 0.0, "to_s": 1.0,
        "samples": 100, "hankel_rows": null, "hankel_columns": null, "singular_values": [], "fit_percent": 88.27,
        "rmse": null, "notes": []
    }));
    let mode: ModeV1 = record(json!({
        "re_per_s": -1.0, "im_rad_per_s": 20.0, "natural_frequency_rad_per_s": 20.025, "damping_ratio": 0.0499
    }));
    vec![Model {
        id: "n4sid-4".to_owned(),
        identification: Some(identification),
        modes: vec![mode],
        ..Model::default()
    }]
}

#[test]
fn inputs_and_outputs_have_the_closest_identified_model() {
    let mut run = Run { models: identified(), ..Run::default() };
    let said = assert_numbers_are_those_of_the_summary(&run, &["n4sid-4"]);
    assert!(
        said[0].starts_with(
            "The closest identified model, n4sid-4, has a fit of 88.3\u{a0}%; its slowest mode is at 3.19\u{a0}Hz, \
        damping ratio 0.050"
        ),
        "{said:?}"
    );
    // Nobody asks for the mass of a hair dryer.
    run.remarks =
        vec![concern("ingest", "mass", 3, "no mass is stated"), concern("identify", "identified-models", 1, "b")];
    let page = page_of(&run);
    let first = &page[page.find("before-use").unwrap()..page.find("<h2>Identification").unwrap()];
    assert!(!page.contains("no mass") && first.contains("<b>Identified models:</b> b"), "{first}");
    run.remarks.pop();
    assert!(!page_of(&run).contains("before-use\""), "nothing is said of a mass alone");
}

#[test]
fn poles_that_are_no_modes_are_in_no_sentence_on_modes() {
    let mut run = Run { models: identified(), ..Run::default() };
    let page = page_of(&run);
    assert!(page.contains("All poles are stable.") && !page.contains("marginal"));
    run.models[0].other_poles = vec![
        record(json!({"re_per_s": 0.01, "im_rad_per_s": 0.03, "kind": "integrator"})),
        record(json!({"re_per_s": 0.01, "im_rad_per_s": -0.03, "kind": "integrator"})),
        record(json!({"re_per_s": -1.0, "im_rad_per_s": 400.0, "kind": "beyond-nyquist"})),
    ];
    let said = assert_numbers_are_those_of_the_summary(&run, &["n4sid-4"]);
    assert!(said[0].contains("its slowest mode is at 3.19\u{a0}Hz"), "{said:?}");
    let page = page_of(&run);
    assert!(!page.contains("All poles are stable.") && page.contains("2 poles are marginal"));
    assert!(page.contains("no mode: near zero") && page.contains("no mode: beyond the sampling"));
    let model = &summary_of(&run)["models"][0];
    assert_eq!((model["poles"].as_array().unwrap().len(), model["modes"].as_array().unwrap().len()), (4, 1));
    // A growing pair is no mode of what was measured either.
    run.models[0].modes[0].re_per_s = 1.0;
    let said = assert_numbers_are_those_of_the_summary(&run, &["n4sid-4"]);
    assert!(!said[0].contains("slowest"), "{said:?}");
    let page = page_of(&run);
    assert!(page.contains("One pole is unstable"));
    // Nobody says so of a model whose poles are not written.
    run.models[0].other_poles.clear();
    run.models[0].modes[0].re_per_s = -1.0;
    run.models.push(Model { id: "arx-2".to_owned(), modes: Vec::new(), ..identified().remove(0) });
    assert!(!page_of(&run).contains("All poles are stable."));
}

#[test]
fn a_model_that_unseen_samples_contradict_is_not_to_be_used() {
    let evidence = |fit: f64| -> EvidenceV1 {
        record(json!({
            "output": "y", "initial_conditions": "estimated", "losses": [], "parameters": 5,
            "numerator_deviations": [], "denominator_deviations": [], "frequency_deviations": [],
            "damping_deviations": [], "zeros_re_per_s": [], "zeros_im_rad_per_s": [], "singular_value_errors": [],
            "zero_re_deviations": [], "zero_im_deviations": [], "frequency_spreads": [], "damping_spreads": [],
            "zero_re_spreads": [], "zero_im_spreads": [], "parameter_names": [], "parameter_values": [],
            "parameter_deviations": [], "parameter_correlations": [], "denominator_covariance": [],
            "validation_fit_percent": fit, "holds_on_unseen": fit > 0.0
        }))
    };
    let mut run = Run { models: identified(), ..Run::default() };
    run.models[0].evidence = Some(evidence(80.0));
    let said = assert_numbers_are_those_of_the_summary(&run, &["n4sid-4"]);
    assert!(said[0].contains("n4sid-4, has a fit of 88.3\u{a0}% (unseen samples: 80.0\u{a0}%)"), "{said:?}");
    run.models[0].evidence = Some(evidence(-5595.0));
    let said = assert_numbers_are_those_of_the_summary(&run, &["n4sid-4"]);
    assert!(said[0].starts_with("No identified model holds: the best, n4sid-4, has a fit of 88.3\u{a0}%"), "{said:?}");
    assert!(said[0].contains("5595.0\u{a0}%") && said[1].starts_with("Do not use it"), "{said:?}");
    // One that holds goes before one that follows its own samples closer.
    let mut other = identified().remove(0);
    (other.id, other.evidence) = ("arx-2".to_owned(), Some(evidence(60.0)));
    other.identification.as_mut().unwrap().fit_percent = Some(70.0);
    run.models.push(other);
    let said = assert_numbers_are_those_of_the_summary(&run, &["n4sid-4", "arx-2"]);
    assert!(said[0].contains("arx-2, has a fit of 70.0\u{a0}% (unseen samples: 60.0\u{a0}%)"), "{said:?}");
}

#[test]
fn every_method_without_a_model_is_named_with_its_reason() {
    let mut run = Run { models: identified(), ..Run::default() };
    let methods = ["okid", "fir", "cva", "arx"];
    run.remarks = methods
        .map(|method| {
            concern("identify", &format!("method:{method}"), 1, &format!("{method} gave no model: too short"))
        })
        .to_vec();
    run.remarks.push(concern("identify", "identified-models", 3, "unseen samples"));
    assert_eq!(status_of(&run), "do not use: every identified model is in doubt, see warning 1.");
    let page = page_of(&run);
    let section = &page[page.find("Not identified").unwrap()..];
    let summary = summary_of(&run);
    assert_eq!(summary["concerns"][0]["about"], "identified-models");
    let ranking = Ranking::of_run(&run);
    let said = crumple_report::summary(&run, &ranking);
    let lines: Vec<String> =
        overview(&run, &ranking, &said, Path::new("r")).into_iter().map(|line| line.text).collect();
    for method in methods {
        let text = format!("{method} gave no model: too short");
        assert!(section.contains(&text) && lines.contains(&text), "{lines:?}");
        assert!(summary["concerns"].as_array().unwrap().iter().any(|concern| concern["text"] == text.as_str()));
    }
    assert!(lines.iter().any(|line| line == "1. unseen samples"), "{lines:?}");
}
