//! The chain of the stages and what they write; the name nearest to a mistyped one.

use std::ffi::OsString;
use std::path::{Component, PathBuf};
use std::sync::LazyLock;

use crumple_artifact::records::AgainstTestV1;

// Folders by what tells them apart.

/// The folders by what tells them apart: their paths without the folders that all begin with and the names that all
/// end with.
pub fn told_apart(folders: &[PathBuf]) -> Vec<String> {
    let parts = |folder: &PathBuf| -> Vec<String> {
        let named = folder.components().filter(|part| !matches!(part, Component::CurDir));
        named.map(|part| part.as_os_str().to_string_lossy().into_owned()).collect()
    };
    let mut all: Vec<Vec<String>> = folders.iter().map(parts).collect();
    let same = |all: &[Vec<String>], at: fn(&Vec<String>) -> Option<&String>| {
        all.iter().all(|parts| parts.len() > 1 && at(parts) == at(&all[0]))
    };
    while same(&all, |parts| parts.first()) {
        all.iter_mut().for_each(|parts| _ = parts.remove(0));
    }
    while same(&all, |parts| parts.last()) {
        all.iter_mut().for_each(|parts| _ = parts.pop());
    }
    all.into_iter().map(|parts| parts.join("/")).collect()
}

/// The file of options beside a record: `crash.csv.toml` of `crash.csv`.
pub fn sidecar_of(record: impl Into<OsString>) -> PathBuf {
    let mut name = record.into();
    name.push(".toml");
    name.into()
}

// "Did you mean ...?"

/// The choice nearest to a mistyped name, if one is near enough to be meant.
pub fn nearest<'a>(name: &str, choices: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    choices
        .into_iter()
        .map(|choice| (strsim::jaro_winkler(&name.to_lowercase(), &choice.to_lowercase()), choice))
        .filter(|(likeness, _)| *likeness > 0.7)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, choice)| choice)
}

// The chain, `pipelines/chain`: which stage reads and writes what, for runs, messages and a stable order. Nothing here
// knows what a stage does.

/// One line a stage, as it was when the program was built.
const CHAIN: &str = include_str!("../../../pipelines/chain");

/// Names of the stages in the order of the chain.
pub(crate) static STAGES: LazyLock<Vec<&str>> = LazyLock::new(|| chain().map(|stage| stage.name).collect());

/// A stage in the chain.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChainStage {
    /// `parameter-solve`.
    pub name: &'static str,
    /// Whether it runs only where the pipeline has a table of its name.
    pub is_optional: bool,
    /// Names in the run folder; `RECORD` is the file that a user brings.
    pub inputs: Vec<&'static str>,
    /// Names in the run folder; the program is told the first and writes the others beside it.
    pub outputs: Vec<&'static str>,
}

/// The stages, in their order.
pub fn chain() -> impl Iterator<Item = ChainStage> {
    CHAIN.lines().filter(|line| !line.starts_with('#')).filter_map(|line| {
        let (before, outputs) = line.split_once("->")?;
        let mut inputs = before.split_whitespace();
        let name = inputs.next()?;
        Some(ChainStage {
            name: name.trim_end_matches('?'),
            is_optional: name.ends_with('?'),
            inputs: inputs.collect(),
            outputs: outputs.split_whitespace().collect(),
        })
    })
}

/// Position of a stage in the pipeline; programs from elsewhere come last.
pub(crate) fn stage_order(stage: Option<&str>) -> usize {
    stage.and_then(|name| STAGES.iter().position(|s| *s == name)).unwrap_or(STAGES.len())
}

/// `5-parameter-solve` of `parameter-solve`: what its artifact is called in a run folder.
pub(crate) fn artifact_of(stage: &str) -> String {
    let name = chain().find(|known| known.name == stage).and_then(|known| known.outputs.first().copied());
    name.map_or(stage, |name| name.trim_end_matches(".mcap")).to_owned()
}

