//! How a person types what a hint advises: by the small programs, by `crumple`, or behind `crumple run`.

use std::sync::atomic::{AtomicU8, Ordering::Relaxed};

/// How a program was called.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// By itself or by `just`: `crumple-filter`.
    Alone,
    /// As a command of `crumple`: `crumple filter`.
    Within,
    /// As a stage of `crumple run`.
    InRun,
}

const WAYS: [Way; 3] = [Way::Alone, Way::Within, Way::InRun];

/// That of the program that runs.
static WAY: AtomicU8 = AtomicU8::new(0);

/// Set in the environment of the programs that a run starts: what they advise is typed behind that run.
pub const IN_RUN: &str = "CRUMPLE_IN_RUN";

pub(crate) fn begin(way: Way) {
    WAY.store(way as u8, Relaxed);
}

/// Whether options are typed behind a run: of `crumple`, or of `just`, which starts the programs.
fn is_in_run() -> bool {
    way() == Way::InRun || (way() == Way::Alone && std::env::var_os(IN_RUN).is_some())
}

fn way() -> Way {
    WAYS[usize::from(WAY.load(Relaxed)).min(WAYS.len() - 1)]
}

/// Of two texts that of a caller of the small programs, or of `crumple`.
pub fn by_way<'a>(alone: &'a str, within: &'a str) -> &'a str {
    if way() == Way::Alone { alone } else { within }
}

/// Commands of `crumple artifact` that are commands of `crumple` too.
pub const OF_ARTIFACT: [&str; 6] = ["show", "notes", "curve", "check", "explain", "new-stage"];

/// A program with its first words: `crumple-filter`, `crumple filter`. What `crumple artifact` shows of a file is a
/// command of its own there.
pub fn program(words: &str) -> String {
    match way() {
        Way::Alone => format!("crumple-{words}"),
        _ => {
            let of_artifact = |rest: &&str| OF_ARTIFACT.iter().any(|word| rest.starts_with(word));
            format!("crumple {}", words.strip_prefix("artifact ").filter(of_artifact).unwrap_or(words))
        }
    }
}

/// An option of a stage with its value: `crumple-filter --cfc 180`, `--set filter.cfc=180` behind a run, where those of
/// ingest are flags behind the record. Without a value it is a switch.
pub fn option(stage: &str, name: &str, value: &str) -> String {
    let flag = format!("--{name} {value}");
    let flag = flag.trim_end();
    match (is_in_run(), stage) {
        (true, "ingest") => flag.to_owned(),
        (true, _) => {
            let value = if value.is_empty() { "true" } else { value };
            format!("--set {stage}.{}={value}", name.replace('-', "_"))
        }
        _ => format!("{} {flag}", program(stage)),
    }
}

/// An option of a stage in a sentence that says what it is for: `--from`, `--set identify.from=...` behind a run.
pub fn flag(stage: &str, name: &str) -> String {
    match (is_in_run(), stage) {
        (true, "ingest") => format!("--{name}"),
        (true, _) => format!("--set {stage}.{}=...", name.replace('-', "_")),
        _ => format!("--{name}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hint_is_what_the_caller_can_type() {
        let all = |way| {
            begin(way);
            let options = [("filter", "cfc", "none"), ("ingest", "mass", "873kg"), ("identify", "real", "")];
            let options = options.map(|(stage, name, value)| option(stage, name, value));
            (options, ["artifact show", "artifact check", "filter"].map(program))
        };
        let texts = |texts: [&str; 3]| texts.map(str::to_owned);
        let alone = (
            texts(["crumple-filter --cfc none", "crumple-ingest --mass 873kg", "crumple-identify --real"]),
            texts(["crumple-artifact show", "crumple-artifact check", "crumple-filter"]),
        );
        let programs = texts(["crumple show", "crumple check", "crumple filter"]);
        let within = texts(["crumple filter --cfc none", "crumple ingest --mass 873kg", "crumple identify --real"]);
        let in_run = texts(["--set filter.cfc=none", "--mass 873kg", "--set identify.real=true"]);
        assert_eq!(all(Way::Within), (within, programs.clone()));
        assert_eq!(all(Way::InRun), (in_run, programs));
        assert_eq!(all(Way::Alone), alone);
    }
}
