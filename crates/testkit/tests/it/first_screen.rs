//! The report of every kind of record in a browser: what it says first, whether its numbers are those of
//! `summary.json`, and whether it can be read on a desk, on a telephone, in the dark and as wide as paper.

use std::fs;
use std::path::Path;

use crumple_testkit::browser::{Browser, Page, Screen};
use crumple_testkit::kinds::{KindOfRecord, made_kinds, real_kinds};
use crumple_testkit::numbers::numbers;
use crumple_testkit::programs::run;
use serde_json::Value;

/// Bytes of a page at most: 600 kB, and the 12 kB of the curves on the first screen.
const LARGEST_PAGE: u64 = 612_000;

fn texts(page: &Page, selector: &str) -> Vec<String> {
    let answer = page.ask(&format!("return [...document.querySelectorAll('{selector}')].map((e) => e.textContent)"));
    answer.as_array().unwrap().iter().map(|text| text.as_str().unwrap().trim().to_owned()).collect()
}

/// The sentences of the page are those of the summary; every number in them stands where the summary says.
fn check_sentences(page: &Page, summary: &Value) {
    let sentences = &summary["verdict"]["sentences"];
    let first = texts(page, "body > header section.verdict p");
    let expected: Vec<&str> = sentences.as_array().unwrap().iter().map(|s| s.as_str().unwrap()).collect();
    assert!(
        first.iter().zip(&expected).all(|(a, b)| a == b) && first.len() >= expected.len(),
        "{first:?} {expected:?}"
    );
    let because = summary["verdict"]["status_sentence"].as_str().unwrap();
    let status = texts(page, "body > header .status");
    assert!(status.len() == 1 && status[0] == because, "{status:?}: {because}");
    let mut known = Vec::new();
    for number in summary["verdict"]["numbers"].as_array().unwrap() {
        let (at, shown) = (number["at"].as_str().unwrap(), number["shown"].as_str().unwrap());
        assert_eq!(summary.pointer(at).and_then(Value::as_f64), number["value"].as_f64(), "{at}");
        known.push(shown.replace('\u{a0}', " "));
        assert!(because.contains(shown) || sentences.to_string().contains(shown), "{shown} is in no sentence");
    }
    assert!(!known.is_empty() || summary["verdict"]["standing"] != "model");
}

/// Every card of the key numbers: its value, interval and spread.
fn check_key_numbers(page: &Page, summary: &Value) {
    let cards = page.ask(
        "return [...document.querySelectorAll('#numbers .card')].map((c) => ({key: c.dataset.key,
            texts: [...c.querySelectorAll('dd')].map((d) => d.textContent)}))",
    );
    let cards = cards.as_array().unwrap();
    let all = summary["key_numbers"].as_array().unwrap();
    assert_eq!(cards.len(), all.len(), "{cards:?}");
    for (card, number) in cards.iter().zip(all) {
        assert_eq!(card["key"], number["name"]);
        let lines: Vec<&str> = card["texts"].as_array().unwrap().iter().map(|text| text.as_str().unwrap()).collect();
        let pair = |line: &str, what: &str, low: &Value, high: &Value| {
            let found = numbers(line.split_once(':').unwrap().1);
            assert!(found[0].is(low) && found[1].is(high), "{what} of {card}: {found:?}, {low} to {high}");
        };
        if number["value"].is_null() {
            assert!(!number["absent_because"].as_str().unwrap_or_default().is_empty(), "{number}");
            continue;
        }
        let value = &numbers(lines[0])[0];
        let magnitude = number["value"].as_f64().map(|v| Value::from(v.abs())).unwrap();
        assert!(value.is(&number["value"]) || value.is(&magnitude), "{card}: {number}");
        assert_eq!(lines[0].starts_with('\u{2265}'), number["is_lower_bound"] == true, "{card}: {number}");
        for line in &lines[1..] {
            // The words of the bar have both, one behind the other.
            for words in line.split("; ") {
                if words.starts_with("inputs") {
                    pair(words, "interval", &number["low"], &number["high"]);
                } else if words.contains(" sensors: ") {
                    pair(words, "spread", &number["spread"]["low"], &number["spread"]["high"]);
                }
            }
        }
    }
}

/// What is said below a model's picture: how many of its numbers are known, and its fit.
fn check_models(page: &Page, summary: &Value) {
    let candidates = summary["candidates"].as_array().unwrap();
    let captions = texts(page, "#model figcaption");
    let names: Vec<&Value> = ["recommended", "closest"].iter().map(|name| &summary[*name]).collect();
    let shown: Vec<&Value> = if names[0] == names[1] { vec![names[0]] } else { names };
    let shown: Vec<&Value> = shown.into_iter().filter(|id| id.is_string()).collect();
    assert!(captions.len() >= shown.len(), "{captions:?}");
    for (caption, id) in captions.iter().zip(shown) {
        let candidate = candidates.iter().find(|candidate| &candidate["id"] == id).unwrap();
        let found = numbers(caption);
        let simulation = &candidate["simulation"];
        let fit = &simulation["fit_as_measured_percent"];
        let fit = if fit.is_null() { &simulation["fit_percent"] } else { fit };
        assert!(fit.is_null() || found.iter().any(|shown| shown.decimals > 0 && shown.is(fit)), "{caption}: {fit}");
        let (parameters, determined) =
            (&candidate["certainties"]["parameters"], &candidate["certainties"]["determined"]);
        let words = format!("{determined} of {parameters} parameters determined");
        // Behind the one stiffness of a curve, where there is one.
        let is_said = caption.starts_with(&words) || caption.contains(&format!(". {words}"));
        assert!(*parameters == 0 || is_said, "{caption}: {words}");
        if let Some((_, spring)) = caption.split_once("k\u{a0}=\u{a0}") {
            let stiffness = &summary["metrics"]["average_stiffness"];
            let shown = numbers(&spring.replace("90\u{a0}%: ", ""));
            assert!(shown[0].is(&stiffness["value"]), "{caption}: {stiffness}");
            // The ends have the unit of the value in front of them.
            let ends = ["low", "high"].into_iter().filter_map(|end| Some(stiffness[end].as_f64()? * shown[0].factor));
            assert!(ends.zip(&shown[1..]).all(|(end, shown)| shown.shows(end)), "{caption}: {stiffness}");
        }
    }
}

