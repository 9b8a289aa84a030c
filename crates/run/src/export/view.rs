//! `crumple-view`: a run as a recording that viewers plot: Foxglove, Lichtblick, PlotJuggler, Rerun.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use crumple_artifact::records::{EventsV1, PredictionV1};
use crumple_artifact::{Artifact, OutputKind, write_atomically};
use crumple_report::Summary;
use crumple_stage::{ExitStatus, Refused, Usage, artifacts_of_a_run, keep_budget, refuse_to_overwrite, say, to_stdout};

use super::layouts::{RERUN, Shown, foxglove, plotjuggler};
use super::program::records;
use super::view_file::{FieldKind, Topic, Value, recording};
use super::waves::{RunWave, Source, to_ns, waves_of, with_unit};

/// Writes a run as a recording that viewers plot: Foxglove, Lichtblick, PlotJuggler, Rerun.
///
/// A topic a body, a field a quantity in SI units, a message a sample; test, models and predictions on one clock, on
/// which time zero is 1 s. Layouts for viewers stand beside it.
#[derive(Debug, clap::Parser)]
#[command(
    name = "crumple-view",
    version,
    after_help = "Exit codes: 0 done, 1 unforeseen failure, 2 usage, 3 input refused."
)]
pub struct ViewOptions {
    /// Folder of a run.
    #[arg(value_name = "RUN")]
    run: PathBuf,

    /// Recording to write.
    #[arg(short, long, value_name = "FILE", default_value = "view.mcap")]
    output: PathBuf,

    /// Every sample, however large the file gets [default: above 5 MB the lowest and highest of each interval].
    #[arg(long)]
    all: bool,

    /// Models to write.
    #[arg(long, value_enum, default_value = "all")]
    models: Models,

    /// The layout for this viewer alone; for Rerun lines of Python on standard output [default: files for the others].
    #[arg(long, value_enum, value_name = "VIEWER")]
    layout: Option<Layout>,

    /// No summary.
    #[arg(short, long)]
    quiet: bool,
}

/// Which models are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Models {
    /// The recommended one.
    Recommended,
    /// All.
    All,
}

/// A viewer with a layout.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Layout {
    /// Foxglove and Lichtblick.
    Foxglove,
    /// PlotJuggler.
    Plotjuggler,
    /// Rerun.
    Rerun,
}

/// Time zero on the clock of the file, ns: viewers show no time before 0.
const ZERO_NS: i64 = 1_000_000_000;
/// Bytes above which samples are left out.
const MOST: usize = 5_000_000;

/// Writes the recording of a run and its layouts.
pub(crate) fn view(options: ViewOptions) -> anyhow::Result<ExitStatus> {
    keep_budget(std::slice::from_ref(&options.run), ExitStatus::Refused);
    let paths = artifacts_of_a_run(&options.run)?;
    let folder = options.output.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if folder.join("1-ingest.mcap").is_file() {
        let problem = format!("{} would lie among the artifacts of a run", options.output.display());
        let elsewhere = folder.join("..").join("view.mcap");
        return Err(Usage::new(problem).hint(format!("write it elsewhere, such as -o {}", elsewhere.display())).into());
    }
    let layouts = [(Layout::Foxglove, "foxglove.json"), (Layout::Plotjuggler, "plotjuggler.xml")]
        .map(|(layout, ending)| (layout, options.output.with_extension(ending)));
    let wanted = |layout: Layout| options.layout.is_none_or(|only| only == layout);
    for path in
        std::iter::once(&options.output).chain(layouts.iter().filter(|(of, _)| wanted(*of)).map(|(_, path)| path))
    {
        refuse_to_overwrite(path, OutputKind::View, &paths)?;
    }
    let artifacts: Vec<Artifact> =
        paths.iter().map(|path| Artifact::open(path).map_err(Refused::from)).collect::<Result<_, _>>()?;
    let summary = read_summary(&options.run)?;
    let run = ViewedRun::new(&artifacts, &summary, options.models)?;
    let (topics, shown) = (run.topics(), run.shown());
    let library = concat!("crumple ", env!("CARGO_PKG_VERSION"));
    let mut bytes = recording(&topics, library)?;
    let mut every = 4;
    while bytes.len() > MOST && !options.all && every < 1 << 20 {
        every *= 2;
        let thinned: Vec<Topic> = topics
            .iter()
            .map(|topic| if topic.messages.len() > every { topic.thinned(every) } else { topic.clone() })
            .collect();
        bytes = recording(&thinned, library)?;
    }
    let write = |path: &Path, content: &[u8]| {
        write_atomically(path, OutputKind::View, |file| file.write_all(content))
            .with_context(|| format!("cannot write {}", path.display()))
    };
    write(&options.output, &bytes)?;
    for (layout, path) in layouts.iter().filter(|(layout, _)| wanted(*layout)) {
        let text = if *layout == Layout::Foxglove { foxglove(&shown) } else { plotjuggler(&shown) };
        write(path, text.as_bytes())?;
    }
    if options.layout == Some(Layout::Rerun) {
        to_stdout(RERUN.as_bytes())?;
    }
    if !options.quiet {
        let messages: usize = topics.iter().map(|topic| topic.messages.len()).sum();
        let thinned = if every > 4 { format!(", thinned to the extremes of every {every}") } else { String::new() };
        say(format_args!("{} topics, {messages} samples{thinned}: {}", topics.len(), options.output.display()));
    }
    Ok(ExitStatus::Done)
}

