//! A real browser for tests of pages, without a window and without a network.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The browser, or `None` where it is left out on purpose. Its absence is a failure otherwise: a report nobody has
/// looked at is not tested.
pub fn browser() -> Option<PathBuf> {
    if let Ok(reason) = std::env::var("CRUMPLE_NO_BROWSER") {
        eprintln!("SKIPPED: the report is not looked at in a browser (CRUMPLE_NO_BROWSER={reason})");
        return None;
    }
    if let Some(path) = std::env::var_os("CRUMPLE_BROWSER") {
        return Some(path.into());
    }
    let path = std::env::var_os("PATH").unwrap_or_default();
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let browser =
        std::env::split_paths(&path).flat_map(|folder| names.map(|name| folder.join(name))).find(|p| p.is_file());
    assert!(
        browser.is_some(),
        "no {} in PATH: install one (apt-get install chromium), name it in CRUMPLE_BROWSER, or set \
         CRUMPLE_NO_BROWSER=1",
        names.join(", ")
    );
    browser
}

/// The document after its scripts have run, and what the browser wrote to its log.
fn load(browser: &Path, page: &Path) -> (String, String) {
    let profile = tempfile::tempdir().unwrap();
    let output = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"])
        .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
        .args(["--enable-logging=stderr", "--log-level=0", "--window-size=1400,1000"])
        // Virtual time: the browser goes on as soon as the page has nothing left to do.
        .arg("--virtual-time-budget=20000")
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg("--dump-dom")
        .arg(format!("file://{}", page.display()))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    (String::from_utf8_lossy(&output.stdout).into_owned(), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// Lines of the log that come from the page: errors, warnings, refused loads.
pub fn console(log: &str) -> Vec<&str> {
    log.lines().filter(|line| line.contains("CONSOLE")).collect()
}

/// What `script` returns in the page, opened `width` CSS pixels wide; and the browser's log. The page is framed, for a
/// browser's own window has a least width.
pub fn ask(browser: &Path, page: &Path, width: u32, script: &str) -> (serde_json::Value, String) {
    let inner = page.with_file_name("framed.html");
    let answer = format!("parent.postMessage(JSON.stringify((function () {{ {script} }})()), '*');");
    let script = format!("<script>{answer}</script></body>");
    let html = std::fs::read_to_string(page).unwrap().replace("</body>", &script);
    std::fs::write(&inner, html).unwrap();
    let outer = page.with_file_name("frame.html");
    let frame = format!(
        "<!DOCTYPE html><meta charset=\"utf-8\"><body><script>\
         addEventListener('message', (event) => {{ document.body.dataset.answer = encodeURIComponent(event.data); }});\
         </script><iframe src=\"framed.html\" style=\"width:{width}px;height:800px;border:0\"></iframe></body>"
    );
    std::fs::write(&outer, frame).unwrap();
    let (dom, log) = load(browser, &outer);
    let answer = dom.split("data-answer=\"").nth(1).unwrap_or_else(|| panic!("no answer: {log}"));
    (serde_json::from_str(&percent_decoded(answer.split('"').next().unwrap())).unwrap(), log)
}

fn percent_decoded(text: &str) -> String {
    let mut bytes = Vec::new();
    let mut rest = text.bytes();
    while let Some(byte) = rest.next() {
        if byte == b'%' {
            let pair = [rest.next().unwrap(), rest.next().unwrap()];
            bytes.push(u8::from_str_radix(std::str::from_utf8(&pair).unwrap(), 16).unwrap());
        } else {
            bytes.push(byte);
        }
    }
    String::from_utf8(bytes).unwrap()
}