/// At most three warnings, word for word the gravest of the summary.
fn check_warnings(page: &Page, summary: &Value) {
    let concerns: Vec<&str> =
        summary["concerns"].as_array().unwrap().iter().filter_map(|concern| concern["text"].as_str()).collect();
    let shown = texts(page, ".before-use li");
    assert!(shown.len() <= 3 && (concerns.is_empty() || !shown.is_empty()), "{shown:?}");
    let plain = |text: &str| text.replace('\u{a0}', " ").split_whitespace().collect::<Vec<_>>().join(" ");
    for line in shown {
        assert!(concerns.iter().any(|text| plain(&line).contains(&plain(text))), "{line}");
    }
}

/// What the page shows is wide enough for its screen, and its sentences are there.
fn check_screen(browser: &Browser, file: &Path, screen: Screen, sentences: &[String]) {
    let page = browser.open(file, "", screen);
    assert_eq!(texts(&page, "section.verdict p"), sentences, "{screen:?}");
    // What is beyond the window takes no room unless it is laid out.
    page.ask("document.querySelectorAll('section').forEach((s) => { s.style.contentVisibility = 'visible'; })");
    let wide = page.ask("return document.documentElement.scrollWidth").as_u64().unwrap();
    assert!(wide <= u64::from(screen.width), "{}: {wide} wide on {screen:?}", file.display());
    let colours = page.ask("const s = getComputedStyle(document.body); return [s.color, s.backgroundColor]");
    let brightness = |k: usize| {
        let text = colours[k].as_str().unwrap();
        numbers(text.split_once('(').unwrap().1).iter().take(3).map(|shown| shown.value).sum::<f64>()
    };
    assert_eq!(brightness(0) > brightness(1), screen.is_dark, "{colours}");
}

fn check_kind(kind: &KindOfRecord) {
    let folder = tempfile::tempdir().unwrap();
    let output = run(kind.variables, folder.path(), &kind.path, kind.flags);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(matches!(output.status.code(), Some(0 | 4)), "{}: {said}", kind.name);
    eprintln!("{}: exit {:?}", kind.name, output.status.code());
    let file = folder.path().join("report.html");
    let summary: Value = serde_json::from_slice(&fs::read(folder.path().join("summary.json")).unwrap()).unwrap();
    assert!(fs::metadata(&file).unwrap().len() < LARGEST_PAGE, "{}", kind.name);
    let Some(browser) = Browser::start("the first screen") else { return };
    let page = browser.open(&file, "", Screen::DESK);
    assert_eq!((page.console(), page.requests()), (vec![], vec![]), "{}", kind.name);
    assert_eq!(page.ask("return document.querySelectorAll('script[src], link, iframe, object').length"), 0);
    check_sentences(&page, &summary);
    check_key_numbers(&page, &summary);
    check_models(&page, &summary);
    check_warnings(&page, &summary);
    let sentences = texts(&page, "section.verdict p");
    let others = [Screen::PHONE, Screen::PHONE.dark(), Screen::DESK.dark(), Screen::DESK.wide(794)];
    for screen in others.into_iter().chain([Screen::DESK.without_script()]) {
        check_screen(&browser, &file, screen, &sentences);
    }
    let sheet = browser.open(&file, "", Screen::SHEET);
    let curves =
        "const all = document.querySelector('.figure .panels'); return all ? all.getBoundingClientRect().bottom : 0";
    let bottom = sheet.ask(curves).as_f64().unwrap();
    assert!(bottom <= f64::from(Screen::SHEET.height), "{}: the curves end at {bottom} of the sheet", kind.name);
    if kind.name == "two vehicles" {
        assert!(summary["recommended"].is_null() && summary["candidates"][0].is_object(), "{}", summary["recommended"]);
        assert!(
            sentences[1].contains("No model is recommended") && !sentences[1].contains("it gives"),
            "{sentences:?}"
        );
    }
    if output.status.code() == Some(4) {
        let reason = summary["verdict"]["reason"].as_str().unwrap();
        assert!(sentences.iter().any(|sentence| sentence.contains(reason.trim_end_matches('.'))), "{sentences:?}");
    }
}

#[test]
fn every_made_record_is_answered_on_the_first_screen_with_the_numbers_of_its_summary() {
    let folder = tempfile::tempdir().unwrap();
    for kind in made_kinds(folder.path()).unwrap() {
        check_kind(&kind);
    }
}

#[test]
fn so_is_every_record_of_a_real_test() {
    for kind in real_kinds() {
        check_kind(&kind);
    }
}