fn read_summary(run: &Path) -> anyhow::Result<Summary> {
    let path = run.join("summary.json");
    let refused = |found: String| Refused::new(found).expected("the folder of a run that has its report");
    let bytes = fs::read(&path).map_err(|error| refused(format!("cannot read {}: {error}", path.display())))?;
    Ok(Summary::from_json(&bytes).map_err(|error| refused(format!("{}: {error}", path.display())))?)
}

/// Waveforms of one body on one grid.
type Group<'a> = Vec<&'a RunWave<'a>>;

/// A run as viewers see it.
struct ViewedRun<'a> {
    summary: &'a Summary,
    events: Option<EventsV1>,
    /// Topic and waveforms.
    bodies: Vec<(String, Vec<RunWave<'a>>)>,
}

/// Where a body is from, its name, and the start (ns) and step (bits of s) of its samples.
type BodyOnGrid = (Source, String, i64, u64);

impl<'a> ViewedRun<'a> {
    fn new(artifacts: &'a [Artifact], summary: &'a Summary, models: Models) -> anyhow::Result<Self> {
        let events = records::<EventsV1>(artifacts, "/events").map_err(Refused::from)?;
        let predictions = records::<PredictionV1>(artifacts, "/prediction/").map_err(Refused::from)?;
        let speeds: BTreeMap<String, f64> =
            predictions.into_iter().map(|(number, made)| (number, 3.6 * made.impact_speed_m_per_s)).collect();
        let mut grouped: Vec<(BodyOnGrid, Vec<RunWave<'a>>)> = Vec::new();
        let recommended = summary.recommended.as_deref();
        for wave in waves_of(artifacts) {
            let is_recommended = recommended.is_some_and(|id| is_of(&wave.body, id));
            if wave.source == Source::Model && models == Models::Recommended && !is_recommended {
                continue;
            }
            let key = (wave.source, wave.body.clone(), to_ns(wave.sampled.t0_s()), wave.sampled.dt_s().to_bits());
            match grouped.iter_mut().find(|(known, _)| *known == key) {
                Some((_, waves)) => waves.push(wave),
                None => grouped.push((key, vec![wave])),
            }
        }
        // Of one body on several grids the one with most quantities has its name.
        grouped.sort_by_key(|((source, ..), waves)| (*source, std::cmp::Reverse(waves.len())));
        let (mut taken, mut named) = (BTreeSet::new(), BTreeSet::new());
        let mut bodies = Vec::new();
        for ((source, body, ..), waves) in grouped {
            let mut topic = topic(source, &body, &speeds);
            if !named.insert((source, body)) {
                topic = format!("{topic}/{}", waves[0].quantity.name());
            }
            let numbered = (2..).map(|number| format!("{topic}_{number}"));
            let name = std::iter::once(topic.clone()).chain(numbered).find(|name| taken.insert(name.clone()));
            bodies.push((name.unwrap_or(topic), waves));
        }
        bodies.sort_by(|a, b| (a.1[0].source, &a.0).cmp(&(b.1[0].source, &b.0)));
        Ok(Self { summary, events: events.into_iter().next().map(|(_, events)| events), bodies })
    }

    /// Log time of a time on the axis of a waveform.
    fn log_time(&self, t_ns: i64) -> i64 {
        self.origin_ns() + t_ns
    }

    /// Time zero on the clock of the file, ns: one second, or as many as the longest record has before it.
    fn origin_ns(&self) -> i64 {
        let starts = self.bodies.iter().flat_map(|(_, waves)| waves).map(|wave| wave.time_ns(0));
        let before = starts.min().unwrap_or(0).saturating_neg().max(1);
        (before + ZERO_NS - 1) / ZERO_NS * ZERO_NS
    }

    fn topics(&self) -> Vec<Topic> {
        let mut topics: Vec<Topic> = self.bodies.iter().map(|(name, waves)| self.motion(name, waves)).collect();
        topics.extend(self.events.as_ref().map(|events| self.events(events)));
        topics.push(self.summary());
        topics
    }

    fn motion(&self, name: &str, waves: &[RunWave<'_>]) -> Topic {
        let waves = in_order(waves);
        let names = distinct(waves.iter().map(|wave| identifier(&wave.field)));
        let mut metadata = BTreeMap::from([("id".to_owned(), waves[0].body.clone())]);
        for (field, wave) in names.iter().zip(&waves) {
            metadata.insert(format!("unit.{field}"), wave.quantity.si_unit().to_owned());
        }
        if waves[0].source == Source::Model {
            let recommended = self.summary.recommended.as_ref().filter(|id| is_of(&waves[0].body, id));
            let candidate = self.summary.candidates.iter().find(|candidate| is_of(&waves[0].body, &candidate.id));
            metadata.extend(candidate.map(|candidate| ("model".to_owned(), candidate.model.clone())));
            metadata.extend(recommended.map(|_| ("recommended".to_owned(), "true".to_owned())));
        }
        let longest = waves.iter().map(|wave| wave.sampled.len()).max().unwrap_or(0);
        let message = |k: usize| {
            let time = self.log_time(waves[0].time_ns(k));
            let values = waves.iter().map(|wave| wave.sampled.samples().get(k).copied().map(Value::Double));
            (time as u64, values.collect())
        };
        Topic {
            name: name.to_owned(),
            fields: names.into_iter().map(|name| (name, FieldKind::Double)).collect(),
            metadata,
            messages: (0..longest).map(message).collect(),
        }
    }

    /// The events of the crash, each at its instant.
    fn events(&self, events: &EventsV1) -> Topic {
        let rebound = events.rebound_velocity_m_per_s;
        let at = [
            ("contact", Some(0.0), Some(0.0), "s"),
            ("dynamic crush", events.time_of_dynamic_crush_s, events.dynamic_crush_m, "m"),
            ("rebound", events.time_of_rebound_s, rebound, "m/s"),
            ("separation", events.time_of_rebound_s, events.coefficient_of_restitution, "1"),
            ("end of event", events.end_of_event_s, events.delta_v_m_per_s, "m/s"),
        ];
        let message = |(name, at_s, value, unit): (&str, Option<f64>, Option<f64>, &str)| {
            let time = self.origin_ns() + to_ns(at_s?);
            let texts = [name, unit].map(|text| Some(Value::Text(text.to_owned())));
            let [name, unit] = texts;
            Some((time as u64, vec![name, value.map(Value::Double), unit]))
        };
        let mut messages: Vec<_> = at.into_iter().filter_map(message).collect();
        messages.sort_by_key(|(time, _)| *time);
        let fields = [("name", FieldKind::Text), ("value", FieldKind::Double), ("unit", FieldKind::Text)];
        Topic {
            name: "/event".to_owned(),
            fields: fields.map(|(name, kind)| (name.to_owned(), kind)).into(),
            metadata: BTreeMap::new(),
            messages,
        }
    }

    /// What the report says first, at time zero.
    fn summary(&self) -> Topic {
        let verdict = &self.summary.verdict;
        let sentences: Vec<&str> =
            std::iter::once(&verdict.status_sentence).chain(&verdict.sentences).map(String::as_str).collect();
        let text = |text: String| Some(Value::Text(text)).filter(|value| *value != Value::Text(String::new()));
        let mut fields = vec![
            ("verdict".to_owned(), text(sentences.join(" "))),
            ("recommended".to_owned(), text(self.summary.recommended.clone().unwrap_or_default())),
        ];
        for number in &self.summary.key_numbers {
            fields.push((identifier(&with_unit(&number.name, &number.unit)), number.value.map(Value::Double)));
        }
        let names = distinct(fields.iter().map(|(name, _)| name.clone()));
        let kind = |k: usize| if k < 2 { FieldKind::Text } else { FieldKind::Double };
        Topic {
            name: "/summary".to_owned(),
            fields: names.into_iter().enumerate().map(|(k, name)| (name, kind(k))).collect(),
            metadata: BTreeMap::new(),
            messages: vec![(self.origin_ns() as u64, fields.into_iter().map(|(_, value)| value).collect())],
        }
    }

    /// What the layouts show: the pulse and the recommended model.
    fn shown(&self) -> Shown {
        let channel = self.summary.test.channel.as_deref().unwrap_or_default();
        let recommended = self.summary.recommended.as_deref();
        let is_shown = |wave: &RunWave<'_>| match wave.source {
            Source::Test => wave.body == channel || wave.body == format!("{channel}/unfiltered"),
            Source::Model => Some(wave.body.as_str()) == recommended,
            Source::Prediction => false,
        };
        let mut shown = Shown::default();
        for (topic, waves) in &self.bodies {
            for wave in waves.iter().filter(|wave| is_shown(wave)) {
                shown.add(wave.quantity, topic, &identifier(&wave.field), wave.field == wave_field(wave));
            }
        }
        shown
    }
}

/// The field of a quantity of the body as a whole.
fn wave_field(wave: &RunWave<'_>) -> String {
    with_unit(wave.quantity.name(), wave.quantity.si_unit())
}

/// Whether a body is a candidate or one of its masses.
fn is_of(body: &str, candidate: &str) -> bool {
    body.strip_prefix(candidate).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

/// Motion first, then forces; those of the whole body before those of elements.
fn in_order<'a>(waves: &'a [RunWave<'a>]) -> Group<'a> {
    let mut sorted: Group<'a> = waves.iter().collect();
    sorted.sort_by_key(|wave| (wave.quantity, wave.field != wave_field(wave), wave.field.clone()));
    sorted
}

/// The topic of a body, in letters that every viewer takes.
fn topic(source: Source, body: &str, speeds: &BTreeMap<String, f64>) -> String {
    let name = match source {
        Source::Test => format!("/test/{body}"),
        Source::Model => match body.rsplit_once("/m") {
            Some((candidate, mass)) if mass.parse::<u32>().is_ok() => format!("/model/{candidate}/mass{mass}"),
            _ => format!("/model/{body}"),
        },
        Source::Prediction => {
            let rest = body.strip_prefix("prediction/").unwrap_or(body);
            let (number, of) = rest.split_once('/').map_or((rest, ""), |(number, of)| (number, of));
            let speed = speeds
                .get(number)
                .map_or_else(String::new, |speed| format!("_at_{}_km_per_h", (speed * 10.0).round() / 10.0));
            format!("/prediction/{number}{speed}{}{of}", if of.is_empty() { "" } else { "/" })
        }
    };
    name.chars().map(|c| if c.is_ascii_alphanumeric() || "_/-".contains(c) { c } else { '_' }).collect()
}

/// A name of letters, digits and `_`, beginning with a letter.
fn identifier(name: &str) -> String {
    let plain: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if plain.starts_with(|c: char| c.is_ascii_alphabetic()) { plain } else { format!("f_{plain}") }
}

/// The names, with a number behind one that another has.
fn distinct(names: impl Iterator<Item = String>) -> Vec<String> {
    let mut taken = BTreeSet::new();
    names
        .map(|name| {
            let numbered = (2..).map(|number| format!("{name}_{number}"));
            let mut all = std::iter::once(name.clone()).chain(numbered);
            all.find(|name| taken.insert(name.clone())).unwrap_or(name)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn topics_are_escaped_and_fields_are_identifiers_each_once() {
        let speeds = BTreeMap::from([("2".to_owned(), 56.0)]);
        assert_eq!(topic(Source::Test, "a b/ü..", &speeds), "/test/a_b/___");
        assert_eq!(topic(Source::Model, "chain/direct-fit/1/m3", &speeds), "/model/chain/direct-fit/1/mass3");
        assert_eq!(topic(Source::Prediction, "prediction/2/partner", &speeds), "/prediction/2_at_56_km_per_h/partner");
        let names = ["k1", "1k", "k1", "ü"].map(str::to_owned);
        assert_eq!(distinct(names.iter().map(|name| identifier(name))), ["k1", "f_1k", "k1_2", "f__"]);
    }
}
