//! Opens a page for a person: by the variable `BROWSER`, else by what the system has for it.

use std::env;
use std::path::Path;
use std::process::{Command, Stdio};

use crumple_stage::say;

use crate::words::Words;

/// Variable of the system: a command, or several with colons between them, each tried until one works; `%s` in it is
/// the page.
const BROWSER: &str = "BROWSER";

/// What the system has: its words, behind which the page stands.
const OF_SYSTEM: &[&str] = if cfg!(target_os = "macos") {
    &["open"]
} else if cfg!(windows) {
    &["cmd", "/C", "start", ""]
} else {
    &["xdg-open"]
};

/// Opens a page, or says that nothing here does. It waits for what opens it, as a browser in a terminal needs.
pub(crate) fn open_page(page: &Path) {
    if !page.is_file() {
        say(format_args!("note: there is no {} to open", page.display()));
        return;
    }
    let typed = env::var(BROWSER).unwrap_or_default();
    let named = typed.split(if cfg!(windows) { ';' } else { ':' }).filter_map(|command| command.parse::<Words>().ok());
    let of_system = Words(OF_SYSTEM.iter().map(|word| (*word).to_owned()).collect());
    if !named.chain([of_system]).any(|command| is_opened_by(&command, page)) {
        let system = OF_SYSTEM.first().copied().unwrap_or_default();
        say(format_args!(
            "note: the report was not opened: {system} is not here or failed, and the variable {BROWSER} names no \
             browser that works\n  hint: open {} in a browser",
            page.display()
        ));
    }
}

/// Whether a command started and ended well. What it complains of would stand among the lines of the run.
fn is_opened_by(command: &[String], page: &Path) -> bool {
    const PAGE: &str = "%s";
    let Some((program, flags)) = command.split_first() else { return false };
    let shown = page.to_string_lossy();
    let mut opener = Command::new(program);
    opener.args(flags.iter().map(|flag| flag.replace(PAGE, &shown)));
    if !flags.iter().any(|flag| flag.contains(PAGE)) {
        opener.arg(page);
    }
    opener.stderr(Stdio::null()).status().is_ok_and(|status| status.success())
}
