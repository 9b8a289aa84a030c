//! The comparison as text for people.

use std::collections::{BTreeSet, HashSet};
use std::fmt::Write as _;
use std::io::{self, Write};

use crumple_artifact::WAVE_PREFIX;
use serde_json::Value;

use crate::Comparison;
use crate::differences::{Difference, FileReport, NotCompared, Reason, Side, TopicReport};

// What a reader asks for first when two results differ: events of the crash, parameters of candidates, metrics.

/// The kinds of difference that are printed first, in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Headline {
    /// Crush, its time and the rest of the events.
    Events,
    /// Parameters of candidates, and candidates that one side lacks.
    Parameters,
    /// Values of metrics.
    Metrics,
}

impl Headline {
    pub(crate) const ALL: [Self; 3] = [Self::Events, Self::Parameters, Self::Metrics];

    /// The kind of a difference, and its name in a summary, by which its repetition in `summary.json` is recognised;
    /// `None` for all others.
    pub(crate) fn of_difference(topic: &str, place: &str) -> Option<(Self, String)> {
        if topic == "/events" {
            return Some((Self::Events, format!("events.{place}")));
        }
        if let Some(id) = topic.strip_prefix("/parameters/") {
            let key = if place.is_empty() { format!("candidates[{id}]") } else { format!("candidates[{id}].{place}") };
            return (place.is_empty() || place.starts_with("parameters.")).then_some((Self::Parameters, key));
        }
        if topic == "/metrics" {
            let name = place.strip_suffix("].value")?.strip_prefix('[')?;
            // Where several channels carry a name, metrics are paired by index; a summary names them.
            let named = name.parse::<usize>().is_err();
            return named.then(|| (Self::Metrics, format!("metrics.{name}.value")));
        }
        if topic.starts_with('/') {
            return None;
        }
        // A summary.
        let of_candidate = || place.strip_prefix("candidates[")?.split_once(']').map(|(_, within)| within);
        let kind = if place.starts_with("events.") {
            Self::Events
        } else if of_candidate().is_some_and(|within| within.is_empty() || within.starts_with(".parameters.")) {
            Self::Parameters
        } else if place.starts_with("metrics.") && place.ends_with(".value") {
            Self::Metrics
        } else {
            return None;
        };
        Some((kind, place.to_owned()))
    }
}

/// Sort key of the differences of a topic: results of the crash, then what they were made of, remarks last.
pub(crate) fn sort_key(difference: &Difference) -> usize {
    let place = difference.place.as_str();
    let last = place.rsplit_once('.').map_or(place, |(_, last)| last);
    match last {
        "dynamic_crush_m" => 0,
        "time_of_dynamic_crush_s" => 1,
        "fit_percent" => 2,
        _ if last.starts_with("notes") => 4,
        _ => 3,
    }
}

// The report for people: one line a difference, headlines before the rest.

/// Differences of a topic that are shown without `--all`.
const SHOWN: usize = 5;

/// Waveforms of a file that are shown without `--all`.
const SHOWN_WAVES: usize = 3;

/// Longest text value shown; the rest is cut.
const LONGEST: usize = 80;

/// What differs and does not count.
const INFORMATION: &str = "  (for information)";

/// What is shown.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct TextOptions {
    /// Every difference of every topic.
    pub all: bool,
}

/// Writes the report: files on one side only, headlines, the rest, the conclusion.
pub fn write_text(report: &Comparison, options: TextOptions, out: &mut dyn Write) -> io::Result<()> {
    for file in &report.files {
        if let Some(side) = file.only_in {
            writeln!(out, "{}: only in {}", file.name, path_of(report, side))?;
        }
    }
    let written = write_headlines(report, options, out)?;
    for file in &report.files {
        let waves = if options.all { None } else { largest_waves(file) };
        let mut topics: Vec<&TopicReport> = differing(file).collect();
        topics.sort_by_key(|topic| topic.topic == "/notes");
        let mut waves_left = 0;
        for topic in topics {
            let is_left =
                |waves: &BTreeSet<&str>| topic.topic.starts_with(WAVE_PREFIX) && !waves.contains(topic.topic.as_str());
            if waves.as_ref().is_some_and(is_left) {
                waves_left += 1;
            } else {
                write_topic(report, topic, &prefix(report, file, topic), &written, options, out)?;
            }
        }
        let prefix = file_prefix(report, file);
        if waves_left > 0 {
            let s = if waves_left == 1 { "" } else { "s" };
            writeln!(out, "{prefix}{waves_left} more waveform{s} (--all shows them)")?;
        }
        for difference in &file.provenance {
            let counts = if report.provenance_counts { "" } else { INFORMATION };
            match only_side(difference).filter(|_| difference.place.is_empty()) {
                Some(side) => writeln!(out, "{prefix}provenance: only in {}{counts}", path_of(report, side))?,
                None => writeln!(out, "{prefix}{}{counts}", line("provenance", &difference.place, difference))?,
            }
        }
    }
    writeln!(out, "{}", conclusion(report))
}

