//! The report in a real browser: the console stays silent, nothing is asked of a network, the script does what it says.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::sample;
use crumple_testkit::browser::{Browser, Page, Screen};
use serde_json::{Value, json};

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

/// The page of the synthetic run.
fn sample_page(folder: &Path) -> PathBuf {
    make(folder, &sample::write_artifacts(folder, true))
}

/// That page open on a screen.
fn open(browser: &Browser, screen: Screen) -> Page {
    let folder = tempfile::tempdir().unwrap();
    browser.open(&sample_page(folder.path()), "", screen)
}

fn browser() -> Option<Browser> {
    Browser::start("the report")
}

#[test]
fn the_console_is_silent_and_nothing_is_loaded() {
    let Some(browser) = browser() else { return };
    let page = open(&browser, Screen::DESK);
    let count = "return {plots: document.querySelectorAll('svg.plot').length,
                 drawn: [...document.querySelectorAll('svg.plot path.l')].filter((p) => p.getTotalLength()).length}";
    let answer = page.ask(count);
    assert_eq!((page.console(), page.requests()), (vec![], vec![]));
    assert_eq!(answer["plots"], 18, "{answer}");
    assert!(answer["drawn"].as_u64().unwrap() > 40, "{answer}");
}

#[test]
fn a_request_and_an_error_are_noticed() {
    // The check above can fail.
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = sample_page(folder.path());
    let html = std::fs::read_to_string(&path).unwrap();
    let allowed = html.replace("default-src 'none'", "default-src 'none'; connect-src *");
    let asking = "<img src=\"https://example.org/x.png\"></main>";
    std::fs::write(&path, html.replace("</main>", asking)).unwrap();
    assert!(!browser.open(&path, "", Screen::DESK).console().is_empty());
    let asking = "<script>fetch('file:///x'); throw new Error('no')</script></main>";
    std::fs::write(&path, allowed.replace("</main>", asking)).unwrap();
    let page = browser.open(&path, "", Screen::DESK);
    assert!(
        !page.requests().is_empty() && page.console().iter().any(|line| line.contains("no")),
        "{:?}",
        page.console()
    );
}

/// The middle of an element on the screen, after the page was scrolled to it.
fn middle(page: &Page, selector: &str) -> (f64, f64) {
    let answer = page.ask(&format!(
        "const e = document.querySelector('{selector}'); e.scrollIntoView({{block: 'center'}});
         const r = e.getBoundingClientRect(); return [r.x + r.width / 2, r.y + r.height / 2];"
    ));
    (answer[0].as_f64().unwrap(), answer[1].as_f64().unwrap())
}

fn number(text: &Value) -> f64 {
    text.as_str().unwrap().replace('−', "-").parse().unwrap()
}

#[test]
fn the_cursor_goes_through_all_figures_over_time_with_the_values_of_the_curves() {
    let Some(browser) = browser() else { return };
    let page = open(&browser, Screen::DESK);
    let values = || {
        page.ask(
            "const cells = document.querySelectorAll('#curves .values tbody tr:first-child td');
             return [...cells].map((t) => t.textContent)",
        )
    };
    // At the time of crush: the velocity is 0, the displacement the dynamic crush of the sample, 447.7 mm.
    let first = values();
    assert!(number(&first[1]).abs() < 0.2 && (number(&first[2]) - 447.7).abs() < 0.3, "{first}");
    // The force is the mass times the deceleration, 873 kg.
    assert!((number(&first[3]) + 0.873 * 9.80665 * number(&first[0])).abs() < 0.5, "{first}");
    // Three panels of the curves and two of the residual.
    assert_eq!(page.ask("return document.querySelectorAll('.cursor-marks path').length"), 5);
    // The outlines of the masses are at rest on the picture until the cursor moves.
    let pictures = || {
        page.ask(
            "return [...document.querySelectorAll('.model-picture .moved')].map((r) => Number(r.getAttribute('x')))",
        )
    };
    assert_eq!(pictures(), json!([]));
    let marks = || page.ask("return [...document.querySelectorAll('.cursor-marks path')].map((p) => p.outerHTML)");
    // The keys of a figure in another section, which is folded with the details, and of the slider.
    page.ask("document.querySelectorAll('details').forEach((fold) => { fold.open = true; })");
    page.ask("document.querySelector('#residual .panels').focus()");
    let (mut seen, mut drawn) = (vec![first], vec![marks()]);
    let mut outlines = Vec::new();
    for key in ["End", "Home", "ArrowRight"] {
        page.press(key);
        outlines.push(pictures());
        seen.push(values());
        drawn.push(marks());
    }
    page.ask("document.querySelector('.cursor input').focus()");
    page.press("ArrowRight");
    seen.push(values());
    drawn.push(marks());
    // The pointer over a panel of the residual moves the values of the curves.
    let (x, y) = middle(&page, "#residual svg.plot");
    page.point_at(x, y);
    seen.push(values());
    drawn.push(marks());
    // At the end the model has come nearer to the barrier than at its first contact.
    assert!(outlines[0][0].as_f64() > outlines[1][0].as_f64(), "{outlines:?}");
    for pair in seen.windows(2).chain(drawn.windows(2)) {
        assert_ne!(pair[0], pair[1]);
    }
    assert_eq!(page.console(), Vec::<String>::new());
}

