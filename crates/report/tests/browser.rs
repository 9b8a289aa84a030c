//! The report in a real browser: the console stays silent, nothing is asked of a network, the script does what it says.

#![allow(clippy::unwrap_used, reason = "a failure here is the test's failure")]

mod browser_of_tests;
mod sample;

use std::path::{Path, PathBuf};
use std::process::Command;

use browser_of_tests::{ask, browser, console};

fn make(folder: &Path, inputs: &[PathBuf]) -> PathBuf {
    let page = folder.join("report.html");
    let output = Command::new(env!("CARGO_BIN_EXE_crumple-report"))
        .args(inputs)
        .arg("-q")
        .arg("-o")
        .arg(&page)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    page
}

/// The page of the synthetic run, with the script of a test appended to what it asks.
fn sample_page(folder: &Path) -> PathBuf {
    make(folder, &sample::write_artifacts(folder, true))
}

#[test]
fn the_console_is_silent_and_nothing_is_loaded() {
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().unwrap();
    let page = sample_page(folder.path());
    let count = "return {loaded: performance.getEntriesByType('resource').length, \
                 plots: document.querySelectorAll('svg.plot').length, \
                 drawn: [...document.querySelectorAll('svg.plot path.l')].filter((p) => p.getTotalLength()).length}";
    let (answer, log) = ask(&browser, &page, 1200, count);
    assert_eq!(console(&log), Vec::<&str>::new());
    assert_eq!((&answer["loaded"], &answer["plots"]), (&0.into(), &14.into()), "{answer}");
    assert!(answer["drawn"].as_u64().unwrap() > 40, "{answer}");
}

#[test]
fn a_request_and_an_error_are_noticed() {
    // The check above can fail.
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().unwrap();
    let page = sample_page(folder.path());
    let html = std::fs::read_to_string(&page).unwrap();
    std::fs::write(&page, html.replace("</main>", "<img src=\"https://example.org/x.png\"></main>")).unwrap();
    let (_, log) = ask(&browser, &page, 1200, "return 1");
    assert!(!console(&log).is_empty(), "{log}");
}

#[test]
fn the_cursor_goes_through_all_figures_over_time_with_the_values_of_the_curves() {
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().unwrap();
    let page = sample_page(folder.path());
    let script = "
        const cells = '#curves .values tbody tr:first-child td';
        const value = () => [...document.querySelectorAll(cells)].map((td) => td.textContent);
        const slider = document.querySelector('.cursor input');
        const panels = document.querySelector('#residual .panels');
        const press = (key) => panels.dispatchEvent(new KeyboardEvent('keydown', {key}));
        const first = value();
        const lines = document.querySelectorAll('.cursor-marks path').length;
        slider.value = 0;
        slider.dispatchEvent(new Event('input'));
        const start = value();
        press('End');
        const end = value();
        press('Home');
        for (let k = 0; k < 3; k += 1) press('ArrowRight');
        return {first, start, end, moved: value(), lines, time: document.querySelector('.time').textContent};";
    let (answer, log) = ask(&browser, &page, 1200, script);
    assert_eq!(console(&log), Vec::<&str>::new());
    let number = |text: &serde_json::Value| text.as_str().unwrap().replace('−', "-").parse::<f64>().unwrap();
    // At the time of crush: the velocity is 0, the displacement the dynamic crush of the sample, 447.7 mm.
    let first = &answer["first"];
    assert!(number(&first[1]).abs() < 0.2 && (number(&first[2]) - 447.7).abs() < 0.3, "{answer}");
    // The force is the mass times the deceleration, 873 kg.
    assert!((number(&first[3]) + 0.873 * 9.80665 * number(&first[0])).abs() < 0.5, "{answer}");
    // Three panels of the curves and two of the residual.
    assert_eq!(answer["lines"], 5, "{answer}");
    assert!(
        answer["start"] != answer["first"] && answer["end"] != answer["start"] && answer["moved"] != answer["start"]
    );
}

#[test]
fn a_legend_shows_and_hides_without_the_script_and_a_zoom_is_shared() {
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().unwrap();
    let page = sample_page(folder.path());
    let script = "
        const box = document.querySelector('#curves .legend input');
        const seen = () => getComputedStyle(document.querySelector('#curves svg.in .e0')).display;
        const before = seen();
        box.click();
        const after = seen();
        const views = () => [...document.querySelectorAll('svg.plot[data-time] svg.in')]
            .map((s) => s.getAttribute('viewBox').split(' ')[2]);
        const whole = views();
        document.querySelector('[aria-label=\"Zoom in at the cursor\"]').click();
        return {before, after, whole, zoomed: views()};";
    let (answer, _) = ask(&browser, &page, 1200, script);
    assert_eq!((&answer["before"], &answer["after"]), (&"inline".into(), &"none".into()), "{answer}");
    assert_eq!(answer["zoomed"].as_array().unwrap().len(), 5);
    for (whole, zoomed) in answer["whole"].as_array().unwrap().iter().zip(answer["zoomed"].as_array().unwrap()) {
        let [whole, zoomed] = [whole, zoomed].map(|x| x.as_str().unwrap().parse::<f64>().unwrap());
        assert!((whole / zoomed - 2.0).abs() < 1e-6, "{answer}");
    }
}

#[test]
fn a_telephone_has_no_scrolling_sideways_and_type_that_can_be_read() {
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().unwrap();
    let page = sample_page(folder.path());
    let script = "
        const sizes = [...document.querySelectorAll('svg.plot text')].map((t) =>
            parseFloat(getComputedStyle(t).fontSize) * t.ownerSVGElement.getBoundingClientRect().width
            / t.ownerSVGElement.viewBox.baseVal.width);
        return {wide: document.documentElement.scrollWidth, window: innerWidth, smallest: Math.min(...sizes)};";
    for width in [390, 700, 1200] {
        let (answer, _) = ask(&browser, &page, width, script);
        assert_eq!(answer["window"], width);
        assert!(answer["wide"].as_u64().unwrap() <= u64::from(width), "{answer}");
        assert!(answer["smallest"].as_f64().unwrap() >= 11.0, "{width}: {answer}");
    }
}

#[test]
fn every_control_and_definition_has_a_name_and_takes_the_focus() {
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().unwrap();
    let page = sample_page(folder.path());
    let script = "
        document.querySelectorAll('details').forEach((d) => { d.open = true; });
        const controls = [...document.querySelectorAll('button, input, summary, [title], .panels[role]')];
        const cannot = controls.filter((c) => { c.focus(); return document.activeElement !== c; });
        const nameless = controls.filter((c) =>
            !(c.getAttribute('aria-label') || c.textContent.trim() || (c.labels && c.labels[0].textContent.trim())));
        const levels = [...document.querySelectorAll('h1, h2, h3, h4')].map((h) => Number(h.tagName[1]));
        const html = (controls) => controls.map((c) => c.outerHTML);
        return {controls: controls.length, cannot: html(cannot), nameless: html(nameless),
                jumps: levels.filter((l, k) => k > 0 && l > levels[k - 1] + 1).length,
                figures: [...document.querySelectorAll('svg[role=img]')].filter((s) => !s.querySelector('title'))
                    .length};";
    let (answer, _) = ask(&browser, &page, 1200, script);
    assert!(answer["controls"].as_u64().unwrap() > 30, "{answer}");
    assert_eq!(answer["cannot"], serde_json::json!([]), "{answer}");
    assert_eq!(answer["nameless"], serde_json::json!([]), "{answer}");
    assert_eq!(answer["figures"], 0);
}