/// Differences that were written, and repetitions of them.
type Written = HashSet<*const Difference>;

/// Writes the headlines of all files, each once; of metrics only a few.
fn write_headlines(report: &Comparison, options: TextOptions, out: &mut dyn Write) -> io::Result<Written> {
    let mut written = Written::new();
    let mut names = BTreeSet::new();
    for kind in Headline::ALL {
        let mut shown = 0;
        for file in &report.files {
            for topic in differing(file) {
                let mut asked: Vec<(&Difference, String)> = topic
                    .differences
                    .iter()
                    .filter_map(|d| {
                        Some((d, Headline::of_difference(&topic.topic, &d.place).filter(|(of, _)| *of == kind)?.1))
                    })
                    .collect();
                asked.sort_by_key(|(difference, _)| sort_key(difference));
                let prefix = prefix(report, file, topic);
                for (difference, name) in asked {
                    let sides = (value(difference.a.as_ref()), value(difference.b.as_ref()));
                    if names.insert((name, sides)) || options.all {
                        // More of them are written with the rest.
                        if kind == Headline::Metrics && shown == SHOWN && !options.all {
                            continue;
                        }
                        shown += 1;
                        write_record_line(report, topic, difference, &prefix, out)?;
                    }
                    written.insert(std::ptr::from_ref(difference));
                }
            }
        }
    }
    Ok(written)
}

/// The waveforms that differ most, relative to their size; `None` where all that differ are few.
fn largest_waves(file: &FileReport) -> Option<BTreeSet<&str>> {
    let mut waves: Vec<&TopicReport> = differing(file).filter(|topic| topic.topic.starts_with(WAVE_PREFIX)).collect();
    if waves.len() <= SHOWN_WAVES {
        return None;
    }
    let size = |topic: &TopicReport| topic.max_rel.unwrap_or(f64::INFINITY);
    waves.sort_by(|a, b| size(b).total_cmp(&size(a)));
    Some(waves[..SHOWN_WAVES].iter().map(|topic| topic.topic.as_str()).collect())
}

fn differing(file: &FileReport) -> impl Iterator<Item = &TopicReport> {
    file.topics.iter().filter(|topic| !topic.same || !topic.aside.is_empty())
}

/// Of two single files the name is known.
fn file_prefix(report: &Comparison, file: &FileReport) -> String {
    if report.files.len() > 1 { format!("{}: ", file.name) } else { String::new() }
}

/// summary.json is one topic of its own name.
fn prefix(report: &Comparison, file: &FileReport, topic: &TopicReport) -> String {
    if topic.topic == file.name { String::new() } else { file_prefix(report, file) }
}

fn path_of(report: &Comparison, side: Side) -> &str {
    match side {
        Side::A => &report.a,
        Side::B => &report.b,
    }
}

