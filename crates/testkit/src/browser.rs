//! Pages in a real browser, for tests: opened on a screen, asked, pointed to, typed to, printed. A dev-dependency only.
//!
//! The browser is driven over its DevTools protocol by the crate `headless_chrome`. What fails here fails the test that
//! asked, so functions panic with what the browser said.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use headless_chrome::browser::tab::point::Point;
use headless_chrome::protocol::cdp::types::Event;
use headless_chrome::protocol::cdp::{Emulation, Input, Network, Page as Cdp};
use headless_chrome::types::PrintToPdfOptions;
use headless_chrome::{LaunchOptions, Tab};
use serde_json::Value;

// An open page.

/// A page that is loaded; it is closed with this value.
pub struct Page {
    tab: Arc<Tab>,
    said: Said,
}

/// What the browser answers, or the end of the test.
fn told<T, E: std::fmt::Display>(what: &str, answer: Result<T, E>) -> T {
    answer.unwrap_or_else(|error| panic!("{what}: {error}"))
}

impl Page {
    pub(crate) fn open(tab: Arc<Tab>, address: &str, screen: Screen) -> Self {
        let said = Said::of(&tab);
        show_on(&tab, screen);
        told(address, tab.navigate_to(address).and_then(|tab| tab.wait_until_navigated()));
        Self { tab, said }
    }

    /// What the body of a function returns in the page, as JSON.
    pub fn ask(&self, body: &str) -> Value {
        let answer = told(body, self.tab.evaluate(&format!("JSON.stringify((function () {{ {body} }})())"), true));
        let text = answer.value.as_ref().and_then(Value::as_str).unwrap_or("null");
        told(text, serde_json::from_str(text))
    }

    /// Texts that a page calls its parts by: headings, heads of tables, legends, captions, names of controls and
    /// figures, folded parts opened or not. Left out is what has `code` alone in it: an identifier.
    pub fn labels(&self) -> BTreeSet<String> {
        let script = "
            const all = [...document.querySelectorAll(
                'h1, h2, h3, th, dt, legend, .legend label, figcaption, summary, button, .caption, svg title')];
            const text = (e) => e.textContent.replace(/\\s+/g, ' ').trim();
            const said = all.filter((e) => !(e.children.length === 1 && e.firstElementChild.tagName === 'CODE'
                && text(e) === text(e.firstElementChild))).map(text);
            const named = [...document.querySelectorAll('[aria-label]')].map((e) => e.getAttribute('aria-label'));
            return [...said, ...named].filter((text) => text);";
        let labels = self.ask(script);
        labels.as_array().into_iter().flatten().filter_map(|label| Some(label.as_str()?.to_owned())).collect()
    }

    /// Presses a key, such as `Tab` or `ArrowRight`, where the focus is.
    pub fn press(&self, key: &str) {
        told(key, self.tab.press_key(key));
    }

    /// Moves the pointer to a place on the screen, CSS pixels.
    pub fn point_at(&self, x: f64, y: f64) {
        told("pointer", self.tab.move_mouse_to_point(Point { x, y }));
    }

    /// Presses the pointer there and lets it go.
    pub fn click(&self, x: f64, y: f64) {
        told("pointer", self.tab.click_point(Point { x, y }));
    }

    /// Types words where the focus is.
    pub fn write(&self, words: &str) {
        told(words, self.tab.type_str(words));
    }

    /// Drops files or folders of the disk at a place on the screen, as a person does.
    pub fn drop_at(&self, x: f64, y: f64, paths: &[&Path]) {
        let absolute = |path: &&Path| told("a file to drop", path.canonicalize()).display().to_string();
        let data = Input::DragData {
            items: Vec::new(),
            files: Some(paths.iter().map(absolute).collect()),
            drag_operations_mask: 1,
        };
        type Step = Input::DispatchDragEventTypeOption;
        for step in [Step::DragEnter, Step::DragOver, Step::Drop] {
            let event = Input::DispatchDragEvent { Type: step, x, y, data: data.clone(), modifiers: None };
            told("drop", self.tab.call_method(event));
        }
    }

    /// Cuts the page off the network.
    pub fn cut_network(&self) {
        told(
            "network",
            self.tab.call_method(Network::EmulateNetworkConditions {
                offline: true,
                latency: 0.0,
                download_throughput: 0.0,
                upload_throughput: 0.0,
                connection_Type: None,
                packet_loss: None,
                packet_queue_length: None,
                packet_reordering: None,
            }),
        );
    }