#[test]
fn a_legend_shows_and_hides_without_the_script_and_a_zoom_is_shared() {
    let Some(browser) = browser() else { return };
    for screen in [Screen::DESK, Screen::DESK.without_script()] {
        let page = open(&browser, screen);
        let seen = || page.ask("return getComputedStyle(document.querySelector('#curves svg.in .e0')).display");
        let before = seen();
        let (x, y) = middle(&page, "#curves .legend label");
        page.click(x, y);
        assert_eq!((before, seen()), (json!("inline"), json!("none")), "{screen:?}");
    }
    let page = open(&browser, Screen::DESK);
    let views = || {
        page.ask(
            "return [...document.querySelectorAll('svg.plot[data-time] svg.in')]
                .map((s) => Number(s.getAttribute('viewBox').split(' ')[2]))",
        )
    };
    let whole = views();
    let (x, y) = middle(&page, "[aria-label=\"Zoom in at the cursor\"]");
    page.click(x, y);
    let zoomed = views();
    assert_eq!(zoomed.as_array().unwrap().len(), 5);
    for (whole, zoomed) in whole.as_array().unwrap().iter().zip(zoomed.as_array().unwrap()) {
        assert!((whole.as_f64().unwrap() / zoomed.as_f64().unwrap() - 2.0).abs() < 1e-6, "{whole} {zoomed}");
    }
}

#[test]
fn a_telephone_names_hidden_curves_on_demand_and_shows_every_value_at_the_cursor() {
    let Some(browser) = browser() else { return };
    for screen in [Screen::PHONE, Screen::PHONE.without_script()] {
        let page = open(&browser, screen);
        let names = || {
            page.ask(
                "return [...document.querySelectorAll('#curves .legend li:not(.all)')]
                    .filter((l) => getComputedStyle(l).display !== 'none').length",
            )
        };
        let first = names();
        let (x, y) = middle(&page, "#curves .legend .all label");
        page.click(x, y);
        let all = names();
        assert!(0 < first.as_u64().unwrap() && first.as_u64() < all.as_u64(), "{screen:?}: {first} {all}");
    }
    let page = open(&browser, Screen::PHONE);
    let cut = page
        .ask("return [...document.querySelectorAll('.cursor')].filter((c) => c.scrollWidth > c.clientWidth).length");
    assert_eq!(cut, 0);
    // A section beyond the window has no text on the screen.
    page.ask("document.querySelector('#curves .values').scrollIntoView()");
    let values = page.ask("return document.querySelector('#curves .values').textContent");
    assert!(values.as_str().unwrap().contains("kN"), "{values}");
}

