//! The sliders in a browser: every kind of element against the exact motion, and a slider that moves.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crumple_artifact::records::{CandidateV1, EventsV1, SimulationV1};
use crumple_lumped::structure_of;
use crumple_report::{CandidateResult, Page, Ranking, Run};
use crumple_signal::Sampled;
use crumple_testkit::browser::{Browser, Page as Opened, Screen};

const SPEED: f64 = 15.0;

fn parameters(pairs: &[(&str, f64)]) -> BTreeMap<String, f64> {
    pairs.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect()
}

/// Crush and time of the compartment, exact.
fn crush(model: &str, parameters: &BTreeMap<String, f64>, speed: f64) -> (f64, f64) {
    let structure = structure_of(model, None, parameters).unwrap().with_trends_beyond();
    let events = *structure.events(speed, 2.0).unwrap().last().unwrap();
    (events.dynamic_crush_m.unwrap(), events.time_of_dynamic_crush_s.unwrap())
}

/// A report whose recommended model is this one, the stage's crush times `factor`.
fn report(folder: &Path, model: &str, parameters: &BTreeMap<String, f64>, factor: f64) -> PathBuf {
    let (crush_m, time_s) = crush(model, parameters, SPEED);
    let id = format!("{model}/direct-fit/1");
    let mut run = Run::default();
    run.test.impact_speed_m_per_s = Some(SPEED);
    run.events = Some(EventsV1 {
        channel: "93".into(),
        dynamic_crush_m: Some(crush_m),
        time_of_dynamic_crush_s: Some(time_s),
        ..EventsV1::default()
    });
    run.measured.displacement =
        Sampled::new(0.0, 1e-3, (0..200).map(|k| crush_m * (0.02 * f64::from(k)).sin()).collect()).ok();
    run.candidates = vec![CandidateResult {
        id: id.clone(),
        record: CandidateV1 {
            model: model.to_owned(),
            method: "direct-fit".into(),
            parameters: parameters.clone(),
            physical: true,
            ..CandidateV1::default()
        },
        simulation: Some(SimulationV1 {
            dynamic_crush_m: Some(factor * crush_m),
            time_of_dynamic_crush_s: Some(time_s),
            fit_percent: Some(99.0),
            ..SimulationV1::default()
        }),
        ..CandidateResult::default()
    }];
    let ranking = Ranking { order: vec![id.clone()], best: Some(id), ..Ranking::default() };
    let page = folder.join("report.html");
    Page::new(&run, &ranking).write_to(std::fs::File::create(&page).unwrap()).unwrap();
    page
}

/// An attribute of the section.
fn attribute(page: &Opened, name: &str) -> serde_json::Value {
    page.ask(&format!("return document.getElementById('what-if').getAttribute('{name}')"))
}

fn number(page: &Opened, name: &str) -> f64 {
    attribute(page, name).as_str().unwrap().parse().unwrap()
}

fn browser() -> Option<Browser> {
    Browser::start("the sliders of the report")
}

