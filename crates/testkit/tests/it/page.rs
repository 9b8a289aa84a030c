//! `crumple.html` in a browser: what a person does with it, and that it says and computes what the programs do.

use std::collections::BTreeMap;
use std::fs;
use std::io::{Cursor, Read};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use crumple_testkit::browser::{Browser, Page, Screen};
use crumple_testkit::programs::{binary, code_and_error, run};
use crumple_testkit::{shared, workspace};

use crate::formats::{iso_mme, zipped};

/// Largest page, bytes.
const LARGEST: u64 = 8_000_000;

/// The page that `just page` made, where `CRUMPLE_PAGE` names it, and a browser.
fn page() -> Option<(PathBuf, Browser)> {
    let Some(path) = std::env::var_os("CRUMPLE_PAGE") else {
        eprintln!("SKIPPED: crumple.html is not looked at (just page; CRUMPLE_PAGE=target/page/crumple.html)");
        return None;
    };
    Some((workspace().join(path), Browser::start("crumple.html")?))
}

fn opened(browser: &Browser, file: &Path, screen: Screen) -> Page {
    let page = browser.open(file, "", screen);
    page.cut_network();
    wait_until(&page, &["ready"]);
    page
}

/// Waits for one of these states.
fn wait_until(page: &Page, states: &[&str]) -> String {
    let state = "const state = document.documentElement.dataset.state;";
    let told = page.wait_for(&format!("{state} return {states:?}.includes(state) && state;"));
    told.as_str().unwrap_or_default().to_owned()
}

fn text(page: &Page, id: &str) -> String {
    page.ask(&format!("return element('{id}').innerText;")).as_str().unwrap_or_default().to_owned()
}

/// Presses a button where it is on the screen.
fn press(page: &Page, id: &str) {
    let place = page.ask(&format!(
        "const button = element('{id}'); button.scrollIntoView({{ block: 'center' }});
         const at = button.getBoundingClientRect(); return [at.x + at.width / 2, at.y + at.height / 2];"
    ));
    page.click(place[0].as_f64().unwrap(), place[1].as_f64().unwrap());
}

/// The files of the archive that *Save results* saves, by their names.
fn saved(page: &Page) -> BTreeMap<String, Vec<u8>> {
    page.ask(
        "window.save = (file, parts) => new Blob(parts).arrayBuffer().then((bytes) => { window.saved = bytes; });",
    );
    page.ask("window.saved = null;");
    press(page, "save-results");
    let packed = page
        .wait_for("return saved && btoa(Array.from(new Uint8Array(saved), (b) => String.fromCharCode(b)).join(''));");
    let bytes = STANDARD.decode(packed.as_str().unwrap()).unwrap();
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
    let mut files = BTreeMap::new();
    for number in 0..archive.len() {
        let mut file = archive.by_index(number).unwrap();
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).unwrap();
        files.insert(file.name().unwrap().rsplit('/').next().unwrap().to_owned(), bytes);
    }
    files
}

/// The results of the page are those of the programs: every artifact and the summary, by the default tolerance.
fn assert_same_as_native(page: &Page, record: &Path, flags: &[&str]) {
    let [native, web] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let output = run(&["flags=-q"], native.path(), record, flags);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    for (name, bytes) in saved(page) {
        fs::write(web.path().join(name), bytes).unwrap();
    }
    let output = Command::new(binary("crumple-diff")).args([native.path(), web.path()]).arg("--all").output().unwrap();
    let told = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{}: {told}", record.display());
}

fn fixture(name: &str) -> PathBuf {
    workspace().join("fixtures").join(name).join("crash.csv")
}

#[test]
fn a_dropped_record_gives_what_the_programs_give_and_nothing_leaves_the_page() {
    let Some((file, browser)) = page() else { return };
    let size = fs::metadata(&file).unwrap().len();
    assert!(size <= LARGEST, "{size} bytes");
    let page = opened(&browser, &file, Screen::DESK);
    for name in ["noisy", "kelvin", "elastoplastic", "double"] {
        page.drop_at(700.0, 300.0, &[&fixture(name)]);
        wait_until(&page, &["running"]);
        wait_until(&page, &["done", "refused"]);
        assert_eq!(text(&page, "refusal"), "", "{name}");
        assert_same_as_native(&page, &fixture(name), &[]);
        page.wait_for("return element('frame').contentDocument?.querySelector('h1')?.innerText;");
    }
    let outside = |address: &String| !["data:", "blob:", "about:"].iter().any(|scheme| address.starts_with(scheme));
    let asked: Vec<String> = page.requests().into_iter().filter(outside).collect();
    assert_eq!(asked, [""; 0]);
    // The report is ours, and the page asks it for its height.
    let is_known = |told: &String| told.starts_with("An iframe which has both allow-scripts and allow-same-origin");
    let console: Vec<String> = page.console().into_iter().filter(|told| !is_known(told)).collect();
    assert_eq!(console, [""; 0]);
}

