//! A running browser.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::time::Duration;

use headless_chrome::LaunchOptions;

use crate::browser::page::Page;
use crate::browser::screen::Screen;

// The browser itself.

/// Longest wait for an answer of the browser: a machine with much other work starts it slowly.
const PATIENCE: Duration = Duration::from_secs(120);

/// Times that a page is asked for: the library waits for each for some seconds only, whatever its patience.
const TRIES: usize = 6;

/// Names under which a browser of this kind is installed.
const NAMES: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];

/// A running browser without a window; it ends with this value.
pub struct Browser(headless_chrome::Browser);

impl Browser {
    /// Starts the browser of `CRUMPLE_BROWSER`, else the one installed.
    ///
    /// `None` where `CRUMPLE_NO_BROWSER` leaves it out on purpose, which is said with `what` is not looked at. Panics
    /// where there is none: a page that nobody has looked at is not tested.
    pub fn start(what: &str) -> Option<Self> {
        if let Ok(reason) = std::env::var("CRUMPLE_NO_BROWSER") {
            eprintln!("SKIPPED: {what} is not looked at in a browser (CRUMPLE_NO_BROWSER={reason})");
            return None;
        }
        let quiet =
            ["--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run"];
        let options = LaunchOptions {
            // In a container there is none of what the sandbox is made of.
            sandbox: false,
            path: Some(installed()),
            window_size: Some((1400, 1000)),
            idle_browser_timeout: PATIENCE,
            args: quiet.map(OsStr::new).to_vec(),
            ..LaunchOptions::default()
        };
        let browser = headless_chrome::Browser::new(options);
        Some(Self(browser.unwrap_or_else(|error| panic!("the browser does not start: {error}"))))
    }

    /// Opens a file on a screen and waits until it is loaded. `fragment`: empty, or what stands behind it from `#` on.
    pub fn open(&self, file: &Path, fragment: &str, screen: Screen) -> Page {
        let file = file.canonicalize().unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let mut tab = self.0.new_tab();
        for _ in 1..TRIES {
            if tab.is_err() {
                tab = self.0.new_tab();
            }
        }
        let tab = tab.unwrap_or_else(|error| panic!("no new page: {error}"));
        tab.set_default_timeout(PATIENCE);
        Page::open(tab, &format!("file://{}{fragment}", file.display()), screen)
    }
}

/// The browser's program.
fn installed() -> PathBuf {
    if let Some(path) = std::env::var_os("CRUMPLE_BROWSER") {
        return path.into();
    }
    let path = std::env::var_os("PATH").unwrap_or_default();
    let mut places = std::env::split_paths(&path).flat_map(|folder| NAMES.map(|name| folder.join(name)));
    places.find(|place| place.is_file()).unwrap_or_else(|| {
        panic!(
            "no {} in PATH: install one (apt-get install chromium), name it in CRUMPLE_BROWSER, or set \
             CRUMPLE_NO_BROWSER=1",
            NAMES.join(", ")
        )
    })
}