    /// Waits until the body of a function returns something that counts as true, and returns it.
    pub fn wait_for(&self, body: &str) -> Value {
        let started = Instant::now();
        loop {
            let answer = self.ask(body);
            if ![Value::Null, Value::Bool(false), Value::from("")].contains(&answer) {
                return answer;
            }
            assert!(started.elapsed() < PATIENCE, "not in {PATIENCE:?}: {body}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Messages of the console, errors and refused loads, so far.
    pub fn console(&self) -> Vec<String> {
        self.said.console()
    }

    /// What the page asked for beside itself, so far.
    pub fn requests(&self) -> Vec<String> {
        self.said.requests().split_off(1)
    }

    /// The page on A4 paper, a PDF file.
    pub fn print(&self) -> Vec<u8> {
        let paper = PrintToPdfOptions {
            paper_width: Some(210.0 / 25.4),
            paper_height: Some(297.0 / 25.4),
            prefer_css_page_size: Some(true),
            print_background: Some(true),
            ..PrintToPdfOptions::default()
        };
        told("print", self.tab.print_to_pdf(Some(paper)))
    }

    /// What the screen shows, a PNG file.
    pub fn picture(&self) -> Vec<u8> {
        let format = Cdp::CaptureScreenshotFormatOption::Png;
        told("picture", self.tab.capture_screenshot(format, None, None, true))
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        // A browser that is gone has closed it.
        let _ = self.tab.close(false);
    }
}

fn show_on(tab: &Tab, screen: Screen) {
    let size = Emulation::SetDeviceMetricsOverride {
        width: screen.width,
        height: screen.height,
        device_scale_factor: 1.0,
        mobile: screen.is_phone,
        scale: None,
        screen_width: None,
        screen_height: None,
        position_x: None,
        position_y: None,
        dont_set_visible_size: None,
        screen_orientation: None,
        viewport: None,
        display_feature: None,
        device_posture: None,
    };
    told("size of the screen", tab.call_method(size));
    let scheme = Emulation::MediaFeature {
        name: "prefers-color-scheme".to_owned(),
        value: if screen.is_dark { "dark" } else { "light" }.to_owned(),
    };
    let media = screen.is_paper.then(|| "print".to_owned());
    told("colours", tab.call_method(Emulation::SetEmulatedMedia { media, features: Some(vec![scheme]) }));
    told("scripts", tab.call_method(Emulation::SetScriptExecutionDisabled { value: !screen.has_script }));
}

// What a page says to the console and asks of a network.

/// What was said so far.
#[derive(Debug, Clone, Default)]
pub(crate) struct Said {
    /// Messages of the console, errors, refused loads.
    console: Arc<Mutex<Vec<String>>>,
    /// Addresses asked for.
    requests: Arc<Mutex<Vec<String>>>,
}

impl Said {
    /// Listens to a page from now on.
    pub(crate) fn of(tab: &Tab) -> Self {
        let said = Self::default();
        let heard = said.clone();
        let listener = Arc::new(move |event: &Event| heard.note(event));
        tab.add_event_listener(listener).unwrap_or_else(|error| panic!("the page cannot be listened to: {error}"));
        tab.enable_runtime().and_then(|tab| tab.enable_log()).unwrap_or_else(|error| panic!("no console: {error}"));
        let network = Network::Enable {
            max_total_buffer_size: None,
            max_resource_buffer_size: None,
            max_post_data_size: None,
            report_direct_socket_traffic: None,
            enable_durable_messages: None,
        };
        tab.call_method(network).unwrap_or_else(|error| panic!("no requests: {error}"));
        said
    }

    fn note(&self, event: &Event) {
        let add = |list: &Mutex<Vec<String>>, text: String| {
            if let Ok(mut list) = list.lock() {
                list.push(text);
            }
        };
        match event {
            Event::RuntimeConsoleAPICalled(call) => {
                let texts = call.params.args.iter().map(|a| a.value.clone().unwrap_or_default().to_string());
                add(&self.console, texts.collect::<Vec<_>>().join(" "));
            }
            Event::RuntimeExceptionThrown(thrown) => {
                let details = &thrown.params.exception_details;
                let text = details.exception.as_ref().and_then(|e| e.description.clone());
                add(&self.console, text.unwrap_or_else(|| details.text.clone()));
            }
            Event::LogEntryAdded(added) => add(&self.console, added.params.entry.text.clone()),
            Event::NetworkRequestWillBeSent(sent) => add(&self.requests, sent.params.request.url.clone()),
            _ => {}
        }
    }

    /// Messages of the console, errors and refused loads.
    pub(crate) fn console(&self) -> Vec<String> {
        self.console.lock().map(|list| list.clone()).unwrap_or_default()
    }

    /// Addresses asked for, the page's own first.
    pub(crate) fn requests(&self) -> Vec<String> {
        self.requests.lock().map(|list| list.clone()).unwrap_or_default()
    }
}

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

// What a page is shown on.

/// A screen, or paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Screen {
    /// Width, CSS pixels.
    pub width: u32,
    /// Height, CSS pixels.
    pub height: u32,
    /// A telephone: touch, and a page as wide as the screen.
    pub is_phone: bool,
    /// The reader prefers dark colours.
    pub is_dark: bool,
    /// Scripts run.
    pub has_script: bool,
    /// Laid out by its print rules, as on paper.
    pub is_paper: bool,
}

impl Screen {
    /// A desk's.
    pub const DESK: Self =
        Self { width: 1400, height: 1000, is_phone: false, is_dark: false, has_script: true, is_paper: false };
    /// A telephone's.
    pub const PHONE: Self =
        Self { width: 390, height: 844, is_phone: true, is_dark: false, has_script: true, is_paper: false };
    /// A sheet of A4 within margins of 11 mm, at 96 pixels an inch.
    pub const SHEET: Self = Self { width: 710, height: 1039, is_paper: true, ..Self::DESK };

    /// The same, `width` CSS pixels wide.
    #[must_use]
    pub const fn wide(self, width: u32) -> Self {
        Self { width, ..self }
    }

    /// The same in dark colours.
    #[must_use]
    pub const fn dark(self) -> Self {
        Self { is_dark: true, ..self }
    }

    /// The same without scripts.
    #[must_use]
    pub const fn without_script(self) -> Self {
        Self { has_script: false, ..self }
    }
}
