//! Runs without a model, and where warnings stand.

use super::*;

/// A run that ended without an acceptable model.
pub fn without_result() -> Run {
    let mut run = car();
    (run.candidates, run.predictions, run.recommendation, run.responses) = (vec![], vec![], None, Some(0));
    run.remarks = vec![
        concern("ingest", "pulse", 3, "the pulse is positive"),
        RemarkV1 {
            code: "CR900".to_owned(),
            remedy: Some("check the sign of the pulse".to_owned()),
            ..concern("parameter-solve", "model:", 3, "the vehicle moves further than its speed carries it")
        },
    ];
    run
}

#[test]
fn a_run_without_an_acceptable_model_has_a_bar_with_reason_and_remedy() {
    let run = without_result();
    let said = assert_numbers_are_those_of_the_summary(&run, &[]);
    assert_eq!(
        said,
        [
            "There is no model: the vehicle moves further than its speed carries it.",
            "What to do: check the sign of the pulse."
        ]
    );
    let summary = summary_of(&run);
    assert_eq!(summary["verdict"]["standing"], "no-result");
    assert_eq!(summary["verdict"]["remedy"], "check the sign of the pulse");
    assert_eq!(summary["concerns"][0]["severity"], "no-result");
    let page = page_of(&run);
    assert!(page.contains("<section class=\"verdict bad\" role=\"alert\""));
    // The bar has said it; below it stands what else speaks against the run.
    let before_use = &page[page.find("class=\"before-use\"").unwrap()..page.find("id=\"notes\"").unwrap()];
    assert!(before_use.contains("the pulse is positive") && !before_use.contains("moves further"), "{before_use}");
}

#[test]
fn what_was_allowed_to_be_missing_leaves_a_linear_model() {
    let mut run = without_result();
    run.models = identified();
    run.events = None;
    // A pulse in doubt would be said instead.
    run.remarks.retain(|concern| concern.about != "pulse");
    (run.test.mass_kg, run.test.impact_speed_m_per_s) = (None, None);
    let said = assert_numbers_are_those_of_the_summary(&run, &["n4sid-4"]);
    assert_eq!(said[0], "This report holds no motion of a vehicle.");
    assert!(said[1].starts_with("The closest identified model, n4sid-4, has a fit of 88.3\u{a0}%"), "{said:?}");
    assert!(said[2].starts_with("Mass and impact speed are missing") && said.len() == 3, "{said:?}");
    assert!(status_of(&run).starts_with("usable with care: neither mass nor impact speed is stated"));
    // That its models fail does not take the pulse away.
    run.remarks.push(concern("identify", "identified-models", 3, "not to be used beyond their samples"));
    assert!(status_of(&run).starts_with("usable with care: neither mass nor impact speed is stated"));
    run.remarks.pop();
    // What the pulse gives is said first.
    let of_pulse = MetricV1 { to_s: Some(0.11), ..metric("delta_v", 17.5, "93") };
    run.metrics = vec![of_pulse, metric("peak_acceleration", 245.17, "93")];
    let said = assert_numbers_are_those_of_the_summary(&run, &["n4sid-4"]);
    let first = "The record gives a delta-v of 63.0\u{a0}km/h within 110\u{a0}ms, a peak of 25.0\u{a0}g.";
    assert_eq!(said[0], first);
    run.metrics[0].is_lower_bound = true;
    let said = assert_numbers_are_those_of_the_summary(&run, &["n4sid-4"]);
    assert_eq!(said[0], first.replace("of 63.0", "of at least 63.0"));
    run.metrics.clear();
    assert_eq!(conclusion(&run, &Ranking::of_run(&run)).0.kind, Kind::LinearModel);
    // Without a linear model either there is nothing.
    run.models.clear();
    assert_eq!(conclusion(&run, &Ranking::of_run(&run)).0.kind, Kind::NoModel);
}

#[test]
fn warnings_stand_by_what_they_do_to_what_is_shown() {
    let mut run = car();
    run.candidates.push(candidate("maxwell/direct-fit/1", 90.0));
    run.remarks = vec![
        concern("ingest", "channel:96", 1, "questionable"),
        concern("parameter-solve", "model:maxwell/direct-fit/1", 2, "maxwell on a bound"),
        concern("parameter-solve", "model:kelvin", 1, "kelvin: nearly rigid"),
        concern("ingest", "pulse", 2, "clipped"),
        concern("integrate", "pulse", 2, "dropouts"),
        concern("integrate", "time", 3, "late contact"),
    ];
    let (said, concerns) = conclusion(&run, &Ranking::of_run(&run));
    let texts: Vec<&str> = concerns.iter().map(|concern| concern.text.as_str()).collect();
    // Two on the pulse are as grave; the second gives way to what concerns something else.
    assert_eq!(texts[..3], ["late contact", "clipped", "kelvin: nearly rigid"]);
    assert_eq!(texts[3], "dropouts");
    assert_eq!(texts.last(), Some(&"questionable"));
    assert_eq!(concerns[0].weight, 9);
    assert_eq!((said.status, said.sentences.len()), (Some(Status::DoNotUse), 1), "{said:?}");
    let page = page_of(&run);
    let before_use = &page[page.find("class=\"before-use\"").unwrap()..];
    let before_use = &before_use[..before_use.find("</section>").unwrap()];
    assert_eq!(before_use.matches("<li ").count(), 3);
    assert!(before_use.contains("<a href=\"#notes\">4 more warnings</a>"), "{before_use}");
    assert!(page.contains("<section id=\"notes\">"));
    let summary = summary_of(&run);
    assert_eq!(
        summary["concerns"][0],
        json!({
            "stage": "integrate", "severity": "warning", "about": "time", "weight": 9, "text": "late contact",
            "remedy": null,
            "code": ""
        })
    );
}

#[test]
fn the_console_repeats_no_warning_that_the_verdict_says() {
    let warnings = |run: &Run| {
        let ranking = Ranking::of_run(run);
        let said = summary(run, &ranking);
        let lines = overview(run, &ranking, &said, Path::new("runs/car"));
        (said.verdict.sentences.join(" "), lines.into_iter().map(|line| line.text).collect::<Vec<_>>().join("\n"))
    };
    // It extrapolates: the verdict says so, and the console not once more.
    let (said, lines) = warnings(&car());
    assert!(said.contains("it extrapolates") && !lines.contains("of the test, extrapolate"), "{said} {lines}");
    // Open numbers are said instead, so the other is new.
    let mut run = car();
    let open = &mut run.candidates[0].record;
    open.uncertainty.as_mut().unwrap().standard_deviation.insert("damping_n_s_per_m".to_owned(), 5e3);
    let (said, lines) = warnings(&run);
    assert!(said.contains("Not identifiable") && !lines.contains("not identifiable"), "{said} {lines}");
    assert!(lines.contains("of the test, extrapolate"), "{lines}");
    // Where all of it is doubtful nothing of this was said.
    run.remarks = vec![concern("integrate", "impact-speed", 3, "is the impact speed right?")];
    let (_, lines) = warnings(&run);
    assert!(lines.contains("is the impact speed right?") && lines.contains("not identifiable"), "{lines}");
}