#[test]
fn the_policy_of_the_page_lets_nothing_out() {
    let Some((file, browser)) = page() else { return };
    let page = opened(&browser, &file, Screen::DESK);
    page.ask("fetch('https://example.invalid/').then(() => { window.got = 'out'; }, () => { window.got = 'kept'; });");
    assert_eq!(page.wait_for("return window.got;"), "kept");
    page.ask("const image = new Image(); image.src = 'https://example.invalid/x.png'; document.body.append(image);");
    page.wait_for("return document.images.length;");
    let console = page.console().join("\n");
    assert!(console.matches("Content Security Policy").count() >= 2, "{console}");
}

#[test]
fn the_example_is_done_twice_alike_and_soon() {
    let Some((file, browser)) = page() else { return };
    let page = opened(&browser, &file, Screen::DESK);
    let mut before = None;
    for _ in 0..2 {
        let started = Instant::now();
        press(&page, "example-button");
        wait_until(&page, &["done", "refused"]);
        eprintln!("example to report: {:.2} s", started.elapsed().as_secs_f64());
        let files = saved(&page);
        assert!(before.as_ref().is_none_or(|before| *before == files));
        before = Some(files);
        page.ask("again();");
    }
}

#[test]
fn a_record_without_mass_and_speed_is_asked_for_them() {
    let Some((file, browser)) = page() else { return };
    let folder = tempfile::tempdir().unwrap();
    let record = folder.path().join("Prüfung 7.csv");
    let table = fs::read_to_string(fixture("noisy")).unwrap();
    let lines: Vec<&str> = table.lines().filter(|line| !line.starts_with('#')).collect();
    fs::write(&record, lines.join("\n")).unwrap();
    let page = opened(&browser, &file, Screen::DESK);
    page.drop_at(700.0, 300.0, &[&record]);
    wait_until(&page, &["asking"]);
    assert!(text(&page, "read").contains("2501 samples at 10000 Hz"), "{}", text(&page, "read"));
    let points = page.ask("return element('curve').getAttribute('points').split(' ').length;");
    assert!(points.as_u64().unwrap() > 500, "{points}");
    let (code, error) = code_and_error(Command::new(binary("crumple-ingest")).arg(&record).args([
        "-o",
        folder.path().join("x.mcap").to_str().unwrap(),
        "--mass",
        "1500 parsec",
    ]));
    page.ask("element('mass').focus();");
    page.write("1500 parsec");
    page.ask("element('impact_speed').focus();");
    page.write("50 km/h");
    page.press("Enter");
    let told = page.wait_for("return element('mass-error').innerText;");
    assert_eq!((code, told.as_str().unwrap()), (2, error.lines().next().unwrap()));
    assert_eq!(page.ask("return element('impact_speed').value;"), "50 km/h");
    page.ask("element('mass').focus(); element('mass').select();");
    page.write("1500 kg");
    page.press("Enter");
    wait_until(&page, &["done", "refused"]);
    assert_same_as_native(&page, &record, &["--mass", "1500 kg", "--impact-speed", "50 km/h"]);
}

#[test]
fn a_refused_file_is_answered_in_the_words_of_the_program_and_a_good_one_follows() {
    let Some((file, browser)) = page() else { return };
    let folder = tempfile::tempdir().unwrap();
    let bad = folder.path().join("bad.csv");
    fs::write(&bad, "time_s,accel_g\n0,0\n1,abc\n2,0\n3,0\n").unwrap();
    let output = folder.path().join("x.mcap");
    let (_, error) = code_and_error(Command::new(binary("crumple-ingest")).arg(&bad).arg("-o").arg(output));
    let page = opened(&browser, &file, Screen::DESK);
    page.drop_at(700.0, 300.0, &[&bad]);
    wait_until(&page, &["refused"]);
    let told = page.ask("return element('refusal').textContent;");
    let native = error.replace(&bad.display().to_string(), "bad.csv");
    assert_eq!(told.as_str().unwrap().trim(), native.trim());
    page.drop_at(700.0, 300.0, &[&fixture("noisy")]);
    wait_until(&page, &["running"]);
    press(&page, "stop");
    wait_until(&page, &["ready"]);
    page.drop_at(700.0, 300.0, &[&fixture("noisy"), &fixture("kelvin").with_file_name("truth.json")]);
    wait_until(&page, &["refused"]);
    page.drop_at(700.0, 300.0, &[&fixture("noisy")]);
    wait_until(&page, &["done"]);
}