/// Writes the differences of a topic that are not written yet.
fn write_topic(
    report: &Comparison,
    topic: &TopicReport,
    prefix: &str,
    written: &Written,
    options: TextOptions,
    out: &mut dyn Write,
) -> io::Result<()> {
    let shown = if options.all { usize::MAX } else { SHOWN };
    let mut left: Vec<&Difference> =
        topic.differences.iter().filter(|difference| !written.contains(&std::ptr::from_ref(*difference))).collect();
    left.sort_by_key(|difference| sort_key(difference));
    // The frame of a waveform (grid, length) may differ beside its samples.
    let samples = topic.differences.iter().filter(|d| d.sample.is_some()).count();
    let differing = topic.different - (topic.differences.len() - samples) as u64;
    let mut first_sample = true;
    for difference in left.iter().take(shown) {
        let Some(time_s) = difference.time_s else {
            write_record_line(report, topic, difference, prefix, out)?;
            continue;
        };
        let which = match (first_sample, samples, differing) {
            (true, _, 1) => "the only one",
            (true, 1, _) => "the first and the largest",
            (true, ..) => "the first",
            (false, ..) => "the largest",
        };
        let place = format!("{} (t = {time_s:.6} s)", difference.place);
        let count = if differing == 1 { String::new() } else { format!(" of {differing} that differ") };
        let text = line(&topic.topic, &place, difference);
        writeln!(out, "{prefix}{text}, {which}{count} of {} samples", topic.values)?;
        first_sample = false;
    }
    let more = left.len().saturating_sub(shown);
    if more > 0 {
        writeln!(out, "{prefix}{}: {more} more (--all shows them)", topic.topic)?;
    }
    for difference in topic.aside.iter().take(shown) {
        writeln!(out, "{prefix}{}{INFORMATION}", line(&topic.topic, &difference.place, difference))?;
    }
    let more = topic.aside.len().saturating_sub(shown);
    if more > 0 {
        writeln!(out, "{prefix}{}: {more} more{INFORMATION} (--all shows them)", topic.topic)?;
    }
    Ok(())
}

fn write_record_line(
    report: &Comparison,
    topic: &TopicReport,
    difference: &Difference,
    prefix: &str,
    out: &mut dyn Write,
) -> io::Result<()> {
    match (difference.place.as_str(), only_side(difference)) {
        ("", Some(side)) => writeln!(out, "{prefix}{}: only in {}", topic.topic, path_of(report, side)),
        _ => writeln!(out, "{prefix}{}", line(&topic.topic, &difference.place, difference)),
    }
}

fn only_side(difference: &Difference) -> Option<Side> {
    match (&difference.a, &difference.b) {
        (Some(_), None) => Some(Side::A),
        (None, Some(_)) => Some(Side::B),
        _ => None,
    }
}

/// `topic, place: a  b  (abs, rel)`.
fn line(topic: &str, place: &str, difference: &Difference) -> String {
    let mut text = topic.to_owned();
    if !place.is_empty() {
        let _ = write!(text, ", {place}");
    }
    let _ = write!(text, ": {}  {}", value(difference.a.as_ref()), value(difference.b.as_ref()));
    if let (Some(abs), Some(rel)) = (difference.abs, difference.rel) {
        let _ = write!(text, "  (abs {}, rel {})", short(abs), short(rel));
    }
    let parameter = || plain_name(place.rsplit_once('.').map_or(place, |(_, name)| name));
    match difference.determined {
        Some(Side::A) => text += &format!(", {} is no longer determined", parameter()),
        Some(Side::B) => text += &format!(", {} is determined now", parameter()),
        None => {}
    }
    text
}

/// The name of a parameter without its unit: `unloading_stiffness_n_per_m` is `unloading stiffness`.
fn plain_name(parameter: &str) -> String {
    const UNITS: [&str; 8] = ["_n_s_per_m", "_n_per_m", "_m_per_s", "_s_per_m", "_kg", "_m", "_n", "_s"];
    let name = UNITS.iter().find_map(|unit| parameter.strip_suffix(unit)).unwrap_or(parameter);
    name.replace('_', " ")
}

/// How many values are not compared and why; `None`: all are.
fn not_compared(list: &[NotCompared]) -> Option<String> {
    let words = |reason: Reason| match reason {
        Reason::OpenParameter => "parameters that both sides leave open",
        Reason::FollowsOpenParameter => "what follows from such parameters",
        Reason::SolverSteps => "steps of solvers",
        Reason::SourceName => "names of sources",
        Reason::ProgramName => "names of programs",
        Reason::OtherGrid => "samples on another time grid",
        Reason::Ignored => "ignored by the tolerance file",
    };
    let total: u64 = list.iter().map(|left| left.count).sum();
    let reasons = match list {
        [] => return None,
        [one] => words(one.reason).to_owned(),
        _ => list.iter().map(|left| format!("{} ({})", words(left.reason), left.count)).collect::<Vec<_>>().join(", "),
    };
    let values = if total == 1 { "value is" } else { "values are" };
    Some(format!("{total} {values} not compared: {reasons}"))
}