/// The stages that write a topic, e.g. `/events` -> `integrate`; none where any may.
pub(crate) fn writer_of(topic: &str) -> &'static [&'static str] {
    const WRITERS: [(&str, &[&str]); 20] = [
        ("/tests", &["parameter-solve"]),
        ("/test", &["ingest"]),
        ("/quality/", &["ingest"]),
        ("/filter/", &["filter"]),
        ("/events", &["integrate"]),
        ("/metrics", &["integrate"]),
        ("/model/", &["identify"]),
        ("/modes/", &["identify"]),
        ("/identification/", &["identify"]),
        ("/evidence/", &["identify"]),
        ("/shapes/", &["identify"]),
        ("/stabilisation/", &["identify"]),
        ("/response/", &["identify"]),
        ("/selection/", &["identify"]),
        ("/matching/", &["parameter-solve"]),
        ("/parameters/", &["parameter-solve"]),
        ("/recommendation", &["parameter-solve"]),
        ("/simulation/", &["simulate"]),
        ("/prediction/", &["predict"]),
        ("/wave/", &["filter", "ingest"]),
    ];
    if topic.starts_with("/wave/") && ["/velocity", "/displacement", "/force"].iter().any(|s| topic.ends_with(s)) {
        return &["integrate"];
    }
    WRITERS.iter().find(|(prefix, _)| topic.starts_with(prefix)).map_or(&[], |(_, writers)| writers)
}

/// The errors of a prediction beside a test, a dash where one is not known: crush, its time and peak in percent, the
/// coefficient of restitution, the score by ISO/TS 18571.
pub fn errors_in_words(against: &AgainstTestV1) -> [String; 5] {
    let percent = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:+.1} %"));
    let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:+.3}"));
    [
        percent(against.dynamic_crush_error_percent),
        percent(against.time_of_dynamic_crush_error_percent),
        percent(against.peak_acceleration_error_percent),
        number(against.coefficient_of_restitution_error),
        against.iso18571_score.map_or_else(|| "-".to_owned(), |score| format!("{score:.3}")),
    ]
}

#[cfg(test)]
mod tests {

    use super::*;

    #[test]
    fn folders_are_called_by_what_tells_them_apart() {
        let of = |folders: &[&str]| told_apart(&folders.iter().map(PathBuf::from).collect::<Vec<_>>());
        assert_eq!(of(&["runs/a/default", "runs/b/default"]), ["a", "b"]);
        assert_eq!(of(&["runs/a/default/", "./runs/a/unfiltered"]), ["default", "unfiltered"]);
        assert_eq!(of(&["a", "a/x"]), ["a", "a/x"]);
        assert_eq!(of(&["a", "a"]), ["a", "a"]);
    }

    #[test]
    fn suggests_what_was_meant_and_nothing_far_fetched() {
        assert_eq!(nearest("cuttoff", ["cfc", "cutoff", "mode"]), Some("cutoff"));
        assert_eq!(nearest("zzz", ["cfc", "cutoff", "mode"]), None);
    }

    #[test]
    fn every_line_of_the_chain_is_a_stage_and_reads_what_stages_before_it_write() {
        let lines = CHAIN.lines().filter(|line| !line.starts_with('#')).count();
        let mut there = vec!["RECORD"];
        for stage in chain() {
            assert!(stage.inputs.iter().all(|input| there.contains(input)) && !stage.outputs.is_empty(), "{stage:?}");
            there.extend(stage.outputs);
        }
        assert_eq!((lines, there.last()), (STAGES.len(), Some(&"summary.json")));
        assert!(chain().all(|stage| stage.is_optional == (stage.name == "predict")));
    }

    #[test]
    fn stages_are_in_the_order_of_the_pipeline_and_others_behind_them() {
        let orders: Vec<usize> = STAGES.iter().map(|stage| stage_order(Some(stage))).collect();
        assert!(orders.windows(2).all(|pair| pair[0] < pair[1]), "{orders:?}");
        assert!(stage_order(Some("mine")) > orders[0] && stage_order(None) > orders[0]);
    }

    #[test]
    fn a_topic_is_written_by_its_stages() {
        for (topic, writer) in [
            ("/test", &["ingest"][..]),
            ("/filter/93", &["filter"][..]),
            ("/events", &["integrate"][..]),
            ("/parameters/kelvin/direct-fit/1", &["parameter-solve"][..]),
            ("/wave/93", &["filter", "ingest"][..]),
            ("/wave/93/velocity", &["integrate"][..]),
            ("/mine/velocity", &[][..]),
        ] {
            assert_eq!(writer_of(topic), writer, "{topic}");
        }
    }
}