#[test]
fn a_definition_stands_at_the_foot_of_the_window() {
    let Some(browser) = browser() else { return };
    let page = open(&browser, Screen::DESK);
    // Far down the page, in a section that is laid out when it comes near.
    let place = page.ask(
        "document.querySelectorAll('details').forEach((fold) => { fold.open = true; });
         const word = [...document.querySelectorAll('main [title][tabindex]')].filter((e) => e.offsetParent).at(-1);
         word.scrollIntoView({block: 'center'}); word.focus();
         const style = getComputedStyle(word, '::after');
         const held = (e) => e && (getComputedStyle(e).contentVisibility === 'auto' || held(e.parentElement));
         return {position: style.position, bottom: style.bottom, held: Boolean(held(word))};",
    );
    assert_eq!(place, json!({"position": "fixed", "bottom": place["bottom"], "held": false}));
}

#[test]
fn a_telephone_has_no_scrolling_sideways_and_type_that_can_be_read() {
    let Some(browser) = browser() else { return };
    let script = "
        // What is beyond the window takes no room unless it is laid out.
        document.querySelectorAll('section').forEach((s) => { s.style.contentVisibility = 'visible'; });
        const sizes = [...document.querySelectorAll('svg.plot text')].map((t) =>
            parseFloat(getComputedStyle(t).fontSize) * t.ownerSVGElement.getBoundingClientRect().width
            / t.ownerSVGElement.viewBox.baseVal.width);
        return {wide: document.documentElement.scrollWidth, window: innerWidth, smallest: Math.min(...sizes)};";
    for screen in [Screen::PHONE, Screen::PHONE.wide(700), Screen::DESK.wide(1200)] {
        let page = open(&browser, screen);
        let answer = page.ask(script);
        assert_eq!(answer["window"], screen.width);
        assert!(answer["wide"].as_u64().unwrap() <= u64::from(screen.width), "{answer}");
        assert!(answer["smallest"].as_f64().unwrap() >= 11.0, "{screen:?}: {answer}");
    }
}

#[test]
fn every_control_and_definition_has_a_name_and_is_reached_by_the_tab_key() {
    let Some(browser) = browser() else { return };
    let page = open(&browser, Screen::DESK);
    let script = "
        document.querySelectorAll('details').forEach((d) => { d.open = true; });
        const all = document.querySelectorAll('button, input, summary, [title], .panels[role]');
        const controls = [...all].filter((c) => c instanceof SVGElement || c.offsetParent !== null);
        controls.forEach((c, k) => { c.dataset.control = k; });
        const nameless = controls.filter((c) =>
            !(c.getAttribute('aria-label') || c.textContent.trim() || (c.labels && c.labels[0].textContent.trim())));
        const levels = [...document.querySelectorAll('h1, h2, h3, h4')].map((h) => Number(h.tagName[1]));
        return {controls: controls.length, nameless: nameless.map((c) => c.outerHTML),
                jumps: levels.filter((l, k) => k > 0 && l > levels[k - 1] + 1).length,
                figures: [...document.querySelectorAll('svg[role=img]')].filter((s) => !s.querySelector('title'))
                    .length};";
    let answer = page.ask(script);
    let controls = answer["controls"].as_u64().unwrap();
    assert!(controls > 30, "{answer}");
    assert_eq!((&answer["nameless"], &answer["figures"], &answer["jumps"]), (&json!([]), &json!(0), &json!(0)));
    let mut reached = std::collections::BTreeSet::new();
    let mut stops = 0;
    loop {
        page.press("Tab");
        stops += 1;
        let control = page.ask("return document.activeElement.dataset.control ?? document.activeElement.tagName");
        match control.as_str().unwrap().parse::<u64>() {
            Ok(control) if !reached.insert(control) => break,
            Err(_) if control == "BODY" => break,
            _ => {}
        }
        assert!(stops < 20 * controls, "the focus never comes round");
    }
    let missed: Vec<String> = (0..controls)
        .filter(|k| !reached.contains(k))
        .map(|k| page.ask(&format!("return document.querySelector('[data-control=\"{k}\"]').outerHTML")).to_string())
        .collect();
    assert_eq!(missed, Vec::<String>::new(), "{stops} stops");
}