#[test]
fn the_usual_settings_are_a_form() {
    let Some((file, browser)) = page() else { return };
    let page = opened(&browser, &file, Screen::DESK);
    page.drop_at(700.0, 300.0, &[&fixture("kelvin")]);
    wait_until(&page, &["done", "refused"]);
    let names = page.ask("return fields.filter((f) => !f.place.hidden).map((f) => f.input.id);");
    assert_eq!(names, serde_json::json!(["mass", "impact_speed", "unit", "time_zero", "cfc", "models", "display"]));
    page.ask("element('settings').open = true; element('cfc').focus();");
    page.write("181");
    page.press("Enter");
    let told = page.wait_for("return element('cfc-error').innerText;");
    assert!(told.as_str().unwrap().contains("181"), "{told}");
    page.ask("element('cfc').value = '180'; element('mass').value = '900 kg';");
    page.ask("for (const one of element('models').options) one.selected = ['kelvin', 'maxwell'].includes(one.value);");
    page.ask("element('cfc').focus();");
    page.press("Enter");
    wait_until(&page, &["running"]);
    wait_until(&page, &["done", "refused"]);
    assert_eq!(text(&page, "refusal"), "");
    let set = ["--mass", "900 kg", "--set", "filter.cfc=180", "--set", "parameter-solve.models=kelvin,maxwell"];
    assert_same_as_native(&page, &fixture("kelvin"), &set);
}

/// Drops a folder or an archive, and states nothing more.
fn take_without_questions(page: &Page, record: &Path) {
    page.drop_at(700.0, 300.0, &[record]);
    if wait_until(page, &["asking", "done", "refused"]) == "asking" {
        press(page, "without");
        wait_until(page, &["done", "refused"]);
    }
    assert_eq!(text(page, "refusal"), "", "{}", record.display());
    assert_same_as_native(page, record, &[]);
}

#[test]
fn a_test_of_many_files_comes_as_a_folder_or_a_zip_archive() {
    let Some((file, browser)) = page() else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut tests = vec![iso_mme(folder.path())];
    tests.extend(shared("data/nhtsa-v10146-camry-frontal"));
    let page = opened(&browser, &file, Screen::DESK);
    for test in tests {
        take_without_questions(&page, &test);
        page.ask("again();");
        take_without_questions(&page, &zipped(&test, folder.path()));
        page.ask("again();");
    }
}

#[test]
fn the_page_is_for_narrow_screens_and_dark_ones_and_for_the_keyboard() {
    let Some((file, browser)) = page() else { return };
    let pictures = file.with_file_name("pictures");
    fs::create_dir_all(&pictures).unwrap();
    for (name, screen) in [("desk", Screen::DESK), ("phone", Screen::PHONE.wide(360)), ("dark", Screen::DESK.dark())] {
        let page = opened(&browser, &file, screen);
        let keep = |state: &str| fs::write(pictures.join(format!("{name}-{state}.png")), page.picture()).unwrap();
        keep("ready");
        // The file field, then the example.
        page.press("Tab");
        page.press("Tab");
        assert_eq!(page.ask("return document.activeElement.id;"), "example-button");
        page.press("Enter");
        wait_until(&page, &["running"]);
        keep("running");
        wait_until(&page, &["done"]);
        page.wait_for("return parseFloat(element('frame').style.height) > 2000;");
        let wide = page.ask("return document.documentElement.scrollWidth - innerWidth;");
        assert!(wide.as_i64().unwrap() <= 0, "{name}: {wide} px too wide");
        keep("done");
        let light = page.ask("return getComputedStyle(document.body).backgroundColor;");
        assert_eq!(light == "rgb(255, 255, 255)", !screen.is_dark, "{light}");
        page.ask("history.back();");
        wait_until(&page, &["ready"]);
        page.ask("history.forward();");
        wait_until(&page, &["done"]);
    }
}