/// Four significant digits, with an exponent only where it helps.
fn short(x: f64) -> String {
    if x == 0.0 || (1e-3..1e6).contains(&x) {
        let digits = if x == 0.0 { 0 } else { (3 - x.log10().floor() as i64).max(0) as usize };
        let text = format!("{x:.digits$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        format!("{x:.1e}")
    }
}

fn value(value: Option<&Value>) -> String {
    let Some(value) = value else { return "absent".to_owned() };
    let text = value.to_string();
    match text.char_indices().nth(LONGEST) {
        Some((cut, _)) => format!("{}...", &text[..cut]),
        None => text,
    }
}

/// What a comparison comes to, in one line. Where values are not compared, a line before it says how many and why.
pub fn conclusion(report: &Comparison) -> String {
    let result = result(report);
    not_compared(&report.not_compared()).map_or_else(|| result.clone(), |line| format!("{line}\n{result}"))
}

fn result(report: &Comparison) -> String {
    let topics = || report.files.iter().flat_map(|file| &file.topics).filter(|topic| topic.is_compared());
    let places = if report.files.len() == 1 { String::new() } else { format!(" in {} files", report.files.len()) };
    if report.same {
        let equal = report.files.iter().filter(|file| equal_digests(file)).count();
        if equal == report.files.len() {
            return format!("same: equal content{places}");
        }
        let values: u64 = topics().map(|topic| topic.values).sum();
        let largest = topics()
            .filter_map(|topic| Some((topic.max_rel?, &topic.topic)))
            .filter(|(rel, _)| *rel > 0.0)
            .max_by(|a, b| a.0.total_cmp(&b.0));
        let largest = largest.map_or_else(
            || ", none differs".to_owned(),
            |(rel, topic)| format!(", the largest relative difference is {rel:.1e} in {topic}"),
        );
        let count = topics().count();
        let aside = match topics().map(|topic| topic.aside.len()).sum::<usize>() {
            0 => String::new(),
            1 => "; one text differs and does not count".to_owned(),
            several => format!("; {several} texts differ and do not count"),
        };
        return format!(
            "same within tolerance: {values} values in {count} topic{}{places}{largest}{aside}",
            if count == 1 { "" } else { "s" }
        );
    }
    let different = topics().filter(|topic| !topic.same).count();
    let missing = report.files.iter().filter(|file| file.only_in.is_some()).count();
    let mut parts = Vec::new();
    if different > 0 {
        parts.push(format!("{different} of {} topics{places}", topics().count()));
    }
    if missing > 0 {
        parts.push(format!("{missing} file{} on one side only", if missing == 1 { "" } else { "s" }));
    }
    if report.provenance_counts && report.files.iter().any(|file| !file.provenance.is_empty()) {
        parts.push("provenance".to_owned());
    }
    format!("different: {}", parts.join(", "))
}

fn equal_digests(file: &FileReport) -> bool {
    file.digests.as_ref().is_some_and(|[a, b]| a == b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_summary_repeats_what_records_say_by_the_same_name() {
        for (topic, place, name) in [
            ("/events", "dynamic_crush_m", "events.dynamic_crush_m"),
            ("/parameters/kelvin/fit/1", "parameters.k_n_per_m", "candidates[kelvin/fit/1].parameters.k_n_per_m"),
            ("/metrics", "[olc].value", "metrics.olc.value"),
        ] {
            let record = Headline::of_difference(topic, place);
            assert_eq!(record, Headline::of_difference("summary.json", name), "{topic}");
            assert_eq!(record.unwrap().1, name);
        }
        for (topic, place) in [
            ("/parameters/kelvin/fit/1", "fit.rmse"),
            ("summary.json", "candidates[a].fit.rmse"),
            ("/metrics", "[olc].unit"),
            ("/metrics", "[3].value"),
            ("/wave/93", "sample 3"),
        ] {
            assert_eq!(Headline::of_difference(topic, place), None, "{topic}, {place}");
        }
    }

    #[test]
    fn a_parameter_is_named_without_its_unit() {
        let names = ["stiffness_n_per_m", "unloading_stiffness_n_per_m", "c2_n_s_per_m", "knot3_n", "v_thresh_m_per_s"];
        assert_eq!(names.map(plain_name), ["stiffness", "unloading stiffness", "c2", "knot3", "v thresh"]);
    }

    #[test]
    fn differences_are_short_numbers() {
        let shown = [0.0, 0.25, 1.5, 120.0, 5.848e-3, 1.494_381, 2e-15, 3e7].map(short);
        assert_eq!(shown, ["0", "0.25", "1.5", "120", "0.005848", "1.494", "2.0e-15", "3.0e7"]);
    }
}