/// Texts fainter on their background than WCAG 2.2 asks for at level AA: 4.5, of large type 3.
const FAINT: &str = r"
    const luminance = (c) => {
        const [r, g, b] = c.map((v) => v / 255).map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
        return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const colour = (text) => text.match(/[\d.]+/g).map(Number);
    const behind = (e) => {
        for (; e; e = e.parentElement) {
            const c = colour(getComputedStyle(e).backgroundColor);
            if (c.length < 4 || c[3] === 1) return c.slice(0, 3);
        }
        return [255, 255, 255];
    };
    const own = (e) => [...e.childNodes].some((n) => n.nodeType === 3 && n.data.trim());
    document.querySelectorAll('details').forEach((d) => { d.open = true; });
    document.querySelectorAll('section').forEach((s) => { s.style.contentVisibility = 'visible'; });
    const texts = [...document.body.querySelectorAll('*')].filter((e) =>
        own(e) && !e.closest('script, title, desc') && e.getClientRects().length);
    return {texts: texts.length, faint: texts.filter((e) => {
        const style = getComputedStyle(e), inSvg = e.namespaceURI.endsWith('svg');
        const [a, b] = [colour(inSvg ? style.fill : style.color).slice(0, 3), behind(e)].map(luminance);
        const size = parseFloat(style.fontSize);
        const least = size >= 24 || (size >= 18.66 && style.fontWeight >= 700) ? 3 : 4.5;
        return (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05) < least;
    }).map((e) => e.textContent)};";

#[test]
fn every_text_stands_out_from_its_background() {
    let Some(browser) = browser() else { return };
    for screen in [Screen::DESK, Screen::DESK.dark()] {
        let page = open(&browser, screen);
        let answer = page.ask(FAINT);
        assert!(answer["texts"].as_u64().unwrap() > 500, "{answer}");
        assert_eq!(answer["faint"], json!([]), "{screen:?}");
        // It can fail.
        page.ask(
            "document.querySelector('h1').style.color = 'gray'; document.querySelector('.brand').style.color = 'gray'",
        );
        assert_eq!(
            page.ask(FAINT)["faint"].as_array().unwrap().len(),
            1,
            "the large one has 3.9 to 1, which is enough"
        );
    }
}

/// Pages of a PDF file, whose page objects are not packed.
fn pages(pdf: &[u8]) -> usize {
    let text = String::from_utf8_lossy(pdf);
    text.matches("/Type /Page\n").count() + text.matches("/Type /Page ").count() + text.matches("/Type /Page/").count()
}

#[test]
fn paper_is_a4_and_nothing_is_cut_at_its_side() {
    let Some(browser) = browser() else { return };
    // The width that A4 leaves for a page, at 96 pixels an inch.
    let page = open(&browser, Screen::DESK.wide(794));
    let pdf = page.print();
    let sheets = pages(&pdf);
    assert!(pdf.starts_with(b"%PDF") && (1..=2).contains(&sheets), "{sheets} pages");
    assert!(String::from_utf8_lossy(&pdf).contains("/MediaBox [0 0 594.9"), "A4 upright");
}

#[test]
fn verdict_model_numbers_and_curves_are_on_the_first_sheet() {
    let Some(browser) = browser() else { return };
    let page = open(&browser, Screen::SHEET);
    let bottoms = page.ask(
        "return ['section.verdict', '#model', '#numbers', '.figure .panels'].map((name) =>
            document.querySelector(name).getBoundingClientRect().bottom)",
    );
    for bottom in bottoms.as_array().unwrap() {
        assert!(bottom.as_f64().unwrap() <= f64::from(Screen::SHEET.height), "{bottoms}");
    }
}

#[test]
fn the_picture_of_the_model_and_the_numbers_are_on_the_first_screen() {
    let Some(browser) = browser() else { return };
    let page = open(&browser, Screen::DESK);
    let bottoms = page.ask(
        "return ['.model-picture', '#numbers .card:last-child'].map((name) =>
            document.querySelector(name).getBoundingClientRect().bottom)",
    );
    for bottom in bottoms.as_array().unwrap() {
        assert!(bottom.as_f64().unwrap() <= f64::from(Screen::DESK.height), "{bottoms}");
    }
}