fn models() -> Vec<(&'static str, BTreeMap<String, f64>)> {
    vec![
        ("kelvin", parameters(&[("mass_kg", 1500.0), ("stiffness_n_per_m", 6e5), ("damping_n_s_per_m", 8e3)])),
        ("maxwell", parameters(&[("mass_kg", 1500.0), ("stiffness_n_per_m", 9e5), ("damping_n_s_per_m", 6e4)])),
        (
            "elastoplastic",
            parameters(&[
                ("mass_kg", 1500.0),
                ("loading_stiffness_n_per_m", 7e5),
                ("unloading_stiffness_n_per_m", 3e7),
            ]),
        ),
        (
            "nonlinear-1",
            parameters(&[
                ("mass_kg", 1500.0),
                ("k1_n_per_m", 2e5),
                ("k2_n_per_m", 9e5),
                ("c1_n_s_per_m", 2e4),
                ("c2_n_s_per_m", 9e3),
                ("c3_n_s_per_m", 1e3),
                ("v_thresh_m_per_s", 6.0),
                ("crush_m", 0.6),
                ("v0_m_per_s", 15.0),
            ]),
        ),
        (
            "double-spring-mass-damper",
            parameters(&[
                ("m1_kg", 375.0),
                ("m2_kg", 1125.0),
                ("k1_n_per_m", 9e5),
                ("k2_n_per_m", 1e6),
                ("c1_n_s_per_m", 6e3),
                ("c2_n_s_per_m", 9e3),
            ]),
        ),
        (
            "force-deflection",
            parameters(&[
                ("mass_kg", 1500.0),
                ("knot1_m", 0.1),
                ("knot1_n", 1.5e5),
                ("knot2_m", 0.3),
                ("knot2_n", 2.5e5),
                ("knot3_m", 0.5),
                ("knot3_n", 5e5),
                ("unloading_stiffness_n_per_m", 3e7),
                ("rate_s_per_m", 0.004),
            ]),
        ),
        // The engine turns before the compartment, and is pushed in again.
        (
            "force-deflection",
            parameters(&[
                ("m1_kg", 300.0),
                ("m2_kg", 1200.0),
                ("front_knot1_m", 0.2),
                ("front_knot1_n", 2.5e5),
                ("front_knot2_m", 0.5),
                ("front_knot2_n", 6e5),
                ("front_unloading_n_per_m", 2e7),
                ("front_rate_s_per_m", 0.004),
                ("rear_knot1_m", 0.1),
                ("rear_knot1_n", 2e5),
                ("rear_knot2_m", 0.3),
                ("rear_knot2_n", 4e5),
                ("rear_unloading_n_per_m", 2e7),
                ("rear_rate_s_per_m", 0.0),
            ]),
        ),
    ]
}

#[test]
fn every_model_opens_with_the_crush_of_the_stage_and_follows_another_speed_exactly() {
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().unwrap();
    for (model, parameters) in models() {
        let file = report(folder.path(), model, &parameters, 1.0);
        let page = browser.open(&file, "#v=72", Screen::DESK);
        assert_eq!(attribute(&page, "data-state"), "ready", "{model}");
        // 72 km/h are 20 m/s; a curve goes on with its trend there.
        let (crush_m, time_s) = crush(model, &parameters, 20.0);
        let (found_m, found_s) = (number(&page, "data-crush"), number(&page, "data-time"));
        assert!((found_m / crush_m - 1.0).abs() < 1e-3, "{model}: {found_m} m, exact {crush_m}");
        assert!((found_s / time_s - 1.0).abs() < 1e-3, "{model}: {found_s} s, exact {time_s}");
    }
}

#[test]
fn a_slider_moves_number_curve_and_address() {
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().unwrap();
    let (model, parameters) = models().remove(0);
    let page = browser.open(&report(folder.path(), model, &parameters, 1.0), "", Screen::DESK);
    let curve = || page.ask("return document.querySelector('#what-if path.changed').getAttribute('d')");
    let (curve_at_rest, crush_at_rest) = (curve(), number(&page, "data-crush"));
    page.ask("document.getElementById('what-if-k').focus()");
    for _ in 0..20 {
        page.press("ArrowLeft");
    }
    let percent = page.ask("return Number(document.getElementById('what-if-k').value)").as_f64().unwrap();
    assert!(percent < 100.0, "{percent}");
    let softer = BTreeMap::from_iter(parameters.iter().map(|(name, value)| {
        (name.clone(), if name == "stiffness_n_per_m" { percent / 100.0 * value } else { *value })
    }));
    let (crush_m, _) = crush(model, &softer, SPEED);
    assert!((number(&page, "data-crush") / crush_m - 1.0).abs() < 1e-3);
    assert!(number(&page, "data-crush") > 1.02 * crush_at_rest);
    assert_eq!(page.ask("return location.hash"), format!("#k={percent}"));
    assert_ne!(curve(), curve_at_rest);
    let words = page.ask("return document.getElementById('what-if').textContent");
    assert!(words.as_str().unwrap().contains(&format!("C {:.1} mm", 1e3 * crush_m)), "the words say it");
}

#[test]
fn a_model_that_is_not_found_again_is_switched_off() {
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().unwrap();
    let (model, parameters) = models().remove(0);
    let page = browser.open(&report(folder.path(), model, &parameters, 1.002), "", Screen::DESK);
    assert_eq!(attribute(&page, "data-state"), "off");
    let section = page.ask("return document.getElementById('what-if').outerHTML");
    let section = section.as_str().unwrap();
    assert!(section.contains("Switched off: this page does not find") && !section.contains("what-if-k"), "no sliders");
}
